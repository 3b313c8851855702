#!/usr/bin/python3
"""examples/tutorial.md: its blocks of Python, word for word, in an empty folder."""
import csv
import json
import os
import re
import subprocess
import sys
import unittest

import numpy as np

from launch import ENVIRONMENT, FLOE, REPOSITORY, FolderTest

TUTORIAL = REPOSITORY / "examples/tutorial.md"
MOST_LINES = 60


class Tutorial(FolderTest):
    def test_word_for_word(self):
        blocks = re.findall(r"^```python\n(.*?)^```", TUTORIAL.read_text(), re.M | re.S)
        script = "".join(blocks)
        lines = [line for line in script.split("\n") if line.strip()]
        self.assertTrue(40 < len(lines) <= MOST_LINES, f"{len(lines)} lines")
        (self.folder / "tutorial.py").write_text(script)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/floe").symlink_to(FLOE)  # as an installation has it on the PATH
        environment = {**ENVIRONMENT, "PATH": f"{self.folder}/bin{os.pathsep}{os.environ['PATH']}",
                       "PYTHONPATH": str(REPOSITORY / "python")}
        done = subprocess.run([sys.executable, "tutorial.py"], cwd=self.folder, env=environment,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for name in ("load", "fragments", "exceedance"):
            self.assertGreater((self.folder / f"{name}.png").stat().st_size, 10000, name)
        found = json.loads((self.folder / "load.json").read_text())
        self.assertEqual(len(found["maxima"]), len(found["runs"]))
        self.assertGreater(min(found["maxima"]), 1000, "every passage loads the cone")
        # Each maximum is below the largest step of its run, and the curve rises as it gets rarer.
        with open(self.folder / "out/seeds/runs.csv", newline="") as file:
            peaks = {row["run"]: np.linalg.norm([float(row[f"peak_force_cone_{a}"]) for a in "xyz"])
                     for row in csv.DictReader(file)}
        for folder, largest in zip(found["runs"], found["largest_of_runs"]):
            self.assertLess(largest, peaks[os.path.basename(folder)])
        values = [level["moments"] for level in found["gumbel"]["levels"]]
        self.assertTrue(np.all(np.diff(values, axis=0) > 0))
        said = re.findall(r"^exceeded in ([\d.]+) of the passages: (\d+) kN", done.stdout, re.M)
        self.assertEqual([(float(p), float(v)) for p, v in said],
                         [(level["probability"], round(level["moments"][0] / 1e3))
                          for level in found["gumbel"]["levels"]])


if __name__ == "__main__":
    unittest.main()
