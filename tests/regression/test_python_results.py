#!/usr/bin/python3
"""floe.open: what Python programs get of a run is what its files hold, read here by csv, h5py and
json alone."""
import csv
import importlib.util
import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

import h5py
import matplotlib
import numpy as np

import launch
from launch import ENDLESS, ENVIRONMENT, FLOE, REPOSITORY, FolderTest, temporary_folder
from running import RunningTest
from supply_runs import SupplyTools

sys.path.insert(0, str(REPOSITORY / "python"))
import floe  # noqa: E402
from floe.results import frames  # noqa: E402

matplotlib.use("Agg")

# A sheet that is pushed against a wall, and breaks.
SCENE = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 12, width: 8, thickness: 0.5, element_size: 2, iterations: 5}
beam: {damping_ratio: 1}
fracture: {tensile_strength: 2e5, shear_strength: 2e5}
water: {drag_linear: 100}
contact: {young: 1e8}
obstacle:
  names: [wall]
  wall: {shape: box, centre: [8.2, 0, 0], size: [4, 20, 4]}
boundary: {names: [back], back: {set: left, fix: x, velocity: [0.5, 0, 0]}}
time: {end: 1.5}
output: {history: 0.02, fields: 0.3, pressure: 0.1, pressure_patch: 1}
"""


def columns_of(folder):
    """{column: numbers} of history.csv."""
    with open(folder / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def frames_in(folder):
    """[(time, {dataset: array})] in order of time."""
    found = []
    for path in folder.glob("fields/[0-9]*.h5"):
        with h5py.File(path) as file:
            if path.suffixes == [".h5"] and path.stem.isdigit():
                found += [(group.attrs["time"], {name: data[:] for name, data in group.items()})
                          for group in file.values()]
    return sorted(found, key=lambda frame: frame[0])


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = temporary_folder(cls.addClassCleanup)
        (cls.folder / "scene.yaml").write_text(SCENE)
        done = launch.run("scene.yaml", cwd=cls.folder)
        assert done.returncode == 0, done.stderr
        cls.out = cls.folder / "out/scene"

    def setUp(self):
        self.run_ = floe.open(self.out)

    def tearDown(self):
        matplotlib.pyplot.close("all") if "matplotlib.pyplot" in sys.modules else None

    def test_history(self):
        table, wanted = self.run_.history, columns_of(self.out)
        self.assertEqual(table.index.name, "time")
        self.assertEqual(list(table), [name for name in wanted if name != "time"])
        np.testing.assert_array_equal(table.index, wanted["time"])
        for name in table:
            np.testing.assert_array_equal(table[name], wanted[name], name)
        units = table.attrs["units"]
        self.assertEqual(set(units), set(wanted))
        for name, unit in {"time": "s", "wall_force_x": "N", "wall_mean_force_z": "N",
                           "wall_moment_y": "N m", "back_displacement_x": "m",
                           "energy_strain": "J", "beams_broken": "1", "contacts": "1"}.items():
            self.assertEqual(units[name], unit, name)
        self.assertIs(self.run_.history, table)  # not read again

    def test_fields(self):
        data, wanted = self.run_.fields, frames_in(self.out)
        np.testing.assert_array_equal(data["time"], [time for time, _ in wanted])
        self.assertGreater(len(wanted), 4)
        for name, of_file in (("position", "centres"), ("displacement", "bodies_displacement"),
                              ("rotation", "bodies_rotation"), ("beam_force", "beams_force"),
                              ("beam_moment", "beams_moment"), ("damage", "damage"),
                              ("tensile_stress", "tensile_stress"),
                              ("shear_stress", "shear_stress")):
            values = np.array([frame[of_file] for _, frame in wanted])
            self.assertTrue(np.any(values), name)
            np.testing.assert_array_equal(data[name].values, values, name)
        self.assertEqual(data["position"].dims, ("time", "body", "axis"))
        self.assertEqual(data["damage"].dims, ("time", "beam"))
        self.assertEqual({name: data[name].attrs["units"] for name in
                          ("position", "rotation", "beam_force", "beam_moment", "shear_stress",
                           "mass", "time")},
                         {"position": "m", "rotation": "rad", "beam_force": "N",
                          "beam_moment": "N m", "shear_stress": "Pa", "mass": "kg", "time": "s"})
        np.testing.assert_array_equal(data["displacement"].sel(axis="z").isel(time=-1),
                                      wanted[-1][1]["bodies_displacement"][:, 2])
        with h5py.File(self.out / "lattice.h5") as file:
            np.testing.assert_array_equal(data["mass"], file["bodies/mass"])
            np.testing.assert_array_equal(data["bodies"], file["beams/bodies"])
        with h5py.File(self.out / "breaks.h5") as file:
            np.testing.assert_array_equal(data["fragment"].isel(time=-1),
                                          file["fragments/of_body"])
        self.assertEqual(data["fragment"].isel(time=0).max(), 0)

    def test_fields_are_lazy(self):
        read = frames.Values.frame
        with mock.patch.object(frames.Values, "frame", autospec=True, side_effect=read) as frame:
            data = floe.open(self.out).fields
            late = data["displacement"].sel(time=0.9, method="nearest").isel(axis=0)
            largest = data["damage"].max()
            self.assertEqual(frame.call_count, 0)
            late.values
            self.assertEqual(frame.call_count, 1)
            largest.values
            self.assertEqual(frame.call_count, 1 + len(data["time"]))

    def test_lattice_breaks_summary(self):
        run = self.run_
        with h5py.File(self.out / "lattice.h5") as file:
            np.testing.assert_array_equal(run.lattice.position, file["bodies/position"])
            np.testing.assert_array_equal(run.lattice.beams["width"], file["beams/width"])
        with h5py.File(self.out / "breaks.h5") as file:
            self.assertGreater(len(file["time"]), 3)
            table = run.breaks.sort_values("beam")
            order = np.argsort(file["beam"][:])
            for name, values in {"beam": file["beam"], "body_a": file["bodies"][:, 0],
                                 "body_b": file["bodies"][:, 1], "y": file["place"][:, 1],
                                 "energy": file["energy"], "mode_mix": file["mode_mix"]}.items():
                np.testing.assert_array_equal(table[name], values[:][order], name)
            np.testing.assert_array_equal(table.index, file["time"][:][order])
            np.testing.assert_array_equal(run.fragments["mass"], file["fragments/mass"])
        self.assertTrue(np.all(np.diff(run.breaks.index) >= 0))
        self.assertEqual(run.breaks.attrs["units"]["energy"], "J")
        self.assertEqual(len(run.breaks), run.history["beams_broken"].iloc[-1])
        self.assertEqual(run.summary, json.loads((self.out / "summary.json").read_text()))
        self.assertEqual(run.status, "done")
        self.assertEqual([run.options[name] for name in ("sheet_thickness", "fracture_energy_shear",
                                                         "integrator")][::2], [0.5, "explicit"])
        self.assertEqual(run.obstacles, ["wall"])

    def test_pressure(self):
        patches = self.run_.pressure["wall"]
        history = self.run_.history
        at = np.searchsorted(history.index, patches.time - 1e-9)
        np.testing.assert_allclose(patches.total[:, 0], history["wall_force_x"].iloc[at], rtol=1e-9)
        with open(self.out / "pressure.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["patch"] != "all"]
        wanted = np.zeros_like(patches.force)
        for row in rows:
            k, t = int(row["patch"]), np.argmin(np.abs(patches.time - float(row["time"])))
            wanted[t, k] = -sum(float(row[f"force_{axis}"]) * normal
                                for axis, normal in zip("xyz", patches.normal[k]))
        self.assertGreater(wanted.max(), 1e4)
        np.testing.assert_allclose(patches.force, wanted, rtol=1e-12, atol=1e-6)

    def test_loads(self):
        """The mean of a component is the difference of impulses over the time."""
        wanted = columns_of(self.out)
        time, mean = np.array(wanted["time"]), np.array(wanted["wall_mean_force_x"])
        found = self.run_.loads(component="x", filter="none")
        end = found["interval"] * np.floor(time[-1] / found["interval"] + 1e-3)
        impulse = np.interp(end, time, time * mean)
        self.assertAlmostEqual(found["mean"] / (impulse / end), 1, delta=1e-9)
        self.assertGreater(found["mean"], 1000)
        self.assertEqual(self.run_.loads("wall", component="x", filter="none"), found)
        for words, said in (({"obstacle": "leg"}, "no obstacle leg (known: wall)"),
                            ({"component": "w"}, "component 'w' is none of horizontal"),
                            ({"filter": "mean"}, "filter 'mean' is none of"),
                            ({"smooth": 1}, "smooth: no setting of a load"),
                            ({"start": -1}, "start -1 is out of its range")):
            with self.assertRaises(floe.InputError) as raised:
                self.run_.loads(**words)
            self.assertIn(said, str(raised.exception))

    def test_plots(self):
        run, wanted = self.run_, columns_of(self.out)
        axes = run.plot.load("z")
        np.testing.assert_allclose(axes.lines[0].get_ydata(),
                                   np.array(wanted["wall_force_z"]) / 1e3)
        both = np.hypot(wanted["wall_force_x"], wanted["wall_force_y"]) / 1e3
        np.testing.assert_allclose(run.plot.load(axes=axes).lines[1].get_ydata(), both)
        axes = run.plot.energies()
        line, = (line for line in axes.lines if line.get_label() == "kinetic")
        size = {"J": 1, "kJ": 1e3, "MJ": 1e6}[axes.get_ylabel().split("[")[1][:-1]]
        kinetic = np.array(wanted["energy_kinetic"])
        np.testing.assert_allclose(line.get_ydata(), (kinetic - kinetic[0]) / size)
        bodies = len(run.lattice.mass)
        axes = run.plot.sheet(colour="ux", time=0.6)
        cells, = axes.collections
        self.assertEqual(len(cells.get_paths()), bodies)
        moved = run.fields["displacement"].sel(axis="x").sel(time=0.6, method="nearest")
        np.testing.assert_allclose(cells.get_array() / np.max(cells.get_array()),
                                   moved / moved.max())
        axes = run.plot.fragments()
        cells, cracks = axes.collections
        self.assertEqual(len(cells.get_paths()), bodies)
        self.assertEqual(len(cracks.get_paths()), len(run.breaks))
        for refused in (lambda: run.plot.sheet(colour="red"), lambda: run.plot.sheet(time=9),
                        lambda: run.plot.load("w")):
            with self.assertRaises(floe.InputError):
                refused()

    @unittest.skipIf(importlib.util.find_spec("pyvista"), "pyvista is installed")
    def test_without_pyvista(self):
        with self.assertRaisesRegex(ImportError, "to_pyvista needs the package pyvista"):
            self.run_.to_pyvista()

    def test_polygons(self):
        """What pyvista would be given: faces with their corners, values of the bodies."""
        class PolyData:
            def __init__(self, points, faces):
                self.points, self.faces, self.cell_data = points, faces, {}
        with mock.patch.dict(sys.modules, pyvista=mock.Mock(PolyData=PolyData)):
            made = self.run_.to_pyvista(0)
        last = frames_in(self.out)[0][1]
        np.testing.assert_array_equal(made.points, last["points"])
        faces, k = [], 0
        while k < len(made.faces):
            faces.append(made.faces[k + 1:k + 1 + made.faces[k]])
            k += 1 + made.faces[k]
        self.assertEqual(len(faces), len(made.cell_data["body"]))
        # The volume of each body by the divergence theorem: outward faces, at the right body.
        volume = np.zeros(len(last["centres"]))
        for corners, body in zip(faces, made.cell_data["body"]):
            p = last["points"][corners] - last["centres"][body]
            volume[body] += sum(np.dot(p[0], np.cross(p[i], p[i + 1]))
                                for i in range(1, len(p) - 1)) / 6
        np.testing.assert_allclose(volume * 920, self.run_.lattice.mass, rtol=1e-9)
        self.assertEqual(set(made.cell_data["fragment"]), {0})

    def test_importing_reads_nothing_else(self):
        """import floe takes neither the compiled module nor any package."""
        code = ("import sys; before = set(sys.modules); import floe; floe.InputError\n"
                "print(*sorted({m.split('.')[0] for m in set(sys.modules) - before}))\n"
                "floe.open(sys.argv[1]).summary\n"
                "print(*({'pandas', 'xarray', 'dask', 'matplotlib', 'scipy'} & set(sys.modules)))")
        done = subprocess.run([sys.executable, "-c", code, str(self.out)], text=True, check=True,
                              capture_output=True,
                              env={**ENVIRONMENT, "PYTHONPATH": str(REPOSITORY / "python")})
        first, second = done.stdout.split("\n")[:2]
        self.assertFalse({"numpy", "h5py", "pandas"} & set(first.split()), first)
        self.assertEqual(second, "")


class BadFolders(FolderTest):
    def refused(self, what, part):
        with self.assertRaises(floe.InputError) as raised:
            what()
        said = str(raised.exception)
        self.assertIn(part, said)
        self.assertNotIn("\n", said)

    def test_messages(self):
        self.assertTrue(issubclass(floe.InputError, ValueError))
        folder = self.folder / "run"
        self.refused(lambda: floe.open(folder), f"{folder}: no such folder")
        folder.mkdir()
        self.refused(lambda: floe.open(folder), f"{folder}: is no output folder of a run")
        history = folder / "history.csv"
        history.write_text("time,wall_force_x\n0,1\n1,x\n")
        self.refused(lambda: floe.open(history), "history.csv: is no folder")
        run = floe.open(folder)
        self.refused(lambda: run.history, "history.csv: cannot be read: line 3: wall_force_x is no "
                                          "number: 'x'")
        history.write_text("time,wall_force_x\n0\n")
        self.refused(lambda: run.history, "line 2: wall_force_x is no number: None")
        history.write_text("time,wall_force_x\n0,nan\n")
        self.assertTrue(np.isnan(run.history["wall_force_x"].iloc[0]))
        self.refused(lambda: run.fields, "lattice.h5: cannot be read: ")
        self.refused(lambda: run.pressure, "has no pressure.csv")
        self.refused(lambda: run.ensemble, "is the output folder of one run")
        self.refused(run.loads, "the scene has no obstacles")
        self.assertEqual((run.summary, run.status), ({}, "under way"))
        (folder / "summary.json").write_text("{")
        self.refused(lambda: run.summary, "summary.json: cannot be read: ")
        (folder / "lattice.h5").write_bytes(b"no")
        self.refused(lambda: run.lattice, "lattice.h5: cannot be read: ")


class RunsUnderWay(RunningTest):
    def test_grows(self):
        """A run that is watched: whole rows and frames only, and ever more of them."""
        process = self.running(*ENDLESS, "-output_fields", "0.01")
        folder = self.folder / "out/scene"
        run = floe.open(folder)
        self.assertEqual(run.status, "under way")
        for _ in range(3):
            rows, times = len(run.history), len(run.fields["time"])
            self.wait(process, lambda: len(run.history) > rows
                      and len(run.fields["time"]) > times)
            self.assertTrue(np.all(np.diff(run.history.index) > 0))
            data = run.fields
            known = len(data["time"])
            self.assertEqual(data["time"].values.tolist(), run.times[:known].tolist())
            self.assertFalse(np.any(np.isnan(data["position"].values)))
        self.assertEqual(len(run.breaks), 0)  # nothing can break
        process.kill()
        process.wait()
        whole = run.history
        path = folder / "history.csv"
        path.write_text(path.read_text() + "9e9,1.2")  # as a write that is cut
        self.assertTrue(run.history.equals(whole))

    def test_goes_on(self):
        """A run in three parts is one history and one row of frames; what was read before is read
        anew."""
        words = ("-time_end", "0.2", "-output_fields", "0.02", "-checkpoint_every", "1000")
        self.floe(*words, "-output_dir", "whole")
        straight = floe.open(self.folder / "whole")
        third = straight.summary["steps"] // 3
        self.floe(*words, "-output_dir", "parts", "-ts_max_steps", str(third))
        run = floe.open(self.folder / "parts")
        rows, times = len(run.history), len(run.times)
        self.floe(*words, "-checkpoint_restart", "parts/checkpoint.h5", "-ts_max_steps",
                  str(2 * third))
        self.assertGreater(len(run.history), rows)
        self.floe(*words, "-checkpoint_restart", "parts/checkpoint.h5")
        self.assertGreater(len(run.times), times)
        # The end of a part may be a sample that the straight run has not.
        self.assertLessEqual(len(run.history), len(straight.history) + 2)
        self.assertTrue(run.history.loc[straight.history.index].equals(straight.history))
        self.assertTrue(np.all(np.diff(run.history.index) > 0))
        np.testing.assert_array_equal(run.fields["position"].sel(time=straight.times),
                                      straight.fields["position"])
        self.assertEqual(run.status, "done")


class Supply(SupplyTools):
    def test_bodies_join_and_leave(self):
        run = floe.open(self.folder / "a")
        data, account = run.fields, self.account
        self.assertTrue(self.output.changes)
        there = ~np.isnan(data["position"].values[..., 0])
        mass = data["mass"].values
        for k, time in enumerate(self.output.times):
            ice = self.output.at(time)
            np.testing.assert_array_equal(data["body"][there[k]], ice.names)
            self.assertAlmostEqual(mass[there[k]].sum() / account.at(time)["mass"], 1, 9)
            np.testing.assert_array_equal(data["position"][k].values[there[k]],
                                          self.output.field("centres", time))
            damage = data["damage"][k].values
            whole = ~np.isnan(damage)
            self.assertEqual(whole.sum(), len(ice.beams["bodies"]))
            self.assertEqual((damage[whole] >= 1).sum(), account.at(time)["beams_broken"])
            self.assertEqual(data["fragment"][k].max() + 1, account.at(time)["fragments"])
            self.assertTrue(np.all(np.isin(data["bodies"].values[whole], ice.names)))
        self.assertFalse(np.all(there[0] == there[-1]))

    def test_breaks(self):
        """All breaks of the run, also of beams that have left; those of bodies that are there at
        the end are the ones that history.csv counts."""
        run = floe.open(self.folder / "a")
        last = self.output.at(self.output.times[-1]).names
        here = run.breaks[["body_a", "body_b"]].isin(last).all(axis=1)
        self.assertEqual(here.sum(), run.history["beams_broken"].iloc[-1])
        self.assertGreater((~here).sum(), 0)
        self.assertTrue(np.all(np.isfinite(run.breaks["energy"][here])))
        self.assertTrue(np.all(np.diff(run.breaks.index) >= 0))
        when = self.output.times[2]
        cells = run.plot.fragments(time=when).collections[0]
        self.assertEqual(len(cells.get_paths()), len(self.output.at(when).names))


class Ensembles(FolderTest):
    def test_runs_and_table(self):
        (self.folder / "scene.yaml").write_text(SCENE)
        (self.folder / "e.yaml").write_text(
            "scene: scene.yaml\nseeds: 3\noptions: {time_end: 0.9}\n"
            "list: [{name: slow, boundary_back_velocity: 0.4 0 0}, {name: fast}]\n")
        subprocess.run([REPOSITORY / "tools/ensemble", "e.yaml", "--dir", "all", "--jobs", "1"],
                       cwd=self.folder, check=True, capture_output=True,
                       env={**ENVIRONMENT, "FLOE": str(FLOE)})
        run = floe.open(self.folder / "all")
        ensemble = run.ensemble
        with open(self.folder / "all/runs.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(ensemble), [row["run"] for row in rows])
        self.assertEqual(len(ensemble), 6)
        table = ensemble.table
        self.assertEqual(list(table.index), list(ensemble))
        for name in ("seed", "beams_broken", "peak_force_wall_x", "energy_kinetic"):
            np.testing.assert_array_equal(table[name], [float(row[name]) for row in rows], name)
        self.assertEqual(set(table["status"]), {"done"})
        some = list(ensemble)[4]
        self.assertEqual(ensemble[some].summary["energy"]["kinetic"],
                         table.loc[some, "energy_kinetic"])
        found = ensemble.loads(filter="none", component="x")
        self.assertEqual(len(found), 2)
        self.assertEqual({each["parameters"]["boundary_back_velocity"] for each in found},
                         {"0.4, 0, 0", "0.5, 0, 0"})
        for each in found:
            self.assertEqual(sorted(map(lambda f: ensemble[Path(f).name].loads(
                filter="none", component="x")["mean"], each["runs"])),
                sorted(each["means_of_runs"]))
        with self.assertRaisesRegex(floe.InputError, "its runs are of 2 scenes"):
            ensemble.plot.exceedance()
        with self.assertRaisesRegex(floe.InputError, "is the folder of an ensemble"):
            run.history
        with self.assertRaises(KeyError):
            ensemble["none"]
        # Any other folder of runs is one too.
        (self.folder / "some").mkdir()
        for row in rows[:3]:
            shutil.copytree(ensemble[row["run"]].folder, self.folder / "some" / row["run"])
        some = floe.open(self.folder / "some").ensemble
        self.assertEqual(list(some), sorted(row["run"] for row in rows[:3]))
        np.testing.assert_array_equal(some.table["energy_kinetic"],
                                      table.loc[list(some), "energy_kinetic"])
        axes = some.plot.exceedance(filter="mean:0.1")
        maxima = np.sort(some.loads(filter="mean:0.1")[0]["maxima"])
        drawn = axes.lines[0].get_xdata()
        np.testing.assert_allclose(drawn / drawn[-1], maxima / maxima[-1])


if __name__ == "__main__":
    unittest.main()
