#include "floe/scene.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "floe/base/options.h"
#include "floe/base/petsc.h"
#include "keys.h"

namespace floe {
namespace {

constexpr std::array<std::string_view, 6> components{"x", "y", "z", "rx", "ry", "rz"};
constexpr std::array<std::string_view, 5> sheet_sets{"left", "right", "bottom", "top", "all"};

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

void read_forces(Options& options, Scene& scene) {
  const auto forces = options.words("forces");
  if (forces.empty()) throw InputError("forces: is empty; nothing would act");
  const auto named = [&](std::string_view force) {
    return std::find(forces.begin(), forces.end(), force) != forces.end();
  };
  scene.forces = {named("beam"),     named("fracture"), named("gravity"),
                  named("buoyancy"), named("drag"),     named("contact")};
  if (scene.forces.fracture && !scene.forces.beam)
    throw InputError("forces: fracture needs beam: it is beams that break");
  if (scene.forces.buoyancy && !scene.forces.gravity)
    throw InputError("forces: buoyancy needs gravity");
  if (scene.forces.drag && scene.integrator == Integrator::quasistatic)
    throw InputError(
        "forces: drag would have no effect: 'integrator' is quasistatic, nothing moves");
  if (scene.forces.contact && scene.integrator == Integrator::quasistatic)
    throw InputError(
        "forces: contact needs 'integrator: explicit': contacts have a memory and no tangent");
  const auto without = [](std::string_view force) {
    return "would have no effect: '" + std::string(force) + "' is not in 'forces'";
  };
  if (!scene.forces.beam) options.refuse("beam", without("beam"));
  if (!scene.forces.fracture) options.refuse("fracture", without("fracture"));
  if (!scene.forces.gravity) options.refuse("gravity", without("gravity"));
  for (const auto* section : {"contact", "obstacle"})
    if (!scene.forces.contact) options.refuse(section, without("contact"));
  if (!scene.forces.buoyancy && !scene.forces.drag) options.refuse("water", without("buoyancy"));
  if (!scene.forces.drag) {
    for (const auto* key : {"water: drag_linear", "water: drag_coefficient", "water: current"})
      options.refuse(key, without("drag"));
  }
}

void read_fracture(Options& options, Scene& scene) {
  FractureOptions& fracture = scene.fracture;
  fracture.tensile_strength = options.number("fracture: tensile_strength");
  fracture.shear_strength =
      options.number("fracture: shear_strength", {}, fracture.tensile_strength);
  enum class Calibration { none, strength };
  if (scene.has_sheet)
    fracture.calibrate =
        options.choice<Calibration>("fracture: calibrate") == Calibration::strength;
  fracture.energy = options.number("fracture: energy");
  fracture.energy_shear = options.number("fracture: energy_shear", {}, fracture.energy);
  fracture.dynamic = scene.integrator != Integrator::quasistatic;
  if (options.given("fracture: weibull_modulus")) {
    fracture.weibull_modulus = options.number("fracture: weibull_modulus");
    if (options.given("fracture: weibull_area"))
      fracture.weibull_area = options.number("fracture: weibull_area");
    fracture.seed = static_cast<std::uint64_t>(options.integer("fracture: seed"));
  } else {
    for (const auto* key : {"fracture: weibull_area", "fracture: seed"})
      options.refuse(key, "would have no effect without 'fracture: weibull_modulus'");
  }
}

void read_water(Options& options, Scene& scene) {
  const bool moves = scene.integrator != Integrator::quasistatic;
  if (moves) {
    scene.added_mass = options.number("water: added_mass");
  } else {
    options.refuse("water: added_mass", "would have no effect: 'integrator' is quasistatic");
  }
  if (scene.forces.drag) {
    scene.drag.linear = options.number("water: drag_linear");
    scene.drag.coefficient = options.number("water: drag_coefficient");
    scene.drag.current = options.numbers<3>("water: current");
    if (scene.drag.linear == 0 && scene.drag.coefficient == 0)
      throw InputError("forces: drag needs 'water: drag_linear' or 'water: drag_coefficient' > 0");
  }
  if (scene.forces.buoyancy || scene.drag.coefficient > 0 || scene.added_mass > 0) {
    scene.water_density = options.number("water: density");
  } else {
    options.refuse("water: density", "would have no effect on linear drag");
  }
  scene.drag.density = scene.water_density;
}

Vec3<double> vector(const Point3& p) { return {p[0], p[1], p[2]}; }

Obstacle read_shape(Options& options, const std::string& name) {
  enum class Shape { halfspace, box, cone, cylinder, file };
  const auto of = [&](const char* key) {
    return vector(options.numbers<3>("obstacle: NAME: " + std::string(key), name));
  };
  const auto shape = options.choice<Shape>("obstacle: NAME: shape", name);
  if (shape == Shape::halfspace) {
    const Vec3<double> point = of("point"), normal = of("normal");
    const double length2 = dot(normal, normal);
    if (!(length2 > 0 && std::isfinite(length2)))
      throw InputError("obstacle: " + name + ": normal: " + text_of(normal.x) + " " +
                       text_of(normal.y) + " " + text_of(normal.z) + " is no direction");
    return half_space(point, normal);
  }
  if (shape == Shape::box) {
    const Vec3<double> centre = of("centre"), size = of("size"), rotation = of("rotation");
    if (!(size.x > 0 && size.y > 0 && size.z > 0))
      throw InputError("obstacle: " + name + ": size: must be three numbers > 0 [m]");
    return box(centre, size, rotation);
  }
  if (shape == Shape::file) {
    const std::string file = options.text("obstacle: NAME: file", name);
    return polyhedron(read_polyhedron(file, "obstacle: " + name + ": file"), 0, of("point"));
  }
  const Vec3<double> base = of("base");
  const double radius = options.number("obstacle: NAME: radius", name),
               height = options.number("obstacle: NAME: height", name);
  const double top =
      shape == Shape::cone ? options.number("obstacle: NAME: top_radius", name) : radius;
  const std::int64_t facets = options.integer("obstacle: NAME: facets", name);
  if (facets < 3 || facets > 1000)
    throw InputError("obstacle: " + name + ": facets: " + std::to_string(facets) +
                     " must be between 3 and 1000");
  return cone(base, radius, top, height, static_cast<int>(facets));
}

ObstacleMotion read_motion(Options& options, const std::string& name, bool half_space) {
  const auto given = [&](const char* key) {
    return options.given("obstacle: NAME: " + std::string(key), name);
  };
  ObstacleMotion motion;
  motion.velocity = vector(options.numbers<3>("obstacle: NAME: velocity", name));
  if (half_space && given("angular_velocity"))
    throw InputError("obstacle: " + name +
                     ": angular_velocity: a halfspace cannot turn; box, cone, cylinder and file "
                     "can");
  if (!half_space)
    motion.angular_velocity = vector(options.numbers<3>("obstacle: NAME: angular_velocity", name));
  if (given("amplitude") != given("frequency"))
    throw InputError("obstacle: " + name +
                     (given("amplitude") ? ": amplitude [m] needs frequency [Hz]"
                                         : ": frequency [Hz] needs amplitude [m]"));
  if (given("amplitude")) {
    motion.amplitude = vector(options.numbers<3>("obstacle: NAME: amplitude", name));
    motion.frequency = options.number("obstacle: NAME: frequency", name);
  }
  // Left unread, and so refused, where nothing moves.
  if (given("velocity") || given("angular_velocity") || given("amplitude"))
    motion.ramp.seconds = options.number("obstacle: NAME: ramp", name);
  return motion;
}

void read_contact(Options& options, Scene& scene) {
  ContactOptions& contact = scene.contact;
  contact.law = options.choice<ContactLaw>("contact: law");
  if (!scene.has_sheet && !options.given("contact: young"))
    throw InputError("contact: young: is required with lattice_file [Pa]");
  contact.young = options.number("contact: young", {}, scene.ice.young);
  contact.friction = options.number("contact: friction");
  if (options.given("contact: plastic_limit"))
    contact.plastic_limit = options.number("contact: plastic_limit");
  contact.initial_overlap = options.choice<InitialOverlap>("contact: initial_overlap");
  const double restitution = options.number("contact: restitution");
  if (restitution > 1)
    throw InputError("contact: restitution: " + text_of(restitution) + " must be <= 1");
  contact.damping_ratio = damping_ratio_of(restitution);
  for (const std::string& name : options.names("obstacle")) {
    Obstacle obstacle = read_shape(options, name);
    obstacle.name = name;
    obstacle.friction = options.number("obstacle: NAME: friction", name, contact.friction);
    obstacle.motion = read_motion(options, name, obstacle.vertices.empty());
    scene.obstacles.push_back(std::move(obstacle));
  }
}

void read_sheet(Options& options, Scene& scene) {
  SheetPlan& plan = scene.sheet;
  plan.length = options.number("sheet: length");
  plan.width = options.number("sheet: width", {}, plan.length);
  plan.element_size = options.number("sheet: element_size");
  plan.seed = static_cast<std::uint64_t>(options.integer("sheet: seed"));
  plan.relaxation = options.choice<Relaxation>("sheet: relaxation");
  const std::int64_t iterations = options.integer("sheet: iterations");
  plan.iterations = static_cast<int>(std::min<std::int64_t>(iterations, 1'000'000'000));
  plan.tolerance = options.number("sheet: tolerance");
  if (options.given("sheet: mesh_file")) scene.mesh_file = options.text("sheet: mesh_file");
  scene.thickness = options.number("sheet: thickness");

  const double shorter = std::min(plan.length, plan.width);
  if (plan.element_size > shorter)
    throw InputError("sheet: element_size: " + text_of(plan.element_size) + " must be <= " +
                     (plan.width < plan.length ? "sheet: width " : "sheet: length ") +
                     text_of(shorter) + " [m]");
  constexpr double most_bodies = 1e8;  // indices of beams and facets are 32-bit
  const double bodies = (plan.length / plan.element_size) * (plan.width / plan.element_size);
  if (bodies > most_bodies)
    throw InputError("sheet: element_size: " + text_of(plan.element_size) + " would make about " +
                     text_of(bodies) + " bodies, at most " + text_of(most_bodies) +
                     " are possible");
}

void read_ice(Options& options, Scene& scene) {
  scene.ice.young = options.number("ice: young");
  scene.ice.poisson = options.number("ice: poisson");
  scene.ice.density = options.number("ice: density");
  if (!scene.forces.beam) return;
  scene.shear_factor = options.number("beam: shear_factor");
  scene.calibrate = options.choice<Calibrate>("beam: calibrate");
  if (scene.calibrate != Calibrate::isotropic) {
    scene.torsion = options.choice<Torsion>("beam: torsion");
    return;
  }
  if (scene.ice.poisson > largest_isotropic_poisson)
    throw InputError("ice: poisson: " + text_of(scene.ice.poisson) +
                     " must be <= 1/3 for beam: calibrate: isotropic, or stiffnesses are negative");
  for (const auto* key : {"beam: shear", "beam: torsion"})
    options.refuse(key, "would have no effect: 'beam: calibrate' is isotropic");
}

void read_lattice_source(Options& options, Scene& scene) {
  scene.has_sheet = options.given_section("sheet");
  const bool has_file = options.given("lattice_file");
  if (scene.has_sheet && has_file)
    throw InputError(
        "lattice_file: a scene has either 'sheet' or 'lattice_file', this one has both");
  if (!scene.has_sheet && !has_file)
    throw InputError("sheet: a scene needs either 'sheet' or 'lattice_file', this one has neither");
  if (scene.has_sheet) {
    read_sheet(options, scene);
    read_ice(options, scene);
  } else {
    scene.lattice_file = options.text("lattice_file");
    constexpr auto said_by_file = "would have no effect: 'lattice_file' says it";
    for (const auto* key : {"ice", "beam: shear_factor", "beam: torsion", "beam: calibrate"})
      options.refuse(key, said_by_file);
    options.refuse("fracture: calibrate",
                   "needs 'sheet': a lattice file says nothing of a sheet's section");
  }
}

void read_regions_and_cuts(Options& options, Scene& scene) {
  for (const std::string& name : options.names("region")) {
    const Region region{name, options.numbers<6>("region: NAME: box", name)};
    const auto& box = region.box;
    if (box[0] > box[1] || box[2] > box[3] || box[4] > box[5])
      throw InputError("region: " + name +
                       ": box: must be x0, x1, y0, y1, z0, z1 with x0 <= x1, "
                       "y0 <= y1, z0 <= z1 [m]");
    const auto last = scene.has_sheet ? sheet_sets.begin() : sheet_sets.end() - 1;
    if (std::find(last, sheet_sets.end(), name) != sheet_sets.end())
      throw InputError("region: names: '" + name + "' is the name of a set that there is already");
    scene.regions.push_back(region);
  }
  for (const std::string& name : options.names("cut")) {
    const Cut cut{name, options.numbers<2>("cut: NAME: from", name),
                  options.numbers<2>("cut: NAME: to", name)};
    if (cut.from == cut.to) throw InputError("cut: " + name + ": from and to are the same point");
    scene.cuts.push_back(cut);
  }
}

/// Values of components that are not fixed would be ignored in silence.
void check_fixed(const Boundary& boundary, const std::string& key, const Point3& values,
                 std::size_t first) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (values[k] != 0 && !boundary.fixed[first + k])
      throw InputError("boundary: " + boundary.name + ": " + key + ": " + text_of(values[k]) +
                       " has no effect: '" + std::string(components[first + k]) +
                       "' is not in 'boundary: " + boundary.name + ": fix'");
  }
}

Boundary read_boundary(Options& options, const std::string& name) {
  Boundary boundary;
  boundary.name = name;
  boundary.set = options.text("boundary: NAME: set", name);
  for (const std::string& word : options.words("boundary: NAME: fix", name)) {
    const auto at = std::find(components.begin(), components.end(), word) - components.begin();
    boundary.fixed[static_cast<std::size_t>(at)] = true;
  }
  if (std::none_of(boundary.fixed.begin(), boundary.fixed.end(), [](bool fixed) { return fixed; }))
    throw InputError("boundary: " + name + ": fix: is empty; nothing would be prescribed");
  if (options.given("boundary: NAME: displacement", name)) {
    if (options.given("boundary: NAME: velocity", name))
      throw InputError("boundary: " + name + ": give either velocity or displacement, not both");
    boundary.displacement = options.numbers<3>("boundary: NAME: displacement", name);
    check_fixed(boundary, "displacement", *boundary.displacement, 0);
  } else {
    boundary.velocity = Point3{};
    if (options.given("boundary: NAME: velocity", name))
      boundary.velocity = options.numbers<3>("boundary: NAME: velocity", name);
    check_fixed(boundary, "velocity", *boundary.velocity, 0);
  }
  boundary.angular_velocity = options.numbers<3>("boundary: NAME: angular_velocity", name);
  check_fixed(boundary, "angular_velocity", boundary.angular_velocity, 3);
  boundary.ramp.seconds = options.number("boundary: NAME: ramp", name);
  return boundary;
}

/// Bodies with mass cannot be displaced at once.
void require_motion(const Scene& scene, const Boundary& boundary) {
  if (scene.integrator == Integrator::quasistatic || boundary.ramp.seconds > 0 ||
      !boundary.displacement || *boundary.displacement == Point3{})
    return;
  throw InputError("boundary: " + boundary.name +
                   ": displacement needs ramp > 0 in a run with time: at once would be a jump");
}

Load read_load(Options& options, const std::string& name) {
  Load load;
  load.name = name;
  const bool on_set = options.given("load: NAME: set", name);
  const bool at_point = options.given("load: NAME: point", name);
  if (on_set == at_point)
    throw InputError("load: " + name + ": give either set or point, " +
                     (on_set ? "not both" : "neither is there"));
  if (on_set) load.set = options.text("load: NAME: set", name);
  if (at_point) load.point = options.numbers<2>("load: NAME: point", name);
  load.force = options.numbers<3>("load: NAME: force", name);
  load.moment = options.numbers<3>("load: NAME: moment", name);
  load.ramp.seconds = options.number("load: NAME: ramp", name);
  constexpr Point3 nothing{};
  if (load.force == nothing && load.moment == nothing)
    throw InputError("load: " + name + ": force and moment are both zero; it would have no effect");
  return load;
}

void read_time(Options& options, Scene& scene) {
  scene.limit.steps = options.number("limit: steps");
  scene.limit.frames = options.number("limit: frames");
  scene.limit.disk = options.number("limit: disk");
  scene.time.end = options.number("time: end");
  scene.time.dt = options.number("time: dt", {}, 0.0);
  if (scene.time.dt > scene.time.end)
    throw InputError("time: dt: " + text_of(scene.time.dt) + " must be <= time: end " +
                     text_of(scene.time.end) + " [s]");
}

/// What only time integration has a use for.
void read_dynamics(Options& options, Scene& scene) {
  if (scene.integrator == Integrator::quasistatic) {
    constexpr auto why = "would have no effect: 'integrator' is quasistatic";
    for (const auto* key : {"initial", "limit: velocity", "limit: energy_error", "checkpoint", "time: safety",
                            "time: allow_unstable", "beam: damping_ratio", "beam: damping_modes"})
      options.refuse(key, why);
    return;
  }
  if (scene.integrator == Integrator::implicit) {
    for (const auto* key : {"time: safety", "time: allow_unstable"})
      options.refuse(key, "would have no effect: 'integrator' is implicit, any step is stable");
  } else {
    scene.time.safety = options.number("time: safety");
    scene.time.allow_unstable = options.flag("time: allow_unstable");
  }
  scene.checkpoint.every = options.number("checkpoint: every");
  scene.checkpoint.at_end = options.given_section("checkpoint");
  scene.limit.velocity = options.number("limit: velocity");
  scene.limit.energy_error = options.number("limit: energy_error");
  for (const Obstacle& o : scene.obstacles) {
    const double speed = o.motion.largest_speed(o.radius());
    if (speed > scene.limit.velocity)
      throw InputError("obstacle: " + o.name + ": moves at up to " + text_of(speed) +
                       " m/s, limit: velocity allows " + text_of(scene.limit.velocity));
  }
  if (scene.forces.beam) {
    scene.beam.damping_ratio = options.number("beam: damping_ratio");
    scene.beam.damping_modes = options.choice<DampingModes>("beam: damping_modes");
    if (scene.beam.damping_ratio == 0 && options.given("beam: damping_modes"))
      throw InputError("beam: damping_modes: would have no effect: 'beam: damping_ratio' is 0");
  }
  for (const std::string& name : options.names("initial")) {
    const Initial initial{name, options.text("initial: NAME: set", name),
                          options.numbers<3>("initial: NAME: velocity", name),
                          options.numbers<3>("initial: NAME: angular_velocity", name)};
    scene.initials.push_back(initial);
  }
}

void read_report(Options& options, Scene& scene) {
  for (const std::string& word : options.words("report")) {
    if (word == "tension") scene.report.tension = true;
    if (word == "bending") scene.report.bending = true;
  }
}

/// Why results cannot be written to `dir`, or nothing. Looks, but makes nothing.
std::string output_problem(const std::string& dir) {
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(dir, error);
  // A link to nowhere counts as being there: no folder can be made in its place.
  while (!std::filesystem::exists(std::filesystem::symlink_status(there, error)) &&
         there.has_relative_path())
    there = there.parent_path();
  if (!std::filesystem::is_directory(there, error))
    return "output: dir: " + dir + " cannot be a folder: " + there.string() + " is not one";
  if (access(there.c_str(), W_OK | X_OK) != 0)
    return "output: dir: " + dir + " cannot be written: no permission for " + there.string();
  return {};
}

void read_output(Options& options, Scene& scene) {
  scene.output.dir = options.text("output: dir", {}, "out/" + scene.name);
  scene.output.history = options.number("output: history", {}, 0.0);
  if (options.given("output: fields")) scene.output.fields = options.number("output: fields");
  throw_verdict(rank() == 0 ? output_problem(scene.output.dir) : "", PETSC_COMM_WORLD);
}

/// A floating sheet needs a draft within its thickness.
void check_floats(const Scene& scene) {
  if (scene.has_sheet && scene.forces.buoyancy && scene.ice.density >= scene.water_density)
    throw InputError("ice: density: " + text_of(scene.ice.density) + " must be < water: density " +
                     text_of(scene.water_density) + " [kg/m^3], or the sheet sinks");
}

}  // namespace

Scene read_scene(const std::string& path) {
  Options options(scene_keys());
  Scene scene;
  scene.path = path;
  scene.name = std::filesystem::path(path).stem().string();
  scene.integrator = options.choice<Integrator>("integrator");
  scene.planar = options.choice<Planarity>("model: planar");
  read_forces(options, scene);
  read_lattice_source(options, scene);
  read_regions_and_cuts(options, scene);
  if (scene.forces.beam) {
    if (scene.calibrate != Calibrate::isotropic)
      scene.beam.shear = options.choice<Shear>("beam: shear");
    scene.beam.kinematics = options.choice<Kinematics>("beam: kinematics");
  }
  if (scene.forces.fracture) read_fracture(options, scene);
  if (scene.forces.gravity) scene.gravity = options.number("gravity");
  if (scene.forces.buoyancy || scene.forces.drag) read_water(options, scene);
  if (scene.forces.contact) read_contact(options, scene);
  check_floats(scene);
  for (const std::string& name : options.names("boundary")) {
    scene.boundaries.push_back(read_boundary(options, name));
    require_motion(scene, scene.boundaries.back());
  }
  for (const std::string& name : options.names("load"))
    scene.loads.push_back(read_load(options, name));
  read_time(options, scene);
  read_dynamics(options, scene);
  read_report(options, scene);
  read_output(options, scene);
  scene.check_only = options.flag("check");
  scene.options_yaml = options.yaml();  // without the restart: it repeats the whole run
  if (options.given("checkpoint: restart"))
    scene.checkpoint.restart = options.text("checkpoint: restart");
  options.reject_unread();
  return scene;
}

std::string options_help() {
  return "floe: a floating ice sheet as rigid bodies joined by beams\n\n"
         "usage: floe SCENE.yaml [-key value ...]      (or: mpiexec -n N floe ...)\n\n"
         "Options nest in the scene (sheet: {length: 40}) and join on the command line "
         "(-sheet_length 40),\n"
         "which wins. Lists are separated by commas or blanks. Solver options are PETSc's own: "
         "-snes_*,\n"
         "-ksp_*, -pc_*, -log_view, ...\n\n" +
         help_text(scene_keys());
}

std::string options_markdown() {
  return "# Options\n\n"
         "Written by `floe -help_markdown` from the table in `src/scene/keys.cpp`; do not edit.\n\n"
         "In a scene, options nest (`sheet: {length: 40}`); on the command line they join with "
         "`_`\n"
         "(`-sheet_length 40`) and win over the scene. Lists are separated by commas or blanks. "
         "`NAME`\n"
         "stands for each name of the section's list `names`. An option that would have no effect "
         "is an\n"
         "error. Solver options are PETSc's own (`-snes_*`, `-ksp_*`, `-pc_*`, `-log_view`, "
         "...).\n" +
         help_markdown(scene_keys());
}

std::string options_man() { return help_man(scene_keys()); }

}  // namespace floe
