"""Scenes: all input of a run."""
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from . import library
from .errors import InputError


@dataclass(frozen=True)
class Option:
    """A line of the table of options (docs/options.md)."""
    key: str  #: as in a scene, "sheet: length"; NAME stands for each name of the section
    kind: str  #: flag, number, duration, integer, numbers, choice, choices, names or text
    unit: str
    default: str  #: as text; in parentheses what holds without the option
    allowed: str  #: bounds or words
    meaning: str
    count: int = 1  #: of numbers

    @property
    def name(self) -> str:
        """As on the command line and as a keyword of Scene: sheet_length."""
        return self.key.replace(": ", "_")


def options() -> list[Option]:
    """The table of all options of a scene, in the order of docs/options.md."""
    return [Option(*line) for line in library.compiled.options()]


class Scene:
    """The input of a run, read and checked.

    scene    path of a scene's file, or nested dicts with the same keys:
             {"integrator": "explicit", "forces": ["beam", "gravity"], "sheet": {"length": 40}}
    name     of a scene of dicts; its output folder is out/NAME unless it says so
    options  further options, as on the command line, which win: sheet_seed=3, time={"end": 2}.
             Options of PETSc are those of this scene alone: ts_max_steps=10.

    Units and checks are those of the file. Collective: all ranks make it alike.
    Raises InputError with one line that names the key, the value and what is allowed.
    """

    def __init__(self, scene: str | os.PathLike | Mapping[str, Any], /, *,
                 name: str = "scene", **options: Any):
        library.start()
        text = None
        path = name
        if not isinstance(name, str) or not name:
            raise InputError(f"name: {name!r} must be a text, which is not empty")
        if isinstance(scene, Mapping):
            text = _as_yaml(scene)
        elif isinstance(scene, (str, os.PathLike)):
            path = os.fspath(scene)
        else:
            raise InputError(f"scene: {scene!r} must be a path or a dict")
        self._read = library.compiled.Scene(path, text, _as_words(options))

    @property
    def name(self) -> str:
        """Stem of the file, or the given name."""
        return self._read.name

    @property
    def end(self) -> float:
        """Time at which the run ends [s]; in statics pseudo-time."""
        return self._read.end

    @property
    def output(self) -> str:
        """The output folder."""
        return self._read.output

    @property
    def obstacles(self) -> list[str]:
        """Names of the obstacles, in order."""
        return self._read.obstacles

    @property
    def yaml(self) -> str:
        """Every option as used, as text: the options.yaml of the run."""
        return self._read.yaml

    @property
    def warnings(self) -> list[str]:
        """Remarks on numbers that suggest mistaken units."""
        return self._read.warnings

    def check(self) -> dict[str, Any]:
        """Builds all of the run and makes no step: {"bodies", "beams": numbers, "dt": first step
        [s]}. Nothing is locked or written. Collective. Raises InputError."""
        run = library.compiled.Run(self._read, [], [], False, False, True)
        try:
            run.prepare()
            return {"bodies": len(run.bodies()[0]), "beams": len(run.beams()[0]), "dt": run.dt()}
        finally:
            run.close()

    def __repr__(self) -> str:
        return f"floe.Scene({self.name!r})"


def _scalar(key: str, value: Any) -> str:
    """A value as text."""
    if value is None:
        return ""
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:  # of numpy
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        value = int(value)  # 20.0 for a whole number; a number is the same without a point
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    raise InputError(f"{key}: {value!r} must be a number, a text, true or false, a list of these, "
                     "or a dict")


def _is_list(value: Any) -> bool:
    return (isinstance(value, Sequence) and not isinstance(value, str)) or (
        hasattr(value, "ndim") and value.ndim == 1)


def _as_words(options: Mapping[str, Any], before: str = "") -> list[str]:
    """Options as words of a command line."""
    words = []
    for key, value in options.items():
        name = before + str(key)
        if isinstance(value, Mapping):
            words += _as_words(value, name + "_")
            continue
        text = ",".join(_scalar(name, v) for v in value) if _is_list(value) else _scalar(name,
                                                                                         value)
        words.append("-" + name)
        if value is not None:
            words.append(text)
    return words


def _as_yaml(scene: Mapping[str, Any], depth: int = 0, where: str = "") -> str:
    """Nested dicts as the text of a scene."""
    lines = []
    for key, value in scene.items():
        label = where + str(key)
        start = "  " * depth + json.dumps(str(key), ensure_ascii=False) + ":"
        if isinstance(value, Mapping):
            lines.append(start)
            if value:
                lines.append(_as_yaml(value, depth + 1, label + ": ").rstrip("\n"))
        elif _is_list(value):
            lines.append(f"{start} [{', '.join(_quoted(label, v) for v in value)}]")
        else:
            lines.append(f"{start} {_quoted(label, value)}" if value is not None else start)
    return "\n".join(lines) + "\n"


def _quoted(key: str, value: Any) -> str:
    text = _scalar(key, value)
    return json.dumps(text, ensure_ascii=False) if isinstance(value, (str, os.PathLike)) else text
