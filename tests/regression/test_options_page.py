#!/usr/bin/python3
"""docs/options.md is what `floe -help_markdown` writes, and -help prints every option."""
import os
import subprocess
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()


def output(*words):
    return subprocess.run([str(FLOE), *words], capture_output=True, text=True, check=True, timeout=60).stdout


class OptionsPage(unittest.TestCase):
    def test_page_is_current(self):
        self.assertEqual((REPOSITORY / "docs/options.md").read_text(), output("-help_markdown"),
                         "run: build/release/floe -help_markdown > docs/options.md")

    def test_help_lists_the_same_options(self):
        page = [line.split("`")[1] for line in output("-help_markdown").splitlines()
                if line.startswith("| `")]
        options = [line.split()[0] for line in output("-help").splitlines() if line.startswith("  -")]
        self.assertEqual(options, ["-" + key.replace(": ", "_") for key in page])
        self.assertIn("-boundary_NAME_fix", options)


if __name__ == "__main__":
    unittest.main()
