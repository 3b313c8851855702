#!/usr/bin/python3
"""What floe answers beside running scenes: usage, versions, help, tools, and names that are nearly
right."""
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from launch import (ENVIRONMENT, FLOE, REPOSITORY, FolderTest, in_short_form, on_ranks,
                    own_words)

SCENES = REPOSITORY / "input"
LOADER = Path("/lib64/ld-linux-x86-64.so.2")


def tools():
    """Names and lines of the tools, as floe help lists them."""
    text = subprocess.run([str(FLOE), "help"], capture_output=True, text=True, check=True).stdout
    return re.findall(r"^  (\w+) +(\S.*)$", text.split("Tools")[1], re.MULTILINE)


class CommandLine(FolderTest):
    def run_it(self, *words, ranks=1, code=0, floe=(FLOE,)):
        """Runs floe in the folder: its standard output and error."""
        run = subprocess.run(on_ranks(ranks, [*floe, *words]), cwd=self.folder, env=ENVIRONMENT,
                             capture_output=True,
                             text=True)
        self.assertEqual(run.returncode, code, f"{words}: {run.stdout}{run.stderr}")
        return run.stdout, own_words(run.stderr)

    def refused(self, *words, ranks=1):
        """The one line by which floe refuses."""
        out, error = self.run_it(*words, ranks=ranks, code=2)
        self.assertEqual(out, "")
        lines = error.splitlines()
        self.assertEqual(len(lines), 1, error)
        return lines[0]

    def test_no_words(self):
        for ranks in (1, 2):
            out, error = self.run_it(code=2, ranks=ranks)
            self.assertEqual(out, "")
            self.assertEqual(error.count("usage: floe SCENE.yaml"), 1)

    def test_version(self):
        text = self.run_it("--version")[0]
        lines = text.splitlines()
        self.assertRegex(lines[0], r"^floe \d+\.\d+\.\d+")
        for library in (r"PETSc 3\.\d+\.\d+", r"Open MPI v\d|MPICH", r"HDF5 1\.\d+\.\d+"):
            self.assertRegex(text, library)
        for word in ("-v", "-version", "version"):
            self.assertEqual(self.run_it(word)[0], text)
        self.assertEqual(self.run_it("--version", ranks=2)[0], text, "once, not per rank")

    def test_help(self):
        usage = self.run_it("--help")[0]
        self.assertLess(len(usage.splitlines()), 15)
        self.assertIn(str(SCENES), usage)
        self.assertEqual(self.run_it("-h")[0], usage)
        self.assertEqual(self.run_it(str(SCENES / "tension.yaml"), "-check", "--help")[0], usage)
        self.assertTrue(self.run_it("help")[0].startswith(usage))
        self.assertEqual(self.run_it("help", "options")[0], self.run_it("-help")[0])
        scenes = self.run_it("help", "scenes")[0]
        self.assertRegex(scenes, r"(?m)^  tension +Tension test of a square sheet$")
        for scene in SCENES.glob("*.yaml"):
            self.assertRegex(scenes, rf"(?m)^  {scene.stem} +\S")
        self.assertLess(max(map(len, scenes.splitlines()[1:])), 105)
        self.assertIn("the nearest one is 'plot_load'", self.refused("help", "plotload"))

    def test_every_tool_answers(self):
        table = tools()
        self.assertGreater(len(table), 5)
        for tool, _ in table:
            with self.subTest(tool=tool):
                self.assertTrue(os.access(REPOSITORY / "tools" / tool, os.X_OK))
                self.assertIn(tool, self.run_it(tool, "--help")[0])
                if in_short_form(tool, 3):  # floe help TOOL calls the same
                    self.assertIn(tool, self.run_it("help", tool)[0])

    def test_a_tool_gets_its_words(self):
        out = self.run_it("make_lattice", "block", "a b.h5")[0]
        self.assertEqual(out, "a b.h5: 1 bodies, 0 beams\n")
        self.assertIn("without mpiexec", self.refused("make_lattice", "block", "b.h5", ranks=2))
        self.assertFalse((self.folder / "b.h5").exists())

    def test_from_wherever_floe_is_called(self):
        (self.folder / "ice").symlink_to(FLOE)
        self.run_it("make_lattice", "block", "a.h5", floe=("./ice",))
        if LOADER.exists():
            self.run_it("make_lattice", "block", "b.h5", floe=(LOADER, FLOE))
        shutil.copy(FLOE, self.folder / "alone")
        (self.folder / "lib").symlink_to(FLOE.parent / "lib")
        error = self.run_it("plot_load", code=1, floe=("./alone",))[1]
        self.assertRegex(error, r"^floe plot_load: the tools that belong to \S*/alone are not "
                                r"there\n$")

    def test_a_file_is_a_scene(self):
        (self.folder / "render").write_text("sheet: 1\n")
        self.assertIn("sheet", self.refused("render"))
        out = subprocess.run([str(FLOE), "plot_load", "--help"], cwd=REPOSITORY / "tools",
                             capture_output=True, text=True)
        self.assertEqual(out.returncode, 0, "beside the tools themselves: " + out.stderr)

    def test_names_that_are_nearly_right(self):
        (self.folder / "mine.yaml").write_text("forces: [beam]\n")
        shipped = str(SCENES / "tension.yaml")
        for word, expected in {
                "plotload": "the nearest subcommand is 'plot_load'", "mine": "is it 'mine.yaml'?",
                "./mine": "is it './mine.yaml'?", "mine.yml": "is it 'mine.yaml'?",
            "mien.yaml": "is it 'mine.yaml'?",
                "tension": f"is it '{shipped}'?", "input/tension": f"is it '{shipped}'?",
                "input/tension.yaml": f"is it '{shipped}'?",
            "/nowhere/tension.yaml": f"is it '{shipped}'?",
                "tenson.yaml": f"is it '{shipped}'?",
            "qqqqqq": "floe help lists the subcommands"}.items():
            with self.subTest(word=word):
                self.assertIn(expected, self.refused(word))
        self.assertIn("'plot_load'", self.refused("plotload", ranks=2))

    def test_manual(self):
        page = self.run_it("-help_man")[0]
        self.assertTrue(page.startswith(".TH FLOE 1 "))
        for option in ("sheet_length", "boundary_NAME_fix"):
            self.assertIn(f"\n.B \\-{option}\n", page)
        for tool, line in tools():
            self.assertIn(f"\n.B {tool}\n{line}\n", page)
        if shutil.which("groff"):
            run = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=page,
                                 capture_output=True, text=True)
            self.assertEqual(run.stderr, "")


if __name__ == "__main__":
    unittest.main()
