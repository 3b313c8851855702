#!/usr/bin/python3
"""tools/validate: formulas against published numbers, measures on made runs, verdicts, rows that go
on after a kill, the page of what is finished, bad specs and command lines."""
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

from launch import ENVIRONMENT, FLOE, REPOSITORY, FolderTest

sys.path.insert(0, str(REPOSITORY / "tools"))
sys.path.insert(0, str(REPOSITORY / "python"))
import floe_validation as validation  # noqa: E402
import floe_validation_formulas as formulas  # noqa: E402
import floe_validation_ice as ice  # noqa: E402
import floe_validation_page as pages  # noqa: E402
import floe_validation_sheets as sheets  # noqa: E402
from floe.errors import InputError  # noqa: E402
from floe_validation_lines import Found, Line  # noqa: E402

TOOL = str(REPOSITORY / "tools/validate")


class Formulas(unittest.TestCase):
    def test_slope(self):
        """OpenFAST IceFloe's own test log, and bare ice."""
        found = formulas.iso_slope(1, 5, 60, 0.15, 0.7e6, 8e9, 3, ice=916.2, water=999.8)
        for part, value in (("H_B", 1.8441), ("H_R", 0.4083), ("H_L", 0.2097), ("H_T", 0.0426),
                            ("H_P", 0.0022), ("H", 2.660)):
            self.assertAlmostEqual(found[part] / 1e6, value, delta=6e-5 if part != "H" else 6e-4)
        for h, angle, load in ((0.5, 45, 0.255), (0.5, 55, 0.346), (0.5, 60, 0.423),
                               (1, 45, 0.909), (1, 55, 1.224), (1, 60, 1.494)):
            self.assertAlmostEqual(
                formulas.iso_slope(h, 10, angle, 0.1, 0.5e6, 4e9)["H"] / 1e6, load, delta=6e-4)

    def test_crushing(self):
        self.assertAlmostEqual(formulas.iso_crushing(1, 5, 2.2e6) * 5 / 1e6, 8.503, 3)
        self.assertAlmostEqual(formulas.iso_crushing(0.5, 4, 1.8e6) * 2 / 1e6, 3.406, 3)

    def test_beams_on_water(self):
        for h, loads in ((0.5, (7.54, 11.46, 14.71)), (1, (18.24, 27.94, 36.12))):
            for angle, load in zip((45, 55, 60), loads):
                self.assertAlmostEqual(
                    formulas.first_failure(h, angle, 0.1, 5e5, 4e9) / 1e3, load, delta=0.006)
        self.assertAlmostEqual(formulas.edge_uplift(0.5, 5e5, 4e9) / (0.6804 * 5e5 * (
            1010 * 9.81 * 0.5**5 / 4e9)**0.25), 1, 3)

    def test_floe_in_waves(self):
        """Long waves carry it along; in one of its own length it does not heave."""
        for amplitude in formulas.thin_floe(1, 1000, 0):
            self.assertAlmostEqual(amplitude, 1, 4)
        self.assertAlmostEqual(formulas.thin_floe(10, 10, 0.3)[0], 0, 9)


class Verdicts(unittest.TestCase):
    def test_lines(self):
        line = Line("x", [1.0, 1.2, 1.1], 1.0, [0.95, 1.05])
        self.assertEqual(line.verdict, "disagrees")
        # Student's t of 2 degrees of freedom: 4.303 x 0.1/sqrt 3
        self.assertAlmostEqual(line.band, 0.2484, 4)
        self.assertAlmostEqual(line.deviation, 0.1)
        line.by_band = True
        self.assertEqual(line.verdict, "agrees")
        self.assertEqual(Line("x", [1.04], 1.0, [0.95, 1.05]).verdict, "agrees")
        self.assertEqual(Line("x", [2.0]).verdict, "")

    def test_rows(self):
        class Chaotic:
            chaotic = True
        good, bad = Line("x", [1.0] * 9, 1, [0.9, 1.1]), Line("x", [2.0] * 12, 1, [0.9, 1.1])
        self.assertEqual(validation.verdict_of(Chaotic, Found([bad], "", "", [])), "disagrees")
        self.assertEqual(validation.verdict_of(Chaotic, Found([good, bad], "", "", [])),
                         "disagrees, 9 of 10 seeds")
        Chaotic.chaotic = False
        self.assertEqual(validation.verdict_of(Chaotic, Found([good], "", "", [])), "agrees")


class Specs(FolderTest):
    def test_all_rows_are_read(self):
        rows = validation.rows()
        self.assertEqual([row.name for row in rows],
                         sorted(path.stem for path in validation.SPECS.glob("*.yaml")))
        for row in rows:
            runs = row.folder("x").runs
            self.assertEqual(len({run.name for run in runs}), len(runs))
            if row.chaotic:  # ten seeds where chaos rules
                points = {validation.Drawn(run, "x").point for run in runs}
                self.assertGreaterEqual(len(runs), 10 * len(points), row.name)
        self.assertGreater(len(validation.rows(short=True)), 3)

    def test_what_is_wrong_is_said(self):
        path = self.folder / "row.yaml"
        good = (validation.SPECS / "first_failure.yaml").read_text().replace(
            "../../input", str(REPOSITORY / "input"))
        path.write_text(good)
        validation.Row(path)
        for old, new, part in (
                ("measure: slope_failure", "measure: slop", "measure: 'slop' must be one of"),
                ("seconds: 40", "secs: 40", "secs: unknown key; is it 'seconds'?"),
                ("seconds: 40", "seconds: long", "seconds: 'long' must be a finite number"),
                ("title: First", "chaotic: 3\ntitle: First", "chaotic: 3 must be true or false"),
                ("runs:\n", "runs:\n  sead: 1\n", "sead: unknown key"),
                ("input/verify/ice_slope", "input/none", "none.yaml' must be a file"),
                ("source: >\n", "sorce: >\n", "sorce: unknown key")):
            with self.subTest(new):
                self.assertIn(old, good)
                path.write_text(good.replace(old, new, 1))
                with self.assertRaisesRegex(InputError, re.escape(part)):
                    validation.Row(path)
        path.write_text(good.replace("points: [h05_a45_v002,", "points: [none,"))
        with self.assertRaisesRegex(InputError, "short: points: .* must be names"):
            validation.Row(path, short=True)
        path.write_text("seconds: [")
        with self.assertRaises(InputError):
            validation.Row(path)


# Says where it is run, and is done at once; a run of seed 2 waits until it may end.
FAKE = """#!/bin/bash
for word; do
  [ "$word" = -check ] && { echo "plan; about 1 s (by 1 evaluation)"; exit; }
  [ "$last" = -output_dir ] && output=$word
  last=$word
done
echo "${output##*/}" >>started
[[ $output == *s002 ]] && [ ! -e go ] && exec sleep 1000
mkdir -p "$output"
echo '{"version": "9.9"}' >"$output/summary.json"
echo "floe: no equilibrium" >&2
exit 1
"""


class Runs(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "fake").write_text(FAKE)
        (self.folder / "fake").chmod(0o755)
        # A copy of the tools, whose only row is that of the test.
        shutil.copytree(REPOSITORY / "tools", self.folder / "tools",
                        ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copytree(REPOSITORY / "python", self.folder / "python",
                        ignore=shutil.ignore_patterns("__pycache__", "web"))
        (self.folder / "docs/pictures").mkdir(parents=True)
        for path in (self.folder / "tools/validation").glob("*.yaml"):
            path.unlink()
        (self.folder / "tools/validation/row.yaml").write_text(
            "title: A row\ntext: t\npublished: p\nsource: s\nmeasure: uplift\nseconds: 60\n"
            "settings: {allowed: [0.9, 1.1]}\nends: no equilibrium\n"
            "runs: {scene: ../../input/edge_uplift.yaml, seeds: 3}\n")
        (self.folder / "input").symlink_to(REPOSITORY / "input")
        self.environment = {**ENVIRONMENT, "FLOE": str(self.folder / "fake")}

    def begin(self, *words):
        process = subprocess.Popen([self.folder / "tools/validate", *words], cwd=self.folder,
                                   env=self.environment, text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        self.addCleanup(self.end, process)
        return process

    def validate(self, *words, code=0):
        process = self.begin(*words)
        out, error = process.communicate()
        self.assertEqual(process.returncode, code, out + error)
        return out, error

    def started(self):
        path = self.folder / "started"
        return path.read_text().split() if path.exists() else []

    def test_it_goes_on_after_a_kill(self):
        words = ("--only", "row", "--jobs", "1", "--dir", "kept")
        self.validate(*words, "--seeds", "1")
        self.assertEqual(self.started(), ["s001"])
        process = self.begin(*words)
        while "s002" not in self.started():
            self.assertIsNone(process.poll(), "it ended too early")
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.wait()
        said, _ = self.validate("--list", "--dir", "kept")
        self.assertIn("1 of 3 runs are done, about 60 s of one core: A row", said)
        (self.folder / "go").touch()
        self.validate(*words)
        self.assertEqual(sorted(self.started()), ["s001", "s002", "s002", "s003"])
        self.validate(*words, "--seeds", "2")  # nothing is left to do
        # a run that ends where no equilibrium is left is done
        said, _ = self.validate("--list", "--dir", "kept")
        self.assertIn("3 of 3 runs are done", said)

    def test_page_of_what_is_there(self):
        """Real numbers of two runs of three; what is not run is said with its command."""
        (self.folder / "kept").mkdir()
        self.validate("--page", "--dir", "kept")
        page = (self.folder / "docs/validation.md").read_text()
        self.assertIn("**Not run** (0 of 3 runs are done): `tools/validate --only row`, about 60 s",
                      page)
        self.assertIn("Nowhere, in the rows that are run.", page)
        row = validation.Row(self.folder / "tools/validation/row.yaml")
        for seed, first in ((1, 0.8), (2, 1.0)):
            run = self.folder / f"kept/row/runs/s00{seed}"
            run.mkdir(parents=True)
            load = formulas.edge_uplift(0.5, 5e5, 4e9) * 8 * first
            (run / "history.csv").write_text(f"time,beams_broken\n0,0\n{load / 6e4},1\n")
            (run / "summary.json").write_text('{"version": "9.9"}')
            (run / "options.yaml").write_text(
                "sheet:\n  thickness: 0.5\n  element_size: 1\n  width: 8\nice:\n  young: 4e9\n"
                "fracture:\n  tensile_strength: 5e5\nload:\n  edge:\n    force: [0, 0, 6e4]\n"
                "    ramp: 1\n")
            results = self.folder / f"kept/row/results/s00{seed}.json"
            results.parent.mkdir(exist_ok=True)
            results.write_text('{"status": "done", "message": "", "results": {}}')
        (self.folder / "kept/row/ensemble.json").write_text('{"runs": {}}')
        found = row.found(row.finished(self.folder / "kept")[0])
        np.testing.assert_allclose(found.lines[0].values, [0.8, 1.0], rtol=1e-9)
        self.validate("--page", "--dir", "kept")
        page = (self.folder / "docs/validation.md").read_text()
        self.assertIn("floe 9.9, ", page)
        self.assertIn("**Not run in full**: 2 of 3 runs are done", page)
        # 0.9 is allowed: neither below 0.9 nor on top of the page
        self.assertIn("| 2 | 0.9 ± 1.3 | 1 (0.9 to 1.1) | -10.0 % | agrees |", page)
        picture = self.folder / "docs/pictures/validation_row.png"
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")
        history = self.folder / "kept/row/runs/s002/history.csv"
        history.write_text(f"time,beams_broken\n0,0\n{2 * load / 6e4},1\n")
        self.validate("--page", "--dir", "kept")
        page = (self.folder / "docs/validation.md").read_text()
        self.assertLess(page.index("+40.0 %"), page.index("## All rows"))  # first of all

        # A row that was run in full keeps its numbers, until another is run under its name.
        shutil.copytree(history.parent, self.folder / "kept/row/runs/s003")
        shutil.copy(self.folder / "kept/row/results/s002.json",
                    self.folder / "kept/row/results/s003.json")
        self.validate("--page", "--dir", "kept")
        whole = (self.folder / "docs/validation.md").read_text()
        self.assertNotIn("Not run", whole)
        (self.folder / "empty").mkdir()
        self.validate("--page", "--dir", "empty")
        self.assertEqual((self.folder / "docs/validation.md").read_text(), whole)
        spec = self.folder / "tools/validation/row.yaml"
        spec.write_text(spec.read_text().replace("seeds: 3", "seeds: 4"))
        self.validate("--page", "--dir", "empty")
        self.assertIn("**Not run** (0 of 4 runs are done)",
                      (self.folder / "docs/validation.md").read_text())

    def test_bad_input(self):
        for words, part in ((("--only", "none"), "--only: 'none' is no row; there are row"),
                            (("--page", "--dir", "none"), "--page: none is no folder"),
                            (("--page", "--short"), "--page writes all rows"),
                            (("--jobs", "0"), "0 is not at least 1"),
                            (("--sort",), "--sort"),
                            (("--short", "--only", "row"), "'row' is no row")):
            with self.subTest(words):
                _, error = self.validate(*words, code=2)
                self.assertEqual(len(error.splitlines()), 1, error)
                self.assertIn(part, error)
        self.assertFalse((self.folder / "out").exists())
        (self.folder / "other/row").mkdir(parents=True)
        (self.folder / "other/row/x").touch()
        _, error = self.validate("--list", "--dir", "other", code=2)
        self.assertIn("is neither empty nor an ensemble's folder", error)


class Short(FolderTest):
    def test_a_row(self):
        """Two real runs of a row's short form, which must be where they were found; and not be
        where they are not."""
        environment = {**ENVIRONMENT, "FLOE": str(FLOE)}
        done = subprocess.run([TOOL, "--short", "--only", "first_failure", "--dir", "kept"],
                              cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        numbers = [float(text) for text in re.findall(r": (0\.\d+)$", done.stdout, re.M)]
        self.assertEqual(len(numbers), 2)
        tools = self.folder / "tools"
        shutil.copytree(REPOSITORY / "tools", tools, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copytree(REPOSITORY / "python", self.folder / "python",
                        ignore=shutil.ignore_patterns("__pycache__", "web"))
        (self.folder / "input").symlink_to(REPOSITORY / "input")
        spec = tools / "validation/first_failure.yaml"
        spec.write_text(re.sub("within: .*", "within: [1.2, 1.3]", spec.read_text()))
        done = subprocess.run([tools / "validate", "--short", "--only", "first_failure", "--dir",
                               "kept"], cwd=self.folder, env=environment, capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("which is not within 1.2 to 1.3", done.stdout)


class Measures(FolderTest):
    def made(self, name, table, options, **more):
        """A run of these columns and options."""
        run = self.folder / name
        run.mkdir()
        rows = [",".join(table)] + [",".join(map(repr, map(float, row)))
                                    for row in zip(*table.values())]
        (run / "history.csv").write_text("\n".join(rows) + "\n")

        class Named:
            pass
        Named.name = name
        drawn = validation.Drawn(Named, run)
        drawn.options = options
        return drawn

    def test_southwell(self):
        """A deflection that grows as 1/(1 - P/P_c)."""
        time = np.arange(0, 0.895, 0.01)
        table = {"time": time, "nudge_load_displacement_z":
                 3.0 + time * (1e-5 + 1e-4 / (1 - time / 0.9))}
        run = self.made("free_s001", table, {"load_push_force": "8e6, 0, 0",
                                             "load_push_ramp": "1"})
        self.assertAlmostEqual(sheets.southwell(run, "nudge", 8) / 0.9e6, 1, 4)
        short = {key: values[:40] for key, values in table.items()}
        run = self.made("short_s001", short, {})
        with self.assertRaisesRegex(InputError, "does not grow enough"):
            sheets.southwell(run, "nudge", 8)

    def test_ridging(self):
        """Forces proportional to h, with scatter that a seed shares."""
        runs = []
        time = np.arange(0, 20, 0.1)
        for h in (0.5, 1.0):
            for seed in (1, 2, 3):
                force = -12 * 1e4 * h * (1 + 0.1 * seed) * np.ones(len(time))
                runs.append(self.made(f"h{h}_s00{seed}", {
                    "time": time, "hold_force_x": force, "push_displacement_x": 0.5 * time,
                    "energy_gravity": -time, "energy_water": time + abs(force) * time / 30},
                    {"sheet_thickness": str(h), "sheet_width": "12"}))
        found = ice.ridging(runs, {"start": 5, "published_ratio": 15,
                                        "allowed_ratio": [10, 20]})
        np.testing.assert_allclose(found.lines[0].values, 1, rtol=1e-9)
        self.assertEqual(found.lines[0].verdict, "agrees")
        ratios = [line for line in found.lines if "potential" in line.what]
        for line in ratios:
            self.assertAlmostEqual(line.mean, 15, 6)

    def test_table_and_numbers(self):
        line = Line("a|b", [2e6, 2.2e6], 1e6, [0.9e6, 1.1e6], unit="N/m")
        row = pages.table(["x"] * 6, [pages.cells(line)]).splitlines()[-1]
        self.assertEqual(row, "| a\\|b | 2 | 2.1 ± 1.3 MN/m | 1 MN/m (9e+05 to 1.1e+06) | "
                              "+110.0 % | **disagrees** |")


if __name__ == "__main__":
    unittest.main()
