#!/usr/bin/python3
"""The package's types, as mypy reads them."""
import shutil
import subprocess
import unittest
from pathlib import Path

from in_python import PACKAGE, PythonTest

CONFIGURATION = Path(__file__).resolve().parents[2] / "python/mypy.ini"


class Types(PythonTest):
    def test_mypy(self):
        if not shutil.which("mypy"):
            self.skipTest("mypy is not installed")
        (self.folder / "user.py").write_text("""import floe
scene = floe.Scene({"forces": ["beam"]}, sheet_seed=3)
with floe.Simulation(scene, coupled=["cone"]) as sim:
    going_on: bool = sim.step_to(1.0)
    force = sim["cone"].wrench.force[0]
    sim["cone"].prescribe(floe.Pose(*sim["cone"].pose), velocity=[0.0, 0.0, 1.0], until=2.0)
    state: floe.State = sim.save()
    sim.restore(state)
    keys: list[str] = [option.key for option in floe.options()]
""")
        for words in (["-p", "floe"], ["user.py"]):
            done = subprocess.run(
                ["mypy", "--config-file", CONFIGURATION, "--cache-dir", self.folder / "cache",
                 *words],
                cwd=self.folder, env={"PATH": "/usr/bin:/bin", "MYPYPATH": str(PACKAGE)},
                capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
