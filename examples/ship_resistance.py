#!/usr/bin/python3
"""Resistance of a ship against its speed, of the runs of input/ensembles/ship_speed.yaml, beside
Lindqvist's formula: a table, and a picture.

    floe ensemble input/ensembles/ship_speed.yaml
    examples/ship_resistance.py out/ensemble_ship_speed docs/pictures/ship_speed.png

Of each run: the mean of -hull_force_x over the way from 16 to 24 m, and the standard deviation of
its rows there, which holds the rise over that way too.
"""
import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

WAY = (16.0, 24.0)  # [m] in the ice
RAMP = 1.0  # [s] in which the ship gets up to speed
GRAVITY = 9.81


@dataclass
class Ship:
    """length, beam, draught [m] at the waterline; stem: angle of the stem to the water, entrance:
    of the waterline to the ship's axis [degrees]; the ice's thickness [m], flexural strength and
    Young's modulus [Pa], Poisson's ratio, density and the water's [kg/m^3]; friction on the hull.
    Numbers of input/ship.yaml: the waterline, half an ellipse 22.5 m long, at a quarter of the beam
    from the axis; 0.87 of the beams' strength, as sheets have in bending (docs/strength.md)."""
    length: float = 75
    beam: float = 17
    draught: float = 6
    stem: float = 25
    entrance: float = 33.2
    thickness: float = 0.5
    strength: float = 0.87 * 5e5
    young: float = 1e9
    poisson: float = 0.3
    ice: float = 920
    water: float = 1010
    friction: float = 0.1


def lindqvist(ship, speed):
    """Resistance in level ice [N] at speeds [m/s] by crushing at the stem, bending, and
    submersion: three arrays. G. Lindqvist, A straightforward method for calculation of ice
    resistance of ships, POAC 1989, vol. 2, 722-735."""
    phi, alpha = np.radians([ship.stem, ship.entrance])
    psi = np.arctan(np.tan(phi) / np.sin(alpha))
    h, beam, draught, mu = ship.thickness, ship.beam, ship.draught, ship.friction
    crushing = (0.5 * ship.strength * h**2 * (np.tan(phi) + mu * np.cos(phi) / np.cos(psi))
                / (1 - mu * np.sin(phi) / np.cos(psi)))
    plate = ship.young / (12 * (1 - ship.poisson**2) * GRAVITY * ship.water)
    bending = (27 / 64 * ship.strength * beam * h**1.5 / np.sqrt(plate)
               * (np.tan(psi) + mu * np.cos(phi) / (np.sin(alpha) * np.cos(psi)))
               * (1 + 1 / np.cos(psi)))
    bottom = (0.7 * ship.length - draught / np.tan(phi) - beam / (4 * np.tan(alpha))
              + draught * np.cos(phi) * np.cos(psi)
              * np.sqrt(1 / np.sin(phi)**2 + 1 / np.tan(alpha)**2))
    submersion = ((ship.water - ship.ice) * GRAVITY * h * beam
                  * (draught * (beam + draught) / (beam + 2 * draught) + mu * bottom))
    faster = 1 + 1.4 * speed / np.sqrt(GRAVITY * h)
    return (crushing * faster, bending * faster,
            submersion * (1 + 9.4 * speed / np.sqrt(GRAVITY * ship.length)))


def measured(folder, speed):
    """Mean and standard deviation of the resistance over WAY [N]. hull_mean_force_x is the mean of
    all steps from the start to a row."""
    with open(folder / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    time, force, since = (np.array([float(row[name]) for row in rows])
                          for name in ("time", "hull_force_x", "hull_mean_force_x"))
    way = speed * (time - RAMP / 2)
    there = (way >= WAY[0]) & (way <= WAY[1] + 1e-6)
    first, last = np.flatnonzero(there)[[0, -1]]
    impulse = time * since
    return (-(impulse[last] - impulse[first]) / (time[last] - time[first]), force[there].std())


def draw(speeds, means, deviations, file):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(6.5, 4.2), layout="constrained")
    line = np.linspace(0, 3.2, 100)
    crushing, bending, submersion = lindqvist(Ship(), line)
    axes.plot(line, (crushing + bending + submersion) / 1e3, color="#1f6f8b",
              label="Lindqvist (1989), the whole hull in ice")
    axes.plot(line, submersion / 1e3, color="#1f6f8b", linestyle="--", label="its submersion")
    axes.errorbar(speeds, np.array(means) / 1e3, np.array(deviations) / 1e3, fmt="o", capsize=3,
                  color="#d1802f", label="floe, the bow in ice (16 to 24 m of way)")
    axes.set_xlabel("speed [m/s]")
    axes.set_ylabel("resistance [kN]")
    axes.set_xlim(0, 3.2)
    axes.set_ylim(0, None)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    figure.savefig(file, dpi=150)


def main(folder, file=None):
    with open(Path(folder) / "runs.csv", newline="") as table:
        runs = [row for row in csv.DictReader(table) if row["status"] == "done"]
    speeds, means, deviations = [], [], []
    for row in runs:
        speeds.append(float(row["obstacle_hull_velocity"].split(",")[0]))
        mean, deviation = measured(Path(folder) / "runs" / row["run"], speeds[-1])
        means.append(mean)
        deviations.append(deviation)
        formula = [float(part) / 1e3 for part in lindqvist(Ship(), speeds[-1])]
        print(f"{row['run']}: {speeds[-1]:g} m/s, {mean / 1e3:.1f} +- {deviation / 1e3:.1f} kN; "
              "Lindqvist: crushing {:.0f}, bending {:.0f}, submersion {:.0f}, ".format(*formula)
              + f"together {sum(formula):.0f} kN")
    if file:
        draw(speeds, means, deviations, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
