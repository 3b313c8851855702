/// \file
/// A solid from a file of triangles, to be divided into convex parts.
#pragma once

#include <string>

namespace floe {

/// A solid by its surface in an STL or OBJ file.
struct SolidFile {
  std::string path;
  double unit = 1;        ///< metres per unit of the file's coordinates
  double tolerance = 0;   ///< distance of the parts from the solid's surface [m]
  int most_parts = 1000;  ///< more are refused
};

}  // namespace floe
