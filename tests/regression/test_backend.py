#!/usr/bin/python3
"""backend: the device's text in loops on the processor makes the runs of the processor; what is
not there yet is refused by name."""
import unittest

import numpy as np

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
FLOATING = HANGING.replace("gravity]", "gravity, buoyancy]")


class Backend(RunningTest):
    def history(self, dir):
        path = self.folder / dir / "history.csv"
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        return lines[0].split(","), np.loadtxt(lines[1:], delimiter=",")

    def test_runs_are_those_of_the_processor(self):
        """The same samples, works and energies too, to what rounding has grown to."""
        self.write(HANGING)
        for backend in ("cpu", "loop"):
            self.floe("-backend", backend, "-output_dir", backend)
        (names, cpu), (others, loop) = self.history("cpu"), self.history("loop")
        self.assertEqual(names, others)
        self.assertEqual(cpu.shape, (21, len(names)))
        for name, a, b in zip(names, cpu.T, loop.T):
            if name == "energy_balance_error":
                continue
            with self.subTest(column=name):
                self.assertLess(np.abs(a - b).max(), 1e-7 * np.abs(a).max() + 1e-12)
        for name in ("energy_damping", "energy_external", "energy_boundary"):
            self.assertGreater(np.abs(loop[:, names.index(name)]).max(), 0, name)
        self.assertIn(", steps by loop", (self.folder / "loop/floe.log").read_text())

    def test_steps_in_space(self):
        self.write(PULL)
        self.floe("-backend", "loop")
        self.assertIn("(backend: loop steps bodies in space)",
                      (self.folder / "out/scene/floe.log").read_text())

    def test_goes_on_from_either(self):
        """Stopped on the way, a run ends in the bits of one in one piece; a run of the processor
        goes on by the device's text, and back."""
        self.write(HANGING)
        for backend in ("cpu", "loop"):
            self.floe("-backend", backend, "-output_dir", backend)
        half = ("-ts_max_steps", "130")
        for first, then in (("loop", "loop"), ("cpu", "loop"), ("loop", "cpu")):
            dir = f"{first}_{then}"
            with self.subTest(dir):
                self.floe("-backend", first, "-output_dir", dir, "-checkpoint_every", "1000", *half)
                self.floe("-backend", then, "-output_dir", dir, "-checkpoint_restart",
                          f"{dir}/checkpoint.h5")
                names, straight = self.history(then)
                _, parts = self.history(dir)
                if first == then:
                    self.assertTrue((parts[-1] == straight[-1]).all())
                else:
                    for name, a, b in zip(names, straight.T, parts.T):
                        if name != "energy_balance_error":
                            self.assertLess(abs(a[-1] - b[-1]), 1e-7 * np.abs(a).max() + 1e-12)

    def test_a_speed_beyond_its_limit_ends_the_run(self):
        self.write(HANGING.replace("1e4", "1e7") + "limit: {velocity: 3}\n")
        said = self.floe("-backend", "loop", code=1)
        self.assertIn("a velocity of ", said)
        self.assertIn("(limit: velocity 3 m/s)", said)
        self.assertEqual(self.summary()["status"], "failed")

    def test_what_is_refused(self):
        for scene, words, said in (
                (FLOATING, (), "backend: loop has no force 'buoyancy' yet"),
                (HANGING, ("-backend", "cuda"), "backend: cuda: "),
                (HANGING, ("-backend", "loop", "-integrator", "implicit"),
                 "backend: makes explicit steps"),
                (HANGING, ("-backend", "loop", "-ts_type", "rk"),
                 "backend: loop makes steps of leapfrog"),
                (HANGING, ("-backend", "gpu"), "backend: gpu must be one of cpu | loop")):
            with self.subTest(said):
                self.write(scene)
                self.assertIn(said, self.refused(*(words or ("-backend", "loop"))))
        self.assertIn("backend: loop has no runs on several ranks yet",
                      self.floe("-backend", "loop", ranks=2, code=2))


if __name__ == "__main__":
    unittest.main()
