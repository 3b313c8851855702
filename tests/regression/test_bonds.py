#!/usr/bin/python3
"""Bonds: beams between faces that are frozen together, against lattices with these beams written
out, closed forms, sheets without the crack that froze; ranks, restarts, refusals."""
import sys
import unittest
from pathlib import Path

import numpy as np

from scene_runs import SceneTest, last_frame

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
from floe import lattice as fl  # noqa: E402

SECTION = fl.Section(1.0, 0.5, young=1e9)
# A row of five blocks along x, held at one end and loaded at the other.
ROW = """forces: [beam]
lattice_file: row.h5
boundary: {names: [root], root: {set: left, fix: x y z rx ry rz}}
load: {names: [tip], tip: {set: right, force: [3e4, 2e3, 1e3]}}
"""
BONDS = "bonds: {gap: 1e-6, young: 1e9}\n"
# Two blocks that are pulled apart, along the joint's normal.
APART = """integrator: quasistatic
forces: [beam, fracture]
lattice_file: row.h5
fracture: {tensile_strength: 4e5, energy: 400}
boundary:
  names: [left, right]
  left: {set: left, fix: x y z rx ry rz}
  right: {set: right, fix: x y z rx ry rz, displacement: [8e-3, 0, 0], ramp: 1}
time: {end: 1, dt: 0.0025}
"""
# A heap that falls on water: bonds break, blocks meet.
HEAP = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
lattice_file: heap.h5
bonds: {gap: 0.02, young: 1e8, strength: 0.02, energy: 0.05}
fracture: {tensile_strength: 4e5, energy: 15}
beam: {damping_ratio: 0.1}
water: {drag_coefficient: 1}
contact: {young: 1e7, friction: 0.3, restitution: 0.2}
time: {end: 1.5}
checkpoint: {every: 1000}
"""
SHEET = """forces: [beam]
sheet: {length: 12, width: 8, element_size: 1, thickness: 0.5, iterations: 60, fit_cuts: false}
boundary:
  names: [left, right]
  left: {set: left, fix: x y z rx ry rz}
  right: {set: right, fix: x, displacement: [1e-3, 0, 0]}
"""
CUT = "cut: {names: [lead], lead: {from: [0.3, -5], to: [-0.4, 5]}}\n"


def heap():
    """Blocks piled above the water like bricks, each above two others."""
    size = np.array([1.0, 0.8, 0.4])
    places = [[1.005 * (k + 0.5 * (row % 2)), 0, 1.0 + 0.405 * row]
              for row in range(4) for k in range(5)]
    return fl.blocks(np.tile(size, (len(places), 1)), places)


class Bonds(SceneTest):
    def row(self, elements=5, shift=None):
        """Blocks in a row along x; `shift` moves every second one across."""
        row = fl.strip(float(elements), elements, SECTION)
        if shift is not None:
            row.position[1::2] += shift
        return row

    def loose(self, row):
        return fl.Lattice(row.position, row.orientation, row.mass, row.inertia, sets=row.sets,
                          shapes=row.shapes)

    def same(self, written, bonded):
        a, b = (last_frame(self.folder / "out" / name) for name in (written, bonded))
        for key in ("bodies_displacement", "bodies_rotation"):
            np.testing.assert_allclose(b[key], a[key], rtol=1e-9,
                                       atol=1e-9 * np.abs(a[key]).max())

    def test_a_row_of_blocks_is_the_strip_of_these_beams(self):
        row = self.row()
        row.write(self.folder / "row.h5")
        self.run_scene(ROW, name="strip")
        self.loose(row).write(self.folder / "row.h5")
        said = self.run_scene(ROW + BONDS, name="bonded").stdout
        self.assertIn("bonds: 4 between faces, 2 m^2; gaps from ", said)
        bonds = self.summary("bonded")["bonds"]
        self.assertEqual(bonds["number"], 4)
        self.assertAlmostEqual(bonds["area"], 4 * 0.5, delta=1e-9)
        self.same("strip", "bonded")
        # Stretched, the tip moves by F L/(E A).
        frame = last_frame(self.folder / "out/bonded")
        self.assertAlmostEqual(frame["bodies_displacement"][-1, 0], 3e4 * 4 / (1e9 * 0.5),
                               delta=2e-6)

    def test_shifted_blocks_have_eccentric_beams(self):
        """Beams through the middles of the common faces, with the common faces as sections."""
        shift = np.array([0.0, 0.4, 0.1])
        row = self.row(shift=shift)
        section = fl.Section(0.6, 0.4, young=1e9)
        first = np.arange(4)
        row.beam = section.scalars(first)
        row.beam["length"] = np.ones(4)
        half = np.where(first[:, None] % 2 == 0, shift, -shift) / 2
        row.offsets = np.hstack([half, -half])
        row.write(self.folder / "row.h5")
        self.run_scene(ROW, name="strip")
        row.bodies = row.bodies[:0]
        self.loose(row).write(self.folder / "row.h5")
        self.run_scene(ROW + BONDS, name="bonded")
        self.same("strip", "bonded")

    def test_strength_and_energy_of_a_bond(self):
        """The largest force is strength x area, what it takes energy x area."""
        self.loose(self.row(2)).write(self.folder / "row.h5")
        for strength, energy in ((1, 1), (0.3, 1), (0.3, 0.5)):
            self.run_scene(APART + f"bonds: {{gap: 0.001, young: 1e9, strength: {strength}, "
                           f"energy: {energy}}}\noutput: {{history: 0.0025}}\n")
            rows = self.rows()
            force = np.abs(rows["right_force_x"]).max()
            step = 8e-3 * 0.0025 * 1e9 * 0.5
            self.assertAlmostEqual(force, strength * 4e5 * 0.5, delta=step)
            self.assertEqual(rows["beams_broken"][-1], 1)
            self.assertAlmostEqual(rows["energy_fracture"][-1] / (energy * 400 * 0.5), 1,
                                   delta=0.02)

    def test_gap_and_box(self):
        row = self.row()
        row.position[3:] += [0.02, 0, 0]  # a gap between the third block and the fourth
        self.loose(row).write(self.folder / "row.h5")
        free = ROW.replace("tip: {set: right", "tip: {set: left")
        for words, number in ((["-bonds_gap", "0.03"], 4), (["-bonds_gap", "0.01"], 3),
                              (["-bonds_gap", "0.03", "-bonds_box", "-2.5,9,-9,9,-9,9"], 2)):
            self.run_scene(free + BONDS, *words, "-check")
            said = self.run_scene(free + BONDS, *words, "-check").stdout
            self.assertIn(f"bonds: {number} between faces", said)

    def test_a_lead_that_froze_is_as_stiff_as_the_sheet(self):
        self.run_scene(SHEET.replace(", fit_cuts: false", ""), name="whole")
        self.run_scene(SHEET + CUT + "bonds: {gap: 1e-6}\n", name="frozen")
        self.run_scene(SHEET + CUT + "bonds: {gap: 1e-6, young: 1e6}\n", name="soft")
        pull = {}
        for name in ("whole", "frozen", "soft"):
            pull[name] = np.atleast_1d(self.rows(name)["right_force_x"])[-1]
        self.assertAlmostEqual(pull["frozen"] / pull["whole"], 1, delta=0.01)
        self.assertLess(pull["soft"], 0.1 * pull["whole"])
        wide = self.run_scene(SHEET + CUT + "bonds: {gap: 0.1}\n", name="wide")
        same = self.summary("frozen")["bonds"]
        # Cells that almost meet have a third between them; at the cut one pair may not.
        self.assertLessEqual(self.summary("wide")["bonds"]["number"], same["number"] + 2,
                             wide.stdout)
        self.assertAlmostEqual(same["area"] / (0.5 * 8), 1.15, delta=0.15)  # along cells

    def test_a_heap_on_ranks_and_after_restarts(self):
        heap().write(self.folder / "heap.h5")
        self.same_on_ranks_and_after_a_restart(HEAP)
        broken = self.rows("one")["beams_broken"][-1]
        self.assertGreater(broken, 3)
        self.assertLess(broken, self.summary("one")["bonds"]["number"])

    def test_refusals(self):
        self.loose(self.row()).write(self.folder / "row.h5")
        for scene, part in (
                (ROW + "bonds: {gap: 0.1}\n", "bonds: young: no value given, must be"),
                (ROW + "bonds: {young: 1e9}\n", "bonds: gap: is missing; it must be"),
                (ROW.replace("[beam]", "[gravity]") + BONDS,
                 "bonds: gap: would have no effect: 'forces' does not name beam, which bonds are"),
                (ROW + "bonds: {gap: 0.1, young: 1e9, strength: 0.5}\n",
                 "bonds: strength: would have no effect: 'forces' does not name fracture"),
                (ROW + "bonds: {gap: 0.1, young: 1e9, box: [0, 1, 0, 1, 2, 1]}\n",
                 "bonds: box: must be x0, x1, y0, y1, z0, z1 with x0 <= x1"),
                (ROW + "bonds: {gap: 0.1, young: 1e9, box: [50, 51, 0, 1, 0, 1]}\n",
                 "bonds: gap: 0.1: no two bodies without a beam between them have faces this near "
                 "in bonds: box")):
            done = self.run_scene(scene, code=2)
            self.assertIn(part, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        row = self.loose(self.row())
        row.shapes = None
        row.write(self.folder / "row.h5")
        done = self.run_scene(ROW + BONDS, code=2)
        self.assertIn("bonds: gap: 'row.h5' has no /shapes, and bonds are between faces",
                      done.stderr)


if __name__ == "__main__":
    unittest.main()
