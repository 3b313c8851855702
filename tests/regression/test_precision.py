#!/usr/bin/python3
"""tools/bench precision: its scenes and the options of each run are good, and what it makes of
times and errors is right."""
import os
import sys
import tempfile
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
sys.path.insert(0, str(REPOSITORY / "tools"))
import floe_precision as precision  # noqa: E402


def row(name, cpu, error, default=False):
    return {"name": name, "label": "", "default": default, "cpu": cpu, "error": error, "steps": 1,
            "newton": 0, "message": ""}


class Precision(unittest.TestCase):
    def test_every_case_runs_and_converges(self):
        """Statics where there are, and one implicit run, against the reference of a coarse mesh."""
        with tempfile.TemporaryDirectory() as folder:
            runner = precision.Runner(FLOE, folder, dict(os.environ), repeats=1)
            for case in precision.cases():
                mesh = case.meshes[0]
                reference = runner.run(case, mesh, precision.reference_options(case))
                self.assertIsNotNone(reference["measure"], f"{case.name}: {reference['message']}")
                run = runner.run(case, mesh, precision.implicit("-ts_rtol", "1e-4"))
                self.assertIsNotNone(run["measure"], f"{case.name}: {run['message']}")
                self.assertLess(precision.error(run, reference), 0.01, case.name)
                self.assertGreater(run["steps"], 4)
                again = precision.Runner(FLOE, folder,
                                         dict(os.environ)).run(case, mesh,
                                                               precision.implicit("-ts_rtol",
                                                                                  "1e-4"))
                self.assertEqual(again, run)  # from its file

    def test_front_and_ratios(self):
        rows = [row("a", 1, 1e-2), row("b", 2, 1e-3, True), row("c", 3, 1e-2), row("d", 4, 1e-5),
                row("e", 0.5, None)]
        self.assertEqual([r["name"] for r in precision.front(rows)], ["a", "b", "d"])
        self.assertEqual(precision.best(rows, 1e-2)["name"], "a")
        self.assertIsNone(precision.best(rows, 1e-9))
        cheapest, ratios = precision.ratios({"rows": rows}, 1e-2)
        self.assertEqual((cheapest["name"], ratios), ("a", [("b", 2.0)]))


if __name__ == "__main__":
    unittest.main()
