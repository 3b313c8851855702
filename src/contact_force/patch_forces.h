/// \file
/// The forces of contacts on patches of obstacles.
#pragma once

#include <span>
#include <vector>

#include <mpi.h>

#include "active_contacts/contacts.h"
#include "forces/force.h"

namespace floe {

/// Shares the force of each contact out to the patches that look towards the body and lie inside
/// it, by their areas there. So the sum over the patches is the force on the obstacle.
class PatchForces {
 public:
  explicit PatchForces(const std::vector<Obstacle>& obstacles);

  /// Whether an obstacle has patches.
  bool is_on() const { return first_.back() > 0; }
  /// Returns the forces of the last evaluation, before it is committed. Collective.
  /// \param on_obstacles  forces of all ranks' bodies on each obstacle [N]
  /// \param time          of the evaluation [s]
  PatchSample sample(const Contacts& contacts, std::span<const Vec3<double>> on_obstacles,
                     double time, MPI_Comm comm);

 private:
  void share_out(const std::vector<Obstacle>& obstacles, const Contacts::OnObstacle& of);

  std::vector<std::size_t>
      first_;  ///< place of the first patch of each obstacle, then their number
  std::vector<Vec3<double>> forces_;  ///< of all patches, of this rank's bodies
  std::vector<HalfSpace> planes_;
  std::vector<std::size_t> touched_;
  std::vector<double> areas_;
  SurfacePatch::Polygon polygon_, work_;
};

}  // namespace floe
