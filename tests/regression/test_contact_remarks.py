#!/usr/bin/python3
"""Contacts that cannot be right are said: overlaps at the start, speeds that jump over bodies,
bodies pressed through others. Each run as a user would run it, at 1 and at 2 ranks."""
import sys
import unittest

from launch import REPOSITORY
from one_run import OneRun

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402

SHEET = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, contact]
sheet: {length: 20, width: 20, thickness: 0.5, element_size: 2, iterations: 5}
fracture: {tensile_strength: 6e5, energy: 15}
contact: {young: 1e8, restitution: 0.5}
time: {end: 0.02}
"""
LEG = ("obstacle: {{names: [leg], leg: {{shape: cylinder, base: [{x}, 0, -3], radius: 2, "
       "height: 6}}}}\n")
CUBE = """integrator: explicit
forces: [contact]
lattice_file: cube.h5
contact: {young: 1e7}
"""
PLATE = ("obstacle: {names: [plate], "
         "plate: {shape: box, centre: [0, 0, -1.03], size: [4, 4, 0.05]}}\n")


def cubes(folder):
    """Two cubes for scenes that ask for them."""
    fl.blocks([[1, 1, 1], [1, 1, 1]], [[0, 0, 0], [100, 0, 50]]).write(folder / "cube.h5")


class Run(OneRun):
    def __init__(self, scene, *words, ranks=1):
        super().__init__(scene, *words, ranks=ranks, prepare=cubes if "cube.h5" in scene
                         else lambda folder: None)

    def warnings(self):
        return [line for line in self.error.splitlines()
                if line.startswith("floe: warning: contact")]


class Overlap(unittest.TestCase):
    def test_an_obstacle_deep_in_a_sheet_is_refused(self):
        for ranks in (1, 2):
            run = Run(SHEET + LEG.format(x=11.5), ranks=ranks)
            self.assertEqual(run.code, 2, run.error)
            self.assertIsNone(run.summary)
            for word in ("obstacle 'leg'", "overlap by 0.", "at most 0.1",
                         "initial_overlap: stress_free"):
                self.assertIn(word, run.error)

    def test_taken_as_rest_it_breaks_nothing(self):
        for ranks in (1, 2):
            run = Run(SHEET + LEG.format(x=11.5), "-contact_initial_overlap", "stress_free",
                      ranks=ranks)
            self.assertEqual(run.code, 0, run.error)
            self.assertEqual(run.summary["beams_broken"], 0)
            self.assertLess(run.summary["energy"]["contact"], 1)
            self.assertLess(run.summary["energy"]["kinetic"], 1)
            self.assertEqual(len(run.warnings()), 1, run.error)
            self.assertIn("count as rest", run.warnings()[0])

    def test_a_slight_one_is_said_and_goes_on(self):
        scene = SHEET + LEG.format(x=11.95)
        for ranks in (1, 2):
            run = Run(scene, ranks=ranks)
            self.assertEqual(run.code, 0, run.error)
            self.assertEqual(len(run.warnings()), 1, run.error)
            self.assertIn("overlap by 0.0", run.warnings()[0])
            self.assertEqual(run.warnings()[0], "floe: warning: " + run.summary["warnings"][0])
        check = Run(scene, "-check")
        self.assertEqual(len(check.warnings()), 1, check.error)

    def test_none_is_not_said(self):
        run = Run(SHEET + LEG.format(x=12.5))
        self.assertEqual(run.code, 0, run.error)
        self.assertEqual(run.warnings(), [])
        self.assertNotIn("warnings", run.summary)


class Passing(unittest.TestCase):
    def test_a_fast_obstacle_is_refused(self):
        scene = SHEET + LEG.format(x=1e5).replace("radius", "velocity: [-1e6, 0, 0], radius")
        for ranks in (1, 2):
            run = Run(scene, ranks=ranks)
            self.assertEqual(run.code, 2, run.error)
            for word in ("obstacle: leg", "1e+06 m/s", "limit: velocity"):
                self.assertIn(word, run.error)

    def test_the_step_looks_at_obstacles_speeds(self):
        scene = SHEET + LEG.format(x=30).replace("radius", "velocity: [-900, 0, 0], radius")
        for ranks in (1, 2):
            run = Run(scene, "-time_end", "1e-3", ranks=ranks)
            self.assertEqual(run.code, 0, run.error)
            self.assertIn("speed of obstacle 'leg'", run.summary["dt_limited_by"])
            self.assertAlmostEqual(run.summary["stable_dt"] * 900 / (0.1 * 0.5), 1, delta=1e-6)
        run = Run(scene, "-time_dt", "1e-4", "-time_end", "1e-3")
        self.assertEqual(run.code, 2, run.error)
        self.assertIn("speed of obstacle 'leg'", run.error)

    def test_a_cube_that_a_plate_cannot_hold(self):
        scene = (CUBE + PLATE + "time: {end: 0.1}\n"
                 "initial: {names: [i], i: {set: all, velocity: [0, 0, -50]}}\n")
        for ranks in (1, 2):
            run = Run(scene, ranks=ranks)
            self.assertEqual(run.code, 0, run.error)
            self.assertEqual(len(run.warnings()), 2, run.error)
            self.assertIn("reaches through", run.warnings()[1])
            for word in ("body 0 is pressed into obstacle 'plate'", "may pass through"):
                self.assertIn(word, run.warnings()[0])

    def test_a_floor_that_rises_through_a_soft_cube(self):
        floor = ("obstacle: {names: [floor], "
                 "floor: {shape: halfspace, point: [0, 0, -0.6], velocity: [0, 0, 5]}}\n")
        held = "boundary: {names: [b], b: {set: all, fix: x y z rx ry rz}}\n"
        run = Run(CUBE + "time: {end: 0.5}\n" + floor + held)
        self.assertEqual(run.code, 0, run.error)
        self.assertEqual(len(run.warnings()), 2, run.error)
        self.assertIn("is pressed into obstacle 'floor'", run.warnings()[0])
        self.assertIn("one lies inside the other", run.warnings()[1])


if __name__ == "__main__":
    unittest.main()
