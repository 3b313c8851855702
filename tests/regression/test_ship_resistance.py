#!/usr/bin/python3
"""examples/ship_resistance.py: Lindqvist's formula in cases that are plain, and means of a record
that is known."""
import sys
import unittest

import numpy as np

from launch import REPOSITORY, FolderTest

sys.path.insert(0, str(REPOSITORY / "examples"))
import ship_resistance  # noqa: E402
from ship_resistance import Ship, lindqvist  # noqa: E402


class Formula(unittest.TestCase):
    def test_without_friction(self):
        """Of a bow that is a wedge of 45 degrees with an entrance of 90: tan psi = 1."""
        ship = Ship(length=80, beam=20, draught=5, stem=45, entrance=90, thickness=1, strength=6e5,
                    young=2e9, friction=0)
        crushing, bending, submersion = lindqvist(ship, 0)
        self.assertAlmostEqual(crushing, 3e5)  # sigma h^2/2
        length = (2e9 / (12 * 0.91 * 1010 * 9.81))**0.25  # that of the plate, h^(3/4) apart
        self.assertAlmostEqual(bending / (27 / 64 * 6e5 * 20 / length**2 * (1 + 2**0.5)), 1)
        self.assertAlmostEqual(bending / (0.003 * 6e5 * 20 * (1 + 2**0.5)), 1, delta=0.05)
        self.assertAlmostEqual(submersion, 90 * 9.81 * 20 * 5 * 25 / 30)

    def test_with_friction(self):
        """Numbers by hand for the wedge, mu = 0.1: cos phi = cos psi = sin phi."""
        ship = Ship(length=80, beam=20, draught=5, stem=45, entrance=90, thickness=1, strength=6e5,
                    friction=0.1)
        crushing, bending, submersion = lindqvist(ship, 0)
        still = lindqvist(Ship(**{**vars(ship), "friction": 0}), 0)
        self.assertAlmostEqual(crushing / still[0], 1.1 / 0.9)
        self.assertAlmostEqual(bending / still[1], 1.1)
        bottom = 0.7 * 80 - 5 + 5 * 0.5 * 2**0.5
        self.assertAlmostEqual(submersion - still[2], 90 * 9.81 * 20 * 0.1 * bottom)

    def test_speed(self):
        still, fast = (lindqvist(Ship(), speed) for speed in (0, 2))
        self.assertAlmostEqual(fast[0] / still[0], 1 + 2.8 / (9.81 * 0.5)**0.5)
        self.assertAlmostEqual(fast[1] / still[1], 1 + 2.8 / (9.81 * 0.5)**0.5)
        self.assertAlmostEqual(fast[2] / still[2], 1 + 18.8 / (9.81 * 75)**0.5)

    def test_entrance(self):
        """That of input/data/ship.stl at a quarter of its beam: half an ellipse, 22.5 x 8.5 m."""
        y = 8.5 / 2
        slope = 8.5**2 / 22.5**2 * 22.5 * np.sqrt(1 - y**2 / 8.5**2) / y
        self.assertAlmostEqual(np.degrees(np.arctan(slope)), Ship().entrance, delta=0.05)


class Means(FolderTest):
    def test_of_a_record(self):
        """A force that rises with the way, of which the cumulative means are known."""
        time = np.linspace(0, 12.5, 501)
        force = 1e3 * time
        rows = np.column_stack([time, -force, -force / 2])
        np.savetxt(self.folder / "history.csv", rows, delimiter=",", comments="",
                   header="time,hull_force_x,hull_mean_force_x")
        mean, deviation = ship_resistance.measured(self.folder, 2.0)
        self.assertAlmostEqual(mean / 10.5e3, 1, delta=1e-9)  # from 8.5 to 12.5 s
        self.assertAlmostEqual(deviation / (4e3 / 12**0.5), 1, delta=0.02)


if __name__ == "__main__":
    unittest.main()
