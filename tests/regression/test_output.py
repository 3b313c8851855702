#!/usr/bin/python3
"""What a run leaves in its folder: summary.json, history.csv, lattice.h5, options.yaml, fields.h5 +
fields.xmf + fields/.

Small scenes run in a temporary folder. Numbers are compared with each other, never with a stored
result.
"""
import csv
import json
import re
import unittest

import h5py
import numpy as np

import launch

HELD_AND_PULLED = """boundary:
  names: [left, right]
  left: {set: left, fix: x}
  right: {set: right, fix: x, displacement: [0.01, 0, 0], ramp: 1}
"""
TENSION = """forces: [beam]
sheet: {length: 10, thickness: 1, element_size: 2, iterations: 20}
""" + HELD_AND_PULLED + "report: [tension]\n"
BENDING = """forces: [beam, gravity, buoyancy]
sheet: {length: 20, thickness: 0.5, element_size: 2, iterations: 20}
load: {names: [centre], centre: {point: [1, 2], force: [0, 0, -1e4], ramp: 1}}
report: [bending]
"""
CANTILEVER = """forces: [beam]
sheet: {length: 10, width: 4, thickness: 0.5, element_size: 2, iterations: 20}
boundary: {names: [root], root: {set: left, fix: x y z rx ry rz}}
load: {names: [tip], tip: {set: right, force: [0, 0, 1e6], ramp: 1}}
time: {end: 1, dt: 0.25}
"""
ALWAYS = {"status", "message", "bodies", "beams", "ranks", "integrator", "steps", "dt", "wall_s",
          "mesh_s", "solve_s",
          "newton_iterations", "energy", "peak_memory_mb", "version"}
OF_A_SHEET = {"seed", "cvt_energy_ratio"}


def rotate(rotation_vectors, v):
    """Rodrigues' formula, row by row."""
    angle = np.linalg.norm(rotation_vectors, axis=1, keepdims=True)
    axis = rotation_vectors / np.where(angle > 0, angle, 1)
    along = axis * np.sum(axis * v, axis=1, keepdims=True)
    return along + np.cos(angle) * (v - along) + np.sin(angle) * np.cross(axis, v)


def by_quaternions(q, v):
    """v turned by unit quaternions (w x y z), row by row."""
    w, r = q[:, :1], q[:, 1:]
    return v + 2 * np.cross(r, np.cross(r, v) + w * v)


class OutputTest(launch.FolderTest):
    def start(self, scene, *options, ranks=1, name="scene"):
        """Runs a scene text; the finished process."""
        path = self.folder / (name + ".yaml")
        path.write_text(scene)
        return self.start_file(path, *options, ranks=ranks)

    def start_file(self, path, *options, ranks=1):
        return launch.run(path, *options, ranks=ranks, cwd=self.folder)

    def run_scene(self, scene, *options, **how):
        """Runs a scene text that must work; its output folder."""
        run = self.start(scene, *options, **how)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return self.folder / "out" / how.get("name", "scene")

    def summary(self, folder):
        return json.loads((folder / "summary.json").read_text())

    def history(self, folder):
        """Rows of history.csv as {column: number}."""
        with open(folder / "history.csv", newline="") as file:
            return [{key: float(value) for key, value in row.items()}
                    for row in csv.DictReader(file)]

    def frames(self, folder):
        """Groups of fields.h5 in order of their time: [(time, {dataset: array})]."""
        with h5py.File(folder / "fields.h5") as file:
            groups = [(float(g.attrs["time"]), {k: d[:] for k, d in g.items()})
                      for name, g in file.items() if name != "mesh"]
        return sorted(groups, key=lambda group: group[0])


class Summary(OutputTest):
    def test_tension(self):
        s = self.summary(self.run_scene(TENSION))
        self.assertEqual(s["status"], "done")
        self.assertLessEqual(ALWAYS | OF_A_SHEET | {"E", "E_over_Eb", "E_star", "E_over_Estar"},
                             set(s))
        self.assertAlmostEqual(s["E"] / s["E_over_Eb"], 4e9, 3)
        self.assertAlmostEqual(s["E"] / s["E_over_Estar"] / s["E_star"], 1, 12)
        self.assertNotIn("deflection_max", s)
        # The work of pulling is stored: F u / 2.
        row = self.history(self.folder / "out/scene")[-1]
        self.assertAlmostEqual(s["energy"]["strain"] / (row["right_force_x"] * 0.01 / 2), 1, 3)

    def test_bending(self):
        s = self.summary(self.run_scene(BENDING))
        self.assertLessEqual(ALWAYS | OF_A_SHEET
                             | {"deflection_max", "wyman", "deflection_over_wyman"}, set(s))
        self.assertAlmostEqual(s["deflection_max"] / s["wyman"], s["deflection_over_wyman"], 12)
        self.assertGreater(s["deflection_over_wyman"], 1)
        self.assertLessEqual({"strain", "gravity", "water"}, set(s["energy"]))

    def test_deflection_is_over_that_of_the_load_at_the_end(self):
        whole, half = (self.summary(self.run_scene(BENDING, *options))
                       for options in ((), ("-time_end", "0.5")))
        self.assertAlmostEqual(half["wyman"], whole["wyman"] / 2, 15)
        self.assertAlmostEqual(half["deflection_over_wyman"], whole["deflection_over_wyman"], 3)

    def test_stages_are_timed(self):
        s = self.summary(self.run_scene(TENSION))
        for key in ("mesh_s", "lattice_s", "partition_s", "forces_s", "tangent_s", "solve_s",
                    "output_s"):
            self.assertGreater(s[key], 0, key)
            self.assertLess(s[key], s["wall_s"], key)


class History(OutputTest):
    def test_columns_and_every_step(self):
        rows = self.history(self.run_scene(TENSION, "-time_dt", "0.25"))
        self.assertEqual([row["time"] for row in rows], [0, 0.25, 0.5, 0.75, 1])
        expected = {"time", "energy_strain"} | {f"{name}_{what}_{axis}"
                                                for name in ("left", "right")
                                                for what in ("force", "moment", "displacement")
                                                for axis in "xyz"}
        self.assertEqual(set(rows[0]), expected)
        for row in rows:
            self.assertAlmostEqual(row["right_displacement_x"], 0.01 * row["time"], 12)
            self.assertAlmostEqual(row["left_force_x"] + row["right_force_x"], 0, delta=1e-3)
            self.assertEqual(row["left_force_y"], 0)  # not prescribed: no reaction
        self.assertGreater(rows[-1]["right_force_x"], 0)

    def test_loads_have_columns(self):
        rows = self.history(self.run_scene(CANTILEVER))
        self.assertGreater(rows[-1]["tip_load_displacement_z"], 0)
        self.assertAlmostEqual(rows[-1]["root_force_z"] / -1e6, 1, 9)
        self.assertAlmostEqual(rows[2]["root_force_z"] / -5e5, 1, 9)

    def test_sampling_keeps_the_last_state(self):
        rows = self.history(self.run_scene(TENSION, "-time_dt", "0.1", "-output_history", "0.4"))
        self.assertEqual([row["time"] for row in rows], [0, 0.4, 0.8, 1])
        rows = self.history(self.run_scene(TENSION, "-time_dt", "0.1", "-output_history", "0.5"))
        self.assertEqual([row["time"] for row in rows], [0, 0.5, 1])
        rows = self.history(self.run_scene(TENSION, "-time_dt", "0.25", "-output_history", "7"))
        self.assertEqual([row["time"] for row in rows], [0, 1])


class InThePlane(OutputTest):
    """A planar run leaves what a spatial one leaves: the same files, columns, datasets and keys,
    the same numbers."""
    MOVING = """integrator: explicit
forces: [beam, drag]
water: {drag_linear: 1e4, current: [0.1, 0.2, 0]}
sheet: {length: 10, thickness: 1, element_size: 2, iterations: 20}
beam: {damping_ratio: 0.1}
""" + HELD_AND_PULLED.replace("displacement: [0.01, 0, 0]",
                              "velocity: [0.1, 0, 0]") + """load:
  names: [p]
  p: {point: [1, 2], force: [1e5, 2e5, 0], moment: [0, 0, 1e5]}
time: {end: 0.1, dt: 1e-4}
output: {history: 0.01, fields: 0.02}
"""

    def compare(self, scene, tolerance, *options, ranks=1):
        planar = self.run_scene(scene, "-model_planar", "true", *options, name="planar",
                                ranks=ranks)
        spatial = self.run_scene(scene, "-model_planar", "false", *options, name="spatial",
                                 ranks=ranks)
        self.assertEqual({p.name for p in planar.iterdir()}, {p.name for p in spatial.iterdir()})
        rows, others = self.history(planar), self.history(spatial)
        self.assertEqual([list(row) for row in rows], [list(row) for row in others])
        for kind in ("force", "moment", "displacement", "energy"):
            of_kind = [key for key in rows[0] if kind in key]
            scale = max([abs(row[key]) for row in others for key in of_kind], default=0)
            for key in of_kind:
                np.testing.assert_allclose([row[key] for row in rows], [row[key] for row in others],
                                           rtol=0,
                                           atol=tolerance * scale, err_msg=key)
        frames, others = self.frames(planar), self.frames(spatial)
        self.assertEqual([time for time, _ in frames], [time for time, _ in others])
        for (_, frame), (_, other) in zip(frames, others):
            self.assertEqual(set(frame), set(other))
            for key, values in frame.items():
                self.assertEqual(values.shape, other[key].shape, key)
                self.assertEqual(values.dtype, other[key].dtype, key)
                # faces are in single precision
                rounding = np.finfo(values.dtype).eps if values.dtype.kind == "f" else 0
                np.testing.assert_allclose(values, other[key], rtol=0, err_msg=key,
                                           atol=max(tolerance,
                                                    rounding) * np.abs(other[key]).max(initial=0))
        summaries = [self.summary(folder) for folder in (planar, spatial)]
        self.assertEqual(*(set(s) for s in summaries))
        self.assertEqual(*(set(s["energy"]) for s in summaries))
        self.assertTrue(summaries[0]["model"].startswith("planar, co-rotational, "))
        self.assertTrue(summaries[1]["model"].startswith("spatial, co-rotational, "))
        self.assertEqual((planar / "fields.xmf").read_text(), (spatial / "fields.xmf").read_text())
        return summaries

    def test_statics(self):
        for ranks in (1, 2):
            planar, spatial = self.compare(TENSION, 1e-9, "-time_dt", "0.25", ranks=ranks)
            self.assertAlmostEqual(planar["E"] / spatial["E"], 1, delta=1e-12)
            self.assertEqual(planar["stable"], spatial["stable"])

    def test_dynamics(self):
        for ranks in (1, 2):
            planar, spatial = self.compare(self.MOVING, 1e-9, ranks=ranks)
            self.assertEqual(planar["steps"], spatial["steps"])

    def test_by_itself(self):
        """And one line says so at the start."""
        run = self.start(TENSION)
        self.assertEqual(run.stdout.splitlines()[0],
                         "model: planar, co-rotational, no water, unbreakable, no contact")
        run = self.start(TENSION, "-model_planar", "false")
        self.assertEqual(run.stdout.splitlines()[0],
                         "model: spatial, co-rotational, no water, unbreakable, no contact (model: "
                         "planar: false)")
        run = self.start(BENDING)
        self.assertEqual(run.stdout.splitlines()[0],
                         "model: spatial, co-rotational, unbreakable, no contact (forces: "
                         "buoyancy acts along z)")


class Available(OutputTest):
    """What is named and never happens changes nothing: an intact sheet with contact or fracture is
    one without."""

    def test_intact_sheets(self):
        frames = {}
        for name, forces, *words in (("plain", "beam,drag"),
                                     ("touch", "beam,drag,contact", "-contact_young", "1e9"),
                                     ("break", "beam,drag,fracture", "-fracture_tensile_strength",
                                      "1e12",
                                      "-fracture_shear_strength", "1e12", "-fracture_energy",
                                      "15")):
            # rotations come from unit quaternions: large enough for their rounding, 1e-16
            folder = self.run_scene(InThePlane.MOVING, "-model_planar", "false", "-forces", forces,
                                    "-load_p_moment", "0,0,1e7", *words, name=name)
            frames[name] = self.frames(folder)[-1][1]
        for name in ("touch", "break"):
            for key in ("bodies_displacement", "bodies_rotation", "beams_force", "beams_moment"):
                plain = frames["plain"][key]
                np.testing.assert_allclose(frames[name][key], plain, rtol=0,
                                           atol=1e-11 * np.abs(plain).max(),
                                           err_msg=name + " " + key)


class Repeats(OutputTest):
    def test_lattice_file_gives_the_same_result(self):
        first = self.run_scene(TENSION, name="sheet")
        scene = f"forces: [beam]\nlattice_file: {first}/lattice.h5\n" + HELD_AND_PULLED
        second = self.run_scene(scene, name="file")
        self.assertEqual(self.history(first)[-1], self.history(second)[-1])
        with h5py.File(first / "lattice.h5") as a, h5py.File(second / "lattice.h5") as b:
            names = []
            a.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset)
                         else None)
            for name in names:
                np.testing.assert_array_equal(a[name][:], b[name][:], err_msg=name)
        self.assertLessEqual({"bodies/position", "beams/bodies", "beams/width", "sets/left",
                              "shapes/vertices"}, set(names))
        self.assertNotIn("seed", self.summary(second))

    def test_options_yaml_repeats_the_run(self):
        first = self.run_scene(TENSION, "-ice_young", "3.3e9", "-beam_shear", "exact",
                               "-sheet_seed", "7", name="a")
        young = self.summary(first)["E"]
        options = (first / "options.yaml").read_text()
        again = self.start_file(first / "options.yaml", "-output_dir", "again")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(self.summary(self.folder / "again")["E"], young)
        second = (self.folder / "again/options.yaml").read_text()
        self.assertEqual(second.replace("dir: again", "dir: out/a"), options)

    def test_second_run_leaves_nothing_of_the_first(self):
        folder = self.run_scene(CANTILEVER, "-output_fields", "0.25")
        self.assertEqual(len(self.frames(folder)), 5)
        self.run_scene(TENSION)
        self.assertEqual(len(self.frames(folder)), 2)
        self.assertIn("left_force_x", self.history(folder)[0])
        self.assertEqual((folder / "fields.xmf").read_text().count("<Time "), 2)
        self.assertEqual(sorted(f.name for f in folder.iterdir()),
                         [".lock", "fields", "fields.h5", "fields.xmf", "floe.log", "history.csv",
                          "lattice.h5",
                          "options.yaml", "summary.json"])


class Fields(OutputTest):
    def test_sampling(self):
        folder = self.run_scene(CANTILEVER)
        self.assertEqual([time for time, _ in self.frames(folder)], [0, 1])
        self.run_scene(CANTILEVER, "-output_fields", "0.5")
        self.assertEqual([time for time, _ in self.frames(folder)], [0, 0.5, 1])
        self.run_scene(CANTILEVER, "-output_fields", "0.75")
        self.assertEqual([time for time, _ in self.frames(folder)], [0, 0.75, 1])

    def test_xmf_names_what_is_there_with_its_size(self):
        folder = self.run_scene(CANTILEVER, "-output_fields", "0.5")
        text = (folder / "fields.xmf").read_text()
        self.assertEqual([float(t) for t in re.findall(r'<Time Value="([^"]*)"', text)],
                         [0, 0.5, 1])
        items = re.findall(r'Dimensions="([\d ]+)">([^<]+\.h5):([^<]+)<', text)
        self.assertGreater(len(items), 30)
        for dimensions, path, name in items:
            with h5py.File(folder / path) as file:
                self.assertEqual(file[name].shape, tuple(int(d) for d in dimensions.split()), name)

    def test_bodies_move_as_prescribed_and_vertices_with_them(self):
        scene = CANTILEVER.replace("fix: x y z rx ry rz",
                                   "fix: x y z rx ry rz, displacement: [0.1, 0.2, 0.3], "
                                   "angular_velocity: [0, 0, 0.5], ramp: 1")
        folder = self.run_scene(scene)
        with h5py.File(folder / "lattice.h5") as lattice:
            position, turn = lattice["bodies/position"][:], lattice["bodies/orientation"][:]
            vertices, of = lattice["shapes/vertices"][:], np.diff(lattice["shapes/vertex_of"][:])
            root, pairs, length = lattice["sets/left"][:], lattice["beams/bodies"][:], lattice[
                "beams/length"][:]
            area, young = lattice["beams/area"][:], lattice["beams/young"][:]
        for time, f in self.frames(folder):
            u, r = f["bodies_displacement"], f["bodies_rotation"]
            np.testing.assert_allclose(u[root],
                                       np.tile([0.1 * time, 0.2 * time, 0.3 * time],
                                               (len(root), 1)), atol=1e-14)
            np.testing.assert_allclose(r[root], np.tile([0, 0, 0.25 * time], (len(root), 1)),
                                       atol=1e-14)
            np.testing.assert_array_equal(f["centres"], position + u)
            body = np.repeat(np.arange(len(of)), of)
            placed = f["centres"][body] + rotate(r[body], by_quaternions(turn[body], vertices))
            np.testing.assert_allclose(f["points"], placed, atol=1e-13)
            chord = np.linalg.norm(np.diff(f["centres"][pairs], axis=1)[:, 0], axis=1)
            normal = young * area * (chord - length) / length
            np.testing.assert_allclose(f["beams_force"][:, 0], normal, atol=1e-13 * 4e9)

    def test_ranks_give_the_same(self):
        for scene in (CANTILEVER, BENDING):
            one = self.run_scene(scene, name="one")
            two = self.run_scene(scene, ranks=2, name="two")
            self.assertEqual(self.summary(two)["ranks"], 2)
            for (time, a), (same_time, b) in zip(self.frames(one), self.frames(two), strict=True):
                self.assertEqual(time, same_time)
                for name, values in a.items():
                    # A million newtons on a sheet: rounding of forces is that of its beams, E A of
                    # 1e10 N.
                    scale = max(np.abs(values).max(), 1e5 if "force" in name or "moment" in name
                                or "stress" in name else 1e-3)
                    np.testing.assert_allclose(b[name], values, rtol=0, atol=1e-9 * scale,
                                               err_msg=name)
            np.testing.assert_array_equal(*(h5py.File(f / "lattice.h5")["beams/bodies"][:]
                                            for f in (one, two)))


class Failure(OutputTest):
    def expect_failure(self, *words, scene, options=(), ranks=1):
        run = self.start(scene, *options, ranks=ranks)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        lines = run.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, run.stderr)
        s = self.summary(self.folder / "out/scene")
        self.assertEqual(s["status"], "failed")
        self.assertEqual(lines[0], "floe: " + s["message"])
        for word in words:
            self.assertIn(word, s["message"])
        return self.folder / "out/scene"

    def test_newton_without_iterations(self):
        for ranks in (1, 2):
            folder = self.expect_failure("no equilibrium beyond time 0", "MAX_IT", scene=CANTILEVER,
                                         options=["-snes_max_it", "1"], ranks=ranks)
            self.assertEqual([time for time, _ in self.frames(folder)], [0])

    def test_overloaded_sheet_sinks_and_keeps_its_last_good_state(self):
        """20 x 20 x 0.5 m of ice carry 177 kN; 300 kN are too much, wherever it is held."""
        heavy = BENDING.replace("-1e4", "-3e5").replace("[1, 2]", "[0, 0]")
        for scene in (heavy, heavy + "boundary: {names: [a], a: {set: all, fix: x y rz}}\n"):
            folder = self.expect_failure("no equilibrium beyond time", scene=scene,
                                         options=["-time_dt", "0.25"])
            rows, frames = self.history(folder), self.frames(folder)
            self.assertAlmostEqual(rows[-1]["time"], frames[-1][0], 11)
            self.assertGreaterEqual(rows[-1]["time"], 0.5)
            self.assertLess(rows[-1]["time"], 0.6)
            self.assertLess(np.abs(frames[-1][1]["bodies_displacement"]).max(), 2)
            self.assertNotIn("deflection_max", self.summary(folder))

    def test_loads_that_balance_at_the_end_only(self):
        scene = TENSION[:TENSION.index("boundary:")] + "load:\n  names: [a, b]\n"
        scene += "  a: {set: all, force: [1e5, 0, 0]}\n"
        scene += "  b: {set: all, force: [-1e5, 0, 0], ramp: 1}\n"
        # no tolerance is to blame
        for options in ([], ["-snes_rtol", "1e-3"], ["-snes_atol", "1e4"]):
            folder = self.expect_failure("time 0", "nothing holds", scene=scene, options=options)
            self.assertEqual(self.frames(folder), [])

    def test_a_tolerance_that_leaves_forces_out_of_balance_is_named(self):
        for options, said in ((["-snes_rtol", "1e-3"], "-snes_rtol 0.001"),
                              (["-snes_atol", "1e5"], "-snes_atol 100000")):
            self.expect_failure("Newton's method stopped where", said, "at most 1e-06 may be",
                                scene=TENSION,
                                options=options)
        self.run_scene(TENSION, "-snes_rtol", "1e-7")

    def test_no_equilibrium_at_the_start(self):
        folder = self.expect_failure("no equilibrium at time 0", "MAX_IT",
                                     scene=CANTILEVER.replace(", ramp: 1", ""),
                                     options=["-snes_max_it", "1"])
        self.assertEqual(self.frames(folder), [])
        self.assertEqual((folder / "history.csv").read_text(), "")


class Stability(OutputTest):
    PRESSED = """forces: [beam]
sheet: {length: 20, width: 4, thickness: 0.2, element_size: 2, iterations: 20}
boundary:
  names: [left, right]
  left: {set: left, fix: x z}
  right: {set: right, fix: x z, displacement: [-1, 0, 0], ramp: 1}
"""  # pinned at both ends: it buckles at a displacement of about pi^2 h^2/(12 L) = 1.6 mm

    def test_below_and_beyond_the_buckling_load(self):
        for ranks in (1, 2):
            for displacement, stable in (("-0.0005,0,0", True), ("-0.005,0,0", False)):
                with self.subTest(ranks=ranks, displacement=displacement):
                    run = self.start(self.PRESSED, "-boundary_right_displacement", displacement,
                                     ranks=ranks)
                    self.assertEqual(run.returncode, 0, run.stderr)
                    self.assertEqual(self.summary(self.folder / "out/scene")["stable"], stable)
                    self.assertEqual("unstable" in run.stderr, not stable, run.stderr)


class Unloaded(OutputTest):
    def test_without_the_force_of_beams_bodies_are_loose(self):
        scene = "forces: [gravity, buoyancy]\nsheet: {length: 10, element_size: 2}\n"
        for ranks in (1, 2):
            out = self.run_scene(scene, ranks=ranks)
            self.assertEqual(self.summary(out)["beams"], 0)
            self.assertLess(np.abs(self.frames(out)[-1][1]["bodies_displacement"]).max(), 1e-9)

    def test_full_turns_leave_no_forces(self):
        scene = ("forces: [beam]\nsheet: {length: 10, element_size: 2}\nboundary: {names: [a], a: "
                 "{set: middle, "
                 "fix: x y z rx ry rz, angular_velocity: [0, 0, 1]}}\n"
                 "region: {names: [middle], middle: {box: BOX}}\n"
                 "time: {end: 13, dt: 0.25}\n")
        out = self.run_scene("forces: [beam]\nsheet: {length: 10, element_size: 2}\n")
        with h5py.File(out / "lattice.h5") as file:
            x, y, _ = file["bodies/position"][0]
        box = f"{x - 0.01} {x + 0.01} {y - 0.01} {y + 0.01} -1 1"
        row = self.history(self.run_scene(scene.replace("BOX", box)))[-1]
        self.assertLess(row["energy_strain"], 1e-9)

    def test_a_full_turn_in_one_step_does_not_fold_the_beams(self):
        scene = ("forces: [beam]\nsheet: {length: 10, width: 4, element_size: 2, iterations: 20}\n"
                 "boundary: {names: [a], a: {set: one, fix: x y z rx ry rz, angular_velocity: "
                 "[0, 0, 6.283185307]}}\n"
                 "region: {names: [one], one: {box: BOX}}\n")
        out = self.run_scene("forces: [beam]\nsheet: {length: 10, width: 4, element_size: "
                             "2, iterations: 20}\n")
        with h5py.File(out / "lattice.h5") as file:
            x, y, _ = file["bodies/position"][0]
        row = self.history(self.run_scene(scene.replace("BOX",
                                                        f"{x - 0.01} {x + 0.01} {y - 0.01} "
                                                        f"{y + 0.01} -1 1")))[-1]
        self.assertLess(row["energy_strain"], 1e-6)

    def test_rigid_displacement_leaves_no_forces(self):
        """Only x is held; the sheet follows rigidly, and reactions that are rounding errors are no
        load."""
        scene = TENSION.replace("report: [tension]\n",
                                "").replace("left: {set: left, fix: x}",
                                            "left: {set: left, fix: x, "
                                                                    "displacement: [0.01, 0, 0], "
                                                                    "ramp: 1}")
        row = self.history(self.run_scene(scene))[-1]
        self.assertEqual(row["left_displacement_x"], 0.01)
        self.assertLess(abs(row["left_force_x"]), 1e-3)


if __name__ == "__main__":
    unittest.main()
