#include "active_contacts/contacts.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace floe {
namespace {

void write_sums(const ActiveContacts& active, std::span<ContactWrench> wrenches) {
  for (std::size_t s = 0; s < wrenches.size(); ++s)
    wrenches[s] = active.on_body(static_cast<std::int32_t>(s)).sum();
}

/// Periods::nearest() in lanes.
Vec3<Lanes> nearest(const Periods& periods, Vec3<Lanes> apart) {
  if (!periods.any()) return apart;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const Vec3<double> near = periods.nearest({apart.x[lane], apart.y[lane], apart.z[lane]});
    apart.x[lane] = near.x, apart.y[lane] = near.y;
  }
  return apart;
}

}  // namespace

Contacts::Contacts(const Shapes& shapes, std::span<const double> masses,
                   std::vector<BodyPair> joined, const ContactOptions& options,
                   std::vector<Obstacle> obstacles, std::span<const Point3> inertia)
    : solids_(shapes, masses, std::move(obstacles), options.inertia_factor, inertia),
      options_(options),
      law_(law_of(options)),
      list_(solids_, std::move(joined), options.initial_overlap == InitialOverlap::stress_free,
            options.periods),
      places_(solids_.parts(), options.periods),
      narrow_(options.damping_ratio > 0 || solids_.has_friction(options)),
      active_(solids_.parts()) {}

void Contacts::build(std::span<const Pose> poses, std::span<const std::uint8_t> here, double time) {
  list_.build(solids_, narrow_, poses, here, time);
  if (!solids_.carriers().empty()) needed_.assign(here.begin(), here.end());
  places_.restart(list_.involved().size());
  history_.take_over(list_.pairs());
  active_.clear();
}

std::vector<BodyPair> Contacts::offload(std::size_t count) {
  std::vector<BodyPair> pairs;
  const std::span<const ContactHistory::Entry> entries = history_.entries();
  std::size_t first = entries.size();
  for (std::size_t left = count; left > 0 && first > 0;)
    left -= list_.pair(entries[--first].pair).one_of_several ? 0 : 1;
  for (const ContactHistory::Entry& entry : entries.subspan(first))
    if (!list_.pair(entry.pair).one_of_several) pairs.push_back(list_.offload(entry.pair));
  return pairs;
}

std::size_t Contacts::offloadable() const {
  const auto entries = history_.entries();
  return static_cast<std::size_t>(std::count_if(
      entries.begin(), entries.end(),
      [&](const ContactHistory::Entry& entry) { return !list_.pair(entry.pair).one_of_several; }));
}

void Contacts::take_on(std::span<const BodyPair> pairs) {
  list_.take_on(solids_, pairs);
  places_.restart(list_.involved().size());
}

void Contacts::place(std::span<const MovingPose> bodies, double time, double velocity_time) {
  places_.place(solids_, list_.involved(), bodies, time, velocity_time);
  last_dt_ = 2 * (time - velocity_time);
}

void Contacts::overlaps_taken_on(std::span<PairOverlap> overlaps) {
  const std::span<Pair> pairs = list_.taken_on();
  Placed image;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    overlaps[k] = narrow_.overlap(solids_, wear_, pairs[k], places_.of_a(pairs[k]),
                                  places_.image_of_b(pairs[k], image));
}

void Contacts::evaluate(std::span<ContactWrench> wrenches, const OffloadedOverlaps& offloaded) {
  active_.start(list_.involved().size());
  std::visit([&](const auto& law) { evaluate_pairs(law, offloaded); }, law_);
  const auto force_of = [](const ContactBlock& active, std::span<const std::int32_t>) {
    return without_dashpots(active.trial);
  };
  if (damps()) {
    std::fill(wrenches.begin(), wrenches.end(), ContactWrench{});
    active_.add_sums(list_, force_of, wrenches);
  } else {
    active_.act(list_, force_of);
    write_sums(active_, wrenches);
  }
}

void Contacts::damp(std::span<const Acceleration> accelerations,
                    std::span<ContactWrench> wrenches) {
  places_.predict(solids_, 0.5 * last_dt_, accelerations);
  active_.act(list_, [&](const ContactBlock& active, std::span<const std::int32_t> pairs) {
    return with_dashpots(active.trial, predicted_motion(active, pairs));
  });
  write_sums(active_, wrenches);
}

RelativeMotionOf<Lanes> Contacts::predicted_motion(const ContactBlock& active,
                                                   std::span<const std::int32_t> pairs) const {
  const auto pair = [&](std::size_t lane) -> const Pair& {
    return list_.pair(pairs[std::min(lane, pairs.size() - 1)]);
  };
  const auto a = gathered<BodyVelocityOf>([&](auto k) { return &places_.predicted_a(pair(k)); });
  const auto b = gathered<BodyVelocityOf>([&](auto k) { return &places_.predicted_b(pair(k)); });
  return relative_motion(a, b, active.centre, active.apart);
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
  Placed image;
  followed_.clear();
  joined_memory_.clear();
  const std::span<Pair> pairs = list_.pairs();
  const auto number = static_cast<std::int32_t>(pairs.size());
  while (index < number) {
    Pair& pair = item(pairs, index);
    if (pair.one_of_several) [[unlikely]] {
      index = meet_parts(law, index, histories);
      continue;
    }
    const Placed &a = places_.of_a(pair), &b = places_.image_of_b(pair, image);
    const PairHistory* memory = histories.of(index);
    PairOverlap& met = met_.overlaps[met_.number];
    if (pair.offloaded) {
      if (given.empty()) given = offloaded();
      met = given[taken++];
      touch(law, index, memory);
    } else if (memory != nullptr || !narrow_.is_apart(solids_, pair, a, b)) {
      narrow_.overlap(solids_, wear_, pair, a, b, met);
      touch(law, index, memory);
    }
    ++index;
  }
  if (met_.number > 0) find_trials(law);
}

/// Takes over the contacts of a body, or of an obstacle that a body carries, with an obstacle,
/// where one of them has several parts or both are obstacles.
/// \param first  index of the first of their pairs
/// \returns the index behind their last pair
// Not inlined: the loop over all pairs is not to pay for it.
template <IsContactLaw Law>
[[gnu::noinline]] std::int32_t Contacts::meet_parts(const Law& law, std::int32_t first,
                                                    ContactHistory::Cursor& histories) {
  const std::span<Pair> pairs = list_.pairs();
  const Pair& one = item(pairs, first);
  const auto is_of_the_same = [&](std::int32_t index, std::int32_t other) {
    if (!is_obstacle(index) || !is_obstacle(other)) return index == other;
    return solids_.obstacle_number(index) == solids_.obstacle_number(other);
  };
  Placed image;
  const Placed &a = places_.of_a(one), &b = places_.image_of_b(one, image);
  parts_.start();
  known_.clear();
  known_memory_.clear();
  std::int32_t index = first;
  for (; index < static_cast<std::int32_t>(pairs.size()); ++index) {
    Pair& pair = item(pairs, index);
    if (!is_of_the_same(pair.a, one.a) || !is_of_the_same(pair.b, one.b)) break;
    if (const PairHistory* memory = histories.of(index)) {
      known_.push_back(index);
      known_memory_.push_back(memory);
    } else if (!pair.met && narrow_.is_apart(solids_, pair, a, b)) {
      continue;
    }
    const PairOverlap met = narrow_.overlap(solids_, wear_, pair, a, b);
    pair.met = met.overlap.volume > 0;
    if (pair.met) parts_.add(index, pair, met, narrow_);
  }
  for (const PartContacts::Joined& contact :
       parts_.join(solids_, wear_, narrow_.with_patch(), pairs, a, b, known_)) {
    const PairHistory* memory = nullptr;
    for (const std::int32_t pair : contact.known) {
      const auto k = std::find(known_.begin(), known_.end(), pair) - known_.begin();
      const PairHistory* of = known_memory_[static_cast<std::size_t>(k)];
      memory = memory == nullptr ? of : &joined_memory_.emplace_back(joined(*memory, *of));
      if (pair != contact.pair) followed_.push_back({pair, contact.pair});
    }
    met_.overlaps[met_.number] = contact.overlap;
    touch(law, contact.pair, memory);
  }
  return index;
}

/// Gives histories to the pairs that stand for their contacts now.
void Contacts::follow_parts() {
  for (const auto& [from, to] : followed_) {
    history_.move(from, to, list_.pairs());
    crushing_.move(list_.pair(from), list_.pair(to));
  }
  followed_.clear();
}

/// Returns the wrench of the bodies of this rank on all parts of an obstacle.
ContactWrench Contacts::on_parts_of(std::size_t obstacle) const {
  const auto [first, end] = solids_.parts_of(obstacle);
  ContactWrench sum = active_.on_part(first);
  for (std::size_t k = first + 1; k < end; ++k) sum = sum + active_.on_part(k);
  return sum;
}

/// Takes over a pair whose overlap is the last of met_, unless there is no overlap.
/// \param memory  null: the pair has no history
template <IsContactLaw Law>
void Contacts::touch(const Law& law, std::int32_t index, const PairHistory* memory) {
  static constexpr PairHistory none{};
  const std::size_t k = met_.number;
  const Overlap& overlap = met_.overlaps[k].overlap;
  if (!(overlap.volume > 0)) return;
  const Pair& pair = list_.pair(index);
  const bool wet = places_.of_a(pair).x.z + overlap.centroid.z < 0;
  met_.pairs[k] = index;
  met_.given[k] = {.constants = pair_constants(solids_, options_, pair, wet),
                   .thinner = std::min(solids_.width(pair.a), solids_.width(pair.b)),
                   .touched = memory != nullptr || pair.newly_eligible ? 1.0 : 0.0,
                   .newly_eligible = pair.newly_eligible ? 1.0 : 0.0};
  met_.memories[k] = memory != nullptr ? memory : &none;
  met_.counted += pair.counted ? 1 : 0;
  if (++met_.number == lanes) find_trials(law);
}

/// Finds the contacts of met_. The lanes beyond their number repeat the last one.
template <IsContactLaw Law>
void Contacts::find_trials(const Law& law) {
  const std::size_t last_lane = met_.number - 1;
  const auto k = [&](std::size_t lane) { return std::min(lane, last_lane); };
  const auto pair = [&](std::size_t lane) -> const Pair& {
    return list_.pair(met_.pairs[k(lane)]);
  };
  const auto a = [&](std::size_t lane) -> const Placed& { return places_.of_a(pair(lane)); };
  const auto b = [&](std::size_t lane) -> const Placed& { return places_.of_b(pair(lane)); };
  const auto vector = [&](const auto& of, Vec3<double> Placed::*part) {
    const auto [x, y, z, after] =
        gather_four([&](std::size_t lane) { return &(of(lane).*part).x; });
    return Vec3<Lanes>{x, y, z};
  };
  const auto overlap =
      gathered<PairOverlapOf>([&](std::size_t lane) { return &met_.overlaps[k(lane)]; });
  const auto given =
      gathered<MetPairs::GivenOf>([&](std::size_t lane) { return &met_.given[k(lane)]; });
  const auto memory =
      gathered<PairHistoryOf>([&](std::size_t lane) { return met_.memories[k(lane)]; });
  const MobilityOf<Lanes> mobility{
      .a = gathered<BodyMobilityOf>(
          [&](std::size_t lane) { return &places_.mobility_of_a(pair(lane)); }),
      .b = gathered<BodyMobilityOf>(
          [&](std::size_t lane) { return &places_.mobility_of_b(pair(lane)); }),
      .apart = nearest(places_.periods(), vector(a, &Placed::x) - vector(b, &Placed::x))};
  const BodyVelocityOf<Lanes> of_a{vector(a, &Placed::velocity), vector(a, &Placed::spin)},
      of_b{vector(b, &Placed::velocity), vector(b, &Placed::spin)};
  const Vec3<Lanes>& centre = overlap.overlap.centroid;
  ContactBlock& active = active_.add(std::span(met_.pairs).first(met_.number), met_.counted);
  active.centre = centre;
  active.apart = mobility.apart;
  find_trial(law, given.constants, overlap.overlap, overlap.depth,
             relative_motion(of_a, of_b, centre, mobility.apart), mobility,
             {.dt = last_dt_, .touched = given.touched != 0.0}, 0.5 * (of_a.spin + of_b.spin),
             memory, given.newly_eligible != 0.0, active.trial);
  active.mark(given.thinner);
  met_.number = 0;
  met_.counted = 0;
}

/// Returns the energy that the counted contacts store.
StoredEnergy Contacts::stored() const {
  StoredEnergy sum;
  std::visit(
      [&](const auto& law) {
        for (std::size_t k = 0; k < active_.size(); ++k) {
          if (!list_.pair(active_.pair(k)).counted) continue;
          const StoredEnergy of = stored_energy(law, active_.trial(k), active_.springs(k));
          sum.normal += of.normal;
          sum.tangential += of.tangential;
        }
      },
      law_);
  return sum;
}

void Contacts::commit() {
  follow_parts();
  history_.start();
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::int32_t index = active_.pair(k);
    const Pair& pair = list_.pair(index);
    if (pair.counted)
      events_.note(active_.is_enclosed(k), active_.is_deep_in(k), pair, places_.time());
    history_.add({.a = pair.a, .b = pair.b, .pair = index, .memory = active_.memory(k)});
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
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const double after = active_.plastic(k);
    const Pair& pair = list_.pair(active_.pair(k));
    if (!pair.counted || after == 0 || is_obstacle(pair.a)) continue;  // obstacles lose nothing
    const PairHistory* memory = before.of(active_.pair(k));
    const double born = pair.newly_eligible ? after : 0.0;
    crushing_.take(pair, memory != nullptr ? memory->plastic : born, after, active_.normal(k),
                   places_.of_a(pair).axes, places_.of_b(pair).axes);
  }
  crushing_.end();
  cuts_ = cuts_of(crushing_.parted());
}

std::vector<WearCut> Contacts::cuts_of(std::span<const Crush> parted) {
  std::vector<WearCut> cuts;
  for (const Crush& crush : parted) cuts.push_back(cut_of(crush));
  return cuts;
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

Contacts::OnObstacle Contacts::on_obstacle_of(std::size_t contact, bool on_a) const {
  const Pair& pair = list_.pair(active_.pair(contact));
  const std::int32_t index = on_a ? pair.a : pair.b, other = on_a ? pair.b : pair.a;
  if (!is_obstacle(index)) return {};
  Placed image;
  const Placed &a = places_.of_a(pair), &b = places_.image_of_b(pair, image);
  const Placed &obstacle = on_a ? a : b, &body = on_a ? b : a;
  const auto local = [&](const Vec3<double>& r) { return obstacle.axes.to_local(r); };
  const auto [turn, x] = Relative(body, obstacle);
  const double sign = on_a ? 1 : -1;  // force and normal of the contact are on A and out of B
  return {.obstacle = static_cast<std::int32_t>(solids_.obstacle_number(index)),
          .counted = pair.counted,
          .force = sign * active_.force(contact),
          .centre = local(active_.centre(contact)) + local(a.x - obstacle.x),
          .normal = -sign * local(active_.normal(contact)),
          .axes = turn,
          .x = x,
          .radius = solids_.is_half_space(other) ? std::numeric_limits<double>::infinity()
                                                 : solids_.radius(other),
          .planes = solids_.planes(other),
          .worn = wear_.of(other)};
}

ContactOfPair Contacts::contact_of(std::size_t contact) const {
  const Pair& pair = list_.pair(active_.pair(contact));
  const ContactTrial trial = active_.trial(contact);
  return {.a = solids_.body_of(pair.a),
          .b = solids_.body_of(pair.b),
          .obstacle = solids_.is_ice(pair.b)
                          ? -1
                          : static_cast<std::int32_t>(solids_.obstacle_number(pair.b)),
          .force = active_.force(contact),
          .point = places_.of_a(pair).x + active_.centre(contact),
          .normal = active_.normal(contact),
          .volume = trial.volume,
          .area = trial.area};
}

std::vector<BodyPair> Contacts::enclosed() const {
  std::vector<BodyPair> found;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const Pair& pair = list_.pair(active_.pair(k));
    if (pair.counted && active_.is_enclosed(k)) found.push_back({pair.a, pair.b});
  }
  return found;
}

std::vector<Penetration> Contacts::penetrations() const {
  return floe::penetrations(solids_, list_, places_, active_);
}

void Contacts::restore(std::span<const double> rows, std::span<const BodyPair> released,
                       std::size_t known) {
  list_.restore(solids_, released, known);
  history_.restore(rows);
}

}  // namespace floe
