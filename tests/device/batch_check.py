#!/usr/bin/python3
"""Times of many runs of one batch against one run alone (tools/check_gpu): whole runs of sheets of
other meshes, by floe ensemble. Exit code 0: each is what it is alone, bit for bit, 1: it is not.

    batch_check.py [BACKEND [RUNS [LENGTH]]]    # cuda 50 37: sheets of LENGTH x LENGTH bodies or so
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
SCENE = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {{length: {length}, width: {length}, thickness: 0.5, element_size: 1, iterations: 20}}
beam: {{damping_ratio: 0.1}}
initial: {{names: [i], i: {{set: right, velocity: [0, 0, 0.1]}}}}
time: {{end: 1}}
output: {{history: 0.1, fields: 1}}
"""


def ensemble(folder, backend, seeds):
    """Runs an ensemble; [(seconds in steps, steps)] of its runs."""
    (folder / "scene.yaml").parent.mkdir(exist_ok=True)
    spec = folder / f"{len(seeds)}.yaml"
    spec.write_text(f"scene: scene.yaml\noptions: {{backend: {backend}}}\nseeds: {seeds}\n")
    done = subprocess.run([REPOSITORY / "tools/ensemble", spec.name, "--jobs", str(len(seeds))],
                          cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    runs = sorted((folder / f"out/ensemble_{len(seeds)}/runs").iterdir())
    found = [json.loads((run / "summary.json").read_text()) for run in runs]
    return [(one["solve_s"], one["steps"]) for one in found]


def main():
    words = sys.argv[1:]
    backend, runs, length = (words + ["cuda", "50", "37"][len(words):])[:3]
    os.environ.setdefault("FLOE", str(REPOSITORY / "build/cuda/floe"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.yaml").write_text(SCENE.format(length=length))
        (seconds, steps), = ensemble(folder, backend, [1])
        alone = 1e6 * seconds / steps
        print(f"one run by {backend}: {steps} steps, {alone:.1f} us each")
        found = ensemble(folder, backend, list(range(1, int(runs) + 1)))
        together = 1e6 * max(seconds for seconds, _ in found) / max(steps for _, steps in found)
        print(f"{runs} runs in a batch: {together:.1f} us for a step of all, "
              f"{together / alone:.2f} times that of one, "
              f"{int(runs) * alone / together:.1f} times as many steps a second")
        histories = [(folder / f"out/ensemble_{count}/runs/s001/history.csv").read_bytes()
                     for count in (1, int(runs))]
        same = histories[0] == histories[1]
        print("the first of them is what it is alone:", "ok" if same else "NOT OK")
        return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
