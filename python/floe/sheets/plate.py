#!/usr/bin/python3
"""Continua to set beside sheets: the infinite floating plate under a point load (Wyman 1950) and
the half-infinite one loaded at its edge, a square block in simple shear; and the profile of a
bending run."""
import numpy as np

from floe.errors import InputError


def kei(x):
    """Kelvin's function kei of order 0, for x >= 0 of any shape.

    kei(x) = Im K0(x exp(i pi/4)), K0(z) = int_0^inf exp(-z cosh t) dt (DLMF 10.61.2, 10.32.9); the
    trapezoidal rule converges exponentially on it.
    """
    x = np.asarray(x, float)
    small = x < 1e-8
    z = np.where(small, 1.0, x) * np.exp(0.25j * np.pi)
    t = np.linspace(0, np.arccosh(40 / np.min(z.real)) if np.min(z.real) < 40 else 1.0, 4001)
    values = np.exp(-z[..., None] * np.cosh(t))
    values[..., 0] /= 2
    return np.where(small, -np.pi / 4, (values.sum(axis=-1) * (t[1] - t[0])).imag)


def wyman(ratio):
    """Deflection over w0 of the infinite plate at ratio = r / l_c."""
    return -4 / np.pi * kei(ratio)


def edge_deflection(poisson, points=400):
    """Deflection under a point load P at the free edge of a half-infinite floating plate, over P/(k
    l_c^2); the infinite plate has 1/8.

    Along the edge w = (1/pi) int_0^inf W(x, s) cos(s y) ds in units of l_c, W = A exp(-a x) + B
    exp(-b x), a^2 = s^2 + i, b^2 = s^2 - i;
    at x = 0 no moment, W_xx - nu s^2 W = 0, and the load, W_xxx - (2 - nu) s^2 W_x = 1 (Kirchhoff).
    Gauss-Legendre in s/(1 + s).
    """
    t, weight = np.polynomial.legendre.leggauss(points)
    t = (t + 1) / 2
    s = t / (1 - t)
    roots = [np.sqrt(s**2 + sign * 1j) for sign in (1, -1)]
    moment = [m**2 - poisson * s**2 for m in roots]
    shear = [-m * (m**2 - (2 - poisson) * s**2) for m in roots]
    at_edge = (moment[0] - moment[1]) / (moment[0] * shear[1] - moment[1] * shear[0])
    return float(np.sum(at_edge.real / (1 - t)**2 * weight / 2) / np.pi)


def simple_shear(poisson, cells=12):
    """Mean shear stress over G times the slope of a square of plane stress, two sides clamped and
    slid along each other, two free.

    Bilinear elements, cells x cells and twice as many, extrapolated (corners are singular; tested
    against 128 x 128).
    """
    def square(n):
        law = np.array([[1, poisson, 0], [poisson, 1, 0],
                        [0, 0, (1 - poisson) / 2]]) / (1 - poisson**2)
        one = np.zeros((8, 8))
        for s, t in [(s / np.sqrt(3), t / np.sqrt(3)) for s in (-1, 1) for t in (-1, 1)]:
            dx, dy = np.array([t - 1, 1 - t, 1 + t,
                               -1 - t]) * n / 2, np.array([s - 1, -1 - s, 1 + s, 1 - s]) * n / 2
            strain = np.zeros((3, 8))
            strain[0, ::2] = strain[2, 1::2] = dx
            strain[1, 1::2] = strain[2, ::2] = dy
            one += strain.T @ law @ strain / (4 * n * n)
        corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
        nodes = corner[:, None] + [0, 1, n + 2, n + 1]
        unknowns = np.stack([2 * nodes, 2 * nodes + 1], axis=2).reshape(-1, 8)
        matrix = np.zeros((2 * (n + 1)**2,) * 2)
        np.add.at(matrix, (unknowns[:, :, None], unknowns[:, None, :]), one)
        # rows of nodes: the first is held, the last one moved
        free = slice(2 * (n + 1), -2 * (n + 1))
        u = np.zeros(len(matrix))
        u[-2 * (n + 1)::2] = 1
        u[free] = np.linalg.solve(matrix[free, free], -(matrix @ u)[free])
        return (matrix @ u)[-2 * (n + 1)::2].sum() * 2 * (1 + poisson)
    return (4 * square(2 * cells) - square(cells)) / 3


def plate(options):
    """Characteristic length l_c [m] and w0 [m] of the scene's infinite plate (docs/model.md)."""
    value = {key: float(options[key]) for key in ("ice_young", "ice_poisson", "sheet_thickness",
                                                  "water_density",
                                                  "gravity")}
    rigidity = value["ice_young"] * value["sheet_thickness"]**3 / (12 * (1
                                                                         - value["ice_poisson"]**2))
    foundation = value["water_density"] * value["gravity"]
    if "load_names" not in options:
        raise InputError("not the output of a bending scene: it has no load")
    loads = [options[f"load_{name.strip()}_force"] for name in options["load_names"].split(",")]
    force = -sum(float(load.replace(",", " ").split()[2]) for load in loads)
    length = (rigidity / foundation)**0.25
    return length, force / (8 * foundation * length**2)


def profile(output, options):
    """Distances from the load r [m] and downward displacements since time 0 [m] along X = 0, Y >=
    0, by r."""
    moved = output.field("bodies_displacement", output.times[-1])
    since = output.field("bodies_displacement", output.times[0])
    x, y = output.position[:, 0], output.position[:, 1]
    near = (abs(x) <= float(options["sheet_element_size"]) / 2) & (y >= 0)
    near &= y <= float(options["sheet_width"]) / 2
    order = np.argsort(np.hypot(x, y)[near])
    return np.hypot(x, y)[near][order], -(moved - since)[near, 2][order]
