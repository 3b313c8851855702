"""Runs a case and says which rules of bad input and of results it breaks."""
import csv
import json
import math
import os
import re
import signal
import subprocess
from pathlib import Path

import h5py
import numpy as np

import launch

HANGS = 600  # [s], for hangs alone
LONGEST_LINE = 400
DONE, FAILED, BAD_INPUT, STOPPED = range(4)
TRACES = re.compile(r"PETSC ERROR|internal error|Traceback|MPI_ABORT|terminate "
                    r"called|what\(\):|Assertion|AddressSanitizer|"
                    r"runtime error:|SUMMARY: \w*Sanitizer|Segmentation|Caught "
                    r"signal|HDF5-DIAG|double free|corrupted|std::|"
                    r"bad_alloc|basic_string|[Bb]acktrace|core dumped|prterun noticed|exited on "
                    r"signal")
# Words that say nothing about the input.
EMPTY = set("a an and are as at be but by can could does for from has have here if in is it its "
            "least most "
            "must never no none not of on one only or out than that the there this to too was what "
            "where "
            "which with without would floe file line value number numbers text expected allowed "
            "known run".split())
HELP = re.compile(r"^-{0,2}(h|help|help_markdown|help_man|version|V|v)$")


def words_of(text):
    return set(re.findall(r"[^\W\d]\w+|\d[\w.+-]*", text.lower()))


def without_paths(line):
    """A message without the paths in it, which the user may have given as long as he likes: behind
    a key of files they may have blanks."""
    line = re.sub(r"\b(\w*file|dir|restart): '[^']{100,}'", r"\1: ...", line)
    return re.sub(r"[^\s']{100,}", "...", line)


class Outcome:
    """What a case did; `broken` lists the rules that it broke."""

    def __init__(self, case, folder):
        self.case, self.folder, self.broken = case, folder, []
        before = self.contents()
        # matplotlib keeps its list of fonts in the home
        environment = {**launch.ENVIRONMENT, "HOME": str(folder),
                       "MPLCONFIGDIR": str(case.base.folder),
                       "XDG_CACHE_HOME": str(case.base.folder), **case.environment}
        command = launch.on_ranks(case.ranks, [launch.FLOE, *case.words])
        process = subprocess.Popen(command, cwd=folder, env=environment, start_new_session=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE,
                                   preexec_fn=launch.limited_memory(4))
        try:
            out, error = process.communicate(timeout=HANGS)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            out, error = process.communicate()
            self.broken.append(f"hangs: no end after {HANGS} s")
        self.code = process.returncode
        self.out, self.error = out.decode(errors="replace"), launch.own_words(
            error.decode(errors="replace"))
        case.said = self.out + self.error
        if not self.broken:
            self.check(before)

    def contents(self):
        """Everything in the folder: names, and what is in files."""
        return {str(p.relative_to(self.folder)): p.read_bytes() if p.is_file()
                and not p.is_symlink() else None
                for p in self.folder.rglob("*")}

    def breaks(self, rule, *more):
        self.broken.append(": ".join([rule, *map(str, more)]))

    def check(self, before):
        """All rules."""
        for text in (self.out, self.error):
            if found := TRACES.search(text):
                self.breaks("a trace", text[max(0, found.start() - 100):found.end() + 300])
        if self.code < 0 or self.code > 128:
            self.breaks("ends by a signal", self.code)
        elif self.code not in (DONE, FAILED, BAD_INPUT, STOPPED):
            self.breaks("exit code", self.code)
        if self.case.must is not None and self.code != self.case.must and (
                self.case.must == BAD_INPUT or self.code == BAD_INPUT):
            self.breaks(f"must end with exit code {self.case.must}", self.code, self.error[:400])
        if self.code == BAD_INPUT:
            self.check_refused(before)
        elif self.code in (DONE, FAILED, STOPPED):
            self.check_run()

    def check_refused(self, before):
        lines = self.error.removesuffix("\n").split("\n")
        if len(lines) != 1 or not re.match(r"floe( \w+)?:",
                                           self.error) or not self.error.endswith("\n"):
            self.breaks("not one line of floe's", repr(self.error[:1000]))
        elif len(without_paths(lines[0])) >= LONGEST_LINE:
            self.breaks(f"a line of {len(lines[0])} letters", lines[0][:LONGEST_LINE])
        elif not self.names_input(lines[0]):
            self.breaks("the line names nothing of the input", lines[0])
        if any(ord(letter) < 32 or ord(letter) == 127 for line in lines for letter in line):
            self.breaks("letters that cannot be printed", repr(self.error[:300]))
        after = self.contents()
        if before != after:
            changed = sorted(name for name in {*before, *after}
                             if before.get(name, 0) != after.get(name, 0))
            self.breaks("refused, but touched", changed[:6])

    def names_input(self, line):
        """Whether it holds a word of the input, or a whole word of the command line."""
        return bool((words_of(line) - EMPTY) & words_of(self.case.all_text()) or
                    any(word.lstrip("-") and word.lstrip("-")[:40] in line or word in line.split()
                        or f"{word}:" in line.split()
                        for word in self.case.words))

    def check_run(self):
        earlier = self.case.earlier(self.folder)
        folders = [path.parent for path in self.folder.rglob("summary.json")
                   if path.parent not in earlier]
        if self.code == FAILED:
            if not any(line.startswith("floe:") for line in self.error.splitlines()):
                self.breaks("fails without a word")
            if not self.case.may_fail_early and not folders:
                self.breaks("fails without a summary", self.error[:500])
        for folder in folders:
            summary = self.read_summary(folder / "summary.json")
            expected = {DONE: "done", FAILED: "failed", STOPPED: "stopped"}[self.code]
            if summary is not None and summary.get("status") != expected:
                self.breaks(f"exit code {self.code}, but the summary's status is",
                            summary.get("status"))
            if summary is not None and self.code == FAILED and not summary.get("message"):
                self.breaks("the summary does not say why it failed")
            self.check_results(folder)
        if self.code == DONE and (problem := self.case.check_results(self.folder)):
            self.breaks(*problem)

    def read_summary(self, path):
        def no_number(text):
            raise ValueError(f"the number {text}")
        try:
            return json.loads(path.read_text(), parse_constant=no_number)
        except ValueError as error:
            self.breaks("summary.json", error)
            return None

    def check_results(self, folder):
        """All files can be read; of runs that did not fail, all numbers are finite."""
        finite = self.code != FAILED
        history = folder / "history.csv"
        if history.exists():
            try:
                rows = list(csv.reader(history.read_text().splitlines()))
                numbers = [float(text) for row in rows[1:] for text in row]
                if finite and not all(map(math.isfinite, numbers)):
                    self.breaks("history.csv is not finite")
                if len({len(row) for row in rows}) > 1:
                    self.breaks("history.csv has torn rows")
            except ValueError as error:
                self.breaks("history.csv", error)
        if (folder / "pressure.csv").exists():
            self.check_pressure(folder / "pressure.csv", finite)
        for path in [*folder.glob("*.h5"), *folder.glob("fields/*.h5")]:
            if path.is_symlink() and not path.exists():
                self.breaks("leads nowhere", path.name)
                continue
            try:
                with h5py.File(path) as file:
                    bad = []
                    file.visititems(lambda name, item, bad=bad: bad.append(name)
                                    if isinstance(item, h5py.Dataset)
                                    and item.dtype.kind == "f" and not np.all(np.isfinite(item[()]))
                                    else None)
            except (OSError, RuntimeError) as error:
                self.breaks("cannot be read", path.name, error)
                continue
            if bad and finite:
                self.breaks("not finite", path.name, bad[:4])

    def check_pressure(self, path, finite):
        """Rows of time, obstacle, patch and three forces."""
        rows = list(csv.reader(path.read_text().splitlines()))
        if {len(row) for row in rows} != {6} or rows[0][:3] != ["time", "obstacle", "patch"]:
            self.breaks("pressure.csv", "has torn rows or another heading", rows[0])
            return
        try:
            numbers = [float(text) for row in rows[1:] for text in (row[0], *row[3:])]
        except ValueError as error:
            self.breaks("pressure.csv", error)
            return
        if finite and not all(map(math.isfinite, numbers)):
            self.breaks("pressure.csv is not finite")

    def report(self):
        """What to look at, with the command that runs the case again."""
        asked = " ".join(repr(word) if not re.fullmatch(r"[\w./=:,+-]+", word) else word
                         for word in self.case.words)
        lines = [f"case: tests/stress/fuzz.py --kind {self.case.kind} --seed {self.case.seed}",
                 f"  floe {asked[:1500]}"]
        if self.case.ranks > 1:
            lines.append(f"  on {self.case.ranks} ranks")
        lines += [f"  {name}={value!r}" for name, value in self.case.environment.items()]
        lines += [f"  exit code {self.code}", *(f"  BROKEN: {rule}" for rule in self.broken)]
        return "\n".join(lines)


def run_case(case, folder):
    """Lays the files of a case in an empty folder and runs it."""
    folder = Path(folder)
    case.lay(folder)
    return Outcome(case, folder)


def is_help(words):
    return any(HELP.match(word) for word in words)
