#!/usr/bin/python3
"""tools/campaign: killed in the middle it goes on to the same table, a failed case does not stop
the rest, results of other options are refused, dynamics agree with statics, and the moduli tests
give one elastic material."""
import os
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

from running import processes_with

REPOSITORY = Path(__file__).resolve().parents[2]
CAMPAIGN = str(REPOSITORY / "tools/campaign")


def tables(folder):
    with h5py.File(folder / "results.h5") as file:
        profiles = {name: data[:] for name, data in file.get("profiles", {}).items()}
        return {test: file[test][:] for test in file if test != "profiles"}, profiles


class Campaign(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = Path(temporary.name)

    def command(self, folder, *words):
        return [CAMPAIGN, "--dir", str(self.root / folder), "--no-report", "--jobs", "2", *words]

    def campaign(self, folder, *words, expect=0):
        run = subprocess.run(self.command(folder, *words), capture_output=True, text=True)
        self.assertEqual(run.returncode, expect, run.stderr)
        return run.stderr

    def test_killed_and_restarted(self):
        which = ("--only", "L20", "--meshes", "2")
        self.campaign("straight", *which)
        finished = self.root / "killed/cases"
        # runs until five cases are finished; a later run never ends, so that the campaign does not
        stuck = self.root / "stuck"
        stuck.write_text(f"""#!/bin/bash
count=("{finished}"/*.json)
if [ ${{#count[@]}} -ge 5 ]; then exec -a "floe $*" sleep infinity; fi
exec "{os.environ["FLOE"]}" "$@"
""")
        stuck.chmod(0o755)
        process = subprocess.Popen(self.command("killed", *which), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL,
                                   env=dict(os.environ, FLOE=str(stuck)))
        while len(list(finished.glob("*.json"))) < 5:
            self.assertIsNone(process.poll())
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
        process.wait()
        while processes_with(str(self.root / "killed")):  # runs die with the campaign
            time.sleep(0.01)
        before = {path: path.stat().st_mtime_ns for path in finished.glob("*.json")}
        self.assertIn(len(before), (5, 6))
        self.assertFalse((self.root / "killed/results.h5").exists())
        said = self.campaign("killed", *which)
        self.assertIn(f"24 runs on 12 meshes, {len(before)} of them finished before", said)
        # not run again
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in before})
        rows, profiles = tables(self.root / "killed")
        expected, curves = tables(self.root / "straight")
        self.assertEqual(sorted(rows), ["bending", "tension"])
        for test in rows:
            self.assertEqual(rows[test].tolist(), expected[test].tolist())  # to the last digit
            self.assertEqual(len(rows[test]), 12)
        self.assertEqual(sorted(profiles), sorted(curves))
        for name, curve in curves.items():
            np.testing.assert_array_equal(profiles[name], curve)

    def test_failed_case_does_not_stop_the_rest(self):
        meshes = self.root / "meshes"
        meshes.mkdir()
        (meshes / "L10_h1_3h_02.h5").write_text("not HDF5")
        which = ("--only", "L10_h1_3h", "--meshes", "3", "--mesh-dir", str(meshes))
        said = self.campaign("out", *which, expect=1)
        self.assertIn("failed: tension_L10_h1_3h_02: exit code 2: ", said)
        self.assertIn("mesh_file", said)
        self.assertEqual([row["case"] for row in tables(self.root / "out")[0]["tension"]],
                         [b"tension_L10_h1_3h_01", b"tension_L10_h1_3h_03"])
        (meshes / "L10_h1_3h_02.h5").unlink()
        self.assertNotIn("failed", self.campaign("out", *which))  # only what failed is run
        self.assertEqual(len(tables(self.root / "out")[0]["tension"]), 3)

    def test_report_of_a_part(self):
        """Figures and tables of what there is; what was not run is said."""
        which = ("--only", "L10_h1_,L20_h1_", "--meshes", "2", "--mesh-dir",
                 str(self.root / "meshes"))
        self.campaign("out", *which)
        self.campaign("exact", *which, "--", "-beam_shear", "exact")
        done = subprocess.run([str(REPOSITORY / "tools/campaign_report"), str(self.root / "out"),
                               "--beside", f"exact shear={self.root / 'exact'}"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        report = (self.root / "out/report.md").read_text()
        row = tables(self.root / "out")[0]["tension"]
        for h, factor in ((1, 2), (1, 3)):
            values = row["E_over_Eb"][(row["L"] == 20) & (row["l"] == h * factor)]
            self.assertIn(f"| 20 | {h} | {factor}h | {20 / h / factor:.2f} | "
                          f"{116 if factor == 2 else 52} | {values.mean():.4f} ± "
                          f"{values.std(ddof=1):.4f} (2) |",
                          report)
        self.assertIn("| exact shear | `floe campaign -- -beam_shear exact` | 8 tension, "
                      "4 bending |", report)
        self.assertIn("| not run | – |", report)
        self.assertNotIn("nan", report)
        for number in (5, 6, 7):
            self.assertTrue((self.root
                             / f"out/figure_{number}.png").read_bytes().startswith(b"\x89PNG"))
            self.assertIn(f"figure_{number}.png", report)

    def test_bad_commands(self):
        self.campaign("out", "--only", "L10_h1_3h", "--meshes", "1")
        for words, named in ((("--only", "nothing"), "no case matches"),
                             (("--tests", "tenzion"), "tenzion"),
                             (("--only", "L10_h1_3h", "--", "-beam_shear", "exact"),
                              "choose another folder"),
                             (("--tests", "shear", "--integrator", "explicit"),
                              "shear is not for")):
            run = subprocess.run(self.command("out", *words), capture_output=True, text=True)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(named, run.stderr)

    def test_dynamics_agree_with_statics(self):
        """One mesh: bending at rest to 1 %, tension to 1 % without the dashpots' force and the
        ringing."""
        which = ("--only", "L20_h1.5_3h", "--meshes", "1", "--mesh-dir", str(self.root / "meshes"))
        self.campaign("static", *which)
        static = {test: table[0] for test, table in tables(self.root / "static")[0].items()}
        self.assertAlmostEqual(static["tension"]["E_stored_over_Eb"]
                               / static["tension"]["E_over_Eb"], 1, delta=3e-4)
        for integrator, start in (("explicit", "step"), ("explicit", "smooth"),
                                  ("implicit", "step")):
            folder = f"{integrator}_{start}"
            self.campaign(folder, *which, "--integrator", integrator, "--start", start)
            moving = {test: table[0] for test, table in tables(self.root / folder)[0].items()}
            self.assertEqual(moving["tension"]["integrator"], integrator.encode())
            self.assertAlmostEqual(moving["bending"]["deflection_max"]
                                   / static["bending"]["deflection_max"], 1, delta=0.001)
            self.assertAlmostEqual(moving["tension"]["E_stored_over_Eb"]
                                   / static["tension"]["E_over_Eb"], 1, delta=0.01)
            self.assertGreater(moving["tension"]["E_over_Eb"] / static["tension"]["E_over_Eb"],
                               1.01)  # the dashpots' force

    def test_one_elastic_material(self):
        """E, nu, G and K of plane stress, each by its own test: G = E/(2(1 + nu)), K = E/(2(1 -
        nu))."""
        self.campaign("out", "--tests", "tension,compression,biaxial,shear,slide", "--only",
                      "L40_h0.5_2h", "--meshes", "1")
        rows = {test: table[0] for test, table in tables(self.root / "out")[0].items()}
        young, poisson = rows["tension"]["E_gauge_over_Eb"], rows["tension"]["poisson"]
        # those of the infinite lattice (model.md, "Effective moduli of the lattice, calibrated
        # sheets")
        self.assertAlmostEqual(young, 0.7954, delta=0.01)
        self.assertAlmostEqual(poisson, 0.2046, delta=0.015)
        self.assertAlmostEqual(rows["compression"]["E_gauge_over_Eb"] / young, 1, delta=0.001)
        self.assertAlmostEqual(rows["compression"]["poisson"], poisson, delta=0.001)
        self.assertAlmostEqual(rows["shear"]["G_over_Eb"] / (young / (2 * (1 + poisson))), 1,
                               delta=0.02)
        self.assertAlmostEqual(rows["biaxial"]["K_over_Eb"] / (young / (2 * (1 - poisson))), 1,
                               delta=0.02)
        self.assertAlmostEqual(rows["biaxial"]["K_over_Eb"], 0.5, delta=0.003)


if __name__ == "__main__":
    os.environ.setdefault("FLOE", str(REPOSITORY / "build/release/floe"))
    unittest.main()
