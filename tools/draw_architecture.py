#!/usr/bin/python3
"""Draws the two pictures of docs/architecture.md from the sources.

    tools/draw_architecture.py             # writes docs/pictures/stages.svg and explicit_step.svg
    tools/draw_architecture.py --check     # writes nothing; exit code 1 if a picture is not current

stages.svg comes from the floe_stage lines of CMakeLists.txt. Each message of explicit_step.svg is
a piece of text that must stand in the function that it is drawn for, in this order; every call in
the step itself must have a message. A stage without a description, or a call that is gone or new,
ends the script with a line that says so.
"""
import argparse
import re
import sys
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs/pictures"
FONT = "font-family=\"'DejaVu Sans', Verdana, Arial, sans-serif\""

# One or two lines per stage.
ROLES = {
    "base": ("checked PETSc calls, collectives,", "rotations, ghosts of bodies, lanes"),
    "files": ("whole files, HDF5,", "log of a run"),
    "options": ("table of options, YAML,", "names and values"),
    "session": ("MPI and PETSc, command line,", "signals, crashes"),
    "geometry": ("polyhedra: volumes,", "clipping, overlap"),
    "mesh": ("Voronoi cells of", "a sheet"),
    "contact_laws": ("overlap, potential,", "friction, restitution"),
    "contact": ("bodies, obstacles, pairs", "that may touch; no mesh"),
    "active_contacts": ("contacts that touch: history,", "crushing, energies"),
    "lattice": ("bodies, beams, sets, state;", "partition, archive"),
    "solid": ("triangle meshes, their", "convex parts"),
    "forces": ("interface of a force, tangent,", "gravity, loads, boundaries"),
    "beams": ("beam kernel, moduli,", "calibration"),
    "submersion": ("submerged parts,", "waves"),
    "water": ("buoyancy, drag,", "added mass"),
    "contact_force": ("contact as a force:", "exchange, sharing"),
    "fracture_laws": ("strengths, damage,", "tips of cracks"),
    "fracture": ("beams that damage", "and break"),
    "model": ("part, forces, prescribed", "unknowns, Newton"),
    "run": ("steps around an integrator,", "ledger, checkpoints"),
    "statics": ("equilibrium,", "load steps"),
    "paths": ("equilibria along a path,", "load factor unknown"),
    "stability": ("stable step", "of explicit runs"),
    "leapfrog": ("update of bodies,", "works of forces"),
    "device": ("the step's text in tiles,", "for devices"),
    "explicit": ("the step, runs by leapfrog", "and Runge-Kutta"),
    "implicit": ("generalised-alpha", "method"),
    "output": ("history, frames,", "fields"),
    "run_folder": ("output folder,", "its lock and files"),
    "scene": ("table of keys,", "restart"),
    "scene_model": ("from a scene to a lattice", "and a model"),
    "simulation": ("from a model to a run,", "its plan and summary.json"),
}
# Names of libraries in CMakeLists.txt and on the picture.
LIBRARIES = {"PkgConfig::HDF5": "HDF5", "PkgConfig::YAML": "libyaml", "Eigen3::Eigen": "Eigen",
             "ZLIB::ZLIB": "zlib", "CGAL::CGAL": "CGAL", "nlohmann_json::nlohmann_json": "JSON"}


class Stale(Exception):
    """The sources and this script do not fit together."""


# -- stages ----------------------------------------------------------------------------------------
def stages():
    """{stage: (stages that it uses, libraries, whether it is compiled for each level)}, in the
    order of CMakeLists.txt."""
    text = re.sub(r"#.*", "", (ROOT / "CMakeLists.txt").read_text())
    found = {}
    for words in re.findall(r"^floe_stage\(([^)]*)\)", text, re.MULTILINE):
        name, *rest = words.split()
        lists, current = {"USES": [], "EXTERNAL": [], "PRIVATE": [], "ARITHMETIC": None}, None
        for word in rest:
            if word in lists:
                current = word
                if word == "ARITHMETIC":
                    lists[word] = True
            else:
                lists[current].append(word)
        libraries = [LIBRARIES.get(word, word) for word in lists["EXTERNAL"] + lists["PRIVATE"]]
        found[name] = (lists["USES"], libraries, bool(lists["ARITHMETIC"]))
    if missing := set(found) ^ set(ROLES):
        raise Stale(f"ROLES and the floe_stage lines of CMakeLists.txt differ: {sorted(missing)}")
    return found


def reduced(uses):
    """Edges (used, user) that follow from no others."""
    def above(name, seen):
        for one in uses[name]:
            if one not in seen:
                seen.add(one)
                above(one, seen)
        return seen
    edges = []
    for name, direct in uses.items():
        for one in direct:
            if not any(one in above(other, set()) for other in direct if other != one):
                edges.append((one, name))
    return edges


def spread(wanted, widths, gap):
    """Places as near to the wanted ones as boxes of these widths allow, in their order: the least
    sum of squares."""
    offsets, total = [], 0.0
    for k, width in enumerate(widths):
        total += 0.5 * width + (0.5 * widths[k - 1] + gap if k else 0)
        offsets.append(total)
    pools = []  # mean, weight
    for want, offset in zip(wanted, offsets):
        pools.append([want - offset, 1])
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            mean, weight = pools.pop()
            pools[-1] = [(pools[-1][0] * pools[-1][1] + mean * weight) / (pools[-1][1] + weight),
                         pools[-1][1] + weight]
    places = [mean for mean, weight in pools for _ in range(weight)]
    return [place + offset for place, offset in zip(places, offsets)]


def layout(names, edges, width_of, gap):
    """Rows of nodes and the place of each along its row: longest paths make the rows, a node for
    each row that a long edge crosses keeps it apart from boxes, neighbours order the rows."""
    row = {}
    for name in names:  # CMakeLists.txt names a stage after those that it uses
        row[name] = max((row[a] + 1 for a, b in edges if b == name), default=0)
    rows = [[] for _ in range(max(row.values()) + 1)]
    for name in names:
        rows[row[name]].append(name)
    chains, links = {}, []
    for a, b in edges:
        chain = [a, *((a, b, r) for r in range(row[a] + 1, row[b])), b]
        for node in chain[1:-1]:
            rows[node[2]].append(node)
        chains[a, b] = chain
        links += zip(chain, chain[1:])
    near, stiff = {}, 6  # edges that cross rows are to be straight
    for a, b in links:
        weight = stiff if a not in row and b not in row else 1
        near.setdefault(a, []).extend([b] * weight)
        near.setdefault(b, []).extend([a] * weight)
    at = {}
    for nodes in rows:
        for k, node in enumerate(nodes):
            at[node] = 200.0 * (k - 0.5 * (len(nodes) - 1))
    for _ in range(60):
        for nodes in [*rows, *reversed(rows)]:
            wanted = {node: sum(at[n] for n in near.get(node, [node]))
                      / len(near.get(node, [node])) for node in nodes}
            nodes.sort(key=lambda node: (wanted[node], str(node)))
            places = spread([wanted[node] for node in nodes], [width_of(n) for n in nodes], gap)
            at.update(zip(nodes, places))
    return rows, at, chains


def text_at(x, y, words, size=12, anchor="middle", **more):
    extra = "".join(f' {key.replace("_", "-")}="{value}"' for key, value in more.items())
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}"{extra}>'
            f'{escape(words)}</text>')


def svg(width, height, title, body):
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" {FONT} fill="#1a1a1a">',
        f"<title>{escape(title)}</title>",
        "<!-- written by tools/draw_architecture.py; do not edit -->",
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7.5" refY="4" markerWidth="7" '
        'markerHeight="7" orient="auto"><path d="M0 0.5 L8 4 L0 7.5 z" fill="#444"/></marker>'
        '</defs>',
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="white"/>', *body, "</svg>", ""])


def draw_stages():
    found = stages()
    edges = reduced({name: uses for name, (uses, _, _) in found.items()})
    box = {name: max(20 + 7.0 * max(map(len, ROLES[name])), 90) for name in found}
    tall, pitch, margin = 62, 90, 20
    rows, at, chains = layout(list(found), edges,
                              lambda node: box[node] if node in box else 26, 14)
    least = min(at[name] - 0.5 * box[name] for name in found)
    least = min(least, *(at[n] - 13 for nodes in rows for n in nodes))
    most = max(at[n] + (0.5 * box[n] if n in box else 13) for nodes in rows for n in nodes)
    shift = margin - least
    width, height = most - least + 2 * margin, pitch * len(rows) + 76
    y_of = {node: margin + pitch * k for k, nodes in enumerate(rows) for node in nodes}
    body = []
    for (a, b), chain in chains.items():
        x, y = at[a] + shift, y_of[a] + tall
        path = f"M{x:.1f} {y:.1f}"
        for node in chain[1:]:
            to_x, to_y = at[node] + shift, y_of[node] - (2 if node in box else 0)
            half = 0.5 * (to_y - y)
            path += f" C{x:.1f} {y + half:.1f} {to_x:.1f} {to_y - half:.1f} {to_x:.1f} {to_y:.1f}"
            x, y = to_x, to_y
            if node not in box:  # beside the boxes of a row that it only crosses
                y += tall
                path += f" L{x:.1f} {y:.1f}"
        body.append(f'<path d="{path}" fill="none" stroke="#444" stroke-width="1.3" '
                    'marker-end="url(#tip)"/>')
    for name, (_, libraries, arithmetic) in found.items():
        x, y = at[name] + shift, y_of[name]
        fill = "#d9e9f7" if arithmetic else "#f0f0ee"
        body.append(f'<rect x="{x - 0.5 * box[name]:.1f}" y="{y}" width="{box[name]:.1f}" '
                    f'height="{tall}" rx="5" fill="{fill}" stroke="#667"/>')
        label = name + (f"  ({', '.join(libraries)})" if libraries else "")
        body.append(text_at(x, y + 19, label, 13, font_weight="bold"))
        for k, line in enumerate(ROLES[name]):
            body.append(text_at(x, y + 37 + 15 * k, line, 11.5))
    y = height - 54
    body.append(text_at(margin, y + 34, "An arrow leads from a stage to one that uses it; arrows "
                        "that follow from others are left out.", 11.5, "start"))
    for k, (fill, words) in enumerate([
            ("#d9e9f7", "runs in every step: compiled for each level of x86-64"),
            ("#f0f0ee", "compiled once")]):
        body.append(f'<rect x="{margin + 420 * k}" y="{y}" width="16" height="12" fill="{fill}" '
                    'stroke="#667"/>')
        body.append(text_at(margin + 24 + 420 * k, y + 11, words, 11.5, "start"))
    return svg(max(width, 640), height, "Stages of floe: each sees only those above it", body)


# -- one step of leapfrog --------------------------------------------------------------------------
TS, LEAPFROG, RUN, STEP, FORCES, CONTACT, OUT = range(7)
ACTORS = {TS: ("TS leapfrog", "explicit"), LEAPFROG: ("LeapfrogRun", "explicit"),
          RUN: ("DynamicRun", "run"), STEP: ("ExplicitStep", "explicit/step.h"),
          FORCES: ("Model, its forces", "model, forces, ..."),
          CONTACT: ("Contact", "contact_force"), OUT: ("Observer, disk", "output")}
STEP_FILE, STEP_AT = "src/explicit/explicit.cpp", "  bool step() {"
# Words in the step that are no calls worth a message.
QUIET = {"done", "dt", "if", "next_time"}
# file, first line of the function, then per message: its text there, from, to, words on the picture
# ("|" begins a second line, "*" says that ranks exchange messages).
SEAM = "src/explicit/step.h"
MESSAGES = [
    ("src/explicit/leapfrog.cpp", "PetscErrorCode step(TS ts) noexcept {",
     [("work(ts->time_step)", TS, LEAPFROG, "step()")]),
    (STEP_FILE, STEP_AT, [("step_->evaluate()", LEAPFROG, STEP, "evaluate(), not in step 0")]),
    (SEAM, "  void evaluate() {",
     [("ghosts.update(", STEP, STEP, "ghosts' records *"),
      ("model_.evaluate(", STEP, FORCES, "evaluate(state at t_n)")]),
    ("src/model/model.cpp",
     "::evaluate(const State<Space>& state, Wrenches<Space>& wrenches) const {",
     [("force->add(", FORCES, FORCES, "add(): beams, water, loads ...")]),
    ("src/contact_force/contact.cpp",
     "void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {",
     [("contacts_.list().changed()", FORCES, CONTACT, "add(), the last force"),
      ("expiry_.is_due(", CONTACT, CONTACT, "is the list of pairs too old? *"),
      ("build(state)", CONTACT, CONTACT, "a new list of pairs, if due *"),
      ("halo_.gather(", CONTACT, CONTACT, "records of bodies in pairs *"),
      ("balance_.evaluate(", CONTACT, CONTACT, "overlaps, laws, wrenches *")]),
    (STEP_FILE, STEP_AT, [("sample_if_due()", LEAPFROG, RUN, "sample_if_due()")]),
    ("src/run/dynamic_run.cpp", "bool DynamicRun<Space>::sample(bool last) {",
     [("model_.report(", RUN, FORCES, "report(): energies *"),
      ("ledger_.take(", RUN, RUN, "energy balance, its limit"),
      ("observer_(", RUN, OUT, "row of history.csv, frame *")]),
    (STEP_FILE, STEP_AT, [
        ("keep_step_stable()", LEAPFROG, LEAPFROG,
         "keep_step_stable(): a new|stable step, if due *"),
        ("step_->advance(", LEAPFROG, STEP, "advance(): kick and drift of owned bodies"),
        ("step_->commit(", LEAPFROG, STEP, "commit()")]),
    (SEAM, "  void commit(double dt) {",
     [("work_.take_powers(", STEP, FORCES, "powers() of the evaluation"),
      ("role->commit(", STEP, FORCES, "commit(): history of damage and slip")]),
    ("src/contact_force/contact.cpp",
     "void commit(const State<Spatial>& state, double dt) override {",
     [("contacts_.commit(", FORCES, CONTACT, "commit(): friction, crushing"),
      ("obstacle_forces_.take(", CONTACT, CONTACT, "peaks on obstacles *")]),
    (SEAM, "  void commit(double dt) {",
     [("work_.take_step(", STEP, FORCES, "powers_with() new velocities: works")]),
    (STEP_FILE, STEP_AT, [("step_->release()", LEAPFROG, STEP, "release()")]),
    (SEAM, "  void release() {",
     [("role->release(", STEP, CONTACT, "release(pairs whose beam broke) *")]),
    (STEP_FILE, STEP_AT, [
        ("moved(", LEAPFROG, RUN, "moved(): t_n+1; every 100 steps|the velocity limit *"),
        ("look_around()", LEAPFROG, RUN, "look_around()")]),
    ("src/run/dynamic_run.cpp", "bool DynamicRun<Space>::look_around() {",
     [("checkpoints_.wish(", RUN, RUN, "is a stop or a checkpoint due? *"),
      ("write_checkpoint()", RUN, OUT, "checkpoint, if due *")]),
]


def body_of(file, head):
    """Text of the function whose first line holds `head`."""
    text = (ROOT / file).read_text()
    start = text.find(head)
    if start < 0:
        raise Stale(f"{file}: no function '{head}'")
    at = text.find("{", start + len(head.rstrip("{")))
    depth, end = 1, at + 1
    while depth > 0:
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        end += 1
    return re.sub(r"//.*", "", text[at:end])


def check_messages():
    """Each message's text stands in its function, after those before it; the step has no other
    calls."""
    place, drawn = {}, set()
    for file, head, messages in MESSAGES:
        body = body_of(file, head)
        for text, *_ in messages:
            at = body.find(text, place.get((file, head), 0))
            if at < 0:
                raise Stale(f"{file}: '{text}' does not follow in '{head.strip()}'")
            place[file, head] = at + len(text)
            if head == STEP_AT:
                drawn.add(re.findall(r"(\w+)\(", text)[0])
    calls = set(re.findall(r"(\w+)\(", body_of(STEP_FILE, STEP_AT))) - QUIET
    if calls != drawn:
        raise Stale(f"{STEP_FILE}: calls in step() and messages differ: {sorted(calls ^ drawn)}")


def draw_step():
    check_messages()
    column, left, top, line = 178, 88, 66, 31
    x_of = {actor: left + column * k for k, actor in enumerate(ACTORS)}
    width = left + column * (len(ACTORS) - 1) + 100
    body, arrows, y = [], [], top + 24
    for _, _, messages in MESSAGES:
        for _, start, end, words in messages:
            lines = words.replace(" *", "").split("|")
            ranks = words.endswith("*")
            colour = "#a33c00" if ranks else "#1a1a1a"
            a, b = x_of[start], x_of[end]
            if start == end:
                y += 8 + 13 * (len(lines) - 1)
                arrows.append(f'<path d="M{a + 4} {y - 9} h14 v13 h-12" fill="none" stroke="#444" '
                            'stroke-width="1.3" marker-end="url(#tip)"/>')
                for k, part in enumerate(lines):
                    body.append(text_at(a + 23, y + 2 - 13 * (len(lines) - 1 - k), part, 11,
                                        "start", fill=colour, stroke="white", stroke_width=4,
                                        paint_order="stroke"))
                y += line - 8
                continue
            y += 8 + 13 * (len(lines) - 1)
            step = 4 if b > a else -4
            arrows.append(f'<path d="M{a + step} {y} H{b - step}" fill="none" stroke="#444" '
                        'stroke-width="1.3" marker-end="url(#tip)"/>')
            for k, part in enumerate(lines):
                body.append(text_at(a + 10 * (1 if b > a else -1),
                                    y - 5 - 13 * (len(lines) - 1 - k), part, 11,
                                    "start" if b > a else "end", fill=colour, stroke="white",
                                    stroke_width=4, paint_order="stroke"))
            y += line - 8
    bottom = y + 4
    lanes = []
    for actor, (name, stage) in ACTORS.items():
        x = x_of[actor]
        lanes.append(f'<path d="M{x} {top} V{bottom}" stroke="#aab" stroke-width="1.2" '
                     'stroke-dasharray="4 3"/>')
        lanes.append(f'<rect x="{x - 76}" y="18" width="152" height="44" rx="5" fill="#d9e9f7" '
                     'stroke="#667"/>')
        lanes.append(text_at(x, 36, name, 13, font_weight="bold"))
        lanes.append(text_at(x, 53, stage, 11.5))
    body.append(text_at(12, bottom + 24, "In this colour: calls in which ranks exchange messages. "
                        "All ranks make them, and in the same order.", 11.5, "start",
                        fill="#a33c00"))
    return svg(width, bottom + 40, "One step of explicit dynamics, from t_n to t_n+1",
               lanes + body + arrows)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, compare only")
    check = parser.parse_args().check
    try:
        pictures = {"stages.svg": draw_stages(), "explicit_step.svg": draw_step()}
    except Stale as why:
        sys.exit(f"tools/draw_architecture.py: {why}")
    old = [name for name, text in pictures.items()
           if not (PICTURES / name).is_file() or (PICTURES / name).read_text() != text]
    if check:
        for name in old:
            print(f"docs/pictures/{name} is not current: run tools/draw_architecture.py")
        return 1 if old else 0
    for name in old:
        (PICTURES / name).write_text(pictures[name])
        print(f"docs/pictures/{name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
