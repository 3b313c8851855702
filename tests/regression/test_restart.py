#!/usr/bin/python3
"""Checkpoint and restart: a run that was interrupted and went on equals the run that was not.

By the STOP file, by SIGTERM, by kill -9 at random moments, bit for bit; what a restart refuses, and
what a full disk does. On several ranks: test_restart_ranks.py. FLOE_FULL=1 kills 20 times instead
of 3.
"""
import csv
import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

from launch import ENDLESS, ENVIRONMENT, FLOE, FULL, REPOSITORY, FolderTest, on_ranks, own_words

sys.path.insert(0, str(REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402
from floe.results.output import frames_of  # noqa: E402

# Damping loss, load work, boundary work and the water's forces all have a history or energies of
# their own. Rows of history.csv and frames are due at different steps.
SCENE = """integrator: explicit
forces: [beam, gravity, buoyancy, drag]
water: {drag_linear: 1e4}
sheet: {length: 20, element_size: 2, iterations: 20}
beam: {damping_ratio: 0.2}
boundary:
  names: [left, right]
  left: {set: left, fix: x}
  right: {set: right, fix: x, velocity: [0.01, 0, 0]}
load: {names: [p], p: {point: [1, 1], force: [0, 0, -1e5], moment: [0, 1e4, 0], ramp: 0.1}}
time: {end: 10}
output: {history: 0.041, fields: 0.37}
checkpoint: {every: 1000}
"""
# The same sheet, pulled in still water and pushed sideways: what moves it stays in its plane.
PLANAR = (SCENE.replace("forces: [beam, gravity, buoyancy, drag]",
                        "forces: [beam, drag]\nmodel: {planar: true}")
          .replace("force: [0, 0, -1e5], moment: [0, 1e4, 0]",
                   "force: [1e4, 1e5, 0], moment: [0, 0, 1e4]"))
INTERRUPTED = 3
TIMES = {"wall_s", "mesh_s", "lattice_s", "partition_s", "forces_s", "tangent_s", "solve_s",
         "output_s",
         "peak_memory_mb", "ns_per_beam_step"}


def contents(path):
    """Every dataset and attribute of an HDF5 file."""
    found = {}

    def visit(name, item):
        for key, value in item.attrs.items():
            found[name + "@" + key] = value
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]
    with h5py.File(path) as file:
        file.visititems(visit)
    return found


class RestartTest(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(SCENE)

    def begin(self, *options, dir="out/scene", ranks=1, scene="scene.yaml", **how):
        """A started process."""
        process = subprocess.Popen(on_ranks(ranks, [FLOE, scene, *options, "-output_dir", dir]),
                                   cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=ENVIRONMENT, **how)
        self.addCleanup(self.end, process)
        return process

    def finish(self, process, code=0):
        """What a process that must end with `code` said on its standard error."""
        out, err = process.communicate()
        self.assertEqual(process.returncode, code, out + err)
        return own_words(err)

    def run_whole(self, *options, **how):
        self.finish(self.begin(*options, **how))
        return self.folder / how.get("dir", "out/scene")

    def interrupted(self, interrupt, *options, dir="b", ranks=1):
        """A run without an end that `interrupt(process, folder)` stops once its history has some
        rows."""
        process = self.begin(*options, *ENDLESS, dir=dir, ranks=ranks)
        self.wait_for_rows(process, self.folder / dir, 20)
        interrupt(process, self.folder / dir)
        return process

    def wait_for(self, process, what):
        """Until what() is true, as long as it takes."""
        while not what():
            if process.poll() is not None:
                self.fail("the run ended before it was interrupted: "
                          + "".join(process.communicate()))
            time.sleep(0.002)

    def wait_for_rows(self, process, folder, rows):
        self.wait_for(process, lambda: rows_of(folder) > rows)

    def wait_for_checkpoint(self, process, folder):
        """A new one."""
        def number():
            return (folder
                    / "checkpoint.h5").stat().st_ino if (folder
                                                         / "checkpoint.h5").exists() else None
        before = number()
        self.wait_for(process, lambda: number() != before)

    def steps_of(self, dir):
        """Steps up to the checkpoint of a folder."""
        with h5py.File(self.folder / dir / "checkpoint.h5") as file:
            return int(file["run/step"][()])

    def straight_and_resumed(self, *options, dir="b", ranks=1, straight_ranks=None):
        """Two folders: a straight run, and that of an endless run that was interrupted and goes on
        to the same step."""
        end = ("-ts_max_steps", str(3 * self.steps_of(dir) // 2))
        straight = self.run_whole(*options, *ENDLESS, *end, dir="straight_" + dir,
                                  ranks=straight_ranks or ranks)
        return straight, self.go_on(*options, *ENDLESS, *end, dir=dir, ranks=ranks)

    def go_on(self, *options, dir="b", ranks=1):
        return self.run_whole("-checkpoint_restart", f"{dir}/checkpoint.h5", *options, dir=dir,
                              ranks=ranks)

    def assert_same(self, a, b):
        """Two folders hold the same run, bit for bit."""
        self.assertEqual((a / "history.csv").read_text(), (b / "history.csv").read_text())
        self.assertEqual((a / "fields.xmf").read_text(), (b / "fields.xmf").read_text())
        segments = sorted(str(path.relative_to(a)) for path in a.glob("fields/*.h5"))
        self.assertEqual(segments, sorted(str(path.relative_to(b))
                                          for path in b.glob("fields/*.h5")))
        for name in (*segments, "checkpoint.h5", "lattice.h5"):
            first, second = contents(a / name), contents(b / name)
            self.assertEqual(set(first), set(second), name)
            for key in set(first) - {"options", "output/run"}:
                np.testing.assert_array_equal(first[key], second[key], f"{name}: {key}")
        one, two = (json.loads((f / "summary.json").read_text()) for f in (a, b))
        self.assertEqual({k: v for k, v in one.items() if k not in TIMES},
                         {k: v for k, v in two.items() if k not in TIMES})
        options = [(f / "options.yaml").read_text().replace(f"dir: {f.name}", "") for f in (a, b)]
        self.assertEqual(*options)

    def check_stopped(self, how, ranks=1):
        """A run that stops as `how` asks says how to go on, and then equals the straight run."""
        said = self.finish(self.interrupted(how, ranks=ranks), INTERRUPTED)
        self.assertIn("floe scene.yaml -checkpoint_restart b/checkpoint.h5 ", said)
        self.assertFalse((self.folder / "b/STOP").exists())
        summary = json.loads((self.folder / "b/summary.json").read_text())
        self.assertEqual(summary["status"], "stopped")
        self.assertEqual(summary["steps"], self.steps_of("b"))
        self.assert_same(*self.straight_and_resumed(ranks=ranks))

    def check_parts(self, scene, stops, *options):
        """A run in parts, which end at the given shares of its steps, is the run in one piece; its
        summary."""
        (self.folder / "scene.yaml").write_text(scene)
        a = self.run_whole(*options, dir="a")
        summary = json.loads((a / "summary.json").read_text())
        resume = []
        for part in stops:
            end = ["-ts_max_steps", str(int(part * summary["steps"]))]
            self.run_whole(*options, *end, *resume, dir="b")
            resume = ["-checkpoint_restart", "b/checkpoint.h5"]
        b = self.go_on(*options)
        rows = set((b / "history.csv").read_text().split("\n"))  # and one at the end of each part
        for row in (a / "history.csv").read_text().split("\n"):
            self.assertIn(row, rows)
        first, second = contents(a / "checkpoint.h5"), contents(b / "checkpoint.h5")
        self.assertEqual(first["run/step"], second["run/step"])
        for name, values in first.items():
            if name == "bodies/records" or name.startswith("force_"):
                np.testing.assert_array_equal(values, second[name], name)
        return summary


def rows_of(folder):
    """Lines of a history that may not be there yet."""
    history = folder / "history.csv"
    return history.read_text().count("\n") if history.exists() else 0


def stop_file(process, folder):
    (folder / "STOP").touch()


def terminate(process, folder):
    process.send_signal(signal.SIGTERM)


def interrupt(process, folder):
    process.send_signal(signal.SIGINT)


class Stopped(RestartTest):
    def test_by_file(self):
        self.check_stopped(stop_file)

    def test_by_sigterm(self):
        self.check_stopped(terminate)

    def test_by_sigint(self):
        self.check_stopped(interrupt)

    def test_twice(self):
        self.finish(self.interrupted(stop_file), INTERRUPTED)
        before = rows_of(self.folder / "b")
        process = self.begin("-checkpoint_restart", "b/checkpoint.h5", *ENDLESS, dir="b")
        self.wait_for_rows(process, self.folder / "b", before + 20)
        terminate(process, self.folder / "b")
        self.finish(process, INTERRUPTED)
        self.assert_same(*self.straight_and_resumed())


class StoppedInThePlane(Stopped):
    """All of the above with three unknowns per body."""

    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(PLANAR)


class GoingOn(RestartTest):
    def test_end_may_be_later(self):
        folder = self.run_whole("-time_end", "1", dir="b")
        before = json.loads((folder / "summary.json").read_text())
        rows = (folder / "history.csv").read_text()
        self.go_on("-time_end", "2")
        after = json.loads((folder / "summary.json").read_text())
        self.assertEqual(after["dt"], before["dt"])
        self.assertEqual(after["steps"], 2 * before["steps"])
        self.assertAlmostEqual(after["time"], 2, 9)
        self.assertTrue((folder / "history.csv").read_text().startswith(rows))
        self.assertLess(abs(after["energy"]["balance_error"]), 1e-3 * after["energy"]["strain"])

    def test_a_finished_run_changes_nothing(self):
        a, b = (self.run_whole("-time_end", "1", dir=d) for d in "ab")
        self.go_on("-time_end", "1")
        self.assert_same(a, b)

    def test_without_section_no_checkpoint_is_left(self):
        (self.folder / "scene.yaml").write_text(SCENE.replace("checkpoint: {every: 1000}\n", ""))
        folder = self.run_whole("-time_end", "1")
        self.assertFalse((folder / "checkpoint.h5").exists())

    def test_by_the_clock(self):
        process = self.begin("-checkpoint_every", "0.01", *ENDLESS, dir="b")
        self.wait_for(process, (self.folder / "b/checkpoint.h5").exists)
        stop_file(process, self.folder / "b")
        self.finish(process, INTERRUPTED)


class Refused(RestartTest):
    def refused(self, *options, dir="b"):
        """The line that a restart is refused with; nothing in the folder has changed."""
        folder = self.folder / dir
        before = self.bytes_of(folder)
        said = self.finish(self.begin(*options, dir=dir), 2)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertEqual(before, self.bytes_of(folder))
        return said

    @staticmethod
    def bytes_of(folder):
        return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}

    def setUp(self):
        super().setUp()
        self.run_whole("-time_end", "1", dir="b")

    def test_no_checkpoint(self):
        self.assertIn("'nowhere.h5' does not exist",
                      self.refused("-checkpoint_restart", "nowhere.h5"))
        for file in ("scene.yaml", "b/lattice.h5"):
            self.assertIn(f"'{file}' is no checkpoint of this version of floe",
                          self.refused("-checkpoint_restart", file))

    def test_another_lattice(self):
        """A file of the same name may hold another one."""
        scene = SCENE.replace("sheet: {length: 20, element_size: 2, iterations: 20}",
                              "lattice_file: sheet.h5")
        (self.folder / "scene.yaml").write_text(scene)
        (self.folder / "sheet.h5").write_bytes((self.folder / "b/lattice.h5").read_bytes())
        self.run_whole("-time_end", "1", dir="f")
        with h5py.File(self.folder / "sheet.h5", "r+") as file:
            file["beams/young"][0] *= 1.001
        said = self.refused("-checkpoint_restart", "f/checkpoint.h5", dir="f")
        self.assertIn("is of another lattice", said)

    def test_an_obstacle_of_another_shape(self):
        """A file of the same name may hold another one."""
        (self.folder / "scene.yaml").write_text(
            SCENE.replace("drag]", "drag, contact]")
            + "obstacle: {names: [o], o: {shape: file, file: o.h5, point: [50, 0, 0]}}\n")
        fl.block([1, 1, 1]).write(self.folder / "o.h5")
        self.run_whole("-time_end", "1", dir="f")
        fl.block([1, 1, 1 + 1e-12]).write(self.folder / "o.h5")
        said = self.refused("-checkpoint_restart", "f/checkpoint.h5", dir="f")
        self.assertIn("is of obstacles of other shapes: a file of theirs has changed", said)
        fl.block([1, 1, 1]).write(self.folder / "o.h5")
        self.run_whole("-checkpoint_restart", "f/checkpoint.h5", "-time_end", "2", dir="f")

    def test_other_forces(self):
        said = self.refused("-checkpoint_restart", "b/checkpoint.h5", "-forces", "beam,drag",
                            "-time_end", "2")
        self.assertIn("forces: 'beam, drag' cannot be changed where a run goes on; "
                      "the checkpoint has "
                      "'beam, gravity, buoyancy, drag'", said)

    def test_another_space(self):
        (self.folder / "scene.yaml").write_text(PLANAR)
        self.run_whole("-time_end", "1", dir="p")
        said = self.refused("-checkpoint_restart", "p/checkpoint.h5", "-model_planar", "false",
                            dir="p")
        self.assertIn("model: planar: false cannot be changed where a run goes on; "
                      "the checkpoint has true", said)
        # One that decides by itself may come to decide otherwise.
        (self.folder / "scene.yaml").write_text(PLANAR.replace("planar: true", "planar: auto"))
        self.run_whole("-time_end", "1", dir="s")
        said = self.refused("-checkpoint_restart", "s/checkpoint.h5", "-load_p_force", "0,0,1",
                            dir="s")
        self.assertIn("is of a planar model, this run's is spatial", said)

    def test_an_end_before_it(self):
        said = self.refused("-checkpoint_restart", "b/checkpoint.h5", "-time_end", "0.5")
        self.assertIn("time: end: 0.5 must be >= 1", said)

    def test_a_folder_without_its_files(self):
        said = self.finish(self.begin("-checkpoint_restart", "b/checkpoint.h5", "-time_end", "2",
                                      dir="c"), 2)
        self.assertIn("a run goes on in the folder where it began", said)

    def test_quasistatic(self):
        said = self.refused("-integrator", "quasistatic", "-checkpoint_every", "3")
        self.assertIn("integrator' is quasistatic", said)


class Breaking(RestartTest):
    """A check without a test of its own, for one rank and for several."""

    def check_breaking(self, ranks, more=""):
        """Damage, breaks and the ledger go on bit for bit; the log of breaks is that of the
        straight run."""
        (self.folder / "scene.yaml").write_text(SCENE.replace("forces: [beam,",
                                                              "forces: [beam, fracture,")
                                                .replace("[0.01, 0, 0]", "[0.02, 0, 0]")
                                                + "fracture: {energy: 100, weibull_modulus: "
                                                  "8, seed: 3" + more + "}\n"
                                                + "limit: {energy_error: 1}\n")
        a = self.run_whole("-time_end", "2", dir=f"a{ranks}", ranks=ranks)
        summary = json.loads((a / "summary.json").read_text())
        self.assertGreater(summary["beams_broken"], 5)
        dir = f"b{ranks}"
        # One checkpoint before anything is damaged, one in the middle of breaking.
        self.run_whole("-time_end", "2", "-ts_max_steps", "100", dir=dir, ranks=ranks)
        with h5py.File(a / "breaks.h5") as file:
            middle = str(int(np.median(file["time"][:]) / summary["dt"]))
        b = self.go_on("-time_end", "2", "-ts_max_steps", middle, dir=dir, ranks=ranks)
        with h5py.File(b / "breaks.h5") as file:
            self.assertGreater(len(file["time"]), 1)
        b = self.go_on("-time_end", "2", dir=dir, ranks=ranks)
        first, second = contents(a / "breaks.h5"), contents(b / "breaks.h5")
        for name, values in first.items():
            self.assertTrue(np.array_equal(values, second[name]), name)
        first, second = contents(a / "checkpoint.h5"), contents(b / "checkpoint.h5")
        self.assertEqual(first["run/step"], second["run/step"])
        for name in ("bodies/records", "force_0_beam/cracks", "force_0_beam/energy_fracture"):
            self.assertTrue(np.array_equal(first[name], second[name]), name)


class Contact(RestartTest):
    def test_stopped_in_steps_in_which_beams_break(self):
        """Bodies whose beam broke in the last step before a stop have evaluated their first
        overlap, but not kept it: where they go on it is their first once more."""
        stops = [k / 400 for k in (*range(290, 352, 4), 360, 383)]
        summary = self.check_parts("""integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
ice: {young: 4e7}
sheet: {length: 24, width: 6, thickness: 0.5, element_size: 1.5, iterations: 20}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 1e5, shear_strength: 1e5, energy: 15}
water: {drag_coefficient: 1, drag_linear: 200, current: [4, 0, 0]}
contact: {young: 1e7, friction: 0.2, restitution: 0.3, plastic_limit: 1e6}
obstacle:
  names: [slope]
  slope: {shape: halfspace, point: [12.02, 0, -0.4554], normal: [-1, 0, 1], friction: 0.1}
boundary: {names: [push], push: {set: left, fix: x y z rx ry rz, velocity: [8, 0, 0], ramp: 0.2}}
time: {end: 0.2, dt: 5e-4}
checkpoint: {every: 1000}
""", stops)
        self.assertGreater(summary["beams_broken"], 60)

    def test_a_sheet_near_a_wall(self):
        """The step gets shorter when the run finds the wall near, not when a restart looks
        again."""
        summary = self.check_parts("""integrator: explicit
forces: [beam, contact]
sheet: {length: 10, thickness: 1, element_size: 1, iterations: 5}
beam: {damping_ratio: 0.02}
contact: {young: 4e9}
initial: {names: [all], all: {set: all, velocity: [0.2, 0, 0]}}
obstacle: {names: [wall], wall: {shape: halfspace, point: [5.16, 0, 0], normal: [-1, 0, 0]}}
time: {end: 1}
checkpoint: {every: 1000}
""", [0.12, 0.18, 0.24, 0.3])
        self.assertEqual(summary["dt_limited_by"], "contacts that may come")

    def test_a_sheet_that_breaks_against_a_slope(self):
        """Friction, crushing and contacts that were born at breaks go on bit for bit, with an
        obstacle on its way."""
        summary = self.check_parts("""integrator: explicit
forces: [beam, fracture, gravity, buoyancy, drag, contact]
sheet: {length: 12, width: 6, thickness: 0.5, element_size: 1.5, iterations: 10}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 3e5, shear_strength: 3e5, energy: 15}
water: {drag_coefficient: 1, drag_linear: 200}
contact: {young: 1e8, friction: 0.2, restitution: 0.3, plastic_limit: 1e6}
obstacle:
  names: [slope, mover]
  slope: {shape: halfspace, point: [6.02, 0, -0.4554], normal: [-1, 0, 1], friction: 0.1}
  mover: {shape: cylinder, base: [1, 0, -3], radius: 1, height: 2.5, facets: 12,
          velocity: [0, 0, 0.5]}
boundary: {names: [push], push: {set: left, fix: x y rz, velocity: [1, 0, 0], ramp: 0.1}}
time: {end: 0.8}
checkpoint: {every: 1000}
""", [0.1, 0.3, 0.5, 0.51, 0.8])
        self.assertGreater(summary["beams_broken"], 10)
        self.assertGreater(summary["contacts"], 3)

    def test_a_sheet_that_crushes(self):
        """Beams that soften under pressure, since a large fracture energy in shear lets them,
        and those that are gone."""
        summary = self.check_parts("""integrator: explicit
forces: [beam, fracture, contact]
sheet: {length: 6, width: 4, thickness: 0.5, element_size: 1, iterations: 10}
beam: {damping_ratio: 0.2}
fracture: {tensile_strength: 4e6, shear_strength: 1.2e6, compressive_strength: 2.5e6,
           flexural_strength: 2e6, energy_shear: 6000}
contact: {young: 1e9}
boundary:
  names: [left, right]
  left: {set: left, fix: x y z rx ry rz, velocity: [0.1, 0, 0], ramp: 0.01}
  right: {set: right, fix: x y z rx ry rz}
time: {end: 0.08}
checkpoint: {every: 10000}
""", [0.4, 0.6, 0.8, 0.9])
        self.assertGreater(summary["beams_crushed"], 2)
        self.assertGreater(summary["beams_damaged"], summary["beams_broken"])


class Fracture(Breaking):
    def test_a_sheet_that_breaks(self):
        self.check_breaking(1)

    def test_cracks_that_run_by_energy(self):
        self.check_breaking(1, ", propagation: energy")

    def test_calibrated_strengths_in_bending_and_under_pressure(self):
        self.check_breaking(1, ", flexural_strength: 4e5, compressive_strength: 1.5e6")


class Killing(RestartTest):
    """As Breaking."""

    def check_killed(self, ranks):
        """kill -9: every file is readable, rows and frames are whole, and going on gives the
        straight run.

        Rows are dense, so that a part need not be long to have many; each but the first lives for
        some checkpoints.
        """
        options = ["-checkpoint_every", "0.02", "-output_fields", "0.037", "-output_history",
                   "0.004", *ENDLESS]
        chance = random.Random(ranks)
        folder, resume = self.folder / "b", []
        for kill in range(20 if FULL else 3):
            before = rows_of(folder)
            process = self.begin(*options, *resume, dir="b", ranks=ranks)
            if kill > 0:  # else there may be none yet, and the run begins again
                for _ in range(chance.randrange(1, 3)):
                    self.wait_for_checkpoint(process, folder)
            self.wait_for_rows(process, folder, before + chance.randrange(1, 100))
            # anywhere between two rows, in a frame, in a checkpoint
            time.sleep(chance.uniform(0, 0.05))
            self.kill(process, ranks)
            self.check_files(folder)
            resume = ["-checkpoint_restart",
                      "b/checkpoint.h5"] if (folder / "checkpoint.h5").exists() else []
        self.assert_same(*self.straight_and_resumed(*options, ranks=ranks))

    def kill(self, process, ranks):
        """SIGKILL to every rank; with several they are mpiexec's children, and it ends once they
        have."""
        victims = [process.pid]
        if ranks > 1:
            children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
            victims = [int(child) for child in children] or victims
        for victim in victims:
            os.kill(victim, signal.SIGKILL)
        process.communicate()

    def check_files(self, folder):
        rows = (folder / "history.csv").read_text()
        self.assertTrue(rows.endswith("\n"))
        table = list(csv.reader(rows.splitlines()))
        self.assertLessEqual({len(row) for row in table}, {len(table[0])} if table else set())
        for path in (*folder.glob("fields/*.h5"), *folder.glob("*.h5")):
            contents(path)


class Killed(Killing):
    def test_at_random_moments(self):
        self.check_killed(1)


class DiskFull(RestartTest):
    def says_why(self, process):
        """What a run says that ended because its files could not grow."""
        said = self.finish(process, 1)
        self.assertIn("floe: cannot write", said)
        self.assertIn("File too large", said)
        self.assertNotIn("internal", said)
        self.assertEqual(list((self.folder / "b").glob("*.part")), [])
        return said

    def limited(self, size, *options):
        """What a run says whose files cannot grow beyond `size(folder)` bytes once it has some
        rows."""
        process = self.begin(*options, *ENDLESS, dir="b")
        self.wait_for_rows(process, self.folder / "b", 20)
        limit = size(self.folder / "b")
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (limit, limit))
        return self.says_why(process)

    def test_fields(self):
        # A byte less than a file that is there: one that is full may be the largest that there will
        # be.
        said = self.limited(lambda folder: max(path.stat().st_size
                                               for path in folder.glob("fields/*.h5")) - 1,
                            "-output_fields", "0.001")
        self.assertIn("fields", said)
        self.assertGreater(len(frames_of(self.folder / "b")), 1)

    def test_checkpoint(self):
        """The checkpoint does not fit; an earlier one stays as it was, and the run can go on from
        it."""
        # a checkpoint comes before the next row
        rare = ("-output_fields", "1e5", "-output_history", "10")
        process = self.begin(*rare, *ENDLESS, dir="b")
        self.wait_for_rows(process, self.folder / "b", 2)
        stop_file(process, self.folder / "b")
        self.finish(process, INTERRUPTED)
        before = (self.folder / "b/checkpoint.h5").read_bytes()
        limit = len(before) - 3000
        said = self.says_why(self.begin(
            *rare, *ENDLESS, "-checkpoint_restart", "b/checkpoint.h5", "-checkpoint_every", "0.001",
            dir="b",
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))))
        self.assertIn("checkpoint.h5", said)
        self.assertEqual((self.folder / "b/checkpoint.h5").read_bytes(), before)
        self.assert_same(*self.straight_and_resumed(*rare))

    def test_history(self):
        said = self.limited(lambda folder: (folder / "history.csv").stat().st_size + 100,
                            "-output_history", "0.001",
                            "-output_fields", "1e5")
        self.assertIn("history.csv", said)
        self.assertTrue((self.folder / "b/history.csv").read_text().endswith("\n"))


class RealDiskFull(RestartTest):
    """A file system of 64 MB that is full; needs the right to mount one."""

    def setUp(self):
        super().setUp()
        self.disk = self.folder / "b"
        self.disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", str(self.disk)],
                          capture_output=True).returncode:
            self.skipTest("cannot mount a small file system (root may)")
        self.addCleanup(subprocess.run, ["umount", str(self.disk)], check=True)

    def fill(self, left):
        """A file that leaves so many bytes."""
        free = os.statvfs(self.disk)
        with open(self.disk / "filler", "wb") as file:
            file.write(bytes(free.f_bavail * free.f_frsize - left))

    def full(self, left, *options):
        """What a run says that goes on from the checkpoint with so many bytes left."""
        self.fill(left)
        before = (self.disk / "checkpoint.h5").read_bytes()
        said = self.finish(self.begin("-checkpoint_restart", "b/checkpoint.h5", *options, *ENDLESS,
                                      dir="b"), 1)
        self.assertIn("floe: cannot write", said)
        self.assertIn("No space left on device", said)
        self.assertNotIn("internal", said)
        self.assertEqual((self.disk / "checkpoint.h5").read_bytes(), before)
        self.assertEqual(list(self.disk.glob("*.part")), [])
        self.assertTrue((self.disk / "history.csv").read_text().endswith("\n"))
        self.assertGreater(len(frames_of(self.disk)), 0)
        (self.disk / "filler").unlink()
        return said

    def check(self, what, left, *options):
        """A disk that is full ends the run with the name of the file, and it goes on once there is
        room."""
        process = self.begin(*options, *ENDLESS, dir="b")
        self.wait_for_rows(process, self.disk, 1)
        stop_file(process, self.disk)
        self.finish(process, INTERRUPTED)
        self.assertRegex(self.full(left(), *options), what)
        if "fields" in what:  # not even what names the frames can be written
            self.assertIn(what, self.full(4 << 10, *options))
        self.assert_same(*self.straight_and_resumed(*options))

    def test_history(self):
        self.check(r"history\.csv", lambda: 8 << 10, "-output_fields", "1e5")

    def test_fields(self):
        self.check("b/fields", lambda: 200 << 10, "-output_history", "1", "-output_fields", "0.05")

    def test_checkpoint(self):
        self.check(r"checkpoint\.h5", lambda: (self.disk / "checkpoint.h5").stat().st_size - 4096,
                   "-output_fields", "1e5", "-output_history", "10", "-checkpoint_every", "0.05")


if __name__ == "__main__":
    unittest.main()
