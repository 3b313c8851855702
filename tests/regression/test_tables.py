#!/usr/bin/python3
"""Tables in time: loads, boundaries, currents, levels, obstacles and anchors that follow a file."""
import unittest

import numpy as np

from scene_runs import SceneTest, last_frame, rows_of
from test_structures import DIAGONAL, fl

# A structure beside a block that it never meets.
ALONE = """integrator: explicit
forces: [contact]
lattice_file: block.h5
contact: {young: 1e6}
obstacle:
  names: [leg]
  leg: {shape: box, centre: [9, 0, 0], size: [2, 2, 6], mass: 5e4, SUPPORT}
time: {end: 3, dt: 1e-3}
output: {history: 1e-2}
"""
LOAD = "load: {names: [p], p: {set: leg, table: p.csv}}\n"
# A box of half the water's density.
SIDE, MASS, RHO, G = 4.0, 16160.0, 1010.0, 9.81
ADRIFT = """integrator: explicit
forces: [gravity, buoyancy, drag, contact]
lattice_file: block.h5
contact: {young: 1e6}
water: {density: 1010, WATER}
obstacle:
  names: [leg]
  leg: {shape: box, centre: [9, 0, 0], size: [4, 4, 2], mass: 16160, floats: true}
time: {end: 20, dt: 2e-3}
output: {history: 0.05}
"""
# A block that is held, and a wall that presses on it.
PRESSED = """integrator: explicit
forces: [contact]
lattice_file: block.h5
contact: {young: 1e6, friction: 0.3, initial_overlap: press}
boundary: {names: [hold], hold: {set: all, fix: x y z rx ry rz}}
obstacle:
  names: [wall]
  wall: {shape: box, centre: [1.48, 0, 0], size: [2, 4, 4], MOTION}
time: {end: 2, dt: 1e-3}
output: {history: 1e-2}
"""
# Breaking ice, all of which moves as tables say.
ICE = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
ice: {young: 4e8}
sheet: {length: 12, width: 8, thickness: 0.5, element_size: 1, iterations: 20}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 1e5, shear_strength: 1e5, energy: 15}
water: {drag_linear: 200, current_table: current.csv, current_interpolation: smooth,
        level_table: level.csv, level_interpolation: smooth, level_periodic: true}
contact: {young: 1e7, friction: 0.2, restitution: 0.3, plastic_limit: 1e6}
obstacle:
  names: [leg, hull]
  leg: {shape: cylinder, base: [7.6, 0, -3], radius: 1.5, height: 5, friction: 0.1,
        table: leg.csv, interpolation: smooth, periodic: true}
  hull: {shape: box, centre: [0, 8, 0], size: [4, 4, 1], mass: 8e3, floats: true}
line: {names: [tow], tow: {structure: hull, fairlead: [0, 6, 0], anchor: [0, -20, 0],
       stiffness: 1e4, pretension: 1e3, damping: 1e3, anchor_table: tug.csv}}
boundary: {names: [push], push: {set: left, fix: x y rz, table: push.csv}}
load: {names: [p], p: {set: hull, table: p.csv, periodic: true}}
time: {end: 1, dt: 2e-4}
output: {history: 0.02, fields: 0.5}
checkpoint: {every: 1000}
"""


class TableTest(SceneTest):
    def setUp(self):
        super().setUp()
        fl.blocks(np.array([[1.0, 1, 1]]), np.array([[0.0, 0, 0]])).write(
            self.folder / "block.h5")

    def table(self, name, heading, rows):
        with open(self.folder / name, "w") as file:
            file.write(heading + "\n")
            for row in np.asarray(rows, float):
                file.write(", ".join(repr(float(x)) for x in row) + "\n")

    def rows(self, scene, *words, name="s"):
        self.run_scene(scene.replace(", SUPPORT", ""), *words, name=name)
        return rows_of(self.folder / "out" / name)

    def closes(self, rows, of, part=1e-6):
        """The ledger closes, relative to the largest of an energy."""
        self.assertLess(np.max(np.abs(rows["energy_balance_error"])), part * np.max(np.abs(of)))


class Loads(TableTest):
    def test_a_load_that_ends(self):
        """The impulse of the table, to rounding, then free motion."""
        self.table("p.csv", "time, fx, mz", [[0, 1e4, 0], [1, 1e4, 2e4], [1.1, 0, 0]])
        rows = self.rows(ALONE + LOAD)
        self.assertAlmostEqual(rows["leg_velocity_x"][-1] / (1.05e4 / 5e4), 1, delta=1e-9)
        about = 5e4 * 8 / 12
        self.assertAlmostEqual(rows["leg_spin_z"][-1] / (1.1e4 / about), 1, delta=1e-9)
        after = rows["time"] > 1.12
        self.assertLess(np.ptp(np.diff(rows["leg_x"][after])), 1e-13)
        self.assertLess(np.ptp(rows["leg_velocity_x"][after]), 1e-14)
        self.assertEqual(np.max(np.abs(rows["leg_y"])), 0)
        self.closes(rows, rows["energy_kinetic"], 1e-9)
        self.assertAlmostEqual(rows["energy_external"][-1] / rows["energy_kinetic"][-1], 1,
                               delta=1e-6)  # a free rotation's, of the second order

    def test_a_load_that_switches(self):
        """There and to rest again: the displacement of the double integral."""
        knots = np.array([[0, 0], [0.1, 1e4], [1.1, 1e4], [1.3, -1e4], [2.3, -1e4], [2.4, 0]])
        self.table("p.csv", "time fy", knots)
        rows = self.rows(ALONE + LOAD)
        self.assertLess(abs(rows["leg_velocity_y"][-1]), 1e-12)
        time = np.linspace(0, 3, 300001)
        velocity = np.cumsum(np.interp(time, *knots.T)) * 1e-5 / 5e4
        self.assertAlmostEqual(rows["leg_y"][-1] / (np.sum(velocity) * 1e-5), 1, delta=1e-4)
        self.assertGreater(rows["leg_y"][-1], 0.1)

    def test_resonance(self):
        """A harmonic load by a periodic table on a leg on springs: amplitude and phase are those of
        one degree of freedom, to 1 %; 1/(2 zeta) in resonance."""
        stiffness, mass, zeta, force = 2e6, 5e4, 0.05, 1e4
        natural = np.sqrt(stiffness / mass)
        scene = ALONE.replace("SUPPORT", DIAGONAL + f", support_damping_ratio: {zeta}").replace(
            "end: 3", "end: 30")
        for ratio, interpolation in ((0.5, "smooth"), (1, "smooth"), (1, "linear"),
                                     (1.7, "smooth")):
            rate = ratio * natural
            time = np.linspace(0, 2 * np.pi / rate, 1001)
            self.table("p.csv", "time,fx", np.column_stack([time, force * np.sin(rate * time)]))
            rows = self.rows(scene + LOAD.replace(
                "p.csv", f"p.csv, periodic: true, interpolation: {interpolation}"),
                "-output_overwrite")
            late = rows["time"] > 30 - 4 * time[-1]
            at = rate * rows["time"][late]
            (sine, cosine), *_ = np.linalg.lstsq(np.column_stack([np.sin(at), np.cos(at)]),
                                                 rows["leg_x"][late], rcond=None)
            expected = force / stiffness / (1 - ratio ** 2 + 2j * zeta * ratio)
            self.assertLess(abs(sine + 1j * cosine - expected), 0.01 * abs(expected), ratio)
            if ratio == 1:
                self.assertAlmostEqual(np.hypot(sine, cosine) / (force / stiffness) * 2 * zeta, 1,
                                       delta=0.01)
            self.closes(rows, rows["energy_external"], 1e-3)

    def test_load_steps(self):
        """Statics follow a table: there, back and beyond."""
        self.table("p.csv", "time, fx", [[0, 0], [1, 1e5], [2, -5e4]])
        self.run_scene("""forces: [beam]
sheet: {length: 8, thickness: 1, element_size: 2, iterations: 10}
beam: {kinematics: linear}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [p], p: {set: right, table: p.csv}}
time: {end: 2, dt: 0.5}
output: {fields: 0.5}
""", name="s")
        rows = rows_of(self.folder / "out/s")
        at = dict(zip(np.round(rows["time"], 9), rows["p_load_displacement_x"]))
        self.assertGreater(at[1.0], 0)
        for time, factor in ((0.5, 0.5), (1.5, 0.25), (2.0, -0.5)):
            self.assertAlmostEqual(at[time] / at[1.0], factor, delta=1e-9)


    def test_implicit_steps_end_at_rows(self):
        """A pulse of 10 ms in the middle of a long run is not stepped over: its impulse."""
        self.table("p.csv", "time, fx", [[0, 0], [5, 0], [5.01, 1e5], [5.02, 0]])
        self.run_scene("""integrator: implicit
forces: [beam]
sheet: {length: 8, thickness: 1, element_size: 2, iterations: 10}
load: {names: [p], p: {set: all, table: p.csv}}
time: {end: 10}
output: {history: 5, fields: 5}
""", name="s")
        moved = np.mean(last_frame(self.folder / "out/s")["bodies_displacement"][:, 0])
        mass = 920 * 64  # equal shares: the mean of the bodies moves about as their centre
        self.assertAlmostEqual(moved / (1000 / mass * 4.99), 1, delta=0.1)


    def test_rows_within_a_step_are_told(self):
        """An impulse within a step: an explicit run says that it does not see it as a whole."""
        self.table("p.csv", "time,fx", [[0, 0], [0.0502, 0], [0.0504, 1e6], [0.0506, 0]])
        scene = ADRIFT.replace("drag, ", "").replace(", WATER", "").replace(
            "end: 20", "end: 0.1") + "load: {names: [p], p: {set: leg, table: p.csv}}\n"
        told = "load: p: table: rows are as near as 0.0002 s, less than a step"
        self.assertIn(told, self.run_scene(scene, name="a").stdout)
        self.table("p.csv", "time,fx", [[0, 0], [0.05, 0], [0.06, 1e6], [0.07, 0]])
        self.assertNotIn("rows are as near", self.run_scene(scene, name="b").stdout)


class Boundaries(TableTest):
    SCENE = ICE.replace("current_table: current.csv, current_interpolation: smooth,",
                        "current: [1, 0, 0],").replace(
        "        level_table: level.csv, level_interpolation: smooth, level_periodic: true}", "}"
    ).replace("table: leg.csv, interpolation: smooth, periodic: true", "velocity: [0, 0, 0]")

    def test_steady_velocity(self):
        """Tables of velocities and of displacements are the constant velocity, and one that rises
        is the ramp."""
        scene = self.SCENE[:self.SCENE.index("  hull:")].replace("[leg, hull]", "[leg]") + (
            "boundary: {names: [push], push: {set: left, fix: x y rz, HOW}}\n"
            "time: {end: 0.2, dt: 2e-4}\noutput: {fields: 0.2}\n")
        self.table("v.csv", "time,vx", [[0, 1], [0.05, 1], [7, 1]])
        self.table("u.csv", "time,ux", [[0, 0], [7, 7]])
        self.table("r.csv", "time,vx", [[0, 0], [0.1, 1], [7, 1]])
        frames = {}
        for name, how in (("steady", "velocity: [1, 0, 0]"), ("v", "table: v.csv"),
                          ("u", "table: u.csv"), ("smooth", "table: u.csv, interpolation: smooth"),
                          ("ramp", "velocity: [1, 0, 0], ramp: 0.1"), ("r", "table: r.csv")):
            self.run_scene(scene.replace("HOW", how), name=name)
            frames[name] = last_frame(self.folder / "out" / name)["bodies_displacement"]
        for one, other in (("steady", "v"), ("steady", "u"), ("steady", "smooth"), ("ramp", "r")):
            np.testing.assert_allclose(frames[other], frames[one], rtol=0, atol=1e-12)
        self.assertGreater(np.max(frames["steady"]), 0.19)
        self.assertGreater(np.max(np.abs(frames["ramp"] - frames["steady"])), 0.01)

    def test_a_structure_that_swings(self):
        """Its place is the table's in each step, and the work of the boundary its energy."""
        time = np.linspace(0, 2, 41)
        self.table("u.csv", "time,ux,wz", np.column_stack(
            [time, 0.1 * np.sin(np.pi * time), 0.2 * np.cos(np.pi * time)]))
        rows = self.rows(ALONE.replace("leg: {", "leg: {").replace(", SUPPORT", "") + (
            "boundary: {names: [b], b: {set: leg, fix: x rx ry rz, table: u.csv, "
            "periodic: true}}\n"))
        expected = np.interp(rows["time"] % 2, time, 0.1 * np.sin(np.pi * time))
        np.testing.assert_allclose(rows["leg_x"], expected, rtol=0, atol=1e-13)
        # The rows' trapezoids.
        whole = np.concatenate([[0], np.cumsum(0.05 * 0.5 * 0.2 * (
            np.cos(np.pi * time[1:]) + np.cos(np.pi * time[:-1])))])
        at_rows = np.isclose(rows["time"] / 0.05, np.round(rows["time"] / 0.05))
        np.testing.assert_allclose(rows["leg_rz"][at_rows],
                                   np.interp(rows["time"][at_rows] % 2, time, whole), rtol=0,
                                   atol=1e-12)
        self.closes(rows, rows["energy_kinetic"], 1e-9)
        self.assertGreater(np.max(rows["energy_kinetic"]), 100)


class Obstacles(TableTest):
    def test_a_harmonic_motion(self):
        """A table of a steady and a harmonic motion presses as the keys' motion does; the error
        falls with the square of the rows' distance at least."""
        exact = self.rows(PRESSED.replace(
            "MOTION", "velocity: [-0.002, 0.001, 0], amplitude: [0.004, 0, 0], frequency: 0.5"),
            name="exact")
        self.assertGreater(np.max(np.abs(exact["wall_force_x"])), 1e4)
        for interpolation in ("linear", "smooth"):
            errors = []
            for count in (20, 40, 80):
                time = np.linspace(0, 2, count + 1)
                self.table("w.csv", "time,ux,uy", np.column_stack(
                    [time, -0.002 * time + 0.004 * np.sin(np.pi * time), 0.001 * time]))
                rows = self.rows(PRESSED.replace(
                    "MOTION", f"table: w.csv, interpolation: {interpolation}"), "-output_overwrite")
                errors.append(np.max(np.abs(rows["wall_force_x"] - exact["wall_force_x"]))
                              / np.max(np.abs(exact["wall_force_x"])))
            self.assertLess(errors[-1], 2e-3, interpolation)
            self.assertGreater(errors[0] / errors[1], 3.4, interpolation)
            self.assertGreater(errors[1] / errors[2], 3.4, interpolation)
            self.closes(rows, rows["energy_external"], 1e-3)

    def test_steady_motions(self):
        """Displacements, velocities and rotation vectors of tables against the keys."""
        self.table("u.csv", "time,ux,uy,rx", [[0, 0, 0, 0], [4, -0.01, 0.02, 0.04]])
        self.table("v.csv", "time,vx,vy,rx", [[0, -0.0025, 0.005, 0], [4, -0.0025, 0.005, 0.04]])
        keys = "velocity: [-0.0025, 0.005, 0], angular_velocity: [0.01, 0, 0]"
        all_rows = [self.rows(PRESSED.replace("MOTION", how), name=f"s{k}") for k, how in enumerate(
            (keys, "table: u.csv", "table: v.csv, interpolation: smooth"))]
        for rows in all_rows[1:]:
            for column in ("wall_force_x", "wall_force_y", "energy_external", "energy_friction"):
                scale = np.max(np.abs(all_rows[0][column]))
                self.assertGreater(scale, 0)
                np.testing.assert_allclose(rows[column], all_rows[0][column], rtol=0,
                                           atol=1e-9 * scale)

    def test_too_fast(self):
        self.table("u.csv", "time,ux", [[0, 0], [1, 1], [1.001, 3], [2, 3]])
        done = self.run_scene(PRESSED.replace("MOTION", "table: u.csv"), code=2)
        self.assertIn("obstacle: wall: moves at up to 2000 m/s", done.stderr)


class Water(TableTest):
    def test_current(self):
        """A current that rises takes a box along: m v' = -c A (v - U)."""
        self.table("c.csv", "time,x,y", [[0, 0, 0], [4, 1, -0.5], [9, 1, -0.5]])
        rows = self.rows(ADRIFT.replace("WATER", "drag_linear: 2000, current_table: c.csv"))
        rate, t = 2000 * SIDE ** 2 / 2 / MASS, rows["time"]
        early = (t - (1 - np.exp(-rate * t)) / rate) / 4
        at_end = (4 - (1 - np.exp(-rate * 4)) / rate) / 4
        expected = np.where(t < 4, early, 1 - (1 - at_end) * np.exp(-rate * (t - 4)))
        np.testing.assert_allclose(rows["leg_velocity_x"], expected, rtol=0, atol=2e-3)
        np.testing.assert_allclose(rows["leg_velocity_y"], -0.5 * rows["leg_velocity_x"],
                                   rtol=0, atol=1e-12)
        self.closes(rows, rows["energy_kinetic"], 1e-4)

    def test_current_in_the_plane(self):
        """The planar model, and drag on faces, feel the same table."""
        self.table("c.csv", "time,x", [[0, 0], [2, 1]])
        self.table("s.csv", "time,x", [[0, 1], [1, 1]])
        scene = """integrator: explicit
forces: [beam, drag]
sheet: {length: 8, thickness: 1, element_size: 2, iterations: 10}
model: {planar: PLANAR}
water: {LAW, TABLE}
time: {end: 1}
"""
        for law in ("drag_linear: 1000", "drag: faces, shelter: 0"):
            for planar in ("true", "false") if "faces" not in law else ("false",):
                found = {}
                for name, table in (("table", "current_table: c.csv"),
                                    ("steady", "current_table: s.csv"),
                                    ("keys", "current: [1, 0, 0]")):
                    self.run_scene(scene.replace("PLANAR", planar).replace("LAW", law).replace(
                        "TABLE", table), "-output_overwrite", name="s")
                    found[name] = np.mean(
                        last_frame(self.folder / "out/s")["bodies_displacement"][:, 0])
                self.assertAlmostEqual(found["steady"] / found["keys"], 1, delta=1e-12)
                self.assertGreater(found["table"], 0.01 * found["keys"])
                self.assertLess(found["table"], 0.7 * found["keys"])

    def test_a_slow_level(self):
        """The draft of a box stays, with drag too: the water rises with its level; below waves of
        no height as well."""
        self.table("l.csv", "time,level", [[0, 0], [1, 0], [19, 0.4], [20, 0.4]])
        for name, more in (("still", ""), ("waves", "waves: {height: 1e-9, period: 8}\n")):
            for law in ("drag_linear: 10", "drag_linear: 1e4", "drag: faces, shelter: 0"):
                rows = self.rows(ADRIFT.replace(
                    "WATER", law + ", level_table: l.csv, level_interpolation: smooth") + more,
                    "-output_overwrite", name=name)
                level = np.interp(rows["time"], [0, 1, 19, 20], [0, 0, 0.4, 0.4])
                middle = (rows["time"] > 4) & (rows["time"] < 16)
                np.testing.assert_allclose(np.interp([1, 10, 19, 20], rows["time"],
                                                     rows["water_level"]), [0, 0.2, 0.4, 0.4],
                                           atol=1e-6)
                self.assertLess(np.max(np.abs(rows["leg_z"] - level)), 0.05)
                self.assertAlmostEqual(rows["leg_z"][-1], 0.4, delta=0.02)
                if "1e4" in law:
                    self.assertLess(np.max(np.abs(np.gradient(rows["leg_z"], rows["time"])
                                                  [middle] - np.gradient(level, rows["time"])
                                                  [middle])), 0.02)
                self.closes(rows, rows["energy_external"], 1e-3)

    def test_a_sudden_level(self):
        """A box heaves about the new level by rho g A/m."""
        self.table("l.csv", "time,level", [[0, 0], [1e-6, 0.1], [9, 0.1]])
        rows = self.rows(ADRIFT.replace("drag, ", "").replace(
            "WATER", "level_table: l.csv").replace("end: 20", "end: 8"))
        rate = np.sqrt(RHO * G * SIDE ** 2 / MASS)
        np.testing.assert_allclose(rows["leg_z"], 0.1 * (1 - np.cos(rate * rows["time"])), rtol=0,
                                   atol=1e-3)
        self.closes(rows, rows["energy_external"], 1e-6)

    def test_a_level_of_faces(self):
        """Drag on faces of floating ice: wet faces, and water that rises with the level."""
        self.table("l.csv", "time,level", [[0, 0], [5, 0.5]])
        scene = """integrator: explicit
forces: [beam, gravity, buoyancy, drag]
sheet: {length: 6, thickness: 1, element_size: 2, iterations: 10}
water: {drag: faces, drag_form: 20, shelter: 0, pace: PACE, level_table: l.csv}
time: {end: 5}
"""
        rise = []
        for pace in (1, 10):
            self.run_scene(scene.replace("PACE", str(pace)), "-output_overwrite", name="s")
            rise.append(np.mean(last_frame(self.folder / "out/s")["bodies_displacement"][:, 2]))
        self.assertAlmostEqual(rise[0], 0.5, delta=0.01)  # heavily damped against still water
        self.assertAlmostEqual(rise[1], rise[0], delta=1e-4)


class Anchors(TableTest):
    def test_towing(self):
        """A tug with a steady speed: the line bears the drag; by a table as by the keys."""
        scene = ADRIFT.replace("WATER", "drag_linear: 2000").replace("end: 20", "end: 60") + (
            "line: {names: [tow], tow: {structure: leg, fairlead: [11, 0, 0], anchor: [40, 0, 0],\n"
            "       stiffness: 5e4, pretension: 0, damping: 1e4, HOW}}\n")
        self.table("a.csv", "time,vx", [[0, 0], [10, 0.5], [99, 0.5]])
        self.table("u.csv", "time,ux", [[0, 0], [10, 2.5], [110, 52.5]])
        keys = self.rows(scene.replace("HOW", "anchor_velocity: [0.5, 0, 0], anchor_ramp: 10"),
                         name="keys")
        drag = 2000 * SIDE ** 2 / 2 * 0.5
        self.assertAlmostEqual(keys["tow_tension"][-1] / drag, 1, delta=1e-3)
        self.assertAlmostEqual(keys["leg_velocity_x"][-1], 0.5, delta=1e-3)
        self.assertAlmostEqual(keys["tow_length"][-1], 29 + drag / 5e4, delta=1e-3)
        self.closes(keys, keys["energy_external"], 1e-4)
        power = np.diff(keys["energy_external"][[-101, -1]])[0] / np.diff(keys["time"][[-101, -1]])
        self.assertAlmostEqual(power[0] / (drag * 0.5), 1, delta=1e-3)
        table = self.rows(scene.replace("HOW", "anchor_table: a.csv"), name="table")
        for column in ("leg_x", "tow_tension", "energy_external"):
            np.testing.assert_allclose(table[column], keys[column], rtol=0,
                                       atol=1e-9 * np.max(np.abs(keys[column])))
        steps = self.rows(scene.replace("HOW", "anchor_table: u.csv").replace(
            "pretension: 0", "pretension: 1e3"), name="u")
        self.assertAlmostEqual(steps["tow_tension"][-1] / drag, 1, delta=1e-3)


class Everything(TableTest):
    def setUp(self):
        super().setUp()
        self.table("current.csv", "time,x,y", [[0, 0, 0], [0.4, 1, 0], [0.9, 1, 0.5]])
        self.table("level.csv", "time,level", [[0, 0], [0.2, 0.01], [0.5, -0.01], [0.8, 0]])
        angle = np.linspace(0, 2 * np.pi, 21)
        self.table("leg.csv", "time,ux,uy,rz", np.column_stack(
            [0.05 * angle, 0.05 * np.sin(angle), 0.1 * (1 - np.cos(angle)), 0.1 * np.sin(angle)]))
        self.table("tug.csv", "time,vx,vy", [[0, 0, 0], [0.5, 0, -1], [0.6, 1, -1]])
        self.table("push.csv", "time,ux", [[0, 0], [0.1, 0.05], [1, 0.95]])
        self.table("p.csv", "time,fx,fy", [[0, 0, 0], [0.1, 1e4, 0], [0.2, 0, 2e4], [0.3, 0, 0]])

    def test_ranks_and_restarts(self):
        self.same_on_ranks_and_after_a_restart(ICE)
        rows = rows_of(self.folder / "out/one")
        self.assertGreater(rows["beams_broken"][-1], 3)
        self.assertGreater(np.max(np.abs(rows["leg_force_x"])), 1e4)
        self.assertGreater(np.max(np.abs(rows["hull_y"])), 0.01)
        self.assertLess(np.max(np.abs(rows["energy_balance_error"])),
                        2e-2 * np.max(np.abs(rows["energy_boundary"])))

    def test_a_changed_table_is_refused(self):
        self.run_scene(ICE, "-ts_max_steps", "100", name="part")
        go = ("-checkpoint_restart", "out/part/checkpoint.h5")
        before = (self.folder / "tug.csv").read_text()
        self.table("tug.csv", "time,vx,vy", [[0, 0, 0], [0.5, 0, -1], [0.6, 1, -1.001]])
        done = self.run_scene(ICE, *go, name="part", code=2)
        self.assertIn("line: tow: anchor_table", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)
        (self.folder / "tug.csv").write_text(before)
        done = self.run_scene(ICE.replace("table: p.csv, periodic: true", "table: p.csv"), *go,
                              "-load_p_periodic", "false", name="part", code=2)
        self.assertIn("load: p: periodic", done.stderr)
        self.run_scene(ICE, *go, "-ts_max_steps", "200", name="part")


class Bad(TableTest):
    def refused(self, scene, part, **files):
        for name, text in files.items():
            if text is not None:
                (self.folder / f"{name}.csv").write_text(text)
        done = self.run_scene(scene, code=2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(part, done.stderr)
        self.assertFalse((self.folder / "out").exists())

    def test_files(self):
        scene = ALONE.replace(", SUPPORT", "") + LOAD
        self.refused(scene, "load: p: table: 'p.csv'")
        for text, part in (
                ("", "heading: there is none; must be time, then at least one of fx, fy"),
                ("0, 1\n1, 2\n", "heading: begins with '0'"),
                ("time\n0\n1\n", "heading: has time only"),
                ("time, fx, fq\n0, 1, 2\n1, 2, 3\n", "heading: has 'fq'"),
                ("time, fx, fx\n0, 1, 2\n1, 2, 3\n", "heading: has 'fx' twice"),
                ("time, fx\n0, 1\n", "has 1 row, must have 2 at least"),
                ("time, fx\n", "has 0 rows"),
                ("time, fx\n0, 1\n0, 2\n", "line 3: time 0 must be later"),
                ("time, fx\n1, 1\n0.5, 2\n", "line 3: time 0.5 must be later"),
                ("time, fx\n0, 1\n1, nan\n", "line 3: 'nan' is no number"),
                ("time, fx\n0, 1\n1, inf\n", "line 3: 'inf' is no number"),
                ("time, fx\n0, 1\n1\n", "line 3: has 1 values, must have 2"),
                ("time, fx\n0, 1\n1, 2, 3\n", "line 3: has 3 values, must have 2"),
                ("time, fx\n0, 1\n1, 1e19\n", "fx 1e19 must be >= -1e+18, <= 1e+18 [N]"),
                ("time, fx\n0, 0\n1, 0\n", "all its values are 0")):
            self.refused(scene, part, p=text)
        self.refused(scene.replace("p.csv", "p.csv, periodic: true"),
                     "fx of its last row, 2, must be that of its first, 1", p="time,fx\n0 1\n1 2\n")

    def test_keys_that_tables_replace(self):
        good = "time,fx\n0,1\n1,2\n"
        scene = ALONE.replace(", SUPPORT", "")
        for key in ("force: [1, 0, 0]", "moment: [1, 0, 0]", "ramp: 1"):
            self.refused(scene + LOAD.replace("p.csv", "p.csv, " + key),
                         f"load: p: {key.split(':')[0]}: does not go with 'load: p: table'", p=good)
        self.refused(scene + LOAD.replace("table: p.csv", "force: [1, 0, 0], periodic: true"),
                     "load: p: periodic")
        self.refused(scene + LOAD.replace("table: p.csv",
                                          "force: [1, 0, 0], interpolation: smooth"),
                     "load: p: interpolation")
        motion = "time,ux\n0,0\n1,2\n"
        for key in ("velocity: [1, 0, 0]", "angular_velocity: [1, 0, 0]", "amplitude: [1, 0, 0]",
                    "frequency: 1", "ramp: 1"):
            self.refused(PRESSED.replace("MOTION", "table: m.csv, " + key),
                         f"obstacle: wall: {key.split(':')[0]}: does not go with", m=motion)
        held = scene + "boundary: {names: [b], b: {set: leg, fix: x, table: m.csv, KEY}}\n"
        for key in ("velocity: [1, 0, 0]", "displacement: [1, 0, 0]", "ramp: 1",
                    "angular_velocity: [0, 0, 1]"):
            self.refused(held.replace("KEY", key),
                         f"boundary: b: {key.split(':')[0]}: does not go with", m=motion)
        self.refused(held.replace(", KEY", ""), "column of 'y', which is not in 'boundary: b: fix'",
                     m="time,ux,vy\n0,0,0\n1,2,0.1\n")
        self.refused(held.replace(", KEY", ""), "has both ux and vx",
                     m="time,ux,vx\n0,0,0\n1,2,0.1\n")
        self.refused(held.replace(", KEY", ""), "ux is 1 m at time 0, must be 0",
                     m="time,ux\n0,1\n1,2\n")
        self.refused(PRESSED.replace("MOTION", "table: m.csv"), "ux is 0.5 m at time 0, must be 0",
                     m="time,ux\n-1,0\n1,1\n")
        self.refused(ALONE.replace("SUPPORT", "table: m.csv"), "does not go with 'mass'", m=motion)
        self.refused(PRESSED.replace("box, centre: [1.48, 0, 0], size: [2, 4, 4]", "halfspace"
                                     ).replace("MOTION", "table: m.csv"), "heading: has 'rx'",
                     m="time,rx\n0,0\n1,1\n")

    def test_water_and_lines(self):
        water = ADRIFT.replace("WATER", "drag_linear: 1, current: [1, 0, 0], current_table: c.csv")
        current = "time,x\n0,0\n1,2\n"
        self.refused(water, "water: current: does not go with 'water: current_table'", c=current)
        level = ADRIFT.replace("WATER", "drag_linear: 1, level_table: l.csv")
        self.refused(level.replace("young: 1e6", "young: 1e6, friction_wet: 0.1"),
                     "contact: friction_wet: does not go with 'water: level_table'",
                     l="time,level\n0,0\n1,2\n")
        self.refused("forces: [beam, gravity, buoyancy]\nsheet: {length: 9}\n"
                     "water: {level_table: l.csv}\n", "level_table: needs 'integrator: explicit'")
        line = ADRIFT.replace("WATER", "drag_linear: 1") + (
            "line: {names: [w], w: {structure: leg, fairlead: [11, 0, 0], anchor: [40, 0, 0],\n"
            "       stiffness: 5e4, pretension: 0, HOW}}\n")
        anchor = "time,ux\n0,0\n1,2\n"
        for key in ("anchor_velocity: [1, 0, 0]", "anchor_ramp: 1"):
            self.refused(line.replace("HOW", "anchor_table: a.csv, " + key),
                         f"line: w: {key.split(':')[0]}: does not go with", a=anchor)
        self.refused(line.replace("HOW", "anchor_ramp: 1"), "line: w: anchor_ramp")

    def test_paths_of_statics(self):
        self.refused("""forces: [beam]
sheet: {length: 8, thickness: 1, element_size: 2, iterations: 10}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [p], p: {set: right, table: p.csv}}
static: {path: arc}
""", "load: p: table: does not go with 'static: path' arc", p="time,fx\n0,0\n1,1e5\n")


if __name__ == "__main__":
    unittest.main()
