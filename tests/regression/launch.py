"""How tests start floe on any number of ranks, whichever Open MPI is installed (4 or 5)."""
import os
import re
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]

# What tools/env exports.
ENVIRONMENT = {**os.environ, **dict(re.findall(r"^ *export (\w+)=(\S*)$", (REPOSITORY / "tools/env").read_text(), re.M))}

# What the launcher of Open MPI 5 adds to the errors of a run that fails: it has no way to keep it quiet.
BANNER = re.compile(r"^-{60,}\n(?:prterun |MPI_ABORT was invoked)(?:.*\n)*?-{60,}\n|^\[\S+:\d+\] PMIX ERROR: .*\n", re.M)


def on_ranks(ranks, command):
    """The command that runs `command` on this many ranks."""
    return [*(["mpiexec", "-n", str(ranks)] if ranks > 1 else []), *map(str, command)]


def own_words(error):
    """Standard error of a run, without what the launcher adds."""
    return BANNER.sub("", error)
