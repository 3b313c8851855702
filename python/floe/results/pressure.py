"""Local pressures of a run: forces on the patches of an obstacle's surface, from pressure.csv, and
the places of the patches at rest, from lattice.h5 (docs/model.md, "Pressure" and "Files").
"""
import dataclasses
import heapq
from pathlib import Path

import numpy as np
import scipy

from floe.errors import InputError, reading
from floe.results import tables
from floe.results.output import Lattice


NEAR = 1.5  # largest distance of neighbours' centres, in mean sides: squares may meet at corners


@dataclasses.dataclass
class Patches:
    """The patches of an obstacle and the forces on them, at rest and at the times of samples."""
    name: str
    centre: np.ndarray   # (n, 3) [m]
    normal: np.ndarray   # (n, 3), outwards
    area: np.ndarray     # (n) [m2]
    size: np.ndarray     # (n, 2), level and up the plane [m]
    time: np.ndarray     # (t) [s]
    force: np.ndarray    # (t, n) [N], against the normal
    total: np.ndarray    # (t, 3) [N]

    @property
    def pressure(self):
        """(t, n) [Pa]."""
        return self.force / self.area

    def mean(self, values):
        """Mean of values (t, ...) over the time, by the trapezoidal rule."""
        if len(self.time) == 1:
            return values[0]
        steps = np.diff(self.time)
        weights = np.append(steps, 0) + np.append(0, steps)
        return np.tensordot(weights / weights.sum(), values, 1)

    def since(self, start):
        """These from a time on."""
        kept = self.time >= start
        return dataclasses.replace(self, time=self.time[kept], force=self.force[kept],
                                   total=self.total[kept])

    def loaded(self):
        """Share of the area that bears a force (t)."""
        return (self.force > 0) @ self.area / self.area.sum()

    def neighbours(self):
        """Per patch the numbers of those beside it: near, and looking less than 90 degrees away."""
        side = np.sqrt(self.area)
        tree = scipy.spatial.cKDTree(self.centre)
        pairs = tree.query_pairs(NEAR * side.max(), output_type="ndarray")
        i, j = pairs[:, 0], pairs[:, 1]
        apart = np.linalg.norm(self.centre[i] - self.centre[j], axis=1)
        kept = ((apart <= NEAR * (side[i] + side[j]) / 2)
                & (np.einsum("pk,pk->p", self.normal[i], self.normal[j]) > 0))
        found = [[] for _ in self.area]
        for a, b in pairs[kept]:
            found[a].append(b)
            found[b].append(a)
        return found


def path_of(folder):
    return Path(folder) / "pressure.csv"


def read(folder):
    """{name: Patches} of a run."""
    path = path_of(folder)
    if not Path(folder).is_dir():
        raise InputError(f"{folder}: no such folder")
    if not path.is_file():
        raise InputError(f"{folder}: has no pressure.csv: the scene asks for no pressures")
    shapes = Lattice(Path(folder) / "lattice.h5").obstacles
    with reading(path):
        table = tables.table_of(path, dtype={"patch": str, "obstacle": str})
        found = {name: of_obstacle(name, rows, shapes[name])
                 for name, rows in table.groupby("obstacle", sort=False)}
    if not found:
        raise InputError(f"{path}: has no rows")
    return found


def of_obstacle(name, rows, shape):
    """The patches of one obstacle from its rows, of which a killed run may lack the last."""
    vectors = rows[["force_x", "force_y", "force_z"]].to_numpy()
    whole = (rows.patch == "all").to_numpy()
    sample = np.cumsum(whole) - 1
    patch = rows.patch[~whole].astype(int).to_numpy()
    normal = shape["patch_normal"]
    force = np.zeros((whole.sum(), len(normal)))
    force[sample[~whole], patch] = -np.einsum("ij,ij->i", vectors[~whole], normal[patch])
    return Patches(name, shape["patch_centre"], normal, shape["patch_area"],
                   shape["patch_size"], rows.time[whole].to_numpy(), force, vectors[whole])


def grown(seed, pressure, area, beside, most):
    """Forces and areas of windows of 1, 2, ..., `most` patches: from a patch on,
    the neighbour of the window with the largest pressure joins it, until none is left."""
    force, size, waiting, known = [], [], [(-pressure[seed], seed)], {seed}
    f = a = 0.0
    while waiting and len(force) < most:
        value, k = heapq.heappop(waiting)
        f, a = f - value * area[k], a + area[k]
        force.append(f)
        size.append(a)
        for other in beside[k]:
            if other not in known:
                known.add(other)
                heapq.heappush(waiting, (-pressure[other], other))
    return np.array(force), np.array(size)


def chosen(found, obstacle=None, start=0.0):
    """The Patches of an obstacle (None: the first) from a time on [s]. found: what read() returns.
    InputError where nothing touches them."""
    name = obstacle or next(iter(found))
    if name not in found:
        raise InputError(f"obstacle {name}: must be one of {', '.join(found)}")
    patches = found[name].since(start)
    if not len(patches.time):
        raise InputError(f"start {start:g}: is after the last row of pressure.csv")
    if not np.any(patches.force > 0):
        raise InputError(f"nothing touches {name}" + (f" from {start:g} s on" if start else ""))
    return patches


def area_curve(patches, most=None):
    """Area [m2] and largest mean pressure [Pa] of connected windows of 1, 2, ... patches, over all
    times and places: windows that grow from each local maximum of the pressure by the neighbour
    with the largest pressure. That finds the largest mean around one maximum; between several it is
    a lower bound."""
    n = len(patches.area)
    most = min(most or n, n)
    beside = patches.neighbours()
    best, at = np.zeros(most), np.cumsum(np.sort(patches.area))[:most]
    least = at.copy()
    pressures = patches.pressure
    order = np.argsort(-pressures.max(axis=1), kind="stable")
    for t in order:
        force, pressure = patches.force[t], pressures[t]
        bound = np.cumsum(-np.sort(-force))[:most] / least
        if not np.any(bound > best * (1 + 1e-12)):
            continue
        for seed in np.flatnonzero(force > 0):
            if any(pressure[k] > pressure[seed] for k in beside[seed]):
                continue
            f, a = grown(seed, pressure, patches.area, beside, most)
            better = np.flatnonzero(f / a > best[:len(f)])
            best[better], at[better] = (f / a)[better], a[better]
    order = np.argsort(at, kind="stable")
    order = order[best[order] > 0]
    return at[order], best[order]


def iso(area):
    """Local pressure of ISO 19906 on an area [m2]: 7.40 A^-0.70 MPa up to 10 m2, 1.48 MPa beyond
    [Pa]."""
    area = np.asarray(area, float)
    return np.where(area <= 10, 7.4e6 * area**-0.7, 1.48e6)


def axis_of(patches):
    """The vertical axis (x, y) nearest to all horizontal normals, or None where they are
    parallel."""
    across = patches.normal[:, :2]
    size = np.linalg.norm(across, axis=1)
    side = size > 0.1
    if not side.any():
        return None
    n, c, w = across[side] / size[side, None], patches.centre[side, :2], patches.area[side]
    if np.linalg.norm(np.average(n, axis=0, weights=w)) > 0.999:
        return None
    matrices = np.eye(2) - n[:, :, None] * n[:, None, :]
    return np.linalg.solve(np.tensordot(w, matrices, 1), np.einsum("p,pij,pj->i", w, matrices, c))


def unrolled(patches):
    """Where the patches are in a map: coordinate along the surface (n), its half widths (n), its
    label; height (n) and half heights (n) [m]; and which patches are shown (those whose normal is
    not vertical). Around an axis the coordinate is the angle from x [degrees], cut where there is
    least load; else the distance along the wall [m]."""
    side, tall = patches.size.T
    steep = np.linalg.norm(patches.normal[:, :2], axis=1)
    axis = axis_of(patches)
    if axis is None:
        n = np.average(patches.normal[:, :2], axis=0, weights=patches.area * (steep > 0.1) + 1e-300)
        along = np.array([-n[1], n[0]]) / max(np.linalg.norm(n), 1e-300)
        return (patches.centre[:, :2] @ along, side / 2, "along the wall [m]", patches.centre[:, 2],
                tall * steep / 2, steep > 0.1)
    off = patches.centre[:, :2] - axis
    angle = np.degrees(np.arctan2(off[:, 1], off[:, 0]))
    mean = patches.mean(patches.force)
    if np.cos(np.radians(angle)) @ mean < 0:  # the load is around 180 degrees
        angle %= 360
    half = np.degrees(side / 2 / np.maximum(np.linalg.norm(off, axis=1), 1e-9))
    return angle, half, "angle from x [°]", patches.centre[:, 2], tall * steep / 2, steep > 0.1
