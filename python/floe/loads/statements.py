"""What the forces on obstacles of one run or of many are as a load: mean, maxima of blocks,
Gumbel's law with its bands, trend, peaks, spectrum (floe loads, docs/loads.md). SI units.

    runs, left_out = find_runs(["out/cone"])
    for parameters, group in groups(runs):
        statement = state(group, "cone", Settings())
"""
import dataclasses
import numbers
from pathlib import Path

import numpy as np
import scipy

from floe.errors import InputError, reading
from floe.loads import extremes, signals
from floe.results.output import options_of, summary_of
from floe.results.tables import history, obstacles_of


# Keys that make runs draws of one law, or that say nothing about the ice.
DRAW_KEYS = ("sheet_seed", "fracture_seed", "waves_seed")
IDLE_SECTIONS = ("output", "checkpoint", "limit", "check")
COMPONENTS = ("horizontal", "x", "y", "z", "total")
WEAK = 10  # maxima, below which a fit is called weak


@dataclasses.dataclass(frozen=True)
class Settings:
    """How a load is stated. start, block, hours: [s], [s], [h of ice action a year]."""
    component: str = "horizontal"
    filter: signals.Filter = signals.Filter("mean", length=0.5)
    start: float = 0
    block: float = 600
    probabilities: tuple = (0.5, 0.1, 0.01)
    hours: float = 0
    level: float = 0.95
    draws: int = extremes.DRAWS
    seed: int = extremes.SEED


def settings_of(**given):
    """Settings from keyword arguments, filter as text (signals.Filter.parse). InputError names the
    one that is not allowed."""
    known = {field.name for field in dataclasses.fields(Settings)}
    if unknown := [name for name in given if name not in known]:
        raise InputError(f"{unknown[0]}: no setting of a load (known: {', '.join(sorted(known))})")
    if isinstance(given.get("filter"), str):
        try:
            given["filter"] = signals.Filter.parse(given["filter"])
        except ValueError as error:
            raise InputError(str(error)) from None
    for name, allowed in (("filter", signals.Filter), ("component", str), ("start", numbers.Real),
                          ("block", numbers.Real), ("hours", numbers.Real),
                          ("level", numbers.Real), ("draws", numbers.Integral),
                          ("seed", numbers.Integral)):
        if name in given and not isinstance(given[name], allowed):
            kind = {numbers.Real: "a number", numbers.Integral: "a whole number"}
            raise InputError(f"{name}: {given[name]!r} must be {kind.get(allowed, 'a text')}")
    found = Settings(**given)
    if found.component not in COMPONENTS:
        raise InputError(f"component '{found.component}' is none of {', '.join(COMPONENTS)}")
    for name, value, allowed in (("start", found.start, found.start >= 0),
                                 ("block", found.block, found.block > 0),
                                 ("hours", found.hours, found.hours >= 0),
                                 ("level", found.level, 0 < found.level < 1)):
        if not allowed:
            raise InputError(f"{name} {value:g} is out of its range")
    if not all(0 < p < 1 for p in found.probabilities):
        raise InputError(f"probabilities {found.probabilities} are not all between 0 and 1")
    return found


@dataclasses.dataclass
class Run:
    """A run: its folder, options, summary, interval of its rows [s], and per obstacle the mean
    forces 3 x k [N] over the intervals, and the largest of all steps (3, of the largest norm)."""
    folder: Path
    options: dict
    summary: dict
    dt: float
    forces: dict
    peaks: dict

    @property
    def name(self):
        return self.folder.name or str(self.folder)


def read_run(folder):
    """The run in a folder. InputError if it has no obstacle, or too few rows."""
    table = history(folder)
    path = Path(folder) / "history.csv"
    names = obstacles_of(table)
    if not names:
        raise InputError(f"{folder}: the scene has no obstacles")
    if len(table) < 3:
        raise InputError(f"{path} has fewer than 3 rows")
    time, forces, peaks, dt = table["time"].to_numpy(), {}, {}, 0.0
    for name in names:
        def columns(what, name=name):
            return table[[f"{name}_{what}_{axis}" for axis in "xyz"]].to_numpy()
        with reading(path):
            dt, means = signals.interval_means(time, columns("mean_force"))
            peaks[name] = columns("peak_force")[-1]
        forces[name] = means
    return Run(Path(folder), options_of(folder), summary_of(folder), dt, forces, peaks)


def find_runs(folders):
    """Runs in output folders and in folders of runs (every folder below with a summary.json), and
    [(folder, why)] of those below that are left out since they have not ended well."""
    found, left_out = [], []
    for given in map(Path, folders):
        if not given.is_dir():
            raise InputError(f"{given} is no folder")
        if (given / "history.csv").exists():
            found.append(read_run(given))
            continue
        below = sorted(path.parent for path in given.rglob("summary.json")
                       if (path.parent / "options.yaml").exists())
        for folder in below:
            try:
                status = summary_of(folder).get("status")
                if status != "done":
                    raise InputError(f"its status is {status}")
                found.append(read_run(folder))
            except InputError as error:
                left_out.append((folder, str(error)))
        if not below:
            raise InputError(f"{given} is no output folder and has none below (no summary.json)")
    if not found:
        raise InputError(f"none of the runs can be used: {left_out[0][0]}: {left_out[0][1]}")
    return found, left_out


def differing(options):
    """Keys, seeds aside, whose values differ between the options of several runs."""
    keys = sorted({key for each in options for key in each})
    return [key for key in keys if key not in DRAW_KEYS
            and key.split("_")[0] not in IDLE_SECTIONS
            and len({each.get(key) for each in options}) > 1]


def groups(runs):
    """[({key: value}, runs)]: runs whose scenes differ by their seeds only, with what tells the
    group from the others."""
    keys, found = differing([run.options for run in runs]), {}
    for run in runs:
        found.setdefault(tuple(run.options.get(key, "") for key in keys), []).append(run)
    return [(dict(zip(keys, values)), members) for values, members in found.items()]


def component(force, kind, sign=1.0):
    """The component of forces 3 x k that is the load [N]."""
    if kind == "horizontal":
        return np.hypot(force[0], force[1])
    if kind == "total":
        return np.linalg.norm(force, axis=0)
    return sign * force["xyz".index(kind)]


def records(runs, obstacle, settings):
    """Per run the record of the load [N] after start-up: raw (means over the rows' interval) and
    filtered. Components pass the filter before their norm is taken; x, y, z count as positive where
    their mean over the runs is."""
    dt = runs[0].dt
    if any(abs(run.dt - dt) > 0.01 * dt for run in runs):
        raise InputError("runs with rows at different intervals (output: history) make no ensemble")
    if any(obstacle not in run.forces for run in runs):
        raise InputError(f"no obstacle {obstacle} (known: {', '.join(runs[0].forces)})")
    sign = 1.0
    if settings.component in ("x", "y", "z"):
        axis = "xyz".index(settings.component)
        sign = -1.0 if np.mean([run.forces[obstacle][axis].mean() for run in runs]) < 0 else 1.0
    skip, raw, filtered = round(settings.start / dt), [], []
    for run in runs:
        force = run.forces[obstacle]
        if force.shape[1] - skip < 8:
            raise InputError(f"{run.folder}: fewer than 8 rows are left after a start of "
                             f"{settings.start:g} s")
        try:
            passed = settings.filter.apply(force, dt)[:, skip:]
        except ValueError as error:
            raise InputError(f"{run.folder}: {error}") from None
        if passed.shape[1] < 1:
            raise InputError(f"{run.folder}: the record is shorter than start and filter")
        raw.append(component(force[:, skip:], settings.component, sign))
        filtered.append(component(passed, settings.component, sign))
    return raw, filtered


def untouched(runs, obstacle):
    """Whether no ice pressed on an obstacle in any run."""
    return not any(np.any(run.forces.get(obstacle, 1)) for run in runs)


def mean_of_runs(raw, level):
    """Mean of the load over runs [N], its band by Student's t over the runs' means (None of one
    run), and the deviation in time."""
    means = np.array([record.mean() for record in raw])
    band = None
    if len(means) > 1:
        half = scipy.stats.t.ppf(0.5 + level / 2, len(means) - 1) * scipy.stats.sem(means)
        band = [means.mean() - half, means.mean() + half]
    return {"mean": means.mean(), "mean_band": band,
            "deviation": float(np.mean([record.std() for record in raw])),
            "means_of_runs": means.tolist()}


def levels(maxima, block, settings):
    """Values with their bands for each probability of exceedance in a block, and, with hours of ice
    action a year, for yearly probabilities of 1e-2 and 1e-4: a year is then hours x 3600/block
    blocks, which count as independent. [{"probability", "return_period" [s], "yearly", METHOD:
    [estimate, low, high] [N]}]"""
    wanted = [(p, None) for p in settings.probabilities]
    if settings.hours:
        blocks = settings.hours * 3600 / block
        wanted += [(-np.expm1(np.log1p(-yearly) / blocks), yearly) for yearly in (1e-2, 1e-4)]
    found = []
    for p, yearly in wanted:
        row = {"probability": float(p), "return_period": float(block / p), "yearly": yearly}
        for method in extremes.METHODS:
            fitted = extremes.fit(maxima, method)
            ends = extremes.band(*fitted, len(maxima), p, method, settings.level, settings.draws,
                                 settings.seed)
            row[method] = [float(v) for v in (extremes.quantile(*fitted, p), *ends)]
        found.append(row)
    return found


def gumbel(maxima, block, settings):
    """Gumbel's law of the maxima: parameters, goodness, levels; None if there are fewer than 2, or
    all alike."""
    if len(maxima) < 2 or np.ptp(maxima) <= 0:
        return None
    fits = {method: dict(zip(("mu", "beta"), map(float, extremes.fit(maxima, method))))
            for method in extremes.METHODS}
    distance, p = extremes.goodness(maxima, settings.draws, settings.seed)
    return {**fits, "anderson_darling": distance, "p": p, "weak": len(maxima) < WEAK,
            "levels": levels(maxima, block, settings)}


def spacing(filtered, dt):
    """Separate peaks of the filtered records above their mean [N], and the times between them."""
    threshold = float(np.mean([record.mean() for record in filtered]))
    found = [signals.peaks(record, threshold) for record in filtered]
    gaps = np.concatenate([np.diff(k) * dt for k in found])
    heights = np.concatenate([record[k] for record, k in zip(filtered, found)])
    hours = sum(map(len, filtered)) * dt / 3600
    return {"threshold": threshold, "number": len(heights), "per_hour": len(heights) / hours,
            "mean_height": float(heights.mean()) if len(heights) else None,
            "mean_spacing": float(gaps.mean()) if len(gaps) else None,
            "median_spacing": float(np.median(gaps)) if len(gaps) else None,
            "variation_of_spacing": float(gaps.std() / gaps.mean()) if len(gaps) else None,
            "spacings": gaps.tolist()}


def state(runs, obstacle, settings):
    """The load on an obstacle as a statement: a dictionary of plain numbers, for JSON."""
    raw, filtered = records(runs, obstacle, settings)
    dt, shortest = runs[0].dt, min(map(len, raw)) * runs[0].dt
    block = min(settings.block, shortest)
    each = [signals.block_maxima(record, dt, block, len(raw[0]) - len(filtered[0]))
            for record in filtered]
    maxima = np.concatenate(each)
    frequency, density = signals.spectrum(raw, dt)
    return {
        "obstacle": obstacle, "component": settings.component, "filter": str(settings.filter),
        "interval": dt, "start": settings.start, "runs": [str(run.folder) for run in runs],
        "seconds": [len(record) * dt for record in raw],
        **mean_of_runs(raw, settings.level),
        "largest_of_a_step": max(float(np.linalg.norm(run.peaks[obstacle])) for run in runs),
        "largest_of_an_interval": max(float(record.max()) for record in raw),
        "block": block, "block_is_run": settings.block > shortest * 1.01,
        "maxima": maxima.tolist(),
        "largest_of_runs": [float(record.max()) for record in filtered],
        "positions": extremes.positions(len(maxima)).tolist(),
        "gumbel": gumbel(maxima, block, settings),
        "trend": signals.trend(raw, dt),
        "peaks": spacing(filtered, dt),
        "spectrum": {"frequency": frequency.tolist(), "density": density.tolist()},
    }
