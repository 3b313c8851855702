#!/usr/bin/python3
"""model: rotational_inertia_factor: what rests stays as it is, at a longer step; ice that breaks
keeps its energy balance and its restarts."""
import csv
import json
import sys
import unittest

from launch import REPOSITORY, FolderTest, run

sys.path.insert(0, str(REPOSITORY / "tools"))
sys.path.insert(0, str(REPOSITORY / "python"))
import floe_precision as precision  # noqa: E402

FACTOR = "-model_rotational_inertia_factor"
# A short sheet that breaks at a slope.
BREAKING = (str(REPOSITORY / "input/ice_slope.yaml"), "-sheet_length", "16", "-sheet_width", "6",
            "-obstacle_slope_point", "8.1,0,-0.4554", "-boundary_push_velocity", "1,0,0",
            "-water_current", "1,0,0", "-output_history", "0.1", "-output_fields", "3")


class RotationalInertia(FolderTest):
    def floe(self, *words, dir="out", ranks=1, code=0):
        """What a run said; its summary if it ended well."""
        done = run(*map(str, words), "-output_dir", dir, ranks=ranks, cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stderr)
        if code:
            return done.stderr
        return json.loads((self.folder / dir / "summary.json").read_text())

    def rows(self, dir):
        with open(self.folder / dir / "history.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_what_rests(self):
        """A damped floating sheet under a load settles where statics say, as without the factor
        (its last motion: 1e-5), at a step more than 1.4 times as long."""
        case = precision.bending()
        scene = self.folder / "scene.yaml"
        scene.write_text(case.make(self.folder, 4))
        static = self.floe(scene, "-integrator", "quasistatic", "-snes_rtol", "1e-13")
        one = self.floe(scene, *case.moving)
        four = self.floe(scene, *case.moving, FACTOR, "4")
        for moved in (one, four):
            self.assertLess(abs(moved["deflection_max"] / static["deflection_max"] - 1), 1e-5)
        self.assertGreater(four["stable_dt"], 1.4 * one["stable_dt"])

    def test_what_breaks(self):
        """Beams break, and the ledger closes to 1e-4 of the boundary's work."""
        with_factor = (*BREAKING, "-time_end", "3", FACTOR, "4")
        self.assertGreater(self.floe(*with_factor, dir="a")["beams_broken"], 10)
        last = self.rows("a")[-1]
        self.assertLess(abs(float(last["energy_balance_error"])),
                        1e-4 * float(last["energy_boundary"]))
        self.assertGreater(float(last["energy_boundary"]), 1e3)
        self.floe(*BREAKING, "-time_end", "3", dir="b")
        self.assertNotEqual(last["energy_kinetic"], self.rows("b")[-1]["energy_kinetic"])

    def test_goes_on(self):
        """From its checkpoint, bit for bit (but for the peak since the last row, of which there is
        one more where the first part ended); not with another factor."""
        words = (*BREAKING, "-time_end", "3", FACTOR, "2.5", "-checkpoint_every", "1000")
        self.floe(*words, "-ts_max_steps", "6000", dir="whole")
        self.floe(*words, "-ts_max_steps", "2500", dir="part")
        again = ("-checkpoint_restart", "part/checkpoint.h5")
        said = self.floe(*words, *again, "-ts_max_steps", "6000", FACTOR, "2", dir="part", code=2)
        self.assertIn("model: rotational_inertia_factor: 2 cannot be changed where a run goes on; "
                      "the checkpoint has 2.5", said)
        self.floe(*words, *again, "-ts_max_steps", "6000", dir="part")
        part, whole = ({name: text for name, text in self.rows(dir)[-1].items()
                        if "_peak_" not in name} for dir in ("part", "whole"))
        self.assertEqual(part, whole)
        self.assertGreater(float(whole["beams_broken"]), 0)


if __name__ == "__main__":
    unittest.main()
