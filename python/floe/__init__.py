"""floe, a simulator of floating sea ice as rigid bodies joined by beams.

    import floe

    scene = floe.Scene("input/ice_cone.yaml", sheet_seed=3)
    with floe.Simulation(scene) as sim:
        for _ in sim.run(every=1.0):
            print(sim.time, sim["cone"].wrench.force)
    run = floe.open(scene.output)

docs/python.md describes all of it. Reading results needs neither MPI nor the compiled library.
"""
import importlib
from typing import TYPE_CHECKING

from .errors import InputError
from .failures import CallbackError, RunFailed

if TYPE_CHECKING:
    import os

    from .ensembles.performing import run_ensemble
    from .force import Force
    from .library import rank, size, version
    from .run import Run
    from .scene import Option, Scene, options
    from .simulation import Motion, Pose, Simulation, State, Wrench

__all__ = ["CallbackError", "Force", "InputError", "Motion", "Option", "Pose", "RunFailed",
           "Scene", "Simulation", "State", "Wrench", "open", "options", "rank", "run_ensemble",
           "size", "version"]

_HOMES = {"Scene": "scene", "options": "scene", "Option": "scene", "Simulation": "simulation",
          "Pose": "simulation", "Motion": "simulation", "Wrench": "simulation",
          "State": "simulation",
          "Force": "force", "run_ensemble": "ensembles.performing", "rank": "library",
          "size": "library", "version": "library"}


def __getattr__(name):
    if name in _HOMES:
        value = getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'floe' has no attribute '{name}'")


def __dir__():
    return sorted({*globals(), *_HOMES})


def open(folder: "str | os.PathLike[str]") -> "Run":  # noqa: A001
    """The results in an output folder, or in the folder of an ensemble: floe.run.Run."""
    from .run import open_run
    return open_run(folder)
