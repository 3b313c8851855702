// One step of all contacts: evaluation and commit.

#include "contact/contacts.h"

#include <algorithm>
#include <cmath>

#include "contact/separation.h"

namespace floe {
namespace {

/// Gaps below this part of the size of a body, and overlaps below this part of its cube, are
/// rounding.
constexpr double rounding = 1e-13, rounding_volume = 1e-15;

Vec3<double> moved(const Triad<double>& axes, const Vec3<double>& x, const Vec3<double>& r) {
  return x + axes.to_world(r);
}

}  // namespace

/// Gap of a pair along its axis, or along a better axis that replaces it [m]. Not positive: no gap
/// was found, which does not prove an overlap.
double Contacts::gap(Pair& pair, const Placed& a, const Placed& b, int tries) {
  const Vec3<double> apart = a.x - b.x;
  const auto points_a = vertices(pair.a), points_b = vertices(pair.b);
  const Vec3<double> along_a = a.axes.to_local(pair.axis), along_b = b.axes.to_local(pair.axis);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& r : points_a) low = std::min(low, dot(along_a, r));
  for (const auto& r : points_b) high = std::max(high, dot(along_b, r));
  if (points_b.empty()) high = planes(pair.b)[0].offset;
  const double found = low + dot(pair.axis, apart) - high;
  if (found > 0 || tries == 0 || points_b.empty()) return found;
  work_a_.clear();
  for (const auto& r : points_a) work_a_.push_back(moved(a.axes, apart, r));
  work_b_.clear();
  for (const auto& r : points_b) work_b_.push_back(b.axes.to_world(r));
  return separate(work_a_, work_b_, pair.axis, tries);
}

PairConstants Contacts::constants(std::int32_t a, std::int32_t b) const {
  const Solid& i = solids_[static_cast<std::size_t>(a)];
  if (b < 0) {
    const Obstacle& o = obstacles_[static_cast<std::size_t>(-1 - b)];
    return {options_.young / (0.5 * i.size), i.size * i.size, i.mass, o.friction,
            o.vertices.empty()};
  }
  const Solid& j = solids_[static_cast<std::size_t>(b)];
  const double smaller = std::min(i.size, j.size);
  return {options_.young / (0.5 * (i.size + j.size)), smaller * smaller,
          i.mass * j.mass / (i.mass + j.mass), options_.friction, false};
}

/// Motion of A relative to B at a point of both.
/// \param centre  the point, from the centroid of A
RelativeMotion Contacts::relative(const Placed& a, const Placed& b, const Vec3<double>& centre) {
  const Vec3<double> arm = centre + (a.x - b.x);
  return {(a.velocity + cross(a.spin, centre)) - (b.velocity + cross(b.spin, arm)),
          a.spin - b.spin};
}

/// Adds the power of the elastic, viscous and friction terms of a contact.
void Contacts::add_power(const ActiveContact& touch, const RelativeMotion& motion,
                         ContactPower& power) {
  const ContactForce& c = touch.contact;
  const double parting = dot(c.normal, motion.velocity);
  power.elastic += c.elastic * parting + dot(c.couple, motion.spin);
  power.viscous += c.viscous * parting;
  power.friction += dot(c.memory.tangential, motion.velocity);
}

/// Power of a moving obstacle on a body [W].
double Contacts::power_of_obstacle(const ActiveContact& touch, const Placed& a,
                                   const Placed& obstacle) {
  const Vec3<double> arm = touch.centre + (a.x - obstacle.x);
  return dot(touch.contact.force(), obstacle.velocity + cross(obstacle.spin, arm)) +
         dot(touch.contact.couple, obstacle.spin);
}

Contacts::PairOverlap Contacts::overlap_of(const Pair& pair, const Placed& a, const Placed& b) {
  // A's vertices in B's frame.
  const Triad<double> turn{b.axes.to_local(a.axes.e1), b.axes.to_local(a.axes.e2),
                           b.axes.to_local(a.axes.e3)};
  const Vec3<double> apart = b.axes.to_local(a.x - b.x);
  work_a_.clear();
  for (const auto& r : vertices(pair.a)) work_a_.push_back(moved(turn, apart, r));
  const Solid& solid = solids_[static_cast<std::size_t>(pair.a)];
  Overlap o = clipper_.overlap(shapes_, pair.a, work_a_, planes(pair.b));
  if (o.volume <= rounding_volume * solid.radius * solid.radius * solid.radius) return {};
  const HalfSpace& first = planes(pair.b)[0];
  const double depth = first.offset - dot(first.normal, o.centroid);
  o.centroid = b.axes.to_world(o.centroid) + (b.x - a.x);
  o.area = b.axes.to_world(o.area);
  o.moment = b.axes.to_world(o.moment);
  return {o, depth};
}

/// Adds a contact: its wrenches, its power and stored energy.
/// \param memory  null: the pair has no history
void Contacts::touch(std::int32_t index, const Placed& b, const PairOverlap& met,
                     const PairHistory* memory, std::span<ContactWrench> wrenches) {
  const Pair& pair = pairs_[static_cast<std::size_t>(index)];
  const Placed& a = placed_[static_cast<std::size_t>(pair.slot_a)];
  const Vec3<double>& centre = met.overlap.centroid;
  const RelativeMotion motion = relative(a, b, centre);
  StoredEnergy stored;
  active_.push_back(
      {index, centre,
       contact_force(options_, constants(pair.a, pair.b), met.overlap, met.depth, motion,
                     memory != nullptr ? *memory : PairHistory{}, pair.newly_eligible, stored),
       false});
  const ContactForce& contact = active_.back().contact;
  // Compares the mean elastic depth (V - V_p)/|S| with the width.
  constexpr double holds = 0.25;
  const double elastic = met.overlap.volume - contact.memory.plastic;
  const double most = holds * std::min(width_of(pair.a), width_of(pair.b));
  active_.back().deep =
      elastic > 0 && elastic * elastic > most * most * dot(met.overlap.area, met.overlap.area);
  if (pair.counted) {
    ++touching_;
    totals_.stored.normal += stored.normal;
    totals_.stored.tangential += stored.tangential;
    add_power(active_.back(), motion, totals_.power);
    if (pair.b < 0) totals_.power.obstacles += power_of_obstacle(active_.back(), a, b);
  }
  const Vec3<double> force = contact.force();
  ContactWrench& on_a = wrenches[static_cast<std::size_t>(pair.slot_a)];
  on_a.force = on_a.force + force;
  on_a.moment = on_a.moment + cross(centre, force) + contact.couple;
  ContactWrench& on_b = pair.b < 0 ? on_obstacle_[static_cast<std::size_t>(-1 - pair.b)]
                                   : wrenches[static_cast<std::size_t>(pair.slot_b)];
  on_b.force = on_b.force - force;
  on_b.moment = on_b.moment - cross(centre + (a.x - b.x), force) - contact.couple;
}

void Contacts::place(std::span<const MovingPose> bodies, double time) {
  const auto move = [&](Placed& p, const Placed& to, double radius) {
    const double travelled = placed_before_ ? p.travelled + farthest_travel(p, to, radius) : 0.0;
    p = to;
    p.travelled = travelled;
  };
  for (std::size_t s = 0; s < bodies.size(); ++s)
    move(placed_[s],
         {bodies[s].pose.x, triad(bodies[s].pose.q), bodies[s].velocity, bodies[s].spin},
         radius(involved_[s]));
  const double half_a_step_ago = time - 0.5 * books_.last_dt;  // the time of the velocities
  for (std::size_t k = 0; k < obstacles_.size(); ++k)
    move(obstacles_at_[k], at_time(-1 - static_cast<std::int32_t>(k), time, half_a_step_ago),
         obstacle_radius_[k]);
  time_ = time;
  placed_before_ = true;
}

/// Bound of the travel of all points within `radius` of the centroid of a body [m].
double Contacts::farthest_travel(const Placed& from, const Placed& to, double radius) {
  const Vec3<double> d1 = to.axes.e1 - from.axes.e1, d2 = to.axes.e2 - from.axes.e2,
                     d3 = to.axes.e3 - from.axes.e3, x = to.x - from.x;
  return std::sqrt(dot(x, x)) + radius * std::sqrt(dot(d1, d1) + dot(d2, d2) + dot(d3, d3));
}

void Contacts::overlaps_taken_on(std::span<PairOverlap> overlaps) {
  for (std::size_t k = 0; k < taken_on_.size(); ++k) {
    const Pair& pair = taken_on_[k];
    overlaps[k] = overlap_of(pair, placed_[static_cast<std::size_t>(pair.slot_a)], partner(pair));
  }
}

void Contacts::evaluate(std::span<ContactWrench> wrenches,
                        const std::function<std::span<const PairOverlap>()>& offloaded) {
  std::fill(on_obstacle_.begin(), on_obstacle_.end(), ContactWrench{});
  active_.clear();
  touching_ = 0;
  totals_ = {};
  auto memory = histories_.cbegin();   // in list order
  std::span<const PairOverlap> given;  // overlaps of the offloaded pairs, in their order
  std::size_t taken = 0;
  constexpr int tries = 8;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    Pair& pair = pairs_[k];
    const Placed& a = placed_[static_cast<std::size_t>(pair.slot_a)];
    const Placed& b = partner(pair);
    const auto index = static_cast<std::int32_t>(k);
    const PairHistory* remembered = nullptr;
    if (memory != histories_.cend() && memory->pair == index) remembered = &(memory++)->memory;
    if (pair.offloaded) {
      if (given.empty()) given = offloaded();
      if (const PairOverlap& met = given[taken++]; met.overlap.volume > 0)
        touch(index, b, met, remembered, wrenches);
      continue;
    }
    if (remembered == nullptr) {
      const double travels = a.travelled + b.travelled;
      if (travels < pair.safe) continue;
      if (const double apart = gap(pair, a, b, tries); apart > rounding * radius(pair.a)) {
        pair.safe = travels + (1 - 1e-6) * apart;  // with a margin for the rounding of travels
        continue;
      }
    }
    if (const PairOverlap met = overlap_of(pair, a, b); met.overlap.volume > 0)
      touch(index, b, met, remembered, wrenches);
  }
}

std::vector<std::array<std::int32_t, 2>> Contacts::enclosed() const {
  std::vector<std::array<std::int32_t, 2>> found;
  for (const ActiveContact& t : active_) {
    const Pair& pair = pairs_[static_cast<std::size_t>(t.pair)];
    const Vec3<double>& n = t.contact.normal;
    if (pair.counted && dot(n, n) == 0) found.push_back({pair.a, pair.b});
  }
  return found;
}

void Contacts::commit(std::span<const MovingPose> bodies, double dt) {
  histories_.clear();
  for (std::size_t k = 0; k < obstacles_at_.size(); ++k) {
    obstacles_at_[k].velocity = obstacles_[k].motion.rate(time_ + 0.5 * dt);
    obstacles_at_[k].spin = obstacles_[k].motion.spin(time_ + 0.5 * dt);
  }
  ContactPower power;
  for (const ActiveContact& t : active_) {
    const Pair& pair = pairs_[static_cast<std::size_t>(t.pair)];
    const auto moving = [&](std::int32_t slot) {  // place of the evaluation, velocities of now
      const auto s = static_cast<std::size_t>(slot);
      return Placed{placed_[s].x, {}, bodies[s].velocity, bodies[s].spin};
    };
    const Placed a = moving(pair.slot_a);
    const Placed b =
        pair.b < 0 ? obstacles_at_[static_cast<std::size_t>(-1 - pair.b)] : moving(pair.slot_b);
    const RelativeMotion motion = relative(a, b, t.centre);
    if (pair.counted) {
      add_power(t, motion, power);
      note_events(t);
    }
    if (pair.b < 0) power.obstacles += power_of_obstacle(t, a, b);
    histories_.push_back(
        {pair.a, pair.b, t.pair, slid(t.contact, motion, 0.5 * (a.spin + b.spin), dt)});
  }
  books_.take(totals_.power, power, totals_.stored, dt);
  if (some_newly_eligible_) {
    for (Pair& pair : pairs_) pair.newly_eligible = false;
  }
  some_newly_eligible_ = at_rest_ = false;
  active_.clear();
  totals_ = {};
}

ContactEnergies Contacts::energies() const {
  return books_.energies(totals_.power, totals_.stored);
}

}  // namespace floe
