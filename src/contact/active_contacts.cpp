#include "contact/active_contacts.h"

#include <algorithm>

#include "floe/base/item.h"

namespace floe {

void add_power(const ContactForce& contact, const RelativeMotion& motion, ContactPower& power) {
  const double parting = dot(contact.normal, motion.velocity);
  power.elastic += contact.elastic * parting + dot(contact.couple, motion.spin);
  power.viscous += contact.viscous * parting + dot(contact.viscous_couple, motion.spin);
  power.friction += dot(contact.friction.force, motion.velocity) +
                    contact.friction.couple * dot(contact.normal, motion.spin);
}

double power_of_obstacle(const ActiveContact& active, const Placed& a, const Placed& obstacle) {
  const Vec3<double> arm = active.centre + (a.x - obstacle.x);
  return dot(active.contact.force(), obstacle.velocity + cross(obstacle.spin, arm)) +
         dot(active.contact.whole_couple(), obstacle.spin);
}

void ActiveContacts::start() {
  std::fill(on_obstacle_.begin(), on_obstacle_.end(), ContactWrench{});
  contacts_.clear();
  touching_ = 0;
  stored_ = {};
  power_ = {};
}

void ActiveContacts::add(const ActiveContact& active, const Pair& pair, const Placed& a,
                         const Placed& b, const RelativeMotion& motion, const StoredEnergy& stored,
                         std::span<ContactWrench> wrenches) {
  contacts_.push_back(active);
  const ContactForce& contact = active.contact;
  if (pair.counted) {
    ++touching_;
    stored_.normal += stored.normal;
    stored_.tangential += stored.tangential;
    add_power(contact, motion, power_);
    if (is_obstacle(pair.b)) power_.obstacles += power_of_obstacle(active, a, b);
  }
  const Vec3<double> force = contact.force(), couple = contact.whole_couple();
  ContactWrench& on_a = item(wrenches, pair.slot_a);
  on_a.force = on_a.force + force;
  on_a.moment = on_a.moment + cross(active.centre, force) + couple;
  ContactWrench& on_b =
      is_obstacle(pair.b) ? on_obstacle_[obstacle_number(pair.b)] : item(wrenches, pair.slot_b);
  on_b.force = on_b.force - force;
  on_b.moment = on_b.moment - cross(active.centre + (a.x - b.x), force) - couple;
}

void ActiveContacts::end_step() {
  contacts_.clear();
  stored_ = {};
  power_ = {};
}

}  // namespace floe
