"""Runs that are killed, told to stop or that find the disk full, at random times, again and again,
and that go on each time from their newest checkpoint: in the end they equal the run that nothing
happened to, bit for bit, and no file was ever torn.

What happens when follows from the chain's seed, but for what the machine's speed decides.
test_kills.py and test_kills_ranks.py run the chains, on one rank and on two.
"""
import functools
import json
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "regression"))
from launch import ENDLESS, ENVIRONMENT, FLOE, own_words  # noqa: E402
from test_restart import INTERRUPTED, Killing, contents, rows_of, stop_file  # noqa: E402

# A floating sheet that is pushed against a slope, breaks, and whose pieces slide: something breaks
# or touches all the time.
SCENE = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 12, width: 6, thickness: 0.5, element_size: 1.5, iterations: 10}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 3e5, shear_strength: 3e5, energy: 15, weibull_modulus: 8}
water: {drag_coefficient: 1, drag_linear: 200}
contact: {young: 1e8, friction: 0.2, restitution: 0.3, plastic_limit: 1e6}
obstacle:
  names: [slope]
  slope: {shape: halfspace, point: [6.02, 0, -0.4554], normal: [-1, 0, 1], friction: 0.1}
boundary: {names: [push], push: {set: left, fix: x y rz, velocity: [0.5, 0, 0], ramp: 0.1}}
limit: {energy_error: 1e9}
output: {history: 0.004, fields: 0.02}
checkpoint: {every: 0.02}
"""
EVENTS = ("kill", "SIGHUP", "SIGTERM", "SIGUSR1", "size limit", "full disk")
DISK = 256 << 20  # [bytes]


class Chain(Killing):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(SCENE)
        self.results = self.folder / "b"
        self.results.mkdir()
        self.has_disk = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK}", "tmpfs",
                                        str(self.results)],
                                       capture_output=True).returncode == 0
        if self.has_disk:
            self.addCleanup(subprocess.run, ["umount", "-l", str(self.results)], check=True)

    def start_again(self):
        """Empties the folders for the next chain."""
        for folder in (self.results, self.folder / "straight_b"):
            for path in sorted(folder.rglob("*"), reverse=True):
                path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()

    @staticmethod
    def end(process):
        """What is left of a chain that failed."""
        if process.poll() is None:
            process.kill()
        process.communicate()

    def newest(self):
        """Options that go on from the newest checkpoint, if there is one."""
        if re.search(r"\bauto\b", checkpoint_help()):
            return ["-checkpoint_restart", "auto"]
        return ["-checkpoint_restart",
                "b/checkpoint.h5"] if (self.results / "checkpoint.h5").exists() else []

    def ranks_of(self, process, ranks):
        """The processes of a run's ranks: mpiexec's children, once they are there."""
        if ranks == 1:
            return [process.pid]
        try:
            children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        except FileNotFoundError:
            return []
        return [int(child) for child in children]

    def fill(self, left):
        """Fills the file system of the results but for so many bytes, while the run writes
        there."""
        with open(self.results / "filler", "wb") as filler:
            while True:
                free = os.statvfs(self.results)
                try:
                    return os.posix_fallocate(filler.fileno(), 0,
                                              max(1, free.f_bavail * free.f_frsize - left))
                except OSError:  # the run was faster
                    left += 8192

    def happen(self, event, process, ranks, chance):
        """Does it to the run; how it must end: exit codes."""
        victims = self.ranks_of(process, ranks)
        try:
            if event == "kill":
                for victim in victims or [process.pid]:
                    os.kill(victim, signal.SIGKILL)
                return None
            if event == "size limit":
                largest = max([p.stat().st_size for p in self.results.rglob("*") if p.is_file()],
                              default=0)
                limit = largest + chance.randrange(0, 20000)
                for victim in victims:
                    resource.prlimit(victim, resource.RLIMIT_FSIZE, (limit, limit))
                return (1,)
            if event == "full disk":
                self.fill(chance.choice((0, 4096, chance.randrange(300000))))
                return (1,)
            os.kill(chance.choice(victims or [process.pid]), getattr(signal, event))
        except ProcessLookupError:
            pass
        return (INTERRUPTED,)

    def check_event(self, event, early, process, codes):
        """What the run left and said."""
        out, error = process.communicate()
        said, code = own_words(error), process.returncode
        what = f"{event}{' early' if early else ''}: exit code {code}: {out[-300:]}{said[-600:]}"
        if codes is not None:
            # before floe listens, or before it has an output folder
            if not (early and code not in (0, 2)):
                self.assertIn(code, codes, what)
            lines = [line for line in said.splitlines() if "warning" not in line]
            if code in (1, INTERRUPTED) and not early:
                self.assertEqual(len(lines), 1, what)
                self.assertTrue(lines[0].startswith("floe: "), what)
            if code == INTERRUPTED and "at time" in said:
                summary = json.loads((self.results / "summary.json").read_text())
                self.assertEqual(summary["status"], "stopped", what)
                self.assertEqual(summary["steps"], self.steps_of("b"), what)
            if code == 1 and not early and event == "size limit":
                self.assertIn("File too large", said)
                self.assertEqual(json.loads((self.results / "summary.json").read_text())["status"],
                                 "failed")
            if code == 1 and not early and event == "full disk":
                self.assertIn("No space left", said)
        if event == "full disk":
            (self.results / "filler").unlink(missing_ok=True)
        if (self.results / "history.csv").exists() and (self.results
                                                        / "history.csv").stat().st_size:
            self.check_files(self.results)
        if (self.results / "summary.json").exists():
            json.loads((self.results / "summary.json").read_text())

    def check_chain(self, seed, events, ranks):
        """A run with so many events equals the one without."""
        chance = random.Random(seed)
        bag = []
        for _ in range(events):
            if not bag:
                bag = [event for event in EVENTS if self.has_disk or event != "full disk"]
                chance.shuffle(bag)
            event, early = bag.pop(), chance.random() < 0.2
            if event in ("size limit", "full disk"):
                early = False
            before = rows_of(self.results)
            process = self.begin(*ENDLESS, *self.newest(), dir="b", ranks=ranks)
            self.addCleanup(self.end, process)
            if early:
                time.sleep(chance.uniform(0, 0.4))
            else:
                self.wait_for_rows(process, self.results,
                                   min(before, rows_of(self.results)) + chance.randrange(1, 60))
                time.sleep(chance.uniform(0, 0.05))
            self.check_event(event, early, process, self.happen(event, process, ranks, chance))
        before = rows_of(self.results)
        process = self.begin(*ENDLESS, *self.newest(), dir="b", ranks=ranks)
        self.addCleanup(self.end, process)
        self.wait_for_rows(process, self.results, before + 5)  # it is under way, and sees the file
        stop_file(process, self.results)
        self.finish(process, INTERRUPTED)
        end = ("-ts_max_steps", str(self.steps_of("b") + 500))
        resumed = self.run_whole(*ENDLESS, *end, *self.newest(), dir="b", ranks=ranks)
        straight = self.run_whole(*ENDLESS, *end, dir="straight_b", ranks=ranks)
        self.assert_same(straight, resumed)
        first, second = contents(straight / "breaks.h5"), contents(resumed / "breaks.h5")
        self.assertEqual(set(first), set(second))
        for name, values in first.items():
            np.testing.assert_array_equal(values, second[name], name)
        summary = json.loads((resumed / "summary.json").read_text())
        self.assertGreater(summary["beams_broken"], 5)
        self.assertGreater(summary["contacts"], 0)


@functools.cache
def checkpoint_help():
    """What floe says of the option -checkpoint_restart."""
    page = subprocess.run([FLOE, "-help_markdown"], capture_output=True, text=True, env=ENVIRONMENT,
                          check=True).stdout
    return next(line for line in page.splitlines() if line.startswith("| `checkpoint: restart`"))
