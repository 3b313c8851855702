"""Measures of docs/validation.md on loads of structures: functions of a row's finished runs and its
settings. SI units."""
import collections
import math

import numpy as np
from scipy import stats

from floe.errors import InputError
from floe.loads import extremes, signals
from floe.results import pressure
from floe_validation_formulas import iso_crushing, iso_slope
from floe_validation_lines import (LEVEL, Found, Line, by_point, low_passed, mean_and_band,
                                   mean_force, rubble_height, slope_of)


DRAWS, SEED = 2000, 1  # of bootstraps


def ratio_of_means(one, other):
    """Mean of one over that of the other, of independent draws, and half its band by Student's t
    and the errors of both; 0 of one draw."""
    one, other = np.asarray(one, float), np.asarray(other, float)
    ratio = float(one.mean() / other.mean())
    many = min(len(one), len(other))
    if many < 2:
        return ratio, 0.0
    error = math.hypot(stats.sem(one) / one.mean(), stats.sem(other) / other.mean())
    return ratio, float(abs(ratio) * error * stats.t.ppf(0.5 + LEVEL / 2, 2 * many - 2))


def iso_terms(run, settings, strength):
    """The arguments of iso_slope but the rubble's height. strength: the scene's key of the flexural
    strength."""
    return {"h": run.option("sheet_thickness"),
            "width": settings.get("width", run.option("sheet_width")), "angle": settings["angle"],
            "friction": run.option(f"obstacle_{settings['obstacle']}_friction"),
            "sigma": run.option(strength), "young": run.option("ice_young"),
            "ice_friction": run.option("contact_friction"),
            "water": run.option("water_density"), "ice": run.option("ice_density"),
            "repose": settings["repose"]}


def iso(runs, settings):
    """Largest low-pass filtered force of each run over ISO's load with the height of the rubble at
    that time, and over that of bare ice. settings: obstacle, width [m] (default the sheet's),
    angle [degrees], filter [Hz], start [s], allowed [least, most]."""
    lines, heights, loads = [], [], []
    for point, drawn in by_point(runs).items():
        ratios, bare, of_h, forces = [], [], [], []
        for run in drawn:
            record, times = low_passed(run, settings["obstacle"], settings)
            peak = int(np.argmax(record))
            h, width = run.option("sheet_thickness"), settings.get("width",
                                                                   run.option("sheet_width"))
            raised = rubble_height(run, settings["obstacle"], times[peak], width / 2)
            given = iso_terms(run, settings, "fracture_flexural_strength")
            ratios.append(record[peak] / iso_slope(rubble=raised, **given)["H"])
            bare.append(record[peak] / iso_slope(**given)["H"])
            of_h.append(raised)
            forces.append(record[peak])
        what = f"h = {h:g} m"
        lines += [Line(f"{what}: peak over ISO with its rubble, {np.mean(of_h):.2f} m high",
                       ratios, 1 / 1.6, settings["allowed"]),
                  Line(f"{what}: peak over ISO without rubble", bare),
                  Line(f"{what}: peak", forces, unit="N")]
        heights.append((what, of_h, ratios))
        loads.append((h, mean_and_band(ratios)))
    series = [(what, raised, ratio, None, "points") for what, raised, ratio in heights]
    span = [0, max(max(raised) for _, raised, _ in heights)]
    series.append(("1/1.6 (measured over ISO)", span, [1 / 1.6] * 2, None, "line"))
    return Found(lines, "height of the rubble [m]", "peak over ISO", series)


def crushing(runs, settings):
    """Largest low-pass filtered force on a vertical leg over width and thickness, against ISO's
    pressure; exponents of width and thickness. settings: obstacle, filter, strength [Pa],
    allowed (exponents: half width of what agrees)."""
    pressures, lines = {}, []
    for point, drawn in by_point(runs).items():
        run = drawn[0]
        h, width = run.option("sheet_thickness"), 2 * run.option("obstacle_leg_radius")
        pressures[width, h] = [low_passed(run, settings["obstacle"], settings)[0].max()
                               / (width * h) for run in drawn]
    for (width, h), found in pressures.items():
        theory = iso_crushing(h, width, settings["strength"])
        lines.append(Line(f"w = {width:g} m, h = {h:g} m: pressure over ISO's",
                          [p / theory for p in found], 1.0, settings["allowed"]))
    series = []
    for what, k in (("width", 0), ("thickness", 1)):
        others = collections.Counter(key[1 - k] for key in pressures)
        fixed = others.most_common(1)[0][0]
        points = sorted(key for key in pressures if key[1 - k] == fixed)
        if len(points) < 2:
            continue
        n = min(len(pressures[key]) for key in points)
        x = [key[k] for key in points]
        found = [slope_of(x, [pressures[key][s] for key in points]) for s in range(n)]
        theory = [iso_crushing(key[1], key[0], settings["strength"]) for key in points]
        published = slope_of(x, theory)
        lines.append(Line(f"exponent of the pressure on {what}", found, published,
                          [published - settings["exponent"], published + settings["exponent"]]))
        means = [mean_and_band(pressures[key]) for key in points]
        label = f"h = {fixed:g} m" if k == 0 else f"w = {fixed:g} m"
        series += [(f"over {what} [m], {label}", x, [m / 1e6 for m, _ in means],
                    [b / 1e6 for _, b in means], "points"),
                   (f"ISO over {what}", x, [p / 1e6 for p in theory], None, "line")]
    return Found(lines, "width, thickness [m]", "pressure [MPa]", series, log="xy")


def pressure_area(runs, settings):
    """Largest mean pressure on areas of an obstacle over ISO's local pressure, and its exponent.
    settings: obstacle, areas [m2], judged {area: [least, most] of the ratio}, exponent [least,
    most] between the second and the last area."""
    areas = settings["areas"]
    curves = []
    for drawn in by_point(runs).values():
        for run in drawn:
            at, largest = pressure.area_curve(
                pressure.read(run.folder)[settings["obstacle"]])
            curves.append(np.exp(np.interp(np.log(areas), np.log(at), np.log(largest))))
    curves = np.array(curves)
    lines = [Line(f"largest pressure on {area:g} m2 over ISO's",
                  list(curves[:, k] / pressure.iso(area)),
                  *((1.0, settings["judged"][area]) if area in settings["judged"] else ()))
             for k, area in enumerate(areas)]
    lines.append(Line("exponent of the area", [slope_of(areas[1:], curve[1:]) for curve in curves],
                      -0.7, settings["exponent"]))
    found = [mean_and_band(column / 1e6) for column in curves.T]
    return Found(lines, "area [m2]", "largest mean pressure [MPa]",
                 [("floe", areas, [m for m, _ in found], [b for _, b in found], "points"),
                  ("ISO 19906", areas, list(pressure.iso(areas) / 1e6), None, "line")],
                 log="xy")


def scaling(runs, settings):
    """Cauchy-Froude: forces over s^3 at times over sqrt(s) of scenes scaled by s. settings: scales
    {point: s}, base, obstacle, exact (largest relative difference), allowed."""
    points, lines, series = by_point(runs), [], []
    base = {run.seed: run for run in points.get(settings["base"], [])}
    if not base:
        raise InputError(f"no run of the point {settings['base']} is finished")
    column = f"{settings['obstacle']}_mean_force_x"

    def impulse(run, scale):
        return run.column("time") * run.column(column) / scale**3.5

    first = next(iter(base.values()))
    series.append(("s = 1", list(first.column("time")),
                   list(first.column(f"{settings['obstacle']}_force_x") / 1e3), None, "line"))
    for point, scale in settings["scales"].items():
        before, whole, means, peaks, mean_of_base, peaks_of_base = [], [], [], [], [], []
        for run in points.get(point, []):
            if run.seed not in base:
                continue
            one = base[run.seed]
            n = min(len(run.history), len(one.history))
            a, b = impulse(one, 1)[:n], impulse(run, scale)[:n]
            apart = np.abs(a - b) / np.abs(a).max()
            broken = one.column("beams_broken")[:n] + run.column("beams_broken")[:n]
            until = int(np.argmax(broken > 0)) if broken.any() else n
            before.append(float(apart[:max(until, 1)].max()))
            whole.append(float(apart.max()))
            for kept, drawn, s in ((means, run, scale), (mean_of_base, one, 1)):
                kept.append(mean_force(drawn, settings["obstacle"])[0] / s**3)
            for kept, drawn, s in ((peaks, run, scale), (peaks_of_base, one, 1)):
                kept.append(low_passed(drawn, settings["obstacle"],
                                       {"filter": settings["filter"] / math.sqrt(s)})[0].max()
                            / s**3)
        if not before:
            continue
        lines.append(Line(f"s = {scale:g}: impulse until the first break, largest difference over "
                          "its largest", [max(before)], 0.0, [0.0, settings["exact"]]))
        lines[-1].seeds = len(before)
        exact = max(whole) <= settings["exact"]
        lines.append(Line(f"s = {scale:g}: the same, whole run", [max(whole)], 0.0 if exact else
                          None, [0.0, settings["exact"]] if exact else None))
        lines[-1].seeds = len(before)
        for what, here, there in (("mean force", means, mean_of_base),
                                  ("peak", peaks, peaks_of_base)):
            if len(here) > 1:
                here, there = np.array(here), np.array(there)
                error = np.hypot(stats.sem(here) / here.mean(), stats.sem(there) / there.mean())
                half = stats.t.ppf(0.5 + LEVEL / 2, 2 * len(here) - 2) * error
                line = Line(f"s = {scale:g}: {what} over s³ over that of s = 1, means of seeds",
                            [here.mean() / there.mean()], 1.0, [1.0, 1.0], half=float(half),
                            by_band=True)
                line.seeds = len(here)
                lines.append(line)
        run = points[point][0]
        series.append((f"s = {scale:g}, scaled", list(run.column("time") / math.sqrt(scale)),
                       list(run.column(f"{settings['obstacle']}_force_x") / scale**3 / 1e3), None,
                       "line"))
    return Found(lines, "time over √s [s]", "force over s³ [kN]", series)


def scatter(runs, settings):
    """Coefficients of variation of mean and peak over seeds, sheets with strengths that scatter
    over homogeneous ones, with bootstrap bands. settings: points [homogeneous, scattered],
    obstacle, filter, start."""
    points, lines, series = by_point(runs), [], []
    found = {}
    for point in settings["points"]:
        drawn = points.get(point, [])
        if len(drawn) < 5:
            raise InputError(f"fewer than 5 runs of {point} are finished")
        records = [low_passed(run, settings["obstacle"], settings)[0] for run in drawn]
        found[point] = {"mean": np.array([record.mean() for record in records]),
                        "peak": np.array([record.max() for record in records])}
        ordered = np.sort(found[point]["peak"]) / 1e3
        series.append((point, list(ordered), list((np.arange(len(ordered)) + 0.5) / len(ordered)),
                       None, "points"))
    generator = np.random.default_rng(SEED)

    def variation(values, axis=-1):
        return values.std(axis=axis, ddof=1) / values.mean(axis=axis)
    one, other = settings["points"]
    for what in ("mean", "peak"):
        drawn = [generator.choice(values, (DRAWS, len(values)))
                 for values in (found[one][what], found[other][what])]
        drawn = np.array([variation(one) for one in drawn])
        drawn = drawn[:, np.all(drawn > 0, axis=0)]  # without draws of one run only
        ends = np.quantile(np.log(drawn[1] / drawn[0]), [0.5 - LEVEL / 2,
                                                         0.5 + LEVEL / 2])
        ratio = variation(found[other][what]) / variation(found[one][what])
        for point in settings["points"]:
            line = Line(f"{what}, {point}: variation over seeds", [variation(found[point][what])])
            line.seeds = len(found[point][what])
            lines.append(line)
        line = Line(f"{what}: variation of {other} over that of {one}", [ratio], 1.0, [1.0, 1.0],
                    half=float(ratio * (np.exp((ends[1] - ends[0]) / 2) - 1)), by_band=True)
        line.seeds = min(len(values[what]) for values in found.values())
        lines.append(line)
        line = Line(f"{what}: mean of {other} over that of {one}",
                    [found[other][what].mean() / found[one][what].mean()])
        line.seeds = lines[-1].seeds
        lines.append(line)
    return Found(lines, "peak of a run [kN]", "share of the runs below", series)


def wide(runs, settings):
    """Peaks per width of cones against their width over thickness, over that of the narrowest,
    beside the same of ISO's load of bare ice. settings: obstacle, angle, filter, start, allowed."""
    found = {}
    for point, drawn in by_point(runs).items():
        for run in drawn:
            name = settings["obstacle"]
            base, top = run.option(f"obstacle_{name}_radius"), run.option(
                f"obstacle_{name}_top_radius")
            height = run.option(f"obstacle_{name}_height")
            foot = run.option(f"obstacle_{name}_base")[2]
            width = 2 * (base + (top - base) * -foot / height)
            angle = float(np.degrees(np.arctan2(height, base - top)))
            record, _ = low_passed(run, name, settings)
            h = run.option("sheet_thickness")
            iso_load = iso_slope(h, width, angle, run.option(f"obstacle_{name}_friction"),
                                 run.option("fracture_flexural_strength"), run.option("ice_young"))
            found.setdefault(round(width, 6), []).append(
                (record.max() / width, record.mean() / width, record.std() / record.mean(),
                 iso_load["H"] / width))
    widths, lines = sorted(found), []
    narrow = np.array(found[widths[0]])
    for width in widths:
        values = np.array(found[width])
        what = f"D/h = {width / h:.0f}"
        lines.append(Line(f"{what}: peak per width", list(values[:, 0]), unit="N/m"))
        lines.append(Line(f"{what}: deviation over mean, in time", list(values[:, 2])))
        if width > widths[0]:
            ratio, half = ratio_of_means(values[:, 0], narrow[:, 0])
            theory = values[0, 3] / narrow[0, 3]
            line = Line(f"{what}: peak per width over that of D/h = {widths[0] / h:.0f}",
                        [ratio], theory, [theory * one for one in settings["allowed"]], half=half)
            line.seeds = min(len(values), len(narrow))
            lines.append(line)
    x = [width / h for width in widths]
    columns = [[mean_and_band(np.array(found[width])[:, k]) for width in widths] for k in (0, 1)]
    series = [(label, x, [m / 1e3 for m, _ in column], [b / 1e3 for _, b in column], "points")
              for label, column in zip(("peaks", "means"), columns)]
    series.append(("ISO, bare ice", x, [found[width][0][3] / 1e3 for width in widths], None,
                   "line"))
    return Found(lines, "D/h", "force per width [kN/m]", series, log="xy")


def endless(runs, settings):
    """The load of ice without end on a slope: mean, deviation in time, largest means over some
    time, largest low-pass filtered value over ISO's load, Gumbel's law of these over the seeds;
    trend. settings: obstacle, angle [degrees], repose, filter [Hz], start [s], mean [s], allowed
    [least, most]."""
    name, found = settings["obstacle"], []
    for run in runs:
        record, times = low_passed(run, name, settings)
        step = times[1] - times[0]
        peak = int(np.argmax(record))
        given = iso_terms(run, settings, "fracture_tensile_strength")
        raised = rubble_height(run, name, times[peak], given["width"] / 2)
        number = max(1, round(settings["mean"] / step))
        running = np.convolve(record, np.ones(number) / number, "valid")
        trend = signals.trend([record], step)
        half = len(record) // 2
        found.append({"mean": record.mean(), "deviation": record.std(), "peak": record[peak],
                      "running": running.max(), "height": raised,
                      "ratio": record[peak] / iso_slope(rubble=raised, **given)["H"],
                      "bare": record[peak] / iso_slope(**given)["H"],
                      "trend": float(trend is not None and trend["p"] < 0.05),
                      "halves": record[half:].mean() / record[:half].mean(),
                      "time": times, "record": record})

    def of(key):
        return [float(one[key]) for one in found]
    lines = [Line(f"largest value over ISO with its rubble, {np.mean(of('height')):.2f} m high",
                  of("ratio"), 1 / 1.6, settings["allowed"]),
             Line("largest value over ISO without rubble", of("bare")),
             Line("largest value", of("peak"), unit="N"),
             Line(f"largest mean of {settings['mean']:g} s", of("running"), unit="N"),
             Line("mean", of("mean"), unit="N"),
             Line("deviation in time", of("deviation"), unit="N"),
             Line("share of the records with a trend (Mann and Kendall, p < 0.05)", of("trend")),
             Line("mean of the second half over that of the first", of("halves"))]
    peaks = np.array(of("peak"))
    if len(peaks) > 1:
        mu, beta = extremes.fit(peaks, "moments")
        for p in (0.5, 0.01):
            low, high = extremes.band(mu, beta, len(peaks), p, "moments")
            line = Line(f"Gumbel's law of the largest values: exceeded with probability {p:g}",
                        [float(extremes.quantile(mu, beta, p))], unit="N",
                        half=float(high - low) / 2)
            line.seeds = len(peaks)
            lines.append(line)
    series = []
    for k, one in enumerate(found[:3]):
        coarse = max(1, len(one["record"]) // 600)
        whole = len(one["record"]) // coarse * coarse
        series.append((f"seed {runs[k].seed}", list(one["time"][:whole:coarse]),
                       list(one["record"][:whole].reshape(-1, coarse).max(axis=1) / 1e3), None,
                       "line"))
    return Found(lines, "time [s]", "load [kN]", series)


def floe_shape(runs, settings):
    """Mean and deviation in time of the load of floes of several shapes on an obstacle, those of
    one shape over those of the others. settings: obstacle, filter [Hz], start [s], shape (its
    point), labels {point: text}, allowed [least, most]."""
    found, lines = {}, []
    for point, drawn in by_point(runs).items():
        records = [low_passed(run, settings["obstacle"], settings)[0] for run in drawn]
        found[point] = {"mean": [float(record.mean()) for record in records],
                        "deviation in time": [float(record.std()) for record in records]}
        for what, values in found[point].items():
            lines.append(Line(f"{settings['labels'][point]}: {what} of the load", values, unit="N"))
    shape, points = settings["shape"], list(found)
    for point in points:
        for what in found[point] if point != shape and shape in found else ():
            ratio, half = ratio_of_means(found[shape][what], found[point][what])
            line = Line(f"{what} of the load, {settings['labels'][shape]} over "
                        f"{settings['labels'][point]}", [ratio], None, settings["allowed"],
                        half=half, by_band=True)
            line.seeds = min(len(found[shape][what]), len(found[point][what]))
            lines.append(line)
    series = [(settings["labels"][point], [v / 1e3 for v in found[point]["mean"]],
               [v / 1e3 for v in found[point]["deviation in time"]], None, "points")
              for point in points]
    return Found(lines, "mean load of a run [kN]", "deviation in time [kN]", series)


def lock_in(runs, settings):
    """Largest velocity of a structure in the second half of a run over that of the ice that is
    driven. settings: structure, published (ratios by the points' names), allowed (the part that a
    ratio may differ by; a fifth of it where none is published)."""
    lines, ice, found = [], [], []
    for run in runs:
        time, velocity = (run.column(name) for name in
                          ("time", f"{settings['structure']}_velocity_x"))
        speed = run.option("boundary_ice_velocity")[0]
        ratio = velocity[time > time[-1] / 2].max() / speed
        published, part = settings["published"][run.point], settings["allowed"]
        allowed = ([published * (1 - part), published * (1 + part)] if published
                   else [-part / 5, part / 5])
        lines.append(Line(f"ice at {speed:g} m/s", [ratio], published, allowed))
        ice.append(speed)
        found.append(ratio * speed)
    goal = [settings["published"][run.point] * speed for run, speed in zip(runs, ice)]
    return Found(lines, "speed of the ice [m/s]", "largest velocity of the leg [m/s]",
                 [("floe", ice, found, None, "points"), ("published", ice, goal, None, "line"),
                  ("the ice", ice, ice, None, "line")])
