#!/usr/bin/python3
"""Values of PETSc's own options that floe cannot use end with one line that names the option and
what is allowed, with exit code 2 and before anything is made, at 1 and at 2 ranks, on the command
line and in the environment."""
import subprocess
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from launch import ENVIRONMENT, FLOE, FULL, in_short_form, on_ranks, own_words

STATIC = """forces: [beam]
sheet: {length: 10, thickness: 1, element_size: 3, iterations: 5}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [p], p: {set: right, force: [1e5, 0, 0]}}
"""
MOVING = "integrator: implicit\n" + STATIC + "time: {end: 0.01}\n"

CASES = [(STATIC, "snes_lag_jacobian", "0", "-2"), (STATIC, "snes_max_it", "-1", ">= 1"),
         (STATIC, "snes_rtol", "nan", "< 1"), (STATIC, "snes_rtol", "-1", ">= 0"),
         (STATIC, "snes_atol", "-1", ">= 0"),
         (STATIC, "mat_mumps_icntl_7", "99", "one of 0 | 2 | 3"),
         (STATIC, "mat_type", "dense", "sbaij"),
         (STATIC, "snes_view", "ascii:/nonexist/x", "no folder '/nonexist'"),
         (STATIC, "log_view", "abc:x", "hdf5"), (STATIC, "ksp_rtol", "inf", "< 1"),
         (STATIC, "check_pointer_intensity", "3", "<= 2"), (MOVING, "ts_max_steps", "-5", ">= 0"),
         (MOVING, "ts_adapt_clip", "3,2", "shrink"), (MOVING, "ts_adapt_safety", "9", "<= 1"),
         (MOVING, "ts_max_time", "-1", "> 0"), (MOVING, "ts_atol", "nan", ">= 0"),
         (MOVING, "ts_dt", "nan", "> 0"),
         (MOVING, "ts_view", "abc", "viewers")]

# What PETSc alone finds: while it begins, while its solvers are set up, or in the first solve.
OF_PETSC = [("ksp_type", "conjugate"), ("snes_type", "abc"), ("pc_type", "abc"),
            ("snes_monitor", "abc"), ("fp_trap", "abc"),
            ("ksp_error_if_not_converged", "abc"), ("malloc_debug", "abc"), ("device_enable", "3"),
            ("mat_mumps_view_info", "99"),
            ("snes_linesearch_type", "abc")]
# What makes PETSc crash, or start something that floe has not.
USELESS = [("snes_monitor_fields", ""), ("snes_monitor_ksp", ""), ("snes_monitor_python", "x"),
           ("ksp_type", "python"),
           ("ksp_view_diagonal_scale", ""), ("ts_save_trajectory", "")]


class Values(unittest.TestCase):
    def run_with(self, scene, words, environment, ranks):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "s.yaml").write_text(scene)
            done = subprocess.run(on_ranks(ranks, [str(FLOE), "s.yaml", *words]), cwd=folder,
                                  capture_output=True, text=True,
                                  timeout=600, env={**ENVIRONMENT, **environment})
            return done.returncode, own_words(done.stderr).strip().splitlines(), Path(folder,
                                                                                      "out").exists(
                                                                                          )

    def check(self, ranks):
        for scene, option, value, allowed in CASES:
            if ranks > 1 and not in_short_form(option, 4):
                continue
            with self.subTest(option=option, value=value):
                code, lines, made = self.run_with(scene, ["-" + option, value], {}, ranks)
                self.assertEqual((code, len(lines), made), (2, 1, False), lines)
                for word in (option, value.removeprefix("ascii:"), allowed):
                    self.assertIn(word, lines[0])

    def test_on_one_rank(self):
        self.check(1)

    def test_on_two_ranks(self):
        self.check(2)

    def refused(self, option, value, words, ranks=1):
        code, lines, made = self.run_with(STATIC, words, {}, ranks)
        self.assertEqual((code, len(lines), made), (2, 1, False), (option, value, lines))
        self.assertTrue(lines[0].startswith(f"floe: {option}"), lines)
        return lines[0]

    def test_what_petsc_finds(self):
        for option, value in OF_PETSC:
            for ranks in (1, 2) if in_short_form(option, 4) else (1,):
                with self.subTest(option=option, value=value, ranks=ranks):
                    said = self.refused(option, value, ["-" + option, value], ranks)
                    self.assertIn(f"{option} {value}: PETSc cannot take it: ", said)

    def test_of_several_the_right_one_is_named(self):
        said = self.refused("snes_monitor", "abc",
                            ["-ksp_rtol", "1e-9", "-snes_monitor", "abc", "-snes_stol", "1e-9"])
        self.assertNotIn("ksp_rtol", said)

    def test_what_is_of_no_use(self):
        for option, value in USELESS:
            with self.subTest(option=option):
                self.refused(option, value, ["-" + option, *([value] if value else [])])

    def test_petscs_handler_is_asked_for_wrongly(self):
        """An option that hands errors to PETSc is itself in error."""
        for value in ("abc", "[nan, 0, 0]"):
            self.refused("on_error_abort", value, ["-on_error_abort", value])

    def test_a_long_value_is_cut(self):
        said = self.refused("ksp_view_mat", "", ["-ksp_view_mat", "1 " * 200])
        self.assertLess(len(said), 400)

    def test_windows_need_a_display(self):
        for words in (["-ksp_view", "draw"], ["-snes_monitor", "draw::draw_lg"],
                      ["-snes_monitor_lg_residualnorm"]):
            with self.subTest(words=words):
                with unittest.mock.patch.dict(ENVIRONMENT, {"DISPLAY": ""}):
                    said = self.refused(words[0][1:], "", words)
                self.assertIn("no display to draw on (DISPLAY is not set)", said)
        for words in (["-draw_type", "image"], ["-draw_type", "null"], ["-nox"]):
            with self.subTest(words=words):
                code, lines, _ = self.run_with(STATIC, ["-snes_monitor", "draw::draw_lg", *words],
                                               {"DISPLAY": ""}, 1)
                self.assertEqual((code, lines), (0, []))

    def test_files_of_a_refused_run_go(self):
        """PETSc makes them while it begins, in the first solve or at its end."""
        unknown = ("-eps_type", "-snes_bogus", "-snes_type")
        files = (["-citations", "c"], ["-info", "i"], ["-log_view", ":l"],
                 ["-ksp_view_mat", "binary:m"], ["-snes_view", "ascii:v"],
                 ["-log_trace", "t"], ["-log_summary", "s"], ["-log_all"], ["-log_all", "a"])
        for ranks in (1, 2):
            for words in files if ranks == 1 or FULL else files[::3]:
                for reason in unknown if ranks == 1 else unknown[1:2]:
                    with (self.subTest(words=words, reason=reason, ranks=ranks),
                          tempfile.TemporaryDirectory() as folder):
                        Path(folder, "s.yaml").write_text(STATIC)
                        done = subprocess.run(
                            on_ranks(ranks, [str(FLOE), "s.yaml", *words, reason]), cwd=folder,
                            capture_output=True, text=True, timeout=600, env=ENVIRONMENT)
                        self.assertEqual(done.returncode, 2, done.stderr)
                        self.assertEqual(sorted(p.name for p in Path(folder).iterdir()), ["s.yaml"])

    def test_files_that_were_there_are_not_taken_away(self):
        """PETSc has written over this one in the first solve, as the option asks."""
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "s.yaml").write_text(STATIC)
            Path(folder, "m").write_text("mine")
            done = subprocess.run([str(FLOE), "s.yaml", "-ksp_view_mat", "binary:m",
                                   "-snes_bogus"], cwd=folder, capture_output=True, text=True,
                                  timeout=600, env=ENVIRONMENT)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(sorted(p.name for p in Path(folder).iterdir()), ["m", "s.yaml"])

    def test_in_the_environment(self):
        code, lines, made = self.run_with(STATIC, [], {"PETSC_OPTIONS": "-snes_rtol nan"}, 1)
        self.assertEqual((code, len(lines), made), (2, 1, False), lines)
        self.assertIn("snes_rtol", lines[0])

    def test_good_values_are_taken(self):
        for words in (["-snes_rtol", "1e-11"], ["-mat_type", "aij", "-pc_type", "lu"],
                      ["-snes_lag_jacobian", "-2"],
                      ["-mat_mumps_icntl_7", "0"]):
            code, lines, _ = self.run_with(STATIC, words, {}, 1)
            self.assertEqual(code, 0, lines)


if __name__ == "__main__":
    unittest.main()
