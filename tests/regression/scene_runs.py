"""Scenes that a test runs in a folder of its own, and what became of them."""
import csv
import json
import sys

import h5py
import numpy as np

import launch
from launch import REPOSITORY, FolderTest

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.results.output import frames_of  # noqa: E402


def rows_of(folder):
    """The columns of history.csv by their names."""
    with open(folder / "history.csv", newline="") as file:
        names = next(csv.reader(file))
        return dict(zip(names, np.loadtxt(file, delimiter=",", ndmin=2).T.copy()))


def last_frame(folder):
    """The arrays of the last frame of a run."""
    _, path, group = frames_of(folder)[-1]
    with h5py.File(path) as file:
        return {key: item[:] for key, item in file[group].items() if isinstance(item, h5py.Dataset)}


class SceneTest(FolderTest):
    def run_scene(self, text, *words, ranks=1, name="scene", code=0):
        """Runs a scene, which must end with `code`; results are in out/NAME."""
        (self.folder / f"{name}.yaml").write_text(text)
        done = launch.run(f"{name}.yaml", *words, ranks=ranks, cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def summary(self, name="scene"):
        return json.loads((self.folder / f"out/{name}/summary.json").read_text())

    def rows(self, name="scene"):
        """history.csv."""
        return np.genfromtxt(self.folder / f"out/{name}/history.csv", delimiter=",", names=True)

    def same_on_ranks_and_after_a_restart(self, text):
        """The last frame on two ranks, and of a run in two parts, is that of out/one, bit for bit;
        out/one is run here."""
        self.run_scene(text, name="one")
        self.run_scene(text, name="two", ranks=2)
        steps = self.summary("one")["steps"]
        self.run_scene(text, "-ts_max_steps", str(steps // 2), name="part")
        done = launch.run("-checkpoint_restart", "out/part/checkpoint.h5", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        one = last_frame(self.folder / "out/one")
        for name in ("two", "part"):
            other = last_frame(self.folder / "out" / name)
            self.assertEqual(set(other), set(one))
            for key, values in other.items():
                np.testing.assert_array_equal(values, one[key], f"{name}: {key}")
        return one
