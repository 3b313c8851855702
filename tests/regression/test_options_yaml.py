#!/usr/bin/python3
"""options.yaml in the output folder repeats the run: same options, same results."""
import tempfile
import unittest
from pathlib import Path

import launch

SCENE = """
forces: [beam, gravity, buoyancy]
sheet: {length: 12, thickness: 1, element_size: 3, iterations: 5}
region: {names: [middle], middle: {box: [-3, 3, -3, 3, -9, 9]}}
load:
  names: [p, q]
  p: {point: [0, 0], force: [0, 0, -1e4], ramp: 1}
  q: {set: middle, force: 0 0 -10}
time: {end: 1, dt: 0.5}
snes_rtol: 1e-9
"""


class OptionsYaml(unittest.TestCase):
    def test_repeats_the_run(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "story.yaml").write_text(SCENE)

            def run(*words):
                launch.run(*words, cwd=root, check=True)
                out = root / "out/story"
                return {name: (out / name).read_text() for name in ("options.yaml", "history.csv")}

            first = run("story.yaml", "-sheet_seed", "9", "-snes_max_it", "40",
                        "-snes_converged_reason")
            for line in ("  seed: 9", "  names: [p, q]", "snes_rtol: 1e-9", "snes_max_it: 40",
                         "snes_converged_reason:", "  dir: out/story"):
                self.assertIn(line, first["options.yaml"].splitlines())
            self.assertEqual(run("out/story/options.yaml"), first)


if __name__ == "__main__":
    unittest.main()
