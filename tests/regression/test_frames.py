#!/usr/bin/python3
"""Frames of a run: fields.h5, fields.xmf and fields/ can be read at any time, and nothing but a
frame that is being written is ever lost.

While a run writes, after kill -9 at random moments, after a file size limit in the middle of a
frame, over an older run.
FLOE_FULL=1 kills 40 times instead of 4.
"""
import random
import resource
import signal
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np

from launch import (ENDLESS, ENVIRONMENT, FLOE, FULL, REPOSITORY, FolderTest, own_words,
                    run)

sys.path.insert(0, str(REPOSITORY / "python"))
from floe.results.output import Output, frames_of, rows_of  # noqa: E402

SCENE = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {length: 6, width: 6, thickness: 0.5, element_size: 2}
beam: {damping_ratio: 1}
load: {names: [p], p: {set: left, force: [0, 0, -1e4], ramp: 1}}
time: {end: 2}
output: {history: 0.01, fields: 0.01}
checkpoint: {every: 0.05}
"""
MANY = ("-output_fields", "0.002", *ENDLESS)
XI = "{http://www.w3.org/2001/XInclude}"


def grids(folder):
    """The grids of a fields.xmf, in order, with those of the files it includes: [(time, [(place,
    dimensions)])]."""
    def of(path):
        collection = ElementTree.parse(path).getroot().find("Domain/Grid")
        for child in collection:
            if child.tag == XI + "include":
                assert child.get("xpointer") == "xpointer(/Xdmf/Domain/Grid/Grid)"
                yield from of(folder / child.get("href"))
            else:
                items = [(item.text, tuple(int(d) for d in item.get("Dimensions").split()))
                         for item in child.iter("DataItem")]
                yield float(child.find("Time").get("Value")), items
    return list(of(folder / "fields.xmf")) if (folder / "fields.xmf").exists() else []


def check_names(folder, last=None):
    """Every dataset that fields.xmf names in its last frames is there with its size; the times of
    all its frames."""
    files, found = {}, grids(folder)
    times = [moment for moment, _ in found]
    for _, items in found[-last:] if last else found:
        for place, dimensions in items:
            file, name = place.split(":")
            if file not in files:
                files[file] = h5py.File(folder / file)
            assert files[file][name].shape == dimensions, place
    for file in files.values():
        file.close()
    assert times == sorted(set(times)), "frames out of order"
    return times


def contents(folder):
    """All values of all frames: {(frame, dataset): array}."""
    found = {}
    for moment, path, group in frames_of(folder):
        with h5py.File(path) as file:
            for name, data in file[group].items():
                found[moment, group, name] = data[:]
    return found


class FramesTest(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scene.yaml").write_text(SCENE)

    def whole(self, *options, dir="a", code=0):
        done = run("scene.yaml", *options, "-output_dir", dir, cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return self.folder / dir

    def begin(self, *options, dir="b"):
        process = subprocess.Popen([FLOE, "scene.yaml", *options, "-output_dir", dir],
                                   cwd=self.folder, env=ENVIRONMENT,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, process)
        return process

    def wait_for(self, process, what):
        """Until what() is true, as long as it takes. A restart that cuts back may take a file away
        between the reading of its name and the reading of the file."""
        def is_there():
            try:
                return what()
            except FileNotFoundError:
                return False
        while not is_there():
            if process.poll() is not None:
                self.fail("the run ended by itself: " + process.stderr.read())
            time.sleep(0.002)

    def assert_same(self, a, b):
        """The frames of two runs are the same to the last bit, and so is what tells of them."""
        first, second = contents(a), contents(b)
        self.assertEqual(list(first), list(second))
        for key, values in first.items():
            np.testing.assert_array_equal(values, second[key], str(key))
        self.assertEqual(grids(a), grids(b))
        self.assertEqual((a / "history.csv").read_text(), (b / "history.csv").read_text())


class Layout(FramesTest):
    def test_segments(self):
        """Several segments, each with its part of the frames; every frame has its name in
        fields.xmf and fields.h5."""
        folder = self.whole("-output_fields", "0.004")
        segments = sorted(int(file.stem) for file in folder.glob("fields/*.h5")
                          if file.stem != "mesh")
        self.assertGreater(len(segments), 3)
        times = check_names(folder)
        self.assertGreater(len(times), 450)
        self.assertEqual(times[0], 0)
        self.assertEqual(times[-1], 2)
        frames = frames_of(folder)
        self.assertEqual([moment for moment, _, _ in frames], times)
        for k, (_, path, group) in enumerate(frames):
            self.assertEqual(group, f"t{k:06d}")
            self.assertEqual(int(path.stem), max(s for s in segments if s <= k))
        with h5py.File(folder / "fields.h5") as file:
            self.assertEqual([group.attrs["time"] for name, group in file.items()
                              if name != "mesh"], times)
            self.assertEqual(len(file["mesh/beams"]), len(file["t000000/beams_force"]))
        includes = (folder / "fields.xmf").read_text().count("xi:include ")
        self.assertEqual(includes, len(segments) - 1)
        self.assertEqual(list(folder.glob("**/*.part")), [])

    def test_a_frame_costs_the_same_however_many_there_are(self):
        """Bytes that a run hands to the system: four times the frames, four times the bytes."""
        # Of a process that has ended only root may read it; of its children anybody in his own
        # account.
        account = ("import subprocess, sys\n"
                   "subprocess.run(sys.argv[1:], check=True, capture_output=True)\n"
                   "print(open('/proc/self/io').read())\n")

        def written(every):
            command = [sys.executable, "-c", account, FLOE, "scene.yaml", "-output_dir", "b",
                       "-output_overwrite",
                       "-output_fields", every, "-output_history", "1", "-checkpoint_every", "1000"]
            done = subprocess.run(command, cwd=self.folder, env=ENVIRONMENT, capture_output=True,
                                  text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            return int(done.stdout.split("wchar:")[1].split()[0])
        few, many = written("0.004"), written("0.001")
        self.assertLess(many, 4.6 * few)

    def test_bodies_without_shapes_and_large_frames(self):
        """A frame of more than a segment's bytes is a segment of its own."""
        folder = self.whole("-sheet_length", "60", "-sheet_width", "60", "-sheet_iterations", "3",
                            "-time_end", "0.02",
                            "-output_fields", "0.005")
        frames = frames_of(folder)
        self.assertEqual(len({path for _, path, _ in frames}), len(frames))
        self.assertEqual(check_names(folder), [moment for moment, _, _ in frames])

    def test_an_older_run_is_replaced_and_its_readers_keep_it(self):
        folder = self.whole("-output_fields", "0.004")
        with h5py.File(folder / "fields/000000.h5") as old, h5py.File(folder / "fields.h5"):
            self.whole("-time_end", "0.1", "-output_fields", "0.02")
            self.assertGreater(len(old), 50)
            self.assertEqual(len(old["t000049/points"].shape), 2)
        self.assertLess(len(frames_of(folder)), 10)
        self.assertEqual(check_names(folder), [moment for moment, _, _ in frames_of(folder)])
        (folder / "fields/notes.txt").write_text("mine")
        self.whole("-time_end", "0.1")
        self.assertTrue((folder / "fields/notes.txt").exists())


class Readers(FramesTest):
    """A run that is under way."""

    def test_nothing_is_torn(self):
        """What is newest is read again and again while a run writes as fast as it can."""
        process = self.begin("-output_fields", "0.001", "-output_history", "0.1", *ENDLESS)
        folder, reads, seen = self.folder / "b", 0, -1
        while reads < (3000 if FULL else 50):
            self.assertIsNone(process.poll())
            if not (folder / "fields.xmf").exists():
                continue
            collection = ElementTree.parse(folder / "fields.xmf").getroot().find("Domain/Grid")
            for include in collection.findall(XI + "include")[-1:]:
                ElementTree.parse(folder / include.get("href"))
            for item in collection.findall("Grid")[-1].iter("DataItem"):
                file, name = item.text.split(":")
                with h5py.File(folder / file) as data:
                    self.assertEqual(data[name].shape,
                                     tuple(int(d) for d in item.get("Dimensions").split()))
            newest = max(folder.glob("fields/0*.h5"))
            with h5py.File(newest) as data:
                groups = list(data)
                self.assertTrue(all(np.isfinite(values[:]).all()
                                    for values in data[groups[-1]].values()))
            frame = int(groups[-1][1:])
            self.assertEqual(len(groups), frame - int(newest.stem) + 1)
            self.assertGreaterEqual(frame, seen)
            with h5py.File(folder / "fields.h5") as links:
                self.assertGreaterEqual(len(links) - 1, seen * 15 // 16)
                self.assertTrue(len(links) == 1 or "time" in links[f"t{len(links) - 2:06d}"].attrs)
            self.assertLessEqual(len({len(row) for row in rows_of(folder)}), 1)
            seen, reads = frame, reads + 1
        process.kill()
        process.wait()
        self.assertGreater(len(check_names(folder, 10)), 100)

    def test_tools_on_a_run_under_way_and_on_a_killed_one(self):
        process, folder = self.begin(*MANY), self.folder / "b"
        self.wait_for(process, lambda: len(grids(folder)) >= 3)
        process.send_signal(signal.SIGSTOP)  # else it fills the disk while pictures are drawn
        for state in ("under way", "killed"):
            output = Output(folder)
            self.assertEqual(output.summary, {})
            self.assertGreater(len(output.times), 2)
            self.assertTrue(np.isfinite(output.field("bodies_displacement",
                                                     output.times[-1])).all())
            self.assertGreater(len(output.history("time")), 0)
            picture = self.folder / f"{state}.png"
            done = subprocess.run([REPOSITORY / "tools/plot_sheet", folder, "--colour", "uz",
                                   "--file", picture],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(picture.exists())
            if state == "under way":
                self.assertIsNone(process.poll())
                process.kill()
                process.wait()
        late = subprocess.run([REPOSITORY / "tools/plot_sheet", folder, "--time", "99999"],
                              capture_output=True, text=True)
        self.assertEqual(late.returncode, 2)
        self.assertIn("time 99999: the frames of", late.stderr)


class Interrupted(FramesTest):
    def go_on(self, *options):
        resume = ["-checkpoint_restart",
                  "b/checkpoint.h5"] if (self.folder / "b/checkpoint.h5").exists() else []
        return self.begin(*MANY, *options, *resume)

    def check_end(self):
        """The interrupted run goes on, and ends as a straight one of as many steps."""
        with h5py.File(self.folder / "b/checkpoint.h5") as file:
            end = ("-ts_max_steps", str(int(file["run/step"][()]) + 2000))
        process = self.go_on(*end)
        _, said = process.communicate()
        self.assertEqual(process.returncode, 0, said)
        self.assert_same(self.whole(*MANY, *end), self.folder / "b")

    def test_killed_at_random_moments(self):
        chance, folder = random.Random(14), self.folder / "b"
        for kill in range(40 if FULL else 4):
            frames = len(grids(folder))
            process = self.go_on()
            more = frames + chance.randrange(1, 100)
            self.wait_for(process, lambda more=more: len(grids(folder)) > more)
            if kill > 0:  # else there may be none yet, and the run begins again
                self.wait_for(process, (folder / "checkpoint.h5").exists)
            time.sleep(chance.uniform(0, 0.05))  # anywhere in a frame or between two
            process.kill()
            process.wait()
            named, frames = check_names(self.folder / "b"), frames_of(self.folder / "b")
            self.assertIn(len(frames) - len(named), (0, 1))
            self.assertEqual([moment for moment, _, _ in frames][:len(named)], named)
        self.check_end()
        self.assertEqual([*self.folder.glob("b/fields*.part"),
                          *self.folder.glob("b/fields/*.part")], [])

    def test_a_file_size_limit_in_a_frame(self):
        """The frame is dropped, all before it can be read, and the run goes on from its
        checkpoint."""
        process, folder = self.begin(*MANY), self.folder / "b"
        self.wait_for(process, (folder / "checkpoint.h5").exists)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (100_000, 100_000))
        said = own_words(process.stderr.read())
        self.assertEqual(process.wait(), 1)
        self.assertRegex(said, r"^floe: cannot write b/\S+: File too large\n")
        named, frames = check_names(folder), frames_of(folder)
        self.assertIn(len(frames) - len(named), (0, 1))
        self.assertGreater(len(frames), 1)
        self.assertTrue(all(np.isfinite(values).all() for values in contents(folder).values()))
        self.check_end()

    def test_a_restart_needs_the_frames(self):
        folder = self.whole("-time_end", "1")
        for file in folder.glob("fields/0*.h5"):
            file.unlink()
        done = run("scene.yaml", "-checkpoint_restart", "a/checkpoint.h5", "-output_dir", "a",
                   cwd=self.folder)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("a/fields' has 0 frames, the checkpoint knows of", done.stderr)


if __name__ == "__main__":
    unittest.main()
