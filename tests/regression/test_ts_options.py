#!/usr/bin/python3
"""What PETSc's -ts_* options do to explicit runs, by leapfrog and by rk: times, steps, monitors,
types, adaptive steps;
restarts of rk; and which of the options are refused, with the reason.
"""
import csv
import json
import subprocess
import unittest

import launch
from small_scenes import PULL
from test_restart import INTERRUPTED, RestartTest, contents, stop_file

RK4 = ("-ts_type", "rk", "-ts_rk_type", "4")
DP5 = ("-ts_type", "rk", "-ts_rk_type", "5dp")
ADAPTIVE = (*DP5, "-ts_adapt_type", "basic", "-ts_atol", "1e-8", "-ts_rtol", "0")


class TsTest(RestartTest):
    def setUp(self):
        super().setUp()
        (self.folder / "pull.yaml").write_text(PULL)

    def pull(self, *options, code=0, ranks=1):
        """(standard output, standard error) of a pull into out/pull."""
        process = self.begin(*options, dir="out/pull", ranks=ranks, scene="pull.yaml")
        out, err = process.communicate()
        self.assertEqual(process.returncode, code, out + err)
        return out, launch.own_words(err)

    def summary(self):
        return json.loads((self.folder / "out/pull/summary.json").read_text())

    def rows(self):
        with open(self.folder / "out/pull/history.csv") as file:
            return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


class Times(TsTest):
    def test_max_time_ends_the_run(self):
        for kind in ((), RK4):
            self.pull(*kind, "-ts_max_time", "0.004")
            self.assertAlmostEqual(self.summary()["time"], 0.004, 12)
            self.assertAlmostEqual(self.summary()["dt"] * self.summary()["steps"], 0.004, 12)
            rows = self.rows()
            self.assertAlmostEqual(rows[-1]["time"], 0.004, 12)
            self.assertAlmostEqual(rows[-1]["right_displacement_x"], 0.1 * 0.004, 12)

    def test_max_steps_ends_the_run(self):
        for kind in ((), RK4):
            self.pull(*kind, "-ts_max_steps", "7")
            summary = self.summary()
            self.assertEqual(summary["steps"], 7)
            self.assertAlmostEqual(summary["time"], 7 * summary["dt"], 12)
            self.assertLess(summary["time"], 0.01)
            self.assertEqual(summary["status"], "done")
            self.assertAlmostEqual(self.rows()[-1]["time"], summary["time"], 12)

    def test_dt_is_the_step(self):
        for kind in ((), RK4):
            self.pull(*kind, "-ts_dt", "1e-5")
            self.assertAlmostEqual(self.summary()["dt"], 1e-5, 12)
            _, err = self.pull(*kind, "-ts_dt", "1e-2", code=2)
            self.assertIn("ts_dt: 0.01 must be <=", err)
            self.assertIn("the stable step", err)

    def test_monitor_and_view(self):
        for kind, name in (((), "leapfrog"), (RK4, "rk")):
            out, _ = self.pull(*kind, "-ts_max_steps", "5", "-ts_monitor", "-ts_view")
            self.assertIn("5 TS dt ", out)
            self.assertIn(f"type: {name}", out)

    def test_rk_takes_fewer_steps_and_ends_where_leapfrog_does(self):
        self.pull("-beam_damping_ratio", "0.1", "-ts_dt", "1e-6")
        leapfrog, steps = self.rows()[-1], self.summary()["stable_dt"]
        self.pull("-beam_damping_ratio", "0.1", *RK4)
        self.assertGreater(self.summary()["stable_dt"], steps)
        self.assertEqual(self.summary()["stepper"], "rk 4")
        rk = self.rows()[-1]
        for key in ("left_force_x", "right_force_x", "energy_strain"):
            self.assertAlmostEqual(rk[key] / leapfrog[key], 1, delta=2e-3, msg=key)


class Adaptive(TsTest):
    def test_ends_at_the_end_and_samples_on_or_after_their_times(self):
        self.pull(*ADAPTIVE, "-output_history", "0.001")
        self.assertAlmostEqual(self.summary()["time"], 0.01, 12)
        self.assertEqual(self.summary()["stepper"], "rk 5dp, adaptive")
        times = [row["time"] for row in self.rows()]
        self.assertEqual(len(times), 11)
        largest = 0.9 * self.summary()["stable_dt"]
        for n, time in enumerate(times):
            self.assertGreaterEqual(time, 0.001 * n - 1e-12)
            self.assertLessEqual(time, 0.001 * n + largest)

    def test_a_number_that_is_not_finite_stops_it(self):
        _, err = self.pull(*DP5, "-ts_adapt_type", "basic", "-ts_adapt_dt_min", "0.005", "-time_dt",
                           "0.005",
                           "-time_allow_unstable", "-time_end", "5", "-limit_velocity", "1e300",
                           "-limit_energy_error", "1e300", code=1)
        self.assertIn("not finite after time", err)
        self.assertNotIn("internal", err)

    def test_steps_that_are_never_accepted_stop_it(self):
        _, err = self.pull(*DP5, "-ts_adapt_type", "basic", "-ts_atol", "1e-14", "-ts_rtol", "0",
                           "-ts_max_reject",
                           "0", code=1)
        self.assertIn("rejected again and again at time 0 s", err)
        self.assertEqual(self.summary()["status"], "failed")


class Limits(TsTest):
    def test_blowing_up(self):
        for ranks in (1, 2):
            _, err = self.pull(*RK4, "-time_dt", "0.001", "-time_allow_unstable", "-time_end",
                               "0.5", ranks=ranks,
                               code=1)
            self.assertRegex(err, r"at time \S+ s.*limit: (velocity|energy_error)")

    def test_not_finite(self):
        _, err = self.pull(*RK4, "-time_dt", "0.001", "-time_allow_unstable", "-time_end", "0.5",
                           "-limit_velocity",
                           "1e300", "-limit_energy_error", "1e300", "-output_history", "0.5",
                           code=1)
        self.assertRegex(err, r"not finite at time \S+ s, body \d+ at \(")


class Restarts(RestartTest):
    def check(self, *options, ranks=1):
        self.finish(self.interrupted(stop_file, *options, ranks=ranks), INTERRUPTED)
        self.assert_same(*self.straight_and_resumed(*options, ranks=ranks))

    def test_rk_goes_on_bit_for_bit(self):
        self.check(*RK4)

    def test_a_method_that_reuses_its_last_stage_does_so_too(self):
        self.check(*DP5)

    def test_on_two_ranks(self):
        self.check(*DP5, ranks=2)

    def test_with_adaptive_steps(self):
        self.check(*ADAPTIVE)

    def test_bodies_are_the_same_on_any_number_of_ranks(self):
        one, two = (self.run_whole(*RK4, "-time_dt", "5e-4", "-time_end", "1", dir=f"r{n}", ranks=n)
                    for n in (1, 2))
        first, second = contents(one / "checkpoint.h5"), contents(two / "checkpoint.h5")
        self.assertTrue((first["bodies/records"] == second["bodies/records"]).all())

    def test_another_type_is_refused(self):
        self.run_whole("-time_end", "1", dir="b")
        said = self.finish(self.begin(*RK4, "-checkpoint_restart", "b/checkpoint.h5", dir="b"), 2)
        self.assertIn("is of ts_type 'leapfrog'", said)
        self.run_whole(*RK4, "-time_end", "1", dir="c")
        said = self.finish(self.begin("-checkpoint_restart", "c/checkpoint.h5", "-ts_type",
                                      "leapfrog", dir="c"), 2)
        self.assertIn("is of ts_type 'rk'", said)
        said = self.finish(self.begin("-checkpoint_restart", "c/checkpoint.h5", "-ts_rk_type",
                                      "5dp", dir="c"), 2)
        self.assertIn("is of steps by 'rk 4', this run's are by 'rk 5dp'", said)


# A block under water, pushed faster and faster: the step shrinks with the speed.
PUSHED = """integrator: explicit
forces: [drag]
lattice_file: block.h5
water: {drag_coefficient: 1.2}
initial: {names: [i], i: {set: all, velocity: [5, 0, 0]}}
load: {names: [p], p: {set: all, force: [2e6, 0, 0], ramp: 4000}}
time: {end: 4200}
limit: {energy_error: 10}
output: {history: 2}
checkpoint: {every: 1000}
"""


class ChangingSteps(RestartTest):
    def test_go_on_bit_for_bit(self):
        subprocess.run([launch.REPOSITORY / "tools/make_lattice", "block", "--size", "2", "2",
                        "0.5", "--height", "-5",
                        "block.h5"], cwd=self.folder, check=True, capture_output=True)
        for kind in ((), RK4):
            summary = self.check_parts(PUSHED, [0.05, 0.3, 0.301, 0.9], *kind)
            self.assertLess(summary["dt"], summary["stable_dt"])
            self.assertGreater(summary["steps"], 5000)  # about 1000 at the first step


class Refused(TsTest):
    def test_with_the_reason(self):
        basic = ("-ts_adapt_type", "basic")
        for options, words in (
                (("-ts_type", "rk", "-ts_rk_type", "2a"),
                 ("2a", "imaginary axis", "damp the beams", "body")),
                (("-ts_type", "rk", "-ts_rk_type", "5f"), ("5f", "imaginary axis")),
                (("-ts_type", "rk", "-ts_rk_type", "1fe", "-beam_damping_ratio", "1"),
                 ("1fe", "Euler")),
                (("-ts_type", "rk", "-ts_rk_type", "44"), ("ts_rk_type", "44")),
                ((*RK4, *basic), ("basic", "estimates its error", "5dp")),
                ((*DP5, "-ts_adapt_type", "dsp"), ("dsp", "must be none", "basic")),
                (basic, ("ts_adapt_type", "leapfrog is fixed")),
                (("-ts_rtol", "1e-3"), ("ts_rtol", "fixed")),
                ((*DP5, "-ts_atol", "1e-3"), ("ts_atol", "fixed")),
                ((*DP5, "-ts_adapt_dt_max", "1e-3"), ("ts_adapt_dt_max", "fixed")),
                ((*DP5, "-ts_exact_final_time", "interpolate"), ("ts_exact_final_time", "end")),
                ((*DP5, "-ts_rk_multirate", "1"), ("ts_rk_multirate", "same step")),
                (("-ts_init_time", "1"), ("ts_init_time", "checkpoint")),
                (("-ts_time_span", "0,1"), ("ts_time_span", "history")),
                (("-ts_rk_type", "4"), ("ts_rk_type",))):
            with self.subTest(options):
                _, err = self.pull(*options, code=2)
            self.assertEqual(err.count("\n"), 1, err)
            for word in words:
                self.assertIn(word, err)
            self.assertFalse((self.folder / "out").exists())

    def test_2a_steps_what_is_damped_enough(self):
        self.pull("-ts_type", "rk", "-ts_rk_type", "2a", "-beam_damping_ratio", "1")
        self.assertEqual(self.summary()["status"], "done")


if __name__ == "__main__":
    unittest.main()
