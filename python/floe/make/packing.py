"""Convex bodies in a plane moved and turned until none overlaps another, a wall or an obstacle.

Bodies are given by their support functions h(phi), the distance of their tangent with the outward
normal at the angle phi from their centre. Two are apart where some direction separates them; of
polygons it is a normal of one of their edges. Depths of overlaps are springs, whose energy falls
to zero by FIRE (Bitzek, Koskinen, Gaehler, Moseler & Gumbsch (2006), Phys. Rev. Lett. 97, 170201).
"""
from dataclasses import dataclass

import numpy as np
import scipy

ANGLES = 720  # of the tables of support functions; between them they are linear
STEP = 2 * np.pi / ANGLES
SEARCH = 4  # steps
FACING = 0.3  # cosine of the largest angle of an edge's normal from the line of centres
SMOOTH = 8  # tables' steps over which a corner's place is averaged, so that edges lie on edges


def support(points):
    """Support function of the convex hull of points k x 2 about the origin: ANGLES values."""
    phi = STEP * np.arange(ANGLES)
    return (np.column_stack([np.cos(phi), np.sin(phi)]) @ points.T).max(axis=1)


@dataclass
class Bodies:
    """Convex bodies about their centres, n of them. shape n: rows of table m x ANGLES (supports of
    unit size) and of normals m x k (angles of their edges, some perhaps twice); size n [m]. Discs:
    table None, size their radius."""
    size: np.ndarray
    shape: np.ndarray | None = None
    table: np.ndarray | None = None
    normals: np.ndarray | None = None


class Box:
    """The region: floes lie in [x0, x1] x [y0, y1]."""

    def __init__(self, x0, y0, x1, y1):
        self.bounds = (x0, y0, x1, y1)
        # direction out of the region and where the wall is along it
        self.walls = [(0.0, x1), (np.pi / 2, y1), (np.pi, -x0), (1.5 * np.pi, -y0)]


class Capsule:
    """All within `radius` of a segment: a piece of a lead, or a circle."""

    def __init__(self, a, b, radius):
        self.a, self.b, self.radius = np.asarray(a, float), np.asarray(b, float), radius

    def away(self, x):
        """Unit normals n x 2 out of it, towards x, and the distances of x from it (signed)."""
        along = self.b - self.a
        square = along @ along
        t = np.clip((x - self.a) @ along / square, 0, 1) if square > 0 else np.zeros(len(x))
        d = x - (self.a + t[:, None] * along)
        distance = np.hypot(*d.T)
        side = np.array([-along[1], along[0]]) / np.sqrt(square) if square > 0 else [1.0, 0.0]
        normal = np.where(distance[:, None] > 1e-9, d / np.maximum(distance, 1e-9)[:, None], side)
        return normal, distance - self.radius


class Rectangle:
    """A box that is kept free."""

    def __init__(self, x0, y0, x1, y1):
        self.low, self.high = np.array([x0, y0]), np.array([x1, y1])

    def away(self, x):
        d = x - np.clip(x, self.low, self.high)
        distance = np.hypot(*d.T)
        normal = d / np.maximum(distance, 1e-9)[:, None]
        inside = distance <= 1e-9
        depth = np.concatenate([x - self.low, self.high - x], axis=1)
        nearest = depth.argmin(axis=1)
        out = np.array([[-1.0, 0], [0, -1], [1, 0], [0, 1]])
        normal[inside] = out[nearest[inside]]
        return normal, np.where(inside, -depth.min(axis=1), distance)


def near_pairs(x, reach):
    """Pairs i, j of points n x 2 closer than reach[i] + reach[j] (n): classes by reach, a tree for
    each."""
    level = np.floor(np.log(reach / reach.min()) / np.log(2)).astype(int)
    classes = [np.flatnonzero(level == k) for k in np.unique(level)]
    trees = [(scipy.spatial.cKDTree(x[members]), members, reach[members].max())
             for members in classes]
    found = []
    for k, (tree, members, most) in enumerate(trees):
        pairs = tree.query_pairs(2 * most, output_type="ndarray")
        found.append(members[pairs])
        for other, others, most_other in trees[k + 1:]:
            pairs = tree.sparse_distance_matrix(other, most + most_other, output_type="ndarray")
            found.append(np.column_stack([members[pairs["i"]], others[pairs["j"]]]))
    i, j = np.concatenate(found).T
    close = np.hypot(*(x[j] - x[i]).T) < reach[i] + reach[j]
    return i[close], j[close]


class Packing:
    """Bodies at x n x 2, turned by `turn` n [rad]; at least `gap` [m] apart after `relax`."""

    def __init__(self, bodies, x, turn, box, obstacles, gap):
        self.bodies, self.x, self.turn = bodies, x.copy(), turn.copy()
        self.box, self.obstacles = box, obstacles
        self.margin = 0.002 * bodies.size.min()  # more than the gap, so that relaxing has an end
        self.pad = (gap + self.margin) / 2
        self.discs = bodies.table is None
        if self.discs:
            self.reach = bodies.size + self.pad
        else:
            self.slope = (np.roll(bodies.table, -SMOOTH, axis=1)
                          - np.roll(bodies.table, SMOOTH, axis=1)) / (2 * SMOOTH * STEP)
            self.reach = bodies.size * bodies.table.max(axis=1)[bodies.shape] + self.pad
            rows = np.arange(len(bodies.table))[:, None]
            self.edges = self._look(bodies.table, rows, bodies.normals)
        self.arm = 0.7 * self.reach  # [m] of turning beside moving
        self.mass = self.reach / self.reach.min()  # larger bodies have more neighbours
        self.pairs = None

    @staticmethod
    def _look(table, shape, angle):
        """Values of the rows `shape` of a table at angles [rad]."""
        place = angle * (1 / STEP)
        whole = np.floor(place)
        part = place - whole
        k = whole.astype(np.int64) % ANGLES
        return table[shape, k] * (1 - part) + table[shape, (k + 1) % ANGLES] * part

    def _support(self, which, angle):
        """Distances of the tangents of bodies with outward normals at `angle`, padded."""
        if self.discs:
            return np.broadcast_to(self.reach[which], np.shape(angle))
        b = self.bodies
        return self._look(b.table, b.shape[which], angle - self.turn[which]) * b.size[which] \
            + self.pad

    def _push(self, force, which, angle, depth):
        """Adds to force n x 3 that of a spring of this depth on what touches at `angle`."""
        c, s = np.cos(angle), np.sin(angle)
        count = len(self.x)
        force[:, 0] -= np.bincount(which, depth * c, count)
        force[:, 1] -= np.bincount(which, depth * s, count)
        if not self.discs:
            b = self.bodies  # the corner is at h n + h' t: only t has a lever
            lever = self._look(self.slope, b.shape[which], angle - self.turn[which]) * b.size[which]
            force[:, 2] += np.bincount(which, depth * lever / self.arm[which], count)

    def _find(self):
        self.skin = 0.3 * np.sqrt(self.reach * np.median(self.reach))
        self.pairs = near_pairs(self.x, self.reach + self.skin)
        self.axis = np.full(len(self.pairs[0]), -1)
        self.found_at, self.searched = self.x.copy(), 0

    def _separation(self, i, j, normal):
        """Signed gaps of the pairs along the edges `normal` of i, and these directions [rad]."""
        b = self.bodies
        angle = b.normals[b.shape[i], normal] + self.turn[i]
        d = self.x[j] - self.x[i]
        gap = np.cos(angle) * d[:, 0] + np.sin(angle) * d[:, 1]
        gap -= self.edges[b.shape[i], normal] * b.size[i] + self.pad
        gap -= self._support(j, angle + np.pi)
        return gap, angle

    def _touching(self):
        """Pairs that overlap: i, j, the direction from i to j [rad], the depth [m]."""
        i, j = self.pairs
        d = self.x[j] - self.x[i]
        near = np.flatnonzero(np.einsum("ab,ab->a", d, d) < (self.reach[i] + self.reach[j])**2)
        if self.discs:
            i, j, d = i[near], j[near], d[near]
            depth = self.reach[i] + self.reach[j] - np.hypot(*d.T)
            return i, j, np.arctan2(d[:, 1], d[:, 0]), depth
        # Most are still separated by what separated them before. Of the others the axis that has
        # been best is taken again but in every SEARCH-th step: any axis shows too much overlap, not
        # too little.
        edges = self.bodies.normals.shape[1]
        known = near[self.axis[near] >= 0]
        axis = self.axis[known]
        turned = axis >= edges
        first, second = np.where(turned, j[known], i[known]), np.where(turned, i[known], j[known])
        gap, angle = self._separation(first, second, axis % edges)
        touch = gap < 0
        search = self.searched % SEARCH == 0
        self.searched += 1
        left = np.ones(len(i), bool)
        left[known if not search else known[~touch]] = False
        near = near[left[near]]
        gap, angle, known = gap[touch], (angle + np.pi * turned)[touch], known[touch]
        if search:
            gap, angle, known = gap[:0], angle[:0], known[:0]
        found_gap, found_angle = self._search(near, i[near], j[near], d[near])
        touch = found_gap < 0
        known = np.concatenate([known, near[touch]])
        return (i[known], j[known], np.concatenate([angle, found_angle[touch]]),
                -np.concatenate([gap, found_gap[touch]]))

    def _search(self, pairs, i, j, d):
        """Of pairs with the distances d the largest gap, below 0 where they may overlap, and its
        direction: along the line of centres, or normal to an edge that faces the other body."""
        edges = self.bodies.normals.shape[1]
        along = np.arctan2(d[:, 1], d[:, 0])
        gap = np.hypot(*d.T) - self._support(i, along) - self._support(j, along + np.pi)
        angle, axis = along.copy(), np.full(len(i), -1)
        for first, second, ahead, offset in ((i, j, along, 0), (j, i, along + np.pi, edges)):
            normal = self.bodies.normals[self.bodies.shape[first]] + self.turn[first, None]
            row, edge = np.nonzero(np.cos(normal - ahead[:, None]) > FACING)
            if len(row) == 0:
                continue
            found, direction = self._separation(first[row], second[row], edge)
            begin = np.flatnonzero(np.diff(row, prepend=-1))
            best = np.maximum.reduceat(found, begin)
            # the place of each row's best one
            place = np.flatnonzero(found == np.repeat(best, np.diff(begin, append=len(row))))
            place = place[np.unique(row[place], return_index=True)[1]]
            row, better = row[place], found[place] > gap[row[place]]
            row, place = row[better], place[better]
            gap[row], axis[row] = found[place], edge[place] + offset
            angle[row] = direction[place] + (np.pi if offset else 0.0)
        self.axis[pairs] = axis
        return gap, angle

    def forces(self):
        """Forces n x 3 (x, y, moment over the arm), the largest depth [m]."""
        if self.pairs is None or np.any(np.abs(self.x - self.found_at)
                                        > 0.35 * self.skin[:, None]):
            self._find()
        force, deepest = np.zeros((len(self.x), 3)), 0.0
        i, j, angle, depth = self._touching()
        if len(i):
            deepest = depth.max()
            self._push(force, i, angle, depth)
            self._push(force, j, angle + np.pi, depth)
        everyone = np.arange(len(self.x))
        contacts = [(everyone, np.full(len(self.x), angle),
                     np.cos(angle) * self.x[:, 0] + np.sin(angle) * self.x[:, 1] - limit)
                    for angle, limit in self.box.walls]
        for obstacle in self.obstacles:
            normal, distance = obstacle.away(self.x)
            near = np.flatnonzero(distance < self.reach)
            contacts.append((near, np.arctan2(-normal[near, 1], -normal[near, 0]),
                             -distance[near]))
        for which, angle, beyond in contacts:
            # The gap is kept from walls and obstacles as well.
            depth = beyond + self._support(which, angle) + self.pad
            touch = depth > 0
            if np.any(touch):
                deepest = max(deepest, depth[touch].max())
                self._push(force, which[touch], angle[touch], depth[touch])
        return force, deepest

    def relax(self, steps):
        """Moves and turns until no overlap is deeper than the margin; whether `steps` sufficed."""
        velocity = np.zeros((len(self.x), 3))
        dt, mixing, good = 0.2, 0.1, 0
        largest_move = 0.1 * self.reach
        root = np.sqrt(self.mass)[:, None]
        for self.steps in range(steps):
            force, self.deepest = self.forces()
            if self.deepest <= 0.9 * self.margin:
                return True
            force /= root  # of coordinates times the root of the mass
            power = np.vdot(force, velocity)
            if power > 0:
                good += 1
                if good > 5:
                    dt, mixing = min(1.1 * dt, 0.7), 0.99 * mixing
            else:
                good, dt, mixing, velocity[:] = 0, max(0.5 * dt, 0.05), 0.1, 0.0
            velocity += dt * force
            speed, size = np.linalg.norm(velocity), np.linalg.norm(force)
            velocity += mixing * (force * (speed / max(size, 1e-300)) - velocity)
            move = dt * velocity / root
            length = np.maximum(np.abs(move).max(axis=1), 1e-300)
            move *= np.minimum(1, largest_move / length)[:, None]
            self.x += move[:, :2]
            self.turn += move[:, 2] / self.arm
        return False
