"""Errors that a user can put right."""


class InputError(ValueError):
    """What the user can put right: a folder, a file, an argument, a key. The text is one line. Of a
    command it is the last line, and the exit code is 2."""
