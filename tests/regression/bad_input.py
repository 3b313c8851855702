"""Bad input ends with one line on standard error, exit code 2 and nothing written.

Each case runs in a temporary folder of its own, as a user would run it. A rank that waits for
another that has given up is a failure that this looks for. The cases: test_bad_*.py.
"""
import re
import tempfile
import unittest
from pathlib import Path

import launch

SHEET = "sheet: {length: 10, thickness: 1, element_size: 3, iterations: 5}\n"
HELD = "boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}\n"
GOOD = "forces: [beam]\n" + SHEET + HELD
BREAKABLE = "forces: [beam, fracture]\n" + SHEET + HELD
FLOATING = "forces: [beam, gravity, buoyancy]\n" + SHEET
FILE = ("forces: [beam]\nlattice_file: bad.h5\n"
        "boundary: {names: [a], a: {set: root, fix: x y z rx ry rz}}\n")


def held(rest):
    return "forces: [beam]\n" + SHEET + "boundary: {names: [a], a: {set: left, " + rest + "}}\n"


def loaded(rest):
    return GOOD + "load: {names: [p], p: {" + rest + "}}\n"


PULLED = loaded("set: right, force: [1e5, 0, 0]")  # what a solver has work with

TOUCHING = "integrator: explicit\nforces: [beam, contact]\n" + SHEET
MOVING = "integrator: explicit\n" + GOOD + "time: {end: 1}\n"
FLOOR = "obstacle: {names: [o], o: {shape: halfspace, normal: [0, 0, 1]}}\n"


def obstacle(rest):
    return TOUCHING + "obstacle: {names: [o], o: {" + rest + "}}\n"


class BadInput(unittest.TestCase):
    """A class of cases, each of them a test: see `case`."""
    maxDiff = None

    @classmethod
    def case(cls, name, words, part, prepare, ranks=None):
        """Adds a test: floe with `words`, in a folder that `prepare(folder)` fills, says `part`. It
        runs on 1 and 2 ranks; in the short form, most run on 1 rank only: a launcher takes longer
        than floe."""
        if ranks is None:
            ranks = (1, 2) if launch.in_short_form(name, 5) else (1,)

        def test(self):
            for n in ranks:
                with self.subTest(ranks=n), tempfile.TemporaryDirectory() as folder:
                    prepare(Path(folder))
                    self.refused(words, part, n, Path(folder))

        method = "test_" + re.sub(r"\W+", "_", name)
        assert not hasattr(cls, method), f"two cases named {name}"
        setattr(cls, method, test)

    def refused(self, words, part, ranks, folder):
        """Runs floe with `words` in `folder`; checks how it ends and that nothing has been
        written."""
        before = sorted(folder.rglob("*"))
        run = launch.run(*words, ranks=ranks, cwd=folder)
        lines = run.stderr.splitlines()
        self.assertEqual(len(lines), 1, f"one line expected: {run.stderr!r} {run.stdout!r}")
        self.assertIn(part, lines[0])
        self.assertEqual(run.returncode, 2, lines[0])
        self.assertEqual(sorted(folder.rglob("*")), before, "something has been written")


def scene_file(text):
    """Fills a folder with this scene."""
    return lambda folder: (folder / "scene.yaml").write_text(text)
