#!/usr/bin/python3
"""Reports (floe report): one file without the network, whose data are those of the run to the
precision that it states; where forces act, by hand; ensembles.

What a browser makes of it: test_report_browser.py.
"""
import csv
import re
import subprocess
import sys
import unittest

import numpy as np

from launch import ENVIRONMENT, FLOE, REPOSITORY, FolderTest
from report_scenes import make_report, run_cone

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.lattice import Shapes  # noqa: E402
from floe.report import map as force_map  # noqa: E402
from floe.report import scene as scenes  # noqa: E402
from floe.report.arrays import pack, unpack  # noqa: E402
from floe.report.page import data_in  # noqa: E402
from floe.report.series import thinned  # noqa: E402
from floe.results.output import Output, matrices, rotations  # noqa: E402

# Names of kinds of elements, which no browser loads.
NAMESPACES = {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xhtml"}
STATIC = """forces: [beam]
sheet: {length: 10, thickness: 1, element_size: 3, iterations: 5}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [b], b: {set: right, force: [0, 0, 1e4]}}
"""


def box_obstacle(motions=()):
    """A cube with sides of 2 m about (10, 0, 1)."""
    shape = Shapes.boxes([[2, 2, 2]])
    ends, origin = shape.corner_of, np.array([10.0, 0, 1])
    faces = [list(shape.corners[ends[k]:ends[k + 1]]) for k in range(len(ends) - 1)]
    return {"name": "box", "points": (origin + shape.vertices).tolist(), "faces": faces,
            "origin": origin.tolist(), "motions": list(motions), "plane": False}


def table(force, moment):
    """A history with these rows."""
    return {f"box_{what}_{axis}": np.array(rows, float)[:, k]
            for what, rows in (("force", force), ("moment", moment))
            for k, axis in enumerate("xyz")}


class Parts(unittest.TestCase):
    """Several checks make one case: each case is a process, which loads scipy."""

    def test_arrays_and_series(self):
        self.arrays_come_back()
        self.smooth_rows_are_short()
        self.wild_motion_is_short_enough()
        self.thinned_series_keep_extremes()
        self.frames_are_spread_evenly()

    def test_where_forces_act(self):
        self.force_enters_where_it_acts()
        self.map_goes_with_the_obstacle()
        self.areas_of_cells_are_those_of_the_surface()

    def arrays_come_back(self):
        random = np.random.default_rng(1)
        for size in (1, 200, 40000, 2**28 - 1):
            for shape in ((1, 0), (7,), (5, 3, 4), (40, 6, 9)):
                values = random.integers(-size, size + 1, shape)
                np.testing.assert_array_equal(unpack(pack(values)), values)
        with self.assertRaises(ValueError):
            pack([[2**28]])

    def smooth_rows_are_short(self):
        """Constant velocities leave no differences of differences."""
        random, rows = np.random.default_rng(1), np.arange(50)[:, None]
        velocity = random.integers(-500, 500, 400)
        steady, wild = pack(velocity * rows), pack(random.integers(-9000, 9000, (50, 400)))
        self.assertEqual(steady["orders"][2:], [2] * 48)
        self.assertLess(len(steady["data"]), len(wild["data"]) / 10)

    def wild_motion_is_short_enough(self):
        """A tenth of 10,000 bodies in 200 frames, each coordinate by chance by 100 steps a frame
        (0.05 m, 0.1 rad), take less than a tenth of 30 MB less the page."""
        moves = np.random.default_rng(1).normal(size=(200, 6, 1000)) * 100
        packed = pack(np.rint(np.cumsum(moves, axis=0)).astype(int))
        self.assertLess(len(packed["data"]), 2.5e6)

    def thinned_series_keep_extremes(self):
        y = np.random.default_rng(1).normal(size=100000)
        x, kept = thinned(np.arange(len(y)), y, 200)
        self.assertLessEqual(len(x), 402)
        self.assertEqual((kept.min(), kept.max()), (y.min(), y.max()))
        self.assertTrue(np.all(np.diff(x) > 0) and np.all(y[x.astype(int)] == kept))

    def frames_are_spread_evenly(self):
        self.assertEqual(list(scenes.chosen(5, 200)), [0, 1, 2, 3, 4])
        self.assertEqual(list(scenes.chosen(9, 3)), [0, 4, 8])
        self.assertEqual(scenes.step_of(1.3), 1e-3)

    def force_enters_where_it_acts(self):
        """A force at a point of a face, with a couple along it, which moves no line of action."""
        at = np.array([[-1, 0.3, 0.4], [-1, -0.9, -0.2], [0.5, -1, 0.7], [0.2, 0.1, 1]])
        force = np.array([[5.0, 1, -2], [3, 0.2, 0], [1, 4, 1], [0.5, 0.5, -7]])
        moment = np.cross(at, force) + 0.37 * force
        world, own, _ = force_map.action(box_obstacle(), table(force, moment), "box")
        np.testing.assert_allclose(own, at, atol=1e-12)
        np.testing.assert_allclose(world, at + [10, 0, 1], atol=1e-12)
        # a force that pulls, one that misses the cube, one that is small
        force = np.array([[5.0, 0, 0], [5, 0, 0], [5, 0, 0], [0.05, 0, 0]])
        at = np.array([[-1, 0, 0], [-1, 3, 0], [-1, 0, 1.2], [-1, 0, 0]])
        _, own, _ = force_map.action(box_obstacle(), table(force, np.cross(at, force)), "box")
        self.assertEqual(np.isfinite(own[:, 0]).tolist(), [True, False, False, False])

    def map_goes_with_the_obstacle(self):
        """The cube has gone by (0, 0, 2) and turned by a quarter about z: a force along y enters
        the face that looks to -x at rest."""
        quarter = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        obstacle = box_obstacle([([0, 0, 2], quarter)])
        at, force = np.array([[0.2, -1, 0.5]]), np.array([[0, 6.0, 0]])
        world, own, _ = force_map.action(obstacle, table(force, np.cross(at, force)), "box")
        np.testing.assert_allclose(world, [[10.2, -1, 3.5]], atol=1e-12)
        np.testing.assert_allclose(own, [[-1, -0.2, 0.5]], atol=1e-12)

    def areas_of_cells_are_those_of_the_surface(self):
        obstacle = box_obstacle()
        coordinate = force_map.coordinates(obstacle, np.array([4.0, 0, 0]))
        angle, height = coordinate(np.array([[-1, 0, 0.5], [0, -1, 0], [0, 1, 0]]))
        np.testing.assert_allclose(angle, [0, 90, -90], atol=1e-9)  # 0 is where the ice comes from
        np.testing.assert_allclose(height, [1.5, 1, 1])
        edges = [np.linspace(-45, 45, 4), np.linspace(0.5, 1.5, 3)]
        area = force_map.areas(obstacle, coordinate, edges)
        # the cell of the angle a is 2 tan a wide
        wide = np.diff(np.tan(np.radians(edges[0])))
        np.testing.assert_allclose(area, 0.5 * np.array([wide, wide]), rtol=0.03)


class Run(FolderTest):
    def test_page_and_data(self):
        run_cone(self.folder / "cone")
        make_report(self.folder / "cone")
        text = (self.folder / "cone/report.html").read_text()
        report = data_in(text)
        self.page_loads_nothing(text)
        output = Output(self.folder / "cone")
        self.words_are_those_of_the_run(report, output)
        self.numbers_are_those_of_the_run(report, output)
        self.places_are_those_of_the_run(report["scene"], output)
        self.shapes_are_those_of_the_run(report["scene"], output)
        self.cracks_are_where_the_run_has_them(report["scene"], output)
        self.forces_act_on_the_cone(report, output)
        self.fewer_frames_make_it_smaller(len(text), report)

    def page_loads_nothing(self, text):
        self.assertTrue(text.startswith("<!doctype html>") and text.endswith("</html>\n"))
        self.assertLess(len(text), 1.5e6)
        found = set(re.findall(r"(?:https?|wss?|ftp)://[^\s\"'`<>()\\]+", text))
        self.assertLessEqual(found, NAMESPACES)
        head = text[:text.index('id="data"')]
        self.assertIn("default-src 'none'", head)
        for word in ("<link", "<img", "<iframe", "<object", " src=", "@import", "url("):
            self.assertNotIn(word, head)
        scripts = re.findall(r"<script[^>]*>", text)
        self.assertEqual(sum("src" in script for script in scripts), 0)
        self.assertEqual(text.count("<script"), text.count("</script>"))

    def words_are_those_of_the_run(self, report, output):
        facts = dict(report["facts"])
        self.assertTrue(facts["scene"].endswith("ice_cone.yaml"))
        self.assertIn(output.summary["version"], facts["floe"])
        self.assertIn(output.summary["built_for"], facts["processor"])
        self.assertEqual(facts["seeds"], "sheet 1")
        self.assertIn("cone", facts["obstacles"])

    def numbers_are_those_of_the_run(self, report, output):
        (load,), summary = report["loads"], output.summary
        statement = load["statement"]
        self.assertEqual(statement["filter"], "running mean over 0.5 s")
        self.assertAlmostEqual(statement["largest_of_a_step"] / np.linalg.norm(
            summary["peak_force"]["cone"]), 1, 9)
        highest = max(load["course"][1]["y"]) * load["size"]
        self.assertAlmostEqual(highest / max(statement["largest_of_runs"]), 1, 4)
        self.assertEqual(report["fragments"]["number"], summary["fragments"])
        self.assertEqual(report["fragments"]["broken"], summary["beams_broken"])
        self.assertGreater(summary["beams_broken"], 3)  # else this run shows little
        rows = report["energies"]["rows"]
        total = {kind: sum(row["end"] for row in rows if row["kind"] == kind)
                 for kind in ("put in", "stored", "lost")}
        self.assertAlmostEqual(total["put in"] - total["stored"] - total["lost"], 0,
                               delta=1.01 * report["energies"]["error"] + 1e-6)

    def places_are_those_of_the_run(self, scene, output):
        step, turn = scene["step"], scene["turn_step"]
        poses, places = unpack(scene["poses"]), unpack(scene["places"])
        self.assertEqual(poses.shape, (len(output.times), 6, len(output.position)))
        for k, time in enumerate(output.times):
            exact = output.position + output.field("bodies_displacement", time) - scene["origin"]
            np.testing.assert_allclose((places + poses[k, :3]).T * step, exact,
                                       atol=0.5001 * step, rtol=0)
            np.testing.assert_allclose(poses[k, 3:].T * turn,
                                       output.field("bodies_rotation", time), atol=0.5001 * turn,
                                       rtol=0)
        np.testing.assert_allclose(scene["masses"], output.mass, rtol=1e-4)
        np.testing.assert_allclose(scene["times"], output.times, atol=1e-6)

    def shapes_are_those_of_the_run(self, scene, output):
        shapes = output.shapes
        body = np.repeat(np.arange(len(output.position)), np.diff(shapes["vertex_of"]))
        exact = np.einsum("vij,vj->vi", matrices(output.orientation)[body], shapes["vertices"])
        np.testing.assert_allclose(unpack(scene["corners"]).T * scene["step"], exact,
                                   atol=0.5001 * scene["step"])
        # all of it together: where the run says that the corners are in its last frame
        poses = unpack(scene["poses"])[-1]
        centres = (unpack(scene["places"]) + poses[:3]).T * scene["step"] + scene["origin"]
        turn = rotations(poses[3:].T * scene["turn_step"])
        points = centres[body] + np.einsum("vij,vj->vi", turn[body],
                                           unpack(scene["corners"]).T * scene["step"])
        reach = np.linalg.norm(exact, axis=1).max() * scene["turn_step"]
        np.testing.assert_allclose(points, output.field("points", output.times[-1]),
                                   atol=scene["step"] + reach)
        np.testing.assert_array_equal(unpack(scene["sides"])[0], np.diff(shapes["corner_of"]))
        np.testing.assert_array_equal(unpack(scene["counts"]), [np.diff(shapes["vertex_of"]),
                                                                np.diff(shapes["face_of"])])
        first = np.repeat(shapes["vertex_of"][:-1], np.diff(shapes["corner_of"][shapes["face_of"]]))
        np.testing.assert_array_equal(unpack(scene["faces"])[0] + first, shapes["corners"])

    def cracks_are_where_the_run_has_them(self, scene, output):
        time = output.times[-1]
        carrier, ended = unpack(scene["cracks"]["of"])
        corners = unpack(scene["cracks"]["corners"]).reshape(-1, 4, 3) * scene["step"]
        points = output.field("crack_points", time)[output.field("cracks", time)]
        self.assertEqual(len(corners), 2 * output.summary["beams_broken"])
        place = output.position + output.field("bodies_displacement", time)
        turn = rotations(output.field("bodies_rotation", time))
        placed = place[carrier][:, None] + np.einsum("fij,fkj->fki", turn[carrier], corners)
        np.testing.assert_allclose(placed, points, atol=scene["step"])
        self.assertTrue(np.all((ended > 0) & (ended <= 1000 * time + 1)))

    def forces_act_on_the_cone(self, report, output):
        """Arrows end on the cone's surface, of radius 6 m less 0.6 times the height."""
        arrow = next(a for a in report["scene"]["arrows"] if a["kind"] == "obstacle")
        at = np.array([p for p in arrow["at"] if p]) + report["scene"]["origin"]
        self.assertGreater(len(at), 5)
        radius = np.hypot(at[:, 0] - 12.2, at[:, 1])
        circle = 6 - 0.6 * (at[:, 2] + 4)
        self.assertTrue(np.all((radius < circle + 0.01) & (radius > circle * np.cos(np.pi / 36)
                                                           - 0.01)))
        shown = report["loads"][0]["map"]
        self.assertGreater(shown["share"], 0.8)
        self.assertGreater(max(v for row in shown["values"] for v in row if v), 0)

    def fewer_frames_make_it_smaller(self, size, report):
        cone, file = self.folder / "cone", self.folder / "small.html"
        make_report(cone, "--file", file, "--frames", 5)
        few = data_in(file.read_text())["scene"]
        self.assertEqual(len(few["times"]), 5)
        self.assertEqual((few["times"][0], few["times"][-1], few["of_frames"]),
                         (0, report["scene"]["times"][-1], len(report["scene"]["times"])))
        most = (size - 500) / 1e6
        make_report(cone, "--file", file, "--size", most)
        self.assertLess(file.stat().st_size, most * 1e6)
        self.assertEqual(len(data_in(file.read_text())["scene"]["times"]),
                         len(report["scene"]["times"]) // 2)

    def test_run_without_obstacles(self):
        (self.folder / "s.yaml").write_text(STATIC)
        subprocess.run([FLOE, "s.yaml"], cwd=self.folder, check=True, capture_output=True,
                       env=ENVIRONMENT)
        make_report(self.folder / "out/s")
        report = data_in((self.folder / "out/s/report.html").read_text())
        self.assertEqual(report["loads"], [])
        self.assertIn("no obstacles", report["no_loads"])
        self.assertIsNone(report["fragments"])
        self.assertGreater(len(report["reactions"]["series"]), 0)


class Ensemble(FolderTest):
    def test_page_links_and_law(self):
        for seed in (1, 2, 3):
            run_cone(self.folder / f"runs/s{seed}", "-sheet_seed", str(seed), "-time_end", "4",
                     "-output_fields", "2")
        with open(self.folder / "runs.csv", "w", newline="") as file:
            csv.writer(file).writerows([["run", "seed", "status"], ["s1", 1, "done"],
                                        ["s2", 2, "done"], ["s3", 3, "done"],
                                        ["s4", 4, "waiting"]])
        make_report(self.folder, "--runs")
        text = (self.folder / "report.html").read_text()
        report = data_in(text)
        rows = {row[0]: row for row in report["runs"]["rows"]}
        self.assertEqual(rows["s2"][1], "runs/s2/report.html")
        self.assertTrue((self.folder / rows["s2"][1]).exists())
        self.assertEqual([rows[name][2] for name in ("s1", "s2", "s3")], ["1", "2", "3"])
        self.assertEqual(rows["s4"][3], "waiting")
        (group,) = report["groups"]
        maxima = group["exceedance"][0]
        np.testing.assert_allclose(np.array(maxima["x"]) * (
            1e6 if group["unit"] == "MN" else 1e3), sorted(group["statement"]["maxima"]),
            rtol=1e-4)
        self.assertEqual(len(group["courses"]), 3)
        self.assertTrue(group["statement"]["gumbel"]["weak"])
        self.assertNotIn("THREE", text)
        make_report(self.folder, "--file", self.folder / "runs/all.html")
        moved = data_in((self.folder / "runs/all.html").read_text())
        self.assertEqual(moved["runs"]["rows"][0][1], "s1/report.html")


if __name__ == "__main__":
    unittest.main()
