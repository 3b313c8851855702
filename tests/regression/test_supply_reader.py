#!/usr/bin/python3
"""What the tools' reader makes of runs in which ice joins and leaves: the ice of each frame is that
of the whole sheet and of the account in history.csv; also of runs that were killed or went on.
"""
import shutil
import signal
import subprocess
import sys
import time
import unittest

import h5py
import numpy as np

from launch import ENDLESS, ENVIRONMENT, FLOE, REPOSITORY
from supply_runs import Account, SupplyTools, begin, run, tool

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402
from floe.report.page import data_in  # noqa: E402
from floe.results import breakage  # noqa: E402
from floe.results.output import Lattice, Output, Present, matrices  # noqa: E402
from floe.results.supply_lattice import lattice_of  # noqa: E402


class Frames(SupplyTools):
    def test_are_of_the_whole_sheet(self):
        """Bodies, beams, shapes and sides of a sheet that has the strips from the start."""
        for strips in (3, 4, 5):
            run(self.folder, "-sheet_length", str(12 * strips), "-obstacle_slope_point",
                f"{6 * strips + 0.02} 0 -0.4554", "-supply_region",
                f"-100, {6 * strips - 1}, -20, 20, -5, 20", "-time_end", "1e-3", "-output_dir",
                "whole")
            whole = Lattice(self.folder / "whole/lattice.h5")
            shift = np.array([6 * strips - 12, 0, 0])
            number = {tuple(pair): k for k, pair in enumerate(whole.beams["bodies"].tolist())}
            mesh = sorted(set(self.output.meshes))[strips - 2]
            ice = self.output.at(self.output.times[self.output.meshes == mesh][-1])
            self.assertEqual(ice.names[-1], len(whole.names) - 1)
            np.testing.assert_allclose(ice.position + shift, whole.position[ice.names], atol=1e-12)
            np.testing.assert_allclose(ice.mass, whole.mass[ice.names], rtol=1e-12)
            beams = [number[tuple(pair)] for pair in ice.names[ice.beams["bodies"]].tolist()]
            for name, values in ice.beams.items():
                if name != "bodies":
                    np.testing.assert_allclose(values, whole.beams[name][beams], atol=1e-10,
                                               err_msg=name)
            for name in ("left", "right", "bottom", "top"):
                np.testing.assert_array_equal(
                    ice.names[ice.sets[name]],
                    np.intersect1d(whole.sets[name], ice.names), name)
            self.assertGreater(len(ice.sets["left"]), 2)
            plans = whole.plans()
            for plan, name in zip(ice.plans(), ice.names):
                np.testing.assert_allclose(np.sort(plan + shift[:2], axis=0),
                                           np.sort(plans[name], axis=0), atol=1e-12)

    def test_are_of_the_account(self):
        """Number and mass of the bodies, breaks and pieces, by counts of their own."""
        for when in self.output.times:
            ice, wanted = self.output.at(when), self.account.at(when)
            self.assertEqual(len(ice.names), wanted["bodies"])
            self.assertAlmostEqual(ice.mass.sum() / wanted["mass"], 1, 12)
            found = breakage.at_frame(self.output, when)
            self.assertEqual(len(found["beam"]), wanted["beams_broken"])
            self.assertEqual(len(found["fragments/mass"]), wanted["fragments"])
            self.assertEqual(found["fragments/bodies"].sum(), len(ice.names))
            self.assertAlmostEqual(found["fragments/mass"].sum() / wanted["mass"], 1, 12)
            # pieces by a walk along whole beams
            whole = np.ones(len(ice.beams["bodies"]), bool)
            whole[found["beam"]] = False
            of_body = found["fragments/of_body"]
            self.assertTrue(np.all(np.diff(of_body[ice.beams["bodies"][whole]], axis=1) == 0))
            beside = {b: [] for b in range(len(ice.names))}
            for a, b in ice.beams["bodies"][whole].tolist():
                beside[a].append(b)
                beside[b].append(a)
            seen, todo = set(), [int(np.flatnonzero(of_body == 0)[0])]
            while todo:
                body = todo.pop()
                if body not in seen:
                    seen.add(body)
                    todo += beside[body]
            self.assertEqual(seen, set(np.flatnonzero(of_body == 0).tolist()))
            self.assertTrue(np.all(found["time"] <= when + 1e-9))

    def test_before_and_after_a_join(self):
        """Who stays keeps name, mass and form; a strip of 37 joins; the others left."""
        for k in np.flatnonzero(np.diff(self.output.meshes)):
            before, after = (self.output.at(when) for when in self.output.times[k:k + 2])
            joined = np.setdiff1d(after.names, before.names)
            gone = np.setdiff1d(before.names, after.names)
            a, b = (self.account.at(when) for when in self.output.times[k:k + 2])
            self.assertEqual(len(joined), b["bodies_supplied"] - a["bodies_supplied"])
            self.assertEqual(len(joined), len(self.output.names) / 2)
            self.assertGreater(joined.min(), before.names.max())
            self.assertEqual(len(gone), b["bodies_removed"] - a["bodies_removed"])
            both, i, j = np.intersect1d(before.names, after.names, return_indices=True)
            np.testing.assert_allclose(after.mass[j], before.mass[i], rtol=1e-12)
            np.testing.assert_allclose(after.position[j], before.position[i], atol=1e-12)
            self.assertAlmostEqual(before.mass[np.isin(before.names, gone)].sum()
                                   / (b["mass_removed"] - a["mass_removed"]), 1, 9)

    def test_times_of_breaks(self):
        """To the step of what breaks.h5 has, else of the first frame that has the break."""
        times = breakage.Times(self.output)
        end = breakage.at_end(self.output)
        with h5py.File(self.made / "breaks.h5") as file:
            np.testing.assert_array_equal(np.sort(end["beam"]), np.sort(file["beam"][:]))
            np.testing.assert_array_equal(end["time"], file["time"][:])
            np.testing.assert_array_equal(end["fragments/of_body"], file["fragments/of_body"][:])
            np.testing.assert_allclose(end["fragments/mass"], file["fragments/mass"][:])
        broken = set()
        for k, when in enumerate(self.output.times):
            names = self.output.beam_names(when)[self.output.field("damage", when) >= 1]
            found = times.of(names)
            for pair, moment in zip(map(tuple, names.tolist()), found):
                if pair not in broken:
                    self.assertTrue(self.output.times[max(k - 1, 0)] - 1e-9 < moment < when + 1e-9)
            broken |= set(map(tuple, names.tolist()))
        self.assertGreater(len(broken), len(end["beam"]) + 100)  # most have left


class Lattices(SupplyTools):
    def test_of_a_frame(self):
        """As lattice.h5 has the first bodies and their beams, and as a run takes it."""
        wanted = fl.read(self.made / "lattice.h5")
        names = np.arange(len(wanted.mass))
        arrays = {**vars(self.output), "beams": {
            name: self.output.beams[name] for name in (
                "bodies", "axis_y", "width", "height", "area", "inertia_y", "inertia_z", "length")}}
        turn = matrices(self.output.orientation)
        body = np.repeat(names, np.diff(self.output.shapes["vertex_of"]))
        arrays["shapes"] = {**self.output.shapes, "vertices": np.einsum(
            "vij,vj->vi", turn[body], self.output.shapes["vertices"])}
        arrays["orientation"] = np.tile([1.0, 0, 0, 0], (len(names), 1))
        found = lattice_of(Present(arrays), self.output.options())
        for name in ("position", "orientation", "mass", "inertia", "axis_y"):
            np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), rtol=1e-9,
                                       atol=1e-12, err_msg=name)
        for name in fl.BEAM_SCALARS:
            np.testing.assert_allclose(found.beam[name], wanted.beam[name], rtol=1e-9,
                                       err_msg=name)
        np.testing.assert_allclose(found.shapes.vertices, wanted.shapes.vertices, atol=1e-12)
        # the last frame, which has lain down, goes on as a scene's lattice
        file = self.folder / "settled.h5"
        tool("make_lattice", "settled", file, "--of", self.made)
        (self.folder / "next.yaml").write_text(
            "integrator: explicit\nforces: [beam, gravity, buoyancy]\n"
            f"lattice_file: {file}\ntime: {{end: 0.01, dt: 1e-4}}\n")
        done = subprocess.run([FLOE, "next.yaml", "-output_dir", "next"], cwd=self.folder,
                              capture_output=True, text=True, env=ENVIRONMENT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        end = self.account.at(5)
        with h5py.File(self.folder / "next/fields.h5") as fields, h5py.File(
                self.folder / "next/lattice.h5") as lattice:
            np.testing.assert_allclose(fields["t000000/points"],
                                       self.output.field("points", 5), atol=1e-9)
            self.assertAlmostEqual(np.sum(lattice["bodies/mass"]) / end["mass"], 1, 9)
            beams = len(self.output.at(5).beams["bodies"])
            self.assertEqual(len(lattice["beams/bodies"]), beams - end["beams_broken"])


class OtherRuns(SupplyTools):
    def same(self, output):
        """Frames of the run and of another up to its last, to the last bit."""
        for when in output.times:
            ice, own = output.at(when), self.output.at(when)
            np.testing.assert_array_equal(ice.names, own.names)
            np.testing.assert_array_equal(ice.mass, own.mass)
            found, wanted = (breakage.at_frame(o, when) for o in (output, self.output))
            np.testing.assert_array_equal(np.sort(found["beam"]), np.sort(wanted["beam"]))

    def test_killed(self):
        """Its last frame, whatever breaks.h5 has gone on to."""
        process = begin(self.folder, "-output_dir", "killed", *ENDLESS)
        folder = self.folder / "killed"
        while process.poll() is None and len(list(folder.glob("fields/mesh_*.h5"))) < 3:
            time.sleep(0.002)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        output, account = Output(folder), Account(folder)
        self.assertGreater(len(output.times), 3)
        last = account.at(output.times[-1])
        self.assertAlmostEqual(output.at(output.times[-1]).mass.sum() / last["mass"], 1, 12)
        self.assertEqual(len(breakage.at_end(output)["fragments/mass"]), last["fragments"])
        tool("report", folder)
        report = data_in((folder / "report.html").read_text())
        self.assertEqual(report["fragments"]["number"], last["fragments"])

    def test_gone_on(self):
        resume = []
        for steps in ("2900", "3600", "7000"):
            run(self.folder, "-output_dir", "on", "-ts_max_steps", steps, *resume)
            resume = ["-checkpoint_restart", "on/checkpoint.h5"]
            self.assertTrue(tool("plot_fragments", self.folder / "on", "--file",
                                 self.folder / "f.png"))
        run(self.folder, "-output_dir", "on", *resume)
        output = Output(self.folder / "on")
        self.assertLessEqual(set(self.output.times), set(output.times))
        for when in self.output.times:
            np.testing.assert_array_equal(output.at(when).names, self.output.at(when).names)
            np.testing.assert_array_equal(output.field("centres", when),
                                          self.output.field("centres", when))
        a, b = breakage.at_end(output), breakage.at_end(self.output)
        for name, values in a.items():
            np.testing.assert_array_equal(values, b[name], name)

    def test_frames_without_their_bodies(self):
        """Of a folder without the files of later bodies: one line."""
        lost = self.folder / "lost"
        shutil.copytree(self.made, lost)
        for path in lost.glob("fields/mesh_*.h5"):
            path.unlink()
        for path in lost.glob("fields/0*.h5"):
            with h5py.File(path, "a") as file:
                for group in file.values():
                    group.attrs.pop("mesh", None)
        said = tool("plot_sheet", lost, code=2)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("(supply)", said)
        spoilt = sorted(self.made.glob("fields/mesh_*.h5"))[-1]
        kept = spoilt.read_bytes()
        try:
            spoilt.write_bytes(kept[:1000])
            for words in (["report"], ["vtkhdf"], ["netcdf"], ["loads", "--fields"],
                          ["plot_fragments", "--time", "1"]):
                said = tool(words[0], self.made, *words[1:], code=2)
                self.assertEqual(said.count("\n"), 1, said)
                self.assertIn(spoilt.name, said)
        finally:
            spoilt.write_bytes(kept)

    def test_breaks_of_other_bodies_are_left_alone(self):
        """breaks.h5 of a moment that no mesh fits: breaks count from their frames."""
        path = self.made / "breaks.h5"
        kept = path.read_bytes()
        try:
            with h5py.File(path, "a") as file:
                file["bodies"][0] = [1, 0]
            times = breakage.Times(self.output)
            self.assertLessEqual(set(times.time), set(self.output.times))
        finally:
            path.write_bytes(kept)
        self.assertFalse(set(breakage.Times(self.output).time) <= set(self.output.times))


if __name__ == "__main__":
    unittest.main()
