#!/usr/bin/python3
"""floe plot_pressure: maps, pressures on areas and extent of contact of made files, whose numbers
are known."""
import re
import subprocess
import sys
import unittest

import h5py
import matplotlib
import numpy as np

from launch import REPOSITORY, FolderTest

matplotlib.use("Agg")
sys.path.insert(0, str(REPOSITORY / "python"))
from floe.results import pressure as pressures  # noqa: E402
from floe.run import Run  # noqa: E402

SIDE = 0.5
HEADER = "time,obstacle,patch,force_x,force_y,force_z\n"


def wall(columns=20, rows=6):
    """Square patches of a wall that faces along -x at x = 3."""
    y, z = np.meshgrid(SIDE * (np.arange(columns) - columns / 2 + 0.5),
                       SIDE * (np.arange(rows) - rows / 2 + 0.5), indexing="ij")
    n = y.size
    return {"centre": np.column_stack([np.full(n, 3.0), y.ravel(), z.ravel()]),
            "normal": np.tile([-1.0, 0, 0], (n, 1)), "area": np.full(n, SIDE**2),
            "size": np.full((n, 2), SIDE)}


def peaked(patches, y, z, largest, reach):
    """Pressures that fall with the distance from a point."""
    apart = np.hypot(patches["centre"][:, 1] - y, patches["centre"][:, 2] - z)
    return largest * np.maximum(1 - apart / reach, 0)


class PressureTest(FolderTest):
    def write(self, name, time, force, patches=None):
        patches = patches or wall()
        with h5py.File(self.folder / "lattice.h5", "a") as file:
            group = file.create_group(f"obstacles/{name}")
            for key, values in patches.items():
                group[f"patch_{key}"] = values
            for key, shape in (("position", (0, 3)), ("orientation", (0, 4)), ("mass", 0)):
                if f"bodies/{key}" not in file:
                    file.create_dataset(f"bodies/{key}", shape, float)
        path = self.folder / "pressure.csv"
        text = path.read_text() if path.exists() else HEADER
        for at, forces in zip(time, np.array(force)):
            vectors = -forces[:, None] * patches["normal"]
            for patch, vector in [("all", vectors.sum(axis=0)), *enumerate(vectors)]:
                if patch == "all" or vector.any():
                    text += ",".join([f"{at:.12g}", name, str(patch),
                                      *(f"{f:.17g}" for f in vector)]) + "\n"
        path.write_text(text)

    def read(self, name="wall"):
        return pressures.read(self.folder)[name]

    def plot(self, *words, code=0):
        done = subprocess.run([sys.executable, str(REPOSITORY / "tools/plot_pressure"),
                               str(self.folder), *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        if code:
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done.stderr if code else done.stdout


class Areas(PressureTest):
    def test_one_maximum(self):
        """The windows around one maximum are the patches of the largest pressures."""
        patches = wall()
        pressure = peaked(patches, 0.6, 0.2, 4e6, 2.0)
        self.write("wall", [0, 1, 2], pressure * SIDE**2 * np.array([[0.5], [1], [0.2]]))
        area, curve = pressures.area_curve(self.read())
        ordered = -np.sort(-pressure)
        np.testing.assert_allclose(area, SIDE**2 * np.arange(1, len(pressure) + 1), rtol=1e-12)
        np.testing.assert_allclose(curve, np.cumsum(ordered) / np.arange(1, len(pressure) + 1),
                                   rtol=1e-12)

    def test_windows_are_connected(self):
        """Of two maxima far apart the higher one gives the curve until its patches are used up; on
        the whole wall the curve is the whole force."""
        patches = wall()
        first, second = (peaked(patches, y, 0.25, p, 1.1) for y, p in ((-3.25, 4e6), (3.25, 3e6)))
        self.write("wall", [0], ((first + second) * SIDE**2)[None])
        area, curve = pressures.area_curve(self.read())
        ordered = -np.sort(-first)
        n = np.count_nonzero(first)
        self.assertEqual(n, 13)
        np.testing.assert_allclose(curve[:n], np.cumsum(ordered)[:n] / np.arange(1, n + 1),
                                   rtol=1e-12)
        self.assertLess(curve[n], (ordered.sum() + second.max()) / (n + 1) * 0.9)
        self.assertAlmostEqual(curve[-1] / ((first + second).mean()), 1, delta=1e-12)

    def test_largest_over_times(self):
        """A sharp peak at one time and a wide load at another: each where it is the larger one."""
        patches = wall()
        sharp = np.zeros(len(patches["area"]))
        sharp[37] = 5e6
        wide = np.full(len(sharp), 1e6)
        self.write("wall", [0, 1, 2], np.array([sharp, 0 * sharp, wide]) * SIDE**2)
        _, curve = pressures.area_curve(self.read())
        expected = np.maximum(5e6 / np.arange(1, len(sharp) + 1), 1e6)
        np.testing.assert_allclose(curve, expected, rtol=1e-12)

    def test_not_through_a_thin_wall(self):
        """Patches back to back are no neighbours; those around a corner of 45 degrees are."""
        patches = wall(2, 1)
        patches["centre"][1] = patches["centre"][0] + [0.1, 0, 0]
        patches["normal"][1] = [1, 0, 0]
        self.write("wall", [0], [[2e5, 1e5]], patches)
        self.assertEqual(self.read().neighbours(), [[], []])
        patches["normal"][1] = [-np.sqrt(0.5), np.sqrt(0.5), 0]
        self.write("corner", [0], [[2e5, 1e5]], patches)
        self.assertEqual(self.read("corner").neighbours(), [[1], [0]])
        for k, n in ((0, 3), (1, 5), (7, 8)):  # a wall 3 patches high: corner, edge, inside
            patches = wall(5, 3)
            if k == 0:
                self.write("high", [0], [patches["area"]], patches)
            self.assertEqual(len(self.read("high").neighbours()[k]), n)

    def test_iso(self):
        for area, pressure in ((1, 7.4e6), (0.1, 7.4e6 * 10**0.7), (10, 1.4765e6), (40, 1.48e6)):
            self.assertAlmostEqual(float(pressures.iso(area)) / pressure, 1, delta=1e-4)


class Maps(PressureTest):
    def test_extent_and_mean(self):
        n = len(wall()["area"])
        force = np.zeros((3, n))
        force[0, :30], force[1, :60] = 1e3, 2e3
        self.write("wall", [0, 1, 3], force)
        patches = self.read()
        np.testing.assert_allclose(patches.loaded(), [30 / n, 60 / n, 0], rtol=1e-15)
        np.testing.assert_allclose(patches.mean(patches.force)[[0, 40, 100]],
                                   [3.5e3 / 3, 1e3, 0], rtol=1e-14)
        self.assertEqual(len(patches.since(1).time), 2)

    def test_wall_is_a_plane(self):
        self.write("wall", [0], np.ones((1, 120)))
        x, half, label, z, tall, shown = pressures.unrolled(self.read())
        np.testing.assert_allclose(x, -wall()["centre"][:, 1], atol=1e-12)
        self.assertIn("[m]", label)
        self.assertTrue(shown.all() and (half == SIDE / 2).all() and (tall == SIDE / 2).all())

    def test_cone_is_unrolled(self):
        """Angles, heights and widths of a cone's patches about an axis off the origin; its lid is
        not shown."""
        angle, high = np.meshgrid(np.radians(np.arange(0, 360, 15) + 7.5), [-1.0, 0, 1],
                                  indexing="ij")
        angle, high = angle.ravel(), high.ravel()
        radius = 4 - high
        centre = np.column_stack([10 + radius * np.cos(angle), -5 + radius * np.sin(angle), high])
        normal = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle + 1]) / np.sqrt(2)
        patches = {"centre": np.vstack([centre, [[10, -5, 1.5]]]),
                   "normal": np.vstack([normal, [[0, 0, 1]]]),
                   "area": np.ones(len(angle) + 1),
                   "size": np.ones((len(angle) + 1, 2))}
        force = np.append(1.0 * (np.abs(angle - np.pi) < 1), 0)
        self.write("cone", [0], force[None], patches)
        one = self.read("cone")
        np.testing.assert_allclose(pressures.axis_of(one), [10, -5], atol=1e-12)
        x, half, label, z, tall, shown = pressures.unrolled(one)
        np.testing.assert_allclose(x[:-1], np.degrees(angle), atol=1e-9)  # ice from -x
        np.testing.assert_allclose(half[:-1], np.degrees(0.5 / radius), rtol=1e-12)
        np.testing.assert_allclose(tall[:-1], 0.5 / np.sqrt(2), rtol=1e-12)
        self.assertTrue(shown[:-1].all() and not shown[-1])
        self.assertIn("[°]", label)
        self.write("other_side", [0], np.append(1.0 * (np.cos(angle) > 0.5), 0)[None], patches)
        x = pressures.unrolled(self.read("other_side"))[0]
        self.assertLess(np.abs(x[force.size - 2]), 180)
        self.assertLess(x.min(), -170)


class Tool(PressureTest):
    def test_picture_and_numbers(self):
        patches = wall()
        pressure = peaked(patches, 0.25, 0.25, 3e6, 2.0)
        force = np.linspace(0, 1, 11)[:, None] * pressure * SIDE**2
        self.write("wall", np.arange(11) / 10, force)
        self.write("other", [0], np.zeros((1, 120)))
        said = self.plot("--obstacle", "wall")
        self.assertIn("largest pressure 3e+06 Pa on 0.25 m2 at (3, 0.25, 0.25), 1 s", said)
        on_one = np.mean(-np.sort(-pressure)[:4])
        found = re.search(r"on 1 m2 at most ([\d.e+]+) Pa, ([\d.]+) of ISO", said)
        self.assertAlmostEqual(float(found[1]) / on_one, 1, delta=1e-3)
        self.assertAlmostEqual(float(found[2]) / (on_one / 7.4e6), 1, delta=3e-3)
        share = np.count_nonzero(pressure) / len(pressure)
        found = re.search(r"in contact ([\d.]+) % of the area at most, ([\d.]+) %", said)
        self.assertAlmostEqual(float(found[1]), 100 * share, delta=0.1)
        self.assertAlmostEqual(float(found[2]), 100 * share * 0.95, delta=0.1)
        self.assertGreater((self.folder / "pressure.png").stat().st_size, 20000)
        figure = Run(self.folder).plot.pressure("wall")
        drawn = {axes.get_title(): axes.collections[0].get_array()
                 for axes in figure.axes if axes.get_title()}
        largest, mean = drawn["largest"], drawn["mean"]
        np.testing.assert_allclose(np.sort(largest), np.sort(pressure) / 1e6, rtol=1e-9)
        np.testing.assert_allclose(mean, largest / 2, rtol=1e-9)
        self.assertIn("x.svg", self.plot("--obstacle", "wall", "--start", "0.5", "--file",
                                         str(self.folder / "x.svg")))

    def test_refusals(self):
        self.assertIn("has no pressure.csv", self.plot(code=2))
        self.write("wall", [0, 1], np.zeros((2, 120)))
        text = (self.folder / "pressure.csv").read_text()
        (self.folder / "pressure.csv").write_text("no")
        self.assertIn("pressure.csv: cannot be read", self.plot(code=2))
        (self.folder / "pressure.csv").write_text(text + "1,wall,120,1,2,3\n")
        self.assertIn("pressure.csv: cannot be read", self.plot(code=2))
        (self.folder / "pressure.csv").write_text(text)
        self.assertIn("nothing touches wall", self.plot(code=2))
        self.assertIn("must be one of wall", self.plot("--obstacle", "hull", code=2))
        self.assertIn("start 3: is after", self.plot("--start", "3", code=2))
        self.assertIn("none: no such folder", subprocess.run(
            [sys.executable, str(REPOSITORY / "tools/plot_pressure"), "none"], capture_output=True,
            text=True).stderr)


if __name__ == "__main__":
    unittest.main()
