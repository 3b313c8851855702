#!/usr/bin/python3
"""backend: the device's text in loops on the processor makes the runs of the processor; what is
not there yet is refused by name."""
import os
import unittest

import h5py
import numpy as np

from interposed import library
from running import RunningTest
from small_scenes import PULL

# A damped sheet that bends under its weight and a load, pulled at its right edge.
HANGING = """forces: [beam, gravity]
integrator: explicit
sheet: {length: 8, width: 5, thickness: 0.5, element_size: 1, iterations: 5}
beam: {damping_ratio: 0.1}
boundary:
  names: [held, pulled]
  held: {set: left, fix: x y z rx ry rz}
  pulled: {set: right, fix: x, velocity: [0.01, 0, 0], ramp: 0.02}
load: {names: [dead], dead: {point: [2, 1], force: [0, 0, -1e4], ramp: 0.05}}
time: {end: 0.1}
output: {history: 0.005, fields: 0.05}
"""
# It floats in a current, the water's level rises, submerged parts are found every third step.
FLOATING = HANGING.replace("gravity]", "gravity, buoyancy, drag]") + """water:
  pace: 3
  level_table: level.csv
  drag_coefficient: 1
  drag_linear: 50
  current: [0.3, 0, 0]
"""
SUPPLIED = """forces: [beam, gravity, buoyancy, drag]
integrator: explicit
sheet: {length: 8, width: 5, thickness: 0.5, element_size: 1, iterations: 5}
beam: {damping_ratio: 0.1}
water: {drag_linear: 50}
boundary: {names: [edge], edge: {set: left, fix: x y z rx ry rz, velocity: [1, 0, 0]}}
supply: {strip: 8, length: 32}
time: {end: 0.1}
"""
# Its beams soften and break.
BREAKING = HANGING.replace("[beam, gravity]", "[beam, gravity, fracture]").replace(
    "-1e4", "-1e5") + """fracture:
  tensile_strength: 5e5
  shear_strength: 5e5
  energy: 15
"""
CRUSHED = HANGING.replace("[beam, gravity]", "[beam, gravity, fracture]").replace(
    "[0.01, 0, 0]", "[-0.1, 0, 0]") + """fracture:
  tensile_strength: 5e5
  shear_strength: 5e5
  compressive_strength: 1e6
  flexural_strength: 6e5
  energy: 150
"""
# Pieces are stiffer than the sheet, so the step becomes shorter when the first beam breaks.
HARD_PIECES = """integrator: explicit
forces: [beam, fracture, contact]
sheet: {length: 8, width: 5, thickness: 0.3, element_size: 1.2, iterations: 10, seed: 77}
fracture: {tensile_strength: 50000, energy: 5}
contact: {young: 1e7, young_broken: 2e8}
load: {names: [l0], l0: {point: [1, 0.5], force: [0, 0, -3e4], ramp: 0.03}}
time: {end: 0.1}
output: {history: 0.005}
"""
# tools/check_gpu, on a machine with a device.
HAS_DEVICE = os.environ.get("FLOE_HAS_DEVICE") == "1"
DEVICES = ("loop", "cuda") if HAS_DEVICE else ("loop",)


class Backend(RunningTest):
    def history(self, dir):
        path = self.folder / dir / "history.csv"
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        return lines[0].split(","), np.loadtxt(lines[1:], delimiter=",")

    def alike(self, names, a, b):
        """Columns to what rounding has grown to; the error of the balance is rounding itself."""
        for name, one, other in zip(names, a.T, b.T):
            if name != "energy_balance_error":
                with self.subTest(column=name):
                    self.assertLess(np.abs(one - other).max(), 1e-7 * np.abs(one).max() + 1e-12)

    def write(self, scene):
        super().write(scene)
        (self.folder / "level.csv").write_text("time,level\n0,0\n0.2,0.05\n")

    def test_runs_are_those_of_the_processor(self):
        """The same samples, works and energies too."""
        for scene, works in ((HANGING, ("damping", "external", "boundary")),
                             (FLOATING, ("damping", "external", "boundary", "drag")),
                             (BREAKING, ("damping", "external", "boundary", "fracture")),
                             (CRUSHED, ("damping", "boundary", "fracture"))):
            self.write(scene)
            for backend in ("cpu", *DEVICES):
                self.floe("-backend", backend, "-output_dir", backend, "-output_overwrite")
            names, cpu = self.history("cpu")
            self.assertEqual(cpu.shape, (21, len(names)))
            for backend in DEVICES:
                others, device = self.history(backend)
                self.assertEqual(names, others)
                self.alike(names, cpu, device)
                for name in works:
                    self.assertGreater(np.abs(device[:, names.index(f"energy_{name}")]).max(), 0)
                self.assertIn(f", steps by {backend}",
                              (self.folder / backend / "floe.log").read_text())
                if "fracture" in works:
                    self.same_breaks(backend, 5)

    def same_breaks(self, backend, least):
        with h5py.File(self.folder / "cpu/breaks.h5") as one, \
                h5py.File(self.folder / backend / "breaks.h5") as other:
            self.assertGreater(len(one["beam"]), least)
            for name in ("beam", "bodies", "brittle", "time"):
                self.assertTrue((one[name][()] == other[name][()]).all(), name)
            for name in ("energy", "mode_mix", "nominal_energy", "place"):
                a, b = one[name][()], other[name][()]
                self.assertLess(np.abs(a - b).max(), 1e-9 * np.abs(a).max(), name)

    def test_steps_in_space(self):
        self.write(PULL)
        self.floe("-backend", "loop")
        self.assertIn("(backend: loop steps bodies in space)",
                      (self.folder / "out/scene/floe.log").read_text())

    def test_goes_on_from_either(self):
        """Stopped on the way, a run ends in the bits of one in one piece; a run of the processor
        goes on by the device's text, and back."""
        for scene in (FLOATING, BREAKING):
            self.write(scene)
            self.go_on_from_either()

    def go_on_from_either(self):
        for backend in ("cpu", *DEVICES):
            self.floe("-backend", backend, "-output_dir", backend, "-output_overwrite")
        for first, then in (pair for device in DEVICES
                            for pair in ((device, device), ("cpu", device), (device, "cpu"))):
            dir = f"{first}_{then}"
            with self.subTest(dir):
                self.floe("-backend", first, "-output_dir", dir, "-output_overwrite",
                          "-checkpoint_every", "1000", "-ts_max_steps", "130")
                self.floe("-backend", then, "-output_dir", dir, "-checkpoint_restart",
                          f"{dir}/checkpoint.h5")
                (names, straight), (_, parts) = self.history(then), self.history(dir)
                if first == then:
                    # Works too: checkpoints keep the parts of their sums.
                    self.assertTrue((parts[-1] == straight[-1]).all())
                    self.assertEqual(self.summary(dir)["energy"], self.summary(then)["energy"])
                else:
                    self.alike(names, straight, parts[np.isin(parts[:, 0], straight[:, 0])])

    def test_a_speed_beyond_its_limit_ends_the_run(self):
        self.write(HANGING.replace("1e4", "1e7") + "limit: {velocity: 3}\n")
        said = self.floe("-backend", "loop", code=1)
        self.assertIn("a velocity of ", said)
        self.assertIn("(limit: velocity 3 m/s)", said)
        self.assertEqual(self.summary()["status"], "failed")

    def test_a_state_beyond_the_limits_gets_no_checkpoint(self):
        """Also where a run is asked to stop between two looks at the speeds, after a blow that
        comes with its second sample."""
        self.write(HANGING.replace("force: [0, 0, -1e4], ramp: 0.05", "table: blow.csv")
                   + "limit: {velocity: 3}\n")
        (self.folder / "blow.csv").write_text("time,fz\n0,0\n0.00495,0\n0.005,-1e9\n1,-1e9\n")
        said = self.floe("-backend", "loop", code=1,
                         environment={**library(self.folder), "TEST_TERM_AT_ROW": "3"})
        self.assertIn("(limit: velocity 3 m/s)", said)
        self.assertFalse((self.folder / "out/scene/checkpoint.h5").exists())

    def test_a_beam_breaks_where_the_step_changes(self):
        """The step after that is the processor's: bodies whose beams break in it may touch, too."""
        self.write(HARD_PIECES)
        counts = {}
        for backend in ("cpu", *DEVICES):
            self.floe("-backend", backend, "-output_dir", backend)
            names, rows = self.history(backend)
            counts[backend] = [rows[:, names.index(name)] for name in ("beams_broken", "contacts")]
            summary = self.summary(backend)
            self.assertGreater(abs(summary["steps"] * summary["dt"] - 0.1), 2 * summary["dt"])
        self.assertGreater(counts["cpu"][0][-1], 40)
        for backend in DEVICES:
            for one, other in zip(counts["cpu"], counts[backend]):
                self.assertEqual(list(one), list(other))

    def test_what_is_refused(self):
        for scene, words, said in (
                (BREAKING + "  propagation: energy\n", (),
                 "backend: loop has no fracture: propagation: energy yet"),
                (SUPPLIED, (), "supply: backend: loop steps a lattice that stays as it is"),
                *(() if HAS_DEVICE else (  # whatever else the scene has
                    (HANGING, ("-backend", "cuda"), "backend: cuda: "),
                    (FLOATING.replace("drag_coefficient: 1", "drag: faces\n  drag_form: 1"),
                     ("-backend", "cuda"), "backend: cuda: "))),
                (HANGING, ("-backend", "loop", "-integrator", "implicit"),
                 "backend: makes explicit steps"),
                (HANGING, ("-backend", "loop", "-ts_type", "rk"),
                 "backend: loop makes steps of leapfrog"),
                (HANGING, ("-backend", "loop", "-ts_type", "alpha"),
                 "backend: loop makes steps of leapfrog"),
                (FLOATING.replace("drag_coefficient: 1", "drag: faces\n  drag_form: 1"), (),
                 "backend: loop has no water: drag: faces yet"),
                (HANGING.replace("gravity]", "gravity, buoyancy]") +
                 "waves: {height: 0.2, period: 5}\n", (), "backend: loop has no waves yet"),
                (HANGING, ("-backend", "gpu"), "backend: gpu must be one of cpu | loop")):
            with self.subTest(said):
                self.write(scene)
                self.assertIn(said, self.refused(*(words or ("-backend", "loop"))))
        self.assertIn("backend: loop has no runs on several ranks yet",
                      self.floe("-backend", "loop", ranks=2, code=2))


if __name__ == "__main__":
    unittest.main()
