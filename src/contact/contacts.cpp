// One step of all contacts: evaluation, and what a step leaves behind.

#include "floe/contact/contacts.h"

#include <algorithm>
#include <cmath>

#include "floe/contact/separation.h"

namespace floe {
namespace {

/// Of the body's size: below, a gap is rounding; and of its cube: an overlap.
constexpr double rounding = 1e-13, rounding_volume = 1e-15;

Vec3<double> moved(const Triad<double>& axes, const Vec3<double>& x, const Vec3<double>& r) {
  return x + axes.to_world(r);
}

}  // namespace

/// Gap along the pair's axis, or along one that is then found [m]; not positive: perhaps none.
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

/// Of A against B at a point of both. \param centre  from A's centroid
RelativeMotion Contacts::relative(const Placed& a, const Placed& b, const Vec3<double>& centre) {
  const Vec3<double> arm = centre + (a.x - b.x);
  return {(a.velocity + cross(a.spin, centre)) - (b.velocity + cross(b.spin, arm)),
          a.spin - b.spin};
}

/// Of the elastic, viscous and friction terms.
void Contacts::add_power(const Touch& touch, const RelativeMotion& motion,
                         std::array<double, 4>& power) {
  const ContactForce& c = touch.contact;
  const double parting = dot(c.normal, motion.velocity);
  power[0] += c.elastic * parting + dot(c.couple, motion.spin);
  power[1] += c.viscous * parting;
  power[2] += dot(c.memory.tangential, motion.velocity);
}

/// What a moving obstacle gives [W].
double Contacts::power_of_obstacle(const Touch& touch, const Placed& a, const Placed& obstacle) {
  const Vec3<double> arm = touch.centre + (a.x - obstacle.x);
  return dot(touch.contact.force(), obstacle.velocity + cross(obstacle.spin, arm)) +
         dot(touch.contact.couple, obstacle.spin);
}

/// Overlap and force of a pair that may touch; false if it does not.
/// \param memory  null: it remembers nothing
bool Contacts::meet(std::int32_t index, const Placed& b, const PairMemory* memory) {
  const Pair& pair = pairs_[static_cast<std::size_t>(index)];
  const Placed& a = placed_[static_cast<std::size_t>(pair.slot_a)];
  // A's vertices in B's frame.
  const Triad<double> turn{b.axes.to_local(a.axes.e1), b.axes.to_local(a.axes.e2),
                           b.axes.to_local(a.axes.e3)};
  const Vec3<double> apart = b.axes.to_local(a.x - b.x);
  work_a_.clear();
  for (const auto& r : vertices(pair.a)) work_a_.push_back(moved(turn, apart, r));
  Overlap o = clipper_.overlap(shapes_, solids_[static_cast<std::size_t>(pair.a)].shape, work_a_,
                               planes(pair.b));
  const double size = radius(pair.a);
  if (o.volume <= rounding_volume * size * size * size) return false;
  const HalfSpace& first = planes(pair.b)[0];
  const double depth = first.offset - dot(first.normal, o.centroid);
  o.centroid = b.axes.to_world(o.centroid) + (b.x - a.x);  // from A's centroid
  o.area = b.axes.to_world(o.area);
  o.moment = b.axes.to_world(o.moment);
  const RelativeMotion motion = relative(a, b, o.centroid);
  StoredEnergy stored;
  touches_.push_back(
      {index, o.centroid,
       contact_force(options_, constants(pair.a, pair.b), o, depth, motion,
                     memory != nullptr ? *memory : PairMemory{}, pair.fresh, stored)});
  if (pair.counted) {
    ++touching_;
    totals_.stored.normal += stored.normal;
    totals_.stored.tangential += stored.tangential;
    add_power(touches_.back(), motion, totals_.power);
    if (pair.b < 0) totals_.power[3] += power_of_obstacle(touches_.back(), a, b);
  }
  return true;
}

void Contacts::evaluate(std::span<const MovingPose> bodies, double time,
                        std::span<ContactWrench> wrenches) {
  for (std::size_t s = 0; s < bodies.size(); ++s)
    placed_[s] = {bodies[s].pose.x, triad(bodies[s].pose.q), bodies[s].velocity, bodies[s].spin};
  obstacles_at_.clear();
  const double half_a_step_ago = time - 0.5 * sums_[4];  // as the bodies' velocities
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(obstacles_.size()); ++k)
    obstacles_at_.push_back(at_time(-1 - k, time, half_a_step_ago));
  time_ = time;
  std::fill(on_obstacle_.begin(), on_obstacle_.end(), ContactWrench{});
  touches_.clear();
  touching_ = 0;
  totals_ = {};
  auto memory = memories_.cbegin();  // in the order of the pairs
  constexpr int tries = 8;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    Pair& pair = pairs_[k];
    const Placed& a = placed_[static_cast<std::size_t>(pair.slot_a)];
    const Placed& b = pair.b < 0 ? obstacles_at_[static_cast<std::size_t>(-1 - pair.b)]
                                 : placed_[static_cast<std::size_t>(pair.slot_b)];
    const auto index = static_cast<std::int32_t>(k);
    const PairMemory* remembered = nullptr;
    if (memory != memories_.cend() && memory->pair == index) remembered = &(memory++)->memory;
    if (remembered == nullptr && gap(pair, a, b, tries) > rounding * radius(pair.a)) continue;
    if (!meet(index, b, remembered)) continue;
    const Touch& t = touches_.back();
    const Vec3<double> force = t.contact.force();
    ContactWrench& on_a = wrenches[static_cast<std::size_t>(pair.slot_a)];
    on_a.force = on_a.force + force;
    on_a.moment = on_a.moment + cross(t.centre, force) + t.contact.couple;
    ContactWrench& on_b = pair.b < 0 ? on_obstacle_[static_cast<std::size_t>(-1 - pair.b)]
                                     : wrenches[static_cast<std::size_t>(pair.slot_b)];
    on_b.force = on_b.force - force;
    on_b.moment = on_b.moment - cross(t.centre + (a.x - b.x), force) - t.contact.couple;
  }
}

void Contacts::commit(std::span<const MovingPose> bodies, double dt) {
  const double last_dt = sums_[4];
  if (sums_[6] == 0) {
    sums_[5] = energies().stored;
    sums_[6] = 1;
  }
  memories_.clear();
  for (std::size_t k = 0; k < obstacles_at_.size(); ++k) {
    obstacles_at_[k].velocity = obstacles_[k].motion.rate(time_ + 0.5 * dt);
    obstacles_at_[k].spin = obstacles_[k].motion.spin(time_ + 0.5 * dt);
  }
  std::array<double, 4> power{};
  for (const Touch& t : touches_) {
    const Pair& pair = pairs_[static_cast<std::size_t>(t.pair)];
    const auto moving = [&](std::int32_t slot) {  // where it was, as it moves now
      const auto s = static_cast<std::size_t>(slot);
      return Placed{placed_[s].x, {}, bodies[s].velocity, bodies[s].spin};
    };
    const Placed a = moving(pair.slot_a);
    const Placed b =
        pair.b < 0 ? obstacles_at_[static_cast<std::size_t>(-1 - pair.b)] : moving(pair.slot_b);
    const RelativeMotion motion = relative(a, b, t.centre);
    if (pair.counted) add_power(t, motion, power);
    if (pair.b < 0) power[3] += power_of_obstacle(t, a, b);
    memories_.push_back(
        {pair.a, pair.b, t.pair, slid(t.contact, motion, 0.5 * (a.spin + b.spin), dt)});
  }
  for (std::size_t k = 0; k < power.size(); ++k)
    sums_[k] += 0.5 * (last_dt * totals_.power[k] + dt * power[k]);
  if (fresh_) {
    for (Pair& pair : pairs_) pair.fresh = false;
  }
  fresh_ = false;
  touches_.clear();
  totals_ = {};
  sums_[4] = dt;
}

ContactEnergies Contacts::energies() const {
  std::array<double, 4> work{sums_[0], sums_[1], sums_[2], sums_[3]};
  for (std::size_t k = 0; k < work.size(); ++k) work[k] += 0.5 * sums_[4] * totals_.power[k];
  const StoredEnergy& stored = totals_.stored;
  ContactEnergies e;
  e.stored = stored.normal + stored.tangential;
  e.viscous = -work[1];
  e.friction = -work[2] - stored.tangential;
  e.crushing = sums_[6] == 0 ? 0.0 : sums_[5] - work[0] - stored.normal;
  e.external = work[3];
  return e;
}

}  // namespace floe
