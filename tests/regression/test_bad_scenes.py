#!/usr/bin/python3
"""Scenes that floe refuses: see bad_input.py."""
import unittest

from bad_input import (BREAKABLE, FILE, FLOATING, FLOOR, GOOD, HELD, MOVING, SHEET, TOUCHING,
                       BadInput, held,
                       loaded, obstacle, scene_file)

ADRIFT = "integrator: explicit\n" + FLOATING + "time: {end: 1}\n"
RAMPED = loaded("set: right, force: [1, 0, 0], ramp: 1")

SCENES = {
    "broken YAML": ("forces: [beam\nsheet: 3\n", "line 2"),
    "tab": ("forces: [beam]\n\tsheet: 3\n", "line 2"),
    "key given twice": (GOOD + "forces: [beam]\n", "given twice"),
    "two keys that join to one name": (GOOD + "sheet_length: 1\n", "given twice"),
    "list of maps": (GOOD + "region: [{r: 1}]\n", "list"),
    "two documents": (GOOD + "---\nforces: [beam]\n", "document"),
    "not a map": ("- 1\n- 2\n", "map"),
    "empty": ("", "forces"),
    "no forces": (SHEET, "forces"),
    "no sheet": ("forces: [beam]\n", "sheet"),
    "misspelt key": (GOOD + "ice: {yuong: 1}\n", "ice: young"),
    "misspelt section": (GOOD + "ise: {young: 1}\n", "ice: young"),
    "value for a section": (GOOD + "ice: 3\n", "section"),
    "wrong type": (GOOD + "ice: {young: stiff}\n", "ice: young: stiff"),
    "wrong word": (GOOD + "beam: {shear: strong}\n", "one_point"),
    "wrong force": ("forces: [beam, wind]\n" + SHEET, "wind"),
    "nan": (GOOD + "ice: {young: nan}\n", "nan"),
    "infinite": (GOOD + "ice: {young: .inf}\n", "inf"),
    "negative thickness": (GOOD, "sheet: thickness: -1", ["-sheet_thickness", "-1"]),
    "element larger than the sheet": (GOOD, "sheet: element_size", ["-sheet_element_size", "11"]),
    "more bodies than memory": (GOOD, "sheet: element_size", ["-sheet_element_size", "1e-6"]),
    "negative seed": (GOOD, "sheet: seed: -1", ["-sheet_seed", "-1"]),
    "Poisson's ratio": (GOOD + "ice: {poisson: 0.5}\n", "ice: poisson"),
    "a sheet that sinks": (FLOATING + "ice: {density: 1100}\n", "ice: density"),
    "fracture without beams": ("forces: [fracture, gravity, buoyancy]\n" + SHEET, "needs beam"),
    "fracture that is not named": (GOOD + "fracture: {energy: 15}\n",
                                   "'fracture' is not in 'forces'"),
    "strength of a sheet": (BREAKABLE + "fracture: {calibrate: sheet}\n", "none | strength"),
    "strength of a lattice file": ("forces: [beam, fracture]\nlattice_file: bad.h5\n"
                                   "fracture: {calibrate: strength}\n",
                                   "fracture: calibrate: needs 'sheet'"),
    "strength of a row of bodies": (BREAKABLE + "fracture: {calibrate: strength}\n",
                                    "sheet: width: must be of more than one row",
                                    ["-sheet_length", "4", "-sheet_width", "1",
                                     "-sheet_element_size", "1"]),
    "flexural strength of a lattice file": ("forces: [beam, fracture]\nlattice_file: bad.h5\n"
                                            "fracture: {flexural_strength: 5e5}\n",
                                            "fracture: flexural_strength: needs 'sheet'"),
    "flexural strength of a row of bodies": (BREAKABLE + "fracture: {flexural_strength: 5e5}\n",
                                             "sheet: width: must be of more than one row",
                                             ["-sheet_length", "4", "-sheet_width", "1",
                                              "-sheet_element_size", "1"]),
    "no flexural strength": (BREAKABLE + "fracture: {flexural_strength: 0}\n",
                             "fracture: flexural_strength: 0"),
    "no compressive strength": (BREAKABLE + "fracture: {compressive_strength: -3e6}\n",
                                "fracture: compressive_strength: -3e6"),
    "weak in compression": (BREAKABLE + "fracture: {shear_strength: 6e5, "
                            "compressive_strength: 1e6}\n",
                            "fracture: compressive_strength: 1e+06 must be >= 2 x fracture: "
                            "shear_strength: 600000 [Pa]"),
    "strength that does not scatter": (BREAKABLE + "fracture: {seed: 3}\n", "weibull_modulus"),
    "no strength": (BREAKABLE + "fracture: {tensile_strength: 0}\n",
                    "fracture: tensile_strength: 0"),
    "a path in dynamics": (MOVING + "static: {path: arc}\n", "static: path: would have no effect"),
    "settings of a path without one": (GOOD + "static: {steps: 5}\n", "'static: path' is load"),
    "a path without a load": (GOOD + "static: {path: arc}\n", "no load to scale"),
    "a path with a constant load": (loaded("set: right, force: [1, 0, 0]")
                                    + "static: {path: arc}\n", "no load to scale"),
    "a path with a longer ramp": (loaded("set: right, force: [1, 0, 0], ramp: 2")
                                  + "static: {path: arc}\n",
                                  "load: p: ramp: 2 must be time: end 1"),
    "a path with a ramp of a velocity": (held("fix: x, velocity: [1, 0, 0], ramp: 1")
                                         + "static: {path: arc}\n",
                                         "boundary: a: ramp: 1 must be 0"),
    "a path with load steps": (RAMPED + "static: {path: arc}\ntime: {dt: 0.1}\n",
                               "time: dt: would have no effect"),
    "an arc longer than the longest": (RAMPED + "static: {path: arc, arc_length: 2, "
                                       "arc_length_max: 1}\n",
                                       "static: arc_length_max: 1 must be >= static: arc_length 2"),
    "an arc shorter than the shortest": (RAMPED + "static: {path: arc, arc_length: 1, "
                                         "arc_length_min: 2}\n",
                                         "static: arc_length_min: 2 must be <= "
                                         "static: arc_length 1"),
    "no steps": (RAMPED + "static: {path: arc, steps: 0}\n", "static: steps: 0"),
    "a path of more steps than allowed": (RAMPED + "static: {path: arc, steps: 20}\n"
                                          "limit: {steps: 10}\n",
                                          "static: steps: 20 are more than 10 (limit: steps)"),
    "an unknown monitor": (RAMPED + "static: {path: arc, monitor: q, monitor_displacement: 1}\n",
                           "static: monitor: 'q' is neither"),
    "a monitor without displacement": (RAMPED + "static: {path: arc, monitor: p}\n",
                                       "static: monitor_displacement"),
    "a displacement without monitor": (RAMPED + "static: {path: arc, monitor_displacement: 1}\n",
                                       "without 'static: monitor'"),
    "growth without fracture": (RAMPED + "static: {path: arc, growth: 0.1}\n",
                                "without 'forces: fracture'"),
    "a path with a report of bending": (RAMPED.replace("[beam]", "[beam, gravity, buoyancy]")
                                        .replace("set: right, force: [1, 0, 0]",
                                                 "point: [0, 0], force: [0, 0, -1]")
                                        + "static: {path: arc}\nreport: bending\n",
                                        "'static: path' is arc"),
    "form drag without faces": (ADRIFT.replace("buoyancy", "buoyancy, drag")
                                + "water: {drag_linear: 1, drag_form: 1}\n", "water: drag: faces"),
    "plan drag on faces": (ADRIFT.replace("buoyancy", "buoyancy, drag")
                           + "water: {drag: faces, drag_coefficient: 1}\n",
                           "water: drag_coefficient"),
    "added mass that is no number": (ADRIFT + "water: {added_mass: disc}\n", "or plate"),
    "a pace of 0": (ADRIFT + "water: {pace: 0}\n", "water: pace: 0"),
    "a pace of half a step": (ADRIFT + "water: {pace: 1.5}\n", "water: pace: 1.5"),
    "a pace of Runge and Kutta": (ADRIFT + "water: {pace: 2}\n", "only leapfrog",
                                  ["-ts_type", "rk"]),
    "a pace in statics": (FLOATING + "water: {pace: 2}\n", "only leapfrog"),
    "added mass twice": (ADRIFT + "water: {added_mass: 1, added_mass_axes: [1, 1, 1, 1, 1, 1]}\n",
                         "give one of them"),
    "waves without height": (ADRIFT + "waves: {period: 5}\n", "waves: height"),
    "waves that do not move": (FLOATING + "waves: {height: 1, period: 5}\n", "quasistatic"),
    "waves shorter than bodies": (ADRIFT + "waves: {height: 0.1, period: 1}\n", "8 bodies"),
    "phase of a sea": (ADRIFT + "waves: {spectrum: jonswap, height: 1, period: 9, phase: 3}\n",
                       "waves: phase"),
    "buoyancy without gravity": ("forces: [beam, buoyancy]\n" + SHEET, "gravity"),
    "section of a force that is not named": (GOOD + "water: {density: 1000}\n", "water: density"),
    "gravity that does not act": (GOOD + "gravity: 9.81\n", "gravity"),
    "sheet and lattice file": (GOOD + "lattice_file: a.h5\n", "lattice_file"),
    "lattice file that is not there": (FILE, "bad.h5"),
    "ice with a lattice file": (FILE + "ice: {young: 1}\n", "ice: young"),
    "unknown set of a boundary": (GOOD.replace("set: left", "set: lefft"), "lefft"),
    "unknown set of a load": (loaded("set: rihgt, force: [1, 0, 0]"), "rihgt"),
    "four numbers for a vector": (loaded("set: right, force: [1, 2, 3, 4]"),
                                  "load: p: force: 1,2,3,4"),
    "two numbers for a vector": (loaded("set: right, force: [1, 2]"), "load: p: force: 1,2"),
    "Poisson's ratio that no lattice has":
        (GOOD + "ice: {poisson: 0.4}\nbeam: {calibrate: isotropic}\n",
         "ice: poisson: 0.4 must be <= 1/3"),
    "shear of a calibrated sheet": (GOOD + "beam: {calibrate: isotropic, shear: exact}\n",
                                    "beam: shear"),
    "torsion of a calibrated sheet": (GOOD + "beam: {calibrate: isotropic, torsion: polar}\n",
                                      "beam: torsion"),
    "calibration of a sheet without inner bodies":
        ("forces: [beam]\nsheet: {length: 10, thickness: 1.5, element_size: 4.5}\n"
         "beam: {calibrate: young}\n" + HELD,
         "beam: calibrate: a sheet of 6 bodies"),
    "unknown calibration": (GOOD + "beam: {calibrate: bending}\n", "none | young | isotropic"),
    "calibration of a file": (FILE + "beam: {calibrate: young}\n", "beam: calibrate"),
    "load on a set and at a point": (loaded("set: right, point: [0, 0], force: [1, 0, 0]"),
                                     "not both"),
    "load nowhere": (loaded("force: [1, 0, 0]"), "set or point"),
    "load beside the sheet": (loaded("point: [6, 0], force: [0, 0, 1]"), "load: p: point"),
    "report of bending under two loads":
        (FLOATING + "load: {names: [p, q], p: {point: [0, 0], force: [0, 0, -1], ramp: 1},"
         " q: {point: [1, 0], force: [0, 0, -1], ramp: 1}}\nreport: [bending]\n",
         "report: bending"),
    "unlisted load": (GOOD + "load: {p: {set: right, force: [1, 0, 0]}}\n", "load: names"),
    "listed load without a section": (GOOD + "load: {names: [p]}\n", "no such section"),
    "name given twice": (GOOD + "load: {names: [p, p], p: {set: right, force: [1, 0, 0]}}\n",
                         "p,p"),
    "nothing fixed": (held("ramp: 1"), "boundary: a: fix"),
    "value for a free component": (held("fix: x, velocity: [0, 1, 0]"), "'y'"),
    "component fixed twice": (held("fix: x x"), "x x"),
    "velocity and displacement": (held("fix: x, velocity: [1, 0, 0], displacement: [1, 0, 0]"),
                                  "not both"),
    "displacement at once, with time":
        ("integrator: explicit\n" + held("fix: x, displacement: [1, 0, 0]") + "time: {end: 1}\n",
         "boundary: a: displacement needs ramp > 0"),
    "nothing holds the sheet against its load":
        ("forces: [beam]\n" + SHEET + "load: {names: [p], p: {set: right, force: [1, 0, 0]}}\n",
         "hold"),
    "two boundaries that disagree":
        ("forces: [beam]\n" + SHEET + "boundary:\n  names: [a, b]\n  a: {set: all, fix: x}\n"
         "  b: {set: left, fix: x, displacement: [1, 0, 0]}\n", "boundary: "),
    "region without bodies": (GOOD + "region: {names: [r], r: {box: 90 91 0 1 0 1}}\n",
                              "region: r"),
    "region upside down": (GOOD + "region: {names: [r], r: {box: 1 0 0 1 0 1}}\n",
                           "region: r: box"),
    "cut beside the sheet": (GOOD + "cut: {names: [c], c: {from: [9, -9], to: [9, 9]}}\n",
                             "cut: c"),
    "contact in statics": (TOUCHING, "forces: contact", ["-integrator", "quasistatic"]),
    "contact in implicit steps": (TOUCHING + "contact: {young: 1e9}\ntime: {end: 1}\n",
                                  "forces: contact: integrator: implicit cannot step it",
                                  ["-integrator", "implicit"]),
    "fracture in implicit steps": (BREAKABLE + "time: {end: 1}\n",
                                   "take integrator: explicit or quasistatic, or leave fracture "
                                   "out",
                                   ["-integrator", "implicit"]),
    "fracture in Runge-Kutta steps": ("integrator: explicit\n" + BREAKABLE + "time: {end: 1}\n",
                                      "take leapfrog (without -ts_type)",
                                      ["-ts_type", "rk"]),
    "contact in Runge-Kutta steps": (TOUCHING + "contact: {young: 1e9}\ntime: {end: 1}\n",
                                     "forces: contact: ts_type: rk cannot step it",
                                     ["-ts_type", "rk"]),
    "contact that does not act": (GOOD + "contact: {friction: 0.1}\n", "contact: friction"),
    "obstacle that does not act": (GOOD + FLOOR, "obstacle"),
    "restitution above 1": (TOUCHING + "contact: {restitution: 1.1}\n", "contact: restitution"),
    "negative friction": (TOUCHING + "contact: {friction: -0.1}\n", "contact: friction"),
    "obstacle of no known shape": (obstacle("shape: sphere"), "sphere"),
    "obstacle without a shape": (obstacle("friction: 0.1"), "obstacle: o: shape"),
    "half-space without a direction": (obstacle("shape: halfspace, normal: [0, 0, 0]"),
                                       "obstacle: o: normal"),
    "flat box": (obstacle("shape: box, size: [1, 0, 1]"), "obstacle: o: size"),
    "cylinder of two facets": (obstacle("shape: cylinder, facets: 2"), "obstacle: o: facets"),
    "half-space whose direction overflows": (obstacle("shape: halfspace, normal: [1e200, 0, 0]"),
                                             "obstacle: o: normal"),
    "obstacle around a body": (obstacle("shape: box, size: [30, 30, 30]"),
                               "obstacle: o: body 0 lies wholly inside"),
    "half-space the wrong way round":
        (obstacle("shape: halfspace, point: [0, 0, -5], normal: [0, 0, -1]"),
         "obstacle: o: body 0 lies wholly inside"),
    "contacts of no stable step": (TOUCHING + FLOOR.replace("shape: halfspace",
                                                            "point: [0, 0, -0.5], shape: halfspace")
                                   + "contact: {young: 1e15}\ntime: {end: 1e12}\n", "time: dt"),
    "a step of no use": (MOVING, "steps to time: end", ["-time_dt", "1e-15"]),
    "radius of a box": (obstacle("shape: box, radius: 1"), "obstacle: o: radius"),
    "half-space that turns":
        (obstacle("shape: halfspace, angular_velocity: [0, 0, 1]"),
         "obstacle: o: angular_velocity"),
    "oscillation without a frequency":
        (obstacle("shape: box, amplitude: [0, 0, 1]"),
         "obstacle: o: amplitude [m] needs frequency"),
    "oscillation without an amplitude":
        (obstacle("shape: box, frequency: 1"), "obstacle: o: frequency [Hz] needs amplitude"),
    "ramp of an obstacle at rest": (obstacle("shape: box, ramp: 1"), "obstacle: o: ramp"),
    "frequency of 0":
        (obstacle("shape: box, amplitude: [0, 0, 1], frequency: 0"), "obstacle: o: frequency"),
    "obstacle from a file that is not there": (obstacle("shape: file, file: none.h5"), "none.h5"),
    "lattice file without a stiffness of contacts":
        ("integrator: explicit\nforces: [contact]\nlattice_file: bad.h5\n", "contact: young"),
    "two sections of initial motion on one set":
        (MOVING + "initial: {names: [i, j], i: {set: left, velocity: [1, 0, 0]}, j: {set: "
                  "left, velocity: [2, 0, 0]}}\n",
         "has its motion from 'initial: i' already"),
    "two sections of initial motion on sets that overlap":
        (MOVING + "initial: {names: [i, j], i: {set: all, velocity: [1, 0, 0]}, j: {set: "
                  "left, velocity: [1, 0, 0]}}\n",
         "initial: j: set: body "),
    "section with a capital letter": (GOOD.replace("sheet:", "Sheet:"),
                                      "unknown option; keys are in lower case: 'sheet_"),
    "name with an underscore": (GOOD + "obstacle: {names: [my_leg], my_leg: {shape: box, centre: "
                                       "[9, 0, 0], size: [2, 2, 6]}}\n",
                                "obstacle: names: 'my_leg' is no name: a name has letters and "
                                "digits, at most 40"),
    "key with a capital letter": (GOOD.replace("length:", "Length:"),
                                  "keys are in lower case: 'sheet_length'"),
    "load step beyond the end": (GOOD + "time: {end: 1, dt: 2}\n", "time: dt"),
    "output below a regular file": (GOOD + "output: {dir: scene.yaml/out}\n", "output: dir"),
    "output in place of a regular file": (GOOD + "output: {dir: scene.yaml}\n", "output: dir"),
}


class Scenes(BadInput):
    pass


for title, (scene, part, *words) in SCENES.items():
    Scenes.case(title, ["scene.yaml", *(words[0] if words else [])], part, scene_file(scene))


if __name__ == "__main__":
    unittest.main()
