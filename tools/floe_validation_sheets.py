"""Measures of docs/validation.md on sheets without broken ice: functions of a row's finished runs
and its settings. SI units."""
import collections
import math
import re

import h5py
import numpy as np

from floe.errors import InputError
from floe.results.output import Output
from floe_validation_formulas import edge_uplift, first_failure, thin_floe
from floe_validation_lines import (G, RHO_WATER, Found, Line, by_point, mean_and_band,
                                   mean_force)


def southwell(run, load, width):
    """The axial load per width P [N/m] at which the deflection under a small force grows without
    end. With the deflection r per force and its value r_0 without P, P/(r - r_0) falls to 0 there
    along a line (Southwell 1932): of the last four rows in which r is over three times r_0."""
    table = run.history
    time = table["time"].to_numpy()[1:]
    moved = table[f"{load}_load_displacement_z"].to_numpy()
    compliance = np.abs(moved[1:] - moved[0]) / time  # the loads grow in proportion
    start = 2 * compliance[0] - compliance[1]
    falling = np.diff(compliance) < 0  # past the critical load
    end = int(np.argmax(falling)) + 1 if falling.any() else len(time)
    last = np.arange(max(end - 4, 0), end)
    last = last[compliance[last] > 3 * start]
    if len(last) < 2:
        raise InputError(f"{run.folder}: its deflection does not grow enough")
    line = np.polyfit(time[last] / (compliance[last] - start), time[last], 1)
    axial = abs(run.option("load_push_force")[0]) / run.option("load_push_ramp")
    return float(line[1]) * axial / width


def buckling(runs, settings):
    """Buckling loads over sqrt(k EI*) and 2 sqrt(k EI*), EI* of the same sheet bent by its ends.
    settings: allowed."""
    points, lines = by_point(runs), []
    ratios = {"free": [], "held": [], "free, theory pushed at the cells' centroids": []}
    for point in points:
        if not point.startswith("bend_"):
            continue
        what = point.removeprefix("bend_")
        stiffness, size = {}, None
        for run in points[point]:
            with h5py.File(run.folder / "lattice.h5") as file:
                x = file["bodies/position"][:, 0]
                left, right = x[file["sets/left"][:]].mean(), x[file["sets/right"][:]].mean()
            turn = 2 * abs(run.option("boundary_left_angular_velocity")[1])
            moment = np.abs([run.column(f"{side}_moment_y")[-1] for side in ("left", "right")])
            width, size = run.option("sheet_width"), run.option("sheet_element_size")
            ei = moment.mean() * (right - left) / turn / width
            inset = left + run.option("sheet_length") / 2
            k = run.option("water_density") * run.option("gravity") if (
                "water_density" in run.options) else RHO_WATER * G
            stiffness[run.seed] = k, ei, inset, width
        label = settings["labels"].get(what, what)
        for end, factor in (("free", 1), ("held", 2)):
            found, centroids = [], []
            for run in points.get(f"{end}_{what}", []):
                if run.seed not in stiffness:
                    continue
                k, ei, inset, width = stiffness[run.seed]
                critical = southwell(run, "nudge", width)
                found.append(critical / (factor * math.sqrt(k * ei)))
                rate = (k / (4 * ei))**0.25
                # an edge that reaches beyond where it is pushed rests on water there: to first
                # order P = sqrt(k EI) (1 + 2 a alpha), alpha = lambda/sqrt 2
                centroids.append(found[-1] / (1 + math.sqrt(2) * rate * inset))
            if not found:
                continue
            lines.append(Line(f"{label}, {end} end: load over {'2 ' * (factor - 1)}sqrt(k EI*)",
                              found, 1.0, settings["allowed"]))
            ratios[end].append((size, what, found))
            if end == "free":
                lines.append(Line(f"{label}, free end: the same, of a beam pushed at the cells' "
                                  "centroids", centroids, 1.0, settings["allowed"]))
                ratios["free, theory pushed at the cells' centroids"].append((size, what,
                                                                              centroids))
    series = []
    for label, found in ratios.items():
        found = sorted(one for one in found if "calibrated" not in one[1])
        series.append((label, [size for size, _, _ in found],
                       [np.mean(values) for _, _, values in found],
                       [Line("", values).band for _, _, values in found], "points"))
    return Found(lines, "size of the elements [m]", "load over theory", series)


def slope_failure(runs, settings):
    """Load on a slope just before a strip's first break over that of a beam on water. settings:
    slow [m/s], up to which theory holds, allowed."""
    lines, series = [], collections.defaultdict(list)
    for point, drawn in by_point(runs).items():
        ratios = []
        for run in drawn:
            normal = run.option("obstacle_slope_normal")
            angle = np.degrees(np.arctan2(-normal[0], normal[2]))
            with h5py.File(run.folder / "lattice.h5") as file:
                h = float(file["beams/height"][0])
                width = float(file["beams/width"][0])
            speed = run.option("boundary_push_velocity")[0]
            theory = first_failure(h, angle, run.option("obstacle_slope_friction"),
                                   run.option("fracture_tensile_strength"), settings["young"])
            time, broken = run.column("time"), run.column("beams_broken")
            if not broken.any():
                raise InputError(f"{run.folder}: nothing has broken")
            last = time[np.argmax(broken > 0) - 1]  # before the break
            load = mean_force(run, "slope", 0.99 * last, last)[0]
            ratios.append(load / width / theory)
        what = f"h = {h:g} m, {angle:.0f} degrees, {speed:g} m/s"
        slow = speed <= settings["slow"]
        lines.append(Line(f"{what}: load over theory", ratios, 1.0 if slow else None,
                          settings["allowed"] if slow else None))
        series[f"h = {h:g} m, {angle:.0f}°"].append((speed, np.mean(ratios)))
    drawn = [(label, *map(list, zip(*sorted(pairs))), None, "points")
             for label, pairs in series.items()]
    speeds = [speed for pairs in series.values() for speed, _ in pairs]
    drawn.append(("beam on water, slow", [min(speeds), max(speeds)], [1, 1], None, "line"))
    return Found(lines, "speed [m/s]", "load at the first break over theory", drawn, log="x")


def uplift(runs, settings):
    """Load of the first break at a lifted edge over theory. settings: allowed."""
    lines, series = [], {}
    for point, drawn in by_point(runs).items():
        ratios = []
        for run in drawn:
            h, size = run.option("sheet_thickness"), run.option("sheet_element_size")
            sigma = (run.option("fracture_flexural_strength")
                     if "fracture_flexural_strength" in run.options
                     else run.option("fracture_tensile_strength"))
            broken = np.flatnonzero(run.column("beams_broken") > 0)
            if len(broken):
                time = run.column("time")[broken[0]]
            else:  # the first break was the end of the run
                found = re.search(r"dynamic failure at load factor ([\d.eE+-]+)",
                                  run.summary.get("message", ""))
                if not found:
                    raise InputError(f"{run.folder}: nothing has broken")
                time = float(found[1]) * run.option("time_end")
            load = run.option("load_edge_force")[2] * time / run.option("load_edge_ramp")
            ratios.append(load / run.option("sheet_width")
                          / edge_uplift(h, sigma, run.option("ice_young")))
        calibrated = point.startswith("calibrated")
        kind = "calibrated sheet" if calibrated else "beams' own stiffness and strength"
        lines.append(Line(f"l = {size / h:g} h, {kind}: load over theory", ratios, 1.0,
                          settings["allowed"]))
        series.setdefault(kind, []).append((size / h, *mean_and_band(ratios)))
    drawn = [(label, *map(list, zip(*sorted(rows))), "points") for label, rows in series.items()]
    drawn.append(("beam on water", [min(r[0] for rows in series.values() for r in rows),
                                    max(r[0] for rows in series.values() for r in rows)],
                  [1, 1], None, "line"))
    return Found(lines, "size of the elements over thickness",
                 "load of the first break over theory", drawn)


def cantilever(runs, settings):
    """6 F L/(w h^2) of the largest force at a cantilever's tip over the sheet's flexural strength.
    settings: length, width [m], allowed."""
    lines, series = [], []
    for point, drawn in by_point(runs).items():
        ratios = []
        for run in drawn:
            h, size = run.option("sheet_thickness"), run.option("sheet_element_size")
            force = np.abs(run.column("press_force_z")).max()
            ratios.append(6 * force * settings["length"] / (settings["width"] * h**2)
                          / run.option("fracture_flexural_strength"))
        lines.append(Line(f"l = {size / h:g} h: 6 F L/(w h²) over the sheet's flexural strength",
                          ratios, None, settings["allowed"]))
        series.append((f"l = {size / h:g} h", [run.seed for run in drawn], ratios, None, "points"))
    seeds = [run.seed for run in runs]
    for edge in settings["allowed"]:
        series.append((f"published: {edge:g}", [min(seeds), max(seeds)], [edge, edge], None,
                       "line"))
    return Found(lines, "seed", "nominal strength over flexural strength", series)


def waves(runs, settings):
    """Amplitudes of heave and pitch of a floe over those of theory, by least squares over the last
    periods. settings: periods, allowed."""
    lines, series = [], {"heave": [], "pitch": []}
    for point, drawn in by_point(runs).items():
        ratios = {"heave": [], "pitch": []}
        for run in drawn:
            output = Output(run.folder)
            period, amplitude = run.option("waves_period"), run.option("waves_height") / 2
            wave = G * period**2 / (2 * np.pi)
            frequency = 2 * np.pi / period
            times = output.times[output.times > output.times[-1] - settings["periods"] * period]
            x, mass = output.position[:, 0], output.mass
            x = x - np.average(x, weights=mass)
            moved = np.array([output.field("bodies_displacement", t)[:, 2] for t in times])
            heave = moved @ mass / mass.sum()
            pitch = (moved - heave[:, None]) @ (mass * x) / (mass @ x**2)
            waves_of = np.column_stack([np.cos(frequency * times), np.sin(frequency * times),
                                        np.ones(len(times))])
            length = run.option("sheet_length")
            draft = run.option("sheet_thickness") * 920 / run.option("water_density")
            theory = thin_floe(length, wave, draft)
            for what, record, scale, expected in (
                    ("heave", heave, amplitude, theory[0]),
                    ("pitch", pitch, amplitude * 2 * np.pi / wave, theory[1])):
                fitted = np.linalg.lstsq(waves_of, record, rcond=None)[0]
                found = np.hypot(*fitted[:2]) / scale
                ratios[what].append(found / expected)
                series[what].append((wave / length, found, expected))
        for what in ratios:
            lines.append(Line(f"wave of {wave / length:.2g} lengths of the floe: {what} over "
                              "theory", ratios[what], 1.0, settings["allowed"]))
    drawn = []
    for what, rows in series.items():
        ratio, found, _ = map(list, zip(*sorted(rows)))
        drawn.append((what, ratio, found, None, "points"))
        fine = np.linspace(ratio[0], ratio[-1], 100)
        theory = [thin_floe(length, one * length, draft)[what == "pitch"] for one in fine]
        drawn.append((f"{what}, theory", list(fine), theory, None, "line"))
    return Found(lines, "wave's length over the floe's",
                 "amplitude, slope over the wave's", drawn)
