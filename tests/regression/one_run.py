"""One run of a scene in a folder of its own, and what is left of it to look at."""
import json
import tempfile
from pathlib import Path

import launch


class OneRun:
    """`code`, `error` (standard error), `summary` or None, and whether there is an output
    folder."""

    def __init__(self, scene, *words, ranks=1, prepare=lambda folder: None):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "s.yaml").write_text(scene)
            prepare(Path(folder))
            done = launch.run("s.yaml", *words, ranks=ranks, cwd=folder)
            self.code, self.error = done.returncode, done.stderr
            summary = Path(folder, "out/s/summary.json")
            self.summary = json.loads(summary.read_text()) if summary.exists() else None
            self.has_folder = Path(folder, "out").exists()
