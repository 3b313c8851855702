#!/usr/bin/python3
"""Levels of x86-64: types of public headers are the same at all of them, and a floe built with
FLOE_PORTABLE has a library for each, of which the loader takes the best that the processor can run.
Levels that this processor does not have are left out; with qemu-user older processors are tried as
well."""
import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

from launch import ENVIRONMENT, FLOE, REPOSITORY, FolderTest

AT_LEVEL = REPOSITORY / "tools/at_level"
BUILT = ["x86-64", "x86-64-v3", "x86-64-v4"]  # levels that get a library
LIBRARIES = {level: FLOE.parent / "lib" / (f"glibc-hwcaps/{level}" if level != "x86-64"
                                           else "") / "libfloe.so" for level in BUILT}
PORTABLE = all(path.exists() for path in LIBRARIES.values())
TENSION = REPOSITORY / "input/tension.yaml"

# A floating sheet of 200 cells, one edge of which is pushed down: it bends, swings and is braked.
# All loops over lanes, 400 steps.
SWINGING = """
integrator: explicit
forces: [beam, gravity, buoyancy, drag]
sheet: {length: 20, width: 20, thickness: 0.5, element_size: 1.5, seed: 3, iterations: 20}
ice: {young: 1e8, poisson: 0.3, density: 920}
beam: {damping_ratio: 0.05}
water: {drag_coefficient: 1, drag_linear: 100}
initial:
  names: [pushed]
  pushed: {set: left, velocity: [0.2, 0.1, -0.5]}
time: {dt: 5e-5, end: 0.02}
output: {history: 0.001}
"""


def has(level):
    """Whether the loader finds that this processor has a level."""
    text = subprocess.run(["/lib64/ld-linux-x86-64.so.2", "--help"], capture_output=True,
                          text=True).stdout
    return level == "x86-64" or f"{level} (supported" in text


def symbols(library):
    """Functions and data of a library that its sources define for others; inline ones may be there
    or not."""
    text = subprocess.run(["nm", "-DC", "--defined-only", library], capture_output=True, text=True,
                          check=True).stdout
    return {line.split(" ", 2)[2] for line in text.splitlines()
            if line.split(" ", 2)[1] in "TDBR" and "floe::" in line}


def history(folder):
    """Columns of history.csv by name."""
    table = np.genfromtxt(folder / "history.csv", delimiter=",", names=True)
    return {name: table[name] for name in table.dtype.names}


@unittest.skipUnless((FLOE.parent / "compile_commands.json").exists(), "needs floe's build folder")
class Layout(unittest.TestCase):
    """One ABI: who includes the public headers sees the same types, whatever level he compiles
    for."""

    def classes(self, level):
        """Every class of floe with the places of its members, as the compiler lays them out."""
        commands = json.loads((FLOE.parent / "compile_commands.json").read_text())
        words = shlex.split(next(c["command"] for c in commands
                                 if c["file"].endswith("src/main.cpp")))
        kept = [w for w in words if re.match(r"-(I|D|std)", w)]
        kept += [w for pair in zip(words, words[1:]) if pair[0] == "-isystem" for w in pair]
        with tempfile.TemporaryDirectory() as folder:
            headers = sorted((REPOSITORY / "include").rglob("*.h"))
            names = [header.relative_to(REPOSITORY / "include") for header in headers]
            (Path(folder) / "all.cpp").write_text("".join(f'#include "{name}"\n' for name in names))
            subprocess.run(["g++", *kept, f"-march={level}", "-fsyntax-only",
                            "-fdump-lang-class=layout", "all.cpp"], cwd=folder,
                           check=True)
            text = re.sub(r"0x[0-9a-fx]+", "", Path(folder, "layout").read_text())
        return {block.split("\n", 1)[0]: block for block in re.split(r"\n\n+", text)
                if block.startswith("Class floe::")}

    def test_of_public_types(self):
        lowest = self.classes("x86-64")
        self.assertGreater(len(lowest), 50)
        for level in ("x86-64-v2", "x86-64-v3", "x86-64-v4"):
            other = self.classes(level)
            self.assertEqual(lowest.keys(), other.keys())
            for name in lowest:
                self.assertEqual(lowest[name], other[name], level)

    def test_no_lanes_in_public_headers(self):
        for header in (REPOSITORY / "include").rglob("*.h"):
            self.assertNotRegex(header.read_text(), r"simd|vector_size|immintrin|\bLanes\b", header)

    def test_no_lanes_in_exported_names(self):
        # A function that takes a register has another name at each level: its class should take it
        # within a struct.
        self.assertFalse([name for name in symbols(LIBRARIES["x86-64"]) if "simd" in name])


@unittest.skipUnless(PORTABLE, "needs a floe that was built with FLOE_PORTABLE")
class Levels(FolderTest):
    def setUp(self):
        super().setUp()
        self.levels = [level for level in BUILT if has(level)]

    def run_at(self, level, *words, dir):
        """Standard output of a run at a level, in the folder `dir`."""
        done = subprocess.run([AT_LEVEL, level, FLOE, *words, "-output_dir", dir], cwd=self.folder,
                              env=ENVIRONMENT,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def summary(self, dir):
        return json.loads((self.folder / dir / "summary.json").read_text())

    def test_loader_takes_the_best(self):
        best = self.levels[-1]
        self.assertIn(f"\nbuilt for {best}\n",
                      subprocess.run([FLOE, "--version"], capture_output=True, text=True).stdout)
        for level in self.levels:
            self.assertEqual(self.run_at(level, TENSION, dir=level).splitlines()[1],
                             f"library: built for {level}")
            self.assertEqual(self.summary(level)["built_for"], level)

    def test_exported_functions_are_the_same(self):
        lowest = symbols(LIBRARIES["x86-64"])
        self.assertGreater(len(lowest), 300)
        for level in BUILT[1:]:
            self.assertEqual(lowest, symbols(LIBRARIES[level]), level)

    def test_static_results_differ_by_rounding(self):
        # Newton ends at 1e-8 of the first residual or below: with one level's rounding it stops at
        # another digit.
        for level in self.levels:
            self.run_at(level, TENSION, dir=level)
        expected = self.summary("x86-64")
        for level in self.levels[1:]:
            self.assertAlmostEqual(self.summary(level)["E_over_Eb"] / expected["E_over_Eb"], 1,
                                   delta=1e-8)
            with (h5py.File(self.folder / "x86-64/lattice.h5") as one,
                  h5py.File(self.folder / level / "lattice.h5") as other):
                np.testing.assert_array_equal(one["beams/bodies"], other["beams/bodies"])
                np.testing.assert_allclose(one["bodies/position"], other["bodies/position"], rtol=0,
                                           atol=1e-11)

    def close(self, found, expected):
        """400 steps add some 400 roundings of 1e-16 to what swings; of the largest number of its
        column, of what balances energies the largest energy."""
        largest = {name: np.abs(column).max() for name, column in expected.items()}
        energy = max(size for name, size in largest.items() if name.startswith("energy_"))
        self.assertGreater(largest["energy_strain"], 1e-4 * energy)
        for name, column in expected.items():
            balance = name.startswith("energy_") and largest[name] < 1e-4 * energy
            size = energy if balance else largest[name]
            np.testing.assert_allclose(found[name], column, rtol=0, atol=1e-11 * size + 1e-300,
                                       err_msg=name)

    def test_motion_differs_by_rounding(self):
        (self.folder / "swinging.yaml").write_text(SWINGING)
        for level in self.levels:
            self.run_at(level, "swinging.yaml", dir=level)
        for level in self.levels[1:]:
            self.close(history(self.folder / level), history(self.folder / "x86-64"))

    def test_checkpoint_goes_on_at_another_level(self):
        (self.folder / "swinging.yaml").write_text(SWINGING)
        self.run_at("x86-64", "swinging.yaml", dir="straight")
        for first, then in zip(self.levels, self.levels[1:] + self.levels[:1]):
            self.run_at(first, "swinging.yaml", "-time_end", "0.01", "-checkpoint_every", "600",
                        dir=first)
            self.run_at(then, "swinging.yaml", "-checkpoint_restart", f"{first}/checkpoint.h5",
                        dir=first)
            self.close(history(self.folder / first), history(self.folder / "straight"))

    def test_ranks_at_different_levels_are_counted(self):
        one, other = self.levels[0], self.levels[-1]
        if one == other:
            self.skipTest("this processor has one level only")
        command = ["mpiexec"]
        for level in (one, other):
            command += ["-n", "1", AT_LEVEL, level, FLOE, TENSION, "-output_dir", "out", ":"]
        done = subprocess.run(command[:-1], cwd=self.folder, env=ENVIRONMENT, capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        both = f"{one} on 1 rank, {other} on 1 rank"
        self.assertEqual(done.stdout.splitlines()[1],
                         f"library: built for {both}; results differ by rounding from those of one "
                         "level")
        self.assertEqual(self.summary("out")["built_for"], both)

    @unittest.skipUnless(shutil.which("qemu-x86_64"), "needs qemu-user")
    def test_older_processors(self):
        for processor, level in (("Nehalem", "x86-64"), ("Haswell", "x86-64-v3")):
            done = subprocess.run(["qemu-x86_64", "-cpu", processor, FLOE, TENSION, "-output_dir",
                                   processor], cwd=self.folder,
                                  env=ENVIRONMENT, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.splitlines()[1], f"library: built for {level}")
            self.assertAlmostEqual(self.summary(processor)["E_over_Eb"], 0.8337, delta=1e-3)

    def test_wrapper_refuses(self):
        for words, message in (([], "a level and a program"),
                               (["x86-64-v9", FLOE], "unknown level 'x86-64-v9'"),
                               (["x86-64", "./none"], "no such program: ./none")):
            done = subprocess.run([AT_LEVEL, *words], cwd=self.folder, capture_output=True,
                                  text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn(message, done.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())
