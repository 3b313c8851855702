#!/usr/bin/python3
"""Files that a scene names and that are not what they should be: lattice_file, mesh_file, an
obstacle's file, a checkpoint.

One line that names the key, the file and what is wrong; exit code 2; no memory for values that a
file only claims to have;
nothing left on disk. FLOE_FULL=1 flips more bytes.
"""
import os
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

from launch import (ENVIRONMENT, FLOE, FULL, REPOSITORY, FolderTest, limited_memory, own_words, run,
                    temporary_folder)

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402

LATTICE = "integrator: explicit\nforces: [beam]\nlattice_file: l.h5\ntime: {end: 1e-3}\n"
SHEET = ("integrator: explicit\nforces: [beam]\n"
         "sheet: {length: 6, element_size: 2, mesh_file: m.h5}\ntime: {end: 1e-3}\n")
OBSTACLE = ("integrator: explicit\nforces: [beam, contact]\nsheet: {length: 6, element_size: 2}\n"
            "obstacle: {names: [o], o: {shape: file, file: o.h5, point: [50, 0, 0]}}\n"
            "time: {end: 1e-3}\n")
# What names a file in a message, and the scene and file that it is.
KINDS = {"lattice_file": (LATTICE, "l.h5"), "sheet: mesh_file": (SHEET, "m.h5"),
         "obstacle: o: file": (OBSTACLE, "o.h5")}


class HostileTest(FolderTest):
    @classmethod
    def setUpClass(cls):
        cls.good = temporary_folder(cls.addClassCleanup)
        fl.straight_frame(4.0, 8, fl.Section(0.2, 0.1)).write(cls.good / "l.h5")
        fl.blocks([[1, 1, 1]], [[0, 0, 0]]).write(cls.good / "o.h5")
        (cls.good / "s.yaml").write_text(SHEET)
        made = run("s.yaml", cwd=cls.good)
        assert made.returncode == 0, made.stderr
        shutil.rmtree(cls.good / "out")
        assert (cls.good / "m.h5").exists()

    def start(self, key):
        """Lays a good file; the path of it."""
        scene, name = KINDS[key]
        (self.folder / "s.yaml").write_text(scene)
        path = self.folder / name
        if path.is_dir():
            path.rmdir()
        path.unlink(missing_ok=True)
        shutil.copy(self.good / name, path)
        return path

    def said(self, code=2):
        """What a run says that must end so: one line, with little memory, and no output folder."""
        done = subprocess.run([FLOE, "s.yaml"], cwd=self.folder, capture_output=True, text=True,
                              env=ENVIRONMENT,
                              preexec_fn=limited_memory(2))
        said = own_words(done.stderr)
        self.assertEqual(done.returncode, code, said)
        if code:
            self.assertEqual(said.count("\n"), 1, said)
            self.assertFalse((self.folder / "out").exists())
        return said

    def refused(self, key, *words):
        said = self.said()
        self.assertTrue(said.startswith(f"floe: {key}: '{KINDS[key][1]}'"), said)
        for word in words:
            self.assertIn(word, said)

    def change(self, key, change, *words):
        """The good file with a change is refused with these words."""
        path = self.start(key)
        with h5py.File(path, "a") as file:
            change(file)
        self.refused(key, *words)


class System(HostileTest):
    def test_good_files_are_taken(self):
        for key in KINDS:
            self.start(key)
            self.assertEqual(self.said(0), "")
            shutil.rmtree(self.folder / "out")

    def test_what_is_no_file(self):
        for key in KINDS:
            path = self.start(key)
            path.unlink()
            path.mkdir()
            self.refused(key, "is a folder, must be a file")
            path.rmdir()
            os.mkfifo(path)
            self.refused(key, "is not a regular file")
            path.unlink()
            path.symlink_to(path.name)
            self.refused(key, "Too many levels of symbolic links")
            path.unlink()
            path.write_text("")
            self.refused(key, "is empty")
            path.write_text("bodies: 3\n" * 1000)
            self.refused(key, "is not an HDF5 file")
            whole = (self.good / path.name).read_bytes()
            path.write_bytes(whole[:len(whole) // 2])
            self.refused(key, "is a damaged or unfinished HDF5 file")
            if os.geteuid() == 0:  # whom no permission stops
                continue
            path.chmod(0)
            self.refused(key, "Permission denied")

    def test_what_is_not_there(self):
        for key in ("lattice_file", "obstacle: o: file"):
            self.start(key).unlink()
            self.refused(key, "is not there" if key == "lattice_file" else "does not exist")

    @unittest.skipUnless(os.geteuid() == 0 and shutil.which("setpriv"),
                         "root may become somebody else")
    def test_permission(self):
        """As a user who may not read the file."""
        path = self.start("lattice_file")
        path.chmod(0)
        self.folder.chmod(0o777)
        done = subprocess.run(["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups",
                               FLOE, "s.yaml"],
                              cwd=self.folder, capture_output=True, text=True, env=ENVIRONMENT)
        refused = "Permission" in done.stderr and "lattice_file" not in done.stderr
        if "setpriv" in done.stderr or refused:
            self.skipTest("nobody may not run this build of floe")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(own_words(done.stderr),
                         "floe: lattice_file: 'l.h5' cannot be read: Permission denied\n")

    def test_somebody_writes_it(self):
        path = self.start("lattice_file")
        with h5py.File(path, "a"):
            said = self.said()
        self.assertIn("lattice_file: 'l.h5' is being written by another program", said)

    def run_in_little_memory(self):
        """Exit code and words of a run, which takes less than 1 GiB; one that would take the whole
        machine's is stopped before it does."""
        with tempfile.TemporaryFile() as error:
            process = subprocess.Popen([FLOE, "s.yaml"], cwd=self.folder, stderr=error,
                                       stdout=subprocess.DEVNULL, env=ENVIRONMENT,
                                       preexec_fn=limited_memory(8))
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            error.seek(0)
            said = own_words(error.read().decode())
        self.assertLess(usage.ru_maxrss, 1 << 20, f"KiB; {said}")
        return process.returncode, said

    def test_free_blocks_in_a_circle(self):
        """The list of free blocks of a group's heap leads to itself: HDF5 1.10 follows it and takes
        24 bytes per turn, until there is no memory left on the machine."""
        for key in ("lattice_file", "obstacle: o: file"):
            path = self.start(key)
            data = bytearray(path.read_bytes())
            heap = data.find(b"HEAP")  # signature, version, size, first free block, address
            free, address = (int.from_bytes(data[heap + at:heap + at + 8], "little")
                             for at in (16, 24))
            self.assertNotEqual(free, 1, "there is no free block")
            data[address + free:address + free + 8] = free.to_bytes(8, "little")
            path.write_bytes(data)
            code, said = self.run_in_little_memory()
            self.assertEqual((code, said.count("\n")), (2, 1), said)
            self.assertIn(f"{key}: '{KINDS[key][1]}'", said)

    def test_flipped_bytes(self):
        """Whatever is flipped: a run, or one line."""
        chance = random.Random(14)
        for key in KINDS:
            for _ in range(300 if FULL else 12):
                path = self.start(key)
                data = bytearray(path.read_bytes())
                for _ in range(chance.choice((1, 1, 4, 30))):
                    data[chance.randrange(len(data))] = chance.randrange(256)
                path.write_bytes(data)
                code, said = self.run_in_little_memory()
                self.assertIn(code, (0, 1, 2), said)
                if code:
                    self.assertEqual(len([line for line in said.splitlines()
                                          if "warning" not in line]), 1, said)
                self.assertNotIn("internal error", said)
                shutil.rmtree(self.folder / "out", ignore_errors=True)


class Datasets(HostileTest):
    """Of a lattice file: what is said of one dataset is said of all."""

    def replaced(self, name, values, *words, **how):
        def change(file):
            del file[name]
            file.create_dataset(name, data=values, **how)
        self.change("lattice_file", change, name, *words)

    def test_types(self):
        for values, word in ((np.full(9, "a", "S3"), "must hold numbers"),
                             (np.zeros(9, [("x", "f8")]), "must hold numbers"),
                             (np.zeros(9, complex), "must hold numbers"),
                             (np.ones(9, bool), "must hold numbers"),
                             (np.ones(()), "has 0 dimensions, must have 1 or 2"),
                             (np.ones((9, 1, 1)), "has 3 dimensions"),
                             (np.ones((9, 2)), "has shape 9 x 2, must be n x 1"),
                             (np.ones((9, 0)), "has shape 9 x 0"),
                             (np.ones(0), "has 0 rows, must have 9"),
                             (h5py.Empty("f8"), "dimensions, must have 1 or 2"),
                             (np.full(9, np.nan), "entry 0 has the value nan"),
                             (np.full(9, np.inf), "must be finite"),
                             (np.full(9, -1.0), "entry 0 is -1, must be > 0"),
                             (np.full(9, 1e300), "at most 1e30")):
            self.replaced("/bodies/mass", values, word)
        self.replaced("/bodies/position", np.ones((0, 3)), "at least one body")
        # stresses and stiffnesses of what is read would be infinite
        for dataset, values, word in (
                ("/bodies/inertia", np.full((9, 3), 1e-300), "row 0 is 1e-300"),
                ("/beams/height", np.full(8, 1e-300), "entry 0 is 1e-300"),
                ("/beams/length", np.full(8, 1e-31), "entry 0 is 1e-31")):
            self.replaced(dataset, values, word + ", must be > 0 and at least 1e-30")

    def test_indices(self):
        for values, word in ((np.full((8, 2), 0.5), "must hold integers"),
                             ([[0, 9]] * 8, "is 9, must be between 0 and 9"),
                             ([[-1, 3]] * 8, "is -1"), ([[0, 2**40]] * 8, "is 2147483647"),
                             (np.full((8, 2), "a", "S1"), "must hold integers"),
                             ([[0, 0]] * 8, "to itself"),
                             ([[1, 0]] * 8, "smaller index first"),
                             ([[0, 1], [2, 3], [0, 1]], "rows 0 and 2 both join bodies 0 and 1")):
            self.replaced("/beams/bodies", values, word)

    def test_every_beam_twice(self):
        def twice(file):
            for name in list(file["beams"]):
                values = file["beams"][name][:]
                del file["beams"][name]
                file["beams"][name] = np.concatenate([values, values])
        self.change("lattice_file", twice, "/beams/bodies: rows 0 and 8 both join bodies 0 and 1")

    def test_claimed_and_not_there(self):
        """Terabytes that take no room: never written, in holes of a sparse file, in chunks that are
        missing, packed."""
        n = 10**11
        for how in ({}, {"chunks": (10**6,)}, {"chunks": (10**6,), "compression": "gzip"}):
            def claim(file, how=how):
                del file["bodies/mass"]
                file.create_dataset("bodies/mass", (n,), "f8", **how)
            self.change("lattice_file", claim,
                        "/bodies/mass has values that its file does not hold")

        def huge(file):
            del file["bodies/position"]
            file.create_dataset("bodies/position", (2**62, 3), "i1", chunks=(1000, 3))
        self.change("lattice_file", huge, "/bodies/position has values that its file does not hold")

        def sparse(file):
            del file["bodies/mass"]
            plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            plan.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
            plan.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
            h5py.h5d.create(file["bodies"].id, b"mass", h5py.h5t.NATIVE_DOUBLE,
                            h5py.h5s.create_simple((10**10,)), plan)
        self.change("lattice_file", sparse, "/bodies/mass has values that its file does not hold")

        def packed(file):
            del file["bodies/mass"]
            file.create_dataset("bodies/mass", data=np.zeros(10**7), compression="gzip")
        self.change("lattice_file", packed, "/bodies/mass: has 10000000 rows, must have 9")

    def test_links(self):
        shutil.copy(self.good / "l.h5", self.folder / "other.h5")

        def linked(link):
            def change(file):
                del file["bodies/mass"]
                file["bodies/mass"] = link
            return change
        self.change("lattice_file", linked(h5py.ExternalLink("other.h5", "/bodies/mass")),
                    "is a link to another file")
        self.change("lattice_file", linked(h5py.SoftLink("/nowhere")),
                    "/bodies/mass is a link that leads nowhere")
        self.change("lattice_file", linked(h5py.SoftLink("/bodies/mass")),
                    "/bodies/mass is a link that leads nowhere")
        self.change("lattice_file", linked(h5py.SoftLink("/bodies")),
                    "/bodies/mass is not a dataset")

        def whole(file):
            del file["bodies"]
            file["bodies"] = h5py.ExternalLink("other.h5", "/bodies")
        self.change("lattice_file", whole, "/bodies is a link to another file")

        def virtual(file):
            del file["bodies/mass"]
            layout = h5py.VirtualLayout((9,), "f8")
            layout[:] = h5py.VirtualSource(self.folder / "other.h5", "bodies/mass", (9,))
            file.create_virtual_dataset("bodies/mass", layout)
        self.change("lattice_file", virtual, "is a virtual dataset")

        def outside(file):
            del file["bodies/mass"]
            file.create_dataset("bodies/mass", (9,), "f8", external=[("/dev/zero", 0, 72)])
        self.change("lattice_file", outside, "has its values in another file")

    def test_soft_links_within_the_file_are_followed(self):
        path = self.start("lattice_file")
        with h5py.File(path, "a") as file:
            file["weights"] = file["bodies/mass"][:]
            del file["bodies/mass"]
            file["bodies/mass"] = h5py.SoftLink("/weights")
        self.said(0)

    def test_packed_files_are_taken(self):
        path = self.start("lattice_file")
        with h5py.File(path, "a") as file:
            for name in ("bodies/mass", "beams/bodies"):
                values = file[name][:]
                del file[name]
                file.create_dataset(name, data=values, chunks=(4, *values.shape[1:]),
                                    compression="gzip", shuffle=True, fletcher32=True)
        self.said(0)

    def test_a_group_in_place_of_a_dataset_and_the_other_way_round(self):
        def group(file):
            del file["bodies/mass"]
            file["bodies"].create_group("mass")

        def dataset(file):
            del file["bodies"]
            file["bodies"] = [1.0]

        def sets(file):
            file["sets"].create_group("odd")
        self.change("lattice_file", group, "/bodies/mass is not a dataset")
        self.change("lattice_file", dataset, "/bodies/position is missing")
        self.change("lattice_file", sets, "/sets/odd is not a dataset")

    def test_shapes(self):
        for name, values, word in (("shapes/corners", [[0]], "has shape 1 x 1"),
                                   ("shapes/vertices", np.full((8, 3), np.nan), "nan"),
                                   ("shapes/face_of", [0, 5], "must grow from 0 to 6"),
                                   ("shapes/corner_of", [], "")):
            def change(file, name=name, values=values):
                del file[name]
                file[name] = values
            if name != "shapes/corners":
                self.change("obstacle: o: file", change, "/" + name, word)

    def test_mesh_file(self):
        def twice(file):
            file["generators"][1] = file["generators"][0]

        def nowhere(file):
            file["generators"][3] = [np.nan, 0]

        def outside(file):
            file["generators"][3] = [3.1, 0]

        def rows(file):
            file["generators"].attrs["length"] = np.zeros(1000)

        def count(file):
            file["generators"].attrs["iterations_done"] = np.nan
        for change, word in ((twice, "has a generator twice"),
                             (nowhere, "a generator outside the sheet"),
                             (outside, "a generator outside the sheet"),
                             (rows, "the attribute length must be a number"),
                             (count, "has a bad number of iterations")):
            self.change("sheet: mesh_file", change, word)


if __name__ == "__main__":
    unittest.main()
