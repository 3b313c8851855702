#!/usr/bin/python3
"""Out of memory and crashes: one line, exit code 1, and a summary that says failed."""
import functools
import os
import resource
import shutil
import signal
import subprocess
import unittest
from datetime import datetime, timedelta, timezone

from interposed import library
from launch import ENVIRONMENT, FLOE, on_ranks, own_words
from running import FAILED, RunningTest
from small_scenes import AFLOAT

STATIC = """forces: [beam]
sheet: {length: 120, thickness: 1, element_size: 1, iterations: 2}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [b], b: {set: right, force: [0, 0, 1e3]}}
"""
LIMITED = ("import resource, os, sys; n = int(sys.argv[1]); "
           "resource.setrlimit(resource.RLIMIT_AS, (n, n)); os.execv(sys.argv[2], sys.argv[2:])")


@functools.cache
def has_sanitizers():
    """Whether floe cannot even say its version in 2 GiB of address space: sanitizers take
    terabytes."""
    size = 2 << 30
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size))
    return subprocess.run([FLOE, "--version"], capture_output=True, env=ENVIRONMENT,
                          preexec_fn=limit).returncode != 0


class OutOfMemory(RunningTest):
    def limited(self, megabytes, *words, ranks=1):
        """A run in so much address space per process: its exit code and what it says."""
        command = ["/usr/bin/python3", "-c", LIMITED, str(megabytes << 20), str(FLOE), "scene.yaml",
                   *words, "-output_overwrite"]
        done = subprocess.run(on_ranks(ranks, command), cwd=self.folder, capture_output=True,
                              text=True, env=ENVIRONMENT)
        return done.returncode, own_words(done.stderr)

    def test_one_line(self):
        """From little to almost enough. Where MPI finds too little to begin, its libraries complain
        too. Two ranks get more: in less than that Open MPI's own start hangs or aborts."""
        if has_sanitizers():
            self.skipTest("a build with sanitizers")
        for scene, ranks in ((STATIC, 1), (STATIC, 2),
                             (STATIC + "integrator: implicit\ntime: {end: 1e-3}\n", 1)):
            self.write(scene)
            ended = []
            for megabytes in (260, 340, 420, 500, 580)[2 * (ranks > 1):]:
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                code, said = self.limited(megabytes, ranks=ranks)
                ended.append(code)
                with self.subTest(ranks=ranks, megabytes=megabytes, said=said):
                    self.assertIn(code, (0, FAILED))
                    starts = ("crashed at the start", "failed to map segment")
                    if code == 0 or any(words in said for words in starts):
                        continue
                    self.assertEqual(said.count("\n"), 1)
                    self.assertTrue(said.startswith("floe: out of memory"))
                    if (self.folder / "out").exists():  # else it failed while it read the scene
                        self.assertEqual(self.summary()["status"], "failed")
            self.assertIn(FAILED, ended)

    def test_of_mumps(self):
        """Told to take less than it needs."""
        self.write(STATIC)
        said = self.floe("-mat_mumps_icntl_23", "1", code=FAILED)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("out of memory: the factorisation of the tangent needs more (MUMPS says "
                      "INFOG(1) = ", said)
        self.assertEqual(self.summary()["status"], "failed")


class Close(RunningTest):
    def test_of_each_result(self):
        """A network disk may say only when a file is closed that it is full."""
        self.write(AFLOAT.replace("100000", "0.02") + "checkpoint: {every: 600}\n")
        environment = library(self.folder)
        for name in ("options.yaml", "lattice.h5", "fields/", "fields.xmf", "history.csv",
                     "checkpoint"):
            with self.subTest(name=name):
                said = self.floe("-output_overwrite", code=FAILED,
                                 environment={**environment, "TEST_NO_CLOSE": name})
                self.assertEqual(said.count("\n"), 1, said)
                self.assertIn(name, said)
                self.assertIn("Disk quota exceeded", said)
                self.assertEqual(self.summary()["status"], "failed")


class Crash(RunningTest):
    SIGNALS = {signal.SIGSEGV: "segmentation fault", signal.SIGBUS: "bus error",
               signal.SIGFPE: "arithmetic exception",
               signal.SIGABRT: "aborted by a library", signal.SIGILL: "illegal instruction"}

    def test_one_line(self):
        if has_sanitizers():
            self.skipTest("sanitizers have handlers of their own")
        for number, what in self.SIGNALS.items():
            for ranks in (1, 2):
                with self.subTest(signal=number, ranks=ranks):
                    process = self.running("-output_overwrite", ranks=ranks)
                    os.kill(self.ranks_of(process)[-1], number)
                    said = self.finish(process, FAILED)
                    self.assertEqual(said.count("\n"), 1, said)
                    self.assertRegex(said, rf"^floe: crashed after time \S+, step \d+: {what}.*; "
                                           r"this is an error in floe or in a "
                                           "library: please report it")
                    summary = self.summary()
                    self.assertEqual((summary["status"], "floe: " + summary["message"] + "\n"),
                                     ("failed", said))
                    if ranks == 1:
                        self.assertIn(said, (self.folder / "out/scene/floe.log").read_text())

    def test_in_the_allocator(self):
        """Nobody can allocate any more, so the last words do not either."""
        if has_sanitizers():
            self.skipTest("sanitizers have handlers and an allocator of their own")
        self.write(AFLOAT)
        before = datetime.now(timezone.utc).replace(microsecond=0)
        said = self.floe(code=FAILED, environment={**library(self.folder),
                                                   "TEST_CRASH_AT_ROW": "20"})
        summary = self.summary()
        self.assertEqual("floe: " + summary.pop("message") + "\n", said)
        self.assertRegex(said, r"crashed after time \S+, step \d+: segmentation fault; ")
        ended, started = (datetime.fromisoformat(summary.pop(key)) for key in ("ended", "started"))
        self.assertLessEqual(before, started)
        self.assertLessEqual(started, ended)
        self.assertLess(ended, before + timedelta(minutes=20))
        self.assertGreater(summary.pop("time"), 0)
        self.assertGreater(summary.pop("steps"), 0)
        self.assertEqual(summary, {"status": "failed", "ranks": 1, "host": os.uname().nodename,
                                   "version": summary["version"]})
        self.assertIn(said, (self.folder / "out/scene/floe.log").read_text())

    def test_petsc_may_be_asked(self):
        """Its traces for whoever wants them, or the system's own end."""
        if has_sanitizers():
            self.skipTest("sanitizers have handlers of their own")
        process = self.running("-on_error_abort", "-output_overwrite")
        os.kill(process.pid, signal.SIGSEGV)
        process.communicate()
        self.assertNotEqual(process.returncode, 0)
        process = self.running("-no_signal_handler", "-output_overwrite")
        os.kill(process.pid, signal.SIGSEGV)
        process.communicate()
        self.assertEqual(process.returncode, -signal.SIGSEGV)


if __name__ == "__main__":
    unittest.main()
