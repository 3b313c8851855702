#!/usr/bin/python3
"""The paper's cases: sheets, meshes, tests, how each is run and what is kept of it. Used by tools/campaign and
tools/campaign_report. SI units."""
import math
from dataclasses import dataclass

import numpy as np

from floe_plate import plate, profile

INTEGRATORS = ["quasistatic", "explicit"]
LENGTHS = [10, 20, 40, 80, 160]        # L [m] (paper, "Mesh Creation")
THICKNESSES = [0.5, 1, 1.5]            # h [m]
FACTORS = [2, 3]                       # l/h
STRAIN = 0.001                         # u/L (paper, "Effective Young's Modulus")
SPEED = 0.1                            # of the right edge [m/s]
TENSION = {"quasistatic": "input/tension.yaml", "explicit": "input/tension_explicit.yaml"}
BENDING = {"quasistatic": "input/bending.yaml", "explicit": "input/bending_explicit.yaml"}


@dataclass(frozen=True)
class Sheet:
    """A square sheet of the paper."""
    length: float
    thickness: float
    factor: int  # l/h

    @property
    def element_size(self):
        return self.factor * self.thickness

    @property
    def name(self):
        return f"L{self.length:g}_h{self.thickness:g}_{self.factor}h"

    @property
    def bodies(self):
        """N = ceil(2 L^2/(sqrt(3) l^2)) (docs/model.md section 1)."""
        return math.ceil(2 * self.length**2 / (math.sqrt(3) * self.element_size**2))

    @property
    def meshes(self):
        """Random meshes in the paper: ten, six of the largest sheet."""
        return 6 if (self.length, self.thickness, self.factor) == (160, 0.5, 2) else 10


SHEETS = [Sheet(length, thickness, factor) for length in LENGTHS for thickness in THICKNESSES for factor in FACTORS]


@dataclass(frozen=True)
class Case:
    """One test on one mesh of one sheet; meshes are numbered from 1."""
    test: str
    sheet: Sheet
    number: int

    @property
    def mesh_name(self):
        return f"{self.sheet.name}_{self.number:02d}"

    @property
    def name(self):
        return f"{self.test}_{self.mesh_name}"

    @property
    def bodies(self):
        return self.sheet.bodies

    @property
    def seed(self):
        """No two sheets share their random numbers: sheets of equal L/l would be the same mesh."""
        return 100 * SHEETS.index(self.sheet) + self.number

    def scene(self, integrator):
        """Scene file and command-line options."""
        sheet = self.sheet
        options = {"sheet_length": sheet.length, "sheet_width": sheet.length, "sheet_thickness": sheet.thickness,
                   "sheet_element_size": sheet.element_size, "sheet_seed": self.seed}
        if self.test == "tension":
            if integrator == "quasistatic":
                options["boundary_right_displacement"] = f"{STRAIN * sheet.length:.12g},0,0"
            else:
                options["time_end"] = STRAIN * sheet.length / SPEED
            scene = TENSION[integrator]
        else:
            if integrator != "quasistatic":  # critical for heaving: 2 sqrt(rho_w g rho_i h) per unit area
                options["water_drag_linear"] = round(2 * math.sqrt(1010 * 9.81 * 920 * sheet.thickness), 1)
            scene = BENDING[integrator]
        return scene, [word for key, value in options.items() for word in (f"-{key}", f"{value}")]

    def evaluate(self, output):
        """What is kept of a run: a row of numbers, and for bending the profile r/l_c, w/w0, y."""
        summary = output.summary
        row = {"case": self.name, "L": float(self.sheet.length), "h": float(self.sheet.thickness), "l": float(self.sheet.element_size),
               "N": int(summary["bodies"]), "seed": self.seed, "integrator": summary["integrator"], "version": summary["version"]}
        if self.test == "tension":
            row |= {key: float(summary[key]) for key in ("E", "E_over_Eb", "E_over_Estar")}
            return {"row": row, "wall_s": summary["wall_s"]}
        row |= {key: float(summary[key]) for key in ("deflection_max", "deflection_over_wyman")}
        length, w0 = plate(output.options())
        r, w = profile(output, output.options())
        r, w = np.concatenate([[0], r]), np.concatenate([[summary["deflection_max"]], w])
        return {"row": row, "profile": np.stack([r / length, w / w0, r / (self.sheet.length / 2)], axis=1).tolist(),
                "wall_s": summary["wall_s"]}


def select(only="", meshes=0):
    """Cases whose name contains one of the texts in `only`; `meshes` per sheet instead of the paper's number."""
    texts = [text for text in only.split(",") if text]
    chosen = [Case(test, sheet, number) for test in ("tension", "bending") for sheet in SHEETS
              for number in range(1, (meshes or sheet.meshes) + 1) if test == "tension" or sheet.length > 10]
    return [case for case in chosen if not texts or any(text in case.name for text in texts)]
