#!/usr/bin/python3
"""Every scene of input/ runs by the command of its own first line and gives the numbers its header promises.

A scene without an entry in EXPECTED fails. The commands run in a temporary folder that looks like the
repository (build/release/floe, input, tools), so nothing is left behind.
"""
import csv
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
sys.path.insert(0, str(REPOSITORY / "tools"))
from floe_output import Output  # noqa: E402

YOUNG = 4e9  # of the triangles [Pa]
SHEAR = {"one_point": 0.8333333333333333 / 2.6, "exact": 0.16339869281045752, "none": 1 / 3}  # r = k_s/k_n


def tip(output, time):
    """Displacement of the body of the set `tip` at a sample that must be there [m]."""
    if np.min(np.abs(output.times - time)) > 1e-9:
        raise AssertionError(f"fields.h5 has no sample at time {time}, only {output.times}")
    return output.field("bodies_displacement", time)[output.sets["tip"][0]]


def last_row(output):
    """Last row of history.csv as {column: number}."""
    with open(output.folder / "history.csv", newline="") as file:
        return {key: float(value) for key, value in list(csv.DictReader(file))[-1].items()}


def force(output, boundaries, component):
    """Sum of the last reactions of named boundaries, what they exert on the sheet [N]."""
    row = last_row(output)
    return sum(row[f"{name}_force_{component}"] for name in boundaries)


def check_tension(test, run):
    output = run()
    test.assertEqual(output.summary["bodies"], 462)
    test.assertAlmostEqual(output.summary["E_over_Eb"], 0.843, delta=0.015)
    test.assertAlmostEqual(output.summary["E_over_Estar"], 1.060, delta=0.019)


def check_largest(test, run):
    output = run()
    test.assertEqual(output.summary["bodies"], 29561)
    test.assertEqual(output.summary["ranks"], 2)
    test.assertAlmostEqual(output.summary["E_over_Eb"], 0.796, delta=0.002)
    test.assertAlmostEqual(output.summary["E_over_Estar"], 1.001, delta=0.002)


def check_bending(test, run):
    output = run()
    test.assertEqual(output.summary["bodies"], 3285)
    test.assertAlmostEqual(output.summary["wyman"] / 1.8558e-3, 1, delta=1e-4)
    test.assertAlmostEqual(output.summary["deflection_over_wyman"], 1.06, delta=0.03)


def check_bend45(test, run):
    output = run()
    for time, expected in ((0.5, (-11.9318, -7.0447, 40.1925)), (1, (-23.5606, -13.6047, 53.4755))):
        error = np.linalg.norm(tip(output, time) - expected) / np.linalg.norm(expected)
        test.assertLess(error, 5e-4, f"time {time}: {tip(output, time)}")


def check_bend45_softer(test, run):
    moved, expected = tip(run(), 1), (-23.8142, -13.7291, 53.6055)
    test.assertLess(np.linalg.norm(moved - expected) / np.linalg.norm(expected), 5e-4, moved)


def check_rollup(test, run):
    output = run()
    half = 0.25 / np.sin(np.pi / 80)
    np.testing.assert_allclose(tip(output, 0.5), [-10, half, 0], atol=1e-5)
    np.testing.assert_allclose(tip(output, 1), [-10, 0, 0], atol=1e-5)  # 1e-6 L


def check_elastica(test, run):
    output = run()
    table = {0.1: (.05643, .30172), 0.2: (.16064, .49346), 0.5: (.38763, .71379), 1: (.55500, .81061)}
    for time, (x, y) in table.items():
        moved = tip(output, time) / 10
        np.testing.assert_allclose([-moved[0], moved[1]], [x, y], rtol=5e-4, err_msg=f"time {time}")


def stresses(output):
    """Stress over Young's modulus in x and, if `top` is prescribed, in y, from the reactions."""
    names = last_row(output)
    x = force(output, ("right", "rightinner"), "x") / (10 * np.sqrt(3) * YOUNG)
    return x, force(output, ("top",), "y") / (20 * YOUNG) if "top_force_y" in names else 0


def check_triangles_tension(test, run):
    for shear, ratio in SHEAR.items():
        output = run("-beam_shear", shear)
        y = output.field("bodies_displacement", 1)[:, 1]
        across = y[output.sets["top"]].mean() - y[output.sets["bottom"]].mean()
        test.assertAlmostEqual(stresses(output)[0] / 1e-3, 2 * (1 + ratio) / (3 + ratio), delta=1e-6, msg=shear)
        test.assertAlmostEqual(-across / (10 * np.sqrt(3)) / 1e-3, (1 - ratio) / (3 + ratio), delta=1e-6, msg=shear)


def check_triangles_shear(test, run):
    for shear, ratio in SHEAR.items():
        x, y = stresses(run("-beam_shear", shear))
        test.assertAlmostEqual((x - y) / 4e-3, (1 + ratio) / 4, delta=1e-6, msg=shear)


def check_triangles_bulk(test, run):
    for shear in SHEAR:
        x, y = stresses(run("-beam_shear", shear))
        test.assertAlmostEqual((x + y) / 4e-3, 0.5, delta=1e-6, msg=shear)


EXPECTED = {
    "tension.yaml": check_tension,
    "bending.yaml": check_bending,
    "bench/largest.yaml": check_largest,
    "verify/bend45.yaml": check_bend45,
    "verify/bend45_softer.yaml": check_bend45_softer,
    "verify/rollup.yaml": check_rollup,
    "verify/elastica.yaml": check_elastica,
    "verify/triangles_tension.yaml": check_triangles_tension,
    "verify/triangles_shear.yaml": check_triangles_shear,
    "verify/triangles_bulk.yaml": check_triangles_bulk,
}


class Scenes(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "build/release").mkdir(parents=True)
        (self.folder / "build/release/floe").symlink_to(FLOE)
        for name in ("input", "tools"):
            (self.folder / name).symlink_to(REPOSITORY / name)

    def runner(self, scene):
        """A function that runs the scene's own command, with more options if given: its output."""
        first = scene.read_text().splitlines()[0]
        self.assertTrue(first.startswith("# ") and first.endswith(f"input/{scene.relative_to(REPOSITORY / 'input')}"),
                        f"{scene}: the first line must be the command that runs it")

        def run(*options):
            command = " ".join([first[2:], *options])
            done = subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}{done.stderr}")
            return Output(self.folder / "out" / scene.stem)

        return run


def add_tests():
    """One test per scene, named after it."""
    for scene in sorted((REPOSITORY / "input").rglob("*.yaml")):
        name = str(scene.relative_to(REPOSITORY / "input"))

        def test(self, scene=scene, name=name):
            self.assertIn(name, EXPECTED, "a scene needs an entry in EXPECTED")
            EXPECTED[name](self, self.runner(scene))

        setattr(Scenes, "test_" + name.removesuffix(".yaml").replace("/", "_"), test)


add_tests()

if __name__ == "__main__":
    unittest.main()
