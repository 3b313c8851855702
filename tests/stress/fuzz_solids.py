"""Closed surfaces to try, as STL and OBJ files: solids of many shapes, with faults of which each
has one right answer, and files that are damaged."""
import math

import numpy as np

from fuzz_files import flipped
from fuzz_outlines import HOSTILE

SCENE = ("integrator: explicit\nforces: [contact]\nlattice_file: block.h5\n"
         "contact: {young: 1e7}\nobstacle: {names: [o], o: {shape: file, file: FILE, "
         "point: [200, 0, 0]WORDS}}\ntime: {end: 1}\n")
# Seen from outside a corner of a box's faces is left of the one before.
BOX = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def prism(ring, low, high):
    """Points and faces of the prism over a counter-clockwise ring, whose ends are fans about its
    first corner."""
    n = len(ring)
    points = [[x, y, z] for z in (low, high) for x, y in ring]
    sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    return points, [[n - 1 - k for k in range(n)], [n + k for k in range(n)], *sides]


def box(size=(1, 1, 1)):
    points = [[size[0] * (k & 1), size[1] * (k >> 1 & 1), size[2] * (k >> 2)] for k in range(8)]
    return points, [list(face) for face in BOX]


def ring_of(count, radius, rough, chance):
    turn, ring = chance.uniform(0, 1), []
    for k in range(count):
        far = radius * (1 + rough * chance.uniform(-1, 1))
        angle = 2 * math.pi * (k + turn) / count
        ring.append([far * math.cos(angle), far * math.sin(angle)])
    return ring


def torus(major, minor, around, across):
    points = [[(major + minor * math.cos(b)) * math.cos(a), (major + minor * math.cos(b))
               * math.sin(a), minor * math.sin(b)]
              for a in (2 * math.pi * i / around for i in range(around))
              for b in (2 * math.pi * j / across for j in range(across))]
    faces = []
    for i in range(around):
        for j in range(across):
            ahead, up = (i + 1) % around, (j + 1) % across
            faces.append([i * across + j, ahead * across + j, ahead * across + up,
                          i * across + up])
    return points, faces


def solid(chance):
    """Points [n, 3] and faces of a solid of one closed surface; a star-shaped polygon's ends are
    one concave face each, as OBJ files have."""
    way = chance.randrange(6)
    if way == 0:
        points, faces = box([chance.uniform(0.2, 3) for _ in range(3)])
    elif way == 1:
        points, faces = prism(ring_of(chance.choice((3, 4, 7, 20)), 1, 0, chance), -1,
                              chance.uniform(-0.5, 3))
    elif way == 2:  # concave
        points, faces = prism(ring_of(chance.choice((5, 6, 9)), 1, 0.4, chance), 0, 1)
    elif way == 3:  # an L
        points, faces = prism([[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [0, 2]], 0, 1)
    elif way == 4:
        points, faces = torus(2, chance.uniform(0.3, 1), chance.choice((3, 4, 6)),
                              chance.choice((3, 4)))
    else:  # a tetrahedron
        points = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, chance.uniform(0.1, 3)]]
        faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    return np.array(points, float), faces


def turned(points, chance):
    """Points turned at random about the origin, and shifted."""
    q, r = np.linalg.qr(np.array([[chance.gauss(0, 1) for _ in range(3)] for _ in range(3)]))
    q = q * np.sign(np.diag(r))
    if np.linalg.det(q) < 0:
        q[:, 0] *= -1
    return points @ q.T + [chance.uniform(-5, 5) for _ in range(3)]


def ears(points, face):
    """A polygon's triangles, by cutting ears; of a convex or a simple concave face."""
    face, found = list(face), []
    corners = np.array([points[k] for k in face])
    normal = sum(np.cross(corners[k] - corners[0], corners[k + 1] - corners[0])
                 for k in range(1, len(face) - 1))
    while len(face) > 3:
        for k in range(len(face)):
            a, b, c = (points[face[(k + i - 1) % len(face)]] for i in range(3))
            inside = [p for p in face if p not in (face[k - 1], face[k], face[(k + 1) % len(face)])
                      and all(np.dot(normal, np.cross(v - u, points[p] - u)) >= 0
                              for u, v in ((a, b), (b, c), (c, a)))]
            if np.dot(normal, np.cross(b - a, c - b)) > 0 and not inside:
                found.append([face[k - 1], face[k], face[(k + 1) % len(face)]])
                del face[k]
                break
        else:
            break
    return [*found, face]


def volume(points, triangles):
    p = np.array([[points[k] for k in t] for t in triangles])
    return np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6


def spoil(points, triangles, chance):
    """Puts one fault into a good surface; returns what it then is, and the exit code that must
    come of it, or None where either may."""
    points, triangles = [list(p) for p in points], [list(t) for t in triangles]
    at, n = chance.randrange(len(triangles)), len(points)
    way = chance.randrange(13)
    refused = 2
    if way == 0:
        del triangles[at]  # a hole
    elif way == 1:
        triangles[at].reverse()
    elif way == 2:
        triangles.append(list(triangles[at]))
    elif way == 3:
        triangles = [t[::-1] for t in triangles]  # inside out
    elif way == 4:
        points[triangles[at][0]] = list(points[triangles[at][1]])  # no area
    elif way == 5:
        points[triangles[at][0]][chance.randrange(3)] = chance.choice(
            (math.nan, math.inf, -math.inf, 1e38))
    elif way == 6:  # the same solid inside itself, about its first corner's inner side
        inner = np.array(points).mean(axis=0)
        points += [list(inner + 0.01 * (np.array(p) - inner)) for p in points]
        triangles += [[n + k for k in t] for t in triangles]
        refused = None  # beside a concave solid it may lie outside
    elif way == 7:  # two apart
        far = np.ptp(np.array(points), axis=0)[0] * 1.5 + 1
        points += [[x + far, y, z] for x, y, z in points]
        triangles += [[n + k for k in t] for t in triangles]
        refused = 0
    elif way == 8:  # two that overlap
        points += [[x + 0.01, y + 0.02, z + 0.01] for x, y, z in points]
        triangles += [[n + k for k in t] for t in triangles]
    elif way == 9:  # the same twice
        points += [list(p) for p in points]
        triangles += [[n + k for k in t] for t in triangles]
    elif way == 10:  # a point pulled through the solid
        k = chance.randrange(n)
        points[k] = list(3 * np.array(points).mean(axis=0) - 2 * np.array(points[k]))
        refused = None
    elif way == 11:
        scale = chance.choice((1e-30, 1e-12, 1e-5, 1e4, 1e8, 1e20))
        points = [[scale * x for x in p] for p in points]
        refused = None
    else:
        shift = chance.choice((1e4, 1e7, 1e8))  # beyond the digits of a 32-bit number
        points = [[p[0] + shift, *p[1:]] for p in points]
        refused = None
    return points, triangles, refused


def as_stl(points, triangles, chance):
    """A binary or text STL file; normals are not read, and may be wrong."""
    with np.errstate(over="ignore"):
        corners = np.array([[points[k] for k in t] for t in triangles], np.float32)
    if chance.random() < 0.5:
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
        rows = np.zeros(len(corners), record)
        rows["corners"] = corners
        head = chance.choice((b"", b"solid", b"made by a test")).ljust(80, chance.choice(
            (b" ", b"\0")))
        return head + len(rows).to_bytes(4, "little") + rows.tobytes()
    lines = ["solid made by a test"]
    for t in corners:
        lines += ["  facet normal 0 0 0", "    outer loop",
                  *(f"      vertex {x!r} {y!r} {z!r}" for x, y, z in t.tolist()), "    endloop",
                  "  endfacet"]
    return "\n".join([*lines, "endsolid made by a test\n"]).encode()


def as_obj(points, faces, chance):
    """An OBJ file: corners by numbers from 1 or from the end, with or without others."""
    lines = ["# made by a test", "o thing"] if chance.random() < 0.5 else []
    lines += ["v " + " ".join(repr(float(x)) for x in p) for p in points]
    ending = chance.choice(("", "/1", "//1", "/1/1"))
    if ending:
        lines += ["vt 0 0", "vn 0 0 1"]
    back = chance.random() < 0.3
    for face in faces:
        lines.append("f " + " ".join(str(k - len(points) if back else k + 1) + ending
                                     for k in face))
    return ("\n".join(lines) + "\n").encode()


def damaged(data, chance):
    """Bytes of a file of which a number, a letter or a part is spoilt."""
    way = chance.randrange(5)
    if way <= 1 and b"\0" not in data:
        text = data.decode()
        places = [k for k, letter in enumerate(text) if letter.isdigit() and not
                  text[k - 1].isalnum()]
        if places:
            at = end = chance.choice(places)
            while end < len(text) and (text[end].isdigit() or text[end] in ".e-+"):
                end += 1
            return (text[:at] + chance.choice((*HOSTILE, "-1", "999999999999", "1//", "%s"))
                    + text[end:]).encode()
    if way == 2:
        return data[:chance.randrange(len(data) + 1)]
    if way == 3:
        return chance.choice((b"", b"solid\n", b"solid x\nendsolid x\n", b"\0" * 84,
                              b"\xff" * 134, b"f 1 2 3\n", b"v 0 0 0\n" * 5,
                              b"v 0 0 0\nf 1 1 1\n", b"\xef\xbb\xbf" + data,
                              data * 2, b"x" * 2000000, data.replace(b"\n", b"\r\n"),
                              data.replace(b"f ", b"p "), data[:-1]))
    return flipped(data, chance)


def case(chance):
    """A scene, the name and the bytes of its solid's file, the exit code that must come of it or
    None, and the solid's volume [m^3] where it must be taken, or None."""
    points, faces = solid(chance)
    if chance.random() < 0.6:
        points = turned(points, chance)
    points = points.astype(np.float32).astype(float)
    triangles = [t for face in faces for t in ears(points, face)]
    good = volume(points, triangles)
    must, is_obj = 0, chance.random() < 0.4
    whole = is_obj and chance.random() < 0.5  # polygons, not triangles
    if chance.random() < 0.45:
        points, triangles, must = spoil(points, triangles, chance)
        whole, good = False, good * (2 if must == 0 else 1)
    shapes = faces if whole else triangles
    if is_obj:
        data, name = as_obj(points, shapes, chance), chance.choice(("o.obj", "o.OBJ"))
    else:
        data, name = as_stl(points, triangles, chance), chance.choice(("o.stl", "o.Stl"))
    if whole and must == 0:
        must = None  # corners of a polygon leave its plane by rounding
    words, scale = "", 1
    for key, values in (("tolerance", (0, 1e-6, 0.05, 1, 1e6)), ("most_parts", (1, 2, 1000)),
                        ("unit", (0.01, 1, 39.37, 1e6))):
        if chance.random() < 0.2:
            value = chance.choice(values)
            words += f", {key}: {value}"
            if key == "unit":
                scale = value
            must = 2 if must == 2 else None
    if chance.random() < 0.3:
        data, must = damaged(data, chance), None
    scene = SCENE.replace("FILE", name).replace("WORDS", words)
    return scene, name, data, must, good * scale ** 3 if must == 0 else None
