/// \file
/// Forces of the bodies on obstacles over a run: peaks and means.
#pragma once

#include <mpi.h>

#include <array>
#include <span>
#include <vector>

#include "active_contacts/contacts.h"
#include "forces/force.h"

namespace floe {

/// The largest force on each obstacle so far, and its mean over the steps so far. Both are alike on
/// all ranks.
class ObstacleForces {
 public:
  /// \param obstacles  number of obstacles
  explicit ObstacleForces(std::size_t obstacles) : peak_(obstacles), impulse_(obstacles) {}

  /// Returns the forces of the last evaluation on all obstacles, of all ranks' bodies. Collective.
  std::span<const Vec3<double>> now(const Contacts& contacts, MPI_Comm comm);
  /// Returns the integral of the force on obstacle k [N s].
  const Vec3<double>& impulse(std::size_t k) const { return impulse_[k]; }
  /// Takes over a step. With obstacles and several ranks this takes one sum over the ranks.
  /// Collective.
  /// \param dt  length of the step [s]
  void take(const Contacts& contacts, double dt, MPI_Comm comm);
  /// Per obstacle: the largest force so far and the impulse, as steps that are made elsewhere count
  /// them on.
  std::vector<std::array<double, 6>> numbers() const;
  void set_numbers(std::span<const std::array<double, 6>> numbers);
  /// Adds the time of such a step [s].
  void add_time(double dt) { time_ += dt; }
  /// Reports per obstacle NAME_force_x.., NAME_moment_x.. (in the last evaluation),
  /// NAME_peak_force_x.. and NAME_mean_force_x.. .
  /// \param first  whether this rank reports what is alike on all ranks
  void report(const Contacts& contacts, bool first, Columns& columns) const;
  /// Saves or loads the sum of the steps.
  void persist_time(Archive& archive) { archive.common("time", time_); }
  /// Saves or loads peaks and impulses.
  void persist(const std::vector<Obstacle>& obstacles, Archive& archive);

 private:
  std::vector<Vec3<double>> peak_;     ///< [N]
  std::vector<Vec3<double>> impulse_;  ///< integral of the force [N s]
  std::vector<Vec3<double>> forces_;   ///< work space
  double time_ = 0;                    ///< sum of the steps [s]
};

}  // namespace floe
