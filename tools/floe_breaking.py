"""What each choice of numbers does to the load of ice that breaks, beside the time that it saves
(tools/bench precision: cases cone and slope).

Runs of ice that breaks part from each other after a small change of anything, so no run is the
error of another one. Each variant is run with several seeds of the mesh, and its load is compared
with that of the reference (the scene as it stands) with the same seeds:
  mean        of the load over the run
  filtered    largest running mean over FILTER seconds
  r.m.s.      of the load in bands of frequency (Welch 1967), without its mean
  centroid    of the power spectrum: sum of f S(f) over that of S(f)
All come from the mean forces between rows of history.csv (their impulses), so that peaks between
rows count and how often is written does not. A change is the mean over the seeds of ln(variant over
reference of the same seed): of two sets of runs without a difference its expectation is 0, while
that of the ratio is not. Its standard error is that of this mean. The band of the seeds is twice
the standard error sqrt(2/n) s of the difference of two sets of n independent runs of the reference,
s the standard deviation of the logarithm over the seeds: what lies inside cannot be told from
another choice of seeds. Time is the processor's as in floe_precision, over that of the reference of
the same seed (geometric mean)."""
import itertools
import json
import os
import resource
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floe.results.output import rows_of

FILTER = 1.0   # of the running mean [s]
ROWS = 0.02    # between rows of history.csv [s]
START = 2.0    # what comes before is left out: the boundary's ramp, and the way to the obstacle [s]
BANDS = ((0.0, 0.5), (0.5, 5.0), (5.0, 25.0))  # [Hz]
SEGMENT = 8.0  # of Welch's spectra [s]


@dataclass(frozen=True)
class Variant:
    """A choice: the knob that it turns, its value there, and options of the command line."""
    knob: str
    value: str
    options: tuple = ()


REFERENCE = Variant("reference", "as it stands")
# In both scenes the step resolves a touch in 14 steps; its stable limit is a seventh longer.
KNOBS = (
    Variant("contact modulus E_c", "3e7 Pa", ("-contact_young", "3e7")),
    Variant("contact modulus E_c", "3e8 Pa", ("-contact_young", "3e8")),
    Variant("step", "27 per touch", ("-time_safety", "0.45")),
    Variant("step", "10 per touch, damping 0.03",
            ("-beam_damping_ratio", "0.03", "-time_dt", "4.4e-4")),
    Variant("pace of the water", "1", ("-water_pace", "1")),
    Variant("pace of the water", "20", ("-water_pace", "20")),
    Variant("rotational inertia", "times 2", ("-model_rotational_inertia_factor", "2")),
    Variant("rotational inertia", "times 4", ("-model_rotational_inertia_factor", "4")),
    Variant("damping ratio", "0", ("-beam_damping_ratio", "0")),
    Variant("damping ratio", "0.03", ("-beam_damping_ratio", "0.03")),
    Variant("damping ratio", "0.3", ("-beam_damping_ratio", "0.3")),
    Variant("element size l/h", "4", ("-sheet_element_size", "2")),
    Variant("element size l/h", "2", ("-sheet_element_size", "1")),
    Variant("together", "E_c 3e7 Pa, damping 0.03",
            ("-contact_young", "3e7", "-beam_damping_ratio", "0.03")),
)
# Of the scene that takes longer: one of each knob.
FEW = tuple(variant for variant in KNOBS if (variant.knob, variant.value) in {
    ("contact modulus E_c", "3e7 Pa"), ("step", "27 per touch"), ("pace of the water", "20"),
    ("rotational inertia", "times 4"), ("damping ratio", "0.03"), ("element size l/h", "4")})


@dataclass(frozen=True)
class BreakingCase:
    """A scene of input/, options of all its runs, and the obstacle whose load counts."""
    name: str
    title: str
    scene: str
    obstacle: str
    end: float
    options: tuple = ()
    variants: tuple = KNOBS

    def command(self, variant, seed):
        return (*self.options, "-fracture_propagation", "energy", "-time_end", str(self.end),
                "-output_history", str(ROWS), "-output_fields", str(self.end),
                "-sheet_seed", str(seed), *variant.options)


def cases():
    return [BreakingCase("slope", "a sheet breaks at a slope and piles up", "input/ice_slope.yaml",
                         "slope", 30,
                         ("-sheet_length", "40", "-sheet_width", "10", "-obstacle_slope_point",
                          "20.1,0,-0.4554")),
            BreakingCase("cone", "a sheet breaks at a cone", "input/ice_cone.yaml", "cone", 30,
                         variants=FEW)]


# -- loads
# -----------------------------------------------------------------------------------------
def load_of(folder, obstacle):
    """The load along x: ends of intervals of ROWS [s], mean forces over them [N]. Rows hold the
    mean force since the start, which times the time is the impulse; it is linear between them.
    """
    rows = rows_of(folder)
    time = np.array([float(row["time"]) for row in rows])
    impulse = time * [float(row[f"{obstacle}_mean_force_x"]) for row in rows]
    edges = ROWS * np.arange(np.floor(time[-1] / ROWS + 1e-6) + 1)
    return edges[1:], np.diff(np.interp(edges, time, impulse)) / ROWS


def running_mean(time, force, width):
    """Means over all windows of `width` [s] that end with a row, by the impulse, which is linear
    between rows."""
    edges = np.concatenate([[time[0] - (time[1] - time[0])], time])
    impulse = np.concatenate([[0.0], np.cumsum(force * np.diff(edges))])
    ends = edges[edges >= edges[0] + width * (1 - 1e-9)]
    return (np.interp(ends, edges, impulse) - np.interp(ends - width, edges, impulse)) / width


def spectrum(time, force):
    """Frequencies [Hz] and the one-sided power spectral density of the load [N^2/Hz]."""
    from scipy.signal import welch
    interval = (time[-1] - time[0]) / (len(time) - 1)
    return welch(force, 1 / interval, nperseg=min(len(force), round(SEGMENT / interval)),
                 detrend="constant")


def measures_of(time, force):
    """What is compared: {name: number above 0}."""
    kept = time > START
    time, force = time[kept], force[kept]
    frequency, density = spectrum(time, force)
    power = density * (frequency[1] - frequency[0])
    found = {"mean": float(np.mean(force)),
             "filtered": float(np.max(running_mean(time, force, FILTER))),
             "centroid": float(np.sum(frequency * power) / np.sum(power))}
    for low, high in BANDS:
        here = (frequency > low) & (frequency <= high)
        found[f"rms {low:g}"] = float(np.sqrt(np.sum(power[here])))
    return found


NAMES = {"mean": "mean load", "filtered": f"largest running mean over {FILTER:g} s",
         "centroid": "centroid of the spectrum",
         **{f"rms {low:g}": f"r.m.s. from {low:g} to {high:g} Hz" for low, high in BANDS}}
UNITS = {name: (1e-3, "kN") for name in NAMES} | {"centroid": (1, "Hz")}


# -- runs
# -------------------------------------------------------------------------------------------
class Runner:
    """Runs floe and keeps what came out, so that an interrupted benchmark goes on where it was."""

    def __init__(self, floe, root, folder, environment):
        self.floe, self.root, self.environment = floe, Path(root), environment
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        self.file = folder / "breaking.jsonl"
        self.known = {}
        if self.file.exists():
            lines = self.file.read_text().splitlines()
            self.known = {run["key"]: run for run in map(json.loads, lines)}

    def key(self, case, variant, seed):
        return f"{case.scene} {' '.join(case.command(variant, seed))}"

    def has(self, case, variant, seed):
        """Whether a run is on file."""
        return self.key(case, variant, seed) in self.known

    def run(self, case, variant, seed):
        """{cpu, steps, dt, ledger, measures, message}; measures is None if the run failed."""
        key = self.key(case, variant, seed)
        if key not in self.known:
            self.known[key] = {"key": key, **self._run(case, variant, seed)}
            with open(self.file, "a") as out:
                out.write(json.dumps(self.known[key]) + "\n")
        return self.known[key]

    def _call(self, case, variant, seed, *more):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([str(self.floe), str(self.root / case.scene),
                               *case.command(variant, seed), *more], env=self.environment,
                              capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def _run(self, case, variant, seed):
        with tempfile.TemporaryDirectory() as folder:
            done, cpu = self._call(case, variant, seed, "-output_dir", folder + "/out")
            _, setup = self._call(case, variant, seed, "-output_dir", folder + "/out", "-check",
                                  "-output_overwrite")
            result = {"cpu": cpu - setup, "steps": 0, "dt": 0, "ledger": None, "measures": None,
                      "message": ""}
            if done.returncode != 0:
                lines = [line for line in done.stderr.splitlines() if line.startswith("floe:")]
                return {**result, "message": (lines or done.stderr.splitlines() or ["failed"])[-1]}
            summary = json.loads(Path(folder, "out/summary.json").read_text())
            last = rows_of(folder + "/out")[-1]
            result |= {"steps": summary["steps"], "dt": summary["stable_dt"],
                       "ledger": abs(float(last["energy_balance_error"])
                                     / float(last["energy_boundary"]))}
            result["measures"] = measures_of(*load_of(folder + "/out", case.obstacle))
            return result


# -- statistics
# -------------------------------------------------------------------------------------
def change(of, reference, scatter):
    """(change, its standard error, half the width of the band of the seeds), relative.

    of, reference: numbers above 0, one per seed; scatter: standard deviation of the logarithm over
    the seeds of the reference.
    """
    steps = np.log(np.asarray(of)) - np.log(np.asarray(reference))
    n = len(steps)
    own = np.std(steps, ddof=1) / np.sqrt(n) if n > 1 else np.nan
    return float(np.mean(steps)), float(own), float(2 * np.sqrt(2 / n) * scatter)


def compare(case, runs):
    """Rows of one case: {variant, seeds, failed, time, time_error, changes: {measure: (change,
    standard error, band)}, ledger, dt}, and of the reference {measure: (mean, standard error,
    scatter)}, from runs[variant][seed]."""
    reference = {seed: run for seed, run in runs[REFERENCE].items() if run["measures"]}
    if not reference:
        raise RuntimeError(f"{case.name}: no reference: "
                           + next(iter(runs[REFERENCE].values()))["message"])
    about, scatter = {}, {}
    for name in NAMES:
        values = np.array([run["measures"][name] for run in reference.values()])
        deviation = float(np.std(values, ddof=1)) if len(values) > 1 else np.nan
        about[name] = (float(np.mean(values)), deviation / np.sqrt(len(values)), deviation)
        scatter[name] = float(np.std(np.log(values), ddof=1)) if len(values) > 1 else np.nan
    rows = []
    for variant in (REFERENCE, *case.variants):
        good = {seed: run for seed, run in runs.get(variant, {}).items()
                if run["measures"] and seed in reference}
        if not good:
            continue
        spent = np.log([run["cpu"] / reference[seed]["cpu"] for seed, run in good.items()])
        rows.append({
            "variant": variant, "seeds": len(good), "failed": len(runs[variant]) - len(good),
            "time": float(np.exp(np.mean(spent))),
            "time_error": float(np.std(spent, ddof=1) / np.sqrt(len(spent)))
            if len(spent) > 1 else np.nan,
            "cpu": float(np.mean([run["cpu"] for run in good.values()])),
            "dt": min(run["dt"] for run in good.values()),
            "ledger": max(run["ledger"] for run in good.values()),
            "changes": {name: change([run["measures"][name] for run in good.values()],
                                     [reference[seed]["measures"][name] for seed in good],
                                     scatter[name]) for name in NAMES}})
    return rows, about


def told_apart(row, name):
    """Whether a change is more than the seeds explain: outside twice its own standard error and
    outside the band."""
    value, own, band = row["changes"][name]
    return abs(value) > max(2 * own, band)


# -- output
# -----------------------------------------------------------------------------------------
COLUMNS = ("mean", "filtered", "rms 0", "rms 0.5", "rms 5", "centroid")


def percent(value, own):
    """A change of a logarithm and its standard error as a change of the number."""
    return f"{100 * np.expm1(value):+.0f} ± {100 * np.exp(value) * own:.0f} %"


def table(case, rows, about):
    """Markdown of one case."""
    seeds = max(row["seeds"] for row in rows)
    picture = f"![](precision/breaking_{case.name}.png)"
    lines = [f"### Error beside time: {case.title}", "", picture, "",
             f"{case.scene.removeprefix('input/')}, {case.end:g} s, {seeds} seeds. "
             f"{' '.join(case.options)}".strip(), "",
             "| knob | value | time | " + " | ".join(NAMES[name] for name in COLUMNS)
             + " | ledger |", "|---" * (4 + len(COLUMNS)) + "|"]
    for row in rows:
        variant = row["variant"]
        if variant == REFERENCE:
            cells = []
            for name in COLUMNS:
                factor, unit = UNITS[name]
                cells.append(f"{factor * about[name][0]:.3g} ± {factor * about[name][1]:.2g} "
                             f"{unit}")
            time = f"{row['cpu']:.1f} s"
        else:
            cells = [("**" if told_apart(row, name) else "") + percent(*row["changes"][name][:2])
                     + ("**" if told_apart(row, name) else "") for name in COLUMNS]
            time = f"{row['time']:.2f}"
        note = f" ({row['failed']} of {row['seeds'] + row['failed']} failed)" * (row["failed"] > 0)
        if row["seeds"] < seeds:
            note += f" ({row['seeds']} seeds)"
        lines.append(f"| {variant.knob} | {variant.value}{note} | {time} | " + " | ".join(cells)
                     + f" | {row['ledger']:.0e} |")
    bands = [f"{100 * next(r for r in rows)['changes'][name][2]:.0f} %" for name in COLUMNS]
    return lines + ["| band of the seeds | | | " + " | ".join(bands) + " | |", ""]


def draw(case, rows, file):
    """Change against time of one case, a panel for each of four measures."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    shown = ("mean", "filtered", "rms 0.5", "rms 5")
    figure, panels = plt.subplots(2, 2, figsize=(9.5, 7.6), sharex=True)
    knobs = list(dict.fromkeys(row["variant"].knob for row in rows))
    for axes, name in zip(panels.flat, shown):
        band = rows[0]["changes"][name][2]
        axes.axhspan(100 * np.expm1(-band), 100 * np.expm1(band), color="#8a949e", alpha=0.25,
                     linewidth=0, label="scatter of the seeds")
        axes.axhline(0, color="black", linewidth=0.6)
        for knob, marker in zip(knobs, "*os^Dvp<>"):
            mine = [row for row in rows if row["variant"].knob == knob]
            value, own = np.transpose([row["changes"][name][:2] for row in mine])
            middle = np.expm1(value)
            bars = 100 * np.array([middle - np.expm1(value - own), np.expm1(value + own) - middle])
            container = axes.errorbar([row["time"] for row in mine], 100 * middle, bars, fmt=marker,
                                      markersize=6, linewidth=0.9, capsize=2, label=knob)
            for row in mine:
                if row["variant"] != REFERENCE:
                    axes.annotate(row["variant"].value,
                                  (row["time"], 100 * np.expm1(row["changes"][name][0])),
                                  xytext=(5, 4), textcoords="offset points", fontsize=7,
                                  color=container.lines[0].get_color())
        axes.set(xscale="log", title=NAMES[name])
        axes.set_xticks((0.5, 0.7, 1, 1.5, 2, 3), labels=("0.5", "0.7", "1", "1.5", "2", "3"))
        axes.minorticks_off()
        axes.spines[["top", "right"]].set_visible(False)
    for axes in panels[:, 0]:
        axes.set_ylabel("change [%]")
    for axes in panels[1]:
        axes.set_xlabel("processor time over the reference's")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, fontsize=8, ncols=4, loc="lower center")
    figure.subplots_adjust(left=0.08, right=0.98, top=0.95, bottom=0.14, hspace=0.16, wspace=0.16)
    figure.savefig(file, dpi=120)
    plt.close(figure)


def measure(case, runner, seeds, say=print):
    """runs[variant][seed] of a case: seed after seed, so that a benchmark that is stopped has as
    many seeds of each variant. Seeds above `seeds` count where all their runs are on file."""
    runs = {variant: {} for variant in (REFERENCE, *case.variants)}
    for seed in itertools.count(1):
        if seed > seeds and not all(runner.has(case, variant, seed) for variant in runs):
            return runs
        for variant in runs:
            run = runs[variant][seed] = runner.run(case, variant, seed)
            said = run["message"] or (f"mean {1e-3 * run['measures']['mean']:.1f} kN, "
                                      f"largest {1e-3 * run['measures']['filtered']:.0f} kN")
            say(f"{case.name}, seed {seed}, {variant.knob} {variant.value}: {run['cpu']:.1f} s, "
                f"{said}", flush=True)


def benchmark(floe, root, environment, names, fresh, seeds):
    """Runs the cases; figures into docs/precision, the tables as lines of Markdown."""
    folder = root / "out/precision"
    if fresh and (folder / "breaking.jsonl").exists():
        os.remove(folder / "breaking.jsonl")
    runner = Runner(floe, root, folder, environment)
    pictures = root / "docs/precision"
    pictures.mkdir(parents=True, exist_ok=True)
    lines = []
    for case in cases():
        if case.name not in names:
            continue
        rows, about = compare(case, measure(case, runner, seeds))
        draw(case, rows, pictures / f"breaking_{case.name}.png")
        lines += table(case, rows, about)
    return lines
