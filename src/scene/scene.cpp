#include "floe/scene.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <set>
#include <system_error>

#include "contact/surface_patches.h"
#include "floe/base/petsc.h"
#include "floe/options/options.h"
#include "floe/scene/keys.h"
#include "reading.h"
#include "restart_changes.h"
#include "run_folder/run_folder.h"
#include "units.h"

namespace floe {

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

namespace {

/// Reads after which lengths the model repeats itself, after forces and bonds.
void read_periods(Options& options, Scene& scene) {
  if (scene.integrator == Integrator::quasistatic) {
    options.refuse("model: periodic",
                   "needs 'integrator' explicit or implicit: statics look for free rigid motions "
                   "of bodies that do not repeat themselves");
    return;
  }
  if (!scene.forces.contact && !scene.bonds.given && !scene.sheet.periodic) {
    options.refuse("model: periodic",
                   "would have no effect: bodies neither touch ('forces': contact) nor freeze "
                   "together ('bonds')");
    return;
  }
  auto [x, y] = options.numbers<2>("model: periodic");
  if (scene.sheet.periodic) {
    if (y != 0 && y != scene.sheet.width)
      throw InputError("model: periodic: " + text_of(y) + " along y must be sheet: width " +
                       text_of(scene.sheet.width) + " [m], since 'sheet: periodic' is true");
    y = scene.sheet.width;
  }
  scene.periods.length = {x, y, 0};
}

void read_time(Options& options, Scene& scene) {
  scene.limit.steps = options.number("limit: steps");
  scene.limit.frames = options.number("limit: frames");
  scene.limit.disk = options.number("limit: disk");
  scene.time.end = options.number("time: end");
  if (scene.path_control.arc) {
    options.refuse("time: dt",
                   "would have no effect: 'static: path' is arc, by static: arc_length");
    return;
  }
  scene.time.dt = options.number("time: dt", {}, 0.0);
  if (scene.time.dt > scene.time.end)
    throw InputError("time: dt: " + text_of(scene.time.dt) + " must be <= time: end " +
                     text_of(scene.time.end) + " [s]");
}

/// Reads the keys that only dynamics need, or refuses them in statics.
void read_dynamics(Options& options, Scene& scene) {
  if (scene.integrator == Integrator::quasistatic) {
    constexpr auto why = "would have no effect: 'integrator' is quasistatic";
    for (const auto* key :
         {"initial", "limit: velocity", "limit: energy_error", "checkpoint", "partition",
          "time: safety", "time: allow_unstable", "backend", "beam: damping_ratio",
          "beam: damping_modes", "model: rotational_inertia_factor"})
      options.refuse(key, why);
    return;
  }
  if (scene.integrator == Integrator::implicit) {
    for (const auto* key : {"time: safety", "time: allow_unstable"})
      options.refuse(key, "would have no effect: 'integrator' is implicit, any step is stable");
    options.refuse("backend", "makes explicit steps; 'integrator' is implicit");
    options.refuse("model: rotational_inertia_factor",
                   "would gain nothing: 'integrator' is implicit, any step is stable");
  } else {
    scene.time.safety = options.number("time: safety");
    scene.time.allow_unstable = options.flag("time: allow_unstable");
    scene.inertia_factor = options.number("model: rotational_inertia_factor");
    scene.backend = options.choice<Backend>("backend");
    const std::string type = options.petsc("ts_type");
    if (scene.backend != Backend::cpu && !type.empty() && type != "leapfrog")
      throw InputError(std::string("backend: ") + name_of(scene.backend) +
                       " makes steps of leapfrog, -ts_type " + type + " does not");
  }
  if (scene.integrator == Integrator::explicit_ && scene.forces.contact) {
    scene.partition.threshold = options.number("partition: threshold");
    scene.partition.every = options.integer("partition: every");
  } else {
    options.refuse("partition",
                   "would have no effect: bodies move between ranks in explicit runs with contact");
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
    if (scene.beam.damping_ratio == 0)
      options.refuse("beam: damping_modes", "would have no effect: 'beam: damping_ratio' is 0");
  }
  for (const std::string& name : options.names("initial")) {
    const Initial initial{name, options.text("initial: NAME: set", name),
                          options.vector("initial: NAME: velocity", name),
                          options.vector("initial: NAME: angular_velocity", name)};
    scene.initials.push_back(initial);
  }
}

void read_report(Options& options, Scene& scene) {
  scene.report.may_go = options.has_command_line() && !options.on_command_line("report");
  for (const std::string& word : options.words("report")) {
    if (word == "tension") scene.report.tension = true;
    if (word == "bending") scene.report.bending = true;
  }
}

/// Returns why results cannot be written to `dir`; empty if they can. Creates nothing.
std::string output_problem(const std::string& dir) {
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(dir, error);
  // A link to nowhere counts as existing: no folder can be made in its place.
  while (!std::filesystem::exists(std::filesystem::symlink_status(there, error)) &&
         there.has_relative_path())
    there = there.parent_path();
  if (!std::filesystem::is_directory(there, error))
    return "output: dir: " + dir + " cannot be a folder: " + there.string() + " is not one";
  if (access(there.c_str(), W_OK | X_OK) != 0)
    return "output: dir: " + dir + " cannot be written: " + there.string() + ": " +
           std::strerror(errno);
  return {};
}

void read_pressure(Options& options, Scene& scene) {
  if (!scene.forces.contact) throw InputError("output: pressure: needs contact among 'forces'");
  scene.output.pressure = options.number("output: pressure");
  const double size = options.number("output: pressure_patch");
  bool any = false;
  for (Obstacle& obstacle : scene.obstacles) {
    if (obstacle.is_half_space()) continue;
    obstacle.patches = surface_patches(obstacle, size);
    any = true;
  }
  if (!any)
    throw InputError("output: pressure: needs an obstacle that is no halfspace, on which it is");
}

void read_output(Options& options, Scene& scene) {
  scene.output.dir = options.text("output: dir", {}, "out/" + scene.name);
  scene.output.history = options.number("output: history", {}, 0.0);
  if (options.given("output: fields")) scene.output.fields = options.number("output: fields");
  if (options.given("output: pressure")) read_pressure(options, scene);
  throw_verdict(rank() == 0 ? output_problem(scene.output.dir) : "", PETSC_COMM_WORLD);
}

/// Returns a question whether the water's density was meant in another unit; empty if it is
/// plausible.
std::string density_question(const Scene& scene) {
  const std::string question = unit_question(scene.water_density, "kg/m^3", 500, 2000);
  return question.empty() ? "" : "; water: density:" + question;
}

/// Checks that the draft of a floating sheet is within its thickness.
void check_floats(const Scene& scene) {
  if (scene.has_sheet && scene.forces.buoyancy && scene.ice.density >= scene.water_density)
    throw InputError("ice: density: " + text_of(scene.ice.density) + " must be < water: density " +
                     text_of(scene.water_density) + " [kg/m^3], or the sheet sinks" +
                     density_question(scene));
}

/// Checks that nothing takes z = 0 for the water's level where that changes.
void check_level(const Scene& scene) {
  if (scene.drag.level_table.empty()) return;
  const auto refuse = [](const std::string& key) {
    throw InputError(key +
                     ": friction_wet: does not go with 'water: level_table', it is for "
                     "contacts below z = 0");
  };
  if (scene.contact.friction_wet) refuse("contact");
  for (const Obstacle& o : scene.obstacles)
    if (o.friction_wet) refuse("obstacle: " + o.name);
}

/// Checks that nothing asks for one sheet where there are floes, or for the one thickness of a
/// sheet whose thickness varies.
void check_one_sheet(const Scene& scene) {
  if (!scene.thickness_field.varies() && scene.floes.empty()) return;
  const char* asks = scene.report.tension || scene.report.bending        ? "report"
                     : scene.forces.fracture && scene.fracture.calibrate ? "fracture: calibrate"
                     : scene.forces.fracture && scene.fracture.flexural_strength > 0
                         ? "fracture: flexural_strength"
                         : nullptr;
  if (asks != nullptr && !scene.floes.empty())
    throw InputError(std::string(asks) + ": is for one sheet, and the scene has 'floe: names'");
  if (asks != nullptr)
    throw InputError(std::string(asks) + ": is for sheets of one thickness, and '" +
                     (scene.outline.has_thickness          ? "sheet: outline"
                      : scene.thickness_field.file.empty() ? "sheet: thickness_deviation"
                                                           : "sheet: thickness_file") +
                     "' makes it vary");
}

/// Drops solver options that this run cannot use.
void leave_out_solvers(Options& options, const Scene& scene) {
  const bool chosen = options.on_command_line("integrator");
  if (scene.integrator == Integrator::quasistatic) options.leave_out("ts_", chosen);
  if (scene.integrator != Integrator::explicit_) return;
  for (const auto* family : {"snes_", "ksp_", "pc_", "mat_"}) options.leave_out(family, chosen);
}

/// Reads the whole scene. Keys without effect are refused, or collected in options.idle().
Scene read_all(Options& options, const std::string& path) {
  Scene scene;
  scene.path = path;
  scene.name = std::filesystem::path(path).stem().string();
  scene.integrator = options.choice<Integrator>("integrator");
  leave_out_solvers(options, scene);
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
  read_bonds(options, scene);
  read_periods(options, scene);
  if (scene.forces.gravity) scene.gravity = options.number("gravity");
  if (scene.forces.buoyancy || scene.forces.drag) read_water(options, scene);
  if (scene.forces.contact) read_contact(options, scene);
  check_floats(scene);
  check_level(scene);
  read_boundaries(options, scene);
  read_loads(options, scene);
  read_path_choice(options, scene);
  read_time(options, scene);
  read_path_control(options, scene);
  read_dynamics(options, scene);
  read_supply(options, scene);
  check_structures(scene);
  read_lines(options, scene);
  read_report(options, scene);
  read_output(options, scene);
  check_one_sheet(scene);
  scene.check_only = options.flag("check");
  // Options that concern only this part of the run are read after this, so that options.yaml
  // repeats the whole run and no more.
  scene.options_yaml = options_heading() + options.yaml();
  scene.output.overwrite = options.flag("output: overwrite");
  if (options.given("checkpoint: restart"))
    scene.checkpoint.restart = options.text("checkpoint: restart");
  if (scene.checkpoint.restart == "auto")
    scene.checkpoint.restart.clear();  // there is no checkpoint
  if (options.given("checkpoint: wall_time"))
    scene.checkpoint.wall_time = options.duration("checkpoint: wall_time");
  options.refuse_unread();
  return scene;
}

/// Returns the labels of the keys without effect in the scene's file alone, without the command
/// line, as far as it can be read so.
std::set<std::string> idle_without_command_line(const std::string& path, const UserOptions& user) {
  std::set<std::string> labels;
  try {
    Options options(scene_keys(), {.environment = {}, .scene = user.scene, .command_line = {}},
                    Options::Idle::kept);
    try {
      (void)read_all(options, path);
    } catch (const InputError&) {  // the command line may correct it
    }
    for (const IdleKey& key : options.idle()) labels.insert(key.label);
  } catch (const InputError&) {
  }
  return labels;
}

/// Refuses keys of the file without effect, unless the command line is the cause, which gives a
/// remark.
void judge_idle_keys(const Options& options, const std::string& path, const UserOptions& user,
                     Scene& scene) {
  if (options.idle().empty()) return;
  const std::set<std::string> already = idle_without_command_line(path, user);
  std::vector<std::string> labels;
  for (const IdleKey& key : options.idle()) {
    if (already.contains(key.label)) throw InputError(key.label + ": " + key.why);
    labels.push_back(key.label);
  }
  scene.remarks.push_back("left without effect by the command line: " + some_of(labels) +
                          (labels.size() == 1 ? " (" + options.idle().front().why + ")" : ""));
}

}  // namespace

Scene read_scene(const std::string& path, const UserOptions& user) {
  refuse_changes(user);
  Options options(scene_keys(), user);
  Scene scene = read_all(options, path);
  refuse_additions(options, user);
  judge_idle_keys(options, path, user, scene);
  scene.unused_options = options.may_stay_unused();
  scene.warnings = unusual_numbers(scene);
  if (std::string remark = options.environment_remark(); !remark.empty())
    scene.remarks.insert(scene.remarks.begin(), remark);
  return scene;
}

std::string options_topic(const std::string& topic) { return help_topic(scene_keys(), topic); }

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
