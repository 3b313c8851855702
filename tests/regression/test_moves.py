#!/usr/bin/python3
"""Bodies that move between ranks: no state depends on it, restarts are bit for bit, nothing leaks.

The sheet breaks against a slope, so that beams, water, contacts, crushing and breaks all have a
history when bodies move. The step is given, since a stable one is a sum over ranks.
"""
import functools
import json
import unittest

import numpy as np

import launch
from launch import FULL, temporary_folder
from test_restart import Killing, RestartTest, contents

SCENE = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 12, width: 8, thickness: 0.5, element_size: 1.5, iterations: 10}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 3e5, shear_strength: 3e5, energy: 15}
water: {drag_coefficient: 1, drag_linear: 200}
contact: {young: 1e8, friction: 0.2, restitution: 0.3, plastic_limit: 1e6}
obstacle:
  names: [slope]
  slope: {shape: halfspace, point: [6.02, 0, -0.4554], normal: [-1, 0, 1], friction: 0.1}
boundary: {names: [push], push: {set: left, fix: x y rz, velocity: [1, 0, 0], ramp: 0.1}}
time: {end: 0.42, dt: 2e-4}
output: {history: 0.0101, fields: 0.037}
checkpoint: {every: 1000}
"""
NEVER = ("-partition_threshold", "1e9")
OFTEN = ("-partition_threshold", "1", "-partition_every", "37")


def in_order(key, values):
    """The cracks of a checkpoint by beam, and pairs released in one step: they are kept rank after
    rank."""
    numbers = {"cracks": 12, "released": 2}.get(key.split("/")[-1])
    if numbers is None:
        return values
    rows = values.reshape(-1, numbers)
    return rows[np.lexsort(rows.T[::-1])]


class Moves(RestartTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = temporary_folder(cls.addClassCleanup)
        (cls.made / "scene.yaml").write_text(SCENE)

    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(SCENE)

    @classmethod
    @functools.cache
    def whole(cls, *options, ranks=1):
        """The folder of a run in one piece, made once for all cases."""
        dir = f"run{len(list(cls.made.iterdir()))}"
        done = launch.run("scene.yaml", *options, "-output_dir", dir, ranks=ranks, cwd=cls.made)
        assert done.returncode == 0, done.stderr
        return cls.made / dir

    def moves(self, folder):
        return json.loads((folder / "summary.json").read_text()).get("moves", {"count": 0})

    def same_states(self, a, b):
        """Frames and what checkpoints keep of bodies and forces, bit for bit; sums over ranks to
        rounding."""
        names = sorted(path.name for path in a.glob("fields/*.h5"))
        self.assertEqual(names, sorted(path.name for path in b.glob("fields/*.h5")))
        for name in names:
            first, second = contents(a / "fields" / name), contents(b / "fields" / name)
            self.assertEqual(set(first), set(second))
            for key, values in first.items():
                np.testing.assert_array_equal(values, second[key], f"{name}: {key}")
        first, second = contents(a / "checkpoint.h5"), contents(b / "checkpoint.h5")
        sums = ("energy_fracture", "stored_at_start", "impulse", "peak", "mean")
        for key, values in first.items():
            kind = key.split("/")[-1]
            if key == "bodies/records" or (key.startswith("force_") and
                                           not any(s in kind for s in sums)):
                np.testing.assert_array_equal(in_order(key, values), in_order(key, second[key]),
                                              key)
        for key, values in contents(a / "breaks.h5").items():
            np.testing.assert_array_equal(values, contents(b / "breaks.h5")[key], key)
        tables = [np.loadtxt(f / "history.csv", delimiter=",", skiprows=1) for f in (a, b)]
        heads = [(f / "history.csv").read_text().split("\n")[0] for f in (a, b)]
        self.assertEqual(*heads)
        self.assertEqual(tables[0].shape, tables[1].shape)
        for name, one, two in zip(heads[0].split(","), tables[0].T, tables[1].T):
            scale = 1e-9 * max(np.max(np.abs(one)), 1)
            np.testing.assert_allclose(two, one, rtol=1e-9, atol=scale, err_msg=name)

    def test_no_state_depends_on_moves_or_ranks(self):
        alone = self.whole()
        self.assertGreater(json.loads((alone / "summary.json").read_text())["beams_broken"], 5)
        self.assertNotIn("moves", json.loads((alone / "summary.json").read_text()))
        for ranks in (2, 3):
            moved = self.whole(*OFTEN, ranks=ranks)
            self.assertEqual(self.moves(moved)["count"], 2100 // 37)
            self.same_states(alone, moved)
            if ranks == 2 or FULL:
                still = self.run_whole(*NEVER, dir=f"n{ranks}", ranks=ranks)
                self.assertEqual(self.moves(still)["count"], 0)
                self.same_states(alone, still)

    def test_a_run_is_repeated(self):
        """Counts decide on moves, no clock, so sums over ranks have the same bits too."""
        self.assert_same(self.whole(*OFTEN, ranks=2),
                         self.run_whole(*OFTEN, dir=self.whole(*OFTEN, ranks=2).name, ranks=2))

    def test_a_restart_finds_the_bodies_where_they_were(self):
        """Stopped just before a look, at it, after it; history and ledger bit for bit."""
        a = self.whole(*OFTEN, ranks=2)
        resume = []
        for step in (36, 37, 38, 1110, 1999):
            self.run_whole(*OFTEN, "-ts_max_steps", str(step), *resume, dir="b", ranks=2)
            resume = ["-checkpoint_restart", "b/checkpoint.h5"]
        b = self.go_on(*OFTEN, dir="b", ranks=2)
        rows = set((b / "history.csv").read_text().split("\n"))  # and one at the end of each part
        for row in (a / "history.csv").read_text().split("\n"):
            self.assertTrue(row in rows, row)
        first, second = contents(a / "checkpoint.h5"), contents(b / "checkpoint.h5")
        for key in set(first) - {"options", "output/run", "output/rows", "output/frames"}:
            if not key.startswith("output/"):
                np.testing.assert_array_equal(first[key], second[key], key)
        self.assertEqual(self.moves(a), self.moves(b))

    def test_on_another_number_of_ranks(self):
        alone = self.whole()
        for before, after in ((2, 3), (3, 1), (1, 2)):
            dir = f"b{before}{after}"
            self.run_whole(*OFTEN, "-ts_max_steps", "1500", dir=dir, ranks=before)
            b = self.go_on(*OFTEN, dir=dir, ranks=after)
            first, second = contents(alone / "checkpoint.h5"), contents(b / "checkpoint.h5")
            for key in ("bodies/records", "force_0_beam/cracks", "force_4_contact/pairs"):
                np.testing.assert_array_equal(in_order(key, first[key]),
                                              in_order(key, second[key]), key)

    def test_threshold(self):
        """Above it bodies move when the wait has cost as much as a move, which is seldom."""
        seldom = self.moves(self.run_whole("-partition_every", "1", dir="a", ranks=2))
        self.assertLess(seldom["count"], 10)
        moved = self.moves(self.whole(*OFTEN, ranks=2))
        self.assertLess(moved["load_after"], 1.1)
        said = self.finish(self.begin("-partition_threshold", "0.9"), 2)
        self.assertIn("partition: threshold: 0.9 must be a number >= 1, <= 1e9", said)
        said = self.finish(self.begin("-forces", "beam,gravity,buoyancy", "-partition_every", "3"),
                           2)
        self.assertIn("partition", said)

    def test_memory_does_not_grow(self):
        """Each move frees what it has replaced: hundreds more of them take no more memory."""
        end, moves, megabytes = ("0.2", 490, 10) if FULL else ("0.1", 245, 5)
        few, many = (self.run_whole("-partition_threshold", "1", "-partition_every", every,
                                    "-time_end", end, dir=every, ranks=2)
                     for every in ("100", "2"))
        self.assertEqual(self.moves(many)["count"] - self.moves(few)["count"], moves)
        sizes = [json.loads((f / "summary.json").read_text())["peak_memory_mb"]
                 for f in (few, many)]
        self.assertLess(sizes[1] - sizes[0], megabytes)


class Killed(Killing):
    def test_near_moves(self):
        (self.folder / "scene.yaml").write_text(
            SCENE.replace("velocity: [1, 0, 0]", "velocity: [0.2, 0, 0]")
            + "partition: {threshold: 1, every: 20}\nlimit: {energy_error: 1}\n")
        self.check_killed(2)


if __name__ == "__main__":
    unittest.main()
