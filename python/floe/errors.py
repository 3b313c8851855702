"""Errors that a user can put right, and how readers of files raise them."""
import contextlib
import csv
from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import Any


class InputError(ValueError):
    """What the user can put right: a folder, a file, an argument, a key. The text is one line. Of a
    command it is the last line, and the exit code is 2."""


@contextlib.contextmanager
def reading(path: str | PathLike) -> Iterator[None]:
    """Whatever is wrong with a file while it is read becomes InputError, which names it."""
    try:
        yield
    except InputError:
        raise
    except (OSError, LookupError, ValueError, TypeError, RuntimeError, csv.Error) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"{path}: cannot be read: {' '.join(why.split())}") from error


def path_of(what: str, value: Any) -> Path:
    """A path that an argument gives. InputError names the argument if it is no path."""
    if not isinstance(value, (str, PathLike)) or not fspath(value):
        raise InputError(f"{what}: {value!r} must be a path")
    return Path(value)
