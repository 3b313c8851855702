#!/usr/bin/python3
"""Results of a campaign and their tables (floe campaign_report)."""
import json
from pathlib import Path

import h5py
import numpy as np

import campaign_figures as figures
from campaign_cases import SHEETS, TESTS
from floe.errors import reading
from floe.sheets.plate import simple_shear

# E/Eb of one_point beams by independent static solutions: L/l: (mean, standard deviation, meshes)
# (docs/model.md)
YOUNG = {2.22: (1.446, .198, 200), 3.33: (1.175, .043, 200), 4.44: (1.095, .022, 200),
         6.67: (.966, .026, 120), 10: (.904, .014, 100),
         13.33: (.872, .009, 80), 20: (.843, .005, 40), 40: (.8147, .0026, 20),
         80: (.8022, .0009, 6)}
# Deflection over w0, one_point, saint_venant, of independent lattice solutions (1 to 6 meshes
# each): (L, h, l/h): value
DEFLECTION = {(160, .5, 2): 1.085, (160, .5, 3): 1.05, (160, 1, 2): 1.088, (160, 1, 3): 1.051,
              (160, 1.5, 2): 1.098, (160, 1.5, 3): 1.066,
              (80, 1.5, 2): 1.249, (80, 1.5, 3): 1.221, (40, .5, 2): 1.21, (40, .5, 3): 1.19,
              (20, 1.5, 2): 7.15, (20, 1.5, 3): 7.14}


class Campaign:
    """Results of one folder, sheet by sheet."""

    def __init__(self, folder, label=""):
        self.folder, self.label = Path(folder), label
        with reading(self.folder / "campaign.json"):
            made_with = json.loads((self.folder / "campaign.json").read_text())
            self.integrator, self.start, self.options = (made_with[key]
                                                         for key in ("integrator", "start",
                                                                     "options"))
        with reading(self.folder / "results.h5"), h5py.File(self.folder / "results.h5") as file:
            self.tables = {test: file[test][:] for test in TESTS if test in file}
            self.profiles = {name: data[:] for name, data in file.get("profiles", {}).items()}

    def rows(self, test, sheet):
        table = self.tables.get(test)
        if table is None:
            return []
        return table[(table["L"] == sheet.length) & (table["h"] == sheet.thickness)
                     & (abs(table["l"] - sheet.element_size) < 1e-9)]

    def values(self, test, sheet, column):
        return np.array([row[column] for row in self.rows(test, sheet)])

    def mean(self, test, sheet, column):
        values = self.values(test, sheet, column)
        return np.mean(values) if len(values) else np.nan

    def profiles_of(self, sheet):
        return [self.profiles[row["case"].decode()] for row in self.rows("bending", sheet)]

    def ratios(self, other, test, sheet, column, column_of_other=None):
        """This campaign's values over another's, mesh by mesh, on the meshes that both have."""
        theirs = {row["seed"]: row[column_of_other or column] for row in other.rows(test, sheet)}
        return np.array([row[column] / theirs[row["seed"]] for row in self.rows(test, sheet)
                         if row["seed"] in theirs])


def spread(values, digits=4):
    """Mean ± standard deviation (number), or a dash."""
    if len(values) == 0:
        return "–"
    if len(values) == 1:
        return f"{values[0]:.{digits}f} (1)"
    return f"{np.mean(values):.{digits}f} ± {np.std(values, ddof=1):.{digits}f} ({len(values)})"


def table(head, rows):
    """Markdown lines of a table."""
    return ["| " + " | ".join(head) + " |", "|"
            + "---|" * len(head)] + ["| " + " | ".join(row) + " |" for row in rows]


def named(sheet):
    return [f"{sheet.length:g}", f"{sheet.thickness:g}", f"{sheet.factor}h"]


def known_young(sheet):
    """(mean, standard deviation, meshes) of the independent solution, or None."""
    return next((known for ratio, known in YOUNG.items()
                 if abs(sheet.length / sheet.element_size - ratio) < 0.01), None)


def deviation(values, known):
    """Difference of the means over the standard error of both samples."""
    return (np.mean(values) - known[0]) / (known[1] * np.sqrt(1 / len(values) + 1 / known[2]))


def tension(c):
    rows = []
    for sheet in SHEETS:
        values = c.values("tension", sheet, "E_over_Eb")
        if len(values) == 0:
            continue
        known = known_young(sheet)
        rows.append([*named(sheet), f"{sheet.length / sheet.element_size:.2f}", f"{sheet.bodies}",
                     spread(values),
                     spread(c.values("tension", sheet, "E_over_Estar")),
                     spread(c.values("tension", sheet, "E_gauge_over_Eb")),
                     f"{known[0]:.4g} ± {known[1]:.2g} ({known[2]})" if known else "–",
                     f"{deviation(values, known):+.1f}" if known and len(values) > 1 else "–",
                     f"{np.std(values, ddof=1) / known[1]:.2f}" if known and len(values) > 1
                     else "–"])
    return table(["L [m]", "h [m]", "l", "L/l", "N", "E/Eb, mean ± std (meshes)", "E/E*",
                  "E/Eb over the gauge length", "independent E/Eb",
                  "deviations", "std/std"], rows)


def bending(c):
    rows = []
    for sheet in SHEETS:
        values = c.values("bending", sheet, "deflection_over_wyman")
        if len(values):
            known = DEFLECTION.get((sheet.length, sheet.thickness, sheet.factor))
            rows.append([*named(sheet),
                         f"{sheet.length / 2 / figures.characteristic_length(sheet.thickness):.2f}",
                         spread(values),
                         f"{known:g}" if known else "–", f"{np.mean(values) / known - 1:+.1%}"
                         if known else "–"])
    return table(["L [m]", "h [m]", "l", "L/2l_c", "w/w0 under the load, mean ± std (meshes)",
                  "independent", "difference"], rows)


def size(base, calibrated):
    """Deflections by the sheet's half-width over l_c: over the infinite lattice's w0* as they come,
    over w0 calibrated."""
    # w0*/w0 = (D*/D)^(-1/2), saint_venant (docs/model.md section 3)
    stiffness = {2: 1.084, 3: 1.051}
    rows = []
    for (length, thickness, _), sheet in sorted(((s.length, s.thickness, s.factor), s)
                                                for s in SHEETS if s.factor == 2):
        half = length / 2 / figures.characteristic_length(thickness)
        pair = [figures.SHEET[length, thickness, factor] for factor in (2, 3)]
        if len(base.rows("bending", sheet)):
            rows.append((half, [f"{half:.2f}", f"{length:g}", f"{thickness:g}"] +
                         [f"{base.mean('bending', s, 'deflection_over_wyman') / known:.3f}"
                          for s in pair for known in (stiffness[s.factor],)] +
                         [spread(calibrated.values("bending", s, "deflection_over_wyman"), 3)
                          for s in pair]))
    return table(["L/2l_c", "L [m]", "h [m]", "w/w0*, l = 2h", "w/w0*, l = 3h",
                  "calibrated w/w0, l = 2h", "calibrated w/w0, l = 3h"],
                 [row for _, row in sorted(rows)])


def far_enough(calibrated):
    """How far calibrated sheets are from the infinite plate, by their half-width over l_c."""
    off = {}
    for sheet in SHEETS:
        half = round(sheet.length / 2 / figures.characteristic_length(sheet.thickness), 2)
        if len(calibrated.rows("bending", sheet)):
            off.setdefault(half,
                           []).append(abs(calibrated.mean("bending", sheet, "deflection_over_wyman")
                                          - 1))
    far, near = [max(v) for half, v in off.items()
                 if half > 4.8], sorted((half, max(v)) for half, v in off.items() if 2 < half < 4.8)
    return ("From a half-width of 5 l_c on (4.85 l_c included) calibrated sheets are within "
            f"{max(far, default=np.nan):.1%} of the infinite plate, at " +
            ", at ".join(f"{half:g} l_c within {value:.1%}" for half, value in reversed(near))
            + ".")


def changed(base, others, test, column):
    """Other campaigns' means, and in brackets over the base's on the same meshes."""
    rows = []
    others = [o for o in others if test in o.tables]
    for sheet in SHEETS:
        found = [o.ratios(base, test, sheet, column) for o in others]
        if any(len(r) for r in found):
            rows.append([*named(sheet), f"{base.mean(test, sheet, column):.3f}"] +
                        [f"{o.mean(test, sheet, column):.3f} ({np.mean(r):.3f})" if len(r) else "–"
                         for o, r in zip(others, found)])
    return table(["L [m]", "h [m]", "l", "as above", *(o.label for o in others)], rows)


def dynamics(base, others):
    """Runs in time over static ones, mesh by mesh."""
    pulls = [o for o in others if "tension" in o.tables]
    bends = [o for o in others if "bending" in o.tables]
    rows = []
    for sheet in SHEETS:
        cells = []
        for o in pulls:
            whole = o.ratios(base, "tension", sheet, "E_over_Eb")
            springs = o.ratios(base, "tension", sheet, "E_stored_over_Eb", "E_over_Eb")
            cells.append(f"{np.mean(whole):.4f}, {np.mean(springs):.4f} ({len(whole)})"
                         if len(whole) else "–")
        for o in bends:
            ratio = o.ratios(base, "bending", sheet, "deflection_max")
            cells.append(f"{np.mean(ratio):.4f} ({len(ratio)})" if len(ratio) else "–")
        if any(cell != "–" for cell in cells):
            rows.append(named(sheet) + cells)
    return table(["L [m]", "h [m]", "l", *(f"E, springs alone: {o.label}" for o in pulls),
                  *(f"deflection: {o.label}" for o in bends)], rows)


def moduli(c):
    """The further moduli over the infinite lattice's."""
    star = figures.LATTICE
    square = simple_shear(star["nu"])
    rows = []
    for sheet in SHEETS:
        if len(c.rows("shear", sheet)) == 0:
            continue
        columns = [("tension", "E_gauge_over_Eb", star["E"]),
                   ("compression", "E_gauge_over_Eb", star["E"]), ("tension", "poisson", 1),
                   ("shear", "G_over_Eb", star["G"]), ("biaxial", "K_over_Eb", star["K"]),
                   ("slide", "slide_over_Eb", star["G"] * square)]
        rows.append(named(sheet) + [f"{sheet.length / sheet.element_size:.1f}"] +
                    [spread(c.values(test, sheet, column) / scale, 3)
                     for test, column, scale in columns])
    return table(["L [m]", "h [m]", "l", "L/l", "E/E*", "E/E* pressed",
                  f"ν (ν* = {star['nu']:.4f})", "G/G*", "K/K*",
                  f"simple shear/({square:.3f} G*)"], rows)
