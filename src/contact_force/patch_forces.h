/// \file
/// The forces of contacts on patches of obstacles, at given times.
#pragma once

#include <vector>

#include <mpi.h>

#include "active_contacts/contacts.h"
#include "forces/force.h"
#include "lattice/archive.h"

namespace floe {

/// Shares the force of each contact out to the patches that lie inside the body and look towards it,
/// by their areas there. So the sum over the patches is the force on the obstacle.
class PatchForces {
 public:
  /// \param interval  between samples [s]; 0: never
  PatchForces(const std::vector<Obstacle>& obstacles, double interval);

  bool is_on() const { return interval_ > 0; }
  /// Takes a sample of the last evaluation if one is due. Collective.
  /// \param time  of the state after the step [s]
  void take(const Contacts& contacts, double time, MPI_Comm comm);
  /// Returns the last sample, once.
  std::optional<PatchSample> taken();
  void persist(Archive& archive);

 private:
  void share_out(const Contacts& contacts, std::size_t contact);

  double interval_, next_ = 0;
  std::vector<std::size_t> first_;  ///< place of the first patch of each obstacle, then their number
  std::vector<Vec3<double>> forces_;  ///< of all patches, of this rank's bodies
  std::optional<PatchSample> sample_;
  std::vector<HalfSpace> planes_;
  std::vector<std::size_t> touched_;
  std::vector<double> areas_;
  SurfacePatch::Polygon polygon_, work_;
};

}  // namespace floe
