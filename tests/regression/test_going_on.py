#!/usr/bin/python3
"""How runs go on: with which options, by the command that they print, by job scripts that say the
same each time."""
import json
import re
import shlex
import subprocess
import unittest

from interposed import library
from launch import ENVIRONMENT, FLOE, own_words
from running import AFLOAT, DONE, STOPPED, RunningTest
from test_restart import RestartTest, SCENE

CHANGING = SCENE.replace("time: {end: 10}", "time: {end: 1, safety: 0.8}") + """initial:
  names: [i]
  i: {set: all, velocity: [0, 0, 0.01]}
"""


class GoingOnTest(RestartTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(CHANGING)

    def go(self, *words, code=DONE, ranks=1, environment={}):
        """floe with these words and no others."""
        command = [*(["mpiexec", "-n", str(ranks)] if ranks > 1 else []), FLOE, *words]
        done = subprocess.run(list(map(str, command)), cwd=self.folder, capture_output=True,
                              text=True,
                              env={**ENVIRONMENT, **environment})
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.said = own_words(done.stderr)
        return done.stdout

    def files(self):
        return {p: p.read_bytes() for p in self.folder.rglob("*") if p.is_file()}

    def assert_same_run(self, straight, folder):
        """As assert_same, whatever the folder is called."""
        options = folder / "options.yaml"
        text = re.sub("^  dir: .*$", f"  dir: {folder.name}", options.read_text(), flags=re.M)
        options.write_text(text)
        self.assert_same(straight, folder)

    def status(self, dir):
        return json.loads((self.folder / dir / "summary.json").read_text())["status"]

    def stopped(self, *words, row=3, **how):
        """A run that is asked to stop when it writes a row."""
        self.go(*words, code=STOPPED, environment={**library(self.folder),
                                                   "TEST_TERM_AT_ROW": str(row)}, **how)
        return self.said


class Options(GoingOnTest):
    def test_are_the_checkpoints_where_they_are_not_given_anew(self):
        """Without a scene, in a folder that has been renamed; also what the first command line
        said."""
        changed = ("-beam_damping_ratio", "0.3", "-load_p_force", "0,0,-2e5", "-output_history",
                   "0.03", "-ts_type", "rk")
        a = self.run_whole(*changed, dir="a")
        self.stopped("scene.yaml", *changed, "-output_dir", "b")
        (self.folder / "b").rename(self.folder / "b c")
        (self.folder / "scene.yaml").unlink()
        self.go("-checkpoint_restart", "b c/checkpoint.h5")
        self.assertIn('  dir: "b c"\n', (self.folder / "b c/options.yaml").read_text())
        self.assert_same_run(a, self.folder / "b c")

    def test_scene_and_command_line_win(self):
        self.run_whole("-output_history", "0.05", dir="b")
        self.go("scene.yaml", "-checkpoint_restart", "b/checkpoint.h5", "-time_end", "1.2",
                "-output_dir", "b")
        text = (self.folder / "b/options.yaml").read_text()
        self.assertIn("end: 1.2", text)
        self.assertIn("history: 0.041", text)  # the scene's

    def test_what_may_change(self):
        self.run_whole(dir="b")
        for words in (("-time_end", "1.1"), ("-time_end", "1.2", "-output_history", "0.01",
                                             "-output_fields", "0.1"),
                      ("-time_end", "1.3", "-load_p_force", "0,0,-3e5", "-load_p_ramp", "0",
                       "-load_p_moment", "0,0,0"),
                      ("-time_end", "1.4", "-limit_velocity", "10", "-limit_energy_error", "0.05",
                       "-checkpoint_every", "5"),
                      ("-time_end", "1.5", "-ts_monitor", "-log_view", ":log.txt",
                       "-time_allow_unstable")):
            self.go("scene.yaml", "-checkpoint_restart", "b/checkpoint.h5", *words)
            self.assertEqual(self.status("b"), "done")

    def test_what_may_not_change(self):
        self.run_whole(dir="b")
        before = self.files()
        for option, value, label, was in (
                ("sheet_length", "22", "sheet: length", "20"),
            ("sheet_seed", "2", "sheet: seed", "1"),
                ("ice_young", "5e9", "ice: young", "4e9"),
            ("beam_damping_ratio", "0.3", "beam: damping_ratio", "0.2"),
                ("beam_kinematics", "linear", "beam: kinematics", "corotational"),
            ("forces", "beam,gravity", "forces", "'beam, "),
                ("integrator", "implicit", "integrator", "explicit"),
            ("water_drag_linear", "2e4", "water: drag_linear", "1e4"),
                ("boundary_right_velocity", "0.02,0,0", "boundary: right: velocity",
                 "'0.01, 0, 0'"),
                ("boundary_left_set", "all", "boundary: left: set", "left"),
            ("load_p_point", "2,1", "load: p: point", "'1, 1'"),
                ("initial_i_velocity", "0,0,0.02", "initial: i: velocity", "'0, 0, 0.01'"),
                ("time_dt", "1e-4", "time: dt", "auto"),
            ("time_safety", "0.7", "time: safety", "0.8"),
                ("gravity", "9.8", "gravity", "9.81"), ("ts_dt", "1e-4", "ts_dt", "none"),
                ("boundary_names", "left", "boundary: names", "'left, right'"),
                ("region_names", "r", "region: names", "none")):
            with self.subTest(option):
                more = ("-region_r_box", "0,1,0,1,0,1") if value == "r" else ()
                self.go("scene.yaml", "-checkpoint_restart", "b/checkpoint.h5", f"-{option}", value,
                        *more, code=2)
                self.assertEqual(self.said.count("\n"), 1, self.said)
                value = f"'{value.replace(',', ', ')}'" if "," in value else value
                if not more:
                    self.assertIn(f"floe: {label}: {value} cannot be changed where a run goes on; "
                                  f"the checkpoint has {was}",
                                  self.said)
                self.assertIn("cannot be changed where a run goes on", self.said)
        (self.folder / "scene.yaml").write_text(CHANGING.replace("damping_ratio: 0.2",
                                                                 "damping_ratio: 0.25"))
        before[self.folder / "scene.yaml"] = (self.folder / "scene.yaml").read_bytes()
        self.go("scene.yaml", "-checkpoint_restart", "b/checkpoint.h5", code=2)
        self.assertIn("beam: damping_ratio: 0.25 cannot be changed where a run goes on; "
                      "the checkpoint has 0.2 "
                      "(scene.yaml, line 5)", self.said)
        self.assertEqual(before, self.files())

    def test_the_same_said_in_another_way(self):
        self.run_whole(dir="b")
        self.go("scene.yaml", "-checkpoint_restart", "b/checkpoint.h5", "-time_end", "1.1",
                "-ice_young", "4000e6", "-forces",
                "drag beam,gravity,buoyancy", "-load_p_point", "1.0 1")
        self.assertEqual(self.status("b"), "done")

    def test_needs_a_checkpoint(self):
        for words in ((), ("-time_end", "1")):
            self.go(*words, code=2)
        self.go("-checkpoint_restart", code=2)
        self.assertIn("checkpoint: restart: no value given", self.said)
        self.go("-checkpoint_restart", "auto", code=2)
        self.assertIn("auto needs a scene", self.said)


class Line(GoingOnTest):
    def check_line(self, ranks, *words, dir):
        """What a stopped run prints, given to a shell, makes the run that was not stopped."""
        options = ("-beam_damping_ratio", "0.3", "-load_p_force", "0,0,-2e5", *words)
        straight = self.run_whole(*options, dir="straight", ranks=ranks)
        said = self.stopped("scene.yaml", *options, "-output_dir", dir, "-output_overwrite",
                            ranks=ranks)
        line = said[said.index("go on with: ") + len("go on with: "):]
        self.assertEqual(line.count("\n"), 1)
        self.assertEqual(line.startswith("mpiexec -n 2 "), ranks == 2)
        for word in (*options, dir):
            self.assertIn(word, shlex.split(line))
        done = subprocess.run(["bash", "-c", line], cwd=self.folder, capture_output=True, text=True,
                              env=ENVIRONMENT)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_same_run(straight, self.folder / dir)

    def test_works_to_the_letter(self):
        self.check_line(1, dir="it's $HOME; here")

    def test_on_two_ranks(self):
        self.check_line(2, dir="b 2")

    def test_by_runge_kutta(self):
        self.check_line(1, "-ts_type", "rk", "-ts_rk_type", "4", dir="b")


class Auto(GoingOnTest):
    def check_job(self, ranks):
        """One command serves all parts of a run: it begins, goes on, and does nothing when all is
        done."""
        job = ("scene.yaml", "-checkpoint_restart", "auto", "-output_dir", "b")
        straight = self.run_whole(dir="a", ranks=ranks)
        for _ in range(3):
            self.stopped(*job, ranks=ranks)
            self.assertEqual(self.status("b"), "stopped")
        out = self.go(*job, ranks=ranks)
        self.assertIn("goes on from 'b/checkpoint.h5', t = 0.", out)
        self.assert_same(straight, self.folder / "b")
        before = self.files()
        self.assertIn("the run in b is done already; nothing is touched",
                      self.go(*job, ranks=ranks))
        self.assertEqual(before, self.files())
        return job

    def test_a_job(self):
        job = self.check_job(1)
        self.go(*job, "-time_end", "1.1")  # a later end is more to do
        self.assertEqual(self.status("b"), "done")
        self.go(*job, "-sheet_length", "22", code=2)
        self.assertIn("sheet: length: 22 cannot be changed", self.said)

    def test_a_job_on_two_ranks(self):
        self.check_job(2)

    def test_what_the_number_of_steps_ended(self):
        job = ("scene.yaml", "-checkpoint_restart", "auto")
        self.go(*job, "-ts_max_steps", "20")
        self.assertEqual(self.status("out/scene"), "done")
        self.assertIn("goes on from", self.go(*job))
        # The first part has a row of its own at its end.
        last, straight = ((folder / "history.csv").read_text().splitlines()[-1]
                          for folder in (self.folder / "out/scene", self.run_whole(dir="a")))
        self.assertEqual(last, straight)

    def test_the_newest_good_one(self):
        job = ("scene.yaml", "-checkpoint_restart", "auto")
        for _ in range(2):
            self.stopped(*job)
        newest = self.folder / "out/scene/checkpoint.h5"
        newest.write_bytes(newest.read_bytes()[:-1])
        out = self.go(*job)
        self.assertIn("is damaged", out)
        self.assertIn("goes on from 'out/scene/checkpoint_previous.h5'", out)
        self.assert_same_run(self.run_whole(dir="a"), self.folder / "out/scene")

    def test_none_is_good(self):
        job = ("scene.yaml", "-checkpoint_restart", "auto")
        self.stopped(*job)
        newest = self.folder / "out/scene/checkpoint.h5"
        newest.write_bytes(newest.read_bytes()[:-1])
        before = self.files()
        self.go(*job, code=2)
        self.assertIn("no good checkpoint is in out/scene", self.said)
        self.assertEqual(before, self.files())

    def test_done_without_a_checkpoint(self):
        (self.folder / "scene.yaml").write_text(CHANGING.replace("checkpoint: {every: 1000}\n", ""))
        self.run_whole(dir="b")
        self.assertFalse((self.folder / "b/checkpoint.h5").exists())
        before = self.files()
        job = ("scene.yaml", "-checkpoint_restart", "auto", "-output_dir", "b")
        self.assertIn("is done already", self.go(*job))
        self.go(*job, "-time_end", "3", code=2)
        self.assertIn("has left no checkpoint to go on from", self.said)
        self.assertEqual(before, self.files())


class WallTime(RunningTest):
    def test_ends_in_time(self):
        self.write(AFLOAT + "checkpoint: {wall_time: 1.5s}\n")
        for ranks in (1, 2):
            said = self.floe("-output_overwrite", "-output_dir", f"r{ranks}", code=STOPPED,
                             ranks=ranks)
            self.assertIn("stopped, since checkpoint: wall_time is nearly over, at time ", said)
            self.assertEqual(self.summary(f"r{ranks}")["status"], "stopped")
            self.assertTrue((self.folder / f"r{ranks}/checkpoint.h5").exists())
            self.assertNotIn("wall_time", (self.folder / f"r{ranks}/options.yaml").read_text())
            # The next part has a wall time of its own.
            self.floe("-checkpoint_restart", "auto", "-output_dir", f"r{ranks}",
                      "-checkpoint_wall_time", "00:00:02", code=STOPPED,
                      ranks=ranks)

    def test_how_it_is_written(self):
        for good in ("3h50m", "90s", "2h", "13800", "01:30:00", "1d2h", "1-02:00:00", "1.5h"):
            self.floe("-time_end", "0.01", "-checkpoint_wall_time", good)
        for bad in ("0", "-5", "nan", "3x", "h", "3m2h", "1:2", "01:60:00", "2000000h", "0.5",
                    "3h50", "''"):
            said = self.refused("-checkpoint_wall_time", bad)
            self.assertIn("checkpoint: wall_time", said)
            if bad != "-5":
                self.assertIn("must be a time (3h50m, 90s, 01:30:00 or seconds) >= 1, <= 1e9 [s]",
                              said)

    def test_of_a_static_run(self):
        said = self.refused("-integrator", "quasistatic", "-checkpoint_wall_time", "1h")
        self.assertIn("quasistatic", said)


if __name__ == "__main__":
    unittest.main()
