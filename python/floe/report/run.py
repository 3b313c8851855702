"""What a report says of a run: facts, loads, energies, fragments, and its scene. Plain numbers and
words, for the page (web/page.js). SI units unless a name says another."""
import platform
import re

import numpy as np

from floe.errors import InputError
from floe.loads import fields, signals, statements
from floe.report.map import action, pressure_map
from floe.report.scene import obstacles_of, scene_of
from floe.report.series import energy_unit, rounded, series, unit_of
from floe.results import breakage, tables
from floe.results.output import Output

LOSSES = {"damping": "damping of beams", "drag": "drag of the water", "fracture": "fracture",
          "contact_viscous": "dashpots of contacts", "friction": "friction",
          "crushing": "crushing", "released": "released by breaks",
          "numerical": "numerical damping", "removed": "with ice that left"}
STORED = {"kinetic": "motion", "strain": "beams", "gravity": "gravity", "water": "buoyancy",
          "contact": "springs of contacts"}
INPUT = {"boundary": "work of boundaries and obstacles", "external": "work of loads",
         "supplied": "with ice that joined"}
NO_TERM = ("load", "balance_error")  # of the balance; every other energy is stored
COLOURS = ["#22577a", "#c1440e", "#4c956c", "#8a5a9e", "#b8860b", "#5c677d", "#d1495b", "#2a9d8f"]


# -- what was run ---------------------------------------------------------------------------------
def processor(host):
    """Name of this machine's processor, if the run was on it; else nothing."""
    if host != platform.node():
        return ""
    try:
        with open("/proc/cpuinfo") as file:
            return next((line.split(":", 1)[1].strip() for line in file
                         if line.startswith("model name")), "")
    except OSError:
        return ""


def log_of(folder):
    """What floe.log says of where and when: {"date", "command", "host", "processor"}."""
    found = {"date": "", "command": "", "host": "", "processor": ""}
    path = folder / "floe.log"
    if not path.exists():
        return found
    text = path.read_text(errors="replace")
    for key, pattern in (("date", r"^floe \S+, (\S+)"), ("command", r"^command: (.*)"),
                         ("host", r"^host: ([^,\n]+)")):
        match = re.search(pattern, text, re.MULTILINE)
        found[key] = match[1] if match else ""
    found["processor"] = processor(found["host"])
    return found


def rows_of_facts(output):
    """[(what, value)] of what was run."""
    summary, options, log = output.summary, output.options(), log_of(output.folder)
    level = str(summary.get("built_for", ""))
    seeds = [f"{key.removesuffix('_seed')} {value}" for key, value in options.items()
             if key.endswith("_seed")]
    scene = next((word for word in log["command"].split() if word.endswith(".yaml")),
                 output.folder.name)
    sheet = [options.get(f"sheet_{key}", "") for key in ("length", "width", "thickness")]
    found = [("scene", scene), ("folder", str(output.folder)), ("command", log["command"]),
             ("status", " ".join(filter(None, (summary.get("status", "not ended yet"),
                                               summary.get("message", ""))))),
             ("floe", f"version {summary.get('version', 'unknown')}"), ("begun", log["date"]),
             ("processor", ", ".join(filter(None, (log["processor"], level, log["host"]
                                                   and f"host {log['host']}")))),
             ("ranks", str(summary.get("ranks", ""))), ("seeds", ", ".join(seeds)),
             ("model", f"{options.get('integrator', '')}; {summary.get('model', '')}"),
             ("forces", options.get("forces", "")),
             ("ice", " x ".join(filter(None, sheet)) + " m" if any(sheet) else
              options.get("lattice_file", "")),
             ("bodies, beams", f"{summary.get('bodies', len(output.position)):,}, "
              f"{summary.get('beams', 0):,}" + " at the end" * output.changes),
             ("ice that joined and left", supply_in_words(summary.get("supply"))),
             ("time", f"to {number(summary.get('time'))} s, {summary.get('steps', 0):,} "
              f"step{'s' * (summary.get('steps') != 1)} of {number(summary.get('dt'))} s"
              if "time" in summary else ""),
             ("wall time", f"{number(summary.get('wall_s'))} s" if "wall_s" in summary else ""),
             ("obstacles", ", ".join(f"{name} ({options.get(f'obstacle_{name}_shape')})" for name in
                                     options.get("obstacle_names", "").replace(",", " ").split()))]
    return [[what, value] for what, value in found if value and value.strip(" ,;")]


def supply_in_words(supply):
    """supply: of summary.json, or None."""
    if not supply:
        return ""
    return "; ".join(f"{int(supply[f'bodies_{key}']):,} bodies of {supply[f'mass_{key}']:,.0f} kg "
                     f"{word}" for key, word in (("supplied", "joined"), ("removed", "left")))


def number(value, digits=4):
    """A number as text, or a dash."""
    return "-" if value is None else f"{value:.{digits}g}"


# -- loads ----------------------------------------------------------------------------------------
def history_of(folder):
    """history.csv as {column: values}."""
    table = tables.history(folder)
    if not len(table):
        raise InputError(f"{folder}/history.csv has no rows yet")
    return {key: table[key].to_numpy() for key in table}


def centred(filtered, raw, dt, start):
    """Times of the values of a filtered record: a running mean is shorter than the raw one."""
    lost = (len(raw) - len(filtered)) / 2
    return start + dt * (np.arange(len(filtered)) + lost + 0.5)


def load_of(run, output, name, settings, history):
    """All that the page has on the load on one obstacle of a run."""
    found = statements.state([run], name, settings)
    (raw,), (filtered,) = statements.records([run], name, settings)
    dt, start = run.dt, settings.start
    size, unit = unit_of(max(np.abs(raw).max(), np.abs(filtered).max()))
    time, at = centred(raw, raw, dt, start), centred(filtered, raw, dt, start)
    peaks = signals.peaks(filtered, found["peaks"]["threshold"])
    mean = np.cumsum(raw) / np.arange(1, len(raw) + 1)
    parts = settings.filter.apply(run.forces[name], dt)
    parts_at = centred(parts[0], run.forces[name][0], dt, 0.0)
    try:
        ice = fields.state([run], name, start)
    except InputError as error:
        ice = {"missing": str(error)}
    return {
        "name": name, "unit": unit, "size": size, "statement": slim(found), "ice": ice,
        "course": [series(time, raw / size, name="means over the rows", colour="#b9c7d3", width=1),
                   series(at, filtered / size, name=f"filtered: {settings.filter}",
                          colour=COLOURS[0], width=1.8),
                   {"x": rounded(at[peaks], 6), "y": rounded(filtered[peaks] / size),
                    "name": "separate peaks above the mean", "colour": COLOURS[1],
                    "points": True}],
        "running": [series(time, mean / size, name="mean since the start", colour=COLOURS[0])],
        "components": [series(parts_at, parts[k] / size, name=f"along {axis}", colour=COLOURS[k])
                       for k, axis in enumerate("xyz")],
        "spectrum": [{"x": rounded(found["spectrum"]["frequency"][1:]),
                      "y": rounded(np.array(found["spectrum"]["density"][1:]) / size**2),
                      "name": "density", "colour": COLOURS[0]}],
        "map": pressure_map(output, history, name, start)}


def slim(statement):
    """A statement without the arrays that the page draws otherwise."""
    found = {key: value for key, value in statement.items() if key != "spectrum"}
    found["peaks"] = {k: v for k, v in statement["peaks"].items() if k != "spacings"}
    return found


def loads_of(output, settings, history):
    """The loads on all obstacles; none, and why."""
    try:
        run = statements.read_run(output.folder)
        return [load_of(run, output, name, settings, history) for name in run.forces], ""
    except InputError as error:
        return [], str(error)


def reactions_of(output, history):
    """Forces that named boundaries take, over time: [series], their unit."""
    names = [key.removesuffix("_displacement_x") for key in history
             if key.endswith("_displacement_x")]
    names += [name for name in ("far_edge",) if f"{name}_force_x" in history]
    found = []
    for name in names:
        for axis in "xyz":
            values = history.get(f"{name}_force_{axis}")
            if values is not None and np.any(values != 0):
                found.append((f"{name}, {axis}", values))
    if not found:
        return {"series": [], "unit": "N"}
    size, unit = unit_of(max(np.abs(values).max() for _, values in found))
    return {"unit": unit, "series": [
        series(history["time"], values / size, name=name, colour=COLOURS[k % len(COLOURS)],
               width=1) for k, (name, values) in enumerate(found[:8])]}


# -- energies, fragments --------------------------------------------------------------------------
def energies_of(history):
    """The energy ledger over time, and what it is at the end since the start."""
    columns = {key.removeprefix("energy_"): values for key, values in history.items()
               if key.startswith("energy_")}
    others = {key: key.replace("_", " ") for key in columns
              if key not in (*INPUT, *LOSSES, *NO_TERM)}
    names = {**INPUT, **others, **STORED, **LOSSES}
    changes = {key: values - values[0] for key, values in columns.items() if key in names}
    if not changes:
        return None
    size, unit = energy_unit(max(np.abs(v).max() for v in changes.values()))
    rows = [{"name": names[key], "kind": "put in" if key in INPUT else
             "lost" if key in LOSSES else "stored", "end": float(changes[key][-1])}
            for key in names if key in changes]
    zero = np.zeros(len(history["time"]))
    put_in = sum((changes[key] for key in INPUT if key in changes), zero)
    stored = sum((changes[key] for key in changes if key not in {**INPUT, **LOSSES}), zero)
    drawn = [("put in", put_in, "#111")] if any(key in changes for key in INPUT) else []
    drawn.append(("stored", stored, COLOURS[0]))
    lost = sorted((key for key in LOSSES if key in changes and np.any(changes[key])),
                  key=lambda key: -np.abs(changes[key]).max())[:6]
    drawn += [(f"lost: {LOSSES[key]}", changes[key], COLOURS[1 + k]) for k, key in enumerate(lost)]
    error = float(np.abs(columns["balance_error"]).max()) if "balance_error" in columns else None
    largest = max(np.abs(v).max() for v in changes.values()) or 1.0
    return {"unit": unit, "size": size, "rows": rows, "error": error,
            "error_share": None if error is None else float(error / largest),
            "course": [series(history["time"], values / size, name=name, colour=colour)
                       for name, values, colour in drawn]}


def fragments_of(output, history):
    """Pieces over time and at the end; None where nothing could break."""
    breaks = breakage.at_end(output)
    if not breaks:
        return None
    mass = np.sort(breaks["fragments/mass"])[::-1]
    bodies = breaks["fragments/bodies"][np.argsort(-breaks["fragments/mass"], kind="stable")]
    course = [series(history["time"], history[key], name=name, colour=colour, step=True)
              for key, name, colour in (("beams_broken", "beams broken", COLOURS[0]),
                                        ("fragments", "fragments", COLOURS[1]))
              if key in history]
    rank = np.arange(1, len(mass) + 1)
    return {"number": len(mass), "broken": len(breaks["beam"]), "course": course,
            "largest": [[int(b), float(m)] for b, m in zip(bodies[:8], mass[:8])],
            "single": int(np.sum(bodies == 1)),
            "sizes": [{**series(mass[::-1], rank[::-1], name="fragments", colour=COLOURS[0]),
                       "points": len(mass) <= 400, "size": 3}] if len(mass) > 1 else []}


# -- forces in space ------------------------------------------------------------------------------
def forces_of(output, history):
    """Forces at the frames: of the ice on obstacles, where the resultant acts, and of boundaries on
    the ice, at the mean place of their bodies."""
    rows = np.array([int(np.argmin(np.abs(history["time"] - t))) for t in output.times], int)
    table = {key: values[rows] for key, values in history.items()}
    found = []
    for obstacle in obstacles_of(output, output.times):
        name = obstacle["name"]
        if f"{name}_moment_x" not in history or not len(rows):
            continue
        at, _, force = action(obstacle, table, name)
        found.append({"name": name, "kind": "obstacle", "force": force,
                      "at": [p if np.isfinite(p[0]) else None for p in at]})
    options = output.options()
    for name in options.get("boundary_names", "").replace(",", " ").split():
        own = options.get(f"boundary_{name}_set", "")
        if own not in output.sets or f"{name}_displacement_x" not in table:
            continue
        rest = np.array([ice.position[ice.sets[own]].mean(axis=0)
                         for ice in map(output.at, output.times)]) if output.changes else (
            output.position[output.sets[own]].mean(axis=0))
        force, way = (np.column_stack([table[f"{name}_{what}_{axis}"] for axis in "xyz"])
                      for what in ("force", "displacement"))
        found.append({"name": name, "kind": "boundary", "force": force,
                      "at": list(rest + way)})
    return found


def report_of(folder, settings, frames):
    """The whole report of a run."""
    output = Output(folder)
    history = history_of(folder)
    loads, missing = loads_of(output, settings, history)
    return {"kind": "run", "title": output.folder.resolve().name, "facts": rows_of_facts(output),
            "warnings": [str(w) for w in output.summary.get("warnings", [])],
            "loads": loads, "no_loads": missing, "reactions": reactions_of(output, history),
            "energies": energies_of(history), "fragments": fragments_of(output, history),
            "scene": scene_of(output, forces_of(output, history), frames)}


def scene_again(folder, frames):
    """The scene of a run alone, with at most so many frames."""
    output = Output(folder)
    return scene_of(output, forces_of(output, history_of(folder)), frames)
