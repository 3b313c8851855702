#!/usr/bin/python3
"""The tools answer bad input with one line and exit code 2: folders that are not there, damaged
files, runs without that result, times out of range, pictures that cannot be drawn.
"""
import os
import shutil
import subprocess
import sys
import unittest

from launch import FLOE, REPOSITORY, temporary_folder

TOOLS = REPOSITORY / "tools"
READERS = ("plot_sheet", "plot_fragments", "plot_load", "plot_deflection", "campaign_report",
           "loads", "netcdf", "vtkhdf")
SCENE = """forces: [beam]
sheet: {length: 10, thickness: 1, element_size: 3, iterations: 5}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
"""


class ToolsBadInput(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = temporary_folder(cls.addClassCleanup)
        (cls.folder / "s.yaml").write_text(SCENE)
        subprocess.run([str(FLOE), "s.yaml"], cwd=cls.folder, check=True, capture_output=True,
                       timeout=600)

    def refused(self, tool, *words, part=""):
        with self.subTest(tool=tool, words=words):
            run = subprocess.run([sys.executable, str(TOOLS / tool), *words], cwd=self.folder,
                                 capture_output=True,
                                 text=True, timeout=600, env={**os.environ, "FLOE": str(FLOE)})
            self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
            self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
            self.assertIn(part, run.stderr)

    def copy(self, name, *spoilt):
        """A copy of the run with some of its files cut to 2,000 bytes of nonsense."""
        shutil.copytree(self.folder / "out/s", self.folder / name)
        for pattern in spoilt:
            for file in (self.folder / name).glob(pattern):
                file.write_text("{" * 2000)
        return name

    def test_no_folder_and_an_empty_one(self):
        (self.folder / "empty").mkdir()
        for tool in READERS:
            for folder in ("none", "empty"):
                self.refused(tool, folder, part=folder)

    def test_reports(self):
        self.refused("report", "none", part="no folder")
        self.refused("report", "out", part="no obstacles")
        self.refused("report", "out/s", "--file", "x.txt", part=".html")
        self.refused("report", "out/s", "--filter", "x", part="filter 'x'")
        self.refused("report", self.copy("report_fields", "fields/*.h5"), part="fields")

    def test_damaged_files(self):
        for tool in ("plot_sheet", "plot_deflection"):
            self.refused(tool, self.copy(f"{tool}_summary", "summary.json"), part="summary.json")
            self.refused(tool, self.copy(f"{tool}_lattice", "lattice.h5"), part="lattice.h5")
            self.refused(tool, self.copy(f"{tool}_fields", "fields/*.h5"), part="fields")
        self.refused("plot_load", self.copy("history", "history.csv"))
        self.refused("plot_fragments", self.copy("breaks"))
        (self.folder / "breaks/breaks.h5").write_text("no")
        self.refused("plot_fragments", "breaks", part="breaks.h5")
        self.refused("loads", "history", part="history.csv")
        self.refused("netcdf", "history", part="history.csv")
        self.refused("vtkhdf", self.copy("vtkhdf_fields", "fields/*.h5"), part="fields")
        (self.folder / "history/history.csv").write_text("time,wall_peak_force_x\n0,x\n")
        self.refused("plot_load", "history", part="line 2")

    def test_runs_without_that_result(self):
        self.refused("plot_fragments", "out/s", part="nothing could break")
        self.refused("plot_load", "out/s", part="no obstacles")
        self.refused("loads", "out/s", part="no obstacles")
        self.refused("plot_deflection", "out/s", part="bending")

    def test_arguments(self):
        for time in ("99", "-1", "nan"):
            self.refused("plot_sheet", "out/s", "--time", time, part="time ")
        self.refused("plot_sheet", "out/s", "--file", "x.zzz", part="must end in one of")
        self.refused("plot_sheet", "out/s", "--file", "none/x.png", part="no folder")
        self.refused("plot_sheet", "out/s", "--colour", "red", part="red")
        for option, value in (("--filter", "low-pass"), ("--probability", "1.5"),
                              ("--start", "-1")):
            self.refused("loads", "out/s", option, value, part=value)

    def test_packages_that_are_not_there(self):
        (self.folder / "xarray.py").write_text("raise ModuleNotFoundError(name='xarray')")
        run = subprocess.run([sys.executable, str(TOOLS / "netcdf"), "out/s"], cwd=self.folder,
                             capture_output=True, text=True, timeout=600,
                             env={**os.environ, "PYTHONPATH": str(self.folder)})
        self.assertEqual((run.returncode, len(run.stderr.splitlines())), (2, 1), run.stderr)
        self.assertIn("apt-get install python3-xarray", run.stderr)

    def test_campaigns(self):
        self.refused("campaign", "--only", "none", part="none")
        self.refused("campaign", "--jobs", "0", part="0")
        self.refused("campaign", "--tests", "foo", part="foo")
        (self.folder / "c").mkdir()
        (self.folder / "c/campaign.json").write_text("{")
        self.refused("campaign", "--dir", "c", "--only", "L10_h1_3h", part="campaign.json")
        self.refused("campaign_report", "c", part="campaign.json")
        self.refused("strength", "--sizes", "a", part="a")
        self.refused("strength", "--only", "none", part="none")
        (self.folder / "runs.json").write_text("{")
        self.refused("strength", "--dir", ".", "--only", "L10_1", part="runs.json")

    def test_ensembles(self):
        self.refused("ensemble", part="SPEC.yaml")
        self.refused("ensemble", "none.yaml", part="none.yaml: cannot be read: No such file")
        (self.folder / "e.yaml").write_text("scene: s.yaml\nseeds: -1\n")
        self.refused("ensemble", "e.yaml", part="e.yaml: seeds: -1 must be")
        (self.folder / "e.yaml").write_bytes(b"\x89HDF\xff\x00")
        self.refused("ensemble", "e.yaml", part="e.yaml: cannot be read")

    def test_lattices(self):
        self.refused("make_lattice", part="KIND")
        self.refused("make_lattice", "block", "--size", "0", "1", "1", "x.h5")
        self.refused("make_lattice", "cantilever", "--elements", "0", "x.h5")
        self.refused("make_lattice", "rubble", "--columns", "0", "1", "1", "x.h5")
        self.assertFalse((self.folder / "x.h5").exists())

    def test_fields_of_floes(self):
        """More of it in test_make_floes.py."""
        self.refused("make_floes", part="FILE.geojson")
        self.refused("make_floes", "x.geojson", "--region", "0", "0", "9", "9", "--sizes", "one:1",
                     "--concentration", "96", part="96 is not within 20 to 95")
        self.assertFalse((self.folder / "x.geojson").exists())


if __name__ == "__main__":
    unittest.main()
