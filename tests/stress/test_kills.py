#!/usr/bin/python3
"""Chains of kills, signals and full disks on one rank: kills.py. FLOE_FULL=1 takes 5 chains of 10
events instead of one of 6;
test_kills_ranks.py as many on two ranks."""
import unittest

from kills import Chain
from launch import FULL


class OnOneRank(Chain):
    def test_chain(self):
        for seed in range(5 if FULL else 1):
            with self.subTest(seed=seed):
                self.check_chain(seed, 10 if FULL else 6, 1)
                self.start_again()


if __name__ == "__main__":
    unittest.main()
