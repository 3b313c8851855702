"""The scene of a run in three dimensions, as a report has it: bodies, their places at some frames,
cracks, obstacles, forces. SI units; whole numbers count steps that the scene states.

Places are about `origin`. Each body's corners, faces and orientation are those at rest, its pose at
a frame is a displacement of its centroid and a rotation vector from rest.
"""
import numpy as np

from floe.report.arrays import pack
from floe.report.cast import Cast
from floe.results import breakage
from floe.results.obstacles import obstacles_of_run, structures
from floe.results.output import matrices

FRAMES = 200             # at most, if not told otherwise
TRIANGLES = 1_800_000    # of bodies; cracks, obstacles and arrows have the rest of 2 million
TURN_STEP = 1e-3         # [rad]


def chosen(count, most):
    """Indices of at most `most` of `count` frames, the first and the last among them."""
    if count <= most:
        return np.arange(count)
    return np.unique(np.round(np.linspace(0, count - 1, max(2, most))).astype(int))


def triangles_of(shapes):
    """Triangles of each body's faces, as fans."""
    sides = np.diff(shapes["corner_of"]) - 2
    return np.add.reduceat(sides, shapes["face_of"][:-1])


def kept_bodies(cast, places):
    """Indices of the bodies that are shown: all but structures, which are shown as obstacles, or
    those nearest to obstacles where their triangles would be too many."""
    triangles = triangles_of(cast.ice.shapes)
    triangles = triangles[:len(triangles) - len(structures(cast.output.options()))]
    if triangles.sum() <= TRIANGLES:
        return np.arange(len(triangles))
    centres = np.array(places) if len(places) else cast.output.position.mean(axis=0)[None]
    order = np.argsort(cast.nearest(centres)[:len(triangles)], kind="stable")
    number = np.searchsorted(np.cumsum(triangles[order]), TRIANGLES, side="right")
    return np.sort(order[:number])


def size_of(output):
    """Median radius of the bodies [m]."""
    radius = np.linalg.norm(output.shapes["vertices"], axis=1)
    return float(np.median(np.maximum.reduceat(radius, output.shapes["vertex_of"][:-1])))


def step_of(size):
    """Step of lengths [m]: about a 1000th of a body's size, a whole number in the last place."""
    exact = size / 1000
    power = 10.0 ** np.floor(np.log10(exact))
    return float(power * max(s for s in (1, 2, 5) if s * power <= exact * (1 + 1e-9)))


def shapes_of(ice, bodies, step):
    """Corners at rest about each body's centroid, in the world's directions, and faces."""
    shapes, corners, sizes, faces, counts = ice.shapes, [], [], [], []
    turn = matrices(ice.orientation)
    for body in bodies:
        v = slice(*shapes["vertex_of"][body:body + 2])
        corners.append(shapes["vertices"][v] @ turn[body].T)
        first, last = shapes["face_of"][body:body + 2]
        ends = shapes["corner_of"][first:last + 1]
        sizes.append(np.diff(ends))
        faces.append(shapes["corners"][ends[0]:ends[-1]] - v.start)
        counts.append((v.stop - v.start, last - first))
    return {"corners": pack(np.rint(np.concatenate(corners) / step).astype(int).T),
            "counts": pack(np.array(counts).T), "sides": pack(np.concatenate(sizes)[None]),
            "faces": pack(np.concatenate(faces)[None])}


def poses_of(cast, bodies, places, step):
    """Displacements and rotation vectors of the bodies, frames x 6 x bodies, in steps. places: 3 x
    bodies, exact ones at rest, in steps; the displacements are from them rounded, so that places at
    a frame are right to half a step. A body that does not exist is where it was last, or will be
    first."""
    found = np.empty((len(cast.times), 6, len(bodies)), np.int64)
    present = np.zeros((len(cast.ice.position), 6))
    for k, time in enumerate(cast.times):
        values, rows = cast.values(time)
        present[rows] = values
        found[k, :3] = np.rint(places + present[bodies, :3].T / step) - np.rint(places)
        found[k, 3:] = np.rint(present[bodies, 3:].T / TURN_STEP)
    if cast.life is None:
        return found
    frame = np.maximum(np.arange(len(found))[:, None], cast.life[0, bodies])
    return np.take_along_axis(found, frame[:, None], axis=0)


def in_milliseconds(times):
    """-1: never."""
    return np.where(np.isnan(times), -1, np.rint(1000 * np.nan_to_num(times))).astype(int)


def beams_of(cast, bodies, breaks):
    """Beams between bodies that are shown: their ends, and the time of their break in ms (-1:
    none)."""
    pairs, ended = cast.beams(breaks)
    number = np.full(len(cast.ice.position), -1)
    number[bodies] = np.arange(len(bodies))
    ends = number[pairs]
    inside = np.all(ends >= 0, axis=1) if len(pairs) else np.zeros(0, bool)
    return pack(np.column_stack([ends, in_milliseconds(ended)])[inside].T)


def cracks_of(cast, bodies, breaks, step):
    """Faces of broken sections, each carried by a body that is shown: four corners about its
    centroid at rest, the body, and the time of the break in ms."""
    corners, carrier, ended = cast.cracks(breaks)
    if not len(corners):
        return {"corners": pack(np.zeros((1, 0))), "of": pack(np.zeros((2, 0)))}
    number = np.full(len(cast.ice.position) + 1, -1)  # the last: of what is not in the cast
    number[bodies] = np.arange(len(bodies))
    shown = number[carrier] >= 0
    return {"corners": pack(np.rint(corners[shown] / step).astype(int).reshape(1, -1)),
            "of": pack(np.column_stack([number[carrier], in_milliseconds(ended)])[shown].T)}


def obstacles_of(output, times):
    """Obstacles as polyhedra, with their places at these times; planes reach 2 m above and below
    the ice."""
    if not len(times) or not output.shapes:
        return []
    places = [output.at(t).position + output.field("bodies_displacement", t)
              for t in (times[0], times[-1])]
    room = 2 * size_of(output)
    low = np.min([p.min(axis=0) for p in places], axis=0) - [room, room, 2]
    high = np.max([p.max(axis=0) for p in places], axis=0) + [room, room, 2]
    return obstacles_of_run(output, low, high, times)


def about_origin(obstacle, origin):
    """What the page needs of an obstacle: moving ones turn about their own origin."""
    own = np.array(obstacle["origin"])
    return {"name": obstacle["name"], "plane": obstacle["plane"],
            "points": np.round(np.array(obstacle["points"]) - own, 4).tolist(),
            "faces": obstacle["faces"], "origin": np.round(own - origin, 4).tolist(),
            "motions": [[np.round(way, 4).tolist(), np.round(turn, 5).tolist()]
                        for way, turn in obstacle["motions"]]}


def scene_of(output, forces, most):
    """The scene for the page, None without shapes or frames. forces: [{"name", "kind", "at",
    "force"}] at all frames (see arrows_of); most: the most frames."""
    if not len(output.times) or not output.shapes:
        return None  # no frame yet; a lattice file without shapes
    frames = chosen(len(output.times), most)
    times = output.times[frames]
    around = obstacles_of(output, times)
    cast = Cast(output, frames)
    ice = cast.ice
    bodies = kept_bodies(cast, [np.mean(o["points"], axis=0) for o in around])
    size = size_of(output)
    step = step_of(size)
    # about the first ice where more joins, which lies ever farther away at rest
    middle = output.position if cast.life is not None else ice.position[bodies]
    origin = np.round(middle.mean(axis=0), 3)
    places = (ice.position[bodies] - origin).T / step
    breaks = breakage.at_end(output)
    options, levels = output.options(), output.water_levels(times)
    of_bodies = len(ice.position) - len(structures(options))
    are_all = len(bodies) == of_bodies and cast.life is None
    return {
        "bodies": len(bodies), "of_bodies": of_bodies, "size": size,
        "step": step, "turn_step": TURN_STEP, "origin": origin.tolist(),
        "times": [round(float(t), 6) for t in times], "of_frames": len(output.times),
        "water": "buoyancy" in options.get("forces", ""),
        "levels": None if levels is None else np.round(levels - origin[2], 4).tolist(),
        "current": [float(v) for v in options.get("water_current", "0, 0, 0").split(",")],
        "ids": None if are_all else pack(ice.names[bodies][None]),
        "life": None if cast.life is None else pack(cast.life[:, bodies]),
        "places": pack(np.rint(places).astype(int)),
        "masses": [float(f"{m:.5g}") for m in ice.mass[bodies]],
        **shapes_of(ice, bodies, step),
        "poses": pack(poses_of(cast, bodies, places, step)),
        "beams": beams_of(cast, bodies, breaks),
        "cracks": cracks_of(cast, bodies, breaks, step),
        "obstacles": [about_origin(o, origin) for o in around],
        "arrows": arrows_of(forces, frames, origin),
    }


def arrows_of(forces, frames, origin):
    """Force arrows at the chosen frames: [{"name", "kind", "force" [N], "at" [m] or None}]."""
    found = []
    for one in forces:
        at = [None if p is None else np.round(p - origin, 3).tolist()
              for p in (one["at"][k] for k in frames)]
        found.append({"name": one["name"], "kind": one["kind"], "at": at,
                      "force": [[float(f"{v:.4g}") for v in one["force"][k]] for k in frames]})
    return found
