#!/usr/bin/python3
"""Sheets of any thickness: a plate by finite elements, random fields, grids, files, ranks."""
import json
import os
import unittest

import h5py
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as linalg
from scipy.interpolate import RectBivariateSpline

import launch
from bad_input import BadInput
from scene_runs import SceneTest, last_frame

YOUNG, POISSON, WATER, GRAVITY = 4e9, 0.3, 1010.0, 9.81
SIDE = 60.0  # [m]


def thickness(x, y):
    return 1 + 0.4 * np.sin(2 * np.pi * x / 60 + 0.5) * np.cos(2 * np.pi * y / 80)


def plate(n, height, pressure):
    """Deflection (down) of a square Kirchhoff plate on water at the (n + 1)^2 nodes of its finite
    elements, rows along y: the rectangle of Adini, Clough and Melosh with 12 unknowns
    (Zienkiewicz & Taylor 2000, vol. 2, ch. 4), integrated at 4 x 4 Gauss points with the thickness
    `height(x, y)` [m] of each, under `pressure(x, y)` [Pa]."""
    a = SIDE / n
    points, weights = np.polynomial.legendre.leggauss(4)
    powers = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3),
              (3, 1), (1, 3)]

    def terms(x, y, along, across):
        """Derivatives of the polynomial's terms."""
        def power(base, exponent, order):
            factor = 1.0
            for k in range(order):
                factor *= exponent - k
            return factor * base ** max(exponent - order, 0) if factor else 0.0
        return np.array([power(x, i, along) * power(y, j, across) for i, j in powers])

    corners = [(0, 0), (a, 0), (a, a), (0, a)]
    shape = np.linalg.inv([terms(x, y, *d) for x, y in corners for d in ((0, 0), (1, 0), (0, 1))])
    inside = [((1 + s) * a / 2, (1 + t) * a / 2, u * v * a * a / 4)
              for s, u in zip(points, weights) for t, v in zip(points, weights)]
    law = np.array([[1, POISSON, 0], [POISSON, 1, 0], [0, 0, (1 - POISSON) / 2]])
    bending, deflections = [], []
    for x, y, w in inside:
        curvature = np.array([terms(x, y, 2, 0), terms(x, y, 0, 2), 2 * terms(x, y, 1, 1)]) @ shape
        bending.append(w * curvature.T @ law @ curvature)
        deflections.append(terms(x, y, 0, 0) @ shape)
    water = WATER * GRAVITY * sum(w * np.outer(f, f) for (_, _, w), f in zip(inside, deflections))
    rows, columns, values = [], [], []
    load = np.zeros(3 * (n + 1)**2)
    for j in range(n):
        for i in range(n):
            nodes = [j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1,
                     (j + 1) * (n + 1) + i]
            unknowns = np.array([3 * node + k for node in nodes for k in range(3)])
            matrix = water.copy()
            for (x, y, w), b, f in zip(inside, bending, deflections):
                at = -SIDE / 2 + i * a + x, -SIDE / 2 + j * a + y
                matrix += YOUNG * height(*at)**3 / (12 * (1 - POISSON**2)) * b
                load[unknowns] += w * pressure(*at) * f
            rows.append(np.repeat(unknowns, 12))
            columns.append(np.tile(unknowns, 12))
            values.append(matrix.ravel())
    matrix = sp.csc_matrix((np.concatenate(values),
                            (np.concatenate(rows), np.concatenate(columns))))
    return linalg.spsolve(matrix, load)[::3].reshape(n + 1, n + 1)


def write_grid(path, height=thickness, n=121, side=SIDE):
    axis = np.linspace(-side / 2, side / 2, n)
    values = height(axis[None, :], axis[:, None])
    if path.suffix == ".csv":
        lines = ["y/x," + ",".join(f"{x:.9g}" for x in axis)]
        lines += [f"{y:.9g}," + ",".join(f"{h:.17g}" for h in row) for y, row in zip(axis, values)]
        path.write_text("\n".join(lines) + "\n")
        return
    with h5py.File(path, "w") as file:
        file["x"], file["y"], file["thickness"] = axis, axis, values


PLATE = """forces: [beam, gravity, buoyancy]
sheet: {length: 60, width: 60, element_size: 1, thickness_file: grid.csv}
ice: {young: 4e9, poisson: 0.3}
beam: {calibrate: isotropic, kinematics: linear}
region: {names: [spot], spot: {box: [-4, 4, -4, 4, -9, 9]}}
load: {names: [p], p: {set: spot, force: [0, 0, -1e5]}}
"""
FIELD = """forces: [beam, gravity, buoyancy]
sheet: {length: 40, width: 30, element_size: 2, thickness: 0.8, thickness_deviation: 0.2,
        thickness_correlation: [6, 3], thickness_seed: 5}
"""
# A sheet of uneven ice breaks against a slope: beams, cracks, water, contacts.
BREAKS = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 16, width: 8, element_size: 2, iterations: 20, thickness: 0.6,
        thickness_deviation: 0.15, thickness_correlation: [6, 6]}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 2e5, shear_strength: 2e5}
water: {drag_coefficient: 1}
contact: {young: 1e8, friction: 0.2, restitution: 0.3}
obstacle: {names: [slope], slope: {shape: halfspace, point: [9, 0, 0], normal: [-1, 0, 1]}}
boundary: {names: [push], push: {set: left, fix: x y rz, velocity: [1, 0, 0], ramp: 0.1}}
time: {end: 2.5}
checkpoint: {every: 1000}
"""


def lattice(folder):
    with h5py.File(folder / "lattice.h5") as file:
        return {key: file[key][:] for key in ("bodies/position", "bodies/mass", "beams/bodies",
                                              "beams/height")}


class Thickness(SceneTest):
    def test_a_plate_of_uneven_thickness(self):
        """Deflections under a load on 8 x 8 m: over the whole sheet within 1 % of a plate's."""
        write_grid(self.folder / "grid.csv")
        self.run_scene(PLATE)
        out = self.folder / "out/scene"
        x = lattice(out)["bodies/position"]
        found = -last_frame(out)["bodies_displacement"][:, 2]
        n = 45  # elements end where the load does
        axis = np.linspace(-SIDE / 2, SIDE / 2, n + 1)

        def expected(height):
            grid = plate(n, height, lambda x, y: 1e5 / 64 if max(abs(x), abs(y)) <= 4 else 0)
            return RectBivariateSpline(axis, axis, grid).ev(x[:, 1], x[:, 0])

        of_plate = expected(thickness)
        self.assertAlmostEqual(found @ of_plate / (of_plate @ of_plate), 1, delta=0.01)
        self.assertLess(np.sqrt(np.mean((found - of_plate)**2)) / of_plate.max(), 0.01)
        # A plate of the mean thickness is another one.
        even = expected(lambda x, y: 1.0)
        self.assertGreater(np.sqrt(np.mean((found - even)**2)) / even.max(), 0.03)
        summary = json.loads((out / "summary.json").read_text())["thickness"]
        self.assertAlmostEqual(summary["mean"], 1.0, delta=0.001)
        self.assertAlmostEqual(summary["least"], 0.6, delta=0.01)
        self.assertAlmostEqual(summary["most"], 1.4, delta=0.01)

    def test_every_column_floats_at_its_own_draft(self):
        self.run_scene(FIELD)
        out = self.folder / "out/scene"
        frame, ice = last_frame(out), lattice(out)
        self.assertLess(np.abs(frame["bodies_displacement"]).max(), 1e-9)
        self.assertLess(np.abs(frame["beams_force"]).max(), 1e-3)  # [N], of columns of 25 kN
        self.assertGreater(np.ptp(ice["bodies/position"][:, 2]), 0.2)

    def test_random_field(self):
        """Mean, deviation and correlation are those asked for, whatever the mesh."""
        large = FIELD.replace("length: 40, width: 30, element_size: 2",
                              "length: 240, width: 120, element_size: 2, iterations: 5")
        sizes = {}
        for size in (2, 3):
            self.run_scene(large, "-sheet_element_size", str(size), name=f"s{size}")
            ice = lattice(self.folder / f"out/s{size}")
            z = ice["bodies/position"][:, 2] / (0.5 - 920 / 1010)  # thickness, by its draft
            sizes[size] = ice["bodies/position"][:, :2], z
        x, h = sizes[2]
        self.assertAlmostEqual(h.mean(), 0.8, delta=0.03)
        self.assertAlmostEqual(h.std(), 0.2, delta=0.03)
        g = np.log(h)
        g = (g - g.mean()) / g.std()
        for axis, length in ((0, 6), (1, 3)):
            other = 1 - axis
            apart = np.abs(x[:, None, axis] - x[None, :, axis])
            pairs = (np.abs(apart - length) < 0.3) & \
                    (np.abs(x[:, None, other] - x[None, :, other]) < 0.5)
            i, j = np.nonzero(pairs)
            self.assertAlmostEqual((g[i] * g[j]).mean(), np.exp(-0.5), delta=0.12)
        # The field of another mesh is the same at the same places.
        near = np.hypot(*(sizes[3][0][:, None] - x[None]).transpose(2, 0, 1))
        i, j = np.nonzero(near < 0.1)
        self.assertGreater(len(i), 10)
        self.assertLess(np.abs(sizes[3][1][i] / h[j] - 1).max(), 0.03)
        self.run_scene(large, "-sheet_thickness_seed", "6", name="other")
        other = lattice(self.folder / "out/other")["bodies/position"][:, 2] / (0.5 - 920 / 1010)
        self.assertLess(abs(np.corrcoef(other, h)[0, 1]), 0.3)

    def test_files(self):
        """Tables, HDF5 and netCDF-4 hold the same grid; one thickness is the sheet of that
        thickness."""
        text = PLATE.replace("element_size: 1", "element_size: 4")
        masses = {}
        for name in ("grid.csv", "grid.h5", "grid.nc"):
            write_grid(self.folder / name)
            self.run_scene(text.replace("grid.csv", name), name=name.replace(".", "_"))
            masses[name] = lattice(self.folder / "out" / name.replace(".", "_"))["bodies/mass"]
            np.testing.assert_allclose(masses[name], masses["grid.csv"], rtol=1e-8)
        rows = (self.folder / "grid.csv").read_text().splitlines()
        turned = [",".join([row.split(",")[0], *row.split(",")[:0:-1]]) for row in rows]
        (self.folder / "grid.csv").write_text("\n".join([turned[0], *turned[:0:-1]]) + "\n")
        self.run_scene(text, name="turned")  # from north to south and from east to west
        np.testing.assert_array_equal(lattice(self.folder / "out/turned")["bodies/mass"],
                                      masses["grid.csv"])
        import netCDF4
        axis = np.array([-30.0, 30.0])
        with netCDF4.Dataset(self.folder / "even.nc", "w") as file:
            for key in ("x", "y"):
                file.createDimension(key, 2)
                file.createVariable(key, "f8", (key,))[:] = axis
            file.createVariable("thickness", "f4", ("y", "x"))[:] = 0.5
        self.run_scene(text.replace("grid.csv", "even.nc"), name="even")
        self.run_scene(text.replace("thickness_file: grid.csv", "thickness: 0.5"), name="plain")
        even, plain = (last_frame(self.folder / "out" / name) for name in ("even", "plain"))
        np.testing.assert_array_equal(even["bodies_displacement"], plain["bodies_displacement"])

    def test_what_is_no_file(self):
        (self.folder / "scene.yaml").write_text(PLATE)
        path = self.folder / "grid.csv"
        for make, part in ((path.mkdir, "is a directory, not a file"),
                           (lambda: os.mkfifo(path), "is not a regular file"),
                           (lambda: path.symlink_to("/dev/zero"), "is not a regular file"),
                           (path.touch, "is empty")):
            make()
            done = launch.run("scene.yaml", cwd=self.folder)
            self.assertEqual(done.returncode, 2)
            self.assertIn(f"sheet: thickness_file: 'grid.csv': {part}", done.stderr)
            path.rmdir() if path.is_dir() else path.unlink()

    def test_cracks_run_by_energy(self):
        self.run_scene(BREAKS, "-fracture_propagation", "energy", "-time_end", "1.5")
        rows = self.rows()
        self.assertGreater(rows["beams_broken"][-1], 1)
        work = rows["energy_boundary"][-1]
        self.assertLess(abs(rows["energy_balance_error"][-1]), 1e-3 * abs(work))

    def test_breaks_the_same_on_ranks_and_after_restarts(self):
        self.same_on_ranks_and_after_a_restart(BREAKS)
        rows = self.rows("one")
        self.assertGreater(rows["beams_broken"][-1], 3)
        work = rows["energy_boundary"][-1]
        self.assertLess(abs(rows["energy_balance_error"][-1]), 1e-3 * abs(work))


class Refused(BadInput):
    pass


def refused(title, sheet, part, grid=None):
    text = ("forces: [beam, gravity, buoyancy]\n"
            "sheet: {length: 10, element_size: 2, " + sheet + "}\n")

    def prepare(folder):
        (folder / "scene.yaml").write_text(text)
        if grid is not None:
            (folder / "grid.csv").write_text(grid)
    Refused.case(title, ["scene.yaml"], part, prepare)


FILE = "thickness_file: grid.csv"
refused("thickness beside a grid", "thickness: 1, " + FILE,
        "sheet: thickness: would have no effect",
        "a,-9,9\n-9,1,1\n9,1,1\n")
refused("a seed without a field", "thickness_seed: 3",
        "sheet: thickness_seed: would have no effect")
refused("a field without a length", "thickness_deviation: 0.1", "sheet: thickness_correlation")
refused("a grid that is not there", FILE, "grid.csv")
refused("a word in a grid", FILE, "line 2: 'ice' is not a number", "a,-9,9\n-9,ice,1\n9,1,1\n")
refused("a short row", FILE, "line 3 has 2 numbers", "a,-9,9\n-9,1,1\n9,1\n")
refused("a grid of one row", FILE, "two values of y", "a,-9,9\n-9,1,1\n")
refused("x that stays", FILE, "values of x must rise or fall", "a,-9,-9\n-9,1,1\n9,1,1\n")
refused("no ice", FILE, "thickness 0 at x = 9, y = -9", "a,-9,9\n-9,1,0\n9,1,1\n")
refused("a grid that is too small", FILE, "reaches from x = -2 to 2 m", "a,-2,2\n-9,1,1\n9,1,1\n")


if __name__ == "__main__":
    unittest.main()
