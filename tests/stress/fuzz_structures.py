"""Scenes with structures, mooring lines, parts of obstacles, tables in time and pressure on
patches, most of them good; and ways to damage tables."""
import numpy as np

from fuzz_files import flipped
from fuzz_outlines import HOSTILE

AXES = ("x", "y", "z", "rx", "ry", "rz")
ICE = {("lattice_file",): None, ("sheet", "length"): "8", ("sheet", "width"): "6",
       ("sheet", "thickness"): "0.5", ("sheet", "element_size"): "1.6",
       ("sheet", "iterations"): "5", ("beam", "damping_ratio"): "0.1"}


def listed(values):
    return "[" + ", ".join(repr(float(f"{value:.6g}")) for value in values) + "]"


def size_of(chance, low, high):
    return 10**chance.uniform(low, high)


def time_table(columns, chance, zero_at_start=False, periodic=False):
    """Text of a table of time and these columns."""
    count = chance.choice((2, 2, 3, 5, 30))
    count = max(count, 3) if periodic and zero_at_start else count
    step = size_of(chance, -4, 0)
    start = chance.choice((0, 0, 0, -step, -1)) if not zero_at_start else 0
    rows = [[start + k * step] for k in range(count)]
    for column in columns:
        most = size_of(chance, -3, 5 if column[0] in "fm" else 0)
        if column[0] in "ur":
            most *= 30 * step  # speeds below limit: velocity
        values = [most * chance.uniform(-1, 1) for _ in rows]
        if zero_at_start and column[0] in "ur":
            values[0] = 0.0
        if periodic:
            values[-1] = values[0]
            if count == 2:
                values = [most, most]
        for row, value in zip(rows, values):
            row.append(value)
    separator, end = chance.choice((",", ", ", " ", "\t")), chance.choice(("\n", "\n", "\r\n"))
    lines = [separator.join(["time", *columns])]
    lines += [separator.join(repr(float(x)) for x in row) for row in rows]
    if chance.random() < 0.2:
        lines.insert(chance.randrange(len(lines) + 1), "# a remark, with words")
    return end.join(lines) + (end if chance.random() < 0.9 else "")


def spoilt_table(text, chance):
    """A table with one fault: the text, and the exit code that must come of it, or None."""
    lines = text.replace("\r\n", "\n").replace("\t", ",").replace(", ", ",").replace(" ", ",")
    lines = [line for line in lines.split("\n") if line and line[0] != "#"]
    rows = [line.split(",") for line in lines]
    at, must = chance.randrange(1, len(rows)), 2
    way = chance.randrange(13)
    if way == 0:
        rows[at][0] = rows[at - 1][0] if at > 1 else "-1e13"  # time stands still
    elif way == 1:
        rows[at][chance.randrange(len(rows[at]))] = chance.choice(
            [word for word in HOSTILE if word not in ("1e15", "-1e9", "0", "1e-320")])
    elif way == 2:
        rows[at].pop()
    elif way == 3:
        rows[at].append("1")
    elif way == 4:
        del rows[2:]  # one row
    elif way == 5:
        rows[0][-1] = chance.choice(("odd", "time", "fX", "vel", "1"))
    elif way == 6:
        rows[0] = rows[0][1:]
    elif way == 7:
        del rows[0]
    elif way == 8:
        for row in rows:
            row.append(row[-1])  # a column twice
    elif way == 9:
        rows[at][-1] = chance.choice(("1e30", "-1e25"))
    elif way == 10:
        rows[1:] = [[row[0], *("0" for _ in row[1:])] for row in rows[1:]]  # no effect
    elif way == 11:
        rows = [[row[0]] for row in rows]
    else:
        return damaged(text, chance), None
    return ("\n".join(",".join(row) for row in rows) + "\n").encode(), must


def damaged(text, chance):
    way = chance.randrange(4)
    if way == 0:
        return flipped(text.encode(), chance)
    if way == 1:
        return text[:chance.randrange(len(text) + 1)].encode()
    if way == 2:
        at = chance.randrange(len(text))
        end = at + chance.choice((1, 5, 50))
        return (text[:at] + chance.choice(("", text[at:end] * 2)) + text[end:]).encode()
    return chance.choice((b"", b"\n\n", b"#", b"\xef\xbb\xbf" + text.encode(),
                          text.encode("utf-16"), text.replace("\n", "\r").encode(),
                          text.replace(".", ",").encode(), b"\0" + text.encode(),
                          text.encode() + b"\0", b"time\n", b"time,fx\n0,1\n" * 2,
                          text.upper().encode(), b"t" * 3000000,
                          text.replace(",", ";").encode()))


class Made:
    """A scene of structures: `scene` {path: text}, `files` {name: bytes}, `tables` {name: text}."""

    def __init__(self, chance):
        self.chance, self.files, self.tables = chance, {}, {}
        self.on_ice = chance.random() < 0.5
        self.forces = ["contact"]
        if self.on_ice:
            self.forces.append("beam")
            if chance.random() < 0.4:
                self.forces.append("fracture")
        if chance.random() < 0.7:
            self.forces += ["gravity", "buoyancy"]
            if chance.random() < 0.5:
                self.forces.append("drag")
        self.scene = {("integrator",): "explicit",
                      ("forces",): "[" + ", ".join(self.forces) + "]"}
        if self.on_ice:
            self.scene.update({path: text for path, text in ICE.items() if text})
        else:
            self.scene[("lattice_file",)] = "block.h5"
        self.scene[("contact", "young")] = chance.choice(("1e6", "1e8"))
        for word, values in (("friction", ("0", "0.3")), ("friction_wet", ("0.05",)),
                             ("restitution", ("0.3", "1")), ("law", ("overlap", "potential")),
                             ("plastic_limit", ("1e5",))):
            if chance.random() < 0.25:
                self.scene[("contact", word)] = chance.choice(values)
        self.edge = 4 if self.on_ice else 1  # of the ice, in x
        self.obstacles, self.structures = [], []
        for k in range(chance.choice((1, 1, 1, 2, 3))):
            self.add_obstacle(f"o{k}", k)
        self.add_parts()
        names = [name for name, _ in self.obstacles]
        self.may_overlap = False  # structures and other obstacles, at the start
        if sum(("obstacle", name, "part_of") not in self.scene for name in names) > 1:
            for name in self.structures:
                if chance.random() < 0.8:
                    self.put("obstacle", name, "touches", "ice")
                else:
                    self.may_overlap = True
        self.scene[("obstacle", "names")] = "[" + ", ".join(names) + "]"
        self.add_lines()
        self.add_motions()
        self.add_water()
        if chance.random() < 0.4 and any(shape != "halfspace" for _, shape in self.obstacles):
            self.scene[("output", "pressure")] = repr(size_of(chance, -5, 0))
            if chance.random() < 0.5:
                self.scene[("output", "pressure_patch")] = repr(size_of(chance, -0.7, 0.7))
        self.scene[("time", "end")] = repr(size_of(chance, -3, 1))
        if chance.random() < 0.3:
            self.scene[("output", "history")] = repr(size_of(chance, -3, 0))

    def put(self, section, name, word, value):
        self.scene[(section, name, word)] = str(value)

    def add_table(self, section, name, word, columns, zero_at_start=False):
        """A key of a table, and those beside it, with a file."""
        chance = self.chance
        stem = word.removesuffix("table")
        path = (section, *([name] if name else []))
        file = f"t{len(self.tables)}.csv"
        self.scene[(*path, word)] = file
        periodic = chance.random() < 0.2
        if periodic:
            self.scene[(*path, stem + "periodic")] = "true"
        if chance.random() < 0.4:
            self.scene[(*path, stem + "interpolation")] = chance.choice(("linear", "smooth"))
        self.tables[file] = time_table(columns, chance, zero_at_start, periodic)

    def motion_columns(self, rotations="", components="xyz"):
        """Some of ux or vx, ... and of rotations."""
        chance = self.chance
        found = [chance.choice("uv") + c for c in components if chance.random() < 0.6]
        found += [chance.choice(rotations) + c for c in "xyz"
                  if rotations and chance.random() < 0.3]
        return found or [chance.choice("uv") + components[0]]

    def add_obstacle(self, name, k):
        chance = self.chance
        shape = chance.choice(("box", "box", "cylinder", "cone", "file", "halfspace"))
        self.obstacles.append((name, shape))
        self.put("obstacle", name, "shape", shape)
        x = self.edge + chance.choice((0.002, 0.3, 5)) + 9 * k  # of its nearest side
        if shape == "box":
            size = [size_of(chance, -0.3, 0.5) for _ in range(3)]
            self.put("obstacle", name, "centre", listed([x + size[0] / 2, 0, 0]))
            self.put("obstacle", name, "size", listed(size))
            if chance.random() < 0.2:
                self.put("obstacle", name, "rotation", listed([0, 0, chance.uniform(-180, 180)]))
                self.put("obstacle", name, "centre", listed([x + max(size), 0, 0]))
        elif shape == "halfspace":
            self.put("obstacle", name, "point", listed([x, 0, 0]))
            self.put("obstacle", name, "normal", "[-1, 0, 0]")
        elif shape == "file":
            self.put("obstacle", name, "file", chance.choice(("o.h5", "hull.stl", "elbow.obj")))
            self.put("obstacle", name, "point", listed([x + 3, 0, 0]))
            if not self.scene[("obstacle", name, "file")].endswith(".h5") and chance.random() < 0.3:
                self.put("obstacle", name, "tolerance", chance.choice((0, 0.001, 0.3)))
        else:
            radius = size_of(chance, -0.3, 0.3)
            self.put("obstacle", name, "base", listed([x + radius, 0, -1]))
            self.put("obstacle", name, "radius", listed([radius])[1:-1])
            self.put("obstacle", name, "height", chance.choice((0.5, 2, 5)))
            self.put("obstacle", name, "facets", chance.choice((3, 4, 12)))
            if shape == "cone":
                self.put("obstacle", name, "top_radius", listed(
                    [radius * chance.choice((0, 0.5, 1))])[1:-1])
        if chance.random() < 0.3:
            self.put("obstacle", name, "friction", chance.choice((0, 0.2)))
        if shape != "halfspace" and chance.random() < 0.65:
            self.structures.append(name)
            self.add_structure(name, x)
        elif chance.random() < 0.4:
            self.add_table("obstacle", name, "table",
                           self.motion_columns("" if shape == "halfspace" else "r"), True)
        elif chance.random() < 0.5:
            self.put("obstacle", name, "velocity", listed([-chance.uniform(0, 2), 0, 0]))

    def add_structure(self, name, x):
        chance = self.chance
        mass = size_of(chance, 1, 6)
        self.put("obstacle", name, "mass", repr(mass))
        if chance.random() < 0.3:
            self.put("obstacle", name, "inertia", listed([mass * chance.uniform(0.5, 1)
                                                          for _ in range(3)]))
            if chance.random() < 0.5:
                self.put("obstacle", name, "centre_of_mass",
                         listed([x + 1, 0, chance.uniform(-1, 1)]))
        upright = ("obstacle", name, "inertia") in self.scene or (
            self.scene[("obstacle", name, "shape")] == "box"
            and ("obstacle", name, "rotation") not in self.scene)
        if upright and chance.random() < 0.5:
            self.put("obstacle", name, "added_mass", listed(
                [mass * chance.choice((0, 0.5, 1)) for _ in range(6)]))
        floats = "buoyancy" in self.forces and chance.random() < 0.5
        if floats:
            self.put("obstacle", name, "floats", "true")
        free = (2, 3, 4) if floats else ()
        way, has_springs = chance.random(), True
        scale = mass * size_of(chance, 0, 3)
        if way < 0.4:
            self.put("obstacle", name, "support_stiffness", listed(
                [0 if k in free or chance.random() < 0.2 and k else scale for k in range(6)]))
        elif way < 0.6 and not floats:
            half = np.array([[chance.gauss(0, 1) for _ in range(6)] for _ in range(6)])
            matrix = scale * (half @ half.T + np.eye(6))
            self.put("obstacle", name, "support_matrix",
                     "[" + ", ".join(repr(float(v)) for v in matrix.ravel()) + "]")
        else:
            has_springs = False
        if chance.random() < 0.3:
            self.put("obstacle", name, "support_damping", listed(
                [mass * chance.choice((0, 0.1, 1)) for _ in range(6)]))
            acts = True
        else:
            acts = has_springs
            if has_springs and chance.random() < 0.4:
                self.put("obstacle", name, "support_damping_ratio", chance.choice((0.02, 1)))
        if acts and chance.random() < 0.3:
            self.put("obstacle", name, "support_point", listed([x + 1, 0, -3]))

    def add_parts(self):
        """Boxes that meet a box at faces."""
        chance = self.chance
        for name, shape in list(self.obstacles):
            if shape != "box" or ("obstacle", name, "rotation") in self.scene:
                continue
            centre, size = ([float(x) for x in self.scene["obstacle", name, word][1:-1].split(",")]
                            for word in ("centre", "size"))
            top = centre[2] + size[2] / 2
            for k in range(chance.choice((0, 0, 1, 2, 3))):
                part, high = f"{name}p{k}", size_of(chance, -0.5, 0.3)
                self.put("obstacle", part, "shape", "box")
                self.put("obstacle", part, "centre",
                         "[" + ", ".join(map(repr, [*centre[:2], top + high / 2])) + "]")
                self.put("obstacle", part, "size", "[" + ", ".join(map(repr, [
                    size[0] * chance.choice((1, 0.5)), size[1], high])) + "]")
                self.put("obstacle", part, "part_of", name)
                self.obstacles.insert(chance.randrange(len(self.obstacles) + 1), (part, "part"))
                top += high

    def add_lines(self):
        chance = self.chance
        if not self.structures or chance.random() < 0.5:
            return
        names = [f"l{k}" for k in range(chance.choice((1, 2, 4)))]
        self.scene[("line", "names")] = "[" + ", ".join(names) + "]"
        for name in names:
            self.put("line", name, "structure", chance.choice(self.structures))
            self.put("line", name, "fairlead", listed([self.edge + 2, 0, 0]))
            self.put("line", name, "anchor",
                     listed([chance.uniform(20, 60), chance.uniform(-30, 30),
                             chance.uniform(-30, 5)]))
            if chance.random() < 0.4:
                file = f"line{name}.csv"
                self.put("line", name, "table", file)
                rows, length, tension = [], chance.uniform(0, 30), 0.0
                for _ in range(chance.choice((2, 3, 6))):
                    rows.append(f"{length!r}, {tension!r}")
                    length += size_of(chance, -1, 1)
                    tension += size_of(chance, 2, 4)
                self.files[file] = ("length, tension\n" * (chance.random() < 0.7)
                                    + "\n".join(rows) + "\n").encode()
                if chance.random() < 0.5:
                    self.put("line", name, "pretension", repr(size_of(chance, 1, 3)))
            else:
                self.put("line", name, "stiffness", repr(size_of(chance, 2, 5)))
                self.put("line", name, "pretension", chance.choice((0, 100, 1e4)))
            if chance.random() < 0.4:
                self.put("line", name, "damping", repr(size_of(chance, 1, 4)))
            way = chance.random()
            if way < 0.2:
                self.add_table("line", name, "anchor_table", self.motion_columns(), True)
            elif way < 0.4:
                self.put("line", name, "anchor_velocity", "[0.5, 0, 0.1]")
                if chance.random() < 0.5:
                    self.put("line", name, "anchor_ramp", "0.01")

    def add_motions(self):
        """Boundaries, loads and initial motions of ice and structures."""
        chance = self.chance
        sets = (["left", "all"] if self.on_ice else ["all"]) + self.structures
        if chance.random() < 0.5:
            self.scene[("boundary", "names")] = "[b0]"
            self.put("boundary", "b0", "set", chance.choice(sets))
            way = chance.random()
            fix = "xyz" if way < 0.5 else chance.choice(("x", "xy"))
            self.put("boundary", "b0", "fix", " ".join([*fix, *(["rx", "ry", "rz"]
                                                               if way < 0.3 else [])]))
            if chance.random() < 0.5:
                self.add_table("boundary", "b0", "table",
                               self.motion_columns("rw" if way < 0.3 else "", fix), True)
            else:
                self.put("boundary", "b0", "velocity", "[0.5, 0, 0]")
        if chance.random() < 0.4:
            self.scene[("load", "names")] = "[p0]"
            self.put("load", "p0", "set", chance.choice(sets))
            if chance.random() < 0.6:
                columns = [c for c in ("fx", "fy", "fz", "mx", "my", "mz") if chance.random() < 0.4]
                self.add_table("load", "p0", "table", columns or ["fx"])
            else:
                self.put("load", "p0", "force", listed([size_of(chance, 0, 4), 0, 1]))
        if chance.random() < 0.3:
            self.scene[("initial", "names")] = "[i0]"
            self.put("initial", "i0", "set", chance.choice(sets))
            self.put("initial", "i0", "velocity", "[0.5, 0.1, 0]")

    def add_water(self):
        chance = self.chance
        if "drag" in self.forces:
            self.scene[("water", "drag_linear")] = "100"
            if chance.random() < 0.5:
                self.add_table("water", "", "current_table",
                               [c for c in "xyz" if chance.random() < 0.5] or ["x"])
            else:
                self.scene[("water", "current")] = "[0.5, 0, 0]"
        if "buoyancy" in self.forces and chance.random() < 0.4:
            self.add_table("water", "", "level_table", ["level"])
            self.scene.pop(("contact", "friction_wet"), None)

    def is_held(self):
        """Whether a boundary holds all ice, so that nothing may limit the step."""
        return self.scene.get(("boundary", "b0", "set")) == "all"

    def spoil_table(self):
        """Damages one of its tables; returns the exit code that must come of it, or None."""
        chance = self.chance
        if not self.tables:
            return None
        name = chance.choice(sorted(self.tables))
        self.files[name], must = spoilt_table(self.tables.pop(name), chance)
        return must

    def all_files(self):
        return {**self.files, **{name: text.encode() for name, text in self.tables.items()}}
