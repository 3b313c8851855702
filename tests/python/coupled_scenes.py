"""Scenes and comparisons that several tests of the Python package share."""
import gc
import resource

import h5py
import numpy as np

# Ice that drives against a cone, breaks and slides past.
CONE = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
ice: {young: 4e8}
sheet: {length: 12, width: 8, thickness: 0.5, element_size: 1, iterations: 20}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 1e5, shear_strength: 1e5, energy: 15}
water: {drag_linear: 200, current: [1, 0, 0]}
contact: {young: 1e7, friction: 0.2, restitution: 0.3, plastic_limit: 1e6}
obstacle:
  names: [cone]
  cone: {shape: cone, base: [7.6, 0, -3], radius: 2, top_radius: 1, height: 5, friction: 0.1MORE}
boundary: {names: [push], push: {set: left, fix: x y rz, velocity: [1, 0, 0], ramp: 0.1}}
time: {end: 0.4, dt: 2e-4}
output: {history: 0.02, fields: 0.1}
checkpoint: {every: 1000}
"""
# The same with a cone that ice moves.
LEG = CONE.replace("MORE", ", mass: 2e4, support_stiffness: [2e6, 2e6, 1e7, 1e7, 1e7, 1e7], "
                           "support_damping_ratio: 0.02")
CONE = CONE.replace("MORE", "")
# Two blocks that fly apart from everything.
BLOCKS = {"integrator": "explicit", "forces": ["beam"],
          "sheet": {"length": 6, "width": 4, "thickness": 0.5, "element_size": 1,
                    "iterations": 5},
          "beam": {"damping_ratio": 0.1}, "time": {"end": 0.1, "dt": 2e-4},
          "output": {"history": 0.01}}


def contents(path, *without):
    """Every dataset and attribute of an HDF5 file, but those named."""
    found = {}

    def visit(name, item):
        for key, value in item.attrs.items():
            found[name + "@" + key] = value
        if isinstance(item, h5py.Dataset) and name not in without:
            found[name] = item[()]
    with h5py.File(path) as file:
        file.visititems(visit)
    return found


def assert_same_run(test, one, other, *without):
    """Two output folders hold the same bits: rows, frames, breaks, checkpoint."""
    names, others = ({str(p.relative_to(folder)) for p in folder.rglob("*.h5")}
                     - {"checkpoint_previous.h5"} for folder in (one, other))
    test.assertEqual(names, others)
    test.assertIn("history.csv", {p.name for p in one.iterdir()})
    test.assertEqual((one / "history.csv").read_bytes(), (other / "history.csv").read_bytes())
    for name in sorted(names - {"fields.h5"}):  # links
        a, b = (contents(folder / name, "output/run", "options", "scene", *without)
                for folder in (one, other))
        test.assertEqual(set(a), set(b), name)
        for key, value in a.items():
            np.testing.assert_array_equal(value, b[key], f"{name}: {key}")


def last(sim):
    """Places, rotations and velocities of all bodies."""
    return np.hstack([sim.bodies.position, sim.bodies.orientation, sim.bodies.velocity])


def memory():
    """Resident memory of this process [MB]."""
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6
