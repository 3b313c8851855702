/// \file
/// The force of the spatial beams of a part, computed in blocks of lanes.
#pragma once

#include "base/collectives.h"
#include "beams/lanes.h"
#include "beams/lattice_beams.h"
#include "beams/spatial.h"

namespace floe {

/// A spatial beam on body records, and in lanes.
template <Kinematics kinematics, template <class> class Frame>
struct SpatialLanes
    : std::conditional_t<is_eccentric_frame<Frame>, SpatialBeam<kinematics, EccentricFrame>,
                         SpatialBeam<kinematics, AnyFrame>> {
  using Block = BeamBlock<Frame>;
  using DashpotBlock = floe::DashpotBlock;
  template <bool damped>
  [[gnu::always_inline]] static Lanes add(const Block& block, const DashpotBlock* dashpots,
                                          const double* records, double* wrenches) {
    return add_block<kinematics, damped>(block, dashpots, records, wrenches);
  }
};

template <Kinematics kinematics, bool damped, template <class> class Frame>
using SpatialBeams = LatticeBeams<SpatialLanes<kinematics, Frame>, damped>;

/// Whether beams of any rank have offsets. Collective.
inline bool any_eccentric(const Part& part) {
  return !on_all_ranks(part.beams.offsets.empty(), part.comm);
}

/// Whether axis 3 of all beams of the lattice is z. Collective, since forces must not depend on
/// how the bodies are distributed over ranks.
inline bool all_flat(const Part& part) {
  bool flat = true;
  for (std::int32_t m = 0; m < part.beams.size() && flat; ++m)
    flat = is_flat(part.bodies, part.beams, m);
  return on_all_ranks(flat, part.comm);
}

}  // namespace floe
