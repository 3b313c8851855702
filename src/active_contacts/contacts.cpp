#include "active_contacts/contacts.h"

#include <algorithm>
#include <utility>

namespace floe {
namespace {

void write_sums(const ActiveContacts& active, std::span<ContactWrench> wrenches) {
  for (std::size_t s = 0; s < wrenches.size(); ++s)
    wrenches[s] = active.on_body(static_cast<std::int32_t>(s)).sum();
}

}  // namespace

Contacts::Contacts(const Shapes& shapes, std::span<const double> masses,
                   std::vector<BodyPair> joined, const ContactOptions& options,
                   std::vector<Obstacle> obstacles)
    : solids_(shapes, masses, std::move(obstacles), options.inertia_factor),
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
  active_.start(list_.involved().size());
  std::visit([&](const auto& law) { evaluate_pairs(law, offloaded); }, law_);
  const auto force_of = [](const ActiveContact& active, const Pair&) {
    return without_dashpots(active.trial);
  };
  if (damps()) {
    std::fill(wrenches.begin(), wrenches.end(), ContactWrench{});
    active_.add_sums(list_, places_, force_of, wrenches);
  } else {
    active_.act(list_, places_, force_of);
    write_sums(active_, wrenches);
  }
}

void Contacts::damp(std::span<const Acceleration> accelerations,
                    std::span<ContactWrench> wrenches) {
  places_.predict(solids_, 0.5 * last_dt_, accelerations);
  active_.act(list_, places_, [&](const ActiveContact& active, const Pair& pair) {
    return with_dashpots(active.trial, places_.predicted_motion(pair, active.centre));
  });
  write_sums(active_, wrenches);
}

Acceleration Contacts::acceleration(std::int32_t slot, const ContactWrench& wrench) const {
  const BodyMobility& body = places_.mobility(slot);
  return {.linear = body.mass * wrench.force, .angular = body.turning * wrench.moment};
}

template <IsContactLaw Law>
void Contacts::evaluate_pairs(const Law& law, const OffloadedOverlaps& offloaded) {
  ContactHistory::Cursor histories(history_);
  std::span<const PairOverlap> given;  // overlaps of the offloaded pairs, in their order
  std::size_t taken = 0;
  std::int32_t index = 0;
  for (Pair& pair : list_.pairs()) {
    const Placed &a = places_.of_a(pair), &b = places_.of_b(pair);
    const PairHistory* memory = histories.of(index);
    if (pair.offloaded) {
      if (given.empty()) given = offloaded();
      touch(law, index, given[taken++], memory);
    } else if (memory != nullptr || !narrow_.is_apart(solids_, pair, a, b)) {
      touch(law, index, narrow_.overlap(solids_, wear_, pair, a, b), memory);
    }
    ++index;
  }
}

/// Adds the contact of a pair, unless there is no overlap.
/// \param memory  null: the pair has no history
template <IsContactLaw Law>
void Contacts::touch(const Law& law, std::int32_t index, const PairOverlap& met,
                     const PairHistory* memory) {
  const Overlap& overlap = met.overlap;
  if (!(overlap.volume > 0)) return;
  const Pair& pair = list_.pair(index);
  const Placed &a = places_.of_a(pair), &b = places_.of_b(pair);
  const Mobility mobility{.a = places_.mobility(pair.slot_a),
                          .b = is_obstacle(pair.b) ? BodyMobility{} : places_.mobility(pair.slot_b),
                          .apart = a.x - b.x};
  const bool wet = a.x.z + overlap.centroid.z < 0;
  const LastStep last{.dt = last_dt_, .touched = memory != nullptr || pair.newly_eligible};
  ActiveContact& active = active_.add(pair.counted);
  active.pair = index;
  active.centre = overlap.centroid;
  find_trial(law, pair_constants(solids_, options_, pair, wet), overlap, met.depth,
             places_.motion(pair, overlap.centroid), mobility, last, 0.5 * (a.spin + b.spin),
             memory != nullptr ? *memory : PairHistory{}, pair.newly_eligible, active.trial);
  active.deep = is_deep(solids_, pair, active.trial);
}

/// Returns the energy that the counted contacts store.
StoredEnergy Contacts::stored() const {
  StoredEnergy sum;
  std::visit(
      [&](const auto& law) {
        for (const ActiveContact& active : active_.contacts()) {
          if (!list_.pair(active.pair).counted) continue;
          const StoredEnergy of = stored_energy(law, active.trial, active.springs);
          sum.normal += of.normal;
          sum.tangential += of.tangential;
        }
      },
      law_);
  return sum;
}

void Contacts::commit() {
  history_.start();
  for (const ActiveContact& active : active_.contacts()) {
    const Pair& pair = list_.pair(active.pair);
    if (pair.counted) events_.note(active, pair, places_.time());
    history_.add({.a = pair.a, .b = pair.b, .pair = active.pair, .memory = active.memory()});
  }
  if (wears()) find_crushed();
  if (!start_.is_known) start_.take(stored());
  list_.end_step();
  active_.clear();
}

/// Finds what counted contacts have crushed by the last step, and the cuts of those that parted.
void Contacts::find_crushed() {
  ContactHistory::Cursor before = history_.before();
  crushing_.start();
  for (const ActiveContact& active : active_.contacts()) {
    const double after = active.trial.memory.plastic;
    const Pair& pair = list_.pair(active.pair);
    if (!pair.counted || after == 0) continue;
    const PairHistory* memory = before.of(active.pair);
    const double born = pair.newly_eligible ? after : 0.0;
    crushing_.take(pair, memory != nullptr ? memory->plastic : born, after, active.trial.normal,
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
