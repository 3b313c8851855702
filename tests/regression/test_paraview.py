#!/usr/bin/python3
"""ParaView opens fields.xmf and sees what fields.h5 holds: cells, times, bounds, values.

Needs ParaView and a virtual display (tools/setup --pictures); skipped where they are not installed.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import matplotlib.pyplot as plt
import numpy as np

from test_supply import SCENE

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "python"))
from floe.results.output import Output  # noqa: E402

FLOE = os.environ.get("FLOE", str(REPOSITORY / "build/release/floe"))

# Runs inside pvpython: per time and grid the counts, bounds and ranges of the cell data, as JSON.
LOOK = """
import json, sys
from paraview.simple import OpenDataFile
from paraview import servermanager

def leaves(data):
    if not data.IsA("vtkCompositeDataSet"):  # of VTKHDF
        return {"bodies" if data.GetCellData().HasArray("body") else "cracks": data}
    # The reader that OpenDataFile takes forgets the grids' names; what they carry tells them apart.
    found, at = {}, data.NewIterator()
    while not at.IsDoneWithTraversal():
        block = at.GetCurrentDataObject()
        cells = block.GetCellData()
        kind = ("bodies" if cells.HasArray("body") else
                "cracks" if cells.HasArray("beam") else "beams")
        found[kind] = block
        at.GoToNextItem()
    return found

def describe(block):
    cells = block.GetCellData()
    arrays = [cells.GetArray(i) for i in range(cells.GetNumberOfArrays())]
    ranges = {a.GetName(): [a.GetRange(k) for k in range(a.GetNumberOfComponents())]
              for a in arrays}
    return {"cells": block.GetNumberOfCells(), "bounds": block.GetBounds(), "ranges": ranges}

reader = OpenDataFile(sys.argv[1])
seen = []
for time in reader.TimestepValues:
    reader.UpdatePipeline(time)
    blocks = leaves(servermanager.Fetch(reader))
    described = {name: describe(block) for name, block in blocks.items()}
    seen.append({"time": time, "blocks": described})
with open(sys.argv[2], "w") as out:
    json.dump(seen, out)
"""


def count_polygons(topology):
    """Number of cells in an XDMF Mixed stream of polygons: 3, n, then n vertices, again and
    again."""
    cells, at = 0, 0
    while at < len(topology):
        if topology[at] != 3:
            raise AssertionError(f"cell code {topology[at]} at {at}, expected 3")
        at += 2 + topology[at + 1]
        cells += 1
    return cells


def version_of_paraview():
    said = subprocess.run(["pvpython", "--version"], capture_output=True, text=True)
    return tuple(map(int, re.findall(r"(\d+)\.(\d+)", said.stdout + said.stderr)[0]))


@unittest.skipUnless(shutil.which("pvpython") and shutil.which("xvfb-run"),
                     "ParaView is not installed (tools/setup --pictures)")
class ParaView(unittest.TestCase):
    def test_opens_fields(self):
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([FLOE, str(REPOSITORY / "input/tension.yaml"), "-sheet_length",
                                  "12",
                                  "-sheet_width", "10", "-sheet_iterations", "10", "-time_dt",
                                  "0.5",
                                  "-output_fields", "0.5", "-output_dir", f"{folder}/out"],
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            seen = self.look(Path(folder), Path(folder, "out/fields.xmf"))
            self.compare(seen, Path(folder, "out"))

    def test_cracks_appear(self):
        """The grid of cracks is there from the first break on."""
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([FLOE, str(REPOSITORY / "input/notch.yaml"), "-sheet_element_size",
                                  "2",
                                  "-output_fields", "0.05", "-output_dir", f"{folder}/out"],
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            seen = self.look(Path(folder), Path(folder, "out/fields.xmf"))
            numbers = []
            with h5py.File(Path(folder, "out/fields.h5")) as fields:
                samples = sorted((g for g in fields.values() if "time" in g.attrs),
                                 key=lambda g: g.attrs["time"])
                self.assertEqual(len(seen), len(samples))
                for sample, group in zip(seen, samples):
                    broken = np.flatnonzero(group["damage"][:] == 1)
                    cracks = sample["blocks"].get("cracks")
                    numbers.append(cracks["cells"] if cracks else 0)
                    self.assertEqual(numbers[-1], 2 * len(broken))
                    self.assertEqual(sample["blocks"]["beams"]["ranges"]["damage"][0][1],
                                     float(len(broken) > 0))
                    if cracks:
                        self.assertEqual(cracks["ranges"]["beam"], [[broken.min(), broken.max()]])
                        points = group["crack_points"][:]
                        bounds = np.column_stack([points.min(axis=0), points.max(axis=0)]).ravel()
                        np.testing.assert_allclose(cracks["bounds"], bounds, atol=1e-6)
            self.assertEqual(numbers[0], 0)
            self.assertGreater(numbers[-1], 10)

    def test_ice_joins_and_leaves(self):
        """fields.xmf shows the bodies, beams and cracks of each time; so does floe vtkhdf's file in
        ParaView 5.12 and later. floe render draws them."""
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "scene.yaml").write_text(SCENE)
            run = subprocess.run([FLOE, f"{folder}/scene.yaml", "-output_fields", "0.5",
                                  "-output_dir", f"{folder}/out"], capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            output = Output(Path(folder, "out"))
            self.assertTrue(output.changes)
            made = subprocess.run([str(REPOSITORY / "tools/vtkhdf"), f"{folder}/out"],
                                  capture_output=True, text=True)
            self.assertEqual(made.returncode, 0, made.stderr)
            seen = self.look(Path(folder), Path(folder, "out/fields.xmf"))
            self.assertEqual([sample["time"] for sample in seen], output.times.tolist())
            self.is_of_the_frames(seen, output, 1e-6)
            for sample, time in zip(seen, output.times):
                beams = output.at(time).beams["bodies"]
                self.assertEqual(sample["blocks"]["beams"]["cells"], len(beams))
                broken = int(np.sum(output.field("damage", time) >= 1))
                self.assertEqual(sample["blocks"].get("cracks", {"cells": 0})["cells"], 2 * broken)
            if version_of_paraview() >= (5, 12):
                self.is_of_the_frames(self.look(Path(folder), Path(folder, "out/bodies.vtkhdf")),
                                      output, 1e-5)
            drawn = subprocess.run([str(REPOSITORY / "tools/render"), f"{folder}/out", "--size",
                                    "320", "200", "--time", "1.5", "2", "--file",
                                    f"{folder}/a.png"], capture_output=True, text=True)
            self.assertEqual(drawn.returncode, 0, drawn.stdout + drawn.stderr)
            for k in (0, 1):
                pixels = plt.imread(f"{folder}/a_{k}.png")
                self.assertGreater(np.sum((pixels[:, :, 0] > 0.6) & (pixels[:, :, 2] < 0.96)), 2000)

    def is_of_the_frames(self, seen, output, tolerance):
        """Number of polygons, and bounds of the bodies [m]."""
        for sample, time in zip(seen, output.times):
            bodies, shapes = sample["blocks"]["bodies"], output.at(time).shapes
            self.assertEqual(bodies["cells"], len(shapes["corner_of"]) - 1)
            points = output.field("points", time)
            bounds = np.column_stack([points.min(axis=0), points.max(axis=0)]).ravel()
            np.testing.assert_allclose(bodies["bounds"], bounds, atol=tolerance)

    def test_opens_vtkhdf(self):
        """ParaView 5.12 and later read floe vtkhdf's files: the same points and values at every
        time, and cracks that open."""
        if version_of_paraview() < (5, 12):
            self.skipTest("VTKHDF with time needs ParaView 5.12")
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([FLOE, str(REPOSITORY / "input/notch.yaml"), "-sheet_element_size",
                                  "2", "-output_fields", "0.05", "-output_dir", f"{folder}/out"],
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            made = subprocess.run([str(REPOSITORY / "tools/vtkhdf"), f"{folder}/out"],
                                  capture_output=True, text=True)
            self.assertEqual(made.returncode, 0, made.stderr)
            bodies, cracks = (self.look(Path(folder), Path(file)) for file in made.stdout.split())
            with h5py.File(Path(folder, "out/fields.h5")) as fields:
                samples = sorted((g for g in fields.values() if "time" in g.attrs),
                                 key=lambda g: g.attrs["time"])
                self.assertEqual([s["time"] for s in bodies],
                                 [float(g.attrs["time"]) for g in samples])
                for body, crack, group in zip(bodies, cracks, samples):
                    points = group["points"][:]
                    bounds = np.column_stack([points.min(axis=0), points.max(axis=0)]).ravel()
                    np.testing.assert_allclose(body["blocks"]["bodies"]["bounds"], bounds,
                                               atol=1e-5)
                    self.same_ranges(body["blocks"]["bodies"]["ranges"]["displacement"],
                                     group["bodies_displacement"][:], 1e-6)
                    self.assertEqual(crack["blocks"]["cracks"]["ranges"]["open"][0][1],
                                     float("crack_beam" in group))

    def test_render_draws(self):
        """Pictures at given times with ice, water and obstacles, and a film."""
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([FLOE, str(REPOSITORY / "input/ice_cone.yaml"),
                                  "-sheet_iterations", "10", "-sheet_length",
                                  "12", "-sheet_width", "10", "-sheet_element_size", "2",
                                  "-obstacle_cone_base", "10,0,-4",
                                  "-time_end", "0.02", "-output_fields", "0.01", "-output_dir",
                                  f"{folder}/out"],
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            render = [str(REPOSITORY / "tools/render"), f"{folder}/out", "--size", "320", "200"]
            drawn = subprocess.run([*render, "--time", "0", "0.02", "--file", f"{folder}/a.png"],
                                   capture_output=True,
                                   text=True)
            self.assertEqual(drawn.returncode, 0, drawn.stdout + drawn.stderr)
            self.assertEqual(drawn.stdout.split(), [f"{folder}/a_0.png", f"{folder}/a_1.png"])
            pixels = (255 * plt.imread(f"{folder}/a_1.png")[:, :, :3]).astype(int)
            self.assertEqual(pixels.shape, (200, 320, 3))
            red, green, blue = np.moveaxis(pixels, 2, 0)
            self.assertGreater(np.sum((red > 150) & (blue < 245)), 2000)  # tops of the ice
            self.assertGreater(np.sum((red < 140) & (red >= blue) & (red > 20)), 500)  # the cone
            if shutil.which("ffmpeg"):
                film = subprocess.run([*render, "--film", f"{folder}/a.mp4"], capture_output=True,
                                      text=True)
                self.assertEqual(film.returncode, 0, film.stdout + film.stderr)
                self.assertGreater(Path(folder, "a.mp4").stat().st_size, 1000)

    def look(self, folder, file):
        """What ParaView sees in a file."""
        script, found = folder / "look.py", folder / "seen.json"
        script.write_text(LOOK)
        run = subprocess.run(["xvfb-run", "-a", "pvpython", str(script), str(file), str(found)],
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return json.loads(found.read_text())

    def compare(self, seen, out):
        """What was seen against fields.h5 and lattice.h5."""
        with h5py.File(out / "fields.h5") as fields, h5py.File(out / "lattice.h5") as lattice:
            faces = count_polygons(fields["mesh/topology"][:])
            self.assertEqual(faces, len(lattice["shapes/corner_of"]) - 1)
            samples = sorted((g for g in fields.values() if "time" in g.attrs),
                             key=lambda g: g.attrs["time"])
            self.assertEqual([s["time"] for s in seen], [0, 0.5, 1])
            self.assertEqual([float(g.attrs["time"]) for g in samples], [0, 0.5, 1])
            for sample, group in zip(seen, samples):
                bodies, beams = sample["blocks"]["bodies"], sample["blocks"]["beams"]
                self.assertEqual(bodies["cells"], faces)
                self.assertEqual(beams["cells"], len(lattice["beams/bodies"]))
                points = group["points"][:]
                bounds = np.column_stack([points.min(axis=0), points.max(axis=0)]).ravel()
                np.testing.assert_allclose(bodies["bounds"], bounds, atol=1e-6)
                self.same_ranges(bodies["ranges"]["face_displacement"],
                                 group["bodies_displacement"][:], 1e-6)
                self.same_ranges(beams["ranges"]["beams_force"], group["beams_force"][:], 1e-12)
                self.assertEqual(bodies["ranges"]["body"], [[0, len(lattice["bodies/mass"]) - 1]])

    def same_ranges(self, seen, values, tolerance):
        """Least and largest value of each column of `values`, to a tolerance relative to the
        largest of all."""
        ranges = np.column_stack([values.min(axis=0), values.max(axis=0)])
        np.testing.assert_allclose(seen, ranges, rtol=tolerance,
                                   atol=tolerance * np.abs(values).max())


if __name__ == "__main__":
    unittest.main()
