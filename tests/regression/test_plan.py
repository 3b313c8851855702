#!/usr/bin/python3
"""What a run says it will do and take, before its first step and with -check; and that absurd runs
are refused with the number, before anything is written."""
import json
import re
import sys
import unittest

import launch

sys.path.insert(0, str(launch.REPOSITORY / "python"))
from floe.results.output import frames_of  # noqa: E402

EXPLICIT = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {length: 20, width: 20, thickness: 0.5, element_size: 2, iterations: 10}
beam: {damping_ratio: 1}
time: {end: 0.02}
"""
IMPLICIT = EXPLICIT.replace("explicit", "implicit") + """load:
  names: [p]
  p: {point: [1, 2], force: [0, 0, -1e4], ramp: 0.01}
"""
STATIC = """forces: [beam, gravity, buoyancy]
sheet: {length: 20, width: 20, thickness: 0.5, element_size: 2, iterations: 10}
load: {names: [p], p: {point: [1, 2], force: [0, 0, -1e4], ramp: 1}}
"""
PLAN = re.compile(r"plan: (?P<step>.*)\nplan: about (?P<rows>\S+) rows?, (?P<frames>\S+) frames?, "
                  r"(?P<size>\S+) "
                  r"(?P<unit>[kMGT]B) on disk; (?P<now>\S+ [kMG]B) of memory so far"
                  r"(?:, about (?P<solver>\S+ [kMG]B) with the solver's)?(?:; about (?P<time>.+) "
                  r"\(by (?P<by>.*)\))?\n")
SHEETS = "what sheets of this size take, roughly"
UNITS = {"kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}


class PlanTest(launch.FolderTest):
    def run_scene(self, scene, *options, code=0, ranks=1):
        (self.folder / "scene.yaml").write_text(scene)
        done = launch.run("scene.yaml", *options, ranks=ranks, cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def plan(self, scene, *options, **how):
        said = self.run_scene(scene, *options, **how).stdout
        found = PLAN.search(said)
        self.assertIsNotNone(found, said)
        return found

    def summary(self):
        return json.loads((self.folder / "out/scene/summary.json").read_text())

    def written(self):
        """Rows, frames and bytes in the output folder."""
        folder = self.folder / "out/scene"
        rows = len((folder / "history.csv").read_text().splitlines()) - 1
        frames = len(frames_of(folder))
        return rows, frames, sum(f.stat().st_size for f in folder.rglob("*") if f.is_file()
                                 and f.name != "floe.log")


class Said(PlanTest):
    def test_explicit(self):
        for options in ((), ("-output_history", "0.001", "-output_fields", "0.0005"),
                        ("-output_fields", "1e-9"),
                        ("-ts_type", "rk", "-ts_rk_type", "4")):
            with self.subTest(options):
                plan = self.plan(EXPLICIT, *options)
                summary = self.summary()
                self.assertIn(f"step {summary['dt']:.4g} s, 0.", plan["step"])
                self.assertIn("of the stable step, limited by the " + summary["dt_limited_by"],
                              plan["step"])
                self.assertIn(f"; {summary['steps']} steps", plan["step"])
                self.assertIn("evaluations of the forces", plan["by"])
                self.assertRegex(plan["time"], r"^\S+ s$")
                rows, frames, size = self.written()
                self.assertEqual(int(plan["frames"]), frames)
                self.assertLessEqual(abs(int(plan["rows"]) - rows), 2 + 0.1 * rows)
                self.assertLess(abs(float(plan["size"]) * UNITS[plan["unit"]] - size), 0.3 * size)

    def test_touch(self):
        """The touch that dt: auto resolves is named; a given step resolves none."""
        made = launch.run("make_lattice", "stack", "--count", "2", "stack.h5", cwd=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        scene = """integrator: explicit
forces: [gravity, contact]
lattice_file: stack.h5
contact: {young: 1e8, restitution: %s}
obstacle: {names: [floor], floor: {shape: halfspace, point: [0, 0, 0], normal: [0, 0, 1]}}
time: {end: 0.1}
"""
        for restitution, steps in ((0.5, 11), (0.3, 14)):
            said = self.plan(scene % restitution)["step"]
            self.assertRegex(said, "so short that it resolves a touch by the largest face of body "
                                   rf"\d in {steps} steps;")
        self.assertNotIn("resolves", self.plan(scene % 0.5, "-time_dt", "1e-4")["step"])

    def test_implicit(self):
        plan = self.plan(IMPLICIT, "-time_dt", "0.001", "-output_history", "0.002",
                         "-output_fields", "0.005")
        self.assertIn("step 0.001 s; 20 steps", plan["step"])
        self.assertRegex(plan["time"], r"^\S+ s$")
        self.assertEqual(plan["by"], SHEETS)
        rows, frames, size = self.written()
        self.assertEqual((int(plan["rows"]), int(plan["frames"])), (rows, frames))
        self.assertLess(abs(float(plan["size"]) * UNITS[plan["unit"]] - size), 0.3 * size)
        plan = self.plan(IMPLICIT)
        self.assertIn("steps as long as their error allows, the first 0.0005 s", plan["step"])
        self.assertRegex(plan["time"], r"^\S+ s a step$")

    def test_static(self):
        plan = self.plan(STATIC, "-time_dt", "0.1", "-output_fields", "0.2")
        self.assertIn("load step 0.1; 10 load steps", plan["step"])
        self.assertRegex(plan["time"], r"^\S+ s$")
        self.assertEqual(plan["by"], SHEETS)
        rows, frames, size = self.written()
        self.assertEqual((int(plan["rows"]), int(plan["frames"])), (rows, frames))
        self.assertLess(abs(float(plan["size"]) * UNITS[plan["unit"]] - size), 0.3 * size)

    def test_beams_that_break_take_longer(self):
        plan = self.plan(STATIC.replace("[beam", "[beam, fracture"), "-check")
        self.assertEqual(plan["by"], SHEETS.replace("take,", "take while no beam breaks,"))

    def seconds(self, scene, *options):
        """What -check expects of a run."""
        number, unit = self.plan(scene, *options, "-check")["time"].split()
        return float(number) * {"s": 1, "min": 60, "h": 3600}[unit]

    def test_time_grows_with_what_is_to_be_done(self):
        large = ("-sheet_length", "40", "-sheet_width", "40")
        for scene, step in ((STATIC, "0.1"), (IMPLICIT, "0.001")):
            whole = self.seconds(scene, "-time_dt", step)
            self.assertLess(whole, 0.5 * self.seconds(scene, "-time_dt", step, *large))
            twice = self.seconds(scene, "-time_dt", str(float(step) / 2))
            self.assertTrue(1.5 * whole < twice < 2.5 * whole, (whole, twice))

    def test_memory_of_the_solver(self):
        """To a factor of 3, of a sheet that is large enough for it to show."""
        units = {"kB": 1e-3, "MB": 1, "GB": 1e3}
        plan = self.plan(STATIC, "-sheet_length", "80", "-sheet_width", "80")
        now, solver = (float(number) * units[unit]
                       for number, unit in (plan[name].split() for name in ("now", "solver")))
        taken = self.summary()["peak_memory_mb"] - now
        self.assertTrue((solver - now) / 3 < taken < 3 * (solver - now), (now, solver, taken))

    def test_check_says_it_too_and_writes_nothing(self):
        for scene in (EXPLICIT, IMPLICIT, STATIC):
            for ranks in (1, 2):
                plan = self.plan(scene, "-check", ranks=ranks)
                self.assertTrue(plan["step"])
                self.assertEqual([f.name for f in self.folder.iterdir()], ["scene.yaml"])

    def test_a_restart_says_what_is_left(self):
        scene = EXPLICIT + "checkpoint: {every: 1000}\n"
        self.run_scene(scene)
        steps = self.summary()["steps"]
        restart = ("-checkpoint_restart", "out/scene/checkpoint.h5", "-time_end", "0.04")
        before = {f.name: f.stat().st_mtime_ns for f in (self.folder / "out/scene").iterdir()}
        plan = self.plan(scene, *restart, "-check")
        self.assertEqual({f.name: f.stat().st_mtime_ns
                          for f in (self.folder / "out/scene").iterdir()}, before)
        self.assertIn(f"; {2 * steps} steps, {steps} of them made", plan["step"])
        plan = self.plan(scene, *restart)
        self.assertIn(f"; {2 * steps} steps, {steps} of them made", plan["step"])
        self.assertEqual(self.summary()["steps"], 2 * steps)


class Refused(PlanTest):
    def refuse(self, scene, *options, said, ranks=1):
        done = self.run_scene(scene, *options, code=2, ranks=ranks)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for words in said:
            self.assertIn(words, done.stderr)
        self.assertEqual([f.name for f in self.folder.iterdir()], ["scene.yaml"])

    def test_steps(self):
        for scene, what in ((EXPLICIT, "2e+10"), (IMPLICIT, "2e+10"), (STATIC, "1e+12")):
            for ranks in (1, 2):
                options = ("-time_dt", "1e-12", "-limit_steps", "1e10")
                self.refuse(scene, *options, said=("time: dt: 1e-12", f"would take {what}",
                                                   "at most 1e+10", "limit: steps"),
                            ranks=ranks)
        self.refuse(EXPLICIT, "-time_dt", "1e-12", "-time_end", "20",
                    said=("2e+13 steps", "at most 1e+11"))
        self.plan(EXPLICIT, "-time_dt", "1e-12", "-time_end", "20", "-limit_steps", "1e14",
                  "-check")

    def test_steps_that_ts_max_steps_ends(self):
        few = ("-ts_dt", "1e-12", "-limit_steps", "100", "-ts_max_steps")
        self.refuse(EXPLICIT, *few, "101", said=("ts_dt: 1e-12", "2e+10 steps", "at most 100"))
        self.plan(EXPLICIT, *few, "100", "-check")

    def test_steps_of_the_own_choice(self):
        self.refuse(EXPLICIT, "-time_end", "1e9",
                    said=("time: dt: ", "stable: ", "limited by the", "limit: steps"))

    def test_frames(self):
        self.refuse(EXPLICIT, "-output_fields", "1e-9", "-limit_frames", "10",
                    said=("output: fields: 1e-09 s would make ",
                          "at most 10 are made (limit: frames)"))
        self.refuse(IMPLICIT, "-output_fields", "1e-9",
                    said=("would make 20000001 frames", "TB", "at most 100000"))
        plan = self.plan(IMPLICIT, "-output_fields", "1e-9", "-limit_frames", "1e8", "-limit_disk",
                         "1e5", "-check")
        self.assertEqual(plan["frames"], "20000001")

    def test_room(self):
        options = ("-output_history", "1e-12")
        self.refuse(IMPLICIT, *options, said=("output: would be about 2e+10 rows", "TB on disk",
                                              "at most 1 TB", "limit: disk"))
        self.plan(IMPLICIT, *options, "-limit_disk", "1e5", "-check")
        self.refuse(EXPLICIT, "-limit_disk", "1e-6", said=("on disk, at most 1 kB are taken",))
        # one line: what may be meant so is not said of a run that is refused
        self.refuse(EXPLICIT, "-limit_disk", "1e-6", "-gravity", "1e-9", said=("limit: disk",))
        self.refuse(STATIC, "-ice_young", "4", "-ts_max_steps", "0", said=("ts_max_steps",))

    def test_memory(self):
        """A sheet that will not find room is refused before it is meshed
        (tests/unit/test_expected_cost.cpp)."""
        large = ("-sheet_length", "10000", "-sheet_width", "10000", "-limit_memory", "2")
        for scene, ranks in ((EXPLICIT, 1), (STATIC, 1), (STATIC, 2)):
            self.refuse(scene, *large, ranks=ranks,
                        said=("sheet: about 28867514 bodies would take about ",
                              "of memory, at most 2 GB are taken (limit: memory)"))
        self.refuse(EXPLICIT.replace("sheet:", "lattice_file: l.h5\n#"), "-limit_memory", "2",
                    said=("limit: memory", "only a sheet"))
        self.plan(STATIC, "-limit_memory", "2", "-check")


if __name__ == "__main__":
    unittest.main()
