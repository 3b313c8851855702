#!/usr/bin/python3
"""tools/bench --peers: what it writes for Yade is what floe gets, and what it says without Yade.
Yade itself is not needed."""
import json
import os
import shutil
import subprocess
import sys
import unittest

import numpy as np

from launch import FLOE, REPOSITORY, FolderTest, run

sys.path.insert(0, str(REPOSITORY / "tools"))
sys.path.insert(0, str(REPOSITORY / "python"))
import floe_peers as peers  # noqa: E402


class Peers(FolderTest):
    def test_without_yade(self):
        """One line that says how to install it, exit code 2."""
        (self.folder / "git").symlink_to(shutil.which("git"))
        done = subprocess.run([sys.executable, REPOSITORY / "tools/bench", "--peers"],
                              capture_output=True, text=True,
                              env={**os.environ, "PATH": str(self.folder), "FLOE": str(FLOE)})
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr, "tools/bench: Yade is not installed; on Debian: apt-get "
                                      "install yade\n")

    def test_scripts(self):
        """Both are Python; both programs get the same boxes, floor and steps."""
        peers.write_scripts(self.folder, (2, 2, 2), 0.5, steps=7)
        for name in ("lattice.py", "polyhedra.py"):
            compile((self.folder / name).read_text(), name, "exec")
        self.assertIn("STEPS = 0.5, 41, 36, 7", (self.folder / "lattice.py").read_text())
        scene = json.loads((self.folder / "boxes.json").read_text())
        boxes = peers.pile((2, 2, 2))
        np.testing.assert_array_equal(scene["places"], boxes.position)
        first = boxes.shapes.vertices[:8] @ np.transpose(peers.matrices(boxes.orientation)[0])
        self.assertEqual({tuple(v) for v in np.round(first, 9)},
                         {tuple(v) for v in np.round(scene["corners"][0], 9)})
        lowest = np.array(scene["places"])[:, None, 2] + np.array(scene["corners"])[:, :, 2]
        self.assertGreater(lowest.min(), 0)
        done = run(self.folder / "boxes.yaml", "-output_dir", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual(summary["steps"], scene["steps"])
        self.assertEqual(summary["bodies"], len(scene["places"]))

    def test_stiffness(self):
        """Two of Yade's in series are floe's E_c/(L_a + L_b), L = V^(1/3)/2."""
        peers.write_scripts(self.folder, (1, 1, 1), 0.1)
        scene = json.loads((self.folder / "boxes.json").read_text())
        half = 0.5 * np.prod(peers.SIZE)**(1 / 3)
        self.assertAlmostEqual(scene["stiffness"] / 2 / (peers.YOUNG / (2 * half)), 1)

    def test_table(self):
        rows = peers.table({"lattice": {"unit": "ns", "what": "per bond", "floe": [2.0, 4.0, 3.0],
                                        "yade": [50.0, 30.0, 20.0]}})
        self.assertEqual(rows[-1], "| lattice | per bond | 2 / 3 ns | 20 / 30 ns | 10, 10 |")
        self.assertEqual(peers.said_by('x\nPEER {"steps": 3}\nlater\n'), {"steps": 3})
        with self.assertRaisesRegex(RuntimeError, "no result"):
            peers.said_by("an error")


if __name__ == "__main__":
    unittest.main()
