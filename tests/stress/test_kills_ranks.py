#!/usr/bin/python3
"""As test_kills.py, on two ranks."""
import unittest

from kills import Chain
from launch import FULL


class OnTwoRanks(Chain):
    def test_chain(self):
        for seed in range(5 if FULL else 1):
            with self.subTest(seed=seed):
                self.check_chain(100 + seed, 10 if FULL else 6, 2)
                self.start_again()


if __name__ == "__main__":
    unittest.main()
