/// \file
/// The halo of contacts: bodies of other ranks that this rank's contacts need.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "active_contacts/contacts.h"
#include "base/ghosts.h"
#include "floe/lattice/state.h"
#include "lattice/partition.h"

namespace floe {

/// Gathers poses and velocities of owned bodies and of bodies of other ranks.
class ContactHalo {
 public:
  /// Collective. \param part  must outlive this object
  explicit ContactHalo(const Part& part);

  /// Poses of all bodies, in global order. Collective.
  std::vector<Pose> poses(const State<Spatial>& state) const;
  /// Chooses the bodies that gather() returns from now on. Collective.
  /// \param wanted  global bodies, sorted
  void choose(std::span<const std::int32_t> wanted);
  /// Poses and velocities of the wanted bodies. Collective.
  /// \param bodies  filled, in the order of choose()
  void gather(const State<Spatial>& state, std::span<MovingPose> bodies);
  /// Sets the accelerations of the wanted bodies that other ranks own. Collective.
  /// \param accelerations  in the order of choose(); those of owned bodies are set
  void complete(std::span<Acceleration> accelerations);
  /// Local index of each wanted body; -1 if another rank owns the body.
  const std::vector<std::int32_t>& local() const { return local_; }

 private:
  std::vector<std::int32_t> sent_by_any(const std::vector<std::int32_t>& foreign) const;
  void connect(const std::vector<std::int32_t>& sent);

  const Part& part_;
  bool alone_;                        ///< one rank only
  std::vector<std::int32_t> global_;  ///< all bodies, rank after rank
  std::vector<std::int32_t> owner_;   ///< per body: the rank that owns it
  std::vector<Vec3<double>> rest_;    ///< per body: centroid at rest [m]
  std::vector<Quat<double>> axes_;    ///< per body: orientation at rest
  std::vector<std::int32_t> wanted_, local_;
  std::vector<std::int32_t> sent_;  ///< owned bodies that another rank wants
  std::vector<std::int32_t> from_;  ///< per wanted body: index of its record in buffer_; -1: owned
  std::vector<double> buffer_;      ///< records sent, then records received
  std::vector<std::int32_t> sent_at_;  ///< per sent body: its index in wanted_
  Ghosts ghosts_;
};

}  // namespace floe
