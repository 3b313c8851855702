/// \file
/// A contact from an overlap: the text of all back ends.
#pragma once

#include <type_traits>

#include "contact_laws/shared_terms.h"

namespace floe {

/// Finds what a law makes of an overlap before dashpots act. Where one body lies inside the other
/// there is no direction and no force, and the force of the springs of friction is lost.
/// \param overlap         in world axes, with V > 0
/// \param depth           of its centroid below the plane of a half-space [m]; else not used
/// \param motion          of A relative to B at the centroid of the overlap, in the last step
/// \param mobility        of A and B
/// \param last            the last step; the turn about the normal is found here
/// \param mean_spin       mean of the spins of A and B in the last step [rad/s]
/// \param memory          history of the pair
/// \param newly_eligible  the overlap is stress-free: V_p = V
/// \param trial           filled
/// \tparam Law           IsContactLaw
/// \tparam T             double, or Lanes for a contact in each lane
template <class Law, class T>
constexpr void find_trial(const Law& law, const PairConstantsOf<T>& pair,
                          const OverlapOf<T>& overlap, const std::type_identity_t<T>& depth,
                          const std::type_identity_t<RelativeMotionOf<T>>& motion,
                          const MobilityOf<T>& mobility, std::type_identity_t<LastStepOf<T>> last,
                          const std::type_identity_t<Vec3<T>>& mean_spin, PairHistoryOf<T> memory,
                          const MaskOf<T>& newly_eligible, ContactTrialOf<T>& trial) {
  memory.plastic = chosen(newly_eligible, overlap.volume, memory.plastic);
  last.dt = chosen(newly_eligible, T(0.0), last.dt);  // nothing has slipped yet
  const T size = length(overlap.area);
  const auto enclosed = size <= 1e-12 * pair.area;
  const T area = chosen(enclosed, T(1.0), size);
  const Vec3<T> normal = (1.0 / area) * overlap.area;
  last.mean_turn = last.dt * dot(mean_spin, normal);
  const ContactStateOf<T> state{.pair = pair,
                                .overlap = overlap,
                                .depth = depth,
                                .motion = motion,
                                .mobility = mobility,
                                .last = last,
                                .area = area,
                                .normal = normal};
  find_trial_along(law.constants, state, law.term(state), memory, trial);
  if (none_of(enclosed)) return;
  ContactTrialOf<T> none;
  none.memory = memory;
  none.memory.springs.force = {};
  none.memory.twist.couple = 0;
  trial = chosen_of<ContactTrialOf>(enclosed, none, trial);
}

/// Whether the mean elastic depth (V - V_p)/|S| of a contact exceeds a quarter of the least width
/// of the thinner one of A and B [m].
template <class T>
constexpr MaskOf<T> is_deep(const T& thinner, const ContactTrialOf<T>& contact) {
  constexpr double holds = 0.25;
  return contact.volume - contact.memory.plastic > holds * thinner * contact.area;
}

}  // namespace floe
