#!/usr/bin/python3
"""Ice without end: strips join and pieces leave; the ledger, restarts, ranks and files follow.

A sheet drives against a slope so fast that three strips join in a run of seconds, breaks, and some
of its pieces leave over the slope.
"""
import json
import random
import sys
import unittest

import h5py
import numpy as np

import launch
from launch import FULL, REPOSITORY, temporary_folder
from scene_runs import rows_of
from test_restart import RestartTest, contents

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.loads.fields import Bodies  # noqa: E402
from floe.results.output import Output, frames_of  # noqa: E402

SCENE = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
ice: {young: 4e7}
sheet: {length: 24, width: 6, thickness: 0.5, element_size: 1.5, iterations: 20}
supply: {strip: 12, region: [-100, 11, -20, 20, -5, 20]}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 1e5, shear_strength: 1e5, energy: 15}
water: {drag_coefficient: 1, drag_linear: 200, current: [4, 0, 0]}
contact: {young: 1e7, friction: 0.2, restitution: 0.3, plastic_limit: 1e6}
obstacle:
  names: [slope]
  slope: {shape: halfspace, point: [12.02, 0, -0.4554], normal: [-1, 0, 1], friction: 0.1}
boundary: {names: [push], push: {set: left, fix: x y z rx ry rz, velocity: [8, 0, 0], ramp: 0.2}}
time: {end: 5, dt: 5e-4}
output: {history: 0.101, fields: 0.37}
checkpoint: {every: 1000}
"""
# Bodies float by themselves, the edge moves them all: every number is known.
CALM = """integrator: explicit
forces: [beam, gravity, buoyancy]
ice: {young: 4e7}
sheet: {length: 24, width: 6, thickness: 0.5, element_size: 1.5, iterations: 20}
supply: {strip: 12, length: 48}
boundary: {names: [push], push: {set: left, fix: x y z rx ry rz, velocity: [8, 0, 0]}}
initial: {names: [moving], moving: {set: all, velocity: [8, 0, 0]}}
time: {end: 5, dt: 5e-4}
output: {history: 0.1, fields: 1}
"""
# The ice behind begins to move at 0.4 m/s, confined as a wide sheet is: a wave of half that speed
# runs to the right side, comes back from it with the whole, and leaves by the far edge.
WAVE = """integrator: explicit
forces: [beam]
sheet: {length: 240, width: 12, thickness: 0.5, element_size: 1.5, iterations: 40}
supply: {strip: 12, edge: absorbing, velocity: [0.4, 0, 0], ramp: 0.02}
boundary: {names: [below, above], below: {set: bottom, fix: y}, above: {set: top, fix: y}}
time: {end: 0.4}
output: {history: 0.001}
"""
# Still water holds the sheet back, so that the far edge bears a mean load.
LOADED = """integrator: explicit
forces: [beam, gravity, buoyancy, drag]
ice: {young: 4e8}
sheet: {length: 24, width: 6, thickness: 0.5, element_size: 1.5, iterations: 20}
supply: {strip: 12, edge: absorbing, velocity: [8, 0, 0], spring: 60}
water: {drag_linear: 200}
boundary:
  names: [below, above, level]
  below: {set: bottom, fix: y}
  above: {set: top, fix: y}
  level: {set: left, fix: z rx ry rz}
initial: {names: [moving], moving: {set: all, velocity: [8, 0, 0]}}
beam: {damping_ratio: 0.1}
time: {end: 4, dt: 5e-4}
output: {history: 0.01}
checkpoint: {every: 1000}
"""
# The same sheet, pushed by a pressure that sees no water: it goes ever faster.
PUSHED = """integrator: explicit
forces: [beam]
sheet: {length: 48, width: 12, thickness: 0.5, element_size: 1.5, iterations: 20}
supply: {strip: 12, length: 84, edge: absorbing, pressure: 4e6, ramp: 0.5, response: 0.2}
boundary: {names: [below, above], below: {set: bottom, fix: y}, above: {set: top, fix: y}}
beam: {damping_ratio: 0.1}
time: {end: 3}
output: {history: 0.01}
"""


class SupplyTest(RestartTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(SCENE)
        (self.folder / "calm.yaml").write_text(CALM)

    def same_end(self, a, b):
        rows = set((b / "history.csv").read_text().split("\n"))  # and one at the end of each part
        for row in (a / "history.csv").read_text().split("\n"):
            self.assertTrue(row in rows, row)
        first, second = contents(a / "checkpoint.h5"), contents(b / "checkpoint.h5")
        self.assertEqual(set(first), set(second))
        for key in set(first) - {"options", "supply/mesh_frame"}:
            if not key.startswith("output/"):
                np.testing.assert_array_equal(first[key], second[key], key)

    def stopped(self, steps, dir, ranks=1):
        resume = []
        for step in steps:
            self.run_whole("-ts_max_steps", str(step), *resume, dir=dir, ranks=ranks)
            resume = ["-checkpoint_restart", f"{dir}/checkpoint.h5"]
        return self.go_on(dir=dir, ranks=ranks)

    def restarts_and_ranks(self, steps):
        """Runs stopped at steps, and on two ranks, have the bits of one in one piece."""
        a = self.run_whole(dir="a")
        self.same_end(a, self.stopped(steps, "b"))
        two = self.stopped(steps[:1], "c", ranks=2)
        one, other = contents(a / "checkpoint.h5"), contents(two / "checkpoint.h5")
        for key in ("bodies/records", "supply/names"):
            np.testing.assert_array_equal(one[key], other[key], key)
        return a


class BreakingTest(SupplyTest):
    """Cases that share one run of SCENE in one piece, in the folder `whole`."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = temporary_folder(cls.addClassCleanup)
        (folder / "scene.yaml").write_text(SCENE)
        done = launch.run("scene.yaml", "-output_dir", "a", cwd=folder)
        assert done.returncode == 0, done.stderr
        cls.whole = folder / "a"


class Account(SupplyTest):
    def test_of_ice_at_one_speed(self):
        """Mass, momentum and energy of two strips, to rounding of the sums."""
        folder = self.run_whole(dir="a", scene="calm.yaml")
        rows = rows_of(folder)
        with h5py.File(folder / "lattice.h5") as file:
            first = float(np.sum(file["bodies/mass"][:]))
            count = len(file["bodies/mass"])
        self.assertEqual(list(np.unique(rows["bodies"])), [count, 1.5 * count, 2 * count])
        self.assertEqual(rows["bodies_supplied"][-1], count)
        mass = rows["mass_supplied"][-1]
        # Strips have the sheet's area but for their joints.
        self.assertLess(abs(mass / first - 1), 0.05)
        np.testing.assert_allclose(rows["momentum_supplied_x"], 8 * rows["mass_supplied"],
                                   rtol=1e-11)
        # What floats has the energy of its motion and the potentials of weight and water, which
        # are those of the first ice per mass.
        potential = (rows["energy_gravity"][0] + rows["energy_water"][0]) / first
        np.testing.assert_allclose(rows["energy_supplied"][-1], mass * (32 + potential),
                                   rtol=1e-9)
        self.assertLess(np.max(np.abs(rows["energy_balance_error"])),
                        1e-10 * np.max(rows["energy_kinetic"]))
        # Joints bear nothing, since all moves as one.
        self.assertLess(np.max(np.abs(rows["energy_strain"])), 1e-9 * rows["energy_kinetic"][0])


class OneRun(BreakingTest):
    def test_account(self):
        folder = self.whole
        rows = rows_of(folder)
        with h5py.File(folder / "lattice.h5") as file:
            mass = float(np.sum(file["bodies/mass"][:]))
            count = len(file["bodies/mass"])
        self.assertEqual(rows["bodies_supplied"][-1], 1.5 * count)  # three strips
        self.assertGreater(rows["bodies_removed"][-1], 0)
        np.testing.assert_array_equal(
            rows["bodies"], count + rows["bodies_supplied"] - rows["bodies_removed"])
        self.assertGreater(rows["beams_broken"][-1], 5)
        self.assertGreater(rows["mass_removed"][-1], 0)
        self.assertLess(rows["mass_removed"][-1], mass + rows["mass_supplied"][-1])
        # The balance jumps by nothing where ice joins or leaves: its error grows by other steps.
        error = rows["energy_balance_error"]
        scale = np.max(np.abs(rows["energy_kinetic"]))
        self.assertLess(np.max(np.abs(error)), 1e-2 * scale)
        changes = np.flatnonzero(np.diff(rows["bodies"]))
        self.assertEqual(len(changes), 3)
        self.assertLess(np.max(np.abs(np.diff(error)[changes])),
                        2 * np.max(np.abs(np.diff(error)[~np.isin(np.arange(len(error) - 1),
                                                                  changes)])) + 1e-9 * scale)


    def test_frames_have_their_mesh(self):
        folder = self.whole
        names = []
        with h5py.File(folder / "fields.h5") as file:
            frames = sorted(name for name in file if name.startswith("t"))
            for name in frames:
                frame = file[name]
                first = int(frame.attrs.get("mesh", 0))
                mesh = file["mesh" if first == 0 else f"mesh_{first:06d}"]
                self.assertLessEqual(first, int(name[1:]))
                bodies = len(frame["centres"])
                self.assertEqual(mesh["body"][-1], bodies - 1)
                self.assertEqual(len(frame["beams_force"]), len(mesh["beams"]))
                self.assertLess(np.max(mesh["beams"][:]), bodies)
                names.append(mesh["name"][:] if first else np.arange(bodies))
                self.assertEqual(len(names[-1]), bodies)
                # A body is where it was but for the way of a frame.
                if len(names) > 1:
                    both, i, j = np.intersect1d(names[-2], names[-1], return_indices=True)
                    way = frame["centres"][:][j] - file[frames[len(names) - 2]]["centres"][:][i]
                    self.assertGreater(len(both), 0)
                    self.assertLess(np.max(np.abs(way[:, 1:])), 6)
                    self.assertLess(np.median(np.abs(way[:, 0])), 3.5)
        self.assertEqual(len({len(n) for n in names}), 4)
        # The tools find the polyhedra: as many as bodies, convex, each around its centre.
        output = Output(folder)
        bodies = Bodies(output, output.times[-1])
        self.assertEqual(len(bodies), len(names[-1]))
        with h5py.File(folder / "fields.h5") as file:
            for body, centre in enumerate(file[frames[-1]]["centres"][:]):
                normal, offset = bodies.planes(body)
                points = bodies.points[bodies.vertex_of[body]:bodies.vertex_of[body + 1]]
                self.assertLess(np.max(points @ normal.T - offset), 1e-6)
                self.assertGreater(np.min(offset - normal @ centre), 0.1)
        text = (folder / "fields.xmf").read_text()
        grids = text.count("<Grid Name=\"sheet\"") + sum(
            (folder / href).read_text().count("<Grid Name=\"sheet\"")
            for href in (part.split('"')[0] for part in text.split('href="')[1:]))
        self.assertEqual(grids, len(frames))

    def test_summary(self):
        folder = self.whole
        summary = json.loads((folder / "summary.json").read_text())
        rows = rows_of(folder)
        self.assertEqual(summary["supply"]["bodies_supplied"], rows["bodies_supplied"][-1])
        self.assertAlmostEqual(summary["supply"]["mass_removed"] / rows["mass_removed"][-1], 1, 9)


class AbsorbingEdge(SupplyTest):
    def test_no_wave_comes_back(self):
        """Less than 3 % of the amplitude, with the wave's own front and the moduli of the
        lattice."""
        (self.folder / "wave.yaml").write_text(WAVE)
        rows = rows_of(self.run_whole(dir="a", scene="wave.yaml"))
        time, force = rows["time"], rows["far_edge_force_x"]
        way = 240 / np.sqrt(4e9 / 920)  # some 0.115 s; lattices are a little slower
        sent = np.mean(force[(time > 0.04) & (time < 1.5 * way)])
        impedance = sent / (0.2 * 12 * 0.5)
        self.assertAlmostEqual(impedance / np.sqrt(920 * 4e9), 1, delta=0.12)
        back = force[time > 2 * way + 0.06]
        self.assertGreater(len(back), 50)
        self.assertLess(np.sqrt(np.mean(back ** 2)), 0.03 * sent)
        self.assertLess(np.max(np.abs(rows["energy_balance_error"])),
                        1e-9 * np.max(rows["energy_kinetic"]))

    def test_ice_joins_under_a_mean_load(self):
        """Each strip carries the mean load from its first step on: the far edge's force goes on,
        and a spring keeps the edge from lagging."""
        (self.folder / "loaded.yaml").write_text(LOADED)
        rows = rows_of(self.run_whole(dir="a", scene="loaded.yaml"))
        force = rows["far_edge_force_x"]
        joins = np.flatnonzero(np.diff(rows["bodies"]))
        self.assertEqual(len(joins), 2)
        for at in joins:
            before, after = np.mean(force[at - 5:at + 1]), force[at + 1]
            self.assertLess(abs(after - before), 0.1 * before)
        # The strip's own drag is the only one that it brings: the load grows with the sheet.
        steady = [np.mean(force[joins[0] - 20:joins[0]]), np.mean(force[joins[1] - 20:joins[1]])]
        self.assertAlmostEqual(steady[1] / steady[0], 36 / 24, delta=0.1)
        pressure, volume = steady[0] / 3, 12 * 3
        mass = rows["mass_supplied"][joins[0] + 1]
        strain_energy = rows["energy_strain"][joins[0] + 1] - rows["energy_strain"][joins[0]]
        # Less where the sides confine it, more by the lattice's modulus and by the wave's own.
        expected = pressure ** 2 / (2 * 4e8) * volume
        self.assertTrue(0.5 * expected < strain_energy < 2 * expected, strain_energy / expected)
        speed = rows["momentum_supplied_x"][joins[0] + 1] / mass
        self.assertAlmostEqual(speed, 8, delta=0.1)
        self.assertLess(np.max(np.abs(rows["energy_balance_error"])),
                        1e-6 * np.max(rows["energy_kinetic"]))


class PushedEdge(SupplyTest):
    def test_no_wave_comes_back(self):
        """A pressure p sends a wave of p/2, which comes back from the free right side and leaves
        with all of p; the edge's own mean velocity is of much more time."""
        (self.folder / "wave.yaml").write_text(WAVE.replace(
            "velocity: [0.4, 0, 0]", "pressure: 8e5, response: 100"))
        rows = rows_of(self.run_whole(dir="a", scene="wave.yaml"))
        time, force = rows["time"], rows["far_edge_force_x"] / (8e5 * 6)
        way = 240 / np.sqrt(4e9 / 920)
        self.assertAlmostEqual(np.mean(force[(time > 0.04) & (time < 1.5 * way)]), 0.5, delta=0.03)
        back = force[time > 2 * way + 0.06]
        self.assertGreater(len(back), 50)
        self.assertLess(np.sqrt(np.mean(back ** 2)), 0.5 * 0.03)

    def test_mean_load(self):
        """The edge bears its pressure however fast it goes, but for the ice behind, which speeds up
        with it: that of the length c times the response. All momentum is the edge's impulse."""
        (self.folder / "pushed.yaml").write_text(PUSHED)
        folder = self.run_whole(dir="a", scene="pushed.yaml")
        rows = rows_of(folder)
        with h5py.File(folder / "lattice.h5") as file:
            mass = float(np.sum(file["bodies/mass"][:]))
        time, force, push = rows["time"], rows["far_edge_force_x"], 4e6 * 6
        behind = 0.2 * np.sqrt(4e9 * 920) * 6  # rho c A response [kg]
        alone = (time > 1) & (rows["bodies_supplied"] == 0)
        self.assertGreater(np.count_nonzero(alone), 20)
        self.assertAlmostEqual(np.mean(force[alone]) / push / (mass / (mass + behind)), 1,
                               delta=0.1)
        present = mass + rows["mass_supplied"]
        momentum = (np.sqrt(2 * rows["energy_kinetic"] * present)
                    - rows["momentum_supplied_x"])
        impulse = np.concatenate([[0], np.cumsum(np.diff(time) * (force[1:] + force[:-1]) / 2)])
        # Where no ice has just joined, all goes at one speed.
        at = [*np.flatnonzero(np.diff(rows["bodies_supplied"])), -1]
        np.testing.assert_allclose(momentum[at], impulse[at], rtol=0.01)
        self.assertEqual(len(np.unique(rows["bodies_supplied"])), 4)  # three strips have joined
        self.assertLess(np.max(np.abs(rows["energy_balance_error"])),
                        1e-3 * np.max(rows["energy_kinetic"]))

    def test_restarts_and_ranks(self):
        (self.folder / "scene.yaml").write_text(PUSHED.replace("end: 3", "end: 2.2")
                                                + "checkpoint: {every: 1000}\n")
        self.restarts_and_ranks((37, 900, 1100))


class PeriodicSides(SupplyTest):
    def test_wave(self):
        """Without sides it is that of a sheet that is confined, and none comes back."""
        text = WAVE.replace("iterations: 40", "iterations: 40, periodic: true")
        (self.folder / "wave.yaml").write_text(
            "\n".join(line for line in text.split("\n") if "boundary" not in line))
        rows = rows_of(self.run_whole(dir="a", scene="wave.yaml"))
        time, force = rows["time"], rows["far_edge_force_x"]
        way = 240 / np.sqrt(4e9 / 920)
        sent = np.mean(force[(time > 0.04) & (time < 1.5 * way)])
        self.assertAlmostEqual(sent / (0.2 * 6 * np.sqrt(920 * 4e9)), 1, delta=0.12)
        back = force[time > 2 * way + 0.06]
        self.assertLess(np.sqrt(np.mean(back ** 2)), 0.03 * sent)

    def test_restarts_and_ranks(self):
        """Of ice that breaks; its sides meet."""
        text = SCENE.replace("width: 6,", "width: 9, periodic: true,")
        strips, end, last = (2, "3.4", 6200) if FULL else (1, "2", 3500)
        (self.folder / "scene.yaml").write_text(text.replace("end: 5", "end: " + end))
        folder = self.restarts_and_ranks((1111, 3050, last))
        rows = rows_of(folder)
        self.assertGreater(rows["beams_broken"][-1], 5)
        self.assertEqual(len(np.unique(rows["bodies_supplied"])), strips + 1)
        self.assertEqual(rows["bodies_supplied"][-1] % strips, 0)
        self.assertGreater(rows["bodies_removed"][-1], 0)
        with h5py.File(folder / "lattice.h5") as file:
            self.assertGreater(np.count_nonzero(file["beams/image"][:, 1]), 10)


class Structures(SupplyTest):
    def test_ice_without_end_against_a_leg_on_springs(self):
        """The leg stays behind all ice that joins and leaves: the same bits after stops and on two
        ranks, and its name in the frames."""
        text = SCENE.replace("names: [slope]", "names: [slope, leg]").replace(
            "boundary: {names: [push],", "  leg: {shape: box, centre: [12.5, 0, 0], size: [1, 1, "
            "4], mass: 2e4, support_stiffness: [4e6, 4e6, 4e7, 4e7, 4e7, 4e7], "
            "support_damping_ratio: 0.05, touches: ice}\nboundary: {names: [push, guide], "
            "guide: {set: leg, fix: z rx ry},")
        (self.folder / "scene.yaml").write_text(text)
        folder = self.restarts_and_ranks((1111, 3050, 3200, 6200))
        rows = rows_of(folder)
        with h5py.File(folder / "lattice.h5") as file:
            ice = len(file["bodies/mass"]) - 1
        self.assertGreater(rows["bodies_removed"][-1], 0)
        self.assertEqual(rows["bodies_supplied"][-1], 1.5 * ice)
        np.testing.assert_array_equal(
            rows["bodies"], ice + 1 + rows["bodies_supplied"] - rows["bodies_removed"])
        # Static under the mean load, to the share that is in the leg's own motion.
        late = rows["time"] > 2
        self.assertGreater(np.max(np.abs(rows["leg_force_x"])), 2e4)
        self.assertAlmostEqual(np.mean(rows["leg_x"][late]) * 4e6
                               / np.mean(rows["leg_force_x"][late]), 1, delta=0.1)
        error = rows["energy_balance_error"]
        self.assertLess(np.max(np.abs(error)), 1e-2 * np.max(np.abs(rows["energy_kinetic"])))
        last = frames_of(folder)[-1]
        with h5py.File(last[1]) as file:
            first = int(file[last[2]].attrs["mesh"])
            names = h5py.File(last[1].with_name(f"mesh_{first:06d}.h5"))["mesh/name"][:]
        self.assertEqual(names[-1], 2 ** 31 - 2)
        self.assertLess(names[-2], 10 ** 6)


class Restarts(BreakingTest):
    def test_near_changes(self):
        """Of ice that breaks: at the steps of changes and beside them."""
        a = self.whole
        changes = rows_of(a)["time"][1:][np.diff(rows_of(a)["bodies"]) != 0]
        near = [50 * round(float(t) / 5e-4 / 50) for t in changes]
        self.same_end(a, self.stopped(sorted(step + d for step in near for d in (-50, 0, 1)), "b"))

    def test_at_twenty_times(self):
        """Of ice that breaks, at random; in the short form at six."""
        a = self.whole
        last = json.loads((a / "summary.json").read_text())["steps"]
        stops = random.Random(11).sample(range(1, last), 20 if FULL else 6)
        self.same_end(a, self.stopped(sorted(stops), "b"))

    def test_on_two_ranks(self):
        """The same states as on one; restarts bit for bit. In the short form until a strip has
        joined and pieces have left."""
        end, last = ("3.4", 6200) if FULL else ("2", 3500)
        (self.folder / "scene.yaml").write_text(SCENE.replace("end: 5", "end: " + end))
        alone, two = (self.run_whole(dir=f"r{ranks}", ranks=ranks) for ranks in (1, 2))
        one, other = contents(alone / "checkpoint.h5"), contents(two / "checkpoint.h5")
        for key in ("bodies/records", "force_4_contact/pairs", "supply/names"):
            np.testing.assert_array_equal(one[key], other[key], key)
        for path in alone.glob("fields/*.h5"):
            first, second = contents(path), contents(two / "fields" / path.name)
            self.assertEqual(set(first), set(second))
            for key, values in first.items():
                np.testing.assert_array_equal(values, second[key], f"{path.name}: {key}")
        self.same_end(two, self.stopped((1111, 3050, last), "b", ranks=2))
        rows = rows_of(alone)
        for name in ("beams_broken", "bodies_supplied", "bodies_removed"):
            self.assertGreater(rows[name][-1], 0)
        three = self.stopped((3050,), "c", ranks=1)  # and on another number
        np.testing.assert_array_equal(contents(three / "checkpoint.h5")["bodies/records"],
                                      one["bodies/records"])


    def test_of_an_absorbing_edge_at_twenty_times(self):
        """In the short form at eight."""
        (self.folder / "scene.yaml").write_text(LOADED)
        a = self.run_whole(dir="a")
        random.seed(5)
        steps = {2999, 3000, 3001, 3050}  # the first change among them
        while len(steps) < (20 if FULL else 8):
            steps.add(random.randrange(1, 8000))
        self.same_end(a, self.stopped(sorted(steps), "b"))
        two = self.run_whole(dir="c", ranks=2)
        np.testing.assert_array_equal(contents(a / "checkpoint.h5")["bodies/records"],
                                      contents(two / "checkpoint.h5")["bodies/records"])


class Files(SupplyTest):
    def test_ice_that_changes_before_the_first_sample_after_a_restart(self):
        """Frames after it have their mesh, as those of a run in one piece have."""
        (self.folder / "scene.yaml").write_text(
            SCENE.replace("history: 0.101, fields: 0.37", "history: 0.1, fields: 0.25")
            .replace("end: 5", "end: 3.4"))
        whole = self.run_whole(dir="a")
        self.run_whole("-ts_max_steps", "3000", dir="b")
        parts = self.go_on(dir="b")
        frames = {}
        for folder in (whole, parts):
            for time, path, group in frames_of(folder):
                with h5py.File(path) as file:
                    first = int(file[group].attrs.get("mesh", 0))
                    name = path.with_name(f"mesh_{first:06d}.h5")
                    names = []
                    if first:
                        with h5py.File(name) as mesh:
                            names = list(mesh["mesh/name"][:])
                    frames.setdefault(round(time, 6), []).append(
                        (len(file[group]["centres"]), names))
        changed = 0
        for found in frames.values():
            if len(found) == 2:  # each part has a frame of its own last state too
                self.assertEqual(*found)
                changed += bool(found[0][1])
        self.assertGreater(changed, 5)


class Length(SupplyTest):
    def test_memory_goes_with_the_window(self):
        """Four times the ice takes no more memory: what comes leaves."""
        sizes, present, supplied = [], [], []
        for end in ("5", "20") if FULL else ("2", "10"):
            folder = self.run_whole("-time_end", end, "-output_fields", "100", dir=end)
            summary = json.loads((folder / "summary.json").read_text())
            sizes.append(summary["peak_memory_mb"])
            present.append(summary["supply"]["bodies"])
            supplied.append(summary["supply"]["bodies_supplied"])
        self.assertGreater(supplied[1], 4 * supplied[0])
        self.assertLess(present[1], 1.5 * present[0])
        self.assertLess(sizes[1] - sizes[0], 4 if FULL else 2)

    def test_ten_kilometres_cost_what_the_window_costs(self):
        """Ice of 10 km, of 48 m and without end: the same run until the shortest ends, in the same
        memory."""
        sizes, rows = [], []
        for length in ("48", "10000", None):
            words = () if length is None else ("-supply_length", length)
            folder = self.run_whole("-time_end", "2", *words, dir=f"l{length}")
            sizes.append(json.loads((folder / "summary.json").read_text())["peak_memory_mb"])
            rows.append((folder / "history.csv").read_text())
        self.assertEqual(rows[0], rows[1])
        self.assertEqual(rows[0], rows[2])
        self.assertLess(max(sizes) - min(sizes), 2)


class Refused(SupplyTest):
    def says(self, *words, **how):
        said = self.finish(self.begin(*words, dir="bad", **how), 2)
        self.assertEqual(said.count("\n"), 1, said)
        return said

    def test_what_does_not_go_together(self):
        for words, expected in (
                (("-supply_strip", "7"), "supply: strip: 7 must be >= 12"),
                (("-supply_strip", "13"), "must be a whole number of strips, is 1.84615 of 13 m"),
                (("-supply_length", "30"), "supply: length: 30 must be >= 36"),
                (("-supply_region", "5 1 0 1 0 1"), "supply: region: must be x0, x1"),
                (("-sheet_mesh_file", "m.h5"), "sheet: mesh_file: does not go with 'supply'"),
                (("-forces", "gravity,buoyancy"), "forces: does not go with 'supply'"),
                (("-beam_calibrate", "isotropic", "-beam_shear", "one_point"), "beam"),
                (("-boundary_push_velocity", "-1 0 0"), "a velocity along +x"),
                (("-boundary_push_set", "right"), "'set: left'"),
                (("-supply_spring", "10"), "supply: spring: would have no effect"),
                (("-supply_pressure", "1e5"), "supply: pressure: would have no effect"),
                (("-supply_edge", "absorbing", "-supply_velocity", "8 0 0", "-supply_response",
                  "2"), "supply: response: would have no effect: there is no 'supply: pressure'"),
                (("-supply_edge", "absorbing", "-supply_velocity", "8 0 0", "-supply_pressure",
                  "1e5"), "supply: velocity: does not go with 'supply: pressure'"),
                (("-supply_edge", "absorbing"), "supply: velocity: "),
                (("-supply_edge", "absorbing", "-supply_velocity", "8 0 0"),
                 "boundary: push: fix: x and y of 'set: left' do not go with"),
                (("-boundary_push_fix", "x y rz"), "'set: left' none has in 'fix': z rx ry")):
            self.assertIn(expected, self.says(*words))
        self.assertIn("supply: -ts_type rk", self.says("-ts_type", "rk", scene="calm.yaml"))


if __name__ == "__main__":
    unittest.main()
