#!/usr/bin/python3
"""Bad input ends with one line on standard error, exit code 2 and nothing written, at 1 and at 2 ranks.

Each case runs in a temporary folder of its own, as a user would run it. A rank that waits for another that has
given up is a failure that this looks for.
"""
import re
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

import launch

sys.path.insert(0, str(launch.REPOSITORY / "tools"))
import floe_lattice as fl  # noqa: E402

SHEET = "sheet: {length: 10, thickness: 1, element_size: 3, iterations: 5}\n"
HELD = "boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}\n"
GOOD = "forces: [beam]\n" + SHEET + HELD
BREAKABLE = "forces: [beam, fracture]\n" + SHEET + HELD
FLOATING = "forces: [beam, gravity, buoyancy]\n" + SHEET
FILE = "forces: [beam]\nlattice_file: bad.h5\nboundary: {names: [a], a: {set: root, fix: x y z rx ry rz}}\n"


def held(rest):
    return "forces: [beam]\n" + SHEET + "boundary: {names: [a], a: {set: left, " + rest + "}}\n"


def loaded(rest):
    return GOOD + "load: {names: [p], p: {" + rest + "}}\n"


PULLED = loaded("set: right, force: [1e5, 0, 0]")  # what a solver has work with

TOUCHING = "integrator: explicit\nforces: [beam, contact]\n" + SHEET
FLOOR = "obstacle: {names: [o], o: {shape: halfspace, normal: [0, 0, 1]}}\n"


def obstacle(rest):
    return TOUCHING + "obstacle: {names: [o], o: {" + rest + "}}\n"


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
MOVING = "integrator: explicit\n" + GOOD + "time: {end: 1}\n"
NEEDS_SPACE = {
    "a word for planar": (GOOD, ["-model_planar", "maybe"], "model: planar"),
    "planar, floating": (FLOATING, PLANAR, "model: planar: true leaves out what this scene needs: forces: buoyancy"),
    "planar, heavy": ("forces: [beam, gravity]\n" + SHEET + HELD, PLANAR, "forces: gravity"),
    "planar, breakable": (BREAKABLE + "fracture: {tensile_strength: 6e5, shear_strength: 6e5, energy: 15}\n", PLANAR, "forces: fracture"),
    "planar, touching": (TOUCHING + "time: {end: 1}\ncontact: {young: 1e9}\n", PLANAR, "forces: contact"),
    "planar, lifted": (loaded("set: right, force: [0, 0, 1]"), PLANAR, "load: p acts out of the x-y plane"),
    "planar, twisted": (loaded("set: right, moment: [1, 0, 0]"), PLANAR, "load: p acts out of the x-y plane"),
    "planar, moved up": (held("fix: x y z rx ry rz, velocity: [0, 0, 1]"), PLANAR, "boundary: a moves out of the x-y plane"),
    "planar, rolled": (held("fix: x y z rx ry rz, angular_velocity: [0, 1, 0]"), PLANAR, "boundary: a moves out of the x-y plane"),
    "planar, thrown up": (MOVING + "initial: {names: [i], i: {set: all, velocity: [0, 0, 1]}}\n", PLANAR, "initial velocity"),
    "planar, implicit": (MOVING.replace("explicit", "implicit"), PLANAR, "integrator: implicit"),
    "planar, Runge-Kutta": (MOVING, [*PLANAR, "-ts_type", "rk"], "-ts_type rk"),
}

SCENES = {
    "broken YAML": ("forces: [beam\nsheet: 3\n", "line 2"),
    "tab": ("forces: [beam]\n\tsheet: 3\n", "line 2"),
    "key given twice": (GOOD + "forces: [beam]\n", "given twice"),
    "two keys that join to one name": (GOOD + "sheet_length: 1\n", "given twice"),
    "list of maps": (GOOD + "region: [{r: 1}]\n", "list"),
    "two documents": (GOOD + "---\nforces: [beam]\n", "document"),
    "not a map": ("- 1\n- 2\n", "map"),
    "empty": ("", "forces"),
    "no forces": (SHEET, "forces"),
    "no sheet": ("forces: [beam]\n", "sheet"),
    "misspelt key": (GOOD + "ice: {yuong: 1}\n", "ice: young"),
    "misspelt section": (GOOD + "ise: {young: 1}\n", "ice: young"),
    "value for a section": (GOOD + "ice: 3\n", "section"),
    "wrong type": (GOOD + "ice: {young: stiff}\n", "ice: young: stiff"),
    "wrong word": (GOOD + "beam: {shear: strong}\n", "one_point"),
    "wrong force": ("forces: [beam, wind]\n" + SHEET, "wind"),
    "nan": (GOOD + "ice: {young: nan}\n", "nan"),
    "infinite": (GOOD + "ice: {young: .inf}\n", "inf"),
    "negative thickness": (GOOD, "sheet: thickness: -1", ["-sheet_thickness", "-1"]),
    "element larger than the sheet": (GOOD, "sheet: element_size", ["-sheet_element_size", "11"]),
    "more bodies than memory": (GOOD, "sheet: element_size", ["-sheet_element_size", "1e-6"]),
    "negative seed": (GOOD, "sheet: seed: -1", ["-sheet_seed", "-1"]),
    "Poisson's ratio": (GOOD + "ice: {poisson: 0.5}\n", "ice: poisson"),
    "a sheet that sinks": (FLOATING + "ice: {density: 1100}\n", "ice: density"),
    "fracture without beams": ("forces: [fracture, gravity, buoyancy]\n" + SHEET, "needs beam"),
    "fracture that is not named": (GOOD + "fracture: {energy: 15}\n", "'fracture' is not in 'forces'"),
    "strength of a sheet": (BREAKABLE + "fracture: {calibrate: sheet}\n", "none | strength"),
    "strength of a lattice file": ("forces: [beam, fracture]\nlattice_file: bad.h5\nfracture: {calibrate: strength}\n",
                                   "fracture: calibrate: needs 'sheet'"),
    "strength of a row of bodies": (BREAKABLE + "fracture: {calibrate: strength}\n", "sheet: width: must be of more than one row",
                                    ["-sheet_length", "4", "-sheet_width", "1", "-sheet_element_size", "1"]),
    "strength that does not scatter": (BREAKABLE + "fracture: {seed: 3}\n", "weibull_modulus"),
    "no strength": (BREAKABLE + "fracture: {tensile_strength: 0}\n", "fracture: tensile_strength: 0"),
    "buoyancy without gravity": ("forces: [beam, buoyancy]\n" + SHEET, "gravity"),
    "section of a force that is not named": (GOOD + "water: {density: 1000}\n", "water: density"),
    "gravity that does not act": (GOOD + "gravity: 9.81\n", "gravity"),
    "sheet and lattice file": (GOOD + "lattice_file: a.h5\n", "lattice_file"),
    "lattice file that is not there": (FILE, "bad.h5"),
    "ice with a lattice file": (FILE + "ice: {young: 1}\n", "ice: young"),
    "unknown set of a boundary": (GOOD.replace("set: left", "set: lefft"), "lefft"),
    "unknown set of a load": (loaded("set: rihgt, force: [1, 0, 0]"), "rihgt"),
    "four numbers for a vector": (loaded("set: right, force: [1, 2, 3, 4]"), "load: p: force: 1,2,3,4"),
    "two numbers for a vector": (loaded("set: right, force: [1, 2]"), "load: p: force: 1,2"),
    "Poisson's ratio that no lattice has":
        (GOOD + "ice: {poisson: 0.4}\nbeam: {calibrate: isotropic}\n", "ice: poisson: 0.4 must be <= 1/3"),
    "shear of a calibrated sheet": (GOOD + "beam: {calibrate: isotropic, shear: exact}\n", "beam: shear"),
    "torsion of a calibrated sheet": (GOOD + "beam: {calibrate: isotropic, torsion: polar}\n", "beam: torsion"),
    "calibration of a sheet without inner bodies":
        ("forces: [beam]\nsheet: {length: 10, thickness: 1.5, element_size: 4.5}\nbeam: {calibrate: young}\n" + HELD,
         "beam: calibrate: a sheet of 6 bodies"),
    "unknown calibration": (GOOD + "beam: {calibrate: bending}\n", "none | young | isotropic"),
    "calibration of a file": (FILE + "beam: {calibrate: young}\n", "beam: calibrate"),
    "load on a set and at a point": (loaded("set: right, point: [0, 0], force: [1, 0, 0]"), "not both"),
    "load nowhere": (loaded("force: [1, 0, 0]"), "set or point"),
    "load beside the sheet": (loaded("point: [6, 0], force: [0, 0, 1]"), "load: p: point"),
    "report of bending under two loads":
        (FLOATING + "load: {names: [p, q], p: {point: [0, 0], force: [0, 0, -1], ramp: 1},"
         " q: {point: [1, 0], force: [0, 0, -1], ramp: 1}}\nreport: [bending]\n", "report: bending"),
    "unlisted load": (GOOD + "load: {p: {set: right, force: [1, 0, 0]}}\n", "load: names"),
    "listed load without a section": (GOOD + "load: {names: [p]}\n", "no such section"),
    "name given twice": (GOOD + "load: {names: [p, p], p: {set: right, force: [1, 0, 0]}}\n", "p,p"),
    "nothing fixed": (held("ramp: 1"), "boundary: a: fix"),
    "value for a free component": (held("fix: x, velocity: [0, 1, 0]"), "'y'"),
    "component fixed twice": (held("fix: x x"), "x x"),
    "velocity and displacement": (held("fix: x, velocity: [1, 0, 0], displacement: [1, 0, 0]"), "not both"),
    "displacement at once, with time":
        ("integrator: explicit\n" + held("fix: x, displacement: [1, 0, 0]") + "time: {end: 1}\n",
         "boundary: a: displacement needs ramp > 0"),
    "nothing holds the sheet against its load":
        ("forces: [beam]\n" + SHEET + "load: {names: [p], p: {set: right, force: [1, 0, 0]}}\n", "hold"),
    "two boundaries that disagree":
        ("forces: [beam]\n" + SHEET + "boundary:\n  names: [a, b]\n  a: {set: all, fix: x}\n"
         "  b: {set: left, fix: x, displacement: [1, 0, 0]}\n", "boundary: "),
    "region without bodies": (GOOD + "region: {names: [r], r: {box: 90 91 0 1 0 1}}\n", "region: r"),
    "region upside down": (GOOD + "region: {names: [r], r: {box: 1 0 0 1 0 1}}\n", "region: r: box"),
    "cut beside the sheet": (GOOD + "cut: {names: [c], c: {from: [9, -9], to: [9, 9]}}\n", "cut: c"),
    "contact in statics": (TOUCHING, "forces: contact", ["-integrator", "quasistatic"]),
    "contact in implicit steps": (TOUCHING + "contact: {young: 1e9}\ntime: {end: 1}\n", "integrator: implicit cannot step force 'contact'",
                                  ["-integrator", "implicit"]),
    "contact in Runge-Kutta steps": (TOUCHING + "contact: {young: 1e9}\ntime: {end: 1}\n", "ts_type: 'rk' cannot step force 'contact'",
                                     ["-ts_type", "rk"]),
    "contact that does not act": (GOOD + "contact: {friction: 0.1}\n", "contact: friction"),
    "obstacle that does not act": (GOOD + FLOOR, "obstacle"),
    "restitution above 1": (TOUCHING + "contact: {restitution: 1.1}\n", "contact: restitution"),
    "negative friction": (TOUCHING + "contact: {friction: -0.1}\n", "contact: friction"),
    "obstacle of no known shape": (obstacle("shape: sphere"), "sphere"),
    "obstacle without a shape": (obstacle("friction: 0.1"), "obstacle: o: shape"),
    "half-space without a direction": (obstacle("shape: halfspace, normal: [0, 0, 0]"), "obstacle: o: normal"),
    "flat box": (obstacle("shape: box, size: [1, 0, 1]"), "obstacle: o: size"),
    "cylinder of two facets": (obstacle("shape: cylinder, facets: 2"), "obstacle: o: facets"),
    "half-space whose direction overflows": (obstacle("shape: halfspace, normal: [1e200, 0, 0]"), "obstacle: o: normal"),
    "obstacle around a body": (obstacle("shape: box, size: [30, 30, 30]"), "obstacle: o: body 0 lies wholly inside"),
    "half-space the wrong way round":
        (obstacle("shape: halfspace, point: [0, 0, -5], normal: [0, 0, -1]"), "obstacle: o: body 0 lies wholly inside"),
    "contacts of no stable step": (TOUCHING + FLOOR.replace("shape: halfspace", "point: [0, 0, -0.5], shape: halfspace")
                                   + "contact: {young: 1e40}\n", "time: dt"),
    "a step of no use": (MOVING, "steps to time: end", ["-time_dt", "1e-30"]),
    "radius of a box": (obstacle("shape: box, radius: 1"), "obstacle: o: radius"),
    "half-space that turns":
        (obstacle("shape: halfspace, angular_velocity: [0, 0, 1]"), "obstacle: o: angular_velocity"),
    "oscillation without a frequency":
        (obstacle("shape: box, amplitude: [0, 0, 1]"), "obstacle: o: amplitude [m] needs frequency"),
    "oscillation without an amplitude":
        (obstacle("shape: box, frequency: 1"), "obstacle: o: frequency [Hz] needs amplitude"),
    "ramp of an obstacle at rest": (obstacle("shape: box, ramp: 1"), "obstacle: o: ramp"),
    "frequency of 0":
        (obstacle("shape: box, amplitude: [0, 0, 1], frequency: 0"), "obstacle: o: frequency"),
    "obstacle from a file that is not there": (obstacle("shape: file, file: none.h5"), "none.h5"),
    "lattice file without a stiffness of contacts":
        ("integrator: explicit\nforces: [contact]\nlattice_file: bad.h5\n", "contact: young"),
    "load step beyond the end": (GOOD + "time: {end: 1, dt: 2}\n", "time: dt"),
    "output below a regular file": (GOOD + "output: {dir: scene.yaml/out}\n", "output: dir"),
    "output in place of a regular file": (GOOD + "output: {dir: scene.yaml}\n", "output: dir"),
}


def spoil(name, value):
    """Puts another value in place of a dataset, or removes it if the value is None."""
    def change(file):
        if name in file:
            del file[name]
        if value is not None:
            file[name] = value
    return change


LATTICE_FILES = {
    "positions with two columns": (spoil("bodies/position", np.zeros((5, 2))), "/bodies/position"),
    "one mass too few": (spoil("bodies/mass", np.ones(4)), "/bodies/mass"),
    "no masses": (spoil("bodies/mass", None), "/bodies/mass"),
    "negative mass": (spoil("bodies/mass", -np.ones(5)), "/bodies/mass"),
    "nan": (spoil("bodies/mass", np.array([1, 1, np.nan, 1, 1])), "/bodies/mass"),
    "not a unit quaternion": (spoil("bodies/orientation", np.full((5, 4), 0.9)), "/bodies/orientation"),
    "beam to a body that is not there":
        (spoil("beams/bodies", np.array([[0, 1], [1, 2], [2, 3], [3, 5]], np.int32)), "/beams/bodies"),
    "beam to a negative body":
        (spoil("beams/bodies", np.array([[-1, 1], [1, 2], [2, 3], [3, 4]], np.int32)), "/beams/bodies"),
    "beam of one body":
        (spoil("beams/bodies", np.array([[0, 1], [1, 2], [2, 3], [3, 3]], np.int32)), "/beams/bodies"),
    "beams with three columns": (spoil("beams/bodies", np.ones((4, 3), np.int32)), "/beams/bodies"),
    "wrong length": (spoil("beams/length", np.full(4, 7.0)), "/beams/length"),
    "factors of shear in the plane, one too few": (spoil("beams/shear_factor_y", np.ones(3)), "/beams/shear_factor_y"),
    "set of a body that is not there": (spoil("sets/root", np.array([5], np.int32)), "/sets/root"),
}


class BadInput(unittest.TestCase):
    """A class of cases, each of them a test: see `case`."""
    maxDiff = None

    @classmethod
    def case(cls, name, words, part, prepare, ranks=(1, 2)):
        """Adds a test: floe with `words`, in a folder that `prepare(folder)` fills, says `part`."""
        def test(self):
            for n in ranks:
                with self.subTest(ranks=n), tempfile.TemporaryDirectory() as folder:
                    prepare(Path(folder))
                    self.refused(words, part, n, Path(folder))

        method = "test_" + re.sub(r"\W+", "_", name)
        assert not hasattr(cls, method), f"two cases named {name}"
        setattr(cls, method, test)

    def refused(self, words, part, ranks, folder):
        """Runs floe with `words` in `folder`; checks how it ends and that nothing has been written."""
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


class CommandLine(BadInput):
    pass


for title, (scene, words, part) in COMMAND_LINE.items():
    CommandLine.case(title, ["scene.yaml", *words], part, scene_file(scene))


class NeedsSpace(BadInput):
    pass


for title, (scene, words, part) in NEEDS_SPACE.items():
    NeedsSpace.case(title, ["scene.yaml", *words], part, scene_file(scene))


class Scenes(BadInput):
    pass


for title, (scene, part, *words) in SCENES.items():
    Scenes.case(title, ["scene.yaml", *(words[0] if words else [])], part, scene_file(scene))


class SceneFiles(BadInput):
    pass


SceneFiles.case("an option in place of the scene", ["-check"], "usage", lambda folder: None)
SceneFiles.case("missing file", ["missing.yaml"], "missing.yaml", lambda folder: None)
SceneFiles.case("folder", ["a"], "directory", lambda folder: (folder / "a").mkdir())
SceneFiles.case("device", ["/dev/null"], "/dev/null", lambda folder: None)
SceneFiles.case("binary", ["a.h5"], "a.h5", lambda folder: h5py.File(folder / "a.h5", "w").close())


class LatticeFiles(BadInput):
    pass


def frame_file(change, scene=FILE):
    """Fills a folder with a frame that `change(file)` has spoilt, and a scene."""
    def prepare(folder):
        (folder / "scene.yaml").write_text(scene)
        fl.straight_frame(length=4, elements=4, section=fl.Section(1, 1)).write(folder / "bad.h5")
        with h5py.File(folder / "bad.h5", "r+") as file:
            change(file)
    return prepare


def without_sides(file):
    del file["beams/width"], file["beams/height"]


for title, (change, part) in LATTICE_FILES.items():
    LatticeFiles.case(title, ["scene.yaml"], part, frame_file(change))
LatticeFiles.case("fracture of sections without sides", ["scene.yaml"], "/beams/width",
                  frame_file(without_sides, FILE.replace("[beam]", "[beam, fracture]")))
LatticeFiles.case("not HDF5", ["scene.yaml"], "bad.h5",
                  lambda folder: [(folder / "scene.yaml").write_text(FILE), (folder / "bad.h5").write_text("no")])


class Shapes(BadInput):
    """Of an obstacle and of loose bodies: cubes that are no closed convex polyhedra with plane faces."""


LOOSE = "integrator: explicit\nforces: [contact]\nlattice_file: good.h5\ncontact: {young: 1e7}\n"
CUBE = np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float) / 2
FACES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
DENTED = np.vstack([CUBE[:6], [[0.1, 0.1, 0.1]], CUBE[7:]])  # a corner that no plane of another face is beyond
SHAPES = {
    "without a top": (CUBE, FACES[:1] + FACES[2:], "faces must close"),
    "without two sides": (CUBE, FACES[:2] + FACES[2:5:2], "faces must close"),
    "a face twice": (CUBE, FACES + FACES[:1], "faces must close"),
    "a face the other way round": (CUBE, FACES[:5] + [FACES[5][::-1]], "faces must close"),
    "vertices of each face its own":
        (CUBE[np.concatenate(FACES)], [list(range(4 * k, 4 * k + 4)) for k in range(6)], "faces must close"),
    "flat": (CUBE * [1, 1, 0], FACES, "volume > 0"),
    "inside out": (CUBE, [face[::-1] for face in FACES], "counter-clockwise"),
    "dented": (DENTED, FACES, "not plane"),
}


def loose_body(path):
    fl.Lattice(np.array([[0.0, 0, 9]]), np.array([[1.0, 0, 0, 0]]), np.array([920.0]), np.full((1, 3), 920 / 6),
               shapes=fl.Shapes.boxes(np.ones((1, 3)))).write(path)


def spoil_shape(path, vertices, corners):
    with h5py.File(path, "a") as file:
        if "shapes" in file:
            del file["shapes"]
        file["shapes/vertices"] = vertices
        file["shapes/corners"] = np.concatenate(corners).astype(np.int32)
        file["shapes/corner_of"] = np.cumsum([0, *map(len, corners)]).astype(np.int32)
        file["shapes/face_of"] = np.array([0, len(corners)], np.int32)
        file["shapes/vertex_of"] = np.array([0, len(vertices)], np.int32)


def spoilt_obstacle(vertices, corners):
    def prepare(folder):
        loose_body(folder / "good.h5")
        spoil_shape(folder / "bad.h5", vertices, corners)
        (folder / "scene.yaml").write_text(LOOSE + "obstacle: {names: [o], o: {shape: file, file: bad.h5}}\n")
    return prepare


def spoilt_body(vertices, corners):
    def prepare(folder):
        loose_body(folder / "good.h5")
        spoil_shape(folder / "good.h5", vertices, corners)
        (folder / "scene.yaml").write_text(LOOSE)
    return prepare


for title, (vertices, corners, part) in SHAPES.items():
    Shapes.case("obstacle " + title, ["scene.yaml"], part, spoilt_obstacle(vertices, corners))
    if title != "dented":  # its centroid is not the origin, which is what is found first
        Shapes.case("body " + title, ["scene.yaml"], "/shapes", spoilt_body(vertices, corners))


class Bodies(BadInput):
    pass


def nested(folder):
    sizes = np.array([[3.0, 3, 3], [1, 1, 1]])
    mass = 920 * sizes.prod(1)
    fl.Lattice(np.zeros((2, 3)), np.array([[1.0, 0, 0, 0]] * 2), mass, mass[:, None] * sizes**2 / 6,
               shapes=fl.Shapes.boxes(sizes)).write(folder / "good.h5")
    (folder / "scene.yaml").write_text(LOOSE)


Bodies.case("a body inside another", ["scene.yaml"], "wholly inside", nested)
Bodies.case("more ranks than bodies", ["scene.yaml", "-sheet_length", "1", "-sheet_element_size", "1"], "ranks",
            scene_file(GOOD), ranks=(3,))  # 2 bodies


if __name__ == "__main__":
    unittest.main()
