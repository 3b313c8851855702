#!/usr/bin/python3
"""Times of whole runs with contact on a device, beside one core of the same machine
(tools/check_gpu): a sheet against a slope, 50 seeds of it in one batch, rubble of 10,240 blocks;
and CUDA's own checks of memory and of races. Exit code 0: all is as it should be, 1: not.

    story_check.py [BACKEND [SHARE]]    # cuda 1: SHARE of the times and of the numbers of bodies
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
INPUT = REPOSITORY / "input"
SLOPE = INPUT / "ice_slope.yaml"
# What runs may take: a slope alone [s for 120 s of ice], 50 of them in a batch [s], times as fast
# as one core for rubble.
SLOPE_LIMIT, BATCH_LIMIT, RUBBLE_LEAST = 60, 900, 15
ICE = 120  # [s]


class Check:
    def __init__(self, folder, backend, share):
        self.folder, self.backend, self.share = folder, backend, share
        self.good = True

    def floe(self, scene, name, *words):
        """Summary of a run."""
        done = subprocess.run([os.environ["FLOE"], str(scene), "-output_dir", name,
                               "-output_overwrite", *words],
                              cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{name}: {done.stderr}")
        return json.loads((self.folder / name / "summary.json").read_text())

    def say(self, what, good=True):
        self.good = self.good and good
        print(what + ("" if good else "  NOT OK"), flush=True)

    def slope(self):
        """One run of the slope, and a tenth of it on one core."""
        end = ICE * self.share
        here = self.floe(SLOPE, "slope_cpu", "-time_end", str(end / 10))
        there = self.floe(SLOPE, "slope", "-backend", self.backend, "-time_end", str(end))
        scaled = there["wall_s"] / self.share
        self.say(f"ice_slope, {end:g} s by {self.backend}: {there['wall_s']:.1f} s, "
                 f"{1e6 * there['solve_s'] / there['steps']:.1f} us a step, "
                 f"{there['beams_broken']} beams broken (one core, the first tenth: "
                 f"{1e6 * here['solve_s'] / here['steps']:.1f} us a step)", scaled <= SLOPE_LIMIT)

    def batch(self):
        """A tenth of the time of 50 slopes; piles grow, so later tenths take longer."""
        runs, end = max(2, round(50 * self.share)), ICE * self.share / 10
        (self.folder / "slopes.yaml").write_text(
            f"scene: {SLOPE}\noptions: {{backend: {self.backend}, time_end: {end}, "
            f"output_history: {end / 10}, output_fields: {end}}}\nseeds: {runs}\n")
        began = time.monotonic()
        done = subprocess.run([REPOSITORY / "tools/ensemble", "slopes.yaml", "--jobs", str(runs)],
                              cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(done.stderr)
        seconds = time.monotonic() - began
        said = next(line for line in done.stderr.splitlines() if line.startswith("batch: "))
        self.say(f"{runs} seeds of it in a batch, {end:g} s: {seconds:.1f} s ({said}); ten times "
                 f"that: {10 * seconds / 60:.1f} min",
                 10 * seconds <= BATCH_LIMIT)

    def rubble(self):
        """Blocks that float up and pile under each other, between walls."""
        side = max(3, round(32 * self.share ** 0.5))
        subprocess.run([REPOSITORY / "tools/make_lattice", "rubble", "--columns", str(side),
                        str(side), "10", "rubble.h5"], cwd=self.folder, check=True,
                       stdout=subprocess.DEVNULL)
        text = (INPUT / "rubble_pile.yaml").read_text()
        text = re.sub(r"lattice_file: .*", "lattice_file: rubble.h5", text)
        (self.folder / "rubble.yaml").write_text(
            re.sub(r"\b8(?=, 0)", f"{0.8 * side:g}", text))
        began = {}
        for backend, end in ((name, end) for name in ("cpu", self.backend) for end in (2, 2.1)):
            words = ("-time_end", str(end), "-output_history", "1", "-output_fields", "10")
            summary = self.floe("rubble.yaml", f"rubble_{backend}", "-backend", backend, *words)
            began.setdefault(backend, []).append((summary["solve_s"], summary["steps"]))
        (a, m), (b, n) = began["cpu"]
        here = (b - a) / (n - m)
        (a, m), (b, n) = began[self.backend]
        there = (b - a) / (n - m)
        self.say(f"rubble of {10 * side * side} blocks after 2 s: {1e6 * there:.0f} us a step, one "
                 f"core {1e6 * here:.0f} us: {here / there:.1f} times as fast",
                 here / there >= RUBBLE_LEAST or self.backend != "cuda")

    def sanitizer(self):
        """A short run under compute-sanitizer, which finds accesses beyond memory, and races."""
        tool = shutil.which("compute-sanitizer") or "/usr/local/cuda/bin/compute-sanitizer"
        if self.backend != "cuda" or not Path(tool).exists():
            self.say("compute-sanitizer: not here")
            return
        for name in ("memcheck", "racecheck"):
            done = subprocess.run([tool, "--tool", name, "--error-exitcode", "9",
                                   os.environ["FLOE"], str(SLOPE), "-backend", "cuda", "-time_end",
                                   "0.02", "-output_dir", name, "-output_overwrite"],
                                  cwd=self.folder, capture_output=True, text=True, check=False)
            last = next((line for line in reversed(done.stdout.splitlines())
                         if line.startswith("=========")), done.stderr[-200:])
            self.say(f"compute-sanitizer, {name}: {last}", done.returncode == 0)


def main():
    backend, share = (sys.argv[1:] + ["cuda", "1"][len(sys.argv) - 1:])[:2]
    os.environ.setdefault("FLOE", str(REPOSITORY / "build/cuda/floe"))
    with tempfile.TemporaryDirectory() as name:
        check = Check(Path(name), backend, float(share))
        check.slope()
        check.batch()
        check.rubble()
        check.sanitizer()
    return 0 if check.good else 1


if __name__ == "__main__":
    sys.exit(main())
