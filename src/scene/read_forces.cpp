// Reading of forces, fracture and water.
#include <algorithm>

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
    scene.drag.current = options.vector("water: current");
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

}  // namespace floe
