#!/usr/bin/python3
"""backend: loop makes the scenes of input/verify as the processor: forces, breaks, contacts."""
import unittest

from launch import REPOSITORY
from test_backend_contact import DEVICES, AlikeTest

SCENES = REPOSITORY / "input/verify"
# A scene with other words, and to what its columns agree. Those that are not here have no explicit
# steps, or something that back ends do not have (docs/devices.md).
WORDS = {"drag_decay": ((), 1e-9),
         "free_flight": (("-model_planar", "false"), 1e-9),
         "free_top": ((), 1e-9),
         "heave": ((), 1e-9),
         "ice_slope": ((), 1e-7),
         "stopping": ((), 1e-7),
         "vibrating": ((), 1e-9),
         "wave": (("-time_end", "0.02"), 1e-9)}


class Scenes(AlikeTest):
    def test_scenes_of_verification(self):
        for name, (words, tolerance) in WORDS.items():
            scene = (SCENES / f"{name}.yaml").read_text()
            make = scene.splitlines()[0].split("&&")[0].split()[3:]  # floe make_lattice KIND ...
            with self.subTest(name):
                self.make(make[:-1], make[-1])
                names, cpu = self.runs(scene, *words)
                for backend in DEVICES:
                    self.alike(names, cpu, self.history(backend)[1], tolerance)
                    self.assertEqual(self.summary(backend)["steps"],
                                     self.summary("cpu")["steps"])


if __name__ == "__main__":
    unittest.main()
