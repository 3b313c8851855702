"""Obstacles of a scene as polyhedra, and where they are in time. SI units."""
import numpy as np
import scipy  # whose modules come when they are used

from floe.lattice import Shapes
from floe.results.output import Lattice, matrices


def numbers(options, key, default):
    """A key's numbers, or the default where it is not given."""
    text = options.get(key)
    return np.array([float(word) for word in text.replace(",", " ").split()] if text else default,
                    float)


def frustum(base, radius, top_radius, height, facets):
    """Points and faces of an upright frustum; one side faces along x."""
    angle = 2 * np.pi * (np.arange(facets) + 0.5) / facets
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([base + radius * ring, base + top_radius * ring + [0, 0, height]])
    k = np.arange(facets)
    sides = np.column_stack([k, (k + 1) % facets, (k + 1) % facets + facets, k + facets])
    return points, [list(face) for face in sides] + [list(k[::-1]), list(k + facets)]


def turned(degrees):
    """Matrix of rotations about x, then y, then z."""
    matrix = np.eye(3)
    for axis, angle in enumerate(np.radians(degrees)):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[i, i] = turn[j, j] = np.cos(angle)
        turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
        matrix = turn @ matrix
    return matrix


def box(centre, size, rotation):
    """Points and faces of a turned box."""
    shape = Shapes.boxes([size])
    ends, corners = shape.corner_of, shape.corners
    return (centre + shape.vertices @ turned(rotation).T,
            [list(corners[ends[f]:ends[f + 1]]) for f in range(len(ends) - 1)])


def plane(point, normal, low, high):
    """A half-space as the rectangle of its plane that spans the box low..high of what is drawn."""
    normal = normal / np.linalg.norm(normal)
    along = np.cross([0, 0, 1.0], normal)
    if np.linalg.norm(along) < 1e-9:
        along = np.array([1.0, 0, 0])
    along /= np.linalg.norm(along)
    up = np.cross(normal, along)
    middle = (low + high) / 2
    foot = point + (middle - point) - normal * np.dot(normal, middle - point)
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1])
                        for z in (low[2], high[2])])
    reach = [np.abs((corners - middle) @ axis).max() for axis in (along, up)]
    if abs(up[2]) > 1e-9:  # from the lowest point to the highest
        foot = foot + up * (middle[2] - foot[2]) / up[2]
        reach[1] = (high[2] - low[2]) / 2 / abs(up[2])
    sides = [foot + s * reach[0] * along + t * reach[1] * up
             for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.array(sides), [[0, 1, 2, 3]]


def about(vector):
    """Matrix of the rotation by |vector| about it."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


def placement(way, turn, origin):
    """Position and Orientation (VTK: degrees about x, y, z, in the order y, x, z) of what turns
    about its origin."""
    angles = np.arcsin(np.clip(turn[2, 1], -1,
                               1)), np.arctan2(-turn[2, 0],
                                               turn[2, 2]), np.arctan2(-turn[0, 1], turn[1, 1])
    return [(origin + way - turn @ origin).tolist(), np.degrees(angles).tolist()]


def columns_of_table(path):
    """The columns of a table in time by their names."""
    with open(path) as file:
        lines = [line.split("#")[0].replace(",", " ").replace(";", " ").split() for line in file]
    names, *rows = [line for line in lines if line]
    return dict(zip(names, np.array(rows, float).T))


def of_column(time, values, smooth, periodic):
    """The value of a column at any times, and its integral from time 0, as functions
    (docs/model.md, "Tables in time")."""
    first, last = time[0], time[-1]
    span, rows = last - first, (time, values)
    if periodic:  # slopes at the ends are those of the periods beside
        rows = (np.concatenate([time[:-1] - span, time, time[1:] + span]),
                np.concatenate([values[:-1], values, values[1:]]))
    curve = (scipy.interpolate.PchipInterpolator(*rows) if smooth else
             scipy.interpolate.make_interp_spline(*rows, k=1))
    area = curve.antiderivative()

    def value(at):
        return curve(first + (at - first) % span if periodic else np.clip(at, first, last))

    def sum_to(at):
        laps = np.floor((at - first) / span) if periodic else 0
        inside = np.clip(at - laps * span, first, last)
        beyond = 0 if periodic else value(at) * (at - inside)
        return area(inside) - area(first) + laps * (area(last) - area(first)) + beyond
    return value, lambda at: sum_to(at) - sum_to(np.zeros(1))


def motions_of_table(path, smooth, periodic, times):
    """As motions(), of an obstacle with a table."""
    columns, at = columns_of_table(path), np.asarray(times, float)
    parts = np.zeros((6, len(at)))
    for name, values in columns.items():
        if name == "time":
            continue
        value, integral = of_column(columns["time"], values, smooth, periodic)
        component = "xyz".index(name[1]) + 3 * (name[0] == "r")
        parts[component] = integral(at) if name[0] == "v" else value(at)
    return [(part[:3], about(part[3:])) for part in parts.T]


def motions(number, origin, times):
    """Where an obstacle is at these times, as [(way, turn)]: a point p of it is at origin + way +
    turn (p - origin) (docs/model.md, "Contact"); nothing if it rests."""
    velocity, spin, amplitude = (number(key, 0, 0, 0)
                                 for key in ("velocity", "angular_velocity", "amplitude"))
    if not (velocity.any() or spin.any() or amplitude.any()):
        return []
    ramp, frequency = number("ramp", 0)[0], number("frequency", 0)[0]
    found = []
    for time in times:
        risen = 1 if time >= ramp else time / ramp
        integral = time - ramp / 2 if time >= ramp else time * time / ramp / 2
        way = integral * velocity + risen * np.sin(2 * np.pi * frequency * time) * amplitude
        found.append((way, about(integral * spin)))
    return found


def obstacles(options, low, high, times, shapes=None):
    """Per obstacle of a scene: its points (at rest), faces, places at these times (see motions and
    placement), and whether it is a plane without an inside. low, high: a box, which planes span.
    shapes: output.Lattice.obstacles of a run, which has those of several parts and of files;
    runs before there were such have none."""
    found = []
    for name in options.get("obstacle_names", "").replace(",", " ").split():
        if f"obstacle_{name}_part_of" in options:
            continue

        def number(key, *default, name=name):
            return numbers(options, f"obstacle_{name}_{key}", default)
        shape = options[f"obstacle_{name}_shape"]
        if name in (shapes or {}):
            points, faces = shapes[name]["vertices"], faces_of(shapes[name])
        elif shape == "halfspace":
            points, faces = plane(number("point", 0, 0, 0), number("normal", 0, 0, 1), low, high)
        elif shape == "box":
            points, faces = box(number("centre", 0, 0, 0), number("size", 1, 1, 1),
                                number("rotation", 0, 0, 0))
        elif shape in ("cone", "cylinder"):
            radius = number("radius", 1)[0]
            top = radius if shape == "cylinder" else number("top_radius", 0)[0]
            points, faces = frustum(number("base", 0, 0, 0), radius, top, number("height", 1)[0],
                                    int(number("facets", 24)[0]))
        else:
            lattice = Lattice(options[f"obstacle_{name}_file"])
            points = lattice.shapes["vertices"] @ matrices(lattice.orientation[:1])[0].T
            points, faces = points + number("point", 0, 0, 0), faces_of(lattice.shapes)
        origin = number({"box": "centre", "cone": "base", "cylinder": "base"}.get(shape, "point"),
                        0, 0, 0)
        if f"obstacle_{name}_table" in options and len(times) > 0:
            ways = motions_of_table(
                options[f"obstacle_{name}_table"],
                options.get(f"obstacle_{name}_interpolation") == "smooth",
                options.get(f"obstacle_{name}_periodic") == "true", times)
        else:
            ways = motions(number, origin, times)
        found.append({"name": name,
                      "points": np.asarray(points).tolist(),
                      "faces": [[int(v) for v in face] for face in faces],
                      "motions": [(way.tolist(), turn.tolist()) for way, turn in ways],
                      "origin": origin.tolist(),
                      "placements": [placement(way, turn, origin) for way, turn in ways],
                      "plane": shape == "halfspace"})
    return found


def faces_of(shape):
    """Corners of the faces of a shape."""
    ends = shape["corner_of"]
    return [list(shape["corners"][ends[f]:ends[f + 1]]) for f in range(len(ends) - 1)]


def structures(options):
    """Names of the obstacles that are structures: those with a mass. They are the last bodies of
    the lattice, in this order."""
    return [name for name in options.get("obstacle_names", "").replace(",", " ").split()
            if f"obstacle_{name}_mass" in options]


def obstacles_of_run(output, low, high, times):
    """As obstacles(), of a run: structures are where its history has them, and their origin is
    their centre of mass, about which history.csv has moments."""
    options = output.options()
    found = obstacles(options, low, high, times, output.obstacles)
    names = structures(options)
    for body, name in enumerate(names, len(output.position) - len(names)):
        obstacle = next(o for o in found if o["name"] == name)
        centre = output.position[body]
        arm = numbers(options, f"obstacle_{name}_support_point", centre) - centre
        time = output.history("time")

        def at(what, time=time, name=name):
            return np.column_stack([np.interp(times, time, output.history(f"{name}_{what}{axis}"))
                                    for axis in "xyz"])
        turns = [about(vector) for vector in at("r")]
        ways = [shift - (turn @ arm - arm) for shift, turn in zip(at(""), turns)]
        obstacle.update(origin=centre.tolist(),
                        motions=[(way.tolist(), turn.tolist())
                                 for way, turn in zip(ways, turns)],
                        placements=[placement(way, turn, centre)
                                    for way, turn in zip(ways, turns)])
    return found
