"""What the frames of runs say of the ice at an obstacle: pressure against area, the pile's height,
depth and porosity against distance, sizes of fragments. SI units; z = 0 is still water.

Shapes are those of the bodies at rest in their places of the frame: what a body has lost by wear is
not taken off, so areas of contact are upper, pressures lower bounds once ice has crushed.
"""
import numpy as np
import scipy  # whose modules come when they are used

from floe.errors import InputError
from floe.results import breakage, tables
from floe.results.obstacles import obstacles_of_run, structures
from floe.results.output import Output


QUANTILES = (0.1, 0.5, 0.9)
SECTOR = np.cos(np.radians(45))  # columns count that lie within 45 degrees of where the ice comes
FINE = 4                         # columns of a pile along the side of a body


class Bodies:
    """The polyhedra of the ice in a frame: planes n x <= d of all faces, one body after another.
    Structures, the last bodies of a run, are obstacles here."""

    def __init__(self, output, time):
        shapes = output.at(time).shapes
        ice = len(shapes["vertex_of"]) - 1 - len(structures(output.options()))
        self.vertex_of, self.face_of = (shapes[name][:ice + 1] for name in ("vertex_of", "face_of"))
        self.points = output.field("points", time)[:self.vertex_of[-1]]
        corner_of = shapes["corner_of"][:self.face_of[-1] + 1]
        corners = shapes["corners"][:corner_of[-1]]
        first = self.points[corners[corner_of[:-1]]]
        # twice the area vector of each face (Newell's method)
        following = np.arange(1, len(corners) + 1)
        following[corner_of[1:] - 1] = corner_of[:-1]
        p = self.points[corners]
        area = np.add.reduceat(np.cross(p, p[following]), corner_of[:-1])
        self.normal = area / np.linalg.norm(area, axis=1)[:, None]
        self.offset = np.einsum("fi,fi->f", self.normal, first)
        self.low = np.minimum.reduceat(self.points, self.vertex_of[:-1])
        self.high = np.maximum.reduceat(self.points, self.vertex_of[:-1])

    def __len__(self):
        return len(self.low)

    def planes(self, body):
        faces = slice(self.face_of[body], self.face_of[body + 1])
        return self.normal[faces], self.offset[faces]

    def side(self):
        """Side of a square of the bodies' mean area in plan [m], by their bounding boxes' median
        where they lie flat."""
        size = self.high - self.low
        return float(np.sqrt(np.median(size[:, 0] * size[:, 1]) * 0.75))


def clipped(polygon, normals, offsets):
    """The part of a plane convex polygon k x 3 within n x <= d for all planes (Sutherland and
    Hodgman, Comm. ACM 17, 1974, 32); fewer than 3 corners: nothing."""
    for n, d in zip(normals, offsets):
        if len(polygon) < 3:
            break
        above = polygon @ n - d
        if np.all(above <= 0):
            continue
        kept = []
        for k, here in enumerate(above):
            there = above[k - 1]
            if (here > 0) != (there > 0):
                share = there / (there - here)
                kept.append(polygon[k - 1] + share * (polygon[k] - polygon[k - 1]))
            if here <= 0:
                kept.append(polygon[k])
        polygon = np.array(kept)
    return polygon


def area_of(polygon):
    """Area of a plane polygon k x 3 [m^2]."""
    if len(polygon) < 3:
        return 0.0
    spans = polygon[1:] - polygon[0]
    return float(np.linalg.norm(np.cross(spans[:-1], spans[1:]).sum(axis=0)) / 2)


def contact_area(bodies, points, faces):
    """Area [m^2] of an obstacle's surface that lies in bodies: what contacts press on."""
    total = 0.0
    for face in faces:
        polygon = points[face]
        normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
        normal /= np.linalg.norm(normal)
        height = (bodies.points - polygon[0]) @ normal
        near = (np.minimum.reduceat(height, bodies.vertex_of[:-1]) < 0) & (
            np.maximum.reduceat(height, bodies.vertex_of[:-1]) > 0)
        near &= np.all(bodies.low <= polygon.max(axis=0), axis=1)
        near &= np.all(bodies.high >= polygon.min(axis=0), axis=1)
        total += sum(area_of(clipped(polygon, *bodies.planes(body)))
                     for body in np.flatnonzero(near))
    return total


def placed(obstacle, k):
    """Points of an obstacle at the k-th of its times."""
    points = np.array(obstacle["points"])
    if not obstacle["motions"]:
        return points
    way, turn = map(np.array, obstacle["motions"][k])
    origin = np.array(obstacle["origin"])
    return origin + way + (points - origin) @ turn.T


def obstacle_of(output, name, times):
    """The obstacle of a run's scene, with its places at these times; planes reach 10 m beyond the
    ice."""
    low, high = output.box()
    low, high = low - [10, 10, 10], high + [10, 10, 10]
    return next(o for o in obstacles_of_run(output, low, high, times) if o["name"] == name)


def pressures(output, name, start):
    """Contact area [m^2] and mean pressure [Pa] on an obstacle at the frames after `start` in which
    it is touched: the norm of the force of that instant over the area."""
    table = tables.history(output.folder)
    time = table["time"].to_numpy()
    force = np.linalg.norm(table[[f"{name}_force_{axis}" for axis in "xyz"]].to_numpy(), axis=1)
    times = output.times[(output.times >= start) & (output.times > 0)]
    obstacle, found = obstacle_of(output, name, times), []
    for k, t in enumerate(times):
        row = int(np.argmin(np.abs(time - t)))
        if abs(time[row] - t) > 1e-6 * max(t, 1) or force[row] == 0:
            continue
        area = contact_area(Bodies(output, t), placed(obstacle, k), obstacle["faces"])
        if area > 0:
            found.append((area, force[row] / area))
    return found


def power_law(pairs):
    """p = c A^-m through pairs (A, p), least squares of the logarithms; {"c" [Pa at 1 m^2], "m",
    "scatter" [of ln p]}; None of fewer than 10."""
    if len(pairs) < 10:
        return None
    area, pressure = np.log(np.array(pairs)).T
    if np.ptp(area) == 0:
        return None
    line = scipy.stats.linregress(area, pressure)
    return {"c": float(np.exp(line.intercept)), "m": float(-line.slope),
            "scatter": float(np.std(pressure - line.intercept - line.slope * area))}


def columns(bodies, spacing, wanted):
    """Vertical lines through the ice, on a grid in plan: places k x 2 [m], the ice's top, bottom
    and solid height [m] on each. wanted: box (low, high) in plan."""
    low, high = wanted
    shape = np.maximum(np.ceil((high - low) / spacing).astype(int), 1)
    index, bottom, top = [], [], []
    for body in np.flatnonzero(np.all(bodies.low[:, :2] < high, axis=1)
                               & np.all(bodies.high[:, :2] > low, axis=1)):
        first = np.maximum(np.ceil((bodies.low[body, :2] - low) / spacing - 0.5), 0).astype(int)
        last = np.minimum(np.floor((bodies.high[body, :2] - low) / spacing - 0.5),
                          shape - 1).astype(int)
        if np.any(last < first):
            continue
        i, j = np.meshgrid(np.arange(first[0], last[0] + 1), np.arange(first[1], last[1] + 1),
                           indexing="ij")
        i, j = i.ravel(), j.ravel()
        places = low + spacing * (np.column_stack([i, j]) + 0.5)
        normal, offset = bodies.planes(body)
        rest = offset - places @ normal[:, :2].T
        up, down = normal[:, 2] > 1e-9, normal[:, 2] < -1e-9
        inside = np.all(rest[:, ~(up | down)] >= 0, axis=1)
        ceiling = (rest[:, up] / normal[up, 2]).min(axis=1)
        floor = (rest[:, down] / normal[down, 2]).max(axis=1)
        inside &= ceiling > floor
        index.append((i * shape[1] + j)[inside])
        bottom.append(floor[inside])
        top.append(ceiling[inside])
    if not index:
        return np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0)
    index, bottom, top = map(np.concatenate, (index, bottom, top))
    return joined(index, bottom, top, lambda k: low + spacing * (
        np.column_stack(np.divmod(k, shape[1])) + 0.5))


def joined(index, bottom, top, place):
    """Columns from intervals of z: their places, tops, bottoms, and lengths of their unions."""
    order = np.lexsort((bottom, index))
    index, bottom, top = index[order], bottom[order], top[order]
    column, first = np.unique(index, return_index=True)
    # the highest top so far within a column: columns are lifted far above those before
    lift = np.repeat(np.arange(len(column)), np.diff(np.append(first, len(index)))) * 1e6
    reached = np.maximum.accumulate(top + lift) - lift
    before = np.empty_like(reached)
    before[1:] = reached[:-1]
    before[first] = -np.inf
    solid = np.maximum(top - np.maximum(bottom, before), 0)
    return (place(column), np.maximum.reduceat(top, first), bottom[first],
            np.add.reduceat(solid, first))


def waterline(points, faces):
    """Corners k x 2 [m] of an obstacle's section at z = 0, around it; of a plane its two ends. None
    if it does not reach the water's surface."""
    found = []
    for face in faces:
        for a, b in zip(face, np.roll(face, -1)):
            za, zb = points[a, 2], points[b, 2]
            if (za > 0) != (zb > 0):
                found.append((points[a] + za / (za - zb) * (points[b] - points[a]))[:2])
    if len(found) < 2:
        return None
    found = np.unique(np.round(found, 9), axis=0)
    if len(found) < 3:
        return found if len(found) == 2 else None
    about = found - found.mean(axis=0)
    return found[np.argsort(np.arctan2(about[:, 1], about[:, 0]))]


def outward(places, line, normal=None):
    """Distances [m] in plan from a waterline, negative inside it, and unit vectors away from it.
    normal: of a plane, away from it in plan."""
    if normal is not None:
        return (places - line[0]) @ normal, np.broadcast_to(normal, places.shape)
    best = np.full(len(places), np.inf)
    nearest, inside = np.zeros_like(places), np.ones(len(places), bool)
    for a, b in zip(line, np.roll(line, -1, axis=0)):
        along = b - a
        share = np.clip((places - a) @ along / (along @ along), 0, 1)
        foot = a + share[:, None] * along
        distance = np.linalg.norm(places - foot, axis=1)
        closer = distance < best
        best[closer], nearest[closer] = distance[closer], foot[closer]
        inside &= along[0] * (places[:, 1] - a[1]) - along[1] * (places[:, 0] - a[0]) > 0
    away = np.where(inside, -1, 1)[:, None] * (places - nearest)
    return np.where(inside, -best, best), away / np.maximum(best, 1e-12)[:, None]


def profile(output, name, force, number=20):
    """Columns of ice on the side from which it comes, at the last frame: signed distances from the
    waterline, tops, bottoms, solid heights [m] and the width of bins; None if the obstacle does not
    cut the water's surface. force: mean force on the obstacle, which points down the drift."""
    time = output.times[-1]
    bodies, obstacle = Bodies(output, time), obstacle_of(output, name, [time])
    points = placed(obstacle, 0)
    line = waterline(points, obstacle["faces"])
    upstream = -np.asarray(force[:2], float)
    if line is None or not np.any(upstream):
        return None
    upstream /= np.linalg.norm(upstream)
    normal = None
    if obstacle["plane"]:
        along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
        normal = np.array([along[1], -along[0]])
        normal *= np.sign(normal @ upstream) or 1
    side = bodies.side()
    reach = number * side
    places, top, bottom, solid = columns(bodies, side / FINE, (line.min(axis=0) - reach,
                                                               line.max(axis=0) + reach))
    distance, away = outward(places, line, normal)
    kept = (away @ upstream >= SECTOR) & (distance < reach)
    return side, distance[kept], top[kept], bottom[kept], solid[kept]


def profile_in_bins(found):
    """Means over columns of several runs by distance: a dictionary of lists [m], one number per
    bin of a body's side. columns: how many a run has; a body's area has FINE^2."""
    side = found[0][0]
    distance, top, bottom, solid = (np.concatenate([each[k] for each in found])
                                    for k in range(1, 5))
    if not len(distance):
        return None
    number = np.floor(distance / side).astype(int)
    bins = np.unique(number)
    rows = {"distance": (bins + 0.5) * side, "top": [], "bottom": [], "highest": [], "deepest": [],
            "porosity": [], "columns": []}
    for k in bins:
        of = number == k
        rows["columns"].append(of.sum() / len(found))
        rows["top"].append(top[of].mean())
        rows["bottom"].append(bottom[of].mean())
        rows["highest"].append(top[of].max())
        rows["deepest"].append(bottom[of].min())
        rows["porosity"].append(1 - solid[of].sum() / (top[of] - bottom[of]).sum())
    return {key: [float(v) for v in values] for key, values in rows.items()}


def fragments(output):
    """Masses [kg] and bodies of the pieces at the end without the heaviest, which is the sheet;
    empty where nothing could break. Pieces that have left are none of them."""
    found = breakage.at_end(output)
    if not found:
        return np.zeros(0), np.zeros(0, int)
    mass, bodies = found["fragments/mass"], found["fragments/bodies"]
    kept = np.arange(len(mass)) != np.argmax(mass)
    return mass[kept], bodies[kept]


def diameters(mass, options):
    """Diameters [m] of discs of the sheet's thickness with these masses; of spheres without a
    sheet."""
    density = float(options.get("ice_density", 920))
    if "sheet_thickness" in options:
        return np.sqrt(4 * mass / (np.pi * density * float(options["sheet_thickness"])))
    return np.cbrt(6 * mass / (np.pi * density))


def sizes(size, mass, bodies):
    """Quantiles of sizes by number and by mass: of which size and below is this share."""
    if not len(size):
        return None
    order = np.argsort(size)
    share = (np.cumsum(mass[order]) - mass[order] / 2) / mass.sum()
    return {"number": len(size), "quantiles": list(QUANTILES),
            "by_number": [float(v) for v in np.quantile(size, QUANTILES)],
            "by_mass": [float(v) for v in np.interp(QUANTILES, share, size[order])],
            "single_bodies": float(np.mean(bodies == 1)), "sizes": sorted(map(float, size))}


def state(runs, name, start):
    """What the frames of runs say of the ice at an obstacle, for JSON."""
    pairs, profiles, size, mass, bodies = [], [], [], [], []
    for run in runs:
        output = Output(run.folder)
        if not output.shapes:
            raise InputError(f"{run.folder}: bodies have no shapes")
        if not len(output.times):
            raise InputError(f"{run.folder} has no frame yet")
        pairs += pressures(output, name, start)
        profiles.append(profile(output, name, run.forces[name].mean(axis=1)))
        m, b = fragments(output)
        size.append(diameters(m, run.options))
        mass.append(m)
        bodies.append(b)
    known = [each for each in profiles if each is not None]
    return {"pressure_area": {"area": [float(a) for a, _ in pairs],
                              "pressure": [float(p) for _, p in pairs], "law": power_law(pairs)},
            "profile": profile_in_bins(known) if known else None,
            "fragments": sizes(*map(np.concatenate, (size, mass, bodies)))}


def lines_of(found):
    """The same as text."""
    pairs, law = found["pressure_area"], found["pressure_area"]["law"]
    if pairs["area"]:
        yield (f"  pressure     {len(pairs['area'])} frames in contact, mean "
               f"{np.mean(pairs['pressure']) / 1e6:.3g} MPa over {np.mean(pairs['area']):.3g} m^2"
               + (f"; p = {law['c'] / 1e6:.3g} MPa (A/m^2)^{-law['m']:.2f}, scatter of ln p "
                  f"{law['scatter']:.2f}" if law else ""))
    profile = found["profile"]
    if profile:
        few = np.array(profile["columns"]) < FINE**2  # less than one body a run
        high = np.argmax(np.where(few, -np.inf, profile["top"]))
        deep = np.argmin(np.where(few, np.inf, profile["bottom"]))
        pile = np.array(profile["distance"]) < profile["distance"][deep] + 1e-9
        yield (f"  pile         mean top {profile['top'][high]:.2f} m at "
               f"{profile['distance'][high]:.1f} m from the waterline, mean bottom "
               f"{profile['bottom'][deep]:.2f} m at {profile['distance'][deep]:.1f} m; highest "
               f"{max(profile['highest']):.2f} m, deepest {min(profile['deepest']):.2f} m, "
               f"porosity {np.array(profile['porosity'])[pile].mean():.2f}")
    pieces = found["fragments"]
    if pieces:
        words = [f"{a:.2f}/{b:.2f}/{c:.2f} m" for a, b, c in (pieces["by_number"],
                                                             pieces["by_mass"])]
        yield (f"  fragments    {pieces['number']} without the sheet, 10/50/90 % of their number "
               f"below {words[0]}, of their mass below {words[1]}; "
               f"{100 * pieces['single_bodies']:.0f} % single bodies")
