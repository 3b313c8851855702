#!/usr/bin/python3
"""What `fracture: flexural_strength`, `compressive_strength` and `calibrate` do to a run."""
import json
import unittest

import h5py

import launch

BENT = """integrator: quasistatic
forces: [beam, fracture]
sheet: {length: 8, width: 6, thickness: 0.5, element_size: 1, iterations: 10}
beam: {kinematics: linear}
boundary:
  names: [left, right]
  left: {set: left, fix: ry, angular_velocity: [0, -3.5e-3, 0], ramp: 1}
  right: {set: right, fix: ry, angular_velocity: [0, 3.5e-3, 0], ramp: 1}
time: {end: 1, dt: 0.1}
"""
PRESSED = """integrator: explicit
forces: [beam, fracture, contact]
sheet: {length: 6, width: 4, thickness: 0.5, element_size: 1, iterations: 10}
beam: {damping_ratio: 0.2}
fracture: {tensile_strength: 4e6, shear_strength: 1.2e6}
contact: {young: 1e9}
boundary:
  names: [left, right]
  left: {set: left, fix: "x y z rx ry rz", velocity: [0.1, 0, 0], ramp: 0.01}
  right: {set: right, fix: "x y z rx ry rz"}
time: {end: 0.06}
"""


class StrengthKeys(launch.FolderTest):
    def summary(self, scene, *options, ranks=1, code=0):
        (self.folder / "scene.yaml").write_text(scene)
        done = launch.run("scene.yaml", *options, "-output_overwrite", ranks=ranks,
                          cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads((self.folder / "out/scene/summary.json").read_text())

    def test_flexural_strength(self):
        """Bent to a nominal stress of about 3.7e5 Pa: the beams' own 6e5 Pa hold, and so does a
        flexural strength of 9e5, but not one of 2.5e5."""
        self.assertEqual(self.summary(BENT)["beams_broken"], 0)
        strong = self.summary(BENT, "-fracture_flexural_strength", "9e5")
        self.assertEqual(strong["beams_broken"], 0)
        (self.folder / "scene.yaml").write_text(BENT)
        done = launch.run("scene.yaml", "-output_overwrite", "-fracture_flexural_strength", "2.5e5",
                          cwd=self.folder)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        weak = json.loads((self.folder / "out/scene/summary.json").read_text())
        self.assertGreater(weak["beams_broken"], 0)
        found = {name: s["strength_calibration"] for name, s in (("9", strong), ("2", weak))}
        for one in found.values():
            self.assertEqual(one["factor"], 1)
            self.assertNotIn("along_x", one)
        ratio = found["2"]["bending_factor"] / found["9"]["bending_factor"]
        self.assertAlmostEqual(ratio, 9 / 2.5, places=4)

    def test_calibrate_takes_both(self):
        """calibrate: strength alone gives bending the strength in tension, and ranks agree."""
        one = self.summary(BENT, "-fracture_calibrate", "strength")
        found = one["strength_calibration"]
        self.assertGreater(found["factor"], 1.1)
        self.assertGreater(found["bending_factor"], 1.1)
        same = self.summary(BENT, "-fracture_calibrate", "strength", "-fracture_flexural_strength",
                            "6e5", ranks=2)["strength_calibration"]
        for name in ("factor", "bending_factor"):
            self.assertEqual(found[name], same[name])

    def test_compressive_strength(self):
        """Beams that are pressed beyond it are gone, and their bodies touch."""
        whole = self.summary(PRESSED)
        self.assertNotIn("beams_crushed", whole)
        crushed = self.summary(PRESSED, "-fracture_compressive_strength", "2.5e6")
        self.assertGreater(crushed["beams_crushed"], 2)
        self.assertLessEqual(crushed["beams_crushed"], crushed["beams_broken"])
        self.assertGreater(crushed["beams_broken"], whole["beams_broken"])
        self.assertGreater(crushed["contacts"], 0)
        energy = crushed["energy"]
        self.assertLess(abs(energy["balance_error"]), 1e-2 * energy["fracture"])

    def test_ranks_crush_alike(self):
        """The same beams break at the same times on two ranks."""
        breaks = []
        for ranks in (1, 2):
            self.summary(PRESSED, "-fracture_compressive_strength", "2.5e6", "-time_dt", "1e-4",
                         ranks=ranks)
            with h5py.File(self.folder / "out/scene/breaks.h5") as file:
                breaks.append((list(file["beam"][:]), list(file["time"][:])))
        self.assertGreater(len(breaks[0][0]), 2)
        self.assertEqual(*breaks)


if __name__ == "__main__":
    unittest.main()
