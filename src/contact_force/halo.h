/// \file
/// Which bodies of other ranks the contacts of this one need, and how their records come here.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/ghosts.h"
#include "contact/contacts.h"
#include "floe/lattice/state.h"
#include "lattice/partition.h"

namespace floe {

class ContactHalo {
 public:
  /// Collective. \param part  must outlive this
  explicit ContactHalo(const Part& part);

  /// Poses of all bodies, in global order. Collective.
  std::vector<Pose> poses(const State<Spatial>& state) const;
  /// Bodies whose records are wanted here from now on. Collective. \param wanted  global, sorted
  void choose(std::span<const std::int32_t> wanted);
  /// Poses and velocities of these bodies, as wanted. Collective.
  void gather(const State<Spatial>& state, std::span<MovingPose> bodies);
  /// Local index of each wanted body, or -1 if another rank owns it.
  const std::vector<std::int32_t>& local() const { return local_; }

 private:
  const Part& part_;
  bool alone_;
  std::vector<std::int32_t> global_;  ///< bodies rank after rank
  std::vector<std::int32_t> owner_;   ///< per body
  std::vector<Vec3<double>> rest_;    ///< per body: centroid at rest
  std::vector<Quat<double>> axes_;    ///< per body: orientation at rest
  std::vector<std::int32_t> wanted_, local_;
  std::vector<std::int32_t> sent_;  ///< owned bodies that some rank wants
  std::vector<std::int32_t> from_;  ///< per wanted body: its record in the buffer, or -1
  std::vector<double> buffer_;      ///< records sent, then records received
  Ghosts ghosts_;
};

}  // namespace floe
