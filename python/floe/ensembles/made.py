"""Files that commands make for the runs of an ensemble, as lattices (`make` of a spec,
docs/ensembles.md): each distinct command is run once, several at a time, and its file is kept under
a name that goes with the command's text."""
import contextlib
import hashlib
import math
import os
import re
import shlex
import string
import sys
from dataclasses import dataclass
from pathlib import Path

from floe import program
from floe.ensembles.runs import Run, Runner, dies_with, locked
from floe.errors import InputError
from floe.results.output import summary_of

# Tools that make a file, and its ending.
TOOLS = {"make_lattice": ".h5", "make_ridge": ".h5", "make_floes": ".geojson"}
FIELDS = ("seed", "before", "here")
FOLDER = "made"  # in the folder of the ensemble


def read(key, given, base, scene_file):
    """A recipe: the commands, one after the other, that make the file of a key of scenes, as
    [(words, path of its scene or None, folder of the spec)]. ValueError with the key, the value and
    what is allowed.

    given: a command, or a list of commands; base: the folder from which paths of scenes count;
    scene_file(key, path, base): the path of a scene from here."""
    commands = given if isinstance(given, list) else [given]
    if not commands:
        raise ValueError(f"{key}: [] must be a command or a list of commands")
    found = []
    for number, command in enumerate(commands):
        try:
            words = shlex.split(command) if isinstance(command, str) else []
            fields = {name for word in words for _, name, _, _ in string.Formatter().parse(word)
                      if name is not None}
        except ValueError as error:
            raise ValueError(f"{key}: '{command}': {error}") from None
        if not words or words[0] not in TOOLS and not words[0].endswith(".yaml"):
            raise ValueError(f"{key}: '{command}' must begin with one of {', '.join(TOOLS)} or be "
                             "a scene (.yaml)")
        for name in sorted(fields):
            if name not in FIELDS or name == "before" and number == 0:
                raise ValueError(f"{key}: '{command}': {{{name}}} is not known here; there are "
                                 "{seed}, {here} and, from the second command on, {before}")
        found.append((words, None if words[0] in TOOLS else scene_file(key, words[0], base),
                      Path(base)))
    if found[-1][1]:
        raise ValueError(f"{key}: '{commands[-1]}' makes a folder, not a file; the last command "
                         f"must begin with one of {', '.join(TOOLS)}")
    return found


def needs_seed(recipe):
    """Whether the file of a recipe depends on the seed of a run."""
    return any("{seed}" in word for words, *_ in recipe for word in words)


def told(recipe):
    """A recipe as one text, with {seed} and {before} as they are."""
    return " && ".join(shlex.join(words) for words, *_ in recipe)


@dataclass
class Step(Run):
    """A command of a recipe, by its words as the spec has them; scene: the path of its scene from
    here, or None of a tool; before: the step whose file it needs, or None; here: the folder of the
    spec."""
    before: object = None
    here: object = None

    @property
    def text(self):
        """The command with those before it, as a shell would have it; {before} is what the command
        before has made."""
        return (f"{self.before.text} && " if self.before else "") + shlex.join(self.words)

    def scenes(self):
        """The paths of its scene and of those before it."""
        return ([self.scene] if self.scene else []) + (self.before.scenes() if self.before else [])

    @property
    def ending(self):
        return "" if self.scene else TOOLS[self.words[0]]

    def place(self, folder):
        """Its file, or the folder of results of its scene."""
        return Path(folder) / "runs" / (self.name + self.ending)

    def part(self, output):
        """The file under the name that it has until it is whole."""
        return output.with_name(f"{output.name}.part{self.ending}")

    def done(self, folder):
        place = self.place(folder)
        if not self.scene:
            return place.exists()
        with contextlib.suppress(InputError):
            return summary_of(place).get("status") == "done"
        return False

    def command(self, output, ranks=1):
        output = Path(output)
        before = self.before.place(output.parent.parent) if self.before else None
        words = [word.replace("{before}", str(before)).replace("{here}", str(self.here))
                 for word in self.words[1:]]
        if self.scene:
            return Run(self.name, self.scene, {}, tuple(words)).command(output)
        return [*dies_with(f"= {os.getpid()}"), sys.executable,
                str(program.TOOLS / self.words[0]), *words, str(self.part(output))]


def steps(recipe, seed):
    """The steps of a recipe for a run of this seed; the last one makes its file. Those of the same
    words and the same text of scenes have the same name."""
    found, digest = [], hashlib.sha256()
    for words, scene, here in recipe:
        words = tuple(word.replace("{seed}", str(seed)) for word in words)
        digest.update("\0".join(words).encode())
        if scene:
            digest.update(Path(scene).read_bytes())
        stem = re.sub(r"\W+", "_", Path(words[0]).stem)
        found.append(Step(f"{stem}_{digest.hexdigest()[:12]}", scene, {}, words,
                          before=found[-1] if found else None, here=here))
    return found


def finish(step, output, ended):
    """Gives a file that is whole its name."""
    if not step.scene and ended.status == "done":
        step.part(output).replace(step.place(output.parent.parent))


def make(folder, wanted, jobs, locks=()):
    """Makes what is not there of the files of these last steps, `jobs` at a time; whether all are
    there, which is false when it was stopped. InputError with a command's last words if it fails.

    folder: of all files that are made; locks: descriptors that the commands inherit."""
    rounds = {}
    for last in wanted:
        needed = []
        while last is not None and not last.done(folder):
            needed.insert(0, last)
            last = last.before
        for number, step in enumerate(needed):
            rounds.setdefault(number, {})[step.name] = step
    for number in sorted(rounds):
        with contextlib.ExitStack() as stack:
            held = [stack.enter_context(locked(Path(folder) / f".lock_{name}", patience=math.inf))
                    for name in sorted(rounds[number])]
            waiting = [step for step in rounds[number].values() if not step.done(folder)]
            ended = Runner(Path(folder), jobs, finish, locks=[*locks, *held]).perform(waiting)
        for step, how in ended:
            if how.status == "failed":
                raise InputError(f"make: '{step.text}': {how.message}")
        if len(ended) < len(waiting) or any(how.status == "stopped" for _, how in ended):
            return False
    return True

