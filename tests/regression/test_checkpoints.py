#!/usr/bin/python3
"""Checkpoint files: no change of one goes unseen, at any instant a good one is there, and none is
newer than its frames.

FLOE_FULL=1 flips 2000 bits instead of 30.
"""
import random
import subprocess
import unittest

import h5py
import numpy as np

from interposed import library
from launch import ENDLESS, FULL
from running import AFLOAT, BAD_INPUT, DONE, RunningTest
from sealed import SEAL, changed, seal
from test_restart import contents

KEPT = AFLOAT.replace("time: {end: 100000}", "time: {end: 0.2}") + "checkpoint: {every: 1000}\n"
# A block that falls on a plane: forces that remember.
HIT = """integrator: explicit
forces: [gravity, contact]
lattice_file: blocks.h5
contact: {young: 1e8}
obstacle: {names: [bed], bed: {shape: halfspace, point: [0, 0, -0.3]}}
time: {end: 0.3}
checkpoint: {every: 1000}
"""


class CheckpointTest(RunningTest):
    def setUp(self):
        super().setUp()
        self.write(KEPT)
        self.dir = self.folder / "out/scene"
        self.newest, self.older = self.dir / "checkpoint.h5", self.dir / "checkpoint_previous.h5"

    def restart(self, file="checkpoint.h5"):
        return "-checkpoint_restart", f"out/scene/{file}", "-time_end", "0.3"

    def damaged(self, ranks=1):
        """What a restart says that is refused for its file."""
        said = self.refused(*self.restart(), ranks=ranks)
        self.assertRegex(said, "^floe: checkpoint: restart: 'out/scene/checkpoint.h5'[: ]")
        return said


class Damaged(CheckpointTest):
    def setUp(self):
        super().setUp()
        self.floe()
        self.good = self.newest.read_bytes()

    def test_flipped_bits(self):
        chance = random.Random(14)
        places = [chance.randrange(8 * len(self.good)) for _ in range(2000 if FULL else 30)]
        # what the seal says
        places += [chance.randrange(8 * 60) for _ in range(20 if FULL else 10)]
        for place in places:
            with self.subTest(place):
                bad = bytearray(self.good)
                bad[place // 8] ^= 1 << place % 8
                self.newest.write_bytes(bad)
                self.assertRegex(self.damaged(), "damaged")

    def test_of_another_length(self):
        for size in (0, 1, 100, SEAL, SEAL + 1, len(self.good) // 2, len(self.good) - 1):
            self.newest.write_bytes(self.good[:size])
            self.assertRegex(self.damaged(), "damaged|is empty")
        self.newest.write_bytes(self.good + b"\0")
        self.assertIn(f"it has {len(self.good) + 1} bytes, not {len(self.good)}", self.damaged())

    def test_on_two_ranks(self):
        self.newest.write_bytes(self.good[:-9])
        self.assertIn("is damaged", self.damaged(ranks=2))

    def test_what_is_no_checkpoint(self):
        self.newest.write_bytes((self.dir / "lattice.h5").read_bytes())
        self.assertIn("is no checkpoint of this version of floe", self.damaged())
        self.newest.write_text(KEPT)
        self.assertIn("is no checkpoint of this version of floe", self.damaged())
        with h5py.File(self.newest, "w", userblock_size=SEAL) as file:
            file["numbers"] = np.arange(10)
        seal(self.newest)
        self.assertIn("layout is missing", self.damaged())
        self.newest.unlink()
        self.newest.mkdir()
        self.assertIn("is a folder", self.damaged())

    def test_numbers_that_cannot_be(self):
        """A seal says that a file is as it was written, not that it makes sense."""
        for name, value in (("layout", 2.0), ("layout", np.nan), ("ranks", 0.0),
                            ("run/step", np.nan), ("run/step", -1.0),
                            ("run/step", 0.5), ("run/step", 1e300), ("run/dt", 0.0),
                            ("run/dt", -1e-3), ("run/dt", np.inf),
                            ("run/time", np.nan), ("run/time", -1.0), ("run/stable_dt", np.nan),
                            ("run/stable_dt", -1.0),
                            ("run/next_sample", np.nan), ("run/largest_velocity2", -1.0),
                            ("run/boundary_work", np.nan),
                            ("ledger/started", 2.0), ("ledger/largest", np.inf),
                            ("bodies/records", np.nan),
                            ("bodies/records", np.inf), ("bodies/records_bodies", -1),
                            ("works/force_0_beam", np.nan),
                            ("output/history_rows", -1.0), ("output/fields_frames", 1.5),
                            ("output/last_sample", np.nan)):
            with self.subTest(name=name, value=value):
                self.newest.write_bytes(self.good)
                with changed(self.newest) as file:
                    data = file[name]
                    values = data[()]
                    values.flat[values.size // 2] = value
                    data[...] = values
                said = self.damaged()
                self.assertTrue(name.split("/")[-1] in said or "another lattice" in said, said)

    def test_parts_that_are_missing(self):
        for name in ("options", "version", "run/dt", "bodies/records", "output/run"):
            self.newest.write_bytes(self.good)
            with changed(self.newest) as file:
                del file[name]
            self.damaged()

    def test_impulses(self):
        make = ["make_lattice", "block", "--size", "1", "1", "0.5", "blocks.h5"]
        self.finish(self.begin(*make[1:], scene=make[0]))
        self.write(HIT)
        self.floe("-output_dir", "hit")
        for name, value in (("impulse_bed_z", np.nan), ("peak_bed_z", np.inf)):
            good = (self.folder / "hit/checkpoint.h5").read_bytes()
            with changed(self.folder / "hit/checkpoint.h5") as file:
                self.assertNotEqual(file["force_1_contact"][name][0], 0)
                file["force_1_contact"][name][...] = value
            said = self.refused("-checkpoint_restart", "hit/checkpoint.h5", "-output_dir", "hit",
                                "-time_end", "0.4")
            self.assertIn(f"force_1_contact/{name} has the value", said)
            (self.folder / "hit/checkpoint.h5").write_bytes(good)


class Generations(CheckpointTest):
    def time_of(self, path):
        with h5py.File(path) as file:
            return file["run/time"][()]

    def test_the_older_one_is_named_and_goes_on(self):
        self.floe()
        first = self.newest.read_bytes()
        self.floe(*self.restart())
        self.assertEqual(self.older.read_bytes(), first)
        self.assertGreater(self.time_of(self.newest), self.time_of(self.older))
        good = self.newest.read_bytes()
        for bad in (good[:-100], good[:5000] + bytes([good[5000] ^ 4]) + good[5001:]):
            self.newest.write_bytes(bad)
            self.assertRegex(self.damaged(),
                             r"; -checkpoint_restart out/scene/checkpoint_previous.h5 goes on from "
                                             r"t = 0\.2\d* s\n$")
        with changed(self.older) as file:
            file["run/dt"][()] = -1
        self.floe(*self.restart("checkpoint_previous.h5"), code=BAD_INPUT)
        self.older.write_bytes(first)
        self.floe(*self.restart("checkpoint_previous.h5"))
        again = contents(self.newest)  # the same run
        self.newest.write_bytes(good)
        first_time = contents(self.newest)
        for name, values in again.items():
            np.testing.assert_array_equal(values, first_time[name], name)
        self.assertEqual(self.older.read_bytes(), first)  # not the damaged one
        self.older.write_bytes(b"")
        self.newest.write_bytes(good[:-1])
        self.assertNotIn("goes on from", self.damaged())

    def test_going_back(self):
        """From the older one: no newer one of the time before is left that would be taken for this
        run's."""
        self.floe()
        self.floe(*self.restart())
        process = self.begin("-checkpoint_restart", "out/scene/checkpoint_previous.h5", *ENDLESS)
        self.wait(process, lambda: not (self.dir / "summary.json").exists())
        process.kill()
        process.communicate()
        self.assertLess(abs(self.time_of(self.newest) - 0.2), 0.01)

    def check_any_instant(self, ranks=1, environment={}):
        """Killed before each of the calls that bring a checkpoint to the disk."""
        self.floe(ranks=ranks)
        environment = {**library(self.folder), **environment}
        words = ("-checkpoint_restart", "auto", "-checkpoint_every", "0.001", *ENDLESS)
        before = self.time_of(self.newest)
        for at in range(1, 40 if FULL else 20):
            process = self.begin(*words, ranks=ranks,
                                 environment={**environment, "TEST_KILL_AT": str(at)})
            process.communicate()
            self.assertNotEqual(process.returncode, DONE)
            check = self.begin(*words, "-check")
            out, err = check.communicate()
            self.assertEqual(check.returncode, DONE, err)
            self.assertIn("goes on from 'out/scene/checkpoint", out)
        self.assertGreater(max(map(self.time_of, self.dir.glob("checkpoint*.h5"))), before)

    def test_a_good_one_is_there_at_any_instant(self):
        self.check_any_instant()

    def test_on_a_file_system_without_second_names(self):
        self.check_any_instant(environment={"TEST_NO_LINKS": "1"})


class Order(CheckpointTest):
    def calls(self, ranks):
        self.write(KEPT)
        log = self.folder / "log"
        log.unlink(missing_ok=True)
        environment = {**library(self.folder), "TEST_LOG": str(log)}
        process = self.running("-checkpoint_every", "0.3", "-output_fields", "0.002", *ENDLESS,
                               ranks=ranks, rows=1,
                               environment=environment)
        self.wait(process, lambda: log.read_text().count("scene/checkpoint.h5\n") >= 4)
        self.stop(process)
        prefix = str(self.folder.resolve()) + "/"
        for line in log.read_text().splitlines():
            yield [word.removeprefix(prefix) for word in line.split("\t")]

    def check_order(self, ranks):
        """Rows and frames are on the disk before the checkpoint that knows of them, and this one
        before its name."""
        waiting, synced, linked, checkpoints = set(), set(), False, 0
        for what, path, second in self.calls(ranks):
            if what == "fsync":
                waiting.discard(path)
                synced.add(path)
            elif what == "rename" and second == "out/scene/checkpoint.h5":
                self.assertEqual(waiting, set())
                self.assertIn(path, synced)
                self.assertLessEqual({"out/scene/history.csv", "out/scene/fields"}, synced)
                self.assertTrue(checkpoints == 0 or linked)
                synced, linked, checkpoints = set(), False, checkpoints + 1
            elif what == "rename" and second.startswith("out/scene/fields/"):
                waiting.add(second)
            elif what == "link":
                linked = second.startswith("out/scene/checkpoint_previous.h5.")
        self.assertGreater(checkpoints, 3)

    def test_frames_before_their_checkpoint(self):
        for ranks in (1, 2):
            self.check_order(ranks)
            self.assertTrue(self.older.exists())
            subprocess.run(["rm", "-r", self.dir], check=True)


class OtherRuns(CheckpointTest):
    def test_files_of_another_run(self):
        self.floe()
        kept = self.folder / "kept.h5"
        kept.write_bytes(self.newest.read_bytes())
        self.floe()  # anew
        said = self.refused("-checkpoint_restart", "kept.h5", "-output_dir", "out/scene",
                            "-time_end", "0.3")
        self.assertIn("'kept.h5' is of another run than the files in out/scene", said)

    def test_a_copy_of_its_own(self):
        self.floe()
        subprocess.run(["cp", "-r", self.dir, self.folder / "copy"], check=True)
        self.newest.rename(self.folder / "kept.h5")
        self.floe("-checkpoint_restart", "kept.h5", "-time_end", "0.3")
        self.assertTrue(self.newest.exists())
        (self.folder / "copy/.lock").unlink()
        said = self.floe("-checkpoint_restart", "copy/checkpoint.h5", "-time_end", "0.3",
                         "-output_dir", "copy")
        self.assertEqual(said, "")
        for name in ("history.csv", "fields.xmf"):
            self.assertEqual((self.dir / name).read_text(),
                             (self.folder / "copy" / name).read_text())

    def test_what_makes_other_roundings_is_said(self):
        self.floe()
        with changed(self.newest) as file:
            for name, value in (("version", "0.0.9"), ("built_for", "z80")):
                del file[name]
                file[name] = np.bytes_(value)
            file["ranks"][...] = 3
        process = self.begin(*self.restart())
        out, err = process.communicate()
        self.assertEqual(process.returncode, DONE, err)
        self.assertRegex(out, r"the checkpoint is of floe 0\.0\.9 \(now \S+\), a library for z80 "
                              r"\(now .+\), 3 ranks \(now 1\): ")

    def test_columns_of_another_version(self):
        self.floe()
        history = self.dir / "history.csv"
        history.write_text(history.read_text().replace("energy_gravity", "energy_weight", 1))
        said = self.refused(*self.restart())
        self.assertIn("'out/scene/history.csv' has other columns than this run writes", said)


if __name__ == "__main__":
    unittest.main()
