"""Specs of ensembles, their runs, and their folders (floe ensemble; docs/ensembles.md)."""
import concurrent.futures
import csv
import difflib
import fcntl
import hashlib
import io
import itertools
import json
import math
import os
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import yaml

from floe.ensembles import made as files
from floe.ensembles.runs import ENVIRONMENT, Run, locked, write_whole
from floe.errors import InputError, reading

KEYS = ("scene", "options", "seeds", "seed_keys", "make", "grid", "list", "latin_hypercube",
        "ranks", "limit", "output")
OURS = ("output_dir", "output_overwrite", "check", "checkpoint_restart")
# Of summary.json what is not the same in each run of the same scene, and what the table says itself
TIMES = {"wall_s", "mesh_s", "lattice_s", "partition_s", "forces_s", "tangent_s", "solve_s",
         "output_s", "peak_memory_mb", "ns_per_beam_step"}
SIZES = {"kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}
UNITS = {"s": 1, "min": 60, "h": 3600, "days": 86400, "years": 365.25 * 86400}


class UniqueKeys(yaml.SafeLoader):
    """YAML in which a key that stands twice in a mapping is an error."""

    def construct_mapping(self, node, deep=False):
        names = [key.value for key, _ in node.value]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"{twice}: stands twice (line {node.start_mark.line + 1})")
        return super().construct_mapping(node, deep)


@dataclass
class Spec:
    """An ensemble as its spec says it. points: [(label, scene, {key: value} that is varied, further
    columns of the table, {key: recipe of the file that is made for it})], without seeds; limits in
    s."""
    name: str
    points: list
    options: dict
    seeds: list
    seed_keys: list
    ranks: int
    limit: float
    total: float
    output: str
    text: dict


@dataclass
class Member(Run):
    """A run of an ensemble: its parameters as the table has them. made: {key: the last step
    (floe.ensembles.made) of what makes its file}; made_in: the folder of such files."""
    parameters: dict = field(default_factory=dict)
    seed: object = None
    made: dict = field(default_factory=dict)
    made_in: object = None

    @property
    def record(self):
        """All that its results depend on and that a spec can change. A file that is made is its
        command, with the digest of the scenes in it."""
        made = {key: f"{step.text} ({step.name})" for key, step in self.made.items()}
        return {"scene": hashlib.sha256(Path(self.scene).read_bytes()).hexdigest(),
                "options": self.options | made}

    def group(self, seed_keys):
        """The same for all seeds of the same parameters."""
        return json.dumps([self.scene, self.parameters,
                           {key: value for key, value in self.options.items()
                            if key not in seed_keys}])

    def command(self, output, ranks=1):
        files = {key: str(step.place(self.made_in)) for key, step in self.made.items()}
        return Run(self.name, self.scene, self.options | files, self.words).command(output, ranks)

    @property
    def ready(self):
        """Whether the files that are made for it are there."""
        return all(step.done(self.made_in) for step in self.made.values())


def refuse(key, value, allowed):
    text = json.dumps(value, default=str) if not isinstance(value, str) else f"'{value}'"
    raise ValueError(f"{key}: {text} must be {allowed}")


def known(key, given, allowed):
    """Refuses keys of a mapping that nobody reads."""
    if not isinstance(given, dict):
        refuse(key, given, f"a mapping with the keys {', '.join(allowed)}")
    for name in given:
        if name not in allowed:
            near = difflib.get_close_matches(str(name), allowed, 1)
            raise ValueError(f"{key + ': ' if key else ''}{name}: unknown key; "
                             + (f"is it '{near[0]}'?" if near else
                                f"there are {', '.join(allowed)}"))


def whole(key, value, least):
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        refuse(key, value, f"a whole number >= {least}")
    return value


def number(key, value):
    try:
        if not isinstance(value, bool) and math.isfinite(float(value)):
            return float(value)
    except (TypeError, ValueError):
        pass
    return refuse(key, value, "a finite number")


def duration(key, value):
    """Seconds of 90, "90s", "3h50m", "01:30:00" (as floe's checkpoint: wall_time)."""
    text = str(value)
    parts = re.fullmatch(r"(?:(\d+)h)?(?:(\d+)m)?(?:(\d+)s)?|(\d+):(\d\d):(\d\d)", text)
    if parts and text:
        h, m, s = parts.groups()[3:] if parts[4] else parts.groups()[:3]
        return 3600 * int(h or 0) + 60 * int(m or 0) + int(s or 0) or refuse(key, value, "> 0 s")
    try:
        seconds = number(key, value)
    except ValueError:
        seconds = -1
    return seconds if seconds > 0 else refuse(
        key, value, "a time > 0: seconds, 3h50m, 90s or 01:30:00")


def flat(section, given, prefix=""):
    """Keys of options: those of a scene, in its sections or joined by _; values as they are."""
    if not isinstance(given, dict):
        refuse(section, given, "a mapping of keys of scenes (docs/options.md)")
    found = {}
    for key, value in given.items():
        name = prefix + re.sub(r"\s*:\s*|\s+", "_", str(key).strip())
        inside = flat(section, value, name + "_") if isinstance(value, dict) else {name: value}
        for one in inside:
            if one in found:
                raise ValueError(f"{section}: {one}: stands twice")
        found |= inside
    return found


def text_of(section, key, value):
    """A value as floe's command line has it."""
    if isinstance(value, list):
        return ",".join(text_of(section, key, one) for one in value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and math.isfinite(value) or isinstance(value, (int, str)):
        return str(value)
    return refuse(f"{section}: {key}", value, "a number, a word, true or false, or a list of them")


def values(section, given):
    """{key: text} of the options in a section of the spec."""
    found = {key: text_of(section, key, value) for key, value in flat(section, given).items()}
    ours(section, found)
    return found


def ours(section, keys):
    """Refuses keys of scenes that only the ensemble gives."""
    for key in keys:
        if key in OURS:
            raise ValueError(f"{section}: {key}: is the ensemble's own")


def grid(given):
    """Every combination of the values of each key; the last key changes first."""
    axes = []
    for key, choices in flat("grid", given).items():
        if not isinstance(choices, list) or not choices:
            refuse(f"grid: {key}", choices, "a list of at least one value")
        axes.append([values("grid", {key: choice}) for choice in choices])
    return [("", None, merged(*cell)) for cell in itertools.product(*axes)]


def recipes(section, given, base):
    """{key: recipe} of a mapping of keys of scenes to commands (floe.ensembles.made)."""
    found = {key: files.read(f"{section}: {key}", commands, base, scene_file)
             for key, commands in flat(section, given).items()}
    ours(section, found)
    return found


def listed(given, base):
    """One point per entry: options, and maybe a name, a scene and a `make` of its own."""
    if not isinstance(given, list) or not given:
        refuse("list", given, "a list of at least one mapping")
    points = []
    for entry in given:
        entry = dict(entry) if isinstance(entry, dict) else refuse("list", entry, "a mapping")
        name, scene = str(entry.pop("name", "")), entry.pop("scene", None)
        if name and not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]*", name):
            refuse("list: name", name, "letters, digits, '.', '_' and '-'")
        made = recipes("list: make", entry.pop("make", {}), base)
        points.append((name, scene if scene is None else scene_file("list: scene", scene, base),
                       values("list", entry), made))
    return points


def latin_hypercube(given):
    """Points that fill the ranges evenly: each of n equal parts of each range has one. Numbers are
    kept to six digits."""
    try:
        from scipy.stats import qmc
    except ImportError:
        raise ValueError("latin_hypercube: needs Python's scipy: apt-get install python3-scipy"
                         ) from None
    known("latin_hypercube", given, ("samples", "seed", "ranges"))
    n = whole("latin_hypercube: samples", given.get("samples"), 1)
    seed = whole("latin_hypercube: seed", given.get("seed", 1), 0)
    ranges = flat("latin_hypercube: ranges", given.get("ranges"))
    ends = []
    for key, pair in ranges.items():
        where = f"latin_hypercube: ranges: {key}"
        if not isinstance(pair, list) or len(pair) != 2:
            refuse(where, pair, "[least, most]")
        low, high = (number(where, end) for end in pair)
        if not low < high:
            refuse(where, pair, "[least, most], least < most")
        ends.append((low, high))
    if not ends:
        refuse("latin_hypercube: ranges", given.get("ranges"), "a mapping {key: [least, most]}")
    unit = qmc.LatinHypercube(len(ends), seed=np.random.default_rng(seed)).random(n)
    low, high = np.transpose(ends)
    return [("", None, values("latin_hypercube", {key: float(f"{value:.6g}")
                                                  for key, value in zip(ranges, row)}))
            for row in low + (high - low) * unit]


def merged(*parts):
    """One mapping of several that must not name the same key."""
    found = {}
    for part in parts:
        for key in part:
            if key in found:
                raise ValueError(f"{key}: is given in two places of the spec")
        found |= part
    return found


def scene_file(key, given, base):
    """The path of a scene, which counts from the spec's folder."""
    if not isinstance(given, str) or not given:
        refuse(key, given, "the path of a scene")
    path = base / given
    if not path.is_file():
        refuse(key, given, f"a file ({path} is none)")
    return os.path.relpath(path) if not Path(given).is_absolute() else given


def seeds_of(given):
    if given is None:
        return [None]
    if isinstance(given, int) and not isinstance(given, bool) and given > 0:
        return list(range(1, given + 1))
    if isinstance(given, list) and given and len(set(map(str, given))) == len(given) and all(
            isinstance(seed, int) and not isinstance(seed, bool) and seed >= 0 for seed in given):
        return given
    return refuse("seeds", given, "a number of seeds >= 1, or a list of different whole numbers "
                                  ">= 0")


def spec_of(given, name, base):
    """A Spec of what a YAML file (or a program) says; ValueError with key, value and what is
    allowed."""
    known("", given, KEYS)
    scene = scene_file("scene", given["scene"], base) if "scene" in given else None
    sections = [grid(given.get("grid") or {}),
                listed(given["list"], base) if "list" in given else [("", None, {}, {})],
                latin_hypercube(given["latin_hypercube"]) if "latin_hypercube" in given
                else [("", None, {})]]
    options = values("options", given.get("options") or {})
    seeds = seeds_of(given.get("seeds"))
    common = recipes("make", given.get("make") or {}, base)
    seeded = [files.needs_seed(recipe) for made in (common, *(part[3] for part in sections[1]))
              for recipe in made.values()]
    if any(seeded) and seeds == [None]:
        raise ValueError("make: {seed}: seeds is not given")
    seed_keys = given.get("seed_keys", ["sheet_seed"])
    if not isinstance(seed_keys, list) or not (seed_keys or any(seeded)):
        refuse("seed_keys", seed_keys, "a list of keys, as [sheet_seed, fracture_seed]")
    seed_keys = list(flat("seed_keys", dict.fromkeys(seed_keys)))
    if seeds == [None] and "seed_keys" in given:
        raise ValueError("seed_keys: would have no effect: seeds is not given")
    seed_keys = seed_keys if seeds != [None] else []
    points = []
    for number, parts in enumerate(itertools.product(*sections), 1):
        label, own, varied = parts[1][0], parts[1][1], merged(*(part[2] for part in parts))
        if (own or scene) is None:
            raise ValueError("scene: is missing; it is the path of a scene, which counts from the "
                             "spec's folder")
        made = merged(common, parts[1][3])
        merged(options, varied, dict.fromkeys(seed_keys), made)
        if not label or len(sections[0]) * len(sections[2]) > 1:
            label = f"{label}_p{number:03d}".lstrip("_")
        told = {key: files.told(recipe) for key, recipe in parts[1][3].items()}
        points.append((label, own or scene, varied, ({"scene": own} if own else {}) | told, made))
    labels = [point[0] for point in points]
    if len(set(labels)) < len(labels):
        raise ValueError(f"list: name: two points are named '{max(labels, key=labels.count)}'")
    limits = given.get("limit") or {}
    known("limit", limits, ("run", "total"))
    output = given.get("output", f"out/ensemble_{name}")
    if not isinstance(output, str) or not output:
        refuse("output", output, "the path of a folder")
    return Spec(name, points, options, seeds, seed_keys, whole("ranks", given.get("ranks", 1), 1),
                *(duration(f"limit: {key}", limits[key]) if key in limits else math.inf
                  for key in ("run", "total")), output, given)


def checked(given, name, where, base):
    """The Spec of nested dicts. InputError, which says where they stand."""
    try:
        return spec_of(given if given is not None else {}, name, base)
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{where}: {' '.join(str(error).split())}") from None


def read(path):
    """The Spec in a YAML file."""
    path = Path(path)
    with reading(path):
        text = path.read_text()
    try:
        given = yaml.load(text, UniqueKeys)
    except (ValueError, yaml.YAMLError) as error:
        raise InputError(f"{path}: {' '.join(str(error).split())}") from None
    return checked(given, path.stem, path, path.parent)


def members(spec):
    """The runs: all seeds of each point. p002_s013 is seed 13 at the second point."""
    runs = []
    varies = len(spec.points) > 1 or spec.points[0][2] or spec.seeds == [None]
    for label, scene, varied, told, recipes_ in spec.points:
        for seed in spec.seeds:
            words = [label if varies else "", "" if seed is None else f"s{seed:03d}"]
            seeded = dict.fromkeys(spec.seed_keys, str(seed))
            made = {key: files.steps(recipe, seed)[-1] for key, recipe in recipes_.items()}
            runs.append(Member("_".join(filter(None, words)), scene, spec.options | varied | seeded,
                               parameters=told | varied, seed=seed, made=made))
    return runs


def read_result(path):
    """What a file results/NAME.json says: {"status", "message", "wall_s", "processor_s",
    "results"}, or None if it is not there."""
    if not path.exists():
        return None
    with reading(path):
        found = json.loads(path.read_text())
        found["status"], found["results"]
        return found


class Folder:
    """An ensemble's folder: ensemble.json (what its runs are), made (files that were made for
    them), runs/NAME (their output), results/NAME.json (how they ended), runs.csv (the table of
    all)."""

    def __init__(self, path, spec):
        self.path, self.spec, self.runs = Path(path), spec, members(spec)
        # Planned time [s] and memory [bytes] of a group of runs that differ by the seed
        self.seconds, self.memory = {}, {}
        for run in self.runs:
            run.made_in = self.path / files.FOLDER

    def output(self, run):
        return self.path / "runs" / run.name

    def result_file(self, run):
        return self.path / "results" / f"{run.name}.json"

    def result(self, run):
        """{"status", "message", "wall_s", "processor_s", "results"} or None."""
        return read_result(self.result_file(run))

    def finished(self, run):
        found = self.result(run)
        return found is not None and found["status"] == "done"

    def compare(self):
        """Refuses a folder that holds something else, or runs of the same names that have other
        options. Takes over the planned times that it knows."""
        kept = self.path / "ensemble.json"
        if not kept.exists():
            if self.path.is_dir() and any(not p.name.startswith(".") for p in self.path.iterdir()):
                raise InputError(f"{self.path}: is neither empty nor an ensemble's folder; choose "
                                 "another (output, --dir)")
            return {}
        with reading(kept):
            before = json.loads(kept.read_text())["runs"]
        for run in self.runs:
            old = before.get(run.name)
            if old is None:
                continue
            if any(old[key] != value for key, value in run.record.items()):
                if self.result_file(run).exists() or self.output(run).exists():
                    raise InputError(f"{self.path}: its run {run.name} has {difference(old, run)}; "
                                     "choose another folder (output, --dir)")
            elif old["seconds"] is not None or not run.made:  # else its file was not there yet
                self.seconds[run.group(self.spec.seed_keys)] = old["seconds"]
                self.memory[run.group(self.spec.seed_keys)] = old.get("memory")
        return before

    def record(self):
        """Writes down what the runs are."""
        runs = self.compare()
        for run in self.runs:
            group = run.group(self.spec.seed_keys)
            runs[run.name] = {**run.record, "parameters": run.parameters, "seed": run.seed,
                              "seconds": self.seconds.get(group), "memory": self.memory.get(group)}
        text = json.dumps({"name": self.spec.name, "spec": self.spec.text, "runs": runs}, indent=1)
        write_whole(self.path / "ensemble.json", text + "\n")

    def plan(self, jobs):
        """Asks floe for the planned time of each point: its first seed. InputError with its words
        if a point is none that floe would run. Costs are times of finished runs where there are
        any; other plans are scaled as those of the finished runs turned out. Points of which no
        seed has its made files yet are not asked for."""
        first = {}
        for run in self.runs:
            if run.ready:
                first.setdefault(run.group(self.spec.seed_keys), run)
        asked = {group: run for group, run in first.items() if group not in self.seconds}
        with concurrent.futures.ThreadPoolExecutor(max(1, jobs)) as pool:
            plans = list(pool.map(lambda run: planned(run, self.output(run), self.spec.ranks),
                                  asked.values()))
        self.seconds |= {group: seconds for group, (seconds, _) in zip(asked, plans)}
        self.memory |= {group: memory for group, (_, memory) in zip(asked, plans)}
        taken = {}
        for run in self.runs:
            if self.finished(run):
                taken.setdefault(run.group(self.spec.seed_keys), []).append(
                    self.result(run)["wall_s"])
        known = [group for group in taken if self.seconds.get(group)]
        pace = (sum(np.mean(taken[group]) for group in known)
                / (sum(self.seconds[group] for group in known) or 1)) or 1.0
        for run in self.runs:
            group = run.group(self.spec.seed_keys)
            run.cost = float(np.mean(taken.get(group, [(self.seconds.get(group) or 1.0) * pace])))

    def unknown(self, run):
        """Whether nobody knows how long a run takes."""
        return (self.seconds.get(run.group(self.spec.seed_keys)) is None
                and not self.finished(run))

    def make(self, runs, jobs, locks=()):
        """Makes the files of runs that are not there; whether all are, which is false when it was
        stopped. Then plans what could not be planned without them."""
        steps = [step for run in runs for step in run.made.values()]
        if not files.make(self.path / files.FOLDER, steps, jobs, locks):
            return False
        if steps:
            self.plan(jobs)
        return True

    def keep(self, run, output, ended):
        """What is kept of a run that has ended: the scalars of its summary."""
        path, summary = output / "summary.json", {}
        if path.exists():
            try:
                summary = json.loads(path.read_text())
            except ValueError:  # it was killed at its start
                pass
        write_whole(self.result_file(run), json.dumps(
            {"status": ended.status, "message": ended.message, "wall_s": round(ended.wall, 3),
             "processor_s": round(ended.processor, 3), "results": scalars(summary)}, indent=1))

    def collect(self):
        """Writes runs.csv: a row for each run in the order of the spec."""
        with locked(self.path / ".table", fcntl.LOCK_EX, math.inf):
            file = io.StringIO()
            table = csv.writer(file, lineterminator="\n")
            table.writerows(table_of([(run.name, run.parameters, run.seed, self.result(run))
                                      for run in self.runs]))
            write_whole(self.path / "runs.csv", file.getvalue())


def table_of(runs):
    """The table of the runs of an ensemble: names of its columns, then a row for each run. runs:
    [(name, parameters, seed, result or None)]."""
    found = [result or {"status": "waiting", "message": "", "wall_s": "", "processor_s": "",
                        "results": {}} for *_, result in runs]
    parameters = list(dict.fromkeys(k for _, own, _, _ in runs for k in own))
    head = ["run", *parameters, "seed", "status", "message", "wall_s", "processor_s"]
    columns = list(dict.fromkeys(k for result in found for k in result["results"]
                                 if k not in head))
    rows = [head + columns]
    for (name, own, seed, _), result in zip(runs, found):
        seed = seed if seed is not None else result["results"].get("seed", "")
        rows.append([name, *(own.get(k, "") for k in parameters), seed,
                     *(result[k] for k in head[-4:]),
                     *(result["results"].get(k, "") for k in columns)])
    return rows


def difference(old, run):
    """What a run of the folder has that the spec has not."""
    options_now = run.record["options"]
    for key in {**old["options"], **options_now}:
        was, now = (options.get(key, "(not given)") for options in (old["options"], options_now))
        if was != now:
            return f"{key} {was}, the spec says {now}"
    return f"another scene than {run.scene} is now"


def scalars(summary):
    """Numbers and words of a summary.json, {name: value}; vectors as NAME_x, _y, _z. Without what
    depends on the machine."""
    found = {}

    def visit(name, value):
        if isinstance(value, dict):
            for key, inside in value.items():
                visit(f"{name}_{key}" if name else key, inside)
        elif isinstance(value, list):
            if len(value) == 3 and all(isinstance(one, (int, float)) for one in value):
                for axis, one in zip("xyz", value):
                    visit(f"{name}_{axis}", one)
        else:
            found[name] = value
    visit("", {key: value for key, value in summary.items()
               if key not in TIMES and key not in ("status", "message")})
    return found


def planned(run, output, ranks):
    """Wall time [s] of a run as floe plans it, and its memory before the first step [bytes]; None
    for what floe cannot tell."""
    done = subprocess.run([*run.command(output, ranks), "-check"], capture_output=True, text=True,
                          env={**os.environ, **ENVIRONMENT})
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if line.strip()] or ["no message"]
        raise InputError(f"run {run.name}: "
                         + ([line for line in said if line.startswith("floe")] or said)[-1])
    time = re.search(rf"; about ([\d.e+-]+) ({'|'.join(UNITS)}) \(by ", done.stdout)
    memory = re.search(rf"; ([\d.e+-]+) ({'|'.join(SIZES)}) of memory", done.stdout)
    return (float(time[1]) * UNITS[time[2]] if time else None,
            float(memory[1]) * SIZES[memory[2]] if memory else None)
