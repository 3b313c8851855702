#!/usr/bin/python3
"""Extremes: every run ends in a right answer, or in one line that says what is wrong; never in a
silent wrong number.

Short by default; FLOE_FULL=1 (tools/bench stress) takes the long forms: 10 million steps, more
seeds and ratios.
"""
import math
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "regression"))
import launch  # noqa: E402

sys.path.insert(0, str(launch.REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402
from floe.results.output import Output  # noqa: E402

FULL = launch.FULL

SHEET = """integrator: quasistatic
forces: [beam]
sheet: {length: 10, width: 10, thickness: 0.5, element_size: 1.5, seed: 1, iterations: 50}
ice: {young: 4e9, poisson: 0.3, density: 920}
boundary:
  names: [left, right]
  left: {set: left, fix: x}
  right: {set: right, fix: x, displacement: [0.01, 0, 0], ramp: 1}
report: [tension]
"""
FREE = """integrator: explicit
forces: [beam]
lattice_file: lattice.h5
time: {end: 0.1}
output: {fields: 1e9}
"""
CANTILEVER = """integrator: quasistatic
forces: [beam]
lattice_file: lattice.h5
beam: {shear: exact}
boundary:
  names: [root]
  root: {set: root, fix: "x y z rx ry rz"}
"""


class Run:
    """A finished run: code, text (standard error), errors (its lines of ours but warnings),
    summary, last (displacements)."""

    def __init__(self, scene, *words, lattice=None, motion=None):
        with tempfile.TemporaryDirectory() as folder:
            if lattice is not None:
                lattice.write(f"{folder}/lattice.h5")
                with h5py.File(f"{folder}/lattice.h5", "a") as file:
                    for name, values in (motion or {}).items():
                        file[f"bodies/{name}"] = values
            Path(folder, "s.yaml").write_text(scene)
            done = launch.run("s.yaml", *words, cwd=folder)
            self.code, self.text = done.returncode, done.stderr
            self.errors = [line for line in done.stderr.splitlines()
                           if line.startswith("floe:") and not line.startswith("floe: warning")]
            self.summary = self.last = None
            if self.code == 0 and Path(folder, "out/s/summary.json").exists():
                output = Output(f"{folder}/out/s")
                self.summary = output.summary
                self.last = output.field("bodies_displacement",
                                         output.times[-1]) if len(output.times) else None


def sheet(columns=5, rows=5, thickness=0.5):
    return fl.triangles(columns, rows, 1.0, thickness)


class Stress(unittest.TestCase):
    def good(self, run):
        """The run came to its end, and every number it gives is finite."""
        self.assertEqual(run.code, 0, run.text)
        if run.last is not None:
            self.assertTrue(np.all(np.isfinite(run.last)))

        def finite(value):
            if isinstance(value, dict):
                return all(map(finite, value.values()))
            return not isinstance(value, float) or np.isfinite(value)
        self.assertTrue(finite(run.summary), run.summary)

    def one_line(self, run, codes=(1, 2)):
        """The run ended with one line that says why."""
        self.assertIn(run.code, codes, run.text)
        self.assertEqual(len(run.errors), 1, run.text)
        self.assertNotIn("internal error", run.errors[0])

    def energy_kept(self, run, tolerance):
        energy = run.summary["energy"]
        scale = max(abs(energy[name]) for name in ("kinetic", "strain"))
        self.assertLess(abs(energy["balance_error"]), tolerance * scale, energy)

    # -- explicit steps -------------------------------------------------------------------------
    def test_free_sheet_many_steps(self):
        """1e4 steps (full: 1e7): the centre goes straight, nothing grows."""
        lattice = sheet()
        rng = np.random.default_rng(1)
        velocity = np.array([0.3, -0.2, 0.1]) + 0.01 * rng.normal(size=lattice.position.shape)
        first = Run(FREE, "-time_end", "0.01", lattice=lattice, motion={"velocity": velocity})
        self.good(first)
        end = first.summary["dt"] * (1e7 if FULL else 1e4)
        run = Run(FREE, "-time_end", repr(end), lattice=lattice, motion={"velocity": velocity})
        self.good(run)
        self.assertGreater(run.summary["steps"], 9e6 if FULL else 9e3)
        self.energy_kept(run, 1e-6 if FULL else 1e-8)
        mean = np.average(velocity, axis=0, weights=lattice.mass)
        np.testing.assert_allclose(np.average(run.last, axis=0, weights=lattice.mass), mean * end,
                                   rtol=1e-9)
        kinetic = 0.5 * np.sum(lattice.mass[:, None] * velocity**2)
        self.assertLess(abs(run.summary["energy"]["kinetic"] + run.summary["energy"]["strain"]
                            - kinetic), 2e-3 * kinetic)

    def test_random_kicks(self):
        """Velocities of up to 100 m/s in random directions, strains of 5 % and more: momentum is
        kept to rounding, energy at a third of the default step (at the default the ledger says how
        far off it is, and stops the run at 10 %)."""
        lattice = sheet()
        for seed in range(20 if FULL else 2):
            for size, options in ((1.0, ()), (100.0, ()), (100.0, ("-time_safety", "0.3"))):
                rng = np.random.default_rng(seed)
                velocity = rng.uniform(-size, size, lattice.position.shape)
                run = Run(FREE, "-time_end", "0.5" if FULL else "0.1", *options, lattice=lattice,
                          motion={"velocity": velocity})
                if run.code != 0:
                    self.assertGreater(size, 1)
                    self.one_line(run, (1,))
                    continue
                self.good(run)
                if size == 1 or options:
                    self.energy_kept(run, 0.02)
                mean = np.average(velocity, axis=0, weights=lattice.mass) * (0.5 if FULL else 0.1)
                np.testing.assert_allclose(np.average(run.last, axis=0, weights=lattice.mass), mean,
                                           rtol=1e-8)

    def test_many_turns(self):
        """A stiff bar turns about z: 10 turns (full: 1000), explicit and implicit; it ends at the
        right angle."""
        bar = fl.straight_frame(2.0, 4, fl.Section(0.5, 0.5))
        turns, rate = (1000 if FULL else 10), 20 * np.pi
        zero = np.zeros(5)
        centre = bar.position[:, 0] - 1.0
        motion = {"velocity": np.column_stack([zero, rate * centre, zero]),
                  "angular_velocity": np.column_stack([zero, zero, zero + rate])}
        for integrator, options in (("explicit", ()),
                                    ("implicit",
                                     ("-time_dt", "2.5e-4", "-ts_liealpha_radius", "1"))):
            end = (turns if integrator == "explicit" else min(turns, 10)) * 0.1
            run = Run(FREE, "-integrator", integrator, "-time_end", repr(end), *options,
                      lattice=bar, motion=motion)
            self.good(run)
            # Centrifugal stretch, about rho rate^2 R^2/3E = 3e-4, comes at once and slows the turn
            # a little.
            self.assertLess(np.max(np.abs(run.last[0] + run.last[-1])), 1e-6)  # the centre stays
            self.assertLess(np.linalg.norm(run.last[0]), 2.02)
            ends = (bar.position + run.last)[[0, -1]]
            self.assertAlmostEqual(np.linalg.norm(ends[1] - ends[0]), 2.0, delta=4e-3)
            self.assertLess(abs(run.last[:, 2]).max(), 1e-9)
            self.energy_kept(run, 1e-3)

    def test_step_against_the_limit(self):
        """0.1 to 0.99 of the stable step: stable; 1.05: refused; forced: caught."""
        lattice = sheet()
        velocity = 0.01 * np.random.default_rng(3).normal(size=lattice.position.shape)
        motion = {"velocity": velocity}
        stable = Run(FREE, "-time_end", "0.001", lattice=lattice,
                     motion=motion).summary["stable_dt"]
        for part in (0.1, 0.5, 0.9, 0.99):
            run = Run(FREE, "-time_dt", repr(part * stable), "-time_end",
                      repr(5000 * part * stable), lattice=lattice, motion=motion)
            self.good(run)
            kinetic = 0.5 * np.sum(lattice.mass[:, None] * velocity**2)
            self.assertLess(run.summary["energy"]["kinetic"], 3 * kinetic, part)
        over = ("-time_dt", repr(1.05 * stable), "-time_end", repr(5000 * stable))
        self.one_line(Run(FREE, *over, lattice=lattice, motion=motion), (2,))
        self.one_line(Run(FREE, *over, "-time_allow_unstable", "true", lattice=lattice,
                          motion=motion), (1,))

    def test_damping_from_none_to_ten_times_critical(self):
        lattice = sheet()
        velocity = np.random.default_rng(4).normal(size=lattice.position.shape)
        kinetic = 0.5 * np.sum(lattice.mass[:, None] * velocity**2)
        rigid = None
        for damping in ("0", "1e-6", "0.1", "1", "10"):
            run = Run(FREE, "-beam_damping_ratio", damping, lattice=lattice,
                      motion={"velocity": velocity})
            # at the largest step the dashpots' loss is not counted well enough, and the run says so
            if run.code != 0:
                self.one_line(run, (1,))
                self.assertIn("energy balance", run.errors[0])
                run = Run(FREE, "-beam_damping_ratio", damping, "-time_safety", "0.1",
                          lattice=lattice,
                          motion={"velocity": velocity})
            self.good(run)
            left = run.summary["energy"]["kinetic"] + run.summary["energy"]["strain"]
            self.assertLess(left, 1.05 * kinetic, damping)
            if damping in ("1", "10"):  # all but the rigid motions is gone
                rigid = rigid or left
                self.assertAlmostEqual(left / rigid, 1, delta=0.02)

    def test_mass_ratios(self):
        """One body a thousand times heavier, one a thousand times lighter: stable, energies
        kept."""
        lattice = sheet()
        for body, factor in ((7, 1e3), (12, 1e-3)):
            lattice.mass[body] *= factor
            lattice.inertia[body] *= factor
        velocity = np.zeros_like(lattice.position)
        velocity[7] = [0.01, 0.02, 0.03]
        run = Run(FREE, lattice=lattice, motion={"velocity": velocity})
        self.good(run)
        self.energy_kept(run, 1e-6)
        moved = np.average(run.last, axis=0, weights=lattice.mass)
        np.testing.assert_allclose(moved, np.average(velocity, axis=0, weights=lattice.mass) * 0.1,
                                   rtol=1e-7)

    def test_denormal_velocities(self):
        """Velocities of 1e-310 m/s move nothing, and cost no time."""
        lattice = sheet()
        velocity = np.full_like(lattice.position, 1e-310)
        run = Run(FREE, lattice=lattice, motion={"velocity": velocity})
        self.good(run)
        self.assertLess(np.max(np.abs(run.last)), 1e-300)

    # -- lattices -------------------------------------------------------------------------------
    def test_slivers(self):
        """Facets a millionth as wide as an element change nothing: neither the answer nor the
        stable step."""
        pull = SHEET.replace("sheet: {length: 10, width: 10, thickness: 0.5, element_size: "
                             "1.5, seed: 1, iterations: 50}",
                             "lattice_file: lattice.h5").replace("ice: {young: 4e9, poisson: "
                                                                 "0.3, density: 920}\n", "")
        pull = pull.replace("report: [tension]\n", "")
        bodies = {}
        for width in (1e-6, 1e-3, None):
            lattice = sheet(7, 7)
            inner = [k for k in range(len(lattice.bodies)) if 20 <= lattice.bodies[k][0] <= 24][:3]
            if width is None:
                keep = np.setdiff1d(np.arange(len(lattice.bodies)), inner)
                lattice.bodies, lattice.axis_y = lattice.bodies[keep], lattice.axis_y[keep]
                lattice.beam = {name: values[keep] for name, values in lattice.beam.items()}
            else:
                for name, values in fl.Section(width,
                                               0.5).scalars(lattice.beam["length"][inner]).items():
                    lattice.beam[name][inner] = values
            statics = Run(pull, lattice=lattice)
            self.good(statics)
            steps = Run(FREE, "-time_end", "0.01", lattice=lattice,
                        motion={"velocity": np.ones_like(lattice.position)})
            self.good(steps)
            bodies[width] = statics.last, steps.summary["stable_dt"]
        for width, tolerance in ((1e-6, 1e-5), (1e-3, 1e-2)):
            np.testing.assert_allclose(bodies[width][0], bodies[None][0], atol=0.01 * tolerance)
            self.assertAlmostEqual(bodies[width][1] / bodies[None][1], 1, delta=0.01)

    def test_thickness(self):
        """Thickness over element size from 1e-3 to 10: E does not depend on it."""
        found = [Run(SHEET, "-sheet_thickness", str(1.5 * ratio)) for ratio in (1e-3, 0.1, 1, 10)]
        for run in found:
            self.good(run)
            self.assertAlmostEqual(run.summary["E_over_Eb"] / found[0].summary["E_over_Eb"], 1,
                                   delta=1e-7)
        for ratio in (1e-3, 10):
            run = Run(SHEET, "-integrator", "explicit", "-boundary_right_ramp", "0.005",
                      "-time_end", "0.01",
                      "-sheet_thickness", str(1.5 * ratio))
            self.good(run)
            self.energy_kept(run, 1e-3)

    # -- statics --------------------------------------------------------------------------------
    def test_strains(self):
        """Strains from 1e-12 to 0.5."""
        small = Run(SHEET, "-boundary_right_displacement", "1e-5,0,0")
        self.good(small)
        for strain in (1e-12, 1e-9, 1e-3, 0.1, 0.5):
            run = Run(SHEET, "-boundary_right_displacement", f"{10 * strain!r},0,0")
            if strain >= 0.1 and run.code != 0:
                self.one_line(run)
                continue
            self.good(run)
            self.assertAlmostEqual(run.summary["E_over_Eb"] / small.summary["E_over_Eb"], 1,
                                   delta=max(1e-5, 2 * strain))

    def test_units(self):
        """Lengths, stiffnesses and densities scaled by 1e6 and 1e-6: E/Eb stays."""
        base = Run(SHEET)
        self.good(base)

        def scaled(length=1.0, young=1.0, density=1.0):
            words = {"sheet_length": 10 * length, "sheet_width": 10 * length,
                     "sheet_thickness": 0.5 * length,
                     "sheet_element_size": 1.5 * length,
                     "boundary_right_displacement": f"{0.01 * length!r},0,0",
                     "ice_young": 4e9 * young, "ice_density": 920 * density}
            return [text for name, value in words.items() for text in ("-" + name, str(value))]
        for words in (scaled(length=1e6), scaled(length=1e-6), scaled(young=1e6),
                      scaled(young=1e-6), scaled(density=1e6)):
            given = dict(zip(words[::2], words[1::2]))
            slow = float(given["-sheet_length"]) / 10 * math.sqrt(
                float(given["-ice_density"]) / 920 * 4e9 / float(given["-ice_young"]))
            for integrator in ("quasistatic", "implicit"):
                options = () if integrator == "quasistatic" else (
                    "-beam_damping_ratio", "1", "-boundary_right_ramp", repr(0.05 * slow),
                    "-time_end", repr(0.1 * slow))
                run = Run(SHEET, *words, "-integrator", integrator, *options)
                self.good(run)
                self.assertAlmostEqual(run.summary["E_over_Eb"] / base.summary["E_over_Eb"], 1,
                                       delta=1e-6 if integrator == "quasistatic" else 1e-2,
                                       msg=f"{words} {integrator}")

    def test_load_steps_far_too_large(self):
        """The 45-degree bend in one step, and at a hundred times its load."""
        scene = CANTILEVER + """load: {names: [tip], tip: {set: tip, force: [0, 0, 600], ramp: 1}}
time: {end: 1}
"""
        scene = scene.replace("load: {names: [tip], tip: {",
                              "load:\n  names: [tip]\n  tip: {").replace("ramp: 1}}", "ramp: 1}")
        bend = fl.bend45(32)
        fine, whole = Run(scene, "-time_dt", "0.05", lattice=bend), Run(scene, lattice=bend)
        self.good(fine)
        tip = np.array([-23.5606, -13.6047, 53.4755])
        self.assertLess(np.linalg.norm(fine.last[-1] - tip), 2e-3 * np.linalg.norm(tip))
        for run in (whole, Run(scene, "-load_tip_force", "0,0,60000", lattice=bend)):
            if run.code != 0:
                self.one_line(run)
        if whole.code == 0:
            np.testing.assert_allclose(whole.last, fine.last, atol=1e-6 * 60)

    def test_near_buckling(self):
        """A column pressed by 0.5 to 1.05 of Euler's load with a slight push from the side."""
        section = fl.Section(0.1, 0.1, young=1e9)
        length, elements = 10.0, 40
        column = fl.straight_frame(length, elements, section)
        stiffness = section.young * section.width * section.height**3 / 12
        euler = np.pi**2 * stiffness / (4 * length**2)
        side = 1e-6 * euler
        scene = CANTILEVER + """load: {names: [tip], tip: {set: tip, force: [0, 0, 0], ramp: 1}}
time: {end: 1, dt: 0.1}
"""
        for part in (0.5, 0.9, 0.99, 1.05):
            run = Run(scene, "-load_tip_force", f"{-part * euler!r},0,{side!r}", lattice=column)
            if part > 1:
                # Past Euler's load the straight column is an equilibrium still, and the run says
                # that it is none to trust.
                if run.code != 0:
                    self.one_line(run)
                elif abs(run.last[-1, 2]) < 0.1 * length:
                    self.assertIs(run.summary["stable"], False)
                    self.assertIn("unstable", run.text)
                continue
            self.good(run)
            u = np.pi / 2 * np.sqrt(part)
            exact = side * length**3 / (3 * stiffness) * 3 * (np.tan(u) - u) / u**3
            self.assertAlmostEqual(run.last[-1, 2] / exact, 1, delta=0.002 / (1 - part))

    def test_small_loads_on_heavy_sheets(self):
        """A floating sheet's deflection per load, from 0.1 mN to 10 kN: its weight must not hide
        small forces."""
        scene = """integrator: quasistatic
forces: [beam, gravity, buoyancy]
sheet: {length: 20, width: 20, thickness: 0.5, element_size: 2, seed: 1, iterations: 50}
gravity: 9.81
water: {density: 1010}
load:
  names: [p]
  p: {point: [0, 0], force: [0, 0, -1e4], ramp: 1}
time: {end: 1}
report: [bending]
"""
        moving = ("-integrator", "implicit", "-forces", "beam,gravity,buoyancy,drag",
                  "-water_drag_linear", "4270",
                  "-beam_damping_ratio", "1", "-time_end", "4")
        expected = Run(scene).summary["deflection_over_wyman"]
        for load in (1e-4, 1.0, 1e4):
            for words in ((), moving, (*moving, "-time_dt", "0.25")):
                run = Run(scene, "-load_p_force", f"0,0,{-load!r}", *words)
                self.good(run)
                self.assertAlmostEqual(run.summary["deflection_over_wyman"] / expected, 1,
                                       delta=1e-4 if not words else 0.01,
                                       msg=f"{load} {words}")

    # -- implicit -------------------------------------------------------------------------------
    def test_implicit_steps_far_too_large(self):
        """A soft bar that turns by 10 rad per given step: the step is cut, or one line says so."""
        bar = fl.straight_frame(10.0, 8, fl.Section(1.0, 1.0, young=1e6))
        zero = np.zeros(9)
        motion = {"velocity": np.column_stack([zero, 10 * (bar.position[:, 0] - 5), zero]),
                  "angular_velocity": np.column_stack([zero, zero, zero + 10])}
        run = Run(FREE, "-integrator", "implicit", "-time_dt", "1", "-time_end", "3", lattice=bar,
                  motion=motion)
        if run.code != 0:
            self.one_line(run, (1,))
        else:
            self.good(run)

    # -- floating-point exceptions --------------------------------------------------------------
    def test_no_floating_point_exceptions(self):
        """Division by zero, overflow and invalid operations trapped (-fp_trap)."""
        water = """integrator: explicit
forces: [beam, gravity, buoyancy, drag]
sheet: {length: 10, width: 10, thickness: 0.5, element_size: 1.5, seed: 1, iterations: 20}
gravity: 9.81
water: {density: 1010, drag_linear: 1000, drag_coefficient: 1}
load:
  names: [p]
  p: {point: [0, 0], force: [0, 0, -1e3], ramp: 0.01}
time: {end: 0.02}
"""
        cracks = SHEET.replace("[beam]", "[beam, fracture]").replace("report: [tension]\n", "") + \
            "fracture: {tensile_strength: 6e5, shear_strength: 6e5, energy: 15}\n"
        explicit = ("-integrator", "explicit", "-boundary_right_ramp", "0.01", "-time_end", "0.02")
        implicit = ("-integrator", "implicit", "-boundary_right_ramp", "0.01", "-time_end", "0.02")
        for scene, words in ((SHEET, ()), (SHEET, explicit),
                             (SHEET, (*explicit, "-beam_damping_ratio", "1")),
                             (SHEET, implicit), (SHEET, (*explicit, "-ts_type", "rk")),
                             (cracks, explicit),
                             (water, ()), (water, ("-integrator", "implicit"))):
            run = Run(scene, *words, "-fp_trap")
            self.assertEqual(run.code, 0, f"{words}: {run.text}")


if __name__ == "__main__":
    unittest.main()
