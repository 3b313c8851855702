#!/usr/bin/python3
"""floe make_line: lines against closed forms, energies and numerical integration; the table in a
run of floe."""
import re
import subprocess
import sys
import unittest

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from launch import REPOSITORY
from scene_runs import SceneTest, rows_of

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.make.catenary import Catenary, Segment, table  # noqa: E402

CHAIN = Segment(300.0, 1500.0, 7e8)
MIXED = (Segment(60.0, 200.0, 3e7), Segment(120.0, 1500.0, 7e8), Segment(130.0, 800.0, 2e8))


def jonkman(pull, lift, length, weight, stiffness, friction):
    """Horizontal and vertical distance of the ends of a uniform line (Jonkman 2007): hanging
    wholly, or partly on the seabed."""
    top, ratio = np.hypot(1, lift / pull), lift / pull
    if lift >= weight * length:
        low = (lift - weight * length) / pull
        return (pull / weight * (np.log(ratio + top) - np.log(low + np.hypot(1, low)))
                + pull * length / stiffness,
                pull / weight * (top - np.hypot(1, low))
                + (lift * length - weight * length**2 / 2) / stiffness)
    lies, x = length - lift / weight, 0
    if friction > 0:
        free = lies - pull / (friction * weight)
        x = friction * weight / (2 * stiffness) * (-lies**2 + free * max(free, 0))
    return (x + lies + pull / weight * np.log(ratio + top) + pull * length / stiffness,
            pull / weight * (top - 1) + lift**2 / (2 * stiffness * weight))


class Lines(unittest.TestCase):
    def test_residual_of_the_equations(self):
        """To 1e-10 of the line's length, from slack to wholly lifted, with and without friction."""
        for friction in (0.0, 0.3, 3.0):
            for height in (3.0, 40.0, 200.0):
                line = Catenary([CHAIN], height, friction)
                lifted = 0
                for pull in np.geomspace(1e2, 1e8, 25):
                    lift = line.lift(pull)
                    x, z = jonkman(pull, lift, 300, 1500, 7e8, friction)
                    self.assertAlmostEqual(x, line.distance(pull), delta=3e-8)
                    self.assertAlmostEqual(z, height, delta=3e-8)
                    self.assertAlmostEqual(line.pull_at(x) / pull, 1, delta=1e-6)
                    self.assertAlmostEqual(line.pull_of(np.hypot(pull, lift)) / pull, 1, delta=1e-8)
                    lifted += lift > 300 * 1500
                self.assertTrue(0 < lifted < 25)

    def test_inextensible(self):
        """X = L - sqrt(h^2 + 2 h a) + a arcosh(1 + h/a), T = H + w h, a = H/w, while part lies."""
        line = Catenary([Segment(300.0, 1500.0, 1e18)], 40)
        for pull in (1e3, 1e5, 1e6):
            a = pull / 1500
            self.assertAlmostEqual(line.distance(pull), 300 - np.sqrt(40**2 + 2 * 40 * a)
                                   + a * np.arccosh(1 + 40 / a), delta=1e-8)
            self.assertAlmostEqual(line.tension(pull) / (pull + 1500 * 40), 1, delta=1e-9)
            self.assertAlmostEqual(line.lying(pull), 300 - np.sqrt(40**2 + 2 * 40 * a), delta=1e-8)
        self.assertAlmostEqual(line.distance(0), 260, delta=1e-9)
        self.assertEqual(line.pull_at(259), 0)

    def test_taut(self):
        """EA/L along a line whose weight does not count; with height, of a spring at an angle."""
        for height, delta in ((0.01, 1e-4), (90.0, 1e-2)):
            line = Catenary([CHAIN], height)
            pull = 2e8
            x = line.distance(pull)
            stretched = np.hypot(x, height)
            cosine, along = x / stretched, 7e8 / 300
            spring = along * cosine**2 + pull / cosine / stretched * (1 - cosine**2)
            self.assertAlmostEqual(line.stiffness(pull) / spring, 1, delta=delta)
            self.assertAlmostEqual(np.hypot(pull, line.lift(pull)) / (along * (stretched - 300)), 1,
                                   delta=delta)

    def test_work_is_energy(self):
        """The work of the horizontal force is what the line gains in height and in stretch; and
        force and stiffness rise with the distance."""
        line = Catenary(MIXED, 40)

        def energy(pull):
            total, top = 0.0, 40.0
            for piece in line.pieces(pull, line.lift(pull)):
                of = piece.segment
                s, weights = np.polynomial.legendre.leggauss(200)
                s, weights = (s + 1) / 2 * piece.hangs, weights / 2 * piece.hangs
                tension = np.hypot(pull, piece.top - of.weight * s)
                total += weights @ (tension**2 / (2 * of.stiffness)
                                    + of.weight * (top - piece.offset(pull, s)[1]))
                total += pull**2 / (2 * of.stiffness) * piece.lies
                top -= piece.offset(pull, np.float64(piece.hangs))[1]
            return total

        pulls = np.geomspace(1e3, 3e6, 30)
        for low, high in zip(pulls, pulls[1:]):
            work = high * line.distance(high) - low * line.distance(low) - quad(
                line.distance, low, high, epsrel=1e-11, limit=200)[0]
            self.assertAlmostEqual(work / (energy(high) - energy(low)), 1, delta=1e-6)
        distances = [line.distance(pull) for pull in pulls]
        self.assertTrue((np.diff(distances) > 0).all())
        self.assertTrue((np.diff([line.stiffness(pull) for pull in pulls]) > 0).all())
        self.assertAlmostEqual(line.stiffness(pulls[9]) / ((pulls[9] * 1.001 - pulls[9] * 0.999) / (
            line.distance(pulls[9] * 1.001) - line.distance(pulls[9] * 0.999))), 1, delta=1e-5)

    def test_segments_against_integration(self):
        """dx/ds = H/T (1 + T/EA), dz/ds = V/T (1 + T/EA), V' = -w while V > 0; on the seabed
        friction takes the tension."""
        for friction, pull in ((0.0, 2e4), (0.4, 2e4), (0.4, 2e5), (0.4, 1.5e6)):
            line = Catenary(MIXED, 40, friction)
            state = np.array([0.0, 0.0, line.lift(pull), pull])  # x, down, V, tension if it lies
            for one in MIXED:
                def rates(_, y, one=one):
                    lies = y[2] <= 0
                    tension = max(y[3], 0.0) if lies else np.hypot(pull, y[2])
                    longer = 1 + tension / one.stiffness
                    if lies:
                        return [longer, 0, 0, -friction * one.weight if y[3] > 0 else 0]
                    return [pull / tension * longer, y[2] / tension * longer, -one.weight, 0]
                state = solve_ivp(rates, (0, one.length), state, max_step=0.05, rtol=1e-9,
                                  atol=1e-9).y[:, -1]
            self.assertAlmostEqual(state[0], line.distance(pull), delta=2e-3)
            self.assertAlmostEqual(state[1], 40, delta=2e-3)
        thirds = [Segment(100.0, 1500.0, 7e8)] * 3
        for pull in (1e4, 3e5, 3e6):
            self.assertAlmostEqual(Catenary(thirds, 40, 0.3).distance(pull),
                                   Catenary([CHAIN], 40, 0.3).distance(pull), delta=1e-9)

    def test_table(self):
        line = Catenary([CHAIN], 40)
        rows, pulls, worst = table(line, 3e6, 100)
        self.assertEqual(rows[0, 1], 0)
        self.assertAlmostEqual(line.tension(pulls[-1]) / 3e6, 1, delta=1e-12)
        self.assertTrue((np.diff(rows, axis=0) > 0).all())
        for (length, tension), pull in zip(rows[1:], pulls[1:]):
            distance = np.sqrt(length**2 - 40**2)
            self.assertAlmostEqual(tension * distance / length / pull, 1, delta=1e-12)
            self.assertAlmostEqual(line.distance(pull), distance, delta=1e-9)
        pull = line.pull_at(285.3)
        length = np.hypot(285.3, 40)
        found = np.interp(length, *rows.T) * 285.3 / length
        self.assertNotEqual(found, pull)
        self.assertAlmostEqual(found / pull, 1, delta=worst)
        self.assertLess(worst, 2e-3)
        level, _, _ = table(line, 3e6, 100, level=True)
        np.testing.assert_allclose(level[:, 1], pulls, rtol=1e-15)
        np.testing.assert_allclose(level[:, 0], np.sqrt(rows[:, 0]**2 - 40**2), rtol=1e-13)


# The step is 0.2 of the stable one. The search for that fails of one body that is nearly at rest
# under large forces, whose rounding it takes for damping.
MOORED = """integrator: explicit
forces: [contact]
lattice_file: block.h5
contact: {young: 1e6}
obstacle:
  names: [box]
  box: {shape: box, centre: [20, 0, 0], size: [4, 4, 2], mass: 16160}
line:
  names: [east, west]
  east: {structure: box, fairlead: [22, 0, 0], anchor: [312, 0, -40], LINE}
  west: {structure: box, fairlead: [18, 0, 0], anchor: [-272, 0, -40], LINE}
boundary: {names: [guide], guide: {set: box, fix: y z rx ry rz}}
load: {names: [pull], pull: {set: box, force: [1e5, 0, 0], ramp: 5}}
time: {end: 60, dt: 2e-3, allow_unstable: true}
output: {history: 0.05}
"""
WORDS = ("--segment", "300", "1500", "7e8", "--height", "40", "--largest", "3e6")


class MakeLine(SceneTest):
    def make(self, *words, code=0):
        done = subprocess.run([sys.executable, str(REPOSITORY / "tools/make_line"), *words],
                              cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        if code:
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done.stderr if code else done.stdout

    def test_offset_of_a_moored_structure(self):
        """The offset under a load is that of the table's forces to 1e-6, and of the line itself to
        what straight pieces are off."""
        from floe import lattice as fl
        fl.blocks(np.array([[1.0, 1, 1]]), np.array([[0.0, 0, 0]])).write(
            self.folder / "block.h5")
        said = self.make("line.csv", *WORDS, "--at", "290", "--plot", "line.png")
        self.run_scene(MOORED.replace("LINE", "table: line.csv, damping: 4e4"), name="s")
        rows = rows_of(self.folder / "out/s")
        curve = np.loadtxt(self.folder / "line.csv", delimiter=",", skiprows=2)

        def pull(distance):
            length = np.hypot(distance, 40)
            return np.interp(length, *curve.T) * distance / length
        found = brentq(lambda x: 1e5 + pull(290 - x) - pull(290 + x), 0, 10, xtol=1e-14)
        self.assertAlmostEqual(rows["box_x"][-1] / found, 1, delta=1e-6)
        line = Catenary([CHAIN], 40)
        itself = brentq(lambda x: 1e5 + line.pull_at(290 - x) - line.pull_at(290 + x), 0, 10)
        self.assertAlmostEqual(found / itself, 1, delta=5e-3)
        # What is printed is the line's, and what floe has at rest.
        at_rest = line.pull_at(290)
        for words, value in (("horizontal force ", at_rest),
                             ("stiffness ", line.stiffness(at_rest)),
                             ("downwards ", line.lift(at_rest)),
                             ("pretension ", rows["west_tension"][0]),
                             ("in floe length ", rows["west_length"][0])):
            printed = float(re.search(words + r"([\d.e+]+)", said)[1])
            self.assertAlmostEqual(printed / value, 1, delta=2e-3, msg=words)
        self.assertAlmostEqual(float(re.search(r"in floe (\d[\d.e+]*) N\)", said)[1])
                               / (at_rest * 40 / 290), 1, delta=1e-5)
        self.assertGreater((self.folder / "line.png").stat().st_size, 10000)

    def test_segments_and_pretension(self):
        said = self.make("two.csv", "--segment", "60", "200", "3e8", "--segment", "250", "1500",
                         "7e8", "--height", "40", "--largest", "3e6", "--friction", "0.6",
                         "--pretension", "2e5", "--rows", "30", "--level")
        line = Catenary([Segment(60, 200, 3e8), Segment(250, 1500, 7e8)], 40, 0.6)
        pull = line.pull_of(2e5)
        self.assertIn("tension at the fairlead 200000 N", said)
        self.assertIn(f"at {line.distance(pull):.6g} m: ", said)
        self.assertIn(f"length {line.distance(pull):.6g} m, pretension {pull:.6g} N", said)
        curve = np.loadtxt(self.folder / "two.csv", delimiter=",", skiprows=2)
        self.assertEqual(curve.shape, (30, 2))
        self.assertAlmostEqual(curve[-1, 0], line.distance(line.pull_of(3e6)), delta=1e-9)

    def test_refusals(self):
        for words, part in (
                (WORDS[:-2], "required: --largest"),
                (("--segment", "30", "1500", "7e8", *WORDS[4:]), "30 m long, too short to reach"),
                ((*WORDS[:-1], "5e4"), "--largest: 50000 must be more than the weight"),
                ((*WORDS, "--at", "200"), "--at: 200 must be where the line pulls"),
                ((*WORDS, "--at", "400"), "--at: 400 must be where the line pulls"),
                ((*WORDS, "--pretension", "4e6"), "--pretension: 4e+06 is more than --largest"),
                ((*WORDS, "--at", "280", "--pretension", "1e5"), "not allowed with"),
                ((*WORDS, "--rows", "3"), "3 is not within 10 to 100000"),
                ((*WORDS, "--plot", "x.zzz"), "must end in one of"),
                (("--segment", "300", "-1", "7e8", *WORDS[4:]), "-1 is not within")):
            self.assertIn(part, self.make("no.csv", *words, code=2))
        self.assertIn("is no folder", self.make("none/no.csv", *WORDS, code=2))
        self.assertFalse((self.folder / "no.csv").exists())


if __name__ == "__main__":
    unittest.main()
