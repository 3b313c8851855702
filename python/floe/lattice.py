"""Writes lattice.h5 files: frames, sheets of regular triangles, loose blocks.

What floe reads as `lattice_file: FILE.h5`. As a command: floe make_lattice KIND [options] FILE.h5
(floe make_lattice --help, floe make_lattice KIND --help). As a module:

    from floe import lattice as fl
    fl.straight_frame(length=10, elements=64, section=fl.Section(0.01, 0.01,
    young=2.1e11)).write("beam.h5")

SI units everywhere. Quaternions are unit, (w, x, y, z), body to world. A beam's axis 1 runs from
its first to its second body, axis 2 is `axis_y`, axis 3 = 1 x 2; `width` is the section's extent
along axis 2 and `height` along axis 3, so inertia_y (about axis 2) = width height^3 / 12.
"""
import os
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

BEAM_SCALARS = ("area", "inertia_y", "inertia_z", "torsion", "length", "young", "shear_modulus",
                "shear_factor", "width", "height")


def saint_venant_torsion(a, b):
    """Torsion constant of an a x b rectangle [m^4] (Timoshenko & Goodier, Theory of Elasticity,
    art. 109)."""
    a, b = max(a, b), min(a, b)
    n = np.arange(1, 200, 2)
    series = np.sum(np.tanh(n * np.pi * a / (2 * b)) / n**5)
    return a * b**3 * (1 / 3 - 64 / np.pi**5 * (b / a) * series)


@dataclass
class Section:
    """Rectangular section of a beam and its material.

    width, height [m]; young [Pa]; density [kg/m^3]; torsion constant [m^4], None: Saint-Venant's.
    """
    width: float
    height: float
    young: float = 4e9
    poisson: float = 0.3
    density: float = 920.0
    shear_factor: float = 5 / 6
    torsion: float | None = None

    def scalars(self, length):
        """Values of BEAM_SCALARS but the length for a beam of this section; length m, result {name:
        m}."""
        w, h = self.width, self.height
        torsion = saint_venant_torsion(w, h) if self.torsion is None else self.torsion
        values = {"area": w * h, "inertia_y": w * h**3 / 12, "inertia_z": h * w**3 / 12,
                  "torsion": torsion, "young": self.young,
                  "shear_modulus": self.young / (2 * (1 + self.poisson)),
                  "shear_factor": self.shear_factor, "width": w, "height": h}
        return {name: np.full(len(length), float(value)) for name, value in values.items()}


@dataclass
class Shapes:
    """Convex polyhedra, one per body, in the body's principal axes with the origin at its centroid.

    vertices [m] V x 3; the vertices of face f are vertices[corners[corner_of[f]:corner_of[f+1]]],
    counter- clockwise seen from outside; body b has the faces face_of[b]:face_of[b+1] and the
    vertices
    vertex_of[b]:vertex_of[b+1].
    """
    vertices: np.ndarray
    corners: np.ndarray
    corner_of: np.ndarray
    face_of: np.ndarray
    vertex_of: np.ndarray

    @staticmethod
    def prisms(plans, heights):
        """Upright prisms. plans: per body a counter-clockwise polygon k x 2 [m]; heights: per body
        [m]."""
        vertices, corners, corner_of, face_of, vertex_of = [], [], [0], [0], [0]
        for plan, height in zip(plans, heights):
            k, first = len(plan), vertex_of[-1]
            for z in (-height / 2, height / 2):
                vertices.append(np.column_stack([plan, np.full(k, z)]))
            bottom, top = first + np.arange(k), first + k + np.arange(k)
            faces = [bottom[::-1], top]
            faces += [[bottom[i], bottom[(i + 1) % k], top[(i + 1) % k], top[i]] for i in range(k)]
            for face in faces:
                corners.extend(int(v) for v in face)
                corner_of.append(len(corners))
            face_of.append(face_of[-1] + len(faces))
            vertex_of.append(first + 2 * k)
        return Shapes(np.concatenate(vertices), np.array(corners), np.array(corner_of),
                      np.array(face_of),
                      np.array(vertex_of))

    @staticmethod
    def boxes(sizes):
        """Boxes; sizes n x 3, extents along the principal axes [m]."""
        corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
        return Shapes.prisms([corner * size[:2] for size in sizes], [size[2] for size in sizes])


@dataclass
class Lattice:
    """Bodies, the beams between them, named sets of bodies and, if given, the bodies' shapes.

    position n x 3 [m]; orientation n x 4; mass n [kg]; inertia n x 3, principal [kg m^2];
    bodies m x 2, first < second, sorted; axis_y m x 3; beam: {name of BEAM_SCALARS: m}; sets {name:
    indices}; offsets m x 6 [m]: ends of beams from the centroids of their bodies, or None; image
    m x 3 [m]: from the second body to its image that is joined, or None; strength, energy m:
    factors of those of fracture, or None.
    """
    position: np.ndarray
    orientation: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    bodies: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    axis_y: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    beam: dict = field(default_factory=lambda: {name: np.zeros(0) for name in BEAM_SCALARS})
    sets: dict = field(default_factory=dict)
    shapes: Shapes | None = None
    offsets: np.ndarray | None = None
    image: np.ndarray | None = None
    strength: np.ndarray | None = None
    energy: np.ndarray | None = None

    def check(self):
        """Raises ValueError with what is wrong, if anything is."""
        n, m = len(self.position), len(self.bodies)
        shapes = [("position", self.position, (n, 3)), ("orientation", self.orientation, (n, 4)),
                  ("mass", self.mass, (n,)), ("inertia", self.inertia, (n, 3)),
                  ("bodies", self.bodies, (m, 2)), ("axis_y", self.axis_y, (m, 3))]
        shapes += [(name, self.beam[name], (m,)) for name in BEAM_SCALARS]
        if self.offsets is not None:
            shapes.append(("offsets", self.offsets, (m, 6)))
        shapes += [(name, getattr(self, name), (m,)) for name in ("strength", "energy")
                   if getattr(self, name) is not None]
        for name, array, shape in shapes:
            if np.shape(array) != shape:
                raise ValueError(f"{name}: shape {np.shape(array)}, expected {shape}")
            if not np.all(np.isfinite(array)):
                raise ValueError(f"{name}: not finite")
        if not np.allclose(np.linalg.norm(self.orientation, axis=1), 1, atol=1e-12):
            raise ValueError("orientation: not unit quaternions")
        if np.any(self.mass <= 0) or np.any(self.inertia <= 0):
            raise ValueError("mass, inertia: must be positive")
        if m:
            pairs = self.bodies.astype(np.int64)
            if pairs.min() < 0 or pairs.max() >= n or np.any(pairs[:, 0] >= pairs[:, 1]):
                raise ValueError("bodies: each beam joins two bodies of the file, the smaller "
                                 "index first")
            if np.any(np.diff(pairs[:, 0] * n + pairs[:, 1]) <= 0):
                raise ValueError("bodies: beams must be sorted, each pair once")
        for name, members in self.sets.items():
            if len(members) == 0 or min(members) < 0 or max(members) >= n:
                raise ValueError(f"set {name}: empty, or an index out of range")

    def write(self, file):
        """Writes the file whole, under a temporary name, then renames it; makes its folder."""
        self.check()
        os.makedirs(os.path.dirname(os.path.abspath(file)), exist_ok=True)
        temporary = f"{file}.{os.getpid()}"
        with h5py.File(temporary, "w") as out:
            for name in ("position", "orientation", "mass", "inertia"):
                out[f"bodies/{name}"] = np.asarray(getattr(self, name), float)
            if len(self.bodies):
                out["beams/bodies"] = np.asarray(self.bodies, np.int32)
                out["beams/axis_y"] = np.asarray(self.axis_y, float)
                for name in BEAM_SCALARS:
                    out[f"beams/{name}"] = np.asarray(self.beam[name], float)
                for name in ("offsets", "image", "strength", "energy"):
                    if getattr(self, name) is not None:
                        out[f"beams/{name}"] = np.asarray(getattr(self, name), float)
            for name, members in self.sets.items():
                out[f"sets/{name}"] = np.asarray(sorted(members), np.int32)
            if self.shapes is not None:
                out["shapes/vertices"] = np.asarray(self.shapes.vertices, float)
                for name in ("corners", "corner_of", "face_of", "vertex_of"):
                    out[f"shapes/{name}"] = np.asarray(getattr(self.shapes, name), np.int32)
        os.replace(temporary, file)


def cuboid_inertia(mass, size):
    """Principal moments n x 3 [kg m^2] of cuboids; mass n [kg], size n x 3 [m]."""
    square = np.asarray(size, float)**2
    return mass[:, None] / 12 * (square.sum(axis=1)[:, None] - square)


def turn_about_z(angle):
    """Quaternions n x 4 of rotations about z; angle n [rad]."""
    zero = np.zeros_like(angle)
    return np.column_stack([np.cos(angle / 2), zero, zero, np.sin(angle / 2)])


def frame(points, tangents, section):
    """A chain of bodies in the x-y plane, neighbours joined by straight beams.

    points n x 2, where the bodies are [m]; tangents n, direction of the axis there [rad from x].
    Axis 2 of a beam lies in the plane, axis 3 is z. A body is a box as long as the part of the axis
    it stands for: half of each of its beams. Sets `root` (first body) and `tip` (last).
    """
    points, tangents = np.asarray(points, float), np.asarray(tangents, float)
    n = len(points)
    chord = np.diff(points, axis=0)
    length = np.hypot(chord[:, 0], chord[:, 1])
    share = np.zeros(n)
    share[:-1] += length / 2
    share[1:] += length / 2
    mass = section.density * section.width * section.height * share
    size = np.column_stack([share, np.full(n, section.width), np.full(n, section.height)])
    zeros = np.zeros(n - 1)
    beam = section.scalars(length)
    beam["length"] = length
    return Lattice(position=np.column_stack([points, np.zeros(n)]),
                   orientation=turn_about_z(tangents),
                   mass=mass, inertia=cuboid_inertia(mass, size),
                   bodies=np.column_stack([np.arange(n - 1), np.arange(1, n)]),
                   axis_y=np.column_stack([-chord[:, 1], chord[:, 0], zeros]) / length[:, None],
                   beam=beam,
                   sets={"root": [0], "tip": [n - 1]}, shapes=Shapes.boxes(size))


def straight_frame(length, elements, section):
    """A frame along x from the origin; length [m]."""
    x = length * np.arange(elements + 1) / elements
    return frame(np.column_stack([x, np.zeros_like(x)]), np.zeros_like(x), section)


def arc_frame(radius, angle, elements, section):
    """A frame on a circular arc from the origin, at first along x, bending to +y; radius [m], angle
    [rad]."""
    phi = angle * np.arange(elements + 1) / elements
    return frame(radius * np.column_stack([np.sin(phi), 1 - np.cos(phi)]), phi, section)


def triangles(columns, rows, spacing, thickness, young=4e9, poisson=0.3, density=920.0,
              shear_factor=5 / 6):
    """A sheet of regular triangles with rows along x, centred on the origin; spacing l and
    thickness h [m].

    Even rows (0, 2, ...) have `columns` bodies at x = 0, l, 2l, ..., odd rows one less, at l/2,
    3l/2, ...;
    rows are l sqrt(3)/2 apart; their number is odd, so bottom and top row are alike. Section of a
    beam: the facet of the regular hexagon, l/sqrt(3) x h.

    Edges. The sheet ends on the axes of the bottom and the top row: the beams of these two rows
    carry half of every section property (area, inertias, torsion), because only one of their two
    triangles is there. With that, any uniform state of stress without traction on these edges is an
    exact equilibrium, right up to the edge: the plan to divide by is (rows - 1) l sqrt(3)/2 wide.
    `left` and `right` are zigzags with whole beams; hold or move them by the sets `left` and
    `right` (ends of even rows), `leftinner` and `rightinner` (ends of odd rows, l/2 further in).
    All bodies are whole hexagons (flat to flat l), also those at the edges, over which they stand
    out; so the sheet's mass is that of whole hexagons.
    """
    if rows % 2 == 0 or rows < 3 or columns < 3:
        raise ValueError("triangles: an odd number of rows, at least 3, and at least 3 columns")
    pitch = spacing * np.sqrt(3) / 2
    count = [columns - row % 2 for row in range(rows)]
    first = np.concatenate([[0], np.cumsum(count)])
    n = first[-1]
    row_of = np.repeat(np.arange(rows), count)
    x = (np.arange(n) - first[row_of] + 0.5 * (row_of % 2)) * spacing
    position = np.column_stack([x - (columns - 1) * spacing / 2, (row_of - (rows - 1) / 2) * pitch,
                                np.zeros(n)])

    pairs = _triangle_pairs(first, count)
    chord = position[pairs[:, 1]] - position[pairs[:, 0]]
    length = np.linalg.norm(chord, axis=1)
    beam = Section(spacing / np.sqrt(3), thickness, young, poisson, density,
                   shear_factor).scalars(length)
    beam["length"] = length
    on_edge = (row_of[pairs[:, 0]] == row_of[pairs[:, 1]]) & np.isin(row_of[pairs[:, 0]],
                                                                     (0, rows - 1))
    for name in ("area", "inertia_y", "inertia_z", "torsion"):
        beam[name][on_edge] /= 2

    angle = np.pi / 6 + np.pi / 3 * np.arange(6)
    hexagon = spacing / np.sqrt(3) * np.column_stack([np.cos(angle), np.sin(angle)])
    area = np.sqrt(3) / 2 * spacing**2
    mass = np.full(n, density * area * thickness)
    plan = 5 * area * spacing**2 / 72  # second moment of the hexagon about any axis in its plane
    inertia = [plan / area + thickness**2 / 12] * 2 + [2 * plan / area]
    even, odd = np.arange(0, rows, 2), np.arange(1, rows, 2)
    return Lattice(position=position, orientation=turn_about_z(np.zeros(n)), mass=mass,
                   inertia=mass[:, None] * np.array(inertia), bodies=pairs,
                   axis_y=np.column_stack([-chord[:, 1], chord[:, 0],
                                           np.zeros(len(pairs))]) / length[:, None],
                   beam=beam,
                   sets={"left": first[even], "leftinner": first[odd], "right": first[even + 1] - 1,
                         "rightinner": first[odd + 1] - 1, "bottom": np.arange(first[1]),
                         "top": np.arange(first[-2], n)},
                   shapes=Shapes.prisms([hexagon] * n, [thickness] * n))


def _triangle_pairs(first, count):
    """Sorted pairs m x 2 of neighbours in rows that start at `first` and hold `count` bodies."""
    pairs = []
    for row, number in enumerate(count):
        for i in range(number):
            body = first[row] + i
            if i + 1 < number:
                pairs.append((body, body + 1))
            if row + 1 < len(count):
                left = i - 1 if row % 2 == 0 else i
                pairs += [(body, first[row + 1] + k) for k in (left, left + 1)
                          if 0 <= k < count[row + 1]]
    return np.array(sorted(pairs), np.int64)


def blocks(sizes, positions, density=920.0):
    """Loose upright boxes, no beams. sizes n x 3 and positions (centroids) n x 3 [m]."""
    sizes, positions = np.asarray(sizes, float), np.asarray(positions, float)
    mass = density * sizes.prod(axis=1)
    return Lattice(position=positions, orientation=turn_about_z(np.zeros(len(mass))), mass=mass,
                   inertia=cuboid_inertia(mass, sizes), shapes=Shapes.boxes(sizes))


def strip(length, elements, section, water=None):
    """A strip of ice that ends at x = 0: one row of equal boxes along x, neighbours joined across
    their facets.

    length [m], all of it at x < 0; `elements` boxes, each length/elements x section.width x
    section.height; water: its density, if the strip floats (its lower face then lies at the draft),
    None: mid-plane at z = 0. The beams' sections are the facets, so the strip has its beams'
    modulus and, in bending, their strength. Sets `left` and `right`.
    """
    size = np.array([length / elements, section.width, section.height])
    middle = section.height * (0.5 - section.density / water) if water else 0.0
    x = size[0] * (np.arange(elements) + 0.5) - length
    row = blocks(np.tile(size, (elements, 1)), np.column_stack([x, 0 * x, 0 * x + middle]),
                 section.density)
    first = np.arange(elements - 1)
    row.bodies = np.column_stack([first, first + 1])
    row.axis_y = np.tile([0.0, 1.0, 0.0], (len(first), 1))
    row.beam = section.scalars(first)
    row.beam["length"] = np.full(len(first), size[0])
    row.sets = {"left": [0], "right": [elements - 1]}
    return row


def stack(count, size, gap=0.0, density=920.0):
    """Equal boxes above each other, the lowest standing on z = 0; size 3, gap between neighbours
    [m]."""
    z = size[2] / 2 + (size[2] + gap) * np.arange(count)
    lattice = blocks(np.tile(size, (count, 1)), np.column_stack([0 * z, 0 * z, z]), density)
    lattice.sets = {"lowest": [0], "highest": [count - 1]}
    return lattice


def rubble(columns, size, spacing, depth, seed=1, density=920.0):
    """Loose equal boxes, turned at random, on a grid; the highest centroids lie at z = -depth.

    columns 3, number along x, y, z; size 3 [m]; spacing of the grid [m], more than the box's
    diagonal.
    """
    if spacing <= np.linalg.norm(size):
        raise ValueError("rubble: spacing must be more than the box's diagonal")
    x, y, z = np.meshgrid(*(spacing * (np.arange(n) - (n - 1) / 2) for n in columns), indexing="ij")
    position = np.column_stack([x.ravel(), y.ravel(), z.ravel() - z.max() - depth])
    lattice = blocks(np.tile(size, (len(position), 1)), position, density)
    # uniform on the sphere of quaternions
    turn = np.random.default_rng(seed).normal(size=(len(position), 4))
    lattice.orientation = turn / np.linalg.norm(turn, axis=1)[:, None]
    return lattice


def shear_box(columns, size, spacing, plates, seed=1, density=920.0):
    """Loose equal boxes above z = 0, turned at random, on a grid that fills one period in x and y,
    and a lid of plates above them: for a scene with model: periodic: [columns[0] spacing,
    columns[1] spacing].

    columns 3, number along x, y, z; size 3 [m]; spacing of the grid [m], more than the box's
    diagonal; plates 2, number along x, y, 3 or more: boxes a fifth of the spacing high and 2 %
    apart, joined. Set `lid`.
    """
    if spacing <= np.linalg.norm(size):
        raise ValueError("shear_box: spacing must be more than the box's diagonal")
    if min(plates) < 3:
        raise ValueError("shear_box: there must be 3 plates along x and along y at least")
    grains = rubble(columns, size, spacing, 0.0, seed, density)
    grains.position[:, 2] += spacing * (columns[2] - 0.5)
    period = spacing * np.array(columns[:2], float)
    pitch = period / plates
    x, y = np.meshgrid(*(p * (np.arange(n) + 0.5) - n * p / 2 for n, p in zip(plates, pitch)),
                       indexing="ij")
    height = spacing / 5
    place = np.column_stack([x.ravel(), y.ravel(),
                             np.full(x.size, spacing * columns[2] + height / 2)])
    side = np.array([*(0.98 * pitch), height])
    lid = blocks(np.tile(side, (len(place), 1)), place, density)
    count = len(grains.position)
    whole = blocks(np.vstack([np.tile(size, (count, 1)), np.tile(side, (len(place), 1))]),
                   np.vstack([grains.position, lid.position]), density)
    whole.orientation[:count] = grains.orientation
    whole.sets = {"lid": list(range(count, count + len(place)))}
    join_plates(whole, count, plates, pitch, side, density)
    return whole


def join_plates(lattice, first, plates, pitch, side, density):
    """Beams between neighbouring plates, and across the ends of the period, that are 1000 times as
    strong as others: the plates are one stiff lid."""
    rows = []
    for i in range(plates[0]):
        for j in range(plates[1]):
            here = first + i * plates[1] + j
            for axis, (p, q) in enumerate((((i + 1) % plates[0], j), (i, (j + 1) % plates[1]))):
                there = first + p * plates[1] + q
                if there == here:
                    continue
                step = np.zeros(3)
                step[axis] = pitch[axis]
                image = lattice.position[here] + step - lattice.position[there]
                a, b = sorted((here, there))
                rows.append((a, b, axis, *(image if here == a else -image)))
    rows = sorted({row[:2]: row for row in rows}.values())
    axis = np.array([row[2] for row in rows])
    lattice.bodies = np.array([row[:2] for row in rows], np.int64)
    lattice.image = np.array([row[3:] for row in rows])
    lattice.axis_y = np.where(axis[:, None] == 0, [[0.0, 1, 0]], [[1.0, 0, 0]])
    beams = [Section(side[1 - a], side[2], young=1e9, density=density).scalars([0]) for a in axis]
    lattice.beam = {name: np.concatenate([beam[name] for beam in beams]) for name in beams[0]}
    chords = (lattice.position[lattice.bodies[:, 1]] + lattice.image
              - lattice.position[lattice.bodies[:, 0]])
    lattice.beam["length"] = np.linalg.norm(chords, axis=1)
    lattice.strength = np.full(len(rows), 1e3)


def joined(lattice, groups):
    """The bodies of each group as one rigid body of several convex parts, behind those of no group.

    lattice: with shapes, without beams. groups: lists of bodies, which meet or lie apart and do not
    overlap. Sets follow. Raises ValueError where a body is in two groups, or there are beams or no
    shapes.
    """
    from scipy.spatial.transform import Rotation
    count, shapes = len(lattice.position), lattice.shapes
    flat = np.concatenate([np.asarray(group, int) for group in groups])
    if len(lattice.bodies) or shapes is None:
        raise ValueError("joined: the bodies must have shapes and no beams")
    if len(np.unique(flat)) < len(flat):
        raise ValueError("joined: a body is in two groups")
    groups = [[body] for body in np.setdiff1d(np.arange(count), flat)] + [list(g) for g in groups]
    turns = matrices(lattice.orientation)
    position, orientation, mass, inertia = [], [], [], []
    vertices, corners, corner_of, face_of, vertex_of = [], [], [0], [0], [0]
    for group in groups:
        masses, places = lattice.mass[group], lattice.position[group]
        middle = masses @ places / masses.sum()
        moments, axes = _principal_axes(masses, places - middle, lattice.inertia[group],
                                        turns[group])
        position.append(middle)
        mass.append(masses.sum())
        inertia.append(moments)
        orientation.append(np.roll(Rotation.from_matrix(axes).as_quat(), 1))  # w first
        for body in group:
            first, end = shapes.vertex_of[body:body + 2]
            shift = len(vertices) - first
            world = shapes.vertices[first:end] @ turns[body].T + lattice.position[body]
            vertices.extend((world - middle) @ axes)
            for face in range(*shapes.face_of[body:body + 2]):
                corners.extend(shapes.corners[slice(*shapes.corner_of[face:face + 2])] + shift)
                corner_of.append(len(corners))
        face_of.append(len(corner_of) - 1)
        vertex_of.append(len(vertices))
    number = np.empty(count, int)
    for k, group in enumerate(groups):
        number[group] = k
    return Lattice(position=np.array(position), orientation=np.array(orientation),
                   mass=np.array(mass), inertia=np.array(inertia),
                   sets={name: sorted({int(number[body]) for body in bodies})
                         for name, bodies in lattice.sets.items()},
                   shapes=Shapes(np.array(vertices), np.array(corners), np.array(corner_of),
                                 np.array(face_of), np.array(vertex_of)))


def _principal_axes(masses, arms, inertia, turns):
    """Principal moments [kg m^2] of bodies put together, and their axes as columns. A tensor that
    is diagonal in the world keeps the world's axes."""
    if len(masses) == 1:
        return inertia[0], turns[0]
    tensor = (np.einsum("bij,bj,bkj->ik", turns, inertia, turns)
              + np.einsum("b,bj,bj->", masses, arms, arms) * np.eye(3)
              - np.einsum("b,bi,bj->ij", masses, arms, arms))
    if np.max(np.abs(tensor - np.diag(np.diag(tensor)))) <= 1e-12 * np.trace(tensor):
        return np.diag(tensor), np.eye(3)
    moments, axes = np.linalg.eigh(tensor)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return moments, axes


def block(size, height=0.0, density=920.0):
    """One upright box with its centroid at (0, 0, height); size 3 [m], height [m]."""
    return blocks([size], [[0, 0, height]], density)


# -- the frames of the verification scenes
# ----------------------------------------------------------
def bend45(elements, torsion=None):
    """The 45-degree bend of Bathe & Bolourchi (1979): R = 100, section 1 x 1, E = 1e7, nu = 0,
    kappa = 5/6.

    torsion [m^4], None: 1/6, so GJ = 8.333e5 (polar); 0.141 gives GJ = 7.05e5 (Saint-Venant).
    """
    section = Section(1.0, 1.0, young=1e7, poisson=0.0, torsion=1 / 6 if torsion is None
                      else torsion)
    return arc_frame(100.0, np.pi / 4, elements, section)


def rollup(elements):
    """A strip to be rolled up by an end moment: L = 10 m, EI = 100 N m^2 (1 x 1, E = 1200 Pa)."""
    return straight_frame(10.0, elements, Section(1.0, 1.0, young=1200.0, poisson=0.0))


def lee_frame(elements):
    """The frame of Lee, Manuel & Rossow (1968), EI = 1440 N m^2: a column of 1.2 m from the origin
    in y and a beam of 1.2 m from its top in x, section 20 x 30 mm.

    elements: beams of each member, a multiple of 5, so that a body is a fifth of the beam from the
    corner. Sets: root, tip (the hinges), load, corner.
    """
    if elements % 5:
        raise ValueError(f"elements: {elements} must be a multiple of 5")
    length, steps = 1.2, np.arange(elements + 1) / elements
    column = np.column_stack([np.zeros(elements + 1), length * steps])
    beam = np.column_stack([length * steps[1:], np.full(elements, length)])
    tangents = np.concatenate([np.full(elements + 1, np.pi / 2), np.zeros(elements)])
    lattice = frame(np.concatenate([column, beam]), tangents,
                    Section(0.02, 0.03, young=7.2e10, poisson=0.0, density=2700.0))
    lattice.sets |= {"corner": [elements], "load": [elements + elements // 5]}
    return lattice


def arch(elements):
    """The arch of DaDeppo & Schmidt (1975): 215 degrees of a circle of R = 100, the crown at the
    origin, EI = 1e6, as good as inextensible (A R^2/I = 1.2e7).

    elements: number of beams, even. Sets: root (the left end), tip (the right end), crown.
    """
    if elements % 2:
        raise ValueError(f"elements: {elements} must be even")
    radius, half = 100.0, np.radians(215) / 2
    phi = half * (2 * np.arange(elements + 1) / elements - 1)
    points = radius * np.column_stack([np.sin(phi), np.cos(phi) - 1])
    lattice = frame(points, -phi, Section(0.1, 1.0, young=1.2e10, poisson=0.0))
    lattice.sets["crown"] = [elements // 2]
    return lattice


def elastica(elements):
    """A spring-steel rod, L = 10 m, section 10 x 10 mm, EI = 175 N m^2: A L^2/I = 1.2e7, as good as
    inextensible."""
    return straight_frame(10.0, elements, Section(0.01, 0.01, young=2.1e11, poisson=0.3,
                                                  density=7850.0))


def read(path):
    """A lattice.h5 file as a lattice, with its beams, sets and shapes."""
    with h5py.File(path) as file:
        def get(name):
            return file[name][:]
        lattice = Lattice(*(get(f"bodies/{name}")
                               for name in ("position", "orientation", "mass", "inertia")),
                             shapes=Shapes(*(get(f"shapes/{name}") for name in
                                                ("vertices", "corners", "corner_of", "face_of",
                                                 "vertex_of"))))
        if "beams" in file:
            lattice.bodies, lattice.axis_y = get("beams/bodies"), get("beams/axis_y")
            lattice.beam = {name: get(f"beams/{name}") for name in BEAM_SCALARS}
            for name in ("offsets", "image", "strength", "energy"):
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


def settled(folder):
    """The bodies of the last frame of a run, at rest, and the beams between them that are whole, as
    stress-free as they then lie; sets stay. folder: of the run's results."""
    from floe.results.output import Output, frames_of, has_changes
    folder = Path(folder)
    lattice = read(folder / "lattice.h5")
    frames = frames_of(folder)
    if not frames:
        raise ValueError(f"{folder}: has no frames")
    time, path, group = frames[-1]
    if has_changes(folder):  # then lattice.h5 has the first bodies only
        from floe.results.supply_lattice import lattice_of
        output = Output(folder)
        ice = output.at(time)
        lattice = lattice if ice is output else lattice_of(ice, output.options())
    with h5py.File(path) as file:
        move, turn = file[group]["bodies_displacement"][:], file[group]["bodies_rotation"][:]
        damage = file[group]["damage"][:] if "damage" in file[group] else None
    angle = np.linalg.norm(turn, axis=1)
    spin = np.column_stack([np.cos(angle / 2), 0.5 * np.sinc(angle / (2 * np.pi))[:, None] * turn])
    lattice.position = lattice.position + move
    lattice.orientation = product(spin, lattice.orientation)
    lattice.orientation /= np.linalg.norm(lattice.orientation, axis=1)[:, None]
    if not len(lattice.bodies):
        return lattice
    whole = np.ones(len(lattice.bodies), bool) if damage is None else damage < 1
    first, second = lattice.bodies[whole].T
    lattice.bodies = lattice.bodies[whole]
    lattice.beam = {name: values[whole] for name, values in lattice.beam.items()}
    for name in ("offsets", "image", "strength", "energy"):
        if getattr(lattice, name) is not None:
            setattr(lattice, name, getattr(lattice, name)[whole])
    turns = matrices(spin)
    lattice.axis_y = np.einsum("mij,mj->mi", turns[first], lattice.axis_y[whole])
    chord = lattice.position[second] - lattice.position[first]
    if lattice.image is not None:
        chord += lattice.image
    if lattice.offsets is not None:
        ends = [np.einsum("mij,mj->mi", turns[b], lattice.offsets[:, k:k + 3])
                for b, k in ((first, 0), (second, 3))]
        lattice.offsets = np.hstack(ends)
        chord += ends[1] - ends[0]
    lattice.beam["length"] = np.linalg.norm(chord, axis=1)
    return lattice
