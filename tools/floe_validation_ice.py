"""Measures of docs/validation.md on ice as it is found, ridges, rubble, floes: functions of a row's
finished runs and its settings. SI units."""
import numpy as np

from floe.loads import fields
from floe.loads import signals, statements
from floe.results.output import Output
from floe_validation_lines import (G, RHO_WATER, Found, Line, by_point, mean_and_band,
                                   mean_force, slope_of)


def punch(runs, settings):
    """Mean upward force on a plate in rubble over the last part of its way, over the net buoyancy
    of the blocks that move down with it. settings: last [s], allowed."""
    ratios, forces, moving, curves = [], [], [], []
    for run in runs:
        output = Output(run.folder)
        end = float(output.times[-1])
        force = -mean_force(run, "plate", end - settings["last"], end)[2]
        speed = abs(run.option("obstacle_plate_velocity")[2])
        frames = output.times[output.times >= end - settings["last"] - 1e-6]
        down = -(output.field("bodies_displacement", frames[-1])
                 - output.field("bodies_displacement", frames[0]))[:, 2]
        moves = down > 0.5 * speed * (frames[-1] - frames[0])
        net = G * (output.mass[moves] / 920 * RHO_WATER - output.mass[moves]).sum()
        forces.append(abs(force))
        moving.append(int(moves.sum()))
        ratios.append(abs(force) / net)
        table = statements.read_run(run.folder)
        record = np.abs(signals.Filter("mean", length=1.0).apply(table.forces["plate"],
                                                                 table.dt)[2])
        curves.append((np.arange(len(record)) * table.dt + 0.5, record))
    lines = [Line("residual force over the buoyancy of the blocks that move", ratios, 1.0,
                  settings["allowed"]),
             Line("residual force", forces, unit="N"), Line("blocks that move", moving)]
    series = [("seeds" if k == 0 else "", list(t), list(record / 1e3), None, "line")
              for k, (t, record) in enumerate(curves[:5])]
    return Found(lines, "time [s]", "force on the plate, mean of 1 s [kN]", series)


def ridging(runs, settings):
    """Mean force per width on the held end after the start, by rows, against thickness; its work
    over the gain of potential energy. settings: start [s], published_ratio, allowed_ratio."""
    forces, ratios = {}, {}
    for point, drawn in by_point(runs).items():
        for run in drawn:
            time, force = run.column("time"), np.abs(run.column("hold_force_x"))
            way = run.column("push_displacement_x")
            late = time >= settings["start"]
            h = run.option("sheet_thickness")
            forces.setdefault(h, {})[run.seed] = force[late].mean() / run.option("sheet_width")
            potential = run.column("energy_gravity") + run.column("energy_water")
            ratios.setdefault(h, []).append(np.trapz(force, way) / (potential[-1] - potential[0]))
    thickness = sorted(forces)
    seeds = sorted(set.intersection(*(set(found) for found in forces.values())))
    exponents = [slope_of(thickness, [forces[h][seed] for h in thickness]) for seed in seeds]
    lines = [Line("exponent of thickness in the force per width", exponents, 1.0, [1.0, 1.0],
                  by_band=True)]
    for h in thickness:
        lines.append(Line(f"h = {h:g} m: mean force per width", list(forces[h].values()),
                          unit="N/m"))
        lines.append(Line(f"h = {h:g} m: work over the gain of potential energy", ratios[h],
                          settings["published_ratio"], settings["allowed_ratio"]))
    means = [mean_and_band(list(forces[h].values())) for h in thickness]
    linear = means[0][0] / thickness[0]
    series = [("floe", thickness, [m / 1e3 for m, _ in means], [b / 1e3 for _, b in means],
               "points"), ("linear in h", thickness, [linear * h / 1e3 for h in thickness], None,
                           "line")]
    return Found(lines, "thickness [m]", "mean force per width [kN/m]", series, log="xy")


def ridge_building(runs, settings):
    """Mean force per width on the held end over the last part of the way, against thickness; its
    largest value before; the work of the push over the gain of potential energy, over the whole way
    and over its last part. settings: start (share of the way after which the last part begins),
    published_ratio, allowed_ratio."""
    found = {}
    for point, drawn in by_point(runs).items():
        for run in drawn:
            force, way = np.abs(run.column("hold_force_x")), run.column("push_displacement_x")
            work = np.concatenate([[0], np.cumsum(np.diff(way) * (force[1:] + force[:-1]) / 2)])
            potential = run.column("energy_gravity") + run.column("energy_water")
            first = int(np.searchsorted(way, settings["start"] * way[-1]))
            width = run.option("sheet_width")
            found.setdefault(run.option("sheet_thickness"), {})[run.seed] = (
                (work[-1] - work[first]) / (way[-1] - way[first]) / width,
                force[:first].max() / width,
                work[-1] / (potential[-1] - potential[0]),
                (work[-1] - work[first]) / (potential[-1] - potential[first]))
    thickness = sorted(found)
    seeds = sorted(set.intersection(*(set(of_seed) for of_seed in found.values())))
    lines = []
    for k, what in enumerate(("mean force per width", "largest force per width before")):
        if len(thickness) > 1:
            lines.append(Line(f"exponent of thickness in the {what}",
                              [slope_of(thickness, [found[h][seed][k] for h in thickness])
                               for seed in seeds], 1.0, [1.0, 1.0], by_band=True))
    for h in thickness:
        of_h = np.array(list(found[h].values())).T
        lines += [Line(f"h = {h:g} m: mean force per width", list(of_h[0]), unit="N/m"),
                  Line(f"h = {h:g} m: largest force per width before", list(of_h[1]), unit="N/m"),
                  Line(f"h = {h:g} m: work over the gain of potential energy", list(of_h[2]),
                       settings["published_ratio"], settings["allowed_ratio"]),
                  Line(f"h = {h:g} m: the same of the last part of the way", list(of_h[3]))]
    series = []
    for k, label in ((0, "mean"), (1, "largest before")):
        means = [mean_and_band([values[k] for values in found[h].values()]) for h in thickness]
        series.append((label, thickness, [m / 1e3 for m, _ in means], [b / 1e3 for _, b in means],
                       "points"))
    linear = np.mean([values[0] for values in found[thickness[0]].values()]) / thickness[0]
    series.append(("linear in h", thickness, [linear * h / 1e3 for h in thickness], None, "line"))
    return Found(lines, "thickness [m]", "force per width [kN/m]", series, log="xy")


def strips(places, top, bottom, solid, h, width, step):
    """Of columns of ice on a grid of `step` [m] in a sheet of thickness h and this width, in strips
    across the sheet 2 h long: the mean thickness from the lowest to the highest ice, voids
    included, and the ice's volume over that of one layer, both over h."""
    strip = np.floor(places[:, 0] / (2 * h)).astype(int)
    strip -= strip.min()
    thickness = np.bincount(strip, top - bottom) / np.maximum(np.bincount(strip), 1) / h
    return thickness, np.bincount(strip, solid) * step**2 / (2 * h * width) / h


def rafting(runs, settings):
    """Whether sheets that are pushed together have rafted at several times, that is whether no
    strip across them, 2 h long, is thicker than some h in the mean; the thickness where it is
    thickest, the layers of ice there, the length of what is thicker than 1.5 h, the work over the
    gain of potential energy. settings: times [s], most (thickness over h of what has rafted),
    published {point: [share of runs that raft, least, most]}, ratio {point: [published, least,
    most]}, labels {point: text}."""
    lines, series = [], []
    for point, drawn in by_point(runs).items():
        label = settings["labels"][point]
        value, *allowed = settings["published"][point]
        for end in settings["times"]:
            thickest, layers, long, ratios, profiles = [], [], [], [], []
            for run in drawn:
                h, width = run.option("sheet_thickness"), run.option("sheet_width")
                output = Output(run.folder)
                bodies = fields.Bodies(output, end)
                low, high = bodies.low.min(axis=0)[:2], bodies.high.max(axis=0)[:2]
                columns = fields.columns(bodies, h / 2, (low, high))
                thickness, number = strips(*columns, h, width, h / 2)
                thickest.append(float(thickness.max()))
                layers.append(float(number.max()))
                long.append(float(2 * (thickness > 1.5).sum()))
                profiles.append(np.sort(thickness)[::-1])
                last = run.column("time") <= end
                force, way = (np.abs(run.column("hold_force_x"))[last],
                              run.column("push_displacement_x")[last])
                potential = (run.column("energy_gravity") + run.column("energy_water"))[last]
                ratios.append(np.trapz(force, way) / (potential[-1] - potential[0]))
            what = f"{label}, {end:g} s"
            lines += [Line(f"{what}: share of the runs that have rafted",
                           [float(one <= settings["most"]) for one in thickest], value, allowed),
                      Line(f"{what}: thickness where thickest over h", thickest),
                      Line(f"{what}: layers of ice where they are most", layers),
                      Line(f"{what}: length of what is thicker than 1.5 h, over h", long)]
            short = min(map(len, profiles))
            series.append((what, list(2.0 * np.arange(short)),
                           list(np.mean([one[:short] for one in profiles], axis=0)), None, "line"))
        ratio, *allowed_ratio = settings["ratio"][point]
        lines.append(Line(f"{what}: work over the gain of potential energy", ratios, ratio,
                          allowed_ratio))
    return Found(lines, "length of the sheet that is thicker, over h", "thickness over h", series)


def porosity_within(bodies, low, high, spacing):
    """Share of a box low to high (3) [m] that is not within any body, by points on a grid."""
    axes = [np.arange(a + spacing / 2, b, spacing) for a, b in zip(low, high)]
    full = np.zeros([len(axis) for axis in axes], bool)
    for body in np.flatnonzero(np.all((bodies.low < high) & (bodies.high > low), axis=1)):
        part = tuple(slice(*np.searchsorted(axis, (a, b)))
                     for axis, a, b in zip(axes, bodies.low[body], bodies.high[body]))
        points = np.stack(np.meshgrid(*(axis[one] for axis, one in zip(axes, part)),
                                      indexing="ij"), axis=-1)
        normal, offset = bodies.planes(body)
        full[part] |= np.all(points @ normal.T <= offset, axis=-1)
    return float(1 - full.mean())


def porosity(runs, settings):
    """Porosity of rubble that has settled between walls, at the last frame, a longest side of its
    blocks within the walls and half a mean side within its mean surfaces. settings: walls (distance
    from the middle [m]), blocks (sides 3 [m]), published, allowed, judged (points of which the
    number is set beside the published one), labels {point: text}."""
    lines, labels, found = [], [], []
    for point, drawn in by_point(runs).items():
        sides = settings["blocks"][point]
        inside, mean = settings["walls"] - max(sides), float(np.mean(sides))
        shares = []
        for run in drawn:
            output = Output(run.folder)
            bodies = fields.Bodies(output, float(output.times[-1]))
            box = np.array([-inside, -inside]), np.array([inside, inside])
            _, top, bottom, _ = fields.columns(bodies, min(sides) / 2, box)
            low, high = np.median(bottom) + mean / 2, np.median(top) - mean / 2
            shares.append(porosity_within(bodies, np.append(box[0], low), np.append(box[1], high),
                                          min(sides) / 5))
        judged = point in settings["judged"]
        lines.append(Line(f"{settings['labels'][point]}: porosity", shares,
                          settings["published"] if judged else None,
                          settings["allowed"] if judged else None))
        labels.append(run.option("contact_friction"))
        found.append(mean_and_band(shares))
    series = [("floe", labels, [m for m, _ in found], [b for _, b in found], "points"),
              ("Baltic keels", [min(labels), max(labels)], [settings["published"]] * 2, None,
               "line")]
    return Found(lines, "friction between blocks", "porosity", series)


def shear_box(runs, settings):
    """Shear stress in a box, the force on its held blocks over its area: the largest mean over some
    time, which is the shear strength, and the mean over the last part. settings: mean [s], last
    (share of the time), allowed [kPa], labels {point: text}."""
    lines, series = [], []
    for point, drawn in by_point(runs).items():
        strengths, last, curves = [], [], []
        for run in drawn:
            area = np.prod(run.option("model_periodic"))
            time, stress = run.column("time"), np.abs(run.column("bottom_force_x")) / area / 1e3
            step = (time[-1] - time[0]) / (len(time) - 1)
            number = max(1, round(settings["mean"] / step))
            passed = np.convolve(stress, np.ones(number) / number, "valid")
            strengths.append(float(passed.max()))
            last.append(float(stress[time >= (1 - settings["last"]) * time[-1]].mean()))
            curves.append(passed)
        label = settings["labels"][point]
        lines += [Line(f"{label}: shear strength [kPa]", strengths, None, settings["allowed"]),
                  Line(f"{label}: shear stress of the last part [kPa]", last, None,
                       settings["allowed"])]
        short = min(map(len, curves))
        series.append((label, list(time[number - 1:][:short]),
                       list(np.mean([one[:short] for one in curves], axis=0)), None, "line"))
    return Found(lines, "time [s]", "shear stress, mean over the seeds [kPa]", series)


def keel_punch(runs, settings):
    """Shear strength of a keel from the largest force F of a punch, (F - F_b)/(pi D H): F_b the
    buoyancy of the blocks under the plate of diameter D, H the rubble's mean thickness there, both
    at the start. settings: filter [s], allowed [kPa], labels {point: text}."""
    lines, series = [], []
    for point, drawn in by_point(runs).items():
        strengths, forces, curves = [], [], []
        for run in drawn:
            output = Output(run.folder)
            radius = run.option("obstacle_plate_radius")
            centre = np.array(run.option("obstacle_plate_base")[:2])
            bodies = fields.Bodies(output, 0.0)
            under = np.linalg.norm(output.position[:, :2] - centre, axis=1) < radius
            net = G * (run.option("water_density") / 920 - 1) * output.mass[under].sum()
            places, top, bottom, _ = fields.columns(bodies, radius / 16,
                                                    (centre - radius, centre + radius))
            near = np.linalg.norm(places - centre, axis=1) < radius
            high = float((top - bottom)[near].mean())
            table = statements.read_run(run.folder)
            record = np.abs(signals.Filter("mean", length=settings["filter"]).apply(
                table.forces["plate"], table.dt)[2])
            forces.append(float(record.max()))
            strengths.append((forces[-1] - net) / (2 * np.pi * radius * high) / 1e3)
            curves.append((np.arange(len(record)) * table.dt, record))
        label = settings["labels"][point]
        lines += [Line(f"{label}: shear strength [kPa]", strengths, None, settings["allowed"]),
                  Line(f"{label}: largest force", forces, unit="N")]
        short = min(len(record) for _, record in curves)
        series.append((label, list(curves[0][0][:short]),
                       list(np.mean([record[:short] for _, record in curves], axis=0) / 1e3), None,
                       "line"))
    return Found(lines, "time [s]", "force on the plate, mean over the seeds [kN]", series)
