"""Writes frames of a run as VTKHDF, version 2, with time: polygons whose points move (PolyData with
Steps; https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format). ParaView 5.12 and later
read it.

Polygons are the same at all times, so that each is stored once; only points and data of the cells
have values per step. Where ice joins and leaves, they are stored once for each set of bodies.
"""
from pathlib import Path

import h5py
import numpy as np

from floe.results import breakage

KINDS = ("Vertices", "Lines", "Polygons", "Strips")


class Polygons:
    """A file with polygons: points and data of the polygons at every time, and meshes, each of
    which holds from its time on."""

    def __init__(self, path):
        self.path = Path(path)
        self.part = self.path.with_name(f".{self.path.name}.part")
        self.file = h5py.File(self.part, "w")
        self.root = self.file.create_group("VTKHDF")
        self.root.attrs["Version"] = np.array([2, 1])
        self.root.attrs["Type"] = np.bytes_("PolyData")
        self.root.create_group("PointData")
        self.times, self.mesh_of = [], []             # of each step
        self.meshes = np.zeros((0, 3), np.int64)      # numbers of points, polygons, corners
        self.fixed, self.begins = [], {"Points": []}  # names; where the values of a step begin

    def append(self, name, values, kind):
        """Adds values to a data set, a chunk."""
        if name not in self.root:
            shape = np.shape(values)
            self.root.create_dataset(name, (0, *shape[1:]), kind, maxshape=(None, *shape[1:]),
                                     chunks=(max(shape[0], 1), *shape[1:]), compression=1,
                                     shuffle=True)
        data = self.root[name]
        data.resize(data.shape[0] + len(values), axis=0)
        if len(values):
            data[-len(values):] = values

    def begin(self, points, offsets, corners, fixed):
        """A mesh for the steps to come. offsets: n + 1 first corners of the polygons, at least one
        (readers find meshes by counting); corners: indices of points; fixed: {name: n values} that
        hold for these steps, of the same names for every mesh."""
        for kind in KINDS:
            own = kind == "Polygons"
            self.append(f"{kind}/Offsets", offsets if own else [0], np.int64)
            self.append(f"{kind}/Connectivity", corners if own else [], np.int64)
        self.fixed = list(fixed)
        for name, values in fixed.items():
            self.append(f"CellData/{name}", values, values.dtype)
        self.meshes = np.vstack([self.meshes, [points, len(offsets) - 1, len(corners)]])

    def add(self, time, points, **cells):
        """A step: points x 3 [m] and data of the polygons, of the same names in every step."""
        for name, values in {"Points": points,
                             **{f"CellData/{key}": v for key, v in cells.items()}}.items():
            self.begins.setdefault(name, []).append(
                self.root[name].shape[0] if name in self.root else 0)
            self.append(name, values, "f4")
        self.times.append(time)
        self.mesh_of.append(len(self.meshes) - 1)

    def close(self):
        """Writes where each step begins, and gives the file its name."""
        number = len(self.times)
        self.root["NumberOfPoints"] = self.meshes[:, 0]
        for kind in KINDS:
            own = kind == "Polygons"
            for column, name in ((1, "NumberOfCells"), (2, "NumberOfConnectivityIds")):
                self.root[f"{kind}/{name}"] = self.meshes[:, column] * own
        before = (np.cumsum(self.meshes, axis=0) - self.meshes)[self.mesh_of]
        steps = self.root.create_group("Steps")
        steps.attrs["NSteps"] = number
        steps["Values"] = np.array(self.times)
        steps["NumberOfParts"] = np.ones(number, np.int64)
        steps["PartOffsets"] = np.array(self.mesh_of, np.int64)
        steps["PointOffsets"] = np.array(self.begins.pop("Points"), np.int64)
        for name, column in (("CellOffsets", 1), ("ConnectivityIdOffsets", 2)):
            steps[name] = before[:, [column]] * (np.array(KINDS) == "Polygons")
        steps.create_group("PointDataOffsets")
        for name, begins in self.begins.items():
            steps[f"CellDataOffsets/{name.removeprefix('CellData/')}"] = np.array(begins, np.int64)
        for name in self.fixed:
            steps[f"CellDataOffsets/{name}"] = before[:, 1]
        self.file.close()
        self.part.replace(self.path)


def write_bodies(output, path):
    """The faces of all bodies: `body` (its name), `displacement` [m] and `rotation` [rad] of their
    bodies, and `fragment` where the run could break: at the end, or at each time where ice joins
    and leaves."""
    file, present, breaks = Polygons(path), None, breakage.at_end(output)
    for time in output.times:
        ice = output.at(time)
        if ice is not present:
            present = ice
            body = np.repeat(np.arange(len(ice.position)), np.diff(ice.shapes["face_of"]))
            fixed = {"body": ice.names[body].astype(np.int32)}
            if breaks and not output.changes:
                fixed["fragment"] = breaks["fragments/of_body"][body].astype(np.int32)
            file.begin(len(ice.shapes["vertices"]), ice.shapes["corner_of"],
                       ice.shapes["corners"], fixed)
        more = {}
        if breaks and output.changes:
            whole = output.field("damage", time) < 1
            more["fragment"] = breakage.fragments(ice, whole)["fragments/of_body"][body]
        file.add(time, output.field("points", time),
                 displacement=output.field("bodies_displacement", time)[body],
                 rotation=output.field("bodies_rotation", time)[body], **more)
    file.close()


def places_of(some, all_of_them):
    """Where sorted numbers, of which several may be alike, are in the sorted numbers that have them
    all: the first of those that are alike in the first place, and so on."""
    again = np.arange(len(some)) - np.searchsorted(some, some)
    return np.searchsorted(all_of_them, some) + again


def crack_beams(output, time):
    """Broken beams of a frame, sorted, each twice: once for either face."""
    if not output.has_field("crack_beam", time):
        return np.zeros(0, int)
    return np.sort(output.field("crack_beam", time))


def write_cracks(output, path):
    """Faces of the cracks (of each broken beam its section on either body), with `beam` and `open`:
    1 once it has broken; until then its corners lie in one point, between its bodies. Where ice
    joins and leaves, those of the bodies of each time, `beam` in their order; bodies of which none
    breaks have one face that never opens, of beam -1. False if there are none."""
    last = output.last_frames()
    if not any(output.has_field("crack_beam", time) for time in output.times[last]):
        return False
    file = Polygons(path)
    for end, mesh in zip(output.times[last], output.meshes[last]):
        beams = crack_beams(output, end)
        named = beams.astype(np.int32) if len(beams) else np.array([-1], np.int32)
        number = len(named)
        file.begin(4 * number, 4 * np.arange(number + 1), np.arange(4 * number), {"beam": named})
        bodies = (output.at(end).beams["bodies"][beams] if len(beams) else np.zeros((1, 2), int))
        for time in output.times[output.meshes == mesh]:
            corners = np.repeat(output.field("centres", time)[bodies].mean(axis=1), 4, axis=0)
            corners = corners.reshape(number, 4, 3)
            is_open = np.zeros(number, np.float32)
            if output.has_field("crack_beam", time):
                beam, quads = output.field("crack_beam", time), output.field("cracks", time)
                order = np.argsort(beam, kind="stable")
                rows = places_of(beam[order], beams)
                corners[rows] = output.field("crack_points", time)[quads[order]]
                is_open[rows] = 1
            file.add(time, corners.reshape(-1, 3), open=is_open)
    file.close()
    return True
