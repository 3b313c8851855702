"""The frames of a run as a lazy xarray dataset: values are read when they are asked for. SI units.

    data = dataset_of(Output("out/ice_cone"))
    data["displacement"].sel(axis="z").sel(time=3.0, method="nearest").values.max()
"""
import threading

import h5py
import numpy as np

from floe.errors import reading
from floe.results import breakage

# variable: dataset of a frame, what it is of, its further dimension, unit, label
VARIABLES = {
    "position": ("centres", "body", "axis", "m", "place of the body's centroid"),
    "displacement": ("bodies_displacement", "body", "axis", "m",
                     "displacement of the body's centroid from rest"),
    "rotation": ("bodies_rotation", "body", "axis", "rad", "rotation vector of the body from rest"),
    "beam_force": ("beams_force", "beam", "force", "N",
                   "normal and shear forces at the beam's middle"),
    "beam_moment": ("beams_moment", "beam", "moment", "N m",
                    "torsion and bending moments at the beam's middle"),
    "tensile_stress": ("tensile_stress", "beam", None, "Pa",
                       "largest tensile stress of the beam's section"),
    "shear_stress": ("shear_stress", "beam", None, "Pa", "largest shear stress of the section"),
    "damage": ("damage", "beam", None, "1", "damage of the beam: 0 whole, 1 broken"),
}
COMPONENTS = {"axis": ["x", "y", "z"], "force": ["N", "Q2", "Q3"], "moment": ["T", "M2", "M3"],
              "end": [0, 1]}


class Values:
    """A dataset in all frames as an array, frame x rows of the run x further ones, which dask takes
    values from. Rows that a frame lacks are nan.

    frames: [(time, path, group)]; rows: per frame the rows of the run that it has, None: all."""

    def __init__(self, frames, name, rows, shape, dtype):
        self.frames, self.name, self.rows = frames, name, rows
        self.shape, self.dtype = (len(frames), *shape), np.dtype(dtype)
        self.ndim = len(self.shape)

    def frame(self, number):
        """The values that a frame has."""
        _, path, group = self.frames[number]
        with reading(path), h5py.File(path) as file:
            return file[group][self.name][:]

    def whole_frame(self, number):
        """The values of a frame, in the rows of the run."""
        values, rows = self.frame(number), self.rows[number]
        if rows is None:
            return values
        found = np.full(self.shape[1:], np.nan, self.dtype)
        found[rows] = values
        return found

    def __getitem__(self, key):
        first, *further = key if isinstance(key, tuple) else (key,)
        numbers, further = np.arange(len(self.frames))[first], tuple(further)
        if np.ndim(numbers) == 0:
            return self.whole_frame(numbers)[further]
        return np.array([self.whole_frame(number)[further] for number in numbers],
                        self.dtype).reshape(len(numbers), *np.empty(self.shape[1:])[further].shape)


class Pieces(Values):
    """Per frame and body the rank by mass of its piece: what whole beams hold together."""

    def __init__(self, output, rows, shape):
        super().__init__(output.frames, "damage", rows, shape, float)
        self.output, self.lock = output, threading.Lock()

    def frame(self, number):
        whole = super().frame(number) < 1
        with self.lock:  # one mesh is kept at a time
            ice = self.output.at(self.output.times[number])
        return breakage.fragments(ice, whole)["fragments/of_body"].astype(float)


def names_of(output):
    """Names of all bodies of the run, names k x 2 of the bodies of all beams, and for each mesh the
    rows of its bodies and of its beams among them; None: all."""
    if not output.changes:
        return *output.mesh_names(0), {0: (None, None)}
    meshes = {number: output.mesh_names(number) for number in np.unique(output.meshes)}
    bodies = np.unique(np.concatenate([names for names, _ in meshes.values()]))
    keys = {number: breakage.keys(pairs) for number, (_, pairs) in meshes.items()}
    every, first = np.unique(np.concatenate(list(keys.values())), return_index=True)
    pairs = np.concatenate([pairs for _, pairs in meshes.values()])[first]
    return bodies, pairs, {number: (np.searchsorted(bodies, names),
                                    np.searchsorted(every, keys[number]))
                           for number, (names, _) in meshes.items()}


def mass_of(output, bodies):
    """Masses [kg] of the bodies by their names, of all frames."""
    mass = np.full(len(bodies), np.nan)
    for number in output.last_frames():
        ice = output.at(output.times[number])
        mass[np.searchsorted(bodies, ice.names)] = ice.mass
    return mass


def dataset_of(output):
    """The frames of an Output as an xarray.Dataset over time, body, beam, axis, force (N Q2 Q3) and
    moment (T M2 M3). Coordinates: time [s], body and the ends of each beam by the names that bodies
    keep. A body or a beam is nan in frames in which it does not exist."""
    import dask
    import dask.array
    import xarray
    bodies, pairs, rows_of = names_of(output)
    count = {"body": len(bodies), "beam": len(pairs)}
    rows = {kind: [rows_of[mesh][k] for mesh in output.meshes]
            for k, kind in enumerate(("body", "beam"))}

    def lazy(values):
        # no name from a hash of the values: they are not read here
        return dask.array.from_array(values, chunks=(1, *values.shape[1:]), name=False)

    there = output.datasets()  # of a frame: {name: (shape, dtype)}
    data, used = {}, set()
    for variable, (name, kind, further, units, label) in VARIABLES.items():
        if name in there:
            shape, dtype = there[name]
            values = Values(output.frames, name, rows[kind], (count[kind], *shape[1:]), dtype)
            dims = ("time", kind, *([further] if further else []))
            data[variable] = (dims, lazy(values), {"units": units, "long_name": label})
            used |= set(dims)
    if "damage" in there:
        data["fragment"] = (("time", "body"), lazy(Pieces(output, rows["body"], (count["body"],))),
                            {"units": "1", "long_name": "rank by mass of the piece that has the "
                                                        "body in this frame"})
    mass = output.mass if not output.changes else dask.array.from_delayed(
        dask.delayed(mass_of)(output, bodies), (len(bodies),), float)
    data["mass"] = ("body", mass, {"units": "kg", "long_name": "mass of the body"})
    coordinates = {"time": ("time", output.times, {"units": "s", "long_name": "time of the frame"}),
                   "body": ("body", bodies, {"long_name": "name of the body, which it keeps"})}
    if "beam" in used:
        coordinates["beam"] = ("beam", np.arange(len(pairs)), {"long_name": "number of the beam"})
        coordinates["bodies"] = (("beam", "end"), pairs,
                                 {"long_name": "names of the bodies that the beam joins"})
    coordinates |= {name: (name, values) for name, values in COMPONENTS.items()
                    if name in used or name == "end" and "beam" in used}
    return xarray.Dataset(data, coordinates, {"title": f"frames of {output.folder}"})
