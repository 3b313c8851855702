#!/usr/bin/python3
"""The tower of examples/tower.py, coupled to ice, is the same pile inside floe as the exchange step
falls."""
import re
import shutil
import unittest

from in_python import PythonTest, launch


class Tower(PythonTest):
    def test_error_falls_with_the_exchange_step(self):
        shutil.copy(launch.REPOSITORY / "examples/tower.py", self.folder / "tower.py")
        out = self.python("""
            sys.path.insert(0, ".")
            import tempfile, pathlib, tower
            a, b = (2 * np.pi * tower.Tower().frequencies) ** 2
            assert np.isclose(a * b, 3e7 * 4e9 / (2e5 * 4e6))  # determinants of K and M
            assert np.isclose(a + b, 3e7 / 2e5 + (64 * 3e7 + 4e9) / 4e6)
            with tempfile.TemporaryDirectory() as folder:
                print(tower.errors([0.02, 0.005], pathlib.Path(folder)))
        """)
        coarse, fine = (float(x) for x in re.findall(r"[\d.e-]+", out.splitlines()[-1]))
        self.assertLess(fine, 2e-4)
        self.assertGreater(coarse / fine, 4 ** 1.7)  # of 4^2 for loads that are smooth


if __name__ == "__main__":
    unittest.main()
