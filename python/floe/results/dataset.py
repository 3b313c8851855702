"""Runs of floe as xarray datasets after the CF conventions, version 1.8 (floe netcdf).

    dataset = ensemble([dataset_of("out/cone/seed1"), dataset_of("out/cone/seed2")])

Dimensions: run, time, obstacle, axis (x y z), fragment; if asked for, frame and body. Times are the
multiples of `output: history` at which rows are due, so that runs join; `sample_time` has the
instants themselves, up to a step later. What one run has and another lacks is nan, and so is a body
in frames in which it does not exist (CF 9.3.2, incomplete multidimensional arrays). SI units.
"""
import re
from pathlib import Path

import h5py
import netCDF4
import numpy as np
import xarray

from floe.errors import InputError, reading
from floe.loads import statements
from floe.results import breakage, tables
from floe.results.output import Output, has_changes, options_of, summary_of


CONVENTIONS = "CF-1.8"
LABELS = {"force": ("N", "force on the obstacle at this instant"),
          "moment": ("N m", "moment on the obstacle about its point at this instant")}
AXIS = ("axis", np.array(list("xyz"), object), {"long_name": "axis of the world, z up"})


def interval_of(options):
    """Time [s] between the rows of a run, 0 if each is at a load step."""
    given = options.get("output_history", "auto")
    if given != "auto":
        return float(given)
    statics = options.get("integrator", "quasistatic") == "quasistatic"
    return 0.0 if statics else float(options["time_end"]) / 200


def due_times(time, interval):
    """The multiples of the interval at which rows at these times [s] were due, up to a step
    earlier; the times themselves where steps are longer than the interval, and of a last row that
    came since the run ended."""
    if interval <= 0:
        return time.copy()
    number = np.floor(time / interval + 1e-6)
    follows = np.append(True, np.diff(number) == 1)
    if not np.all(follows[:-1]):
        return time.copy()
    return np.where(follows, number * interval, time)


def plain(name):
    """A name that CF allows for a variable: letters, digits, underscores, a letter first."""
    name = re.sub(r"\W", "_", name, flags=re.ASCII)
    return name if name[:1].isalpha() else f"n_{name}"


def variable(dims, values, units, label, **more):
    return dims, values, {"units": units, "long_name": label, **more}


def of_obstacles(table, names):
    """Variables of the obstacles: forces, moments, impulses (run, time, obstacle, axis), largest
    force (run, obstacle, axis)."""
    def columns(what):
        return np.stack([table[[f"{name}_{what}_{axis}" for axis in "xyz"]].to_numpy()
                         for name in names], axis=1)[None]
    dims = ("run", "time", "obstacle", "axis")
    found = {f"obstacle_{what}": variable(dims, columns(what), units, label)
             for what, (units, label) in LABELS.items()}
    impulse = columns("mean_force") * table["time"].to_numpy()[None, :, None, None]
    found["obstacle_impulse"] = variable(
        dims, impulse, "N s", "integral of the force over all steps since the start of the run")
    found["obstacle_largest_force"] = variable(
        ("run", "obstacle", "axis"), columns("peak_force")[:, -1], "N",
        "force on the obstacle in the step in which its norm was largest")
    return found


def of_history(table, names):
    """Every other column of history.csv as a variable (run, time)."""
    own = re.compile("(" + "|".join(map(re.escape, names)) +
                     ")_(force|moment|peak_force|mean_force)_[xyz]$") if names else None
    return {plain(column): variable(("run", "time"), table[column].to_numpy()[None],
                                    tables.unit_of(column), column.replace("_", " "))
            for column in table if column != "time" and not (own and own.match(column))}


def of_fragments(folder):
    """Masses and numbers of bodies of the pieces at the end; nothing if the run cannot break."""
    path = Path(folder) / "breaks.h5"
    if not path.exists():
        return {}
    if has_changes(folder):  # of the last frame: a run that was killed may have other breaks
        found = breakage.at_end(Output(folder))
        mass, bodies = found["fragments/mass"], found["fragments/bodies"]
    else:
        with reading(path), h5py.File(path) as file:
            mass, bodies = file["fragments/mass"][:], file["fragments/bodies"][:]
    order = np.argsort(-mass, kind="stable")
    return {"fragment_mass": variable(("run", "fragment"), mass[order][None], "kg",
                                      "mass of a piece at the end, the heaviest first"),
            "fragment_bodies": variable(("run", "fragment"), bodies[order][None].astype(float), "1",
                                        "number of bodies of a piece at the end")}


def of_bodies(folder):
    """Variables of the bodies in the frames (run, frame, body, axis), and their coordinates."""
    output = Output(folder)
    if not len(output.times):
        raise InputError(f"{folder} has no frame yet")
    names = np.unique(np.concatenate([output.at(time).names
                                      for time in output.times[output.last_frames()]]))
    shape = len(output.times), len(names)
    place, turn, mass = (np.full(size, np.nan) for size in ((*shape, 3), (*shape, 3), shape[1]))
    piece = np.full(shape, np.nan)
    for k, time in enumerate(output.times):
        ice = output.at(time)
        rows = np.searchsorted(names, ice.names)
        place[k, rows], turn[k, rows] = (output.field("centres", time),
                                         output.field("bodies_rotation", time))
        mass[rows] = ice.mass
        if output.has_field("damage", time):
            whole = output.field("damage", time) < 1
            piece[k, rows] = breakage.fragments(ice, whole)["fragments/of_body"]
    dims, axes = ("run", "frame", "body"), ("run", "frame", "body", "axis")
    found = {"frame_time": variable(dims[:2], output.times[None], "s",
                                    "time of the frame since the start of the run"),
             "body_mass": variable(("run", "body"), mass[None], "kg", "mass of the body"),
             "body_position": variable(axes, place[None], "m", "place of the body's centroid"),
             "body_rotation": variable(axes, turn[None], "rad",
                                       "rotation vector of the body from rest")}
    if not np.all(np.isnan(piece)):
        found["body_fragment"] = variable(dims, piece[None], "1", "rank by mass of the piece that "
                                          "has the body in this frame")
    return found, {"frame": variable("frame", np.arange(len(output.times)), "1",
                                     "number of the frame"),
                   "body": variable("body", names, "1", "name of the body, its number in the run"),
                   "axis": AXIS}


def dataset_of(folder, name=None, bodies=False):
    """A run as a dataset with a dimension run of length 1, called `name` (default: the folder's
    name). bodies: with those of the frames."""
    folder = Path(folder)
    table, options, summary = tables.history(folder), options_of(folder), summary_of(folder)
    if not len(table):
        raise InputError(f"{folder}/history.csv has no rows yet")
    names = tables.obstacles_of(table)
    path = folder / "options.yaml"
    with reading(path):
        scene = path.read_text()
        time = table["time"].to_numpy()
        interval = interval_of(options)
        variables = {"sample_time": variable(("run", "time"), time[None], "s",
                                             "time of the sample since the start of the run")}
        variables |= of_obstacles(table, names) if names else {}
        variables |= of_history(table, names) | of_fragments(folder)
    version = str(summary.get("version", "unknown"))
    for key, value, label in (("scene", scene, "every option of the run, as used (YAML)"),
                              ("version", version, "version of floe"),
                              ("status", str(summary.get("status", "under way")),
                               "how the run ended")):
        variables[key] = ("run", np.array([value], object), {"long_name": label})
    if "sheet_seed" in options:
        variables["seed"] = variable(("run",), np.array([float(options["sheet_seed"])]), "1",
                                     "seed of the mesh")
    coordinates = {"run": ("run", np.array([name or folder.resolve().name], object),
                           {"long_name": "name of the run"}),
                   "time": variable("time", due_times(time, interval), "s",
                                    "time at which a row was due since the start of the run")}
    if names:
        coordinates["obstacle"] = ("obstacle", np.array(names, object),
                                   {"long_name": "name of the obstacle"})
        coordinates["axis"] = AXIS
    if bodies:
        of_frames, its = of_bodies(folder)
        variables, coordinates = variables | of_frames, coordinates | its
    if "fragment_mass" in variables:
        number = variables["fragment_mass"][1].shape[1]
        coordinates["fragment"] = variable("fragment", np.arange(number), "1",
                                           "rank of the piece by its mass")
    return xarray.Dataset(variables, coordinates, {
        "Conventions": CONVENTIONS, "title": "A run of floe, a simulator of floating sea ice",
        "source": f"floe {version}",
        "history": f"floe netcdf of {folder.resolve()} (netCDF4 {netCDF4.__version__})",
        "version": version, "scene": scene})


def with_parameters(datasets, options):
    """The datasets of runs with a variable option_KEY (run) for each key, seeds aside, whose value
    differs between their options: numbers where all are, else text."""
    keys = statements.differing(options)
    for key in keys:
        values = [each.get(key, "") for each in options]
        try:
            values, kind = [float(value) for value in values], float
        except ValueError:
            kind = object
        for data, value in zip(datasets, values):
            data[f"option_{plain(key)}"] = ("run", np.array([value], kind),
                                            {"long_name": f"option {key} of the scene"})
    return datasets


def completed(datasets):
    """The datasets, each with the variables of all: what a run lacks is nan, text empty. xarray
    joins no others."""
    known = {name: data.variables[name] for data in reversed(datasets) for name in data.data_vars}
    axes = {dim: data.coords[dim] for data in reversed(datasets) for dim in data.dims}
    for data in datasets:
        for name, like in known.items():
            if name in data:
                continue
            shape = [data.sizes.get(dim, axes[dim].size) for dim in like.dims]
            values = np.full(shape, np.nan if like.dtype.kind == "f" else "", like.dtype)
            data.coords.update({dim: axes[dim] for dim in like.dims if dim not in data.dims})
            data[name] = (like.dims, values, like.attrs)
    return datasets


def ensemble(datasets):
    """The datasets of runs as one, along run."""
    joined = xarray.concat(datasets, "run", join="outer", data_vars="all",
                           combine_attrs="override")
    joined.attrs |= {"title": f"{len(datasets)} runs of floe, a simulator of floating sea ice",
                     "comment": "the attribute scene is that of the first run, the variable scene "
                                "has all"}
    return joined


def write(dataset, path):
    """As netCDF-4, compressed; whole or not at all."""
    encoding = {name: {"zlib": True, "complevel": 4, "_FillValue": np.nan}
                for name, data in dataset.data_vars.items() if data.dtype.kind == "f"}
    encoding |= {name: {"_FillValue": None} for name, data in dataset.coords.items()
                 if data.dtype.kind == "f"}
    for name in ("fragment_bodies", "body_fragment"):
        if name in dataset:
            encoding[name] |= {"dtype": "int32", "_FillValue": -1}
    path = Path(path)
    part = path.with_name(f".{path.name}.part")
    dataset.to_netcdf(part, format="NETCDF4", engine="netcdf4", encoding=encoding)
    part.replace(path)
