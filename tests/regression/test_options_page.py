#!/usr/bin/python3
"""docs/options.md is what `floe -help_markdown` writes, and -help prints every option."""
import re
import tempfile
import unittest
from pathlib import Path

import launch


def output(*words):
    return launch.run(*words, check=True).stdout


class OptionsPage(unittest.TestCase):
    def test_page_is_current(self):
        self.assertEqual((launch.REPOSITORY / "docs/options.md").read_text(),
                         output("-help_markdown"),
                         "run: build/release/floe -help_markdown > docs/options.md")

    def test_help_lists_the_same_options(self):
        page = [line.split("`")[1] for line in output("-help_markdown").splitlines()
                if line.startswith("| `")]
        options = [line.split()[0] for line in output("-help").splitlines()
                   if line.startswith("  -")]
        self.assertEqual(options, ["-" + key.replace(": ", "_") for key in page])
        self.assertIn("-boundary_NAME_fix", options)

    def test_every_number_has_a_sane_range(self):
        """No number may be so large that products of a few of them overflow, nor be absurd: only
        limits may be far."""
        number = re.compile(r"\| `([^`]+)` \| (?:a number|a whole number|\d+ numbers) (.*?)(?: "
                            r"\[.*?\])? \|")
        ranges = dict(number.findall(output("-help_markdown")))
        self.assertGreater(len(ranges), 60)
        for key, bounds in ranges.items():
            with self.subTest(key):
                low, high = (re.search(rf"(?:^|, ){sign}=? (\S+?)(?:,|$)", bounds)
                             for sign in (">", "<"))
                self.assertTrue(low and high, bounds)
                largest = max(abs(float(low[1])), abs(float(high[1])))
                self.assertLessEqual(largest, 1e300 if key.startswith("limit:") else 1e21)

    def test_numbers_beyond_their_range_are_refused(self):
        """Ramps and sizes of 1e300, and the like: one line that names the key."""
        scene = ("integrator: explicit\nforces: [beam, contact]\nsheet: {length: 10, element_size: "
                 "2}\n"
                 "boundary: {names: [b], b: {set: left, fix: x, velocity: [1, 0, 0], ramp: 1}}\n"
                 "load: {names: [l], l: {point: [0, 0], force: [1, 0, 0], ramp: 1}}\n"
                 "obstacle: {names: [o], o: {shape: box, centre: [90, 0, 0], size: "
                 "[1, 1, 1], velocity: [1, 0, 0], ramp: 1}}\n")
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "scene.yaml").write_text(scene)
            for key in ("boundary_b_ramp", "load_l_ramp", "obstacle_o_ramp", "sheet_length",
                        "sheet_thickness",
                        "sheet_element_size", "time_end", "time_dt", "ice_young", "ice_density"):
                for value in ("1e300", "-1e300", "1e999", "nan"):
                    self.refused(folder, key, value)
            for key, count in (("obstacle_o_size", 3), ("obstacle_o_centre", 3),
                               ("load_l_point", 2), ("load_l_force", 3),
                               ("boundary_b_velocity", 3)):
                self.refused(folder, key, ",".join(["1e300"] * count))

    def refused(self, folder, key, value):
        with self.subTest(f"{key} {value}"):
            done = launch.run("scene.yaml", "-" + key, value, cwd=folder)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertTrue(done.stderr.startswith("floe: "
                                                   + key.replace("_", ": ", 2 if "_o_" in key
                                                                 or "_l_" in key or
                                                                         "_b_" in key else 1)
                                                   + ": "), done.stderr)
            self.assertLess(len(done.stderr), 200)
            self.assertEqual([f.name for f in Path(folder).iterdir()], ["scene.yaml"])


if __name__ == "__main__":
    unittest.main()
