"""What a report says of an ensemble: the law of its maxima, loads of all its runs, a table of them.
Plain numbers and words, for the page (web/page.js)."""
import csv
import os
from pathlib import Path

import numpy as np

from floe.errors import InputError, reading
from floe.loads import extremes
from floe.loads import statements
from floe.report.run import COLOURS, centred, log_of, number, slim
from floe.report.series import rounded, series, unit_of

COURSES = 12  # runs whose loads are drawn, at most
RUN_COLOURS = [*COLOURS, "#7cb518", "#ff924c", "#1982c4", "#6a4c93"]


def runs_in(folder):
    """Folders of runs below a folder, by name."""
    found = sorted(path.parent for path in Path(folder).rglob("summary.json")
                   if (path.parent / "options.yaml").exists())
    if not found:
        raise InputError(f"{folder} is no output folder and has none below (no summary.json)")
    return found


def exceedance(statement, size):
    """Maxima against how often they are exceeded, Gumbel's law by likelihood with its band."""
    maxima = np.sort(statement["maxima"])
    found = [{"x": rounded(maxima / size), "y": rounded(extremes.positions(len(maxima))),
              "name": "maxima", "colour": COLOURS[1], "points": True}]
    if not statement["gumbel"]:
        return found
    law = statement["gumbel"]["likelihood"]
    probability = np.geomspace(0.98, min(0.01, 0.3 / len(maxima)), 40)
    values = extremes.quantile(law["mu"], law["beta"], probability)
    ends = np.array([extremes.band(law["mu"], law["beta"], len(maxima), p, "likelihood")
                     for p in probability])
    for k, name in enumerate(("95 % band of the law", "")):
        found.append({"x": rounded(ends[:, k] / size), "y": rounded(probability), "name": name,
                      "colour": COLOURS[0], "dash": "4 3", "width": 1, "silent": k > 0})
    found.append({"x": rounded(values / size), "y": rounded(probability),
                  "name": "Gumbel, likelihood", "colour": COLOURS[0]})
    return found


def group_of(parameters, runs, name, settings):
    """Runs that differ by their seeds only, as draws of one law of the load on an obstacle."""
    found = statements.state(runs, name, settings)
    raw, filtered = statements.records(runs, name, settings)
    size, unit = unit_of(max(record.max() for record in raw))
    words = ", ".join(f"{key} {value}" for key, value in parameters.items())
    courses = [series(centred(passed, record, runs[0].dt, settings.start), passed / size,
                      name=run.name, colour=RUN_COLOURS[k % len(RUN_COLOURS)], width=1, opacity=0.8)
               for k, (run, record, passed) in enumerate(zip(runs, raw, filtered)) if k < COURSES]
    density = np.array(found["spectrum"]["density"][1:]) / size**2
    return {"title": f"Load on {name}" + (f": {words}" if words else ""), "unit": unit,
            "statement": slim(found), "exceedance": exceedance(found, size), "courses": courses,
            "spectrum": [{"x": rounded(found["spectrum"]["frequency"][1:]), "y": rounded(density),
                          "name": "density", "colour": COLOURS[0]}]}


def table_of(folder):
    """runs.csv of an ensemble's folder as {run: row}; empty without one."""
    path = Path(folder) / "runs.csv"
    if not path.exists():
        return {}
    with reading(path), open(path, newline="") as file:
        return {row["run"]: row for row in csv.DictReader(file)}


def rows_of(folder, beside, runs, groups, settings):
    """The table of runs: [name, link to its report or nothing, cells], its head and which cells are
    numbers. beside: folder of the ensemble's report."""
    told, by_folder = table_of(folder), {run.folder: run for run in runs}
    columns = list(dict.fromkeys(key for parameters, _ in groups for key in parameters))
    names = list(runs[0].forces) if runs else []
    loads = {}
    for _, members in groups:
        for name in names:
            raw, filtered = statements.records(members, name, settings)
            for run, record, passed in zip(members, raw, filtered):
                loads[run.folder, name] = (record.mean() / 1000, passed.max() / 1000)
    rows = []
    for path in runs_in(folder):
        run, row = by_folder.get(path), told.get(path.name, {})
        summary, options = (run.summary, run.options) if run else ({}, {})
        report = path / "report.html"
        link = os.path.relpath(report, beside) if report.exists() else ""
        cells = [options.get(key, "") for key in columns]
        cells += [options.get("sheet_seed", row.get("seed", "")),
                  summary.get("status") or row.get("status") or "not used",
                  number(summary.get("time")), str(summary.get("fragments", "-"))]
        for name in names:
            cells += [number(v) for v in loads.get((path, name), (None, None))]
        rows.append([path.name, link, *cells])
    head = ["run", *columns, "seed", "status", "time [s]", "fragments"]
    for name in names:
        head += [f"{name}: mean [kN]", f"{name}: largest, filtered [kN]"]
    numbers = list(range(len(columns) + 3, len(head)))
    waiting = [[name, "", *("" for _ in columns), row.get("seed", ""), row.get("status", ""),
                *("-" for _ in head[len(columns) + 3:])]
               for name, row in told.items() if name not in {r[0] for r in rows}]
    return {"head": head, "numbers": numbers, "rows": rows + waiting}


def facts_of(folder, runs, found):
    """[(what, value)] of the ensemble."""
    versions = sorted({str(run.summary.get("version", "")) for run in runs})
    levels = sorted({str(run.summary.get("built_for", "")) for run in runs})
    seconds = sum(run.summary.get("wall_s", 0) for run in runs)
    seeds = [run.options.get("sheet_seed", "") for run in runs]
    log = log_of(runs[0].folder)
    return [["folder", str(folder)], ["command of the first run", log["command"]],
            ["runs", f"{len(found)}, {len(runs)} of them used"],
            ["floe", f"version {', '.join(versions)}"],
            ["processor", ", ".join(filter(None, (log["processor"], *levels)))],
            ["seeds", ", ".join(dict.fromkeys(filter(None, seeds)))],
            ["wall time", f"{number(seconds)} s of all runs together"]]


def report_of(folder, beside, settings):
    """The report of an ensemble; links are from the folder `beside`, where the page will be."""
    found = runs_in(folder)
    runs, left_out = statements.find_runs([folder])
    groups = statements.groups(runs)
    names = list(dict.fromkeys(name for run in runs for name in run.forces))
    parts = [group_of(parameters, members, name, settings) for parameters, members in groups
             for name in names if all(name in run.forces for run in members)]
    table = rows_of(folder, beside, runs, groups, settings)
    table["left_out"] = [f"{path.name}: {why}" for path, why in left_out]
    return {"kind": "ensemble", "title": Path(folder).resolve().name,
            "facts": facts_of(folder, runs, found), "warnings": [], "groups": parts,
            "runs": table}
