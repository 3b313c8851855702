/// \file
/// The contacts of one evaluation, with the wrenches and energies that they add up to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/energies.h"
#include "contact/pair.h"
#include "contact/places.h"
#include "contact_laws/response.h"

namespace floe {

/// Wrench of contacts on a body, about its centroid [N, N m].
struct ContactWrench {
  Vec3<double> force{}, moment{};
};

/// A contact of an evaluation.
struct ActiveContact {
  std::int32_t pair = 0;  ///< index in the list
  bool deep = false;      ///< elastic depth above a quarter of the least width of the thinner one
  Vec3<double> centre{};  ///< of the overlap, from the centroid of A [m]
  ContactForce contact;

  /// Whether one body lies inside the other: there is no direction for a force.
  bool is_enclosed() const { return dot(contact.normal, contact.normal) == 0; }
};

/// Adds the power of the elastic, viscous and friction terms of a contact.
void add_power(const ContactForce& contact, const RelativeMotion& motion, ContactPower& power);
/// Returns the power of a moving obstacle on the body A [W].
double power_of_obstacle(const ActiveContact& active, const Placed& a, const Placed& obstacle);

/// The contacts of the last evaluation, until its step is committed.
class ActiveContacts {
 public:
  /// \param obstacles  number of obstacles
  explicit ActiveContacts(std::size_t obstacles) : on_obstacle_(obstacles) {}

  /// Begins an evaluation.
  void start();
  /// Adds a contact: its wrenches, and its energies if the pair is counted.
  /// \param motion    of A relative to B at the centre
  /// \param wrenches  on the involved bodies, by slot
  void add(const ActiveContact& active, const Pair& pair, const Placed& a, const Placed& b,
           const RelativeMotion& motion, const StoredEnergy& stored,
           std::span<ContactWrench> wrenches);
  /// Forgets the contacts; sums and forces on obstacles stay.
  void clear() { contacts_.clear(); }
  /// Forgets the contacts and their energies; forces on obstacles and the count stay.
  void end_step();

  /// Returns the contacts, in list order.
  std::span<const ActiveContact> contacts() const { return contacts_; }
  /// Returns the number of counted contacts.
  std::int64_t touching() const { return touching_; }
  /// Returns the energy stored in counted contacts [J].
  const StoredEnergy& stored() const { return stored_; }
  /// Returns the power of counted contacts [W].
  const ContactPower& power() const { return power_; }
  /// Returns the force [N] and the moment about the origin of its frame [N m] of the bodies of this
  /// rank on obstacle k.
  const ContactWrench& on_obstacle(std::size_t k) const { return on_obstacle_[k]; }

 private:
  std::vector<ActiveContact> contacts_;
  std::vector<ContactWrench> on_obstacle_;
  std::int64_t touching_ = 0;
  StoredEnergy stored_;
  ContactPower power_;
};

}  // namespace floe
