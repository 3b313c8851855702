#!/usr/bin/python3
"""Output folders in which something stands in the way: one line that names it, exit code 2, and
nothing is touched; what goes wrong during a run is one line, exit code 1, and a summary that says
so."""
import os
import shutil
import subprocess
import unittest

from launch import ENVIRONMENT, FLOE, in_short_form, own_words
from running import AFLOAT, FAILED, RunningTest

FILES = ("summary.json", "lattice.h5", "options.yaml", "fields.h5", "fields.xmf", "history.csv",
         "checkpoint.h5",
         "checkpoint_previous.h5", "breaks.h5", "floe.log")
SHORT = ("-time_end", "0.01")
NOBODY = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups"]


class HostileFolder(RunningTest):
    def setUp(self):
        super().setUp()
        self.write(AFLOAT)
        self.out = self.folder / "out/scene"
        self.out.mkdir(parents=True)

    def refused_for(self, name, *words):
        """As in a folder of an earlier run and in one of somebody else, at one rank and two."""
        (self.out / ".lock").write_text("floe run 1\n")
        for ranks in (1, 2) if in_short_form(name, 4) else (1,):
            said = self.refused(*SHORT, ranks=ranks)
            self.assertTrue(said.startswith("floe: output: dir: 'out/scene' cannot be used: its "
                                            + name), said)
            for word in words:
                self.assertIn(word, said)
        path = self.out / name
        path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()

    def test_folders_in_place_of_files(self):
        for name in FILES:
            with self.subTest(name):
                (self.out / name).mkdir()
                self.refused_for(name, "is a folder", "needs the name for a file")

    def test_a_file_in_place_of_a_folder(self):
        (self.out / "fields").write_text("mine")
        self.refused_for("fields", "is a file", "needs the name for a folder")

    def test_pipes(self):
        """Opening one would wait for a reader for ever."""
        for name in FILES:
            with self.subTest(name):
                os.mkfifo(self.out / name)
                (self.out / ".lock").write_text("floe run 1\n")
                done = subprocess.run([FLOE, "scene.yaml", *SHORT], cwd=self.folder,
                                      capture_output=True, text=True,
                                      env=ENVIRONMENT)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(f"its {name} is a pipe", own_words(done.stderr))
                (self.out / name).unlink()

    def test_links(self):
        for to, word in (("/dev/full", "is a link to a device"),
                         ("/dev/null", "is a link to a device"),
                         ("/nonexist/x", "leads nowhere"), ("history.csv", "symbolic links")):
            (self.out / "history.csv").symlink_to(to)
            (self.out / ".lock").write_text("floe run 1\n")
            done = subprocess.run([FLOE, "scene.yaml", *SHORT], cwd=self.folder,
                                  capture_output=True, text=True, env=ENVIRONMENT)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("its history.csv", done.stderr)
            (self.out / "history.csv").unlink()

    def test_a_check_says_so_too(self):
        (self.out / "history.csv").mkdir()
        done = subprocess.run([FLOE, "scene.yaml", "-check"], cwd=self.folder, capture_output=True,
                              text=True, env=ENVIRONMENT)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("but a run would be refused now: output: dir: 'out/scene' cannot be used: "
                      "its history.csv is a folder",
                      done.stdout)

    def test_inputs_among_the_frames(self):
        self.floe(*SHORT)
        shutil.copy(self.out / "lattice.h5", self.out / "fields/mine.h5")
        self.write(AFLOAT.replace("sheet: {length: 6, thickness: 0.5, element_size: 2, iterations: "
                                  "5}",
                                  "lattice_file: out/scene/fields/mine.h5"))
        self.assertIn("lattice_file: out/scene/fields/mine.h5 would be overwritten by the run's "
                      "own fields", self.refused(*SHORT))

    def as_nobody(self, *words):
        """What an ordinary user is told."""
        command = [*(NOBODY if os.geteuid() == 0 else []), FLOE, "scene.yaml", *SHORT, *words]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True,
                              env={**ENVIRONMENT, "HOME": "/nonexistent"})
        if "setpriv" in done.stderr or done.returncode in (126, 127):
            self.skipTest("nobody may not run this build of floe: " + done.stderr)
        return done.returncode, own_words(done.stderr)

    def open_to_all(self):
        self.folder.chmod(0o755)
        (self.folder / "out").chmod(0o777)
        self.out.chmod(0o777)

    @unittest.skipUnless(os.geteuid() != 0 or shutil.which("setpriv"),
                         "root may become somebody else")
    def test_permissions(self):
        self.open_to_all()
        code, said = self.as_nobody()
        self.assertEqual(code, 0, said)
        before = self.files()
        self.out.chmod(0o555)
        self.assertEqual(self.as_nobody(), (2,
                                            "floe: output: dir: out/scene cannot be written: "
                                            f"{self.out}: Permission denied\n"))
        self.out.chmod(0o777)
        for name, mode in (("history.csv", 0o444), ("fields", 0o555)):
            (self.out / name).chmod(mode)
            code, said = self.as_nobody()
            self.assertEqual(code, 2, said)
            self.assertIn(f"its {name} may not be changed: Permission denied", said)
            self.assertEqual(said.count("\n"), 1)
            (self.out / name).chmod(0o777)
        self.assertEqual(before, self.files())

    @unittest.skipUnless(os.geteuid() != 0 or shutil.which("setpriv"),
                         "root may become somebody else")
    def test_a_folder_that_may_not_be_made(self):
        self.folder.chmod(0o755)
        self.out.rmdir()
        (self.folder / "out").chmod(0o555)
        self.addCleanup((self.folder / "out").chmod, 0o755)
        code, said = self.as_nobody()
        self.assertEqual((code, said.count("\n")), (2, 1), said)
        self.assertIn("Permission denied", said)

    def test_a_read_only_file_system(self):
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "ro", "tmpfs", self.out],
                          capture_output=True).returncode:
            self.skipTest("cannot mount a file system (root may)")
        self.addCleanup(subprocess.run, ["umount", self.out], check=True)
        self.assertEqual(self.refused(*SHORT),
                         f"floe: output: dir: out/scene cannot be written: {self.out}: "
                         "Read-only file system\n")

    def test_what_becomes_bad_during_a_run(self):
        """fields is taken away: one line, and a summary that says it."""
        process = self.running("-output_fields", "0.01", "-output_overwrite", "-limit_frames",
                               "1e12", "-limit_disk", "1e12")
        while True:
            try:
                shutil.rmtree(self.out / "fields")
                break
            except OSError:
                continue
        (self.out / "fields").write_text("mine")
        said = self.finish(process, FAILED)
        self.assertEqual(said.count("\n"), 1, said)
        summary = self.summary()
        self.assertEqual((summary["status"], "floe: " + summary["message"] + "\n"),
                         ("failed", said))

    def test_a_history_that_somebody_empties(self):
        """No hole in front of the rows that follow."""
        process = self.running("-output_overwrite")
        history = self.out / "history.csv"
        os.truncate(history, 0)
        self.wait(process, lambda: history.stat().st_size > 1000)
        self.stop(process)
        self.assertNotIn(b"\0", history.read_bytes())


if __name__ == "__main__":
    unittest.main()
