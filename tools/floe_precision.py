"""Work and precision: the error of floe's integrators against the processor time they take
(tools/bench precision).

Each case is one scene; each run of it differs from the others in its integrator, step, kinematics
or mesh. Errors are told apart:
  error       against a converged solution of the same lattice: what the integrator makes wrong
              (time and iteration)
  iteration   implicit and static runs: what a tighter Newton tolerance changes in the same run
  lattice     of the converged solution against the analytic answer: what the mesh makes wrong,
              whatever the integrator
Time is the processor's (user and system) on one rank, less that of the same scene with -check
(reading, meshing, building); on a busy machine it says more than the clock.
"""
import json
import math
import os
import resource
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from floe import lattice as fl
from floe.results.output import Output


@dataclass
class Method:
    """One way to run a case: a name for the figure's legend, and options of the command line."""
    name: str
    options: tuple
    label: str
    default: bool = False

    def key(self):
        return f"{self.name} {self.label}"


@dataclass
class Case:
    """A scene, what is compared, and what is known of it.

    make(folder, mesh): writes lattice files, returns the scene's text; measure(output): the
    compared numbers, an array; settled: whether a static solution answers the same question;
    analytic(mesh): the exact answer, None if there is none; number(output): the number that it is
    compared with; moving: options of all runs but static ones.
    """
    name: str
    title: str
    make: object
    measure: object
    meshes: tuple
    settled: bool
    end: float
    methods: list = field(default_factory=list)
    moving: tuple = ()
    analytic: object = None
    number: object = None


# -- runs
# -------------------------------------------------------------------------------------------
class Runner:
    """Runs floe and keeps what came out, so that an interrupted benchmark goes on where it was."""

    def __init__(self, floe, folder, environment, repeats=3):
        self.floe, self.folder, self.environment, self.repeats = floe, Path(
            folder), environment, repeats
        self.folder.mkdir(parents=True, exist_ok=True)
        self.file = self.folder / "runs.jsonl"
        self.known = {}
        if self.file.exists():
            self.known = {run["key"]: run for run in map(json.loads,
                                                         self.file.read_text().splitlines())}

    def run(self, case, mesh, options, check=False):
        """{cpu, steps, newton, measure, number, message}; the measure is None if the run failed."""
        if "quasistatic" not in options:
            options = (*case.moving, *options)
        key = f"{case.name} {mesh} {'check ' if check else ''}{' '.join(options)}"
        if key not in self.known:
            self.known[key] = {"key": key, **self._run(case, mesh, options, check)}
            with open(self.file, "a") as out:
                out.write(json.dumps(self.known[key]) + "\n")
        return self.known[key]

    def _run(self, case, mesh, options, check):
        with tempfile.TemporaryDirectory() as work:
            scene = Path(work, "scene.yaml")
            scene.write_text(case.make(self.folder, mesh))
            command = [str(self.floe), str(scene), "-output_dir", f"{work}/out", *options,
                       *(["-check"] if check else [])]
            spent = []
            # the least of short runs counts
            while not spent or (len(spent) < self.repeats and sum(spent) < 1.5):
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                done = subprocess.run(command, env=self.environment, capture_output=True, text=True)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
            cpu = min(spent)
            result = {"cpu": cpu, "steps": 0, "newton": 0, "measure": None, "number": None,
                      "message": ""}
            if done.returncode != 0:
                lines = [line for line in done.stderr.splitlines() if line.startswith("floe:")]
                return {**result, "message": (lines or done.stderr.splitlines() or ["failed"])[-1]}
            if check:
                return result
            output = Output(f"{work}/out")
            result |= {"steps": output.summary["steps"],
                       "newton": output.summary.get("newton_iterations", 0)}
            result["measure"] = np.asarray(case.measure(output), float).ravel().tolist()
            if case.number:
                result["number"] = float(case.number(output))
            return result


def error(run, reference):
    """Root of the mean square, relative to the reference's; None if the run failed."""
    if run["measure"] is None:
        return None
    a, b = np.array(run["measure"]), np.array(reference["measure"])
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


# -- cases
# ------------------------------------------------------------------------------------------
def explicit(*options):
    return ("-integrator", "explicit", *options)


def implicit(*options):
    return ("-integrator", "implicit", *options)


def stepped(damped, end, counts):
    """Runs that every case has: leapfrog and Runge-Kutta at several steps, implicit at several
    steps and radii."""
    methods = [Method("leapfrog", explicit(), "default", True)]
    methods += [Method("leapfrog", explicit("-time_safety", str(s)), f"{s:g} of the limit")
                for s in (0.45, 0.2)]
    for kind in ("2a", "4") if damped else ("3bs", "4"):
        for safety in (0.9, 0.45):
            methods.append(Method(f"rk {kind}",
                                  explicit("-ts_type", "rk", "-ts_rk_type", kind, "-time_safety",
                                           str(safety)),
                                  f"{safety:g} of the limit"))
    methods.append(Method("implicit, adaptive", implicit(), "default", True))
    for tolerance in ("1e-2", "1e-4", "1e-5"):
        methods.append(Method("implicit, adaptive", implicit("-ts_rtol", tolerance),
                              f"-ts_rtol {tolerance}"))
    for radius in (0.8, 1, 0.5, 0):
        for count in counts if radius == 0.8 else counts[1:3]:
            methods.append(Method(f"implicit, radius {radius:g}",
                                  implicit("-time_dt", repr(end / count), "-ts_liealpha_radius",
                                           str(radius)),
                                  f"dt {end / count:.3g} s"))
    methods.append(Method("leapfrog, linear", explicit("-beam_kinematics", "linear"), "default"))
    methods.append(Method("implicit, linear", implicit("-beam_kinematics", "linear"), "default"))
    return methods


DASHPOTS = ("-beam_damping_ratio", "1", "-beam_damping_modes", "all")
STATIC = [Method("quasi-static", ("-integrator", "quasistatic"), "default", True),
          Method("quasi-static, linear", ("-integrator", "quasistatic", "-beam_kinematics",
                                          "linear"), "default")]


def reference_options(case):
    """What converges on the same lattice: statics where the motion has settled, else Runge-Kutta of
    order 4."""
    if case.settled:
        return ("-integrator", "quasistatic", "-snes_rtol", "1e-13")
    return explicit("-ts_type", "rk", "-ts_rk_type", "4", "-time_safety", "0.1")


def tension():
    def make(folder, mesh):
        return f"""integrator: explicit
forces: [beam]
sheet: {{length: 20, width: 20, thickness: 0.5, element_size: {mesh}, seed: 1,
        relaxation: lloyd, iterations: 150}}
ice: {{young: 4e9, poisson: 0.3, density: 920}}
boundary:
  names: [left, right]
  left: {{set: left, fix: x}}
  right: {{set: right, fix: x, displacement: [0.02, 0, 0], ramp: 0.2}}
time: {{end: 0.4}}
report: [tension]
"""
    return Case("tension", "tension, settled: E", make, lambda o: [o.summary["E"]], (2, 1), True,
                0.4,
                STATIC + stepped(True, 0.4, (4, 8, 16, 32)), DASHPOTS, lambda mesh: 1.0,
                lambda o: o.summary["E_over_Estar"])


def bending():
    def make(folder, mesh):
        return f"""integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {{length: 40, width: 40, thickness: 0.5, element_size: {mesh}, seed: 1,
        relaxation: lloyd, iterations: 150}}
ice: {{young: 4e9, poisson: 0.3, density: 920}}
gravity: 9.81
water: {{density: 1010}}
load:
  names: [centre]
  centre: {{point: [0, 0], force: [0, 0, -1e4], ramp: 1}}
time: {{end: 4}}
report: [bending]
"""
    drag = ("-forces", "beam,gravity,buoyancy,drag", "-water_drag_linear", "4270")
    return Case("bending", "bending on water, settled: deflection", make,
                lambda o: [o.summary["deflection_max"]],
                (4, 2), True, 4, STATIC + stepped(True, 4, (8, 16, 32, 64)), DASHPOTS + drag,
                lambda mesh: 1.0,
                lambda o: o.summary["deflection_over_wyman"])


STRIP = {"length": 10.0, "section": fl.Section(0.6, 0.4)}


def strip():
    """A cantilever under a load that comes at once, for 2.7 periods of its first mode."""
    end = 2.0

    def make(folder, mesh):
        file = folder / f"strip{mesh}.h5"
        fl.straight_frame(STRIP["length"], mesh, STRIP["section"]).write(file)
        return f"""integrator: explicit
forces: [beam]
lattice_file: {file}
beam: {{shear: exact}}
boundary:
  names: [root]
  root: {{set: root, fix: "x y z rx ry rz"}}
load:
  names: [tip]
  tip: {{set: tip, force: [0, 0, -1000]}}
time: {{end: {end}}}
output: {{fields: {end}}}
"""

    def analytic(mesh):
        """Tip at the end under a sudden load: static deflection less all modes' cosines
        (Euler-Bernoulli) [m]."""
        s, length = STRIP["section"], STRIP["length"]
        inertia, mass = s.width * s.height**3 / 12, s.density * s.width * s.height
        total = 0.0
        for k in range(1, 6):
            root = {1: 1.8751040687, 2: 4.6940911330, 3: 7.8547574382}.get(k, (k - 0.5) * math.pi)
            omega = root**2 * math.sqrt(s.young * inertia / (mass * length**4))
            # tip value 2, norm 1
            total -= 1000 * 4 / (mass * length * omega**2) * (1 - math.cos(omega * end))
        return total

    return Case("strip", "vibrating strip: displacements", make, displacements, (16, 32), False,
                end,
                stepped(False, end, (50, 200, 800, 3200)), (), analytic, tip_height)


def displacements(output):
    """Of all bodies at the last sample [m]."""
    return output.field("bodies_displacement", output.times[-1])


def tip_height(output):
    return output.field("bodies_displacement", output.times[-1])[output.sets["tip"][0], 2]


def rotation():
    """A soft bar flies, spins by 6 rad and vibrates in its first bending mode, smoothly; about four
    of its periods."""
    end, length, spin, bend, flight = 2.0, 10.0, 3.0, 5.0, np.array([0.7, -0.3, 0.5])

    def make(folder, mesh):
        file = folder / f"rotation{mesh}.h5"
        bar = fl.straight_frame(length, mesh, fl.Section(1.0, 1.0, young=4e7))
        bar.write(file)
        s = 2 * bar.position[:, 0] / length - 1  # -1 to 1; s^2 - 1/3 has no momentum
        zero = np.zeros_like(s)
        velocity = flight + np.column_stack([zero, spin * s * length / 2 + bend * (s**2 - 1 / 3),
                                             zero])
        with h5py.File(file, "a") as out:
            out["bodies/velocity"] = velocity
            out["bodies/angular_velocity"] = np.column_stack([zero, zero,
                                                              spin + bend * 4 * s / length])
        return f"""integrator: explicit
forces: [beam]
lattice_file: {file}
beam: {{shear: exact}}
time: {{end: {end}}}
output: {{fields: {end}}}
"""

    def centre(output):
        """Way of the centre of mass in y [m]."""
        weight = np.ones(len(output.position))
        weight[[0, -1]] = 0.5
        return np.average(output.field("bodies_displacement", output.times[-1])[:, 1],
                          weights=weight)

    def straight(mesh):
        """What momentum says of it; the lattice's own first momentum is not quite that of the
        parabola."""
        s = 2 * np.arange(mesh + 1) / mesh - 1
        weight = np.ones(mesh + 1)
        weight[[0, -1]] = 0.5
        return end * np.average(flight[1] + spin * s * length / 2 + bend * (s**2 - 1 / 3),
                                weights=weight)

    methods = [m for m in stepped(False, end, (100, 400, 1600, 6400)) if "linear" not in m.name]
    return Case("rotation", "large rotation: displacements", make, displacements, (16, 32), False,
                end, methods,
                (), straight, centre)


def cases():
    return [tension(), bending(), strip(), rotation()]


# -- the whole benchmark
# ----------------------------------------------------------------------------
def measure_case(case, runner, say=print):
    """Rows of one case: every method on the finest mesh, the converged solution on all of them.

    Returns {rows: [...], lattice: [(mesh, lattice error)], iteration: ...}; a row is {name, label,
    default, cpu, steps, newton, error, message}.
    """
    main = case.meshes[-1]
    base = runner.run(case, main, (), check=True)["cpu"]
    options = reference_options(case)
    reference = runner.run(case, main, options)
    if reference["measure"] is None:
        raise RuntimeError(f"{case.name}: no reference: {reference['message']}")
    rows = []
    for method in case.methods:
        run = runner.run(case, main, method.options)
        rows.append({"name": method.name, "label": method.label, "default": method.default,
                     "steps": run["steps"],
                     "newton": run["newton"], "cpu": max(run["cpu"] - base, 5e-3),
                     "error": error(run, reference),
                     "message": run["message"]})
        say(f"{case.name}: {method.key()}: {rows[-1]['cpu']:.2f} s, error {rows[-1]['error']}")
    loose = runner.run(case, main, implicit())
    tight = runner.run(case, main, implicit("-snes_rtol", "1e-12"))
    lattice = []
    for mesh in case.meshes:
        converged = runner.run(case, mesh, options)
        lattice.append((mesh, converged["number"] / case.analytic(mesh) - 1))
    return {"rows": rows, "mesh": main, "lattice": lattice, "iteration": error(loose, tight)}


def front(rows):
    """Rows that no other one beats in both time and error."""
    good = [r for r in rows if r["error"] is not None]
    return [r for r in good if not any(o["cpu"] < r["cpu"] and o["error"] <= r["error"]
                                       for o in good)]


def best(rows, target):
    """The cheapest row of at most this error; None if there is none."""
    good = [r for r in rows if r["error"] is not None and r["error"] <= target]
    return min(good, key=lambda r: r["cpu"], default=None)


def ratios(result, target):
    """(name of a default method, time over the best row's) of those whose error is small enough."""
    cheapest = best(result["rows"], target)
    if cheapest is None:
        return None, []
    return cheapest, [(r["name"], r["cpu"] / cheapest["cpu"]) for r in result["rows"]
                      if r["default"] and r["error"] is not None and r["error"] <= target]


def draw(case, result, file):
    """Error against time of one case, the front as a line."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(7.2, 4.8), layout="constrained")
    names = list(dict.fromkeys(r["name"] for r in result["rows"]))
    floor = 1e-13
    for name, marker in zip(names, "os^Dv<>p*XPd" * 3):
        rows = sorted((r for r in result["rows"] if r["name"] == name and r["error"] is not None),
                      key=lambda r: r["cpu"])
        if not rows:
            continue
        x, y = [r["cpu"] for r in rows], [max(r["error"], floor) for r in rows]
        line, = axes.plot(x, y, marker + "-", markersize=5, linewidth=0.8, markerfacecolor="none",
                          label=name)
        axes.plot([r["cpu"] for r in rows if r["default"]],
                  [max(r["error"], floor) for r in rows if r["default"]], marker,
                  markersize=7, color=line.get_color())
    line = sorted(front(result["rows"]), key=lambda r: r["cpu"])
    axes.step([r["cpu"] for r in line], [max(r["error"], floor) for r in line], where="post",
              color="#8a949e", linewidth=3,
              alpha=0.4, zorder=0, label="front")
    for mesh, value in result["lattice"]:
        if mesh == result["mesh"]:
            axes.axhline(max(abs(value), floor), color="black", linewidth=0.8, linestyle=":",
                         label="error of the lattice")
    axes.set(xscale="log", yscale="log", xlabel="processor time [s]", ylabel="error, relative",
             title=case.title)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8, ncols=2)
    figure.savefig(file, dpi=130)
    plt.close(figure)


def table(case, result):
    """Markdown of one case."""
    on_front = {id(r) for r in front(result["rows"])}
    lines = [f"### {case.title[0].upper()}{case.title[1:]}", "", f"![](precision/{case.name}.png)",
             "",
             "| method | | time [s] | steps | Newton | error |", "|---|---|---|---|---|---|"]
    for r in result["rows"]:
        value = f"{r['error']:.1e}" if r["error"] is not None else r["message"].removeprefix(
            "floe: ")
        mark = " **front**" if id(r) in on_front else ""
        lines.append(f"| {r['name']} | {r['label']}{mark} | {r['cpu']:.2f} | {r['steps']} | "
                     f"{r['newton']} | {value} |")
    lattice = ", ".join(f"{value:+.1e} (mesh {mesh:g})" for mesh, value in result["lattice"])
    lines += ["", f"Lattice error: {lattice}. Iteration error of the implicit default: "
                  f"{result['iteration']:.0e}.", ""]
    for target, text in ((1e-2, "1 %"), (1e-3, "0.1 %")):
        cheapest, others = ratios(result, target)
        if cheapest is None:
            continue
        ratio = ", ".join(f"{name} {value:.1f}"
                          for name, value in others) or "no default is that good"
        lines.append(f"At {text}: best is {cheapest['name']}, {cheapest['label']} "
                     f"({cheapest['cpu']:.2f} s); "
                     f"time of the defaults over that: {ratio}.")
    return lines + [""]


def benchmark(floe, root, environment, names, fresh):
    """Runs all cases; figures into docs/precision, the table as lines of Markdown."""
    folder = root / "out/precision"
    if fresh and (folder / "runs.jsonl").exists():
        os.remove(folder / "runs.jsonl")
    runner = Runner(floe, folder, environment)
    pictures = root / "docs/precision"
    pictures.mkdir(parents=True, exist_ok=True)
    lines = []
    for case in cases():
        if names and case.name not in names:
            continue
        result = measure_case(case, runner)
        draw(case, result, pictures / f"{case.name}.png")
        lines += table(case, result)
    return lines
