"""Scenes to try: changed scenes of input/, scenes made from the list of keys, scenes whose text is
damaged.

A scene is {path: text}, the path a tuple of keys, and is kept small: a run that is accepted takes
no second.
"""
import math
import re

import launch
from fuzz_keys import ODD

NAMES = {"region": "r", "cut": "c", "obstacle": "o", "boundary": "b", "load": "p", "initial": "i"}
SHEET_SETS = ("left", "right", "bottom", "top", "all", "r0", "leftinner", "centre")
LATTICES = {"frame.h5": ("root", "tip", "all"), "rubble.h5": ("all",), "block.h5": ("all",),
            "triangles.h5": ("left", "right", "bottom", "top", "leftinner", "rightinner", "all"),
            "strip.h5": ("left", "right", "all"), "stack.h5": ("lowest", "highest", "all")}
BEAMLESS = ("rubble.h5", "block.h5", "stack.h5")
# The lattices of input/, and the small ones that take their places.
FILE_STAND_INS = {"input/data/ship.stl": "hull.stl", "input/data/tug.csv": "tug.csv"}
STAND_INS = {"strip": "frame.h5", "rubble_pile": "rubble.h5", "punch_through": "rubble.h5",
             "triangles": "triangles.h5",
             "ice_slope": "strip.h5", "stopping": "block.h5", "drag_decay": "block.h5",
             "top": "block.h5", "heave": "block.h5"}
MOST_CELLS, MOST_ITERATIONS, MOST_LOAD_STEPS = 60, 100, 12


def flat_flow(text, path, scene):
    """Adds what stands in `{a: 1, b: {c: [2]}}`, or a plain value."""
    if not text.startswith("{"):
        scene[path] = text
        return
    depth, quoted, parts, part = 0, False, [], ""
    for letter in text.strip()[1:-1]:
        quoted ^= letter == '"'
        depth += letter in "[{"
        depth -= letter in "]}"
        if letter == "," and depth == 0 and not quoted:
            parts.append(part)
            part = ""
        else:
            part += letter
    for entry in [*parts, part]:
        key, value = entry.split(":", 1)
        flat_flow(value.strip(), (*path, key.strip()), scene)


def scene_of(text):
    """A scene of a text that uses a small part of YAML, as those of input/ do."""
    scene, open_keys, begun = {}, [], ""
    for line in text.splitlines():
        line = re.sub(r"(^|\s)#.*", "", line).rstrip()
        if not line:
            continue
        line = f"{begun} {line.strip()}" if begun else line
        begun = line if sum(map(line.count, "[{")) > sum(map(line.count, "]}")) else ""
        if begun:  # a list or map that goes on in the next line
            continue
        indent = len(line) - len(line.lstrip())
        key, value = line.strip().split(":", 1)
        open_keys = [(i, k) for i, k in open_keys if i < indent] + [(indent, key)]
        if value.strip():
            flat_flow(value.strip(), tuple(k for _, k in open_keys), scene)
    return scene


def write_scene(scene):
    """The text of a scene: nested, in the order of its keys."""
    tree = {}
    for path, value in scene.items():
        node = tree
        for word in path[:-1]:
            node = node.setdefault(word, {})
            if not isinstance(node, dict):
                break
        else:
            node[path[-1]] = value
    lines = []

    def write(node, indent):
        for key, value in node.items():
            if isinstance(value, dict):
                lines.append(f"{indent}{key}:")
                write(value, indent + "  ")
            else:
                lines.append(f"{indent}{key}: {value}")
    write(tree, "")
    return "\n".join(lines) + "\n"


def number(scene, *path, default):
    try:
        value = float(scene.get(path, default))
    except (ValueError, OverflowError):
        return None
    return value if math.isfinite(value) else None


def bound(scene, chance):
    """Makes a scene so small that an accepted run is short; words for the command line that end
    it."""
    for key in [path for path in scene if path[0] == "sheet" and path[1:] and
                path[1].startswith(("mesh_file", "outline", "thickness_file"))]:
        scene.pop(key)
    length = number(scene, "sheet", "length", default="40")
    width = number(scene, "sheet", "width", default=scene.get(("sheet", "length"), "40"))
    size = number(scene, "sheet", "element_size", default="2")
    if any(path[0] == "sheet"
           for path in scene) and None not in (length, width,
                                               size) and min(length, width, size) > 0:
        if MOST_CELLS < length * width / size / size < 1e8:  # above, it is refused
            scene[("sheet", "element_size")] = repr(math.sqrt(length)
                                                    * math.sqrt(width / chance.randint(10,
                                                                                       MOST_CELLS)))
        iterations = number(scene, "sheet", "iterations", default="150")
        if iterations is not None and MOST_ITERATIONS < iterations <= 1e6:
            scene[("sheet", "iterations")] = str(chance.randint(0, MOST_ITERATIONS))
    if scene.get(("integrator",), "quasistatic") not in ("explicit", "implicit"):
        end, step = number(scene, "time", "end",
                           default="1"), number(scene, "time", "dt", default="1e300")
        if end is not None and step is not None and step > 0 and end / step > MOST_LOAD_STEPS:
            scene[("time", "dt")] = repr(end / chance.randint(1, MOST_LOAD_STEPS))
        if scene.get(("static", "path")) == "arc":
            scene[("static", "steps")] = str(chance.randint(1, MOST_LOAD_STEPS))
        return []
    explicit = scene[("integrator",)] == "explicit"
    if chance.random() < 0.3:
        if explicit and ("time", "end") in scene and number(scene, "time", "end",
                                                            default="1") is not None:
            scene[("time", "end")] = repr(10**chance.uniform(-6, -3))
        if explicit:
            scene[("limit", "steps")] = "2000"
            return []
    return ["-ts_max_steps", str(chance.randint(0, 60) if explicit else chance.randint(0, 8))]


class Scenes:
    """Makes scenes from a program's keys."""

    def __init__(self, keys):
        self.keys = keys
        self.inputs = {str(file.relative_to(launch.REPOSITORY)): scene_of(file.read_text())
                       for file in sorted((launch.REPOSITORY / "input").rglob("*.yaml"))
                       if file.parent.name != "ensembles"}

    def place(self, key, scene, chance):
        """A path for a key: a name that the scene has, seldom another."""
        if "NAME" not in key.path:
            return key.path
        names = sorted({path[1] for path in scene if path[0] == key.path[0] and len(path) == 3})
        name = chance.choice(names) if names and chance.random() < 0.9 else "odd"
        return tuple(name if word == "NAME" else word for word in key.path)

    def value(self, key, scene, chance):
        """An allowed value that fits the scene."""
        if key.path[-1] == "set":
            return chance.choice(LATTICES.get(scene.get(("lattice_file",)), SHEET_SETS[:5]))
        if key.path[0] == "region" and key.count == 6 and chance.random() < 0.9:
            return "[" + ", ".join(f"{-chance.uniform(0, 6):.3f}, {chance.uniform(0, 6):.3f}"
                                   for _ in range(3)) + "]"
        if key.path[0] == "cut" and key.count == 2 and chance.random() < 0.8:
            return f"[{-20 if key.path[-1] == 'from' else 20}, {chance.uniform(-2, 2):.3f}]"
        if key.path[-1] == "point" and key.count == 2 or key.path[0] == "cut" and key.count == 2:
            return "[" + ", ".join(repr(round(chance.uniform(-6, 6), 3))
                                   for _ in range(key.count)) + "]"
        if key.path[-1] == "fix":
            return " ".join(chance.sample(key.choices, chance.randint(1, 6)))
        if key.path == ("lattice_file",):
            return chance.choice(list(LATTICES))
        if key.path[-1] == "file":
            return chance.choice(["o.h5", "hull.stl", "elbow.obj", "nowhere.h5"])
        if key.path[-1].endswith("table"):
            tables = sorted(value for path, value in scene.items() if path[-1].endswith("table"))
            return chance.choice([*tables, "t0.csv"])
        if key.path[-1] in ("part_of", "structure"):
            names = sorted({path[1] for path in scene if path[0] == "obstacle" and len(path) == 3})
            return chance.choice([*names, "odd"])
        if key.path == ("output", "dir"):
            return chance.choice(["out/fuzz", "out", "o p", "out/../out/x", "out/fuzz/"])
        return key.allowed(chance)

    def add(self, scene, section, chance, name=None, share=0.35):
        """Keys of a section: those that are required, and some of the others."""
        for key in self.keys:
            if key.path[0] != section or key.path[-1] == "names":
                continue
            if ("NAME" in key.path) != (name is not None):
                continue
            if key.default == "required" or chance.random() < share:
                path = tuple(name if word == "NAME" else word for word in key.path)
                scene[path] = self.value(key, scene, chance)

    def named(self, scene, section, chance, count):
        """`count` sections with names."""
        names = [f"{NAMES[section]}{k}" for k in range(count)]
        if names:
            scene[(section, "names")] = "[" + ", ".join(names) + "]"
        for name in names:
            self.add(scene, section, chance, name)
            if section == "obstacle":
                self.mend_obstacle(scene, name, chance)
            for word in ("table", "interpolation", "periodic"):  # fuzz_structures has them
                scene.pop((section, name, word), None)
            if section == "load":
                scene.pop((section, name, chance.choice(["set", "point"])), None)
                if (section, name, "set") not in scene:
                    scene[(section, name, "point")] = "[0, 0]"
            if section == "boundary" and (section, name, "displacement") in scene:
                scene.pop((section, name, "velocity"), None)

    @staticmethod
    def mend_obstacle(scene, name, chance):
        """Leaves the keys of one shape, and those of a motion or of a structure on springs."""
        own = {"halfspace": ("point", "normal"), "box": ("centre", "size", "rotation"),
               "cone": ("base", "radius", "top_radius",
               "height", "facets"), "cylinder": ("base", "radius", "height", "facets"),
               "file": ("file", "point", "unit", "tolerance", "most_parts")}
        given = {path[2] for path in scene if path[:2] == ("obstacle", name)}
        if not scene.get(("obstacle", name, "file"), "").endswith((".stl", ".obj")):
            own["file"] = ("file", "point")
        gone = {"part_of", "table", "interpolation", "periodic", "floats", "support_matrix",
                "centre_of_mass", "support_damping"}
        if "support_stiffness" not in given:
            gone |= {"support_damping_ratio", "support_point"}
        structure = {word for word in given if word.startswith("support_")} | {
            "mass", "inertia", "added_mass"}
        if "mass" in given and scene[("obstacle", name, "shape")] != "halfspace":
            gone |= {"velocity", "angular_velocity", "amplitude", "frequency", "ramp"}
        else:
            gone |= structure
        for word in gone:
            scene.pop(("obstacle", name, word), None)
        if not {"velocity", "angular_velocity", "amplitude"} & (given - gone):
            scene.pop(("obstacle", name, "ramp"), None)
        shape = scene[("obstacle", name, "shape")]
        every = {word for words in own.values() for word in words}
        for word in every - set(own.get(shape, every)):
            scene.pop(("obstacle", name, word), None)
        if shape != "halfspace":
            place = {"box": "centre", "file": "point"}.get(shape, "base")
            x, z = chance.choice([0, 5, 9, 30]), chance.choice([-20, -3, 0, 3])
            scene[("obstacle", name, place)] = f"[{x}, 0, {z}]"
        else:
            scene.pop(("obstacle", name, "angular_velocity"), None)
            scene[("obstacle", name, "point")] = f"[{chance.choice([5, 6.01, 50])}, 0, 0]"
            scene[("obstacle", name, "normal")] = chance.choice(["[-1, 0, 0]", "[-1, 0, 1]"])
        if (("obstacle", name, "amplitude") in scene) != (("obstacle", name, "frequency") in scene):
            scene.pop(("obstacle", name, "amplitude"), None)
            scene.pop(("obstacle", name, "frequency"), None)

    def made(self, chance):
        """A scene from the list of keys: mostly one that fits together."""
        scene = {("integrator",): chance.choice(["explicit", "explicit", "implicit",
                                                 "quasistatic"])}
        dynamic = scene[("integrator",)] != "quasistatic"
        if chance.random() < 0.4:
            scene[("lattice_file",)] = chance.choice(list(LATTICES))
        forces = ["beam"] if scene.get(("lattice_file",)) not in BEAMLESS else []
        if forces and scene[("integrator",)] != "implicit" and chance.random() < 0.4:
            forces.append("fracture")
        if chance.random() < 0.5:
            forces += ["gravity", "buoyancy"]
        if dynamic and chance.random() < 0.4:
            forces.append("drag")
        if scene[("integrator",)] == "explicit" and chance.random() < 0.4:
            forces.append("contact")
        if not forces:
            forces = ["gravity"]
        chance.shuffle(forces)
        scene[("forces",)] = "[" + ", ".join(forces) + "]"
        if ("lattice_file",) not in scene:
            size = 10**chance.uniform(-0.3, 0.5)
            scene[("sheet", "length")] = repr(size * chance.uniform(2, 8))
            scene[("sheet", "width")] = repr(size * chance.uniform(2, 8))
            scene[("sheet", "element_size")] = repr(size)
            scene[("sheet", "thickness")] = repr(chance.uniform(0.1, 2))
            for word in ("seed", "relaxation", "iterations", "tolerance"):
                if chance.random() < 0.3:
                    key = next(k for k in self.keys if k.path == ("sheet", word))
                    scene[key.path] = key.allowed(chance)
            self.add(scene, "ice", chance, share=0.3)
            self.named(scene, "region", chance, chance.choice((0, 0, 1)))
            self.named(scene, "cut", chance, chance.choice((0, 0, 0, 1)))
        for section, force in (("beam", "beam"), ("fracture", "fracture"), ("contact", "contact")):
            if force in forces and chance.random() < 0.7:
                self.add(scene, section, chance)
        if not dynamic:
            scene.pop(("beam", "damping_ratio"), None)
            scene.pop(("beam", "damping_modes"), None)
        if ("lattice_file",) in scene:
            for word in ("calibrate", "shear_factor", "torsion"):
                scene.pop(("beam", word), None)
            scene.pop(("fracture", "calibrate"), None)
            scene.pop(("fracture", "flexural_strength"), None)
            if "contact" in forces:
                scene[("contact", "young")] = "1e7"
        if "buoyancy" in forces or "drag" in forces:
            self.add(scene, "water", chance, share=0.2)
            for path in [path for path in scene if path[0] == "water" and path[1].startswith(
                    ("level_", "current_"))]:
                scene.pop(path)
            if "drag" not in forces:
                for word in ("drag_linear", "drag_coefficient", "current", "drag", "drag_form",
                             "drag_skin", "shelter"):
                    scene.pop(("water", word), None)
            elif ("water", "drag_linear") not in scene:
                scene[("water", "drag_linear")] = "100"
            if dynamic and chance.random() < 0.2:
                self.add(scene, "waves", chance)
                scene[("waves", "height")] = repr(10**chance.uniform(-4, 0))
                scene[("waves", "period")] = repr(10**chance.uniform(0.3, 1.5))
        if "contact" in forces:
            self.named(scene, "obstacle", chance, chance.choice((0, 1, 1, 2)))
        self.named(scene, "boundary", chance, 1 if not dynamic else chance.choice((0, 1)))
        if not dynamic and ("boundary", "b0", "set") in scene and chance.random() < 0.7:
            scene[("boundary", "b0", "fix")] = "x y z rx ry rz"
        self.named(scene, "load", chance, chance.choice((0, 1)))
        if dynamic:
            self.named(scene, "initial", chance, chance.choice((0, 0, 1)))
            scene[("time", "end")] = repr(10**chance.uniform(-4, 1))
        for path in (("time", "safety"), ("output", "history"), ("output", "fields"),
                     ("limit", "velocity"),
                     ("model", "planar"), ("model", "rotational_inertia_factor")):
            if chance.random() < 0.15:
                key = next(k for k in self.keys if k.path == path)
                scene[path] = self.value(key, scene, chance)
        self.tidy(scene, chance)
        return scene

    @staticmethod
    def tidy(scene, chance):
        """Takes out of a scene most of what would be refused because two keys do not go
        together."""
        for name in sorted({path[1] for path in scene if path[0] == "boundary" and len(path) == 3}):
            fix = scene.get(("boundary", name, "fix"), "").split()
            for word, of in (("velocity", "xyz"), ("displacement", "xyz"),
                             ("angular_velocity", ["rx", "ry", "rz"])):
                path = ("boundary", name, word)
                if path in scene:
                    values = [chance.uniform(-1, 1) * 10**chance.uniform(-4, 1) if c in fix else 0
                              for c in of]
                    scene[path] = "[" + ", ".join(f"{value:.3g}" for value in values) + "]"
            if ("boundary", name, "displacement") in scene:
                scene[("boundary", name, "ramp")] = repr(10**chance.uniform(-4, 1))
        for name in sorted({path[1] for path in scene if path[0] == "load" and len(path) == 3}):
            if ("load", name, "moment") not in scene:
                scene.setdefault(("load", name, "force"),
                                 f"[0, {10**chance.uniform(-3, 7):.3g}, 0]")
        if ("sheet", "thickness_deviation") not in scene:
            for word in ("thickness_correlation", "thickness_seed"):
                scene.pop(("sheet", word), None)
        elif chance.random() < 0.9:
            scene.setdefault(("sheet", "thickness_correlation"), "[3, 7]")
            for path in (("fracture", "calibrate"), ("fracture", "flexural_strength"),
                         ("report",)):
                scene.pop(path, None)
        if ("fracture", "weibull_modulus") not in scene:
            for word in ("weibull_area", "seed"):
                scene.pop(("fracture", word), None)
        if ("fracture", "compressive_strength") in scene and chance.random() < 0.8:
            shear = scene.get(("fracture", "shear_strength"),
                              scene.get(("fracture", "tensile_strength"), "6e5"))
            scene[("fracture", "compressive_strength")] = repr(5 * float(shear))
        if scene.get(("beam", "calibrate"), "none") == "isotropic":
            scene.pop(("beam", "shear"), None)
        if scene.get(("beam", "shear"), "") == "none":
            scene.pop(("beam", "shear_factor"), None)
        if ("water", "drag_coefficient") not in scene and "buoyancy" not in scene.get(("forces",),
                                                                                      ""):
            scene.pop(("water", "density"), None)
        if ("water", "density") in scene and chance.random() < 0.8:
            scene[("water", "density")] = "1025"
            scene.pop(("ice", "density"), None)
        if scene.get(("model", "planar")) == "true" and chance.random() < 0.7:
            scene.pop(("model", "planar"))
        if scene.get(("integrator",)) != "explicit":
            scene.pop(("time", "safety"), None)
            scene.pop(("model", "rotational_inertia_factor"), None)
        if scene.get(("static", "path")) != "arc" or chance.random() < 0.8:
            for path in [path for path in scene if path[0] == "static" and path[1] != "path"]:
                scene.pop(path)
        if scene.get(("integrator",)) != "quasistatic":
            scene.pop(("static", "path"), None)
        if scene.get(("static", "path")) == "arc":
            scene.pop(("time", "dt"), None)
            scene.pop(("time", "end"), None)
            for path in [path for path in scene if path[-1] == "ramp"]:
                scene[path] = "1"
        if scene.get(("integrator",)) == "quasistatic":
            scene.pop(("limit", "velocity"), None)
            scene.pop(("water", "added_mass"), None)
            scene.pop(("water", "added_mass_axes"), None)
        if ("water", "added_mass") in scene:
            scene.pop(("water", "added_mass_axes"), None)
            scene[("water", "added_mass")] = chance.choice(("0.5", "2", "plate"))
        if any(path[0] == "obstacle" and path[-1] == "mass" for path in scene):
            scene.pop(("water", "drag"), None)
        if scene.get(("water", "drag")) == "faces":
            scene.pop(("water", "drag_coefficient"), None)
            scene.setdefault(("water", "shelter"), "0.1")
        else:
            for word in ("drag_form", "drag_skin", "shelter"):
                scene.pop(("water", word), None)
        in_space = ("buoyancy" in scene.get(("forces",), "")
                    or scene.get(("water", "drag")) == "faces")
        if scene.get(("integrator",)) != "explicit" or not in_space:
            scene.pop(("water", "pace"), None)
        if scene.get(("integrator",)) == "implicit":
            for path in [path for path in scene if path[0] == "waves"]:
                del scene[path]
            scene.pop(("water", "added_mass_axes"), None)
        law = {word: ("contact", "plastic_" + word) for word in (
            "limit", "exponent", "area", "least", "most", "fast", "speed")}
        if law["limit"] not in scene:
            for path in (*law.values(), ("contact", "wear")):
                scene.pop(path, None)
        if float(scene.get(law["exponent"], 0)) == 0:
            for word in ("exponent", "area", "least", "most"):
                scene.pop(law[word], None)
        if float(scene.get(law["fast"], 1)) == 1:
            for word in ("fast", "speed"):
                scene.pop(law[word], None)
        elif law["fast"] in scene:
            scene.setdefault(law["speed"], "0.1")
        jonswap = scene.get(("waves", "spectrum")) == "jonswap"
        for word in ("phase",) if jonswap else ("gamma", "components", "seed"):
            scene.pop(("waves", word), None)
        if ("lattice_file",) in scene:
            for path in [path for path in scene if path[0] in ("sheet", "ice", "cut")]:
                del scene[path]

    def spoil(self, scene, chance):
        """Changes some keys: other values, allowed or hostile, keys that are gone, new,
        misspelt."""
        for _ in range(chance.choice((1, 1, 1, 1, 2, 4))):
            way = chance.random()
            path = chance.choice(list(scene)) if scene else ("integrator",)
            known = [key for key in self.keys if len(key.path) == len(path) and
                     all(a == b or a == "NAME" for a, b in zip(key.path, path))]
            key = known[0] if known else chance.choice(self.keys)
            if way < 0.3:
                scene[path] = key.hostile(chance)
            elif way < 0.65:
                scene[path] = self.value(key, scene,
                                         chance) if key.kind != "names" else chance.choice(
                                             ["[b0, b0]", "x", "[]"])
            elif way < 0.72:
                scene.pop(path, None)
            elif way < 0.95:
                new = chance.choice(self.keys)
                scene[self.place(new, scene, chance)] = self.value(new, scene, chance)
            else:
                scene.pop(path, None)
                word = path[-1]
                at = chance.randrange(len(word))
                scene[(*path[:-1], word[:at] + chance.choice("aex_1")
                       + word[at + chance.choice((0, 1)):])] = chance.choice(ODD)

    def changed(self, chance):
        """A small copy of a scene of input/, changed."""
        scene = dict(self.inputs[chance.choice(list(self.inputs))])
        if ("lattice_file",) in scene:
            name = re.split(r"[/.]", scene[("lattice_file",)])[-2]
            scene[("lattice_file",)] = STAND_INS.get(name, "frame.h5")
        scene = {path: FILE_STAND_INS.get(value, value) for path, value in scene.items()}
        if chance.random() < 0.85:
            self.spoil(scene, chance)
        return scene

    def damaged(self, text, chance):
        """Text of a scene of which letters, lines or bytes are changed."""
        data = text.encode()
        for _ in range(chance.choice((1, 1, 2, 5))):
            at = chance.randrange(len(data) + 1)
            lines = data.split(b"\n")
            row = chance.randrange(len(lines))
            odd = [b"\t", b"\0", b"\xff", b"\xff\xfe", b"\xef\xbb\xbf", b"\r\n", b"---\n", b"...\n",
                   b"- ", b"? ",
                   b": ", b"{", b"}", b"[", b"]", b"&a ", b"*a ", b"!t ", b"|\n",
                   b"'", b'"', b"#", b"%YAML 1.3\n", b"<<: *a\n", "ü".encode(), "\u2028".encode(),
                   b"  ", b"a: {" * chance.choice((3, 50, 3000)), b"x" * 5000,
                   b"[" * chance.choice((3, 3000))]
            way = chance.randrange(7)
            if way == 0:
                data = data[:at] + chance.choice(odd) + data[at:]
            elif way == 1:
                data = data[:at] + bytes([chance.randrange(256)]) + data[at + 1:]
            elif way == 2:
                data = data[:at]
            elif way == 3:
                data = b"\n".join([*lines[:row], *lines[row + 1:]])
            elif way == 4:
                data = b"\n".join([*lines[:row], lines[row], *lines[row:]])
            elif way == 5:
                data = b"\n".join([*lines[:row], b" " * chance.randrange(5) + lines[row].lstrip(),
                                   *lines[row + 1:]])
            else:
                chance.shuffle(lines)
                data = b"\n".join(lines)
        return data
