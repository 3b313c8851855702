#!/usr/bin/python3
"""Reports in a browser (headless Chromium): no complaint of the page, the scene as Python decodes
it, play, turn, pick; on a telephone's width.

Needs chromium and python3-websocket (tools/setup --pictures); skipped where they are not there.
"""
import subprocess
import sys
import unittest

import numpy as np

import browser
from launch import ENVIRONMENT, FLOE, REPOSITORY, FolderTest
from report_scenes import make_report, run_cone
from test_supply import SCENE

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.report.arrays import unpack  # noqa: E402
from floe.report.page import data_in  # noqa: E402
from floe.results.output import rows_of  # noqa: E402

VIEW = "window.floe.view"
BOX = ("(e => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })"
       "(document.querySelector('%s'))")


@unittest.skipIf(browser.MISSING, browser.MISSING)
class InBrowser(FolderTest):
    def setUp(self):
        super().setUp()
        self.browser = browser.Browser()
        self.addCleanup(self.browser.close)

    def open(self, file, width, touch=False):
        self.browser.open(file, width, 900, touch)
        self.browser.until("window.floe && window.floe.ready")
        self.browser.run("document.documentElement.style.scrollBehavior = 'auto'")
        self.assertIsNone(self.browser.run("window.floe.error"))

    def run_of_cone(self):
        """A cone that comes nearer and turns."""
        run_cone(self.folder / "cone", "-obstacle_cone_velocity", "-0.1, 0, 0",
                 "-obstacle_cone_angular_velocity", "0, 0, 0.3")
        make_report(self.folder / "cone")
        return self.folder / "cone/report.html"

    def test_scene_plays_turns_and_tells_of_bodies(self):
        file = self.run_of_cone()
        self.open(file, 1200)
        scene = data_in(file.read_text())["scene"]
        self.decodes_as_python_does(scene)
        self.draws_little_at_a_time()
        self.plays(scene)
        self.turns()
        self.picks(scene)
        self.shows_colours()
        self.assertEqual(self.browser.complaints, [])

    def decodes_as_python_does(self, scene):
        poses, places = unpack(scene["poses"]), unpack(scene["places"])
        last = len(scene["times"]) - 1
        for frame in (0, last // 2, last):
            for body in (0, scene["bodies"] // 2, scene["bodies"] - 1):
                seen = self.browser.run(f"floeScene.bodyPose({VIEW}.scene, {frame}, {body})")
                np.testing.assert_allclose(
                    seen["place"], (places[:, body] + poses[frame, :3, body]) * scene["step"],
                    atol=1e-9)
                half = poses[frame, 3:, body] * scene["turn_step"] / 2
                size = np.linalg.norm(half)
                np.testing.assert_allclose(
                    seen["turn"], [*(half * np.sinc(size / np.pi)), np.cos(size)], atol=1e-9)
        # what goes to the graphics card between two frames
        card = self.browser.run(f"({VIEW}.setFrame({last - 0.5}), "
                                f"Array.from({VIEW}.poses.data.slice(0, 3)))")
        middle = places[:, 0] + poses[last - 1:, :3, 0].mean(axis=0)
        np.testing.assert_allclose(card, middle * scene["step"], atol=1e-5)

        # and of the obstacle
        time = self.browser.run(f"{VIEW}.time")
        card = self.browser.run(f"Array.from({VIEW}.places.data.slice(0, 8))")
        base = np.array([12.2 - 0.1 * time, 0, -4]) - scene["origin"]
        np.testing.assert_allclose(card[:3], base, atol=1e-3)
        np.testing.assert_allclose(card[4:], [0, 0, np.sin(0.15 * time), np.cos(0.15 * time)],
                                   atol=1e-3)

    def draws_little_at_a_time(self):
        self.browser.until(f"{VIEW}.calls > 0")
        self.assertLessEqual(self.browser.run(f"{VIEW}.calls"), 10)
        self.assertLess(self.browser.run(f"{VIEW}.triangles"), 2_000_000)
        words = self.browser.until("document.getElementById('rate').textContent")
        self.assertIn("draw calls", words)

    def plays(self, scene):
        self.browser.run(f"{VIEW}.speed *= 5; {VIEW}.setFrame(0); "
                         "document.getElementById('play').click()")
        self.assertEqual(self.browser.run("document.getElementById('play').textContent"), "Pause")
        self.browser.until(f"{VIEW}.time > 0.5")
        self.browser.until(f"{VIEW}.rate > 0 || !{VIEW}.playing")
        self.browser.until(f"!{VIEW}.playing")  # at its end
        self.assertAlmostEqual(self.browser.run(f"{VIEW}.time"), scene["times"][-1], 6)
        self.assertIn("frames a second", self.browser.run(
            "document.getElementById('rate').textContent"))

    def turns(self):
        camera = f"{VIEW}.camera.position.toArray()"
        self.browser.run("document.getElementById('scene').scrollIntoView()")
        left, top, width, height = self.browser.run(BOX % "#window canvas")
        before = np.array(self.browser.run(camera))
        self.browser.drag(left + width / 2, top + height / 2, 150, 30)
        self.browser.until(f"{VIEW}.camera.position.distanceTo("
                           f"new THREE.Vector3({','.join(map(str, before))})) > 1")
        self.assertEqual(self.browser.run(f"{VIEW}.selected"), -1)  # a turn is no pick
        self.browser.run("document.getElementById('back').click()")
        np.testing.assert_allclose(self.browser.run(camera), before, rtol=1e-6)

    def picks(self, scene):
        """A click on where the middle of a body is seen from: of one that nothing hides."""
        left, top, width, height = self.browser.run(BOX % "#window canvas")
        body, x, y = self.browser.run(f"""(() => {{
            const view = {VIEW}, data = view.poses.data;
            view.camera.updateMatrixWorld();
            for (let b = 0; b < view.scene.bodies; ++b) {{
              const p = new THREE.Vector3(data[12 * b], data[12 * b + 1], data[12 * b + 2]);
              p.project(view.camera);
              const x = (p.x + 1) / 2, y = (1 - p.y) / 2;
              if (x > 0.3 && x < 0.7 && y > 0.3 && y < 0.7 && view.bodyAt(x, y) === b) {{
                return [b, x, y];
              }}
            }}
        }})()""")
        self.browser.click(left + x * width, top + y * height)
        self.browser.until(f"{VIEW}.selected === {body}")
        words = self.browser.until("document.getElementById('picked').innerText")
        for word in (f"body {body}", "mass", "velocity", "fragment"):
            self.assertIn(word, words)
        numbers = self.browser.run(f"{VIEW}.numbersOf({body})")
        self.assertEqual(numbers["mass"], scene["masses"][body])
        poses = unpack(scene["poses"])[:, :3, body] * scene["step"]
        times = scene["times"]
        speed = (poses[-1] - poses[-2]) / (times[-1] - times[-2])
        np.testing.assert_allclose(numbers["velocity"], speed, atol=1e-9)
        self.assertEqual(numbers["fragments"], self.fragments(scene))

    @staticmethod
    def fragments(scene):
        """Pieces at the last frame, by the joined bodies' least numbers."""
        a, b, ended = unpack(scene["beams"])
        whole = (ended < 0) | (ended > 1000 * scene["times"][-1])
        piece = np.arange(scene["bodies"])
        for _ in range(scene["bodies"]):
            least = piece.copy()
            np.minimum.at(least, a[whole], piece[b[whole]])
            np.minimum.at(least, b[whole], piece[a[whole]])
            if np.array_equal(least, piece):
                break
            piece = least
        return len(np.unique(piece))

    def shows_colours(self):
        for colour in ("fragment", "speed", "height"):
            self.browser.run(f"(e => {{ e.value = '{colour}'; e.dispatchEvent(new Event('change'))"
                             "; })(document.getElementById('colour'))")
            self.assertEqual(self.browser.run(f"{VIEW}.colour"), colour)

    def test_ice_joins_and_leaves(self):
        """Bodies are drawn, picked and counted in the frames between which they exist."""
        (self.folder / "scene.yaml").write_text(SCENE)
        subprocess.run([FLOE, "scene.yaml", "-output_history", "0.1", "-output_fields", "0.5",
                        "-output_dir", "a"], cwd=self.folder, check=True, capture_output=True,
                       env=ENVIRONMENT)
        make_report(self.folder / "a")
        file = self.folder / "a/report.html"
        self.open(file, 1200)
        scene = data_in(file.read_text())["scene"]
        ids, life = unpack(scene["ids"])[0], unpack(scene["life"])
        rows = {round(float(row["time"]), 6): row for row in rows_of(self.folder / "a")}
        for k, time in enumerate(scene["times"]):
            self.browser.run(f"{VIEW}.setFrame({k})")
            shown = self.browser.run(f"Array.from({{length: {scene['bodies']}}}, "
                                     f"(_, b) => {VIEW}.poses.data[12 * b + 3])")
            there = (life[0] <= k) & (k <= life[1])
            np.testing.assert_array_equal(np.array(shown) == 1, there)
            self.assertEqual(sum(shown), float(rows[time]["bodies"]))
            body = int(np.flatnonzero(there)[-1])
            numbers = self.browser.run(f"{VIEW}.numbersOf({body})")
            self.assertEqual(numbers["fragments"], float(rows[time]["fragments"]))
            self.assertEqual(numbers["body"], ids[body])
            if not np.all(there):
                gone = int(np.flatnonzero(~there)[0])
                self.assertIsNone(self.browser.run(f"{VIEW}.numbersOf({gone})"))
        # between two frames: who leaves after the first or joins at the second is in neither
        k = int(np.flatnonzero(np.bincount(life[0], minlength=2)[1:])[0]) + 1
        self.browser.run(f"{VIEW}.setFrame({k - 0.5})")
        drawn = self.browser.run(f"Array.from({{length: {scene['bodies']}}}, "
                                 f"(_, b) => {VIEW}.poses.data[12 * b + 3])")
        np.testing.assert_array_equal(np.array(drawn) == 1, (life[0] < k) & (life[1] >= k))
        self.shows_colours()
        self.assertEqual(self.browser.complaints, [])

    def test_water_rises(self):
        """The water is drawn at its level, and heights of ice are above it."""
        (self.folder / "level.csv").write_text("time,level\n0,0\n1,0.5\n")
        (self.folder / "scene.yaml").write_text("""integrator: explicit
forces: [beam, gravity, buoyancy, drag]
sheet: {length: 6, thickness: 1, element_size: 2, iterations: 10}
water: {drag_linear: 1e4, level_table: level.csv}
time: {end: 1}
output: {history: 0.1, fields: 0.25}
""")
        subprocess.run([FLOE, "scene.yaml", "-output_dir", "a"], cwd=self.folder, check=True,
                       capture_output=True, env=ENVIRONMENT)
        make_report(self.folder / "a")
        file = self.folder / "a/report.html"
        self.open(file, 1200)
        bottom = data_in(file.read_text())["scene"]["origin"][2]
        for frame, level in ((0, 0), (2.5, 0.3125), (4, 0.5)):
            self.browser.run(f"{VIEW}.setFrame({frame})")
            for seen in (f"{VIEW}.bodies.material.uniforms.level.value",
                         f"{VIEW}.waterPose.data[2]"):
                self.assertAlmostEqual(self.browser.run(seen), level - bottom, delta=1e-3)
        self.assertEqual(self.browser.complaints, [])

    def test_telephone_and_ensemble(self):
        for seed in (1, 2):
            run_cone(self.folder / f"runs/s{seed}", "-sheet_seed", str(seed), "-time_end", "3")
        make_report(self.folder, "--runs")
        for file in (self.folder / "report.html", self.folder / "runs/s1/report.html"):
            self.open(file, 390, touch=True)
            self.fits(390)
        self.assertEqual(self.browser.complaints, [])

    def fits(self, width):
        self.assertLessEqual(self.browser.run("document.documentElement.scrollWidth"), width)
        beyond = self.browser.run("""[...document.querySelectorAll('button, select, input, svg, '
            + 'canvas, h1, h2, figcaption')].filter(
            e => e.getBoundingClientRect().right > innerWidth + 0.5).map(e => e.outerHTML)""")
        self.assertEqual(beyond, [])
        cut = self.browser.run("""[...document.querySelectorAll('svg text')].filter(e => {
            const t = e.getBoundingClientRect();
            const s = e.ownerSVGElement.getBoundingClientRect();
            return t.left < s.left - 1 || t.right > s.right + 1 || t.bottom > s.bottom + 1;
        }).map(e => e.textContent)""")
        self.assertEqual(cut, [])


if __name__ == "__main__":
    unittest.main()
