#!/usr/bin/python3
"""Structures that touch each other and obstacles."""
import unittest

import numpy as np
import pandas as pd

from test_restart import contents
from test_structures import ALONE, StructureTest


class Meeting(StructureTest):
    TWO = ALONE[:ALONE.index("obstacle:")] + """obstacle:
  names: [ram, leg]
  ram: {shape: box, centre: [6, 0, 0], size: [1, 1, 1], mass: 1000}
  leg: {shape: box, centre: [9, 0, 0], size: [2, 1, 1], mass: 2000}
time: {end: 3}
initial: {names: [go], go: {set: ram, velocity: [1, 0, 0]}}
output: {history: 2e-3}
"""
    QUAY = ALONE[:ALONE.index("obstacle:")].replace(
        "young: 1e6", "young: 1e7, restitution: 0.2, friction: 0.3") + """obstacle:
OBSTACLES
time: {end: 1.5, dt: 2e-4}
initial: {names: [kick], kick: {set: crate, velocity: [0, 0, -1], angular_velocity: [0.3, 1, 2]}}
load: {names: [weight], weight: {set: crate, force: [0, 0, -9810]}}
output: {history: 0.02, pressure: 0.1, pressure_patch: 0.25}
checkpoint: {every: 1000}
"""
    WHOLE = """  names: [quay, crate]
  quay: {shape: box, centre: [9, 0, 0], size: [4, 4, 2]}
  crate: {shape: box, centre: [9, 0, 1.6], size: [2, 1, 1], mass: 1000}"""
    PARTS = """  names: [quay, south, crate, half]
  quay: {shape: box, centre: [9, 1, 0], size: [4, 2, 2]}
  south: {shape: box, centre: [9, -1, 0], size: [4, 2, 2], part_of: quay}
  crate: {shape: box, centre: [8.5, 0, 1.6], size: [1, 1, 1], mass: 1000}
  half: {shape: box, centre: [9.5, 0, 1.6], size: [1, 1, 1], part_of: crate}"""

    def test_impact_of_two(self):
        """Momentum to 1e-10 and restitution to 2 % of a central impact."""
        for restitution in (1.0, 0.4):
            scene = self.TWO.replace("young: 1e6", f"young: 1e8, restitution: {restitution}")
            rows = self.rows(scene, name=f"e{restitution}")
            ram, leg = rows["ram_velocity_x"][-1], rows["leg_velocity_x"][-1]
            self.assertAlmostEqual((1000 * ram + 2000 * leg) / 1000, 1, delta=1e-10)
            self.assertAlmostEqual((leg - ram) / restitution, 1, delta=0.02)
            np.testing.assert_allclose(rows["leg_force_x"], -rows["ram_force_x"], atol=1e-6)
            self.assertGreater(np.max(rows["leg_force_x"]), 1e4)

    def test_through_each_other(self):
        """Where one touches ice only, they pass through each other."""
        rows = self.rows(self.TWO.replace("mass: 2000", "mass: 2000, touches: ice"))
        self.assertEqual(np.max(np.abs(rows["leg_force_x"])), 0)
        self.assertAlmostEqual(rows["ram_velocity_x"][-1], 1, delta=1e-12)

    def test_one_that_overlaps_an_obstacle_at_the_start(self):
        done = self.run_scene(self.TWO.replace("[6, 0, 0]", "[7.7, 0, 0]"), code=2)
        self.assertIn("obstacle 'ram' and obstacle 'leg' overlap by 0.2 m at the start",
                      done.stderr)
        self.assertIn("touches: ice", done.stderr)

    def test_on_a_quay(self):
        """A crate tumbles on a quay and comes to rest, bit for bit on two ranks and after a stop;
        both of parts do the same. The sum of its patches is the force on each."""
        whole = self.QUAY.replace("OBSTACLES", self.WHOLE)
        rows = self.rows(whole, name="one")
        late = rows["time"] > 1.2
        np.testing.assert_allclose(rows["quay_force_z"][late], -9810, rtol=1e-2)
        np.testing.assert_allclose(rows["crate_force_z"][late], 9810, rtol=1e-2)
        self.assertGreater(rows["crate_rz"][-1], 0.1)
        self.run_scene(whole, name="two", ranks=2)
        self.run_scene(whole, "-ts_max_steps", "2777", name="part")
        self.run_scene(whole, "-checkpoint_restart", "out/part/checkpoint.h5", name="part")
        one = contents(self.folder / "out/one/checkpoint.h5")
        for name in ("two", "part"):
            other = contents(self.folder / f"out/{name}/checkpoint.h5")
            for key in ("bodies/records", next(k for k in one if k.endswith("contact/pairs"))):
                np.testing.assert_array_equal(one[key], other[key], f"{name} {key}")
        parts = self.rows(self.QUAY.replace("OBSTACLES", self.PARTS), name="parts")
        early = rows["time"] < 0.4  # later rounding has grown over impacts on corners
        for column in ("crate_force_z", "crate_moment_y", "crate_ry", "quay_force_y"):
            size = np.max(np.abs(rows[column]))
            np.testing.assert_allclose(parts[column][early], rows[column][early],
                                       atol=1e-7 * size, err_msg=column)
        self.assertGreater(np.max(np.abs(rows["crate_force_z"][early])), 1e4)
        pressure = pd.read_csv(self.folder / "out/one/pressure.csv", dtype={"patch": str})
        sums = pressure.groupby(["time", "obstacle"])
        for (_, name), of in sums:
            force = of[["force_x", "force_y", "force_z"]].to_numpy()
            self.assertEqual(of["patch"].iloc[0], "all")
            np.testing.assert_allclose(force[1:].sum(axis=0), force[0], atol=1e-9 * 1e4)
        self.assertEqual(set(pressure["obstacle"][pressure["patch"] != "all"]), {"quay", "crate"})


if __name__ == "__main__":
    unittest.main()
