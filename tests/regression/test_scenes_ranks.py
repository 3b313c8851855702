#!/usr/bin/python3
"""The scenes of input/ whose commands are for several ranks, which want the cores to themselves:
see test_scenes.py."""
import unittest

import numpy as np

import test_scenes


class OnRanks(test_scenes.SceneTest):
    def test_a_sheet_that_breaks_on_a_slope(self):
        """Beams that break, fragments and their contacts move alike on one rank and on two, to the
        last bit."""
        run = self.runner(test_scenes.REPOSITORY / "input/ice_slope.yaml")

        def motion(ranks):
            output = run("-time_end", "2", "-output_fields", "2", ranks=ranks)
            self.assertEqual(output.summary["ranks"], ranks)
            self.assertGreater(output.summary["beams_broken"], 10)
            return output.field("bodies_displacement", 2), output.field("bodies_rotation", 2)

        for alone, shared in zip(motion(1), motion(2)):
            np.testing.assert_array_equal(alone, shared)


test_scenes.add_tests(OnRanks, on_ranks=True)

if __name__ == "__main__":
    unittest.main()
