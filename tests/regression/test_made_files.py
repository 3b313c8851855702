#!/usr/bin/python3
"""make of a spec of floe ensemble: each distinct command is run once, killed in the middle it goes
on, what is made is what the runs take; commands that fail, bad specs."""
import signal
import sys
import unittest

import h5py

from launch import FLOE, REPOSITORY
from test_ensemble import EnsembleTest

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.ensembles import specs  # noqa: E402
from floe.errors import InputError  # noqa: E402

SCENE = """integrator: explicit
forces: [gravity, buoyancy]
lattice_file: none.h5
time: {end: 0.01, dt: 0.002}
"""
SPEC = """scene: run.yaml
seeds: 2
seed_keys: []
list: [{name: a}, {name: b, time_end: 0.02}]
make:
  lattice_file:
    - make_lattice rubble --columns 2 1 1 --seed {seed}
    - settle.yaml -lattice_file {before}
    - make_lattice settled --of {before}
"""
# Notes its scene; the scene that settles blocks waits until it may end.
SLOW = """#!/bin/bash
[ "$1" = run.yaml ] || echo "$1 ${@: -1}" >>started
[ "$1" = run.yaml ] || [ -e go ] || exec sleep 1000
exec "$REAL" "$@"
"""


class Made(EnsembleTest):
    def setUp(self):
        super().setUp()
        (self.folder / "settle.yaml").write_text(SCENE)
        (self.folder / "run.yaml").write_text(SCENE)
        (self.folder / "e.yaml").write_text(SPEC)
        self.made = self.folder / "out/ensemble_e/made/runs"

    def files(self):
        return {path.name: path.stat().st_mtime_ns for path in self.made.glob("*.h5")}

    def test_once_per_command_and_going_on_after_a_kill(self):
        self.fake(SLOW)
        self.environment["REAL"] = str(FLOE)
        said, _ = self.ensemble("--check")
        self.assertIn("a_s001  seed 1, time unknown", said)
        self.assertFalse((self.folder / "out").exists())
        process = self.begin("--jobs", "1")
        started = self.folder / "started"
        self.wait(process, lambda: started.exists() and started.read_text().endswith("\n"))
        process.send_signal(signal.SIGKILL)
        process.wait()
        loose = self.files()
        self.assertEqual(len(loose), 2)  # one of each seed, for both points
        (self.folder / "go").touch()
        self.ensemble()
        self.assertEqual([row["status"] for row in self.table()], ["done"] * 4)
        self.assertEqual(loose, {name: self.files()[name] for name in loose})
        self.assertEqual(len(self.files()), 4)
        settled = started.read_text().split("\n")[:-1]
        self.assertEqual((len(settled), len(set(settled))), (3, 2))  # the killed one anew

        def taken(run):
            with h5py.File(self.folder / f"out/ensemble_e/runs/{run}/lattice.h5") as file:
                return file["bodies/orientation"][:].tolist()
        self.assertEqual(taken("a_s001"), taken("b_s001"))
        self.assertNotEqual(taken("a_s001"), taken("a_s002"))

        # More seeds later; files that are there stay. Another command under the same name is
        # refused, as is another scene in it.
        before = self.files()
        (self.folder / "e.yaml").write_text(SPEC.replace("seeds: 2", "seeds: 3"))
        self.ensemble()
        self.assertEqual(before, {name: self.files()[name] for name in before})
        self.assertEqual(len(self.files()), 6)
        (self.folder / "e.yaml").write_text(SPEC.replace("2 1 1", "1 1 2"))
        _, said = self.ensemble(code=2)
        self.assertIn("its run a_s001 has lattice_file make_lattice rubble --columns 2 1 1 --seed "
                      "1 && settle.yaml", said)
        (self.folder / "e.yaml").write_text(SPEC)
        (self.folder / "settle.yaml").write_text(SCENE.replace("0.01", "0.02"))
        _, said = self.ensemble(code=2)
        self.assertIn("its run a_s001 has lattice_file", said)

    def test_commands_of_a_point(self):
        """Each point its own file; the table tells them apart."""
        (self.folder / "e.yaml").write_text(
            "scene: run.yaml\nlist:\n"
            "  - {name: two, make: {lattice_file: make_lattice stack --count 2}}\n"
            "  - {name: three, make: {lattice_file: make_lattice stack --count 3}}\n")
        self.ensemble()
        rows = self.table()
        self.assertEqual([row["lattice_file"] for row in rows],
                         ["make_lattice stack --count 2", "make_lattice stack --count 3"])
        self.assertEqual([row["bodies"] for row in rows], ["2", "3"])

    def test_a_command_that_fails(self):
        for command, why in (("make_lattice rubble --columns 0 1 1", "argument --columns: 0 is "
                              "not at least 1"),
                             ("make_lattice settled --of {here}/none", "/sub/none/")):
            (self.folder / "sub").mkdir(exist_ok=True)
            (self.folder / "sub/e.yaml").write_text("scene: ../run.yaml\nmake:\n  lattice_file: "
                                                    f"{command}\n")
            _, said = self.ensemble("--dir", "x", name=self.folder / "sub/e", code=2)
            last = said.splitlines()[-1].replace("'", "")  # {here} in quotes, as for a shell
            self.assertTrue(last.startswith(f"floe ensemble: make: {command}: exit code 2: "), said)
            self.assertIn(why.replace("'", ""), last)
        # what floe says of the scene comes once its file is there, and before any run
        (self.folder / "e.yaml").write_text("scene: run.yaml\noptions: {time_end: -1}\nmake: "
                                            "{lattice_file: make_lattice stack}\n")
        _, said = self.ensemble(code=2)
        self.assertIn("run p001: floe: time: end: -1 must be", said)
        self.assertFalse((self.folder / "out/ensemble_e/runs").exists())


class BadSpecs(EnsembleTest):
    def test_what_is_wrong_is_said(self):
        path = self.folder / "e.yaml"
        for text, part in (
                ("make: {lattice_file: make_latice x}",
                 "make: lattice_file: 'make_latice x' must begin with one of make_lattice, "
                 "make_ridge, make_floes or be a scene"),
                ("make: {lattice_file: 3}", "make: lattice_file: '3' must begin with"),
                ("make: {lattice_file: []}", "make: lattice_file: [] must be a command"),
                ("make: {lattice_file: none.yaml}", "make: lattice_file: 'none.yaml' must be a "
                                                    "file"),
                ("make: {lattice_file: scene.yaml}", "makes a folder, not a file"),
                ("make: {lattice_file: \"make_lattice 'x\"}", "No closing quotation"),
                ("make: {lattice_file: \"make_lattice {x}\"}", "{x} is not known here"),
                ("make: {lattice_file: \"make_lattice {before}\"}", "{before} is not known here"),
                ("make: {lattice_file: \"make_lattice {seed}\"}", "seeds is not given"),
                ("seeds: 1\nseed_keys: []\nmake: {lattice_file: make_lattice stack}",
                 "seed_keys: []"),
                ("make: {lattice_file: make_lattice stack}\noptions: {lattice_file: a.h5}",
                 "lattice_file: is given in two places"),
                ("make: {output_dir: make_lattice stack}", "output_dir: is the ensemble's own"),
                ("list: [{make: {lattice_file: make_it}}]", "list: make: lattice_file: 'make_it'")):
            with self.subTest(text):
                path.write_text("scene: scene.yaml\n" + text)
                with self.assertRaises(InputError) as raised:
                    specs.read(path)
                self.assertIn(part, str(raised.exception))


if __name__ == "__main__":
    unittest.main()
