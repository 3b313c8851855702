#!/usr/bin/python3
"""Measures of docs/validation.md on ice as it is found, on made numbers of which the answer is
known: ridging, layers, porosity, shear box, punch, endless ice, floes of several shapes."""
import subprocess
import sys
import unittest
from unittest import mock

import numpy as np

from launch import FLOE, REPOSITORY, FolderTest
from launch import run as floe

sys.path.insert(0, str(REPOSITORY / "tools"))
sys.path.insert(0, str(REPOSITORY / "python"))
import floe_validation as validation  # noqa: E402
import floe_validation_formulas as formulas  # noqa: E402
import floe_validation_ice as ice  # noqa: E402
import floe_validation_loads as loads  # noqa: E402

PUNCH = """integrator: explicit
forces: [gravity, buoyancy, contact]
lattice_file: block.h5
water: {density: 1010}
contact: {young: 1e7}
obstacle:
  names: [plate]
  plate: {shape: cylinder, base: [0, 0, 0.52], radius: 0.8, height: 1, velocity: [0, 0, -0.5]}
time: {end: 1.2}
output: {history: 0.01, fields: 1}
"""


class Cubes:
    """Upright boxes as fields.Bodies has polyhedra."""

    def __init__(self, low, high):
        self.low, self.high = np.array(low, float), np.array(high, float)

    def planes(self, body):
        return np.vstack([np.eye(3), -np.eye(3)]), np.append(self.high[body], -self.low[body])


class Formulas(unittest.TestCase):
    def test_layers(self):
        """A sheet 40 h long that lies in n layers, h/2 apart, over 12 h of it."""
        h, width, step = 0.5, 6.0, 0.25
        x, y = np.meshgrid(np.arange(-10 + step / 2, 10, step), np.arange(step / 2, width, step),
                           indexing="ij")
        places = np.column_stack([x.ravel(), y.ravel()])
        for n in (1, 2, 5):
            piled = (places[:, 0] > 2) & (places[:, 0] < 8)
            solid = np.where(piled, n * h, h)
            bottom = -solid - piled * (n - 1) * h / 2
            thickness, number = ice.strips(places, 0 * solid, bottom, solid, h, width, step)
            np.testing.assert_allclose(number, [1] * 12 + [n] * 6 + [1] * 2)
            np.testing.assert_allclose(thickness, [1] * 12 + [1.5 * n - 0.5] * 6 + [1] * 2)

    def test_porosity(self):
        """Boxes that fill a quarter, also where two overlap or reach beyond the box."""
        whole = [0, 0, 0], [4, 4, 4]
        bodies = Cubes([[0, 0, 0], [0, 0, 1], [9, 9, 9]], [[4, 2, 2], [4, 2, 2], [10, 10, 10]])
        self.assertAlmostEqual(ice.porosity_within(bodies, *map(np.array, whole), 0.25), 0.75)
        bodies = Cubes([[-5, -5, -5]], [[4, 2, 2]])
        self.assertAlmostEqual(ice.porosity_within(bodies, *map(np.array, whole), 0.25), 0.75)

    def test_ratio_of_means(self):
        ratio, half = loads.ratio_of_means([3.0, 5.0], [2.0, 2.0])
        self.assertAlmostEqual(ratio, 2)
        self.assertAlmostEqual(half, 2 * (1 / 4) * 4.3027, 3)  # Student's t of 2 degrees of freedom
        self.assertEqual(loads.ratio_of_means([3.0], [2.0]), (1.5, 0.0))


class Made(FolderTest):
    def made(self, name, table, options):
        """A run of these columns and options."""
        run = self.folder / name
        run.mkdir()
        rows = [",".join(table)] + [",".join(map(repr, map(float, row)))
                                    for row in zip(*table.values())]
        (run / "history.csv").write_text("\n".join(rows) + "\n")
        (run / "options.yaml").write_text("".join(f"{key}: {value}\n"
                                                  for key, value in options.items()))

        class Named:
            pass
        Named.name = name
        return validation.Drawn(Named, run)

    def pushed(self, name, force, options, obstacle):
        """A run in which an obstacle bears these forces in x in the intervals of 0.05 s."""
        time = 0.05 * np.arange(len(force) + 1)
        mean = np.concatenate([[0], np.cumsum(force) / np.arange(1, len(force) + 1)])
        table = {"time": time}
        for axis in "xyz":
            of_x = axis == "x"
            table |= {f"{obstacle}_force_{axis}": mean * of_x,
                      f"{obstacle}_mean_force_{axis}": mean * of_x,
                      f"{obstacle}_peak_force_{axis}": mean * of_x}
        return self.made(name, table, options)

    def test_ridge_building(self):
        """A first peak, then forces as h; 15 times the gain of potential energy over the last part,
        30 times over the whole."""
        runs = []
        way = np.linspace(0, 10, 401)
        for h in (0.25, 0.5, 1.5):
            for seed in (1, 2, 3):
                force = np.where(way < 2, 90, 10) * 12e3 * h * (1 + 0.1 * seed)
                work = np.concatenate([[0], np.cumsum(np.diff(way) * (force[1:] + force[:-1]) / 2)])
                first = int(np.searchsorted(way, 2))
                gain = np.where(way < 2, 0, (work - work[first]) / 15)
                runs.append(self.made(f"h{h}_s00{seed}", {
                    "hold_force_x": -force, "push_displacement_x": way, "energy_gravity": -way,
                    "energy_water": way + gain}, {"sheet_thickness": h, "sheet_width": 12}))
        found = ice.ridge_building(runs, {"start": 0.2, "published_ratio": 15,
                                          "allowed_ratio": [10, 20]})
        lines = {line.what: line for line in found.lines}
        line = lines["exponent of thickness in the mean force per width"]
        np.testing.assert_allclose(line.values, 1, rtol=1e-9)
        self.assertEqual(line.verdict, "agrees")
        np.testing.assert_allclose(lines["h = 0.5 m: mean force per width"].values,
                                   [5500, 6000, 6500], rtol=1e-9)
        np.testing.assert_allclose(lines["h = 0.5 m: largest force per width before"].values,
                                   [49500, 54000, 58500], rtol=1e-9)
        self.assertAlmostEqual(lines["h = 1.5 m: the same of the last part of the way"].mean, 15, 6)
        whole = lines["h = 1.5 m: work over the gain of potential energy"]
        self.assertGreater(whole.mean, 40)
        self.assertEqual(whole.verdict, "disagrees")
        # not as h
        for run in runs:
            run.options["sheet_thickness"] = str(run.option("sheet_thickness")**2)
        found = ice.ridge_building(runs, {"start": 0.2, "published_ratio": 15,
                                          "allowed_ratio": [10, 20]})
        self.assertEqual(found.lines[0].verdict, "disagrees")

    def test_shear_box(self):
        """6 kPa in the second second, 2 kPa otherwise."""
        time = np.arange(0, 6.0001, 0.05)
        stress = np.where((time > 1) & (time < 2), 6e3, 2e3)
        run = self.made("bonds_s001", {"time": time, "bottom_force_x": -stress * 20},
                        {"model_periodic": "4, 5"})
        found = ice.shear_box([run], {"mean": 0.5, "last": 1 / 3, "allowed": [1.7, 4],
                                      "labels": {"bonds": "b"}})
        self.assertAlmostEqual(found.lines[0].mean, 6, 6)
        self.assertEqual(found.lines[0].verdict, "disagrees")
        self.assertAlmostEqual(found.lines[1].mean, 2, 6)
        self.assertEqual(found.lines[1].verdict, "agrees")

    def test_endless(self):
        """A load that steps up at half time, over ISO's with no rubble and with 1 m of it."""
        options = {"sheet_thickness": 0.5, "sheet_width": 10, "obstacle_slope_friction": 0.1,
                   "fracture_tensile_strength": 5e5, "ice_young": 4e9, "contact_friction": 0.2,
                   "water_density": 1010, "ice_density": 920}
        settings = {"obstacle": "slope", "angle": 45, "repose": 40, "filter": 1, "start": 5,
                    "mean": 5, "allowed": [0.47, 0.78]}
        runs = []
        for seed in (1, 2):
            force = np.where(np.arange(2100) < 1100, 1e5, 1e5 * (1 + seed))
            runs.append(self.pushed(f"s00{seed}", force, options, "slope"))
        with mock.patch.object(loads, "rubble_height", return_value=1.0):
            found = loads.endless(runs, settings)
        lines = {line.what: line for line in found.lines}
        given = (0.5, 10, 45, 0.1, 5e5, 4e9)
        iso = formulas.iso_slope(*given, 1.0, ice_friction=0.2)["H"]
        bare = formulas.iso_slope(*given, ice_friction=0.2)["H"]
        peaks = np.array(lines["largest value"].values)
        np.testing.assert_allclose(peaks, [2e5, 3e5], rtol=0.04)  # the filter overshoots
        np.testing.assert_allclose(found.lines[0].values, peaks / iso, rtol=1e-9)
        np.testing.assert_allclose(lines["largest value over ISO without rubble"].values,
                                   peaks / bare, rtol=1e-9)
        np.testing.assert_allclose(lines["largest mean of 5 s"].values, [2e5, 3e5], rtol=1e-2)
        np.testing.assert_allclose(lines["mean"].values, [1.5e5, 2e5], rtol=1e-3)
        np.testing.assert_allclose(lines["mean of the second half over that of the first"].values,
                                   [2, 3], rtol=1e-2)
        # L-moments of two numbers: beta = (b - a)/(2 ln 2), mu = mean - 0.5772 beta
        beta = (peaks[1] - peaks[0]) / (2 * np.log(2))
        line = lines["Gumbel's law of the largest values: exceeded with probability 0.5"]
        self.assertAlmostEqual(line.mean / (peaks.mean() - 0.57722 * beta
                                            - beta * np.log(np.log(2))), 1, 4)

    def test_floe_shape(self):
        options, runs = {}, []
        settings = {"obstacle": "leg", "filter": 1, "start": 5, "shape": "a", "allowed": [1, 10],
                    "labels": {"a": "A", "b": "B"}}
        wave = np.sin(2 * np.pi * 0.05 * 0.05 * np.arange(2100))
        for point, mean, deviation in (("a", 4e4, 4e3), ("b", 2e4, 4e3)):
            for seed in (1, 2, 3):
                runs.append(self.pushed(f"{point}_s00{seed}", mean * (1 + 0.01 * seed)
                                        + deviation * np.sqrt(2) * wave, options, "leg"))
        lines = {line.what: line for line in loads.floe_shape(runs, settings).lines}
        self.assertAlmostEqual(lines["A: mean of the load"].mean / 4.08e4, 1, 3)
        self.assertAlmostEqual(lines["B: deviation in time of the load"].mean / 4e3, 1, 2)
        line = lines["mean of the load, A over B"]
        self.assertAlmostEqual(line.mean, 2, 3)
        self.assertEqual((line.verdict, line.draws), ("agrees", 3))
        settings["allowed"] = [3, 10]
        self.assertEqual(next(line for line in loads.floe_shape(runs, settings).lines
                              if line.what == "mean of the load, A over B").verdict, "disagrees")

    def test_keel_punch(self):
        """A block of 4 x 4 x 1 m that a plate pushes down: 1 m of it is under the plate, and all
        its buoyancy counts, since its centroid is."""
        subprocess.run([REPOSITORY / "tools/make_lattice", "block", self.folder / "block.h5"],
                       check=True, capture_output=True)
        (self.folder / "scene.yaml").write_text(PUNCH)
        done = floe("scene.yaml", "-output_dir", "out", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)

        class Named:
            name = "bonds_s001"
        run = validation.Drawn(Named, self.folder / "out")
        found = ice.keel_punch([run], {"filter": 0.05, "allowed": [1.7, 4],
                                       "labels": {"bonds": "b"}})
        net = 9.81 * 90 * 16
        strength, force = (line.mean for line in found.lines)
        self.assertGreater(force, 100)
        self.assertAlmostEqual(strength / ((force - net) / (np.pi * 1.6) / 1e3), 1, 6)


if __name__ == "__main__":
    assert FLOE.exists(), FLOE
    unittest.main()
