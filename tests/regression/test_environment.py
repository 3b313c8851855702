#!/usr/bin/python3
"""Options that lie around (PETSC_OPTIONS, petscrc files) change no key of a scene and stop no run;
those of PETSc's families are taken from there, below the scene and the command line, and named in
the first line. Scenes with more options than PETSc's own table holds run.
"""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()

SCENE = """forces: [beam]
sheet: {length: 10, thickness: 1, element_size: 3, iterations: 5}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [p], p: {set: right, force: [1e5, 0, 0]}}
"""


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "home").mkdir()

    def run_floe(self, scene, *words, ranks=1, code=0, **variables):
        (self.folder / "s.yaml").write_text(scene)
        launcher = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
        run = subprocess.run([*launcher, str(FLOE), "s.yaml", *words], cwd=self.folder,
                             capture_output=True, text=True,
                             env={**os.environ, "HOME": str(self.folder / "home"), **variables})
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run

    def bodies(self):
        return json.loads((self.folder / "out/s/summary.json").read_text())["bodies"]


class Environment(Case):
    def test_scene_keys_are_not_taken_and_foreign_options_do_not_stop(self):
        self.run_floe(SCENE)
        plain, history = self.bodies(), (self.folder / "out/s/history.csv").read_text()
        (self.folder / ".petscrc").write_text("-sheet_length 20\n-integrator explicit\n"
                                              "-my_option 3\n-options_file none\n")
        (self.folder / "home/.petscrc").write_text("junk that is no option\n-forces\n")
        for ranks in (1, 2):
            run = self.run_floe(SCENE, ranks=ranks,
                                PETSC_OPTIONS="-sheet_thickness 7 stray -ts_type bdf -help")
            self.assertNotIn("floe:", run.stderr)  # progress may be there: the machine may be slow
            first = run.stdout.splitlines()[0]
            self.assertIn("options of the environment: none taken; not taken: ", first)
            self.assertIn("-integrator (.petscrc, line 2)", first)
            self.assertEqual(self.bodies(), plain)
        self.run_floe(SCENE)
        self.assertEqual((self.folder / "out/s/history.csv").read_text(), history)

    def test_petsc_options_are_taken_below_scene_and_command_line(self):
        def line_of(name, *words, scene=SCENE, **variables):
            self.run_floe(scene, *words, **variables)
            options = (self.folder / "out/s/options.yaml").read_text().splitlines()
            return next((line for line in options if line.startswith(name + ":")), "")

        (self.folder / "home/.petscrc").write_text("-snes_rtol 1e-3 # at home\n-snes_max_it 33\n")
        self.assertEqual(line_of("snes_rtol"), "snes_rtol: 1e-3")
        (self.folder / ".petscrc").write_text("-snes_rtol 1e-4\n")
        self.assertEqual(line_of("snes_rtol"), "snes_rtol: 1e-4")
        self.assertEqual(line_of("snes_rtol", PETSC_OPTIONS="-snes_rtol 1e-5"), "snes_rtol: 1e-5")
        scene = SCENE + "snes_rtol: 1e-6\n"
        self.assertEqual(line_of("snes_rtol", PETSC_OPTIONS="-snes_rtol 1e-5", scene=scene),
                         "snes_rtol: 1e-6")
        self.assertEqual(line_of("snes_rtol", "-snes_rtol", "1e-7", scene=scene), "snes_rtol: 1e-7")
        self.assertEqual(line_of("snes_max_it"), "snes_max_it: 33")
        self.assertEqual(line_of("snes_rtol", "-skip_petscrc"), "")
        self.assertEqual(line_of("snes_rtol", "-skip_petscrc", "no"), "snes_rtol: 1e-4")

    def test_they_act(self):
        """PETSc's own log, which PETSc decides on while it begins, by each of the ways."""
        def logs(*words, scene=SCENE, ranks=1, **variables):
            return "Performance Summary" in self.run_floe(scene, *words, ranks=ranks,
                                                          **variables).stdout

        self.assertFalse(logs())
        self.assertTrue(logs("-log_view"))
        self.assertTrue(logs(scene=SCENE + "log_view:\n"))
        for ranks in (1, 2):
            self.assertTrue(logs(ranks=ranks, PETSC_OPTIONS="-log_view"))
        (self.folder / "petscrc").write_text("-log_view\n")
        self.assertTrue(logs())
        self.assertFalse(logs("-skip_petscrc"))

    def test_solver_options_do_not_stop_a_run_without_solver(self):
        moving = "integrator: explicit\nbeam: {damping_ratio: 1}\ntime: {end: 0.001}\n" + SCENE
        run = self.run_floe(moving,
                            PETSC_OPTIONS="-ksp_monitor -ksp_type cg -fieldsplit_0_pc_type lu "
                                          "-ts_rtol 1e-3")
        self.assertIn("not taken: -ksp_monitor (PETSC_OPTIONS), -ksp_type (PETSC_OPTIONS), "
                      "-ts_rtol (PETSC_OPTIONS)",
                      run.stdout.splitlines()[0])
        run = self.run_floe(moving, "-ksp_type", "cg", code=2)
        self.assertIn("ksp_type", run.stderr)


class ManyOptions(Case):
    def test_more_than_petscs_table_holds(self):
        """255 cuts and 130 obstacles: 900 options."""
        cuts = [f"c{k}" for k in range(255)]
        obstacles = [f"o{k}" for k in range(130)]
        scene = ("integrator: explicit\nforces: [beam, contact]\n"
                 "sheet: {length: 10, element_size: 1, iterations: 5}\n")
        scene += f"cut:\n  names: [{', '.join(cuts)}]\n"
        for k, name in enumerate(cuts):
            at = -3 + 6 * k / len(cuts)
            x = -4 + (k % 4) * 2
            ends = ((-6, at), (6, at)) if k == 0 else ((x, at), (x + 0.001, at + 0.5))
            scene += f"  {name}: {{from: {list(ends[0])}, to: {list(ends[1])}}}\n"
        scene += f"obstacle:\n  names: [{', '.join(obstacles)}]\n"
        for k, name in enumerate(obstacles):
            place = f"centre: [{20 + 2 * k}, 0, 0]"
            scene += f"  {name}: {{shape: box, {place}, velocity: [0.1, 0, 0], ramp: 1}}\n"
        scene += "time: {end: 1e-4}\n"
        for ranks in (1, 2):
            # Cuts that cross no beam any more are no error under another sheet.
            run = self.run_floe(scene, "-sheet_seed", "2", ranks=ranks)
            self.assertNotIn("floe:", run.stderr)
            yaml = (self.folder / "out/s/options.yaml").read_text()
            self.assertIn("  o129:\n    shape: box\n", yaml)

    def test_too_many_for_petsc(self):
        words = [word for k in range(500) for word in (f"-ksp_a{k}", "1")]
        run = self.run_floe(SCENE, *words, code=2)
        self.assertEqual(len(run.stderr.splitlines()), 1)
        self.assertIn("more than 400 options of PETSc's", run.stderr)


if __name__ == "__main__":
    unittest.main()
