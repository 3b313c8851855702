"""Ensembles that are run: floe ensemble, floe.run_ensemble."""
from __future__ import annotations

import contextlib
import fcntl
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from floe.ensembles import specs
from floe.ensembles.batches import BatchRunner, backend_of, most
from floe.ensembles.runs import locked, processors
from floe.errors import InputError, path_of

if TYPE_CHECKING:
    from floe.run import Ensemble


def jobs_of(spec: specs.Spec) -> int:
    """Runs at a time that the processors have room for."""
    return max(1, processors() // spec.ranks)


@dataclass
class Room:
    """How many runs there may be at a time: `jobs` on processors, `batch` on a device, all of which
    are in one batch. backends: {name of a run: its back end}."""
    jobs: int
    batch: int
    backends: dict[str, str]

    def __str__(self) -> str:
        kinds = {name == "cpu" for name in self.backends.values()}
        words = [f"{self.jobs} at a time"] * (True in kinds or not kinds)
        words += [f"{self.batch} in a batch"] * (False in kinds)
        return ", ".join(words)


def room_of(folder: specs.Folder, runs: Sequence[Any], jobs: int | None) -> Room:
    """The room for runs that have been planned; jobs: as the user wants it."""
    backends = {run.name: backend_of(run) for run in runs}
    memory = max((folder.memory.get(run.group(folder.spec.seed_keys)) or 0 for run in runs
                  if backends[run.name] != "cpu"), default=0)
    return Room(jobs or jobs_of(folder.spec), jobs or most(memory), backends)


def chosen(folder: specs.Folder, only: Sequence[str], option: str = "only") -> list[Any]:
    """The runs of these names, all if there are none. InputError, which names the option, for
    others."""
    if not only:
        return folder.runs
    known = {run.name: run for run in folder.runs}
    for name in only:
        if name not in known:
            raise InputError(f"{option}: '{name}' is no run of {folder.spec.name}; there "
                             f"are {folder.runs[0].name} to {folder.runs[-1].name} "
                             "(--check lists them)")
    return [known[name] for name in only]


@contextlib.contextmanager
def holding(folder: specs.Folder, some: Sequence[Any] = ()) -> Iterator[list[int]]:
    """Holds the folder while its block runs; descriptors of the locks.

    some: runs of their own, beside others of the same ensemble (tasks of an array)."""
    with contextlib.ExitStack() as stack:
        shared = fcntl.LOCK_SH if some else fcntl.LOCK_EX
        locks = [stack.enter_context(locked(folder.path / ".lock", shared))]
        for run in some:
            locks.append(stack.enter_context(locked(folder.path / f".lock_{run.name}",
                                                    what=f"run {run.name}")))
        yield locks


def perform(folder: specs.Folder, runs: Sequence[Any], jobs: int | None,
            locks: Sequence[int]) -> tuple[int, str]:
    """Runs what is not done, with its progress on standard error. Exit code of floe ensemble, and
    by what all was stopped: a signal, a limit, or nothing ("").

    jobs: runs at a time; None: as many as there is room for"""
    waiting = [run for run in runs if not folder.finished(run)]
    room = room_of(folder, waiting, jobs)
    print(f"{len(runs)} runs, {len(runs) - len(waiting)} of them finished before, {room}",
          file=sys.stderr)
    if not folder.make(waiting, room.jobs, locks):
        print("files are still to be made: the same command goes on", file=sys.stderr)
        return 3, "signal"
    written = time.monotonic()

    def finish(run: Any, output: Path, ended: Any) -> None:
        nonlocal written
        folder.keep(run, output, ended)
        if time.monotonic() - written > 5:
            folder.collect()
            written = time.monotonic()
    spec = folder.spec
    room = room_of(folder, waiting, jobs)  # of runs whose files have just been made too
    runner = BatchRunner(folder.path, room.jobs, finish, room.backends, room.batch, spec.ranks,
                         spec.limit, spec.total, locks)
    ended = runner.perform(waiting)
    folder.collect()
    states = [how.status for _, how in ended]
    if "stopped" in states or len(ended) < len(waiting):
        print(f"{states.count('done')} runs are done, {len(waiting) - states.count('done')} are "
              "not: the same command goes on", file=sys.stderr)
        return 3, runner.stopping
    return (1 if "failed" in states else 0), ""


def plain(value: Any) -> Any:
    """A spec of dicts as one that was read from YAML: of dicts, lists, texts and Python's own
    numbers."""
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):  # of numpy
        return value.tolist()
    return [plain(one) for one in value] if isinstance(value, (list, tuple, range)) else value


def run_ensemble(spec: str | os.PathLike[str] | Mapping[str, Any],
                 folder: str | os.PathLike[str] | None = None, *, jobs: int | None = None,
                 only: Sequence[str] = ()) -> Ensemble:
    """Runs one scene many times, as `floe ensemble` does (docs/ensembles.md), and returns the
    Ensemble.

    spec    path of a spec's file, or nested dicts with the same keys, whose paths count from the
            current folder: {"scene": "cone.yaml", "seeds": 10}
    folder  results (default: the spec's output, else out/ensemble_SPEC)
    jobs    runs at a time (default: processors over ranks per run; with a back end other than
            cpu as many in one batch as there is memory for, at most 64)
    only    names of runs, which alone are run (default: all)

    Runs that are done are kept, others go on from their checkpoint or begin anew. A run that fails
    is a line on standard error, and its status is in Ensemble.table; it does not stop the rest.
    Each run is a process of its own, of the program floe: that of $FLOE, the one that was installed
    with the package, or the shell's. Called by one process, which mpiexec has not started.

    Raises InputError with one line for a bad spec, or a folder that is in use or holds something
    else; KeyboardInterrupt (Ctrl-C) when all runs have stopped with a checkpoint."""
    from floe.run import Ensemble
    if "OMPI_COMM_WORLD_SIZE" in os.environ:
        raise InputError("run_ensemble: starts runs of its own (`ranks` of the spec); call it "
                         "without mpiexec")
    if isinstance(spec, Mapping):
        read = specs.checked(plain(spec), "ensemble", "spec", Path())
    else:
        read = specs.read(path_of("spec", spec))
    if folder is not None:
        folder = path_of("folder", folder)
    if jobs is not None and not (isinstance(jobs, int) and jobs >= 1):
        raise InputError(f"jobs: {jobs!r} must be a whole number of at least 1")
    if isinstance(only, str):
        raise InputError(f"only: {only!r} must be a list of names")
    found = specs.Folder(folder if folder is not None else read.output, read)
    runs = chosen(found, only)
    found.compare()
    found.plan(jobs or jobs_of(read))
    with holding(found, runs if only else ()) as locks:
        found.record()
        _, stopped = perform(found, runs, jobs, locks)
    if stopped and stopped != "limit: total":
        raise KeyboardInterrupt
    return Ensemble(found.path)
