#!/usr/bin/python3
"""A turbine's tower as a modal model, coupled to ice in floe.

    PYTHONPATH=PREFIX/lib/python3/dist-packages examples/tower.py [--steps 0.1 0.05 0.025]

The tower is a rigid pile on a spring and a rotational spring below it: two modes, which scipy finds
and integrates. floe has the ice and the pile as an obstacle that Python moves. At each exchange
step H both agree on motion and load by fixed-point iteration: floe goes back to a state in memory
until the load that it finds is the one with which the tower has moved. The same pile as a structure
of floe, with mass and support, is the reference. The load is taken as linear in time within an
exchange step, so the error falls as H^2 (contacts that begin within a step are of lower order).
"""
import argparse
import tempfile
from pathlib import Path

import numpy as np
from scipy.linalg import eigh, expm

import floe

MASS, INERTIA = 2e5, 4e6  # [kg, kg m^2 about y]
STIFFNESS, TURNING = 3e7, 4e9  # of the support [N/m, N m]
DAMPING = 2e-3  # of both, as part of the stiffness [s]
CENTRE, SUPPORT = np.array([4.01, 0.0, 0.0]), np.array([4.01, 0.0, -8.0])
END, DT = 1.0, 1e-4  # [s]
SCENE = {
    "integrator": "explicit", "forces": ["beam", "contact"],
    "sheet": {"length": 6, "width": 4, "thickness": 0.4, "element_size": 1, "iterations": 10},
    "beam": {"damping_ratio": 0.1},
    "contact": {"young": 2e7, "plastic_limit": 1e6, "restitution": 1},
    "obstacle": {"names": ["pile"],
                 "pile": {"shape": "box", "centre": CENTRE, "size": [2, 2, 10]}},
    "boundary": {"names": ["push"],
                 "push": {"set": "left", "fix": "x y z rx ry rz", "velocity": [0.1, 0, 0],
                          "ramp": 0.5}},
    "time": {"end": END, "dt": DT}, "output": {"history": END}}


class Tower:
    """Displacement and rotation (x, ry) of the pile's centre by two modes."""

    def __init__(self):
        mass = np.diag([MASS, INERTIA])
        lever = np.array([1.0, SUPPORT[2] - CENTRE[2]])  # of the support's displacement
        stiffness = STIFFNESS * np.outer(lever, lever) + np.diag([0, TURNING])
        squares, self.modes = eigh(stiffness, mass)  # modes' generalised masses are 1
        self.frequencies = np.sqrt(squares) / (2 * np.pi)
        self.rates = squares
        self.place, self.speed = np.zeros(2), np.zeros(2)  # of the modes

    def moved(self, load, later, step):
        """Places and speeds of the modes after a step in which the load (Fx, My) changes linearly:
        exact, by exp of the system of q, q', f, f'."""
        place, speed = np.empty(2), np.empty(2)
        for k, (now, then) in enumerate(zip(self.modes.T @ load, self.modes.T @ later)):
            system = np.zeros((4, 4))
            system[0, 1] = system[2, 3] = 1
            system[1] = -self.rates[k], -DAMPING * self.rates[k], 1, 0
            state = self.place[k], self.speed[k], now, (then - now) / step
            place[k], speed[k], *_ = expm(step * system) @ state
        return place, speed

    def pose_and_motion(self, place, speed):
        """What the obstacle is told."""
        (x, turn), (v, spin) = self.modes @ place, self.modes @ speed
        pose = floe.Pose(CENTRE + [x, 0, 0], np.array([np.cos(turn / 2), 0, np.sin(turn / 2), 0]))
        return pose, floe.Motion(np.array([v, 0, 0]), np.array([0, spin, 0]))


def coupled(step, folder, tolerance=1e-6, most=30):
    """(exchanges + 1, 2) x and ry of the pile, and the mean number of iterations."""
    tower, load, found, tries = Tower(), np.zeros(2), [np.zeros(2)], 0
    scene = floe.Scene(SCENE, name="tower", output_dir=str(folder / f"coupled_{step:g}"))
    exchanges = round(END / step)
    if abs(round(step / DT) * DT - step) > 1e-9:
        raise ValueError(f"{step:g} s must be a multiple of {DT:g} s, floe's own step")
    with floe.Simulation(scene, coupled=["pile"]) as sim:
        pile = sim["pile"]
        scale = np.array([1e5, 1e6])  # of loads, below which changes do not count [N, N m]
        before = load
        for k in range(1, exchanges + 1):
            start = sim.save()
            later = 2 * load - before  # a guess
            relaxation, residual = 1.0, None
            for _ in range(most):
                place, speed = tower.moved(load, later, step)
                sim.restore(start)
                pile.prescribe(*tower.pose_and_motion(place, speed), until=k * step)
                sim.step_to(k * step)
                tries += 1
                wrench = pile.wrench
                new = np.array([wrench.force[0], wrench.moment[1]])
                change, last = (new - later) / scale, residual
                if np.max(np.abs(change)) <= tolerance * max(1, np.max(np.abs(new / scale))):
                    break
                if last is not None:  # Aitken
                    difference = change - last
                    relaxation *= -(last @ difference) / (difference @ difference)
                residual = change
                later = later + relaxation * change * scale
            else:
                raise RuntimeError(f"no agreement at {k * step:g} s")
            before, load = load, new
            tower.place, tower.speed = tower.moved(before, load, step)
            found.append(tower.modes @ tower.place)
    return np.array(found), tries / exchanges


def inside_floe(step, folder):
    """The same by a structure of floe."""
    pile = {**SCENE["obstacle"]["pile"], "mass": MASS, "inertia": [INERTIA] * 3,
            "support_point": SUPPORT,
            "support_stiffness": [STIFFNESS, 0, 0, 0, TURNING, 0],
            "support_damping": [DAMPING * STIFFNESS, 0, 0, 0, DAMPING * TURNING, 0]}
    scene = {**SCENE, "obstacle": {"names": ["pile"], "pile": pile}}
    scene["boundary"] = {**SCENE["boundary"], "names": ["push", "guide"],
                         "guide": {"set": "pile", "fix": "y z rx rz"}}
    found = []
    with floe.Simulation(floe.Scene(scene, name="tower",
                                    output_dir=str(folder / "inside"))) as sim:
        for k in range(round(END / step) + 1):
            sim.step_to(k * step)
            pose = sim["pile"].pose
            found.append([pose.position[0] - CENTRE[0],
                          2 * np.arctan2(pose.orientation[2], pose.orientation[0])])
    return np.array(found)


def errors(steps, folder):
    """Largest error of x at the exchanges, in parts of the largest x, for each exchange step."""
    finest = min(steps)
    inside = inside_floe(finest, folder)
    largest = np.max(np.abs(inside[:, 0]))
    found = []
    for step in steps:
        of_tower, tries = coupled(step, folder)
        every = round(step / finest)
        found.append(np.max(np.abs(of_tower[:, 0] - inside[::every, 0])) / largest)
        order = ""
        if len(found) > 1:
            before = steps[len(found) - 2]
            order = f", order {np.log(found[-2] / found[-1]) / np.log(before / step):.2f}"
        print(f"H = {step:g} s: error {found[-1]:.2e} of {largest:.3g} m, "
              f"{tries:.1f} iterations{order}", flush=True)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=float, nargs="+",
                        default=[0.1, 0.05, 0.02, 0.01, 0.005, 0.0025],
                        help="exchange steps [s], whole multiples of floe's step and of the least")
    steps = parser.parse_args().steps
    print("modes of the tower:", ", ".join(f"{f:.3g} Hz" for f in Tower().frequencies))
    with tempfile.TemporaryDirectory() as folder:
        errors(steps, Path(folder))


if __name__ == "__main__":
    main()
