"""Many runs of floe at a time, the longest first (floe ensemble, floe campaign).

A run is a process of its own, which dies with the process that started it, so that none is left to
write into the folder when the same command goes on.
"""
import contextlib
import fcntl
import math
import os
import selectors
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

from floe import program
from floe.errors import InputError

GRACE = 60       # [s] that a run has for its checkpoint when it is asked to stop
STOPPED = 3      # floe's exit code with a checkpoint to go on from
# One thread per rank. Ranks of several runs must not be bound to the same cores, and processors may
# be more than Open MPI counts; the first name of each pair is that of release 4, the second of 5.
# Open MPI needs leave to run as root.
ENVIRONMENT = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
               "OMPI_MCA_hwloc_base_binding_policy": "none",
               "PRTE_MCA_hwloc_default_binding_policy": "none",
               "OMPI_MCA_rmaps_base_oversubscribe": "1",
               "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
               "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def dies_with(parent):
    """Words before a command that is killed when the process that starts it ends.

    parent: what the shell's PPID must be, as a comparison: if the starter has ended before setpriv
    (util-linux) asks for its death's signal, none comes, and the command is not run at all."""
    start = f'[ "$PPID" {parent} ] && exec "$@"'
    return ["setpriv", "--pdeathsig", "KILL", "sh", "-c", start, "sh"]


@dataclass
class Run:
    """One run. options: {key: value} of its command line, words: more words of it; cost: by which
    the longest comes first, in a unit that all runs share."""
    name: str
    scene: str
    options: dict
    words: tuple = ()
    cost: float = 1.0

    @property
    def mesh(self):
        """The mesh file that runs of one mesh share, or None: the first of them makes it."""
        return self.options.get("sheet_mesh_file")

    def command(self, output, ranks=1):
        given = [word for key, value in self.options.items() for word in (f"-{key}", f"{value}")]
        launcher = ["mpiexec", "-n", str(ranks), *dies_with("!= 1")] if ranks > 1 else []
        return [*dies_with(f"= {os.getpid()}"), *launcher, program.floe(), self.scene, *given,
                *self.words, "-output_dir", str(output)]


@dataclass
class Ended:
    """How a run ended: "done", "failed" or "stopped" (it can go on), with a message if not done;
    its exit code; the wall time [s] and the processor time of all ranks [s] of its last part."""
    status: str
    code: int
    message: str
    wall: float
    processor: float


@dataclass
class Process:
    """A run that is under way; files of what it says, and when and why it was asked to stop."""
    run: Run
    popen: subprocess.Popen
    out: object
    error: object
    started: float = field(default_factory=time.monotonic)
    asked: float = math.inf
    reason: str = ""


def processors():
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))


def clock(seconds):
    """A duration as floe writes it: "12 s", "3.4 min"."""
    for size, name, until in ((1, "s", 120), (60, "min", 7200), (3600, "h", 3 * 86400)):
        if seconds < until:
            return f"{round(seconds / size, 1 if size > 1 else 0):g} {name}"
    return f"{seconds / 86400:.3g} days"


def last_words(error, out):
    """The line that says why a run failed; launchers may add their own lines after floe's."""
    for file in (error, out):
        file.seek(0)
        lines = [line.strip() for line in file.read().decode(errors="replace").splitlines()]
        lines = [line for line in lines if line]
        if lines:
            return next((line for line in reversed(lines) if line.startswith("floe")), lines[-1])
    return "no message"


def write_whole(path, text):
    """Under another name first: neither a kill nor a power cut leaves a half-written file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(part, "w") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def locked(path, kind=fcntl.LOCK_EX, patience=2.0, what=None):
    """Holds a lock file while its block runs; its descriptor. Runs inherit it, so it is held until
    the last of them is gone. InputError, which names `what`, if another process holds it for
    `patience` [s]."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "a") as file:
        until = time.monotonic() + patience
        while True:
            try:
                fcntl.flock(file, kind | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > until:
                    raise InputError(f"{what or path.parent}: is in use by another "
                                     "process") from None
                time.sleep(0.02)
        yield file.fileno()


class Progress:
    """Runs that have ended and time left: a bar on a terminal, else a line every ten seconds in
    which something ends."""

    def __init__(self, runs, jobs):
        self.total, self.jobs = len(runs), jobs
        self.ended, self.failed = 0, 0
        self.spent, self.expected = 0.0, 0.0  # of the runs that are done: s, cost
        self.cost, self.cost_ended = sum(run.cost for run in runs), 0.0
        self.started = self.shown = time.monotonic()
        self.bar = sys.stderr.isatty()

    def count(self, run, ended):
        self.ended += 1
        self.failed += ended.status == "failed"
        self.cost_ended += run.cost
        if ended.status == "done":
            self.spent += ended.wall
            self.expected += run.cost

    def left(self, waiting, running, now):
        """Time [s] until all have ended: the costs that are left, by what a unit of cost has taken
        so far, or nan."""
        if self.expected == 0:
            return math.nan
        pace = self.spent / self.expected
        rest = [run.cost * pace for run in waiting]
        rest += [max(0.0, p.run.cost * pace - (now - p.started)) for p in running]
        return max([sum(rest) / self.jobs, *rest], default=0.0)

    def show(self, waiting, running, news):
        now = time.monotonic()
        last = news and self.ended == self.total
        if not (last or now - self.shown > 0.2 and self.bar or now - self.shown > 10 and news):
            return
        self.shown = now
        share = self.cost_ended / self.cost if self.cost else 1.0
        left = self.left(waiting, running, now)
        words = [f"{self.ended} of {self.total} runs", f"{self.failed} failed" * bool(self.failed),
                 f"{100 * share:.0f} %", clock(now - self.started),
                 f"about {clock(left)} left" if left > 0 else ""]
        line = ", ".join(word for word in words if word)
        if self.bar:
            done = int(30 * share)
            print(f"\r\033[K[{'#' * done}{' ' * (30 - done)}] {line}", end="", file=sys.stderr,
                  flush=True)
        else:
            print(line, file=sys.stderr, flush=True)

    def close(self):
        if self.bar:
            print(file=sys.stderr)

    def say(self, line):
        """A line of its own, above the bar."""
        print(f"\r\033[K{line}" if self.bar else line, file=sys.stderr, flush=True)


class Runner:
    """Runs many runs, `jobs` at a time, in folder/runs/NAME.

    finish(run, output, ended): called when a run has ended, takes from its output folder what is to
    be kept; may change `ended`. limit: wall time of a run [s] after which it is asked to stop,
    total: of all of them. locks: descriptors that runs inherit.
    """

    def __init__(self, folder, jobs, finish, ranks=1, limit=math.inf, total=math.inf, locks=()):
        self.folder, self.jobs, self.finish = folder, jobs, finish
        self.ranks, self.limit, self.total, self.locks = ranks, limit, total, locks
        self.waiting, self.running, self.results, self.stopping = [], {}, [], ""

    def perform(self, runs):
        """[(run, ended)] in the order in which they ended, without those that never started."""
        self.waiting = sorted(runs, key=lambda run: -run.cost)
        self.until = time.monotonic() + self.total
        self.progress = Progress(runs, self.jobs)
        with selectors.DefaultSelector() as self.selector, self.requests_to_stop():
            while self.under_way() or self.waiting and not self.stopping:
                if not self.stopping:
                    self.begin()
                ready = [key.data for key, _ in self.selector.select(0.25)]
                for process in ready:
                    self.end(process)
                self.watch()
                self.progress.show(self.waiting, self.running.values(), bool(ready))
        self.progress.close()
        return self.results

    @contextlib.contextmanager
    def requests_to_stop(self):
        """SIGINT, SIGTERM and SIGHUP ask all runs to stop with a checkpoint; a second one does not
        wait for them. In other threads than the main one, which get no signals, nothing does."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return

        def ask(number, _):
            if self.stopping:
                raise KeyboardInterrupt
            self.stopping = signal.Signals(number).name
        before = {number: signal.signal(number, ask)
                  for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def under_way(self):
        """Whether anything is to be waited for."""
        return bool(self.running)

    def begin(self):
        """Starts runs while there is room for them."""
        while len(self.running) < self.jobs:
            run = self.next()
            if run is None:
                return
            self.start(run)

    def next(self, suits=lambda run: True, beside=()):
        """The longest run that waits and suits, and whose mesh neither a run that is under way nor
        one of those beside it is making; None if there is none."""
        making = {run.mesh for run in beside}
        making |= {process.run.mesh for process in self.running.values()}
        for run in self.waiting:
            has_mesh = run.mesh is None or run.mesh not in making or Path(run.mesh).exists()
            if has_mesh and suits(run):
                self.waiting.remove(run)
                return run
        return None

    def start(self, run, environment={}, files=()):
        """Begins a run, or goes on from the checkpoint that its folder has.

        environment: further variables; files: descriptors that it inherits beside the locks."""
        output = self.folder / "runs" / run.name
        command = run.command(output, self.ranks)
        if any((output / name).exists() for name in ("checkpoint.h5", "checkpoint_previous.h5")):
            command += ["-checkpoint_restart", "auto"]
        else:
            shutil.rmtree(output, ignore_errors=True)
        output.parent.mkdir(parents=True, exist_ok=True)
        out, error = tempfile.TemporaryFile(), tempfile.TemporaryFile()
        # In a session of its own, so that Ctrl-C reaches it by our request only
        popen = subprocess.Popen(command, env={**os.environ, **ENVIRONMENT, **environment},
                                 stdout=out, stderr=error, stdin=subprocess.DEVNULL,
                                 start_new_session=True, pass_fds=[*self.locks, *files])
        process = Process(run, popen, out, error)
        self.running[run.name] = process
        self.note(process)

    def note(self, process):
        """Waits for a process beside the others."""
        self.selector.register(os.pidfd_open(process.popen.pid), selectors.EVENT_READ, process)

    def reap(self, process):
        """Exit code of a process that has ended, and the resources that it used."""
        handle = next(key.fd for key in self.selector.get_map().values() if key.data is process)
        self.selector.unregister(handle)
        os.close(handle)
        _, status, used = os.wait4(process.popen.pid, 0)
        process.popen.returncode = os.waitstatus_to_exitcode(status)
        return process.popen.returncode, used

    def end(self, process):
        """Takes a run that has ended out of those under way, and judges it."""
        code, used = self.reap(process)
        del self.running[process.run.name]
        ended = Ended("done", code, "", time.monotonic() - process.started,
                      used.ru_utime + used.ru_stime)
        if code != 0 and process.reason:
            ended.status, ended.message = "stopped", process.reason
        elif code == STOPPED:
            ended.status, ended.message = "stopped", last_words(process.error, process.out)
        elif code != 0:
            ended.status = "failed"
            how = f"exit code {code}" if code > 0 else f"ended by {signal.Signals(-code).name}"
            ended.message = f"{how}: {last_words(process.error, process.out)}"
        process.out.close()
        process.error.close()
        self.finish(process.run, self.folder / "runs" / process.run.name, ended)
        self.results.append((process.run, ended))
        self.progress.count(process.run, ended)
        if ended.status != "done":
            self.progress.say(f"{ended.status}: {process.run.name}: {ended.message}")

    def watch(self):
        """Asks runs to stop whose time is over, and all of them when the whole is to stop. mpiexec
        hands SIGUSR1 on to the ranks (docs/restarts.md)."""
        now = time.monotonic()
        if now > self.until:
            self.stopping = self.stopping or "limit: total"
        for process in self.running.values():
            reason = self.stopping or "limit: run" * (now - process.started > self.limit)
            if reason and not process.reason:
                process.reason, process.asked = f"by {reason}", now
                process.popen.send_signal(signal.SIGUSR1)
            elif now - process.asked > GRACE:
                process.popen.kill()
