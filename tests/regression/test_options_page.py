#!/usr/bin/python3
"""docs/options.md is what `floe -help_markdown` writes, and -help prints every option."""
import unittest

import launch


def output(*words):
    return launch.run(*words, check=True).stdout


class OptionsPage(unittest.TestCase):
    def test_page_is_current(self):
        self.assertEqual((launch.REPOSITORY / "docs/options.md").read_text(), output("-help_markdown"),
                         "run: build/release/floe -help_markdown > docs/options.md")

    def test_help_lists_the_same_options(self):
        page = [line.split("`")[1] for line in output("-help_markdown").splitlines()
                if line.startswith("| `")]
        options = [line.split()[0] for line in output("-help").splitlines() if line.startswith("  -")]
        self.assertEqual(options, ["-" + key.replace(": ", "_") for key in page])
        self.assertIn("-boundary_NAME_fix", options)


if __name__ == "__main__":
    unittest.main()
