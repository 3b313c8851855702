#!/usr/bin/python3
"""What asks a run to stop from outside, and what must not end it: signals, closed pipes."""
import os
import signal
import subprocess
import unittest

from launch import ENVIRONMENT, FLOE, on_ranks, own_words
from running import STOPPED, RunningTest
from small_scenes import AFLOAT, LOADED

ALL = ("SIGTERM", "SIGINT", "SIGHUP", "SIGUSR1", "SIGUSR2", "SIGXCPU")
LONG_SET_UP = AFLOAT.replace("iterations: 5",
                             "iterations: 1000000").replace("length: 6", "length: 30")


class Signals(RunningTest):
    def check_stopped(self, said):
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("stopped on request at time", said)
        self.assertEqual(self.summary()["status"], "stopped")

    def test_each_leaves_a_checkpoint(self):
        for name in ALL:
            with self.subTest(name):
                process = self.running("-output_overwrite")
                process.send_signal(getattr(signal, name))
                self.check_stopped(self.finish(process, STOPPED))
                self.assertTrue((self.folder / "out/scene/checkpoint.h5").exists())

    def test_twice_and_more(self):
        """Who presses Ctrl-C again still gets the checkpoint."""
        for name in ("SIGINT", "SIGTERM"):
            process = self.running("-output_overwrite")
            for _ in range(5):
                process.send_signal(getattr(signal, name))
            self.check_stopped(self.finish(process, STOPPED))
            self.assertTrue((self.folder / "out/scene/checkpoint.h5").exists())

    def test_one_rank_of_two(self):
        process = self.running(ranks=2)
        os.kill(self.ranks_of(process)[-1], signal.SIGUSR1)
        self.check_stopped(self.finish(process, STOPPED))

    def test_through_mpiexec(self):
        """mpiexec hands SIGUSR1 on and gives the exit code back."""
        process = self.running(ranks=2)
        process.send_signal(signal.SIGUSR1)
        self.check_stopped(self.finish(process, STOPPED))

    def test_nohup(self):
        ignore = lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = self.running(preexec_fn=ignore)
        process.send_signal(signal.SIGHUP)
        history = self.folder / "out/scene/history.csv"
        rows = history.read_text().count("\n")
        self.wait(process, lambda: history.read_text().count("\n") > 2 * rows)
        self.stop(process)

    def test_a_static_run(self):
        self.write(LOADED)
        for ranks in (1, 2):
            process = self.running(ranks=ranks)
            process.send_signal(signal.SIGUSR1)
            said = self.finish(process, STOPPED)
            self.assertIn("stopped on request at time", said)
            summary = self.summary()
            self.assertEqual(summary["status"], "stopped")
            self.assertGreater(summary["steps"], 10)

    def test_during_set_up(self):
        self.write(LONG_SET_UP)
        for ranks in (1, 2):
            process = self.begin(ranks=ranks)
            self.wait(process, lambda: (self.folder / "out/scene/.lock").exists())
            process.send_signal(signal.SIGUSR1)
            said = self.finish(process, STOPPED)
            self.assertEqual(said, "floe: stopped on request before the first state; "
                                   "nothing has been written\n")
            self.assertEqual(sorted(self.files()), ["scene.yaml"])


class Pipes(RunningTest):
    def test_a_reader_that_leaves(self):
        """floe SCENE | head -1: the run goes on to its end."""
        for ranks in (1, 2):
            command = " ".join(map(str, on_ranks(ranks, [FLOE, "scene.yaml", "-time_end", "2"])))
            done = subprocess.run(["bash", "-c", f"{command} | head -1; exit ${{PIPESTATUS[0]}}"],
                                  cwd=self.folder,
                                  capture_output=True, text=True, env=ENVIRONMENT)
            self.assertEqual(done.stdout.count("\n"), 1)
            self.assertEqual(own_words(done.stderr), "")
            self.assertEqual(done.returncode, 0)
            self.assertEqual(self.summary()["status"], "done")

    def test_closed_from_the_start(self):
        done = subprocess.run([FLOE, "scene.yaml", "-time_end", "1"], cwd=self.folder,
                              env=ENVIRONMENT,
                              preexec_fn=lambda: (os.close(1), os.close(2)))
        self.assertEqual(done.returncode, 0)
        self.assertEqual(self.summary()["status"], "done")


if __name__ == "__main__":
    unittest.main()
