"""What the rows of docs/validation.md find, Line and Found, and what their measures share. SI
units."""
import dataclasses
import math

import numpy as np
from scipy import stats

from floe.loads import fields
from floe.loads import signals, statements
from floe.results.output import Output


G = 9.81
RHO_WATER = 1010.0
LEVEL = 0.95  # of bands of means


@dataclasses.dataclass
class Line:
    """One comparison of a row. values: floe's, one per seed (or one); published: the number beside
    it or None; allowed: [least, most] that agrees, or None if nothing is published; half: half the
    band of the mean where it is not Student's over `values`. by_band: it agrees where the band of
    the mean meets `allowed`, as for a difference of statistics. seeds: how many it is of, where not
    one per value."""
    what: str
    values: list
    published: object = None
    allowed: object = None
    unit: str = ""
    half: object = None
    by_band: bool = False
    seeds: object = None

    @property
    def draws(self):
        """Number of seeds behind it."""
        return self.seeds or len(self.values)

    @property
    def mean(self):
        return float(np.mean(self.values))

    @property
    def band(self):
        """Half the confidence band of the mean by Student's t over the seeds, 0 of one value."""
        if self.half is not None:
            return self.half
        n = len(self.values)
        return float(stats.t.ppf(0.5 + LEVEL / 2, n - 1) * stats.sem(self.values)) if n > 1 else 0.0

    @property
    def deviation(self):
        """Of the mean from what is published, over that; None where nothing is, or it is 0."""
        return self.mean / self.published - 1 if self.published else None

    @property
    def verdict(self):
        """agrees, disagrees, or "" where nothing is published, or one seed has no band."""
        if self.allowed is None or self.by_band and self.draws < 2:
            return ""
        slack = self.band if self.by_band else 0.0
        low, high = self.allowed
        return "agrees" if low - slack <= self.mean <= high + slack else "disagrees"


@dataclasses.dataclass
class Found:
    """What a row's runs give. series: [(label, x, y, half bands or None, "points" or "line")], x
    and y: labels of the axes; log: the axes that are logarithmic, "", "x" or "xy"."""
    lines: list
    x: str
    y: str
    series: list
    log: str = ""


def by_point(runs):
    """{name of the point: its runs by seed}, in the order of the spec."""
    found = {}
    for run in runs:
        found.setdefault(run.point, []).append(run)
    return found


def mean_and_band(values):
    line = Line("", list(values))
    return line.mean, line.band


def low_passed(run, obstacle, settings):
    """The horizontal force on an obstacle [N] after the start, low-pass filtered, and its times."""
    drawn = statements.read_run(run.folder)
    frequency, start = settings.get("filter", 1.0), settings.get("start", 0.0)
    passed = signals.Filter("low-pass", frequency=frequency).apply(drawn.forces[obstacle],
                                                                   drawn.dt)
    skip = round(start / drawn.dt)
    record = np.hypot(passed[0], passed[1])[skip:]
    return record, (skip + np.arange(len(record)) + 0.5) * drawn.dt


def mean_force(run, obstacle, start=0.0, end=math.inf):
    """Mean force on an obstacle (3) [N] between two times, of all steps."""
    table = run.history
    time = table["time"].to_numpy()
    impulse = time[:, None] * table[[f"{obstacle}_mean_force_{a}" for a in "xyz"]].to_numpy()
    ends = np.clip([start, min(end, time[-1])], time[0], time[-1])
    at = np.stack([np.interp(ends, time, column) for column in impulse.T])
    return (at[:, 1] - at[:, 0]) / (ends[1] - ends[0])


def rubble_height(run, obstacle, time, half):
    """Mean over the structure's width, in eight parts, of the highest ice within 1.5 widths in
    front of it or on it [m above water] at the frame nearest to a time."""
    output = Output(run.folder)
    time = output.times[np.argmin(np.abs(output.times - time))]
    bodies = fields.Bodies(output, time)
    front = run.option("sheet_length") / 2
    middle = (bodies.low + bodies.high) / 2
    near = middle[:, 0] > front - 3 * half
    parts = np.linspace(-half, half, 9)
    tops = [bodies.high[near & (bodies.low[:, 1] < b) & (bodies.high[:, 1] > a), 2]
            for a, b in zip(parts, parts[1:])]
    return float(np.mean([top.max(initial=0.0) for top in tops]))


def slope_of(x, y):
    """Slope of log y over log x."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])
