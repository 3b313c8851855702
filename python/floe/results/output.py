#!/usr/bin/python3
"""Reads an output folder of floe: summary.json, options.yaml, lattice.h5, history.csv, fields. SI
units everywhere.

Also that of a run that is under way, was killed or has failed: what is there is whole. Where ice
joins and leaves (supply) Output.at(time) has the ice of a frame; one frame is read at a time.
"""
import csv
import json
import re
from pathlib import Path

import h5py
import numpy as np

from floe.errors import InputError, reading
from floe.results.supply import ice_of

# name: dataset of a time group of fields.h5, its column (None: length of the vector), unit, label
BODY_QUANTITIES = {
    "ux": ("bodies_displacement", 0, "m", "displacement in x"),
    "uy": ("bodies_displacement", 1, "m", "displacement in y"),
    "uz": ("bodies_displacement", 2, "m", "displacement in z"),
    "u": ("bodies_displacement", None, "m", "displacement"),
    "rx": ("bodies_rotation", 0, "rad", "rotation about x"),
    "ry": ("bodies_rotation", 1, "rad", "rotation about y"),
    "rz": ("bodies_rotation", 2, "rad", "rotation about z"),
}
BEAM_STRESSES = {
    "axial": "axial stress of the beams",             # N/A
    "tensile": "largest tensile stress of the beams",  # of the section: N/A and bending
    "shear": "shear stress of the beams",
}


def matrices(quaternions):
    """Rotation matrices n x 3 x 3 of unit quaternions n x 4 (w, x, y, z)."""
    w, x, y, z = np.asarray(quaternions).T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), 2, 0)


def rotations(vectors):
    """Rotation matrices n x 3 x 3 of rotation vectors n x 3."""
    angle = np.linalg.norm(vectors, axis=1)
    half = np.sinc(angle / 2 / np.pi) / 2  # sin(angle/2)/angle
    return matrices(np.column_stack([np.cos(angle / 2), vectors * half[:, None]]))


class Lattice:
    """A lattice.h5. names: of the bodies, which they keep while others join and leave. obstacles:
    points [m] and faces of those other than half-spaces, at rest."""

    def __init__(self, path):
        with reading(path), h5py.File(path) as file:
            self.position = file["bodies/position"][:]      # n x 3 [m]
            self.orientation = file["bodies/orientation"][:]  # n x 4
            self.mass = file["bodies/mass"][:]              # n [kg]
            self.beams = {name: data[:] for name, data in file.get("beams", {}).items()}
            self.sets = {name: data[:] for name, data in file.get("sets", {}).items()}
            self.shapes = {name: data[:] for name, data in file.get("shapes", {}).items()}
            self.obstacles = {name: {key: data[:] for key, data in group.items()}
                              for name, group in file.get("obstacles", {}).items()}
        self.names = np.arange(len(self.position))

    def plans(self):
        """Per body the corners k x 2 [m], seen from above, of its most upward face, in the
        reference state."""
        body_of = np.repeat(np.arange(len(self.position)), np.diff(self.shapes["vertex_of"]))
        placed = np.einsum("vij,vj->vi", matrices(self.orientation)[body_of],
                           self.shapes["vertices"])
        placed += self.position[body_of]
        first, corners = self.shapes["corner_of"][:-1], self.shapes["corners"]
        a, b, c = (placed[corners[first + k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        upward = normal[:, 2] / np.linalg.norm(normal, axis=1)
        of_body = np.repeat(np.arange(len(self.position)), np.diff(self.shapes["face_of"]))
        order = np.lexsort((upward, of_body))
        top = order[self.shapes["face_of"][1:] - 1]
        ends = self.shapes["corner_of"]
        return [placed[corners[ends[f]:ends[f + 1]], :2] for f in top]


class Present(Lattice):
    """The lattice of the bodies of a frame, at rest. arrays: supply.ice_of."""

    def __init__(self, arrays):
        vars(self).update(arrays)


def frames_of(folder):
    """All frames in a folder, in order of time: [(time, file, group)]. None is ever there in
    part."""
    folder = Path(folder)
    files = [file for file in folder.glob("fields/*.h5") if file.stem.isdigit()]
    if not (folder / "fields").is_dir():  # of floe 0.1: a single file
        files = [folder / "fields.h5"]
    frames = []
    for path in files:
        with reading(path), h5py.File(path) as file:
            frames += [(float(group.attrs["time"]), path, name) for name, group in file.items()
                       if "time" in group.attrs]
    return sorted(frames)


def rows_of(folder):
    """Rows of history.csv as {column: text}; of a run that is under way without a last one that is
    not whole yet."""
    path = Path(folder) / "history.csv"
    with reading(path), open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if line.endswith("\n")))
        for number, row in enumerate(rows, 2):
            for column, text in row.items():
                try:
                    float(text)
                except (TypeError, ValueError):
                    raise ValueError(f"line {number}: {column} is no number: {text!r}") from None
        return rows


def options_of(folder):
    """options.yaml as {"sheet_length": "40", ...}: sections joined by _, values as text."""
    options, sections = {}, []
    path = Path(folder) / "options.yaml"
    with reading(path):
        lines = path.read_text().splitlines()
    for line in lines:
        match = re.match(r"( *)([^\s#:][^:]*):(?: (.*))?$", line)
        if not match:
            continue
        indent, key, value = len(match[1]), match[2], (match[3] or "").strip()
        sections = [(i, k) for i, k in sections if i < indent]
        name = "_".join([k for _, k in sections] + [key])
        if value:
            options[name] = value.strip("\"'[]")
        else:
            sections.append((indent, key))
    return options


def summary_of(folder):
    """summary.json; empty until the run has ended."""
    path = Path(folder) / "summary.json"
    with reading(path):
        return json.loads(path.read_text()) if path.exists() else {}


def has_changes(folder):
    """Whether ice has joined or left in a run (supply)."""
    return any(Path(folder).glob("fields/mesh_*.h5"))


class Output(Lattice):
    """An output folder. Its arrays of bodies and beams are those of its lattice.h5, the first ones;
    where ice joins and leaves (`changes`), those of a frame are at(time)."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.summary = summary_of(self.folder)
        super().__init__(self.folder / "lattice.h5")
        self._frames = frames_of(self.folder)
        self.times = np.array([time for time, _, _ in self._frames])
        # per frame the first one that has the same bodies
        self.meshes = np.zeros(len(self._frames), int)
        if has_changes(self.folder):
            self.meshes[:] = [self._mesh_number(*frame[1:]) for frame in self._frames]
        is_there = (self.folder / "options.yaml").exists()
        if has_changes(self.folder) or is_there and "supply_strip" in self.options():
            self._require_meshes()
        self._present = self._pairs = (0, None)

    @property
    def frames(self):
        """[(time, file, group)] in order of time."""
        return self._frames

    def datasets(self):
        """{name: (shape, type)} of what frames have, of the first one; empty without frames."""
        if not self._frames:
            return {}
        _, path, group = self._frames[0]
        with reading(path), h5py.File(path) as file:
            return {name: (data.shape, data.dtype) for name, data in file[group].items()}

    def mesh_names(self, mesh):
        """Names of the bodies of a mesh (0: of lattice.h5), and m x 2 of its beams' bodies."""
        if mesh == 0:
            return self.names, self.beams.get("bodies", np.zeros((0, 2), int)).astype(np.int64)
        path = self.mesh_file(mesh)
        with reading(path), h5py.File(path) as file:
            names = file["mesh/name"][:].astype(np.int64)
            return names, names[file["mesh/beams"][:]]

    @property
    def changes(self):
        """Whether some frames are of other bodies than lattice.h5."""
        return bool(np.any(self.meshes))

    def _require_meshes(self):
        """Checks that each mesh has the bodies of its frames."""
        for number in np.unique(self.meshes):
            count, path = len(self.position), self.mesh_file(number)
            if number > 0:
                with reading(path), h5py.File(path) as file:
                    count = len(file["mesh/name"])
            for k in np.flatnonzero(self.meshes == number):
                if self.count(self.times[k]) != count:
                    raise InputError(f"{self.folder}: the frame at {self.times[k]:g} s is of "
                                     "bodies that joined or left (supply) and that no file in "
                                     "fields/ tells of")

    def count(self, time):
        """Number of the bodies in the frame nearest to `time`."""
        _, path, group = self._frames[self._number(time)]
        with reading(path), h5py.File(path) as file:
            return len(file[group]["centres"])

    @staticmethod
    def _mesh_number(path, group):
        with reading(path), h5py.File(path) as file:
            return int(file[group].attrs.get("mesh", 0))

    def _number(self, time):
        """Number of the frame nearest to `time`."""
        if not self._frames:
            raise InputError(f"{self.folder} has no frame yet")
        return int(np.argmin(np.abs(self.times - time)))

    def at(self, time):
        """The lattice of the bodies and beams that exist in the frame nearest to `time`, at rest:
        fields of that frame are in its order."""
        number = self._number(time)
        mesh = self.meshes[number]
        if mesh == 0:
            return self
        if self._present[0] != mesh:
            _, path, group = self._frames[number]
            of_mesh = self.mesh_file(mesh)
            with reading(of_mesh), h5py.File(of_mesh) as shared, reading(path), h5py.File(
                    path) as file:
                frame = file[group]
                turns = rotations(frame["bodies_rotation"][:])
                self._present = mesh, Present(ice_of(shared["mesh"], frame, turns,
                                                     len(self.position), self.options()))
        return self._present[1]

    def mesh_file(self, mesh):
        """File of the bodies of the frames from number `mesh` > 0 on."""
        return self.folder / f"fields/mesh_{mesh:06d}.h5"

    def beam_names(self, time):
        """Names m x 2 of the bodies of the beams of the frame nearest to `time`."""
        mesh = self.meshes[self._number(time)]
        if mesh == 0:
            return self.mesh_names(0)[1]
        if self._pairs[0] != mesh:
            self._pairs = mesh, self.mesh_names(mesh)[1]
        return self._pairs[1]

    def last_frames(self):
        """Numbers of the last frames before other bodies: all that breaks in a frame of the same
        bodies has broken by then."""
        return np.flatnonzero(np.append(np.diff(self.meshes) != 0, True)[:len(self.meshes)])

    def box(self):
        """Corners low, high [m] of the box of the centroids at rest; where ice joins and leaves,
        also of those in the first and the last frame."""
        places = [self.position]
        if self.changes:
            places += [self.field("centres", time) for time in self.times[[0, -1]]]
        return (np.min([p.min(axis=0) for p in places], axis=0),
                np.max([p.max(axis=0) for p in places], axis=0))

    def nearest(self, time=None):
        """Time of the frame nearest to `time` (None: the last one). InputError if the run has none,
        or none so late."""
        if not self._frames:
            raise InputError(f"{self.folder} has no frame yet")
        last = self.times[-1]
        if time is not None and not -1e-9 * last <= time <= last * (1 + 1e-9):
            raise InputError(f"time {time:g}: the frames of {self.folder} go from 0 to {last:g} s")
        return last if time is None else self.times[np.argmin(np.abs(self.times - time))]

    def field(self, name, time):
        """Dataset `name` of the sample nearest to `time`."""
        _, path, group = self._frames[self._number(time)]
        with reading(path), h5py.File(path) as file:
            return file[group][name][:]

    def has_field(self, name, time):
        """Whether the sample nearest to `time` has the dataset `name`."""
        _, path, group = self._frames[self._number(time)]
        with reading(path), h5py.File(path) as file:
            return name in file[group]

    def body_quantity(self, name, time):
        """Values n of a quantity of BODY_QUANTITIES, its unit and label."""
        dataset, column, unit, label = BODY_QUANTITIES[name]
        values = self.field(dataset, time)
        return np.linalg.norm(values, axis=1) if column is None else values[:, column], unit, label

    def beam_stress(self, name, time):
        """Values m [Pa] of a quantity of BEAM_STRESSES, and its label."""
        if name == "axial":
            area = self.at(time).beams["area"]
            return self.field("beams_force", time)[:, 0] / area, BEAM_STRESSES[name]
        return self.field("beams_stress", time)[:,
                                                {"tensile": 0,
                                                 "shear": 1}[name]], BEAM_STRESSES[name]

    def history(self, name):
        """One column of history.csv."""
        rows = rows_of(self.folder)
        if rows and name not in rows[0]:
            raise InputError(f"{self.folder / 'history.csv'}: has no column {name}")
        return np.array([float(row[name]) for row in rows])

    def water_levels(self, times):
        """The level of still water at these times [m], None unless it changes."""
        rows = rows_of(self.folder)
        if not rows or "water_level" not in rows[0]:
            return None
        return np.interp(times, self.history("time"), self.history("water_level"))

    def options(self):
        """options_of the folder."""
        return options_of(self.folder)


def scaled(values, unit):
    """The values in a unit that suits their size, and its name: Pa -> kPa, MPa; m -> mm, um; rad ->
    mrad."""
    steps = {"Pa": [(1e6, "MPa"), (1e3, "kPa"), (1, "Pa")],
             "m": [(1, "m"), (1e-3, "mm"), (1e-6, "µm")],
             "rad": [(1, "rad"), (1e-3, "mrad"), (1e-6, "µrad")]}[unit]
    largest = np.max(np.abs(values), initial=0)
    for size, name in steps:
        if largest >= size:
            return values / size, name
    return values / steps[-1][0], steps[-1][1]
