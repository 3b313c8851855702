#!/usr/bin/python3
"""Explicit runs that must not go on: a step above the stable one, a run that blows up, options of
solvers.

Each runs in a temporary folder of its own, as a user would run it, at 1 and at 2 ranks.
"""
import re
import unittest

from one_run import OneRun
from small_scenes import PULL

# What holds an edge takes far more than its bodies could; in space, and in the plane.
HELD = """integrator: explicit
forces: [beam]
sheet: {length: 8, width: 5, thickness: 0.5, element_size: 1, iterations: 5}
boundary: {names: [held], held: {set: left, fix: "x y rz"}}
load: {names: [dead], dead: {set: left, force: [1e8, 0, 0]}}
time: {end: 0.02}
limit: {velocity: 5}
"""


class ExplicitLimits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        run = OneRun(PULL)
        assert run.code == 0, run.error
        cls.stable = run.summary["stable_dt"]
        cls.good = run.summary

    def test_auto_is_the_stable_step_times_safety(self):
        self.assertLessEqual(self.good["dt"], 0.9 * self.stable)
        self.assertGreater(self.good["dt"], 0.85 * self.stable)
        self.assertAlmostEqual(self.good["dt"] * self.good["steps"], 0.01, delta=1e-12)

    def test_a_step_above_the_stable_one_is_refused(self):
        for ranks in (1, 2):
            run = OneRun(PULL, "-time_dt", repr(1.01 * self.stable), ranks=ranks)
            self.assertEqual(run.code, 2, run.error)
            self.assertFalse(run.has_folder)
            lines = run.error.strip().splitlines()
            self.assertEqual(len(lines), 1, run.error)
            for word in ("time: dt", "stable step", "body", "allow_unstable"):
                self.assertIn(word, lines[0])
            number = float(re.search(r"must be <= (\S+)", lines[0])[1])
            self.assertAlmostEqual(number / self.stable, 1, delta=1e-4)

    def test_held_bodies_are_as_fast_as_they_move(self):
        for scene in (HELD, HELD.replace('"x y rz"', '"x y z rx ry rz"').replace("[1e8, 0, 0]",
                                                                         "[0, 0, 1e8]")):
            run = OneRun(scene)
            self.assertEqual(run.code, 0, run.error)

    def test_a_step_just_below_it_is_taken(self):
        run = OneRun(PULL, "-time_dt", repr(0.99 * self.stable), "-beam_damping_ratio", "0")
        self.assertEqual(run.code, 0, run.error)

    def test_a_run_that_blows_up_stops_and_says_where(self):
        for ranks in (1, 2):
            run = OneRun(PULL, "-time_dt", repr(1.05 * self.stable), "-time_allow_unstable",
                         "-time_end", "0.5", ranks=ranks)
            self.assertEqual(run.code, 1, run.error)
            last = [line for line in run.error.splitlines() if line.startswith("floe: ")][-1]
            self.assertRegex(last, r"at time \S+ s")
            self.assertRegex(last, r"limit: (velocity|energy_error)")
            if "limit: velocity" in last:
                self.assertRegex(last, r"body \d+ at \(")
            self.assertNotEqual(run.summary["status"], "done")
            self.assertIn(run.summary["message"], last)
            self.assertLess(run.summary["steps"] * run.summary["dt"], 0.5)

    def test_a_number_that_is_not_finite_stops_it(self):
        # Too wide a limit to stop a velocity before it is infinite.
        run = OneRun(PULL, "-time_dt", repr(3 * self.stable), "-time_allow_unstable",
                     "-time_end", "0.5", "-limit_velocity", "1e300", "-limit_energy_error", "1e300",
                     "-output_history", "0.5")
        self.assertEqual(run.code, 1, run.error)
        self.assertRegex(run.error, r"not finite at time \S+ s, body \d+ at \(")

    def test_a_limit_of_the_user_stops_it(self):
        run = OneRun(PULL, "-limit_velocity", "0.05")
        self.assertEqual(run.code, 1, run.error)
        self.assertIn("limit: velocity 0.05 m/s", run.error)

    def test_options_of_solvers_are_refused(self):
        for option, value in (("-snes_rtol", "0.1"), ("-ksp_type", "cg"), ("-pc_type", "lu"),
                              ("-mat_type", "aij")):
            run = OneRun(PULL, option, value)
            self.assertEqual(run.code, 2, option + run.error)
            self.assertIn(option[1:], run.error)
            self.assertIn("explicit", run.error)
            self.assertFalse(run.has_folder)

    def test_types_of_petsc_that_cannot_step_this_are_refused(self):
        for kind, reason in (("basicsymplectic", "angular momentum"), ("beuler", "implicit"),
                             ("alpha2", "implicit"), ("euler", "unstable"),
                             ("nonsense", "leapfrog")):
            run = OneRun(PULL, "-ts_type", kind)
            self.assertEqual(run.code, 2, kind + run.error)
            self.assertIn(kind, run.error)
            self.assertIn(reason, run.error)
            self.assertFalse(run.has_folder)


if __name__ == "__main__":
    unittest.main()
