#!/usr/bin/python3
"""Strengths of sheets from the histories of their runs, and statistics of them."""
import csv
import re
from pathlib import Path

import numpy as np


def history(folder):
    """Rows of a run's history.csv as {column: number}."""
    with open(Path(folder) / "history.csv", newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def of_tension(rows, nominal):
    """{"first", "largest"}: force over `nominal` at the first break and at its largest.

    rows: of history.csv, of a run by prescribed displacements that grow with time. Rows are states
    after the breaks at their time. Between rows beams that break at once (brittle) leave the rest
    linear, so the force before the breaks of a step is that of the row before, times the times'
    ratio: as sharp as the step that led there (floe: 0.5 %).
    """
    times = [row["time"] for row in rows]
    forces = [abs(row["right_force_x"]) for row in rows]
    broken = [row["beams_broken"] for row in rows]
    peaks = [forces[k - 1] * times[k] / times[k - 1] if broken[k] > broken[k - 1]
             and times[k - 1] > 0 else forces[k]
             for k in range(1, len(rows))]
    first = next((k for k in range(1, len(rows)) if broken[k] > 0), None)
    if first is None:
        raise ValueError("nothing has broken")
    return {"first": peaks[first - 1] / nominal, "largest": max(peaks) / nominal}


def of_bending(rows, message, most):
    """The same of moments that grow with time until no equilibrium is left, as the run's message
    says.

    most: moment over the nominal one at the end of the ramp.
    """
    found = re.search(r"dynamic failure at load factor ([\d.eE+-]+):", message)
    if not found:
        raise ValueError(f"no dynamic failure: {message}")
    last = float(found[1])  # of the end of the ramp; at most 0.5 % above what starts the failure
    broken = [row["time"] for row in rows if row["beams_broken"] > 0]
    first = broken[0] if broken else last * most  # the scene's ramp ends at time `most`
    return {"first": first, "largest": last * most}


def mean_and_deviation(values):
    if not len(values):
        return ""
    spread = f" ± {np.std(values, ddof=1):.3f}" if len(values) > 1 else ""
    return f"{np.mean(values):.3f}{spread}"


def slope(of_size):
    """Slope of log(mean) over log(size) by least squares, with its standard error from the means'
    own, as text."""
    if len(of_size) < 2:
        return ""
    x = np.log([size for size in of_size])
    y = np.log([np.mean(values) for values in of_size.values()])
    error = [np.std(values, ddof=1) / np.mean(values) / np.sqrt(len(values)) if len(values) > 1
             else 0
             for values in of_size.values()]
    weights = (x - x.mean()) / np.sum((x - x.mean())**2)
    return f"{weights @ y:.3f} ± {np.linalg.norm(weights * error):.3f}"
