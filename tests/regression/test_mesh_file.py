#!/usr/bin/python3
"""sheet: mesh_file: the second scene of a sheet reads the mesh that the first one made, to the last
bit."""
import json
import tempfile
import unittest
from pathlib import Path

import h5py

import launch

TENSION = [str(launch.REPOSITORY / "input/tension.yaml"), "-sheet_length", "20", "-sheet_width",
           "20"]


class MeshFile(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        self.addCleanup(self.folder.cleanup)

    def floe(self, *words, expect=0):
        run = launch.run(*TENSION, *words, cwd=self.root)
        self.assertEqual(run.returncode, expect, run.stderr)
        return run.stderr

    def lattice(self, folder):
        with h5py.File(self.root / folder / "lattice.h5") as file:
            return [file[name][:].tobytes() for name in ("bodies/position", "bodies/inertia",
                                                         "beams/bodies", "beams/area")]

    def summary(self, folder):
        return json.loads((self.root / folder / "summary.json").read_text())

    def test_same_mesh_from_the_file(self):
        self.floe("-output_dir", "plain")
        self.floe("-output_dir", "made", "-sheet_mesh_file", "mesh.h5")
        stamp = (self.root / "mesh.h5").stat().st_mtime_ns
        self.floe("-output_dir", "read", "-sheet_mesh_file", "mesh.h5")
        self.assertEqual((self.root / "mesh.h5").stat().st_mtime_ns, stamp)
        self.assertEqual(self.lattice("made"), self.lattice("read"))
        made, read, plain = (self.summary(name) for name in ("made", "read", "plain"))
        self.assertEqual(made["E"], read["E"])
        self.assertAlmostEqual(made["E"] / plain["E"], 1, delta=1e-10)
        for key in ("cvt_energy_ratio", "cvt_largest_move", "cvt_iterations", "seed"):
            self.assertEqual(made[key], read[key])
        self.assertEqual(read["cvt_iterations"], 150)

    def test_mesh_of_another_sheet_is_refused(self):
        self.floe("-output_dir", "made", "-sheet_mesh_file", "mesh.h5")
        for change, named in ((("-sheet_seed", "2"), "seed"),
                              (("-sheet_element_size", "2.5"), "element_size"),
                              (("-sheet_iterations", "10"), "iterations")):
            message = self.floe("-output_dir", "other", "-sheet_mesh_file", "mesh.h5", *change,
                                expect=2)
            self.assertIn("sheet: mesh_file: 'mesh.h5' is the mesh of another sheet", message)
            self.assertIn(named, message)
        (self.root / "text.h5").write_text("not HDF5")
        self.assertIn("sheet: mesh_file", self.floe("-sheet_mesh_file", "text.h5", expect=2))
        message = self.floe("-output_dir", "other", "-sheet_mesh_file", "made/lattice.h5", expect=2)
        self.assertIn("is not a mesh file", message)


if __name__ == "__main__":
    unittest.main()
