"""What the tests that drive the program share: where it is, how it is started, what it says.

No test gives a run a time limit: ctest ends what hangs, after 20 minutes and with all its processes.
"""
import os
import re
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
FULL = os.environ.get("FLOE_FULL", "0") not in ("", "0")  # the long forms

PROGRESS = re.compile(r"[\w ]+: +\d+ %, \d+ s left  .*\n")


def environment():
    """This process's, and what tools/env exports: MPI in containers and on few cores."""
    lines = subprocess.run(["bash", "-c", f". '{REPOSITORY}/tools/env' && env -0"], check=True,
                           capture_output=True, text=True).stdout
    return dict(line.split("=", 1) for line in lines.split("\0") if line)


ENVIRONMENT = environment()


def command(*words, ranks=1):
    """The words that run floe on so many ranks."""
    mpi = ["mpiexec", "-q", "-n", str(ranks)] if ranks > 1 else []
    return [*mpi, str(FLOE), *map(str, words)]


def without_progress(text):
    """What a run said on standard error but for lines of its progress, which come when a machine is slow."""
    return PROGRESS.sub("", text)


def run(*words, ranks=1, **how):
    """A finished run of floe, its standard error without progress."""
    done = subprocess.run(command(*words, ranks=ranks), capture_output=True, text=True, env=ENVIRONMENT, **how)
    done.stderr = without_progress(done.stderr)
    return done
