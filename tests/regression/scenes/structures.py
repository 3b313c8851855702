"""Sheets that drift against structures."""
import numpy as np

from launch import FULL
from scenes.shared import breaks, last_row


def check_ice_slope_strip(test, run):
    output = run()
    time, load, lift = (output.history(name) for name in ("time", "slope_force_x", "slope_force_z"))
    before = time < breaks(output, "time")[0]
    last = before & (time > 0.9 * time[before][-1])
    test.assertAlmostEqual(load[last].mean() / 7544, 1, delta=0.1)
    test.assertAlmostEqual(load[before][-5:].mean() / 7544, 1, delta=0.04)
    test.assertAlmostEqual(-load[last].mean() / lift[last].mean(), 1.1 / 0.9, delta=0.01)
    test.assertAlmostEqual(-breaks(output, "place")[0, 0], 9.26, delta=0.75)
    test.assertLess(abs(last_row(output)["energy_balance_error"]),
                    0.01 * output.summary["energy"]["boundary"])


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


def check_endless_slope(test, run):
    """Ten times as fast, so that a strip joins soon, in the short form one of 12.5 m."""
    strip, end = (20, "4.7") if FULL else (12.5, "3.2")
    output = run("-time_end", end, "-boundary_push_velocity", "5,0,0", "-water_current", "5,0,0",
                 "-supply_strip", str(strip))
    supply = output.summary["supply"]
    test.assertEqual(supply["bodies"] + supply["bodies_removed"],
                     len(output.position) + supply["bodies_supplied"])
    test.assertEqual(supply["bodies_supplied"], len(output.position) * strip / 100)
    test.assertAlmostEqual(supply["momentum_supplied_x"] / supply["mass_supplied"], 5, 9)
    test.assertAlmostEqual(supply["mass_supplied"] / (strip * 10 * 0.5 * 920), 1, delta=0.03)
    test.assertGreater(output.summary["beams_broken"], 50)
    expect_ledger(test, output, 1e-3)


def check_monopile_lockin(test, run):
    """The first 12 s, in the short form 8 s, three times as fast: from 0.1 m/s to 0.24 m/s the pile
    goes with the ice."""
    begin, end = (5, 12) if FULL else (4, 8)
    output = run("-time_end", str(end), "-boundary_push_ramp", "20")
    time, speed = output.history("time"), output.history("pile_velocity_x")
    ice = 0.4 / 20 * time
    locked = (time > begin) & (time < end - 1e-3 - (1 if FULL else 0))
    test.assertGreater(np.max(speed[locked] / ice[locked]), 1.05)
    test.assertLess(np.max(speed[locked] / ice[locked]), 2)
    test.assertGreater(np.mean(speed[locked] > 0.9 * ice[locked]), 0.08)
    load = output.history("pile_force_x")[locked]
    test.assertTrue(6e5 < load.mean() < 9e5, load.mean())
    test.assertLess(load.max(), 1.4e6)
    offset = output.history("pile_x")[locked].mean() * 3.158e7
    test.assertAlmostEqual(offset / load.mean(), 1, delta=0.05)


def check_bridge_pier(test, run):
    """The first 8 s: the soil bears the load by its whole matrix, and more at times, as the pier
    swings at its own frequency."""
    output = run("-time_end", "8")
    stiffness = np.diag([1.54e9, 1.54e9, 1.59e9, 5e10, 5e10, 6.9e10])
    stiffness[0, 4] = stiffness[4, 0] = 1.54e9
    stiffness[1, 3] = stiffness[3, 1] = -1.54e9
    shear, poisson, radius, deep = 40e6, 1 / 3, 5, 3  # of the soil, and of the footing
    ratio = deep / radius
    sway = 8 * shear * radius / (2 - poisson) * (1 + ratio)
    for k, formula in ((0, sway), (2, 4 * shear * radius / (1 - poisson) * (1 + 0.54 * ratio)),
                       (4, 8 * shear * radius**3 / (3 * (1 - poisson))
                        * (1 + 2.3 * ratio + 0.58 * ratio**3)),
                       (5, 16 * shear * radius**3 / 3 * (1 + 2.67 * ratio))):
        test.assertAlmostEqual(stiffness[k, k] / formula, 1, delta=0.006)
    test.assertAlmostEqual(stiffness[0, 4] / (sway * deep / 3), 1, delta=0.006)
    time, load = output.history("time"), output.history("pier_force_x")
    late = time > 2
    motion, bears = ([output.history(f"pier_{name}")[late].mean() for name in names] for names in (
        ("x", "y", "z", "rx", "ry", "rz"),
        [f"support_{what}_{axis}" for what in ("force", "moment") for axis in "xyz"]))
    expected = -stiffness @ motion  # in the mean dashpots bear nothing
    for k in (0, 2, 4):
        test.assertAlmostEqual(bears[k] / expected[k], 1, delta=0.02)
    test.assertGreater(abs(stiffness[0, 4] * motion[4]), 0.1 * abs(expected[0]))
    test.assertAlmostEqual(-bears[0] / load[late].mean(), 1, delta=0.05)
    test.assertTrue(180e3 < load.max() < 450e3, load.max())
    most = -output.history("pier_support_force_x").min()
    test.assertTrue(1.01 < most / load.max() < 1.8, most / load.max())
    even = np.arange(2, 8, 0.01)
    swings = np.abs(np.fft.rfft(np.hanning(600) * np.interp(
        even, time, output.history("pier_spin_y"))))
    test.assertAlmostEqual(np.fft.rfftfreq(600, 0.01)[swings.argmax()], 2.45, delta=0.4)
    expect_ledger(test, output, 1e-4)


def check_moored_floater(test, run):
    """The first 12 s, in the short form 9 s: the lines bear what ice and water push."""
    end = 12 if FULL else 9
    output = run("-time_end", str(end))
    late = output.history("time") > end - (4 if FULL else 3)
    offset = output.history("hull_x")[late].mean()
    test.assertTrue(0.5 < offset < 2, offset)
    test.assertGreater(output.history("hull_force_x")[late].mean(), 2e4)
    test.assertGreater(output.summary["beams_broken"], 20)
    west, east = (output.history(f"{name}_tension")[late].mean() for name in ("nw", "ne"))
    test.assertTrue(1.6e5 < west < 2.6e5, west)
    test.assertTrue(0.7e5 < east < 1.4e5, east)
    test.assertLess(abs(output.history("hull_y")[late].mean()), 0.3 * offset)
    expect_ledger(test, output)


def check_ship(test, run):
    """The bow goes in: it is pushed back and up, and breaks ice."""
    output = run("-time_end", "3")
    time = output.history("time")
    late = time > 2
    back, up = (output.history(f"hull_force_{axis}")[late].mean() for axis in "xz")
    test.assertTrue(-45e3 < back < -15e3, back)
    test.assertTrue(1.3 < -up / back < 2.5, up / back)
    test.assertGreater(output.summary["beams_broken"], 20)
    test.assertGreater((output.folder / "pressure.csv").stat().st_size, 1000)
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-3 * energy["external"])


def check_towed_floe(test, run):
    """The line bears drag and what the floes push."""
    output = run()
    time, tension = output.history("time"), output.history("tow_tension")
    speed = np.hypot(output.history("berg_velocity_x"), output.history("berg_velocity_y"))
    for begin, end, low, high in ((15, 30, 95e3, 112e3), (30, 60, 120e3, 150e3),
                                  (65, 90, 85e3, 110e3)):
        late = (time > begin) & (time < end)
        test.assertTrue(low < tension[late].mean() < high, (begin, tension[late].mean()))
    drag = 0.901 * 144 * (1010 * speed**2 + 50 * speed)
    late = (time > 30) & (time < 60)
    ice = -output.history("berg_force_x")
    test.assertAlmostEqual((drag + ice)[late].mean() / tension[late].mean(), 1, delta=0.1)
    test.assertGreater(output.history("berg_velocity_y")[-1], 0.1)
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 1e-3 * energy["external"])
    test.assertGreater(energy["external"], 4e6)


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
        test.assertAlmostEqual(load[np.argmin(np.abs(time - moment))] / crushing, 1, delta=0.08,
                               msg=moment)
    energy = output.summary["energy"]
    test.assertGreater(energy["crushing"], 0.7 * energy["boundary"])
    expect_ledger(test, output, 1e-3)


def check_ice_vibration(test, run):
    output = run()
    time, force = output.history("time"), output.history("leg_force_x")
    crushing = time[(force > 1.45e6) & (time > 3.5) & (time < 4.5)]
    test.assertAlmostEqual(crushing[0], 3.843, delta=0.03)
    test.assertAlmostEqual(crushing[-1], 4.339, delta=0.03)
    test.assertAlmostEqual(force.max() / 1.5e6, 1, delta=0.08)
    test.assertEqual(force[(time > 3.45) & (time < 3.65)].max(), 0)
    test.assertAlmostEqual(output.summary["energy"]["balance_error"], 0, delta=10)


def check_ridge_on_leg(test, run):
    """In the short form the leg is nearer."""
    nearer = 0 if FULL else 0.5
    output = run("-time_end", "3.2" if FULL else "2.2",
                 "-obstacle_leg_base", f"{5.9 - nearer},0,-6")
    bonds = output.summary["bonds"]
    test.assertEqual((output.summary["bodies"], bonds["number"]), (403, 843))
    time, load = output.history("time"), output.history("leg_force_x")
    test.assertEqual(np.abs(load[time < (2 if FULL else 0.8)]).max(), 0)
    test.assertTrue(15e3 < load.max() < 100e3, load.max())
    test.assertTrue(100 < output.summary["beams_broken"] < 300, output.summary["beams_broken"])
    expect_ledger(test, output)


def check_keel_punch(test, run):
    """In the short form the plate begins just above the ice."""
    output = run(*(("-time_end", "1.2") if FULL else
                   ("-time_end", "0.5", "-obstacle_plate_base", "0,0,0.27")))
    test.assertEqual(output.summary["bonds"]["number"], 1874)
    lift = output.history("plate_force_z")
    test.assertTrue(15e3 < lift.max() < 35e3, lift.max())
    test.assertTrue(400 < output.summary["beams_broken"] < 1200, output.summary["beams_broken"])


def check_rafting(test, run):
    output = run("-time_end", "2" if FULL else "1")
    peak = np.abs(output.history("hold_force_x")).max() / 12e3  # kN per metre
    test.assertTrue(500 < peak < 800, peak)
    test.assertGreater(output.summary["beams_broken"], 500)
    expect_ledger(test, output, 1e-4)


def check_ridge_building(test, run):
    output = run("-time_end", "1.5" if FULL else "0.8")
    force = np.abs(output.history("hold_force_x")) / 12e3
    test.assertTrue(200 < force.max() < 450, force.max())
    test.assertLess(output.history("time")[force.argmax()], 0.6)
    test.assertGreater(output.summary["thickness"]["deviation"], 0.1)
    expect_ledger(test, output, 1e-4)
