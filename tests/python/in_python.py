"""Scripts that import the package floe of the build folder, on any number of ranks."""
import subprocess
import sys
import textwrap
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "regression"))
import launch  # noqa: E402

PACKAGE = launch.FLOE.parent / "python"


def sanitizer():
    """Libraries that a build with sanitizers needs before all others."""
    linked = subprocess.run(["ldd", launch.FLOE], capture_output=True, text=True).stdout
    return " ".join(line.split(" => ")[1].split(" (")[0] for line in linked.splitlines()
                    if "libasan" in line or "libubsan" in line)


ENVIRONMENT = {**launch.ENVIRONMENT, "PYTHONDONTWRITEBYTECODE": "1",
               "PYTHONPATH": f"{PACKAGE}:{Path(__file__).resolve().parent}"}
if sanitizer():
    ENVIRONMENT["LD_PRELOAD"] = sanitizer()


BEGIN = ("import sys\nimport numpy as np\nimport floe\n"
         "from coupled_scenes import BLOCKS, last, memory\n")


class PythonTest(launch.FolderTest):
    """Each test has a folder of its own, in which its scripts run."""

    def setUp(self):
        if not list(PACKAGE.glob("floe/_floe*.so")):
            raise unittest.SkipTest("the Python module is not built")
        super().setUp()

    def python(self, script, *words, ranks=1, code=0):
        """Standard output of a script, which begins with the imports of BEGIN; with another exit
        code its standard error as well."""
        path = self.folder / "script.py"
        path.write_text(BEGIN + textwrap.dedent(script))
        command = ["/usr/bin/python3", path, *words]
        done = subprocess.run(launch.on_ranks(ranks, command), cwd=self.folder, text=True,
                              env=ENVIRONMENT, capture_output=True)
        error = launch.own_words(done.stderr)
        self.assertEqual(done.returncode, code, f"{done.stdout}{error}")
        return done.stdout if code == 0 else done.stdout + error

    def floe(self, *words, ranks=1):
        """The command."""
        done = launch.run(*words, ranks=ranks, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def scene(self, text, name="s.yaml"):
        (self.folder / name).write_text(text)
        return name
