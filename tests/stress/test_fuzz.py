#!/usr/bin/python3
"""120 cases of fuzz.py, in ten parts that run side by side. FLOE_FULL=1 takes 20,000."""
import unittest

import fuzz
from launch import FULL

PARTS, CASES = 10, 2000 if FULL else 12


class Fuzz(unittest.TestCase):
    pass


def add(part):
    def test(self):
        broken, _, _ = fuzz.try_many(range(part * CASES, (part + 1) * CASES))
        self.assertEqual([outcome.report() for outcome in broken], [],
                         "\n" + "\n".join(o.report() for o in broken[:20]))
    setattr(Fuzz, f"test_part_{part}", test)


for part in range(PARTS):
    add(part)


if __name__ == "__main__":
    unittest.main()
