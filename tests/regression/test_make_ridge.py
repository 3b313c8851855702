#!/usr/bin/python3
"""floe make_ridge: ridges of the sail and keel that were asked for, loose and frozen, afloat."""
import os
import subprocess
import sys
import unittest

import h5py
import numpy as np

import launch
from launch import FLOE, REPOSITORY, FolderTest

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402
from floe.make import ridge as ridges  # noqa: E402

SMALL = ("--block", "0.5", "0.4", "0.25", "--length", "1.6", "--contact", "1e7")
KEEL = 1.2 if launch.FULL else 1.0
SHEET = """forces: [beam, gravity, buoyancy]
sheet: {length: 6, width: 1.6, thickness: 0.2, element_size: 0.6, iterations: 20}
"""
AFLOAT = """integrator: explicit
forces: [%sgravity, buoyancy, drag, contact]
lattice_file: %s
water: {drag_linear: 300}
contact: {young: 1e7, friction: 1}
obstacle:
  names: [south, north]
  south: {shape: halfspace, point: [0, -0.8, 0], normal: [0, 1, 0], friction: 0}
  north: {shape: halfspace, point: [0, 0.8, 0], normal: [0, -1, 0], friction: 0}
time: {end: 1}
"""


class MakeRidge(FolderTest):
    def make(self, *words, code=0):
        done = subprocess.run([sys.executable, str(REPOSITORY / "tools/make_ridge"),
                               *map(str, words)], cwd=self.folder, capture_output=True, text=True,
                              env={**launch.ENVIRONMENT, "FLOE": os.path.abspath(FLOE)})
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr if code else done.stdout

    def arrays(self, name):
        with h5py.File(self.folder / name) as file:
            found = {}
            file.visititems(lambda path, item: found.update({path: item[()]})
                            if isinstance(item, h5py.Dataset) else None)
            return found

    def run_scene(self, text):
        (self.folder / "scene.yaml").write_text(text)
        done = launch.run("scene.yaml", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_loose_and_frozen(self):
        said = self.make("loose.h5", "--sail", 0.4, "--keel", KEEL, *SMALL)
        self.assertIn("asked: 0.4), keel", said)
        loose = self.arrays("loose.h5")
        ridge = fl.read(self.folder / "loose.h5")
        sets = [set(ridge.sets[name]) for name in ("keel", "sail")]
        self.assertEqual(set.union(*sets), set(range(len(ridge.mass))))
        self.assertFalse(sets[0] & sets[1])
        corners, body = ridges.placed(ridge)
        self.assertAlmostEqual(-corners[:, 2].min() / KEEL, 1, delta=0.35)
        self.assertGreater(corners[:, 2].max(), 0.1)
        # At the water's level it is as wide as its flanks say.
        near = np.abs(ridge.position[:, 2]) < 0.3
        wide = 2 * KEEL / np.tan(np.radians(33))
        self.assertAlmostEqual(np.ptp(ridge.position[near, 0]) / wide, 1, delta=0.35)
        # All ice is between the walls, and there is as much as a keel of rubble takes.
        self.assertLess(np.abs(corners[:, 1]).max(), 0.8 + 0.05)
        section = KEEL**2 / np.tan(np.radians(33)) + 0.4**2 / np.tan(np.radians(26))
        self.assertAlmostEqual(ridge.mass.sum() / 920 / (1.6 * section), 0.55, delta=0.2)
        porosity = float(said.split("porosity of the keel ")[1].split()[0].rstrip(";"))
        self.assertAlmostEqual(porosity, 0.45, delta=0.2)

        # It floats, and stays where it is.
        self.run_scene(AFLOAT % ("", "loose.h5"))
        move = fl.settled(self.folder / "out/scene").position - ridge.position
        self.assertLess(abs(np.average(move[:, 2], weights=ridge.mass)), 0.02)
        self.assertLess(np.abs(move).max(), 0.25)

        said = self.make("frozen.h5", "--sail", 0.4, "--keel", KEEL, *SMALL, "--frozen", 0.5)
        frozen = self.arrays("frozen.h5")
        for key, values in loose.items():  # the same seed
            np.testing.assert_array_equal(frozen[key], values, key)
        beams = frozen["beams/bodies"]
        self.assertIn(f"; {len(beams)} bonds down to 0.5 m", said)
        self.assertGreater(len(beams), 10)
        place = frozen["bodies/position"][beams[:, 0]] + frozen["beams/offsets"][:, :3]
        middle = place + (frozen["bodies/position"][beams[:, 1]] + frozen["beams/offsets"][:, 3:]
                          - place) / 2
        self.assertGreater(middle[:, 2].min(), -0.5 - 0.25)
        self.assertLess(frozen["bodies/position"][:, 2].min(), -0.7)
        self.assertIn("results", self.run_scene(
            AFLOAT.replace("end: 1", "end: 0.1") % ("beam, ", "frozen.h5")
            + "beam: {damping_ratio: 0.2}\n"))

    def test_under_a_sheet(self):
        self.run_scene(SHEET)
        said = self.make("ridge.h5", "--sail", 0.4, "--keel", 0.8, *SMALL, "--frozen", 0.4,
                         "--sheet", "out/scene/lattice.h5")
        self.assertIn("ridge.h5: ", said)
        ridge, sheet = self.arrays("ridge.h5"), self.arrays("out/scene/lattice.h5")
        n = len(sheet["bodies/mass"])
        np.testing.assert_array_equal(ridge["sets/sheet"], np.arange(n))
        np.testing.assert_array_equal(ridge["bodies/position"][:n], sheet["bodies/position"])
        pairs = ridge["beams/bodies"]
        whole = (pairs < n).all(axis=1)
        np.testing.assert_array_equal(pairs[whole], sheet["beams/bodies"])
        self.assertGreater(((pairs < n).any(axis=1) & ~whole).sum(), 0)  # rubble frozen to it
        keel, sail = (ridge["bodies/position"][ridge[f"sets/{name}"], 2]
                      for name in ("keel", "sail"))
        self.assertLess(keel.max(), 0)
        self.assertGreater(sail.min(), 0)

    def test_refusals(self):
        fl.blocks([[4, 4, 0.3]], [[0, 0, 0]]).write(self.folder / "wide.h5")
        for words, part in (
                (["--sail", 1, "--keel", 4], "required: --length"),
                (["--sail", 1, "--keel", 4, "--length", 1], "argument --length: the ridge is 1 m"),
                (["--sail", 1, "--keel", 4, "--length", 9, "--density", 1020],
                 "--density: 1020 must be below --water 1010"),
                (["--sail", 1, "--keel", 4, "--length", 9, "--sheet", "no.h5"],
                 "no.h5: cannot be read"),
                (["--sail", 1, "--keel", 4, "--length", 2, "--sheet", "wide.h5"],
                 "--length: 2: the walls at the ridge's ends would cut the sheet"),
                (["--sail", -1, "--keel", 4, "--length", 9], "-1 is not within 0 to 1000")):
            said = self.make("ridge.h5", *words, code=2)
            self.assertIn(part, said)
            self.assertEqual(said.count("\n"), 1, said)
        self.assertFalse((self.folder / "ridge.h5").exists())


class Pressed(unittest.TestCase):
    """Two blocks of which a corner lies deep in the other, beside a sheet."""
    def setUp(self):
        self.whole = fl.blocks([[1, 1, 0.5]] * 2 + [[4, 4, 0.2]],
                               [[0.5, 0.5, -1], [-0.4, -0.5, -1], [0, 0, 0]])
        self.whole.sets["sheet"] = [2]
        self.tries = []

    def settle(self, why, refusals):
        test = self

        class Settling:
            def settle(self, _what, lattice, *_words):
                test.tries.append(lattice.position.copy())
                if len(test.tries) <= refusals:
                    raise ridges.Failed(why)
                return lattice
        return ridges.float_up(Settling(), self.whole, {})

    def test_blocks_are_moved_apart(self):
        self.settle("body 0 and body 1 overlap by 0.1 m at the start", 2)
        first, _, last = self.tries
        np.testing.assert_allclose(last[:2], 1.01 * 1.02 * first[:2], rtol=1e-14)
        np.testing.assert_array_equal(last[2], first[2])

    def test_other_errors_are_told(self):
        for why, tries in (("overlap at the start", len(ridges.SPREADS)), ("no disk", 1)):
            self.tries.clear()
            with self.assertRaisesRegex(ridges.Failed, why):
                self.settle(why, 99)
            self.assertEqual(len(self.tries), tries)


if __name__ == "__main__":
    unittest.main()
