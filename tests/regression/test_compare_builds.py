#!/usr/bin/python3
"""tools/compare_builds finds a program the same as itself, and another where its results differ."""
import subprocess
import unittest

from launch import ENVIRONMENT, FLOE, REPOSITORY, FolderTest

SCENE = REPOSITORY / "input/verify/heave.yaml"


class CompareBuilds(FolderTest):
    def compare(self, other, code):
        done = subprocess.run([REPOSITORY / "tools/compare_builds", FLOE, other, SCENE, "--ranks",
                               "1", "--steps", "20"], env=ENVIRONMENT, capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def test_itself(self):
        self.assertRegex(self.compare(FLOE, 0), r"1 rank: \d+ datasets, the same to the last bit\n")

    def test_another(self):
        """A floe whose gravity is off by 1e-9 of itself."""
        other = self.folder / "floe"
        other.write_text(f'#!/bin/sh\nexec {FLOE} "$@" -gravity 9.81000001\n')
        other.chmod(0o755)
        said = self.compare(other, 1)
        self.assertRegex(said, r"datasets differ, most of all .* \(allowed: 0.0e\+00\)")
        self.assertIn("1 differ by more than they may", said)


if __name__ == "__main__":
    unittest.main()
