"""Files of outlines to try: GeoJSON and tables with faults that files of floes have, and hostile
ones."""
import json
import math

from fuzz_files import flipped

SCENES = ("integrator: explicit\nforces: [beam]\nsheet: {outline: FILE, iterations: 5WORDS}\n"
          "time: {end: 1}\n",
          "integrator: explicit\nforces: [beam, gravity, buoyancy]\nsheet: {iterations: 5}\n"
          "floe: {names: [a, b], a: {outline: FILEWORDS}, b: {length: 6, place: [40, 0]}}\n"
          "time: {end: 1}\n")
HOSTILE = ("NaN", "Infinity", "-Infinity", "1e999", "-1e308", "1e-320", "null", '"7"', "[]", "{}",
           "true", "0x10", "1e15", "-1e9", "0", "1_0", "")


def circle(chance, centre=(0, 0), radius=8.0):
    """A rough ring about a centre."""
    n = chance.choice((3, 4, 5, 9, 30, 200))
    rough = chance.choice((0, 0.02, 0.2))
    ring = []
    for k in range(n):
        r = radius * (1 + rough * (2 * chance.random() - 1))
        angle = 2 * math.pi * (k + 0.3 * chance.random()) / n
        ring.append([centre[0] + r * math.cos(angle), centre[1] + r * math.sin(angle)])
    return ring


def polygons(chance):
    """Polygons apart, some with holes, most of them good."""
    made = []
    for k in range(chance.choice((1, 1, 1, 2, 4))):
        centre = (20 * k, 0)
        rings = [circle(chance, centre)]
        if chance.random() < 0.3:
            rings.append(circle(chance, centre, 3))
        if chance.random() < 0.1:
            rings.append(circle(chance, centre, 1))  # inside the hole
        made.append(rings)
    return made


def spoil(made, chance):
    """Puts one geometrical fault into good polygons."""
    rings = chance.choice(made)
    ring = chance.choice(rings)
    at = chance.randrange(len(ring))
    way = chance.randrange(13)
    if way == 0:
        ring[at] = [ring[at][0] * 30, ring[at][1] * 30]  # a spike
    elif way == 1:
        ring.insert(at, list(ring[at]))  # twice
    elif way == 2:
        chance.shuffle(ring)  # it crosses itself
    elif way == 3:
        ring[:] = [[x, 0.0] for x, _ in ring]  # no area
    elif way == 4:
        del ring[2:]
    elif way == 5:
        ring.reverse()
    elif way == 6:
        made.append([[list(p) for p in ring] for ring in rings])  # the same twice
    elif way == 7:
        made.append([[[x + 3, y] for x, y in ring] for ring in rings])  # an overlap
    elif way == 8:
        made.append([[[x + 16, y] for x, y in ring] for ring in rings])
    elif way == 9:
        scale = 10.0**chance.choice((-320, -12, -3, 3, 6, 12, 150))
        for one in rings:
            one[:] = [[scale * x, scale * y] for x, y in one]
    elif way == 10:
        shift = chance.choice((1e5, 1e8, 1e12, 1e16))
        for one in rings:
            one[:] = [[x + shift, y] for x, y in one]
    elif way == 11:
        rings[1:] = [circle(chance, (0.3 * chance.randrange(99), 0), 0.1) for _ in range(400)]
    else:
        many = chance.choice((3000, 30000))
        ring[:] = [[8 * math.cos(2 * math.pi * k / many) + 0.01 * chance.random(),
                    8 * math.sin(2 * math.pi * k / many)] for k in range(many)]


def as_json(made, chance):
    closed = [[ring + ring[:1] for ring in rings] for rings in made]
    way = chance.randrange(4)
    if way == 0 and len(closed) == 1:
        top = {"type": "Polygon", "coordinates": closed[0]}
    elif way == 1:
        top = {"type": "MultiPolygon", "coordinates": closed}
    elif way == 2:
        top = {"type": "GeometryCollection",
               "geometries": [{"type": "Polygon", "coordinates": rings} for rings in closed]}
    else:
        top = {"type": "FeatureCollection", "features": [
            {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": rings},
             "properties": {"thickness": chance.choice((0.5, 1, 1, 1, None))}}
            for rings in closed]}
    return json.dumps(top)


def as_table(made, chance):
    separator = chance.choice((",", " ", ";", ", "))
    end = chance.choice(("\n", "\n", "\r\n"))
    rings = [ring for rings in made for ring in rings]
    if chance.random() < 0.3:  # a ring ends where the third column changes
        return end.join(separator.join((repr(x), repr(y), str(k)))
                        for k, ring in enumerate(rings) for x, y in ring)
    return (end + end).join(end.join(separator.join((repr(x), repr(y))) for x, y in ring)
                            for ring in rings)


def damaged(text, chance):
    """A text of which a number, a letter or a part is spoilt."""
    way = chance.randrange(6)
    places = [k for k, letter in enumerate(text) if letter.isdigit()]
    if way <= 1 and places:
        at = end = chance.choice(places)
        while end < len(text) and (text[end].isdigit() or text[end] in ".e-+"):
            end += 1
        return (text[:at] + chance.choice(HOSTILE) + text[end:]).encode()
    if way == 2:
        return flipped(text.encode(), chance)
    if way == 3:
        return text[:chance.randrange(len(text) + 1)].encode()
    if way == 4:
        at = chance.randrange(len(text))
        end = at + chance.choice((1, 5, 50))
        return (text[:at] + chance.choice(("", text[at:end] * 2)) + text[end:]).encode()
    return chance.choice((
        b"", b"\n\n\n", b"\xef\xbb\xbf" + text.encode(), text.encode("utf-16"), b"[" * 100000,
        b'{"type":"GeometryCollection","geometries":[' * 60, b"x,y\n", b"0,0\n" * 5,
        b'{"type":"FeatureCollection","features":[{"type":"Feature","geometry":null}]}',
        b"".join(b"%d,0,%d\n" % (k, k) for k in range(30000))))


def case(chance):
    """A scene, and the name and the bytes of its outline's file."""
    made = polygons(chance)
    if chance.random() < 0.6:
        spoil(made, chance)
    is_json = chance.random() < 0.5
    text = (as_json if is_json else as_table)(made, chance)
    data = damaged(text, chance) if chance.random() < 0.4 else text.encode()
    words = ""
    for key, values in (("outline_simplify", (0, 0.1, 1, 5, 1e6)),
                        ("element_size", (0.7, 1, 2, 3, 30)),
                        ("outline_feature", (1, 2, 7)), ("outline_scale", (0.01, 2, 1e9))):
        if chance.random() < (0.5 if key == "element_size" else 0.15):
            words += f", {key}: {chance.choice(values)}"
    name = chance.choice(("o.geojson", "o.json") if is_json else ("o.csv", "o.xy"))
    scene = chance.choice(SCENES).replace("FILE", name, 1).replace("WORDS", words, 1)
    return scene, name, data
