#!/usr/bin/python3
"""examples/tutorial.md: its blocks of Python, word for word, in an empty folder; and what
floe.run_ensemble refuses."""
import csv
import json
import os
import re
import subprocess
import unittest

import numpy as np

from in_python import ENVIRONMENT, PythonTest
from launch import REPOSITORY

TUTORIAL = REPOSITORY / "examples/tutorial.md"
MOST_LINES = 60
# What a session would ask for next.
AFTER = """
import json
print(json.dumps({"found": found, "steps": str(floe.open(scene.output).history.index[-1]),
                  "program": run.summary["status"]}))
again = floe.run_ensemble({"scene": "cone.yaml", "seeds": 10,
                           "options": {"output": {"fields": 4}}}, "out/seeds", jobs=1)
assert (again.table["wall_s"] == ensemble.table["wall_s"]).all(), "what is done is kept"
"""


class Tutorial(PythonTest):
    def test_word_for_word(self):
        script = "".join(re.findall(r"^```python\n(.*?)^```", TUTORIAL.read_text(), re.M | re.S))
        lines = [line for line in script.split("\n") if line.strip()]
        self.assertTrue(40 < len(lines) <= MOST_LINES, f"{len(lines)} lines")
        (self.folder / "tutorial.py").write_text(script + AFTER)
        done = subprocess.run(["/usr/bin/python3", "tutorial.py"], cwd=self.folder,
                              env={**ENVIRONMENT, "MPLBACKEND": "agg"}, capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for name in ("load", "fragments", "exceedance"):
            self.assertGreater((self.folder / f"{name}.png").stat().st_size, 10000, name)
        self.assertIn("\nrefused: sheet: thickness: -0.4 must be", done.stdout)
        found = json.loads(done.stdout.splitlines()[-1])["found"]
        self.assertEqual(len(found["maxima"]), len(found["runs"]))
        self.assertGreater(min(found["maxima"]), 1000, "every passage loads the cone")
        # Each maximum is below the largest step of its run, and the curve rises as it gets rarer.
        with open(self.folder / "out/seeds/runs.csv", newline="") as file:
            rows = {row["run"]: row for row in csv.DictReader(file)}
        for folder, largest in zip(found["runs"], found["largest_of_runs"]):
            row = rows[os.path.basename(folder)]
            self.assertLess(largest, np.linalg.norm([float(row[f"peak_force_cone_{a}"])
                                                     for a in "xyz"]))
        values = [level["moments"] for level in found["gumbel"]["levels"]]
        self.assertTrue(np.all(np.diff(values, axis=0) > 0))
        said = re.findall(r"^exceeded in ([\d.]+) of the passages: (\d+) kN", done.stdout, re.M)
        self.assertEqual([(float(p), float(v)) for p, v in said],
                         [(level["probability"], round(level["moments"][0] / 1e3))
                          for level in found["gumbel"]["levels"]])
        # The run that was stepped in Python and that of the same seed in the ensemble are one.
        summary = json.loads((self.folder / "out/cone/summary.json").read_text())
        third = rows["s003"]
        self.assertEqual([summary["beams_broken"], summary["steps"]],
                         [int(third["beams_broken"]), int(third["steps"])])
        self.assertEqual(repr(summary["peak_force"]["cone"][0]), third["peak_force_cone_x"])


class Ensembles(PythonTest):
    def test_refusals(self):
        """One line each; nothing is written."""
        self.scene("forces: [beam]\nsheet: {length: 6, thickness: 0.5, element_size: 2}\n"
                   "time: {end: 1, dt: 1}\n")
        self.python("""
            from pathlib import Path
            def refused(words, *given, **more):
                try:
                    floe.run_ensemble(*given, **more)
                except floe.InputError as error:
                    assert words in str(error) and "\\n" not in str(error), error
                else:
                    raise AssertionError(words)
            spec = {"scene": Path("s.yaml"), "seeds": np.arange(1, 3)}
            refused("seeds: -1", {**spec, "seeds": -1})
            refused("seed: ", {**spec, "seed": 1})
            refused("no.yaml", {**spec, "scene": "no.yaml"})
            refused("jobs: 0", spec, jobs=0)
            refused("only: 's001' must be a list", spec, only="s001")
            refused("only: 's003' is no run", spec, only=["s003"])
            refused("no.yaml", "no.yaml")
            refused("sheet: thickness: -1", {**spec, "options": {"sheet_thickness": -1.0}})
            assert not Path("out").exists()
            Path("full").mkdir()
            Path("full/file").touch()
            refused("full: is neither empty nor", spec, "full")
        """)

    def test_one_run_at_a_time_and_failures(self):
        """Only what is named is run; a run that fails has a row with its words, and the rest is
        done. A list of numpy is the spec's list."""
        self.scene("integrator: explicit\nforces: [beam, gravity, buoyancy]\n"
                   "sheet: {length: 6, thickness: 0.5, element_size: 2, iterations: 5}\n"
                   "initial: {names: [i], i: {set: right, velocity: [0, 0, 1]}}\n"
                   "time: {end: 0.1}\n")
        self.python("""
            spec = {"scene": "s.yaml", "grid": {"limit_velocity": np.array([1e-3, 100.0])}}
            part = floe.run_ensemble(spec, "some", only=["p002"])
            assert list(part) == ["p002"] and part["p002"].status == "done"
            every = floe.run_ensemble(spec, "some")
            states = every.table["status"]
            assert dict(states) == {"p001": "failed", "p002": "done"}, states
            assert "velocity" in every.table["message"]["p001"]
        """)

    def test_not_under_mpiexec(self):
        out = self.python("""
            floe.run_ensemble({"scene": "s.yaml"})
        """, ranks=2, code=1)
        self.assertIn("without mpiexec", out)


if __name__ == "__main__":
    unittest.main()
