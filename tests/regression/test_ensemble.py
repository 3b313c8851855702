#!/usr/bin/python3
"""floe ensemble: the runs that a spec means, longest first; killed in the middle it goes on to the
same table; a failed run does not stop the rest; limits, locks, job arrays; bad specs."""
import csv
import os
import pty
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import numpy as np

from launch import ENVIRONMENT, FLOE, REPOSITORY, FolderTest
from running import processes_with

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.ensembles import specs  # noqa: E402
from floe.ensembles.runs import Ended, Process, Progress, Run, clock, dies_with  # noqa: E402
from floe.errors import InputError  # noqa: E402

TOOL = str(REPOSITORY / "tools/ensemble")
SCENE = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {length: 6, thickness: 0.5, element_size: 2, iterations: 5}
beam: {damping_ratio: 1}
initial: {names: [i], i: {set: right, velocity: [0, 0, 1]}}
time: {end: 3}
output: {history: 0.1, fields: 1000}
checkpoint: {every: 0.05}
"""
# Plans as many seconds as the sheet is thick, notes that it was run, and is done at once.
FAKE = """#!/bin/bash
thickness=1
while [ $# -gt 0 ]; do
  case $1 in
    -sheet_thickness) thickness=$2 ;;
    -output_dir) output=$2 ;;
    -check) echo "plan: about 1 MB on disk; about $thickness s (by 1 evaluation)"; exit ;;
  esac
  shift
done
echo "${output##*/}" >>started
mkdir -p "$output"
echo "{\\"steps\\": 7, \\"force\\": {\\"cone\\": [1, 2, 3]}}" >"$output/summary.json"
"""


class EnsembleTest(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(SCENE)
        self.environment = {**ENVIRONMENT, "FLOE": str(FLOE)}

    def fake(self, script=FAKE):
        """A floe that takes no time."""
        (self.folder / "fake").write_text(script)
        (self.folder / "fake").chmod(0o755)
        self.environment["FLOE"] = str(self.folder / "fake")

    def spec(self, text, name="e"):
        (self.folder / f"{name}.yaml").write_text("scene: scene.yaml\n" + text)

    def begin(self, *words, name="e", **how):
        process = subprocess.Popen([TOOL, f"{name}.yaml", *words], cwd=self.folder, text=True,
                                   env=self.environment, stdout=subprocess.PIPE,
                                   **{"stderr": subprocess.PIPE, **how})
        self.addCleanup(self.end, process)
        return process

    def ensemble(self, *words, name="e", code=0):
        """Standard output and standard error of a finished ensemble."""
        process = self.begin(*words, name=name)
        out, error = process.communicate()
        self.assertEqual(process.returncode, code, out + error)
        return out, error

    def table(self, folder="out/ensemble_e"):
        with open(self.folder / folder / "runs.csv", newline="") as file:
            return list(csv.DictReader(file))

    def wait(self, process, condition):
        while not condition():
            self.assertIsNone(process.poll(), "it ended too early")
            time.sleep(0.002)

    def gone(self):
        """Waits until no run of the test is left."""
        while processes_with(f"-output_dir {self.folder}"):
            time.sleep(0.01)


class Points(unittest.TestCase):
    """The runs of a spec."""

    def members(self, **given):
        scene = str(REPOSITORY / "input/tension.yaml")
        return specs.members(specs.spec_of({"scene": scene, **given}, "e", Path()))

    def test_grid_list_and_seeds(self):
        runs = self.members(
            grid={"sheet": {"thickness": [0.5, 1]}, "water_density": [1010, 1025, "1e3"]},
            list=[{"ice": {"young": 4e9}}, {"ice_young": "5e9", "model: planar": False}],
            options={"boundary": {"right": {"displacement": [0.1, 0, 0]}}}, seeds=[3, 12],
            seed_keys=["sheet: seed", "fracture_seed"])
        self.assertEqual(len(runs), 2 * 3 * 2 * 2)
        self.assertEqual(len({run.name for run in runs}), len(runs))
        self.assertEqual([run.name for run in runs[:3]], ["p001_s003", "p001_s012", "p002_s003"])
        self.assertEqual(runs[3].options,
                         {"boundary_right_displacement": "0.1,0,0", "sheet_thickness": "0.5",
                          "water_density": "1010", "ice_young": "5e9", "model_planar": "false",
                          "sheet_seed": "12", "fracture_seed": "12"})
        self.assertEqual(runs[3].parameters, {"sheet_thickness": "0.5", "water_density": "1010",
                                              "ice_young": "5e9", "model_planar": "false"})
        self.assertEqual([run.name for run in self.members(seeds=3)], ["s001", "s002", "s003"])
        self.assertEqual([run.name for run in self.members(list=[{"name": "a"}, {"name": "b"}])],
                         ["a", "b"])

    def test_latin_hypercube(self):
        def sample(**given):
            given = {"samples": 20, "ranges": {"a": [0.3, 0.8], "b": ["1e5", 3e5]}, **given}
            runs = self.members(latin_hypercube=given)
            return np.array([[float(run.parameters[key]) for key in "ab"] for run in runs])
        points = sample()
        self.assertEqual(points.shape, (20, 2))
        for column, (low, high) in zip(points.T, ((0.3, 0.8), (1e5, 3e5))):
            # each twentieth of the range has one
            part = np.floor((column - low) / (high - low) * 20)
            self.assertEqual(sorted(part), list(range(20)))
        self.assertLess(abs(np.corrcoef(points.T)[0, 1]), 0.7)
        np.testing.assert_array_equal(points, sample())
        self.assertTrue(np.any(points != sample(seed=2)))

    def test_durations(self):
        for text, seconds in ((90, 90), ("90s", 90), ("3h50m", 13800), ("01:30:00", 5400),
                              ("2h", 7200), (0.5, 0.5), ("1m5s", 65)):
            self.assertEqual(specs.duration("limit: run", text), seconds)


class BadSpecs(FolderTest):
    def test_what_is_wrong_is_said_with_key_value_and_what_is_allowed(self):
        (self.folder / "s.yaml").write_text(SCENE)
        path = self.folder / "e.yaml"
        for text, *parts in (
                ("", "scene: is missing"), ("scene: none.yaml", "scene: 'none.yaml'", "a file"),
                ("scene: s.yaml\nsead: 1", "sead: unknown key", "is it 'seeds'?"),
                ("scene: s.yaml\nseeds: 0", "seeds: 0", ">= 1"),
                ("scene: s.yaml\nseeds: [1, 1]", "seeds: [1, 1]", "different"),
                ("scene: s.yaml\nseeds: 1.5", "seeds: 1.5", "whole"),
                ("scene: s.yaml\nseeds: yes", "seeds: true", "whole"),
                ("scene: s.yaml\nseed_keys: [a]", "seed_keys: would have no effect"),
                ("scene: s.yaml\nranks: 0", "ranks: 0", ">= 1"),
                ("scene: s.yaml\nlimit: {run: 0}", "limit: run: 0", "> 0"),
                ("scene: s.yaml\nlimit: {run: soon}", "limit: run: 'soon'", "3h50m"),
                ("scene: s.yaml\nlimit: {ran: 1}", "limit: ran: unknown key", "is it 'run'?"),
                ("scene: s.yaml\ngrid: {a: 1}", "grid: a: 1", "a list"),
                ("scene: s.yaml\ngrid: {a: []}", "grid: a: []", "at least one"),
                ("scene: s.yaml\ngrid: {a: [.nan]}", "grid: a: NaN", "a number"),
                ("scene: s.yaml\ngrid: {output_dir: [a]}", "output_dir: is the ensemble's own"),
                ("scene: s.yaml\nlist: {a: 1}", "list: ", "a list"),
                ("scene: s.yaml\nlist: [1]", "list: 1", "a mapping"),
                ("scene: s.yaml\nlist: [{name: a/b}]", "list: name: 'a/b'", "letters"),
                ("scene: s.yaml\nlist: [{name: a}, {name: a}]", "two points are named 'a'"),
                ("scene: s.yaml\nlist: [{scene: no}]", "list: scene: false", "a scene"),
                ("scene: s.yaml\noptions: {a: 1}\ngrid: {a: [1]}", "a: is given in two places"),
                ("scene: s.yaml\nseeds: 1\ngrid: {sheet: {seed: [1]}}", "sheet_seed: is given in"),
                ("scene: s.yaml\noptions: {a: {b: 1}, a_b: 1}", "a_b: stands twice"),
                ("scene: s.yaml\nseeds: 1\nseeds: 2", "seeds: stands twice"),
                ("scene: s.yaml\nlatin_hypercube: {ranges: {a: [0, 1]}}", "samples: null"),
                ("scene: s.yaml\nlatin_hypercube: {samples: 2, ranges: {a: [1, 0]}}",
                 "ranges: a: [1, 0]", "least < most"),
                ("scene: s.yaml\nlatin_hypercube: {samples: 2, ranges: {a: [0, x]}}", "a: 'x'"),
                ("scene: s.yaml\nlatin_hypercube: {samples: 2}", "ranges: null"),
                ("scene: s.yaml\noutput: 3", "output: 3", "a folder"),
                ("scene: [", "e.yaml: while parsing"), ("- a", "must be a mapping")):
            with self.subTest(text):
                path.write_text(text)
                with self.assertRaises(InputError) as raised:
                    specs.read(path)
                said = str(raised.exception)
                self.assertTrue(said.startswith(f"{path}: "), said)
                self.assertNotIn("\n", said)
                for part in parts:
                    self.assertIn(part, said)


class Refused(EnsembleTest):
    def refused(self, *words, part, name="e"):
        before = sorted(self.folder.rglob("*"))
        _, said = self.ensemble(*words, name=name, code=2)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn(part, said)
        self.assertEqual(sorted(self.folder.rglob("*")), before, "something has been written")

    def test_nothing_is_touched(self):
        self.spec("seeds: 0\n")
        self.refused(part="e.yaml: seeds: 0 must be")
        self.refused("--jobs", "0", part="--jobs")
        self.refused(name="none", part="none.yaml")
        # what only floe knows is floe's own line
        self.spec("grid: {sheet_thickness: [0.5, -1]}\n")
        self.refused(part="run p002: floe: sheet: thickness: -1 must be a number")
        self.spec("seeds: 2\noptions: {shet_length: 3}\n")
        self.refused("--check", part="shet_length: unknown option")
        self.spec("seeds: 2\n")
        self.refused("--only", "s3", part="'s3' is no run")
        self.refused("--table", part="is no ensemble's folder")
        (self.folder / "mine").mkdir()
        (self.folder / "mine/thesis.txt").write_text("")
        self.refused("--dir", "mine", part="neither empty nor an ensemble's folder")

    def test_a_program_that_cannot_start(self):
        self.fake("#!/bin/sh\necho 'floe.so: no such library' >&2\necho >&2\nexit 127\n")
        self.spec("seeds: 2\n")
        self.refused(part="run s001: floe.so: no such library")
        self.fake("#!/bin/sh\nexit 1\n")
        self.refused(part="run s001: no message")

    def test_other_options_in_the_same_folder(self):
        self.fake()
        self.spec("seeds: 2\noptions: {sheet_thickness: 0.5}\n")
        self.ensemble()
        self.spec("seeds: 3\noptions: {sheet_thickness: 0.5}\n")
        self.assertIn("3 runs, 2 of them finished before", self.ensemble()[1])
        self.spec("seeds: 3\noptions: {sheet_thickness: 0.6}\n")
        self.refused(part="its run s001 has sheet_thickness 0.5, the spec says 0.6")
        self.spec("seeds: 3\noptions: {sheet_thickness: 0.5}\n")
        (self.folder / "scene.yaml").write_text(SCENE.replace("end: 3", "end: 4"))
        self.refused(part="another scene")


class Runs(EnsembleTest):
    def test_killed_and_going_on(self):
        """kill -9 in the middle: runs die with it, what was done is kept, what was under way goes
        on from its checkpoint, and the table is the same but for times."""
        runs = "seeds: 2\ngrid: {sheet_thickness: [0.5, 0.4]}\n"
        self.spec(runs + "options: {checkpoint_every: 600}\n", "straight")
        self.ensemble("--dir", "straight", "--jobs", "2", name="straight")
        self.spec(runs)
        folder = self.folder / "killed"
        process = self.begin("--dir", str(folder), "--jobs", "2")

        def results():
            return {path.stem: path.stat().st_mtime_ns for path in folder.glob("results/*.json")}

        def halfway():
            return [path.parent.name for path in folder.glob("runs/*/checkpoint.h5")
                    if (path.parent / "history.csv").read_text().count("\n") < 15]
        self.wait(process, lambda: results() and halfway())
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.gone()
        before, restarted = results(), halfway()
        self.assertIn(len(before), range(1, 4))
        _, said = self.ensemble("--dir", str(folder), "--jobs", "2")
        self.assertIn(f"4 runs, {len(before)} of them finished before", said)
        self.assertEqual(before, {name: results()[name] for name in before})
        self.assertTrue(restarted)
        for name in restarted:
            self.assertIn("checkpoint", (folder / "runs" / name / "floe.log").read_text())
        times = ("wall_s", "processor_s")
        expected, rows = self.table("straight"), self.table("killed")
        self.assertEqual([{k: v for k, v in row.items() if k not in times} for row in rows],
                         [{k: v for k, v in row.items() if k not in times} for row in expected])
        self.assertEqual({row["status"] for row in rows}, {"done"})
        self.assertEqual([row["sheet_thickness"] for row in rows],
                         ["0.5"] * 2 + ["0.4"] * 2)
        self.assertEqual(len({row["energy_damping"] for row in rows}), 4)  # no two are one run

    def test_failed_run_does_not_stop_the_rest(self):
        self.spec("options: {time_end: 0.2}\n"
                  "list: [{name: a}, {name: b, limit_energy_error: 1e-12}, {name: c}]\n")
        _, said = self.ensemble("--jobs", "1", code=1)
        self.assertIn("\nfailed: b: exit code 1: ", said)
        rows = {row["run"]: row for row in self.table()}
        self.assertEqual({name: row["status"] for name, row in rows.items()},
                         {"a": "done", "b": "failed", "c": "done"})
        self.assertIn("limit: energy_error", rows["b"]["message"])
        self.assertIn("2 of them finished before", self.ensemble(code=1)[1])

    def test_limits_and_requests_to_stop(self):
        """A run that takes too long, and all when the ensemble is asked to stop, write checkpoints;
        the same command goes on."""
        for k, limit in enumerate((0.4, 2, 10, 50, 250)):  # [s], until steps are reached in time
            name, times = f"e{k}", []
            self.spec("options: {time_end: 1e5, limit_frames: 1e12, limit_disk: 1e12}\n"
                      f"limit: {{run: {limit}}}\nseeds: 1\n", name)
            for _ in range(2):
                _, said = self.ensemble(name=name, code=3)
                self.assertIn("stopped: s001: by limit: run", said)
                row, = self.table(f"out/ensemble_{name}")
                self.assertEqual((row["status"], row["message"]), ("stopped", "by limit: run"))
                times.append(float(row.get("time") or 0))
            if 0 < times[0] < times[1]:
                break
        else:
            self.fail(f"no step after a checkpoint, whatever the limit: {times}")
        self.spec("options: {time_end: 1e5, limit_frames: 1e12, limit_disk: 1e12}\nseeds: 2\n",
                  "two")
        process = self.begin("--jobs", "1", name="two")
        folder = self.folder / "out/ensemble_two/runs/s001"
        self.wait(process, (folder / "checkpoint.h5").exists)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate()
        self.assertEqual(process.returncode, 3, said)
        self.assertIn("stopped: s001: by SIGINT", said)
        self.assertIn("0 runs are done, 2 are not", said)
        self.assertEqual([row["status"] for row in self.table("out/ensemble_two")],
                         ["stopped", "waiting"])

    def test_ranks_die_with_the_ensemble(self):
        self.spec("options: {time_end: 1e5, limit_frames: 1e12, limit_disk: 1e12}\nranks: 2\n")
        process = self.begin("--dir", str(self.folder / "out"))
        self.wait(process, (self.folder / "out/runs/p001/checkpoint.h5").exists)
        self.assertEqual(len([command for command in
                              processes_with(f"-output_dir {self.folder}")
                              if command.startswith(str(FLOE))]), 2)
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.gone()

    def test_no_run_starts_once_the_ensemble_has_ended(self):
        for parent, status in ((f"= {os.getpid()}", 0), ("= 1", 1), ("!= 1", 0)):
            self.assertEqual(subprocess.run([*dies_with(parent), "true"]).returncode, status)

    def test_the_longest_first(self):
        self.fake()
        self.spec("seeds: 2\ngrid: {sheet_thickness: [1, 3, 0.5, 2]}\n")
        out, _ = self.ensemble("--check")
        self.assertFalse((self.folder / "out").exists())
        names = [f"p{point:03d}_s{seed:03d}" for point in (2, 4, 1, 3) for seed in (1, 2)]
        lines = out.splitlines()
        self.assertEqual([line.split()[0] for line in lines[:-1]], names)
        self.assertIn("sheet_thickness 3, seed 1, about 3 s", lines[0])
        self.assertIn("8 runs, 0 of them done", lines[-1])
        self.ensemble("--jobs", "1")
        self.assertEqual((self.folder / "started").read_text().split(), names)
        row = self.table()[0]
        self.assertEqual({key: row[key] for key in ("run", "seed", "steps", "force_cone_y")},
                         {"run": "p001_s001", "seed": "1", "steps": "7", "force_cone_y": "2"})

    def test_two_at_once_are_refused(self):
        self.fake(FAKE.replace("mkdir", "[ -e once ] || exec sleep infinity\nmkdir"))
        self.spec("seeds: 2\n")
        process = self.begin("--jobs", "1")
        self.wait(process, (self.folder / "out/ensemble_e/ensemble.json").exists)
        _, said = self.ensemble(code=2)
        self.assertIn("out/ensemble_e: is in use by another process", said)
        self.assertEqual(said.count("\n"), 1)
        process.kill()
        process.wait()
        (self.folder / "once").touch()
        self.ensemble()
        self.assertEqual({row["status"] for row in self.table()}, {"done"})

    def test_a_bar_on_a_terminal(self):
        self.fake()
        self.spec("seeds: 2\n")
        ours, theirs = pty.openpty()
        process = self.begin(stderr=theirs)
        process.communicate()
        said = os.read(ours, 10000).decode()
        os.close(ours)
        os.close(theirs)
        self.assertIn(f"\r\033[K[{'#' * 30}] 2 of 2 runs, 100 %", said)


class TimeLeft(unittest.TestCase):
    def test_by_what_runs_have_taken(self):
        """Costs that are left times what a unit has taken so far, over the runs at a time; but not
        less than the longest run."""
        runs = [Run(str(cost), "", {}, cost=cost) for cost in (10, 10, 10, 10)]
        progress = Progress(runs, 1)
        self.assertTrue(np.isnan(progress.left(runs, [], 0)))
        progress.count(runs[0], Ended("done", 0, "", 20, 20))
        progress.count(runs[1], Ended("failed", 1, "", 1, 1))  # tells nothing
        process = Process(runs[2], None, None, None, started=100)
        self.assertAlmostEqual(progress.left(runs[3:], [process], 105), 20 + 15)
        progress.jobs = 2
        self.assertAlmostEqual(progress.left(runs[3:], [process], 105), 20)
        self.assertAlmostEqual(progress.left(runs[2:], [process], 105), (20 + 20 + 15) / 2)
        self.assertAlmostEqual(progress.left([], [process], 105), 15)
        self.assertEqual(progress.left([], [process], 150), 0)
        self.assertEqual([clock(s) for s in (5.2, 119, 200, 7300, 1e6)],
                         ["5 s", "119 s", "3.3 min", "2 h", "11.6 days"])


class Slurm(EnsembleTest):
    def test_an_array_of_all_runs(self):
        self.fake("#!/bin/bash\nif [ \"$1\" = ensemble ]; then shift; exec \"$TOOL\" \"$@\"; fi\n"
                  + FAKE + "[ ! -e full ] || exit 3\n")
        (self.folder / "sbatch").write_text("#!/bin/bash\necho \"$@\" >submitted\n")
        (self.folder / "sbatch").chmod(0o755)
        self.environment |= {"TOOL": TOOL, "PATH": f"{self.folder}:{os.environ['PATH']}"}
        self.spec("seeds: 2\ngrid: {sheet_thickness: [1, 2]}\nlimit: {run: 90m}\nranks: 1\n")
        self.ensemble("--only", "p002_s001")
        self.ensemble("--slurm", "--only", "p001_s002,p002_s001")
        self.assertIn("--array=1-1 ", (self.folder / "out/ensemble_e/slurm.sh").read_text())
        out, _ = self.ensemble("--slurm")
        script = self.folder / out.strip()
        self.assertEqual(script, self.folder / "out/ensemble_e/slurm.sh")
        subprocess.run(["bash", "-n", script], check=True)
        text = script.read_text()
        self.assertIn("--array=1-3 --ntasks=1 --time=95\n", text)
        self.assertIn("\nruns=(p002_s002 p001_s001 p001_s002)\n", text)  # longest first, none done
        self.assertEqual([row["status"] for row in self.table()], ["waiting"] * 2
                         + ["done", "waiting"])

        def begin(task):
            return subprocess.Popen([script], cwd="/", stdout=subprocess.DEVNULL,
                                    stderr=subprocess.DEVNULL,
                                    env={**self.environment, "SLURM_ARRAY_TASK_ID": str(task)})
        (self.folder / "full").touch()  # a run that stops with a checkpoint has a successor
        self.assertEqual(begin(2).wait(), 3)
        self.assertEqual((self.folder / "submitted").read_text(), f"--array=2 {script}\n")
        (self.folder / "full").unlink()
        (self.folder / "started").unlink()
        tasks = [begin(task) for task in (1, 2, 3)]
        self.assertEqual([task.wait() for task in tasks], [0, 0, 0])  # beside each other
        self.assertEqual({row["status"] for row in self.table()}, {"done"})
        self.assertEqual(sorted((self.folder / "started").read_text().split()),
                         ["p001_s001", "p001_s002", "p002_s002"])


class Example(EnsembleTest):
    def test_ice_cone(self):
        """The spec of input/ensembles, two of its draws for a moment."""
        given = (REPOSITORY / "input/ensembles/ice_cone.yaml").read_text()
        given = given.replace("../ice_cone", f"{REPOSITORY}/input/ice_cone")
        (self.folder / "e.yaml").write_text(
            given.replace("seeds: 5", "seeds: 1").replace("options:", "options:\n  time_end: 0.02"))
        self.ensemble()
        rows = self.table()
        self.assertEqual([row["status"] for row in rows], ["done", "done"])
        self.assertIn("peak_force_cone_x", rows[0])
        self.assertEqual([row["sheet_thickness"] for row in rows], ["0.5", "0.7"])

    def test_all_are_valid(self):
        self.environment["FLOE"] = str(FLOE)
        for spec, runs in (("ice_cone", 10), ("ice_slope", 50)):
            path = REPOSITORY / f"input/ensembles/{spec}.yaml"
            self.assertEqual(path.read_text().splitlines()[0],
                             f"# floe ensemble input/ensembles/{spec}.yaml")
            out, _ = self.ensemble("--check", "--dir", "out", name=path.with_suffix(""))
            self.assertIn(f"{runs} runs, 0 of them done", out)


if __name__ == "__main__":
    unittest.main()
