#!/usr/bin/python3
"""Measures of docs/validation.md on moored structures, on made numbers of which the answer is
known."""
import sys
import unittest
from unittest import mock

import numpy as np

from launch import REPOSITORY, FolderTest

sys.path.insert(0, str(REPOSITORY / "tools"))
sys.path.insert(0, str(REPOSITORY / "python"))
import floe_validation as validation  # noqa: E402
import floe_validation_moored as moored  # noqa: E402
from floe.errors import InputError  # noqa: E402

# Two lines of 1 kN/m along x, 100 m long, that hold at the centroid; water 10 m wide at z = 0.
OPTIONS = {"obstacle_hull_radius": "5", "obstacle_hull_top_radius": "5",
           "obstacle_hull_height": "4", "obstacle_hull_base": "20, 0, -2",
           "obstacle_hull_mass": "3e4", "obstacle_hull_added_mass": "1e4, 0, 0, 0, 0, 0",
           "line_names": "west, east", "line_west_fairlead": "20, 0, 0",
           "line_west_anchor": "-80, 0, 0", "line_west_stiffness": "1e3",
           "line_west_pretension": "2e4", "line_east_fairlead": "20, 0, 0",
           "line_east_anchor": "120, 0, 0", "line_east_stiffness": "1e3",
           "line_east_pretension": "2e4", "sheet_thickness": "0.5",
           "water_current": "1, 0, 0"}
SLANTED = {**OPTIONS, "line_west_fairlead": "16, 3, 1", "line_west_anchor": "-80, 40, -30",
           "obstacle_hull_top_radius": "9"}


class Statics(FolderTest):
    def made(self, name, table, options=None):
        """A run of these columns and options."""
        run = self.folder / name
        run.mkdir()
        table = {**{f"hull_{c}": 0 * table["time"] for c in ("x", "y", "z", "rx", "ry", "rz",
                                                             "velocity_x")}, **table}
        rows = [",".join(table)] + [",".join(map(repr, map(float, row)))
                                    for row in zip(*table.values())]
        (run / "history.csv").write_text("\n".join(rows) + "\n")

        class Named:
            pass
        Named.name = name
        drawn = validation.Drawn(Named, run)
        drawn.options = options or OPTIONS
        return drawn

    def loaded(self, name, force, offset=0.0, **more):
        """A run under a constant force, of which history.csv has means since the start."""
        time = np.linspace(0, 60, 121)
        table = {"time": time, "hull_x": offset + 0 * time, **more}
        for axis, value in zip("xyz", (force, 0, 0)):
            table[f"hull_mean_force_{axis}"] = value + 0 * time
        return self.made(name, table)

    def test_force_of_lines(self):
        """2 k against an offset; and minus the gradient of the lines' energy in any place."""
        run = self.loaded("a", 0)
        force = moored.force_of_lines(run, "hull", np.array([1.5, 0, 0, 0, 0, 0]))
        np.testing.assert_allclose(force, [-3e3, 0, 0], atol=1e-9)
        run.options = SLANTED
        np.testing.assert_allclose(moored.centre_of_frustum(run, "hull"),
                                   [20, 0, -2 + (25 + 90 + 243) / (25 + 45 + 81)])
        motion = np.array([1.0, -2, 0.5, 0.1, -0.2, 0.05])

        def energy(at):
            centre, total = moored.centre_of_frustum(run, "hull"), 0.0
            a, b, c = motion[3:]
            angle = np.linalg.norm(motion[3:])
            cross = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
            turn = (np.eye(3) + np.sin(angle) / angle * cross
                    + (1 - np.cos(angle)) / angle**2 * cross @ cross)
            for line in ("west", "east"):
                fairlead, anchor = (np.array(run.option(f"line_{line}_{key}"))
                                    for key in ("fairlead", "anchor"))
                longer = (np.linalg.norm(anchor - centre - at - turn @ (fairlead - centre))
                          - np.linalg.norm(anchor - fairlead))
                total += 2e4 * longer + 500 * longer**2
            return total
        for axis in range(3):
            step = 1e-4 * np.eye(3)[axis]
            slope = (energy(motion[:3] + step) - energy(motion[:3] - step)) / 2e-4
            self.assertAlmostEqual(moored.force_of_lines(run, "hull", motion)[axis] / -slope, 1, 7)
        run.options = {k: v for k, v in OPTIONS.items() if k != "line_east_stiffness"}
        with self.assertRaisesRegex(InputError, "line east has no stiffness"):
            moored.force_of_lines(run, "hull", motion)

    def test_offset_of_statics(self):
        def none(speed):
            return 0 * speed
        self.assertAlmostEqual(moored.statics(self.loaded("a", 4e3, 2.0), "hull", 10, none), 1, 9)
        self.assertAlmostEqual(moored.statics(self.loaded("b", 4e3, 2.0), "hull", 10,
                                              lambda speed: 4e3 * speed), 0.5, 9)
        self.assertAlmostEqual(moored.statics(self.loaded("c", -4e3, 2.0), "hull", 10, none), -1, 9)
        # 40 t that gain 2 m/s in the last 50 s take 1.6 kN.
        time = np.linspace(0, 60, 121)
        run = self.loaded("d", 4e3, 1.2, hull_velocity_x=2 * (time - 10) / 50)
        self.assertAlmostEqual(moored.statics(run, "hull", 10, none), 1, 9)
        # Drag of what goes with half the current.
        run = self.loaded("e", 4e3, 2.25, hull_velocity_x=0 * time + 0.5)
        self.assertAlmostEqual(moored.statics(run, "hull", 10, lambda u: 2e3 * u**2), 1, 9)

    def calm(self):
        """Runs without ice that tell a drag of 200 u + 800 u^2."""
        runs = [self.loaded("calm_s001", 0, 0.5), self.loaded("slow_s001", 0, 0.15)]
        runs[1].options = {**OPTIONS, "water_current": "0.5, 0, 0"}
        return runs

    def test_drag_law(self):
        runs = self.calm()
        drag = moored.drag_law(runs, "hull")
        np.testing.assert_allclose(drag(np.array([1, 0.5, -0.5, 2])), [1000, 300, -300, 3600])
        with self.assertRaisesRegex(InputError, "in two currents"):
            moored.drag_law(runs[:1], "hull")

    def test_row(self):
        """Loads on a moored hull that are 0.8 of those on the fixed one; the drag of 1 kN that the
        run without ice tells is in the offset."""
        runs = self.calm()
        for seed in (1, 2, 3):
            runs.append(self.loaded(f"moored_s00{seed}", 800.0 * seed, (800 * seed + 1e3) / 2e3))
            runs.append(self.loaded(f"fixed_s00{seed}", 1000.0 * seed))
        settings = {"obstacle": "hull", "start": 10, "filter": 1, "calm": ["calm", "slow"],
                    "pairs": {"moored": "fixed", "none": "fixed"}, "allowed": [0.74, 1.1],
                    "statics": 0.02}
        with mock.patch.object(moored, "low_passed",
                               lambda run, *_: (2 * run.column("hull_mean_force_x"), None)):
            found = moored.moored(runs, settings)
        lines = {line.what: line for line in found.lines}
        np.testing.assert_allclose(lines["h = 0.5 m: mean load, moored"].values, [800, 1600, 2400])
        ratio = lines["h = 0.5 m: mean load, moored over fixed"]
        self.assertAlmostEqual(ratio.mean, 0.8)
        self.assertEqual((ratio.draws, ratio.verdict), (3, "agrees"))
        self.assertAlmostEqual(lines["h = 0.5 m: peak, moored over fixed"].mean, 0.8)
        np.testing.assert_allclose(lines["h = 0.5 m: mean offset over that of statics"].values, 1)
        self.assertFalse(any("exponent" in what for what in lines))
        with self.assertRaisesRegex(InputError, "without ice in two currents"):
            moored.moored(runs[1:], settings)
        with self.assertRaisesRegex(InputError, "no thickness has"):
            moored.moored(runs[:2], settings)


if __name__ == "__main__":
    unittest.main()
