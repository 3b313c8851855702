#!/usr/bin/python3
"""The pictures of docs/architecture.md are those of the sources: stages of CMakeLists.txt, calls of
a step."""
import subprocess
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]


class Architecture(unittest.TestCase):
    def test_pictures_are_current(self):
        done = subprocess.run([REPOSITORY / "tools/draw_architecture.py", "--check"],
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
