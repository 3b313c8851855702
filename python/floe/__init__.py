"""floe, a simulator of floating sea ice: what its runs have written.

    run = floe.open("out/ice_cone")
    run.history["cone_force_x"].plot()
"""
from .errors import InputError

__all__ = ["InputError", "open"]


def open(folder):  # noqa: A001
    """The results in an output folder, or in the folder of an ensemble: floe.run.Run."""
    from .run import open_run
    return open_run(folder)
