#!/usr/bin/python3
"""floe make_parts and floe make_hull: parts files, pictures, hulls of ships, what is refused."""
import math
import os
import struct
import subprocess
import sys
import unittest

import h5py
import numpy as np

import launch
from launch import FLOE, REPOSITORY, FolderTest

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.make import hull as hulls  # noqa: E402

L_SHAPE = """v 0 0 0
v 3 0 0
v 3 1 0
v 1 1 0
v 1 2 0
v 0 2 0
v 0 0 2
v 3 0 2
v 3 1 2
v 1 1 2
v 1 2 2
v 0 2 2
f 6 5 4 3 2 1
f 7 8 9 10 11 12
f 1 2 8 7
f 2 3 9 8
f 3 4 10 9
f 4 5 11 10
f 5 6 12 11
f 6 1 7 12
"""


def read_stl(path):
    data = path.read_bytes()
    (count,) = struct.unpack("<I", data[80:84])
    rows = np.frombuffer(data[84:], np.dtype([("n", "<f4", 3), ("t", "<f4", (3, 3)),
                                              ("a", "<u2")]))
    assert len(rows) == count
    return rows["t"].astype(float)


class Tools(FolderTest):
    def setUp(self):
        super().setUp()
        self.cache = self.folder / "cache"

    def tool(self, name, *words, code=0):
        done = subprocess.run([sys.executable, str(REPOSITORY / "tools" / name),
                               *map(str, words)], cwd=self.folder, capture_output=True, text=True,
                              env={**launch.ENVIRONMENT, "FLOE": os.path.abspath(FLOE),
                                   "XDG_CACHE_HOME": str(self.cache)})
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr if code else done.stdout


class MakeParts(Tools):
    def test_parts_file(self):
        (self.folder / "l.obj").write_text(L_SHAPE)
        said = self.tool("make_parts", "l.obj", "--unit", 0.1, "-o", "l.h5", "--picture", "l.png")
        self.assertIn("l.obj: 20 triangles, 0.008 m3\nl.h5: 2 convex parts with 12 faces, 0.008 m3",
                      said)
        self.assertTrue((self.folder / "l.png").read_bytes().startswith(b"\x89PNG"))
        with h5py.File(self.folder / "l.h5") as file:
            shapes = {name: values[:] for name, values in file["shapes"].items()}
            self.assertAlmostEqual(file["shapes"].attrs["volume"], 0.008, 15)
        self.assertEqual(shapes["face_of"].tolist(), [0, 6, 12])
        self.assertEqual(shapes["vertex_of"].tolist(), [0, 8, 16])
        low, high = shapes["vertices"].min(0), shapes["vertices"].max(0)
        np.testing.assert_allclose([low, high], [[0, 0, 0], [0.3, 0.2, 0.2]], atol=1e-15)
        (kept,) = (self.cache / "floe").iterdir()
        again = self.tool("make_parts", "l.obj", "--unit", 0.1, "-o", "m.h5")
        self.assertIn("m.h5: 2 convex parts", again)
        self.assertEqual([kept], list((self.cache / "floe").iterdir()))
        filled = self.tool("make_parts", "l.obj", "--tolerance", 0.8, "-o", "m.h5")
        self.assertIn("m.h5: 1 convex part with", filled)

    def test_refused(self):
        (self.folder / "l.obj").write_text(L_SHAPE)
        (self.folder / "open.obj").write_text(L_SHAPE.rsplit("f", 1)[0])
        for words, part in (
                (["none.stl"], "argument FILE: 'none.stl': cannot be read"),
                (["open.obj"], "argument FILE: 'open.obj': the surface is open: the edge from "),
                (["l.obj", "--most-parts", 1], "needs more than 1 convex parts at a tolerance of 0"
                                               " m; a larger tolerance gives fewer"),
                (["l.obj", "--unit", 0], "argument --unit: 0 is not within 1e-09 to 1e+06"),
                (["l.obj", "--tolerance", -1], "argument --tolerance: -1 is not within"),
                (["l.obj", "-o", "no/parts.h5"], "argument -o: 'no' is no folder"),
                (["l.obj", "--picture", "x.txt"], "argument --picture: 'x.txt' must end in")):
            with self.subTest(words):
                said = self.tool("make_parts", *words, code=2)
                self.assertEqual(len(said.splitlines()), 1, said)
                self.assertTrue(said.startswith("floe make_parts: "), said)
                self.assertIn(part, said)
                self.assertFalse((self.folder / "parts.h5").exists())


class MakeHull(Tools):
    SIZES = ("--length", 75, "--beam", 17, "--draught", 6, "--depth", 9)

    def test_is_closed_and_symmetric(self):
        said = self.tool("make_hull", "ship.stl", *self.SIZES, "--stem", 25, "--flare", 8)
        triangles = read_stl(self.folder / "ship.stl")
        self.assertLess(abs(len(triangles) - 2000), 200)
        self.assertIn(f"ship.stl: {len(triangles)} triangles", said)
        edges = {}
        for triangle in triangles:
            corners = [tuple(corner) for corner in triangle]
            for a, b in zip(corners, corners[1:] + corners[:1]):
                self.assertNotIn((a, b), edges)
                edges[a, b] = True
        self.assertTrue(all((b, a) in edges for a, b in edges))

        def corners_of(all_triangles):
            return {frozenset(map(tuple, triangle)) for triangle in all_triangles}
        mirrored = triangles * [1, -1, 1] + 0.0
        # the deck's diagonals run one way
        side = (np.ptp(triangles[:, :, 2], axis=1) > 0)
        self.assertEqual(corners_of(triangles[side]), corners_of(mirrored[side]))
        self.assertEqual({tuple(p) for p in triangles.reshape(-1, 3)},
                         {tuple(p) for p in mirrored.reshape(-1, 3)})
        # the one that comes with floe
        ours = (REPOSITORY / "input/data/ship.stl").read_bytes()
        self.assertEqual(len(ours), (self.folder / "ship.stl").stat().st_size)
        np.testing.assert_allclose(read_stl(REPOSITORY / "input/data/ship.stl"), triangles,
                                   rtol=0, atol=1e-4)

    def test_follows_its_formula(self):
        hull = hulls.Hull(80, 16, 5, 8, stem=30, flare=0, midbody=0.5)
        triangles = hull.triangles(20000)
        # below the water: sections times waterlines; int (1 - u^4 - t^p)^(1/2) over the quarter
        # plane, by sums
        u = (np.arange(1500) + 0.5) / 1500
        exact = 0
        for exponent, length in ((2, 20), (4, 20)):
            t = u[:, None]
            exact += length * np.sqrt(np.clip(1 - u[None, :]**4 - t**exponent, 0, None)).mean()
        rake = 5 / math.tan(math.radians(30))
        exact += 40 * np.sqrt(1 - u**4).mean() - 2 * rake * (u * np.sqrt(1 - u**4)).mean()
        exact *= 16 * 5
        self.assertLess(abs(hulls.displacement(triangles) / exact - 1), 0.005)
        points = triangles.reshape(-1, 3)
        stem = points[(points[:, 1] == 0) & (points[:, 0] > 30) & (points[:, 2] >= 0)]
        np.testing.assert_allclose(stem[:, 0], 40 + stem[:, 2] / math.tan(math.radians(30)),
                                   atol=1e-4)
        water = points[points[:, 2] == 0]
        self.assertEqual(water[:, 0].max() - water[:, 0].min(), 80)
        self.assertEqual(water[:, 1].max(), 8)
        self.assertEqual((points[:, 2].min(), points[:, 2].max()), (-5, 3))

    def test_is_few_parts(self):
        ship = REPOSITORY / "input/data/ship.stl"
        said = self.tool("make_parts", ship, "--tolerance", 0.05)
        parts = int(said.split("parts.h5: ")[1].split()[0])
        self.assertLessEqual(parts, 3, said)
        with h5py.File(self.folder / "parts.h5") as file:
            facts = dict(file["shapes"].attrs)
            faces = len(file["shapes/corner_of"]) - 1
        self.assertLess(facts["distance"], 0.05)
        self.assertLess(faces, len(read_stl(ship)) / 1.5)
        self.assertAlmostEqual(facts["volume"], hulls.volume(read_stl(ship)), 6)
        self.assertAlmostEqual(facts["parts_volume"] / facts["volume"], 1, delta=5e-3)

    def test_refused(self):
        for words, part in (
                (["a.obj", *self.SIZES], "argument FILE.stl: 'a.obj' must end in .stl"),
                (["no/a.stl", *self.SIZES], "argument FILE.stl: 'no' is no folder"),
                (["a.stl", *self.SIZES, "--stem", 12], "argument --stem: 12: bow and stern go in"),
                (["a.stl", *self.SIZES, "--depth", 5], "argument --depth: 5 must be above the"),
                (["a.stl", *self.SIZES, "--flare", 45, "--draught", 8, "--stem", 60],
                 "argument --flare: 45: leaves no breadth at the keel")):
            with self.subTest(words):
                said = self.tool("make_hull", *words, code=2)
                self.assertEqual(len(said.splitlines()), 1, said)
                self.assertIn(part, said)
                self.assertFalse((self.folder / "a.stl").exists())


if __name__ == "__main__":
    unittest.main()
