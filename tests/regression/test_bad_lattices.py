#!/usr/bin/python3
"""Lattice files, shapes and bodies that floe refuses: see bad_input.py."""
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

import launch
from bad_input import FILE, GOOD, BadInput, scene_file

sys.path.insert(0, str(launch.REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402


def spoil(name, value):
    """Puts another value in place of a dataset, or removes it if the value is None."""
    def change(file):
        if name in file:
            del file[name]
        if value is not None:
            file[name] = value
    return change


def twice(file):
    """Every beam a second time, after all others."""
    beams = file["beams"]
    for name in list(beams):
        values = beams[name][:]
        spoil(f"beams/{name}", np.concatenate([values, values]))(file)


LATTICE_FILES = {
    "positions with two columns": (spoil("bodies/position", np.zeros((5, 2))), "/bodies/position"),
    "one mass too few": (spoil("bodies/mass", np.ones(4)), "/bodies/mass"),
    "no masses": (spoil("bodies/mass", None), "/bodies/mass"),
    "negative mass": (spoil("bodies/mass", -np.ones(5)), "/bodies/mass"),
    "nan": (spoil("bodies/mass", np.array([1, 1, np.nan, 1, 1])), "/bodies/mass"),
    "not a unit quaternion": (spoil("bodies/orientation", np.full((5, 4), 0.9)),
                              "/bodies/orientation"),
    "beam to a body that is not there":
        (spoil("beams/bodies", np.array([[0, 1], [1, 2], [2, 3], [3, 5]], np.int32)),
         "/beams/bodies"),
    "beam to a negative body":
        (spoil("beams/bodies", np.array([[-1, 1], [1, 2], [2, 3], [3, 4]], np.int32)),
         "/beams/bodies"),
    "beam of one body":
        (spoil("beams/bodies", np.array([[0, 1], [1, 2], [2, 3], [3, 3]], np.int32)),
         "/beams/bodies"),
    "beams with three columns": (spoil("beams/bodies", np.ones((4, 3), np.int32)), "/beams/bodies"),
    "wrong length": (spoil("beams/length", np.full(4, 7.0)), "/beams/length"),
    "factors of shear in the plane, one too few": (spoil("beams/shear_factor_y", np.ones(3)),
                                                   "/beams/shear_factor_y"),
    "an image elsewhere": (spoil("beams/image", np.tile([0, 0, 5.0], (4, 1))), "/beams/length"),
    "a strength of 0": (spoil("beams/strength", np.array([1, 1, 0, 1.0])), "/beams/strength"),
    "energies of too few": (spoil("beams/energy", np.ones(3)), "/beams/energy: has 3 rows"),
    "offsets of three numbers": (spoil("beams/offsets", np.ones((4, 3))), "/beams/offsets"),
    "offsets that change a length":
        (spoil("beams/offsets", np.tile([0, 0, 0.1, 0, 0, 0], (4, 1))),
         "/beams/length: row 0 is 1, but its ends are 1.00498756 m apart"),
    "set of a body that is not there": (spoil("sets/root", np.array([5], np.int32)), "/sets/root"),
    "a beam given twice":
        (spoil("beams/bodies", np.array([[0, 1], [1, 2], [1, 2], [3, 4]], np.int32)),
         "/beams/bodies: rows 1 and 2 both join bodies 1 and 2"),
    "every beam given twice": (twice, "/beams/bodies: rows 0 and 4 both join bodies 0 and 1"),
}


class LatticeFiles(BadInput):
    pass


def frame_file(change, scene=FILE):
    """Fills a folder with a frame that `change(file)` has spoilt, and a scene."""
    def prepare(folder):
        (folder / "scene.yaml").write_text(scene)
        fl.straight_frame(length=4, elements=4, section=fl.Section(1, 1)).write(folder / "bad.h5")
        with h5py.File(folder / "bad.h5", "r+") as file:
            change(file)
    return prepare


def without_sides(file):
    del file["beams/width"], file["beams/height"]


for title, (change, part) in LATTICE_FILES.items():
    LatticeFiles.case(title, ["scene.yaml"], part, frame_file(change))
LatticeFiles.case("fracture of sections without sides", ["scene.yaml"], "/beams/width",
                  frame_file(without_sides, FILE.replace("[beam]", "[beam, fracture]")))
LatticeFiles.case("not HDF5", ["scene.yaml"], "bad.h5",
                  lambda folder: [(folder / "scene.yaml").write_text(FILE),
                                  (folder / "bad.h5").write_text("no")])

# A point is carried by the nearest body: the frame's last one, at x = 4 m, reaches half a beam and
# more.
POINT = (FILE.replace("bad.h5", "good.h5")
         + "load: {names: [p], p: {point: [4.1, 0], force: [0, 0, 1]}}\n")


def good_frame(folder):
    (folder / "scene.yaml").write_text(POINT)
    fl.straight_frame(length=4, elements=4, section=fl.Section(1, 1)).write(folder / "good.h5")


class FarLoads(BadInput):
    def test_a_near_point_is_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            good_frame(Path(folder))
            self.assertEqual(launch.run("scene.yaml", cwd=folder).returncode, 0)


for title, point, distance in (("far ahead", "40,0", "36 m"), ("far aside", "2,9", "9 m")):
    FarLoads.case(title, ["scene.yaml", "-load_p_point", point],
                  f"load: p: point: lies {distance} from the nearest body", good_frame)


class Shapes(BadInput):
    """Of an obstacle and of loose bodies: cubes that are no closed convex polyhedra with plane
    faces."""


LOOSE = "integrator: explicit\nforces: [contact]\nlattice_file: good.h5\ncontact: {young: 1e7}\n"
CUBE = np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
                float) / 2
FACES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
# a corner that no plane of another face is beyond
DENTED = np.vstack([CUBE[:6], [[0.1, 0.1, 0.1]], CUBE[7:]])
SHAPES = {
    "without a top": (CUBE, FACES[:1] + FACES[2:], "faces must close"),
    "without two sides": (CUBE, FACES[:2] + FACES[2:5:2], "faces must close"),
    "a face twice": (CUBE, FACES + FACES[:1], "faces must close"),
    "a face the other way round": (CUBE, FACES[:5] + [FACES[5][::-1]], "faces must close"),
    "vertices of each face its own":
        (CUBE[np.concatenate(FACES)], [list(range(4 * k, 4 * k + 4)) for k in range(6)],
         "faces must close"),
    "flat": (CUBE * [1, 1, 0], FACES, "volume > 0"),
    "inside out": (CUBE, [face[::-1] for face in FACES], "counter-clockwise"),
    "dented": (DENTED, FACES, "not plane"),
}


def loose_body(path):
    fl.Lattice(np.array([[0.0, 0, 9]]), np.array([[1.0, 0, 0, 0]]), np.array([920.0]),
               np.full((1, 3), 920 / 6),
               shapes=fl.Shapes.boxes(np.ones((1, 3)))).write(path)


def spoil_shape(path, vertices, corners):
    with h5py.File(path, "a") as file:
        if "shapes" in file:
            del file["shapes"]
        file["shapes/vertices"] = vertices
        file["shapes/corners"] = np.concatenate(corners).astype(np.int32)
        file["shapes/corner_of"] = np.cumsum([0, *map(len, corners)]).astype(np.int32)
        file["shapes/face_of"] = np.array([0, len(corners)], np.int32)
        file["shapes/vertex_of"] = np.array([0, len(vertices)], np.int32)


def spoilt_obstacle(vertices, corners):
    def prepare(folder):
        loose_body(folder / "good.h5")
        spoil_shape(folder / "bad.h5", vertices, corners)
        (folder / "scene.yaml").write_text(LOOSE
                                           + "obstacle: {names: [o], o: {shape: file, file: "
                                             "bad.h5}}\n")
    return prepare


def spoilt_body(vertices, corners):
    def prepare(folder):
        loose_body(folder / "good.h5")
        spoil_shape(folder / "good.h5", vertices, corners)
        (folder / "scene.yaml").write_text(LOOSE)
    return prepare


for title, (vertices, corners, part) in SHAPES.items():
    Shapes.case("obstacle " + title, ["scene.yaml"], part, spoilt_obstacle(vertices, corners))
    if title != "dented":  # its centroid is not the origin, which is what is found first
        Shapes.case("body " + title, ["scene.yaml"], "/shapes", spoilt_body(vertices, corners))


class Bodies(BadInput):
    pass


def nested(folder):
    sizes = np.array([[3.0, 3, 3], [1, 1, 1]])
    mass = 920 * sizes.prod(1)
    fl.Lattice(np.zeros((2, 3)), np.array([[1.0, 0, 0, 0]] * 2), mass, mass[:, None] * sizes**2 / 6,
               shapes=fl.Shapes.boxes(sizes)).write(folder / "good.h5")
    (folder / "scene.yaml").write_text(LOOSE)


Bodies.case("a body inside another", ["scene.yaml"], "wholly inside", nested)
Bodies.case("more ranks than bodies", ["scene.yaml", "-sheet_length", "1", "-sheet_element_size",
                                       "1"], "ranks",
            scene_file(GOOD), ranks=(3,))  # 2 bodies


if __name__ == "__main__":
    unittest.main()
