"""Hulls of ships by formulas, as closed surfaces of triangles.

x points ahead, y to port, z up; x = 0 is midships and z = 0 the water. Half the breadth at the
height z is

    y = (B/2 + z tan(flare)) (1 - t^p - max(0, -z/T)^4)^(1/2)

t is 0 along the parallel midbody and grows to 1 at the ends of the waterline, with p = 2 in the
bow, whose waterline is half an ellipse (an icebreaker's spoon bow), and p = 4 in the stern, which
is fuller. Waterlines move ahead with the height by z / tan(stem) in the bow, which makes the stem a
straight line at the stem angle above the water and down to the forefoot; in the stern they move so
below the water only. Without flare y is a concave function of x and z, so the hull is convex but
for its division into triangles.
"""
import struct
from dataclasses import dataclass

import numpy as np

SECTION = 4  # exponent of sections
BOW, STERN = 2, 4  # exponents p of waterlines
MIDBODY = 4  # intervals of stations along it


@dataclass
class Hull:
    """length: between the ends of the waterline [m]; beam: at the waterline [m]; draught; depth:
    from keel to deck [m]; stem: angle of the stem to the water, flare: angle of the sides to the
    vertical [degrees]; midbody: length of the parallel midbody over the length."""
    length: float
    beam: float
    draught: float
    depth: float
    stem: float = 30.0
    flare: float = 0.0
    midbody: float = 0.4

    def problem(self):
        """What is wrong with these numbers, as (name, why), or None."""
        if self.depth <= self.draught:
            return "depth", f"{self.depth:g} must be above the draught {self.draught:g}"
        overhang = self.draught / np.tan(np.radians(self.stem))
        if overhang > 0.45 * self.midbody * self.length:
            return "stem", (f"{self.stem:g}: bow and stern go in by {overhang:.3g} m to the keel, "
                            f"must be below 0.45 of the midbody's {self.midbody * self.length:.3g} "
                            "m")
        if self.draught * np.tan(np.radians(self.flare)) > 0.45 * self.beam:
            return "flare", f"{self.flare:g}: leaves no breadth at the keel"
        return None

    def half(self, z, angle, exponent):
        """t and half the breadth at the heights z, of stations from the midbody (angle 0) to an
        end (pi/2)."""
        left = 1 - np.clip(-z / self.draught, 0, 1)**SECTION
        share = np.sin(angle)**(2 / exponent)
        widest = self.beam / 2 + z * np.tan(np.radians(self.flare))
        y = widest * np.sqrt(left) * np.cos(angle)
        return left**(1 / exponent) * share, np.where(angle > 0.999 * np.pi / 2, 0, y)

    def grid(self, triangles):
        """Points of the port side, [level, station, 3], that give about so many triangles. Levels
        go from the keel to the deck, stations from aft ahead; z = 0 is a level."""
        levels = max(4, round(0.16 * np.sqrt(triangles)))  # below the water
        above = max(1, round(levels * 0.7 * (self.depth - self.draught) / self.draught))
        stations = max(12, round(triangles / 4 / (levels + above) - 0.5 * MIDBODY))
        aft = (stations - MIDBODY) // 2
        ahead = stations - MIDBODY - aft
        # closer together at the bilge
        z = np.concatenate([-self.draught * np.cos(np.linspace(0, np.pi / 2, levels + 1))[:-1],
                            np.linspace(0, self.depth - self.draught, above + 1)])[:, None]
        rake = 1 / np.tan(np.radians(self.stem))
        middle = self.midbody * self.length / 2
        entrance = self.length / 2 - middle
        back, front = -middle - np.minimum(z, 0) * rake, middle + z * rake
        t, port = self.half(z, np.linspace(np.pi / 2, 0, aft + 1)[None, :], STERN)
        x, y = [back - entrance * t], [port]
        along = np.linspace(0, 1, MIDBODY + 1)[None, 1:-1]
        x.append(back + along * (front - back))
        y.append(self.half(z, 0 * along, BOW)[1])
        t, port = self.half(z, np.linspace(0, np.pi / 2, ahead + 1)[None, :], BOW)
        x.append(front + entrance * t)
        y.append(port)
        x, y = np.concatenate(x, 1), np.concatenate(y, 1)
        return np.stack([x, y, np.broadcast_to(z, x.shape)], -1)

    def triangles(self, about):
        """The hull's triangles, [n, 3, 3], counter-clockwise seen from outside; mirrored in y = 0
        to the last bit. Numbers are rounded to those of an STL file."""
        side = self.grid(about).astype(np.float32).astype(float)
        found = []
        levels, stations = side.shape[:2]
        for j in range(levels - 1):
            for i in range(stations - 1):
                found += halves(side[j, i], side[j + 1, i], side[j + 1, i + 1], side[j, i + 1])
        mirror = np.array([1, -1, 1])
        found += [(mirror * triangle)[::-1] for triangle in found]
        deck = side[-1]
        for i in range(stations - 1):
            quad = [deck[i] * mirror, deck[i + 1] * mirror, deck[i + 1], deck[i]]
            found += [np.array(quad)[list(k)] for k in ((0, 1, 2), (0, 2, 3))]
        found = np.array(found) + 0.0  # no -0
        return found[[len(np.unique(triangle, axis=0)) == 3 for triangle in found]]


def halves(a, b, c, d):
    """The two triangles of a quadrangle, along that diagonal along which it is convex."""
    if np.dot(np.cross(b - a, c - a), d - a) <= 0:
        return [np.array([a, b, c]), np.array([a, c, d])]
    return [np.array([a, b, d]), np.array([b, c, d])]


def volume(triangles):
    """The volume under the triangles as seen from the origin: of a closed surface, the enclosed
    one."""
    return np.einsum("ij,ij->i", triangles[:, 0],
                     np.cross(triangles[:, 1], triangles[:, 2])).sum() / 6


def displacement(triangles):
    """The volume below z = 0, a plane that no triangle crosses."""
    return volume(triangles[(triangles[:, :, 2] <= 0).all(1)])


def stl(triangles, title):
    """The bytes of a binary STL file."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    record = np.dtype([("numbers", "<f4", 12), ("attribute", "<u2")])
    rows = np.zeros(len(triangles), record)
    rows["numbers"] = np.concatenate([normals[:, None], triangles], 1).reshape(-1, 12)
    return title.encode("ascii")[:80].ljust(80) + struct.pack("<I", len(rows)) + rows.tobytes()
