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
  const auto i = static_cast<std::size_t>(a);
  const double size_a = std::cbrt(volumes_[i]);
  if (b < 0) {
    const Obstacle& o = obstacles_[static_cast<std::size_t>(-1 - b)];
    return {options_.young / (0.5 * size_a), size_a * size_a, masses_[i], o.friction,
            o.vertices.empty()};
  }
  const auto j = static_cast<std::size_t>(b);
  const double size_b = std::cbrt(volumes_[j]), smaller = std::min(size_a, size_b);
  return {options_.young / (0.5 * (size_a + size_b)), smaller * smaller,
          masses_[i] * masses_[j] / (masses_[i] + masses_[j]), options_.friction, false};
}

/// \param centre  relative to A's centroid
RelativeMotion Contacts::relative(const Pair& pair, const Vec3<double>& centre,
                                  std::span<const MovingPose> bodies) const {
  const MovingPose& a = bodies[static_cast<std::size_t>(pair.slot_a)];
  const Vec3<double> velocity = a.velocity + cross(a.spin, centre);
  if (pair.b < 0)
    return {velocity - obstacles_[static_cast<std::size_t>(-1 - pair.b)].velocity, a.spin};
  const MovingPose& b = bodies[static_cast<std::size_t>(pair.slot_b)];
  const Vec3<double> arm = centre + (placed_[static_cast<std::size_t>(pair.slot_a)].x -
                                     placed_[static_cast<std::size_t>(pair.slot_b)].x);
  return {velocity - (b.velocity + cross(b.spin, arm)), a.spin - b.spin};
}

std::array<double, 4> Contacts::powers(const Touch& t, std::span<const MovingPose> bodies) const {
  const Pair& pair = pairs_[static_cast<std::size_t>(t.pair)];
  const RelativeMotion m = relative(pair, t.centre, bodies);
  const ContactForce& c = t.contact;
  const double given =
      pair.b < 0 ? dot(c.force(), obstacles_[static_cast<std::size_t>(-1 - pair.b)].velocity) : 0.0;
  return {dot(c.elastic, m.velocity) + dot(c.couple, m.spin), dot(c.viscous, m.velocity),
          dot(c.tangential, m.velocity), given};
}

/// Overlap and force of a pair that may touch; false if it does not.
bool Contacts::meet(std::int32_t index, const Placed& b, std::span<const MovingPose> bodies) {
  Pair& pair = pairs_[static_cast<std::size_t>(index)];
  const Placed& a = placed_[static_cast<std::size_t>(pair.slot_a)];
  // A's vertices in B's frame.
  const Triad<double> turn{b.axes.to_local(a.axes.e1), b.axes.to_local(a.axes.e2),
                           b.axes.to_local(a.axes.e3)};
  const Vec3<double> apart = b.axes.to_local(a.x - b.x);
  work_a_.clear();
  for (const auto& r : vertices(pair.a)) work_a_.push_back(moved(turn, apart, r));
  Overlap o = clipper_.overlap(shapes_, pair.a, work_a_, planes(pair.b));
  const double size = radius_[static_cast<std::size_t>(pair.a)];
  if (o.volume <= rounding_volume * size * size * size) return false;
  const HalfSpace& first = planes(pair.b)[0];
  const double depth = first.offset - dot(first.normal, o.centroid);
  o.centroid = b.axes.to_world(o.centroid) + (b.x - a.x);  // from A's centroid
  o.area = b.axes.to_world(o.area);
  o.moment = b.axes.to_world(o.moment);
  const PairMemory memory =
      pair.memory < 0 ? PairMemory{} : memories_[static_cast<std::size_t>(pair.memory)].memory;
  pair.touch = static_cast<std::int32_t>(touches_.size());
  touches_.push_back({index,
                      o.centroid,
                      contact_force(options_, constants(pair.a, pair.b), o, depth,
                                    relative(pair, o.centroid, bodies), memory, pair.fresh),
                      {}});
  touches_.back().power = powers(touches_.back(), bodies);
  return true;
}

void Contacts::evaluate(std::span<const MovingPose> bodies, double time,
                        std::span<ContactWrench> wrenches) {
  for (std::size_t s = 0; s < bodies.size(); ++s)
    placed_[s] = {bodies[s].pose.x, triad(bodies[s].pose.q)};
  std::fill(on_obstacle_.begin(), on_obstacle_.end(), ContactWrench{});
  touches_.clear();
  touching_ = 0;
  constexpr int tries = 8;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    Pair& pair = pairs_[k];
    pair.touch = -1;
    const Placed& a = placed_[static_cast<std::size_t>(pair.slot_a)];
    const Placed b =
        pair.b < 0 ? at_time(pair.b, time) : placed_[static_cast<std::size_t>(pair.slot_b)];
    const double clear = rounding * radius_[static_cast<std::size_t>(pair.a)];
    if (pair.memory < 0 && gap(pair, a, b, tries) > clear) continue;
    if (!meet(static_cast<std::int32_t>(k), b, bodies)) continue;
    const Touch& t = touches_.back();
    const Vec3<double> force = t.contact.force();
    ContactWrench& on_a = wrenches[static_cast<std::size_t>(pair.slot_a)];
    on_a.force = on_a.force + force;
    on_a.moment = on_a.moment + cross(t.centre, force) + t.contact.couple;
    touching_ += pair.counted ? 1 : 0;
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
  for (const Remembered& r : memories_) {
    if (r.pair >= 0) pairs_[static_cast<std::size_t>(r.pair)].memory = -1;
  }
  memories_.clear();
  for (const Touch& t : touches_) {
    Pair& pair = pairs_[static_cast<std::size_t>(t.pair)];
    if (pair.counted) {
      const std::array<double, 4> power = powers(t, bodies);
      for (std::size_t k = 0; k < power.size(); ++k)
        sums_[k] += 0.5 * (last_dt * t.power[k] + dt * power[k]);
    }
    PairMemory memory = t.contact.memory;
    const MovingPose& a = bodies[static_cast<std::size_t>(pair.slot_a)];
    const Vec3<double> other =
        pair.b < 0 ? Vec3<double>{} : bodies[static_cast<std::size_t>(pair.slot_b)].spin;
    slide(memory, relative(pair, t.centre, bodies), 0.5 * (a.spin + other), dt);
    pair.memory = static_cast<std::int32_t>(memories_.size());
    memories_.push_back({pair.a, pair.b, t.pair, memory});
  }
  for (Pair& pair : pairs_) pair.fresh = false;
  touches_.clear();
  sums_[4] = dt;
}

ContactEnergies Contacts::energies() const {
  std::array<double, 4> work{sums_[0], sums_[1], sums_[2], sums_[3]};
  double normal = 0, tangential = 0;
  for (const Touch& t : touches_) {
    if (!pairs_[static_cast<std::size_t>(t.pair)].counted) continue;
    normal += t.contact.normal_energy;
    tangential += t.contact.tangential_energy;
    for (std::size_t k = 0; k < work.size(); ++k) work[k] += 0.5 * sums_[4] * t.power[k];
  }
  ContactEnergies e;
  e.stored = normal + tangential;
  e.viscous = -work[1];
  e.friction = -work[2] - tangential;
  e.crushing = sums_[6] == 0 ? 0.0 : sums_[5] - work[0] - normal;
  e.external = work[3];
  return e;
}

}  // namespace floe
