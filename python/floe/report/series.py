"""Series of a report: thinned so that a plot shows what they show, rounded to be short."""
import math

import numpy as np


def rounded(values, digits=5):
    """Numbers of so many digits as a list; None for what is no number."""
    return [float(f"{v:.{digits}g}") if math.isfinite(v) else None for v in values]


def thinned(x, y, bins=900):
    """x and y of at most 2 bins points that keep the smallest and the largest value of each bin."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    if len(x) <= 2 * bins:
        return x, y
    kept = {0, len(x) - 1}
    for part in np.array_split(np.arange(len(x)), bins):
        kept |= {part[np.argmin(y[part])], part[np.argmax(y[part])]}
    order = np.array(sorted(kept))
    return x[order], y[order]


def series(x, y, **more):
    """A series of a plot."""
    x, y = thinned(x, y)
    return {"x": rounded(x, 6), "y": rounded(y), **more}


def unit_of(largest):
    """A unit of force for values up to this size [N], and its name."""
    for size, name in ((1e6, "MN"), (1e3, "kN")):
        if largest >= size:
            return size, name
    return 1.0, "N"


def energy_unit(largest):
    """The same of energies [J]."""
    for size, name in ((1e9, "GJ"), (1e6, "MJ"), (1e3, "kJ")):
        if largest >= size:
            return size, name
    return 1.0, "J"
