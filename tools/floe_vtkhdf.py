"""Writes frames of a run as VTKHDF, version 2, with time: polygons whose points move (PolyData with
Steps; https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format). ParaView 5.12 and later
read it.

Polygons are the same at all times, so that each is stored once; only points and data of the cells
have values per step.
"""
from pathlib import Path

import h5py
import numpy as np

KINDS = ("Vertices", "Lines", "Polygons", "Strips")


class Polygons:
    """A file with polygons: points at every time, data of the polygons.

    offsets: n + 1 first corners of the polygons, corners: indices of points; fixed: {name: n
    values} that hold at all times.
    """

    def __init__(self, path, points, offsets, corners, fixed):
        self.path = Path(path)
        self.part = self.path.with_name(f".{self.path.name}.part")
        self.file = h5py.File(self.part, "w")
        self.root = self.file.create_group("VTKHDF")
        self.root.attrs["Version"] = np.array([2, 1])
        self.root.attrs["Type"] = np.bytes_("PolyData")
        self.points, self.cells, self.times = points, len(offsets) - 1, []
        self.root["NumberOfPoints"] = np.array([points])
        self.data = {"Points": self.growing("Points", (points, 3))}
        for kind in KINDS:
            own = kind == "Polygons"
            group = self.root.create_group(kind)
            group["NumberOfCells"] = np.array([self.cells if own else 0])
            group["NumberOfConnectivityIds"] = np.array([len(corners) if own else 0])
            group["Offsets"] = np.asarray(offsets if own else [0], np.int64)
            group["Connectivity"] = np.asarray(corners if own else [], np.int64)
        self.root.create_group("PointData")
        self.fixed = list(fixed)
        for name, values in fixed.items():
            self.root[f"CellData/{name}"] = values

    def growing(self, name, shape):
        """A data set to which steps of this shape are added, each a chunk."""
        return self.root.create_dataset(name, (0, *shape[1:]), "f4", maxshape=(None, *shape[1:]),
                                        chunks=(max(shape[0], 1), *shape[1:]), compression=1,
                                        shuffle=True)

    def add(self, time, points, **cells):
        """A step: points x 3 [m] and data of the polygons, of the same names in every step."""
        for name, values in {"Points": points,
                             **{f"CellData/{key}": v for key, v in cells.items()}}.items():
            if name not in self.data:
                self.data[name] = self.growing(name, np.shape(values))
            data = self.data[name]
            data.resize(data.shape[0] + len(values), axis=0)
            if len(values):
                data[-len(values):] = values
        self.times.append(time)

    def close(self):
        """Writes where each step begins, and gives the file its name."""
        number = len(self.times)
        begin, none = np.arange(number), np.zeros(number, np.int64)
        steps = self.root.create_group("Steps")
        steps.attrs["NSteps"] = number
        steps["Values"] = np.array(self.times)
        steps["NumberOfParts"] = none + 1
        steps["PartOffsets"] = none
        steps["PointOffsets"] = begin * self.points
        steps["CellOffsets"] = steps["ConnectivityIdOffsets"] = np.zeros((number, len(KINDS)),
                                                                         np.int64)
        steps.create_group("PointDataOffsets")
        for name in self.data:
            if name != "Points":
                steps[f"CellDataOffsets/{name.removeprefix('CellData/')}"] = begin * self.cells
        for name in self.fixed:
            steps[f"CellDataOffsets/{name}"] = none
        self.file.close()
        self.part.replace(self.path)


def write_bodies(output, path):
    """The faces of all bodies: `body`, `fragment` at the end where the run could break, and
    `displacement` [m] and `rotation` [rad] of their bodies."""
    shapes = output.shapes
    body = np.repeat(np.arange(len(output.position)), np.diff(shapes["face_of"])).astype(np.int32)
    fixed = {"body": body}
    breaks = output.folder / "breaks.h5"
    if breaks.exists():
        with h5py.File(breaks) as file:
            fixed["fragment"] = file["fragments/of_body"][:][body].astype(np.int32)
    file = Polygons(path, len(shapes["vertices"]), shapes["corner_of"], shapes["corners"], fixed)
    for time in output.times:
        file.add(time, output.field("points", time),
                 displacement=output.field("bodies_displacement", time)[body],
                 rotation=output.field("bodies_rotation", time)[body])
    file.close()


def places_of(some, all_of_them):
    """Where sorted numbers, of which several may be alike, are in the sorted numbers that have them
    all: the first of those that are alike in the first place, and so on."""
    again = np.arange(len(some)) - np.searchsorted(some, some)
    return np.searchsorted(all_of_them, some) + again


def write_cracks(output, path):
    """Faces of the cracks (of each broken beam its section on either body), with `beam` and `open`:
    1 once it has broken; until then its corners lie in one point, between its bodies. False if
    there are none."""
    last = output.times[-1]
    if not output.has_field("crack_beam", last):
        return False
    beams = np.sort(output.field("crack_beam", last))
    bodies, number = output.beams["bodies"][beams], len(beams)
    file = Polygons(path, 4 * number, 4 * np.arange(number + 1), np.arange(4 * number),
                    {"beam": beams.astype(np.int32)})
    for time in output.times:
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
