#!/usr/bin/python3
"""Coupling: motions and loads that Python gives, and forces in Python."""
import unittest

from in_python import PythonTest
from coupled_scenes import CONE, LEG


class Prescribed(PythonTest):
    def test_steady_motion_is_that_of_the_scene(self):
        """A cone that Python moves steadily is the scene's moving obstacle: the same bits, also
        where it is given anew at each exchange up to rounding, and the same work on the ice."""
        self.scene(CONE)
        self.python("""
            v = np.array([-0.7, 0.1, 0.2])
            spin = np.array([0.0, 0.0, 0.3])
            def run(name, coupled=(), **options):
                return floe.Simulation(floe.Scene("s.yaml", output_dir=name, time_end=0.2,
                                                  **options), coupled=coupled)
            scene = run("scene", obstacle_cone_velocity=v, obstacle_cone_angular_velocity=spin,
                        obstacle_cone_ramp=0)
            scene.run()
            once = run("once", ["cone"])
            at = once["cone"].pose
            assert np.allclose(at.position, [7.6, 0, -3]), at
            once["cone"].prescribe(at, (v, spin))
            once.run()
            assert (last(once) == last(scene)).all()
            assert once.energies["external"] == scene.energies["external"] != 0
            pose = once["cone"].pose
            assert np.allclose(pose.position, [7.6 - 0.14, 0.02, -3 + 0.04], rtol=0, atol=1e-12)
            half = np.cos(0.03), 0, 0, np.sin(0.03)
            assert np.allclose(pose.orientation, half, rtol=0, atol=1e-12), pose
            assert np.allclose(once["cone"].velocity, (v, spin))
            assert np.allclose(once["cone"].wrench, scene["cone"].wrench, rtol=1e-9)

            # A pose that is given for a later time is reached then, on the way that keeps its
            # velocity.
            piece = run("piece", ["cone"])
            cone = piece["cone"]
            cone.prescribe(at, (v, spin))
            early = run("early", obstacle_cone_velocity=v, obstacle_cone_angular_velocity=spin,
                        obstacle_cone_ramp=0)
            for k in range(1, 9):
                t = 0.02 * k
                turn = np.cos(0.15 * t), 0, 0, np.sin(0.15 * t)
                cone.prescribe((at.position + v * t, turn), (v, spin), until=t)
                piece.step_to(t)
                early.step_to(t)
                assert np.allclose(cone.pose.position, at.position + v * t, rtol=0, atol=1e-12)
                assert np.allclose(cone.pose.orientation, turn, rtol=0, atol=1e-12)
            # Beams that break amplify rounding: at 0.2 s it would be a centimetre a second.
            assert early.beams.broken.sum() > 10 and early["cone"].wrench.force[0] > 2e5
            assert np.abs(last(piece) - last(early)).max() < 1e-11
        """)

    def test_cubic_between_exchanges(self):
        """Between two poses the obstacle moves by the cubic with their velocities, also in
        rotation, and its velocity is the rate of its place."""
        self.scene(CONE)
        self.python("""
            far = floe.Scene("s.yaml", time_end=0.2, obstacle_cone_base=[30, 0, -3])
            sim = floe.Simulation(far, coupled=["cone"])
            cone = sim["cone"]
            start = cone.pose.position
            cone.prescribe(start, ([1, 0, 0], [0, 0.5, 0]))
            end = start + [0.05, 0.02, 0]
            turn = np.cos(0.1), 0, np.sin(0.1), 0   # by 0.2 rad about y
            cone.prescribe((end, turn), ([-1, 0.3, 0], [0, -2, 0]), until=0.1)
            places, spins, rates, angles, times = [], [], [], [], []
            for k in range(101):
                sim.step_to(0.001 * k)
                times.append(sim.time)
                places.append(cone.pose.position - start)
                rates.append(cone.velocity.velocity)
                spins.append(cone.velocity.spin[1])
                angles.append(2 * np.arctan2(cone.pose.orientation[2], cone.pose.orientation[0]))
            t, x, v = np.array(times), np.array(places), np.array(rates)
            s = t / 0.1
            cubic = (3*s**2 - 2*s**3) * 0.05 + 0.1 * (s - 2*s**2 + s**3) + 0.1 * (s**3 - s**2) * -1
            assert np.abs(x[:, 0] - cubic).max() < 1e-12
            about_y = ((3*s**2 - 2*s**3) * 0.2 + 0.1 * (s - 2*s**2 + s**3) * 0.5
                       + 0.1 * (s**3 - s**2) * -2)
            assert np.abs(np.array(angles) - about_y).max() < 1e-12
            middle = (x[2:] - x[:-2]) / (t[2:] - t[:-2])[:, None]
            assert np.abs(middle - v[1:-1]).max() < 1e-3
            turning = (about_y[2:] - about_y[:-2]) / (t[2:] - t[:-2])
            assert np.abs(turning - np.array(spins)[1:-1]).max() < 2e-3
            assert np.allclose(v[-1], [-1, 0.3, 0]) and np.isclose(spins[-1], -2)
            sim.step_to(0.15)  # and then goes on
            assert np.allclose(cone.pose.position, end + 0.05 * np.array([-1, 0.3, 0]), atol=1e-9)
        """)

    def test_two_ranks(self):
        """Motion and loads on two ranks are those on one, bit for bit."""
        self.scene(LEG)
        script = """
            sim = floe.Simulation(floe.Scene("s.yaml", output_dir=sys.argv[1], time_end=0.1),
                                  coupled=["cone"])
            saved = sim.save()
            for turn in range(2):
                sim.restore(saved)
                for k in range(1, 6):
                    sim["cone"].apply([1e4 * k, 0, 0], [0, 500, 0])
                    sim.step_to(0.02 * k)
            bodies = last(sim)
            if floe.rank() == 0:
                bodies.tofile(sys.argv[1] + ".raw")
        """
        self.python(script, "one")
        self.python(script, "two", ranks=2)
        self.assertEqual((self.folder / "one.raw").read_bytes(),
                         (self.folder / "two.raw").read_bytes())


class Checkpoints(PythonTest):
    def test_a_run_goes_on_with_its_motions_and_loads(self):
        """A checkpoint keeps what Python moves and loads; a run in which nobody does is another."""
        self.scene(CONE)
        self.scene(LEG, "leg.yaml")
        self.python("""
            import shutil
            for scene in ("s.yaml", "leg.yaml"):
                def act(sim):
                    if scene == "s.yaml":
                        sim["cone"].prescribe([7.6, 0, -3], [-1, 0, 0])
                    else:
                        sim["cone"].apply([-5e4, 1e4, 0], [0, 1e4, 0])
                def make(name, **options):
                    return floe.Simulation(floe.Scene(scene, output_dir=name, time_end=0.15,
                                                      **options), coupled=["cone"])
                for name in ("whole", "part"):
                    shutil.rmtree(name, ignore_errors=True)
                whole = make("whole")
                act(whole)
                whole.run()
                part = make("part", ts_max_steps=500)
                act(part)
                part.run().close()
                for coupled in ([], ["cone"]):
                    sim = None
                    try:
                        sim = floe.Simulation(floe.Scene(
                            scene, checkpoint_restart="part/checkpoint.h5", time_end=0.15,
                            output_dir="part", ts_max_steps=750), coupled=coupled)
                        sim.run()
                    except floe.InputError as error:
                        assert not coupled, error
                        assert "a program moves or loads cone; in this one no program" in str(error)
                    else:
                        assert coupled
                    if sim is not None and coupled:
                        assert sim.time == whole.time, sim.time
                        assert (last(sim) == last(whole)).all()
                    sim and sim._free()
                whole.close()
        """)


class Applied(PythonTest):
    def test_constant_load_is_that_of_the_scene(self):
        """A force that Python applies before the first step is the scene's load, bit for bit, and
        its work is booked."""
        self.scene(LEG)
        self.scene(LEG + "load: {names: [pull], pull: {set: cone, force: [-3e4, 2e4, 1e4], "
                         "moment: [0, 1e3, 2e3], ramp: 0}}\n", "load.yaml")
        self.python("""
            load = floe.Simulation(floe.Scene("load.yaml", time_end=0.1)).run()
            sim = floe.Simulation(floe.Scene("s.yaml", time_end=0.1), coupled=["cone"])
            sim["cone"].apply([-3e4, 2e4, 1e4], [0, 1e3, 2e3])
            sim.run()
            assert (last(sim) == last(load)).all()
            assert sim.energies["external"] == load.energies["external"] != 0
            # nothing applied: another motion
            still = floe.Simulation(floe.Scene("s.yaml", output_dir="still", time_end=0.1)).run()
            assert np.abs(last(sim) - last(still)).max() > 1e-4
        """)

    def test_what_is_refused(self):
        self.scene(CONE)
        self.scene(LEG, "leg.yaml")
        out = self.python("""
            cone = floe.Scene("s.yaml", time_end=0.1)
            leg = floe.Scene("leg.yaml", output_dir="leg", time_end=0.1)
            class Nothing(floe.Force):
                def add(self, bodies):
                    pass
            def refused(work):
                try:
                    work()
                except floe.InputError as error:
                    print(error)
                else:
                    print("taken")
            refused(lambda: floe.Simulation(cone, coupled=["cane"]))
            sim = floe.Simulation(cone, coupled=["cone"])
            refused(lambda: sim["cone"].apply([1, 0, 0]))
            sim.step_to(0.05)
            refused(lambda: sim["cone"].prescribe([0, 0, 0], until=0.01))
            two = floe.Simulation(leg, coupled=["cone"])
            refused(lambda: two["cone"].prescribe([0, 0, 0]))
            two.close()
            three = floe.Simulation(floe.Scene("leg.yaml", output_dir="three"))
            refused(lambda: three["cone"].apply([0, 0, 0]))
            refused(lambda: floe.Simulation(floe.Scene({
                "forces": ["beam"], "sheet": {"length": 6}, "time": {"end": 1}}),
                forces=[Nothing()]))
            refused(lambda: sim["cone"].prescribe(([8, 0, -2], [0, 0, 0, 0])))
            refused(lambda: sim["cone"].prescribe(([8, 0, -2], [1, 0, 0, float("nan")])))
            refused(lambda: sim.step_to(float("nan")))
            refused(lambda: sim.run(every=0))
            refused(lambda: sim.restore(None))
            refused(lambda: floe.Simulation(leg, coupled="cone"))
            refused(lambda: floe.Simulation(leg, forces=[floe.Force()]))
            Nothing.stiffness = -1
            refused(lambda: floe.Simulation(leg, forces=[Nothing()]))
            try:
                three["leg"]
            except KeyError as error:
                print(error)
            try:
                sim["cone"].prescribe([0, 0])
            except ValueError as error:
                print(error)
        """).splitlines()
        for line, expected in zip(out, (
                "coupled: 'cane' is no obstacle of the scene (cone)",
                "apply: obstacle 'cone' has no mass: its motion is prescribed (prescribe)",
                "prescribe: until 0.010000 must be > 0.05",
                "prescribe: obstacle 'cone' has a mass: forces move it (apply)",
                "coupled: obstacle 'cone' is not coupled", "a program moves obstacles and gives",
                "prescribe: orientation: [0.0, 0.0, 0.0, 0.0] is no rotation",
                "orientation: [1, 0, 0, nan] must be 4 finite numbers",
                "time: nan must be a number [s]", "every: 0 must be > 0 [s]",
                "restore: None is no state of save()",
                "coupled: 'cone' must be a list of names of obstacles",
                "forces: <floe.force.Force object",
                "forces: Nothing: stiffness: -1 must be a finite number >= 0",
                "\"no obstacle 'leg' (cone)\"", "position: [0, 0] must be 3 finite numbers")):
            self.assertTrue(line.startswith(expected), f"{line}\nis not\n{expected}")
        self.assertEqual(len(out), 16)


    def test_after_ice_has_joined(self):
        """A load that Python gives a structure is that structure's, however many bodies of ice
        there are: its speed is the impulse over its mass."""
        self.scene("""integrator: explicit
forces: [beam, contact]
ice: {young: 4e7}
sheet: {length: 24, width: 6, thickness: 0.5, element_size: 1.5, iterations: 20}
contact: {young: 1e7}
supply: {strip: 12, length: 48}
boundary: {names: [push], push: {set: left, fix: x y z rx ry rz, velocity: [8, 0, 0]}}
initial: {names: [moving], moving: {set: all, velocity: [8, 0, 0]}}
obstacle:
  names: [far]
  far: {shape: cylinder, base: [0, 500, -2], radius: 2, height: 4, mass: 1000}
time: {end: 3.2, dt: 5e-4}
""")
        for ranks in (1, 2):
            self.python("""
                sim = floe.Simulation(floe.Scene("s.yaml", output_overwrite=True),
                                      coupled=["far"])
                bodies = len(sim.bodies.index)
                sim["far"].apply([300, 0, 0])
                sim.step_to(2)
                assert len(sim.bodies.index) > bodies
                sim["far"].apply([0, 500, 0])
                sim.step_to(3)
                speed = sim["far"].velocity.velocity
                assert np.allclose(speed, [0.6, 0.5, 0], rtol=1e-3, atol=1e-9), speed
                assert abs(sim.energies["external"] - 500 * (0.6 ** 2 + 0.5 ** 2)) < 1
            """, ranks=ranks)


class Forces(PythonTest):
    def test_gravity_in_python(self):
        """Weight as a force in Python is the scene's gravity, bit for bit, and its work is booked;
        it is asked once per step, with where bodies are."""
        for ranks in (1, 2):
            self.python("""
            keys = {"integrator": "explicit", "forces": ["beam"], "model": {"planar": False},
                    "sheet": {"length": 6, "width": 4, "thickness": 0.5, "element_size": 1,
                              "iterations": 5},
                    "beam": {"damping_ratio": 0.1}, "time": {"end": 0.05, "dt": 2e-4},
                    "boundary": {"names": ["wall"], "wall": {"set": "left", "fix": "x y z"}},
                    "output": {"overwrite": True}}
            class Weight(floe.Force):
                calls, times = 0, []
                def add(self, bodies):
                    self.calls += 1
                    self.times.append(bodies.time)
                    self.bodies = bodies
                    assert len(bodies) == len(bodies.mass) == len(bodies.index)
                    assert not bodies.force.any() and not bodies.position.flags.writeable
                    bodies.force[:, 2] -= 9.81 * bodies.mass

            weight = Weight()
            sim = floe.Simulation(floe.Scene(keys, name="python"), forces=[weight]).run()
            of_scene = floe.Simulation(floe.Scene(
                {**keys, "forces": ["beam", "gravity"], "gravity": 9.81}, name="scene")).run()
            assert (last(sim) == last(of_scene)).all()
            fall = of_scene.energies["gravity"]
            assert fall < -1 and abs(sim.energies["external"] / -fall - 1) < 1e-9, (
                fall, sim.energies)
            steps = sim.outcome["steps"]
            assert weight.calls == steps + 1, (weight.calls, steps)   # and for the last sample
            assert np.allclose(weight.times, np.linspace(0, 0.05, steps + 1), atol=1e-12)
            mine = sim.bodies.position[weight.bodies.index]
            assert (mine == weight.bodies.position).all()
            """, ranks=ranks)

    def test_damping_in_python(self):
        """A dashpot on every body in Python slows bodies as exp(-c t/m), and takes their energy."""
        self.python("""
            class Dashpot(floe.Force):
                damping = 3.0
                def add(self, bodies):
                    bodies.force[:] = -3.0 * bodies.mass[:, None] * bodies.velocity

            keys = {"integrator": "explicit", "forces": ["beam"],
                    "sheet": {"length": 6, "thickness": 0.5, "element_size": 2, "iterations": 5},
                    "time": {"end": 0.5, "dt": 1e-4},
                    "initial": {"names": ["go"], "go": {"set": "all", "velocity": [2, 1, 0]}}}
            sim = floe.Simulation(floe.Scene(keys), forces=[Dashpot()]).run()
            v = sim.bodies.velocity[:, :2].mean(axis=0)
            assert np.allclose(v, np.array([2, 1]) * np.exp(-1.5), rtol=1e-3), v
            mass = sim.bodies.mass.sum()
            lost = 0.5 * mass * 5 * (1 - np.exp(-3))
            assert abs(sim.energies["external"] / -lost - 1) < 1e-3
        """)

    def test_a_stiff_force_shortens_the_step(self):
        """The stable step allows for the rates that a force gives: below 2/omega and 2/damping."""
        self.python("""
            class Spring(floe.Force):
                def add(self, bodies):
                    pass
            keys = {"integrator": "explicit", "forces": ["beam"],
                    "sheet": {"length": 6, "thickness": 0.5, "element_size": 2, "iterations": 5},
                    "time": {"end": 0.01}}
            def stable(name, **rates):
                spring = Spring()
                for key, value in rates.items():
                    setattr(spring, key, value)
                sim = floe.Simulation(floe.Scene(keys, name=name), forces=[spring])
                assert sim.dt <= sim.outcome["stable_dt"]
                return sim.outcome["stable_dt"]
            beams = stable("beams")   # 2/omega of the beams
            k = (2 / beams) ** 2
            assert abs(stable("both", stiffness=3 * k) / (beams / 2) - 1) < 0.01
            c = 5 / beams
            assert abs(stable("damped", damping=c) * c / 2 - 1) < 1e-6
        """)

    def test_an_exception_pauses_the_run(self):
        """An exception in a force comes out of step_to() on its rank, as CallbackError on others;
        the run goes on from there, and is the undisturbed one bit for bit."""
        script = """
            keys = {"integrator": "explicit", "forces": ["beam"],
                    "sheet": {"length": 6, "thickness": 0.5, "element_size": 2, "iterations": 5},
                    "time": {"end": 0.05, "dt": 1e-4}}
            class Wind(floe.Force):
                fails_at = None
                def add(self, bodies):
                    if self.fails_at is not None and bodies.time >= self.fails_at:
                        self.fails_at = None
                        if floe.rank() == floe.size() - 1:
                            raise ZeroDivisionError("no wind")
                    bodies.force[:, 0] += 100.0
            plain = floe.Simulation(floe.Scene(keys, name="plain"), forces=[Wind()]).run()
            wind = Wind()
            wind.fails_at = 0.02
            sim = floe.Simulation(floe.Scene(keys, name="failed"), forces=[wind])
            try:
                sim.run()
            except ZeroDivisionError as error:
                assert floe.rank() == floe.size() - 1 and str(error) == "no wind"
            except floe.CallbackError as error:
                assert floe.rank() < floe.size() - 1 and "another rank" in str(error), error
            else:
                raise AssertionError
            assert abs(sim.time - 0.02) < 1e-9 and not sim.ended, sim.time
            sim.run()
            assert (last(sim) == last(plain)).all()
            assert sim.results["status"] == "done"
        """
        for ranks in (1, 2):
            self.python(script, ranks=ranks)

    def test_an_uncaught_exception_ends_all_ranks(self):
        out = self.python("""
            class Bad(floe.Force):
                def add(self, bodies):
                    if floe.rank() == 1 and bodies.time > 0.01:
                        raise ZeroDivisionError("no wind")
            sim = floe.Simulation(floe.Scene({
                "integrator": "explicit", "forces": ["beam"],
                "sheet": {"length": 6, "thickness": 0.5, "element_size": 2, "iterations": 5},
                "time": {"end": 0.05, "dt": 1e-4}}), forces=[Bad()])
            try:
                sim.run()
            except floe.CallbackError:
                import time
                time.sleep(1000)
        """, ranks=2, code=1)
        self.assertIn("ZeroDivisionError: no wind", out)


if __name__ == "__main__":
    unittest.main()
