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

import h5py
import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
sys.path.insert(0, str(REPOSITORY / "tools"))
import campaign_cases  # noqa: E402
import floe_plate  # noqa: E402
import floe_strength  # noqa: E402
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
    test.assertAlmostEqual(young["E_gauge_over_Eb"], 1, delta=0.012)  # edges are stiff by half a cell
    test.assertAlmostEqual(young["calibration"]["poisson_error"], 0.211 - 0.3, delta=0.005)
    none = run("-beam_calibrate", "none").summary
    test.assertAlmostEqual(none["E_over_Eb"] * young["calibration"]["scale"] / young["E_over_Eb"], 1, delta=1e-9)
    test.assertNotIn("calibration", none)
    small = ("-sheet_length", "20", "-sheet_width", "20", "-boundary_right_displacement", "0.02,0,0")
    static = run(*small).summary["E_over_Eb"]
    moving = run(*small, "-integrator", "explicit", "-beam_damping_ratio", "1", "-boundary_right_ramp", "0.2",
                 "-time_end", "0.4").summary
    test.assertAlmostEqual(moving["E_over_Eb"] / static, 1, delta=1e-4)  # the same stiffnesses, at rest again
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
    test.assertAlmostEqual(output.summary["deflection_over_wyman"] / (8 * floe_plate.edge_deflection(0.3)), 1, delta=0.05)
    plain = run("-beam_calibrate", "none").summary["deflection_over_wyman"]
    test.assertAlmostEqual(plain, 3.47, delta=0.08)
    softer = 8 * floe_plate.edge_deflection(0.00415) / np.sqrt(0.9062)  # D*, nu_b* of the infinite lattice, docs/model.md section 3
    test.assertAlmostEqual(plain / softer, 1, delta=0.03)


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


def check_heave(test, run):
    for added in (0, 0.5):
        output = run("-water_added_mass", str(added))
        z = np.array([output.field("bodies_displacement", time)[0, 2] for time in output.times])
        k = np.flatnonzero((z[1:-1] < 0) != (z[2:] < 0)) + 1
        passages = output.times[k] + (output.times[k + 1] - output.times[k]) * z[k] / (z[k] - z[k + 1])
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


def check_tension_explicit(test, run):
    output = run()
    test.assertAlmostEqual(output.summary["E_over_Eb"] / 0.8337, 1, delta=0.03)
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-3 * energy["boundary"])


def check_bending_explicit(test, run):
    output = run()
    test.assertAlmostEqual(output.summary["deflection_over_wyman"] / 1.0561, 1, delta=0.01)


def check_tension_implicit(test, run):
    output = run()
    test.assertAlmostEqual(output.summary["E_over_Eb"] / 0.8337, 1, delta=0.002)
    test.assertLess(output.summary["steps"], 150)
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-3 * energy["boundary"])


def check_bending_implicit(test, run):
    for options, steps in (((), 8), (("-ts_adapt_type", "basic"), 80)):
        output = run(*options)
        test.assertAlmostEqual(output.summary["deflection_over_wyman"] / 1.0561, 1, delta=0.001)
        test.assertLessEqual(output.summary["steps"], steps)


def check_explicit_bench(test, run):
    energy = run().summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-6 * energy["boundary"])


def check_largest_explicit(test, run):
    summary = run("-sheet_length", "20", "-sheet_width", "20", "-time_end", "0.2").summary
    test.assertAlmostEqual(summary["E_over_Eb"] / 0.843, 1, delta=0.04)  # static; the dashpots come on top


def check_free_top(test, run):
    output = run()
    upright = [np.cos(np.linalg.norm(v)) + (1 - np.cos(np.linalg.norm(v))) * (v[1] / np.linalg.norm(v))**2
               for v in (output.field("bodies_rotation", t)[0] for t in output.times[1:])]  # R_22
    test.assertGreater(max(upright), 0.9)
    test.assertLess(min(upright), -0.9)
    kinetic = output.history("energy_kinetic")
    test.assertLess(np.ptp(kinetic), 1e-6 * kinetic[0])


def rotations(vectors):
    """Matrices of rotation vectors, n x 3 x 3 (Rodrigues)."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None] + 1e-300
    cross = np.zeros((len(vectors), 3, 3))
    for (i, j, k), sign in (((2, 1, 0), 1), ((0, 2, 1), 1), ((1, 0, 2), 1), ((1, 2, 0), -1), ((2, 0, 1), -1),
                            ((0, 1, 2), -1)):
        cross[:, i, j] = sign * vectors[:, k]
    cross /= angle
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def check_rk_top(test, run):
    output = run()
    inertia, omega = np.array([1.25, 4.25, 5]), np.array([0.3, 3, 0.1])
    momentum, energy2 = inertia * omega, inertia @ omega**2
    i1, i2, i3 = inertia
    first = momentum @ momentum - energy2 * i1
    rate = np.sqrt((i3 - i2) * first / (i1 * i2 * i3))
    parameter = (i2 - i1) * (energy2 * i3 - momentum @ momentum) / ((i3 - i2) * first)
    if parameter > 1:
        rate, parameter = rate * np.sqrt(parameter), 1 / parameter
    a, b = 1.0, np.sqrt(1 - parameter)  # K = pi/(2 M(1, sqrt(1 - m))), M the arithmetic-geometric mean
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2, np.sqrt(a * b)
    half_period = np.pi / a / rate
    turned = rotations(np.array([output.field("bodies_rotation", t)[0] for t in output.times]))
    along = np.einsum("nij,i->nj", turned, momentum)[:, 1]
    k = np.flatnonzero(along[:-1] * along[1:] < 0)
    passages = output.times[k] + (output.times[k + 1] - output.times[k]) * along[k] / (along[k] - along[k + 1])
    test.assertGreater(len(passages), 4)
    test.assertAlmostEqual((passages[-1] - passages[0]) / (len(passages) - 1) / half_period, 1, delta=1e-4)
    kinetic = output.history("energy_kinetic")
    test.assertLess(np.ptp(kinetic), 1e-9 * kinetic[0])


def check_rk_drag(test, run):
    r, k = 500 / 920, 0.5 * 1010 * 1.2 / 920
    ways = ((), (1 - np.exp(-4 * r)) / r), (("-water_drag_linear", "0", "-water_drag_coefficient", "1.2"),
                                           np.log(1 + 4 * k) / k)
    adaptive = ("-ts_rk_type", "5dp", "-ts_adapt_type", "basic", "-ts_atol", "1e-8", "-ts_rtol", "0")
    for options, way in ways:
        for how in ((), adaptive):
            output = run(*options, *how)
            test.assertAlmostEqual(output.field("bodies_displacement", 4)[0, 0] / way, 1, delta=1e-6)
            row = last_row(output)
            test.assertAlmostEqual((row["energy_drag"] + row["energy_kinetic"]) / 7360, 1, delta=2e-6)


def check_free_flight(test, run):
    output = run()
    with h5py.File(output.folder / "lattice.h5") as file:
        mass = file["bodies/mass"][:]
    for time in output.times[1:]:
        centre = mass @ output.field("bodies_displacement", time) / mass.sum()
        np.testing.assert_allclose(centre, [0, 20 * time * mass[-1] / mass.sum(), 0], atol=1e-9)
    energy = output.history("energy_kinetic") + output.history("energy_strain")
    test.assertLess(np.ptp(energy), 1e-3 * energy[0])


def timoshenko_frequency(young, density, poisson, width, height, length, shear_factor=5 / 6):
    """First natural frequency [Hz] of a clamped-free Timoshenko beam bending along `height`: the smallest root of the
    determinant of its four end conditions (Timoshenko 1921; solutions cosh, sinh, cos, sin of the two wave numbers)."""
    area, inertia = width * height, width * height**3 / 12
    shear = shear_factor * young / (2 * (1 + poisson)) * area

    def determinant(omega):
        a, b, c = young * inertia, density * inertia * omega**2, density * area * omega**2
        # w'''' (EI) + w'' (rho I omega^2 + EI rho A omega^2/kGA) + w (rho I omega^4 rho A/kGA - rho A omega^2) = 0
        roots = np.roots([a, b + a * c / shear, b * c / shear - c]).astype(complex)
        waves = [k for root in roots for k in (np.sqrt(root), -np.sqrt(root))]
        rows = [[1] * 4, [], [], []]
        for k in waves:
            psi = k + c / (shear * k)  # rotation over deflection: kGA (w'' - psi') = -rho A omega^2 w
            rows[1].append(psi)
            rows[2].append(k * psi * np.exp(k * length))
            rows[3].append((k - psi) * np.exp(k * length))
        matrix = np.array(rows)
        value = np.linalg.det(matrix)
        return value / np.prod(np.linalg.norm(matrix, axis=0)) * 1j**0

    euler = 3.5160153 / length**2 * np.sqrt(young * inertia / (density * area))
    grid = np.linspace(0.8, 1.02, 2201) * euler
    size = np.abs([determinant(omega) for omega in grid])
    return grid[np.argmin(size)] / (2 * np.pi)


def dominant_frequency(values, step):
    """Frequency [Hz] of the largest peak of a sampled signal (Hann window, parabola through the peak's logarithms)."""
    spectrum = np.abs(np.fft.rfft(values * np.hanning(len(values))))
    k = int(np.argmax(spectrum[1:])) + 1
    left, middle, right = np.log(spectrum[k - 1:k + 2])
    return (k + 0.5 * (left - right) / (left - 2 * middle + right)) / (len(values) * step)


def check_vibrating(test, run):
    output = run()
    body = output.sets["tip"][0]
    tip_motion = np.array([output.field("bodies_displacement", t)[body] for t in output.times])
    step = output.times[1] - output.times[0]
    for axis, width, height in ((2, 0.6, 0.4), (1, 0.4, 0.6)):
        expected = timoshenko_frequency(4e9, 920, 0.3, width, height, 10)
        test.assertAlmostEqual(dominant_frequency(tip_motion[:, axis], step) / expected, 1, delta=0.005)


def check_wave(test, run):
    output = run()
    time = output.times[-1]
    x = output.position[:, 0] - output.position[:, 0].min()
    u = output.field("bodies_displacement", time)[:, 0]
    behind = (x > 10) & (x < 100)  # the ramp's foot is at c (t - 0.005), beyond 130 m
    slope = np.polyfit(x[behind], u[behind], 1)[0]
    test.assertAlmostEqual(-0.01 / slope / 1773.1, 1, delta=0.01)


def check_stopping(test, run):
    output = run()
    row = last_row(output)
    test.assertAlmostEqual(output.field("bodies_displacement", 1.5)[0, 0] / 1.0194, 1, delta=0.01)
    test.assertAlmostEqual(row["energy_friction"] / 368, 1, delta=0.01)
    test.assertAlmostEqual(row["floor_force_z"] / -1805.04, 1, delta=0.01)
    test.assertEqual(output.summary["contacts"], 1)
    test.assertGreater(-output.summary["peak_force"]["floor"][2], 1805)
    test.assertAlmostEqual(output.summary["mean_force"]["floor"][2] / -1805.04, 1, delta=0.05)


def check_ice_vibration(test, run):
    output = run()
    time, force = output.history("time"), output.history("leg_force_x")
    crushing = time[(force > 1.45e6) & (time > 3.5) & (time < 4.5)]
    test.assertAlmostEqual(crushing[0], 3.843, delta=0.03)
    test.assertAlmostEqual(crushing[-1], 4.339, delta=0.03)
    test.assertAlmostEqual(force.max() / 1.5e6, 1, delta=0.08)
    test.assertEqual(force[(time > 3.45) & (time < 3.65)].max(), 0)
    test.assertAlmostEqual(output.summary["energy"]["balance_error"], 0, delta=10)


def check_floes_collide(test, run):
    output = run()
    row = last_row(output)
    test.assertLess(abs(row["energy_balance_error"]), 0.01 * output.history("energy_kinetic")[0])
    test.assertGreater(output.history("contacts").max(), 3)
    with h5py.File(output.folder / "lattice.h5") as file:
        mass = file["bodies/mass"][:]
    times = output.times
    u = [output.field("bodies_displacement", time)[:, 0] for time in times]
    west = np.isin(np.arange(len(mass)), output.sets["west"])
    mean = mass @ (u[-1] - u[0]) / mass.sum() / (times[-1] - times[0])
    test.assertAlmostEqual(mean / (0.5 * mass[west].sum() / mass.sum()), 1, delta=1e-6)
    late = times > 0.8 * times[-1]  # they have parted
    speed = [mass[floe] @ (u[-1] - u[np.flatnonzero(late)[0]])[floe] / mass[floe].sum()
             / (times[-1] - times[late][0]) for floe in (west, ~west)]
    test.assertGreater(speed[1], speed[0] + 0.1)  # it was at rest and leads now
    test.assertLess(speed[1], 0.5)


def check_rubble_pile(test, run):
    output = run("-time_end", "3")
    test.assertEqual(output.summary["bodies"], 1000)
    test.assertGreater(output.summary["contacts"], 30)
    energy = output.summary["energy"]
    lost = sum(energy[name] for name in ("drag", "contact_viscous", "friction", "crushing"))
    test.assertGreater(lost, 0)
    test.assertLess(abs(energy["balance_error"]), 0.01 * lost)
    z = output.position[:, 2] + output.field("bodies_displacement", 3)[:, 2]
    test.assertGreater(z.mean(), output.position[:, 2].mean() + 0.5)  # they rise,
    test.assertLess(z.max(), 1)                                       # and none is thrown out


def check_punch_through(test, run):
    output = run()
    time, load = output.history("time"), output.history("plate_force_z")
    test.assertEqual(np.abs(load[time < 7.5]).max(), 0)
    test.assertGreater(load[time > 14].mean(), 5 * 441)
    test.assertGreater(output.summary["peak_force"]["plate"][2], load.max() - 1e-6 * load.max())
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 0.01 * energy["external"])
    mean = output.summary["mean_force"]["plate"][2]  # over every step, where history.csv has samples
    test.assertAlmostEqual(energy["external"] / (mean * 18 * 0.25), 1, delta=1e-3)


def largest(output, name):
    """Largest size in a column of history.csv."""
    return np.max(np.abs(output.history(name)))


def check_break_strip(test, run):
    output = run()
    test.assertAlmostEqual(largest(output, "right_moment_y") / 200e3, 1, delta=0.01)
    test.assertEqual((output.summary["beams_broken"], output.summary["fragments"]), (1, 2))
    test.assertLess(abs(last_row(output)["right_moment_y"]), 1)


def breaks(output, name):
    with h5py.File(output.folder / "breaks.h5") as file:
        return file[name][:]


def check_in_situ_cantilever(test, run):
    output = run()
    test.assertGreaterEqual(output.summary["fragments"], 2)
    bodies = breaks(output, "fragments/bodies")
    test.assertGreater(bodies[1], 35)  # most of the cantilever, 46 bodies
    test.assertLess(bodies[1], 60)
    root = breaks(output, "place")[:, 0] < -1
    test.assertGreaterEqual(root.sum(), 4)
    test.assertAlmostEqual(6 * largest(output, "press_force_z") * 4.75 / (2 * 0.5**2) / 6e5, 1.2, delta=0.25)


def check_strength_tension(test, run):
    """Short forms: l = 1 m, L/l = 10 (docs/strength.md)."""
    small = ("-sheet_length", "10", "-sheet_width", "10", "-boundary_right_displacement", "0.0015,0,0", "-time_dt", "0.1",
             "-beam_kinematics", "linear")
    nominal = 10 * 0.5 * 6e5
    plain = run(*small)
    strength = floe_strength.of_tension(floe_strength.history(plain.folder), nominal)
    test.assertAlmostEqual(strength["largest"], 0.68, delta=0.08)
    test.assertNotIn("strength_calibration", plain.summary)
    free = (*small, "-boundary_left_fix", "x", "-boundary_right_fix", "x", "-boundary_right_displacement", "0.0025,0,0",
            "-fracture_calibrate", "strength", "-time_end", "0.8")
    found = {}
    for ranks in (1, 2):
        output = run(*free, ranks=ranks)
        found[ranks] = output.summary["strength_calibration"]
        strength = floe_strength.of_tension(floe_strength.history(output.folder), nominal)["first"]
        along_x = found[ranks]["factor"] * found[ranks]["along_x"]
        test.assertAlmostEqual(strength / along_x, 1, delta=0.006)  # a load step may pass the strength by 0.5 %
        test.assertAlmostEqual(strength, 1, delta=0.08)  # x and y differ
    test.assertEqual(found[1]["factor"], found[2]["factor"])


def check_strength_bending(test, run):
    output = run("-sheet_length", "10", "-sheet_width", "10", "-load_left_moment", "0,3e5,0", "-load_right_moment", "0,-3e5,0",
                 "-time_dt", "0.1", "-beam_kinematics", "linear", status=1)
    strength = floe_strength.of_bending(floe_strength.history(output.folder), output.summary["message"], 1.2)
    test.assertAlmostEqual(strength["largest"], 0.87, delta=0.12)


def check_edge_uplift(test, run):
    output = run()
    force = largest(output, "edge_force_z") / 8
    test.assertAlmostEqual(force / 5672, 1, delta=0.07)
    place = breaks(output, "place")[:, 0] + 30
    far = place[place > 4]
    test.assertAlmostEqual(np.median(far), 8.94, delta=1)


def check_point_breakthrough(test, run):
    output = run()
    time, place, pairs = (breaks(output, name) for name in ("time", "place", "bodies"))
    chord = output.position[pairs[:, 1]] - output.position[pairs[:, 0]]
    chord /= np.linalg.norm(chord, axis=1)[:, None]
    radius = np.hypot(*place[:, :2].T)
    along = np.abs(np.sum(chord[:, :2] * place[:, :2], axis=1)) / radius  # 1: the crack runs around the load
    early, late = time <= np.quantile(time, 0.25), time >= np.quantile(time, 0.6)
    test.assertGreater(np.mean(along[early] < 0.5), 2 * np.mean(along[early] > 0.8))
    test.assertGreater(np.mean(along[late] > 0.8), 1.5 * np.mean(along[late] < 0.5))
    around = radius[late & (along > 0.8)]
    test.assertTrue(0.7 < np.median(around) / 8.245 < 1.5, np.median(around))


def check_notch(test, run):
    output = run()
    test.assertEqual(output.summary["fragments"], 2)
    place = breaks(output, "place")
    test.assertLess(np.max(np.abs(place[:, 0])), 3)  # ahead of the notch, all the way
    test.assertTrue(place[:, 1].min() > -5.5 and place[:, 1].max() > 9)
    test.assertLess(abs(last_row(output)["right_force_x"]), 1)


def check_ice_slope_strip(test, run):
    output = run()
    time, load, lift = (output.history(name) for name in ("time", "slope_force_x", "slope_force_z"))
    before = time < breaks(output, "time")[0]
    last = before & (time > 0.9 * time[before][-1])
    test.assertAlmostEqual(load[last].mean() / 7544, 1, delta=0.1)
    test.assertAlmostEqual(load[before][-5:].mean() / 7544, 1, delta=0.04)
    test.assertAlmostEqual(-load[last].mean() / lift[last].mean(), 1.1 / 0.9, delta=0.01)
    test.assertAlmostEqual(-breaks(output, "place")[0, 0], 9.26, delta=0.75)
    test.assertLess(abs(last_row(output)["energy_balance_error"]), 0.01 * output.summary["energy"]["boundary"])


def expect_ledger(test, output, bound=0.01):
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), bound * energy["boundary"])


def check_ice_slope(test, run):
    output = run("-time_end", "3")
    test.assertEqual(output.summary["bodies"], 1027)
    test.assertGreater(output.summary["beams_broken"], 10)
    place = breaks(output, "place")[:, 0]
    test.assertTrue(-18 < np.median(place) - 50 < -3, np.median(place))
    peak = output.summary["peak_force"]["slope"]
    test.assertTrue(151e3 < peak[0] < 400e3, peak)  # more than at a slow first break
    test.assertLess(peak[2], -0.7 * peak[0])
    z = output.position[:, 2] + output.field("bodies_displacement", 3)[:, 2]
    test.assertTrue(0.2 < z.max() < 2, z.max())  # rides up
    expect_ledger(test, output, 1e-3)


def check_ice_cone(test, run):
    output = run("-time_end", "2")
    test.assertGreater(output.summary["beams_broken"], 10)
    test.assertGreaterEqual(output.summary["fragments"], 2)
    peak = output.summary["peak_force"]["cone"]
    test.assertTrue(80e3 < peak[0] < 300e3, peak)
    test.assertLess(peak[2], 0)
    expect_ledger(test, output, 1e-3)


def check_ice_cylinder(test, run):
    output = run("-time_end", "2.5")
    time, load = output.history("time"), output.history("leg_force_x")
    for moment in (1.5, 2, 2.5):
        d = 0.5 * (moment - 0.5) - 0.1  # ramp of 1 s, a gap of 0.1 m
        crushing = 1.5e6 * 0.5 * 2 * np.sqrt(4 * d - d**2)
        test.assertAlmostEqual(load[np.argmin(np.abs(time - moment))] / crushing, 1, delta=0.08, msg=moment)
    energy = output.summary["energy"]
    test.assertGreater(energy["crushing"], 0.7 * energy["boundary"])
    expect_ledger(test, output, 1e-3)


EXPECTED = {
    "ice_slope.yaml": check_ice_slope,
    "ice_cone.yaml": check_ice_cone,
    "ice_cylinder.yaml": check_ice_cylinder,
    "verify/ice_slope.yaml": check_ice_slope_strip,
    "punch_through.yaml": check_punch_through,
    "floes_collide.yaml": check_floes_collide,
    "ice_vibration.yaml": check_ice_vibration,
    "rubble_pile.yaml": check_rubble_pile,
    "verify/stopping.yaml": check_stopping,
    "break_strip.yaml": check_break_strip,
    "in_situ_cantilever.yaml": check_in_situ_cantilever,
    "edge_uplift.yaml": check_edge_uplift,
    "strength_tension.yaml": check_strength_tension,
    "strength_bending.yaml": check_strength_bending,
    "point_breakthrough.yaml": check_point_breakthrough,
    "notch.yaml": check_notch,
    "tension.yaml": check_tension,
    "bending.yaml": check_bending,
    "compression.yaml": check_compression,
    "biaxial.yaml": check_biaxial,
    "shear.yaml": check_shear,
    "slide.yaml": check_slide,
    "edge_load.yaml": check_edge_load,
    "tension_calibrated.yaml": check_tension_calibrated,
    "bending_calibrated.yaml": check_bending_calibrated,
    "tension_explicit.yaml": check_tension_explicit,
    "bending_explicit.yaml": check_bending_explicit,
    "tension_implicit.yaml": check_tension_implicit,
    "bending_implicit.yaml": check_bending_implicit,
    "verify/free_top.yaml": check_free_top,
    "verify/rk_top.yaml": check_rk_top,
    "verify/rk_drag.yaml": check_rk_drag,
    "verify/free_flight.yaml": check_free_flight,
    "verify/vibrating.yaml": check_vibrating,
    "verify/wave.yaml": check_wave,
    "bench/largest.yaml": check_largest,
    "bench/explicit.yaml": check_explicit_bench,
    "bench/largest_explicit.yaml": check_largest_explicit,
    "verify/bend45.yaml": check_bend45,
    "verify/bend45_softer.yaml": check_bend45_softer,
    "verify/rollup.yaml": check_rollup,
    "verify/elastica.yaml": check_elastica,
    "verify/triangles_tension.yaml": check_triangles_tension,
    "verify/triangles_shear.yaml": check_triangles_shear,
    "verify/triangles_bulk.yaml": check_triangles_bulk,
    "verify/heave.yaml": check_heave,
    "verify/drag_decay.yaml": check_drag_decay,
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

        def run(*options, ranks=1, status=0):
            command = " ".join([*(["mpiexec", "-n", str(ranks)] if ranks > 1 else []), first[2:], *options])
            done = subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, status, f"{command}\n{done.stdout}{done.stderr}")
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
