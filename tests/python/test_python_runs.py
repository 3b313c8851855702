#!/usr/bin/python3
"""Runs through Python are those of the command, however they are stepped and looked at."""
import json
import unittest

import numpy as np

from in_python import PythonTest
from coupled_scenes import CONE, LEG, assert_same_run
from test_supply import LOADED, SCENE

STEPPED = """
    samples = []
    with floe.Simulation(floe.Scene("s.yaml", output_dir="python")) as sim:
        for _ in sim.run(every=0.05):
            cone = sim["cone"]
            samples.append((sim.time, *cone.wrench.force, *cone.impulse, *cone.pose.position,
                            len(sim.contacts.area), sim.energies["kinetic"],
                            int(sim.beams.broken.sum()), sim.bodies.fragment.max()))
        assert sim.ended and sim.outcome["done"]
    if floe.rank() == 0:
        print(samples)
"""


class SameAsTheCommand(PythonTest):
    def compare(self, scene, ranks):
        self.scene(scene)
        self.floe("s.yaml", "-output_dir", "command", ranks=ranks)
        out = self.python(STEPPED, ranks=ranks)
        assert_same_run(self, self.folder / "command", self.folder / "python")
        one, two = (json.loads((self.folder / name / "summary.json").read_text())
                    for name in ("command", "python"))
        for key in ("steps", "dt", "energy", "bodies", "beams", "time"):
            self.assertEqual(one[key], two[key], key)
        rows = [row for row in eval(out)]
        self.assertEqual([round(row[0], 9) for row in rows],
                         [round(0.05 * k, 9) for k in range(1, 9)])
        return rows

    def test_one_rank(self):
        rows = self.compare(CONE, 1)
        # What Python sees is the rows of the run.
        lines = (self.folder / "python/history.csv").read_text().splitlines()
        names = lines[0].split(",")
        last = dict(zip(names, map(float, lines[-1].split(","))))
        time, fx, fy, fz, ix, iy, iz = rows[-1][:7]
        for name, value in (("time", time), ("cone_force_x", fx), ("cone_force_y", fy),
                            ("cone_force_z", fz), ("contacts", rows[-1][10]),
                            ("energy_kinetic", rows[-1][11]), ("beams_broken", rows[-1][12]),
                            ("fragments", rows[-1][13] + 1)):
            self.assertAlmostEqual(value, last[name], delta=1e-11 * max(1, abs(last[name])),
                                   msg=name)
        self.assertGreater(last["cone_force_x"], 1e3)
        self.assertGreater(last["beams_broken"], 3)
        self.assertAlmostEqual(ix / 0.4, last["cone_mean_force_x"],
                               delta=1e-9 * abs(last["cone_mean_force_x"]))

    def test_two_ranks(self):
        self.compare(LEG, 2)

    def test_implicit_and_static(self):
        """Other integrators can be stepped and looked at as well."""
        scenes = {"implicit": "integrator: implicit\nforces: [beam, gravity, buoyancy]\n"
                              "time: {end: 0.02, dt: 0.001}\n",
                  "static": "forces: [beam]\ntime: {end: 1, dt: 0.25}\nboundary: {names: [a, b], "
                            "a: {set: left, fix: x y z rx ry rz}, b: {set: right, fix: x, "
                            "displacement: [0.01, 0, 0], ramp: 1}}\n"}
        for name, scene in scenes.items():
            with self.subTest(name):
                self.scene(scene + "sheet: {length: 8, thickness: 1, element_size: 2, "
                                   "iterations: 5}\n", name + ".yaml")
                self.floe(name + ".yaml", "-output_dir", name)
                out = self.python(f"""
                    with floe.Simulation(floe.Scene("{name}.yaml", output_dir="p_{name}")) as sim:
                        end = sim.end
                        for _ in sim.run(every=end / 4):
                            energies = sim.energies
                        print(len(sim.bodies.index), len(sim.beams.damage), len(sim.contacts.area),
                              sorted(energies))
                        try:
                            sim.save()
                        except floe.InputError as error:
                            print(error)
                """)
                self.assertIn("save: only runs with integrator: explicit", out)
                self.assertIn("strain", out)
                self.assertEqual((self.folder / name / "history.csv").read_bytes(),
                                 (self.folder / f"p_{name}" / "history.csv").read_bytes())


class Tables(PythonTest):
    def test_bodies_beams_and_contacts_are_those_of_the_files(self):
        """At a frame's time they are the frame's, and contacts add up to the force on the cone and
        on every body; on two ranks they are those on one, in the same order."""
        self.scene(CONE)
        script = """
            import glob, h5py
            sim = floe.Simulation(floe.Scene("s.yaml", output_dir=sys.argv[1]))
            sim.step_to(0.3)
            bodies, beams, contacts, cone = sim.bodies, sim.beams, sim.contacts, sim["cone"]
            wrench, pose, columns = cone.wrench, cone.pose, sim.columns
            assert np.array_equal(bodies.index, np.arange(len(bodies.mass)))
            on_cone = contacts.obstacle == 0
            assert on_cone.any() and (contacts.bodies[on_cone, 1] == -1).all()
            assert (contacts.bodies[~on_cone, 1] > contacts.bodies[~on_cone, 0]).all()
            force = -contacts.force[on_cone].sum(axis=0)
            assert np.allclose(force, wrench.force, rtol=1e-9), (force, wrench)
            moment = -np.cross(contacts.point - pose.position, contacts.force)[on_cone].sum(axis=0)
            size = np.abs(wrench.force).max() * 3
            assert np.abs(moment - wrench.moment).max() < 0.02 * size, (moment, wrench)  # couples
            assert (contacts.volume > 0).all() and (contacts.area > 0).all()
            assert np.allclose(np.linalg.norm(contacts.normal, axis=1), 1)
            assert (np.einsum("ij,ij->i", contacts.force, contacts.normal) >= -1e-6).all()
            assert columns["contacts"] == len(contacts.area)
            kinetic = 0.5 * (bodies.mass[:, None] * bodies.velocity ** 2).sum()
            assert 0.5 < kinetic / columns["energy_kinetic"] < 1.5
            assert bodies.fragment.max() + 1 == len(np.unique(bodies.fragment))
            joined = beams.bodies[~beams.broken]
            assert (bodies.fragment[joined[:, 0]] == bodies.fragment[joined[:, 1]]).all()
            weights = np.bincount(bodies.fragment, bodies.mass)
            assert (np.diff(weights) <= 1e-9).all() and len(weights) > 1
            sim.step_to(0.3002)  # the frame of 0.3 s has been written
            if floe.rank() == 0:
                np.savez(sys.argv[1], *bodies, *beams, *contacts)
                frames = {}
                for path in glob.glob(sys.argv[1] + "/fields/[0-9]*.h5"):
                    with h5py.File(path) as file:
                        frames.update({file[g].attrs["time"]: {k: v[()] for k, v in
                                                               file[g].items()} for g in file})
                frame = frames[min(frames, key=lambda t: abs(t - 0.3))]
                assert np.array_equal(frame["centres"], bodies.position)
                assert np.array_equal(frame["beams_force"], beams.force)
                assert np.array_equal(frame["beams_moment"], beams.moment)
                assert np.array_equal(frame["damage"], beams.damage)
        """
        self.python(script, "one")
        self.python(script, "two", ranks=2)
        one, two = (np.load(self.folder / f"{name}.npz") for name in ("one", "two"))
        for name in one.files:
            np.testing.assert_array_equal(one[name], two[name], name)


    def test_names_of_bodies_stay_where_ice_joins(self):
        """`index` is the name of a body, whichever bodies join; also on two ranks."""
        self.scene("""integrator: explicit
forces: [beam, gravity, buoyancy]
ice: {young: 4e7}
sheet: {length: 24, width: 6, thickness: 0.5, element_size: 1.5, iterations: 20}
supply: {strip: 12, length: 48}
boundary: {names: [push], push: {set: left, fix: x y z rx ry rz, velocity: [8, 0, 0]}}
initial: {names: [moving], moving: {set: all, velocity: [8, 0, 0]}}
time: {end: 3.2, dt: 5e-4}
output: {history: 0.1, overwrite: true}
""")
        for ranks in (1, 2):
            self.python("""
                sim = floe.Simulation(floe.Scene("s.yaml"))
                before, sizes = None, []
                for _ in sim.run(every=0.8):
                    now = {n: x for n, x in zip(sim.bodies.index, sim.bodies.position)}
                    assert len(now) == len(sim.bodies.index)
                    if before:
                        assert set(before) <= set(now)   # none leave
                        assert all(n > max(before) for n in set(now) - set(before))
                        for n in before:
                            assert np.abs(now[n] - before[n] - [8 * 0.8, 0, 0]).max() < 0.02
                    before = now
                    sizes.append(len(now))
                assert sizes[-1] > sizes[0], sizes
            """, ranks=ranks)



class Scenes(PythonTest):
    def test_dicts_are_the_file(self):
        """A scene of dicts makes the run of the same text, and its messages."""
        self.scene(CONE)
        out = self.python("""
            import yaml

            def numbers(x):  # YAML of Python takes 1e5 for a text
                if isinstance(x, dict):
                    return {k: numbers(v) for k, v in x.items()}
                if isinstance(x, list):
                    return [numbers(v) for v in x]
                try:
                    return float(x) if isinstance(x, str) else x
                except ValueError:
                    return x

            keys = numbers(yaml.safe_load(open("s.yaml")))
            a = floe.Scene(keys, name="s", time={"end": 0.01})
            b = floe.Scene("s.yaml", time_end=0.01)
            one, other = (numbers(yaml.safe_load(s.yaml)) for s in (a, b))
            assert one == other, (a.yaml, b.yaml)
            assert a.name == b.name == "s" and a.output == "out/s" and a.obstacles == ["cone"]
            print(a.check())
            for change in ({"sheet": {"lenght": 3}}, {"time": {"end": -1}},
                           {"forces": ["beams"]}, {"sheet": {"length": [1, 2]}}):
                try:
                    floe.Scene({**keys, **change})
                except floe.InputError as error:
                    print(error)
            try:
                floe.Scene("s.yaml", sheet_seed=1.5)
            except ValueError as error:
                print(error)
            assert "seed: 3" in floe.Scene("s.yaml", sheet_seed=3.0).yaml
            from floe.loads.statements import settings_of
            for wrong in (lambda: settings_of(filter=0.1), lambda: settings_of(draws=2.5),
                          lambda: settings_of(start="1"),
                          lambda: floe.Scene(keys, name=""), lambda: floe.open(3),
                          lambda: floe.open(""), lambda: floe.run_ensemble(3),
                          lambda: floe.run_ensemble({"scene": "s.yaml", "seeds": 2}, 3)):
                try:
                    wrong()
                except floe.InputError as error:
                    print(error)
            try:
                floe.Scene("none.yaml")
            except floe.InputError as error:
                print(error)
        """)
        self.assertIn("'bodies': ", out)
        for line in ("name: '' must be a text, which is not empty", "folder: 3 must be a path",
                     "filter: 0.1 must be a text", "draws: 2.5 must be a whole number",
                     "start: '1' must be a number",
                     "folder: '' must be a path", "spec: 3 must be a path"):
            self.assertIn(line, out)
        for line in ("sheet_lenght: unknown option; the nearest known one is 'sheet: length'",
                     "time: end: -1", "forces: ", "sheet: length: ",
                     "sheet: seed: 1.5", "none.yaml"):
            self.assertIn(line, out)
        self.assertNotIn("line ", out)
        self.assertFalse((self.folder / "out").exists(), "checks write nothing")

    def test_options_are_the_table(self):
        out = self.python("""
            table = {option.name: option for option in floe.options()}
            length = table["sheet_length"]
            print(length.key, length.kind, length.unit, length.default, len(table))
        """)
        key = "sheet: length number m 40"
        self.assertTrue(out.startswith(key), out)
        self.assertGreater(int(out.split()[-1]), 150)


class Back(PythonTest):
    def test_same_bits_after_going_back(self):
        """A run that goes back, from later and from its end, also to its first state, is the
        straight one bit for bit, and so are its files."""
        for ranks, scene in ((1, CONE), (2, LEG)):
            with self.subTest(ranks=ranks):
                self.scene(scene)
                self.python("""
                    floe.Simulation(floe.Scene("s.yaml", output_dir="straight",
                                               output_overwrite=True)).run().close()
                    sim = floe.Simulation(floe.Scene("s.yaml", output_dir="back",
                                                     output_overwrite=True))
                    start = sim.save()
                    sim.step_to(0.13)
                    first = sim.save()
                    before = sim.bodies
                    sim.step_to(0.25)
                    sim.restore(first)
                    assert abs(sim.time - 0.13) < 1e-9
                    assert all((a == b).all() for a, b in zip(sim.bodies, before))
                    sim.run()
                    assert sim.ended
                    sim.restore(first)
                    assert not sim.ended
                    sim.step_to(0.2)
                    sim.restore(start)
                    assert sim.time == 0
                    sim.step_to(0.03)
                    sim.restore(start)
                    sim.run()
                    sim.close()
                """, ranks=ranks)
                assert_same_run(self, self.folder / "straight", self.folder / "back")

    def test_where_ice_joins_and_leaves(self):
        """Likewise where ice joins and leaves between a state and the going back to it, with edges
        that are prescribed or absorb."""
        for ranks, scene, times in ((1, SCENE, (0.7, 1.3, 2.1, 2.9, 3.7)), (2, SCENE, (1.3, 2.9)),
                                    (1, LOADED, (1.2, 2.8))):
            with self.subTest(ranks=ranks, times=times):
                self.scene(scene)
                self.python(f"""
                    floe.Simulation(floe.Scene("s.yaml", output_dir="straight",
                                               output_overwrite=True)).run().close()
                    sim = floe.Simulation(floe.Scene("s.yaml", output_dir="back",
                                                     output_overwrite=True))
                    start = sim.save()
                    others = 0
                    for time in {times}:
                        sim.step_to(time)
                        state, before = sim.save(), sim.bodies
                        sim.step_to(time + 0.9)
                        others += list(sim.bodies.index) != list(before.index)
                        sim.restore(state)
                        assert all((a == b).all() for a, b in zip(sim.bodies, before))
                    assert others >= 2, others   # ice has changed, and was taken back
                    if {ranks} == 2:
                        sim.restore(start)
                    sim.run()
                    sim.close()
                """, ranks=ranks)
                assert_same_run(self, self.folder / "straight", self.folder / "back")

    def test_states_are_of_one_simulation(self):
        out = self.python("""
            from floe import Scene, Simulation
            scene = {"integrator": "explicit", "forces": ["beam"], "sheet": {"length": 6},
                     "time": {"end": 0.01}}
            a = Simulation(Scene(scene, name="a"))
            b = Simulation(Scene(scene, name="b"))
            try:
                b.restore(a.save())
            except floe.InputError as error:
                print(error)
        """)
        self.assertIn("of another simulation", out)


if __name__ == "__main__":
    unittest.main()
