"""Rows of docs/validation.md: their specs in tools/validation, their runs, and the verdict on what
they measure (tools/validate; measures: floe_validation_measures.py). SI units."""
import functools
import re
import subprocess
import sys
from pathlib import Path

import yaml

from floe import program
from floe.ensembles import specs
from floe.ensembles.specs import known, number, refuse, whole
from floe.errors import InputError, reading
from floe.results import tables
from floe.results.output import options_of, summary_of
from floe_validation_measures import MEASURES

SPECS = program.TOOLS / "validation"
KEYS = ("title", "text", "published", "source", "measure", "settings", "chaotic", "seconds",
        "ends", "lattice_seeds", "runs", "short", "disagreement")
NEEDED = ("title", "text", "published", "source", "measure", "seconds", "runs")
SHORT = ("seeds", "lattice_seeds", "points", "options", "within")
SEEDS = 10   # that a chaotic row needs


def seed_of(name):
    """The seed in the name of a run, or None."""
    match = re.search(r"(?:^|_)s(\d+)$", name)
    return int(match[1]) if match else None


class Drawn:
    """A finished run of a row. point: the name of its point, number of the seed in its name or
    None."""

    def __init__(self, run, folder):
        self.name, self.folder = run.name, Path(folder)
        self.point, self.seed = re.sub(r"(^|_)s\d+$", "", run.name), seed_of(run.name)

    @functools.cached_property
    def history(self):
        """history.csv as a table."""
        return tables.history(self.folder)

    @functools.cached_property
    def options(self):
        return options_of(self.folder)

    @functools.cached_property
    def summary(self):
        return summary_of(self.folder)

    def option(self, key):
        """A number of the scene, or a list of numbers."""
        found = [float(word) for word in self.options[key].replace(",", " ").split()]
        return found[0] if len(found) == 1 else found

    def column(self, name):
        return self.history[name].to_numpy()


class RowFolder(specs.Folder):
    """An ensemble's folder in which runs that end where no equilibrium is left are done."""

    def __init__(self, path, spec, ends):
        super().__init__(path, spec)
        self.ends = ends

    def keep(self, run, output, ended):
        if ended.status == "failed" and self.ends and re.search(self.ends, ended.message):
            ended.status = "done"
        super().keep(run, output, ended)


def lattice_file(folder, words):
    """The file that floe make_lattice WORDS writes, by name."""
    name = re.sub(r"[^A-Za-z0-9.]+", "_", words).strip("_")
    return (Path(folder) / "lattices" / f"{name}.h5").resolve()


def as_numbers(given):
    """Settings with what YAML leaves as text but is a number (1e6) as one."""
    if isinstance(given, dict):
        return {key: as_numbers(value) for key, value in given.items()}
    if isinstance(given, list):
        return [as_numbers(value) for value in given]
    try:
        return float(given) if isinstance(given, str) else given
    except ValueError:
        return given


class Row:
    """A row as its spec says it. short: the form for tools/check, a few of its runs."""

    def __init__(self, path, short=False):
        self.path, self.name = Path(path), Path(path).stem
        with reading(path):
            text = self.path.read_text()
        try:
            given = yaml.load(text, specs.UniqueKeys)
            self.read(given if isinstance(given, dict) else {}, short)
        except InputError:
            raise
        except (ValueError, yaml.YAMLError) as error:
            raise InputError(f"{path}: {' '.join(str(error).split())}") from None

    def read(self, given, short):
        known("", given, KEYS)
        for key in NEEDED:
            if key not in given:
                raise ValueError(f"{key}: is missing")
        for key in ("title", "text", "published", "source", "disagreement", "ends"):
            if not isinstance(given.get(key, ""), str):
                refuse(key, given[key], "text")
        self.title, self.text, self.published = (" ".join(given[key].split())
                                                 for key in ("title", "text", "published"))
        self.source, self.disagreement = (" ".join(given.get(key, "").split())
                                          for key in ("source", "disagreement"))
        self.ends = given.get("ends", "")
        if given["measure"] not in MEASURES:
            refuse("measure", given["measure"], f"one of {', '.join(sorted(MEASURES))}")
        self.measure = MEASURES[given["measure"]]
        self.settings = as_numbers(given.get("settings", {}))
        self.chaotic = given.get("chaotic", False)
        if not isinstance(self.chaotic, bool):
            refuse("chaotic", self.chaotic, "true or false")
        self.seconds = number("seconds", given["seconds"])
        if not isinstance(given["runs"], dict):
            refuse("runs", given["runs"], "a mapping as a spec of floe ensemble")
        self.runs = dict(given["runs"])
        self.lattice_seeds = whole("lattice_seeds", given.get("lattice_seeds", 1), 1)
        self.seeded = "lattice_seeds" in given
        self.has_short, self.within = "short" in given, None
        if self.has_short:
            known("short", given["short"], SHORT)
        if short:
            self.shorten(given.get("short"))
        self.spec(".")  # what is wrong with it is said now

    def shorten(self, short):
        """Takes the short form of the runs."""
        if short is None:
            raise ValueError("short: is missing")
        for key in ("seeds", "options"):
            if key in short:
                self.runs[key] = ({**self.runs.get(key, {}), **short[key]}
                                  if key == "options" else short[key])
        if "points" in short:
            kept = [one for one in self.runs.get("list", []) if one.get("name") in short["points"]]
            if len(kept) < len(short["points"]):
                refuse("short: points", short["points"], "names of runs: list")
            self.runs["list"] = kept
        self.lattice_seeds = short.get("lattice_seeds", self.lattice_seeds)
        self.within = short.get("within")
        if not isinstance(self.within, list) or len(self.within) != 2:
            refuse("short: within", self.within, "[least, most] of all its numbers")
        self.within = [number("short: within", one) for one in self.within]

    def lattices(self):
        """Per entry of `list` its lattice's words or None, without seeds."""
        return [entry.get("lattice") for entry in self.runs.get("list", [])
                if isinstance(entry, dict)]

    def spec(self, folder):
        """The ensemble of its runs; `lattice` of a point becomes the file of that lattice."""
        given = dict(self.runs)
        given["output"] = str(Path(folder) / self.name)
        if "list" in given:
            points = []
            for entry in given["list"]:
                entry = dict(entry)
                words = entry.pop("lattice", None)
                for seed in range(1, self.lattice_seeds + 1):
                    point = dict(entry)
                    if words:
                        point["lattice_file"] = str(lattice_file(folder, words.format(seed=seed)))
                    if self.seeded:
                        point["name"] = f"{entry.get('name', 'p')}_s{seed:03d}"
                    points.append(point)
            given["list"] = points
        return specs.spec_of(given, self.name, self.path.parent)

    def made_by(self):
        """The scenes in the commands that make files of its runs."""
        return sorted({scene for run in self.folder(".").runs for step in run.made.values()
                       for scene in step.scenes()})

    def make_lattices(self, folder):
        """Writes what is not there of the lattices of its runs."""
        for words in filter(None, self.lattices()):
            for seed in range(1, self.lattice_seeds + 1):
                given = words.format(seed=seed)
                path = lattice_file(folder, given)
                if path.exists():
                    continue
                path.parent.mkdir(parents=True, exist_ok=True)
                part = path.with_name(f".{path.name}.part.h5")
                made = subprocess.run([sys.executable, program.TOOLS / "make_lattice",
                                       *given.split(), part], capture_output=True, text=True)
                if made.returncode != 0:
                    raise InputError(f"{self.path}: lattice: '{given}': "
                                     f"{(made.stderr.strip() or 'no message').splitlines()[-1]}")
                part.replace(path)

    def folder(self, directory):
        return RowFolder(Path(directory) / self.name, self.spec(directory), self.ends)

    def finished(self, directory):
        """Its finished runs, and how many there should be."""
        folder = self.folder(directory)
        folder.compare()
        done = [Drawn(run, folder.output(run)) for run in folder.runs if folder.finished(run)]
        return done, len(folder.runs)

    def found(self, done):
        """What its finished runs give: a Found."""
        return self.measure(done, self.settings)


def rows(short=False, folder=SPECS):
    """All rows, those with a short form only on request, in the order of their names."""
    found = [Row(path) for path in sorted(Path(folder).glob("*.yaml"))]
    return [Row(row.path, True) for row in found if row.has_short] if short else found


def verdict_of(row, found):
    """agrees, disagrees or reported, of the whole row; with the number of seeds where chaos rules
    and they are too few."""
    verdicts = [line.verdict for line in found.lines]
    word = ("disagrees" if "disagrees" in verdicts else
            "agrees" if "agrees" in verdicts else "reported")
    fewest = min(line.draws for line in found.lines)
    return f"{word}, {fewest} of {SEEDS} seeds" if row.chaotic and fewest < SEEDS else word
