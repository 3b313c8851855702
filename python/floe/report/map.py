"""Where the force on an obstacle acts: the resultant of all contacts at the rows of a run's
history, mapped over the obstacle's surface. SI units.

Outputs have the force F and moment M on an obstacle, not each contact's. The two are one force
along the line r + s F with r = F x M/|F|^2, Poinsot's central axis, without the couple along it.
It meets the surface where it presses inwards. With contacts at several places it acts between
them.
"""
import numpy as np

from floe.loads.fields import clipped
from floe.report.series import rounded
from floe.results.obstacles import obstacles_of_run

LEAST = 0.02    # rows with less than this share of the largest force are left out: their line of
                # action says little
CELLS = 16      # along each side of a map
FINE = 120      # parts of a triangle's side when areas of cells are measured


def foot(force, moment):
    """Foot of the central axis, seen from the point that the moment is about; n x 3."""
    return np.cross(force, moment) / np.maximum((force**2).sum(axis=1), 1e-300)[:, None]


def entries(points, faces, foot_of, force):
    """Where lines foot_of + s force (n x 3) enter a convex polyhedron or meet a plane pressing
    inwards; NaN where they miss it."""
    found = np.full(force.shape, np.nan)
    for face in faces:
        ring = points[face]
        normal = np.cross(ring[1] - ring[0], ring[2] - ring[0])
        speed = force @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            s = ((ring[0] - foot_of) @ normal) / speed
        inside = (speed < 0) & np.isfinite(s)
        at = foot_of + np.where(inside, s, 0)[:, None] * force
        for a, b in zip(ring, np.roll(ring, -1, axis=0)):
            side = np.cross(b - a, at - a) @ normal
            inside &= side >= -1e-9 * np.linalg.norm(normal)**1.5
        found[inside] = at[inside]
    return found


def motion_at(obstacle, count):
    """Way n x 3 and turn n x 3 x 3 of an obstacle at its times."""
    if not obstacle["motions"]:
        return np.zeros((count, 3)), np.broadcast_to(np.eye(3), (count, 3, 3))
    return tuple(np.array([motion[k] for motion in obstacle["motions"]]) for k in (0, 1))


def action(obstacle, history, name):
    """Per row of the history the place where the resultant acts [m]: in the world, and in the
    obstacle's frame at rest about its origin; NaN where the force is small or its line misses the
    obstacle."""
    columns = [[history[f"{name}_{what}_{axis}"] for axis in "xyz"] for what in ("force", "moment")]
    force, moment = (np.array(one, float).T for one in columns)
    way, turn = motion_at(obstacle, len(force))
    own_force, own_moment = (np.einsum("nji,nj->ni", turn, one) for one in (force, moment))
    origin = np.array(obstacle["origin"])
    points = np.array(obstacle["points"]) - origin
    at = entries(points, obstacle["faces"], foot(own_force, own_moment), own_force)
    size = np.linalg.norm(force, axis=1)
    at[size < LEAST * size.max(initial=0)] = np.nan
    return origin + way + np.einsum("nij,nj->ni", turn, at), at, force


def coordinates(obstacle, mean):
    """A function from places in an obstacle's frame to the map: along the plane [m], or the angle
    about a vertical axis from where the ice comes [degrees]; and height [m]."""
    origin = np.array(obstacle["origin"])
    if obstacle["plane"]:
        ring = np.array(obstacle["points"])
        along = ring[1] - ring[0]
        along /= np.linalg.norm(along)
        return lambda at: ((at + origin) @ along, at[..., 2] + origin[2])
    middle = np.mean(obstacle["points"], axis=0) - origin
    ahead = np.arctan2(-mean[1], -mean[0])

    def unrolled(at):
        angle = np.arctan2(at[..., 1] - middle[1], at[..., 0] - middle[0]) - ahead
        return np.degrees((angle + np.pi) % (2 * np.pi) - np.pi), at[..., 2] + origin[2]
    return unrolled


def areas(obstacle, coordinate, edges):
    """Area of the obstacle's surface in each cell of the map [m^2], by small triangles."""
    points = np.array(obstacle["points"]) - np.array(obstacle["origin"])
    i, j = np.mgrid[0:FINE, 0:FINE]
    inside, back = i + j < FINE, i + j < FINE - 1
    shares = np.concatenate([np.column_stack([i[inside] + 1 / 3, j[inside] + 1 / 3]),
                             np.column_stack([i[back] + 2 / 3, j[back] + 2 / 3])]) / FINE
    places, weights = [], []
    heights = edges[1][[0, -1]] - obstacle["origin"][2]
    for face in obstacle["faces"]:
        ring = clipped(points[face], [[0, 0, -1], [0, 0, 1]], [-heights[0], heights[1]])
        for k in range(1, len(ring) - 1):
            a, b, c = ring[[0, k, k + 1]]
            places.append(a + shares[:, :1] * (b - a) + shares[:, 1:] * (c - a))
            weights.append(np.full(len(shares),
                                   np.linalg.norm(np.cross(b - a, c - a)) / 2 / len(shares)))
    u, v = coordinate(np.concatenate(places))
    return np.histogram2d(v, u, bins=edges[::-1], weights=np.concatenate(weights))[0]


def pressure_map(output, history, name, start):
    """The map for the page: edges of cells, mean force over the time of rows after `start` per area
    of surface [kPa], share of the impulse that is on it. None without forces."""
    rows = np.flatnonzero(history["time"] >= start)
    table = {key: values[rows] for key, values in history.items()}
    low, high = output.box()
    low, high = low - 10, high + 10
    obstacle = next(o for o in obstacles_of_run(output, low, high, table["time"])
                    if o["name"] == name)
    _, at, force = action(obstacle, table, name)
    known, size = np.isfinite(at[:, 0]), np.linalg.norm(force, axis=1)
    if known.sum() < 5:
        return None
    coordinate = coordinates(obstacle, force.mean(axis=0))
    u, v = coordinate(at[known])
    edges = [edges_of(u, 0.5 if obstacle["plane"] else 5), edges_of(v, 0.2)]
    load = np.histogram2d(v, u, bins=edges[::-1], weights=size[known])[0] / len(size)
    area = areas(obstacle, coordinate, edges)
    with np.errstate(divide="ignore", invalid="ignore"):
        pressure = np.where(area > 0.02 * area.max(), load / area / 1000, np.nan)
    return {"edgesX": rounded(edges[0], 4), "edgesY": rounded(edges[1], 4),
            "values": [rounded(row, 3) for row in pressure], "plane": obstacle["plane"],
            "share": float(size[known].sum() / size.sum()), "rows": int(known.sum())}


def edges_of(values, least):
    """Edges of at most CELLS cells that hold 98 of 100 values, at least `least` wide."""
    low, high = np.quantile(values, [0.01, 0.99])
    width = max((high - low) / CELLS, least)
    first = np.floor(low / width)
    return width * np.arange(first, max(np.ceil(high / width), first + 1) + 1)
