#!/usr/bin/python3
"""Command lines, scene files and what needs space that floe refuses: see bad_input.py."""
import unittest

import h5py

from bad_input import (BREAKABLE, FLOATING, GOOD, HELD, MOVING, PULLED, SHEET, TOUCHING, BadInput,
                       held, loaded, scene_file)

COMMAND_LINE = {
    "stray word": (GOOD, ["stray"], "stray"),
    "stray word after a flag with a value": (GOOD, ["-check", "no", "stray"], "stray"),
    "key=value": (GOOD, ["-sheet_length=3"], "-sheet_length=3"),
    "two dashes": (GOOD, ["--sheet_length", "3"], "--sheet_length"),
    "misspelt": (GOOD, ["-shet_length", "3"], "sheet: length"),
    "no value": (GOOD, ["-sheet_length"], "sheet: length"),
    "not a number": (GOOD, ["-sheet_length", "3m"], "3m"),
    "options from a file": (GOOD, ["-options_file", "more"], "-options_file"),
    "PETSc's history file": (GOOD, ["-history", "3"], "output: history"),
    "unknown PETSc family": (GOOD, ["-kps_type", "cg"], "ksp_type"),
    "unknown PETSc option": (PULLED, ["-ksp_tpye", "cg"], "ksp_type"),
    "unknown linear solver": (PULLED, ["-ksp_type", "conjugate"], "conjugate"),
    "unknown factorisation": (PULLED, ["-pc_factor_mat_solver_type", "magic"], "magic"),
    "word for a number of PETSc's": (PULLED, ["-snes_rtol", "small"], "small"),
    "PETSc option of another solver": (PULLED, ["-ts_type", "rk"], "ts_type"),
    "unknown preconditioner": (PULLED, ["-pc_type", "magic"], "magic"),
    "unknown nonlinear solver": (PULLED, ["-snes_type", "magic"], "magic"),
}

PLANAR = ["-model_planar", "true"]
NEEDS_SPACE = {
    "a word for planar": (GOOD, ["-model_planar", "maybe"], "model: planar"),
    "planar, floating": (FLOATING, PLANAR, "model: planar: true leaves out what this scene needs: "
                                           "forces: buoyancy"),
    "planar, heavy": ("forces: [beam, gravity]\n" + SHEET + HELD, PLANAR, "forces: gravity"),
    "planar, breakable": (BREAKABLE + "fracture: {tensile_strength: 6e5, shear_strength: "
                                      "6e5, energy: 15}\n", PLANAR, "forces: fracture"),
    "planar, touching": (TOUCHING + "time: {end: 1}\ncontact: {young: 1e9}\n", PLANAR,
                         "forces: contact"),
    "planar, lifted": (loaded("set: right, force: [0, 0, 1]"), PLANAR,
                       "load: p acts out of the x-y plane"),
    "planar, twisted": (loaded("set: right, moment: [1, 0, 0]"), PLANAR,
                        "load: p acts out of the x-y plane"),
    "planar, moved up": (held("fix: x y z rx ry rz, velocity: [0, 0, 1]"), PLANAR,
                         "boundary: a moves out of the x-y plane"),
    "planar, rolled": (held("fix: x y z rx ry rz, angular_velocity: [0, 1, 0]"), PLANAR,
                       "boundary: a moves out of the x-y plane"),
    "planar, thrown up": (MOVING + "initial: {names: [i], i: {set: all, velocity: [0, 0, 1]}}\n",
                          PLANAR, "initial velocity"),
    "planar, implicit": (MOVING.replace("explicit", "implicit"), PLANAR, "integrator: implicit"),
    "planar, Runge-Kutta": (MOVING, [*PLANAR, "-ts_type", "rk"], "-ts_type rk"),
}


class CommandLine(BadInput):
    pass


for title, (scene, words, part) in COMMAND_LINE.items():
    CommandLine.case(title, ["scene.yaml", *words], part, scene_file(scene))


class NeedsSpace(BadInput):
    pass


for title, (scene, words, part) in NEEDS_SPACE.items():
    NeedsSpace.case(title, ["scene.yaml", *words], part, scene_file(scene))


class SceneFiles(BadInput):
    pass


SceneFiles.case("an option in place of the scene", ["-check"], "usage", lambda folder: None)
SceneFiles.case("missing file", ["missing.yaml"], "missing.yaml", lambda folder: None)
SceneFiles.case("folder", ["a"], "directory", lambda folder: (folder / "a").mkdir())
SceneFiles.case("device", ["/dev/null"], "/dev/null", lambda folder: None)
SceneFiles.case("binary", ["a.h5"], "a.h5", lambda folder: h5py.File(folder / "a.h5", "w").close())


if __name__ == "__main__":
    unittest.main()
