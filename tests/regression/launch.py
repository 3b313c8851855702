"""How tests start floe on any number of ranks, whichever Open MPI is installed (4 or 5), and what
it says.

No test gives a run a time limit: ctest ends what hangs, after 20 minutes.
"""
import functools
import os
import re
import resource
import subprocess
import tempfile
import unittest
import zlib
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
# Of a run that is to be interrupted: it does not end by itself, however late that comes, and is not
# refused for that. The straight run that it is compared with ends by -ts_max_steps, and has this
# end as well: the step divides it.
ENDLESS = ("-time_end", "1e5", "-limit_frames", "1e12", "-limit_disk", "1e12")
FULL = os.environ.get("FLOE_FULL", "0") not in ("", "0")  # the long forms


def in_short_form(name, part):
    """Whether one of many cases like each other is in the short form, which has one of `part` of
    them, always the same ones."""
    return FULL or zlib.crc32(name.encode()) % part == 0


# What tools/env exports. Of a build with sanitizers: MPI and PETSc keep what they have until the
# process ends, and what is too large is refused as by any allocator.
ENVIRONMENT = {"ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1",
               # where the parts of solids are kept, not in the home of who runs the tests
               "XDG_CACHE_HOME": str(Path(tempfile.gettempdir()) / "floe_tests"), **os.environ,
               **dict(re.findall(r"^ *export (\w+)=(\S*)$", (REPOSITORY / "tools/env").read_text(),
                                 re.M))}

# What the launcher of Open MPI 5 adds to the errors of a run that fails: it has no way to keep it
# quiet.
BANNER = re.compile(r"^-{60,}\n(?:prterun |MPI_ABORT was invoked)(?:.*\n)*?-{60,}\n|^\[\S+:\d+\] "
                    r"PMIX ERROR: .*\n", re.M)

PROGRESS = re.compile(r"^(?:[\w ]+: +\d+ %(?:, \d+ s left)?  .*|stable step: iteration \d+)\n",
                      re.M)


class FolderTest(unittest.TestCase):
    """Each test has a temporary folder of its own."""

    def setUp(self):
        self.folder = temporary_folder(self.addCleanup)

    def end(self, process):
        """What is left of a test that failed."""
        if process.poll() is None:
            process.kill()
        process.wait()
        for stream in (process.stdout, process.stderr):
            if stream is not None:
                stream.close()


def temporary_folder(cleanup):
    """A folder that goes where `cleanup` (of a test or of its class) says, whatever still writes
    into it."""
    temporary = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
    cleanup(temporary.cleanup)
    return Path(temporary.name)


def on_ranks(ranks, command):
    """The command that runs `command` on this many ranks."""
    return [*(["mpiexec", "-n", str(ranks)] if ranks > 1 else []), *map(str, command)]


def own_words(error):
    """Standard error of a run, without what the launcher adds and without lines of progress, which
    come when a machine is slow."""
    # prterun (Open MPI 5) puts a zero byte beside what a rank said that has crashed.
    return PROGRESS.sub("", BANNER.sub("", error.replace("\0", "")))


@functools.cache
def limited_memory(gib):
    """A preexec_fn that limits a run's address space, of which floe takes 0.5 GiB. None for a build
    with sanitizers, which takes terabytes of it."""
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (gib << 30, gib << 30))
    works = subprocess.run([FLOE, "--version"], capture_output=True, env=ENVIRONMENT,
                           preexec_fn=limit).returncode == 0
    return limit if works else None


def run(*words, ranks=1, **how):
    """A finished run of floe, its standard error in its own words."""
    done = subprocess.run(on_ranks(ranks, [FLOE, *words]), capture_output=True, text=True,
                          env=ENVIRONMENT, **how)
    done.stderr = own_words(done.stderr)
    return done
