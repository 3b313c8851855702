"""Results of runs and of ensembles as a Python program wants them (docs/python_results.md).

    run = floe.open("out/ice_cone")
    run.history["cone_force_x"].max()                  # pandas, by the time [s]
    run.fields["displacement"].isel(time=-1).values    # xarray, read when it is asked for

Also of a run that is under way: each attribute is of what is there when it is asked for. SI units.
"""
from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from floe.errors import InputError, reading, path_of
from floe.results.output import Lattice, Output, has_changes, options_of, summary_of

if TYPE_CHECKING:
    import pandas
    import xarray

    from floe.plots import EnsemblePlots, Plots
    from floe.results.pressure import Patches

BREAKS = {"mode_mix": "1", "energy": "J", "nominal_energy": "J", "brittle": "1"}


def stamp(path: Path) -> tuple[int, ...]:
    """Changes when a file or the entries of a folder change; empty while it is not there."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_mtime_ns, found.st_size, found.st_ino


def number_of(text: str) -> Any:
    """A value of options.yaml as a bool, an int or a float if it is one, else as text."""
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


class Run:
    """The results in an output folder: floe.open(folder).

    Values are those of the files, at once: those of a run that is under way grow. What has been
    read is kept until its file changes. InputError where a file is not there (yet) or damaged."""

    def __init__(self, folder: str | Path):
        self.folder = Path(folder)
        self._kept: dict[str, tuple[Any, Any]] = {}

    def __repr__(self) -> str:
        if is_ensemble(self.folder):
            return f"<floe.Run {self.folder}: {len(self.ensemble)} runs of an ensemble>"
        return f"<floe.Run {self.folder}: {self.status}>"

    def _current(self, name: str, files: list[str], read: Callable[[], Any]) -> Any:
        """What `read` returns, read anew when one of the files has changed."""
        if is_ensemble(self.folder):
            raise InputError(f"{self.folder}: is the folder of an ensemble, whose runs are "
                             "floe.open(folder).ensemble[name]")
        now = [stamp(self.folder / file) for file in files]
        if name not in self._kept or self._kept[name][0] != now:
            self._kept[name] = now, read()
        return self._kept[name][1]

    # -- what the run was -------------------------------------------------------------------------

    @property
    def summary(self) -> dict[str, Any]:
        """summary.json as a dictionary; empty until the run has ended."""
        return self._current("summary", ["summary.json"], lambda: summary_of(self.folder))

    @property
    def status(self) -> str:
        """How the run ended: done, failed or stopped; "under way" before (or killed)."""
        return self.summary.get("status", "under way")

    @property
    def options(self) -> dict[str, Any]:
        """Every option as used, {"sheet_thickness": 0.5, ...}; lists are texts."""
        return self._current("options", ["options.yaml"], lambda: {
            key: number_of(text) for key, text in options_of(self.folder).items()})

    @property
    def obstacles(self) -> list[str]:
        """Names of the obstacles whose forces history.csv has."""
        from floe.results.tables import obstacles_of
        return obstacles_of(self.history)

    def one_or_all(self, obstacle: str | None) -> list[str]:
        """The obstacle, or all of them. InputError if there is none, or none of this name."""
        names = self.obstacles
        if not names:
            raise InputError(f"{self.folder}: the scene has no obstacles")
        if obstacle is not None and obstacle not in names:
            raise InputError(f"no obstacle {obstacle} (known: {', '.join(names)})")
        return names if obstacle is None else [obstacle]

    # -- tables -----------------------------------------------------------------------------------

    @property
    def history(self) -> pandas.DataFrame:
        """history.csv with the time [s] as index; attrs["units"] has the unit of each column."""
        def read() -> pandas.DataFrame:
            from floe.results import tables
            table = tables.history(self.folder).set_index("time")
            table.attrs["units"] = {name: tables.unit_of(name) for name in ["time", *table]}
            return table
        return self._current("history", ["history.csv"], read)

    @property
    def breaks(self) -> pandas.DataFrame:
        """The beams that have broken, by the time [s]: the names body_a, body_b of their bodies,
        their index `beam` in lattice.h5, place x, y, z [m] at that time, mode_mix, energy and
        nominal_energy [J], brittle. attrs["units"] has the units. No rows if nothing can break.

        Where ice joins and leaves, `beam` is -1, and of beams of bodies that have left only bodies
        and time are known, the time to the frame."""
        return self._current("breaks", ["breaks.h5", "fields"], lambda: breaks_of(self.output))

    @property
    def fragments(self) -> pandas.DataFrame:
        """The pieces of the ice at the end, the heaviest first: mass [kg], bodies (their number).
        No rows if nothing can break."""
        def read() -> pandas.DataFrame:
            import pandas

            from floe.results import breakage
            found = breakage.at_end(self.output)
            table = pandas.DataFrame({name: found.get(f"fragments/{name}", [])
                                      for name in ("mass", "bodies")})
            table.attrs["units"] = {"mass": "kg", "bodies": "1"}
            return table
        return self._current("fragments", ["breaks.h5", "fields"], read)

    @property
    def pressure(self) -> dict[str, Patches]:
        """Forces on the patches of each obstacle, {name: floe.results.pressure.Patches}, of a scene
        with `output: pressure`."""
        def read() -> dict[str, Patches]:
            from floe.results import pressure
            return pressure.read(self.folder)
        return self._current("pressure", ["pressure.csv"], read)

    # -- bodies and beams -------------------------------------------------------------------------

    @property
    def lattice(self) -> Lattice:
        """Bodies and beams at rest, of lattice.h5: position (n, 3) [m], orientation (n, 4), mass
        (n) [kg], beams and sets (dictionaries of arrays), shapes, obstacles."""
        return self._current("lattice", ["lattice.h5"],
                             lambda: Lattice(self.folder / "lattice.h5"))

    @property
    def output(self) -> Output:
        """The frames one by one (floe.results.output.Output), as those are that are there now."""
        return self._current("output", ["lattice.h5", "fields", "summary.json"],
                             lambda: Output(self.folder))

    @property
    def times(self) -> np.ndarray:
        """Times of the frames [s]."""
        return self.output.times

    @property
    def fields(self) -> xarray.Dataset:
        """The frames over time, body, beam, axis: position, displacement [m], rotation [rad],
        fragment, and of beams force, moment, stresses, damage (floe.results.frames). Lazy, by dask:
        nothing is read until values are asked for."""
        def read() -> xarray.Dataset:
            from floe.results import frames
            return frames.dataset_of(self.output)
        return self._current("fields", ["lattice.h5", "fields"], read)

    def to_pyvista(self, time: float | None = None) -> Any:
        """The bodies at the frame nearest to `time` (None: the last) as a pyvista.PolyData of their
        faces, with body, displacement [m] and fragment per face. ImportError without pyvista."""
        try:
            import pyvista
        except ImportError as error:
            raise ImportError("to_pyvista needs the package pyvista: pip install pyvista "
                              "(floe vtkhdf writes files for ParaView without it)") from error
        return polygons_of(self.output, time, pyvista)

    # -- what follows from them -------------------------------------------------------------------

    def loads(self, obstacle: str | None = None, **settings: Any) -> dict[str, Any]:
        """The load on an obstacle as `floe loads` states it (docs/loads.md): mean, maxima, Gumbel's
        law with its bands, peaks, spectrum, as a dictionary of numbers.

        settings: component ("horizontal", "x", "y", "z", "total"), filter ("mean:0.5",
        "low-pass:2", "structure:2:0.05", "none"), start [s], block [s], probabilities, hours."""
        from floe.loads import statements
        names = self.one_or_all(obstacle)
        if len(names) > 1:
            raise InputError(f"{self.folder}: has several obstacles, name one of "
                             f"{', '.join(names)}")
        return statements.state([statements.read_run(self.folder)], names[0],
                                statements.settings_of(**settings))

    @cached_property
    def plot(self) -> Plots:
        """Pictures: run.plot.load(), .energies(), .sheet(), .fragments() (floe.plots.Plots)."""
        from floe.plots import Plots
        return Plots(self)

    @cached_property
    def ensemble(self) -> Ensemble:
        """The runs in the folder of an ensemble. InputError if it is none."""
        return Ensemble(self.folder)


class Ensemble(Mapping[str, Run]):
    """The runs of an ensemble by their names: ensemble["s001"].history.

    Of a folder of `floe ensemble` all runs that have begun; of another one, the runs below it that
    have ended."""

    def __init__(self, folder: str | Path):
        self.folder = Path(folder)
        if not is_ensemble(self.folder):
            raise InputError(f"{self.folder}: is the output folder of one run, no ensemble's")
        self._runs: dict[str, Run] = {}

    def _folders(self) -> dict[str, Path]:
        if (self.folder / "ensemble.json").exists():
            every = {name: self.folder / "runs" / name for name in self._recorded()}
            return {name: path for name, path in every.items() if is_run(path)}
        found = runs_below(self.folder)
        alike = len({path.name for path in found}) < len(found)
        return {str(path.relative_to(self.folder)) if alike else path.name: path for path in found}

    def _recorded(self) -> dict[str, Any]:
        path = self.folder / "ensemble.json"
        with reading(path):
            return json.loads(path.read_text())["runs"]

    def __getitem__(self, name: str) -> Run:
        folders = self._folders()
        if name not in folders:
            raise KeyError(f"{self.folder}: has no run {name}")
        return self._runs.setdefault(name, Run(folders[name]))

    def __iter__(self) -> Iterator[str]:
        return iter(self._folders())

    def __len__(self) -> int:
        return len(self._folders())

    def __repr__(self) -> str:
        return f"<floe.Ensemble {self.folder}: {len(self)} runs>"

    @property
    def table(self) -> pandas.DataFrame:
        """A row for each run, by its name: what is varied, seed, status, times, and the numbers of
        its summary, as runs.csv has them."""
        import pandas

        from floe.ensembles import specs
        from floe.loads import statements
        if (self.folder / "ensemble.json").exists():
            runs = [(name, run["parameters"], run["seed"],
                     specs.read_result(self.folder / "results" / f"{name}.json"))
                    for name, run in self._recorded().items()]
        else:
            varied = statements.differing([run.options for run in self.values()])
            runs = [(name, {key: run.options.get(key, "") for key in varied},
                     run.options.get("sheet_seed"),
                     {"status": run.status, "message": run.summary.get("message", ""),
                      "wall_s": run.summary.get("wall_s", ""), "processor_s": "",
                      "results": specs.scalars(run.summary)}) for name, run in self.items()]
        head, *rows = specs.table_of(runs)
        table = pandas.DataFrame(rows, columns=head).set_index("run")
        return table.replace("", np.nan).infer_objects() if len(table) else table

    def loads(self, obstacle: str | None = None, **settings: Any) -> list[dict[str, Any]]:
        """The load on an obstacle, of all runs together that are done: a statement for each group
        of runs that differ in their seeds only, with its "parameters"; settings as of Run.loads."""
        from floe.loads import statements
        chosen = statements.settings_of(**settings)
        runs, _ = statements.find_runs([self.folder])
        names = list(runs[0].forces)
        if obstacle is None and len(names) > 1:
            raise InputError(f"{self.folder}: has several obstacles, name one of "
                             f"{', '.join(names)}")
        return [statements.state(group, obstacle or names[0], chosen) | {"parameters": parameters}
                for parameters, group in statements.groups(runs)]

    @cached_property
    def plot(self) -> EnsemblePlots:
        """Pictures: ensemble.plot.exceedance() (floe.plots.EnsemblePlots)."""
        from floe.plots import EnsemblePlots
        return EnsemblePlots(self)


def is_run(folder: Path) -> bool:
    """Whether a folder is the output folder of a run that has begun."""
    return any((folder / name).exists() for name in ("history.csv", "lattice.h5"))


def runs_below(folder: Path) -> list[Path]:
    """Output folders below, of runs that have ended."""
    return sorted(path.parent for path in folder.rglob("summary.json")
                  if (path.parent / "options.yaml").exists())


def is_ensemble(folder: Path) -> bool:
    """Whether a folder is that of an ensemble, or a folder of runs that have ended."""
    return (folder / "ensemble.json").exists() or not is_run(folder) and bool(runs_below(folder))


def open_run(folder: str | os.PathLike[str]) -> Run:
    """The results in an output folder, or in the folder of an ensemble (Run.ensemble). InputError
    if it is neither."""
    path = path_of("folder", folder)
    if not path.exists():
        raise InputError(f"{path}: no such folder")
    if not path.is_dir():
        raise InputError(f"{path}: is no folder")
    if not is_run(path) and not is_ensemble(path):
        raise InputError(f"{path}: is no output folder of a run (no history.csv, no lattice.h5) "
                         "and has none below")
    return Run(path)


def breaks_of(output: Output) -> pandas.DataFrame:
    """Run.breaks."""
    import h5py
    import pandas

    from floe.results import breakage
    columns = {"body_a": "1", "body_b": "1", "beam": "1", "x": "m", "y": "m", "z": "m", **BREAKS}
    path = output.folder / "breaks.h5"
    if has_changes(output.folder):
        # by the names of bodies, with those that have left
        times = breakage.times_of(output)
        keys, _, place, *values = breakage.of_file(output, "place", *BREAKS)
        detail = pandas.DataFrame(dict(zip(BREAKS, values)), index=keys)
        detail[["x", "y", "z"]] = place.reshape(-1, 3)
        table = detail.reindex(times.key).reset_index(drop=True)
        table["time"], table["beam"] = times.time, -1
        table["body_a"], table["body_b"] = times.key >> 32, times.key & 0xffffffff
    elif path.exists():
        with reading(path), h5py.File(path) as file:
            found = {name: file[name][:] for name in ("time", "beam", *BREAKS)}
            found |= dict(zip(("body_a", "body_b"), file["bodies"][:].T))
            found |= dict(zip("xyz", file["place"][:].T))
        table = pandas.DataFrame(found)
    else:
        table = pandas.DataFrame(columns=["time", *columns], dtype=float)
    table = table.sort_values(["time", "body_a", "body_b"]).set_index("time")[[*columns]]
    table.attrs["units"] = {"time": "s", **columns}
    return table


def polygons_of(output: Output, time: float | None, pyvista: Any) -> Any:
    """Run.to_pyvista."""
    from floe.results import breakage
    if not output.shapes:
        raise InputError(f"{output.folder}: bodies have no shapes")
    time = output.nearest(time)
    ice = output.at(time)
    first, corners = ice.shapes["corner_of"], ice.shapes["corners"]
    faces = np.insert(corners, first[:-1], np.diff(first))  # a count before the corners of each
    body = np.repeat(np.arange(len(ice.position)), np.diff(ice.shapes["face_of"]))
    made = pyvista.PolyData(output.field("points", time), faces)
    made.cell_data["body"] = ice.names[body]
    made.cell_data["displacement"] = output.field("bodies_displacement", time)[body]
    if output.has_field("damage", time):
        whole = output.field("damage", time) < 1
        made.cell_data["fragment"] = breakage.fragments(ice, whole)["fragments/of_body"][body]
    return made
