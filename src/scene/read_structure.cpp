// Reading of structures: obstacles that forces move.
#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Eigenvalues>
#include <string>

#include "reading.h"

namespace floe {
namespace {

constexpr std::array keys_of_structures{
    "inertia",           "centre_of_mass", "added_mass",      "floats",
    "support_stiffness", "support_matrix", "support_damping", "support_damping_ratio",
    "support_point",     "touches",
};

std::string key(const char* last) { return "obstacle: NAME: " + std::string(last); }

SupportMatrix diagonal(const std::array<double, 6>& values) {
  SupportMatrix m{};
  for (std::size_t k = 0; k < values.size(); ++k) m[7 * k] = values[k];
  return m;
}

/// Refuses a matrix that is not symmetric, or gives energy away.
void check_matrix(const std::string& name, const SupportMatrix& m) {
  Eigen::Matrix<double, 6, 6> k;
  double most = 0;
  for (Eigen::Index row = 0; row < 6; ++row) {
    for (Eigen::Index column = 0; column < 6; ++column) {
      k(row, column) = m[static_cast<std::size_t>(6 * row + column)];
      most = std::max(most, std::abs(k(row, column)));
    }
  }
  constexpr double rounding = 1e-9;
  for (Eigen::Index row = 0; row < 6; ++row) {
    for (Eigen::Index column = 0; column < row; ++column) {
      if (std::abs(k(row, column) - k(column, row)) > rounding * most)
        throw InputError("obstacle: " + name + ": support_matrix: row " + std::to_string(row + 1) +
                         ", column " + std::to_string(column + 1) + " is " +
                         text_of(k(row, column)) + ", the other way round " +
                         text_of(k(column, row)) + "; it must be symmetric");
    }
  }
  // Lengths and angles differ in their units: a diagonal of one for all signs.
  Eigen::Matrix<double, 6, 1> unit;
  for (Eigen::Index row = 0; row < 6; ++row) {
    if (k(row, row) < 0)
      throw InputError("obstacle: " + name + ": support_matrix: row " + std::to_string(row + 1) +
                       ", column " + std::to_string(row + 1) + " is " + text_of(k(row, row)) +
                       ", must be >= 0");
    unit(row) = k(row, row) > 0 ? 1 / std::sqrt(k(row, row)) : 1;
  }
  const Eigen::Matrix<double, 6, 6> scaled = unit.asDiagonal() * k * unit.asDiagonal();
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(scaled).eigenvalues()(0);
  if (least < -rounding)
    throw InputError("obstacle: " + name +
                     ": support_matrix: is not positive: some motion would be pushed on");
}

/// Refuses moments of inertia that no body has: int y^2 + z^2 is at most int x^2 + z^2 + x^2 + y^2.
void check_moments(const std::string& name, const Vec3<double>& moments) {
  constexpr double rounding = 1e-9;
  const double sum = moments.x + moments.y + moments.z;
  const double most = std::max({moments.x, moments.y, moments.z});
  if (most > (0.5 + rounding) * sum)
    throw InputError("obstacle: " + name + ": inertia: " + text_of(most) +
                     " is more than the sum of the other two, " + text_of(sum - most) +
                     " [kg m^2], which no body has");
}

void read_support(Options& options, const std::string& name, Structure& structure) {
  const auto given = [&](const char* last) { return options.given(key(last), name); };
  if (given("support_matrix")) {
    structure.stiffness = options.numbers<36>(key("support_matrix"), name);
    check_matrix(name, structure.stiffness);
    options.refuse_one(key("support_stiffness"), name, "'support_matrix' says it");
  } else {
    structure.stiffness = diagonal(options.numbers<6>(key("support_stiffness"), name));
  }
  if (given("support_damping_ratio")) {
    structure.damping_ratio = options.number(key("support_damping_ratio"), name);
    options.refuse_one(key("support_damping"), name, "'support_damping_ratio' says it");
  } else {
    structure.damping = diagonal(options.numbers<6>(key("support_damping"), name));
  }
  const auto acts = [](const SupportMatrix& m) {
    return std::any_of(m.begin(), m.end(), [](double x) { return x != 0; });
  };
  if (structure.damping_ratio && !acts(structure.stiffness))
    throw InputError("obstacle: " + name +
                     ": support_damping_ratio: would have no effect: there is no stiffness");
  if (!acts(structure.stiffness) && !acts(structure.damping))
    options.refuse_one(key("support_point"), name,
                       "would have no effect: there is no stiffness and no damping");
  else if (given("support_point"))
    structure.support_point = options.vector(key("support_point"), name);
}

}  // namespace

Structure read_structure(Options& options, Obstacle& obstacle) {
  const std::string& name = obstacle.name;
  if (obstacle.is_half_space())
    throw InputError("obstacle: " + name +
                     ": mass: a halfspace is no body; box, cone, cylinder "
                     "and file can be");
  for (const auto* last : {"velocity", "angular_velocity", "amplitude", "frequency", "ramp",
                           "table", "interpolation", "periodic"})
    options.refuse_one(key(last), name,
                       "does not go with 'mass': forces move it; a 'boundary' or 'initial' with "
                       "'set: " +
                           name + "' prescribes or begins its motion");
  if (std::find(sheet_sets.begin(), sheet_sets.end(), name) != sheet_sets.end())
    throw InputError("obstacle: names: '" + name +
                     "' is the name of a set, which that of a structure must not be");
  Structure structure;
  structure.mass = options.number(key("mass"), name);
  if (options.given(key("inertia"), name)) structure.inertia = options.vector(key("inertia"), name);
  if (structure.inertia) {
    check_moments(name, *structure.inertia);
    if (options.given(key("centre_of_mass"), name))
      structure.centre = options.vector(key("centre_of_mass"), name);
  } else {
    options.refuse_one(key("centre_of_mass"), name,
                       "needs 'inertia', which that of the shape is not");
  }
  structure.added_mass = options.numbers<6>(key("added_mass"), name);
  structure.floats = options.flag(key("floats"), name);
  read_support(options, name, structure);
  enum class Touched { all, ice };
  obstacle.touches_obstacles = options.choice<Touched>(key("touches"), name) == Touched::all;
  return structure;
}

void refuse_structure(Options& options, const std::string& name) {
  for (const auto* last : keys_of_structures)
    options.refuse_one(key(last), name, "needs 'mass', by which the obstacle is a structure");
}

void check_structures(const Scene& scene) {
  for (const Structure& s : scene.structures) {
    const std::string& name = scene.obstacles[s.obstacle].name;
    const auto refuse = [&](const std::string& last, const std::string& why) {
      throw InputError("obstacle: " + name + ": " + last + ": " + why);
    };
    for (const Region& region : scene.regions)
      if (region.name == name)
        throw InputError("obstacle: names: '" + name + "' is the name of a region too");
    for (const Floe& floe : scene.floes)
      if (floe.name == name)
        throw InputError("obstacle: names: '" + name + "' is the name of a floe too");
    if (!scene.obstacles[s.obstacle].touches_obstacles && scene.obstacles.size() == 1)
      refuse("touches", "would have no effect: there is no other obstacle");
    if (!s.floats) continue;
    if (scene.drag.faces && scene.obstacles[s.obstacle].parts.size() > 1)
      refuse("floats", "drag on faces ('water: drag') is for structures of one convex part");
    if (!scene.forces.buoyancy || !scene.forces.gravity)
      refuse("floats", "needs gravity and buoyancy among 'forces'");
    for (const std::size_t k : {2U, 3U, 4U}) {
      if (s.stiffness[7 * k] != 0)
        refuse("floats", "the water's stiffness acts along " + std::string(component_names[k]) +
                             ", and that of the support too; give one of them");
    }
  }
}

}  // namespace floe
