"""Fields of floes: outlines by concentration, sizes, shapes, leads and places that are kept free.

Polygons and outlines are placed whole and moved until none overlaps (packing). Voronoi floes
are the cells of a power diagram (tessellation), cut by leads and shrunk about their centroids
until the concentration is right. All lengths in metres.
"""
import json
from dataclasses import dataclass, field

import numpy as np
import scipy
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon, box, shape
from shapely.geometry.polygon import orient
from shapely.ops import unary_union
from shapely.prepared import prep

from floe.errors import InputError, reading
from floe.make import packing
from floe.make import tessellation

MITRE = 2  # shapely's number of this style of joins
PLACED_MOST, CELLS_MOST = 80.0, 95.0  # concentrations [%]
FLOES_MOST = 200000
STEPS = 2000
LEAST_CELLS = 5
EDGES = 32  # of an outline: along normals of its longest ones it is known to be apart from another
ASPECT = 1.8  # largest of random polygons


def calliper(polygon):
    """Mean calliper diameter [m]: Cauchy's formula."""
    return polygon.convex_hull.length / np.pi


def parts_of(geometry):
    return [part for part in getattr(geometry, "geoms", [geometry])
            if part.geom_type == "Polygon" and part.area > 0]


@dataclass
class Lead:
    """All within half the width of a line through points."""
    points: list
    width: float

    def geometry(self):
        return LineString(self.points).buffer(self.width / 2, 64)

    def obstacles(self):
        return [packing.Capsule(a, b, self.width / 2)
                for a, b in zip(self.points, self.points[1:])]


@dataclass
class Circle:
    centre: tuple
    radius: float

    def geometry(self):
        return Point(self.centre).buffer(self.radius, 64)

    def obstacles(self):
        return [packing.Capsule(self.centre, self.centre, self.radius)]


@dataclass
class Box:
    bounds: tuple  # x0, y0, x1, y1

    def geometry(self):
        return box(*self.bounds)

    def obstacles(self):
        return [packing.Rectangle(*self.bounds)]


@dataclass
class Water:
    """The rectangle x0, y0, x1, y1 and what is cut out of it."""
    region: tuple
    cuts: list = field(default_factory=list)

    def __post_init__(self):
        self.cut = unary_union([cut.geometry() for cut in self.cuts])
        self.whole = box(*self.region)
        self.open = self.whole.difference(self.cut)
        self.obstacles = [each for cut in self.cuts for each in cut.obstacles()]
        if self.open.area <= 1e-6 * self.whole.area:
            raise InputError("--region: leads and keep-outs leave no water for floes")


@dataclass
class Field:
    """Floes, the largest first: polygons, how many times as large as drawn all of them are, the
    least distance between two [m]."""
    polygons: list
    factor: float
    gap: float = np.inf

    def __post_init__(self):
        diameter = np.array([calliper(polygon) for polygon in self.polygons])
        order = np.argsort(-diameter, kind="stable")
        self.diameter, self.polygons = diameter[order], [orient(self.polygons[k]) for k in order]
        self.area = np.array([polygon.area for polygon in self.polygons])
        self.centroid = np.array([polygon.centroid.coords[0] for polygon in self.polygons])
        self.gap = least_gap(self.polygons, self.centroid)


def least_gap(polygons, centre):
    """Least distance of two polygons [m], 0 if any touch or overlap; infinite for one."""
    if len(polygons) < 2:
        return np.inf
    reach = np.array([np.hypot(*(np.asarray(p.exterior.coords) - c).T).max()
                      for p, c in zip(polygons, centre)])
    pairs = np.column_stack(packing.near_pairs(centre, 1.02 * reach))
    if len(pairs) == 0:
        pairs = np.column_stack(packing.near_pairs(centre, reach + 1e3 * reach.max()))
    bounds = np.array([p.bounds for p in polygons])
    low = np.maximum(bounds[pairs[:, 0], :2], bounds[pairs[:, 1], :2])
    high = np.minimum(bounds[pairs[:, 0], 2:], bounds[pairs[:, 1], 2:])
    lower_bound = np.hypot(*np.maximum(low - high, 0).T)
    least = np.inf
    for k in np.argsort(lower_bound, kind="stable"):
        if lower_bound[k] >= least:
            break
        least = min(least, polygons[pairs[k, 0]].distance(polygons[pairs[k, 1]]))
    return least


class Regular:
    """Polygons of `corners` equal sides."""

    def __init__(self, corners):
        self.corners = corners

    def draw(self, random, count):
        """Polygons of mean calliper diameter 1 about their centroids, and which of them each floe
        is."""
        angle = 2 * np.pi * np.arange(self.corners) / self.corners
        return [unit(Polygon(np.column_stack([np.cos(angle), np.sin(angle)])))], \
            np.zeros(count, int)


class Random:
    """Convex polygons of least to most corners, on ellipses of an aspect of 1 to ASPECT."""

    def __init__(self, least, most):
        self.least, self.most = least, most

    def draw(self, random, count):
        found = []
        for _ in range(count):
            k = random.integers(self.least, self.most + 1)
            # Corners off even angles by less than half their spacing: none is lost.
            angle = 2 * np.pi * (np.arange(k) + 0.7 * (random.random(k) - 0.5)) / k
            aspect = 1 + (ASPECT - 1) * random.random()
            turn = 2 * np.pi * random.random()  # of the corners on the ellipse
            corners = np.column_stack([aspect * np.cos(angle + turn), np.sin(angle + turn)])
            polygon = Polygon(corners)
            centre = polygon.centroid
            found.append(Polygon((corners - [centre.x, centre.y]) * (np.pi / polygon.length)))
        return found, np.arange(count)


class Outlines:
    """Outer rings of the polygons of a GeoJSON file, each as often as another; simplified by at
    most `tolerance` times the diameter."""

    def __init__(self, path, tolerance):
        self.polygons = []
        for polygon in read_polygons(path):
            ring = orient(Polygon(polygon.exterior))
            if not ring.is_valid:
                ring = max(parts_of(ring.buffer(0)), key=lambda part: part.area, default=None)
            if ring is None or not ring.area > 0:
                raise InputError(f"{path}: a polygon has no area")
            simple = ring.simplify(tolerance * calliper(ring)) if tolerance else ring
            self.polygons.append(unit(simple if simple.area > 0 else ring))

    def draw(self, random, count):
        return self.polygons, random.integers(0, len(self.polygons), count)


def read_polygons(path):
    """All polygons of a GeoJSON file."""
    with reading(path), open(path) as file:
        text = json.load(file)
        geometries = ([f["geometry"] for f in text["features"]] if text["type"]
                      == "FeatureCollection" else [text["geometry"] if text["type"] == "Feature"
                                                   else text])
        found = [part for geometry in geometries if geometry
                 for part in parts_of(shape(geometry))]
        if not all(np.all(np.isfinite(part.bounds)) for part in found):
            raise ValueError("a coordinate is not finite")
    if not found:
        raise InputError(f"{path}: has no polygons")
    return found


def unit(polygon):
    """Of mean calliper diameter 1, the centroid at the origin, counter-clockwise."""
    size = 1 / calliper(polygon)
    centre = polygon.centroid
    return affinity.scale(affinity.translate(orient(polygon), -centre.x, -centre.y), size, size,
                          origin=(0, 0))


def normals_of(polygon):
    """Angles of the outward normals of a polygon's hull's edges, the longest EDGES of them."""
    hull = orient(polygon.convex_hull)
    if len(hull.exterior.coords) > EDGES:
        hull = orient(hull.simplify(0.01))
    edge = np.diff(np.asarray(hull.exterior.coords), axis=0)
    edge = edge[np.argsort(-np.hypot(*edge.T), kind="stable")[:EDGES]]
    return np.arctan2(-edge[:, 0], edge[:, 1])


def enough(law, random, area, form, shapes=None):
    """Diameters, the largest first, whose floes have an area nearest to `area` [m^2] together, the
    factor on all diameters that makes it exact, and, if shapes are given, polygons and which of
    them each floe is. form: a floe's mean area over the square of its diameter."""
    expected = area / (form * law.mean_square())
    if expected > FLOES_MOST:
        raise InputError(f"--sizes: takes some {expected:.3g} floes; at most {FLOES_MOST}")
    count = int(1.1 * expected) + 50
    while True:
        sizes, pool, kind, forms = law.draw(random, count), None, None, np.full(count, form)
        if shapes:
            pool, kind = shapes.draw(random, count)
            forms = np.array([polygon.area for polygon in pool])[kind]
        total = np.cumsum(forms * sizes**2)
        if total[-1] > area:
            break
        count *= 2
    count = np.abs(total - area).argmin() + 1
    order = np.argsort(-sizes[:count], kind="stable")
    factor = np.sqrt(area / total[count - 1])
    return sizes[order] * factor, factor, pool, kind[order] if shapes else None


def check_largest(water, diameter):
    x0, y0, x1, y1 = water.region
    if diameter > min(x1 - x0, y1 - y0):
        raise InputError(f"--sizes: a floe of {diameter:.4g} m does not fit into the region of "
                         f"{x1 - x0:g} m x {y1 - y0:g} m")


def scattered(water, diameter, area, random):
    """Random points n x 2 in the open water for floes of these diameters and areas n, the largest
    first, as many in one part of it as in another: squares of twice the largest diameter, cut by
    what is cut out, take floes of an area that goes with their own."""
    x0, y0, x1, y1 = water.region
    columns, rows = (max(1, min(30, int(side / (2 * diameter[0])))) for side in (x1 - x0, y1 - y0))
    x, y = np.linspace(x0, x1, columns + 1), np.linspace(y0, y1, rows + 1)
    squares = [box(x[i], y[j], x[i + 1], y[j + 1]) for i in range(columns) for j in range(rows)]
    parts = [part for square in squares for part in parts_of(square.intersection(water.open))]
    left = np.array([part.area for part in parts])
    width = np.array([4 * part.area / part.length for part in parts])
    left *= area.sum() / left.sum()
    home = np.empty(len(area), int)
    for k, (d, a) in enumerate(zip(diameter, area)):
        fits = np.flatnonzero((left > a) & (width > d))
        if len(fits):
            chance = np.cumsum(left[fits])
            home[k] = fits[np.searchsorted(chance, chance[-1] * random.random())]
        else:
            home[k] = left.argmax()
        left[home[k]] -= a
    found = np.empty((len(area), 2))
    for k, part in enumerate(parts):
        low, high = np.reshape(part.bounds, (2, 2))
        inside = prep(part)
        whole = part.area > (1 - 1e-9) * np.prod(high - low)
        todo, tries = np.flatnonzero(home == k), 0
        while len(todo):
            found[todo] = low + (high - low) * random.random((len(todo), 2))
            room = np.minimum(found[todo] - [x0, y0], [x1, y1] - found[todo]).min(axis=1)
            for obstacle in water.obstacles:
                room = np.minimum(room, obstacle.away(found[todo])[1])
            # Rather where it fits beside walls and cuts; anywhere in its part after 20 tries.
            tries += 1
            good = np.array([whole or inside.contains(Point(at)) for at in found[todo]])
            good &= (room > 0.4 * diameter[todo]) | (tries > 20)
            todo = todo[~good]
    return found


def place(water, concentration, law, shapes, gap, random):
    """Whole polygons; concentration [%] of the open water."""
    wanted = concentration / 100 * water.open.area
    pool, _ = shapes.draw(np.random.default_rng(0), 1000)
    form = np.mean([polygon.area for polygon in pool])
    sizes, factor, pool, kind = enough(law, random, wanted, form, shapes)
    check_largest(water, sizes[0] / factor)
    # Of polygons that belong to one floe each, those of floes only.
    used, kind = np.unique(kind, return_inverse=True)
    pool = [pool[k] for k in used]
    hulls = np.array([polygon.convex_hull.area for polygon in pool])[kind] * sizes**2
    x = scattered(water, sizes, hulls, random)
    turn = 2 * np.pi * random.random(len(sizes))
    walls = packing.Box(*water.region)
    # Discs first: they spread evenly, at less cost.
    radius = np.sqrt(hulls / np.pi * min(1, 0.78 * water.open.area / hulls.sum()))
    discs = packing.Packing(packing.Bodies(radius), x, turn, walls, water.obstacles, gap)
    discs.relax(STEPS // 2)
    normals = [normals_of(polygon) for polygon in pool]
    most = max(map(len, normals))
    bodies = packing.Bodies(
        sizes, kind, np.array([packing.support(np.asarray(p.exterior.coords)) for p in pool]),
        np.array([np.pad(each, (0, most - len(each)), "edge") for each in normals]))
    packed = packing.Packing(bodies, discs.x, turn, walls, water.obstacles, gap)
    if not packed.relax(STEPS):
        raise InputError(f"--concentration {concentration:g}: these floes do not come apart: two "
                         f"overlap by {packed.deepest:.3g} m after {STEPS} moves; ask for less, a "
                         "smaller --gap, other sizes, or --shape voronoi")
    floes = []
    for k, size, at, angle in zip(kind, sizes, packed.x, packed.turn):
        c, s = size * np.cos(angle), size * np.sin(angle)
        floes.append(affinity.affine_transform(pool[k], [c, -s, s, c, *at]))
    return Field(floes, factor)


def cells(region, sizes, random):
    """Polygons of a power diagram of the region whose diameters are as `sizes` to each other."""
    x0, y0, x1, y1 = region
    form = 0.7 * (x1 - x0) * (y1 - y0) / (np.pi / 4 * (sizes**2).sum())
    radius = sizes / 2 * np.sqrt(form)
    x = scattered(Water(region), sizes, sizes**2, random)
    discs = packing.Packing(packing.Bodies(radius), x, np.zeros(len(x)), packing.Box(*region), [],
                            0.0)
    discs.relax(STEPS)
    diagram = tessellation.round_cells(discs.x, radius, sizes, region)
    if diagram is None:
        raise InputError("--sizes: no cells of these sizes are found; ask for less different sizes")
    return diagram


def shrunk(polygon, share):
    """A polygon inside, with this share of the area: about the centroid if that keeps it inside,
    else by an even margin."""
    if polygon.convex_hull.area < (1 + 1e-9) * polygon.area:
        size = np.sqrt(share)
        return affinity.scale(polygon, size, size, origin=polygon.centroid)

    def largest(margin):
        return max(parts_of(polygon.buffer(-margin, join_style=MITRE)),
                   key=lambda part: part.area, default=Polygon())
    wanted = share * polygon.area
    end = np.sqrt(polygon.area / np.pi)  # no circle inside is larger
    margin = scipy.optimize.brentq(lambda m: largest(m).area - wanted, 0, end, xtol=1e-9 * end)
    return largest(margin)


def tessellate(water, concentration, law, gap, random):
    """Voronoi floes; concentration [%] of the open water."""
    x0, y0, x1, y1 = water.region
    whole = (x1 - x0) * (y1 - y0)
    share = concentration / 100
    # The first few sizes tell how much area cells have for their diameters.
    sizes, *_ = enough(law, np.random.default_rng(0), whole, 0.8 * np.pi / 4)
    pilot = sizes[:: len(sizes) // 300 + 1]
    form = 0.8 * np.pi / 4
    if len(pilot) >= LEAST_CELLS:
        side = np.sqrt((pilot**2).sum())
        diagram = cells((0, 0, side, side), pilot, np.random.default_rng(0))
        form = np.mean(diagram.area) / np.mean((diagram.perimeter / np.pi)**2)
    # A floe is its cell times the root of the concentration.
    sizes, factor, *_ = enough(law, random, share * whole, form)
    if len(sizes) < LEAST_CELLS:
        raise InputError(f"--sizes: the region holds {len(sizes)} floes of these sizes, at least "
                         f"{LEAST_CELLS} are needed")
    check_largest(water, sizes[0] / factor)
    diagram = cells(water.region, sizes, random)
    polygons = [Polygon(corners) for corners in diagram.cells()]
    smallest = (diagram.perimeter.min() / np.pi) / 2
    cut = prep(water.cut)
    pieces = []
    for polygon in polygons:
        if cut.intersects(polygon):
            pieces += [part for part in parts_of(polygon.difference(water.cut))
                       if calliper(part) > smallest]
        else:
            pieces.append(polygon)
    if gap > 0:
        pieces = [part for polygon in pieces
                  for part in parts_of(polygon.buffer(-gap / 2, join_style=MITRE))
                  if calliper(part) > smallest / 2]
    most = sum(piece.area for piece in pieces)
    wanted = share * water.open.area
    if wanted > most:
        raise InputError(f"--concentration {concentration:g}: the --gap of {gap:g} m and pieces "
                         f"too small between cuts leave {100 * most / water.open.area:.4g} % at "
                         "most")
    # Of floes that no cut has touched, as drawn.
    factor *= np.median(diagram.perimeter / np.pi / sizes) * np.sqrt(wanted / most)
    return Field([shrunk(piece, wanted / most) for piece in pieces], factor)
