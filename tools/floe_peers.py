"""floe beside Yade, Debian's package, on the same machine in one run (tools/bench --peers).

Two scenes that both can do:
  lattice    a sheet of some 1,460 elements joined by beams, undamped, nothing else acting. floe:
             the sheet of input/bench/explicit.yaml as a spatial model. Yade: equal spheres on a
             regular triangular lattice, each joined to its neighbours by bonds that stretch, shear,
             bend and twist (CohFrictMat, Law2_ScGeom6D_CohFrictPhys_CohesionMoment)
  polyhedra  boxes of ice, 1 x 1 x 0.5 m, turned at random, fall on a floor between four walls and
             settle there. Both take the same boxes, places, density, contact stiffness per volume
             of overlap, friction and step. floe: contact by the overlap's volume. Yade:
             PolyhedraMat, Law2_PolyhedraGeom_PolyhedraPhys_Volumetric
Both steps are explicit, and both programs run on the same number of cores: floe by ranks, Yade by
threads. A time is the processor's (user and system) over the number of cores, which is the clock's
on an idle machine and less on a busy one: Yade's of its stepping loop, floe's of a run less that of
the same scene with -check; per bond and step, per box and step.
Yade's numerical damping is off in the lattice, and so are floe's dashpots; in the pile both lose
energy (Yade 0.3 of its numerical damping, floe restitution 0.3)."""
import json
import resource
import shutil
import statistics
import subprocess
from pathlib import Path

import numpy as np

from floe import lattice as fl
from floe.errors import InputError
from floe.results.output import matrices

YOUNG = 5e6        # of contacts [Pa]
FRICTION = 0.3
STEP = 1e-3        # of the pile [s]
SIZE = (1.0, 1.0, 0.5)  # of the boxes [m]
SPACING = 1.6      # of their places at the start [m]
GRAVITY = 9.81     # [m/s^2]
DENSITY = 920.0    # [kg/m^3]

HOW_TO = "Yade is not installed; on Debian: apt-get install yade"

# Of the page that --write writes.
WHAT = ("Lattice: an undamped sheet; floe joins convex bodies by co-rotational Timoshenko beams,",
        "Yade spheres by bonds that stretch, shear, bend and twist (CohFrictMat, ScGeom6D).",
        "Polyhedra: the same boxes turned at random fall on a floor between walls, with the same",
        "stiffness per volume of overlap, friction and step (1e-3 s).")

LATTICE = '''# Written by tools/bench --peers: a sheet of bonded spheres in Yade.
# yade -n -x -j1 lattice.py
import json
import math
import random
import time

from yade import utils

random.seed(1)
RADIUS, ROWS, COLUMNS, STEPS = 0.5, {rows}, {columns}, {steps}
O.materials.append(CohFrictMat(young=4e9, poisson=0.3, density=920, frictionAngle=0,
                               isCohesive=True, normalCohesion=1e30, shearCohesion=1e30,
                               momentRotationLaw=True, etaRoll=-1, etaTwist=-1, label="ice"))
for row in range(ROWS):
    for column in range(COLUMNS):
        place = (column + 0.5 * (row % 2), row * math.sqrt(0.75), 0)
        body = utils.sphere(place, RADIUS * 1.0001, material="ice")
        body.state.vel = Vector3(*(random.uniform(-1e-3, 1e-3) for _ in range(3)))
        O.bodies.append(body)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom6D()],
        [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True,
                                                  setCohesionOnNewContacts=False)],
        [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True)]),
    NewtonIntegrator(damping=0, gravity=(0, 0, 0)),
]
O.dt = 0.3 * utils.PWaveTimeStep()
O.run(200, True)  # bonds are made, memory is warm
bonds = sum(1 for contact in O.interactions if contact.isReal)
started = time.process_time()
O.run(STEPS, True)
spent = time.process_time() - started
after = sum(1 for contact in O.interactions if contact.isReal)
print("PEER " + json.dumps({{"elements": len(O.bodies), "bonds": bonds, "bonds_after": after,
                            "steps": STEPS, "seconds": spent}}))
'''

POLYHEDRA = '''# Written by tools/bench --peers: boxes fall on a floor in Yade.
# yade -n -x -j1 polyhedra.py
import json
import time

from yade import polyhedra_utils, utils

HERE = {folder!r}
scene = json.load(open(HERE + "/boxes.json"))
ice = PolyhedraMat(young=scene["stiffness"], poisson=0.3, density=scene["density"],
                   frictionAngle=scene["friction_angle"])
for place, corners in zip(scene["places"], scene["corners"]):
    body = polyhedra_utils.polyhedra(ice, v=[tuple(corner) for corner in corners])
    body.state.pos = tuple(place)
    O.bodies.append(body)
wall = scene["wall"]
O.bodies.append(utils.wall(0, axis=2, sense=1, material=ice))
for axis in (0, 1):
    O.bodies.append(utils.wall(-wall, axis=axis, sense=1, material=ice))
    O.bodies.append(utils.wall(wall, axis=axis, sense=-1, material=ice))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop(
        [Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
        [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
        [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
    NewtonIntegrator(damping=0.3, gravity=(0, 0, -scene["gravity"])),
]
O.dt = scene["step"]
started = time.process_time()
O.run(scene["steps"], True)
spent = time.process_time() - started
contacts = sum(1 for contact in O.interactions if contact.isReal)
boxes = [body for body in O.bodies if isinstance(body.shape, Polyhedra)]
height = sum(body.state.pos[2] for body in boxes) / len(boxes)
print("PEER " + json.dumps({{"elements": len(boxes), "contacts": contacts, "height": height,
                            "steps": scene["steps"], "seconds": spent}}))
'''


def pile(columns):
    """The boxes of the pile: a lattice of floe's whose lowest centroids lie at 0.8 m."""
    return fl.rubble(columns, SIZE, SPACING, -(0.8 + SPACING * (columns[2] - 1)), 1, DENSITY)


def wall_of(columns):
    """Distance of the walls from the axis [m]."""
    return 0.5 * SPACING * max(columns[:2])


def write_scripts(folder, columns, end, rows=41, wide=36, steps=1000):
    """Writes Yade's scripts and what they read, and the scene of floe's pile, into a folder."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "lattice.py").write_text(LATTICE.format(rows=rows, columns=wide, steps=steps))
    (folder / "polyhedra.py").write_text(POLYHEDRA.format(folder=str(folder.resolve())))
    boxes = pile(columns)
    boxes.write(folder / "boxes.h5")
    half = 0.5 * np.array(SIZE)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    turned = np.einsum("nij,vj->nvi", matrices(boxes.orientation), corners)
    size = np.cbrt(np.prod(SIZE))
    # floe: E_c/(L_a + L_b) per volume, L half the cube root of a body's volume. Yade has two
    # stiffnesses in series.
    scene = {"places": boxes.position.tolist(), "corners": turned.tolist(),
             "stiffness": 2 * YOUNG / size, "density": DENSITY,
             "friction_angle": float(np.arctan(FRICTION)), "wall": wall_of(columns),
             "gravity": GRAVITY, "step": STEP, "steps": round(end / STEP)}
    (folder / "boxes.json").write_text(json.dumps(scene))
    wall = wall_of(columns)
    sides = {"west": ((-wall, 0, 0), (1, 0, 0)), "east": ((wall, 0, 0), (-1, 0, 0)),
             "south": ((0, -wall, 0), (0, 1, 0)), "north": ((0, wall, 0), (0, -1, 0)),
             "floor": ((0, 0, 0), (0, 0, 1))}
    lines = [f"  {name}: {{shape: halfspace, point: {list(point)}, normal: {list(normal)}}}"
             for name, (point, normal) in sides.items()]
    (folder / "boxes.yaml").write_text(f"""# Written by tools/bench --peers: boxes fall on a floor.
integrator: explicit
forces: [gravity, contact]
lattice_file: {folder.resolve() / "boxes.h5"}
gravity: {GRAVITY}
contact: {{young: {YOUNG:g}, friction: {FRICTION}, restitution: 0.3}}
obstacle:
  names: [{', '.join(sides)}]
""" + "\n".join(lines) + f"""
time: {{end: {end}, dt: {STEP}}}
output: {{history: {end}, fields: {end}}}
""")


def said_by(text):
    """What a script of Yade says of its run: the last line that begins with PEER."""
    lines = [line for line in text.splitlines() if line.startswith("PEER ")]
    if not lines:
        raise RuntimeError("Yade: no result: " + " ".join(text.split())[-300:])
    return json.loads(lines[-1][5:])


def yade(script, cores):
    done = subprocess.run(["yade", "-n", "-x", f"-j{cores}", str(script)], capture_output=True,
                          text=True, stdin=subprocess.DEVNULL)
    return said_by(done.stdout + done.stderr)


def version_of_yade():
    done = subprocess.run(["yade", "--version"], capture_output=True, text=True)
    words = (done.stdout + done.stderr).split()
    return next((word for word in words if word[0].isdigit()), "unknown")


def best(values):
    return f"{min(values):.3g} / {statistics.median(values):.3g}"


def table(times):
    """Markdown rows from times[case] = {unit, floe: [...], yade: [...], what}."""
    rows = ["| scene | | floe | Yade | ratio of the minima, of the medians |",
            "|---|---|---|---|---|"]
    for case, found in times.items():
        ours, theirs = found["floe"], found["yade"]
        ratios = (min(theirs) / min(ours), statistics.median(theirs) / statistics.median(ours))
        rows.append(f"| {case} | {found['what']} | {best(ours)} {found['unit']} | {best(theirs)} "
                    f"{found['unit']} | {ratios[0]:.3g}, {ratios[1]:.3g} |")
    return rows


def floe_run(floe, scene, cores, options, folder, environment):
    """Processor time over the cores [s] and summary of a run of floe."""
    command = [*(["mpiexec", "-n", str(cores)] if cores > 1 else []), str(floe), str(scene),
               "-output_dir", str(folder), "-output_overwrite", *options]
    spent = []
    for more in ([], ["-check"]):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([*command, *more], check=True, env=environment, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    summary = json.loads((Path(folder) / "summary.json").read_text())
    return (spent[0] - spent[1]) / cores, summary


def benchmark(floe, root, folder, environment, cores, repeats, columns=(5, 5, 4), end=2.5):
    """Runs both programs in turn; lines of Markdown.

    throws InputError without Yade
    """
    if not shutil.which("yade"):
        raise InputError(HOW_TO)
    folder = Path(folder)
    write_scripts(folder, columns, end)
    sheet = ["-sheet_length", "35.56", "-sheet_width", "35.56", "-time_end", "3",
             "-output_history", "3", "-model_planar", "false"]
    lattice, boxes = {"floe": [], "yade": []}, {"floe": [], "yade": []}
    for _ in range(repeats):
        spent, run = floe_run(floe, Path(root) / "input/bench/explicit.yaml", cores, sheet,
                              folder / "floe_lattice", environment)
        lattice["floe"].append(1e9 * spent / run["steps"] / run["beams"])
        peer = yade(folder / "lattice.py", cores)
        if peer["bonds_after"] != peer["bonds"]:
            raise RuntimeError(f"Yade: {peer['bonds']} bonds became {peer['bonds_after']}")
        lattice["yade"].append(1e9 * peer["seconds"] / cores / peer["steps"] / peer["bonds"])
        lattice |= {"unit": "ns", "what": f"per bond and step: {run['bodies']} bodies, "
                    f"{run['beams']} beams; {peer['elements']} spheres, {peer['bonds']} bonds"}
        spent, run = floe_run(floe, folder / "boxes.yaml", cores, [], folder / "floe_boxes",
                              environment)
        boxes["floe"].append(1e6 * spent / run["steps"] / run["bodies"])
        peer = yade(folder / "polyhedra.py", cores)
        boxes["yade"].append(1e6 * peer["seconds"] / cores / peer["steps"] / peer["elements"])
        boxes |= {"unit": "us", "what": f"per box and step: {run['bodies']} boxes, "
                  f"{run['contacts']} contacts at the end; {peer['elements']}, {peer['contacts']}"}
    return [f"Yade {version_of_yade()} as Debian compiles it, for any x86-64; floe for "
            f"{run['built_for']} (what its level is worth: `tools/bench levels`).",
            f"{cores} core{'s' * (cores > 1)}, {repeats} runs of each in turn; minimum / median of "
            "the processor's time over the cores.", "", *WHAT, "",
            *table({"lattice": lattice, "polyhedra": boxes})]
