"""Single beams and rigid bodies: large rotations, vibrations, waves, tops."""
import h5py
import numpy as np


def tip(output, time):
    """Displacement of the body of the set `tip` at a sample that must be there [m]."""
    if np.min(np.abs(output.times - time)) > 1e-9:
        raise AssertionError(f"fields.h5 has no sample at time {time}, only {output.times}")
    return output.field("bodies_displacement", time)[output.sets["tip"][0]]


def check_bend45(test, run):
    output = run()
    for time, expected in ((0.5, (-11.9318, -7.0447, 40.1925)), (1, (-23.5606, -13.6047, 53.4755))):
        error = np.linalg.norm(tip(output, time) - expected) / np.linalg.norm(expected)
        test.assertLess(error, 5e-4, f"time {time}: {tip(output, time)}")
    # The work of the load in every row, the first too: its mean over each step times its way.
    load, way = 600 * output.history("time"), output.history("tip_load_displacement_z")
    work = np.cumsum([0, *(0.5 * (load[1:] + load[:-1]) * np.diff(way))])
    np.testing.assert_allclose(output.history("energy_external"), work, rtol=1e-9)


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
    table = {0.1: (.05643, .30172), 0.2: (.16064, .49346), 0.5: (.38763, .71379),
             1: (.55500, .81061)}
    for time, (x, y) in table.items():
        moved = tip(output, time) / 10
        np.testing.assert_allclose([-moved[0], moved[1]], [x, y], rtol=5e-4, err_msg=f"time {time}")


def check_lee_frame(test, run):
    output = run()
    path = output.summary["path"]
    kinds = [(p["kind"], p["load_factor"]) for p in path["limit_points"]]
    test.assertEqual([kind for kind, _ in kinds], ["maximum", "minimum"])
    test.assertLess(abs(kinds[0][1] - 18.557), 0.02)
    test.assertLess(abs(kinds[1][1] + 9.414), 0.02)
    test.assertEqual(path["load_factor"], 30)
    test.assertGreater(path["snap_backs"], 3)
    factor, back = output.history("load_factor"), output.history("snap_back")
    way = -output.history("load_load_displacement_y")
    test.assertTrue(np.all(np.diff(factor)[back[1:] == 1] < 0))
    test.assertTrue(np.all(np.diff(way)[back[1:] == 1] < 0))
    test.assertTrue(np.all(np.diff(output.history("arc_length")) > 0))
    np.testing.assert_array_equal(output.history("time"), np.arange(len(factor)))


def check_arch(test, run):
    output = run()
    path = output.summary["path"]
    test.assertEqual([p["kind"] for p in path["limit_points"]], ["maximum"])
    test.assertLess(abs(path["limit_points"][0]["load_factor"] - 8.97), 0.01)
    test.assertLess(abs(output.history("crown_load_displacement_y")[-1] + 120), 1e-6)
    test.assertLess(output.history("load_factor")[-1], 8)


def check_free_top(test, run):
    output = run()
    turned = [output.field("bodies_rotation", t)[0] for t in output.times[1:]]
    angles = [np.linalg.norm(v) for v in turned]
    upright = [np.cos(a) + (1 - np.cos(a)) * (v[1] / a)**2  # R_22
               for v, a in zip(turned, angles)]
    test.assertGreater(max(upright), 0.9)
    test.assertLess(min(upright), -0.9)
    kinetic = output.history("energy_kinetic")
    test.assertLess(np.ptp(kinetic), 1e-6 * kinetic[0])


def rotations(vectors):
    """Matrices of rotation vectors, n x 3 x 3 (Rodrigues)."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None] + 1e-300
    cross = np.zeros((len(vectors), 3, 3))
    for (i, j, k), sign in (((2, 1, 0), 1), ((0, 2, 1), 1), ((1, 0, 2), 1), ((1, 2, 0), -1),
                            ((2, 0, 1), -1),
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
    # K = pi/(2 M(1, sqrt(1 - m))), M the arithmetic-geometric mean
    a, b = 1.0, np.sqrt(1 - parameter)
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2, np.sqrt(a * b)
    half_period = np.pi / a / rate
    turned = rotations(np.array([output.field("bodies_rotation", t)[0] for t in output.times]))
    along = np.einsum("nij,i->nj", turned, momentum)[:, 1]
    k = np.flatnonzero(along[:-1] * along[1:] < 0)
    passages = output.times[k] + (output.times[k + 1]
                                  - output.times[k]) * along[k] / (along[k] - along[k + 1])
    test.assertGreater(len(passages), 4)
    test.assertAlmostEqual((passages[-1] - passages[0]) / (len(passages) - 1) / half_period, 1,
                           delta=1e-4)
    kinetic = output.history("energy_kinetic")
    test.assertLess(np.ptp(kinetic), 1e-9 * kinetic[0])


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
    """First natural frequency [Hz] of a clamped-free Timoshenko beam bending along `height`: the
    smallest root of the determinant of its four end conditions (Timoshenko 1921; solutions cosh,
    sinh, cos, sin of the two wave numbers)."""
    area, inertia = width * height, width * height**3 / 12
    shear = shear_factor * young / (2 * (1 + poisson)) * area

    def determinant(omega):
        a, b, c = young * inertia, density * inertia * omega**2, density * area * omega**2
        # w'''' (EI) + w'' (rho I omega^2 + EI rho A omega^2/kGA) + w (rho I omega^4 rho A/kGA - rho
        # A omega^2) = 0
        roots = np.roots([a, b + a * c / shear, b * c / shear - c]).astype(complex)
        waves = [k for root in roots for k in (np.sqrt(root), -np.sqrt(root))]
        rows = [[1] * 4, [], [], []]
        for k in waves:
            # rotation over deflection: kGA (w'' - psi') = -rho A omega^2 w
            psi = k + c / (shear * k)
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
    """Frequency [Hz] of the largest peak of a sampled signal (Hann window, parabola through the
    peak's logarithms)."""
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
        test.assertAlmostEqual(dominant_frequency(tip_motion[:, axis], step) / expected, 1,
                               delta=0.005)


def check_wave(test, run):
    output = run()
    time = output.times[-1]
    x = output.position[:, 0] - output.position[:, 0].min()
    u = output.field("bodies_displacement", time)[:, 0]
    behind = (x > 10) & (x < 100)  # the ramp's foot is at c (t - 0.005), beyond 130 m
    slope = np.polyfit(x[behind], u[behind], 1)[0]
    test.assertAlmostEqual(-0.01 / slope / 1773.1, 1, delta=0.01)
