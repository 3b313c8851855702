"""Runs: stepping, coupling, looking at the present state."""
import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import library
from .errors import InputError
from .failures import RunFailed
from .force import Force
from .scene import Scene

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]


class Pose(NamedTuple):
    position: Floats  #: [m], (3,)
    orientation: Floats  #: rotation since time 0, w x y z, (4,)


class Motion(NamedTuple):
    velocity: Floats  #: [m/s], (3,)
    spin: Floats  #: world axes [rad/s], (3,)


class Wrench(NamedTuple):
    force: Floats  #: [N], (3,)
    moment: Floats  #: about the position of the pose [N m], (3,)


class Bodies(NamedTuple):
    """All bodies of the model, one row each, in the order of the lattice."""
    #: in the lattice; with supply the name that a body keeps, (n,)
    index: Integers  # type: ignore[assignment]
    position: Floats  #: of the centroids [m], (n, 3)
    orientation: Floats  #: rotation since rest, w x y z, (n, 4)
    velocity: Floats  #: [m/s], (n, 3); by leapfrog half a step before the time
    spin: Floats  #: world axes [rad/s], (n, 3); likewise
    mass: Floats  #: [kg], (n,)
    fragment: Integers  #: piece that unbroken beams join, the heaviest is 0, (n,)


class Beams(NamedTuple):
    """All beams of the model, one row each, in the order of the lattice."""
    bodies: Integers  #: rows of Bodies, (n, 2)
    force: Floats  #: N, Q2, Q3 in the middle, in the beam's mean axes [N], (n, 3)
    moment: Floats  #: T, M2, M3 likewise [N m], (n, 3)
    damage: Floats  #: 0 whole, 1 broken, (n,)

    @property
    def broken(self) -> NDArray[np.bool_]:
        """Whether a beam has broken, (n,)."""
        return self.damage >= 1


class Contacts(NamedTuple):
    """Contacts at the present state, one row each, sorted by bodies."""
    bodies: Integers  #: rows of Bodies; -1: an obstacle without mass, (n, 2)
    obstacle: Integers  #: number of the obstacle in Scene.obstacles; -1: none, (n,)
    force: Floats  #: on the first body [N], (n, 3)
    point: Floats  #: centroid of the overlap [m], (n, 3)
    normal: Floats  #: to the first body, (n, 3)
    volume: Floats  #: of the overlap [m^3], (n,)
    area: Floats  #: of the contact [m^2], (n,)


class State:
    """A state of a simulation in memory: Simulation.save()."""

    def __init__(self, state: Any, time: float):
        self._state = state
        self.time = time  #: [s]


class Obstacle:
    """An obstacle of a simulation: sim["cone"]. What it shows is of the present state."""

    def __init__(self, simulation: "Simulation", name: str):
        self._simulation = simulation
        self.name = name

    def _now(self) -> dict[str, Any]:
        return self._simulation._obstacles()[self.name]

    @property
    def pose(self) -> Pose:
        """Where it is: its point (of one with mass, the centre of mass), and its rotation since
        time 0. Collective."""
        now = self._now()
        return Pose(now["position"], now["orientation"])

    @property
    def velocity(self) -> Motion:
        """Velocity of that point and spin; of one with mass half a step before. Collective."""
        now = self._now()
        return Motion(now["velocity"], now["spin"])

    @property
    def wrench(self) -> Wrench:
        """What all bodies do to it, evaluated at the present state: the work of about a step, once
        per state. Collective."""
        now = self._now()
        return Wrench(now["force"], now["moment"])

    @property
    def impulse(self) -> Floats:
        """Integral of the force over the steps since time 0 [N s], (3,): differences over
        exchanges, divided by their time, are mean forces. Collective."""
        return self._now()["impulse"]

    def prescribe(self, pose: Pose | ArrayLike,
                  velocity: Motion | ArrayLike = (0.0, 0.0, 0.0),
                  until: float | None = None) -> None:
        """Moves an obstacle without mass, from the present time on.

        pose      Pose, or a position alone [m]: of its point
        velocity  Motion, or a velocity alone [m/s]
        until     none: it is there now and goes on with this velocity. A time [s]: it goes from its
                  present pose and velocity to these at that time, by cubics of time, and then goes
                  on with them.

        Collective. Raises InputError if the obstacle is not coupled or has a mass.
        """
        position, orientation = _both(pose, (1.0, 0.0, 0.0, 0.0), ("position", "orientation"))
        if not any(orientation):
            raise InputError(f"prescribe: orientation: {orientation} is no rotation: a quaternion "
                             "w x y z of length 1")
        speed, spin = _both(velocity, (0.0, 0.0, 0.0), ("velocity", "spin"))
        self._simulation._open().prescribe(self.name, position, orientation, speed, spin,
                                           None if until is None else _number(until, "until"))
        self._simulation._changed()

    def apply(self, force: ArrayLike, moment: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Loads an obstacle that has a mass, until the next call: force [N] and moment [N m] about
        its centre of mass, in world axes.

        Collective. Raises InputError if the obstacle is not coupled or has no mass.
        """
        self._simulation._open().apply(self.name, _numbers(force, 3, "force"),
                                       _numbers(moment, 3, "moment"))
        self._simulation._changed()

    def __repr__(self) -> str:
        return f"<obstacle {self.name!r}>"


class Simulation:
    """A run of a scene, which writes the scene's output folder as the program floe does.

        with floe.Simulation(scene) as sim:
            while sim.step_to(sim.time + 0.1):
                ...

    scene     a Scene, or what makes one
    coupled   names of obstacles that Python moves (prescribe) or, where they have a mass, loads
              (apply)
    forces    forces in Python: Force
    verbose   whether rank 0 prints the model, the plan and warnings, as the program does
    progress  whether rank 0 shows the progress of long calls, as the program does

    All methods and properties are collective: all ranks use them alike, and get the same. Leaving
    `with`, or close(), ends the run and frees its memory; an object that is merely dropped is freed
    with the next call on all ranks, once all have dropped it. Steps and coupling are bit for bit
    those of an undisturbed run as long as nothing is changed.

    Raises InputError if scene, files or folder cannot be used. Steps raise RunFailed if the run
    cannot go on, and KeyboardInterrupt (Ctrl-C) between two steps: then the simulation may go on.
    """

    def __init__(self, scene: Scene | str | os.PathLike | Mapping[str, Any], *,
                 coupled: Sequence[str] = (), forces: Sequence[Force] = (),
                 verbose: bool = False, progress: bool = False):
        library.start()
        self.scene = scene if isinstance(scene, Scene) else Scene(scene)
        self._results: dict[str, Any] | None = None
        self._kept: dict[str, Any] | None = None
        self._handle: Any = library.compiled.Run(self.scene._read, _names(coupled),
                                                 _checked(forces), verbose, progress, False)

    # -- steps
    def step_to(self, time: float) -> bool:
        """Steps to the first state at or after `time` [s], or to the end of the run. False: the run
        has ended. Raises RunFailed."""
        run = self._open()
        self._changed()
        goes_on = run.step_to(_number(time, "time", math.inf))
        if not goes_on:
            self._raise_failure()
        return goes_on

    def run(self, until: float | None = None, every: float | None = None) -> "Any":
        """Steps to `until` [s], or to the end of the run.

        every  none: all at once; returns the simulation. A time [s]: returns an iterator that steps
               on to each multiple of it, and yields the simulation there:
                   for _ in sim.run(every=0.5):
                       print(sim.time, sim.progress)
        Raises RunFailed.
        """
        end = math.inf if until is None else _number(until, "until", math.inf)
        if every is not None:
            period = _number(every, "every")
            if not period > 0:
                raise InputError(f"every: {every} must be > 0 [s]")
            return self._steps(end, period)
        self.step_to(end)
        return self

    def _steps(self, end: float, every: float) -> Iterator["Simulation"]:
        early = 1e-9
        while self.time < end - early * every:
            k = math.floor(self.time / every + early) + 1
            goes_on = self.step_to(min(k * every, end))
            yield self
            if not goes_on:
                return

    # -- times
    @property
    def time(self) -> float:
        """Time of the present state [s]."""
        return self._open().time()

    @property
    def dt(self) -> float:
        """Length of the last step or, before it, of the first one [s]."""
        run = self._open()
        run.prepare()
        return run.dt()

    @property
    def end(self) -> float:
        """Time at which the run ends [s]."""
        return self._open().end()

    @property
    def progress(self) -> float:
        """Part of the run that is done, 0 to 1."""
        return min(1.0, self.time / self.end)

    @property
    def ended(self) -> bool:
        """Whether the run has come to its end or failed."""
        return self._open().has_ended()

    @property
    def outcome(self) -> dict[str, Any]:
        """How the run ended, or stands: done, stopped (on request), message, steps, dt, stable_dt,
        limited_by, warnings."""
        return self._open().outcome()

    # -- the present state
    @property
    def bodies(self) -> Bodies:
        """All bodies, gathered from all ranks. The arrays are the reader's own."""
        return Bodies(*self._open().bodies())

    @property
    def beams(self) -> Beams:
        """All beams, gathered from all ranks. The arrays are the reader's own."""
        bodies, section, damage = self._open().beams()
        return Beams(bodies, section[:, :3], section[:, 3:], damage)

    @property
    def contacts(self) -> Contacts:
        """All contacts, gathered from all ranks; evaluates the forces. From the first call on their
        forces are kept in every step, which costs some per cent of it."""
        self._changed()
        return Contacts(*self._open().contacts())

    @property
    def columns(self) -> dict[str, float]:
        """Energies, forces on obstacles, counts: the columns of history.csv at the present state,
        apart from boundaries and loads; evaluates the forces."""
        return self._open().columns()

    @property
    def energies(self) -> dict[str, float]:
        """Energies and works [J], by names without "energy_": docs/model.md, "Files"."""
        return {name[7:]: value for name, value in self.columns.items()
                if name.startswith("energy_")}

    @property
    def obstacles(self) -> list[Obstacle]:
        """All obstacles of the scene."""
        return [Obstacle(self, name) for name in self._open().obstacle_names()]

    def __getitem__(self, name: str) -> Obstacle:
        """The obstacle of this name. Raises KeyError."""
        if name not in self._open().obstacle_names():
            raise KeyError(f"no obstacle '{name}' "
                           f"({', '.join(self._open().obstacle_names()) or 'the scene has none'})")
        return Obstacle(self, name)

    def _obstacles(self) -> dict[str, Any]:
        """What obstacles show, once per state."""
        if self._kept is None:
            self._kept = self._open().obstacles()
        return self._kept

    # -- back
    def save(self) -> State:
        """Keeps the present state in memory: for explicit runs by leapfrog."""
        run = self._open()
        return State(run.save(), run.time())

    def restore(self, state: State) -> None:
        """Goes back to a saved state of this simulation, also from the end of the run; rows and
        frames that were written since then are taken back too. The same steps from there have the
        same bits."""
        if not isinstance(state, State):
            raise InputError(f"restore: {state!r} is no state of save()")
        self._changed()
        self._open().restore(state._state)

    # -- end
    @property
    def results(self) -> dict[str, Any]:
        """Ends the run where it is and returns what it has written to summary.json."""
        if self._results is None:
            self._results = json.loads(self._open().results()[0] or "{}")
        return self._results

    def close(self) -> None:
        """Ends the run where it is, writes summary.json and frees all memory and the lock of the
        output folder. Does nothing a second time."""
        if self.closed:
            return
        try:
            _ = self.results
        finally:
            self._free()

    @property
    def closed(self) -> bool:
        """Whether the simulation is closed."""
        return self._handle is None

    def _free(self) -> None:
        self._changed()
        handle, self._handle = self._handle, None
        if handle is not None:
            handle.close()

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if kind is None:
            self.close()
        elif library.size() == 1 or isinstance(error, (RunFailed, KeyboardInterrupt)):
            self._free()  # its summary says that it was ended

    def __repr__(self) -> str:
        return (f"<floe.Simulation {self.scene.name!r}, "
                + ("closed>" if self.closed else f"{self.time:g} of {self.end:g} s>"))

    def _open(self) -> Any:
        if self._handle is None:
            raise ValueError("the simulation is closed")
        return self._handle

    def _changed(self) -> None:
        self._kept = None

    def _raise_failure(self) -> None:
        outcome = self._open().outcome()
        if not outcome["done"] and not outcome["stopped"] and outcome["message"]:
            raise RunFailed(outcome["message"])


def _number(value: Any, name: str, most: float = 0.0) -> float:
    """A number; with most = inf it may be infinite."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if math.isnan(number) or math.isinf(number) and not math.isinf(most):
        raise InputError(f"{name}: {value!r} must be a number [s]")
    return number


def _numbers(values: ArrayLike, count: int, name: str) -> list[float]:
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (count,) or not np.isfinite(array).all():
        raise InputError(f"{name}: {values!r} must be {count} finite numbers")
    return array.tolist()


def _both(values: Any, second: Sequence[float],
          names: tuple[str, str]) -> tuple[list[float], list[float]]:
    """A vector and what stands beside it, which may be left out."""
    if isinstance(values, (tuple, list)) and len(values) == 2 and np.ndim(values[0]) == 1:
        return _numbers(values[0], 3, names[0]), _numbers(values[1], len(second), names[1])
    return _numbers(values, 3, names[0]), list(second)


def _names(coupled: Any) -> list[str]:
    if isinstance(coupled, str) or not isinstance(coupled, Iterable):
        raise InputError(f"coupled: {coupled!r} must be a list of names of obstacles")
    return list(coupled)


def _checked(forces: Any) -> list[Force]:
    """Forces that can be asked."""
    if not isinstance(forces, Iterable):
        raise InputError(f"forces: {forces!r} must be a list of floe.Force")
    all_forces = list(forces)
    for force in all_forces:
        if not isinstance(force, Force) or type(force).add is Force.add:
            raise InputError(f"forces: {force!r} must be a floe.Force with a method "
                             "add(self, bodies)")
        for name in ("stiffness", "damping"):
            value = getattr(force, name)
            if not isinstance(value, (int, float)) or not 0 <= value < math.inf:
                raise InputError(f"forces: {type(force).__name__}: {name}: {value!r} must be a "
                                 "finite number >= 0")
    return all_forces
