#!/usr/bin/python3
"""floe make_floes: fields of floes have the concentration, sizes, gaps and water that were asked
for."""
import contextlib
import importlib.machinery
import importlib.util
import io
import json
import math
import os
import resource
import subprocess
import sys
import unittest
from unittest import mock

import numpy as np
from shapely.geometry import LineString, Point, Polygon, box, mapping, shape

from launch import REPOSITORY, temporary_folder

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import program  # noqa: E402
from floe.make import packing  # noqa: E402
from floe.make import sizes as laws  # noqa: E402
from floe.make import tessellation  # noqa: E402

TOOL = REPOSITORY / "tools/make_floes"
sys.path.insert(0, str(TOOL.parent))  # as of a program that is started
loader = importlib.machinery.SourceFileLoader("make_floes", str(TOOL))
tool = importlib.util.module_from_spec(importlib.util.spec_from_loader("make_floes", loader))
loader.exec_module(tool)
REGION = (-100.0, 50.0, 500.0, 450.0)
FIELD = ("--region", *REGION, "--concentration", 60, "--sizes", "one:30")
# A bent floe, which is not convex, with a hole; and a smooth one.
BENT = Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)], [[(.5, .5), (1, .5), (1, 1)]])
OVAL = Polygon([(3 * math.cos(t / 20), 2 * math.sin(t / 20)) for t in range(126)])


def overlaps(polygons, gap=0.0):
    """Pairs of polygons nearer to each other than gap."""
    low, high = np.split(np.array([polygon.bounds for polygon in polygons]), 2, axis=1)
    near = np.all(low[:, None] < high[None] + gap + 1e-6, axis=2)
    return [(i, j) for i, j in zip(*np.nonzero(np.triu(near & near.T, 1)))
            if polygons[i].intersects(polygons[j]) or polygons[i].distance(polygons[j]) < gap]


class MakeFloes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = temporary_folder(cls.addClassCleanup)
        features = [{"type": "Feature", "properties": {}, "geometry": mapping(polygon)}
                    for polygon in (BENT, OVAL)]
        (cls.folder / "outlines.geojson").write_text(
            json.dumps({"type": "FeatureCollection", "features": features}))

    def run_it(self, *words, **how):
        """The tool in a process of its own."""
        return subprocess.run([sys.executable, str(TOOL), *map(str, words)], cwd=self.folder,
                              capture_output=True, text=True, **how)

    def called(self, *words):
        """The same within this process, which has its packages."""
        out, err = io.StringIO(), io.StringIO()
        with mock.patch.object(sys, "argv", [str(TOOL), *map(str, words)]), \
                contextlib.chdir(self.folder), contextlib.redirect_stdout(out), \
                contextlib.redirect_stderr(err), self.assertRaises(SystemExit) as end:
            program.run(tool.main)
        return subprocess.CompletedProcess(words, end.exception.code or 0, out.getvalue(),
                                           err.getvalue())

    def made(self, *words, file="field.geojson"):
        """Properties and polygons of the floes, what the tool said. What holds for every field is
        checked here."""
        done = self.called(file, *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stderr)
        features = json.loads((self.folder / file).read_text())["features"]
        rows = [feature["properties"] for feature in features]
        polygons = [shape(feature["geometry"]) for feature in features]
        self.assertEqual([row["id"] for row in rows], list(range(len(rows))))
        diameters = [row["diameter"] for row in rows]
        self.assertEqual(diameters, sorted(diameters, reverse=True))
        for row, polygon in zip(rows, polygons):
            self.assertTrue(polygon.is_valid and polygon.exterior.is_ccw)
            self.assertAlmostEqual(row["area"], polygon.area, delta=1e-3)
            self.assertAlmostEqual(row["diameter"], polygon.convex_hull.length / math.pi,
                                   delta=1e-4)
            self.assertLess(polygon.centroid.distance(Point(row["x"], row["y"])), 1e-4)
        return rows, polygons, done.stdout

    def test_every_shape(self):
        """No overlap, the concentration, the water that is kept open, the region."""
        lead = LineString([(-100, 300), (200, 200), (500, 250)]).buffer(15, 64)
        kept = [box(300, 300, 360, 330), Point(100, 100).buffer(25, 64)]
        water = box(*REGION).difference(lead).difference(kept[0]).difference(kept[1])
        for form, concentration, gap in (("voronoi", 90, 0.1), ("voronoi", 20, 0),
                                         ("regular:6", 75, 0), ("random", 70, 0.3),
                                         ("outlines:outlines.geojson", 65, 0)):
            with self.subTest(form=form, concentration=concentration):
                _, floes, said = self.made(
                    "--region", *REGION, "--concentration", concentration, "--sizes",
                    "lognormal:24:0.3", "--shape", form, "--gap", gap,
                    "--lead", "30:-100,300:200,200:500,250", "--keep-out", "box:300,300:360,330",
                    "--keep-out", "circle:100,100:25")
                self.assertEqual(overlaps(floes, gap), [])
                found = sum(floe.area for floe in floes) / water.area
                self.assertAlmostEqual(100 * found, concentration, delta=0.01)
                self.assertIn(f"(asked: {concentration} %)", said)
                for floe in floes:
                    self.assertLess(floe.difference(box(*REGION)).area, 1e-6)
                    for place in (lead, *kept):
                        self.assertLess(floe.intersection(place).area, 1e-6)
                # They lie on both sides of the lead, and Voronoi floes end on its banks.
                self.assertGreater(min(sum(floe.centroid.y > 300 for floe in floes),
                                       sum(floe.centroid.y < 200 for floe in floes)), 20)

    def test_outlines(self):
        """Scaled and turned, without their holes: the ratio of area to diameter is theirs."""
        _, floes, _ = self.made(*FIELD, "--shape", "outlines:outlines.geojson", "--tolerance", 0)
        forms = {round(floe.area / floe.convex_hull.length**2, 5) for floe in floes}
        self.assertEqual(forms, {round(p.area / p.convex_hull.length**2, 5)
                                 for p in (Polygon(BENT.exterior), OVAL)})
        corners = {len(floe.exterior.coords) for floe in floes}
        self.assertEqual(corners, {7, 127})
        _, floes, _ = self.made(*FIELD, "--shape", "outlines:outlines.geojson")
        self.assertTrue(all(len(floe.exterior.coords) < 40 for floe in floes))

    def test_sizes(self):
        """The exponent asked for is found in placed and in Voronoi floes, and is what is said."""
        for form, concentration in (("random", 50), ("voronoi", 85)):
            rows, _, said = self.made("--region", 0, 0, 500, 500, "--concentration", concentration,
                                      "--sizes", "power:10:100:2.2", "--shape", form)
            sizes = np.array([row["diameter"] for row in rows])
            exponent, error = laws.power_exponent(sizes, 10, 100)
            self.assertLess(error, 0.2)
            self.assertLess(abs(exponent - 2.2), 3 * error)
            told = float(said.split("exponent of the number above d: ")[1].split()[0])
            self.assertAlmostEqual(told, exponent, delta=error / 2)  # its bounds times the factor
        rows, _, said = self.made("--region", 0, 0, 700, 600, "--concentration", 60, "--sizes",
                                  "lognormal:20:0.4")
        logarithms = np.log([row["diameter"] for row in rows])
        self.assertLess(abs(logarithms.mean() - np.log(20)), 3 * 0.4 / np.sqrt(len(rows)))
        self.assertLess(abs(logarithms.std() - 0.4), 3 * 0.4 / np.sqrt(2 * len(rows)))
        rows, _, said = self.made(*FIELD, "--shape", "regular:6")
        for row in rows:  # a regular hexagon: perimeter pi d
            self.assertAlmostEqual(row["diameter"] / 30, 1, delta=0.01)
            self.assertAlmostEqual(row["area"] / row["diameter"]**2,
                                   math.sqrt(3) / 24 * math.pi**2, delta=1e-5)

    def test_seeds_and_thickness(self):
        words = (*FIELD, "--sizes", "power:15:60:2")
        files = []
        for name, seed, how in (("one", 1, self.called), ("again", 1, self.run_it),
                                ("two", 2, self.called)):
            self.assertEqual(how(f"{name}.geojson", *words, "--seed", seed).returncode, 0)
            files.append((self.folder / f"{name}.geojson").read_bytes())
        self.assertEqual(files[0], files[1])
        self.assertNotEqual(files[0], files[2])
        bare = self.made(*words)[0]
        self.assertNotIn("thickness", bare[0])
        for law, exponent in (("0.8", 0), ("uniform:0.5:1.5", 0), ("lognormal:1:0.2", 0.5)):
            rows, _, said = self.made(*words, "--thickness", law, "--thickness-exponent", exponent,
                                      "--csv", "floes.csv", "--picture", "floes.png")
            thickness = np.array([row.pop("thickness") for row in rows])
            self.assertEqual(rows, bare)  # the floes are the same
            diameter = np.array([row["diameter"] for row in rows])
            drawn = thickness / (diameter / diameter.mean())**exponent
            if law == "0.8":
                np.testing.assert_allclose(drawn, 0.8)
            elif law.startswith("uniform"):
                self.assertTrue(0.5 <= drawn.min() < 0.6 and 1.4 < drawn.max() <= 1.5)
            else:
                self.assertLess(abs(np.log(drawn).std() - 0.2), 3 * 0.2 / np.sqrt(2 * len(rows)))
        table = np.genfromtxt(self.folder / "floes.csv", delimiter=",", names=True)
        self.assertEqual(table.dtype.names, ("id", "x", "y", "diameter", "area", "thickness"))
        np.testing.assert_allclose(table["thickness"], thickness)
        np.testing.assert_allclose(table["x"], [row["x"] for row in rows])
        self.assertEqual((self.folder / "floes.png").read_bytes()[:4], b"\x89PNG")

    def test_bad_input(self):
        (self.folder / "bad.geojson").write_text("{")
        (self.folder / "none.geojson").write_text('{"type":"FeatureCollection","features":[]}')
        before = sorted(os.listdir(self.folder))
        for words, part in (
                (("--concentration", "10"), "--concentration: 10 is not within 20 to 95"),
                (("--concentration", "90"), "reach 80 %; --shape voronoi reaches 95 %"),
                (("--region", "0", "0", "0", "9"), "X0 is not below X1"),
                (("--region", "0", "0", "nan", "9"), "nan is not within"),
                (("--sizes", "power:10:5:2"), "10 is not below 5"),
                (("--sizes", "power:10:5"), "takes 3 numbers"),
                (("--sizes", "power:1:50:99"), "not within 0.1 to 10"),
                (("--sizes", "zipf:1"), "'zipf:1' is none of power"),
                (("--sizes", "one:700"), "700 m does not fit"),
                (("--sizes", "one:0.1"), "at most 200000"),
                (("--sizes", "one:x"), "numbers above 0"),
                (("--shape", "round"), "'round' is none of voronoi"),
                (("--shape", "regular:2"), "3 to 32 corners"),
                (("--shape", "outlines:nowhere.geojson"), "nowhere.geojson: cannot be read: No"),
                (("--shape", "outlines:bad.geojson"), "bad.geojson: cannot be read"),
                (("--shape", "outlines:none.geojson"), "none.geojson: has no polygons"),
                (("--shape", "voronoi", "--sizes", "one:300"), "at least 5 are needed"),
                (("--shape", "voronoi", "--concentration", "90", "--gap", "5"), "the --gap of 5 m"),
                (("--shape", "regular:4", "--concentration", "80", "--sizes", "one:90", "--gap",
                  "20"), "do not come apart"),
                (("--seed", "-1"), "--seed: -1 is not within"),
                (("--lead", "0:0,0:9,9"), "a width above 0"),
                (("--lead", "9:0,0"), "is not WIDTH:X,Y"),
                (("--keep-out", "circle:0,0:-1"), "radius is not above 0"),
                (("--keep-out", "disc:0,0:1"), "is neither circle"),
                (("--keep-out", "box:-999,-999:999,999"), "leave no water"),
                (("--thickness", "thick"), "'thick' is none of METRES"),
                (("--thickness", "uniform:2:1"), "2 is not below 1"),
                (("--thickness-exponent", "1"), "needs --thickness"),
                (("--picture", "x.zzz"), "must end in one of"),
                (("--colour", "red"), "unrecognized arguments")):
            with self.subTest(words=words):
                done = self.called("bad_input.geojson", *FIELD, *words)
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertIn(part, done.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_whole_or_not_at_all(self):
        """A file that does not fit leaves the one that was there."""
        self.made(*FIELD, file="kept.geojson")
        before = (self.folder / "kept.geojson").read_bytes()
        names = sorted(os.listdir(self.folder))
        done = self.run_it("kept.geojson", *FIELD, "--seed", 5, preexec_fn=lambda:
                           resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)))
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (1, 1), done.stderr)
        self.assertEqual((self.folder / "kept.geojson").read_bytes(), before)
        self.assertEqual(sorted(os.listdir(self.folder)), names)


class Parts(unittest.TestCase):
    def test_exponent(self):
        """By hand: without an end a = 1 / mean ln(d / least); the mean of many fits is what was
        drawn, and their deviation the standard error."""
        sizes = np.exp(np.linspace(0.1, 1.9, 10))
        self.assertAlmostEqual(laws.power_exponent(sizes, 1, 1e12)[0], 1, 6)
        random = np.random.default_rng(3)
        law = laws.Power(2, 30, 1.7)
        fits = np.array([laws.power_exponent(law.draw(random, 500), 2, 30)
                         for _ in range(400)])
        error = fits[:, 1].mean()
        self.assertLess(abs(fits[:, 0].mean() - 1.7), 3 * error / 20 + 0.01)
        self.assertAlmostEqual(fits[:, 0].std() / error, 1, delta=0.12)
        sizes = law.draw(random, 200000)
        self.assertAlmostEqual(np.mean(sizes**2) / law.mean_square(), 1, delta=0.02)

    def test_cells(self):
        """Areas as asked; they fill the rectangle; derivatives are those of differences."""
        random = np.random.default_rng(5)
        x, rectangle = random.random((60, 2)) * [3, 2], (0, 0, 3, 2)
        target = 1 + random.random(60)
        target *= 6 / target.sum()
        diagram, w = tessellation.with_areas(x, np.zeros(60), target, rectangle, 1e-9)
        np.testing.assert_allclose(diagram.area, target, rtol=1e-8)
        cells = [Polygon(corners) for corners in diagram.cells()]
        self.assertAlmostEqual(sum(cell.area for cell in cells), 6, 9)
        for cell, perimeter, centre in zip(cells, diagram.perimeter, diagram.centroid):
            self.assertAlmostEqual(cell.length, perimeter, 9)
            self.assertLess(cell.centroid.distance(Point(centre)), 1e-9)
        for k in (0, 17):
            change = np.zeros(60)
            change[k] = 1e-6
            plus, minus = (tessellation.Diagram(x, w + s * change, rectangle).area
                           for s in (1, -1))
            np.testing.assert_allclose((plus - minus) / 2e-6,
                                       diagram.derivative()[:, k].toarray().ravel(), atol=1e-6)

    def test_pairs(self):
        """As by trying all."""
        random = np.random.default_rng(7)
        x, reach = random.random((300, 2)), 0.002 * np.exp(3 * random.random(300))
        i, j = packing.near_pairs(x, reach)
        found = {(min(a, b), max(a, b)) for a, b in zip(i, j)}
        self.assertEqual(len(found), len(i))
        distance = np.hypot(*(x[:, None] - x[None]).transpose(2, 0, 1))
        a, b = np.nonzero(np.triu(distance < reach[:, None] + reach, 1))
        self.assertEqual(found, set(zip(a, b)))


if __name__ == "__main__":
    unittest.main()
