#include "contact/pair_list.h"

#include <algorithm>
#include <utility>

#include "contact/broad_phase.h"
#include "geometry/separation.h"

namespace floe {

/// What a build looks at.
struct PairList::Search {
  const Solids& solids;
  NarrowPhase& narrow;
  std::vector<Placed> bodies;  ///< all; without motion
  std::span<const std::uint8_t> here;
  double time;

  bool is_here(std::int32_t body) const { return item(here, body) != 0; }
};

PairList::PairList(const Solids& solids, std::vector<BodyPair> joined, bool stress_free,
                   const Periods& periods)
    : eligibility_(solids, std::move(joined)), periods_(periods), stress_free_(stress_free) {
  // The reach lasts a few hundred steps of slow bodies without listing many more pairs.
  constexpr double part_of_radius = 0.15;
  reach_ = part_of_radius * solids.mean_radius();
}

void PairList::build(const Solids& solids, NarrowPhase& narrow, std::span<const Pose> poses,
                     std::span<const std::uint8_t> here, double time) {
  if (changed_) eligibility_.update(solids);
  // Until the end of the step, however many lists are made before it.
  newly_eligible_ = newly_eligible_ || stress_free_ || changed_;
  Search search{.solids = solids, .narrow = narrow, .bodies = {}, .here = here, .time = time};
  search.bodies.reserve(poses.size());
  for (const Pose& p : poses) search.bodies.push_back({.x = p.x, .axes = triad(p.q)});
  pairs_.clear();
  narrow.forget_cuts();
  list_bodies(search);
  list_obstacles(search);
  if (solids.obstacles_touch()) list_touching_obstacles(search);
  std::sort(pairs_.begin(), pairs_.end(),
            [](const Pair& p, const Pair& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  bring_together(solids);
  taken_on_.clear();
  find_involved(solids);
  changed_ = false;
}

void PairList::list_bodies(const Search& search) {
  const Solids& solids = search.solids;
  std::vector<Vec3<double>> centres;
  centres.reserve(search.bodies.size());
  for (const Placed& body : search.bodies) centres.push_back(body.x);
  std::vector<double> radii;
  radii.reserve(centres.size());
  for (std::int32_t b = 0; b < solids.bodies(); ++b)
    radii.push_back(is_left_out(solids, b) ? -1 : solids.radius(b));
  std::vector<BodyPair> near;
  near_pairs(centres, radii, reach_, search.here, near, periods_);
  for (const auto& [a, b] : near) {
    if (eligibility_.may_touch(a, b))
      list(search, {a, b}, item(search.bodies, a), item(search.bodies, b));
  }
}

namespace {
constexpr double near = 0.25;  // of the reach
}  // namespace

bool PairList::is_near(const Solids& solids, std::int32_t body, const Placed& place,
                       std::int32_t obstacle, const Placed& other) const {
  const Vec3<double> x = other.axes.to_local(periods_.nearest(place.x - other.x));
  const auto planes = solids.planes(obstacle);
  return std::none_of(planes.begin(), planes.end(), [&](const HalfSpace& h) {
    const Vec3<double> along = place.axes.to_local(other.axes.to_world(h.normal));
    const double lowest = lowest_along(solids.vertex_lists(body), along);
    return dot(h.normal, x) - h.offset + lowest > near * reach_;
  });
}

void PairList::list_obstacles(const Search& search) {
  const Solids& solids = search.solids;
  may_become_near_.clear();
  for (std::size_t k = 0; k < solids.parts(); ++k) {
    const std::int32_t index = part_index(k);
    const std::int32_t carrier = solids.obstacle(index).body;
    const Placed obstacle = carrier < 0 ? place_of(solids.obstacle(index), search.time, search.time)
                                        : item(search.bodies, carrier);
    // The rank of a structure needs all contacts with it, as that of a body does.
    const bool carrier_is_here = carrier >= 0 && search.is_here(carrier);
    const bool is_ice = solids.is_ice(index);
    for (std::int32_t b = 0; b < solids.bodies(); ++b) {
      if ((!search.is_here(b) && !carrier_is_here) || solids.carries(b)) continue;
      if (is_ice && !eligibility_.may_touch(std::min(b, carrier), std::max(b, carrier))) continue;
      const Placed& body = item(search.bodies, b);
      const Vec3<double> x = obstacle.axes.to_local(periods_.nearest(body.x - obstacle.x));
      const auto planes = solids.planes(index);
      const auto is_within = [&](double reach) {
        return std::none_of(planes.begin(), planes.end(), [&](const HalfSpace& h) {
          return dot(h.normal, x) - h.offset > solids.radius(b) + reach;
        });
      };
      // Both may travel by half of the reach before the next build.
      if (!is_within((1 + near) * reach_)) continue;
      if (search.is_here(b)) may_become_near_.push_back({b, index});
      if (is_within(reach_)) list(search, {b, index}, body, obstacle);
    }
  }
}

/// Lists the parts of obstacles that bodies carry with those of other obstacles.
void PairList::list_touching_obstacles(const Search& search) {
  const Solids& solids = search.solids;
  const std::vector<Obstacle>& obstacles = solids.obstacles();
  const auto is_here = [&](const Obstacle& o) { return o.is_carried() && search.is_here(o.body); };
  const auto place = [&](const Obstacle& o) {
    return o.is_carried() ? item(search.bodies, o.body) : place_of(o, search.time, search.time);
  };
  for (std::size_t one = 0; one < obstacles.size(); ++one) {
    if (!obstacles[one].is_carried()) continue;
    const Placed a = place(obstacles[one]);
    const auto [first_a, end_a] = solids.parts_of(one);
    for (std::size_t other = 0; other < obstacles.size(); ++other) {
      const auto [first, second] = std::minmax({obstacles[one].body, obstacles[other].body});
      if (!may_touch(obstacles[one], obstacles[other])) continue;
      if (obstacles[other].is_carried() && other < one) continue;
      if (first >= 0 && !eligibility_.may_touch(first, second)) continue;
      if (!is_here(obstacles[one]) && !is_here(obstacles[other])) continue;
      const Placed b = place(obstacles[other]);
      const auto [first_b, end_b] = solids.parts_of(other);
      const double radii = solids.radius(part_index(first_a)) + solids.radius(part_index(first_b));
      if (!obstacles[other].is_half_space() && length(periods_.nearest(a.x - b.x)) > radii + reach_)
        continue;
      for (std::size_t p = first_a; p < end_a; ++p)
        for (std::size_t q = first_b; q < end_b; ++q)
          list(search, {part_index(p), part_index(q)}, a, b);
    }
  }
}

/// Brings the pairs of the same two obstacles together, in the order of the obstacles.
void PairList::bring_together(const Solids& solids) {
  const auto end = std::find_if(pairs_.begin(), pairs_.end(),
                                [](const Pair& pair) { return !is_obstacle(pair.a); });
  std::stable_sort(pairs_.begin(), end, [&](const Pair& p, const Pair& q) {
    const auto obstacles = [&](const Pair& pair) {
      return std::array{solids.obstacle_number(pair.a), solids.obstacle_number(pair.b)};
    };
    return obstacles(p) < obstacles(q);
  });
}

/// Lists a pair unless its gap exceeds the reach.
void PairList::list(const Search& search, const BodyPair& bodies, const Placed& a,
                    const Placed& itself) {
  Placed image;
  const Placed& b = periods_.any() ? nearest_image(a, itself, periods_, image) : itself;
  constexpr int tries = 20;
  Pair pair{.a = bodies[0],
            .b = bodies[1],
            .counted = search.is_here(search.solids.body_of(bodies[0])),
            .newly_eligible = stress_free_,
            .one_of_several = is_obstacle(bodies[0]) || search.solids.is_one_of_several(bodies[1])};
  const auto [first, second] =
      std::minmax({search.solids.body_of(pair.a), search.solids.body_of(pair.b)});
  if (first >= 0) {
    pair.newly_eligible =
        stress_free_ || (newly_eligible_ && eligibility_.became_eligible(first, second));
    pair.broken = eligibility_.beam_broke({first, second});
  }
  const Vec3<double> apart = a.x - b.x;
  const double distance = length(apart);
  pair.axis = distance > 0 ? (1 / distance) * apart : Vec3<double>{0, 0, 1};
  if (search.solids.is_half_space(pair.b)) pair.axis = search.solids.planes(pair.b)[0].normal;
  if (search.narrow.gap(search.solids, pair, a, b, reach_, tries) <= reach_) pairs_.push_back(pair);
}

/// Lists the involved bodies and gives pairs the slots of their bodies.
void PairList::find_involved(const Solids& solids) {
  involved_ = solids.carriers();
  for (const std::vector<Pair>* pairs : {&pairs_, &taken_on_}) {
    for (const Pair& p : *pairs) {
      if (!is_obstacle(p.a)) involved_.push_back(p.a);
      if (!is_obstacle(p.b)) involved_.push_back(p.b);
    }
  }
  std::sort(involved_.begin(), involved_.end());
  involved_.erase(std::unique(involved_.begin(), involved_.end()), involved_.end());
  for (std::vector<Pair>* pairs : {&pairs_, &taken_on_}) {
    for (Pair& p : *pairs) {
      p.slot_a = slot_of(solids.body_of(p.a));
      const std::int32_t b = solids.body_of(p.b);
      p.slot_b = b < 0 ? -1 : slot_of(b);
    }
  }
}

BodyPair PairList::offload(std::int32_t pair) {
  Pair& offloaded = item(pairs_, pair);
  offloaded.offloaded = true;
  return {offloaded.a, offloaded.b};
}

void PairList::take_on(const Solids& solids, std::span<const BodyPair> pairs) {
  taken_on_.clear();
  for (const auto& [a, b] : pairs) taken_on_.push_back({.a = a, .b = b});
  find_involved(solids);
}

void PairList::release(BodyPair pair) { changed_ = eligibility_.release(pair) || changed_; }

void PairList::end_step() {
  if (newly_eligible_) {
    for (Pair& pair : pairs_) pair.newly_eligible = false;
  }
  newly_eligible_ = stress_free_ = false;
  settled_ = eligibility_.known();
}

void PairList::restore(const Solids& solids, std::span<const BodyPair> released,
                       std::size_t known) {
  settled_ = known;
  for (const BodyPair& pair : released.first(known)) eligibility_.release(pair);
  eligibility_.update(solids);
  for (const BodyPair& pair : released.subspan(known)) eligibility_.release(pair);
  pairs_.clear();
  changed_ = true;
  stress_free_ = newly_eligible_ = false;
}

}  // namespace floe
