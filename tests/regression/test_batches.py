#!/usr/bin/python3
"""floe ensemble with a back end for devices: runs whose steps are made together are each what they
are alone, bit for bit, whoever fails, leaves or is killed."""
import json
import os
import signal
import socket
import subprocess
import sys
import unittest

import h5py

from launch import REPOSITORY
from test_backend import BREAKING, DEVICES, FLOATING
from test_backend_contact import FLOES
from test_ensemble import TOOL, EnsembleTest

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.ensembles import batches  # noqa: E402
from floe.ensembles.runs import Run  # noqa: E402
from floe.ensembles.specs import TIMES  # noqa: E402
from floe.results.output import frames_of  # noqa: E402

# floe ensemble that gives runs little time for their checkpoints.
HASTY = """import os
import runpy
import sys
sys.argv = sys.argv[1:]
sys.path.insert(0, os.path.dirname(sys.argv[0]))
import find_floe
find_floe.load()
from floe.ensembles import runs
runs.GRACE = 3
runpy.run_path(sys.argv[0], run_name="__main__")
"""
KEEPING = FLOATING + "checkpoint: {every: 1000}\n"
# Of other meshes, steps, ends, and one in each list that fails on its way.
OTHERS = """seeds: [3, 4]
list:
  - name: plain
  - {name: short, time_end: 0.07}
  - {name: fine, time_dt: 2e-4}
  - {name: fast, load_dead_force: [0, 0, -1e7], limit_velocity: 3}
"""


class BatchTest(EnsembleTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(KEEPING)
        (self.folder / "level.csv").write_text("time,level\n0,0\n0.2,0.05\n")

    def arrays(self, path):
        """All data of a file of HDF5, as bytes; names of the run and its folder aside."""
        found = {}

        def visit(name, item):
            if isinstance(item, h5py.Dataset) and name not in ("options", "output/run"):
                found[name] = item[()].tobytes() if item.shape else item[()]
        with h5py.File(path) as file:
            file.visititems(visit)
        return found

    def results(self, folder):
        """What is left of a run, without times."""
        summary = json.loads((folder / "summary.json").read_text())
        for name in (*TIMES, "started", "ended"):
            summary.pop(name, None)
        kept = {"summary": summary, "history": (folder / "history.csv").read_text()}
        for _, path, group in frames_of(folder):
            kept[f"{path.name} {group}"] = {name: value for name, value in
                                            self.arrays(path).items()
                                            if name.startswith(group.strip("/"))}
        for name in ("checkpoint.h5", "breaks.h5"):
            if (folder / name).exists():
                kept[name] = self.arrays(folder / name)
        return kept

    def batches(self, said):
        """[(runs, engines, launches, steps)] of the batches, as the ensemble says them."""
        lines = [line for line in said.splitlines() if line.startswith("batch: ")]
        return [tuple(int("".join(filter(str.isdigit, part))) for part in line.split(","))
                for line in lines]


class Together(BatchTest):
    def test_runs_are_what_they_are_alone(self):
        for backend in DEVICES:
            with self.subTest(backend):
                self.compare(backend)

    def test_beams_that_break(self):
        (self.folder / "scene.yaml").write_text(KEEPING.replace(FLOATING, BREAKING))
        for backend in DEVICES:
            with self.subTest(backend):
                self.compare(backend)
                done = [row for row in self.table(f"out/ensemble_{backend}")
                        if row["status"] == "done"]
                self.assertGreater(min(float(row["energy_fracture"]) for row in done), 0)

    def test_contacts(self):
        """Floes of three meshes that collide; their lists of pairs expire at other steps."""
        (self.folder / "scene.yaml").write_text(FLOES + "checkpoint: {every: 1000}\n")
        for backend in DEVICES:
            self.spec(f"seeds: 3\noptions: {{backend: {backend}}}\n", backend)
            _, said = self.ensemble(name=backend)
            self.assertEqual([batch[:2] for batch in self.batches(said)], [(3, 1)])
            folder = self.folder / f"out/ensemble_{backend}"
            rows = self.table(folder)
            self.assertGreater(min(float(row["energy_contact_viscous"]) for row in rows), 0)
            self.compare_alone(folder, rows)

    def compare(self, backend):
        """Runs an ensemble, and each of its runs alone."""
        self.spec(f"options: {{backend: {backend}}}\n" + OTHERS, backend)
        _, said = self.ensemble(name=backend, code=1)
        folder = self.folder / f"out/ensemble_{backend}"
        (runs, engines, launches, steps), = self.batches(said)
        self.assertEqual((runs, engines), (8, 1))
        rows = self.table(folder)
        self.assertEqual([row["status"] for row in rows], ["done"] * 6 + ["failed"] * 2)
        self.assertIn("(limit: velocity 3 m/s)", rows[-1]["message"])
        counts = [int(row["steps"]) for row in rows]
        self.assertGreater(len(set(counts)), 4)
        # In a launch several runs make several steps.
        self.assertGreaterEqual(steps, max(counts))
        self.assertLess(steps, sum(counts) / 2)
        self.assertLess(10 * launches, steps)
        self.compare_alone(folder, rows)

    def compare_alone(self, folder, rows):
        recorded = json.loads((folder / "ensemble.json").read_text())["runs"]
        for row in rows:
            words = [word for key, value in recorded[row["run"]]["options"].items()
                     for word in (f"-{key}", value)]
            alone = self.folder / "alone" / row["run"]
            done = subprocess.run([self.environment["FLOE"], "scene.yaml", *words, "-output_dir",
                                   str(alone), "-output_overwrite"], cwd=self.folder,
                                  env=self.environment, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0 if row["status"] == "done" else 1)
            self.assertEqual(self.results(folder / "runs" / row["run"]), self.results(alone),
                             row["run"])

    def test_batches_of_few(self):
        """--jobs says how many are in a batch; the longest come first, one that is left is alone;
        runs of the processor are beside them."""
        self.spec("seeds: 5\noptions: {backend: loop, time_end: 0.01}\n")
        _, said = self.ensemble("--jobs", "2")
        self.assertIn("5 runs, 0 of them finished before, 2 in a batch", said)
        self.assertEqual([batch[0] for batch in self.batches(said)], [2, 2])
        self.spec("seeds: 2\noptions: {time_end: 0.01}\ngrid: {backend: [cpu, loop]}\n", "both")
        _, said = self.ensemble("--jobs", "3", name="both")
        self.assertIn("3 at a time, 3 in a batch", said)
        self.assertEqual([batch[0] for batch in self.batches(said)], [2])
        self.assertEqual({row["status"] for row in self.table("out/ensemble_both")}, {"done"})


class Interrupted(BatchTest):
    SPEC = "seeds: 3\noptions: {backend: loop, time_end: 1, checkpoint_every: %s}\n"
    straight = []  # the table of an ensemble that nothing has interrupted, of all tests

    def setUp(self):
        super().setUp()
        if not self.straight:
            self.spec(self.SPEC % 1000, "straight")
            self.ensemble("--dir", "straight", name="straight")
            self.straight.extend(self.rows("straight"))
        self.spec(self.SPEC % 0.05)
        self.process = self.begin("--dir", str(self.folder / "parts"))

        def halfway():
            folders = list((self.folder / "parts").glob("runs/*"))
            return len(folders) == 3 and all(
                (folder / "checkpoint.h5").exists() for folder in folders) and all(
                (folder / "history.csv").read_text().count("\n") > 20 for folder in folders)
        self.wait(self.process, halfway)

    def rows(self, folder):
        return [{key: value for key, value in row.items() if key not in ("wall_s", "processor_s")}
                for row in self.table(folder)]

    def goes_on(self):
        """The same command ends in the same table, to the last digit."""
        _, said = self.ensemble("--dir", str(self.folder / "parts"))
        self.assertEqual([batch[0] for batch in self.batches(said)], [3])
        for name in ("s001", "s002", "s003"):
            self.assertIn("---- the run goes on ----",
                          (self.folder / "parts/runs" / name / "floe.log").read_text())
        self.assertEqual(self.rows("parts"), self.straight)
        self.assertEqual({row["status"] for row in self.straight}, {"done"})

    def test_killed(self):
        self.process.kill()
        self.process.wait()
        self.gone()
        self.goes_on()

    def test_asked_to_stop(self):
        self.process.send_signal(signal.SIGINT)
        _, said = self.process.communicate()
        self.assertEqual(self.process.returncode, 3, said)
        self.assertEqual([row["status"] for row in self.table("parts")], ["stopped"] * 3)
        self.goes_on()

    def test_a_run_is_killed(self):
        """The others go on without it; the same command takes it up again."""
        child = self.process_of("parts/runs/s002")
        os.kill(child, signal.SIGKILL)
        _, said = self.process.communicate()
        self.assertEqual(self.process.returncode, 1, said)
        self.assertIn("failed: s002: ended by SIGKILL", said)
        self.assertEqual([row["status"] for row in self.table("parts")],
                         ["done", "failed", "done"])
        self.ensemble("--dir", str(self.folder / "parts"))  # alone
        self.assertEqual(self.rows("parts"), self.straight)

    def test_a_run_hangs(self):
        """Asked to stop, the others leave it behind and write their checkpoints."""
        self.process.kill()
        self.process.wait()
        self.gone()
        (self.folder / "hasty.py").write_text(HASTY)
        self.process = subprocess.Popen(
            [sys.executable, "hasty.py", str(TOOL), "e.yaml", "--dir", str(self.folder / "parts")],
            cwd=self.folder, text=True, env=self.environment, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE)
        self.addCleanup(self.end, self.process)
        logs = [self.folder / "parts/runs" / name / "floe.log" for name in ("s001", "s002", "s003")]
        self.wait(self.process, lambda: all("goes on from" in log.read_text() for log in logs))
        child = self.process_of("parts/runs/s002")
        os.kill(child, signal.SIGSTOP)
        self.process.send_signal(signal.SIGINT)
        _, said = self.process.communicate()
        self.assertEqual(self.process.returncode, 3, said)
        self.assertEqual([row["status"] for row in self.table("parts")], ["stopped"] * 3)
        self.assertEqual(["with exit code 3" in log.read_text() for log in logs],
                         [True, False, True])
        self.goes_on()

    def process_of(self, folder):
        """The process of a run of this test with this folder."""
        def is_it(process):
            try:
                with open(f"/proc/{process}/cmdline", "rb") as file:
                    words = file.read().decode().split("\0")
            except OSError:
                return False
            return words[0].endswith("floe") and any(
                word.startswith(str(self.folder)) and folder in word for word in words)
        child, = (int(entry.name) for entry in os.scandir("/proc")
                  if entry.name.isdigit() and is_it(entry.name))
        return child

    def test_the_process_of_the_batch_is_killed(self):
        """Its runs say so, and the same command goes on."""
        batch, = (int(entry.name) for entry in os.scandir("/proc") if entry.name.isdigit()
                  and self.is_batch(entry.name))
        os.kill(batch, signal.SIGKILL)
        _, said = self.process.communicate()
        self.assertEqual(self.process.returncode, 1, said)
        self.assertIn("failed: batch: ", said)
        for row in self.table("parts"):
            self.assertIn("the process that makes the steps of a batch has ended", row["message"])
        self.goes_on()

    def is_batch(self, process):
        """Whether a process makes the steps of this test's ensemble."""
        try:
            with open(f"/proc/{process}/cmdline", "rb") as file:
                words = file.read().split(b"\0")
            return (words[0].endswith(b"floe") and words[1] == b"-batch"
                    and os.readlink(f"/proc/{process}/cwd") == str(self.folder.resolve()))
        except (OSError, IndexError):
            return False


class Words(BatchTest):
    def test_bad_words(self):
        for words in (["-batch"], ["-batch", "loop"], ["-batch", "loop", "x"],
                      ["-batch", "loop", "1"], ["-batch", "loop", "7"]):
            done = subprocess.run([self.environment["FLOE"], *words], capture_output=True,
                                  text=True)
            self.assertEqual(done.returncode, 2)
            self.assertEqual(done.stderr.count("\n"), 1)
            self.assertTrue(done.stderr.startswith("floe: -batch"), done.stderr)
        ours, theirs = socket.socketpair()
        with ours, theirs:
            for words, part in ((["gpu", str(ours.fileno())], "backend: gpu must be one of"),
                                (["loop", *[str(ours.fileno())] * 2], "different open")):
                done = subprocess.run([self.environment["FLOE"], "-batch", *words],
                                      capture_output=True, text=True, pass_fds=[ours.fileno()])
                self.assertEqual(done.returncode, 2)
                self.assertIn(part, done.stderr)

    def test_a_connection_that_is_none(self):
        for number in ("0", "1", "x", "77"):
            done = subprocess.run([self.environment["FLOE"], "scene.yaml", "-backend", "loop"],
                                  capture_output=True, text=True, cwd=self.folder,
                                  env={**self.environment, "FLOE_BATCH": number})
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"FLOE_BATCH: '{number}' must be", done.stderr)

    def test_backend_of_a_run(self):
        scene = self.folder / "scene.yaml"
        for text, options, backend in (("backend: loop\n", {}, "loop"), ("a: 1\n", {}, "cpu"),
                                       ("backend: loop\n", {"backend": "cuda"}, "cuda"),
                                       ("a: 1\n", {"backend": ["loop"]}, "loop"),
                                       ("a: [\n", {}, "cpu"), ("", {}, "cpu")):
            scene.write_text(text)
            self.assertEqual(batches.backend_of(Run("r", str(scene), options)), backend)

    def test_memory_bounds_a_batch(self):
        self.assertEqual(batches.most(None), batches.MOST)
        self.assertEqual(batches.most(1e3), batches.MOST)
        self.assertEqual(batches.most(1e30), 1)
        few = batches.most(batches.memory() / 12)
        self.assertTrue(4 <= few <= 8, few)  # 0.8 / 1.5 * 12 = 6.4; memory may change meanwhile


if __name__ == "__main__":
    unittest.main()
