#!/usr/bin/python3
"""backend: contacts by the device's text, in loops on the processor, are those of the processor."""
import os
import subprocess
import unittest

import h5py
import numpy as np

from launch import REPOSITORY
from running import RunningTest

# A block that slides until friction stops it.
SLIDING = """integrator: explicit
forces: [gravity, contact]
lattice_file: block.h5
contact: {young: 1e7, friction: 0.2, restitution: 0.3}
obstacle:
  names: [floor]
  floor: {shape: halfspace, point: [0, 0, 0], normal: [0, 0, 1]}
initial: {names: [push], push: {set: all, velocity: [2, 0, 0]}}
time: {end: 1.5}
output: {history: 0.05}
"""
# Blocks that rise in water against a slope, and a wall that comes.
HEAP = """integrator: explicit
forces: [gravity, buoyancy, drag, contact]
lattice_file: heap.h5
water: {drag_linear: 200, drag_coefficient: 1}
contact: {law: potential, young: 5e6, friction: 0.3, friction_wet: 0.1, restitution: 0.3}
obstacle:
  names: [slope, wall]
  slope: {shape: halfspace, point: [0, 0, 0.55], normal: [0.4, 0, -1]}
  wall: {shape: box, centre: [-3.5, 0, 0], size: [1, 8, 8], velocity: [2, 0, 0], ramp: 0.2}
time: {end: 1}
output: {history: 0.02, fields: 0.5}
"""
# The same of ice that crushes and loses it.
WEARING = HEAP.replace("restitution: 0.3}", "restitution: 0.3, plastic_limit: 1e5}", 1)
# Two floes of beams, of which one drifts against the other.
FLOES = """integrator: explicit
forces: [beam, gravity, buoyancy, contact]
sheet: {length: 12, width: 6, thickness: 0.5, element_size: 1.5, iterations: 5}
beam: {damping_ratio: 0.1}
contact: {young: 4e8, friction: 0.1, restitution: 0.5}
region: {names: [west], west: {box: [-20, 0, -20, 20, -2, 2]}}
cut: {names: [saw], saw: {from: [0.01, -4], to: [0.01, 4]}}
initial: {names: [drift], drift: {set: west, velocity: [0.5, 0, 0]}}
time: {end: 0.1}
output: {history: 0.005}
"""
# A floe that drifts against a leg on springs, and a block that comes from behind and hits it.
LEG = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 8, width: 4, thickness: 0.5, element_size: 1.2, iterations: 5}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 2e5, shear_strength: 2e5, energy: 15}
water: {drag_linear: 200, drag_coefficient: 1}
contact: {young: 1e8, friction: 0.2, restitution: 0.3, plastic_limit: 5e5}
obstacle:
  names: [leg, block]
  leg:
    shape: box
    centre: [4.55, 0.2, 0.1]
    size: [1, 0.8, 2]
    mass: 3000
    touches: ice
    support_stiffness: [4e5, 4e5, 1e6, 2e6, 2e6, 2e6]
    support_damping_ratio: 0.05
  block: {shape: box, centre: [-4.7, 0.3, 0], size: [1.2, 1, 0.4], mass: 440, touches: ice}
initial: {names: [drift, kick], drift: {set: all, velocity: [0.8, 0, 0]},
          kick: {set: block, velocity: [2, 0, 0]}}
time: {end: 0.8}
output: {history: 0.01}
"""
# A sheet in one piece that drifts against a wall: the step is shorter once it is near.
NEARING = """integrator: explicit
forces: [beam, gravity, buoyancy, contact]
sheet: {length: 6, width: 4, thickness: 0.5, element_size: 1.5, iterations: 5}
beam: {damping_ratio: 0.1}
contact: {young: 4e9, friction: 0.1, restitution: 0.5}
obstacle:
  names: [wall]
  wall: {shape: halfspace, point: [3.1, 0, 0], normal: [-1, 0, 0]}
initial: {names: [drift], drift: {set: all, velocity: [1, 0, 0]}}
time: {end: 0.2}
output: {history: 0.01}
"""
MADE = {"block.h5": ("block", "--size", "1", "1", "0.2", "--height", "0.1"),
        "heap.h5": ("rubble", "--columns", "3", "2", "2", "--size", "1", "1", "0.5", "--spacing",
                    "1.6")}
# tools/check_gpu, on a machine with a device.
HAS_DEVICE = os.environ.get("FLOE_HAS_DEVICE") == "1"
DEVICES = ("loop", "cuda") if HAS_DEVICE else ("loop",)


class AlikeTest(RunningTest):
    def make(self, words, file):
        path = self.folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run([str(REPOSITORY / "tools/make_lattice"), *words, str(path)], check=True,
                       stdout=subprocess.DEVNULL)

    def history(self, dir):
        path = self.folder / dir / "history.csv"
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        return lines[0].split(","), np.loadtxt(lines[1:], delimiter=",")

    def alike(self, names, a, b, tolerance):
        """Columns to what rounding has grown to; the error of the balance is rounding itself."""
        self.assertEqual(a.shape, b.shape)
        energies = max(np.abs(column).max() for name, column in zip(names, a.T)
                       if name.startswith("energy_"))
        forces = max((np.abs(column).max() for name, column in zip(names, a.T)
                      if "_force_" in name or "_moment_" in name), default=1)
        for name, one, other in zip(names, a.T, b.T):
            if name == "energy_balance_error":
                continue
            scale = (energies if name.startswith("energy_") else
                     forces if "_force_" in name or "_moment_" in name else np.abs(one).max())
            with self.subTest(column=name):
                self.assertLess(np.abs(one - other).max(), tolerance * scale + 1e-12)

    def runs(self, scene, *words):
        self.write(scene)
        for backend in ("cpu", *DEVICES):
            self.floe("-backend", backend, "-output_dir", backend, "-output_overwrite", *words)
        return self.history("cpu")


class BackendContact(AlikeTest):
    def setUp(self):
        super().setUp()
        for file, words in MADE.items():
            self.make(words, file)

    def test_a_block_slides_until_it_stops(self):
        """v^2/(2 mu g), and the weight on the floor: as the processor has them, and theory."""
        names, cpu = self.runs(SLIDING)
        for backend in DEVICES:
            others, device = self.history(backend)
            self.assertEqual(names, others)
            self.alike(names, cpu, device, 1e-7)
            last = dict(zip(names, device[-1]))
            self.assertAlmostEqual(last["energy_friction"] / (0.5 * 184 * 4), 1, delta=0.01)
            self.assertAlmostEqual(last["floor_force_z"] / (-184 * 9.81), 1, delta=0.01)

    def test_a_heap_against_walls(self):
        """Bodies that collide in water, walls at rest and in motion: forces, largest and mean
        ones, works and energies; what is a contact is one in both."""
        names, cpu = self.runs(HEAP)
        for backend in DEVICES:
            others, device = self.history(backend)
            self.assertEqual(names, others)
            self.alike(names, cpu, device, 1e-5)
            for name in ("energy_friction", "energy_contact_viscous", "energy_external",
                         "wall_peak_force_x", "slope_mean_force_z", "energy_drag"):
                self.assertGreater(np.abs(device[:, names.index(name)]).max(), 0, name)
            self.assertEqual(list(device[:, names.index("contacts")]),
                             list(cpu[:, names.index("contacts")]))

    def test_floes_collide(self):
        names, cpu = self.runs(FLOES)
        for backend in DEVICES:
            self.alike(names, cpu, self.history(backend)[1], 1e-6)
            self.assertGreater(cpu[:, names.index("contacts")].max(), 1)

    def test_structures_on_springs_and_adrift(self):
        names, cpu = self.runs(LEG)
        column = {name: cpu[:, k] for k, name in enumerate(names)}
        for name in ("leg_force_x", "block_force_x", "energy_crushing", "energy_fracture"):
            self.assertGreater(np.abs(column[name]).max(), 0, name)
        for backend in DEVICES:
            others, device = self.history(backend)
            self.assertEqual(names, others)
            self.alike(names, cpu, device, 1e-6)

    def test_a_sheet_comes_near_a_wall(self):
        """The step becomes that of the processor, at the same time."""
        names, cpu = self.runs(NEARING)
        self.assertGreater(cpu[:, names.index("contacts")].max(), 0)
        for backend in DEVICES:
            self.alike(names, cpu, self.history(backend)[1], 1e-5)
            self.assertEqual(self.summary(backend)["steps"], self.summary("cpu")["steps"])

    def test_goes_on_from_either(self):
        """Stopped on the way, a run ends as one in one piece; a run of the processor goes on by the
        device's text, and back."""
        for scene in (HEAP, WEARING):
            self.go_on(scene)
        with h5py.File(self.folder / "loop_loop/checkpoint.h5") as file:
            self.assertGreater(len(file["force_3_contact/worn"]), 0)

    def go_on(self, scene):
        self.runs(scene)
        for first, then in (pair for device in DEVICES
                            for pair in ((device, device), ("cpu", device), (device, "cpu"))):
            dir = f"{first}_{then}"
            with self.subTest(dir):
                self.floe("-backend", first, "-output_dir", dir, "-checkpoint_every", "1000",
                          "-ts_max_steps", "600")
                self.floe("-backend", then, "-output_dir", dir, "-checkpoint_restart",
                          f"{dir}/checkpoint.h5")
                (names, straight), (_, parts) = self.history(then), self.history(dir)
                rows = parts[np.isin(parts[:, 0], straight[:, 0])]
                self.alike(names, straight, rows, 1e-10 if first == then else 1e-5)

    def test_what_is_refused(self):
        for scene, said in (
                (HEAP.replace("fields: 0.5", "fields: 0.5, pressure: 0.5"), "output: pressure"),
                (LEG.replace("touches: ice", "touches: all"),
                 "contact of structures with other obstacles ('touches: ice' is without)")):
            with self.subTest(said):
                self.write(scene)
                self.assertIn(f"backend: loop has no {said} yet", self.refused("-backend", "loop"))


if __name__ == "__main__":
    unittest.main()
