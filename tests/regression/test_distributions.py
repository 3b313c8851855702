#!/usr/bin/python3
"""tools/check_distribution and tools/in_debian refuse what they cannot do in one line, before they
make anything. (That they do what they should is what they show when they run: they need root,
packages from the network and half an hour.)
"""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
NOBODY = ["setpriv", "--reuid=65534", "--regid=65534",
          "--clear-groups"] if os.geteuid() == 0 else []


class Refused(unittest.TestCase):
    def refused(self, words, part, by=()):
        with tempfile.TemporaryDirectory() as folder:
            os.chmod(folder, 0o755)
            command = [*by, f"{REPOSITORY}/tools/{words[0]}", *words[1:]]
            run = subprocess.run(command, cwd=folder, capture_output=True, text=True)
            self.assertEqual(run.returncode, 1, run.stderr)
            self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
            self.assertIn(part, run.stderr)
            self.assertEqual(run.stdout, "")
            self.assertEqual(os.listdir(folder), [])

    def test_without_a_release(self):
        self.refused(["check_distribution"], "tools/check_distribution trixie")
        self.refused(["check_distribution", "--quick"], "needs the name of a Debian release")

    def test_unknown_words(self):
        self.refused(["check_distribution", "trixie", "--fast"], "--quick")
        self.refused(["check_distribution", "trixie", "bookworm"], "one release at a time")
        self.refused(["in_debian", "../trixie", "a", "true"], "'../trixie'")
        self.refused(["in_debian", "trixie", "a"], "COMMAND")

    def test_who_is_not_root_is_told_how(self):
        self.refused(["check_distribution", "trixie"], "sudo tools/check_distribution trixie",
                     NOBODY)
        self.refused(["in_debian", "trixie", "a", "true"], "sudo tools/in_debian", NOBODY)


if __name__ == "__main__":
    unittest.main()
