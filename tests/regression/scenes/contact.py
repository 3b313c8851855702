"""Bodies that touch: friction, impacts, rubble."""
import h5py
import numpy as np

from launch import FULL
from scenes.shared import last_row, short


def check_stopping(test, run):
    output = run()
    row = last_row(output)
    test.assertAlmostEqual(output.field("bodies_displacement", 1.5)[0, 0] / 1.0194, 1, delta=0.01)
    test.assertAlmostEqual(row["energy_friction"] / 368, 1, delta=0.01)
    test.assertAlmostEqual(row["floor_force_z"] / -1805.04, 1, delta=0.01)
    test.assertEqual(output.summary["contacts"], 1)
    test.assertGreater(-output.summary["peak_force"]["floor"][2], 1805)
    test.assertAlmostEqual(output.summary["mean_force"]["floor"][2] / -1805.04, 1, delta=0.05)


def check_local_pressure(test, run):
    output = run()
    for time, force in zip(output.history("time"), output.history("wedge_force_x")):
        area = 8 * time
        if area > 0.5:
            pressure = max(7.4e6 * area**-0.7, 1.48e6)
            test.assertAlmostEqual(force / (pressure * area), 1, delta=1e-6, msg=f"{area} m^2")
    last = 8 * (1.5 - output.summary["dt"])  # of the last step that was made
    test.assertAlmostEqual(output.summary["peak_force"]["wedge"][0] / (1.48e6 * last), 1,
                           delta=1e-6)


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


def check_real_floe(test, run):
    output = run()
    outline = output.summary["outline"]
    test.assertEqual((outline["corners_of_file"], outline["corners"]), (98, 12))
    test.assertAlmostEqual(outline["area"] / outline["area_of_file"], 1, delta=1e-12)
    test.assertAlmostEqual(outline["area_moved"] / outline["area_of_file"], 0.014, delta=1e-3)
    with h5py.File(output.folder / "lattice.h5") as file:
        mass = file["bodies/mass"][:]
    test.assertAlmostEqual(mass.sum() / (460 * outline["area"]), 1, delta=1e-12)
    row = last_row(output)
    kinetic = output.history("energy_kinetic")[0]
    test.assertAlmostEqual(kinetic / (0.125 * mass.sum()), 1, delta=1e-9)
    test.assertLess(abs(row["energy_balance_error"]), 1e-6 * kinetic)
    x, y = (output.summary["peak_force"]["leg"][k] for k in (0, 1))
    test.assertTrue(4.5e5 < np.hypot(x, y) < 6.5e5)
    # The momentum that the floe loses goes to the leg, but for what the water takes by its drag.
    time, force = output.history("time"), output.history("leg_force_x")
    impulse = ((force[1:] + force[:-1]) / 2 * np.diff(time)).sum()
    times = output.times
    u = [output.field("bodies_displacement", t)[:, 0] for t in times]
    speed = mass @ (u[-1] - u[-2]) / mass.sum() / (times[-1] - times[-2])
    lost = mass.sum() * (0.5 - speed)
    test.assertAlmostEqual(impulse / lost, 1, delta=0.01)
    test.assertEqual(row["fragments"], 1)


def check_floe_field(test, run):
    output = run(*short("-time_end", "5"))
    outline, thickness = output.summary["outline"], output.summary["thickness"]
    test.assertEqual(outline["polygons"], 39)
    test.assertAlmostEqual(outline["area_of_file"] / (0.65 * (70 * 60 - np.pi * 25 / 2)), 1,
                           delta=1e-4)
    test.assertTrue(outline["thickness_of_file"])
    test.assertTrue(0.4 <= thickness["least"] < thickness["most"] <= 0.8)
    with h5py.File(output.folder / "lattice.h5") as file:
        mass, z = file["bodies/mass"][:], file["bodies/position"][:, 2]
    mean, area = thickness["mean"], outline["area"]
    test.assertAlmostEqual(mass.sum() / (920 * mean * area), 1, delta=1e-12)
    draft = 920 / 1010  # over the thickness
    test.assertAlmostEqual((mass @ z) / mass.sum() / (0.5 - draft), (
        mean * (1 + (thickness["deviation"] / mean) ** 2)), delta=1e-12)
    test.assertEqual(output.history("fragments")[0], 39)
    kinetic = output.history("energy_kinetic")[0]
    test.assertAlmostEqual(kinetic / (0.125 * mass.sum()), 1, delta=1e-9)
    test.assertLess(abs(last_row(output)["energy_balance_error"]), 1e-6 * kinetic)
    energy = output.summary["energy"]
    lost = sum(energy[name] for name in ("drag", "contact_viscous", "friction", "crushing"))
    test.assertAlmostEqual((kinetic - energy["kinetic"]) / lost, 1, delta=0.01)
    test.assertTrue(1e5 < output.summary["peak_force"]["leg"][0] < 3e5)
    test.assertGreater(output.summary["contacts"], 0)


def check_touching_floes(test, run):
    output = run()
    floes = output.summary["floes"]
    test.assertEqual([floes[name]["area"] for name in ("west", "lead", "east")], [120, 48, 120])
    with h5py.File(output.folder / "lattice.h5") as file:
        mass = file["bodies/mass"][:]
    sets = output.sets
    rows = output.history("beams_broken")
    test.assertGreater(rows[-1], 50)
    # The thick floes are whole: each has moved as one body.
    times, u = output.times, {}
    for name in ("west", "east"):
        u[name] = output.field("bodies_displacement", times[-1])[sets[name]][:, 0]
        test.assertLess(np.ptp(u[name]), 0.02)
    # The eastern one is pushed along, the western one comes on more slowly.
    test.assertGreater(u["east"].mean(), 0.01)
    test.assertLess(u["west"].mean(), 0.95 * 0.5 * times[-1])
    lead = output.field("bodies_displacement", times[-1])[sets["lead"]]
    test.assertGreater(np.ptp(lead[:, 0]), 0.02)
    test.assertGreater(output.history("fragments")[-1], 10)
    test.assertLess(output.history("fragments")[-1], len(sets["lead"]) + 3)
    kinetic = output.history("energy_kinetic")[0]
    test.assertAlmostEqual(kinetic / (0.125 * mass[sets["west"]].sum()), 1, delta=1e-9)
    test.assertLess(abs(last_row(output)["energy_balance_error"]), 0.01 * kinetic)


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
    end = 18 if FULL else 13
    output = run("-time_end", str(end))
    time, load = output.history("time"), output.history("plate_force_z")
    test.assertEqual(np.abs(load[time < 7.5]).max(), 0)
    test.assertGreater(load[time > end - (4 if FULL else 1)].mean(), 5 * 441)
    test.assertGreater(output.summary["peak_force"]["plate"][2], load.max() - 1e-6 * load.max())
    energy = output.summary["energy"]
    test.assertLess(abs(energy["balance_error"]), 0.01 * energy["external"])
    # over every step, where history.csv has samples
    mean = output.summary["mean_force"]["plate"][2]
    test.assertAlmostEqual(energy["external"] / (mean * end * 0.25), 1, delta=1e-3)


def check_shear_box_pour(test, run):
    end = 1.6 if FULL else 1.4
    output = run("-time_end", str(end))
    area = 6.24 * 5.46
    lift = -output.history("floor_force_z")[output.history("time") > end - 0.3].mean() / area
    test.assertAlmostEqual(lift / 11.7e3, 1, delta=0.15)
    heights = output.position[-16:, 2] + output.field("bodies_displacement", end)[-16:, 2]
    test.assertLess(np.ptp(heights), 0.02)  # the plates are one lid
    test.assertTrue(0.8 < heights.mean() < 1.6, heights.mean())


def check_shear_box(test, run):
    output = run("-time_end", "0.8" if FULL else "0.6")
    area = 6.24 * 5.46
    held = -output.history("bottom_force_x") / area
    time = output.history("time")
    test.assertTrue(5e3 < held[time < 0.25].max() < 12e3, held)  # bonds break
    test.assertAlmostEqual(held[(time > 0.14) & (time < 0.3)].mean() / 3.6e3, 1, delta=0.3)
    test.assertTrue(300 < output.summary["beams_broken"] < 1000, output.summary["beams_broken"])
    drawn = (output.history("draw_force_x") + output.history("top_force_x")) / area
    floor = output.history("floor_force_x") / area
    late = output.history("time") > 0.4
    test.assertAlmostEqual((held - floor)[late].mean() / drawn[late].mean(), 1, delta=0.1)
