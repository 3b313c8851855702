#!/usr/bin/python3
"""Runs of more steps than 32 bits count: they begin, go on over 2^31 and end like others."""
import json
import unittest

import h5py
import numpy as np

from sealed import changed
from small_scenes import AFLOAT
from test_restart import RestartTest

SMALL = AFLOAT + "checkpoint: {every: 1000}\n"
END = ("-time_end", "200000", "-output_history", "0.001")
FAR = 2**31 - 250  # steps


class LongRuns(RestartTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(SMALL)

    def summary(self, dir):
        return json.loads((self.folder / dir / "summary.json").read_text())

    def test_one_begins(self):
        self.run_whole(*END, "-ts_max_steps", "100", dir="a")
        summary = self.summary("a")
        self.assertGreater(summary["dt"], 0)
        self.assertGreater(200000 / summary["dt"], 2**31)
        self.assertEqual((summary["status"], summary["steps"]), ("done", 100))

    def test_a_restart_crosses_the_limit(self):
        """As if 2^31 - 250 steps had been made before the checkpoint."""
        for options in ((), ("-ts_type", "rk", "-ts_rk_type", "4")):
            self.run_whole(*END, *options, "-ts_max_steps", "600", dir="a")
            self.run_whole(*END, *options, "-ts_max_steps", "200", dir="b")
            with changed(self.folder / "b/checkpoint.h5") as file:
                for name in ("step", "steps", "step_base", "sampled_step", "last_look"):
                    file["run"][name][...] = file["run"][name][...] + FAR
            self.go_on(*END, *options, "-ts_max_steps", str(FAR + 600), dir="b")
            self.assertEqual(self.summary("b")["steps"], FAR + 600)
            self.assertGreater(FAR + 600, 2**31)
            with h5py.File(self.folder
                           / "a/checkpoint.h5") as a, h5py.File(self.folder
                                                                / "b/checkpoint.h5") as b:
                self.assertEqual(a["run/time"][()], b["run/time"][()])
                self.assertEqual(a["run/step"][()] + FAR, b["run/step"][()])
                np.testing.assert_array_equal(a["bodies/records"][()], b["bodies/records"][()])


if __name__ == "__main__":
    unittest.main()
