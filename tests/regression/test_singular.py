#!/usr/bin/python3
"""A tangent that cannot be factorised fails its load step, not the run: smaller ones go on."""
import sys
import unittest

from launch import REPOSITORY
from running import RunningTest

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402

# Boxes that float on a corner and are turned by almost a whole turn: Newton's method throws some
# out of the water, where nothing holds them.
TURNED = """integrator: quasistatic
lattice_file: boxes.h5
forces: [gravity, buoyancy]
boundary:
  names: [turned]
  turned: {set: all, fix: rx ry rz, angular_velocity: [-5.92, -0.0152, 0.000867]}
"""
# Where they begin: quaternions.
TURNS = [[0.21424427, 0.50936062, 0.20485384, -0.80788988],
         [0.70590254, 0.34803657, -0.41866041, 0.45309559],
         [0.50599447, 0.40823008, 0.03944758, 0.75878962],
         [-0.68379222, -0.15126069, -0.44764424, 0.55602431]]


class Singular(RunningTest):
    def test_smaller_load_steps(self):
        centres = [[x, y, -0.2] for x in (-0.8, 0.8) for y in (-0.8, 0.8)]
        boxes = fl.blocks([[1, 1, 0.5]] * 4, centres)
        boxes.orientation[:] = TURNS
        boxes.write(self.folder / "boxes.h5")
        self.write(TURNED)
        for ranks in (1, 2):
            self.floe("-output_overwrite", ranks=ranks)
            self.assertEqual(self.summary()["status"], "done")
            self.assertGreater(self.summary()["steps"], 1)


if __name__ == "__main__":
    unittest.main()
