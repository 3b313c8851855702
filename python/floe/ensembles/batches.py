"""Runs whose steps a device makes, many in one launch (docs/ensembles.md, "On a device").

A run is a process as ever. Its engine is a further process, `floe -batch`, which the runs of a
batch share: each has a connection to it, whose number is in FLOE_BATCH."""
import os
import re
import signal
import socket
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import yaml

from floe import program
from floe.ensembles import runs as single
from floe.ensembles.runs import ENVIRONMENT, Runner, dies_with, last_words

MOST = 64  # runs of a batch, unless the user says how many


def backend_of(run):
    """The back end of a run, by its options or its scene."""
    if "backend" in run.options:
        given = run.options["backend"]
        return str(given[0] if isinstance(given, list) and len(given) == 1 else given)
    try:
        scene = yaml.safe_load(Path(run.scene).read_text())
    except (OSError, ValueError, yaml.YAMLError):
        return "cpu"  # floe says what is wrong
    return str(scene.get("backend", "cpu")) if isinstance(scene, dict) else "cpu"


def memory():
    """Memory that is free on this machine [bytes], 0 if it does not say."""
    try:
        with open("/proc/meminfo") as file:
            found = re.search(r"MemAvailable: +(\d+) kB", file.read())
    except OSError:
        found = None
    return 1024 * int(found[1]) if found else 0


def most(bytes_of_run):
    """Runs for which this machine has memory, of at most MOST.

    bytes_of_run: memory of one run before its first step, or None"""
    if not bytes_of_run:
        return MOST
    return max(1, min(MOST, int(0.8 * memory() / (1.5 * bytes_of_run))))


@dataclass
class Batch:
    """The process that makes the steps of some runs; files of what it says; since when it is
    without runs."""
    backend: str
    runs: list
    popen: subprocess.Popen
    out: object
    error: object
    alone: float = 0.0
    pressed: bool = False  # it has been told to leave behind runs for which others wait


class BatchRunner(Runner):
    """A Runner that puts runs of a device together.

    backends: {name of a run: its backend}; most: runs of a batch. Others are `jobs` at a time."""

    def __init__(self, folder, jobs, finish, backends, most, *others):
        super().__init__(folder, jobs, finish, *others)
        self.backends, self.most, self.batches = backends, most, []

    def under_way(self):
        return super().under_way() or bool(self.batches)

    def backend(self, run):
        return self.backends.get(run.name, "cpu")

    def has_room(self, run):
        """Whether a run may be started now: one of a device if nothing else is there."""
        backend = self.backend(run)
        busy = sum(self.backend(process.run) == backend for process in self.running.values())
        if backend == "cpu":
            return busy < self.jobs
        return busy == 0 and all(batch.backend != backend for batch in self.batches)

    def begin(self):
        while (run := self.next(self.has_room)) is not None:
            runs = [run]
            backend = self.backend(run)
            while backend != "cpu" and len(runs) < self.most:
                other = self.next(lambda one: self.backend(one) == backend, runs)
                if other is None:
                    break
                runs.append(other)
            if len(runs) == 1:
                self.start(run)
            else:
                self.start_batch(backend, runs)

    def start_batch(self, backend, runs):
        """Starts runs, and the process that makes their steps."""
        pairs = [socket.socketpair() for _ in runs]
        files = [ours.fileno() for ours, _ in pairs]
        out, error = tempfile.TemporaryFile(), tempfile.TemporaryFile()
        command = [*dies_with(f"= {os.getpid()}"), program.floe(), "-batch", backend,
                   *map(str, files)]
        popen = subprocess.Popen(command, env={**os.environ, **ENVIRONMENT}, stdout=out,
                                 stderr=error, stdin=subprocess.DEVNULL, start_new_session=True,
                                 pass_fds=[*self.locks, *files])
        batch = Batch(backend, runs, popen, out, error)
        self.batches.append(batch)
        self.note(batch)
        for ours, _ in pairs:
            ours.close()
        for run, (_, theirs) in zip(runs, pairs):
            with theirs:  # once only the run has it, its end says that the run has ended
                self.start(run, {"FLOE_BATCH": str(theirs.fileno())}, [theirs.fileno()])

    def end(self, process):
        if not isinstance(process, Batch):
            super().end(process)
            return
        code, _ = self.reap(process)
        self.batches.remove(process)
        process.out.seek(0)
        said = process.out.read().decode(errors="replace").strip()
        self.progress.say(f"batch: {said}" if code == 0 else
                          f"failed: batch: {last_words(process.error, process.out)}")
        process.out.close()
        process.error.close()

    def watch(self):
        for batch in self.batches:
            self.press(batch)
        super().watch()
        for batch in self.batches:  # one that hangs is no reason to wait for ever
            if any(run.name in self.running for run in batch.runs):
                batch.alone = 0.0
            elif not batch.alone:
                batch.alone = time.monotonic()
            elif time.monotonic() - batch.alone > single.GRACE:
                batch.popen.kill()

    def press(self, batch):
        """Where runs that were asked to stop take too long, one of them may hang, and all others
        wait for it: these are to go on without it, to their checkpoints."""
        now = time.monotonic()
        runs = [self.running[run.name] for run in batch.runs if run.name in self.running]
        asked = [process for process in runs if process.reason]
        if batch.pressed or all(now - process.asked <= single.GRACE for process in asked):
            return
        batch.pressed = True
        batch.popen.send_signal(signal.SIGUSR1)
        for process in asked:
            process.asked = now
