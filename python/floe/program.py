"""What the tools have in common: where floe and its scenes are, how a tool reads its command line
and how it ends."""
import argparse
import contextlib
import errno
import os
import shutil
import sys
from pathlib import Path

from floe.errors import InputError

# A path that the user can put right; others, as a full disk, are failures.
NOT_THERE = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EACCES, errno.EPERM, errno.EROFS,
             errno.ENAMETOOLONG)


def home():
    """The folder that holds tools/ and input/: the source tree, or share/floe of a build folder or
    of an installation, whether the package is there or among Python's own."""
    above = Path(__file__).resolve().parents[2:]
    places = [above[0], *(folder / "share/floe" for folder in above[:3])]
    return next((place for place in places if (place / "tools").is_dir()), above[0])


HOME = home()
TOOLS = HOME / "tools"


def floe():
    """The floe that a tool runs: $FLOE (set by the floe that became the tool), else the one that
    belongs to the package's folder, else the shell's. InputError if there is none."""
    given = os.environ.get("FLOE")
    belonging = [Path(__file__).absolute().parents[2] / "floe",  # in a build folder
                 HOME / "build/release/floe", HOME.parent.parent / "bin/floe"]
    found = given or next((str(path) for path in belonging if path.is_file()),
                          None) or shutil.which("floe")
    if not found or not shutil.which(found):
        reason = (f"$FLOE is {given}, which is no program" if given else
                  "floe is not built; run tools/setup first")
        raise InputError(reason)
    return str(Path(shutil.which(found)).resolve())


def scene(path):
    """The path of a scene that comes with floe, as input/tension.yaml."""
    return str(HOME / path)


def name():
    """The tool's name, as in floe NAME."""
    return Path(sys.argv[0]).name


class Parser(argparse.ArgumentParser):
    """Says what is wrong with a command line in one line."""

    def error(self, message):
        self.exit(2, f"{self.prog}: {' '.join(message.split())} ({self.prog} --help)\n")


def parser(description, **options):
    """A parser that calls the tool as its users do."""
    return Parser(prog=f"floe {name()}", description=description,
                  formatter_class=argparse.RawDescriptionHelpFormatter,
                  **options)


# Of what Python imports: the Debian package that has it, where the names differ.
DEBIAN = {"netCDF4": "python3-netcdf4"}


def missing(error):
    """The line about a module that is not installed, with its package."""
    module = (error.name or "").split(".")[0]
    package = DEBIAN.get(module, f"python3-{module}")
    return f"needs Python's {module}: apt-get install {package} (tools/setup does it)"


@contextlib.contextmanager
def packages():
    """Around imports of what floe itself does without: what is missing ends the tool by one line
    that names its package."""
    try:
        yield
    except ModuleNotFoundError as error:
        print(f"floe {name()}: {missing(error)}", file=sys.stderr)
        sys.exit(2)


def draws():
    """Of a tool that draws into files: matplotlib, imported later, opens no window."""
    os.environ["MPLBACKEND"] = "Agg"


# What matplotlib writes.
PICTURES = ("eps", "jpeg", "jpg", "pdf", "png", "ps", "svg", "tif", "tiff", "webp")


def picture(text, known=PICTURES):
    """An argparse type: a file to draw into, whose ending is known and whose folder is there."""
    path = Path(text)
    if path.suffix[1:] not in known:
        endings = f"{'one of ' if len(known) > 1 else ''}.{', .'.join(known)}"
        raise argparse.ArgumentTypeError(f"'{text}' must end in {endings}")
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f"'{path.parent}' is no folder")
    return text


def count(text):
    """A whole number of at least 1, as argparse's type."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{number} is not at least 1")
    return number


count.__name__ = "whole number"


def between(low, high, kind=float):
    """An argparse type: a number from low to high."""
    def read(text):
        number = kind(text)
        if not low <= number <= high:
            raise argparse.ArgumentTypeError(f"{text} is not within {low:g} to {high:g}")
        return number
    read.__name__ = "whole number" if kind is int else "number"
    return read


def numbers(kind, least):
    """An argparse type: numbers of at least `least`, separated by commas."""
    def read(text):
        found = [kind(word) for word in text.split(",")]
        if min(found) < least:
            raise argparse.ArgumentTypeError(f"{min(found)} is not at least {least}")
        return found
    read.__name__ = "list of numbers"
    return read


def run(main):
    """Ends the process by what main() returns; files that cannot be read or written are one line,
    and so is Ctrl-C."""
    try:
        sys.exit(main())
    except ModuleNotFoundError as error:  # imported where it is used
        print(f"floe {name()}: {missing(error)}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:  # its reader, as head, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except InputError as error:
        print(f"floe {name()}: {error}", file=sys.stderr)
        sys.exit(2)
    except OSError as error:
        print(f"floe {name()}: {error}", file=sys.stderr)
        sys.exit(2 if error.errno in NOT_THERE else 1)
    except KeyboardInterrupt:
        sys.exit(f"floe {name()}: stopped")
