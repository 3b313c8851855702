"""Run times of the scenes that come with floe (tools/bench scenes).

Each scene is run by its own command, on one rank, in a folder of its own. The time is the
processor's (user and system): on an idle core the clock shows the same, on a busy machine it says
more than the clock. A run in time that takes longer than wanted is stopped, and its whole time
follows from the part of it that was made.
"""
import json
import os
import re
import shlex
import signal
import subprocess
import tempfile
import time
from pathlib import Path

HEAD = "| scene | what it shows | integrator | bodies | time |\n|---|---|---|---|---|"


def scenes_of(floe):
    """Names of the scenes and what they show, as `floe help scenes` lists them."""
    text = subprocess.run([floe, "help", "scenes"], check=True, capture_output=True,
                          text=True).stdout
    return re.findall(r"^  (\w+) +(\S.*)$", text, re.MULTILINE)


def seconds_so_far(pid):
    """User and system time of a process that has not been waited for [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def steps_in_time(out):
    """Whether a run is dynamic and its history has a row after that of time 0."""
    options, history = out / "options.yaml", out / "history.csv"
    return (history.exists() and history.read_text().count("\n") > 2
            and "integrator: quasistatic" not in options.read_text())


def timed(command, folder, environment, most, out):
    """Processor time of a command [s], which is asked to stop after `most` of it if it steps in
    time."""
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    asked = False
    while True:
        pid, _, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            return usage.ru_utime + usage.ru_stime
        if not asked and seconds_so_far(process.pid) > most and steps_in_time(out):
            process.send_signal(signal.SIGTERM)
            asked = True
        time.sleep(0.02)


def text_of(seconds):
    """As people say it."""
    if seconds >= 120:
        return f"{seconds / 60:.0f} min"
    return f"{seconds:.1f} s" if seconds < 10 else f"{seconds:.0f} s"


def row(floe, root, scene, subject, environment, most):
    """The Markdown row of a scene."""
    path = root / f"input/{scene}.yaml"
    command = path.read_text().splitlines()[0].removeprefix("# ")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "input").symlink_to(root / "input")
        *before, last = (shlex.split(part) for part in command.split("&&"))
        for words in before:
            subprocess.run([root / "tools" / words[1], *words[2:]], cwd=folder, env=environment,
                           check=True,
                           stdout=subprocess.DEVNULL)
        out = folder / "out" / scene
        seconds = timed([floe, *last[1:]], folder, environment, most, out)
        summary = json.loads((out / "summary.json").read_text())
        about = ""
        if summary["status"] == "stopped":
            options = (out / "options.yaml").read_text()
            end = float(re.search(r"^time:.*?^  end: (\S+)", options, re.MULTILINE | re.DOTALL)[1])
            seconds, about = seconds * end / summary["time"], "about "
        cells = (f"`{scene}`", subject, summary["integrator"], str(summary["bodies"]),
                 about + text_of(seconds))
        return f"| {' | '.join(cells)} |"


def table(floe, root, environment, wanted, most):
    """Rows of all scenes, or of those that are wanted; each is printed when it is there."""
    rows = HEAD.splitlines()
    for scene, subject in scenes_of(floe):
        if wanted and scene not in wanted:
            continue
        rows.append(row(floe, root, scene, subject, environment, most))
        print(rows[-1], flush=True)
    return rows
