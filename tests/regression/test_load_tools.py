#!/usr/bin/python3
"""floe loads, netcdf and vtkhdf on runs: what they write is what the runs wrote."""
import json
import subprocess
import unittest

import h5py
import numpy as np
import pandas
import xarray

from launch import REPOSITORY, FolderTest, run

# A sheet that is pushed against a slope, and breaks; a box that it never meets.
SCENE = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 12, width: 8, thickness: 0.5, element_size: 2, iterations: 5}
beam: {damping_ratio: 1}
fracture: {tensile_strength: 2e5, shear_strength: 2e5}
water: {drag_linear: 100}
contact: {young: 1e8}
obstacle:
  names: [wall, far]
  wall: {shape: halfspace, point: [6.4, 0, 0], normal: [-0.8, 0, 0.6]}
  far: {shape: box, centre: [0, 50, 0], size: [1, 1, 1]}
boundary: {names: [back], back: {set: left, fix: x, velocity: [0.5, 0, 0]}}
time: {end: 2}
output: {history: 0.02, fields: 0.5}
"""
ZERO = {f"{name}_{what}_{axis}": 0.0 for name in ("leg",) for axis in "xyz"
        for what in ("force", "moment", "peak_force", "mean_force")}


def column(values, name):
    return values[[f"{name}_{axis}" for axis in "xyz"]].to_numpy()


class LoadTools(FolderTest):
    def tool(self, name, *words):
        """The paths that a tool prints, and the rest of what it says."""
        done = subprocess.run([REPOSITORY / "tools" / name, *map(str, words)], cwd=self.folder,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("Warning", done.stderr)
        lines = done.stdout.splitlines()
        files = [line for line in lines if (self.folder / line).is_file()]
        return files, "\n".join(line for line in lines if line not in files) + done.stderr

    def made(self, name, force, status="done", speed="0.5", seed=1):
        """A run whose leg feels force(t) [N] (3) in every step of 1 ms for 20 s, with rows every
        0.05 s."""
        folder = self.folder / "made" / name
        folder.mkdir(parents=True)
        time = 0.001 * np.arange(1, 20001)
        forces = np.array([force(t) for t in time])
        mean = np.cumsum(forces, axis=0) / np.arange(1, 20001)[:, None]
        largest = forces[np.argmax(np.linalg.norm(forces, axis=1))]
        rows = [{"time": 0.0, **ZERO}]
        for k in range(49, 20000, 50):
            row = {"time": time[k], **ZERO}
            for i, axis in enumerate("xyz"):
                row |= {f"leg_force_{axis}": forces[k, i], f"leg_mean_force_{axis}": mean[k, i],
                        f"leg_peak_force_{axis}": largest[i]}
            rows.append(row)
        pandas.DataFrame(rows).to_csv(folder / "history.csv", index=False)
        (folder / "options.yaml").write_text(
            f"sheet:\n  seed: {seed}\nwater:\n  current: [{speed}, 0, 0]\noutput:\n  dir: {name}\n"
            "  history: 0.05\n")
        (folder / "summary.json").write_text(json.dumps({"status": status, "version": "9.9"}))

    def test_statements(self):
        """Runs with known forces: components, means, maxima, groups, runs that failed."""
        for seed in (1, 2, 3):
            for speed in ("0.1", "0.5"):
                size = seed * (10 if speed == "0.5" else 1)
                # 3 and -4 on a second's pulse every 5 s; a spike of one step, which no filter keeps
                self.made(f"{speed}_{seed}", lambda t, size=size: size * np.array(
                    [3.0, -4.0, 1.0]) * (1000 if t % 5 < 1 else 0) + (
                        np.array([1e7, 0, 0]) if abs(t - 7.5) < 2e-4 else 0), speed=speed,
                    seed=seed)
        self.made("failed", lambda t: np.zeros(3), status="failed")
        files, said = self.tool("loads", "made", "--block", "5", "--filter", "mean:0.5", "--hours",
                                "100")
        self.assertEqual(files, ["made/loads.json", "made/loads.csv"])
        self.assertIn("left out: made/failed: its status is failed", said)
        found = json.loads((self.folder / "made/loads.json").read_text())
        self.assertEqual([each["parameters"] for each in found],
                         [{"water_current": "0.1, 0, 0"}, {"water_current": "0.5, 0, 0"}])
        slow, fast = found
        self.assertEqual(len(fast["runs"]), 3)
        for each, pulse in ((fast, 1e5), (slow, 1e4)):  # a fifth of the time; the spike's impulse
            self.assertAlmostEqual(each["mean"] / (pulse / 5 + 1e7 * 0.001 / 20), 1, delta=0.02)
        maxima = np.reshape(fast["maxima"], (3, 4))
        np.testing.assert_allclose(maxima[:, 0], [5e4, 1e5, 1.5e5], rtol=1e-6)
        self.assertAlmostEqual(fast["largest_of_a_step"] / 1e7, 1, 2)
        self.assertAlmostEqual(fast["peaks"]["mean_spacing"], 5, delta=2.6)
        rows = fast["gumbel"]["levels"]
        self.assertAlmostEqual(1 - (1 - rows[3]["probability"])**(100 * 3600 / 5), 0.01, 9)
        for row in rows:
            for method in ("moments", "likelihood"):
                value, low, high = row[method]
                self.assertTrue(low < value < high)
        table = pandas.read_csv(self.folder / "made/loads.csv")
        self.assertEqual(len(table), 6)
        self.assertEqual(sorted(set(table["seed"])), [1, 2, 3])
        self.tool("loads", "made/0.5_1", "--component", "y", "--filter", "none")
        (along,) = json.loads((self.folder / "made/0.5_1/loads.json").read_text())
        self.assertAlmostEqual(along["maxima"][0] / 4e4, 1, 6)  # positive where its mean is

    def test_rows_by_themselves(self):
        """Statics have a row per load step, dynamics without `output: history` 200, or one per
        step."""
        for name, words in (("statics", ["-time_dt", "0.5"]),
                            ("steps", ["-integrator", "explicit", "-time_end", "0.01"]),
                            ("dynamics", ["-integrator", "explicit", "-time_end", "0.4"])):
            done = run(REPOSITORY / "input/tension.yaml", "-sheet_length", "12", "-sheet_width",
                       "10", *words, "-output_dir", name, cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.tool("netcdf", name)
            with xarray.open_dataset(self.folder / name / "run.nc") as data:
                late = (data["sample_time"][0] - data["time"]).values
                self.assertTrue(np.all(np.diff(data["time"]) > 0))
                due = data["time"].values
            self.assertTrue(np.all((late >= -1e-12) & (late < 0.001)))
            if name == "dynamics":
                np.testing.assert_allclose(due, 0.002 * np.arange(201), atol=1e-12)
            else:
                np.testing.assert_array_equal(late, 0)

    def test_runs_of_several_scenes(self):
        """Runs that lack what others have, and end earlier, are one file all the same."""
        self.made("a/r", lambda t: np.array([1.0, 0, 0]), speed="0.1")
        self.made("b/r", lambda t: np.array([2.0, 0, 0]))
        rows = pandas.read_csv(self.folder / "made/b/r/history.csv")
        rows.iloc[:100].assign(energy_drag=3.0).to_csv(self.folder / "made/b/r/history.csv",
                                                      index=False)
        with h5py.File(self.folder / "made/b/r/breaks.h5", "w") as file:
            file["fragments/mass"], file["fragments/bodies"] = [5.0, 7.0], [1, 2]
        files, _ = self.tool("netcdf", "made")
        paths = [self.folder / file for file in files]
        with xarray.open_dataset(paths[2]) as ensemble, xarray.open_mfdataset(
                paths[:2], combine="nested", concat_dim="run") as joined:
            xarray.testing.assert_equal(joined.load(), ensemble.load())
            self.assertEqual(list(ensemble["run"].values), ["a/r", "b/r"])
            self.assertEqual(ensemble.sizes["time"], 401)
            self.assertEqual(ensemble["option_water_current"].values.tolist(),
                             ["0.1, 0, 0", "0.5, 0, 0"])
            a, b = (ensemble.sel(run=name) for name in ensemble["run"].values)
            self.assertTrue(np.all(np.isnan(a["energy_drag"])))
            np.testing.assert_array_equal(b["fragment_mass"], [7, 5])
            np.testing.assert_array_equal(np.isnan(b["energy_drag"]), np.arange(401) >= 100)
            last = a["obstacle_impulse"].sel(obstacle="leg", axis="x")[-1]
            self.assertAlmostEqual(float(last), 20)

    def test_runs_of_floe(self):
        for seed in (1, 2):
            (self.folder / "s.yaml").write_text(SCENE)
            done = run("s.yaml", "-sheet_seed", seed, "-output_dir", f"out/r{seed}",
                       cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
        files, said = self.tool("loads", "out", "--fields", "--figure", "--filter", "low-pass:5")
        self.assertEqual(files[2:], ["out/loads_wall.png", "out/ice_wall.png"])
        self.assertIn("far: no ice touched it", said)
        self.loads_are_of_the_runs()
        self.netcdf_is_of_the_runs()
        self.vtkhdf_is_of_the_run()

    def loads_are_of_the_runs(self):
        (found,) = json.loads((self.folder / "out/loads.json").read_text())
        for k in (0, 1):
            summary = json.loads((self.folder / f"out/r{k + 1}/summary.json").read_text())
            history = pandas.read_csv(self.folder / f"out/r{k + 1}/history.csv")
            self.assertGreaterEqual(found["largest_of_a_step"],
                                    np.linalg.norm(summary["peak_force"]["wall"]) * (1 - 1e-9))
            mean = column(history, "wall_mean_force")[-1]
            # the mean of the norm is at least the norm of the mean; ice only pushes along x
            self.assertGreaterEqual(found["means_of_runs"][k] * 1.02, np.hypot(*mean[:2]))
            self.assertLess(found["means_of_runs"][k], 1.2 * np.hypot(*mean[:2]))
        profile = found["ice"]["profile"]
        far = np.array(profile["distance"]) > 6  # of a level sheet: h, freeboard, no pores
        self.assertAlmostEqual(np.array(profile["top"])[far][-1], 0.5 * (1 - 920 / 1025),
                               delta=0.08)
        self.assertTrue(np.all(np.array(profile["porosity"]) < 0.9))
        self.assertGreater(len(found["ice"]["pressure_area"]["area"]), 0)

    def netcdf_is_of_the_runs(self):
        files, _ = self.tool("netcdf", "out")
        self.assertEqual(files, ["out/r1/run.nc", "out/r2/run.nc", "out/ensemble.nc"])
        paths = [self.folder / file for file in files]
        with xarray.open_mfdataset(paths[:2], combine="nested", concat_dim="run") as joined:
            joined.load()
        with xarray.open_dataset(paths[2]) as ensemble:
            ensemble.load()
        xarray.testing.assert_equal(joined, ensemble)
        self.assertEqual(joined.sizes["run"], 2)
        self.assertEqual(joined.sizes["time"], 101)
        self.assertEqual(list(joined["obstacle"].values), ["wall", "far"])
        self.assertEqual(joined.attrs["Conventions"], "CF-1.8")
        self.assertEqual(ensemble.attrs["scene"],
                         (self.folder / "out/r1/options.yaml").read_text())
        for name, data in joined.variables.items():
            self.assertIn("long_name", data.attrs, name)
            if data.dtype.kind in "fi":
                self.assertIn("units", data.attrs, name)
            self.assertRegex(name, r"^[A-Za-z]\w*$")
        for seed in (1, 2):
            history = pandas.read_csv(self.folder / f"out/r{seed}/history.csv",
                                      float_precision="round_trip")
            one = joined.sel(run=f"r{seed}", obstacle="wall")
            np.testing.assert_array_equal(one["obstacle_force"], column(history, "wall_force"))
            np.testing.assert_array_equal(one["sample_time"], history["time"])
            np.testing.assert_array_equal(one["energy_kinetic"], history["energy_kinetic"])
            np.testing.assert_allclose(
                one["obstacle_impulse"][-1],
                column(history, "wall_mean_force")[-1] * history["time"].iloc[-1])
            with h5py.File(self.folder / f"out/r{seed}/breaks.h5") as file:
                mass = np.sort(file["fragments/mass"][:])[::-1]
            got = one["fragment_mass"].values
            np.testing.assert_array_equal(got[~np.isnan(got)], mass)
            self.assertIn(f"seed: {seed}", str(one["scene"].values))

    def vtkhdf_is_of_the_run(self):
        """The structure that VTK's reader asks for; test_paraview reads it with ParaView."""
        files, _ = self.tool("vtkhdf", "out/r1")
        self.assertEqual(files, ["out/r1/bodies.vtkhdf", "out/r1/cracks.vtkhdf"])
        with h5py.File(self.folder / files[0]) as file, h5py.File(
                self.folder / "out/r1/fields.h5") as fields, h5py.File(
                    self.folder / "out/r1/lattice.h5") as lattice:
            root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
            self.assertEqual(root.attrs["Type"], b"PolyData")
            self.assertEqual(root.attrs["Version"][0], 2)
            frames = sorted((group for group in fields.values() if "time" in group.attrs),
                            key=lambda group: group.attrs["time"])
            self.assertEqual(steps.attrs["NSteps"], len(frames))
            cells = int(root["Polygons/NumberOfCells"][0])
            self.assertEqual(cells, len(lattice["shapes/corner_of"]) - 1)
            np.testing.assert_array_equal(root["Polygons/Connectivity"],
                                          lattice["shapes/corners"])
            for k, frame in enumerate(frames):
                self.assertEqual(steps["Values"][k], frame.attrs["time"])
                first = steps["PointOffsets"][k]
                np.testing.assert_allclose(
                    root["Points"][first:first + root["NumberOfPoints"][0]], frame["points"],
                    rtol=1e-6, atol=1e-6)
                first = steps["CellDataOffsets/displacement"][k]
                np.testing.assert_allclose(root["CellData/displacement"][first:first + cells],
                                           frame["face_displacement"], rtol=1e-6)
            self.assertEqual(steps["CellOffsets"].shape, (len(frames), 4))
            self.assertFalse(np.any(steps["CellDataOffsets/body"]))
        with h5py.File(self.folder / files[1]) as file:
            root, steps, number = file["VTKHDF"], file["VTKHDF/Steps"], []
            cells = int(root["Polygons/NumberOfCells"][0])
            for k, frame in enumerate(frames_of(self.folder / "out/r1/fields.h5")):
                first = steps["CellDataOffsets/open"][k]
                is_open = root["CellData/open"][first:first + cells] == 1
                number.append(is_open.sum())
                points = root["Points"][4 * first:4 * (first + cells)].reshape(cells, 4, 3)
                spread = np.ptp(points, axis=1).max(axis=1)
                np.testing.assert_array_equal(spread > 1e-6, is_open)
                self.assertEqual(number[-1], len(frame))
                if len(frame):
                    np.testing.assert_array_equal(np.sort(root["CellData/beam"][:][is_open]),
                                                  np.sort(frame))
            self.assertEqual(number[0], 0)
            self.assertEqual(number[-1], cells)


def frames_of(path):
    """Beams of the cracks in each frame."""
    with h5py.File(path) as file:
        groups = sorted((group for group in file.values() if "time" in group.attrs),
                        key=lambda group: group.attrs["time"])
        return [group["crack_beam"][:] if "crack_beam" in group else np.zeros(0, int)
                for group in groups]


if __name__ == "__main__":
    unittest.main()
