#!/usr/bin/python3
"""floe.lattice writes lattices that are consistent, and that floe reads."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = os.environ.get("FLOE", str(REPOSITORY / "build/release/floe"))
sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402

KINDS = {
    "bend45": ["bend45", "--elements", "8"],
    "rollup": ["rollup"],
    "elastica": ["elastica"],
    "lee_frame": ["lee_frame", "--elements", "5"],
    "arch": ["arch", "--elements", "8"],
    "cantilever": ["cantilever", "--elements", "5", "--young", "2e9"],
    "triangles": ["triangles", "--columns", "5", "--rows", "7", "--spacing", "2", "--thickness",
                  "0.5"],
    "stack": ["stack", "--count", "3", "--size", "1", "2", "0.5", "--gap", "0.01"],
}


def volume_and_inertia(shapes, body):
    """Volume and tensor of inertia per density 3 x 3 about the origin, by tetrahedra to the
    origin."""
    volume, second = 0.0, np.zeros((3, 3))
    for face in range(shapes.face_of[body], shapes.face_of[body + 1]):
        corner = shapes.vertices[shapes.corners[shapes.corner_of[face]:shapes.corner_of[face + 1]]]
        for b, c in zip(corner[1:-1], corner[2:]):
            a = corner[0]
            v = np.dot(a, np.cross(b, c)) / 6
            s = a + b + c
            volume += v
            second += v / 20 * (np.outer(a, a) + np.outer(b, b) + np.outer(c, c) + np.outer(s, s))
    return volume, np.trace(second) * np.eye(3) - second


def planar_residual(lattice, displacement, shear_stiffness):
    """Forces and moments n x 3 that beams of linear planar kinematics put on bodies that do not
    rotate.

    displacement n x 2 [m]; shear_stiffness(A, I_z, l) [N/m per unit of E].
    """
    out = np.zeros((len(lattice.position), 3))
    beam = lattice.beam
    for m, (i, j) in enumerate(lattice.bodies):
        length, young = beam["length"][m], beam["young"][m]
        n = (lattice.position[j] - lattice.position[i])[:2] / length
        t = np.array([-n[1], n[0]])
        stretch = displacement[j] - displacement[i]
        axial = young * beam["area"][m] / length * (n @ stretch)
        shear = young * shear_stiffness(beam["area"][m], beam["inertia_z"][m],
                                        length) * (t @ stretch)
        force = axial * n + shear * t
        out[i, :2] += force
        out[j, :2] -= force
        out[[i, j], 2] += shear * length / 2
    return out


class Written(unittest.TestCase):
    """Files made by the command."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def make(self, kind):
        file = os.path.join(self.folder.name, kind + ".h5")
        subprocess.run([str(REPOSITORY / "tools/make_lattice"), *KINDS[kind], file], check=True,
                       capture_output=True)
        return file

    def test_layout(self):
        for kind in KINDS:
            with self.subTest(kind), h5py.File(self.make(kind)) as file:
                n = len(file["bodies/position"])
                self.assertEqual(file["bodies/position"].shape, (n, 3))
                self.assertEqual(file["bodies/orientation"].shape, (n, 4))
                self.assertEqual(file["bodies/mass"].shape, (n,))
                self.assertEqual(file["bodies/inertia"].shape, (n, 3))
                self.assertEqual("beams" in file, kind != "stack")
                if "beams" in file:
                    m = len(file["beams/bodies"])
                    self.assertEqual(file["beams/bodies"].shape, (m, 2))
                    self.assertEqual(file["beams/bodies"].dtype, np.int32)
                    self.assertEqual(file["beams/axis_y"].shape, (m, 3))
                    for name in fl.BEAM_SCALARS:
                        self.assertEqual(file["beams/" + name].shape, (m,), name)
                self.assertEqual(len(file["shapes/face_of"]), n + 1)
                self.assertEqual(len(file["shapes/vertex_of"]), n + 1)
                self.assertEqual(file["shapes/corner_of"][-1], len(file["shapes/corners"]))
                self.assertEqual(file["shapes/vertex_of"][-1], len(file["shapes/vertices"]))
                self.assertEqual(os.listdir(self.folder.name).count(kind + ".h5"), 1)

    def test_floe_reads_them(self):
        if not os.access(FLOE, os.X_OK):
            self.skipTest("floe is not built")
        for kind in KINDS:
            if kind == "stack":  # without beams nothing quasi-static holds it
                continue
            scene = os.path.join(self.folder.name, kind + ".yaml")
            held = "left" if kind == "triangles" else "root"
            Path(scene).write_text(
                "integrator: quasistatic\nforces: [beam]\n"
                f"lattice_file: {self.make(kind)}\n"
                "boundary:\n  names: [held]\n"
                f"  held: {{set: {held}, fix: \"x y z rx ry rz\"}}\n")
            run = subprocess.run([FLOE, scene, "-check"], capture_output=True, text=True,
                                 cwd=self.folder.name)
            self.assertEqual(run.returncode, 0, f"{kind}: {run.stdout}{run.stderr}")

    def test_a_calibrated_sheet_reads_back_with_its_stiffness(self):
        if not os.access(FLOE, os.X_OK):
            self.skipTest("floe is not built")
        pulled = ("boundary: {names: [left, right], left: {set: left, fix: x},"
                  " right: {set: right, fix: x, displacement: [0.01, 0, 0], ramp: 1}}\n")
        scenes = {"made": "sheet: {length: 10, element_size: 1}\nbeam: {calibrate: isotropic}\n",
                  "read": "lattice_file: out/made/lattice.h5\n"}
        for name, lattice in scenes.items():
            Path(self.folder.name, name + ".yaml").write_text("forces: [beam]\n" + lattice + pulled)
            subprocess.run([FLOE, name + ".yaml"], capture_output=True, check=True,
                           cwd=self.folder.name)
        made, read = (Path(self.folder.name, "out", name, "history.csv").read_text()
                      for name in scenes)
        self.assertEqual(made, read)
        with h5py.File(Path(self.folder.name, "out/made/lattice.h5")) as file:
            self.assertEqual(file["beams/shear_factor_y"].shape, file["beams/length"].shape)
            width, height = file["beams/width"][:], file["beams/height"][:]
            np.testing.assert_array_equal(file["beams/area"][:], width * height)
            np.testing.assert_allclose(file["beams/inertia_y"][:], width * height**3 / 12,
                                       rtol=1e-15)

    def test_bad_arguments_are_one_clear_line(self):
        file = os.path.join(self.folder.name, "x.h5")
        run = subprocess.run([str(REPOSITORY / "tools/make_lattice"), "triangles", "--rows", "4",
                              file],
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, 2)
        self.assertIn("odd number of rows", run.stderr)
        self.assertFalse(os.path.exists(file))


class Frames(unittest.TestCase):
    def test_bend45_is_an_arc(self):
        lattice = fl.bend45(16)
        radius = np.linalg.norm(lattice.position - [0, 100, 0], axis=1)
        np.testing.assert_allclose(radius, 100, rtol=1e-14)
        np.testing.assert_allclose(lattice.position[-1],
                                   [100 * np.sqrt(0.5), 100 * (1 - np.sqrt(0.5)), 0])
        beam = lattice.beam
        self.assertAlmostEqual(beam["shear_factor"][0] * beam["shear_modulus"][0] * beam["area"][0],
                               4.1667e6, -3)
        self.assertAlmostEqual(beam["shear_modulus"][0] * beam["torsion"][0], 8.333e5, -3)
        softer = fl.bend45(16, torsion=0.141).beam
        self.assertAlmostEqual(softer["shear_modulus"][0] * softer["torsion"][0], 7.05e5, 3)
        self.assertAlmostEqual(fl.saint_venant_torsion(1, 1), 0.140577, 6)

    def test_mass_and_axes(self):
        section = fl.Section(0.2, 0.1, density=1000.0)
        lattice = fl.straight_frame(4.0, 8, section)
        self.assertAlmostEqual(lattice.mass.sum(), 1000 * 0.2 * 0.1 * 4)
        self.assertAlmostEqual(lattice.mass[0], lattice.mass[1] / 2)
        np.testing.assert_array_equal(lattice.axis_y, np.tile([0, 1, 0], (8, 1)))
        self.assertAlmostEqual(lattice.beam["inertia_z"][0], 0.1 * 0.2**3 / 12)
        self.assertAlmostEqual(lattice.beam["inertia_y"][0], 0.2 * 0.1**3 / 12)

    def test_bending_stiffness_of_the_rods(self):
        for lattice, stiffness in ((fl.rollup(4), 100.0), (fl.elastica(4), 175.0)):
            np.testing.assert_allclose(lattice.beam["young"] * lattice.beam["inertia_z"], stiffness)
            self.assertAlmostEqual(lattice.position[-1, 0], 10)


class BodiesMatchTheirShapes(unittest.TestCase):
    def test_volume_and_principal_inertia(self):
        cases = (fl.straight_frame(4.0, 4, fl.Section(0.5, 0.25)), fl.triangles(4, 5, 2.0, 0.5),
                 fl.blocks([[1, 2, 3], [2, 1, 0.5]], [[0, 0, 0], [5, 0, 0]]))
        for lattice in cases:
            for body in range(len(lattice.mass)):
                volume, inertia = volume_and_inertia(lattice.shapes, body)
                self.assertAlmostEqual(920 * volume / lattice.mass[body], 1, 12)
                np.testing.assert_allclose(920 * inertia, np.diag(lattice.inertia[body]),
                                           atol=1e-10 * lattice.mass[body])

    def test_stack_stands_on_the_ground(self):
        lattice = fl.stack(3, (1.0, 2.0, 0.5), gap=0.01)
        np.testing.assert_allclose(lattice.position[:, 2], [0.25, 0.76, 1.27])


class Triangles(unittest.TestCase):
    def test_counts_and_sets(self):
        lattice = fl.triangles(5, 7, 1.0, 1.0)
        self.assertEqual(len(lattice.position), 4 * 5 + 3 * 4)
        self.assertEqual(len(lattice.bodies), 4 * 4 + 3 * 3 + 6 * 8)
        np.testing.assert_allclose(lattice.beam["length"], 1)
        np.testing.assert_allclose(lattice.position.mean(axis=0), 0, atol=1e-14)
        x = {name: np.unique(np.round(lattice.position[members, 0], 12))
             for name, members in lattice.sets.items()}
        self.assertEqual((x["left"], x["leftinner"], x["rightinner"], x["right"]),
                         (-2, -1.5, 1.5, 2))

    def test_uniform_stress_is_an_exact_equilibrium(self):
        """Stretched along its rows, only the held zigzags feel forces; the modulus is E* of the
        infinite lattice."""
        lattice, strain = fl.triangles(7, 9, 2.0, 0.5), 1e-3
        held = np.concatenate([lattice.sets[s]
                               for s in ("left", "leftinner", "right", "rightinner")])
        free = np.setdiff1d(np.arange(len(lattice.position)), held)
        variants = {"one_point": lambda a, i, l: 5 / 6 * a / 2.6 / l, "none": lambda a, i,
                    l: 12 * i / l**3}
        for name, ratio in (("one_point", 5 / 6 / 2.6), ("none", 1 / 3)):
            poisson = (1 - ratio) / (3 + ratio)
            affine = lattice.position[:, :2] * strain * [1, -poisson]
            out = planar_residual(lattice, affine, variants[name])
            scale = np.abs(out).max()
            self.assertLess(np.abs(out[free]).max(), 1e-12 * scale, name)
            self.assertLess(np.abs(out[held, 1]).max(), 1e-12 * scale, name)
            force = -out[np.concatenate([lattice.sets["right"], lattice.sets["rightinner"]]),
                         0].sum()
            width = 8 * np.sqrt(3)
            modulus = abs(force) / (width * 0.5 * strain * 4e9)
            self.assertAlmostEqual(modulus, 2 * (1 + ratio) / (3 + ratio), 12)


class Checks(unittest.TestCase):
    def test_inconsistent_lattices_are_refused(self):
        def broken(change):
            lattice = fl.bend45(4)
            change(lattice)
            return lattice

        def swap(lattice):
            lattice.bodies = lattice.bodies[::-1]

        def negative(lattice):
            lattice.mass[0] = -1

        def outside(lattice):
            lattice.sets["tip"] = [99]

        for change, word in ((swap, "sorted"), (negative, "positive"), (outside, "set tip")):
            with self.assertRaisesRegex(ValueError, word):
                broken(change).check()


if __name__ == "__main__":
    unittest.main()
