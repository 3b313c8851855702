#!/usr/bin/python3
"""Models that repeat themselves: what happens across the ends is what happens in the middle."""
import re
import sys
import unittest

import h5py
import numpy as np

from launch import REPOSITORY
from scene_runs import SceneTest, last_frame

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402

# Blocks that fall upon each other on a floor that has no ends.
HEAP = """integrator: explicit
forces: [gravity, contact]
lattice_file: heap.h5
model: {periodic: [5, 4]}
contact: {young: 2e7, friction: 0.4, restitution: 0.2}
obstacle: {names: [floor], floor: {shape: halfspace, normal: [0, 0, 1]}}
initial: {names: [drift], drift: {set: all, velocity: [1.5, -1, 0]}}
time: {end: 0.8}
output: {history: 0.05}
checkpoint: {every: 1000}
"""
SHEET = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {length: 24, width: 8, element_size: 1, thickness: 0.5, iterations: 30}
water: {density: 1010}
beam: {damping_ratio: 1}
region: {names: [line], line: {box: [-1, 1, -9, 9, -9, 9]}}
load: {names: [press], press: {set: line, force: [0, 0, -2e4], ramp: 2}}
time: {end: 6}
"""
SEAM = "bonds: {gap: 1e-6, box: [-99, 99, 3.9, 4.1, -9, 9]}\n"
PERIODIC = "model: {periodic: [0, 8]}\n"


def heap(shift=(0, 0), period=(5, 4), count=60):
    """Blocks above a floor at random, none near enough to another to touch."""
    random = np.random.default_rng(4)
    places = []
    layer, grid = 0, [(i, j) for i in range(4) for j in range(4)]
    while len(places) < count:
        for i, j in grid:
            places.append([1.25 * i + 0.04 * random.normal(), j + 0.04 * random.normal(),
                           0.7 + 0.9 * layer])
        layer += 1
    places = np.array(places[:count])
    places[:, :2] += shift
    places[:, :2] -= np.floor(places[:, :2] / period) * period  # where they stand for themselves
    size = np.array([0.9, 0.5, 0.4]) * (1 + 0.1 * random.uniform(-1, 1, (count, 3)))
    lattice = fl.blocks(size, places)
    turn = 0.2 * random.normal(size=(count, 3))
    lattice.orientation = np.column_stack([np.ones(count), turn / 2])
    lattice.orientation /= np.linalg.norm(lattice.orientation, axis=1)[:, None]
    return lattice


class Periodic(SceneTest):
    def test_two_blocks_meet_across_the_end(self):
        """As two that meet in the middle, to rounding; momentum stays."""
        scene = HEAP.replace("gravity, contact", "contact").replace("-1, 0]", "0, 0]")
        scene = scene.replace("set: all", "set: first").replace("time: {end: 0.8}",
                                                                "time: {end: 0.4}")
        frames = []
        for name, place in (("middle", [[1, 2, 0], [2.2, 2.1, 0.1]]),
                            ("across", [[4.4, 2, 0], [0.6, 2.1, 0.1]]),
                            ("far", [[4.4, 3.9, 0], [0.6 - 15, 0 + 8, 0.1]])):
            pair = fl.blocks([[1, 0.8, 0.6], [1, 0.8, 0.6]], place)
            pair.sets = {"first": [0]}
            pair.write(self.folder / "heap.h5")
            self.run_scene(scene.replace("obstacle: {names: [floor], floor: {shape: halfspace, "
                                         "normal: [0, 0, 1]}}\n", ""), name=name)
            frames.append(last_frame(self.folder / "out" / name))
        for other in frames[1:]:
            for key in ("bodies_displacement", "bodies_rotation"):
                np.testing.assert_allclose(other[key], frames[0][key], rtol=0, atol=1e-9)
        move = frames[0]["bodies_displacement"]
        self.assertGreater(move[1, 0], 0.1)  # they met
        self.assertAlmostEqual(move[:, 0].sum(), 1.5 * 0.4, delta=1e-9)

    def test_a_heap_is_the_same_wherever_its_ends_are(self):
        """On ranks and after a restart bit for bit; with other ends until round-off has grown."""
        heap().write(self.folder / "heap.h5")
        one = self.same_on_ranks_and_after_a_restart(HEAP)
        heap(shift=(2.3, 1.7)).write(self.folder / "heap.h5")
        self.run_scene(HEAP, name="moved")
        moved = last_frame(self.folder / "out/moved")
        np.testing.assert_allclose(moved["bodies_displacement"], one["bodies_displacement"],
                                   rtol=0, atol=1e-6)
        rows = self.rows("one")
        self.assertGreater(rows["contacts"].max(), 40)
        fell = rows["energy_kinetic"][0] + np.ptp(rows["energy_gravity"])
        self.assertLess(np.abs(rows["energy_balance_error"]).max(), 1e-3 * fell)
        # Without images blocks at the ends have no neighbours.
        self.run_scene(HEAP.replace("model: {periodic: [5, 4]}\n", ""), name="alone")
        alone = last_frame(self.folder / "out/alone")
        apart = alone["bodies_displacement"] - moved["bodies_displacement"]
        self.assertGreater(np.abs(apart).max(), 0.05)

    def test_a_sheet_without_sides(self):
        """Bonds across the seam make a sheet that a load on a line bends as a strip of plane
        strain: no point of the line is apart from others, and nothing bends across."""
        self.run_scene(SHEET + PERIODIC + SEAM, name="endless")
        self.run_scene(SHEET, name="sides")
        dips = {}
        for name in ("endless", "sides"):
            frame = last_frame(self.folder / "out" / name)
            with h5py.File(self.folder / f"out/{name}/lattice.h5") as file:
                x = file["bodies/position"][:]
            near = np.abs(x[:, 0]) < 1.2
            z, y = frame["bodies_displacement"][near, 2], x[near, 1]
            edge = np.abs(y) > 3
            dips[name] = (z.mean(), z[edge].mean() - z[~edge].mean())
        self.assertLess(dips["endless"][0], -0.01)
        self.assertLess(abs(dips["endless"][1]), 0.01 * abs(dips["endless"][0]))
        self.assertGreater(abs(dips["sides"][1]), 2 * abs(dips["endless"][1]))
        self.assertLess(abs(dips["endless"][0]), abs(dips["sides"][0]))  # stiffer: E/(1 - nu^2)
        bonds = self.summary("endless")["bonds"]
        self.assertAlmostEqual(bonds["area"], 24 * 0.5, delta=1e-4)

    def test_a_periodic_sheet(self):
        """`sheet: periodic` does the same with its own mesh, from any seam: the line dips as one,
        as deep as with bonds across the seam; beams broken there break as elsewhere."""
        width = float(re.search(r"width: ([0-9.]+)", SHEET)[1])
        whole = SHEET.replace("sheet: {", "sheet: {periodic: true, ")
        self.run_scene(whole, name="wraps")
        self.run_scene(SHEET + PERIODIC + SEAM, name="bonded")
        dip = {}
        for name in ("wraps", "bonded"):
            frame = last_frame(self.folder / "out" / name)
            with h5py.File(self.folder / f"out/{name}/lattice.h5") as file:
                at, image = file["bodies/position"][:], file["beams/image"][:]
            near = np.abs(at[:, 0]) < 1.2
            z = frame["bodies_displacement"][near, 2]
            dip[name] = (z.mean(), np.ptp(z))
            self.assertEqual(set(np.unique(image[:, 1])), {-width, 0, width})
        self.assertLess(dip["wraps"][1], 0.15 * abs(dip["wraps"][0]))  # cells are not on one line
        self.assertAlmostEqual(dip["wraps"][0] / dip["bonded"][0], 1, delta=0.05)

    def test_refusals(self):
        heap().write(self.folder / "heap.h5")
        for scene, part in (
                (HEAP.replace("[5, 4]", "[2, 4]"), "model: periodic: 2 must be >= "),
                (HEAP.replace("normal: [0, 0, 1]", "normal: [0, 1, 1]"),
                 "obstacle: floor: normal: has a part along y, after which the model repeats"),
                (SHEET + PERIODIC, "model: periodic: would have no effect"),
                (SHEET.replace("explicit", "quasistatic").replace("time: {end: 6}\n", "")
                 .replace("beam: {damping_ratio: 1}\n", "") + PERIODIC + SEAM,
                 "model: periodic: needs 'integrator' explicit or implicit"),
                (HEAP.replace("[5, 4]", "[5, -4]"), "model: periodic"),
                (SHEET.replace("sheet: {", "sheet: {periodic: true, mesh_file: m.h5, "),
                 "sheet: mesh_file: does not go with 'sheet: periodic'"),
                (SHEET.replace("sheet: {", "sheet: {periodic: true, thickness_deviation: 0.1, "
                               "thickness_correlation: [2, 2], "),
                 "sheet: thickness_deviation: does not go with 'sheet: periodic'"),
                (SHEET.replace("sheet: {", "sheet: {periodic: true, ")
                 + "cut: {names: [c], c: {from: [0, -9], to: [0, 9]}}\n",
                 "cut: c: does not go with 'sheet: periodic'"),
                (SHEET.replace("sheet: {", "sheet: {periodic: true, ")
                 + "model: {periodic: [0, 7]}\n",
                 "model: periodic: 7 along y must be sheet: width")):
            done = self.run_scene(scene, code=2)
            self.assertIn(part, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


if __name__ == "__main__":
    unittest.main()
