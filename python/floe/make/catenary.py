"""Elastic mooring lines at rest: they hang from a fairlead and lie partly on a flat seabed.

Formulas: Irvine 1981, *Cable Structures*, ch. 2; with a seabed and friction: Jonkman 2007,
NREL/TP-500-41958 (mooring system module). Here for several segments: each hangs, or lies from
where the vertical force is used up. A line bears no bending and no torsion; its weight per length
is that of the unstretched line in water. Units: m, N.
"""
import dataclasses

import numpy as np
import scipy


@dataclasses.dataclass(frozen=True)
class Segment:
    """Unstretched length [m], weight per metre in water [N/m], axial stiffness EA [N]."""
    length: float
    weight: float
    stiffness: float


@dataclasses.dataclass(frozen=True)
class Piece:
    """A segment under a force: `hangs` of its unstretched length [m], with the vertical forces
    `top` and `bottom` at the ends of that part [N]; `lies`: the rest [m], `tension` at its upper
    end and `end` at its lower [N], `stretch` of it [m]."""
    segment: Segment
    hangs: float
    top: float
    bottom: float
    lies: float
    tension: float
    end: float
    stretch: float

    def offset(self, pull, along):
        """Horizontal and vertical distance [m] from its top to the point `along` [m] its hanging
        part, unstretched, of a line with that horizontal force."""
        of, bottom = self.segment, self.top - self.segment.weight * along
        sides = np.hypot(pull, self.top) + np.hypot(pull, bottom)
        share = np.divide(self.top + bottom, sides, out=np.zeros_like(sides), where=sides > 0)
        across = 0 * along if pull == 0 else pull / of.weight * (
            np.arcsinh(self.top / pull) - np.arcsinh(bottom / pull))
        return (across + pull * along / of.stiffness,
                along * share + (self.top + bottom) * along / (2 * of.stiffness))


class Catenary:
    """A line from a fairlead `height` [m] above its anchor, which is on the seabed.
    segments: from the fairlead to the anchor; friction: its coefficient on the seabed. `pull` is
    the horizontal force at the fairlead [N], `lift` the vertical one [N]."""

    def __init__(self, segments, height, friction=0.0):
        self.segments, self.height, self.friction = tuple(segments), height, friction
        self.length = sum(one.length for one in self.segments)
        self.weight = sum(one.length * one.weight for one in self.segments)

    def pieces(self, pull, lift):
        """The segments under these forces, from the fairlead."""
        found, top, tension = [], lift, pull
        for one in self.segments:
            hangs = min(one.length, top / one.weight)
            lies = one.length - hangs
            rub = self.friction * one.weight
            taut = min(lies, tension / rub) if rub > 0 else lies
            stretch = (tension * taut - rub * taut**2 / 2) / one.stiffness
            end = max(tension - rub * lies, 0.0)
            bottom = top - one.weight * hangs if lies == 0 else 0.0
            found.append(Piece(one, hangs, top, bottom, lies, tension, end, stretch))
            top, tension = bottom, end
        return found

    def reach(self, pull, lift):
        """Horizontal and vertical distance of its ends under these forces [m]."""
        across = down = 0.0
        for piece in self.pieces(pull, lift):
            x, z = piece.offset(pull, np.float64(piece.hangs))
            across, down = across + x + piece.lies + piece.stretch, down + z
        return float(across), float(down)

    def lift(self, pull):
        """Vertical force at the fairlead where the line reaches down to the seabed [N]."""
        high = self.weight
        while self.reach(pull, high)[1] < self.height:
            high *= 2
        return scipy.optimize.brentq(lambda lift: self.reach(pull, lift)[1] - self.height, 0.0,
                                     high, xtol=1e-300, rtol=1e-15)

    def distance(self, pull):
        """Horizontal distance of its ends under a horizontal force [m]; of the slack line at 0."""
        return self.reach(pull, self.lift(pull))[0]

    def tension(self, pull):
        """At the fairlead [N]."""
        return float(np.hypot(pull, self.lift(pull)))

    def _pull_where(self, value, wanted):
        """The horizontal force at which a value that rises with it is what is wanted."""
        high = self.weight
        while value(high) < wanted:
            high *= 2
        return scipy.optimize.brentq(lambda pull: value(pull) - wanted, 0.0, high, xtol=1e-300,
                                     rtol=1e-15)

    def pull_at(self, distance):
        """Horizontal force at a horizontal distance of its ends [N]; 0 where it is slack."""
        return (self._pull_where(self.distance, distance) if distance > self.distance(0.0)
                else 0.0)

    def pull_of(self, tension):
        """Horizontal force at a tension at the fairlead, above that of the slack line [N]."""
        return self._pull_where(self.tension, tension)

    def stiffness(self, pull):
        """Change of the horizontal force with the horizontal distance [N/m]."""
        step = 1e-5 * pull
        return 2 * step / (self.distance(pull + step) - self.distance(pull - step))

    def lying(self, pull):
        """Unstretched length on the seabed [m]."""
        return sum(piece.lies for piece in self.pieces(pull, self.lift(pull)))

    def shape(self, pull, number=50):
        """Points (n, 2) of the line [m]: distance from the fairlead, height above the seabed."""
        at, points = np.array([0.0, self.height]), []
        for piece in self.pieces(pull, self.lift(pull)):
            x, z = piece.offset(pull, np.linspace(0, piece.hangs, number))
            points += [at + (a, -b) for a, b in zip(x, z)]
            at = points[-1] + (piece.lies + piece.stretch, 0)
        return np.array(points + [at])


def table(line, largest, number, level=False):
    """Rows (length [m], tension [N]) of `line: NAME: table`, from where the line is slack to where
    its tension at the fairlead is the largest; the horizontal forces of the rows; and the largest
    error of straight pieces between the rows, over the tension there.

    floe pulls straight from the fairlead to the anchor. So that its horizontal pull is the line's,
    a row has the straight distance of the ends and the horizontal force times that over the
    horizontal distance; level: horizontal distance and force, for an anchor as high as the
    fairlead."""
    top = line.pull_of(largest)
    pulls = np.concatenate([[0.0], np.geomspace(1e-3 * top, top, number - 1)])

    def row(pull):
        distance = line.distance(pull)
        length = np.hypot(distance, 0 if level else line.height)
        return length, pull * length / distance
    rows = np.array([row(pull) for pull in pulls])
    worst = 0.0
    for k in range(1, number - 1):
        length, tension = row(np.sqrt(pulls[k] * pulls[k + 1]))
        worst = max(worst, abs(np.interp(length, *rows[k:k + 2].T) / tension - 1))
    return rows, pulls, float(worst)
