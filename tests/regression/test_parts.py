#!/usr/bin/python3
"""Obstacles and structures of several convex parts."""
import sys
import unittest

import h5py
import numpy as np
from scipy.spatial import ConvexHull

from launch import REPOSITORY
from scene_runs import SceneTest, rows_of
from test_restart import contents
from test_structures import ICE as STRUCTURE_ICE
from test_structures import SOFT

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402
from floe.results.obstacles import obstacles_of_run  # noqa: E402
from floe.results.output import Output  # noqa: E402

# A loose block that is dropped on a step, with a spin; it slides over the step's parts.
DROP = """integrator: explicit
forces: [gravity, contact]
lattice_file: block.h5
contact: {young: 1e7, friction: 0.2, restitution: 0.4, law: LAW}
obstacle:
OBSTACLES
initial: {names: [kick], kick: {set: all, velocity: [1.5, 0.4, 0], angular_velocity: [0.3, 0.2, 1]}}
time: {end: 0.6}
output: {history: 0.01}
"""
WHOLE = """  names: [step]
  step: {shape: box, centre: [0, 0, -1], size: [6, 3, 2], friction: 0.1}"""
PARTS = """  names: [b, step, c, d]
  step: {shape: box, centre: [-2, 0, -1], size: [2, 3, 2], friction: 0.1}
  b: {shape: box, centre: [0, 0, -1.5], size: [2, 3, 1], part_of: step}
  c: {shape: box, centre: [0, 0, -0.5], size: [2, 3, 1], part_of: step}
  d: {shape: box, centre: [2, 0, -1], size: [2, 3, 2], part_of: step}"""
# Ice that drives against a leg of three parts, breaks and slides past.
ICE = STRUCTURE_ICE.replace("""  names: [leg]
  leg: {shape: cylinder, base: [7.6, 0, -3], radius: 1.5, height: 5, friction: 0.1, LEG}
""", """  names: [leg, toe, top]
  leg: {shape: box, centre: [7.5, 0, 0], size: [2, 2, 2], friction: 0.1, LEG}
  toe: {shape: cone, base: [7.5, 0, -3], radius: 2, top_radius: 1, height: 2, part_of: leg}
  top: {shape: box, centre: [7.5, 0, 1.5], size: [3, 3, 1], part_of: leg}
""")
assert "part_of" in ICE


def write_hulls(path, parts):
    """Writes the hulls of several lists of points as /shapes, in triangles."""
    vertices, corners, vertex_of, face_of = [], [], [0], [0]
    for points in parts:
        points = np.unique(np.round(points, 12), axis=0)
        hull = ConvexHull(points)
        middle = points.mean(axis=0)
        for a, b, c in hull.simplices:
            normal = np.cross(points[b] - points[a], points[c] - points[a])
            if normal @ (points[a] - middle) < 0:
                b, c = c, b
            corners += [len(vertices) + k for k in (a, b, c)]
        vertices += list(points)
        vertex_of.append(len(vertices))
        face_of.append(len(corners) // 3)
    with h5py.File(path, "w") as file:
        for name, values in (("vertices", np.array(vertices)), ("corners", corners),
                             ("corner_of", 3 * np.arange(len(corners) // 3 + 1)),
                             ("face_of", face_of), ("vertex_of", vertex_of)):
            dtype = float if name == "vertices" else np.int32
            file["shapes/" + name] = np.asarray(values, dtype)


def bowl(facets=12, rings=4, inside=2.0, thick=0.4):
    """A bowl as the convex parts between two spheres, below z = 0: points of each."""
    found = []
    angle = 2 * np.pi * np.arange(facets + 1) / facets
    dip = np.linspace(0, np.pi / 2, rings + 1)

    def point(radius, k, m):
        return radius * np.array([np.cos(dip[m]) * np.cos(angle[k]),
                                  np.cos(dip[m]) * np.sin(angle[k]), -np.sin(dip[m])])
    for k in range(facets):
        for m in range(rings):
            found.append([point(r, k + i, m + j) for r in (inside, inside + thick)
                          for i in (0, 1) for j in (0, 1)])
    return found


class WholeAndParts(SceneTest):
    def setUp(self):
        super().setUp()
        fl.blocks(np.array([[1.0, 0.7, 0.5]]), np.array([[-1.6, 0, 0.4]])).write(
            self.folder / "block.h5")

    def test_a_step_cut_into_parts_is_the_step(self):
        """Columns of history.csv of a box and of the box in parts: to 1e-8 of the largest force, to
        which rounding grows in impacts."""
        for law in ("overlap", "potential"):
            scene = DROP.replace("LAW", law)
            rows = []
            for name, obstacles in (("whole", WHOLE), ("parts", PARTS)):
                self.run_scene(scene.replace("OBSTACLES", obstacles), name=name)
                rows.append(rows_of(self.folder / "out" / name))
            whole, parts = rows
            self.assertEqual(set(whole), set(parts))
            most = np.abs(whole["step_peak_force_z"]).max()
            self.assertGreater(most, 1e3)
            for axis in "xyz":
                np.testing.assert_allclose(parts[f"step_mean_force_{axis}"],
                                           whole[f"step_mean_force_{axis}"], atol=1e-8 * most)
            np.testing.assert_array_equal(parts["contacts"], whole["contacts"])
            for column in ("energy_contact", "energy_friction", "energy_contact_viscous"):
                np.testing.assert_allclose(parts[column], whole[column],
                                           atol=1e-7 * np.abs(whole[column]).max())

    def test_lattice_file_and_tools_have_the_parts(self):
        self.run_scene(DROP.replace("LAW", "overlap").replace("OBSTACLES", PARTS)
                       .replace("end: 0.6", "end: 0.01"), name="parts")
        output = Output(self.folder / "out/parts")
        obstacle, = obstacles_of_run(output, np.zeros(3), np.ones(3), [0.0])
        points = np.array(obstacle["points"])
        self.assertEqual(len(points), 32)
        self.assertEqual(len(obstacle["faces"]), 24)
        np.testing.assert_allclose(points.min(axis=0), [-3, -1.5, -2], atol=1e-12)
        np.testing.assert_allclose(points.max(axis=0), [3, 1.5, 0], atol=1e-12)

    def test_refusals(self):
        for part, line in (
                ("b: {shape: box, centre: [0.1, 0, -1.5], size: [2, 3, 1], part_of: step}",
                 "obstacle: step: its parts 'b' and 'd' overlap by 0.3 m^3; parts may meet at "
                 "faces, not overlap"),
                ("b: {shape: box, part_of: leg}",
                 "obstacle: b: part_of: there is no obstacle 'leg' of its own (there are step)"),
                ("b: {shape: box, part_of: c}", "obstacle: b: part_of: there is no obstacle 'c'"),
                ("b: {shape: halfspace, part_of: step}",
                 "obstacle: b: part_of: a halfspace has no parts and is none"),
                ("b: {shape: box, part_of: step, friction: 0.1}",
                 "obstacle: b: friction: belongs to 'step', of which it is a part"),
                ("b: {shape: box, part_of: step, velocity: [1, 0, 0]}",
                 "obstacle: b: velocity: belongs to 'step', of which it is a part"),
                ("b: {shape: box, part_of: step, mass: 3}",
                 "obstacle: b: mass: belongs to 'step', of which it is a part")):
            lines = PARTS.splitlines()
            lines[2] = "  " + part
            scene = DROP.replace("LAW", "overlap").replace("OBSTACLES", "\n".join(lines))
            done = self.run_scene(scene, code=2)
            self.assertIn(line, done.stderr)
            self.assertFalse((self.folder / "out").exists())


class Bowl(SceneTest):
    def test_a_ball_stays_in_a_bowl(self):
        """A block that slides in a bowl of 48 parts comes to rest near its lowest point, and the
        bowl bears its weight."""
        write_hulls(self.folder / "bowl.h5", bowl())
        fl.blocks(np.array([[0.5, 0.5, 0.5]]), np.array([[0.9, 0, -0.9]])).write(
            self.folder / "ball.h5")
        self.run_scene("""integrator: explicit
forces: [gravity, contact]
lattice_file: ball.h5
contact: {young: 1e7, friction: 0.05, restitution: 0.2}
obstacle:
  names: [bowl]
  bowl: {shape: file, file: bowl.h5}
time: {end: 12}
output: {history: 0.02, fields: 12}
""", name="bowl")
        rows = rows_of(self.folder / "out/bowl")
        output = Output(self.folder / "out/bowl")
        end = output.position[0] + output.field("bodies_displacement", 12.0)[0]
        self.assertLess(np.hypot(end[0], end[1]), 0.35)
        weight = 9.81 * output.mass[0]
        late = rows["time"] > 11
        self.assertAlmostEqual(-rows["bowl_force_z"][late].mean() / weight, 1, delta=0.02)


# Loose blocks that tumble on a step.
TUMBLE = """integrator: explicit
forces: [gravity, contact]
lattice_file: LATTICE
contact: {young: 1e7, friction: 0.2, restitution: 0.4}
obstacle:
  names: [step]
  step: {shape: box, centre: [0, 0, -1], size: [6, 3, 2], friction: 0.1}
initial: {names: [kick], kick: {set: all, velocity: [0.5, 0.2, 0], angular_velocity: [0.3, 1, 1]}}
time: {end: 1, dt: 2e-4}
output: {history: 0.02}
checkpoint: {every: 1000}
"""


class Bodies(SceneTest):
    """Bodies of a lattice that have several convex parts."""

    def setUp(self):
        super().setUp()
        whole = fl.blocks(np.array([[2, 1, 0.5], [1, 1, 1]]),
                          np.array([[0, 0, 0.4], [0.3, 0, 1.3]]))
        halves = fl.blocks(
            np.array([[1, 1, 0.5], [1, 1, 0.5], [1, 1, 0.5], [1, 0.5, 0.5], [1, 0.5, 0.5]]),
            np.array([[-0.5, 0, 0.4], [0.5, 0, 0.4], [0.3, 0, 1.05], [0.3, 0.25, 1.55],
                      [0.3, -0.25, 1.55]]))
        whole.write(self.folder / "whole.h5")
        fl.joined(halves, [[0, 1], [2, 3, 4]]).write(self.folder / "parts.h5")

    def test_of_parts_as_in_one_piece(self):
        """Blocks of parts fall on each other and on a step as those in one piece do; on two ranks
        and after a stop bit for bit."""
        rows = {}
        for name in ("whole", "parts"):
            self.run_scene(TUMBLE.replace("LATTICE", f"{name}.h5"), name=name)
            rows[name] = rows_of(self.folder / f"out/{name}")
        early = rows["whole"]["time"] < 0.4  # later rounding has grown over impacts on corners
        for column in ("step_force_z", "step_moment_y", "energy_kinetic", "energy_contact",
                       "energy_friction"):
            size = np.max(np.abs(rows["whole"][column]))
            self.assertGreater(size, 1e-3)
            np.testing.assert_allclose(rows["parts"][column][early], rows["whole"][column][early],
                                       atol=1e-7 * size, err_msg=column)
        scene = TUMBLE.replace("LATTICE", "parts.h5")
        self.run_scene(scene, name="two", ranks=2)
        self.run_scene(scene, "-ts_max_steps", "1777", name="part")
        self.run_scene(scene, "-checkpoint_restart", "out/part/checkpoint.h5", name="part")
        one = contents(self.folder / "out/parts/checkpoint.h5")
        self.assertGreater(len(one["force_1_contact/pairs"]), 0)
        for name in ("two", "part"):
            other = contents(self.folder / f"out/{name}/checkpoint.h5")
            for key in ("bodies/records", "force_1_contact/pairs"):
                np.testing.assert_array_equal(one[key], other[key], f"{name} {key}")

    def test_beams_keep_them_apart(self):
        """A body of parts that a beam joins to another does not touch it; once it has broken, it
        does."""
        lattice = fl.read(self.folder / "parts.h5")
        lattice.position[:, 2] = [0.25, 0.95]  # the upper block reaches 5 cm into the lower one
        lattice.bodies, lattice.axis_y = np.array([[0, 1]]), np.array([[0.0, 1, 0]])
        length = np.linalg.norm(np.diff(lattice.position, axis=0), axis=1)
        lattice.beam = {"length": length,
                        **fl.Section(1, 1, young=1e7, poisson=0.3).scalars(length)}
        lattice.write(self.folder / "joined.h5")
        scene = (TUMBLE.replace("LATTICE", "joined.h5").replace("[gravity, ", "[beam, ")
                 .replace("[0.5, 0.2, 0], angular_velocity: [0.3, 1, 1]", "[0, 0, 1]")
                 .replace("end: 1,", "end: 0.1,"))
        self.run_scene(scene, name="joined")
        rows = rows_of(self.folder / "out/joined")
        self.assertEqual(np.max(rows["contacts"]), 0)
        self.run_scene(scene.replace("[beam, ", "[").replace("young: 1e7", "young: 1e7, "
                       "initial_overlap: stress_free"), name="loose")
        self.assertEqual(rows_of(self.folder / "out/loose")["contacts"][-1], 1)

    def test_a_floe_of_parts_floats_as_the_structure(self):
        """An angle of two parts that floats: as a structure of the same parts does, its drag by
        the plan area of both."""
        parts = fl.blocks(np.array([[3.0, 1, 0.5], [1, 2, 0.5], [2.8, 0.9, 0.1]]),
                          np.array([[0, 0, 0], [-1, 1.5, 0], [0, 0, 0.3]]))
        fl.joined(parts, [[0, 1, 2]]).write(self.folder / "angle.h5")
        self.run_scene("""integrator: explicit
forces: [gravity, buoyancy, drag, contact]
lattice_file: angle.h5
contact: {young: 1e6}
water: {drag_linear: 300, current: [0.5, 0.2, 0]}
obstacle:
  names: [twin, leg, lid]
  twin: {shape: box, centre: [0, 20, 0], size: [3, 1, 0.5], mass: MASS, floats: true}
  leg: {shape: box, centre: [-1, 21.5, 0], size: [1, 2, 0.5], part_of: twin}
  lid: {shape: box, centre: [0, 20, 0.3], size: [2.8, 0.9, 0.1], part_of: twin}
time: {end: 3, dt: 1e-3}
output: {history: 0.02, fields: 3}
""".replace("MASS", repr(float(parts.mass.sum()))), name="angle")
        output = Output(self.folder / "out/angle")
        ice, twin = output.field("bodies_displacement", 3)
        self.assertGreater(np.linalg.norm(ice[:2]), 0.1)
        np.testing.assert_allclose(twin, ice, atol=1e-9)
        # c A V_wet/V over m, A the 5 m^2 of the first two parts: the lid lies above them
        rate = 300 * 5 * 920 / 1010 / parts.mass.sum()
        way = np.array([0.5, 0.2]) * (3 - (1 - np.exp(-3 * rate)) / rate)
        np.testing.assert_allclose(ice[:2], way, rtol=0.05)  # it sinks to its draft first

    def test_refusals(self):
        lattice = fl.read(self.folder / "parts.h5")
        lattice.shapes.vertices[:8] += [0.1, 0, 0]  # the centroid stays
        lattice.shapes.vertices[8:16] -= [0.1, 0, 0]
        plus = fl.blocks([[1, 1, 0.5]], [[0, 0, 2]])
        plan = [[1, 1], [1, 3], [-1, 3], [-1, 1], [-3, 1], [-3, -1], [-1, -1], [-1, -3], [1, -3],
                [1, -1], [3, -1], [3, 1]]
        plus.shapes = fl.Shapes.prisms([np.array(plan) / 6], [0.5])
        for bad, line in ((lattice, "parts of body 0 of the lattice overlap"),
                          (plus, "body 0 of the lattice is not convex, or a face of it is not "
                                 "plane")):
            bad.write(self.folder / "bad.h5")
            if bad is lattice:
                scene = TUMBLE.replace("LATTICE", "bad.h5").replace("contact]", "drag, contact]")
                done = self.run_scene(scene + "water: {drag: faces, shelter: 0}\n", code=2)
                self.assertIn("water: drag: faces is for convex bodies; body 0 of 'bad.h5' has 2 "
                              "parts", done.stderr)
            done = self.run_scene(TUMBLE.replace("LATTICE", "bad.h5"), code=2)
            self.assertIn(line, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


class Structure(SceneTest):
    def test_ranks_and_restarts(self):
        """Breaking ice against a leg of parts, fixed and on springs: the same bits on two ranks and
        after a stop."""
        for kind, leg in (("fixed", ""), ("moving", SOFT)):
            scene = ICE.replace(", LEG" if not leg else "LEG", leg)
            self.run_scene(scene, name="one")
            self.run_scene(scene, name="two", ranks=2)
            self.run_scene(scene, "-ts_max_steps", "3111", name="part")
            self.run_scene(scene, "-checkpoint_restart", "out/part/checkpoint.h5", name="part")
            one = contents(self.folder / "out/one/checkpoint.h5")
            rows = rows_of(self.folder / "out/one")
            self.assertGreater(rows["beams_broken"][-1], 3)
            contact, = {key.split("/")[0] for key in one if key.endswith("contact/pairs")}
            for name in ("two", "part"):
                other = contents(self.folder / f"out/{name}/checkpoint.h5")
                for key in ("bodies/records", f"{contact}/pairs"):
                    np.testing.assert_array_equal(one[key], other[key], f"{kind} {name} {key}")

    def test_mass_and_water_of_parts(self):
        """A floating box of three parts heaves as the box does, to 1e-9."""
        fl.blocks(np.array([[1.0, 1, 1]]), np.array([[50.0, 0, 0]])).write(
            self.folder / "block.h5")
        scene = """integrator: explicit
forces: [gravity, buoyancy, contact]
lattice_file: block.h5
contact: {young: 1e6}
obstacle:
OBSTACLES
initial: {names: [kick], kick: {set: hull, velocity: [0, 0, 0.4], angular_velocity: [0.1, 0, 0]}}
time: {end: 3, dt: 1e-3}
output: {history: 0.01}
"""
        whole = """  names: [hull]
  hull: {shape: box, centre: [0, 0, 0], size: [6, 3, 2], mass: 18000, floats: true}"""
        parts = """  names: [hull, b, c]
  hull: {shape: box, centre: [-2, 0, 0], size: [2, 3, 2], mass: 18000, floats: true}
  b: {shape: box, centre: [1, 0, -0.5], size: [4, 3, 1], part_of: hull}
  c: {shape: box, centre: [1, 0, 0.5], size: [4, 3, 1], part_of: hull}"""
        rows = []
        for name, obstacles in (("whole", whole), ("parts", parts)):
            self.run_scene(scene.replace("OBSTACLES", obstacles), name=name)
            rows.append(rows_of(self.folder / "out" / name))
        self.assertGreater(np.ptp(rows[0]["hull_z"]), 0.1)
        for column in ("hull_x", "hull_z", "hull_rx", "hull_ry"):
            np.testing.assert_allclose(rows[1][column], rows[0][column], atol=1e-9)


if __name__ == "__main__":
    unittest.main()
