/// \file
/// Patches of the surface of an obstacle, for the pressure of ice on it.
#pragma once

#include <vector>

#include "floe/base/rotation.h"

namespace floe {

/// A part of the surface in one plane.
struct SurfacePatch {
  using Polygon = std::vector<Vec3<double>>;  ///< convex, in the frame of the obstacle [m]
  Vec3<double> centre{};                      ///< of its area, in that frame [m]
  Vec3<double> normal{};                      ///< outwards
  double area = 0;                            ///< [m^2]
  double width = 0, height = 0;               ///< level and up the plane [m]
  double radius = 0;                          ///< of a sphere about `centre` that holds it [m]
  std::vector<Polygon> pieces;                ///< of faces
  std::vector<Polygon> covered;               ///< where two parts meet, in `pieces`
};

}  // namespace floe
