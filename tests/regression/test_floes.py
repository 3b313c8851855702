#!/usr/bin/python3
"""Floes with sections of their own: their cells, places, drafts, sets; floes that touch and that
overlap; keys that are refused."""
import math
import unittest

import numpy as np

from test_outlines import FLOES, OutlineTest

TWO = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {iterations: 20}
floe:
  names: [a, b]
  a: {length: 12, width: 8, place: [-8, 1], thickness: 0.5, element_size: 1, seed: 7}
  b: {length: 10, place: [6, 0], turn: 30, thickness: 0.8, element_size: 2, seed: 9}
beam: {damping_ratio: 0.1}
time: {end: 0.1}
output: {history: 0.02}
"""
ONE = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {SHEET iterations: 20}
FLOE
initial: {names: [m], m: {set: all, velocity: [0.1, 0, 0]}}
time: {end: 0.1}
output: {history: 0.02}
"""
TOUCHING = """integrator: explicit
forces: [beam, gravity, buoyancy, contact]
sheet: {iterations: 20, element_size: 1}
floe:
  names: [a, b, c]
  a: {length: 6, width: 4, thickness: 0.5}
  b: {length: 6, width: 4, place: [6, 0], thickness: 0.5, seed: 2}
  c: {length: 6, width: 4, place: [SHIFT, 4], thickness: 0.8, element_size: 1.5}
time: {end: 0.1}
output: {history: 0.02}
"""
DENSITY, WATER = 920, 1010


class FloesTest(OutlineTest):
    def setUp(self):
        super().setUp()
        self.write(TWO)


class Cells(FloesTest):
    def test_a_rectangle_is_the_sheet_of_its_sizes(self):
        size = "length: 14, width: 9, thickness: 0.7, element_size: 1.5, seed: 3,"
        self.write(ONE.replace("SHEET", size).replace("FLOE", ""))
        self.said("-output_dir", "out/sheet")
        self.write(ONE.replace("SHEET", "").replace(
            "FLOE", f"floe: {{names: [a], a: {{{size[:-1]}}}}}"))
        self.said("-output_dir", "out/floe")
        sheet, floe = self.lattice("out/sheet"), self.lattice("out/floe")
        np.testing.assert_array_equal(floe.pop("sets/a"), np.arange(len(floe["bodies/mass"])))
        self.assertEqual(sheet.keys(), floe.keys())
        for name, values in sheet.items():
            self.assertEqual(values.tobytes(), floe[name].tobytes(), name)
        self.assertEqual(self.rows("out/sheet"), self.rows("out/floe"))

    def test_an_outline_is_the_sheet_of_this_outline(self):
        words = "outline: FILE, outline_feature: 2, outline_scale: 2, "
        words = words.replace("FILE", str(FLOES))
        self.write(ONE.replace("SHEET", words + "outline_place: [5, -3], outline_turn: 20, "
                                                "thickness: 0.7, element_size: 3, seed: 3,")
                   .replace("FLOE", ""))
        self.said("-output_dir", "out/sheet")
        self.write(ONE.replace("SHEET", "element_size: 3, thickness: 0.7, ")
                   .replace("FLOE", "floe: {names: [a], a: {" + words +
                            "place: [5, -3], turn: 20, seed: 3}}"))
        out = self.said("-output_dir", "out/floe")
        self.assertIn("floes: 1: a ", out)
        sheet, floe = self.lattice("out/sheet"), self.lattice("out/floe")
        for name, values in sheet.items():
            self.assertEqual(values.tobytes(), floe[name].tobytes(), name)
        outline = self.summary("out/sheet")["outline"]
        one = self.summary("out/floe")["floes"]["a"]
        for key in ("area", "area_of_file", "area_moved", "corners_of_file", "simplified_to"):
            self.assertEqual(one[key], outline[key])

    def test_each_has_its_own(self):
        self.said()
        lattice = self.lattice()
        mass, x = lattice["bodies/mass"], lattice["bodies/position"]
        for name, area, thickness, size, place in (("a", 96, 0.5, 1, (-8, 1)),
                                                   ("b", 100, 0.8, 2, (6, 0))):
            of = lattice[f"sets/{name}"]
            self.assertAlmostEqual(mass[of].sum() / (DENSITY * area * thickness), 1, delta=1e-12)
            self.assertEqual(len(of), math.ceil(2 * area / (math.sqrt(3) * size**2)))
            np.testing.assert_allclose(x[of, 2], thickness * (0.5 - DENSITY / WATER), rtol=1e-13)
            centroid = (mass[of, None] * x[of]).sum(0) / mass[of].sum()
            np.testing.assert_allclose(centroid[:2], place, atol=1e-12)
            self.assertEqual(self.summary()["floes"][name]["element_size"], size)
            self.assertAlmostEqual(self.summary()["floes"][name]["area"], area, delta=1e-9)
        self.assertEqual(len(lattice["sets/a"]) + len(lattice["sets/b"]), len(mass))
        in_a = np.isin(lattice["beams/bodies"], lattice["sets/a"])
        self.assertTrue((in_a[:, 0] == in_a[:, 1]).all())
        for row in self.rows():  # they float at rest
            self.assertLess(float(row["energy_kinetic"]), 1e-12)

    def test_places_and_turns(self):
        def positions(*words):
            self.said("-output_overwrite", *words)
            lattice = self.lattice()
            return lattice["bodies/position"][lattice["sets/b"]][:, :2]
        straight = positions("-floe_b_turn", "0", "-floe_b_place", "20 9")
        angle = math.radians(30)
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        expected = (straight - (20, 9)) @ turn.T + (6, 0)
        turned = positions()
        self.assertEqual(turned.shape, expected.shape)
        # Each body of one is a body of the other; their numbers differ.
        distance = np.linalg.norm(turned[:, None] - expected[None], axis=2)
        self.assertLess(distance.min(0).max(), 1e-12)
        self.assertLess(distance.min(1).max(), 1e-12)

    def test_seeds(self):
        self.said("-output_dir", "out/1")
        self.said("-output_dir", "out/2", "-floe_b_seed", "10")
        one, two = self.lattice("out/1"), self.lattice("out/2")
        def cells(lattice, name):
            return np.sort(lattice["bodies/mass"][lattice[f"sets/{name}"]])
        np.testing.assert_array_equal(cells(one, "a"), cells(two, "a"))
        self.assertFalse(np.array_equal(cells(one, "b"), cells(two, "b")))
        # Without a seed of its own it has that of the sheet.
        self.write(TWO.replace(", seed: 9", ""))
        self.said("-output_dir", "out/3", "-sheet_seed", "10")
        np.testing.assert_array_equal(cells(self.lattice("out/3"), "b"), cells(two, "b"))

    def test_what_a_floe_does_not_say_the_sheet_says(self):
        self.write(TWO.replace(", thickness: 0.8, element_size: 2", "")
                   .replace("iterations: 20", "iterations: 20, element_size: 1.5, thickness: 0.6"))
        self.said()
        lattice = self.lattice()
        of = lattice["sets/b"]
        np.testing.assert_allclose(lattice["bodies/position"][of, 2],
                                   0.6 * (0.5 - DENSITY / WATER), rtol=1e-13)
        self.assertEqual(len(of), math.ceil(200 / (math.sqrt(3) * 1.5**2)))

    def test_a_field_of_thicknesses_for_the_others(self):
        self.write(TWO.replace(", thickness: 0.8", "").replace(
            "iterations: 20", "iterations: 20, thickness: 0.6, thickness_deviation: 0.1, "
            "thickness_correlation: [5, 5]"))
        self.said()
        lattice = self.lattice()
        z = lattice["bodies/position"][:, 2]
        np.testing.assert_allclose(z[lattice["sets/a"]], 0.5 * (0.5 - DENSITY / WATER), rtol=1e-13)
        thickness = z[lattice["sets/b"]] / (0.5 - DENSITY / WATER)
        self.assertGreater(thickness.std(), 0.02)
        self.assertAlmostEqual(thickness.mean(), 0.6, delta=0.15)

    def test_sides_of_a_turned_floe(self):
        self.write(TWO.replace("turn: 30", "turn: 90"))
        self.said()
        lattice = self.lattice()
        x = lattice["bodies/position"]
        for side, axis, sign in (("left", 0, -1), ("right", 0, 1), ("bottom", 1, -1),
                                 ("top", 1, 1)):
            of = np.intersect1d(lattice[f"sets/{side}"], lattice["sets/b"])
            self.assertGreaterEqual(len(of), 4)
            self.assertGreater((sign * (x[of, axis] - (6, 0)[axis])).min(), 3.5)  # of 5

    def test_cuts(self):
        self.write(TWO + "cut: {names: [c], c: {from: [-20, 0], to: [20, 0]}}\n")
        self.said()
        lattice = self.lattice()
        x = lattice["bodies/position"]
        i, j = lattice["beams/bodies"].T
        self.assertTrue(((x[i, 1] > 0) == (x[j, 1] > 0)).all())
        for of in (lattice["sets/a"], lattice["sets/b"]):
            self.assertTrue((x[of, 1] > 0).any() and (x[of, 1] < 0).any())

    def test_a_load_lies_on_a_floe(self):
        load = "load: {names: [p], p: {point: [POINT], force: [0, 0, 1e3]}}\n"
        self.write(TWO + load.replace("POINT", "7.5, 6"))  # on b as it is turned
        self.said()
        self.write(TWO + load.replace("POINT", "1.5, 4.5"))  # on b if it were not
        self.assertIn("load: p: point: lies outside the sheet", self.refused())


class Runs(FloesTest):
    def test_same_bits_on_two_ranks(self):
        for ranks in (1, 2):
            self.finish(self.begin("-output_dir", f"out/{ranks}", ranks=ranks))
        one, two = self.lattice("out/1"), self.lattice("out/2")
        for name, values in one.items():
            self.assertEqual(values.tobytes(), two[name].tobytes(), name)
        self.assertEqual(self.rows("out/1"), self.rows("out/2"))

    def test_restart(self):
        step = ("-time_dt", "0.0002", "-checkpoint_every", "1e5")
        self.said("-output_dir", "out/whole", *step)
        self.said("-output_dir", "out/parts", "-time_end", "0.04", *step)
        restart = ("-output_dir", "out/parts", *step, "-checkpoint_restart",
                   "out/parts/checkpoint.h5")
        self.assertIn("floe: b: seed", self.refused(*restart, "-floe_b_seed", "8"))
        self.said(*restart)
        self.assertEqual(self.rows("out/whole")[-1], self.rows("out/parts")[-1])

    def test_options_as_used(self):
        (self.folder / "plain.yaml").write_text(
            TWO.replace("seed: 9", "place: [20, 0]").replace("place: [6, 0], ", "")
            .replace("thickness: 0.5, element_size: 1, ", ""))
        for scene, dir in (("plain.yaml", "out/first"), ("out/first/options.yaml", "out/again")):
            process = self.begin("-output_dir", dir, scene=scene)
            out, err = process.communicate()
            self.assertEqual(process.returncode, 0, out + err)
        self.assertEqual(self.rows("out/first"), self.rows("out/again"))

    def test_mesh_file(self):
        self.said("-output_dir", "out/made", "-sheet_mesh_file", "m.h5")
        self.said("-output_dir", "out/read", "-sheet_mesh_file", "m.h5")
        made, read = self.lattice("out/made"), self.lattice("out/read")
        for name, values in made.items():
            self.assertEqual(values.tobytes(), read[name].tobytes(), name)
        self.assertIn("is the mesh of another sheet (its floes",
                      self.refused("-sheet_mesh_file", "m.h5", "-floe_b_seed", "8"))

    def test_motion_of_one(self):
        self.write(TWO + "initial: {names: [m], m: {set: b, velocity: [0.1, 0, 0]}}\n")
        self.said()
        self.assertAlmostEqual(float(self.rows()[0]["energy_kinetic"])
                               / (0.005 * DENSITY * 0.8 * 100), 1, delta=1e-9)


BROKEN = """integrator: explicit
forces: [beam, fracture]
sheet: {iterations: 20, thickness: 0.5, element_size: 1}
floe:
  names: [a, b]
  a: {length: 6, place: [-5, 0]}
  b: {length: 6, place: [5, 0]}
beam: {damping_ratio: 0.5}
fracture: {tensile_strength: 2e5, energy: 1}
boundary:
  names: [left, right]
  left: {set: left, fix: x}
  right: {set: right, fix: x, velocity: [1e-2, 0, 0]}
time: {end: 0.06}
output: {history: 0.01}
"""


class Strengths(FloesTest):
    """Two floes of the same cells are pulled alike."""

    def pulled(self, of_a="", of_b="", ranks=1, words=()):
        self.write(BROKEN.replace("[-5, 0]", "[-5, 0]" + of_a).replace("[5, 0]", "[5, 0]" + of_b))
        self.finish(self.begin("-output_overwrite", *words, ranks=ranks))
        return self.rows()

    def test_the_weak_one_breaks(self):
        self.assertEqual(float(self.pulled(", strength: 10", ", strength: 10")[-1]["beams_broken"]),
                         0)
        self.assertNotIn("beams/energy", self.lattice())
        rows = self.pulled(of_b=", strength: 10")
        lattice = self.lattice()
        in_b = np.isin(lattice["beams/bodies"][:, 0], lattice["sets/b"])
        np.testing.assert_array_equal(lattice["beams/strength"], np.where(in_b, 10, 1))
        broken = float(rows[-1]["beams_broken"])
        self.assertGreater(broken, 5)
        self.assertGreater(float(self.pulled()[-1]["beams_broken"]), broken)
        self.assertNotIn("beams/strength", self.lattice())
        # The other way round the other breaks, as the cells are the same.
        self.assertEqual(float(self.pulled(of_a=", strength: 10")[-1]["beams_broken"]), broken)

    def test_factors_are_those_of_fracture(self):
        both = self.pulled(", strength: 2", ", strength: 2")
        self.assertEqual(both, self.pulled(words=("-fracture_tensile_strength", "4e5")))
        tough = self.pulled(", energy: 4", ", energy: 4")
        self.assertEqual(tough, self.pulled(words=("-fracture_energy", "4")))
        self.assertNotEqual(tough, self.pulled())

    def test_on_two_ranks(self):
        one, two = (self.pulled(", energy: 2", ", strength: 2", ranks) for ranks in (1, 2))
        for a, b in zip(one, two, strict=True):
            self.assertEqual(a["beams_broken"], b["beams_broken"])
            for key in ("energy_fracture", "energy_strain"):
                self.assertAlmostEqual(float(a[key]), float(b[key]), delta=1e-9)

    def test_without_fracture(self):
        for key in ("strength", "energy"):
            self.write(TWO.replace("seed: 7", f"seed: 7, {key}: 2"))
            self.assertIn(f"floe: a: {key}: would have no effect: 'forces' does not name fracture",
                          self.refused())


class Touching(FloesTest):
    def test_at_rest(self):
        """Floes that touch along whole edges and parts of them, of one and two thicknesses."""
        for shift in (6, 3):
            self.write(TOUCHING.replace("SHIFT", str(shift)))
            self.said("-output_overwrite")
            for row in self.rows():
                self.assertLess(float(row["energy_kinetic"]), 1e-12)

    def test_turned(self):
        """The same turned: corners then are rounded numbers."""
        angle = math.radians(17)
        def place(x, y):
            return (f"[{math.cos(angle) * x - math.sin(angle) * y!r}, "
                    f"{math.sin(angle) * x + math.cos(angle) * y!r}], turn: 17")
        scene = TOUCHING.replace("width: 4, th", "width: 4, turn: 17, th")
        for x, y in ((6, 0), (3, 4)):
            scene = scene.replace(f"[{'SHIFT' if y else x}, {y}]", place(x, y))
        self.write(scene)
        self.said()
        for row in self.rows():
            self.assertLess(float(row["energy_kinetic"]), 1e-12)

    def test_they_push_each_other(self):
        self.write(TOUCHING.replace("SHIFT", "3") +
                   "initial: {names: [m], m: {set: a, velocity: [0.05, 0, 0]}}\n")
        self.said()
        first, last = (float(self.rows()[k]["energy_kinetic"]) for k in (0, -1))
        self.assertLess(last, 0.98 * first)
        self.said("-output_overwrite", "-floe_b_place", "6.1 0", "-floe_c_place", "0 4.1")
        self.assertAlmostEqual(float(self.rows()[-1]["energy_kinetic"]) / first, 1, delta=1e-9)

    def test_overlap(self):
        for shift in ("5.999", "-5.9"):
            self.write(TOUCHING.replace("[6, 0]", f"[{shift}, 0]").replace("[SHIFT, 4]", "[0, 9]"))
            self.assertIn("floe: a and floe: b overlap near (", self.refused())
        self.write(TOUCHING.replace("[6, 0]", "[0, 0]").replace("[SHIFT, 4]", "[0, 9]"))
        self.assertIn("floe: a and floe: b overlap", self.refused())


class Refused(FloesTest):
    def test_keys_of_the_sheet(self):
        for key, value in (("length", 3), ("width", 3), ("outline", "x.csv"), ("outline_turn", 3),
                           ("element_size", 1), ("seed", 2), ("thickness", 1),
                           ("thickness_seed", 3)):
            self.write(TWO.replace("iterations: 20", f"iterations: 20, {key}: {value}"))
            self.assertIn(f"sheet: {key}: would have no effect: each floe has its own",
                          self.refused())

    def test_keys_of_floes(self):
        def refused(old, new, part):
            self.write(TWO.replace(old, new))
            self.assertIn(part, self.refused())
        refused("length: 12, ", "", "floe: a: length: is missing")
        refused("length: 12, ", f"outline: {FLOES}, ",
                "floe: a: width: would have no effect: the floe's outline says it")
        for key in ("outline_scale", "outline_feature", "outline_simplify"):
            refused("length: 12, ", f"length: 12, {key}: 1, ",
                    f"floe: a: {key}: would have no effect: the floe has no outline")
        refused("element_size: 1", "element_size: 9",
                "floe: a: element_size: 9 must be <= floe: a: width 8 [m]")
        refused("length: 12, width: 8, ", "outline: none.csv, ",
                "floe: a: outline: 'none.csv': No such file")
        refused("names: [a, b]", "names: [a]", "floe: b")
        self.write(TWO.replace("[a, b]", "[left, b]").replace("  a:", "  left:"))
        self.assertIn("floe: names: 'left' is the name of a set that there is already",
                      self.refused())
        self.write(TWO + "region: {names: [b], b: {box: [-9, 9, -9, 9, -9, 9]}}\n")
        self.assertIn("region: names: 'b' is the name of a floe", self.refused())
        self.write(TWO + "lattice_file: x.h5\n")
        self.assertIn("lattice_file: a scene has either", self.refused())

    def test_an_edge_that_cells_cannot_follow(self):
        (self.folder / "o.csv").write_text(
            "0,0\n10,0\n10,6\n8,6\n8,5.7\n7.7,5.7\n7.7,6\n0,6\n")
        self.write(TWO.replace("length: 12, width: 8, ", "outline: o.csv, outline_simplify: 0, "))
        self.assertIn("floe: a: outline: 'o.csv': the polygon: no cells of floe: a: element_size: "
                      "1 can end on edge", self.refused())

    def test_what_is_for_one_sheet(self):
        self.write(TWO.replace("[beam,", "[beam, fracture,"))
        self.assertIn("fracture: flexural_strength: is for one sheet, and the scene has "
                      "'floe: names'", self.refused("-fracture_flexural_strength", "5e5"))


if __name__ == "__main__":
    unittest.main()
