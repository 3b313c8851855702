#!/usr/bin/python3
"""Checkpoint and restart on several ranks: bit for bit on the same number, to 1e-9 on another.

Beside test_restart.py, because a run on two ranks wants both cores: at every step one rank waits
for the other.
FLOE_FULL=1 kills 20 times instead of 3.
"""
import unittest

import numpy as np

from test_restart import INTERRUPTED, PLANAR, Breaking, Killing, RestartTest, contents, stop_file


class Stopped(RestartTest):
    def test_by_file_on_two_ranks(self):
        self.check_stopped(stop_file, 2)

    def test_on_another_number_of_ranks(self):
        for before, after in ((1, 2), (2, 1), (2, 3)):
            dir = f"b{before}{after}"
            self.finish(self.interrupted(stop_file, dir=dir, ranks=before), INTERRUPTED)
            straight, b = self.straight_and_resumed(dir=dir, ranks=after, straight_ranks=1)
            first, second = contents(straight / "fields.h5"), contents(b / "fields.h5")
            self.assertEqual(set(first), set(second))
            for key, values in first.items():
                scale = np.max(np.abs(values)) if np.size(values) else 0
                np.testing.assert_allclose(second[key], values, rtol=1e-9, atol=1e-9 * scale,
                                           err_msg=key)
            tables = [np.loadtxt(f / "history.csv", delimiter=",", skiprows=1)
                      for f in (straight, b)]
            names = (b / "history.csv").read_text().split("\n")[0].split(",")
            for name, one, two in zip(names, tables[0].T, tables[1].T):
                energies = max(np.max(np.abs(c)) for n, c in zip(names, tables[0].T)
                               if n.startswith("energy"))
                scale = energies if name.startswith("energy") else np.max(np.abs(one))
                np.testing.assert_allclose(two, one, rtol=1e-9, atol=1e-9 * max(scale, 1),
                                           err_msg=name)


class StoppedInThePlane(Stopped):
    """The same with three unknowns per body."""

    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(PLANAR)


class Fracture(Breaking):
    def test_a_sheet_that_breaks(self):
        self.check_breaking(2)

    def test_cracks_that_run_by_energy(self):
        self.check_breaking(2, ", propagation: energy")

    def test_calibrated_strengths_in_bending_and_under_pressure(self):
        self.check_breaking(2, ", flexural_strength: 4e5, compressive_strength: 1.5e6")


class Killed(Killing):
    def test_at_random_moments(self):
        self.check_killed(2)


if __name__ == "__main__":
    unittest.main()
