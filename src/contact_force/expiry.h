/// \file
/// When the list of pairs that may touch must be made anew.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "contact/contacts.h"
#include "floe/lattice/state.h"
#include "lattice/archive.h"
#include "lattice/partition.h"

namespace floe {

/// Before a vertex has moved by the list's slack. Steps say how fast the fastest body was, which
/// bounds all travels; only when that bound has reached the slack are the travels themselves looked
/// at. A scene in which little moves pays next to nothing.
class PairListExpiry {
 public:
  /// \param bodies  of all ranks
  PairListExpiry(const Contacts& contacts, std::int32_t bodies);
  /// The list was made from this state.
  void start(const State<Spatial>& state, std::int32_t owned);
  bool started() const { return started_; }
  /// A step was made. \param dt  [s]
  void after_step(const State<Spatial>& state, double dt);
  /// The same on every rank. Collective.
  bool is_due(const State<Spatial>& state, const Part& part, const Contacts& contacts, double dt);

  /// Where bodies were when the list was made, and what is known of their travels since.
  /// Collective.
  void persist(Archive& archive, const Part& part);
  /// The state that the list was made from; of owned bodies.
  State<Spatial> at_build(const Part& part) const;

 private:
  std::array<double, 2> of_obstacles(const Contacts& contacts, double time) const;
  double travels(const State<Spatial>& state, const Part& part, const Contacts& contacts) const;

  double radius_ = 0;  ///< of the farthest vertex of a body from its centroid [m]
  std::vector<double> at_build_;
  double time_ = 0;
  double travelled_ =
      0;              ///< bound of the way of any vertex of this rank since the list was made [m]
  double speed_ = 0;  ///< bound of their speeds in the last step [m/s]
  std::int64_t asks_in_ = 0;  ///< evaluations until ranks ask each other again
  bool started_ = false;
};

}  // namespace floe
