"""Measures of docs/validation.md on ice as it is found, ridges, rubble, floes: functions of a row's
finished runs and its settings. SI units."""
import numpy as np

import floe_loads
import floe_signals
from floe_output import Output
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
        table = floe_loads.read_run(run.folder)
        record = np.abs(floe_signals.Filter("mean", length=1.0).apply(table.forces["plate"],
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
