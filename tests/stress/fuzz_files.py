"""HDF5 files to try: the small files that scenes name, and ways to damage them."""
import io
import shutil
import sys

import h5py
import numpy as np

import launch

sys.path.insert(0, str(launch.REPOSITORY / "python"))
from floe import lattice as fl  # noqa: E402
from floe.make import hull  # noqa: E402

NUMBERS = (np.nan, np.inf, -np.inf, -1.0, 0.0, -0.0, 1.0, 2.0, 1e300, -1e300, 1e-300, 1e-320, 1e31,
           1e15, 1e-15, 0.5, 2.0**53, 1e9)
INTEGERS = (-1, 0, 1, 2, 3, 7, 2**31 - 1, -2**31, 100, 10**6)
TYPES = ("f4", "f2", ">f8", "i1", "u1", "i8", "u8", ">i4", "c16", "S4", "b1")

# An L of two parts.
ELBOW = """v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0
v 0 0 1\nv 3 0 1\nv 3 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1
f 6 5 4 3 2 1\nf 7 8 9 10 11 12
f 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12
"""

# Floating ice that breaks on a mover, with checkpoints.
CHECKPOINTED = """integrator: explicit
forces: [beam, fracture, gravity, buoyancy, contact]
sheet: {length: 6, width: 4, thickness: 0.5, element_size: 1.5, iterations: 5}
beam: {damping_ratio: 0.1}
fracture: {tensile_strength: 1e4, energy: 0.01}
contact: {young: 1e8, restitution: 0.5}
obstacle:
  names: [o]
  o: {shape: cylinder, base: [1, 0, -1.46], radius: 0.5, height: 1, facets: 8,
      velocity: [0, 0, 1]}
time: {end: 100}
limit: {energy_error: 1}
output: {history: 0.002, fields: 0.005}
checkpoint: {every: 1000}
"""


def lay_lattices(folder):
    """The lattices of fuzz_scenes.LATTICES, and a block for obstacles."""
    fl.straight_frame(4.0, 6, fl.Section(0.2, 0.1)).write(folder / "frame.h5")
    fl.triangles(5, 5, 1.0, 0.5).write(folder / "triangles.h5")
    fl.rubble([2, 2, 1], [1, 1, 0.5], 1.6, 0.2).write(folder / "rubble.h5")
    fl.block([2, 2, 0.5]).write(folder / "block.h5")
    fl.strip(4.0, 5, fl.Section(0.8, 0.5), 1010.0).write(folder / "strip.h5")
    fl.stack(3, [1, 1, 0.5], 0.01).write(folder / "stack.h5")
    fl.blocks([[1, 1, 1]], [[0, 0, 0]]).write(folder / "o.h5")
    ship = hull.Hull(6, 2, 0.6, 1, 35)
    (folder / "hull.stl").write_bytes(hull.stl(ship.triangles(200), "hull"))
    (folder / "elbow.obj").write_text(ELBOW)
    (folder / "tug.csv").write_text("time, vx, vy\n0, 0, 0\n0.01, 0.7, 0\n0.02, 0.5, 0.5\n")


def lay_mesh_and_checkpoint(folder):
    """m.h5, a mesh file; c/out/s, a stopped run with a checkpoint; d/out/s, the same gone on with
    to its end."""
    (folder / "m.yaml").write_text("integrator: explicit\nforces: [beam]\n"
                                   "sheet: {length: 6, element_size: 2, iterations: 9, mesh_file: "
                                   "m.h5}\n")
    for scene, at, words in (("m", folder, ["-ts_max_steps", "1"]),
                             ("s", folder / "c", ["-ts_max_steps", "150"])):
        at.mkdir(exist_ok=True)
        if scene == "s":
            (at / "s.yaml").write_text(CHECKPOINTED)
        done = launch.run(f"{scene}.yaml", *words, cwd=at)
        if done.returncode != 0:
            raise SystemExit("fuzz: a good scene fails: " + done.stderr)
    shutil.copytree(folder / "c", folder / "d")
    done = launch.run("s.yaml", *RESTART, cwd=folder / "d")
    if done.returncode != 0:
        raise SystemExit("fuzz: a good restart fails: " + done.stderr)


RESTART = ("-checkpoint_restart", "out/s/checkpoint.h5", "-ts_max_steps", "220")


def flipped(data, chance):
    """Bytes of a file of which bits or bytes are changed, or which is cut, filled, prolonged."""
    data = bytearray(data)
    way = chance.random()
    if way < 0.4:
        for _ in range(chance.choice((1, 1, 2, 8))):
            at = chance.randrange(len(data))
            data[at] ^= 1 << chance.randrange(8)
    elif way < 0.7:
        for _ in range(chance.choice((1, 4, 30, 300))):
            data[chance.randrange(len(data))] = chance.choice((0, 255, chance.randrange(256)))
    elif way < 0.85:
        del data[chance.randrange(len(data)):]
    elif way < 0.95:
        at = chance.randrange(len(data))
        end = min(len(data), at + chance.choice((8, 512, 4096)))
        data[at:end] = bytes([chance.choice((0, 255))]) * (end - at)
    else:
        data += bytes(chance.randrange(256) for _ in range(chance.choice((1, 1000))))
    return bytes(data)


def _datasets(file):
    names = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset)
                    else None)
    return names


def _odd_entries(values, chance):
    """A copy of which some entries are hostile."""
    values = np.array(values)
    flat = values.reshape(-1)
    for _ in range(chance.choice((1, 1, 2, max(1, flat.size)))):
        if flat.size == 0 or flat.dtype.kind not in "fiu":
            break
        at = chance.randrange(flat.size)
        if chance.random() < 0.3:
            flat[at] = flat[chance.randrange(flat.size)]
        elif flat.dtype.kind == "f":
            with np.errstate(all="ignore"):
                flat[at] = chance.choice((*NUMBERS, flat[at] * 2, -flat[at],
                                          flat[at] * 10**chance.uniform(-9, 9)))
        else:
            info = np.iinfo(flat.dtype)
            flat[at] = min(max(int(chance.choice((*INTEGERS, int(flat[at]) + 1))), info.min),
                           info.max)
    return values


def _change_dataset(file, name, chance):
    data = file[name]
    values = np.zeros(0) if isinstance(data[()], h5py.Empty) else data[()]
    way = chance.randrange(3 if data.shape is None else 0, 9)
    if way <= 2:
        data[...] = _odd_entries(values, chance)
        return
    attributes = dict(data.attrs)
    del file[name]
    if way == 3:
        return
    if way == 4:
        values = np.asarray(values)
        with np.errstate(all="ignore"):
            values = values.astype(chance.choice(
                TYPES)) if values.dtype.kind in "fiu" else np.zeros(3)
    elif way == 5:
        rows = np.atleast_1d(values)
        values = chance.choice((rows[:-1], np.concatenate([rows, rows]), rows[:0], rows[::-1],
                                np.concatenate([rows, rows[:1]])))
    elif way == 6:
        values = chance.choice((np.float64(1), np.zeros(np.shape(values) + (1,)), np.ravel(values),
                                np.asarray(values).T,
                                np.zeros((2, 2, 2)), h5py.Empty("f8"), np.zeros(4, [("x", "f8")]),
                                "text"))
    elif way == 7:
        file.create_group(name)
        return
    else:
        file[name] = chance.choice((h5py.SoftLink("/" + name), h5py.SoftLink("/nowhere"),
                                    h5py.ExternalLink("o.h5", "/" + name)))
        return
    file[name] = values
    for key, value in attributes.items():
        file[name].attrs[key] = value


def _change_attributes(file, name, chance):
    attributes = file[name].attrs
    known = list(attributes)
    way = chance.randrange(4) if known else 3
    if way == 3:
        attributes["odd"] = chance.choice((1.0, "x", np.zeros(3)))
    elif way == 2:
        del attributes[chance.choice(known)]
    else:
        key = chance.choice(known)
        old = attributes[key]
        wrong = (np.nan, np.inf, -1.0, 0.0, 1e300, "x", np.zeros(1000), 2**62, np.int8(-1),
                 h5py.Empty("f8"))
        if isinstance(old, str):
            wrong += (old + "x", old[:-1], "", old.upper())
        elif np.asarray(old).dtype.kind in "fiu":
            wrong += (np.asarray(old) * 2, np.asarray(old) + 1, np.asarray(old) * (1 + 1e-15))
        attributes[key] = chance.choice(wrong)


def changed(data, chance):
    """Bytes of an HDF5 file of which datasets, groups and attributes are changed by its own
    library."""
    store = io.BytesIO(data)
    with h5py.File(store, "a") as file:
        for _ in range(chance.choice((1, 1, 1, 2, 4))):
            names = _datasets(file)
            holders = ["/", *names]
            file.visititems(lambda name, item: holders.append(name) if isinstance(item, h5py.Group)
                            else None)
            way = chance.random()
            if way < 0.75 and names:
                _change_dataset(file, chance.choice(names), chance)
            elif way < 0.9:
                # Attributes are few: those that there are come first.
                some = [name for name in holders if len(file[name].attrs)]
                _change_attributes(file, chance.choice(some or holders), chance)
            elif way < 0.95:
                file[f"odd{chance.randrange(10**6)}"] = np.arange(3.0)
            elif len(file):
                del file[chance.choice(list(file))]
    return store.getvalue()


def names_in(folder):
    """Names of all datasets, groups and attributes of the files that are damaged."""
    names = set()
    for path in (*folder.glob("*.h5"), folder / "c/out/s/checkpoint.h5"):
        with h5py.File(path) as file:
            names.update(file.attrs)
            file.visititems(lambda name, item: names.update([*name.split("/"), *item.attrs]))
    return " ".join(sorted(names))
