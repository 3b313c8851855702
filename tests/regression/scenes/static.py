"""Sheets and lattices in equilibrium: moduli, deflections, calibrated stiffnesses."""
import sys

import numpy as np

from launch import REPOSITORY
from scenes.shared import last_row

sys.path.insert(0, str(REPOSITORY / "tools"))
import campaign_cases  # noqa: E402
from floe.sheets import plate  # noqa: E402

YOUNG = 4e9  # of the triangles [Pa]
# r = k_s/k_n
SHEAR = {"one_point": 0.8333333333333333 / 2.6, "exact": 0.16339869281045752, "none": 1 / 3}


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


def expect_calibration(test, calibration):
    test.assertEqual(calibration["kind"], "isotropic")
    test.assertAlmostEqual(calibration["scale"], 1 / 0.7, delta=1e-12)
    for constant in ("young", "poisson", "bending", "bending_poisson"):
        test.assertAlmostEqual(calibration[f"{constant}_error"], 0, delta=1e-8)
        test.assertLess(calibration[f"{constant}_scatter"], 3e-3)


def check_tension_calibrated(test, run):
    output = run()
    test.assertEqual(output.summary["bodies"], 7391)
    test.assertAlmostEqual(output.summary["gauge_length"], 79.1, delta=0.1)
    test.assertAlmostEqual(output.summary["E_gauge_over_Eb"], 1, delta=0.005)
    test.assertAlmostEqual(output.summary["E_over_Estar"], output.summary["E_over_Eb"], delta=1e-8)
    expect_calibration(test, output.summary["calibration"])
    young = run("-beam_calibrate", "young").summary
    # edges are stiff by half a cell
    test.assertAlmostEqual(young["E_gauge_over_Eb"], 1, delta=0.012)
    test.assertAlmostEqual(young["calibration"]["poisson_error"], 0.211 - 0.3, delta=0.005)
    none = run("-beam_calibrate", "none").summary
    test.assertAlmostEqual(none["E_over_Eb"] * young["calibration"]["scale"] / young["E_over_Eb"],
                           1, delta=1e-9)
    test.assertNotIn("calibration", none)
    small = ("-sheet_length", "20", "-sheet_width", "20", "-boundary_right_displacement",
             "0.02,0,0")
    static = run(*small).summary["E_over_Eb"]
    moving = run(*small, "-integrator", "explicit", "-beam_damping_ratio", "1",
                 "-boundary_right_ramp", "0.2",
                 "-time_end", "0.4").summary
    # the same stiffnesses, at rest again
    test.assertAlmostEqual(moving["E_over_Eb"] / static, 1, delta=1e-4)
    test.assertLess(abs(moving["energy"]["balance_error"]), 1e-3 * moving["energy"]["boundary"])


def check_bending_calibrated(test, run):
    output = run()
    test.assertEqual(output.summary["bodies"], 3285)
    test.assertAlmostEqual(output.summary["deflection_over_wyman"], 1.01, delta=0.025)
    expect_calibration(test, output.summary["calibration"])


def check_compression(test, run):
    output = run()
    test.assertAlmostEqual(output.summary["E_over_Eb"] / 0.834, 1, delta=0.01)
    test.assertTrue(output.summary["stable"])


def check_edge_load(test, run):
    output = run()
    test.assertEqual(output.summary["bodies"], 3080)
    test.assertAlmostEqual(output.summary["deflection_over_wyman"], 3.79, delta=0.08)
    test.assertAlmostEqual(output.summary["deflection_over_wyman"]
                           / (8 * plate.edge_deflection(0.3)), 1, delta=0.05)
    plain = run("-beam_calibrate", "none").summary["deflection_over_wyman"]
    test.assertAlmostEqual(plain, 3.47, delta=0.08)
    # D*, nu_b* of the infinite lattice (model.md, "Effective moduli of the lattice, calibrated
    # sheets")
    softer = 8 * plate.edge_deflection(0.00415) / np.sqrt(0.9062)
    test.assertAlmostEqual(plain / softer, 1, delta=0.03)


def check_uneven_sheet(test, run):
    output = run()
    ice = output.summary["thickness"]
    test.assertAlmostEqual(ice["least"], 0.389, delta=0.02)
    test.assertAlmostEqual(ice["most"], 1.47, delta=0.05)
    test.assertAlmostEqual(ice["deviation"], 0.24, delta=0.01)
    deflection = output.history("vehicle_load_displacement_z")[-1]
    test.assertAlmostEqual(deflection / -0.0267, 1, delta=0.03)
    even = run("-sheet_thickness_deviation", "0")
    test.assertNotIn("thickness", even.summary)
    test.assertAlmostEqual(even.history("vehicle_load_displacement_z")[-1] / -0.0186, 1, delta=0.02)


def expect_modulus(test, output, name, modulus, expected, delta):
    test.assertEqual(output.summary["bodies"], 462)
    row = campaign_cases.TESTS[name].evaluate(output, campaign_cases.Sheet(40, 1, 2))["row"]
    test.assertAlmostEqual(row[modulus], expected, delta=delta)


def check_biaxial(test, run):
    expect_modulus(test, run(), "biaxial", "K_over_Eb", 0.5, 0.01)


def check_shear(test, run):
    expect_modulus(test, run(), "shear", "G_over_Eb", 0.33, 0.02)


def check_slide(test, run):
    expect_modulus(test, run(), "slide", "slide_over_Eb", 0.217, 0.015)


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
        test.assertAlmostEqual(stresses(output)[0] / 1e-3, 2 * (1 + ratio) / (3 + ratio),
                               delta=1e-6, msg=shear)
        test.assertAlmostEqual(-across / (10 * np.sqrt(3)) / 1e-3, (1 - ratio) / (3 + ratio),
                               delta=1e-6, msg=shear)


def check_triangles_shear(test, run):
    for shear, ratio in SHEAR.items():
        x, y = stresses(run("-beam_shear", shear))
        test.assertAlmostEqual((x - y) / 4e-3, (1 + ratio) / 4, delta=1e-6, msg=shear)


def check_triangles_bulk(test, run):
    for shear in SHEAR:
        x, y = stresses(run("-beam_shear", shear))
        test.assertAlmostEqual((x + y) / 4e-3, 0.5, delta=1e-6, msg=shear)
