/// \file
/// The support of a structure: springs and dashpots to the ground (model.md, "Structures").
#pragma once

#include <array>
#include <string>

#include "floe/geometry/polyhedron.h"

namespace floe {

/// A matrix of a support, row by row, on (displacement, rotation vector) of its point, or on their
/// rates.
using SupportMatrix = std::array<double, 36>;

/// What holds a body. It acts at a point that goes with the body; forces and moments are 0 where
/// the body is at rest.
struct Support {
  std::string name;           ///< of the structure
  std::int32_t body = -1;     ///< global index
  Point3 point{};             ///< at rest [m]
  SupportMatrix stiffness{};  ///< symmetric [N/m, N, N m/rad]
  SupportMatrix damping{};    ///< symmetric [N s/m, N s, N m s/rad]
};

}  // namespace floe
