"""The ice that exists in a frame of a run in which ice joins and leaves (docs/model.md, "Ice
without end"): bodies, beams, shapes and sets at rest, from the mesh of the frame and the frame
itself. SI units.

Such a sheet is of prisms of one thickness, and each beam has the section of the facet between its
bodies, so all that lattice.h5 has of the first bodies follows for later ones.
"""
import numpy as np

CHUNK = 50_000  # beams whose facets are found together


def shapes_of(topology, body):
    """Faces of bodies, as lattice.h5 has them, without the vertices: {"corners", "corner_of",
    "face_of", "vertex_of"}. topology: XDMF mixed, polygons only; body: of each face."""
    sides, at = np.empty(len(body), np.int64), 0
    for face in range(len(body)):
        sides[face] = topology[at + 1]
        at += sides[face] + 2
    corner_of = np.concatenate([[0], np.cumsum(sides)])
    no_corner = corner_of[:-1] + 2 * np.arange(len(body))
    corners = np.delete(topology, np.concatenate([no_corner, no_corner + 1]))
    face_of = np.searchsorted(body, np.arange(body[-1] + 2))
    highest = np.maximum.reduceat(corners, corner_of[face_of[:-1]])
    return {"corners": corners, "corner_of": corner_of, "face_of": face_of,
            "vertex_of": np.concatenate([[0], highest + 1])}


def area_vectors(points, shapes):
    """Area vector of each face [m^2] (Newell's method)."""
    corners, corner_of = shapes["corners"], shapes["corner_of"]
    following = np.arange(1, len(corners) + 1)
    following[corner_of[1:] - 1] = corner_of[:-1]
    p = points[corners]
    return np.add.reduceat(np.cross(p, p[following]), corner_of[:-1]) / 2


def volumes(shapes):
    """Volume of each body [m^3] by the divergence theorem."""
    first = shapes["vertices"][shapes["corners"][shapes["corner_of"][:-1]]]
    of_faces = np.einsum("fi,fi->f", area_vectors(shapes["vertices"], shapes), first) / 3
    return np.add.reduceat(of_faces, shapes["face_of"][:-1])


class Edges:
    """Sides of the bodies seen from above, at rest, body after body. ends e x 2 x 2 [m], body e,
    first n + 1: of each body."""

    def __init__(self, position, shapes):
        bodies = np.arange(len(position))
        upward = area_vectors(shapes["vertices"], shapes)[:, 2]
        of_face = np.repeat(bodies, np.diff(shapes["face_of"]))
        top = np.lexsort((upward, of_face))[shapes["face_of"][1:] - 1]
        first, last = shapes["corner_of"][top], shapes["corner_of"][top + 1]
        self.first = np.concatenate([[0], np.cumsum(last - first)])
        self.body = np.repeat(bodies, last - first)
        corner = np.arange(self.first[-1]) + (first - self.first[:-1])[self.body]
        following = corner + 1
        following[self.first[1:] - 1] = first
        placed = shapes["vertices"][shapes["corners"], :2]
        self.ends = np.stack([placed[corner], placed[following]], axis=1)
        self.ends += position[self.body, None, :2]
        self.middle = self.ends.mean(axis=1)
        self.length = np.linalg.norm(self.ends[:, 1] - self.ends[:, 0], axis=1)

    def common(self, pairs):
        """Edges of the first and of the second body of each pair that are the same side: those
        whose middles are nearest to each other."""
        found = [self._common(pairs[k:k + CHUNK]) for k in range(0, len(pairs), CHUNK)]
        return np.concatenate([np.zeros((0, 2), int), *found])

    def _common(self, pairs):
        count = np.diff(self.first)[pairs]
        number = count.prod(axis=1)
        begin = np.concatenate([[0], np.cumsum(number)])
        pair = np.repeat(np.arange(len(pairs)), number)
        i, j = np.divmod(np.arange(begin[-1]) - begin[pair], count[pair, 1])
        i, j = i + self.first[pairs[pair, 0]], j + self.first[pairs[pair, 1]]
        distance = np.linalg.norm(self.middle[i] - self.middle[j], axis=1)
        order = np.lexsort((distance, pair))
        best = order[begin[:-1]]
        return np.column_stack([i[best], j[best]])


def beams_of(position, shapes, pairs, edges, joint):
    """Beams as lattice.h5 has them: their bodies and what follows from their facets."""
    z = shapes["vertices"][:, 2]
    thickness = (np.maximum.reduceat(z, shapes["vertex_of"][:-1])
                 - np.minimum.reduceat(z, shapes["vertex_of"][:-1]))
    width, height = edges.length[joint[:, 0]], thickness[pairs[:, 0]]
    chord = position[pairs[:, 1]] - position[pairs[:, 0]]
    length = np.hypot(chord[:, 0], chord[:, 1])
    return {"bodies": pairs, "width": width, "height": height, "area": width * height,
            "inertia_y": width * height**3 / 12, "inertia_z": height * width**3 / 12,
            "length": length, "axis_y": np.column_stack([-chord[:, 1], chord[:, 0], 0 * length])
            / length[:, None]}


def sets_of(names, edges, joint, each, sheet):
    """Bodies at the sides of the sheet. left: at the far edge, those of the last strip with a side
    that no other body has, on its half towards the next one. each: cells of a strip; sheet:
    (length, width, strip) [m]."""
    length, width, strip = sheet

    def on_line(axis, place):
        there = np.all(np.abs(edges.ends[:, :, axis] - place) < 1e-9 * (length + width), axis=1)
        return np.unique(edges.body[there]), there
    (right, _), (bottom, low), (top, high) = (on_line(0, length / 2), on_line(1, -width / 2),
                                              on_line(1, width / 2))
    last = names[-1] // each
    is_open = ~(low | high)
    is_open[joint.ravel()] = False
    is_open &= names[edges.body] // each == last
    is_open &= edges.middle[:, 0] < length / 2 - (last + 0.5) * strip
    is_open &= edges.length > 1e-6 * np.mean(edges.length)
    return {"left": np.unique(edges.body[is_open]), "right": right, "bottom": bottom, "top": top}


def ice_of(mesh, frame, turns, first, options):
    """The ice of a frame as {name: arrays} of output.Lattice, with the bodies' own axes along
    the world's at rest. mesh, frame: groups of HDF5; turns: rotation matrices of the bodies; first:
    number of bodies in lattice.h5; options: of the run."""
    names, pairs = mesh["name"][:].astype(np.int64), mesh["beams"][:].astype(np.int64)
    centres = frame["centres"][:]
    position = centres - frame["bodies_displacement"][:]
    shapes = shapes_of(mesh["topology"][:].astype(np.int64), mesh["body"][:].astype(np.int64))
    body = np.repeat(np.arange(len(names)), np.diff(shapes["vertex_of"]))
    shapes["vertices"] = np.einsum("vji,vj->vi", turns[body], frame["points"][:] - centres[body])
    edges = Edges(position, shapes)
    joint = edges.common(pairs)
    sheet = [float(options[key]) for key in ("sheet_length", "sheet_width", "supply_strip")]
    each = first // round(sheet[0] / sheet[2])
    orientation = np.zeros((len(names), 4))
    orientation[:, 0] = 1
    return {"names": names, "position": position, "orientation": orientation,
            "mass": float(options["ice_density"]) * volumes(shapes), "shapes": shapes,
            "beams": beams_of(position, shapes, pairs, edges, joint),
            "sets": sets_of(names, edges, joint, each, sheet)}
