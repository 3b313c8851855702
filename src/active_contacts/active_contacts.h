/// \file
/// The contacts of one evaluation, with the wrenches and powers that they add up to.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "active_contacts/energies.h"
#include "base/simd.h"
#include "contact/pair_list.h"
#include "contact/places.h"
#include "contact_laws/response.h"
#include "contact_laws/trial.h"

namespace floe {

/// Wrench of contacts on a body, about its centroid [N, N m].
template <class T>
struct ContactWrenchOf {
  Vec3<T> force{}, moment{};

  /// Returns the power of the wrench on a body that moves so [W].
  double power(const Vec3<double>& velocity, const Vec3<double>& spin) const {
    return dot(force, velocity) + dot(moment, spin);
  }
};
using ContactWrench = ContactWrenchOf<double>;
inline ContactWrench operator+(const ContactWrench& a, const ContactWrench& b) {
  return {.force = a.force + b.force, .moment = a.moment + b.moment};
}

/// The terms of the wrench of contacts on a body.
template <class T>
struct TermWrenchesOf {
  ContactWrenchOf<T> elastic, viscous, friction;

  ContactWrench sum() const { return elastic + viscous + friction; }
  /// Adds the powers of the terms on a body that moves so.
  void add_power(const Vec3<double>& velocity, const Vec3<double>& spin,
                 ContactPower& power) const {
    power.elastic += elastic.power(velocity, spin);
    power.viscous += viscous.power(velocity, spin);
    power.friction += friction.power(velocity, spin);
  }
};
using TermWrenches = TermWrenchesOf<double>;

/// Contacts of an evaluation, one per lane.
struct alignas(64) ContactBlock {
  Vec3<Lanes> centre{};  ///< of the overlap, from the centroid of A [m]
  Vec3<Lanes> apart{};   ///< x_A - x_B [m]
  ContactTrialOf<Lanes> trial;
  FrictionOf<Lanes> springs;   ///< of friction, within the limit of the last forces
  std::uint32_t enclosed = 0;  ///< bits of contacts of which one body lies inside the other: there
                               ///< is no direction for a force
  std::uint32_t deep = 0;      ///< bits of contacts that are deep: is_deep()

  /// Sets the bits. \param thinner  least width of the thinner one of A and B [m]
  void mark(const Lanes& thinner) {
    enclosed = bits_of(dot(trial.normal, trial.normal) == 0.0);
    deep = bits_of(is_deep(thinner, trial));
  }
};

/// The contacts of the last evaluation, until its step is committed.
class ActiveContacts {
 public:
  /// \param parts  number of parts of obstacles
  explicit ActiveContacts(std::size_t parts) : on_parts_(parts) {}

  /// Begins an evaluation. \param slots  number of involved bodies
  void start(std::size_t slots);
  /// Adds contacts, at most one per lane; only the last block may have fewer. All members of the
  /// block are to be set, in all lanes: they are those of an earlier one.
  /// \param pairs    indices in the list, in its order
  /// \param counted  number of these that are counted
  ContactBlock& add(std::span<const std::int32_t> pairs, std::int64_t counted);
  /// Sets the forces of all contacts anew, and with them the wrenches on bodies and obstacles.
  /// \param force_of  function from block and indices of its pairs to the forces of its contacts
  void act(const PairList& list, auto force_of);
  /// Adds the sums of the terms of all contacts to the wrenches on bodies only, and sets no forces.
  /// \param wrenches  by slot
  void add_sums(const PairList& list, auto force_of, std::span<ContactWrench> wrenches) const;
  /// Forgets the contacts; forces on obstacles stay.
  void clear() { pairs_.clear(); }

  /// Returns the number of contacts, which are in list order.
  std::size_t size() const { return pairs_.size(); }
  /// Returns the number of counted contacts of the last evaluation.
  std::int64_t touching() const { return touching_; }
  /// Returns the index of a contact's pair in the list.
  std::int32_t pair(std::size_t contact) const { return pairs_[contact]; }
  /// Whether one body lies inside the other.
  bool is_enclosed(std::size_t contact) const {
    return (block(contact).enclosed >> contact % lanes & 1U) != 0;
  }
  bool is_deep_in(std::size_t contact) const {
    return (block(contact).deep >> contact % lanes & 1U) != 0;
  }
  /// Returns the centroid of an overlap, from the centroid of A [m].
  Vec3<double> centre(std::size_t contact) const {
    return one_lane<Vec3>(block(contact).centre, contact % lanes);
  }
  Vec3<double> normal(std::size_t contact) const {
    return one_lane<Vec3>(block(contact).trial.normal, contact % lanes);
  }
  /// Returns V_p of a contact [m^3].
  double plastic(std::size_t contact) const {
    return block(contact).trial.memory.plastic[contact % lanes];
  }
  ContactTrial trial(std::size_t contact) const {
    return one_lane<ContactTrialOf>(block(contact).trial, contact % lanes);
  }
  /// Returns the springs of friction within the limit of the last forces.
  Friction springs(std::size_t contact) const {
    return one_lane<FrictionOf>(block(contact).springs, contact % lanes);
  }
  /// Returns the history of a contact's pair once the step is committed.
  PairHistory memory(std::size_t contact) const {
    const std::size_t lane = contact % lanes;
    PairHistory now = one_lane<PairHistoryOf>(block(contact).trial.memory, lane);
    const Friction in_springs = springs(contact);
    now.springs.force = in_springs.force;
    now.twist.couple = in_springs.couple;
    return now;
  }
  /// Keeps the force of each contact from the next forces on.
  void keep_forces() { keeps_forces_ = true; }
  /// Returns the force of a contact on A [N], where forces are kept.
  const Vec3<double>& force(std::size_t contact) const { return forces_[contact]; }
  /// Returns the wrench on an involved body.
  const TermWrenches& on_body(std::int32_t slot) const { return item(on_bodies_, slot); }
  /// Returns the force [N] and the moment about the origin of its frame [N m] of the bodies of this
  /// rank on part k of obstacles.
  ContactWrench on_part(std::size_t k) const { return on_parts_[k].sum(); }
  /// Adds the powers of the contacts on part k of obstacles, and of the obstacle, if it moves so.
  void add_power_on_part(std::size_t k, const Vec3<double>& velocity, const Vec3<double>& spin,
                         ContactPower& power) const {
    on_parts_[k].add_power(velocity, spin, power);
    power.obstacles -= on_parts_[k].sum().power(velocity, spin);
  }

 private:
  void begin_forces();
  const ContactBlock& block(std::size_t contact) const { return blocks_[contact / lanes]; }
  std::span<const std::int32_t> pairs_from(std::size_t first) const {
    return std::span(pairs_).subspan(first, std::min(lanes, pairs_.size() - first));
  }

  std::vector<std::int32_t> pairs_;      ///< of the contacts
  std::vector<ContactBlock> blocks_;     ///< those of the contacts, then room for more
  std::vector<TermWrenches> on_bodies_;  ///< by slot
  std::vector<TermWrenches> on_parts_;   ///< of obstacles, about the origins of their frames
  std::vector<Vec3<double>> forces_;     ///< of contacts on A, if they are kept
  bool keeps_forces_ = false;
  std::int64_t touching_ = 0;
};

/// Forces at the overlaps of a block, and couples, as wrenches on A, and on B with the other sign.
template <class T>
struct OnBoth {
  ContactWrenchOf<T> a, b;

  OnBoth(const Vec3<T>& force, const Vec3<T>& couple, const Vec3<T>& arm_a, const Vec3<T>& arm_b)
      : a{force, cross(arm_a, force) + couple}, b{force, cross(arm_b, force) + couple} {}
};

void ActiveContacts::act(const PairList& list, auto force_of) {
  begin_forces();
  for (std::size_t first = 0; first < pairs_.size(); first += lanes) {
    ContactBlock& active = blocks_[first / lanes];
    const std::span<const std::int32_t> pairs = pairs_from(first);
    const ContactForceOf<Lanes> contact = force_of(active, pairs);
    active.springs = contact.springs;
    const Vec3<Lanes>&n = contact.normal, &arm_a = active.centre;
    const Vec3<Lanes> arm_b = arm_a + active.apart;
    const OnBoth elastic(contact.elastic * n, contact.couple, arm_a, arm_b),
        viscous(contact.viscous * n, contact.viscous_couple, arm_a, arm_b),
        friction(contact.friction.force, contact.friction.couple * n, arm_a, arm_b);
    const LaneRows<TermWrenchesOf> on_a({elastic.a, viscous.a, friction.a}),
        on_b({elastic.b, viscous.b, friction.b});
    if (keeps_forces_) [[unlikely]] {
      const Vec3<Lanes> force = elastic.a.force + viscous.a.force + friction.a.force;
      forces_.resize(std::max(forces_.size(), first + pairs.size()));
      for (std::size_t lane = 0; lane < pairs.size(); ++lane)
        forces_[first + lane] =
            (active.enclosed >> lane & 1U) != 0 ? Vec3<double>{} : one_lane<Vec3>(force, lane);
    }
    for (std::size_t lane = 0; lane < pairs.size(); ++lane) {
      if ((active.enclosed >> lane & 1U) != 0) continue;
      const Pair& pair = list.pair(pairs[lane]);
      on_a.add(lane, item(on_bodies_, pair.slot_a));
      on_b.subtract(
          lane, pair.slot_b < 0 ? on_parts_[part_number(pair.b)] : item(on_bodies_, pair.slot_b));
    }
  }
}

void ActiveContacts::add_sums(const PairList& list, auto force_of,
                              std::span<ContactWrench> wrenches) const {
  ContactWrench on_obstacles;
  for (std::size_t first = 0; first < pairs_.size(); first += lanes) {
    const ContactBlock& active = blocks_[first / lanes];
    const std::span<const std::int32_t> pairs = pairs_from(first);
    const ContactForceOf<Lanes> contact = force_of(active, pairs);
    const OnBoth sum(contact.force(), contact.whole_couple(), active.centre,
                     active.centre + active.apart);
    const LaneRows<ContactWrenchOf> on_a(sum.a), on_b(sum.b);
    for (std::size_t lane = 0; lane < pairs.size(); ++lane) {
      if ((active.enclosed >> lane & 1U) != 0) continue;
      const Pair& pair = list.pair(pairs[lane]);
      on_a.add(lane, item(wrenches, pair.slot_a));
      on_b.subtract(lane, pair.slot_b < 0 ? on_obstacles : item(wrenches, pair.slot_b));
    }
  }
}

}  // namespace floe
