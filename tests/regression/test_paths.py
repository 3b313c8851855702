#!/usr/bin/python3
"""The section `static` as a user gives it: what each key of a path does, and how paths end."""
import subprocess
import sys
import unittest

import launch
import numpy as np
from launch import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.results.output import Output  # noqa: E402

SCENE = (REPOSITORY / "input/verify/lee_frame.yaml").read_text()


class Paths(launch.FolderTest):
    def setUp(self):
        super().setUp()
        subprocess.run([str(REPOSITORY / "tools/make_lattice"), "lee_frame", "--elements", "5",
                        str(self.folder / "lee.h5")], check=True, capture_output=True)
        (self.folder / "scene.yaml").write_text(SCENE)

    def follow(self, *words, status=0):
        """Output of the scene with these options, and what it says to standard error."""
        run = launch.run("scene.yaml", "-lattice_file", "lee.h5", *words, cwd=self.folder)
        self.assertEqual(run.returncode, status, run.stdout + run.stderr)
        self.said = run.stdout
        return Output(self.folder / "out/scene"), run.stderr

    def test_steps_end_it(self):
        output, _ = self.follow("-static_steps", "7")
        self.assertEqual(len(output.history("time")), 8)
        self.assertEqual(output.summary["path"]["end"], "after 7 steps")
        self.assertIn("at most 7 steps along the path", self.said)

    def test_the_first_arc(self):
        output, _ = self.follow("-static_steps", "1", "-static_arc_length", "1e-4")
        np.testing.assert_allclose(output.history("arc_length"), [0, 1e-4], rtol=1e-9)

    def test_the_longest_arc(self):
        arcs = []
        for longest in ("0.01", "0.02"):
            output, _ = self.follow("-static_steps", "60", "-static_arc_length_max", longest)
            arcs.append(np.diff(output.history("arc_length")))
        self.assertLess(arcs[0].max(), 0.01 * (1 + 1e-9))
        self.assertGreater(arcs[1].max(), 0.01 * (1 + 1e-9))

    def test_the_shortest_arc(self):
        # Twice the frame cannot be reached by one arc.
        output, said = self.follow("-static_arc_length", "3", "-static_arc_length_min", "2.9",
                                   "-static_arc_length_max", "3", status=1)
        self.assertIn("no equilibrium beyond load factor 0, step 0 (arc length cut to 1.5 m)", said)
        self.assertEqual(len(output.history("time")), 1)

    def test_a_load_factor(self):
        output, _ = self.follow("-static_load_factor", "10")
        self.assertEqual(output.history("load_factor")[-1], 10)
        self.assertEqual(output.summary["path"]["limit_points"], [])

    def test_a_displacement(self):
        ends = {}
        for component, value in (("x", 0.2), ("y", -0.3)):
            output, _ = self.follow("-static_monitor", "load",
                                    "-static_monitor_component", component,
                                    "-static_monitor_displacement", str(value))
            moved = output.history("load_load_displacement_" + component)[-1]
            self.assertAlmostEqual(moved, value, 9)
            ends[component] = output.history("load_factor")[-1]
        self.assertNotAlmostEqual(ends["x"], ends["y"], 1)

    def test_frames_are_counted_in_steps(self):
        output, _ = self.follow("-static_steps", "6", "-output_fields", "2")
        np.testing.assert_array_equal(output.times, [0, 2, 4, 6])

    def test_the_options_of_a_run_make_it_again(self):
        output, _ = self.follow("-static_load_factor", "10")
        run = launch.run("out/scene/options.yaml", "-output_dir", "again", cwd=self.folder)
        self.assertEqual(run.returncode, 0, run.stderr)
        again = Output(self.folder / "again")
        for column in ("load_factor", "arc_length", "energy_strain"):
            np.testing.assert_allclose(again.history(column), output.history(column), rtol=1e-9)

    def test_load_steps_agree_below_the_limit(self):
        arc, _ = self.follow("-static_load_factor", "15")
        path = arc.history("load_load_displacement_y")[-1]
        steps = SCENE.split("static:")[0].replace("-1000", "-15000")
        (self.folder / "scene.yaml").write_text(steps)
        steps, _ = self.follow("-time_dt", "0.05")
        self.assertNotIn("load_factor", steps.summary)
        self.assertAlmostEqual(steps.history("load_load_displacement_y")[-1], path, 8)


if __name__ == "__main__":
    unittest.main()
