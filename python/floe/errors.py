"""Errors that a user can put right, and how readers of files raise them."""
import contextlib
import csv
from collections.abc import Iterator
from os import PathLike


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
