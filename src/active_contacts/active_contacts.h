/// \file
/// The contacts of one evaluation, with the wrenches and powers that they add up to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "active_contacts/energies.h"
#include "contact/pair_list.h"
#include "contact/places.h"
#include "contact_laws/response.h"

namespace floe {

/// Wrench of contacts on a body, about its centroid [N, N m].
struct ContactWrench {
  Vec3<double> force{}, moment{};

  /// Returns the power of the wrench on a body that moves so [W].
  double power(const Vec3<double>& velocity, const Vec3<double>& spin) const {
    return dot(force, velocity) + dot(moment, spin);
  }
};
inline ContactWrench operator+(const ContactWrench& a, const ContactWrench& b) {
  return {.force = a.force + b.force, .moment = a.moment + b.moment};
}

/// The terms of the wrench of contacts on a body.
struct TermWrenches {
  ContactWrench elastic, viscous, friction;

  ContactWrench sum() const { return elastic + viscous + friction; }
  /// Adds the powers of the terms on a body that moves so.
  void add_power(const Vec3<double>& velocity, const Vec3<double>& spin,
                 ContactPower& power) const {
    power.elastic += elastic.power(velocity, spin);
    power.viscous += viscous.power(velocity, spin);
    power.friction += friction.power(velocity, spin);
  }
};

/// A contact of an evaluation.
struct ActiveContact {
  std::int32_t pair = 0;  ///< index in the list
  bool deep = false;      ///< is_deep()
  Vec3<double> centre{};  ///< of the overlap, from the centroid of A [m]
  ContactTrial trial;
  Friction springs{};  ///< of friction, within the limit of the last forces

  /// Whether one body lies inside the other: there is no direction for a force.
  bool is_enclosed() const { return dot(trial.normal, trial.normal) == 0; }
  /// Returns the history of the pair once the step is committed.
  PairHistory memory() const { return history_of(trial, springs); }
};

/// The contacts of the last evaluation, until its step is committed.
class ActiveContacts {
 public:
  /// \param obstacles  number of obstacles
  explicit ActiveContacts(std::size_t obstacles) : on_obstacles_(obstacles) {}

  /// Begins an evaluation. \param slots  number of involved bodies
  void start(std::size_t slots);
  /// Adds a contact, of which all members are to be set: they are those of an earlier one.
  ActiveContact& add(bool counted) {
    touching_ += counted ? 1 : 0;
    if (size_ == room_.size()) room_.resize(2 * size_ + 16);
    return room_[size_++];
  }
  /// Sets the forces of all contacts anew, and with them the wrenches on bodies and obstacles.
  /// \param force_of  function from contact and pair to the contact's force
  void act(const PairList& list, const Places& places, auto force_of);
  /// Adds the sums of the terms of all contacts to the wrenches on bodies only, and sets no forces.
  /// \param wrenches  by slot
  void add_sums(const PairList& list, const Places& places, auto force_of,
                std::span<ContactWrench> wrenches) const;
  /// Forgets the contacts; forces on obstacles stay.
  void clear() { size_ = 0; }

  /// Returns the contacts, in list order.
  std::span<const ActiveContact> contacts() const { return std::span(room_).first(size_); }
  /// Returns the number of counted contacts.
  std::int64_t touching() const { return touching_; }
  /// Returns the wrench on an involved body.
  const TermWrenches& on_body(std::int32_t slot) const { return item(on_bodies_, slot); }
  /// Returns the force [N] and the moment about the origin of its frame [N m] of the bodies of this
  /// rank on obstacle k.
  ContactWrench on_obstacle(std::size_t k) const { return on_obstacles_[k].sum(); }
  /// Adds the powers of the contacts on obstacle k, and of the obstacle, if it moves so.
  void add_power_on_obstacle(std::size_t k, const Vec3<double>& velocity, const Vec3<double>& spin,
                             ContactPower& power) const {
    on_obstacles_[k].add_power(velocity, spin, power);
    power.obstacles -= on_obstacles_[k].sum().power(velocity, spin);
  }

 private:
  void begin_forces();

  std::vector<ActiveContact> room_;         ///< the contacts, then room for more
  std::size_t size_ = 0;                    ///< number of contacts
  std::vector<TermWrenches> on_bodies_;     ///< by slot
  std::vector<TermWrenches> on_obstacles_;  ///< about the origins of their frames
  std::int64_t touching_ = 0;
};

/// Adds a force at two arms, and a couple, to the wrenches on A and B.
inline void add_pair(const Vec3<double>& force, const Vec3<double>& couple,
                     const Vec3<double>& arm_a, const Vec3<double>& arm_b, ContactWrench& on_a,
                     ContactWrench& on_b) {
  on_a.force = on_a.force + force;
  on_a.moment = on_a.moment + (cross(arm_a, force) + couple);
  on_b.force = on_b.force - force;
  on_b.moment = on_b.moment - (cross(arm_b, force) + couple);
}

void ActiveContacts::act(const PairList& list, const Places& places, auto force_of) {
  begin_forces();
  for (ActiveContact& active : std::span(room_).first(size_)) {
    active.springs = {};
    if (active.is_enclosed()) continue;
    const Pair& pair = list.pair(active.pair);
    const ContactForce contact = force_of(active, pair);
    active.springs = contact.springs;
    const Vec3<double>& arm_a = active.centre;
    const Vec3<double> arm_b = arm_a + (places.of_a(pair).x - places.of_b(pair).x);
    TermWrenches& a = item(on_bodies_, pair.slot_a);
    TermWrenches& b = is_obstacle(pair.b) ? on_obstacles_[obstacle_number(pair.b)]
                                          : item(on_bodies_, pair.slot_b);
    const Vec3<double>& n = contact.normal;
    add_pair(contact.elastic * n, contact.couple, arm_a, arm_b, a.elastic, b.elastic);
    add_pair(contact.viscous * n, contact.viscous_couple, arm_a, arm_b, a.viscous, b.viscous);
    add_pair(contact.friction.force, contact.friction.couple * n, arm_a, arm_b, a.friction,
             b.friction);
  }
}

void ActiveContacts::add_sums(const PairList& list, const Places& places, auto force_of,
                              std::span<ContactWrench> wrenches) const {
  ContactWrench on_obstacles;
  for (const ActiveContact& active : contacts()) {
    if (active.is_enclosed()) continue;
    const Pair& pair = list.pair(active.pair);
    const ContactForce contact = force_of(active, pair);
    add_pair(contact.force(), contact.whole_couple(), active.centre,
             active.centre + (places.of_a(pair).x - places.of_b(pair).x),
             item(wrenches, pair.slot_a),
             is_obstacle(pair.b) ? on_obstacles : item(wrenches, pair.slot_b));
  }
}

}  // namespace floe
