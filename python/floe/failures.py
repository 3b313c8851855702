"""Errors of runs, raised alike on all ranks."""


class RunFailed(RuntimeError):
    """A run cannot go on: a velocity or the energy balance has passed its limit, a file cannot be
    written. The text is one line, which summary.json has as well."""


class CallbackError(RuntimeError):
    """A force in Python has raised an exception on another rank. The rank that had it gets its own
    exception. The run has paused before the step and may go on."""
