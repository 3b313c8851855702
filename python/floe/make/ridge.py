"""Ridges of loose blocks: keel and sail are poured, carved to shape, put together and let float.

Blocks are boxes with their sides drawn about a mean; floe moves them (explicit steps, contact,
water). The ridge runs along y, between two walls; x runs across it; z = 0 is the water's level.
The keel is poured as the sail is, by gravity upon a floor, and then turned upside down: so it is
packed as blocks are that float up under ice, but in a tenth of the time.
"""
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from floe import lattice as fl
from floe import program
from floe.lattice import matrices, product


# Contact is soft while blocks settle, so that steps are long; blocks of 0.3 m overlap by less than
# a thousandth of their thickness.
SETTLE = """integrator: explicit
forces: [{forces}]
lattice_file: blocks.h5
{water}contact: {{young: {young}, friction: {friction}, restitution: 0.1}}
obstacle:
  names: [{names}]
{walls}time: {{end: {seconds}}}
limit: {{energy_error: 10}}
output: {{dir: out, history: {seconds}}}
checkpoint: {{every: 1e9}}
{held}"""
WATER = "water: {{density: {density}, drag_coefficient: 1, drag_linear: 300, added_mass: 0.5}}\n"
AFLOAT = 8.0  # s
SPREADS = 0.01, 0.02, 0.02, 0.0  # by which blocks are moved apart, one after the other
HOLDS = 1.0  # friction while keel and sail come together: frozen flanks are steeper than loose ones
FREEZE = """forces: [beam]
lattice_file: blocks.h5
bonds: {{gap: {gap}, young: {young}, box: [-1e9, 1e9, -1e9, 1e9, {low}, 1e9]}}
boundary: {{names: [all], all: {{set: all, fix: x y z rx ry rz}}}}
output: {{dir: out}}
"""


@dataclass
class Ridge:
    """What a ridge is to be.

    sail, keel: height and depth [m]; length along y [m]; angles of the flanks [rad]; crest, bottom:
    widths of the flat top and bottom [m]; blocks: mean sides 3 [m]; scatter of the sides, relative
    deviation; density, water [kg/m^3]; friction between blocks.
    """
    sail: float
    keel: float
    length: float
    sail_angle: float
    keel_angle: float
    crest: float
    bottom: float
    blocks: tuple
    scatter: float
    density: float
    water: float
    friction: float
    seed: int

    def width(self, z):
        """Width of the section at a height above the lid's plane [m]; 0 beyond it."""
        z = np.asarray(z, float)
        up, down = (2 / np.tan(angle) for angle in (self.sail_angle, self.keel_angle))
        above = np.where(z <= self.sail, self.crest + up * (self.sail - z), 0)
        below = np.where(z >= -self.keel, self.bottom + down * (self.keel + z), 0)
        return np.maximum(0, np.where(z > 0, above, below))

    def widest(self, part):
        return float(self.width(1e-9 if part == "sail" else 0))


def turned(random, count):
    """Uniform on the sphere of quaternions."""
    turn = random.normal(size=(count, 4))
    return turn / np.linalg.norm(turn, axis=1)[:, None]


def loose_blocks(ridge, part, random):
    """Blocks on a grid beyond the lid's plane, more than the part's rectangle holds when settled;
    sorted by their distance from it."""
    sides = np.array(ridge.blocks)
    width, depth = ridge.widest(part), ridge.sail if part == "sail" else ridge.keel
    # Rubble of no more than 75 % of ice, and half a block above the carved shape
    volume = 0.75 * width * ridge.length * (depth + 0.5 * sides.min())
    count = int(np.ceil(volume / sides.prod()))
    size = sides * np.clip(1 + ridge.scatter * random.normal(size=(count, 3)), 0.4, 1.6)
    pitch = 1.02 * np.linalg.norm(size, axis=1).max()
    across = max(1, int((width + 1e-9) / pitch)), max(1, int((ridge.length + 1e-9) / pitch))
    k = np.arange(count)
    layer, cell = np.divmod(k, across[0] * across[1])
    i, j = np.divmod(cell, across[1])
    room = np.array([width / across[0], ridge.length / across[1]])
    place = np.column_stack([(i + 0.5) * room[0] - width / 2,
                             (j + 0.5) * room[1] - ridge.length / 2,
                             (layer + 0.6) * pitch])
    lattice = fl.blocks(size, place, ridge.density)
    lattice.orientation = turned(random, count)
    return lattice, size


def picked(lattice, which):
    """The bodies of a mask or of indices, without beams."""
    which = np.arange(len(lattice.position))[which]
    s = lattice.shapes
    vertices, corners, corner_of, face_of, vertex_of = [], [], [0], [0], [0]
    for b in which:
        first = s.vertex_of[b]
        shift = vertex_of[-1] - first
        vertices.append(s.vertices[first:s.vertex_of[b + 1]])
        for f in range(s.face_of[b], s.face_of[b + 1]):
            corners.append(s.corners[s.corner_of[f]:s.corner_of[f + 1]] + shift)
            corner_of.append(corner_of[-1] + len(corners[-1]))
        face_of.append(len(corner_of) - 1)
        vertex_of.append(vertex_of[-1] + len(vertices[-1]))
    return fl.Lattice(lattice.position[which], lattice.orientation[which], lattice.mass[which],
                      lattice.inertia[which],
                      shapes=fl.Shapes(np.concatenate(vertices), np.concatenate(corners),
                                       np.array(corner_of), np.array(face_of),
                                       np.array(vertex_of)))


def joined(*parts):
    """Lattices one after the other, each with the beams that it has."""
    first = np.cumsum([0] + [len(p.position) for p in parts])
    shapes = [p.shapes for p in parts]
    vertex = np.cumsum([0] + [len(s.vertices) for s in shapes])
    corner = np.cumsum([0] + [len(s.corners) for s in shapes])
    face = np.cumsum([0] + [len(s.corner_of) - 1 for s in shapes])

    def offsets(name, starts):
        return np.concatenate([[0]] + [getattr(s, name)[1:] + start
                                       for s, start in zip(shapes, starts)])
    together = fl.Lattice(
        *(np.concatenate([getattr(p, name) for p in parts])
          for name in ("position", "orientation", "mass", "inertia")),
        bodies=np.concatenate([p.bodies + start for p, start in zip(parts, first)]),
        axis_y=np.concatenate([p.axis_y for p in parts]),
        beam={name: np.concatenate([p.beam[name] for p in parts]) for name in fl.BEAM_SCALARS},
        shapes=fl.Shapes(np.concatenate([s.vertices for s in shapes]),
                         np.concatenate([s.corners + v for s, v in zip(shapes, vertex)]),
                         offsets("corner_of", corner), offsets("face_of", face),
                         offsets("vertex_of", vertex)))
    for name, without in (("offsets", np.zeros(6)), ("image", np.zeros(3)), ("strength", 1.0),
                          ("energy", 1.0)):
        if any(getattr(p, name) is not None for p in parts):
            setattr(together, name, np.concatenate(
                [np.tile(without, (len(p.bodies),) + (1,) * np.ndim(without))
                 if getattr(p, name) is None else getattr(p, name) for p in parts]))
    for part, start in zip(parts, first):
        for name, members in part.sets.items():
            together.sets.setdefault(name, []).extend(int(m) + int(start) for m in members)
    return together


def placed(lattice):
    """Vertices of all bodies in the world, V x 3 [m], and the body of each."""
    s = lattice.shapes
    body = np.repeat(np.arange(len(lattice.position)), np.diff(s.vertex_of))
    turn = matrices(lattice.orientation)[body]
    return lattice.position[body] + np.einsum("vij,vj->vi", turn, s.vertices), body


class Failed(Exception):
    """floe could not move the blocks; the text is what it said."""


@dataclass
class Settling:
    """Runs of floe in temporary folders.

    ridge: Ridge; young: of the contact while blocks settle [Pa]; say: takes a line of text.
    """
    ridge: Ridge
    young: float
    say: object = print

    def run(self, lattice, scene, result):
        """Runs a scene on blocks.h5; what `result` makes of its folder of results."""
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            lattice.write(folder / "blocks.h5")
            (folder / "scene.yaml").write_text(scene)
            done = subprocess.run([program.floe(), "scene.yaml"], cwd=folder, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            if done.returncode:
                raise Failed(" ".join((done.stderr.strip() or "no word").splitlines()[-1:]))
            return result(folder / "out")

    def settle(self, what, lattice, seconds, walls, friction, water=True):
        """Lets the bodies move for some seconds between walls {name: (point, normal, friction)},
        but the set `sheet`; returns the lattice where they then are, at rest."""
        self.say(f"{what}: {len(lattice.position)} bodies settle for {seconds:.3g} s")
        ridge = self.ridge
        lines = "".join(f"  {name}: {{shape: halfspace, point: {list(map(float, point))}, "
                        f"normal: {list(map(float, normal))}, friction: {mu}}}\n"
                        for name, (point, normal, mu) in walls.items())
        forces = ["gravity", "contact"] + ["beam"] * (len(lattice.bodies) > 0)
        forces += ["buoyancy", "drag"] * water
        held = ("boundary: {names: [held], held: {set: sheet, fix: x y z rx ry rz}}\n"
                if "sheet" in lattice.sets else "")
        return self.run(lattice, SETTLE.format(
            forces=", ".join(forces), water=WATER.format(density=ridge.water) * water,
            young=self.young, friction=friction, names=", ".join(walls), walls=lines,
            seconds=seconds, held=held), fl.settled)

    def freeze(self, lattice, depth, gap, young):
        """The lattice with beams between faces within `gap` [m] down to a depth [m]."""
        return self.run(lattice, FREEZE.format(gap=gap, young=young, low=-depth),
                        lambda out: fl.read(out / "lattice.h5"))


def make(ridge, settling, sheet=None):
    """Makes the ridge; sheet: a floating lattice that stays above the keel and below the sail, or
    None. Returns the lattice with the sets keel and sail, and the sides of the blocks n x 3 [m]."""
    random = np.random.default_rng(ridge.seed)
    top = bottom = 0.0
    if sheet is not None:
        z = placed(sheet)[0][:, 2]
        top, bottom = z.max(), z.min()
    shore = {"south": ((0, -ridge.length / 2, 0), (0, 1, 0), 0.0),
             "north": ((0, ridge.length / 2, 0), (0, -1, 0), 0.0)}
    parts, sides = {}, {}
    for part, plane in (("keel", bottom), ("sail", top)):
        if (ridge.keel + plane if part == "keel" else ridge.sail - plane) <= 0:
            continue
        blocks, size = loose_blocks(ridge, part, random)
        half = ridge.widest(part) / 2
        walls = {**shore, "west": ((-half, 0, 0), (1, 0, 0), ridge.friction),
                 "east": ((half, 0, 0), (-1, 0, 0), ridge.friction),
                 "floor": ((0, 0, 0), (0, 0, 1), ridge.friction)}
        fall = np.sqrt(2 * blocks.position[:, 2].max() / 9.81)
        blocks = settling.settle(part, blocks, fall + 2, walls, ridge.friction, water=False)
        if part == "keel":  # upside down, by half a turn about y
            blocks.position *= [-1, 1, -1]
            blocks.orientation = product(np.array([[0.0, 0, 1, 0]]), blocks.orientation)
        blocks.position[:, 2] += plane
        z = blocks.position[:, 2]
        inside = np.abs(blocks.position[:, 0]) <= ridge.width(z) / 2
        parts[part], sides[part] = picked(blocks, inside), size[inside]
        parts[part].sets = {part: list(range(int(inside.sum())))}
    whole = joined(*([sheet] if sheet is not None else []), *parts.values())
    if sheet is not None:
        whole.sets["sheet"] = list(range(len(sheet.position)))
    return float_up(settling, whole, shore), np.concatenate(list(sides.values()))


def float_up(settling, whole, shore):
    """The ridge after it has floated. Where the weight of the pour has pressed a corner deeper into
    a block than floe lets a run begin, all blocks are moved apart by some per cent first."""
    loose = np.ones(len(whole.position), bool)
    loose[whole.sets.get("sheet", [])] = False
    for spread in SPREADS:
        try:
            return settling.settle("ridge", whole, AFLOAT, shore, HOLDS)
        except Failed as error:
            if "at the start" not in str(error) or spread == SPREADS[-1]:
                raise
        whole.position[loose] *= 1 + spread


def porosity(ridge, lattice, sides, part):
    """The share of the part's section that is no ice, by points well inside the section; NaN if
    there is no room for them."""
    first = len(lattice.position) - len(sides)
    centre, turn = lattice.position[first:], matrices(lattice.orientation[first:])
    block = np.mean(ridge.blocks)
    step = min(ridge.blocks) / 5
    depth = ridge.sail if part == "sail" else ridge.keel
    half = ridge.widest(part) / 2
    x, y, z = np.meshgrid(np.arange(-half, half, step),
                          np.arange(-ridge.length / 2 + block, ridge.length / 2 - block, step),
                          np.arange(block / 2, depth - block / 2, step)
                          * (1 if part == "sail" else -1), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    points = points[np.abs(points[:, 0]) <= ridge.width(points[:, 2]) / 2 - block / 2]
    if "sheet" in lattice.sets:
        corners = placed(picked(lattice, lattice.sets["sheet"]))[0][:, 2]
        points = points[(points[:, 2] < corners.min()) | (points[:, 2] > corners.max())]
    if not len(points):
        return np.nan
    reach = np.linalg.norm(sides, axis=1).max() / 2
    full = np.zeros(len(points), bool)
    near = scipy.spatial.cKDTree(points).query_ball_point(centre, reach)
    for found, b in zip(near, range(len(centre))):
        local = np.abs((points[found] - centre[b]) @ turn[b])
        full[np.array(found, int)[np.all(local <= sides[b] / 2, axis=1)]] = True
    return 1 - full.mean()
