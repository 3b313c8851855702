#!/usr/bin/python3
"""tools/bench: what it says of repeated runs and of the scenes."""
import os
import re
import subprocess
import unittest

from launch import FLOE, REPOSITORY, FolderTest

SCENE = """forces: [beam]
sheet: {length: 10, thickness: 1, element_size: 2, iterations: 5}
boundary:
  names: [left, right]
  left: {set: left, fix: x}
  right: {set: right, fix: x, displacement: [0.01, 0, 0]}
report: [tension]
"""


class Bench(FolderTest):
    def bench(self, *words):
        done = subprocess.run([REPOSITORY / "tools/bench", *words], capture_output=True, text=True,
                              env={**os.environ, "FLOE": str(FLOE)})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_repeats(self):
        """Runs on one rank are the same to the last bit, those on two to rounding."""
        scene = self.folder / "s.yaml"
        scene.write_text(SCENE)
        row = re.compile(r"^\| `\S+s.yaml` \| quasistatic \| (\d+) \| (\S+) \| (\S+) \| (\S+) \|$",
                         re.M)
        for ranks, most in (("1", 0), ("2", 1e-12)):
            said = self.bench("repeats", str(scene), "--repeats", "3", "--ranks", ranks)
            self.assertIn(f"3 runs of each scene on {ranks} ranks", said)
            bodies, *differences = row.search(said).groups()
            self.assertGreater(int(bodies), 10)
            self.assertLessEqual(max(map(float, differences)), most)

    def test_scenes(self):
        """A scene to its end, and one that is stopped, whose time is that of the whole."""
        row = re.compile(r"^\| `(\w+)` \| (.+) \| (\w+) \| (\d+) \| (about )?(\S+) (s|min) \|$",
                         re.M)
        rows = {found[1]: found.groups() for found in
                row.finditer(self.bench("scenes", "tension", "bending_explicit", "--most", "0.5"))}
        self.assertEqual(rows["tension"][:5],
                         ("tension", "Tension test of a square sheet", "quasistatic", "462", None))
        self.assertEqual(rows["bending_explicit"][2:5], ("explicit", "3285", "about "))

    def test_page_of_scenes(self):
        """docs/scenes.md has a time for each."""
        page = (REPOSITORY / "docs/scenes.md").read_text()
        self.assertEqual(re.findall(r"^\| `(\w+)` \|.* (?:s|min) \|$", page, re.M),
                         sorted(path.stem for path in (REPOSITORY / "input").glob("*.yaml")))


if __name__ == "__main__":
    unittest.main()
