#!/usr/bin/python3
"""tools/bench precision: its scenes and the options of each run are good, and what it makes of
times, errors and loads is right."""
import os
import subprocess
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
sys.path.insert(0, str(REPOSITORY / "tools"))
sys.path.insert(0, str(REPOSITORY / "python"))
import floe_breaking as breaking  # noqa: E402
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


class Breaking(unittest.TestCase):
    """Loads of ice that breaks: cases slope and cone."""

    def test_every_variant_is_a_scene(self):
        for case in breaking.cases():
            for variant in (breaking.REFERENCE, *case.variants):
                with tempfile.TemporaryDirectory() as folder:
                    done = subprocess.run([FLOE, REPOSITORY / case.scene, *case.command(variant, 2),
                                           "-output_dir", folder, "-check"], capture_output=True,
                                          text=True)
                self.assertEqual(done.returncode, 0, f"{variant}: {done.stderr}")
            self.assertEqual(len(set(case.variants)), len(case.variants))

    def test_short_form(self):
        """Two seeds of 5 s: loads, a table, a figure; and again from its file."""
        case = replace(breaking.cases()[0], end=5, variants=breaking.KNOBS[:1])
        with tempfile.TemporaryDirectory() as folder:
            def runner():
                return breaking.Runner(FLOE, REPOSITORY, folder, dict(os.environ))
            runs = breaking.measure(case, runner(), 2, say=lambda *words, **how: None)
            rows, about = breaking.compare(case, runs)
            again = breaking.measure(case, runner(), 2, say=lambda *words, **how: None)
            self.assertEqual(again, runs)
            picture = Path(folder, "picture.png")
            breaking.draw(case, rows, picture)
            self.assertGreater(picture.stat().st_size, 1000)
        self.assertEqual([row["seeds"] for row in rows], [2, 2])
        self.assertEqual(rows[0]["changes"]["mean"][:2], (0, 0))
        self.assertEqual(rows[0]["time"], 1)
        self.assertGreater(about["filtered"][0], about["mean"][0])
        self.assertLess(rows[0]["ledger"], 1e-2)
        lines = breaking.table(case, rows, about)
        self.assertEqual(len([line for line in lines if line.startswith("| contact modulus")]), 1)

    def test_load_by_impulses(self):
        """Of a force 2 t + 1 from its mean since the start at uneven rows: 2 t + 1 - ROWS in the
        mean over each interval, where rows lie."""
        with tempfile.TemporaryDirectory() as folder:
            time = np.concatenate([[0], np.sort(np.random.default_rng(1).uniform(0, 1, 4000)), [1]])
            mean = (time**2 + time) / np.maximum(time, 1e-300)
            text = "time,wall_mean_force_x\n" + "".join(f"{t:.12g},{m:.12g}\n"
                                                        for t, m in zip(time, mean))
            Path(folder, "history.csv").write_text(text)
            ends, force = breaking.load_of(folder, "wall")
        np.testing.assert_allclose(ends, breaking.ROWS * np.arange(1, 51))
        np.testing.assert_allclose(force, 2 * ends + 1 - breaking.ROWS, rtol=1e-4)

    def test_running_mean(self):
        """Of a pulse of 0.3 s and 100 N, over 1 s: 30 N, whatever the interval of the rows."""
        for interval in (0.02, 0.05):
            time = interval * np.arange(1, round(5 / interval) + 1)
            force = np.where((time > 2 + interval / 2) & (time < 2.3 + interval / 2), 100.0, 0.0)
            self.assertAlmostEqual(breaking.running_mean(time, force, 1.0).max(), 30, places=9)
        self.assertAlmostEqual(breaking.running_mean(time, 0 * force + 7, 1.0).min(), 7)

    def test_spectrum(self):
        """A mean and two sines: their r.m.s. A/sqrt(2), each in its band; the centroid by power."""
        time = breaking.ROWS * np.arange(1, 3001)
        force = (50 + 4 * np.sin(2 * np.pi * 2 * time) + 3 * np.sin(2 * np.pi * 10 * time))
        found = breaking.measures_of(time, force)
        self.assertAlmostEqual(found["mean"], 50, delta=0.01)
        self.assertAlmostEqual(found["rms 0.5"], 4 / np.sqrt(2), delta=0.02)
        self.assertAlmostEqual(found["rms 5"], 3 / np.sqrt(2), delta=0.02)
        self.assertLess(found["rms 0"], 0.05)
        self.assertAlmostEqual(found["centroid"], (16 * 2 + 9 * 10) / 25, delta=0.02)

    def test_change(self):
        """The mean logarithm of pairs, its standard error, and the band of the seeds."""
        reference = np.array([1.0, 2.0, 4.0, 8.0])
        value, own, band = breaking.change(1.5 * reference, reference, 0.2)
        self.assertAlmostEqual(value, np.log(1.5))
        self.assertAlmostEqual(own, 0)
        self.assertAlmostEqual(band, 2 * np.sqrt(2 / 4) * 0.2)
        value, own, _ = breaking.change(reference * [2, 0.5, 2, 0.5], reference, 0.2)
        self.assertAlmostEqual(value, 0)
        self.assertAlmostEqual(own, np.log(2) * np.sqrt(4 / 3) / 2)
        row = {"changes": {"mean": (0.3, 0.1, 0.2), "filtered": (0.3, 0.2, 0.2),
                           "centroid": (-0.3, 0.1, 0.4)}}
        self.assertEqual([breaking.told_apart(row, name) for name in row["changes"]],
                         [True, False, False])


if __name__ == "__main__":
    unittest.main()
