#!/usr/bin/python3
"""Bad input ends with one line on standard error, exit code 2 and nothing written, at 1 and at 2 ranks.

Each case is (scene text or None for no scene file, words after the scene, words its error must hold). It runs
in a temporary folder of its own, as a user would run it, with a time limit: a rank that waits for another
that has given up is the failure this looks for.
"""
import concurrent.futures
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
sys.path.insert(0, str(REPOSITORY / "tools"))
import floe_lattice as fl  # noqa: E402

SECONDS = 60  # one run takes well below 1 s; the machine may be busy
ENVIRONMENT = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
               "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_NUM_THREADS": "1",
               "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

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
    "contact in implicit steps": (TOUCHING + "contact: {young: 1e9}\ntime: {end: 1}\n", "forces: contact: integrator: implicit cannot step it",
                                  ["-integrator", "implicit"]),
    "fracture in implicit steps": (BREAKABLE + "time: {end: 1}\n", "take integrator: explicit or quasistatic, or leave fracture out",
                                   ["-integrator", "implicit"]),
    "fracture in Runge-Kutta steps": ("integrator: explicit\n" + BREAKABLE + "time: {end: 1}\n", "take leapfrog (without -ts_type)",
                                      ["-ts_type", "rk"]),
    "contact in Runge-Kutta steps": (TOUCHING + "contact: {young: 1e9}\ntime: {end: 1}\n", "forces: contact: ts_type: rk cannot step it",
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
                                   + "contact: {young: 1e15}\ntime: {end: 1e12}\n", "time: dt"),
    "a step of no use": (MOVING, "steps to time: end", ["-time_dt", "1e-15"]),
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
    maxDiff = None

    def refused(self, words, part, ranks, folder):
        """Runs floe with `words` in `folder`; checks how it ends and that nothing has been written."""
        before = sorted(folder.rglob("*"))
        command = [str(FLOE), *words]
        if ranks > 1:
            command = ["mpiexec", "-q", "-n", str(ranks), *command]
        run = subprocess.run(command, cwd=folder, env={**os.environ, **ENVIRONMENT}, capture_output=True,
                             text=True, timeout=SECONDS)
        lines = run.stderr.splitlines()
        self.assertEqual(len(lines), 1, f"one line expected: {run.stderr!r} {run.stdout!r}")
        self.assertIn(part, lines[0])
        self.assertEqual(run.returncode, 2, lines[0])
        self.assertEqual(sorted(folder.rglob("*")), before, "something has been written")

    def setUp(self):
        self.pool = concurrent.futures.ThreadPoolExecutor(6)  # a run is mostly waiting for MPI to start
        self.addCleanup(self.pool.shutdown)
        self.cases = []

    def on_ranks(self, name, words, part, prepare):
        """Starts the case on 1 and 2 ranks; finish() looks at what came out."""
        def one(ranks):
            with tempfile.TemporaryDirectory() as folder:
                prepare(Path(folder))
                self.refused(words, part, ranks, Path(folder))
        for ranks in (1, 2):
            self.cases.append((name, ranks, self.pool.submit(one, ranks)))

    def finish(self):
        for name, ranks, case in self.cases:
            with self.subTest(case=name, ranks=ranks):
                case.result()

    def test_command_line(self):
        for name, (scene, words, part) in COMMAND_LINE.items():
            self.on_ranks(name, ["scene.yaml", *words], part,
                          lambda folder, scene=scene: (folder / "scene.yaml").write_text(scene))
        self.finish()

    def test_what_needs_space(self):
        for name, (scene, words, part) in NEEDS_SPACE.items():
            self.on_ranks(name, ["scene.yaml", *words], part,
                          lambda folder, scene=scene: (folder / "scene.yaml").write_text(scene))
        self.finish()

    def test_scenes(self):
        for name, (scene, part, *words) in SCENES.items():
            self.on_ranks(name, ["scene.yaml", *(words[0] if words else [])], part,
                          lambda folder, scene=scene: (folder / "scene.yaml").write_text(scene))
        self.finish()

    def test_scene_files(self):
        self.on_ranks("an option in place of the scene", ["-check"], "usage", lambda folder: None)
        self.on_ranks("missing file", ["missing.yaml"], "missing.yaml", lambda folder: None)
        self.on_ranks("folder", ["a"], "directory", lambda folder: (folder / "a").mkdir())
        self.on_ranks("device", ["/dev/null"], "/dev/null", lambda folder: None)
        self.on_ranks("binary", ["a.h5"], "a.h5", lambda folder: h5py.File(folder / "a.h5", "w").close())
        self.finish()

    def test_lattice_files(self):
        frame = fl.straight_frame(length=4, elements=4, section=fl.Section(1, 1))
        for name, (change, part) in LATTICE_FILES.items():
            def prepare(folder, change=change):
                (folder / "scene.yaml").write_text(FILE)
                frame.write(folder / "bad.h5")
                with h5py.File(folder / "bad.h5", "r+") as file:
                    change(file)
            self.on_ranks(name, ["scene.yaml"], part, prepare)
        def without_sides(folder):
            (folder / "scene.yaml").write_text(FILE.replace("[beam]", "[beam, fracture]"))
            frame.write(folder / "bad.h5")
            with h5py.File(folder / "bad.h5", "r+") as file:
                del file["beams/width"], file["beams/height"]
        self.on_ranks("fracture of sections without sides", ["scene.yaml"], "/beams/width", without_sides)
        self.on_ranks("not HDF5", ["scene.yaml"], "bad.h5",
                      lambda folder: [(folder / "scene.yaml").write_text(FILE),
                                      (folder / "bad.h5").write_text("no")])
        self.finish()

    def test_shapes(self):
        """Of an obstacle and of loose bodies: cubes that are no closed convex polyhedra with plane faces."""
        cube = np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float) / 2
        faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
        dented = cube.copy()
        dented[6] = 0.1  # a corner that no plane of another face is beyond
        cases = {"without a top": (cube, faces[:1] + faces[2:], "faces must close"),
                 "without two sides": (cube, faces[:2] + faces[2:5:2], "faces must close"),
                 "a face twice": (cube, faces + faces[:1], "faces must close"),
                 "a face the other way round": (cube, faces[:5] + [faces[5][::-1]], "faces must close"),
                 "vertices of each face its own":
                     (cube[np.concatenate(faces)], [list(range(4 * k, 4 * k + 4)) for k in range(6)], "faces must close"),
                 "flat": (cube * [1, 1, 0], faces, "volume > 0"),
                 "inside out": (cube, [face[::-1] for face in faces], "counter-clockwise"),
                 "dented": (dented, faces, "not plane")}
        scene = "integrator: explicit\nforces: [contact]\nlattice_file: good.h5\ncontact: {young: 1e7}\n"
        for name, (vertices, corners, part) in cases.items():
            def spoilt(path, vertices=vertices, corners=corners):
                with h5py.File(path, "a") as file:
                    if "shapes" in file:
                        del file["shapes"]
                    file["shapes/vertices"] = vertices
                    file["shapes/corners"] = np.concatenate(corners).astype(np.int32)
                    file["shapes/corner_of"] = np.cumsum([0, *map(len, corners)]).astype(np.int32)
                    file["shapes/face_of"] = np.array([0, len(corners)], np.int32)
                    file["shapes/vertex_of"] = np.array([0, len(vertices)], np.int32)

            def good(path):
                fl.Lattice(np.array([[0.0, 0, 9]]), np.array([[1.0, 0, 0, 0]]), np.array([920.0]),
                           np.full((1, 3), 920 / 6), shapes=fl.Shapes.boxes(np.ones((1, 3)))).write(path)

            def an_obstacle(folder, spoilt=spoilt):
                good(folder / "good.h5")
                spoilt(folder / "bad.h5")
                (folder / "scene.yaml").write_text(
                    scene + "obstacle: {names: [o], o: {shape: file, file: bad.h5}}\n")

            def a_body(folder, spoilt=spoilt):
                good(folder / "good.h5")
                spoilt(folder / "good.h5")
                (folder / "scene.yaml").write_text(scene)

            self.on_ranks("obstacle " + name, ["scene.yaml"], part, an_obstacle)
            if name != "dented":  # its centroid is not the origin, which is what is found first
                self.on_ranks("body " + name, ["scene.yaml"], "/shapes", a_body)
        self.finish()

    def test_a_body_inside_another(self):
        def nested(folder):
            sizes = np.array([[3.0, 3, 3], [1, 1, 1]])
            mass = 920 * sizes.prod(1)
            fl.Lattice(np.zeros((2, 3)), np.array([[1.0, 0, 0, 0]] * 2), mass, mass[:, None] * sizes**2 / 6,
                       shapes=fl.Shapes.boxes(sizes)).write(folder / "bad.h5")
            (folder / "scene.yaml").write_text("integrator: explicit\nforces: [contact]\nlattice_file: bad.h5\n"
                                               "contact: {young: 1e7}\n")
        self.on_ranks("nested", ["scene.yaml"], "wholly inside", nested)
        self.finish()

    def test_more_ranks_than_bodies(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder)
            (path / "scene.yaml").write_text(GOOD)
            words = ["scene.yaml", "-sheet_length", "1", "-sheet_element_size", "1"]  # 2 bodies
            self.refused(words, "ranks", 3, path)


if __name__ == "__main__":
    unittest.main()
