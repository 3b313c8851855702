// Reading of forces, fracture and water.
#include <algorithm>
#include <numbers>
#include <optional>

#include "options/option_values.h"
#include "reading.h"

namespace floe {
namespace {

/// Refuses forces that the integrator cannot step, with an alternative.
void check_integrator_of_forces(Options& options, Scene& scene) {
  const bool is_static = scene.integrator == Integrator::quasistatic;
  if (scene.forces.drag && is_static) {
    options.refuse_part("forces", {}, "forces: drag",
                        "would have no effect: 'integrator' is quasistatic, nothing moves");
    scene.forces.drag = false;
  }
  if (scene.forces.contact && is_static)
    throw InputError(
        "forces: contact: integrator: quasistatic cannot solve it: contacts remember what happened "
        "and have no tangent; take integrator: explicit, or leave contact out");
  const auto refuse = [&](const std::string& who, const std::string& why,
                          const std::string& for_cracks, const std::string& for_contacts) {
    const auto refuse_one = [&](const std::string& force, const std::string& what,
                                const std::string& instead) {
      throw InputError("forces: " + force + ": " + who + " cannot step it: " + what +
                       " remember what happened, and " + why + " do not happen; take " + instead +
                       ", or leave " + force + " out");
    };
    if (scene.forces.fracture) refuse_one("fracture", "cracks", for_cracks);
    if (scene.forces.contact) refuse_one("contact", "contacts", for_contacts);
  };
  if (scene.integrator == Integrator::implicit)
    refuse("integrator: implicit", "Newton's trials", "integrator: explicit or quasistatic",
           "integrator: explicit");
  if (scene.integrator == Integrator::explicit_ && options.petsc("ts_type") == "rk")
    refuse("ts_type: rk", "the stages of a step", "leapfrog (without -ts_type)",
           "leapfrog (without -ts_type)");
}

}  // namespace

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
  check_integrator_of_forces(options, scene);
  const auto without = [](std::string_view force) {
    return "would have no effect: '" + std::string(force) + "' is not in 'forces'";
  };
  if (!scene.forces.beam) options.refuse("beam", without("beam"));
  if (!scene.forces.fracture) options.refuse("fracture", without("fracture"));
  if (!scene.forces.gravity) options.refuse("gravity", without("gravity"));
  for (const auto* section : {"contact", "obstacle"})
    if (!scene.forces.contact) options.refuse(section, without("contact"));
  if (!scene.forces.buoyancy && !scene.forces.drag) options.refuse("water", without("buoyancy"));
  if (!scene.forces.buoyancy && !scene.forces.drag) options.refuse("waves", without("buoyancy"));
  if (!scene.forces.drag) {
    for (const auto* key :
         {"water: drag_linear", "water: drag_coefficient", "water: current", "water: current_table",
          "water: current_interpolation", "water: current_periodic", "water: drag",
          "water: drag_form", "water: drag_skin", "water: shelter"})
      options.refuse(key, without("drag"));
  }
}

void read_fracture(Options& options, Scene& scene) {
  FractureOptions& fracture = scene.fracture;
  fracture.tensile_strength = options.number("fracture: tensile_strength");
  fracture.shear_strength =
      options.number("fracture: shear_strength", {}, fracture.tensile_strength);
  if (options.given("fracture: compressive_strength")) {
    fracture.compressive_strength = options.number("fracture: compressive_strength");
    if (fracture.compressive_strength < 2 * fracture.shear_strength)
      throw InputError(
          "fracture: compressive_strength: " + text_of(fracture.compressive_strength) +
          " must be >= 2 x fracture: shear_strength: " + text_of(fracture.shear_strength) +
          " [Pa], or friction in Mohr and Coulomb's law is negative");
  }
  if (scene.has_sheet && options.given("fracture: flexural_strength"))
    fracture.flexural_strength = options.number("fracture: flexural_strength");
  enum class Calibrated { none, strength };
  if (scene.has_sheet)
    fracture.calibrate = options.choice<Calibrated>("fracture: calibrate") == Calibrated::strength;
  fracture.energy = options.number("fracture: energy");
  fracture.energy_shear = options.number("fracture: energy_shear", {}, fracture.energy);
  fracture.propagation = options.choice<Propagation>("fracture: propagation");
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

namespace {

/// Whether the scene is stepped by leapfrog.
bool leaps(const Options& options, const Scene& scene) {
  return scene.integrator == Integrator::explicit_ && options.petsc("ts_type") != "rk";
}

void read_drag(Options& options, Scene& scene) {
  DragOptions& drag = scene.drag;
  enum class Law { plan, faces };
  drag.faces = options.choice<Law>("water: drag") == Law::faces;
  drag.linear = options.number("water: drag_linear");
  constexpr double fastest = 1e6;
  drag.current_table =
      read_time_table(options, scene,
                      {"water: current_table",
                       {"water: current"},
                       {{"x", "m/s", fastest}, {"y", "m/s", fastest}, {"z", "m/s", fastest}}})
          .table;
  if (drag.current_table.empty()) drag.current = options.vector("water: current");
  if (!drag.faces) {
    drag.coefficient = options.number("water: drag_coefficient");
    for (const auto* key : {"water: drag_form", "water: drag_skin", "water: shelter"})
      options.refuse(key, "would have no effect without 'water: drag: faces'");
    return;
  }
  options.refuse("water: drag_coefficient",
                 "would have no effect: 'water: drag' is faces, with drag_form and drag_skin");
  drag.form = options.number("water: drag_form");
  drag.skin = options.number("water: drag_skin");
  if (drag.form == 0 && drag.skin == 0)
    throw InputError("water: drag: faces needs 'water: drag_form' or 'water: drag_skin' > 0");
  std::optional<double> otherwise;
  if (!leaps(options, scene)) otherwise = 0;
  if (leaps(options, scene) && scene.has_sheet) otherwise = scene.thickness;
  if (leaps(options, scene) && !scene.has_sheet && !options.given("water: shelter"))
    throw InputError("water: shelter: is required with lattice_file [m]; 0: beams only");
  drag.shelter = options.number("water: shelter", {}, otherwise);
  if (!leaps(options, scene) && drag.shelter > 0)
    throw InputError("water: shelter: " + text_of(drag.shelter) +
                     " must be 0 with this integrator: what shelters is found anew between steps, "
                     "by leapfrog (integrator: explicit without -ts_type)");
}

void read_added_mass(Options& options, Scene& scene) {
  const std::string_view which =
      options.one_of("water: added_mass", "water: added_mass_axes", {},
                     "water: added_mass and added_mass_axes: give one of them");
  std::string by;
  if (which == "water: added_mass_axes") {
    scene.added_mass_axes = options.numbers<6>(which);
    by = which;
  } else {
    const std::string text = options.text("water: added_mass");
    scene.added_mass_plate = text == "plate";
    const std::optional<double> number = to_number(text);
    if (scene.added_mass_plate) {
      by = "water: added_mass: plate";
    } else if (number && *number >= 0 && *number <= 1e3) {
      scene.added_mass = *number;
    } else {
      throw InputError("water: added_mass: '" + text +
                       "' is not allowed: a number >= 0, <= 1e3, or plate");
    }
  }
  if (!by.empty() && !leaps(options, scene))
    throw InputError(by + ": " +
                     "mass that differs between directions is stepped by leapfrog only "
                     "(integrator: explicit without -ts_type); give added_mass a number");
}

/// Reads the level of the water where it changes.
void read_level(Options& options, Scene& scene) {
  constexpr const char* key = "water: level_table";
  if (scene.integrator != Integrator::explicit_ && options.given(key))
    throw InputError("water: level_table: needs 'integrator: explicit'");
  constexpr double farthest = 1e9;
  scene.drag.level_table =
      read_time_table(options, scene, {key, {}, {{"level", "m", farthest}}}).table;
}

/// Bodies that may come loose are cut by the surface in any way, which takes time; those of an
/// intact sheet are not.
void read_pace(Options& options, Scene& scene) {
  const bool in_space = scene.forces.buoyancy || scene.drag.faces || options.given_section("waves");
  if (!leaps(options, scene)) {
    options.refuse("water: pace",
                   "would have no effect: only leapfrog (integrator: explicit without -ts_type) "
                   "steps at it");
  } else if (!in_space) {
    options.refuse("water: pace", "would have no effect without buoyancy, waves or 'drag: faces'");
  } else if (options.given("water: pace")) {
    scene.water_pace = static_cast<int>(options.integer("water: pace"));
  } else {
    constexpr int enough = 10;
    scene.water_pace = scene.forces.fracture || scene.forces.contact ? enough : 1;
  }
}

void read_waves(Options& options, Scene& scene) {
  if (!options.given_section("waves")) return;
  if (!scene.forces.buoyancy && !scene.forces.drag) return;  // refused
  if (scene.integrator == Integrator::quasistatic) {
    options.refuse("waves", "would have no effect: 'integrator' is quasistatic, nothing moves");
    return;
  }
  if (scene.integrator == Integrator::implicit)
    throw InputError("waves: integrator: implicit cannot step them; take integrator: explicit");
  WaveOptions& waves = scene.waves;
  constexpr double degree = std::numbers::pi / 180;
  waves.spectrum = options.choice<WaveOptions::Spectrum>("waves: spectrum");
  waves.height = options.number("waves: height");
  waves.period = options.number("waves: period");
  waves.direction = degree * options.number("waves: direction");
  if (options.given("waves: depth")) waves.depth = options.number("waves: depth");
  waves.ramp = options.number("waves: ramp");
  if (waves.spectrum == WaveOptions::Spectrum::jonswap) {
    waves.gamma = options.number("waves: gamma");
    waves.components = static_cast<int>(options.integer("waves: components"));
    waves.seed = static_cast<std::uint64_t>(options.integer("waves: seed"));
    options.refuse("waves: phase",
                   "would have no effect: phases of 'spectrum: jonswap' are random");
  } else {
    waves.phase = degree * options.number("waves: phase");
    for (const auto* key : {"waves: gamma", "waves: components", "waves: seed"})
      options.refuse(key, "would have no effect without 'waves: spectrum: jonswap'");
  }
}

}  // namespace

void read_water(Options& options, Scene& scene) {
  const bool moves = scene.integrator != Integrator::quasistatic;
  if (moves) {
    read_added_mass(options, scene);
  } else {
    for (const auto* key : {"water: added_mass", "water: added_mass_axes"})
      options.refuse(key, "would have no effect: 'integrator' is quasistatic");
  }
  read_level(options, scene);
  if (scene.forces.drag) {
    read_drag(options, scene);
    if (scene.drag.linear == 0 && scene.drag.coefficient == 0 && !scene.drag.faces)
      throw InputError("forces: drag needs 'water: drag_linear' or 'water: drag_coefficient' > 0");
  }
  if (scene.forces.buoyancy || scene.drag.coefficient > 0 || scene.drag.faces ||
      scene.added_mass > 0 || scene.added_mass_plate || scene.added_mass_axes) {
    scene.water_density = options.number("water: density");
  } else {
    options.refuse("water: density", "would have no effect on linear drag");
  }
  scene.drag.density = scene.water_density;
  read_pace(options, scene);
  read_waves(options, scene);
}

}  // namespace floe
