#!/usr/bin/python3
"""The picture tools: Kelvin's function against tabulated values, and pictures from real runs."""
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

from launch import ENDLESS, FLOE, REPOSITORY
from running import RunningTest

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.sheets import plate as plates  # noqa: E402


class Curve(unittest.TestCase):
    def test_wyman(self):
        wyman = plates.wyman
        ratio = np.array([0, 0.5, 1, 1.5, 2, 3, 5])
        np.testing.assert_allclose(wyman(ratio),
                                   [1, .85508, .63025, .42195, .25770, .06509, -.01424], atol=6e-6)
        self.assertAlmostEqual(float(wyman(1e-9)), 1, 12)

    def test_kei_is_smooth_where_its_branches_meet(self):
        kei = plates.kei
        x = np.array([0.9e-8, 1.1e-8, 1e-4])
        np.testing.assert_allclose(kei(x), -np.pi / 4, atol=1e-6)


class Plate(unittest.TestCase):
    def test_characteristic_length_and_deflection(self):
        plate = plates.plate
        for h, length, w0 in ((0.5, 8.2450, 1.8558e-3), (1, 13.8663, .65614e-3),
                              (1.5, 18.7945, .35716e-3)):
            options = {"ice_young": "4e9", "ice_poisson": "0.3", "sheet_thickness": str(h),
                       "gravity": "9.81",
                       "water_density": "1010", "load_names": "centre",
                       "load_centre_force": "0, 0, -1e4"}
            got = plate(options)
            self.assertAlmostEqual(got[0], length, 3)
            self.assertAlmostEqual(got[1] / w0, 1, 4)


class Continua(unittest.TestCase):
    def test_edge_of_a_half_infinite_plate(self):
        """Westergaard's formula for the edge, sqrt(2 + 1.2 nu)/sqrt(12 (1 - nu^2)), is a fit to
        within 1 %."""
        for poisson in (0.15, 0.3):
            fitted = np.sqrt((2 + 1.2 * poisson) / (12 * (1 - poisson**2)))
            self.assertAlmostEqual(plates.edge_deflection(poisson) / fitted, 1, delta=0.01)
        self.assertAlmostEqual(plates.edge_deflection(0.3),
                               plates.edge_deflection(0.3, 800), delta=1e-5)

    def test_square_in_simple_shear(self):
        """128 x 128 elements give 0.64125 and 0.65820."""
        for poisson, fine in ((0.2046, 0.64125), (0.3, 0.65820)):
            self.assertAlmostEqual(plates.simple_shear(poisson), fine, delta=0.002)


class Pictures(unittest.TestCase):
    def draw(self, scene, options, tool, *arguments):
        """Runs a small variant of a scene, then a tool on its output, which must leave these
        pictures."""
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([FLOE, str(REPOSITORY / "input" / scene), "-sheet_iterations",
                                  "10", *options,
                                  "-output_dir", folder + "/out"], capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            plot = subprocess.run([str(REPOSITORY / "tools" / tool), folder + "/out", *arguments],
                                  capture_output=True, text=True)
            self.assertEqual(plot.returncode, 0, plot.stderr)
            written = [Path(line) for line in plot.stdout.split()]
            self.assertEqual([file.suffix for file in written], [".png", ".svg"])
            self.assertTrue(written[0].read_bytes().startswith(b"\x89PNG"))
            self.assertGreater(len(written[1].read_text()), 10000)

    def test_sheet(self):
        self.draw("tension.yaml", ["-sheet_length", "12", "-sheet_width", "10"], "plot_sheet",
                  "--colour", "ux")

    def test_fragments(self):
        self.draw("notch.yaml", ["-sheet_element_size", "2"], "plot_fragments")

    def test_deflection(self):
        self.draw("bending.yaml", ["-sheet_length", "20", "-sheet_width", "20"], "plot_deflection")

    def test_not_an_output_folder(self):
        for tool in ("plot_sheet", "plot_deflection"):
            run = subprocess.run([str(REPOSITORY / "tools" / tool), "/nonexistent"],
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 2)
            self.assertIn("/nonexistent", run.stderr)


# A sheet that is pushed against a leg, and breaks.
PUSHED = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 12, width: 8, thickness: 0.5, element_size: 2, iterations: 5}
beam: {damping_ratio: 1}
water: {drag_linear: 100}
contact: {young: 1e8}
obstacle: {names: [leg], leg: {shape: cylinder, base: [8.01, 0, -3], radius: 2, height: 6}}
boundary: {names: [back], back: {set: left, fix: x, velocity: [0.5, 0, 0]}}
output: {history: 0.01, fields: 0.1}
"""


class Unfinished(RunningTest):
    """A run that is under way, then killed: its pictures are drawn in either state."""

    def test_pictures(self):
        self.write(PUSHED)
        process = self.running(*ENDLESS)
        process.send_signal(signal.SIGSTOP)  # while pictures are drawn
        for state in ("under way", "killed"):
            for tool, name in (("plot_sheet", "sheet"), ("plot_fragments", "fragments"),
                               ("plot_load", "load")):
                with self.subTest(f"{tool}, {state}"):
                    picture = self.folder / f"{name} {state}.png"
                    plot = subprocess.run([REPOSITORY / "tools" / tool, "out/scene", "--file",
                                           picture], cwd=self.folder,
                                          capture_output=True, text=True)
                    self.assertEqual(plot.returncode, 0, plot.stderr)
                    self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))
            process.kill()
            process.wait()


if __name__ == "__main__":
    unittest.main()
