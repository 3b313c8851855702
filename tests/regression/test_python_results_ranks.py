#!/usr/bin/python3
"""floe.open on a run of two ranks: as on one."""
import sys
import unittest

import numpy as np

import launch
from launch import REPOSITORY, FolderTest
from test_python_results import SCENE

sys.path.insert(0, str(REPOSITORY / "python"))
import floe  # noqa: E402


class TwoRanks(FolderTest):
    def test_results_are_those_of_one(self):
        (self.folder / "scene.yaml").write_text(SCENE.replace("end: 1.5", "end: 0.9"))
        runs = []
        for ranks in (1, 2):
            done = launch.run("scene.yaml", "-output_dir", str(ranks), ranks=ranks, cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            runs.append(floe.open(self.folder / str(ranks)))
        one, two = runs
        self.assertEqual((one.summary["ranks"], two.summary["ranks"]), (1, 2))
        self.assertGreater(len(one.breaks), 0)
        for name in ("position", "rotation", "beam_force", "damage", "fragment"):
            np.testing.assert_array_equal(two.fields[name], one.fields[name], name)
        self.assertTrue(two.breaks.equals(one.breaks))
        forces = [run.history["wall_force_x"] for run in runs]  # sums over ranks
        np.testing.assert_allclose(forces[1], forces[0], rtol=1e-9, atol=1e-6)


if __name__ == "__main__":
    unittest.main()
