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
}

void Contacts::overlaps_taken_on(std::span<PairOverlap> overlaps) {
  const std::span<const Pair> pairs = list_.taken_on();
  for (std::size_t k = 0; k < pairs.size(); ++k)
    overlaps[k] =
        narrow_.overlap(solids_, pairs[k], places_.of_a(pairs[k]), places_.of_b(pairs[k]));
}

void Contacts::evaluate(std::span<ContactWrench> wrenches, const OffloadedOverlaps& offloaded) {
  active_.start();
  std::visit([&](const auto& law) { evaluate_pairs(law, wrenches, offloaded); }, law_);
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
      touch(law, index, narrow_.overlap(solids_, pair, a, b), memory, wrenches);
    }
    ++index;
  }
}

/// Adds the contact of a pair, unless there is no overlap.
/// \param memory  null: the pair has no history
template <IsContactLaw Law>
void Contacts::touch(const Law& law, std::int32_t index, const PairOverlap& met,
                     const PairHistory* memory, std::span<ContactWrench> wrenches) {
  const Overlap& overlap = met.overlap;
  if (!(overlap.volume > 0)) return;
  const Pair& pair = list_.pair(index);
  const Placed &a = places_.of_a(pair), &b = places_.of_b(pair);
  const RelativeMotion motion = relative_motion(a, b, overlap.centroid);
  const ContactResponse response =
      contact_response(law, pair_constants(solids_, options_, pair), overlap, met.depth, motion,
                       memory != nullptr ? *memory : PairHistory{}, pair.newly_eligible);
  const double plastic = response.contact.memory.plastic;
  active_.add({.pair = index,
               .deep = is_deep(solids_, pair, overlap, plastic),
               .centre = overlap.centroid,
               .contact = response.contact},
              pair, a, b, motion, response.stored, wrenches);
}

void Contacts::commit(std::span<const MovingPose> bodies, double velocity_time, double dt) {
  history_.clear();
  places_.set_obstacle_velocities(solids_, velocity_time);
  later_power_ = {};
  for (const ActiveContact& active : active_.contacts()) commit(active, bodies, dt);
  start_.take(active_.stored());
  list_.end_step();
  active_.end_step();
}

/// Commits one contact and adds its power with the velocities after the step.
void Contacts::commit(const ActiveContact& active, std::span<const MovingPose> bodies, double dt) {
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
  const FrictionSprings springs =
      slid(contact.memory.springs, contact.normal, motion.velocity, 0.5 * (a.spin + b.spin), dt);
  history_.add({.a = pair.a,
                .b = pair.b,
                .pair = active.pair,
                .memory = {.plastic = contact.memory.plastic, .springs = springs}});
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

void Contacts::restore(std::span<const double> rows, bool changed) {
  list_.restore(changed);
  history_.restore(rows);
}

}  // namespace floe
