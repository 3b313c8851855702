#!/usr/bin/python3
"""What `cmake --install` leaves: a floe that needs neither the source tree nor its first place, and
a library that other projects find. The build folder is that of $FLOE, built as a whole (its man
page too)."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

import launch

REPOSITORY = Path(__file__).resolve().parents[2]
FLOE = Path(os.environ.get("FLOE", REPOSITORY / "build/release/floe")).resolve()
BUILD = FLOE.parent
# What a run needs from outside; nothing else of the shell's environment, least of all FLOE.
KEEP = {name: value for name, value in os.environ.items()
        if name.startswith(("OMP", "OPENBLAS", "PRTE", "CCACHE", "HOME"))}
ENVIRONMENT = KEEP | {"PATH": "/usr/bin:/bin"}
CMAKE = shutil.which("cmake")

ADDED = """cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES C CXX)
{how}
add_executable(user {example}/main.cpp)
target_link_libraries(user PRIVATE floe::floe)
get_target_property(built floe BINARY_DIR)
message(STATUS "tests of floe: ${{FLOE_TESTS}}, rules to install: ${{FLOE_INSTALL}}, "
               "source: ${{CMAKE_SOURCE_DIR}}")
"""

SHEET = "sheet: {length: 8, thickness: 1, element_size: 2, iterations: 5}\n"
STEPPED = {
    "tension": "forces: [beam]\n" + SHEET + "time: {end: 0.02, dt: 0.002}\n"
               "boundary: {names: [a, b], a: {set: left, fix: x y z rx ry rz},\n"
               "           b: {set: right, fix: x, displacement: [0.01, 0, 0], ramp: 0.02}}\n",
    "explicit": "integrator: explicit\nforces: [beam, gravity, buoyancy]\n" + SHEET
                + "time: {end: 0.02}\n"
                + "initial: {names: [i], i: {set: right, velocity: [0, 0, 1]}}\n",
    "implicit": "integrator: implicit\nforces: [beam, gravity, buoyancy]\n" + SHEET
                + "time: {end: 0.02, dt: 0.001}\n"}


def run(*words, cwd, code=0):
    """Standard output of a command."""
    # Ninja is there after tools/setup; make need not be.
    environment = {**ENVIRONMENT, "CMAKE_GENERATOR": "Ninja"}
    done = subprocess.run([str(word) for word in words], cwd=cwd, env=environment,
                          capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{words} ended with {done.returncode}: "
                             f"{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout + done.stderr


class Installed(launch.FolderTest):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "a prefix"
        run(CMAKE, "--install", BUILD, "--prefix", self.folder / "first", cwd=self.folder)
        (self.folder / "first").rename(self.prefix)  # it works where it is moved to
        self.floe = self.prefix / "bin/floe"

    def test_program(self):
        work = self.folder / "work"
        work.mkdir()
        share = self.prefix / "share/floe"
        self.assertIn("floe ", run(self.floe, "--version", cwd=work))
        self.assertIn(str(share / "input"), run(self.floe, "--help", cwd=work))
        self.assertIn("E/Eb", run(self.floe, share / "input/tension.yaml", cwd=work))
        run(self.floe, "plot_sheet", "out/tension", cwd=work)
        self.assertTrue((work / "out/tension/sheet.png").exists())
        (work / "floe").symlink_to(self.floe)
        run("./floe", "make_lattice", "block", "block.h5", cwd=work)
        run("./floe", "campaign", "--only", "tension_L10_h1_3h", "--meshes", "1", "--jobs", "1",
            "--no-report", cwd=work)
        self.assertTrue((work / "out/campaign_quasistatic/results.h5").exists())
        self.assertIn("10 runs, 0 of them done", run(
            "./floe", "ensemble", share / "input/ensembles/ice_cone.yaml", "--check", cwd=work))
        run(share / "tools/campaign_report", "out/campaign_quasistatic", cwd=work)
        self.assertIn("source tree", run(self.floe, "campaign_report", "out/campaign_quasistatic",
                                         "--write", cwd=work, code=2))
        self.assertIn(f"is it '{share}/input/tension.yaml'?",
                      run(self.floe, "tension", cwd=work, code=2))

    def test_files(self):
        page = self.prefix / "share/man/man1/floe.1.gz"
        self.assertTrue(run("zcat", page, cwd=self.folder).startswith(".TH FLOE 1 "))
        self.assertTrue((self.prefix / "share/doc/floe/LICENSE").exists())
        for script in (self.prefix / "share/floe/tools").iterdir():
            self.assertEqual(os.access(script, os.X_OK), script.suffix == "", script)
        # No script or configuration knows where it was made (binaries have the sources' names in
        # their messages).
        for path in self.prefix.rglob("*"):
            if (path.is_file() and path.suffix not in (".so", ".gz")
                    and path.parent.name not in ("bin", "lib")):
                text = path.read_bytes()
                for place in (REPOSITORY, BUILD, self.folder / "first"):
                    self.assertNotIn(str(place).encode(), text, path)

    def test_one_package(self):
        """Python's package floe is there once, and tools use it and no other."""
        package = self.prefix / "lib/python3/dist-packages/floe"
        self.assertEqual([path.parent for path in self.prefix.rglob("program.py")], [package])
        here, there = ({path.relative_to(folder) for path in folder.rglob("*")
                        if path.suffix not in (".so", ".pyc") and path.name != "__pycache__"}
                       for folder in (package, REPOSITORY / "python/floe"))
        self.assertEqual(here, there)
        run(self.floe, self.prefix / "share/floe/input/tension.yaml", cwd=self.folder)
        (self.folder / "other/floe").mkdir(parents=True)
        (self.folder / "other/floe/__init__.py").write_text("raise ValueError('another floe')")
        done = subprocess.run([self.floe, "plot_sheet", "out/tension"], cwd=self.folder, text=True,
                              capture_output=True,
                              env={**ENVIRONMENT, "PYTHONPATH": str(self.folder / "other")})
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_python(self):
        """The package that was installed, and no other, runs a scene."""
        packages = self.prefix / "lib/python3/dist-packages"
        if not list(packages.glob("floe/_floe*.so")):
            self.skipTest("the Python module is not built")
        script = ("import floe; floe.Simulation(floe.Scene(sys.argv[1])).run().close(); "
                  "print(floe.__file__); from floe import program; print(program.floe())")
        done = subprocess.run(["/usr/bin/python3", "-c", "import sys; " + script,
                               self.prefix / "share/floe/input/tension.yaml"], cwd=self.folder,
                              env={**ENVIRONMENT, "PYTHONPATH": str(packages),
                                   "PYTHONDONTWRITEBYTECODE": "1"},
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.splitlines(),
                         [str(packages / "floe/__init__.py"), str(self.floe)])
        summary = json.loads((self.folder / "out/tension/summary.json").read_text())
        self.assertEqual(summary["status"], "done")

    def test_library(self):
        example = self.prefix / "share/doc/floe/examples/measure_lattice"
        build = self.folder / "build"
        run(CMAKE, "-S", example, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
            cwd=self.folder)
        run(CMAKE, "--build", build, cwd=self.folder)
        run(self.floe, self.prefix / "share/floe/input/tension.yaml", "-output_dir", "out",
            cwd=self.folder)
        whole, sheet, cut = run(build / "measure_lattice", "out/lattice.h5", "0", "-30", "0", "30",
                                cwd=self.folder).splitlines()
        with h5py.File(self.folder / "out/lattice.h5") as file:
            beams = len(file["beams/bodies"])
        # Its weight is 920 kg/m3 x 1600 m3.
        self.assertEqual(whole, f"whole: 462 bodies, {beams} beams, 1 piece, the heaviest of "
                                "1.472e+06 kg")
        # Young's modulus of a large sheet of this lattice, in those of its beams: near the 0.8 of
        # the regular one.
        self.assertAlmostEqual(float(sheet.split("=")[1].split(",")[0]), 0.8, delta=0.03)
        left = int(re.match(r"cut: 462 bodies, (\d+) beams, 2 pieces, ", cut)[1])
        self.assertTrue(beams - 60 < left < beams - 15,
                        "a cut through 20 cells meets about two beams of each")
        error = run(build / "measure_lattice", "none.h5", cwd=self.folder, code=2)
        self.assertIn("none.h5", error)

    def test_simulation(self):
        """A program steps a scene, and its results are those of the program floe."""
        examples, build = self.prefix / "share/doc/floe/examples", self.folder / "examples"
        run(CMAKE, "-S", examples, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
            cwd=self.folder)
        run(CMAKE, "--build", build, cwd=self.folder)
        for name in ("tension", "explicit", "implicit"):
            with self.subTest(scene=name):
                scene = self.folder / f"{name}.yaml"
                scene.write_text(STEPPED[name])
                run(self.floe, scene.name, "-output_dir", "whole", cwd=self.folder)
                said = run(build / "library", scene.name, "-output_dir", "stepped",
                           cwd=self.folder).splitlines()
                times = [float(line.split(" s:")[0]) for line in said if " samples, " in line]
                for tenth, time in enumerate(times, 1):
                    self.assertGreaterEqual(time, 0.1 * tenth * 0.02 * (1 - 1e-6))
                self.assertGreaterEqual(len(times), 9)
                whole, stepped = (self.folder / where / "history.csv"
                                  for where in ("whole", "stepped"))
                self.assertEqual(whole.read_bytes(), stepped.read_bytes())
                summary = json.loads((self.folder / "stepped/summary.json").read_text())
                self.assertEqual(summary["status"], "done")
        error = run(build / "library", "tension.yaml", "-sheet_length", "x", cwd=self.folder,
                    code=2)
        self.assertEqual(error.count("\n"), 1, error)
        self.assertIn("sheet: length", error)

    def test_headers(self):
        """They need nothing but floe::floe, on the oldest processor and without a warning."""
        project = self.folder / "project"
        project.mkdir()
        headers = sorted((self.prefix / "include").rglob("*.h"))
        of_sources = sorted((REPOSITORY / "include").rglob("*.h"))
        self.assertEqual([header.relative_to(self.prefix / "include") for header in headers],
                         [header.relative_to(REPOSITORY / "include") for header in of_sources])
        self.assertGreater(len(headers), 20)
        lines = [f'#include "{header.relative_to(self.prefix / "include")}"\n'
                 for header in headers]
        for name, order in (("forward", lines), ("backward", reversed(lines))):
            (project / f"{name}.cpp").write_text("".join(order))
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(headers LANGUAGES CXX)\n"
            "find_package(floe REQUIRED)\n"
            "add_library(headers OBJECT forward.cpp backward.cpp)\n"
            "target_link_libraries(headers PRIVATE floe::floe)\n"
            "target_compile_options(headers PRIVATE -march=x86-64 -Wall -Wextra -Wpedantic "
            "-Wshadow -Werror)\n")
        run(CMAKE, "-S", project, "-B", "build", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            cwd=self.folder)
        run(CMAKE, "--build", "build", cwd=self.folder)

    def test_wrong_petsc(self):
        config = next(self.prefix.rglob("floe-config.cmake"))
        config.write_text(config.read_text().replace('MATCHES "^3', 'MATCHES "^2'))
        error = run(CMAKE, "-S", REPOSITORY / "examples/measure_lattice", "-B", "build",
                    f"-DCMAKE_PREFIX_PATH={self.prefix}",
                    cwd=self.folder, code=1)
        self.assertIn("it was built with PETSc", error)


# The backend of pip over what is built already.
WHEEL = """import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
import pip_backend
pip_backend.BUILD = Path(sys.argv[2])
pip_backend.build = lambda options: None
print(pip_backend.build_wheel("."))
"""


class Wheel(launch.FolderTest):
    def test_pip(self):
        """What `pip install .` installs, in an environment of its own: package, module, program and
        tools, which find each other, and which pip removes."""
        if not list(BUILD.glob("python/floe/_floe*.so")):
            self.skipTest("the Python module is not built")
        place = self.folder / "v"
        made = subprocess.run(["/usr/bin/python3", "-m", "venv", "--system-site-packages", place],
                              capture_output=True, text=True)
        if made.returncode != 0:
            self.skipTest("python3-venv is not installed")
        python = place / "bin/python"
        name = run(python, "-c", WHEEL, REPOSITORY / "python", BUILD, cwd=self.folder)
        run(python, "-m", "pip", "install", "--no-index", "--no-deps", name.strip(),
            cwd=self.folder)
        scene = place / "share/floe/input/tension.yaml"
        said = run(python, "-c", "import floe, sys; from floe import program\n"
                   "floe.Simulation(floe.Scene(sys.argv[1])).run().close()\n"
                   "print(floe.__file__, program.floe(), program.scene('input/tension.yaml'))",
                   scene, cwd=self.folder)
        package = next(place.glob("lib/python3*/site-packages/floe"))
        self.assertEqual(said.split(), [str(package / "__init__.py"),
                                        str((place / "bin/floe").resolve()), str(scene.resolve())])
        run(place / "bin/floe", "plot_sheet", "out/tension", cwd=self.folder)
        self.assertTrue((self.folder / "out/tension/sheet.png").exists())
        run(python, "-m", "pip", "uninstall", "--yes", "floe", cwd=self.folder)
        self.assertEqual([path for path in place.rglob("*floe*") if path.is_file()
                          and path.suffix != ".pyc"], [])


class Included(unittest.TestCase):
    """A project that has floe's sources as a part of itself."""

    def configure(self, how):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "CMakeLists.txt").write_text(ADDED.format(how=how,
                                                                      example=REPOSITORY
                                                                      / "examples/measure_lattice"))
            text = run(CMAKE, "-S", folder, "-B", f"{folder}/build", "-G", "Ninja", cwd=folder)
            self.assertIn(f"tests of floe: OFF, rules to install: OFF, source: {folder}", text)
            commands = run("ninja", "-C", f"{folder}/build", "-t", "commands", "user", cwd=folder)
            self.assertIn("libfloe.so", commands)
            self.assertNotIn("-march", commands.splitlines()[-2], "flags of ours are no one else's")

    def test_add_subdirectory(self):
        self.configure(f"add_subdirectory({REPOSITORY} floe)")

    def test_fetch_content(self):
        self.configure("include(FetchContent)\n"
                       f"FetchContent_Declare(floe SOURCE_DIR {REPOSITORY})\n"
                       "FetchContent_MakeAvailable(floe)")


if __name__ == "__main__":
    sys.exit(unittest.main())
