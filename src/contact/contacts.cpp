#include "contact/contacts.h"

#include <utility>

namespace floe {

Contacts::Contacts(const Shapes& shapes, std::span<const double> masses,
                   std::vector<BodyPair> joined, const ContactOptions& options,
                   std::vector<Obstacle> obstacles)
    : solids_(shapes, masses, std::move(obstacles)),
      options_(options),
      law_(law_of(options)),
      list_(solids_, std::move(joined), options.initial_overlap == InitialOverlap::stress_free),
      places_(solids_.obstacles().size()),
      narrow_(options.damping_ratio > 0 || solids_.has_friction(options)),
      active_(solids_.obstacles().size()) {}

void Contacts::build(std::span<const Pose> poses, std::span<const std::uint8_t> here, double time) {
  list_.build(solids_, narrow_, poses, here, time);
  places_.restart(list_.involved().size());
  history_.take_over(list_.pairs());
  active_.clear();
}

std::vector<BodyPair> Contacts::offload(std::size_t count) {
  std::vector<BodyPair> pairs;
  for (const ContactHistory::Entry& entry : history_.last(count))
    pairs.push_back(list_.offload(entry.pair));
  return pairs;
}

void Contacts::take_on(std::span<const BodyPair> pairs) {
  list_.take_on(pairs);
  places_.restart(list_.involved().size());
}

void Contacts::place(std::span<const MovingPose> bodies, double time, double velocity_time) {
  places_.place(solids_, list_.involved(), bodies, time, velocity_time);
  last_dt_ = 2 * (time - velocity_time);
}

void Contacts::overlaps_taken_on(std::span<PairOverlap> overlaps) {
  const std::span<Pair> pairs = list_.taken_on();
  for (std::size_t k = 0; k < pairs.size(); ++k)
    overlaps[k] =
        narrow_.overlap(solids_, wear_, pairs[k], places_.of_a(pairs[k]), places_.of_b(pairs[k]));
}

void Contacts::evaluate(std::span<ContactWrench> wrenches, const OffloadedOverlaps& offloaded) {
  active_.start();
  touches_.clear();
  std::visit([&](const auto& law) { evaluate_pairs(law, wrenches, offloaded); }, law_);
}

void Contacts::damp(std::span<const Acceleration> accelerations,
                    std::span<ContactWrench> wrenches) {
  active_.start();
  places_.set_obstacles_now(solids_);
  const auto later = [&](Placed solid, std::int32_t slot) {
    const Acceleration& change = item(accelerations, slot);
    solid.velocity = solid.velocity + (0.5 * last_dt_) * change.linear;
    solid.spin = solid.spin + (0.5 * last_dt_) * change.angular;
    return solid;
  };
  std::visit(
      [&](const auto& law) {
        for (const Touch& touch : touches_) {
          const Pair& pair = list_.pair(touch.pair);
          const Placed a = later(places_.of_a(pair), pair.slot_a);
          const Placed b = is_obstacle(pair.b) ? places_.obstacle_now(pair)
                                               : later(places_.of_b(pair), pair.slot_b);
          const RelativeMotion predicted = relative_motion(a, b, touch.met.overlap.centroid);
          respond(law, touch, &predicted, wrenches);
        }
      },
      law_);
}

Acceleration Contacts::acceleration(std::int32_t slot, const ContactWrench& wrench) const {
  const InverseInertia inverse =
      solids_.inverse_inertia(list_.involved()[static_cast<std::size_t>(slot)]);
  const Triad<double>& axes = places_.of_slot(slot).axes;
  const Vec3<double> m = axes.to_local(wrench.moment);
  return {.linear = inverse.mass * wrench.force,
          .angular = axes.to_world(
              {inverse.moments.x * m.x, inverse.moments.y * m.y, inverse.moments.z * m.z})};
}

template <IsContactLaw Law>
void Contacts::evaluate_pairs(const Law& law, std::span<ContactWrench> wrenches,
                              const OffloadedOverlaps& offloaded) {
  ContactHistory::Cursor histories(history_);
  std::span<const PairOverlap> given;  // overlaps of the offloaded pairs, in their order
  std::size_t taken = 0;
  std::int32_t index = 0;
  for (Pair& pair : list_.pairs()) {
    const Placed &a = places_.of_a(pair), &b = places_.of_b(pair);
    const PairHistory* memory = histories.of(index);
    if (pair.offloaded) {
      if (given.empty()) given = offloaded();
      touch(law, index, given[taken++], memory, wrenches);
    } else if (memory != nullptr || !narrow_.is_apart(solids_, pair, a, b)) {
      touch(law, index, narrow_.overlap(solids_, wear_, pair, a, b), memory, wrenches);
    }
    ++index;
  }
}

/// Adds the contact of a pair, unless there is no overlap.
/// \param memory  null: the pair has no history
template <IsContactLaw Law>
void Contacts::touch(const Law& law, std::int32_t index, const PairOverlap& met,
                     const PairHistory* memory, std::span<ContactWrench> wrenches) {
  if (!(met.overlap.volume > 0)) return;
  const Touch touch{.pair = index,
                    .met = met,
                    .memory = memory != nullptr ? *memory : PairHistory{},
                    .known = memory != nullptr};
  if (damps()) touches_.push_back(touch);
  respond(law, touch, nullptr, wrenches);
}

/// Adds the response of a law to a touch.
/// \param predicted  motion at t_n but for dashpots; null: dashpots are left out
template <IsContactLaw Law>
void Contacts::respond(const Law& law, const Touch& touch, const RelativeMotion* predicted,
                       std::span<ContactWrench> wrenches) {
  const Overlap& overlap = touch.met.overlap;
  const Pair& pair = list_.pair(touch.pair);
  const Placed &a = places_.of_a(pair), &b = places_.of_b(pair);
  const RelativeMotion motion = relative_motion(a, b, overlap.centroid);
  const Mobility mobility{.a = solids_.inverse_inertia(pair.a),
                          .b = solids_.inverse_inertia(pair.b),
                          .axes_a = a.axes,
                          .axes_b = b.axes,
                          .apart = a.x - b.x};
  const bool wet = a.x.z + overlap.centroid.z < 0;
  const LastStep last{.dt = last_dt_, .touched = touch.known || pair.newly_eligible};
  const ContactResponse response = contact_response(
      law, pair_constants(solids_, options_, pair, wet), overlap, touch.met.depth, motion,
      predicted, mobility, last, 0.5 * (a.spin + b.spin), touch.memory, pair.newly_eligible);
  const double plastic = response.contact.memory.plastic;
  active_.add({.pair = touch.pair,
               .deep = is_deep(solids_, pair, overlap, plastic),
               .centre = overlap.centroid,
               .contact = response.contact},
              pair, a, b, motion, response.stored, wrenches);
}

void Contacts::commit(std::span<const MovingPose> bodies, double velocity_time) {
  history_.start();
  places_.set_obstacle_velocities(solids_, velocity_time);
  later_power_ = {};
  for (const ActiveContact& active : active_.contacts()) commit(active, bodies);
  if (wears()) find_crushed();
  start_.take(active_.stored());
  list_.end_step();
  active_.end_step();
}

/// Commits one contact and adds its power with the velocities after the step.
void Contacts::commit(const ActiveContact& active, std::span<const MovingPose> bodies) {
  const Pair& pair = list_.pair(active.pair);
  const ContactForce& contact = active.contact;
  const Placed a = places_.moving(pair.slot_a, item(bodies, pair.slot_a));
  const Placed b = is_obstacle(pair.b) ? places_.of_b(pair)
                                       : places_.moving(pair.slot_b, item(bodies, pair.slot_b));
  const RelativeMotion motion = relative_motion(a, b, active.centre);
  if (pair.counted) {
    add_power(contact, motion, later_power_);
    events_.note(active, pair, places_.time());
  }
  if (is_obstacle(pair.b)) later_power_.obstacles += power_of_obstacle(active, a, b);
  history_.add({.a = pair.a, .b = pair.b, .pair = active.pair, .memory = contact.memory});
}

/// Finds what counted contacts have crushed by the last step, and the cuts of those that parted.
void Contacts::find_crushed() {
  ContactHistory::Cursor before = history_.before();
  crushing_.start();
  for (const ActiveContact& active : active_.contacts()) {
    const double after = active.contact.memory.plastic;
    const Pair& pair = list_.pair(active.pair);
    if (!pair.counted || after == 0) continue;
    const PairHistory* memory = before.of(active.pair);
    const double born = pair.newly_eligible ? after : 0.0;
    crushing_.take(pair, memory != nullptr ? memory->plastic : born, after, active.contact.normal,
                   places_.of_a(pair).axes, places_.of_b(pair).axes);
  }
  crushing_.end();
  cuts_.clear();
  for (const Crush& crush : crushing_.parted()) cuts_.push_back(cut_of(crush));
}

/// The body that loses what was crushed is the sharper one, of which the lost volume is the higher
/// cap; obstacles lose nothing.
WearCut Contacts::cut_of(const Crush& crush) {
  constexpr double clearly = 1 + 1e-6;
  const double volume = crush.plastic - crush.before;
  CapFinder::Cap cap = caps_.find(solids_, wear_, crush.a, -1.0 * crush.normal_a, volume);
  std::int32_t body = crush.a;
  if (!is_obstacle(crush.b)) {
    const CapFinder::Cap other = caps_.find(solids_, wear_, crush.b, crush.normal_b, volume);
    if (other.height > clearly * cap.height) {
      cap = other;
      body = crush.b;
    }
  }
  return {.a = crush.a, .b = crush.b, .body = body, .left = cap.left, .volume = volume};
}

void Contacts::wear(std::span<const WearCut> cuts) {
  for (const WearCut& cut : cuts) wear_.add(solids_, cut);
}

void Contacts::restore_wear(std::span<const double> crushed, std::span<const double> worn,
                            std::span<const std::uint8_t> here) {
  crushing_.restore(crushed, here);
  wear_.restore(solids_, worn);
}

std::vector<BodyPair> Contacts::enclosed() const {
  std::vector<BodyPair> found;
  for (const ActiveContact& active : active_.contacts()) {
    const Pair& pair = list_.pair(active.pair);
    if (pair.counted && active.is_enclosed()) found.push_back({pair.a, pair.b});
  }
  return found;
}

std::vector<Penetration> Contacts::penetrations() const {
  return floe::penetrations(solids_, list_, places_, active_.contacts());
}

void Contacts::restore(std::span<const double> rows, std::span<const BodyPair> released,
                       std::size_t known) {
  list_.restore(solids_, released, known);
  history_.restore(rows);
}

}  // namespace floe
