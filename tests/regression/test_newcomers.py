#!/usr/bin/python3
"""What helps who is new to floe: numbers in other units are asked about, a scene says how its
lattice file is made, the last line says where the results are."""
import csv
import re
import shutil
import subprocess
import unittest

import launch

FLOATING = """forces: [beam, gravity, buoyancy]
sheet: {length: 12, thickness: 0.5, element_size: 2, iterations: 5}
"""
WARNING = "floe: warning: "


class NewcomerTest(launch.FolderTest):
    def run_scene(self, *words, code=0, ranks=1):
        done = launch.run("scene.yaml", *words, cwd=self.folder, ranks=ranks)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done


class Units(NewcomerTest):
    """The tables of usual numbers: tests/unit/test_units.cpp."""

    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(FLOATING)

    def warnings(self, *words, **how):
        lines = self.run_scene(*words, **how).stderr.splitlines()
        self.assertTrue(all(line.startswith(WARNING) for line in lines), lines)
        return [line.removeprefix(WARNING) for line in lines]

    def test_usual_numbers(self):
        self.assertEqual(self.warnings("-check"), [])

    def test_unusual_ones_are_one_line_each(self):
        for ranks in (1, 2):
            for words in (("-check",), ()):
                said = self.warnings("-ice_young", "4", "-ice_density", "0.92", *words, ranks=ranks)
                self.assertEqual(said, ["ice: density: 0.92 kg/m^3 is unusual for ice at sea (100 "
                                        "to 2000 kg/m^3): is it "
                                        "meant in g/cm^3?",
                                        "ice: young: 4 Pa is unusual for ice at sea (1e+06 to "
                                        "1e+11 Pa): is it meant in GPa?"])

    def test_a_sheet_that_sinks_by_its_units_is_asked_about(self):
        said = self.run_scene("-water_density", "1.01", "-check", code=2).stderr
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("or the sheet sinks; water: density: is it meant in g/cm^3?", said)


class LatticeFiles(NewcomerTest):
    def test_scenes_say_the_command_that_makes_theirs(self):
        """And it is the right one: with the file that it makes, or that is kept with the scenes
        because that takes minutes, the scene is valid."""
        scenes = [path for path in sorted((launch.REPOSITORY / "input").rglob("*.yaml"))
                  if re.search(r"^lattice_file:", path.read_text(), re.M)]
        self.assertGreater(len(scenes), 10)
        for path in scenes:
            with self.subTest(path.name):
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                shutil.copy(path, self.folder / "scene.yaml")
                said = self.run_scene("-check", code=2).stderr
                self.assertEqual(said.count("\n"), 1, said)
                found = re.fullmatch(r"floe: lattice_file: '(\S+)' is not there; make it with: "
                                     r"(?:floe input/\w+.yaml && )?floe (make_.*)\n", said)
                self.assertIsNotNone(found, said)
                self.assertIn(found[1], found[2].split())
                if (launch.REPOSITORY / found[1]).exists():
                    (self.folder / found[1]).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(launch.REPOSITORY / found[1], self.folder / found[1])
                else:
                    subprocess.run([launch.FLOE, *found[2].split()], cwd=self.folder, check=True,
                                   capture_output=True)
                self.run_scene("-check")

    def test_another_file(self):
        (self.folder / "scene.yaml").write_text("forces: [beam]\nlattice_file: mine.h5\n")
        for ranks in (1, 2):
            said = self.run_scene(code=2, ranks=ranks).stderr
            self.assertEqual(said, "floe: lattice_file: 'mine.h5' is not there; "
                                   "floe make_lattice --help tells how to make one\n")


class Words(NewcomerTest):
    def test_words_of_a_choice_in_capitals(self):
        (self.folder / "scene.yaml").write_text("model: {planar: False}\n" + FLOATING)
        for value in ("False", "FALSE", "auto"):
            self.run_scene("-model_planar", value, "-check")
        said = self.run_scene("-model_planar", "True", "-check", code=2).stderr
        self.assertIn("model: planar: true leaves out what this scene needs", said)

    def test_help_of_a_section_and_of_a_key(self):
        def said(*words, code=0):
            done = launch.run("-help", *words, cwd=self.folder)
            self.assertEqual(done.returncode, code, done.stderr)
            return done.stdout + done.stderr
        section = re.findall(r"^  (-\w+)", said("sheet"), re.M)
        self.assertIn("-sheet_mesh_file", section)
        self.assertTrue(all(key.startswith("-sheet_") for key in section), section)
        for name in ("sheet_length", "sheet: length"):
            self.assertEqual(re.findall(r"^  (-\w+)", said(name), re.M), ["-sheet_length"])
        self.assertIn("there is no section or key shett", said("shett", code=2))
        # PETSc's families, and where they are explained
        for name in ("snes", "snes_rtol"):
            self.assertRegex(said(name), r"petsc\.org.*\n(.*\n)*  -snes_rtol +>= 0, < 1\n")
        self.assertNotIn("-ts_dt", said("snes"))
        self.assertIn("petsc.org", said("dm"))


class Results(NewcomerTest):
    def test_the_last_line_says_where_they_are(self):
        (self.folder / "scene.yaml").write_text(FLOATING)
        for words, where in (((), "out/scene"), (("-output_dir", "elsewhere"), "elsewhere")):
            last = self.run_scene(*words).stdout.splitlines()[-1]
            self.assertEqual(last, f"results: {where}/ (summary.json, history.csv, floe.log; "
                                   "fields.xmf for ParaView)")
            for name in ("summary.json", "history.csv", "fields.xmf"):
                self.assertTrue((self.folder / where / name).exists())


class ReadMe(NewcomerTest):
    def test_the_scene_of_ones_own(self):
        """README's three lines, and the number that it gives."""
        readme = (launch.REPOSITORY / "README.md").read_text()
        scene = re.search(r"`mine.yaml`:.*?\n\n((?:    [^\n]*\n)+)", readme, re.S)[1]
        sinks = float(re.search(r"he sinks by (\S+) mm", readme)[1])
        (self.folder / "scene.yaml").write_text("".join(line[4:] for line in
                                                        scene.splitlines(keepends=True)))
        self.run_scene()
        with open(self.folder / "out/scene/history.csv", newline="") as file:
            row = list(csv.DictReader(file))[-1]
        self.assertEqual(round(-1e3 * float(row["man_load_displacement_z"]), 2), sinks)


if __name__ == "__main__":
    unittest.main()
