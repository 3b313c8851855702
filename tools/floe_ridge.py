"""Ridges of loose blocks: a keel floated up under a lid or a sheet, a sail let fall upon it, both
carved to shape and settled.

Blocks are boxes with their sides drawn about a mean; floe moves them (explicit steps, contact,
water). The ridge runs along y, between two walls.
"""
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import floe_lattice as fl
import floe_program
import h5py
import numpy as np
from floe_program import BadInput

LID = 6.0  # m; thickness of the box that is the lid
# Contact of the blocks while they settle: soft, so that steps are long; what it lets overlap is a
# part of a thousand of a block.
CONTACT = "contact: {young: %g, friction: %g, restitution: 0.1}\n"
SETTLE = """integrator: explicit
forces: [%s]
lattice_file: blocks.h5
water: {density: %g, drag_coefficient: 1, drag_linear: 300, added_mass: 0.5%s}
%sobstacle:
%stime: {end: %g}
limit: {energy_error: 1}
output: {dir: out, overwrite: true}
checkpoint: {every: 1e9}
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

    def section(self, part):
        """Area of the part's section [m^2]."""
        depth, flat, angle = ((self.sail, self.crest, self.sail_angle) if part == "sail" else
                              (self.keel, self.bottom, self.keel_angle))
        return depth * (flat + depth / np.tan(angle))

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
    sign = 1 if part == "sail" else -1
    place = np.column_stack([(i + 0.5) * room[0] - width / 2,
                             (j + 0.5) * room[1] - ridge.length / 2,
                             sign * (layer + 0.6) * pitch])
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
    if any(p.offsets is not None for p in parts):
        together.offsets = np.concatenate([np.zeros((len(p.bodies), 6)) if p.offsets is None
                                           else p.offsets for p in parts])
    for part, start in zip(parts, first):
        for name, members in part.sets.items():
            together.sets.setdefault(name, []).extend(int(m) + int(start) for m in members)
    return together


def read(path):
    """A lattice.h5 file as a lattice, with its beams, sets and shapes."""
    with h5py.File(path) as file:
        def get(name):
            return file[name][:]
        lattice = fl.Lattice(*(get(f"bodies/{name}")
                               for name in ("position", "orientation", "mass", "inertia")),
                             shapes=fl.Shapes(*(get(f"shapes/{name}") for name in
                                                ("vertices", "corners", "corner_of", "face_of",
                                                 "vertex_of"))))
        if "beams" in file:
            lattice.bodies, lattice.axis_y = get("beams/bodies"), get("beams/axis_y")
            lattice.beam = {name: get(f"beams/{name}") for name in fl.BEAM_SCALARS}
            if "offsets" in file["beams"]:
                lattice.offsets = get("beams/offsets")
            for name in ("strength", "energy"):
                if name in file["beams"]:
                    setattr(lattice, name, get(f"beams/{name}"))
        if "sets" in file:
            lattice.sets = {name: list(get(f"sets/{name}")) for name in file["sets"]}
    return lattice


def product(a, b):
    """Quaternion products n x 4 of a (n x 4) and b (n x 4): first b."""
    aw, ax, ay, az = a.T
    bw, bx, by, bz = b.T
    return np.column_stack([aw * bw - ax * bx - ay * by - az * bz,
                            aw * bx + ax * bw + ay * bz - az * by,
                            aw * by - ax * bz + ay * bw + az * bx,
                            aw * bz + ax * by - ay * bx + az * bw])


def matrices(turn):
    """Rotation matrices n x 3 x 3 of unit quaternions."""
    w, x, y, z = turn.T
    return np.stack([np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)]),
                     np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)]),
                     np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
                     ]).transpose(2, 0, 1)


def placed(lattice):
    """Vertices of all bodies in the world, V x 3 [m], and the body of each."""
    s = lattice.shapes
    body = np.repeat(np.arange(len(lattice.position)), np.diff(s.vertex_of))
    turn = matrices(lattice.orientation)[body]
    return lattice.position[body] + np.einsum("vij,vj->vi", turn, s.vertices), body


class Settling:
    """Runs of floe in a temporary folder."""

    def __init__(self, ridge, young, say):
        self.ridge, self.young, self.say = ridge, young, say

    def box(self, name, low, high):
        return f"  {name}: {{shape: box, box: [{', '.join(f'{x:.9g}' for x in low + high)}]}}\n"

    def obstacles(self, walls):
        names = ", ".join(walls)
        return f"  names: [{names}]\n" + "".join(
            f"  {name}: {{shape: halfspace, point: {list(map(float, point))}, "
            f"normal: {list(map(float, normal))}, friction: {friction}}}\n"
            for name, (point, normal, friction) in walls.items())

    def settle(self, lattice, seconds, walls, held=None):
        """Lets the bodies move; they come to rest where they then are."""
        ridge = self.ridge
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            lattice.write(folder / "blocks.h5")
            beams = len(lattice.bodies) > 0
            forces = "gravity, buoyancy, drag, contact" + (", beam" if beams else "")
            scene = SETTLE % (forces, ridge.water, ", shelter: 0" if False else "",
                              CONTACT % (self.young, ridge.friction), self.obstacles(walls),
                              seconds)
            if held:
                scene += f"boundary: {{names: [held], held: {{set: {held}, fix: x y z rx ry rz}}}}\n"
            (folder / "settle.yaml").write_text(scene)
            done = subprocess.run([floe_program.floe(), "settle.yaml"], cwd=folder,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            if done.returncode:
                raise BadInput("blocks do not settle: " +
                               " ".join(done.stderr.strip().splitlines()[-1:]))
            return self.after(lattice, folder / "out")

    def after(self, lattice, out):
        last = sorted(p for p in (out / "fields").glob("*.h5") if p.stem.isdigit())[-1]
        with h5py.File(last) as file:
            frame = file[list(file)[-1]]
            move, turn = frame["bodies_displacement"][:], frame["bodies_rotation_vector"][:]
        angle = np.linalg.norm(turn, axis=1)
        half = np.where(angle > 1e-9, np.sin(angle / 2) / np.maximum(angle, 1e-300), 0.5)
        spin = np.column_stack([np.cos(angle / 2), half[:, None] * turn])
        lattice.position = lattice.position + move
        lattice.orientation = product(spin, lattice.orientation)
        lattice.orientation /= np.linalg.norm(lattice.orientation, axis=1)[:, None]
        return lattice
