#!/usr/bin/python3
"""The infinite floating plate under a point load (Wyman 1950), and the profile of a bending run to set beside it."""
import numpy as np


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


def plate(options):
    """Characteristic length l_c [m] and w0 [m] of the scene's infinite plate (docs/model.md)."""
    value = {key: float(options[key]) for key in ("ice_young", "ice_poisson", "sheet_thickness", "water_density",
                                                  "gravity")}
    rigidity = value["ice_young"] * value["sheet_thickness"]**3 / (12 * (1 - value["ice_poisson"]**2))
    foundation = value["water_density"] * value["gravity"]
    loads = [options[f"load_{name.strip()}_force"] for name in options["load_names"].split(",")]
    force = -sum(float(load.replace(",", " ").split()[2]) for load in loads)
    length = (rigidity / foundation)**0.25
    return length, force / (8 * foundation * length**2)


def profile(output, options):
    """Distances from the load r [m] and downward displacements since time 0 [m] along X = 0, Y >= 0, by r."""
    moved = output.field("bodies_displacement", output.times[-1])
    since = output.field("bodies_displacement", output.times[0])
    x, y = output.position[:, 0], output.position[:, 1]
    near = (abs(x) <= float(options["sheet_element_size"]) / 2) & (y >= 0)
    near &= y <= float(options["sheet_width"]) / 2
    order = np.argsort(np.hypot(x, y)[near])
    return np.hypot(x, y)[near][order], -(moved - since)[near, 2][order]
