"""The ice of a frame of a run in which ice joins and leaves, as a lattice that can be written for
lattice_file: of a scene. SI units."""
import numpy as np

from floe import lattice as fl


def plan_moments(plan):
    """Second moments (xx, yy, xy) of the area of a polygon k x 2 about the origin [m^4]."""
    x, y = plan.T
    u, v = np.roll(plan, -1, axis=0).T
    area = x * v - u * y
    return (np.sum(area * (x * x + x * u + u * u)) / 12,
            np.sum(area * (y * y + y * v + v * v)) / 12,
            np.sum(area * (2 * x * y + x * v + u * y + 2 * u * v)) / 24)


def lattice_of(ice, options):
    """ice: of Output.at, at rest; options: of the run. Bodies are prisms: their principal axes are
    z and those of their plans."""
    moments = np.array([plan_moments(plan - place[:2])
                        for plan, place in zip(ice.plans(), ice.position)]).T
    xx, yy, xy = moments
    turn = fl.turn_about_z(np.arctan2(2 * xy, xx - yy) / 2)
    half = np.hypot((xx - yy) / 2, xy)
    z = ice.shapes["vertices"][:, 2]
    height = -2 * np.minimum.reduceat(z, ice.shapes["vertex_of"][:-1])
    density = float(options["ice_density"])
    slab, plate = ice.mass * height**2 / 12, density * height
    inertia = np.column_stack([plate * ((xx + yy) / 2 - half) + slab,
                               plate * ((xx + yy) / 2 + half) + slab, plate * (xx + yy)])
    body = np.repeat(np.arange(len(ice.mass)), np.diff(ice.shapes["vertex_of"]))
    vertices = np.einsum("vji,vj->vi", fl.matrices(turn)[body], ice.shapes["vertices"])
    shapes = fl.Shapes(vertices, *(ice.shapes[name] for name in ("corners", "corner_of", "face_of",
                                                                  "vertex_of")))
    sets = {name: list(bodies) for name, bodies in ice.sets.items() if len(bodies)}
    return fl.Lattice(ice.position, turn, ice.mass,
                      float(options.get("model_rotational_inertia_factor", 1)) * inertia,
                      ice.beams["bodies"], ice.beams["axis_y"], scalars(ice.beams, options), sets,
                      shapes)


def scalars(beams, options):
    """fl.BEAM_SCALARS of beams."""
    young, poisson = float(options["ice_young"]), float(options["ice_poisson"])
    is_polar = options["beam_torsion"] == "polar"
    torsion = (beams["inertia_y"] + beams["inertia_z"] if is_polar else
               np.array([fl.saint_venant_torsion(w, h)
                         for w, h in zip(beams["width"], beams["height"])]))
    alike = {"young": young, "shear_modulus": young / (2 * (1 + poisson)),
             "shear_factor": float(options["beam_shear_factor"])}
    count = len(beams["width"])
    found = {**beams, "torsion": torsion,
             **{name: np.full(count, value) for name, value in alike.items()}}
    return {name: found[name] for name in fl.BEAM_SCALARS}
