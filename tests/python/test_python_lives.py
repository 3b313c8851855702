#!/usr/bin/python3
"""Simulations beside each other and one after the other, interrupts, failures, MPI's and PETSc's
lives."""
import json
import signal
import subprocess
import time
import unittest

from in_python import BEGIN, ENVIRONMENT, PythonTest
from coupled_scenes import CONE, LEG, assert_same_run

KEYS = "keys = BLOCKS\n"


class Beside(PythonTest):
    def test_two_at_once(self):
        """Two simulations stepped in turns are those stepped alone, each with its own options of
        PETSc, which do not stay behind."""
        self.scene(CONE)
        self.scene(LEG, "leg.yaml")
        for ranks in (1, 2):
            self.python("""
                import shutil
                for name in ("a", "b", "c", "a2", "b2", "c2"):
                    shutil.rmtree(name, ignore_errors=True)
                def make(name):
                    if name[0] == "a":
                        return floe.Simulation(floe.Scene("s.yaml", output_dir=name, time_end=0.1))
                    if name[0] == "b":
                        return floe.Simulation(floe.Scene("leg.yaml", output_dir=name,
                                                          ts_max_steps=250))
                    return floe.Simulation(floe.Scene({
                        "integrator": "implicit", "forces": ["beam"], "sheet": {"length": 6},
                        "time": {"end": 0.01, "dt": 0.001}}, output_dir=name, snes_rtol=1e-6,
                        name="c"))
                for name in ("a", "b", "c"):
                    make(name).run().close()
                sims = [make(name) for name in ("a2", "b2", "c2")]
                for k in range(1, 11):
                    for sim in sims:
                        sim.step_to(0.01 * k)
                assert sims[1].outcome["steps"] == 250
                for sim in reversed(sims):
                    sim.close()
            """, ranks=ranks)
            assert_same_run(self, self.folder / "a", self.folder / "a2")
            assert_same_run(self, self.folder / "b", self.folder / "b2")
            self.assertEqual((self.folder / "c/history.csv").read_bytes(),
                             (self.folder / "c2/history.csv").read_bytes())

    def test_options_of_petsc_are_checked(self):
        out = self.python(KEYS + """
for k, options in enumerate(({"ts_max_step": 3}, {"snes_rtol": 1e-3}, {"log_view": None},
                             {"ts_dt": -1})):
    try:
        sim = floe.Simulation(floe.Scene(keys, name=f"s{k}", **options))
        sim.step_to(0.01)
    except floe.InputError as error:
        print(error)
sim = floe.Simulation(floe.Scene(keys))
print(sim.step_to(0.01))
        """)
        for part in ("ts_max_step: nothing in this run has asked",
                     "snes_rtol: integrator: explicit",
                     "log_view: PETSc takes it once in a process",
                     "ts_dt: -1 must be a number > 0", "True"):
            self.assertIn(part, out)

    def test_a_folder_is_locked_until_its_simulation_is_closed(self):
        out = self.python(KEYS + """
first = floe.Simulation(floe.Scene(keys))
try:
    floe.Simulation(floe.Scene(keys))
except floe.InputError as error:
    print(error)
first = None   # dropped: the next one frees it
second = floe.Simulation(floe.Scene(keys))
second.close()
second.close()
try:
    second.step_to(1)
except ValueError as error:
    print(error)
        """)
        self.assertIn("out/scene", out)
        self.assertIn("the simulation is closed", out)


class Many(PythonTest):
    def test_many_steps_keep_memory(self):
        """1e4 calls of step_to, with looks at bodies, beams, contacts and states in memory."""
        self.python("""
            keys = {"integrator": "explicit", "forces": ["beam", "contact"],
                    "sheet": {"length": 4, "thickness": 0.5, "element_size": 2, "iterations": 5},
                    "time": {"end": 100, "dt": 1e-4}, "output": {"history": 10},
                    "contact": {"young": 1e6},
                    "obstacle": {"names": ["wall"], "wall": {"shape": "box",
                                 "centre": [10, 0, 0], "size": [1, 1, 1]}}}
            sim = floe.Simulation(floe.Scene(keys), coupled=["wall"])
            def use(calls):
                for k in range(calls):
                    sim.step_to(sim.time + 1e-4)
                    if k % 10 == 0:
                        sim["wall"].prescribe([10, 0, 0], [0, 0, 0], until=sim.time + 1e-3)
                        sim.bodies, sim.beams, sim.contacts, sim.energies, sim["wall"].wrench
                    if k % 50 == 0:
                        state = sim.save()
                        sim.restore(state)
            use(2000)
            before = memory()
            use(8000)
            assert memory() - before < 2, (before, memory())
        """)

    def test_many_simulations_keep_memory(self):
        """200 simulations, closed or dropped, leave nothing."""
        self.python(KEYS + """
import gc
def use(n):
    for k in range(n):
        sim = floe.Simulation(floe.Scene(keys, name="s", output_overwrite=True, ts_max_steps=3))
        sim.step_to(4e-4)
        sim.save()
        if k % 2:
            sim.close()
        del sim
    gc.collect()
use(60)
before = memory()
use(140)
from floe import library
assert library.compiled.alive() <= 1
assert memory() - before < 4, (before, memory())
""")

    def test_dropped_in_another_order_on_each_rank(self):
        self.python(KEYS + """
from floe import library
sims = [floe.Simulation(floe.Scene(keys, name=f"s{k}")) for k in range(4)]
order = [0, 1, 2, 3] if floe.rank() == 0 else [3, 1, 0, 2]
for k in order[:2]:
    sims[k] = None
last = sims[2 if floe.rank() == 0 else 2]
for sim in (sims[2],):
    sim.step_to(0.001)
assert library.compiled.alive() == 3, library.compiled.alive()   # 1 is dropped on both ranks
sims = None
last.step_to(0.002)
assert library.compiled.alive() == 1
# the last one is left to the end of Python
""", ranks=2)


class Ends(PythonTest):
    def test_failed_run(self):
        out = self.python(KEYS + """
keys["limit"] = {"velocity": 1e-3}
keys["initial"] = {"names": ["go"], "go": {"set": "all", "velocity": [1, 0, 0]}}
sim = floe.Simulation(floe.Scene(keys))
for _ in range(2):
    try:
        sim.run()
    except floe.RunFailed as error:
        print(error)
print(sim.ended, sim.results["status"])
sim.close()
        """)
        self.assertEqual(out.count("a velocity of 1 m/s at time"), 2)
        self.assertIn("True failed", out)

    def test_with_ends_a_run_before_its_end(self):
        self.python(KEYS + """
with floe.Simulation(floe.Scene(keys, name="early")) as sim:
    sim.step_to(0.05)
try:
    with floe.Simulation(floe.Scene(keys, name="error")) as sim:
        sim.step_to(0.05)
        raise ZeroDivisionError
except ZeroDivisionError:
    pass
left = floe.Simulation(floe.Scene(keys, name="left"))
left.step_to(0.05)
        """)
        for name, words in (("early", "by its program"), ("error", "ended by the program"),
                            ("left", "ended by the program")):
            summary = json.loads((self.folder / f"out/{name}/summary.json").read_text())
            self.assertIn(words, json.dumps(summary))

    def test_interrupt_of_one_rank(self):
        """A signal's exception on one rank pauses all of them, which get KeyboardInterrupt."""
        out = self.python(KEYS + """
import os, pathlib, signal, threading, time
class Stop(Exception):
    pass
def stop(*_):
    raise Stop
signal.signal(signal.SIGUSR1, stop)
keys["time"]["end"] = 1e5
keys["limit"] = {"frames": 1e12, "disk": 1e12}
keys["output"] = {"history": 0.1}
sim = floe.Simulation(floe.Scene(keys))
sim.step_to(0.01)
history = pathlib.Path("out/scene/history.csv")
def kill():
    while len(history.read_text().splitlines()) < 4:  # then step_to() is under way
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGUSR1)
if floe.rank() == 1:
    threading.Thread(target=kill).start()
try:
    sim.step_to(1e5)
except Stop:
    assert floe.rank() == 1
except KeyboardInterrupt:
    assert floe.rank() == 0
else:
    raise AssertionError
at = sim.time
assert sim.step_to(at + 0.01)
if floe.rank() == 0:
    print("on")
sim.close()
""", ranks=2)
        self.assertEqual(out, "on\n")

    def test_interrupt(self):
        """Ctrl-C comes out of a long step_to() between two steps; the simulation goes on."""
        (self.folder / "script.py").write_text(BEGIN + KEYS + """
keys["time"]["end"] = 1e5
keys["limit"] = {"frames": 1e12, "disk": 1e12}
keys["output"] = {"history": 0.1}
sim = floe.Simulation(floe.Scene(keys))
sim.step_to(0.01)
print("stepping", flush=True)
try:
    sim.step_to(1e5)
except KeyboardInterrupt:
    pass
else:
    raise AssertionError
at, step = sim.time, sim.outcome["steps"]
assert at > 0.01 and not sim.ended
assert sim.step_to(at + 0.01) and sim.time > at
print("on", flush=True)
sim.close()
""")
        process = subprocess.Popen(["/usr/bin/python3", "script.py"], cwd=self.folder, text=True,
                                   env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(self.end, process)
        self.assertEqual(process.stdout.readline(), "stepping\n")
        history = self.folder / "out/scene/history.csv"
        while process.poll() is None and len(history.read_text().splitlines()) < 4:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        out, error = process.communicate()
        self.assertEqual((out, process.returncode), ("on\n", 0), error)

    def test_mpi_of_mpi4py(self):
        """MPI that mpi4py has begun is used, and left to it; MPI that floe has begun serves mpi4py
        as well."""
        end = """
sim = floe.Simulation(floe.Scene(keys, name="m", output_overwrite=True))
sim.run()
assert MPI.COMM_WORLD.size == floe.size()
total = MPI.COMM_WORLD.allreduce(floe.rank() + 1)
assert total == floe.size() * (floe.size() + 1) // 2
"""
        for ranks in (1, 2):
            self.python("from mpi4py import MPI\n" + KEYS + end + """
try:
    MPI.COMM_WORLD.send(1, dest=100)   # errors of mpi4py's calls stay exceptions
except MPI.Exception:
    pass
else:
    raise AssertionError
""", ranks=ranks)
            self.python("floe.size()\nfrom mpi4py import MPI\n" + KEYS + end, ranks=ranks)

    def test_reading_needs_no_library(self):
        """Neither MPI nor the compiled module is loaded by the package alone."""
        done = subprocess.run(
            ["/usr/bin/python3", "-c", "import sys, floe; floe.open; print([name for name in "
             "sys.modules if name in ('floe._floe', 'mpi4py', 'pandas', 'numpy', 'matplotlib', "
             "'xarray')])"], env=ENVIRONMENT, capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.stdout, "[]\n", done.stderr)


if __name__ == "__main__":
    unittest.main()
