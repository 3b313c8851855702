"""The page docs/validation.md and its pictures, of the rows' finished runs (tools/validate)."""
import datetime
import hashlib
import json
import os
import re
import textwrap
from dataclasses import asdict, dataclass
from pathlib import Path

import matplotlib

from floe import program
from floe.ensembles.runs import clock, write_whole
from floe.errors import InputError, reading
from floe_validation import SEEDS, verdict_of
from floe_validation_lines import Found, Line


matplotlib.use("Agg")
import matplotlib.pyplot as plt

HEAD = """# Validation

Written by `tools/validate` from the runs of its rows (specs: tools/validation); do not edit.
floe {version}, {date}.

{rows} rows: {agree} agree with what is published, {disagree} disagree in at least one number, {few}
have fewer seeds than chaos asks for ({seeds}), {missing} are not run or not run in full. Nothing is
tuned to a row: a scene has the numbers of its source where that has them, else those of the scene
in input that it comes from. Numbers are means over seeds with their 95 % band (Student's t). What
is allowed for is the spread of the source where it has one, else our choice, said beside it.
"""


def number(value, unit=""):
    """A number to 4 digits, small ones to 2, of forces in kN or MN."""
    if value is None:
        return ""
    for size, name in ((1e6, "M"), (1e3, "k")):
        if unit in ("N", "N/m") and abs(value) >= size:
            return f"{value / size:.4g} {name}{unit}"
    return f"{value:.4g}{' ' * bool(unit)}{unit}" if abs(value) >= 1e-3 or value == 0 else (
        f"{value:.1e}")


def of_floe(line):
    """floe's number with its band."""
    band = line.band
    text = number(line.mean, line.unit)
    if not band:
        return text
    for size, name in ((1e6, "M"), (1e3, "k")):
        if line.unit in ("N", "N/m") and abs(line.mean) >= size:
            return f"{line.mean / size:.4g} ± {band / size:.2g} {name}{line.unit}"
    return f"{line.mean:.4g} ± {band:.2g}{' ' * bool(line.unit)}{line.unit}"


def published(line):
    """The published number with what is allowed for."""
    if line.allowed is None:
        return ""
    low, high = line.allowed
    if line.published is None:
        return f"{low:.3g} to {high:.3g}"
    text = number(line.published, line.unit)
    return text if low == high else f"{text} ({low:.3g} to {high:.3g})"


def cells(line):
    deviation = "" if line.deviation is None or line.allowed is None else (
        f"{100 * line.deviation:+.1f} %")
    verdict = line.verdict
    return [line.what, str(line.draws), of_floe(line), published(line), deviation,
            f"**{verdict}**" if verdict == "disagrees" else verdict]


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def wrapped(text):
    return "\n".join(textwrap.wrap(text, 100, break_long_words=False, break_on_hyphens=False))


def picture(found, path):
    """Draws what a row found."""
    figure, axis = plt.subplots(figsize=(6, 3.6))
    markers = "os^Dv<>p"
    colours = plt.rcParams["axes.prop_cycle"].by_key()["color"]
    for k, (label, x, y, band, kind) in enumerate(found.series):
        if kind == "line":
            axis.plot(x, y, ["-", "--", ":"][k % 3] if label else "-", linewidth=1.2,
                      color=colours[k % 10], label=label or None)
        else:
            axis.errorbar(x, y, band, fmt=markers[k % 8], markersize=4, capsize=2, linewidth=1,
                          color=colours[k % 10], label=label or None)
    for which, column, ax in (("x", 1, axis.xaxis), ("y", 2, axis.yaxis)):
        values = [value for one in found.series for value in one[column]]
        if which in found.log and values:
            axis.set(**{f"{which}scale": "log"})
            for mantissas in ((1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7), (1, 1.2, 1.4, 1.7, 2, 2.5)):
                ticks = [m * 10.0**e for e in range(-6, 9) for m in mantissas]
                ticks = [t for t in ticks if 0.7 * min(values) <= t <= 1.4 * max(values)]
                if len(ticks) > 2:
                    break
            ax.set_ticks(ticks, [f"{t:g}" for t in ticks])
            ax.set_minor_locator(matplotlib.ticker.NullLocator())
    axis.set(xlabel=found.x, ylabel=found.y)
    axis.legend(fontsize=7)
    figure.tight_layout()
    part = path.with_name(f".{path.stem}.part.png")
    figure.savefig(part, dpi=120)
    part.replace(path)
    plt.close(figure)


def scenes_of(row):
    """The files of its scenes."""
    runs = row.runs
    scenes = [runs["scene"]] if "scene" in runs else []
    scenes += [entry["scene"] for entry in runs.get("list", []) if "scene" in entry]
    return [Path(os.path.normpath(row.path.parent / scene)) for scene in dict.fromkeys(scenes)]


def parameters(row):
    """The scenes that a row runs, as text."""
    names = [path.relative_to(program.HOME) for path in scenes_of(row)]
    return ", ".join(f"[{name}](../{name})" for name in names)


def section(row, result):
    """A row's part of the page."""
    found, done, number_of_runs = result.found, result.done, result.runs
    spec = row.path.relative_to(program.HOME)
    lines = [f"## {row.title}", "", wrapped(row.text), "",
             wrapped(f"Scenes: {parameters(row)}; all parameters: [{spec}](../{spec})."), "",
             wrapped(f"Published: {row.published}. Source: {row.source}"), ""]
    if found is None:
        lines += [wrapped(f"**Not run** ({done} of {number_of_runs} runs are done): "
                          f"`tools/validate --only {row.name}`, about {clock(row.seconds)} of one "
                          "core."), ""]
        return lines
    if done < number_of_runs:
        lines += [wrapped(f"**Not run in full**: {done} of {number_of_runs} runs are done; "
                          f"`tools/validate --only {row.name}`, about {clock(row.seconds)} of one "
                          "core for all."), ""]
    else:
        lines += [wrapped(f"Command: `tools/validate --only {row.name}`; {number_of_runs} runs, "
                          f"about {clock(row.seconds)} of one core; these are of {result.day}."),
                  ""]
    lines += [table(["", "seeds", "floe", "published (allowed)", "deviation", ""],
                    [cells(line) for line in found.lines]), ""]
    lines += [f"![{row.title}](pictures/validation_{row.name}.png)", ""]
    return lines


@dataclass
class Result:
    """What there is of a row: number of runs that are done, of all runs, Found or None, versions of
    floe, and the day."""
    done: int
    runs: int
    found: Found | None
    versions: list
    day: str


def digest(row):
    """Of what the row runs and measures, its scenes included: another one is another row."""
    text = json.dumps([row.runs, row.settings, row.measure.__name__, row.lattice_seeds],
                      sort_keys=True)
    for scene in [*scenes_of(row), *row.made_by()]:
        text += Path(scene).read_text()
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def kept(row, path):
    """The Result of a row that was run in full before, as keep() wrote it; None without one."""
    if not path.exists():
        return None
    with reading(path):
        text = json.loads(path.read_text())
        if text.pop("digest") != digest(row):
            return None
        text["found"] = Found(**{**text["found"],
                                 "lines": [Line(**line) for line in text["found"]["lines"]]})
        return Result(**text)


def as_text(dataclass_):
    """A dataclass as JSON; arrays as lists."""
    return json.dumps(asdict(dataclass_), indent=1, default=lambda array: array.tolist())


def keep(row, result, path):
    """Writes the Result of a row whose runs are all done: the page has it without the runs too."""
    path.parent.mkdir(exist_ok=True)
    text = {"digest": digest(row), **json.loads(as_text(result))}
    write_whole(path, json.dumps(text, indent=1) + "\n")


def result_of(row, directory, path):
    """The Result of the runs in a folder of results; where they are not all there, that of all runs
    which was kept, if there is one."""
    done, number_of_runs = row.finished(directory)
    found = None
    if done:
        try:
            found = row.found(done)
        except InputError as error:
            print(f"{row.name}: {error}")
    versions = sorted({run.summary.get("version", "of an unknown version") for run in done})
    result = Result(len(done), number_of_runs, found, versions,
                    datetime.date.today().isoformat())
    before = kept(row, path)
    if found is None or len(done) < number_of_runs:
        return before or result
    if before is None or as_text(before.found) != as_text(found):
        keep(row, result, path)
    return kept(row, path)


def page_of(rows, results, directory, page):
    """The page as text. results: {name: Result}."""
    version = ", ".join(sorted({v for result in results.values() for v in result.versions}))
    verdicts = {}
    for row in rows:
        found = results[row.name].found
        verdicts[row.name] = "not run" if found is None else verdict_of(row, found)
    few = sum("seeds" in verdict for verdict in verdicts.values())
    missing = sum(result.done < result.runs for result in results.values())
    text = [HEAD.format(version=version or "not run", date=datetime.date.today().isoformat(),
                        rows=len(rows),
                        agree=sum(v.startswith("agrees") for v in verdicts.values()),
                        disagree=sum(v.startswith("disagrees") for v in verdicts.values()),
                        few=few, missing=missing, seeds=SEEDS),
            "## Where floe disagrees", ""]
    for row in rows:
        found = results[row.name].found
        wrong = [line for line in found.lines if line.verdict == "disagrees"] if found else []
        if wrong:
            text += [wrapped(f"**[{row.title}](#{anchor(row.title)})**. {row.disagreement}"), "",
                     table(["", "seeds", "floe", "published (allowed)", "deviation"],
                           [cells(line)[:-1] for line in wrong]), ""]
    if not any(verdict.startswith("disagrees") for verdict in verdicts.values()):
        text += ["Nowhere, in the rows that are run.", ""]
    text += ["## All rows", "",
             table(["row", "published", "runs", "verdict"],
                   [[f"[{row.title}](#{anchor(row.title)})", row.published,
                     f"{results[row.name].done} of {results[row.name].runs}", verdicts[row.name]]
                    for row in rows]), ""]
    for row in rows:
        text += section(row, results[row.name])
    return "\n".join(text).rstrip() + "\n"


def anchor(title):
    """GitHub's anchor of a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def write(rows, directory, page):
    """Writes the page and its pictures of what is finished in a folder of results; the page's
    path."""
    results = {}
    pictures = Path(page).parent / "pictures"
    for row in rows:
        result = result_of(row, directory, Path(page).parent / f"validation/{row.name}.json")
        if result.found is not None:
            picture(result.found, pictures / f"validation_{row.name}.png")
        results[row.name] = result
    write_whole(Path(page), page_of(rows, results, directory, page))
    return page
