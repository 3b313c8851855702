// Reading of ice without end.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "reading.h"

namespace floe {
namespace {

/// Refuses what a sheet without end does not go with.
void check_company(const Scene& scene) {
  const auto refuse = [](const std::string& key, const std::string& why) {
    throw InputError(key + ": does not go with 'supply': " + why);
  };
  if (!scene.has_sheet) refuse("lattice_file", "strips of a sheet join");
  if (scene.integrator != Integrator::explicit_) refuse("integrator", "it must be explicit");
  if (!scene.forces.beam) refuse("forces", "beam must be among them");
  if (!scene.floes.empty()) refuse("floe: names", "the sheet must be a rectangle");
  if (!scene.sheet.outline.empty()) refuse("sheet: outline", "the sheet must be a rectangle");
  if (scene.thickness_field.varies())
    refuse(
        scene.thickness_field.file.empty() ? "sheet: thickness_deviation" : "sheet: thickness_file",
        "the sheet must have one thickness");
  if (!scene.mesh_file.empty()) refuse("sheet: mesh_file", "strips are meshed during the run");
  if (!scene.cuts.empty()) refuse("cut: " + scene.cuts[0].name, "strips have none");
  if (!scene.regions.empty())
    refuse("region: " + scene.regions[0].name,
           "its bodies would change (supply: region is another)");
  if (!scene.loads.empty()) refuse("load: " + scene.loads[0].name, "its bodies would change");
  if (scene.bonds.given) refuse("bonds", "strips have none");
  if (scene.calibrate != Calibrate::none) refuse("beam: calibrate", "it must be none");
  if (scene.drag.faces) refuse("water: drag", "it must be plan");
}

/// Refuses boundaries that ice cannot join or leave. \throws InputError
void check_boundaries(const Scene& scene) {
  if (scene.supply.absorbs && !scene.supply.pressure) {
    if (!(scene.supply.velocity.x > 0))
      throw InputError("supply: velocity: " + text_of(scene.supply.velocity.x) +
                       " along x must be > 0 [m/s], towards the sheet");
    if (scene.supply.velocity.z != 0)
      throw InputError("supply: velocity: " + text_of(scene.supply.velocity.z) +
                       " along z must be 0 [m/s]");
  }
  const auto is_edge = [](const Boundary& b) { return b.set == "left" && b.fixed[0]; };
  const auto edge = std::find_if(scene.boundaries.begin(), scene.boundaries.end(), is_edge);
  const bool has_edge = edge != scene.boundaries.end() && edge->velocity && edge->velocity->x > 0;
  if (!scene.supply.absorbs && !has_edge)
    throw InputError(
        "supply: needs a boundary with 'set: left', x among 'fix' and a velocity along +x, by "
        "which "
        "the far edge brings the ice");
  // Strips join level and side by side: the edge to which they join must be so too.
  const bool in_space = scene.forces.gravity || scene.forces.buoyancy || scene.forces.contact;
  std::array<bool, 6> held{};
  for (const Boundary& b : scene.boundaries) {
    for (std::size_t k = 0; k < held.size(); ++k)
      held[k] = held[k] || (b.set == "left" && b.fixed[k]);
  }
  std::string missing;
  for (std::size_t k = scene.supply.absorbs ? 2 : 1; k < held.size(); ++k) {
    const bool is_out_of_plane = k >= 2 && k <= 4;
    if (!held[k] && (in_space || !is_out_of_plane) && !(scene.supply.absorbs && !in_space))
      missing += " " + std::string(component_names[k]);
  }
  if (!missing.empty())
    throw InputError(
        "supply: the far edge must be held level: of the boundaries with 'set: left' "
        "none has in 'fix':" +
        missing);
  for (const Boundary& b : scene.boundaries) {
    const bool is_of_structure =
        std::any_of(scene.structures.begin(), scene.structures.end(),
                    [&](const Structure& s) { return scene.obstacles[s.obstacle].name == b.set; });
    if (is_of_structure) continue;
    if (b.set != "left" && b.set != "bottom" && b.set != "top")
      throw InputError("boundary: " + b.name + ": set: '" + b.set +
                       "' does not go with 'supply', must be left, bottom, top or a structure");
    if (b.set == "left" && scene.supply.absorbs && (b.fixed[0] || b.fixed[1]))
      throw InputError("boundary: " + b.name +
                       ": fix: x and y of 'set: left' do not go with 'supply: edge' absorbing, "
                       "which moves it");
    if (!b.table.empty())
      throw InputError("boundary: " + b.name +
                       ": table does not go with 'supply': strips join at a steady velocity");
    if (b.angular_velocity != Point3{})
      throw InputError("boundary: " + b.name +
                       ": angular_velocity does not go with 'supply': strips join without turning");
  }
}

}  // namespace

void read_supply(Options& options, Scene& scene) {
  auto& supply = scene.supply;
  supply.on = options.given_section("supply");
  if (!supply.on) return;
  supply.strip = options.number("supply: strip");
  if (options.given("supply: length")) supply.length = options.number("supply: length");
  if (options.given("supply: region")) supply.region = options.numbers<6>("supply: region");
  enum class Edge { prescribed, absorbing };
  supply.absorbs = options.choice<Edge>("supply: edge") == Edge::absorbing;
  if (!supply.absorbs) {
    for (const auto* key : {"supply: velocity", "supply: ramp", "supply: spring",
                            "supply: pressure", "supply: response"})
      options.refuse(key, "would have no effect: 'supply: edge' is prescribed, by a boundary");
  } else if (options.given("supply: pressure")) {
    supply.pressure = options.number("supply: pressure");
    supply.response = options.number("supply: response");
    supply.ramp.seconds = options.number("supply: ramp");
    for (const auto* key : {"supply: velocity", "supply: spring"})
      options.refuse(key, "does not go with 'supply: pressure', by which the far edge moves");
  } else {
    supply.velocity = options.vector("supply: velocity");
    supply.ramp.seconds = options.number("supply: ramp");
    supply.spring = options.number("supply: spring");
    options.refuse("supply: response", "would have no effect: there is no 'supply: pressure'");
  }
  check_company(scene);
  check_boundaries(scene);
  const double least = 8 * scene.sheet.element_size;
  if (supply.strip < least)
    throw InputError("supply: strip: " + text_of(supply.strip) + " must be >= " + text_of(least) +
                     " [m], eight times sheet: element_size");
  const double strips = scene.sheet.length / supply.strip;
  constexpr double rounding = 1e-9;
  if (std::round(strips) < 1 || std::abs(strips - std::round(strips)) > rounding * strips)
    throw InputError("supply: strip: sheet: length " + text_of(scene.sheet.length) +
                     " must be a whole number of strips, is " + text_of(strips) + " of " +
                     text_of(supply.strip) + " m");
  if (supply.length < scene.sheet.length + supply.strip * (1 - rounding))
    throw InputError("supply: length: " + text_of(supply.length) +
                     " must be >= " + text_of(scene.sheet.length + supply.strip) +
                     " [m], the sheet and one strip, or no ice joins");
  if (supply.region) {
    const auto& box = *supply.region;
    if (!(box[0] < box[1]) || !(box[2] < box[3]) || !(box[4] < box[5]))
      throw InputError(
          "supply: region: must be x0, x1, y0, y1, z0, z1 with x0 < x1, y0 < y1, z0 < z1 [m]");
  }
}

}  // namespace floe
