#include "units.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reading.h"

namespace floe {
namespace {

/// A unit that users may have in mind where the scene expects SI, and its size in SI.
struct Unit {
  std::string_view si, name;
  double size;
};
constexpr std::array units{Unit{"Pa", "GPa", 1e9},       Unit{"Pa", "MPa", 1e6},
                           Unit{"Pa", "kPa", 1e3},       Unit{"m", "mm", 1e-3},
                           Unit{"m", "km", 1e3},         Unit{"kg/m^3", "g/cm^3", 1e3},
                           Unit{"J/m^2", "kJ/m^2", 1e3}, Unit{"J/m^2", "mJ/m^2", 1e-3}};

/// Asks about an outline that is small, or so far away that coordinates lose digits.
void look_at_outline(const Scene& scene, std::vector<std::string>& lines) {
  if (!scene.floes.empty()) return;  // each has its place, in metres
  const auto [least, most] = scene.sheet.outline.box();
  const double size = std::max(most[0] - least[0], most[1] - least[1]);
  const double away = std::max(std::abs(least[0] + most[0]), std::abs(least[1] + most[1])) / 2;
  constexpr double smallest = 0.1, largest = 1e6, farthest = 1e4;
  if (size < smallest || size > largest)
    lines.push_back("sheet: outline: is " + text_of(size) +
                    " m long: is sheet: outline_scale what it should be?");
  if (away > farthest && away > 10 * size)
    lines.push_back("sheet: outline: lies " + text_of(away) +
                    " m from the origin, where coordinates lose digits: sheet: outline_place: "
                    "[0, 0] brings it there");
}

}  // namespace

std::string unit_question(double value, std::string_view unit, double least, double most) {
  for (const Unit& other : units) {
    const double in_si = value * other.size;
    if (other.si == unit && in_si >= least && in_si <= most)
      return " is it meant in " + std::string(other.name) + "?";
  }
  return {};
}

std::vector<std::string> unusual_numbers(const Scene& scene) {
  std::vector<std::string> lines;
  const auto look = [&](std::string_view key, double value, std::string_view unit, double least,
                        double most) {
    if (value >= least && value <= most) return;
    const std::string question = unit_question(value, unit, least, most);
    lines.push_back(std::string(key) + ": " + text_of(value) + " " + std::string(unit) +
                    " is unusual for ice at sea (" + text_of(least) + " to " + text_of(most) + " " +
                    std::string(unit) + "):" + (question.empty() ? " units are SI" : question));
  };
  if (scene.has_sheet) {
    if (scene.sheet.outline.empty()) {
      look("sheet: length", scene.sheet.length, "m", 0.1, 1e6);
      look("sheet: width", scene.sheet.width, "m", 0.1, 1e6);
    } else {
      look_at_outline(scene, lines);
    }
    const auto by_sheet = [](const Floe& floe) { return floe.thickness.empty(); };
    for (const Floe& floe : scene.floes)
      if (!by_sheet(floe))
        look("floe: " + floe.name + ": thickness", floe.thickness.front(), "m", 1e-3, 100);
    if (scene.floes.empty() || std::any_of(scene.floes.begin(), scene.floes.end(), by_sheet))
      look(scene.outline.has_thickness ? "sheet: outline: thickness" : "sheet: thickness",
           scene.thickness, "m", 1e-3, 100);
    look("ice: density", scene.ice.density, "kg/m^3", 100, 2000);
    if (scene.forces.beam) look("ice: young", scene.ice.young, "Pa", 1e6, 1e11);
  }
  if (scene.forces.gravity) look("gravity", scene.gravity, "m/s^2", 0.1, 100);
  if (scene.forces.buoyancy) look("water: density", scene.water_density, "kg/m^3", 500, 2000);
  if (scene.forces.fracture) {
    look("fracture: tensile_strength", scene.fracture.tensile_strength, "Pa", 1e3, 1e8);
    look("fracture: shear_strength", scene.fracture.shear_strength, "Pa", 1e3, 1e8);
    if (scene.fracture.flexural_strength > 0)
      look("fracture: flexural_strength", scene.fracture.flexural_strength, "Pa", 1e3, 1e8);
    if (scene.fracture.compressive_strength > 0)
      look("fracture: compressive_strength", scene.fracture.compressive_strength, "Pa", 1e3, 1e9);
    look("fracture: energy", scene.fracture.energy, "J/m^2", 1e-2, 1e4);
  }
  if (scene.forces.contact) look("contact: young", scene.contact.young, "Pa", 1e4, 1e11);
  return lines;
}

}  // namespace floe
