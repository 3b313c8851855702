/// \file
/// Solids as convex parts, which contact can act between.
#pragma once

#include <cstdint>
#include <string>

#include "floe/geometry/polyhedron.h"
#include "solid/surface.h"

namespace floe {

/// The convex parts of a solid, without common interior.
struct ConvexParts {
  Shapes shapes;               ///< one body per part, all in the frame of the solid
  std::int64_t triangles = 0;  ///< of the solid's surface
  double volume = 0;           ///< of the solid [m^3]
  double parts_volume = 0;     ///< of all parts [m^3]
  /// Largest distance of a point of a piece's hull from the piece, or from the part in its place,
  /// as hull_distance() finds it [m]; 0 if every part is a piece of the solid up to rounding.
  double distance = 0;
};

/// Divides a solid into convex parts. A piece whose convex hull lies within the tolerance becomes
/// a part, its hull without the vertices that the tolerance can do without; another one is cut by a
/// plane (see cut_planes()) and its sides are treated likewise. The parts cover the solid, and meet
/// in the planes of cuts. Numbers of STL files have 24 bits: dents of up to 2.4e-7 of the largest
/// coordinate, and pieces as thin, are no dents and no pieces. The result depends on the arguments
/// only, not on the processor. \param surface checked by check_surface() \param tolerance  >= 0 [m]
/// \param most       parts \param where the beginning of messages, as in "KEY: 'FILE'" \throws
/// InputError if there are more parts than `most`, or a piece cannot be cut
ConvexParts convex_parts(const Surface& surface, double tolerance, int most,
                         const std::string& where);

}  // namespace floe
