"""How far runs of one scene on several ranks differ from one time to the next (tools/bench
repeats).

MUMPS adds what ranks send it in the order in which it arrives, so static and implicit runs on
several ranks are rounded differently each time. Each scene is run many times, and each run is
compared with the first.
"""
import subprocess
import tempfile

import numpy as np

from floe.results.output import Output

SCENES = ("input/tension.yaml", "input/compression.yaml", "input/bending.yaml",
          "input/edge_load.yaml",
          "input/bending_implicit.yaml", "input/tension_implicit.yaml", "input/bench/largest.yaml")
RESULTS = ("E", "E_gauge_over_Eb", "deflection_max")  # of summary.json


class Run:
    """The numbers of one run."""

    def __init__(self, floe, root, scene, ranks):
        with tempfile.TemporaryDirectory() as folder:
            command = ["bash", "-c", '. "$0" && exec mpiexec "$@"', str(root / "tools/env"),
                       "-n", str(ranks), floe, str(root / scene), "-output_dir", folder]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=root)
            output = Output(folder)
            self.results = {name: output.summary[name] for name in RESULTS
                            if name in output.summary}
            self.energies = output.summary["energy"]
            last = output.times[-1]
            self.moved = output.field("bodies_displacement", last)
            self.bodies, self.integrator = output.summary["bodies"], output.summary["integrator"]

    def differs(self, first):
        """Largest differences: of the results, each relative to its size; of the energies and of
        the displacements, relative to the largest of them."""
        results = [abs(self.results[name] / value - 1) for name, value in first.results.items()]
        energies = np.array(list(self.energies.values())) - list(first.energies.values())
        return (max(results, default=0),
                np.abs(energies).max() / np.abs(list(first.energies.values())).max(),
                np.abs(self.moved - first.moved).max() / np.abs(first.moved).max())


def benchmark(floe, root, scenes, repeats, ranks):
    """Prints Markdown rows: the largest differences over `repeats` runs of each scene."""
    print("| scene | integrator | bodies | results | energies | displacements |\n"
          "|---|---|---|---|---|---|")
    for scene in scenes or SCENES:
        first = Run(floe, root, scene, ranks)
        largest = [0.0] * 3
        for _ in range(repeats - 1):
            run = Run(floe, root, scene, ranks)
            largest = [max(pair) for pair in zip(largest, run.differs(first))]
        cells = " | ".join(f"{value:.1e}" if value else "0" for value in largest)
        print(f"| `{scene}` | {first.integrator} | {first.bodies} | {cells} |", flush=True)
