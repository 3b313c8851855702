#!/usr/bin/python3
"""The scenes of input/ whose commands are for several ranks, which want the cores to themselves: see test_scenes.py."""
import unittest

import test_scenes


class OnRanks(test_scenes.SceneTest):
    pass


test_scenes.add_tests(OnRanks, on_ranks=True)

if __name__ == "__main__":
    unittest.main()
