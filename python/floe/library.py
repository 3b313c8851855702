"""The compiled library, and what a process has of it once: MPI, PETSc.

MPI is initialised with the first scene or simulation, unless it is already (`from mpi4py import
MPI`). When Python ends, simulations that are left are ended, then PETSc, then MPI if it was
initialised here.
"""
import atexit
import sys

try:
    from . import _floe as compiled
except ImportError as error:
    if "_floe" not in str(error) or "circular" in str(error):
        raise
    raise ImportError(f"floe's compiled module is not there ({error}): install python3-floe, or "
                      "build floe with python3-dev and pybind11-dev; reading results (floe.open) "
                      "works without") from error

_started = False


def start():
    """Starts MPI, if nobody has, and PETSc, once. Collective."""
    global _started
    if _started:
        return
    compiled.start()
    _started = True
    atexit.register(compiled.finish)
    if compiled.size() > 1:
        _end_all_ranks_on_errors()


def _end_all_ranks_on_errors():
    """What ends one rank ends all: the others would wait for it for ever."""
    before = sys.excepthook

    def end(kind, error, trace):
        before(kind, error, trace)
        sys.stdout.flush()
        sys.stderr.flush()
        compiled.abort(1)

    sys.excepthook = end


def rank() -> int:
    """Rank of this process, from 0."""
    start()
    return compiled.rank()


def size() -> int:
    """Number of ranks."""
    start()
    return compiled.size()


def version() -> str:
    """Version of the library."""
    return compiled.version()
