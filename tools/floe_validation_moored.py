"""Measures of docs/validation.md on moored structures: functions of a row's finished runs and its
settings. SI units."""
import numpy as np
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from floe.errors import InputError
from floe_validation_lines import (Found, Line, by_point, low_passed, mean_and_band, mean_force,
                                   slope_of)
from floe_validation_loads import ratio_of_means


COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")


def centre_of_frustum(run, name):
    """Centroid of a cone obstacle."""
    low, high, height = (run.option(f"obstacle_{name}_{key}")
                         for key in ("radius", "top_radius", "height"))
    up = height / 4 * (low**2 + 2 * low * high + 3 * high**2) / (low**2 + low * high + high**2)
    return np.array(run.option(f"obstacle_{name}_base")) + [0, 0, up]


def force_of_lines(run, name, motion):
    """Force (3) of the mooring lines of a stiffness on a cone that has moved by `motion` (6): its
    centroid's displacement [m] and its rotation vector [rad]."""
    centre, total = centre_of_frustum(run, name), np.zeros(3)
    turn = Rotation.from_rotvec(motion[3:])
    for line in run.options["line_names"].replace(",", " ").split():
        if f"line_{line}_stiffness" not in run.options:
            raise InputError(f"{run.name}: line {line} has no stiffness; a table is not read here")
        fairlead, anchor = (np.array(run.option(f"line_{line}_{key}"))
                            for key in ("fairlead", "anchor"))
        way = anchor - (centre + motion[:3] + turn.apply(fairlead - centre))
        longer = np.linalg.norm(way) - np.linalg.norm(anchor - fairlead)
        tension = run.option(f"line_{line}_pretension") + run.option(
            f"line_{line}_stiffness") * longer
        total += max(tension, 0.0) * way / np.linalg.norm(way)
    return total


def mean_motion(run, name, start):
    """Mean displacement and rotation (6) of a structure after a time."""
    late = run.column("time") >= start
    return np.array([run.column(f"{name}_{component}")[late].mean() for component in COMPONENTS])


def drag_law(calm, name):
    """The drag on a structure [N] at relative speeds of the water [m/s], as a function: linear and
    quadratic parts, from runs without ice in two currents or more, in whose second halves the lines
    bear the drag."""
    speeds = np.array([run.option("water_current")[0] for run in calm])
    if len(set(speeds)) < 2:
        raise InputError("the drag needs finished runs without ice in two currents")
    drags = [-force_of_lines(run, name, mean_motion(run, name, run.column("time")[-1] / 2))[0]
             for run in calm]
    parts = np.linalg.lstsq(np.column_stack([speeds, speeds * abs(speeds)]), drags, rcond=None)[0]
    return lambda speed: parts[0] * speed + parts[1] * speed * abs(speed)


def statics(run, name, start, drag):
    """Mean offset along x after a time over that at which the lines bear the mean load: that of the
    ice and the drag (a function of the relative speed), less what changes the structure's
    momentum."""
    time, speed = run.column("time"), run.column(f"{name}_velocity_x")
    first = int(np.argmax(time >= start))
    inertia = run.option(f"obstacle_{name}_mass") + run.option(f"obstacle_{name}_added_mass")[0]
    gained = inertia * (speed[-1] - speed[first]) / (time[-1] - time[first])
    in_water = float(np.mean(drag(run.option("water_current")[0] - speed[first:])))
    load = mean_force(run, name, time[first])[0] + in_water - gained
    motion = mean_motion(run, name, start)

    def rest(x):
        return load + force_of_lines(run, name, np.append(x, motion[1:]))[0]
    reach = 1.0
    while rest(reach) > 0 or rest(-reach) < 0:
        reach *= 2
    return float(motion[0] / brentq(rest, -reach, reach))


def moored(runs, settings):
    """Mean load on a moored cone over that on the same cone held fast; the mean offset over that of
    the lines under the mean load. settings: obstacle, start [s], filter [Hz], calm (points
    that ice does not reach, in two currents), pairs {moored point: fixed point}, allowed [least,
    most], statics (what the offset may differ by)."""
    name, start, points = settings["obstacle"], settings["start"], by_point(runs)
    drag = drag_law([run for point in settings["calm"] for run in points.get(point, [])], name)
    lines, loads = [], {"moored": {}, "fixed": {}}
    for point, fixed in settings["pairs"].items():
        both = points.get(point, []), points.get(fixed, [])
        if not all(both):
            continue
        h = both[0][0].option("sheet_thickness")
        means = [[mean_force(run, name, start)[0] for run in drawn] for drawn in both]
        peaks = [[low_passed(run, name, settings)[0].max() for run in drawn] for drawn in both]
        for what, values in (("moored", means[0]), ("fixed", means[1])):
            loads[what][h] = values
            lines.append(Line(f"h = {h:g} m: mean load, {what}", values, unit="N"))
        ratio, half = ratio_of_means(*means)
        line = Line(f"h = {h:g} m: mean load, moored over fixed", [ratio], 1.0,
                    settings["allowed"], half=half, by_band=True)
        line.seeds = min(map(len, both))
        lines.append(line)
        ratio, half = ratio_of_means(*peaks)
        line = Line(f"h = {h:g} m: peak, moored over fixed", [ratio], half=half)
        line.seeds = min(map(len, both))
        lines.append(line)
        lines.append(Line(f"h = {h:g} m: mean offset over that of statics",
                          [statics(run, name, start, drag) for run in both[0]], 1.0,
                          [1 - settings["statics"], 1 + settings["statics"]]))
        lines.append(Line(f"h = {h:g} m: mean offset",
                          [mean_motion(run, name, start)[0] for run in both[0]], unit="m"))
    if not lines:
        raise InputError("no thickness has a moored and a fixed run that are finished")
    for what, found in loads.items():
        number = min(map(len, found.values()))
        if len(found) > 1:
            lines.append(Line(f"exponent of the mean load on thickness, {what}",
                              [slope_of(list(found), [found[h][k] for h in found])
                               for k in range(number)]))
    series = []
    for what, found in loads.items():
        bands = [mean_and_band(values) for values in found.values()]
        series.append((what, list(found), [m / 1e3 for m, _ in bands], [b / 1e3 for _, b in bands],
                       "points"))
    return Found(lines, "thickness [m]", "mean load [kN]", series)
