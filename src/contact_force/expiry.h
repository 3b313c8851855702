/// \file
/// Decides when the pair list must be made anew.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "active_contacts/contacts.h"
#include "floe/lattice/state.h"
#include "lattice/partition.h"

namespace floe {

/// Returns a bound of the travel of the vertices of obstacle k between two times [m].
double obstacle_travel(const Solids& solids, std::size_t k, double from, double to);

/// A pair list expires before any vertex has travelled by its slack. The largest speed times dt,
/// summed over the steps, bounds the travel of every vertex; the true travels are computed only
/// when this bound exceeds the slack. So a scene in which little moves pays next to nothing.
class PairListExpiry {
 public:
  /// \param part  must outlive this object
  PairListExpiry(const Solids& solids, const Part& part);
  /// Notes the state from which a list was made.
  /// \param owned  number of owned bodies
  void start(const State<Spatial>& state, std::int32_t owned);
  bool started() const { return started_; }
  /// Adds the travel of a step to the bound.
  /// \param state  after the step
  /// \param dt     length of the step [s]
  void after_step(const State<Spatial>& state, double dt);
  /// Whether a new list is due; the same on all ranks. Collective.
  /// \param dt  length of the last step [s]
  bool is_due(const State<Spatial>& state, const Part& part, const Contacts& contacts, double dt);

 private:
  std::array<double, 2> of_obstacles(const Solids& solids, double time) const;
  double travels(const State<Spatial>& state, const Part& part, const Solids& solids) const;

  /// A body of this rank that carries obstacles.
  struct Carrier {
    std::size_t local;
    double radius;  ///< distance of the farthest vertex from its centroid [m]
  };
  std::vector<Carrier> carriers_;
  double radius_ = 0;             ///< the same, the largest of all other bodies [m]
  std::vector<double> at_build_;  ///< records of owned bodies when the list was made
  double time_ = 0;               ///< when the list was made [s]
  /// Bound of the travel of this rank's vertices since the list was made [m].
  double travelled_ = 0;
  double speed_ = 0;  ///< bound of the speeds of this rank's vertices in the last step [m/s]
  std::int64_t asks_in_ = 0;  ///< evaluations until the ranks compare their bounds again
  bool started_ = false;
};

}  // namespace floe
