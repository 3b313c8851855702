#!/usr/bin/python3
"""Tries floe with scenes, command lines, files and solver options as hostile and naive users would
write them.

    tests/stress/fuzz.py --kind scene --seed 123 [--keep FOLDER]      one case: its files, what floe
    says, broken rules tests/stress/fuzz.py [--cases 500] [--first 0] [--kind KIND] [--jobs N]
    many; exit code 1 if any breaks a rule

Each case follows from its kind and seed alone. Rules: no signal, no hang, no trace, an exit code of
0 to 3; exit code 2 with one line that names something of the input, nothing touched; exit code 0
with finite results; exit code 1 with a summary that says so.
FLOE: the program, build/release/floe by default.
"""
import argparse
import concurrent.futures
import os
import math
import random
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "regression"))
import fuzz_files  # noqa: E402
import fuzz_outlines  # noqa: E402
import fuzz_solids  # noqa: E402
import fuzz_structures  # noqa: E402
import fuzz_words  # noqa: E402
from fuzz_keys import read_keys  # noqa: E402
from fuzz_rules import is_help, run_case  # noqa: E402
from fuzz_scenes import LATTICES, Scenes, bound, scene_of, write_scene  # noqa: E402

# One case of each, again and again.
KINDS = ("scene", "keys", "lattice", "words", "scene", "keys", "checkpoint", "petsc", "text",
         "mesh", "outline", "structure", "solid", "structure", "table")
FILES = ("o.h5", "hull.stl", "elbow.obj", "tug.csv")  # of obstacles and lines
TMPFS = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None

LATTICE_SCENES = {
    "frame.h5": "integrator: explicit\nforces: [beam]\nbeam: {damping_ratio: 0.1}\n"
                "initial: {names: [i], i: {set: tip, velocity: [0, 1, 1]}}\n"
                "lattice_file: frame.h5\ntime: {end: 1}\n",
    "triangles.h5": "forces: [beam]\nlattice_file: triangles.h5\nboundary: {names: [a], a: {set: "
                    "left, fix: x y z rx ry rz}}\n"
                    "load: {names: [p], p: {set: right, force: [1e3, 0, 1e2]}}\n",
    "rubble.h5": "integrator: explicit\nforces: [contact, gravity, buoyancy]\n"
                 "contact: {young: 1e6}\nlattice_file: rubble.h5\n"
                 "time: {end: 10}\noutput: {fields: 1e-3}\n",
    "strip.h5": "integrator: implicit\nforces: [beam, gravity, buoyancy]\nlattice_file: strip.h5\n"
                "time: {end: 1}\n",
    "o.h5": "integrator: explicit\nforces: [beam, contact]\nsheet: {length: 6, element_size: 2}\n"
            "obstacle: {names: [o], o: {shape: file, file: o.h5, point: [3.6, 0, 0], velocity: "
            "[-1, 0, 0]}}\ntime: {end: 1}\n"}
MESH_SCENE = ("integrator: explicit\nforces: [beam]\n"
              "sheet: {length: 6, element_size: 2, iterations: 9, mesh_file: m.h5}\n"
              "time: {end: 1}\n")
PETSC_SCENES = ("forces: [beam]\nsheet: {length: 8, thickness: 1, element_size: 2, iterations: 5}\n"
                "boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}\n"
                "load: {names: [p], p: {set: right, force: [1e5, 0, 1e3]}}\n",
                "integrator: implicit\nforces: [beam, gravity, buoyancy]\n"
                "sheet: {length: 6, element_size: 2}\n"
                "time: {end: 0.1, dt: 0.02}\n",
                "integrator: explicit\nforces: [beam]\nsheet: {length: 6, element_size: 2}\n"
                "time: {end: 1e-3}\n",
                "integrator: explicit\nforces: [beam]\nsheet: {length: 6, element_size: 2}\n"
                "time: {end: 1e-3}\n"
                "ts: {type: rk, rk_type: 4}\n")


def are_close(one, other):
    """Whether two history.csv are the same but for the rounding of sums over ranks."""
    tables = [np.genfromtxt(path, delimiter=",", names=True) for path in (one, other)]
    if tables[0].dtype.names != tables[1].dtype.names or len(tables[0]) != len(tables[1]):
        return False
    for name in tables[0].dtype.names:
        a, b = (table[name] for table in tables)
        scale = 1 if name == "energy_balance_error" else np.abs(a).max()  # a part of the energies
        if not np.allclose(a, b, rtol=0, atol=1e-9 * scale):
            return False
    return True


class Case:
    """Files (name: bytes), words of the command line, environment, ranks: all from a kind and a
    seed."""

    def __init__(self, kind, seed, base):
        self.kind, self.seed, self.base = kind, seed, base
        self.files, self.words, self.environment, self.ranks = {}, [], {}, 1
        self.may_fail_early = False
        self.scene, self.tree, self.damaged = "", None, None
        self.must, self.volume = None, None  # exit code; volume of its solid [m^3]
        self.said = ""  # by floe
        chance = random.Random(f"{kind} {seed}")
        getattr(self, "make_" + kind)(chance)
        if self.ranks == 1 and chance.random() < 0.03:
            self.ranks = 2
            self.must = None  # the scene may have one body
        if kind in ("scene", "keys") and chance.random() < 0.05:
            self.words.append("-check")
        self.may_fail_early = is_help(self.words) or "-check" in self.words

    def put_scene(self, text, words):
        self.scene = text if isinstance(text, str) else text.decode(errors="replace")
        self.files["s.yaml"] = text.encode(errors="surrogatepass") if isinstance(text,
                                                                                 str) else text
        self.words = ["s.yaml", *words]

    def any_scene(self, chance):
        scenes = self.base.scenes
        way = chance.random()
        if way < 0.2:
            made = fuzz_structures.Made(chance)
            self.files.update(made.all_files())
            return made.scene
        return scenes.made(chance) if way < 0.6 else scenes.changed(chance)

    def make_scene(self, chance):
        scene = self.base.scenes.changed(chance)
        words = bound(scene, chance)
        self.put_scene(write_scene(scene), words)

    def make_keys(self, chance):
        scene = self.base.scenes.made(chance)
        if chance.random() < 0.4:
            self.base.scenes.spoil(scene, chance)
        words = bound(scene, chance)
        self.put_scene(write_scene(scene), words)

    def make_text(self, chance):
        scene = self.any_scene(chance)
        words = bound(scene, chance)
        self.put_scene(self.base.scenes.damaged(write_scene(scene), chance), words)

    def make_structure(self, chance):
        made = fuzz_structures.Made(chance)
        spoilt, held = chance.random() < 0.5, made.is_held()
        if spoilt:
            self.base.scenes.spoil(made.scene, chance)
        words = bound(made.scene, chance)
        if not spoilt and not chance.randrange(4):  # half of it by the command line
            for path in chance.sample(sorted(made.scene), len(made.scene) // 2):
                value = made.scene.pop(path)
                words += ["-" + "_".join(path), value.strip("[]").replace(", ", ",")]
        self.put_scene(write_scene(made.scene), words)
        self.files.update(made.all_files())
        self.must = None if spoilt or held or made.may_overlap else 0

    def make_table(self, chance):
        made = fuzz_structures.Made(chance)
        while not made.tables:
            made = fuzz_structures.Made(chance)
        self.must = made.spoil_table()
        if made.may_overlap and self.must == 0:
            self.must = None
        self.put_scene(write_scene(made.scene), bound(made.scene, chance))
        self.files.update(made.all_files())

    def make_solid(self, chance):
        scene, name, data, self.must, self.volume = fuzz_solids.case(chance)
        self.put_scene(scene, ["-ts_max_steps", "2"])
        self.files[name] = data

    def make_words(self, chance):
        scene = self.base.scenes.made(chance)
        words = bound(scene, chance)
        more = fuzz_words.command_line(self.base.scenes, scene, chance)
        self.put_scene(write_scene(scene), [*more, *words])
        if chance.random() < 0.15:
            self.words.remove("s.yaml")
            self.words.insert(chance.randrange(len(self.words) + 1), "s.yaml")
        elif chance.random() < 0.1:
            self.words.remove("s.yaml")
            self.words = self.words or ["-check"]

    def damage(self, name, chance):
        data = (self.base.folder / name).read_bytes()
        if chance.random() < 0.4:
            return fuzz_files.flipped(data, chance)
        return fuzz_files.changed(data, chance)

    def make_lattice(self, chance):
        name = chance.choice(list(LATTICE_SCENES))
        steps = {"triangles.h5": None, "strip.h5": "8"}.get(name, "40")
        self.put_scene(LATTICE_SCENES[name], ["-ts_max_steps", steps] if steps else [])
        self.files[name] = self.damage(name, chance)
        self.damaged = name

    def make_mesh(self, chance):
        self.put_scene(MESH_SCENE, ["-ts_max_steps", "5"])
        self.files["m.h5"] = self.damage("m.h5", chance)
        self.damaged = "m.h5"

    def make_outline(self, chance):
        scene, name, data = fuzz_outlines.case(chance)
        self.put_scene(scene, ["-ts_max_steps", "3", "-limit_memory", "1"])
        self.files[name] = data

    def make_checkpoint(self, chance):
        self.tree = self.base.folder / "c"
        self.damaged = "out/s/checkpoint.h5"
        self.put_scene(fuzz_files.CHECKPOINTED, list(fuzz_files.RESTART))
        way = chance.random()
        if way < 0.7:
            self.files[self.damaged] = self.damage("c/out/s/checkpoint.h5", chance)
            return
        # The good checkpoint of another scene, or none.
        scene = scene_of(fuzz_files.CHECKPOINTED)
        self.base.scenes.spoil(scene, chance)
        more = fuzz_words.command_line(self.base.scenes, scene,
                                       chance) if chance.random() < 0.3 else []
        self.put_scene(write_scene(scene), [*more,
                                            *(fuzz_files.RESTART if way < 0.95
                                              else fuzz_files.RESTART[2:])])
        self.damaged = None

    def make_petsc(self, chance):
        scene, options, words = chance.choice(PETSC_SCENES), fuzz_words.petsc_options(chance), []
        for name, value in options:
            way = chance.random()
            text = "-" + name + ("" if value is None else " " + value)
            if way < 0.7:
                words += ["-" + name] + ([] if value is None else [value.replace("\0", "")])
            elif way < 0.8:
                self.environment["PETSC_OPTIONS"] = (self.environment.get("PETSC_OPTIONS", "") + " "
                                                     + text).replace("\0", "")
            elif way < 0.9:
                self.files[".petscrc"] = self.files.get(".petscrc", b"") + text.encode() + b"\n"
            else:
                scene += f"{name}: {value}\n"
        self.put_scene(scene, words)

    def all_text(self):
        """What a message may name."""
        names = " ".join([*self.files, *LATTICES, *FILES,
                          "checkpoint mesh_file lattice_file m.h5 scene"])
        datasets = self.base.names if self.damaged else ""
        rest = " ".join(self.files[name].decode(errors="replace") for name in self.files
                        if name == ".petscrc")
        # one may be missing
        keys = " ".join(word for key in self.base.scenes.keys for word in key.path)
        text = " ".join([self.scene, *self.words, *self.environment.values(), names, datasets, rest,
                         keys])
        text = text.encode(errors="replace").decode()
        return text + " " + text.replace("_", " _ ")

    def lay(self, folder):
        for name in (*LATTICES, *FILES):
            if name not in self.files and (name in self.scene
                                           or any(name in word for word in self.words)):
                shutil.copy(self.base.folder / name, folder)
        if self.tree:
            shutil.copytree(self.tree, folder, dirs_exist_ok=True, symlinks=True)
        for name, data in self.files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)

    def earlier(self, folder):
        """Folders with a summary of an earlier run, if that is still there."""
        if not self.tree:
            return []
        old, new = self.tree / "out/s/summary.json", folder / "out/s/summary.json"
        return [folder / "out/s"] if new.exists() and old.read_bytes() == new.read_bytes() else []

    def check_results(self, folder):
        """Which rule of this kind a run breaks that ended well: a restart from a damaged checkpoint
        is the undamaged run's, convex parts have their solid's volume."""
        if self.volume is not None:
            return self.check_volume()
        if self.kind != "checkpoint" or not self.damaged:
            return None
        if "-check" in self.words:
            return None
        straight, resumed = (f / "out/s/history.csv" for f in (self.base.folder / "d", folder))
        same = (straight.read_bytes() == resumed.read_bytes() if self.ranks == 1
                else are_close(straight, resumed))
        return None if same else ("a damaged checkpoint gives other results",)

    def check_volume(self):
        """The volume of a solid and of its parts, in the remark on it."""
        found = re.search(r"triangles around (\S+) m\^3 are .* of (\S+) m\^3, at most (\S+) m",
                          self.said)
        if not found:
            return ("no remark on the solid",)
        whole, parts, apart = map(float, found.groups())
        if not math.isclose(whole, self.volume, rel_tol=1e-3):
            return ("the solid's volume", whole, "must be", self.volume)
        if not math.isclose(parts, whole, rel_tol=1e-3 if apart < 1e-3 else 0.5):
            return ("the volume of its parts", parts, "must be", whole)
        return None


class Base:
    """What cases have in common: the list of keys, good files."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.scenes = Scenes(read_keys())
        fuzz_files.lay_lattices(self.folder)
        fuzz_files.lay_mesh_and_checkpoint(self.folder)
        self.names = fuzz_files.names_in(self.folder)


def kind_of(seed):
    return KINDS[seed % len(KINDS)]


def try_case(kind, seed, base):
    """Outcome of one case, and how long it took [s]."""
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="fuzz", dir=TMPFS) as around:
        # one that a case escapes to is in the temporary folder too
        folder = Path(around) / "in" / "case"
        folder.mkdir(parents=True)
        outcome = run_case(Case(kind, seed, base), folder)
    return outcome, time.monotonic() - began


def try_many(seeds, kind=None, jobs=1, say=None):
    """Outcomes that broke a rule, counts of exit codes per kind, the slowest cases."""
    broken, codes, slowest = [], {}, []
    with (tempfile.TemporaryDirectory(prefix="fuzz_base", dir=TMPFS) as folder,
          concurrent.futures.ThreadPoolExecutor(jobs) as pool):
        base = Base(folder)
        for outcome, took in pool.map(lambda seed: try_case(kind or kind_of(seed), seed, base),
                                      seeds):
            count = codes.setdefault(outcome.case.kind, {})
            count[outcome.code] = count.get(outcome.code, 0) + 1
            slowest = sorted([*slowest, (took, outcome.case.kind, outcome.case.seed)],
                             reverse=True)[:8]
            if outcome.broken:
                broken.append(outcome)
                if say:
                    say(outcome.report())
    return broken, codes, slowest


def show(kind, seed, keep):
    """One case, with all that there is to see."""
    with tempfile.TemporaryDirectory(prefix="fuzz", dir=TMPFS) as folder:
        base = Base(folder)
        case = Case(kind, seed, base)
        inside = Path(folder) / "in" / "case"
        inside.mkdir(parents=True)
        outcome = run_case(case, inside)
        if keep:
            keep = Path(keep)
            keep.mkdir(parents=True, exist_ok=True)
            case.lay(keep)
        print("--- s.yaml\n" + case.scene[:6000])
        print("--- standard output\n" + outcome.out[-3000:] + "--- standard error\n"
              + outcome.error[:6000])
        print(outcome.report())
    return 1 if outcome.broken else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kind", choices=sorted(set(KINDS)))
    parser.add_argument("--seed", type=int, help="one case")
    parser.add_argument("--keep", help="a folder where the files of the one case are left")
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--first", type=int, default=0, help="the first seed of many")
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    if given.seed is not None:
        return show(given.kind or kind_of(given.seed), given.seed, given.keep)
    began = time.monotonic()
    broken, codes, slowest = try_many(range(given.first, given.first + given.cases), given.kind,
                                      given.jobs,
                                      lambda text: print(text, flush=True))
    print(f"{given.cases} cases, {len(broken)} break a rule, {time.monotonic() - began:.0f} s")
    for kind, count in sorted(codes.items()):
        print(f"  {kind}: " + ", ".join(f"{number} with exit code {code}"
                                        for code, number in sorted(count.items())))
    print("  slowest: " + ", ".join(f"{kind} {seed} {took:.1f} s" for took, kind, seed in slowest))
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
