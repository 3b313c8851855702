"""Broken beams and the pieces of the ice, at the end of a run and at any of its frames. SI units.

breaks.h5 is of the bodies that a run had when it was last written. Where ice joins and leaves, the
beams of bodies that have left since are known by the frames: their breaks count from the first
frame that has them.
"""
import functools

import h5py
import numpy as np

from floe.errors import reading
from floe.results.output import has_changes

BREAKS = ("time", "beam", "fragments/of_body", "fragments/mass", "fragments/bodies")


def pieces(count, pairs):
    """Which of `count` bodies hang together by pairs: per body the least number of its piece."""
    piece = np.arange(count)
    while True:
        least = piece[pairs].min(axis=1)
        joined = piece.copy()
        for end in pairs.T:
            np.minimum.at(joined, piece[end], least)
        while not np.array_equal(joined, joined[joined]):
            joined = joined[joined]
        if np.array_equal(joined, piece):
            return piece
        piece = joined


def fragments(ice, whole):
    """Pieces that whole beams hold together, the heaviest first, as breaks.h5 has them: the number
    of each body's piece, masses [kg] and numbers of bodies. whole: of each beam."""
    root, piece = np.unique(pieces(len(ice.position), ice.beams["bodies"][whole]),
                            return_inverse=True)
    mass = np.bincount(piece, ice.mass, len(root))
    order = np.argsort(-mass, kind="stable")
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    return {"fragments/of_body": number[piece], "fragments/mass": mass[order],
            "fragments/bodies": np.bincount(piece, minlength=len(root))[order]}


def keys(names):
    """One number per beam from the names m x 2 of its bodies."""
    return (names[:, 0] << 32) + names[:, 1]


class Times:
    """When beams broke [s]: to the step where breaks.h5 has them, else the time of the first frame
    in which they are broken."""

    def __init__(self, output):
        found, times = [], []
        for time in output.times:
            if output.has_field("damage", time):
                broken = output.beam_names(time)[output.field("damage", time) >= 1]
                found.append(keys(broken))
                times.append(np.full(len(broken), time))
        exact, moment = of_file(output)
        found, times = (np.concatenate([np.zeros(0, kind), *lists]) for lists, kind in
                        (([exact, *found], np.int64), ([moment, *times], float)))
        self.key, first = np.unique(found, return_index=True)  # the first of those that are alike
        self.time = times[first]

    def of(self, names):
        """Times of the breaks of beams by the names m x 2 of their bodies; nan: whole in all
        frames."""
        if not len(self.key):
            return np.full(len(names), np.nan)
        at = np.minimum(np.searchsorted(self.key, keys(names)), len(self.key) - 1)
        return np.where(self.key[at] == keys(names), self.time[at], np.nan)


@functools.lru_cache(maxsize=1)
def times_of(output):
    """Times of the output last asked for, found once."""
    return Times(output)


def of_file(output, *more):
    """Keys and times of the breaks in breaks.h5, and further datasets of it. Nothing (empty arrays)
    where it is not plain of which bodies it is: a run that was killed may have changed its ice
    since."""
    path = output.folder / "breaks.h5"
    if not path.exists():
        return np.zeros(0, np.int64), np.zeros(0), *(np.zeros(0) for _ in more)
    with reading(path), h5py.File(path) as file:
        beam, bodies = file["beam"][:], file["bodies"][:]
        values = [file[name][:] for name in ("time", *more)]
        count = len(file["fragments/of_body"])
    for mesh in sorted({0, *numbers_of_meshes(output)}, reverse=True):
        names, pairs = output.mesh_names(mesh)
        if len(names) == count and np.all(beam < len(pairs)) and np.array_equal(
                pairs[beam], names[bodies]):
            frame = np.flatnonzero(output.meshes == mesh)
            broken = np.zeros(0, int)
            if len(frame):  # whose breaks the file has all, unless it is older
                last = output.times[frame[-1]]
                broken = np.flatnonzero(output.field("damage", last) >= 1)
            if np.all(np.isin(broken, beam)):
                return keys(pairs[beam]), *values
    return np.zeros(0, np.int64), *(each[:0] for each in values)


def numbers_of_meshes(output):
    return [int(path.stem.removeprefix("mesh_"))
            for path in output.folder.glob("fields/mesh_*.h5")]


def at_end(output):
    """Breaks and pieces of the ice at the end of a run as {name: array} by BREAKS; nothing if no
    beam can break."""
    if has_changes(output.folder) and len(output.times):
        return at_frame(output, output.times[-1])
    path = output.folder / "breaks.h5"
    if not path.exists():
        return {}
    with reading(path), h5py.File(path) as file:
        return {name: file[name][:] for name in BREAKS}


def at_frame(output, time):
    """The same of the ice in the frame nearest to `time`, beams and bodies in its order."""
    if not output.has_field("damage", time):
        return {}
    ice, broken = output.at(time), output.field("damage", time) >= 1
    when = times_of(output).of(output.beam_names(time)[broken])
    order = np.argsort(when, kind="stable")
    return {"time": when[order], "beam": np.flatnonzero(broken)[order],
            **fragments(ice, ~broken)}
