"""Sheets and floating bodies in time: explicit, implicit and Runge-Kutta steps."""
import numpy as np

from launch import FULL
from scenes.shared import last_row, short

# Deflection over Wyman's of a sheet of 40 x 40 m by statics, of input/bending.yaml of this size.
SMALLER = 1.19045


def check_heave(test, run):
    for added in (0, 0.5):
        output = run("-water_added_mass", str(added))
        z = np.array([output.field("bodies_displacement", time)[0, 2] for time in output.times])
        k = np.flatnonzero((z[1:-1] < 0) != (z[2:] < 0)) + 1
        passages = output.times[k] + (output.times[k + 1]
                                      - output.times[k]) * z[k] / (z[k] - z[k + 1])
        omega = np.pi * (len(passages) - 1) / (passages[-1] - passages[0])
        expected = 3.281718 / np.sqrt(1 + added)
        test.assertAlmostEqual(omega / expected, 1, delta=1e-3)
        test.assertAlmostEqual(np.abs(z).max() / (0.03 / expected), 1, delta=1e-3)
        test.assertLess(abs(last_row(output)["energy_balance_error"]), 1e-3 * 6.624)


def check_drag_decay(test, run):
    quadratic = ("-water_drag_linear", "0", "-water_drag_coefficient", "1.2")
    for options, way in (((), 1.630734), (quadratic, 1.959250)):
        output = run(*options)
        test.assertAlmostEqual(output.field("bodies_displacement", 4)[0, 0] / way, 1, delta=1e-3)
        row = last_row(output)
        test.assertAlmostEqual((row["energy_drag"] + row["energy_kinetic"]) / 7360, 1, delta=1e-5)


def check_yaw_decay(test, run):
    row = last_row(run())
    inertia, slowing = 920 * 3.6 * 4 / 6, 1010 * 1.1 * 0.9 * 2**4 / 32
    left = 0.5 * inertia / (1 + 10 * slowing / inertia)**2
    test.assertAlmostEqual(row["energy_kinetic"] / left, 1, delta=2e-3)
    test.assertAlmostEqual((row["energy_drag"] + row["energy_kinetic"]) / (0.5 * inertia), 1,
                           delta=1e-5)


def check_floe_in_waves(test, run):
    output = run()
    k = 2 * np.pi / 50
    omega = np.sqrt(9.81 * k)
    late = [time for time in output.times if time > output.times[-1] - 2 * np.pi / omega]
    z = np.array([output.field("bodies_displacement", time)[:, 2] for time in late])
    # Each body is lifted as its place in the wave is, but for the stiffness of the floe.
    amplitude = (z.max(axis=0) - z.min(axis=0)) / 2
    test.assertAlmostEqual(amplitude.mean() / 0.1, 1, delta=0.15)
    # Added mass by direction: without the velocities after the kick the error is 6e-5.
    for row in (last_row(output), last_row(run("-water_added_mass", "plate"))):
        test.assertLess(abs(row["energy_balance_error"]), 1e-6 * abs(row["energy_external"]))


def check_rk_drag(test, run):
    r, k = 500 / 920, 0.5 * 1010 * 1.2 / 920
    quadratic = ("-water_drag_linear", "0", "-water_drag_coefficient", "1.2")
    ways = ((), (1 - np.exp(-4 * r)) / r), (quadratic, np.log(1 + 4 * k) / k)
    adaptive = ("-ts_rk_type", "5dp", "-ts_adapt_type", "basic", "-ts_atol", "1e-8", "-ts_rtol",
                "0")
    for options, way in ways:
        for how in ((), adaptive):
            output = run(*options, *how)
            test.assertAlmostEqual(output.field("bodies_displacement", 4)[0, 0] / way, 1,
                                   delta=1e-6)
            row = last_row(output)
            test.assertAlmostEqual((row["energy_drag"] + row["energy_kinetic"]) / 7360, 1,
                                   delta=2e-6)


def check_tension_explicit(test, run):
    output = run()
    test.assertAlmostEqual(output.summary["E_over_Eb"] / 0.8337, 1, delta=0.03)
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-3 * energy["boundary"])


def check_bending_explicit(test, run):
    """In the short form of a quarter of the sheet, to the deflection of its own statics, and only
    up to 2.2 s, where it is as near as at 4 s."""
    small = short("-sheet_length", "40", "-sheet_width", "40")
    expected = 1.0561 if FULL else SMALLER
    output = run(*small, *short("-time_end", "2.2"))
    test.assertAlmostEqual(output.summary["deflection_over_wyman"] / expected, 1, delta=0.01)


def check_tension_implicit(test, run):
    output = run()
    test.assertAlmostEqual(output.summary["E_over_Eb"] / 0.8337, 1, delta=0.002)
    test.assertLess(output.summary["steps"], 150)
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-3 * energy["boundary"])


def check_bending_implicit(test, run):
    """In the short form steps of changing length are those of a quarter of the sheet."""
    small = short("-sheet_length", "40", "-sheet_width", "40")
    expected = 1.0561 if FULL else SMALLER
    for options, steps, deflection in (((), 8, 1.0561),
                                       ((*small, "-ts_adapt_type", "basic"), 80, expected)):
        output = run(*options)
        test.assertAlmostEqual(output.summary["deflection_over_wyman"] / deflection, 1,
                               delta=0.001)
        test.assertLessEqual(output.summary["steps"], steps)


def check_explicit_bench(test, run):
    energy = run().summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-6 * energy["boundary"])


def check_largest_explicit(test, run):
    summary = run("-sheet_length", "20", "-sheet_width", "20", "-time_end", "0.2").summary
    # static; the dashpots come on top
    test.assertAlmostEqual(summary["E_over_Eb"] / 0.843, 1, delta=0.04)
