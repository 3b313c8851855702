#!/usr/bin/python3
"""Every option that PETSc asks for in floe's kinds of runs, with values that cannot be right: a
run, or one line that says what is wrong, with an exit code that has a meaning; never a trace, a
crash, a hang or a launcher's banner.

FLOE_FULL=1 asks the installed PETSc for its options (by its -help, which a library put in before it
switches on) and tries all of them, each in the first kind of run that asks for it; otherwise a
sample of them. FLOE_SWEEP takes those only whose names match a regular expression,
FLOE_KINDS=NAME,NAME only these kinds of runs.
"""
import concurrent.futures
import os
import random
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "regression"))
from launch import ENVIRONMENT, FLOE, FULL, PROGRESS  # noqa: E402

STATIC = """forces: [beam]
sheet: {length: 6, thickness: 1, element_size: 2, iterations: 5}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [p], p: {set: right, force: [1e3, 0, 1e3]}}
time: {end: 1}
"""
MOVING = STATIC.replace("time: {end: 1}", "time: {end: 1e-3}")
SCENES = {"static": STATIC, "implicit": "integrator: implicit\n" + MOVING,
          "explicit": "integrator: explicit\n" + MOVING}
RK = ("-ts_type", "rk", "-ts_rk_type", "5dp", "-ts_adapt_type", "basic")
# What is run: a scene and options that are in their place.
KINDS = {
    "static": ("static",),
    "iterative": ("static", "-ksp_type", "gmres", "-pc_type", "gamg"),
    "blocks": ("static", "-ksp_type", "fgmres", "-pc_type", "asm"),
    "trust region": ("static", "-snes_type", "newtontr", "-pc_type", "lu", "-snes_monitor"),
    "line search": ("static", "-snes_linesearch_type", "bt", "-snes_ksp_ew", "-ksp_type", "cg",
                    "-pc_type", "bjacobi"),
    "implicit": ("implicit",),
    "adaptive": ("implicit", "-ts_adapt_type", "basic", "-ts_monitor"),
    "explicit": ("explicit",),
    "rk": ("explicit", *RK),
}
VALUES = ("-1", "0", "3", "1e300", "nan", "abc", "", "/nonexist/x", ":/nonexist/x", "1,2")
# They wait for somebody, end the process by design, or open windows.
LEFT_OUT = re.compile(
    r"debugger|^help|^display|^draw_|saws|^on_error_|x_virtual|^petsc_ci|stop_for|^version$|_draw|"
    r"_lg$|_lg_|_pause")
LISTENER = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
int PetscOptionsSetValue(void*, const char*, const char*);
typedef int Initialize(int*, char***, const char*, const char*);
int PetscInitialize(int* n, char*** words, const char* file, const char* help) {
  PetscOptionsSetValue(0, "-help", "true");
  return ((Initialize*)dlsym(RTLD_NEXT, "PetscInitialize"))(n, words, file, help);
}
"""
# A few of all, where PETSc is not asked.
SAMPLE = ("snes_max_it", "snes_rtol", "snes_view", "snes_monitor", "ksp_type", "ksp_rtol",
          "pc_type", "mat_type", "snes_type",
          "pc_factor_mat_ordering_type", "mat_mumps_icntl_7", "mat_mumps_cntl_1", "ts_adapt_clip",
          "ts_max_steps", "ts_monitor",
          "snes_linesearch_type", "log_view", "malloc_debug", "fp_trap", "check_pointer_intensity",
          "ts_adapt_safety",
          "pc_gamg_threshold", "mg_levels_ksp_type", "sub_pc_type")
# What PETSc says where it has no display to draw on.
NO_DISPLAY = re.compile(r"^(?:\[\d+\]PETSC ERROR: (?:Unable to open display|PETSc unable to use "
                        r"X).*|proceeding without graphics|"
                        r" +Make sure your COMPUTE NODES.*| +to this X server.*| +is set or you "
                        r"use the -display.*)\n", re.M)
TRACE = re.compile(r"PETSC ERROR|MPI_ABORT|Traceback|internal error|received signal|terminate "
                   r"called|\*\*\* (?:An error|Process|The MPI)|Backtrace")


def options_of(kind, folder):
    """What PETSc says it asks for in a run of a kind."""
    listener = folder / "listener.so"
    if not listener.exists():
        (folder / "listener.c").write_text(LISTENER)
        subprocess.run(["cc", "-shared", "-fPIC", "-o", listener, folder / "listener.c", "-ldl"],
                       check=True, capture_output=True)
    scene, *words = KINDS[kind]
    done = subprocess.run([FLOE, f"{scene}.yaml", *words, "-output_dir", "help"], cwd=folder,
                          capture_output=True, text=True,
                          env={**ENVIRONMENT, "LD_PRELOAD": str(listener)}, errors="replace")
    names = re.findall(r"^ *-([A-Za-z]\w*):? ", done.stdout, re.M)
    return sorted({name for name in names if not LEFT_OUT.search(name)})


def problem_of(kind, name, value, folder):
    """What is wrong with the answer; empty if it is right."""
    scene, *words = KINDS[kind]
    words = [FLOE, f"{folder}/{scene}.yaml", *words, f"-{name}", *([value] if value else [])]
    with tempfile.TemporaryDirectory() as here:
        try:
            done = subprocess.run(words, cwd=here, capture_output=True, text=True, env=ENVIRONMENT,
                                  errors="replace", timeout=300)
        except subprocess.TimeoutExpired:
            return "hangs"
        made = sorted(os.listdir(here))
    said = NO_DISPLAY.sub("", PROGRESS.sub("", done.stderr))
    found = TRACE.search(said + done.stdout)
    lines = [line for line in said.splitlines() if line.startswith("floe:")
             and not line.startswith("floe: warning:")]
    if done.returncode not in (0, 1, 2, 3):
        return f"exit code {done.returncode}: {said[-300:]}"
    if found:
        return f"{found[0]} (exit code {done.returncode}): {said[:600]}"
    if done.returncode == 2 and len(said.splitlines()) != 1:
        return f"not one line: {said[:600]}"
    if done.returncode and len(lines) != 1:
        return f"not one line of floe's: {said[:600]}"
    if done.returncode == 2 and made:
        return f"made {made}: {said}"
    # Something of the option must be named.
    if done.returncode == 2 and name not in said:
        return f"does not name it: {said}"
    return ""


class Sweep(unittest.TestCase):
    def test_values_that_cannot_be_right(self):
        wanted = re.compile(os.environ.get("FLOE_SWEEP", ""))
        kinds = os.environ.get("FLOE_KINDS", ",".join(KINDS)).split(",")
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            for name, text in SCENES.items():
                (folder / f"{name}.yaml").write_text(text)
            cases, seen = [], set()
            for kind in kinds:
                names = options_of(kind, folder) if FULL else SAMPLE
                cases += [(kind, name, value) for name in names for value in VALUES
                          if wanted.search(name) and not (FULL and name in seen)]
                seen |= set(names)
            if not FULL:
                cases = random.Random(1).sample(cases, 60)
            tried, bad = len(cases), []
            with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("FLOE_JOBS",
                                                                          "2"))) as pool:
                for case, problem in zip(cases,
                                         pool.map(lambda case: problem_of(*case, folder), cases)):
                    if problem:
                        bad.append((*case, problem))
                        if FULL:
                            print(*case, problem, sep=" | ", flush=True)
        self.assertEqual(bad, [], f"{len(bad)} of {tried}")


if __name__ == "__main__":
    unittest.main()
