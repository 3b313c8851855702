/// \file
/// What forces tell a back end that computes their steps by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "floe/geometry/polyhedron.h"

namespace floe {

/// The numbers of forces, for a back end that keeps the state in memory of its own and steps it
/// there (src/device). Bodies are those of a part that is the whole lattice.
struct DeviceModel {
  struct Beam {
    std::array<std::int32_t, 2> bodies;
    std::array<double, 9> triad;       ///< axes 1, 2, 3 at rest, world axes
    std::array<double, 6> offsets;     ///< of the ends from the centroids at rest [m]
    double length;                     ///< at rest [m]
    std::array<double, 6> stiffness;   ///< kn ksz ksy [N/m], kt kby kbz [N m]
    std::array<double, 6> dashpots{};  ///< on the six strains [N s/m, N m s]
  };
  /// A dead wrench that is the same for some bodies, at an arm that turns with each of them.
  struct Load {
    std::size_t work;  ///< index of its work among those of all forces
    std::vector<std::int32_t> bodies;
    Point3 arm;  ///< from the centroid to the force, at rest [m]
    /// Force and moment on each body at a time [N, N m].
    std::function<std::array<double, 6>(double time)> wrench;
  };

  std::vector<Beam> beams;      ///< in the order in which bodies sum them
  std::size_t beam_work = 0;    ///< index of the dashpots' work among those of all forces
  bool damped = false;          ///< beams have dashpots
  std::vector<double> weights;  ///< per body: along -z [N]; empty: none
  std::vector<Load> loads;

  /// Index of the first work of the force that is asked.
  std::size_t next_work = 0;
};

}  // namespace floe
