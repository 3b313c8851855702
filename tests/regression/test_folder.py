#!/usr/bin/python3
"""Whose an output folder is: its lock, folders and files that a run must not take, and runs that
are not done."""
import os
import resource
import shutil
import subprocess
import time
import unittest
from pathlib import Path

import h5py

from running import BAD_INPUT, FAILED, RunningTest
from small_scenes import AFLOAT, LOADED

SHORT = ["-time_end", "0.5"]
WITHOUT_FLOCK = """#include <errno.h>
int flock(int file, int what) { (void)file, (void)what; errno = ENOLCK; return -1; }
"""


class Lock(RunningTest):
    def check_locked(self, ranks=1, environment={}):
        """A run in a folder in use is refused and touches nothing; the other one does not
        notice."""
        first = self.running(ranks=ranks, environment=environment)
        said = self.floe(code=BAD_INPUT, ranks=ranks, environment=environment)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("output: dir: out/scene is in use by a run (process ", said)
        self.stop(first)
        rows = (self.folder / "out/scene/history.csv").read_text().splitlines()
        self.assertEqual({len(row.split(",")) for row in rows}, {len(rows[0].split(","))})
        with h5py.File(self.folder / "out/scene/fields.h5") as file:
            self.assertIn("mesh", file)
        self.floe("-checkpoint_restart", "out/scene/checkpoint.h5", "-time_end", "1e5",
                  "-ts_max_steps", "1")

    def test_one_run_at_a_time(self):
        self.check_locked()

    def test_on_two_ranks(self):
        self.check_locked(2)

    def test_without_locks_of_hdf5(self):
        self.check_locked(environment={"HDF5_USE_FILE_LOCKING": "FALSE"})

    def test_two_that_begin_together(self):
        both = [self.begin() for _ in range(2)]  # of which neither ends by itself
        while all(process.poll() is None for process in both):
            time.sleep(0.01)
        refused, running = sorted(both, key=lambda process: process.poll() is None)
        self.finish(refused, BAD_INPUT)
        history = self.folder / "out/scene/history.csv"
        self.wait(running, lambda: history.exists() and history.read_text().count("\n") > 2)
        self.stop(running)

    def test_a_check_beside_a_run(self):
        first = self.running()
        check = self.begin("-check")
        self.assertIn("a run would be refused now: output: dir: out/scene is in use",
                      check.communicate()[0])
        self.assertEqual(check.returncode, 0)
        self.stop(first)

    def test_a_killed_run_holds_nothing(self):
        first = self.running()
        first.kill()
        first.wait()
        self.floe(*SHORT)
        self.assertEqual((self.folder / "out/scene/.lock").read_text().count("\n"), 1)

    def test_a_refused_run_leaves_no_folder(self):
        self.refused("-time_dt", "1000", "-output_dir", "x/y/z")
        self.assertFalse((self.folder / "x").exists())
        (self.folder / "x/y").mkdir(parents=True)
        self.refused("-time_dt", "1000", "-output_dir", "x/y/z")
        self.assertTrue((self.folder / "x/y").exists())

    def test_a_lock_of_others(self):
        (self.folder / "out/scene").mkdir(parents=True)
        (self.folder / "out/scene/.lock").write_text("mine\n")
        self.assertIn("has a file .lock that is not floe's", self.refused())

    def test_a_file_system_without_flock(self):
        (self.folder / "none.c").write_text(WITHOUT_FLOCK)
        subprocess.run(["cc", "-shared", "-fPIC", "none.c", "-o", "none.so"], cwd=self.folder,
                       check=True)
        without = {"environment": {"LD_PRELOAD": str(self.folder / "none.so"),
                                   "HDF5_USE_FILE_LOCKING": "FALSE"}}
        first = self.running(**without)
        said = self.floe(code=BAD_INPUT, **without)
        self.assertIn("is in use by a run (process ", said)
        first.kill()  # what it leaves is known to be of a process that is gone
        first.wait()
        self.assertTrue((self.folder / "out/scene/.lock.held").exists())
        said = self.floe(*SHORT, **without)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("is on a file system without flock", said)
        self.assertFalse((self.folder / "out/scene/.lock.held").exists())
        held = (self.folder / "out/scene/.lock.held")
        held.write_text("host elsewhere\nprocess 1\nsince 2025\n")
        self.assertIn("(if it is gone, remove out/scene/.lock.held)",
                      self.refused(*SHORT, **without))


class NotAFolder(RunningTest):
    def test_the_root_and_homes(self):
        for dir in ("/", "//", "/..", str(Path.home())):
            # Who may not write there hears that first.
            said = "is no folder for results" if os.access(dir, os.W_OK) else "cannot be written: "
            self.assertIn(said, self.refused("-output_dir", dir))
        home = {"environment": {"HOME": str(self.folder)}}
        self.assertIn("is no folder for results",
                      self.refused("-output_dir", ".", "-output_overwrite", **home))

    def test_a_folder_of_others(self):
        (self.folder / "work").mkdir()
        (self.folder / "work/notes.txt").write_text("mine")
        self.assertIn("output: dir: work is not empty and holds no run (it has 'notes.txt')",
                      self.refused(*SHORT, "-output_dir", "work"))
        self.floe(*SHORT, "-output_dir", "work", "-output_overwrite")
        self.assertEqual((self.folder / "work/notes.txt").read_text(), "mine")
        self.floe(*SHORT, "-output_dir", "work")  # it is a run's now

    def test_an_empty_one(self):
        (self.folder / "work").mkdir()
        self.floe(*SHORT, "-output_dir", "work")


class Inputs(RunningTest):
    def setUp(self):
        super().setUp()
        self.floe(*SHORT, "-output_dir", "keep")

    def test_lattice_file(self):
        scene = AFLOAT.replace("sheet: {length: 6, thickness: 0.5, element_size: 2, iterations: 5}",
                               "lattice_file: LATTICE")
        (self.folder / "link.h5").symlink_to("keep/lattice.h5")
        for name in ("keep/lattice.h5", "./keep/../keep/lattice.h5", "link.h5",
                     str(self.folder / "keep/lattice.h5")):
            self.write(scene.replace("LATTICE", name))
            for words in ([], ["-output_overwrite"]):
                said = self.refused(*SHORT, "-output_dir", "keep", *words)
                self.assertIn(f"lattice_file: {name} would be overwritten by the run's own "
                              "lattice.h5", said)
        self.floe(*SHORT, "-output_dir", "other")

    def test_mesh_file(self):
        self.assertIn("sheet: mesh_file: keep/checkpoint.h5 would be overwritten",
                      self.refused("-output_dir", "keep", "-sheet_mesh_file", "keep/checkpoint.h5"))
        self.floe(*SHORT, "-output_dir", "keep", "-sheet_mesh_file", "keep/mesh.h5")

    def test_obstacle(self):
        self.write(AFLOAT.replace("buoyancy]", "buoyancy, contact]")
                   + "obstacle: {names: [a], a: {shape: file, file: keep/lattice.h5}}\n")
        self.assertIn("obstacle", self.refused("-output_dir", "keep"))

    def test_a_scene_of_the_same_name(self):
        (self.folder / "keep/options.yaml").write_text(AFLOAT)
        self.assertIn("the run would overwrite its scene keep/options.yaml",
                      self.refused("-output_dir", "keep", scene="keep/options.yaml"))

    def test_options_yaml_repeats_its_run(self):
        before = self.files("keep")
        self.floe(scene="keep/options.yaml")
        after = self.files("keep")
        for name in ("history.csv", "options.yaml"):
            self.assertEqual(before["keep/" + name], after["keep/" + name], name)


class NotDone(RunningTest):
    def interrupted(self):
        process = self.running(rows=5)
        self.stop(process)

    def test_is_not_begun_anew(self):
        self.interrupted()
        for _ in range(2):
            said = self.refused()
            self.assertIn("out/scene has the checkpoint of a run that is not done (its status is "
                          "stopped); "
                          "-checkpoint_restart out/scene/checkpoint.h5 goes on with it, "
                          "-output_overwrite begins anew", said)
        (self.folder / "out/scene/summary.json").unlink()
        self.assertIn("(it was interrupted)", self.refused())
        (self.folder / "out/scene/summary.json").write_text("{")
        self.assertIn("(its summary cannot be read)", self.refused())

    def test_overwrite(self):
        self.interrupted()
        self.floe(*SHORT, "-output_overwrite")
        self.assertEqual(self.summary()["status"], "done")
        self.assertFalse((self.folder / "out/scene/checkpoint.h5").exists())
        self.assertNotIn("overwrite", (self.folder / "out/scene/options.yaml").read_text())

    def test_failed_counts(self):
        process = self.running("-checkpoint_every", "0.01")
        self.wait(process, (self.folder / "out/scene/checkpoint.h5").exists)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (20000, 20000))
        self.finish(process, FAILED)
        self.assertIn("(its status is failed)", self.refused())

    def test_done_and_without_a_checkpoint(self):
        """Running a scene twice is painless."""
        for words in (SHORT, [*SHORT, "-checkpoint_every", "100"]):
            for _ in range(2):
                self.floe(*words)
        self.floe(*SHORT, "-output_dir", "b")
        (self.folder / "b/summary.json").unlink()
        self.floe(*SHORT, "-output_dir", "b")


class MeshFile(RunningTest):
    def test_is_written_once_all_is_known_to_be_good(self):
        self.floe("-check", "-sheet_mesh_file", "mesh.h5")
        self.refused("-time_dt", "1000", "-sheet_mesh_file", "mesh.h5")
        self.assertEqual(sorted(self.files()), ["scene.yaml"])
        self.floe(*SHORT, "-sheet_mesh_file", "mesh.h5")
        self.assertTrue((self.folder / "mesh.h5").exists())

    def places(self, folder):
        with h5py.File(self.folder / folder / "lattice.h5") as file:
            return file["bodies/position"][:].tobytes()

    def test_four_runs_make_it_together(self):
        runs = [self.begin(*SHORT, "-sheet_mesh_file", "mesh.h5", "-output_dir", f"run{k}")
                for k in range(4)]
        for run in runs:
            self.finish(run)
        self.floe(*SHORT, "-sheet_mesh_file", "mesh.h5", "-output_dir", "again")
        places = {self.places(f) for f in ("run0", "run1", "run2", "run3", "again")}
        self.assertEqual(len(places), 1)
        self.assertEqual(list(self.folder.rglob("*.part")), [])

    def test_what_a_killed_run_left(self):
        dead = subprocess.Popen(["true"])
        dead.wait()
        left = self.folder / f"mesh.h5.{os.uname().nodename}.{dead.pid}.part"
        left.write_text("half")
        self.floe(*SHORT, "-sheet_mesh_file", "mesh.h5")
        self.assertFalse(left.exists())


class Failed(RunningTest):
    def check_failed(self, said, *words):
        """One line, and a summary that says the same and when."""
        self.assertEqual(said.count("\n"), 1, said)
        summary = self.summary()
        self.assertEqual(summary["status"], "failed")
        self.assertEqual(said, "floe: " + summary["message"] + "\n")
        for word in words:
            self.assertIn(word, said)
        for key in ("time", "steps", "ended", "version"):
            self.assertIn(key, summary)

    def limited(self, file, *words, ranks=1):
        """A run whose files may grow no more: what it says."""
        process = self.running(*words, ranks=ranks)
        size = (self.folder / "out/scene" / file).stat().st_size
        for victim in self.ranks_of(process):
            resource.prlimit(victim, resource.RLIMIT_FSIZE, (size, size))
        return self.finish(process, FAILED)

    def test_a_history_that_cannot_grow(self):
        for ranks in (1, 2):
            self.check_failed(self.limited("history.csv", "-output_overwrite", ranks=ranks),
                              "cannot write", "history.csv",
                              "File too large")

    def test_a_full_disk(self):
        """The room for the summary has been kept."""
        disk = self.folder / "out/scene"
        disk.mkdir(parents=True)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", disk],
                          capture_output=True).returncode:
            self.skipTest("cannot mount a small file system (root may)")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        process = self.running("-output_history", "0.001")
        # until it is full
        subprocess.run(["dd", "if=/dev/zero", f"of={disk}/filler", "bs=64K"], capture_output=True)
        self.check_failed(self.finish(process, FAILED), "history.csv", "No space left on device")

    def test_a_static_run(self):
        self.write(LOADED)
        self.check_failed(self.limited("history.csv"), "cannot write", "history.csv")

    def test_while_the_files_are_opened(self):
        self.floe(*SHORT)
        shutil.rmtree(self.folder / "out/scene", ignore_errors=True)
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (8000, 8000))
        self.check_failed(self.floe(*SHORT, code=FAILED, preexec_fn=limit), "cannot write")


if __name__ == "__main__":
    unittest.main()
