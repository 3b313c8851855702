#!/usr/bin/python3
"""Forces on patches of obstacles (output: pressure)."""
import sys
import unittest

import numpy as np
import pandas as pd

from launch import REPOSITORY
from scene_runs import SceneTest, rows_of
from test_parts import ICE, SOFT

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402
from floe.results.output import Lattice  # noqa: E402

REST = """integrator: explicit
forces: [gravity, contact]
lattice_file: block.h5
contact: {young: 1e7, friction: 0.2, restitution: 0.2}
obstacle:
OBSTACLES
time: {end: 1}
output: {history: 0.25, pressure: 0.25, pressure_patch: 0.4}
"""
TABLE = """  names: [table]
  table: {shape: box, centre: [0, 0, -0.5], size: [3, 2, 1]}"""
TWO = """  names: [table, b]
  table: {shape: box, centre: [-1, 0, -0.5], size: [1, 2, 1]}
  b: {shape: box, centre: [0.5, 0, -0.5], size: [2, 2, 1], part_of: table}"""


def pressures(folder):
    return pd.read_csv(folder / "pressure.csv", dtype={"patch": str})


class PressureTest(SceneTest):
    def check_sums(self, name, obstacle, largest):
        """The sum over patches is the obstacle's force, which is that of history.csv."""
        folder = self.folder / "out" / name
        table = pressures(folder)
        table = table[table.obstacle == obstacle]
        axes = ["force_x", "force_y", "force_z"]
        whole = table[table.patch == "all"].set_index("time")[axes]
        sums = table[table.patch != "all"].groupby("time")[axes].sum()
        sums = sums.reindex(whole.index, fill_value=0)
        self.assertGreater(np.abs(whole.to_numpy()).max(), largest)
        np.testing.assert_allclose(sums, whole, rtol=1e-12, atol=1e-12 * np.abs(whole).max().max())
        history = rows_of(folder)
        at = np.searchsorted(history["time"], whole.index.to_numpy() - 1e-9)
        for axis in "xyz":
            np.testing.assert_allclose(history[f"{obstacle}_force_{axis}"][at],
                                       whole[f"force_{axis}"], rtol=1e-9, atol=1e-6)
        return table, whole


class Rest(PressureTest):
    def test_a_block_on_a_table(self):
        """Each patch bears the part of the weight that its area under the block is of the block's,
        also where the table is of two parts."""
        fl.blocks(np.array([[1.0, 0.7, 0.5]]), np.array([[0.13, 0.21, 0.249]])).write(
            self.folder / "block.h5")
        for name, obstacles, origin in (("one", TABLE, 0.0), ("two", TWO, -1.0)):
            self.run_scene(REST.replace("OBSTACLES", obstacles), name=name)
            table, _ = self.check_sums(name, "table", 3e3)
            shape = Lattice(self.folder / f"out/{name}/lattice.h5").obstacles["table"]
            centre, area = shape["patch_centre"], shape["patch_area"]
            np.testing.assert_allclose(np.linalg.norm(shape["patch_normal"], axis=1), 1)
            self.assertAlmostEqual(area.sum(), 2 * (3 * 2 + 3 * 1 + 2 * 1), places=9)
            at_end = table[(table.time == table.time.max()) & (table.patch != "all")]
            weight = 920 * 0.35 * 9.81
            self.assertAlmostEqual(-at_end.force_z.sum() / weight, 1, delta=0.01)
            under = 0
            for row in at_end.itertuples():
                x, y, z = centre[int(row.patch)]
                self.assertAlmostEqual(z, 0)
                start = np.array([origin, 0]) - 0.2  # middle of a square
                low = start + np.floor((np.array([x, y]) - start) / 0.4) * 0.4
                high = np.minimum(low + 0.4, [1.5, 1.0])
                low = np.maximum(low, [-1.5, -1.0])
                common = (np.minimum(high, [0.63, 0.56]) - np.maximum(low, [-0.37, -0.14])).prod()
                self.assertAlmostEqual(row.force_z / at_end.force_z.sum(), common / 0.7, delta=2e-3)
                under += common
            self.assertAlmostEqual(under, 0.7, places=9)

    def test_refusals(self):
        fl.blocks(np.array([[1.0, 0.7, 0.5]]), np.array([[0, 0, 0.3]])).write(
            self.folder / "block.h5")
        scene = REST.replace("OBSTACLES", TABLE)
        for text, line in (
                (scene.replace("pressure_patch: 0.4", "pressure_patch: 1e-3"),
                 "output: pressure_patch: 0.001 [m] makes more than 1e+06 patches on obstacle "
                 "'table'"),
                (scene.replace(TABLE, "  names: [floor]\n  floor: {shape: halfspace}"),
                 "output: pressure: needs an obstacle that is no halfspace, on which it is"),
                (scene.replace(TABLE, "  names: []"), "output: pressure: needs an obstacle"),
                (scene.replace("pressure: 0.25, ", ""), "output: pressure_patch")):
            done = self.run_scene(text, code=2)
            self.assertIn(line, done.stderr)
            self.assertFalse((self.folder / "out").exists())


class BreakingIce(PressureTest):
    def test_sums_ranks_and_restarts(self):
        """Ice that breaks on a fixed leg and on one on springs: sums; the same on two ranks, and
        after a stop the same file."""
        for leg in ("", SOFT):
            scene = (ICE.replace(", LEG" if not leg else "LEG", leg)
                     .replace("history: 0.02,", "history: 0.02, pressure: 0.04,"))
            self.run_scene(scene, name="one")
            self.check_sums("one", "leg", 1e5)
            self.run_scene(scene, name="two", ranks=2)
            self.check_sums("two", "leg", 1e5)
            one, two = (pressures(self.folder / f"out/{name}") for name in ("one", "two"))
            self.assertEqual(len(one), len(two))
            np.testing.assert_array_equal(one.patch, two.patch)
            for axis in "xyz":
                np.testing.assert_allclose(one[f"force_{axis}"], two[f"force_{axis}"], rtol=1e-9,
                                           atol=1e-6)
            self.run_scene(scene, "-ts_max_steps", "3111", name="part")
            go = ("-checkpoint_restart", "out/part/checkpoint.h5")
            done = self.run_scene(scene, *go, "-output_pressure_patch", "0.1", name="part", code=2)
            self.assertIn("output: pressure_patch: 0.1 cannot be changed where a run goes on",
                          done.stderr)
            self.run_scene(scene, *go, name="part")
            self.assertEqual((self.folder / "out/one/pressure.csv").read_bytes(),
                             (self.folder / "out/part/pressure.csv").read_bytes())


if __name__ == "__main__":
    unittest.main()
