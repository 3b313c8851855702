#include "floe/scene/keys.h"

#include <array>

namespace floe {
namespace {

using enum Kind;

// A new key needs one line here and one where scene.cpp or read_*.cpp reads it. Words of a choice
// are in the order of their enum. Columns: key, kind, default, unit, allowed, doc, count.
constexpr std::array table{
    OptionSpec{
        "integrator", choice, "quasistatic", "", "quasistatic | explicit | implicit",
        "how the state moves on: static equilibrium at each load step, or in time by leapfrog "
        "or by the generalised-alpha method"},
    OptionSpec{"backend", choice, "cpu", "", "cpu | loop | cuda",
               "what makes the steps of leapfrog: the processor; a device of NVIDIA, if floe is "
               "built for it; loop: the device's text on the processor, slow, for tests"},
    OptionSpec{
        "model: planar", choice, "auto", "", "auto | true | false",
        "three unknowns per body where nothing loads, moves or prescribes anything out of the "
        "x-y plane; true: an error where something does, false: always six"},
    OptionSpec{"model: rotational_inertia_factor", number, "1", "", ">= 1, <= 4",
               "explicit: all moments of inertia of the bodies times this, for a longer stable "
               "step; what rests stays as it is, what vibrates or tumbles becomes slower"},
    OptionSpec{"model: periodic", numbers, "0 0", "m", ">= 0, <= 1e9",
               "lengths after which the model repeats itself in x and in y, 0: it does not: bodies "
               "that leave at one side meet, or by bonds join, those of the other",
               2},
    OptionSpec{"forces", choices, "(required)", "",
               "beam | fracture | gravity | buoyancy | drag | contact",
               "the forces that act; options of a force that is not named are errors"},
    OptionSpec{"gravity", number, "9.81", "m/s^2", ">= 1e-12, <= 1e6",
               "acceleration of gravity, along -z"},
    OptionSpec{"lattice_file", text, "(none: the sheet is meshed)", "", "",
               "HDF5 file with bodies and beams (docs/model.md), instead of sheet:"},
    OptionSpec{"report", choices, "(none)", "", "tension | bending",
               "adds the numbers of a tension or bending test to summary.json"},
    OptionSpec{"check", flag, "false", "", "",
               "read, mesh and build everything, write nothing, stop before the run"},

    OptionSpec{"sheet: length", number, "40", "m", ">= 1e-9, <= 1e9",
               "extent in x; the plan is centred on the origin"},
    OptionSpec{"sheet: width", number, "(sheet: length)", "m", ">= 1e-9, <= 1e9", "extent in y"},
    OptionSpec{"sheet: periodic", flag, "false", "", "",
               "the sheet goes on beyond its bottom and top side as itself: the model repeats "
               "itself in y after sheet: width"},
    OptionSpec{"sheet: outline", text, "(none: the rectangle)", "", "",
               "GeoJSON or table of x, y: polygons with holes that the sheet fills, instead of "
               "length and width"},
    OptionSpec{"sheet: outline_feature", integer, "0", "", ">= 0, <= 2000000",
               "number of the one feature of the file that is taken, from 1; 0: all"},
    OptionSpec{"sheet: outline_scale", number, "1", "m", ">= 1e-12, <= 1e12",
               "length of one unit of the file's coordinates"},
    OptionSpec{"sheet: outline_place", numbers, "(as in the file)", "m", ">= -1e9, <= 1e9",
               "x, y to which the centroid comes", 2},
    OptionSpec{"sheet: outline_turn", number, "0", "degrees", ">= -360, <= 360",
               "turn about the centroid, counter-clockwise"},
    OptionSpec{"sheet: outline_simplify", number, "(0.5 or 0.8 element_size)", "m", ">= 0, <= 1e9",
               "corners that lie within this of the edge that takes their place are left out, the "
               "area stays; 0: none; by default each polygon the smaller with which cells can end "
               "on its edges"},
    OptionSpec{"sheet: thickness", number, "1", "m", ">= 1e-9, <= 1e9",
               "extent in z; with thickness_deviation the mean; where the features of the outline "
               "have a property thickness and the scene has no thickness, each floe has its own"},
    OptionSpec{"sheet: thickness_file", text, "(none)", "", "",
               "grid of thicknesses, linear in between: .csv (first a row of x, then rows of y and "
               "thicknesses), or HDF5 or netCDF-4 with x, y, thickness; instead of thickness"},
    OptionSpec{"sheet: thickness_deviation", number, "0", "m", ">= 0, <= 1e9",
               "standard deviation of a lognormal random field of thicknesses"},
    OptionSpec{"sheet: thickness_correlation", numbers, "(required)", "m", ">= 1e-9, <= 1e9",
               "correlation lengths of the random field in x and y: exp(-(d/L)^2/2)", 2},
    OptionSpec{"sheet: thickness_seed", integer, "1", "", ">= 0, <= 9223372036854775807",
               "of the random field; whatever the mesh"},
    OptionSpec{"sheet: element_size", number, "2", "m", ">= 1e-9, <= 1e9",
               "flat-to-flat size of the regular hexagon of the mean cell area"},
    OptionSpec{"sheet: seed", integer, "1", "", ">= 0, <= 9223372036854775807",
               "of the random generators: same seed, same mesh, on any number of ranks"},
    OptionSpec{"sheet: relaxation", choice, "lloyd", "", "lloyd | quasi_newton",
               "how cells become centroidal: Lloyd's algorithm (Du et al. 1999) or L-BFGS (Liu et "
               "al. 2009)"},
    OptionSpec{"sheet: iterations", integer, "150", "", ">= 0, <= 1000000",
               "most iterations of the relaxation"},
    OptionSpec{"sheet: tolerance", number, "0", "", ">= 0, <= 1",
               "the relaxation ends when no generator moves by more than this times element_size"},
    OptionSpec{"sheet: mesh_file", text, "(none)", "", "",
               "HDF5 file that keeps the relaxed generators: read if it is there, else written; "
               "scenes that share a sheet mesh it once"},
    OptionSpec{"sheet: fit_cuts", flag, "true", "", "",
               "cells end on the lines of cuts; false: the cells stay, and cuts follow them"},

    OptionSpec{
        "supply: strip", number, "(required)", "m", ">= 1e-9, <= 1e9",
        "ice without end joins the sheet's left side in strips of this length, each when the "
        "boundary on left has come so much nearer; sheet: length is a whole number of them"},
    OptionSpec{"supply: length", number, "(without end)", "m", ">= 1e-9, <= 1e12",
               "extent in x of all ice, with the sheet"},
    OptionSpec{"supply: edge", choice, "prescribed", "", "prescribed | absorbing",
               "far edge: moved by the boundary on left; or dashpots that take waves up, relative "
               "to the ice behind"},
    OptionSpec{"supply: velocity", numbers, "(required)", "m/s", ">= -1e6, <= 1e6",
               "absorbing: of the ice behind the far edge", 3},
    OptionSpec{
        "supply: pressure", number, "(none)", "Pa", ">= 0, <= 1e9",
        "absorbing, in place of the velocity: mean pressure with which the ice behind pushes "
        "the far edge, as fast as that goes"},
    OptionSpec{"supply: response", number, "1", "s", ">= 1e-9, <= 1e12",
               "absorbing, with a pressure: dashpots are relative to the mean motion of the edge "
               "over this time; waves longer than it come back"},
    OptionSpec{"supply: ramp", number, "0", "s", ">= 0, <= 1e12",
               "absorbing: that velocity or pressure rises linearly over this time"},
    OptionSpec{
        "supply: spring", number, "0", "m", ">= 0, <= 1e12",
        "absorbing: a spring as stiff as so much ice holds the edge to the ice behind, or it "
        "lags under a mean load; 0: none"},
    OptionSpec{"supply: region", numbers, "(all ice stays)", "m", ">= -1e9, <= 1e9",
               "x0, x1, y0, y1, z0, z1: pieces wholly outside are taken out when a strip is due",
               6},

    OptionSpec{
        "floe: names", names, "(none)", "", "",
        "floes in place of one sheet: one section each; sheet: gives what they have in common. "
        "They may touch; each is a set of its name"},
    OptionSpec{"floe: NAME: length", number, "(required)", "m", ">= 1e-9, <= 1e9",
               "a rectangle: its extent in x before it turns"},
    OptionSpec{"floe: NAME: width", number, "(length)", "m", ">= 1e-9, <= 1e9",
               "its extent in y before it turns"},
    OptionSpec{"floe: NAME: outline", text, "(none: the rectangle)", "", "",
               "file of its outline, as sheet: outline"},
    OptionSpec{"floe: NAME: outline_feature", integer, "0", "", ">= 0, <= 2000000",
               "number of the one feature of the file that is taken, from 1; 0: all"},
    OptionSpec{"floe: NAME: outline_scale", number, "1", "m", ">= 1e-12, <= 1e12",
               "length of one unit of the file's coordinates"},
    OptionSpec{"floe: NAME: outline_simplify", number, "(as of sheet)", "m", ">= 0, <= 1e9",
               "tolerance of its simplification, as sheet: outline_simplify"},
    OptionSpec{"floe: NAME: place", numbers, "(0 0; as in the file)", "m", ">= -1e9, <= 1e9",
               "x, y of its centroid", 2},
    OptionSpec{"floe: NAME: turn", number, "0", "degrees", ">= -360, <= 360",
               "turn about the centroid, counter-clockwise"},
    OptionSpec{"floe: NAME: thickness", number, "(sheet: thickness)", "m", ">= 1e-9, <= 1e9",
               "extent in z; else that of the sheet or of its field, or that of the file"},
    OptionSpec{"floe: NAME: element_size", number, "(sheet: element_size)", "m", ">= 1e-9, <= 1e9",
               "of its cells, as sheet: element_size"},
    OptionSpec{"floe: NAME: strength", number, "1", "", ">= 1e-6, <= 1e6",
               "fracture: its strengths over those of fracture:"},
    OptionSpec{"floe: NAME: energy", number, "1", "", ">= 1e-6, <= 1e6",
               "fracture: its energies per area over those of fracture:"},
    OptionSpec{"floe: NAME: seed", integer, "(sheet: seed)", "", ">= 0, <= 9223372036854775807",
               "of its mesh"},

    OptionSpec{"region: names", names, "(none)", "", "",
               "further sets of bodies: one section each"},
    OptionSpec{"region: NAME: box", numbers, "(required)", "m", ">= -1e9, <= 1e9",
               "x0, x1, y0, y1, z0, z1: the set is the bodies with their centroid inside", 6},
    OptionSpec{"region: NAME: edge", flag, "false", "", "",
               "of a sheet: the set is the bodies with an edge on the outline whose middle is "
               "inside"},
    OptionSpec{"cut: names", names, "(none)", "", "", "cuts through the sheet: one section each"},
    OptionSpec{
        "cut: NAME: from", numbers, "(required)", "m", ">= -1e9, <= 1e9",
        "x, y of one end: beams whose facet lies on the segment, or that cross it, are not made",
        2},
    OptionSpec{"cut: NAME: to", numbers, "(required)", "m", ">= -1e9, <= 1e9",
               "x, y of the other end", 2},

    OptionSpec{"bonds: gap", number, "(required)", "m", ">= 0, <= 1e6",
               "faces of two bodies, without a beam between them, that are at most this far apart "
               "at the start are frozen together, by a beam of their common area"},
    OptionSpec{
        "bonds: box", numbers, "(everywhere)", "m", ">= -1e9, <= 1e9",
        "x0, x1, y0, y1, z0, z1: where the middle of these faces lies, as of a layer that is "
        "consolidated down to z0",
        6},
    OptionSpec{"bonds: young", number, "(ice: young)", "Pa", ">= 1, <= 1e18",
               "Young's modulus of the bonds; required with lattice_file"},
    OptionSpec{"bonds: strength", number, "1", "", ">= 1e-6, <= 1e6",
               "fracture: strengths of the bonds over those of fracture:"},
    OptionSpec{"bonds: energy", number, "1", "", ">= 1e-6, <= 1e6",
               "fracture: energies per area of the bonds over those of fracture:"},

    OptionSpec{"ice: young", number, "4e9", "Pa", ">= 1, <= 1e18", "Young's modulus of the beams"},
    OptionSpec{"ice: poisson", number, "0.3", "", "> -1, < 0.5", "Poisson's ratio of the beams"},
    OptionSpec{"ice: density", number, "920", "kg/m^3", ">= 1e-6, <= 1e12",
               "density of the bodies"},

    OptionSpec{
        "beam: shear", choice, "one_point", "", "one_point | exact | none",
        "transverse stiffness: one-point Timoshenko, locking-free Timoshenko, Euler-Bernoulli"},
    OptionSpec{"beam: shear_factor", number, "0.8333333333333334", "", ">= 1e-6, <= 1e6",
               "shear correction of the section, 5/6 for a rectangle"},
    OptionSpec{"beam: torsion", choice, "saint_venant", "", "saint_venant | polar",
               "torsion constant of the section: Saint-Venant's series, or Iy + Iz"},
    OptionSpec{"beam: calibrate", choice, "none", "", "none | young | isotropic",
               "stiffnesses of a sheet's beams: of its ice; such that a large sheet has the ice's "
               "Young's modulus; or its Young's modulus and Poisson's ratio in stretching and in "
               "bending"},
    OptionSpec{"beam: kinematics", choice, "corotational", "", "corotational | linear",
               "any rotation (Crisfield 1990), or small displacements and rotations"},

    OptionSpec{
        "beam: damping_ratio", number, "0", "", ">= 0, <= 1e3",
        "dynamics: zeta of every dashpot, c = 2 zeta sqrt(m k) with the harmonic mean of the "
        "bodies' masses"},
    OptionSpec{"beam: damping_modes", choice, "all", "", "all | axial",
               "dynamics: dashpots on all six strains, or on the elongation only"},

    OptionSpec{"fracture: tensile_strength", number, "6e5", "Pa", ">= 1e-3, <= 1e15",
               "sigma_t: a beam cracks where its largest tensile stress, with shear, reaches it"},
    OptionSpec{"fracture: shear_strength", number, "(tensile_strength)", "Pa", ">= 1e-3, <= 1e15",
               "tau_c, of shear and torsion"},
    OptionSpec{"fracture: flexural_strength", number,
               "(as the beams give it; with calibrate: strength tensile_strength)", "Pa",
               ">= 1e-3, <= 1e15",
               "of the sheet: under a uniform moment its first beam breaks at this 6M/(b h^2), in "
               "the mean of x and y"},
    OptionSpec{"fracture: compressive_strength", number, "(none: beams do not crush)", "Pa",
               ">= 1e-3, <= 1e15",
               "sigma_c, at least 2 shear_strength: Mohr and Coulomb's law for beams under "
               "pressure; pressure then raises the shear that they stand"},
    OptionSpec{"fracture: calibrate", choice, "none", "", "none | strength",
               "tensile_strength and shear_strength are those of the beams; or of the sheet: the "
               "beams' are such that its first beam breaks at a mean stress sigma_t, in the mean "
               "of x and y"},
    OptionSpec{"fracture: energy", number, "15", "J/m^2", ">= 1e-9, <= 1e12",
               "dissipated per area of a section that breaks in tension or bending"},
    OptionSpec{"fracture: energy_shear", number, "(energy)", "J/m^2", ">= 1e-9, <= 1e12",
               "the same in shear or torsion"},
    OptionSpec{
        "fracture: propagation", choice, "strength", "", "strength | energy",
        "at a crack's tip beams break by their strengths, as elsewhere; or when the crack releases "
        "`energy` per area, by their stress and its opening, whatever the size of the elements"},
    OptionSpec{"fracture: weibull_modulus", number, "(none: equal strengths)", "", ">= 0.1, <= 1e6",
               "beams' strengths scatter with this modulus"},
    OptionSpec{"fracture: weibull_area", number, "(mean section of the beams)", "m^2",
               ">= 1e-12, <= 1e12",
               "section whose mean strength is the given one; larger ones are weaker"},
    OptionSpec{"fracture: seed", integer, "1", "", ">= 0, <= 9223372036854775807",
               "of the scatter"},

    OptionSpec{"water: density", number, "1010", "kg/m^3", ">= 1e-3, <= 1e6",
               "density of the water; its level is z = 0, or as level_table says"},
    OptionSpec{"water: drag_linear", number, "0", "N s/m^3", ">= 0, <= 1e12",
               "drag: c in the force -c A v on the submerged part, A the plan area of the body"},
    OptionSpec{"water: drag_coefficient", number, "0", "", ">= 0, <= 1e6",
               "drag: C_d in the force -density C_d A |v| v/2 on the submerged part"},
    OptionSpec{"water: drag", choice, "plan", "", "plan | faces",
               "drag: on the plan area at rest, at the centroid, by drag_linear and "
               "drag_coefficient; or on the wetted faces, with its moment"},
    OptionSpec{"water: drag_form", number, "1.1", "", ">= 0, <= 1e6",
               "drag: faces: C_d of faces that move against the water, for front and back"},
    OptionSpec{"water: drag_skin", number, "0.003", "", ">= 0, <= 1e6",
               "drag: faces: C_s of the flow along faces"},
    OptionSpec{"water: shelter", number, "(sheet: thickness)", "m", ">= 0, <= 1e6",
               "drag: faces: a face with another body this near along its normal feels no flow, as "
               "one that a beam joins; required with lattice_file; 0: beams only"},
    OptionSpec{"water: current", numbers, "0 0 0", "m/s", ">= -1e6, <= 1e6",
               "drag: velocity of the water", 3},
    OptionSpec{"water: current_table", text, "(current)", "", "",
               "drag: file of time, x, y, z [s, m/s], in place of current"},
    OptionSpec{"water: current_interpolation", choice, "linear", "", "linear | smooth",
               "of that table"},
    OptionSpec{"water: current_periodic", flag, "false", "", "", "that table repeats itself"},
    OptionSpec{
        "water: level_table", text, "(none: z = 0)", "", "",
        "explicit: file of time, level [s, m]: the height of the water's surface over z = 0"},
    OptionSpec{"water: level_interpolation", choice, "linear", "", "linear | smooth",
               "of that table"},
    OptionSpec{"water: level_periodic", flag, "false", "", "", "that table repeats itself"},
    OptionSpec{"water: pace", integer, "(10 with fracture or contact, else 1)", "", ">= 1, <= 100",
               "leapfrog: the water on a body is computed in every pace-th step, and earlier once "
               "the body has moved by 1 % of its thickness; in between it follows to first order"},
    OptionSpec{
        "water: added_mass", text, "0", "", "",
        "dynamics: a body takes along this part, 0 to 1e3, of the water that it displaces at "
        "rest; or plate: as a thin disc of its plan area that floats alone"},
    OptionSpec{"water: added_mass_axes", numbers, "(added_mass)", "", ">= 0, <= 1e3",
               "dynamics: the same parts along the body's principal axes 1, 2 and 3, then of the "
               "moments of inertia about them; instead of added_mass",
               6},

    OptionSpec{"waves: spectrum", choice, "regular", "", "regular | jonswap",
               "one wave, or a sea by the spectrum of Hasselmann et al. (1973)"},
    OptionSpec{"waves: height", number, "(required)", "m", ">= 1e-9, <= 1e3",
               "from trough to crest; jonswap: the significant height H_s"},
    OptionSpec{"waves: period", number, "(required)", "s", ">= 1e-3, <= 1e6",
               "jonswap: that of the peak, T_p; each wave must be at least 8 bodies long"},
    OptionSpec{"waves: direction", number, "0", "degrees", ">= -360, <= 360",
               "in which they travel, from x towards y"},
    OptionSpec{"waves: phase", number, "0", "degrees", ">= -360, <= 360",
               "regular: at the origin at time 0; 0 is a crest"},
    OptionSpec{"waves: depth", number, "(infinite)", "m", ">= 1e-3, <= 1e9", "of the water"},
    OptionSpec{"waves: ramp", number, "0", "s", ">= 0, <= 1e12",
               "their height rises linearly over this time"},
    OptionSpec{"waves: gamma", number, "3.3", "", ">= 1, <= 100",
               "jonswap: enhancement of the peak"},
    OptionSpec{"waves: components", integer, "50", "", ">= 1, <= 1000",
               "jonswap: number of waves, of equal height"},
    OptionSpec{"waves: seed", integer, "1", "", ">= 0, <= 9223372036854775807",
               "jonswap: of their phases"},

    OptionSpec{"contact: law", choice, "overlap", "", "overlap | potential",
               "force by the overlap's volume, or the gradient of an energy of it (Feng 2021)"},
    OptionSpec{"contact: young", number, "(ice: young)", "Pa", ">= 1, <= 1e15",
               "E_c: an overlap V presses with E_c V/(L_a + L_b), L half the cube root of a body's "
               "volume; required with lattice_file"},
    OptionSpec{"contact: young_broken", number, "(contact: young)", "Pa", ">= 1, <= 1e15",
               "E_c of pairs whose beam broke: new faces may press with the ice's own modulus"},
    OptionSpec{"contact: friction", number, "0.1", "", ">= 0, <= 1e3",
               "Coulomb's coefficient between bodies"},
    OptionSpec{"contact: friction_wet", number, "(contact: friction)", "", ">= 0, <= 1e3",
               "Coulomb's coefficient between bodies where they touch below still water, z < 0"},
    OptionSpec{"contact: plastic_limit", number, "(none)", "Pa", ">= 1e-3, <= 1e15",
               "most normal force over the contact's area; what is crushed is remembered"},
    OptionSpec{"contact: plastic_exponent", number, "0", "", ">= 0, <= 0.99",
               "m: plastic_limit is that of the area plastic_area, that of an area A is "
               "(A/plastic_area)^-m times as high"},
    OptionSpec{"contact: plastic_area", number, "1", "m^2", ">= 1e-6, <= 1e6",
               "with plastic_exponent: area for which plastic_limit holds"},
    OptionSpec{"contact: plastic_least", number, "0", "Pa", ">= 0, <= 1e15",
               "with plastic_exponent: least limit, of large areas"},
    OptionSpec{"contact: plastic_most", number, "(none)", "Pa", ">= 1e-3, <= 1e15",
               "with plastic_exponent: largest limit, of small areas"},
    OptionSpec{"contact: plastic_fast", number, "1", "", ">= 1e-3, <= 1e3",
               "part f of plastic_limit that is left when bodies approach fast: at the speed v it "
               "is f + (1 - f) exp(-v/plastic_speed) times as high"},
    OptionSpec{"contact: plastic_speed", number, "(required)", "m/s", ">= 1e-9, <= 1e6",
               "with plastic_fast: speed v_r over which plastic_limit falls"},
    OptionSpec{
        "contact: wear", flag, "true", "", "",
        "with plastic_limit: bodies lose what a contact has crushed when it parts; else they "
        "heal"},
    OptionSpec{"contact: initial_overlap", choice, "press", "", "press | stress_free",
               "what overlaps at the start presses apart (refused above a tenth of the smaller "
               "one's size), or is taken as rest"},
    OptionSpec{"contact: restitution", number, "1", "", ">= 1e-6, <= 1",
               "part of the speed that a central impact of a face on a plane gives back"},
    OptionSpec{"obstacle: names", names, "(none)", "", "",
               "rigid obstacles, and parts of them: one section each"},
    OptionSpec{"obstacle: NAME: shape", choice, "(required)", "",
               "halfspace | box | cone | cylinder | file", "what it is"},
    OptionSpec{
        "obstacle: NAME: part_of", text, "(it is an obstacle itself)", "", "",
        "name of the obstacle of which it is a part: they move as one, and only that one has "
        "friction, a motion and a mass; parts may meet at faces, not overlap"},
    OptionSpec{"obstacle: NAME: friction", number, "(contact: friction)", "", ">= 0, <= 1e3",
               "Coulomb's coefficient against it"},
    OptionSpec{"obstacle: NAME: friction_wet", number, "(friction)", "", ">= 0, <= 1e3",
               "Coulomb's coefficient against it below still water, z < 0; without it and without "
               "friction that of contact"},
    OptionSpec{"obstacle: NAME: velocity", numbers, "0 0 0", "m/s", ">= -1e6, <= 1e6",
               "of its motion; steady without ramp", 3},
    OptionSpec{"obstacle: NAME: angular_velocity", numbers, "0 0 0", "rad/s", ">= -1e6, <= 1e6",
               "it turns about its point, centre or base, about an axis of fixed direction; not a "
               "halfspace",
               3},
    OptionSpec{"obstacle: NAME: amplitude", numbers, "(none)", "m", ">= -1e6, <= 1e6",
               "of the oscillation amplitude sin(2 pi frequency time) that is added to its motion",
               3},
    OptionSpec{"obstacle: NAME: frequency", number, "(none)", "Hz", ">= 1e-9, <= 1e9",
               "of that oscillation; neither without the other"},
    OptionSpec{"obstacle: NAME: ramp", number, "0", "s", ">= 0, <= 1e12",
               "its velocity, angular velocity and amplitude rise linearly over this time"},
    OptionSpec{
        "obstacle: NAME: table", text, "(velocity)", "", "",
        "file of time and its displacement ux, uy, uz [m], or velocity vx, vy, vz [m/s], and "
        "rotation vector rx, ry, rz [rad], in place of the keys above"},
    OptionSpec{"obstacle: NAME: interpolation", choice, "linear", "", "linear | smooth",
               "of its table"},
    OptionSpec{"obstacle: NAME: periodic", flag, "false", "", "", "its table repeats itself"},
    OptionSpec{"obstacle: NAME: point", numbers, "0 0 0", "m", ">= -1e9, <= 1e9",
               "halfspace: a point of its plane; file: where the file's origin is", 3},
    OptionSpec{"obstacle: NAME: normal", numbers, "0 0 1", "", ">= -1e9, <= 1e9",
               "halfspace: points out of it", 3},
    OptionSpec{"obstacle: NAME: centre", numbers, "0 0 0", "m", ">= -1e9, <= 1e9",
               "box: its centre", 3},
    OptionSpec{"obstacle: NAME: size", numbers, "1 1 1", "m", ">= 1e-6, <= 1e7", "box: its edges",
               3},
    OptionSpec{"obstacle: NAME: rotation", numbers, "0 0 0", "degrees", ">= -1e6, <= 1e6",
               "box: about x, then y, then z", 3},
    OptionSpec{"obstacle: NAME: base", numbers, "0 0 0", "m", ">= -1e9, <= 1e9",
               "cone, cylinder: centre of the foot; the axis is vertical", 3},
    OptionSpec{"obstacle: NAME: radius", number, "1", "m", ">= 1e-6, <= 1e7",
               "cone, cylinder: of the foot"},
    OptionSpec{"obstacle: NAME: top_radius", number, "0", "m", ">= 0, <= 1e7", "cone: of the top"},
    OptionSpec{"obstacle: NAME: height", number, "1", "m", ">= 1e-6, <= 1e7", "cone, cylinder"},
    OptionSpec{"obstacle: NAME: facets", integer, "24", "", ">= 3, <= 1000",
               "cone, cylinder: sides of the polygon inside the circle"},
    OptionSpec{"obstacle: NAME: file", text, "(required)", "", "",
               "file: HDF5 file whose /shapes hold convex polyhedra, the parts of the obstacle; or "
               "STL or OBJ "
               "file of closed surfaces, which are divided into convex parts"},
    OptionSpec{"obstacle: NAME: unit", number, "1", "m", ">= 1e-6, <= 1e6",
               "STL, OBJ: length of the file's unit"},
    OptionSpec{"obstacle: NAME: tolerance", number, "0.01", "m", ">= 0, <= 1e6",
               "STL, OBJ: distance of convex parts from the solid's surface; 0: rounding"},
    OptionSpec{"obstacle: NAME: most_parts", integer, "1000", "", ">= 1, <= 100000",
               "STL, OBJ: a solid of more convex parts is refused"},
    OptionSpec{"obstacle: NAME: mass", number, "(it is fixed, or moves as it is told)", "kg",
               ">= 1e-9, <= 1e15",
               "the obstacle is a structure, a body that contacts, its support and loads move; its "
               "name is a set of bodies, for boundary, load and initial"},
    OptionSpec{"obstacle: NAME: inertia", numbers, "(of its shape)", "kg m^2", ">= 1e-9, <= 1e20",
               "structure: moments about axes of the world through its centre of mass", 3},
    OptionSpec{"obstacle: NAME: centre_of_mass", numbers, "(of its shape)", "m", ">= -1e9, <= 1e9",
               "structure: goes with inertia", 3},
    OptionSpec{"obstacle: NAME: added_mass", numbers, "0 0 0 0 0 0", "kg, kg m^2", ">= 0, <= 1e20",
               "structure: that of the water along x, y, z and about rx, ry, rz", 6},
    OptionSpec{"obstacle: NAME: floats", flag, "false", "", "",
               "structure: weight and water act on its shape; false: its support carries it"},
    OptionSpec{"obstacle: NAME: touches", choice, "all", "", "all | ice",
               "structure: what it touches; ice: it passes through obstacles and structures"},
    OptionSpec{"obstacle: NAME: support_stiffness", numbers, "0 0 0 0 0 0", "N/m, N m/rad",
               ">= 0, <= 1e20", "structure: of springs to the ground along x, y, z, rx, ry, rz", 6},
    OptionSpec{"obstacle: NAME: support_matrix", numbers, "(support_stiffness)", "N/m, N, N m/rad",
               ">= -1e20, <= 1e20",
               "structure: the whole matrix of these springs, row by row, symmetric", 36},
    OptionSpec{"obstacle: NAME: support_damping", numbers, "0 0 0 0 0 0", "N s/m, N m s/rad",
               ">= 0, <= 1e20", "structure: of dashpots along and about the same axes", 6},
    OptionSpec{"obstacle: NAME: support_damping_ratio", number, "(support_damping)", "",
               ">= 0, <= 2", "structure: of critical damping, of each component by itself"},
    OptionSpec{"obstacle: NAME: support_point", numbers, "(its centre of mass)", "m",
               ">= -1e9, <= 1e9", "structure: where its support holds it, at rest", 3},

    OptionSpec{"line: names", names, "(none)", "", "",
               "mooring lines of structures: one section each"},
    OptionSpec{"line: NAME: structure", text, "(required)", "", "",
               "the obstacle with a mass that it holds"},
    OptionSpec{"line: NAME: fairlead", numbers, "(required)", "m", ">= -1e9, <= 1e9",
               "its end on the structure, at rest", 3},
    OptionSpec{"line: NAME: anchor", numbers, "(required)", "m", ">= -1e9, <= 1e9",
               "its other end, "
               "fixed without anchor_velocity and anchor_table",
               3},
    OptionSpec{"line: NAME: anchor_velocity", numbers, "0 0 0", "m/s", ">= -1e6, <= 1e6",
               "of the anchor, as of a tug", 3},
    OptionSpec{"line: NAME: anchor_ramp", number, "0", "s", ">= 0, <= 1e12",
               "that velocity rises linearly over this time"},
    OptionSpec{"line: NAME: anchor_table", text, "(anchor_velocity)", "", "",
               "file of time and the anchor's displacement ux, uy, uz [m], or velocity vx, vy, vz "
               "[m/s], in place of them"},
    OptionSpec{"line: NAME: anchor_interpolation", choice, "linear", "", "linear | smooth",
               "of that table"},
    OptionSpec{"line: NAME: anchor_periodic", flag, "false", "", "", "that table repeats itself"},
    OptionSpec{"line: NAME: table", text, "(stiffness)", "", "",
               "file of length, tension [m, N]: lengths rise, tensions do not fall; straight in "
               "between and beyond, never below 0"},
    OptionSpec{"line: NAME: stiffness", number, "(required)", "N/m", ">= 1e-9, <= 1e15",
               "without a table: of a line whose tension is its pretension and this times how much "
               "longer it is"},
    OptionSpec{"line: NAME: pretension", number, "(required)", "N", ">= 0, <= 1e12",
               "tension at rest; optional with a table, whose lengths move to it"},
    OptionSpec{"line: NAME: damping", number, "0", "N s/m", ">= 0, <= 1e12",
               "of a dashpot along the line while it is taut"},

    OptionSpec{"boundary: names", names, "(none)", "", "", "prescribed motions: one section each"},
    OptionSpec{"boundary: NAME: set", text, "(required)", "", "", "the set of bodies"},
    OptionSpec{"boundary: NAME: fix", choices, "(required)", "", "x | y | z | rx | ry | rz",
               "the components that are prescribed; all others are free"},
    OptionSpec{"boundary: NAME: velocity", numbers, "0 0 0", "m/s", ">= -1e6, <= 1e6",
               "of the fixed components", 3},
    OptionSpec{"boundary: NAME: displacement", numbers, "(velocity)", "m", ">= -1e9, <= 1e9",
               "of the fixed components, instead of velocity", 3},
    OptionSpec{"boundary: NAME: angular_velocity", numbers, "0 0 0", "rad/s", ">= -1e6, <= 1e6",
               "of the fixed components; each body turns about its own centroid", 3},
    OptionSpec{"boundary: NAME: ramp", number, "0", "s", ">= 0, <= 1e12",
               "the motion rises linearly over this time"},
    OptionSpec{"boundary: NAME: table", text, "(velocity)", "", "",
               "file of time and the displacement ux, uy, uz [m] or velocity vx, vy, vz [m/s], the "
               "rotation rx, ry, rz [rad] or angular velocity wx, wy, wz [rad/s], in place of the "
               "keys above; fixed components without a column stay"},
    OptionSpec{"boundary: NAME: interpolation", choice, "linear", "", "linear | smooth",
               "of its table"},
    OptionSpec{"boundary: NAME: periodic", flag, "false", "", "", "its table repeats itself"},

    OptionSpec{"load: names", names, "(none)", "", "",
               "dead loads in world axes: one section each"},
    OptionSpec{"load: NAME: set", text, "(point)", "", "",
               "the set of bodies that share the load equally; either this or point"},
    OptionSpec{"load: NAME: point", numbers, "(set)", "m", ">= -1e9, <= 1e9",
               "x, y: the nearest body carries the load", 2},
    OptionSpec{"load: NAME: force", numbers, "0 0 0", "N", ">= -1e18, <= 1e18", "the total force",
               3},
    OptionSpec{"load: NAME: moment", numbers, "0 0 0", "N m", ">= -1e21, <= 1e21",
               "the total moment", 3},
    OptionSpec{"load: NAME: ramp", number, "0", "s", ">= 0, <= 1e12",
               "the load rises linearly over this time"},
    OptionSpec{"load: NAME: table", text, "(force, moment)", "", "",
               "file of time, fx, fy, fz [N], mx, my, mz [N m], in place of them"},
    OptionSpec{"load: NAME: interpolation", choice, "linear", "", "linear | smooth",
               "of its table: straight between rows, or a monotone cubic"},
    OptionSpec{"load: NAME: periodic", flag, "false", "", "",
               "its table repeats itself; else the first and the last row go on for ever"},

    OptionSpec{"initial: names", names, "(none)", "", "",
               "dynamics: initial motions, one section each; they override the lattice file's"},
    OptionSpec{"initial: NAME: set", text, "(required)", "", "", "the set of bodies"},
    OptionSpec{"initial: NAME: velocity", numbers, "0 0 0", "m/s", ">= -1e6, <= 1e6",
               "of each body", 3},
    OptionSpec{"initial: NAME: angular_velocity", numbers, "0 0 0", "rad/s", ">= -1e6, <= 1e6",
               "of each body", 3},

    OptionSpec{
        "time: end", number, "1", "s", ">= 1e-12, <= 1e12",
        "end of the run, from 0 (quasistatic: of the pseudo-time; what has no ramp acts fully)"},
    OptionSpec{"time: dt", number, "(auto)", "s", ">= 1e-15, <= 1e12",
               "step; auto: safety times the stable step (implicit: from the error of each step; "
               "quasistatic: one load step)"},
    OptionSpec{"time: safety", number, "0.9", "", ">= 1e-3, < 1",
               "explicit: dt auto is this times the stable step"},
    OptionSpec{"time: allow_unstable", flag, "false", "", "",
               "explicit: take a dt above the stable step all the same"},

    OptionSpec{"static: path", choice, "load", "", "load | arc",
               "quasistatic: load steps up to the full load; or arc-length control, which follows "
               "the equilibrium path past limit points, with the load factor as an unknown"},
    OptionSpec{"static: load_factor", number, "(1, or none with monitor)", "", ">= -1e12, <= 1e12",
               "arc: the path ends there; 1 is the full load and motion of all that has a ramp, or "
               "a velocity until time: end"},
    OptionSpec{"static: steps", integer, "1000", "", ">= 1, <= 100000000",
               "arc: the path ends after so many steps"},
    OptionSpec{"static: arc_length", number, "(auto)", "m", ">= 1e-15, <= 1e9",
               "arc: of the first step, the root mean square over bodies of displacements and of "
               "rotations times the mean beam length; it adapts to Newton's iterations; auto: a "
               "tenth of load_factor, at most a hundredth of the lattice's extent"},
    OptionSpec{"static: arc_length_min", number, "(arc_length/4096)", "m", ">= 1e-15, <= 1e9",
               "arc: a run that needs shorter steps ends"},
    OptionSpec{"static: arc_length_max", number, "(a twentieth of the lattice's extent)", "m",
               ">= 1e-15, <= 1e9", "arc: of the longest step"},
    OptionSpec{"static: monitor", text, "(none)", "", "",
               "arc: name of a load or boundary at whose displacement the path may end"},
    OptionSpec{"static: monitor_component", choice, "x", "", "x | y | z",
               "arc: of this displacement"},
    OptionSpec{"static: monitor_displacement", number, "(required)", "m", ">= -1e9, <= 1e9",
               "arc: the path ends there"},
    OptionSpec{"static: growth", number, "0.05", "", ">= 1e-6, <= 1",
               "arc, fracture: of s in a step of the softening beam that grows most, over s and "
               "over s_u - 1"},

    OptionSpec{"limit: velocity", number, "1000", "m/s", ">= 1e-9, <= 1e300",
               "dynamics: a body faster than this stops the run"},
    OptionSpec{
        "limit: energy_error", number, "0.1", "", ">= 1e-12, <= 1e300",
        "dynamics: an error of the energy balance above this part of the energies that moved "
        "stops the run"},

    OptionSpec{"limit: steps", number, "1e11", "", ">= 1, <= 1e18",
               "a run that would take more steps is refused before the first"},
    OptionSpec{"limit: frames", number, "1e5", "", ">= 1, <= 1e15",
               "the same for frames of fields.h5"},
    OptionSpec{"limit: disk", number, "1000", "GB", ">= 1e-6, <= 1e15",
               "the same for the room on disk"},
    OptionSpec{"limit: memory", number, "(auto)", "GB", ">= 1e-3, <= 1e9",
               "a sheet whose run would take more memory, by an estimate, is refused before it is "
               "meshed, more than is free is a warning; auto: three times what is free"},

    OptionSpec{"output: dir", text, "(out/SCENE)", "", "", "folder of the results"},
    OptionSpec{"output: overwrite", flag, "false", "", "",
               "take a folder that holds the checkpoint of an unfinished run, or files that are "
               "not floe's; never part of options.yaml"},
    OptionSpec{
        "output: history", number, "(auto)", "s", ">= 1e-12, <= 1e12",
        "between rows of history.csv, where steps of implicit end too; auto: every load step, "
        "dynamics: 200 rows at the most"},
    OptionSpec{"output: fields", number, "(first and last state)", "s", ">= 1e-12, <= 1e12",
               "between frames of fields.h5, where steps of implicit end too"},
    OptionSpec{"output: pressure", number, "(none)", "s", ">= 1e-9, <= 1e12",
               "with contact: between samples of the forces on patches of obstacles, in "
               "pressure.csv"},
    OptionSpec{"output: pressure_patch", number, "0.5", "m", ">= 1e-3, <= 1e6",
               "with pressure: edge of the patches"},

    OptionSpec{"partition: threshold", number, "1.15", "", ">= 1, <= 1e9",
               "explicit runs with contact: bodies move between ranks when the busiest has more "
               "than this many times the mean load, and has kept the others waiting for longer "
               "than a move takes; 1: at each look; states keep their bits"},
    OptionSpec{"partition: every", integer, "1000", "", ">= 1, <= 1000000000",
               "steps between looks at the loads"},

    OptionSpec{"checkpoint: every", number, "600", "s", ">= 1e-3, <= 1e9",
               "dynamics: run time (by the clock) between checkpoints; with a section checkpoint "
               "there is one at the end of the run too"},
    OptionSpec{
        "checkpoint: wall_time", duration, "(none)", "s", ">= 1, <= 1e9",
        "dynamics: the run ends with a checkpoint and exit code 3 before its process is that "
        "old by the clock; never part of options.yaml"},
    OptionSpec{
        "checkpoint: restart", text, "(none: from t = 0)", "", "",
        "dynamics: the checkpoint.h5 to go on from, in the same output folder, or auto: the newest "
        "good one of the output folder, if there is one; options that are not given anew are the "
        "checkpoint's (docs/restarts.md); the same to the last bit on as many ranks, but for "
        "implicit runs on several, which MUMPS rounds differently each time (displacements by up "
        "to 2e-15 of the largest)"},
};

}  // namespace

std::span<const OptionSpec> scene_keys() { return table; }

}  // namespace floe
