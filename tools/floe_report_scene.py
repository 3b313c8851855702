"""The scene of a run in three dimensions, as a report has it: bodies, their places at some frames,
cracks, obstacles, forces. SI units; whole numbers count steps that the scene states.

Places are about `origin`. Each body's corners, faces and orientation are those at rest, its pose at
a frame is a displacement of its centroid and a rotation vector from rest.
"""
import h5py
import numpy as np

from floe_obstacles import obstacles
from floe_output import frames_of, matrices
from floe_program import reading
from floe_report_arrays import pack

FRAMES = 200             # at most, if not told otherwise
TRIANGLES = 1_800_000    # of bodies; cracks, obstacles and arrows have the rest of 2 million
TURN_STEP = 1e-3         # [rad]


def rotations(vectors):
    """Rotation matrices n x 3 x 3 of rotation vectors n x 3."""
    angle = np.linalg.norm(vectors, axis=1)
    half = np.sinc(angle / 2 / np.pi) / 2  # sin(angle/2)/angle
    return matrices(np.column_stack([np.cos(angle / 2), vectors * half[:, None]]))


def chosen(count, most):
    """Indices of at most `most` of `count` frames, the first and the last among them."""
    if count <= most:
        return np.arange(count)
    return np.unique(np.round(np.linspace(0, count - 1, max(2, most))).astype(int))


def triangles_of(shapes):
    """Triangles of each body's faces, as fans."""
    sides = np.diff(shapes["corner_of"]) - 2
    return np.add.reduceat(sides, shapes["face_of"][:-1])


def kept_bodies(output, places):
    """Indices of the bodies that are shown: all, or those nearest to obstacles where their
    triangles would be too many."""
    triangles = triangles_of(output.shapes)
    if triangles.sum() <= TRIANGLES:
        return np.arange(len(triangles))
    centres = np.array(places) if len(places) else output.position.mean(axis=0)[None]
    distance = np.min([np.linalg.norm(output.position - c, axis=1) for c in centres], axis=0)
    order = np.argsort(distance, kind="stable")
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


def shapes_of(output, bodies, step):
    """Corners at rest about each body's centroid, in the world's directions, and faces."""
    shapes, corners, sizes, faces, counts = output.shapes, [], [], [], []
    turn = matrices(output.orientation)
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


def poses_of(output, bodies, frames, places, step):
    """Displacements and rotation vectors of the bodies, frames x 6 x bodies, in steps. places: 3 x
    bodies, exact ones at rest, in steps; the displacements are from them rounded, so that places at
    a frame are right to half a step."""
    found = np.empty((len(frames), 6, len(bodies)), np.int64)
    for k, time in enumerate(output.times[frames]):
        moved = places + output.field("bodies_displacement", time)[bodies].T / step
        found[k, :3] = np.rint(moved) - np.rint(places)
        found[k, 3:] = np.rint(output.field("bodies_rotation", time)[bodies].T / TURN_STEP)
    return found


def beams_of(output, bodies, breaks):
    """Beams between bodies that are shown: their ends, and the time of their break in ms (-1:
    none)."""
    pairs = output.beams.get("bodies", np.zeros((0, 2), int)).astype(int)
    number = np.full(len(output.position), -1)
    number[bodies] = np.arange(len(bodies))
    ended = np.full(len(pairs), -1, int)
    if breaks:
        ended[breaks["beam"]] = np.rint(1000 * breaks["time"]).astype(int)
    ends = number[pairs]
    inside = np.all(ends >= 0, axis=1) if len(pairs) else np.zeros(0, bool)
    return pack(np.column_stack([ends, ended])[inside].T)


def breaks_of(folder):
    """breaks.h5, or nothing if nothing could break or has."""
    path = folder / "breaks.h5"
    if not path.exists():
        return {}
    with reading(path), h5py.File(path) as file:
        names = ("time", "beam", "fragments/of_body", "fragments/mass", "fragments/bodies")
        return {name: file[name][:] for name in names}


def cracks_of(output, bodies, breaks, step):
    """Faces of broken sections, each carried by a body that is shown: four corners about its
    centroid at rest, the body, and the time of the break in ms."""
    none = {"corners": pack(np.zeros((1, 0))), "of": pack(np.zeros((2, 0)))}
    frames = frames_of(output.folder)
    if not breaks or not len(breaks["beam"]) or not frames:
        return none
    _, path, group = frames[-1]
    with reading(path), h5py.File(path) as file:
        if "cracks" not in file[group]:
            return none
        beam, faces, points, shift, turn = (file[group][name][:] for name in (
            "crack_beam", "cracks", "crack_points", "bodies_displacement", "bodies_rotation"))
    # two faces per broken beam, the first of its first body
    carrier = output.beams["bodies"][beam, np.arange(len(beam)) % 2].astype(int)
    place = output.position[carrier] + shift[carrier]
    about = points[faces] - place[:, None]
    corners = np.einsum("fij,fki->fkj", rotations(turn[carrier]), about)  # turned back
    time = dict(zip(breaks["beam"].tolist(), breaks["time"]))
    number = np.full(len(output.position), -1)
    number[bodies] = np.arange(len(bodies))
    shown = number[carrier] >= 0
    ended = np.array([1000 * time.get(b, 0) for b in beam.tolist()])
    return {"corners": pack(np.rint(corners[shown] / step).astype(int).reshape(1, -1)),
            "of": pack(np.rint(np.column_stack([number[carrier], ended])[shown]).astype(int).T)}


def obstacles_of(output, times):
    """Obstacles as polyhedra, with their places at these times; planes reach 2 m above and below
    the ice."""
    if not len(times) or not output.shapes:
        return []
    places = [output.position + output.field("bodies_displacement", t)
              for t in (times[0], times[-1])]
    room = 2 * size_of(output)
    low = np.min([p.min(axis=0) for p in places], axis=0) - [room, room, 2]
    high = np.max([p.max(axis=0) for p in places], axis=0) + [room, room, 2]
    return obstacles(output.options(), low, high, times)


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
    bodies = kept_bodies(output, [np.mean(o["points"], axis=0) for o in around])
    size = size_of(output)
    step, origin = step_of(size), np.round(output.position[bodies].mean(axis=0), 3)
    places = (output.position[bodies] - origin).T / step
    breaks = breaks_of(output.folder)
    options = output.options()
    return {
        "bodies": len(bodies), "of_bodies": len(output.position), "size": size,
        "step": step, "turn_step": TURN_STEP, "origin": origin.tolist(),
        "times": [round(float(t), 6) for t in times], "of_frames": len(output.times),
        "water": "buoyancy" in options.get("forces", ""),
        "current": [float(v) for v in options.get("water_current", "0, 0, 0").split(",")],
        "ids": None if len(bodies) == len(output.position) else pack(bodies[None]),
        "places": pack(np.rint(places).astype(int)),
        "masses": [float(f"{m:.5g}") for m in output.mass[bodies]],
        **shapes_of(output, bodies, step),
        "poses": pack(poses_of(output, bodies, frames, places, step)),
        "beams": beams_of(output, bodies, breaks),
        "cracks": cracks_of(output, bodies, breaks, step),
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
