#!/usr/bin/python3
"""The paper's cases: sheets, meshes, tests, how each is run and what is kept of it. Used by floe
campaign and floe campaign_report. SI units."""
import math
from dataclasses import dataclass
from typing import Callable

import numpy as np

from floe.sheets.plate import plate, profile

INTEGRATORS = ["quasistatic", "explicit", "implicit"]
STARTS = ["step", "smooth"]
LENGTHS = [10, 20, 40, 80, 160]        # L [m] (paper, "Mesh Creation")
THICKNESSES = [0.5, 1, 1.5]            # h [m]
FACTORS = [2, 3]                       # l/h
STRAIN = 0.001                         # u/L (paper, "Effective Young's Modulus")
SPEED = 0.1                            # of the right edge [m/s]
YOUNG, ICE, WATER, GRAVITY = 4e9, 920, 1010, 9.81  # of the paper's scenes (paper, table 1)
SIDES = {"x": ("left", "right"), "y": ("bottom", "top")}


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


SHEETS = [Sheet(length, thickness, factor) for length in LENGTHS for thickness in THICKNESSES
          for factor in FACTORS]


def gauge(output, axis):
    """Distance of the mean places of a pair of opposite edge sets at rest, and its change by the
    end [m]."""
    k = "xyz".index(axis)
    low, high = (output.sets[name] for name in SIDES[axis])
    moved = output.field("bodies_displacement", output.times[-1])[:, k]
    return output.position[high,
                           k].mean() - output.position[low,
                                                       k].mean(), moved[high].mean() - moved[
                                                           low].mean()


def strain(output, axis):
    """Mean strain between the centroids of opposite edges' bodies."""
    length, change = gauge(output, axis)
    return change / length


def stress(output, sheet, boundary, axis):
    """What a boundary pulls with at the end, over the section L h [Pa]."""
    return output.history(f"{boundary}_force_{axis}")[-1] / (sheet.length * sheet.thickness)


def pulled(sheet, integrator, start):
    if integrator == "quasistatic":
        return {"boundary_right_displacement": f"{STRAIN * sheet.length:.12g},0,0"}
    # Waves run between the two edges and back in 2 L/c: a speed that rises over a whole number of
    # these periods leaves no ringing behind.
    ramp = round(4 * sheet.length / math.sqrt(0.8 * YOUNG / ICE), 6) if start == "smooth" else 0
    return {"boundary_right_ramp": ramp, "time_end": STRAIN * sheet.length / SPEED + ramp / 2}


def young(output, sheet):
    """E as the paper has it, with the strain over the gauge length, and of the springs alone: what
    they store, (1/2) E eps^2 L^2 h, knows nothing of the dashpots' force, and ringing adds its own
    small energy only (it does no work against the static state: the edges do not take part in
    it)."""
    row = {key: float(output.summary[key]) for key in ("E", "E_over_Eb", "E_over_Estar",
                                                       "E_gauge_over_Eb")}
    over_length = gauge(output, "x")[1] / sheet.length
    row["E_stored_over_Eb"] = 2 * output.summary["energy"]["strain"] / (over_length**2
                                                                        * sheet.length**2
                                                                        * sheet.thickness * YOUNG)
    row["poisson"] = -strain(output, "y") / strain(output, "x")
    return {"row": row}


def loaded(sheet, integrator, start):
    if integrator == "quasistatic":
        return {}
    # Drag is critical for heaving, 2 sqrt(rho_w g rho_i h) per area; all slower than it has died
    # out after 14/omega.
    omega = math.sqrt(WATER * GRAVITY / (ICE * sheet.thickness))
    return {"water_drag_linear": round(2 * omega * ICE * sheet.thickness, 1),
            "time_end": round(1 + 14 / omega, 2)}


def deflection(output, sheet):
    """Deflection under the load, and the profile r/l_c, w/w0, r/(L/2) along X = 0, Y >= 0."""
    length, w0 = plate(output.options())
    r, w = profile(output, output.options())
    r, w = np.concatenate([[0], r]), np.concatenate([[output.summary["deflection_max"]], w])
    return {"row": {key: float(output.summary[key])
                    for key in ("deflection_max", "deflection_over_wyman")},
            "profile": np.stack([r / length, w / w0, r / (sheet.length / 2)], axis=1).tolist()}


def shortened(sheet, integrator, start):
    return {"boundary_right_displacement": f"{-STRAIN * sheet.length:.12g},0,0"}


def both_ways(sign):
    """All four edges moved out in x by half the strain, in y too (sign 1) or in (sign -1)."""
    def options(sheet, integrator, start):
        half = STRAIN * sheet.length / 2
        moved = {"left": (-half, 0), "right": (half, 0), "bottom": (0, -sign * half),
                 "top": (0, sign * half)}
        return {f"boundary_{side}_displacement": f"{x:.12g},{y:.12g},0"
                for side, (x, y) in moved.items()}
    return options


def two_stresses(output, sheet):
    return stress(output, sheet, "right", "x"), stress(output, sheet, "top",
                                                       "y"), strain(output, "x"), strain(output,
                                                                                         "y")


def bulk(output, sheet):
    """Two-dimensional bulk modulus (sx + sy)/(2 (ex + ey)), strains over the gauge lengths."""
    sx, sy, ex, ey = two_stresses(output, sheet)
    return {"row": {"K_over_Eb": (sx + sy) / (2 * (ex + ey) * YOUNG)}}


def rigidity(output, sheet):
    """Shear modulus (sx - sy)/(2 (ex - ey)), strains over the gauge lengths."""
    sx, sy, ex, ey = two_stresses(output, sheet)
    return {"row": {"G_over_Eb": (sx - sy) / (2 * (ex - ey) * YOUNG)}}


def slid(sheet, integrator, start):
    return {"boundary_top_displacement": f"{STRAIN * sheet.length:.12g},0,0"}


def sliding(output, sheet):
    """Mean shear stress of the moved edge over its slope to the held one, over the gauge length.
    The other two sides are free, so a continuum has less than G too (plate.simple_shear)."""
    length = gauge(output, "y")[0]
    slope = output.history("top_displacement_x")[-1] / length
    return {"row": {"slide_over_Eb": stress(output, sheet, "top", "x") / slope / YOUNG}}


@dataclass(frozen=True)
class Test:
    """A test: its scene for each integrator it has, its further options, what is kept."""
    scenes: dict
    options: Callable
    evaluate: Callable
    smallest: float = 0  # L [m]


def moving(scene):
    """Both ways to step in time run the same scene."""
    return {"explicit": scene, "implicit": scene}


TESTS = {
    "tension": Test({"quasistatic": "input/tension.yaml", **moving("input/tension_explicit.yaml")},
                    pulled, young),
    "bending": Test({"quasistatic": "input/bending.yaml", **moving("input/bending_explicit.yaml")},
                    loaded, deflection, 20),
    "compression": Test({"quasistatic": "input/compression.yaml"}, shortened, young),
    "biaxial": Test({"quasistatic": "input/biaxial.yaml"}, both_ways(1), bulk),
    "shear": Test({"quasistatic": "input/shear.yaml"}, both_ways(-1), rigidity),
    "slide": Test({"quasistatic": "input/slide.yaml"}, slid, sliding),
}
PAPER = ["tension", "bending"]


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

    def scene(self, integrator, start):
        """Scene file and {key: value} of its options."""
        sheet = self.sheet
        options = {"sheet_length": sheet.length, "sheet_width": sheet.length,
                   "sheet_thickness": sheet.thickness,
                   "sheet_element_size": sheet.element_size, "sheet_seed": self.seed}
        options |= TESTS[self.test].options(sheet, integrator, start)
        if integrator == "implicit":
            options["integrator"] = integrator
        return TESTS[self.test].scenes[integrator], options

    def evaluate(self, output):
        """What is kept of a run: a row of numbers, and for bending a profile."""
        summary = output.summary
        row = {"case": self.name, "L": float(self.sheet.length), "h": float(self.sheet.thickness),
               "l": float(self.sheet.element_size),
               "N": int(summary["bodies"]), "seed": self.seed, "integrator": summary["integrator"],
               "version": summary["version"]}
        found = TESTS[self.test].evaluate(output, self.sheet)
        return found | {"row": row | found["row"], "wall_s": summary["wall_s"]}


def select(only="", meshes=0, tests=PAPER):
    """Cases whose name contains one of the texts in `only`; `meshes` per sheet instead of the
    paper's number."""
    texts = [text for text in only.split(",") if text]
    chosen = [Case(test, sheet, number) for test in tests for sheet in SHEETS
              for number in range(1, (meshes or sheet.meshes) + 1)
              if sheet.length >= TESTS[test].smallest]
    return [case for case in chosen if not texts or any(text in case.name for text in texts)]
