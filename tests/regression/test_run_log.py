#!/usr/bin/python3
"""floe.log: what a run says, in its output folder too."""
import re
import subprocess
import unittest

from launch import ENVIRONMENT, FLOE, on_ranks, own_words
from running import FAILED, STOPPED, RunningTest
from small_scenes import LOADED

SHORT = ("-time_end", "0.5")


class RunLog(RunningTest):
    def log(self):
        return (self.folder / "out/scene/floe.log").read_text()

    def run_with(self, *words, ranks=1, **how):
        return subprocess.run(on_ranks(ranks, [FLOE, "scene.yaml", *words]), cwd=self.folder,
                              env=ENVIRONMENT, text=True, **how)

    def test_has_what_the_terminal_has(self):
        for ranks in (1, 2):
            done = self.run_with(*SHORT, "-output_dir", "out/scene", ranks=ranks,
                                 capture_output=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            head, body = self.log().split("\nhost: ")
            version = subprocess.run([FLOE, "--version"], capture_output=True, text=True,
                                     env=ENVIRONMENT).stdout.split()[1]
            self.assertRegex(head, rf"^floe {re.escape(version)}, "
                                   rf"\d{{4}}-\d\d-\d\dT\d\d:\d\d:\d\d\S*\ncommand: "
                                   r"\S*floe scene.yaml "
                                   r"-time_end 0.5 -output_dir out/scene\nfolder: ")
            first, rest = body.split("\n", 1)
            self.assertIn(f"{ranks} rank", first)
            self.assertIn("library for ", first)
            said, last = rest.rsplit("ended ", 1)
            self.assertEqual(own_words(said), done.stdout)
            self.assertRegex(last, r"^\d{4}-\S+ with exit code 0\n$")
            self.assertIn("floe.log", done.stdout.splitlines()[-1])

    def test_has_what_petsc_prints_and_errors(self):
        self.write(LOADED)
        done = self.run_with("-snes_monitor", "-time_dt", "1", "-snes_view", "-log_view",
                             capture_output=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        for line in done.stdout.splitlines():
            self.assertIn(line, self.log())
        self.assertIn("SNES Function norm", self.log())
        done = self.run_with("-time_dt", "1", "-snes_max_it", "1", "-snes_rtol", "1e-14",
                             "-load_b_force", "0,0,1e7",
                             capture_output=True)
        self.assertEqual(done.returncode, FAILED)
        self.assertIn(done.stderr, self.log())

    def test_goes_on(self):
        process = self.running("-output_dir", "out/scene", "-checkpoint_every", "1e9")
        self.stop(process)
        first = self.log()
        self.assertTrue(first.endswith(f"with exit code {STOPPED}\n"))
        self.floe("-checkpoint_restart", "out/scene/checkpoint.h5", "-time_end", "1e5",
                  "-ts_max_steps", "1")
        both = self.log()
        self.assertTrue(both.startswith(first + "\n---- the run goes on ----\nfloe "), both)
        self.assertEqual(both.count("ended "), 2)
        self.floe(*SHORT, "-output_overwrite")
        self.assertEqual(self.log().count("ended "), 1)  # another run

    def test_closed_streams(self):
        """Files must not take the numbers of what is closed, or what is printed would go into
        them."""
        self.run_with(*SHORT, capture_output=True)
        good = {name: (self.folder / "out/scene" / name).read_bytes()
                for name in ("history.csv", "options.yaml")}
        said = self.log().split("\nhost: ")[1].split("\n", 1)[1]
        for closed in ("<&-", ">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"):
            done = subprocess.run(f"exec {FLOE} scene.yaml -time_end 0.5 {closed}", shell=True,
                                  cwd=self.folder, env=ENVIRONMENT,
                                  capture_output=True)
            self.assertEqual(done.returncode, 0, (closed, done.stderr))
            for name, text in good.items():
                self.assertEqual((self.folder / "out/scene" / name).read_bytes(), text,
                                 (closed, name))
            lines = [line for line in said.splitlines()
                     if not line.startswith(("wall", "ended", "plan"))]
            for line in lines:
                self.assertIn(line, self.log(), closed)

    def test_a_refused_run_leaves_it(self):
        self.floe(*SHORT)
        before = self.files()
        self.floe("-time_end", "-1", code=2)
        self.floe("-check")
        self.assertEqual(before, self.files())


if __name__ == "__main__":
    unittest.main()
