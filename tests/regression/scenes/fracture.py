"""Sheets and strips that break."""
import re

import numpy as np

from floe.sheets import strength as strengths
from launch import FULL
from scenes.shared import breaks, last_row, short


def largest(output, name):
    """Largest size in a column of history.csv."""
    return np.max(np.abs(output.history(name)))


def check_break_strip(test, run):
    output = run()
    test.assertAlmostEqual(largest(output, "right_moment_y") / 200e3, 1, delta=0.01)
    test.assertEqual((output.summary["beams_broken"], output.summary["fragments"]), (1, 2))
    test.assertLess(abs(last_row(output)["right_moment_y"]), 1)


def check_in_situ_cantilever(test, run):
    output = run()
    test.assertGreaterEqual(output.summary["fragments"], 2)
    bodies = breaks(output, "fragments/bodies")
    test.assertGreater(bodies[1], 35)  # most of the cantilever, 46 bodies
    test.assertLess(bodies[1], 60)
    root = breaks(output, "place")[:, 0] < -1
    test.assertGreaterEqual(root.sum(), 4)
    test.assertAlmostEqual(6 * largest(output, "press_force_z") * 4.75 / (2 * 0.5**2) / 6e5, 0.75,
                           delta=0.1)


def check_strength_tension(test, run):
    """Short forms: l = 1 m, L/l = 10 (docs/strength.md)."""
    small = ("-sheet_length", "10", "-sheet_width", "10", "-boundary_right_displacement",
             "0.0015,0,0", "-time_dt", "0.1",
             "-beam_kinematics", "linear")
    nominal = 10 * 0.5 * 6e5
    plain = run(*small)
    strength = strengths.of_tension(strengths.history(plain.folder), nominal)
    test.assertAlmostEqual(strength["largest"], 0.68, delta=0.08)
    test.assertNotIn("strength_calibration", plain.summary)
    free = (*small, "-boundary_left_fix", "x", "-boundary_right_fix", "x",
            "-boundary_right_displacement", "0.0025,0,0",
            "-fracture_calibrate", "strength", "-time_end", "0.8")
    found = {}
    for ranks in (1, 2):
        # The sheet breaks in two at its first break. Each half is held along x only, so rounding
        # decides whether a balance is found or the run stops there.
        output = run(*free, ranks=ranks, status=(0, 1))
        found[ranks] = output.summary["strength_calibration"]
        rows = strengths.history(output.folder)
        if rows[-1]["beams_broken"] == 0:
            stopped = re.search(r"dynamic failure at load factor ([\d.]+):",
                                output.summary["message"])
            test.assertIsNotNone(stopped, output.summary["message"])
            time = float(stopped[1]) * 0.8  # of `-time_end`
            strength = abs(rows[-1]["right_force_x"]) * time / rows[-1]["time"] / nominal
        else:
            strength = strengths.of_tension(rows, nominal)["first"]
        along_x = found[ranks]["factor"] * found[ranks]["along_x"]
        # a load step may pass the strength by 0.5 %
        test.assertAlmostEqual(strength / along_x, 1, delta=0.006)
        test.assertAlmostEqual(strength, 1, delta=0.08)  # x and y differ
    test.assertEqual(found[1]["factor"], found[2]["factor"])


def check_strength_bending(test, run):
    output = run("-sheet_length", "10", "-sheet_width", "10", "-load_left_moment", "0,3e5,0",
                 "-load_right_moment", "0,-3e5,0",
                 "-time_dt", "0.1", "-beam_kinematics", "linear", status=1)
    strength = strengths.of_bending(strengths.history(output.folder),
                                    output.summary["message"], 1.2)
    test.assertAlmostEqual(strength["largest"], 0.87, delta=0.12)


def check_edge_uplift(test, run):
    """In the short form of a shorter sheet, by larger load steps."""
    output = run(*short("-sheet_length", "44", "-time_dt", "0.05"))
    time = breaks(output, "time")
    place = breaks(output, "place")[:, 0] - output.position[:, 0].min()
    first = time.min()
    test.assertAlmostEqual(6e4 * first / 8 / 5672, 1, delta=0.07)
    # nothing breaks before, not beside the edge either: the first breaks are the crack
    test.assertGreater(place[time == first].min(), 5)
    test.assertAlmostEqual(np.median(place[time < 1.01 * first]), 8.94, delta=1)


def check_point_breakthrough(test, run):
    output = run()
    time, place, pairs = (breaks(output, name) for name in ("time", "place", "bodies"))
    chord = output.position[pairs[:, 1]] - output.position[pairs[:, 0]]
    chord /= np.linalg.norm(chord, axis=1)[:, None]
    radius = np.hypot(*place[:, :2].T)
    # 1: the crack runs around the load
    along = np.abs(np.sum(chord[:, :2] * place[:, :2], axis=1)) / radius
    early, late = time <= np.quantile(time, 0.25), time >= np.quantile(time, 0.6)
    test.assertGreater(np.mean(along[early] < 0.5), 2 * np.mean(along[early] > 0.8))
    test.assertGreater(np.mean(along[late] > 0.8), 1.5 * np.mean(along[late] < 0.5))
    around = radius[late & (along > 0.8)]
    test.assertTrue(0.7 < np.median(around) / 8.245 < 1.5, np.median(around))


def check_notch_snap_back(test, run):
    output = run()
    path = output.summary["path"]
    test.assertEqual(output.summary["fragments"], 2)
    test.assertGreater(path["snap_backs"], 10)
    names = ("boundary", "strain", "fracture", "released")
    work, *rest = (output.history("energy_" + name) for name in names)
    np.testing.assert_allclose(work, np.sum(rest, axis=0), rtol=2e-5, atol=1e-6)
    force, factor = output.history("right_force_x"), output.history("load_factor")
    back = output.history("snap_back")[1:] == 1
    test.assertTrue(np.all(np.diff(force)[back] < 0))
    test.assertTrue(np.all(np.diff(factor)[back] < 0))
    test.assertTrue(np.all(np.diff(output.history("beams_broken")) <= 1))


def check_notch(test, run):
    coarse = run("-time_dt", "0.1")
    tough = largest(coarse, "left_force_x")
    sharp = run("-time_dt", "0.1", "-fracture_propagation", "energy")
    test.assertTrue(0.25 < largest(sharp, "left_force_x") / tough < 0.45)  # 1/3.0 of three meshes
    test.assertGreater(sharp.summary["broken_area_at_tips"], 10)
    output = run() if FULL else coarse
    test.assertEqual(output.summary["fragments"], 2)
    place = breaks(output, "place")
    test.assertLess(np.max(np.abs(place[:, 0])), 3)  # ahead of the notch, all the way
    test.assertTrue(place[:, 1].min() > -5.5 and place[:, 1].max() > 9)
    test.assertLess(abs(last_row(output)["right_force_x"]), 1)
