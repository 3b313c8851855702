#include "contact_force/expiry.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/collectives.h"

namespace floe {
namespace {

std::array<double, 2> largest(std::array<double, 2> mine, MPI_Comm comm) {
  largest_over_ranks(mine, comm);
  return mine;
}

double radius_of(const Solids& solids, std::size_t obstacle) {
  return solids.radius(part_index(solids.parts_of(obstacle)[0]));
}

}  // namespace

double obstacle_travel(const Solids& solids, std::size_t k, double from, double to) {
  const ObstacleMotion& m = solids.obstacles()[k].motion;
  if (m.at_rest()) return 0;
  const Quat<double> turn = product(m.turn(to), conjugate(m.turn(from)));
  return length(m.way(to) - m.way(from)) +
         2 * radius_of(solids, k) * length(Vec3<double>{turn.x, turn.y, turn.z});
}

PairListExpiry::PairListExpiry(const Solids& solids, const Part& part) {
  for (std::int32_t b = 0; b < solids.bodies(); ++b)
    if (!solids.carries(b)) radius_ = std::max(radius_, solids.radius(b));
  for (const std::int32_t b : solids.carriers()) {
    const std::int32_t local = part.local_index(b);
    if (local >= 0 && local < part.owned)
      carriers_.push_back({static_cast<std::size_t>(local), solids.radius(b)});
  }
}

void PairListExpiry::start(const State<Spatial>& state, std::int32_t owned) {
  at_build_.assign(state.records.begin(),
                   state.records.begin() + static_cast<std::ptrdiff_t>(owned) * Spatial::record);
  time_ = state.time;
  travelled_ = 0;
  asks_in_ = 0;
  started_ = true;
}

void PairListExpiry::after_step(const State<Spatial>& state, double dt) {
  // The spin of a tumbling body changes within a step, by far less than this factor.
  constexpr double tumbling = 1.5;
  speed_ = state.fastest + tumbling * radius_ * state.fastest_spin;
  for (const Carrier& c : carriers_)
    speed_ = std::max(speed_, length(velocity(state, c.local)) +
                                  tumbling * c.radius * length(angular_velocity(state, c.local)));
  travelled_ += dt * speed_;
}

bool PairListExpiry::is_due(const State<Spatial>& state, const Part& part, const Contacts& contacts,
                            double dt) {
  if (--asks_in_ > 0) return false;
  const Solids& solids = contacts.solids();
  const auto [theirs, their_speed] = of_obstacles(solids, state.time);
  std::array<double, 2> all =
      largest({std::max(travelled_, theirs), std::max(speed_, their_speed)}, part.comm);
  if (!std::isfinite(all[0])) return false;  // the run has blown up: places are not finite
  const double slack = contacts.list().slack();
  if (all[0] > slack) {
    travelled_ = travels(state, part, solids);
    all[0] = largest({std::max(travelled_, theirs), 0}, part.comm)[0];
    constexpr double enough = 0.8;  // of the slack; the rest would not last long
    if (all[0] > enough * slack) return true;
  }
  if (size(part.comm) > 1) {        // each comparison costs a message
    constexpr double sudden = 100;  // gain of speed of a body between two comparisons [m/s]
    const double per_step = dt > 0 ? dt * (2 * all[1] + sudden) : slack;
    asks_in_ = static_cast<std::int64_t>(std::clamp((slack - all[0]) / per_step, 0.0, 1000.0));
  }
  return false;
}

/// Largest travel of a vertex of an obstacle since the list was made [m], and the largest speed of
/// such a vertex [m/s].
std::array<double, 2> PairListExpiry::of_obstacles(const Solids& solids, double time) const {
  std::array<double, 2> most{};
  for (std::size_t k = 0; k < solids.obstacles().size(); ++k) {
    const ObstacleMotion& m = solids.obstacles()[k].motion;
    if (m.at_rest()) continue;
    most[0] = std::max(most[0], obstacle_travel(solids, k, time_, time));
    most[1] = std::max(most[1], m.largest_speed(radius_of(solids, k)));
  }
  return most;
}

/// Largest travel of a vertex of an owned body since the list was made [m].
double PairListExpiry::travels(const State<Spatial>& state, const Part& part,
                               const Solids& solids) const {
  double farthest = 0;
  for (std::int32_t b = 0; b < part.owned; ++b) {
    const auto k = static_cast<std::size_t>(b);
    const double* was = &at_build_[k * Spatial::record];
    const double* is = state.record(k);
    const Vec3<double> way{is[0] - was[0], is[1] - was[1], is[2] - was[2]};
    const Quat<double> turn = product(Quat<double>{is[3], is[4], is[5], is[6]},
                                      Quat<double>{was[3], -was[4], -was[5], -was[6]});
    farthest = std::max(farthest, length(way) + 2 * solids.radius(part.global[k]) *
                                                    length(Vec3<double>{turn.x, turn.y, turn.z}));
  }
  return farthest;
}

}  // namespace floe
