"""What the tools have in common: where floe and its scenes are, how a tool reads its command line and how it ends."""
import argparse
import os
import shutil
import sys
from pathlib import Path

TOOLS = Path(__file__).resolve().parent
HOME = TOOLS.parent  # the source tree, or share/floe of an installation: both hold tools/ and input/


def floe():
    """The floe that a tool runs: $FLOE (set by the floe that became the tool), else the one that belongs to the tool's
    folder, else the shell's."""
    given = os.environ.get("FLOE")
    belonging = [HOME / "build/release/floe", HOME.parent.parent / "bin/floe"]
    found = given or next((str(path) for path in belonging if path.is_file()), None) or shutil.which("floe")
    if not found or not shutil.which(found):
        sys.exit(f"floe {name()}: {f'$FLOE is {given}, which is no program' if given else 'floe is not built; run tools/setup first'}")
    return str(Path(shutil.which(found)).resolve())


def scene(path):
    """The path of a scene that comes with floe, as input/tension.yaml."""
    return str(HOME / path)


def name():
    """The tool's name, as in floe NAME."""
    return Path(sys.argv[0]).name


def parser(description, **options):
    """An argparse.ArgumentParser that calls the tool as its users do."""
    return argparse.ArgumentParser(prog=f"floe {name()}", description=description,
                                   formatter_class=argparse.RawDescriptionHelpFormatter, **options)


def run(main):
    """Ends the process by what main() returns; files that cannot be read or written are one line, and so is Ctrl-C."""
    try:
        sys.exit(main())
    except BrokenPipeError:  # its reader, as head, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        sys.exit(f"floe {name()}: {error}")
    except KeyboardInterrupt:
        sys.exit(f"floe {name()}: stopped")
