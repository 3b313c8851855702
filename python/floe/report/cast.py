"""The bodies, beams and cracks that a report's scene shows: those of the run, or, where ice joins
and leaves, of all its frames together, each with the frames between which it exists. SI units.
"""
import numpy as np

from floe.results import breakage
from floe.results.output import Present, rotations

NO_CRACKS = np.zeros((0, 4, 3)), np.zeros(0, int), np.zeros(0)


def tail(ice, body):
    """The bodies from number `body` on, without beams, as arrays of a lattice."""
    shapes = ice.shapes
    face, vertex = shapes["face_of"][body], shapes["vertex_of"][body]
    corner = shapes["corner_of"][face]
    return {"names": ice.names[body:], "position": ice.position[body:], "mass": ice.mass[body:],
            "orientation": ice.orientation[body:], "shapes": {
                "vertices": shapes["vertices"][vertex:],
                "corners": shapes["corners"][corner:] - vertex,
                "corner_of": shapes["corner_of"][face:] - corner,
                "face_of": shapes["face_of"][body:] - face,
                "vertex_of": shapes["vertex_of"][body:] - vertex}}


def with_more(arrays, more):
    """Bodies and more bodies, one after another."""
    found = {name: np.concatenate([arrays[name], more[name]])
             for name in ("names", "position", "mass", "orientation")}
    a, b = arrays["shapes"], more["shapes"]
    found["shapes"] = {name: np.concatenate([a[name], b[name][1:] + a[name][-1]])
                       for name in ("corner_of", "face_of", "vertex_of")}
    found["shapes"]["vertices"] = np.concatenate([a["vertices"], b["vertices"]])
    found["shapes"]["corners"] = np.concatenate([a["corners"],
                                                 b["corners"] + len(a["vertices"])])
    return found


class Cast:
    """Bodies of the chosen frames, a lattice `ice`, in the order of their names. life: 2 x n, the
    first and the last of the chosen frames with each; None if all are in all."""

    def __init__(self, output, frames):
        self.output, self.times = output, output.times[frames]
        self.ice, self.life = output, None
        if output.changes:
            self.gather()

    def gather(self):
        """Names grow from strip to strip, so bodies that have joined are the last of a frame."""
        ice = self.output.at(self.times[0])
        arrays = tail(ice, 0)
        for time in self.times[1:]:
            ice = self.output.at(time)
            more = np.searchsorted(ice.names, arrays["names"][-1], side="right")
            if more < len(ice.names):
                arrays = with_more(arrays, tail(ice, more))
        self.ice = Present(arrays)
        self.life = np.full((2, len(self.ice.names)), -1)
        for k, time in enumerate(self.times):
            rows = self.rows(time)
            self.life[1, rows] = k
            self.life[0, rows[self.life[0, rows] < 0]] = k

    def rows(self, time):
        """Which bodies those of the frame at `time` are."""
        if self.life is None:
            return np.arange(len(self.ice.names))
        return np.searchsorted(self.ice.names, self.output.at(time).names)

    def numbers(self, names):
        """Numbers of bodies by their names; -1: none."""
        at = np.minimum(np.searchsorted(self.ice.names, names), len(self.ice.names) - 1)
        return np.where(self.ice.names[at] == names, at, -1)

    def nearest(self, centres):
        """Least distance of each body to one of the centres [m]: at rest, or in any frame."""
        if self.life is None:
            return np.min([np.linalg.norm(self.ice.position - c, axis=1) for c in centres], axis=0)
        found = np.full(len(self.ice.names), np.inf)
        for time in self.times:
            rows, places = self.rows(time), self.output.field("centres", time)
            for c in centres:
                found[rows] = np.minimum(found[rows], np.linalg.norm(places - c, axis=1))
        return found

    def values(self, time):
        """Displacements and rotation vectors, bodies x 6, and the bodies that have them."""
        return np.hstack([self.output.field("bodies_displacement", time),
                          self.output.field("bodies_rotation", time)]), self.rows(time)

    def beams(self, breaks):
        """Bodies m x 2 of the beams and the times of their breaks [s], nan: none. breaks: of the
        end of the run."""
        if self.life is None:
            pairs = self.output.beams.get("bodies", np.zeros((0, 2), int)).astype(int)
            ended = np.full(len(pairs), np.nan)
            if breaks:
                ended[breaks["beam"]] = breaks["time"]
            return pairs, ended
        found = [self.output.beam_names(time) for time in self.times]
        _, first = np.unique(breakage.keys(np.concatenate(found)), return_index=True)
        pairs = np.concatenate(found)[first]
        return self.numbers(pairs), breakage.times_of(self.output).of(pairs)

    def cracks(self, breaks):
        """Faces of broken sections: corners k x 4 x 3 [m] about the centroid at rest of the body
        that carries each, that body (-1: not in the cast) and the time of the break [s]."""
        output = self.output
        if not breaks or not len(output.times):
            return NO_CRACKS
        if self.life is None:
            corners, carrier, beam = faces_of(output, output.times[-1])
            time = dict(zip(breaks["beam"].tolist(), breaks["time"]))
            return corners, carrier, np.array([time.get(b, 0) for b in beam.tolist()])
        times, parts = breakage.times_of(output), []
        for time in output.times[output.last_frames()]:
            corners, carrier, beam = faces_of(output, time)
            names = output.beam_names(time)[beam]
            key = np.column_stack([names, np.arange(len(beam)) % 2])
            parts.append((key, corners, output.at(time).names[carrier], times.of(names)))
        key, corners, carrier, when = (np.concatenate(each) for each in zip(*parts))
        _, first = np.unique(key, axis=0, return_index=True)
        return corners[first], self.numbers(carrier[first]), when[first]


def faces_of(output, time):
    """Faces of the broken sections of a frame: corners k x 4 x 3 [m] about the centroid at rest of
    the body that carries each, that body and the beam. Two per broken beam, the first of its first
    body."""
    if not output.has_field("cracks", time):
        return *NO_CRACKS[:2], np.zeros(0, int)
    beam, faces, points, shift, turn = (output.field(name, time) for name in (
        "crack_beam", "cracks", "crack_points", "bodies_displacement", "bodies_rotation"))
    ice = output.at(time)
    carrier = ice.beams["bodies"][beam, np.arange(len(beam)) % 2].astype(int)
    about = points[faces] - (ice.position[carrier] + shift[carrier])[:, None]
    return np.einsum("fij,fki->fkj", rotations(turn[carrier]), about), carrier, beam  # turned back
