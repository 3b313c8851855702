"""A run in which three strips of ice join and pieces leave, for tests of the tools: made once for a
class, beside the account that its history.csv keeps."""
import subprocess
import sys
import unittest

import h5py
import numpy as np

from launch import ENVIRONMENT, FLOE, REPOSITORY, temporary_folder
from test_supply import SCENE

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.results.output import Output, rows_of  # noqa: E402

# A row with every frame.
SAMPLES = ("-output_history", "0.1", "-output_fields", "0.5")


def begin(folder, *words):
    return subprocess.Popen([FLOE, "scene.yaml", *SAMPLES, *words], cwd=folder, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT)


def run(folder, *words, code=0):
    process = begin(folder, *words)
    said = process.communicate()[0]
    assert process.returncode == code, said


def tool(name, *words, code=0):
    """What a tool said."""
    done = subprocess.run([sys.executable, REPOSITORY / "tools" / name, *map(str, words)],
                          capture_output=True, text=True, env=ENVIRONMENT)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout if code == 0 else done.stderr


class Account:
    """What history.csv says at a time of a run."""

    def __init__(self, folder):
        rows = rows_of(folder)
        self.rows = {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}
        with h5py.File(folder / "lattice.h5") as file:
            self.first = float(np.sum(file["bodies/mass"][:]))

    def at(self, when):
        (k,) = np.flatnonzero(np.abs(self.rows["time"] - when) < 1e-9)
        found = {key: values[k] for key, values in self.rows.items()}
        found["mass"] = self.first + found["mass_supplied"] - found["mass_removed"]
        return found


class SupplyTools(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = temporary_folder(cls.addClassCleanup)
        (cls.folder / "scene.yaml").write_text(SCENE)
        run(cls.folder, "-output_dir", "a")
        cls.made = cls.folder / "a"

    def setUp(self):
        self.output, self.account = Output(self.made), Account(self.made)
        self.assertEqual(len(set(self.output.meshes.tolist())), 4)  # three strips join
