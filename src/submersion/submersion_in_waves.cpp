#include "submersion/submersion_in_waves.h"

#include <algorithm>
#include <utility>

#include "floe/base/item.h"
#include "submersion/submersion.h"

namespace floe {

SubmersionInWaves::SubmersionInWaves(const Part& part, Waves waves, int pace, bool shared)
    : part_(part),
      immersion_(part, pace > 1 ? Wet::by_points : Wet::by_sphere),
      waves_(std::move(waves)),
      pace_(pace),
      shared_(shared) {
  const auto owned = static_cast<std::size_t>(part.owned);
  if (shared || has_pace()) now_.resize(owned);
  if (!has_pace()) return;
  expansions_.resize(owned);
  for (std::int32_t body = 0; body < part.owned; ++body) {
    const double most = largest_move * immersion_.mean_thickness(body);
    most2_.push_back(0.5 * most * most);
  }
}

void SubmersionInWaves::before_evaluation(const State<Spatial>& state) {
  if (now_.empty() && part_.owned > 0) return;
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    if (has_pace() && since_ > 0) {
      follow(state, body);
    } else {
      find(state, body);
    }
  }
  known_ = true;
}

/// Height over a plane and rotation of a body in the axes in which the plane is level.
std::pair<double, Quat<double>> SubmersionInWaves::in_level_axes(const SurfacePlane& plane,
                                                                 double z, const Quat<double>& q) {
  return {(z - plane.level) / plane.steepness(), product(plane.to_level(), of_unit_length(q))};
}

void SubmersionInWaves::find(const State<Spatial>& state, std::int32_t body) {
  const auto b = static_cast<std::size_t>(body);
  const Vec3<double> at = immersion_.centroid(state, body);
  Now& now = now_[b];
  now.plane = waves_.plane(b, at, state.time);
  now.water = waves_.velocity(b, at, state.time);
  now.below = immersion_.below(state, body, now.plane);
  now.is_new = true;
  if (!has_pace()) return;
  const auto [z, q] = in_level_axes(now.plane, at.z, rotation(state, b));
  expansions_[b] = {at, state.time, now.plane, now.water, waves_.change(b, at, state.time),
                    z,  q,          now.below};
}

void SubmersionInWaves::follow(const State<Spatial>& state, std::int32_t body) {
  const auto b = static_cast<std::size_t>(body);
  const Expansion& e = expansions_[b];
  const Vec3<double> at = immersion_.centroid(state, body);
  const double later = state.time - e.time, dx = at.x - e.at.x, dy = at.y - e.at.y;
  Now& now = now_[b];
  now.plane = {e.plane.level + later * e.change.level + e.plane.slope_x * dx + e.plane.slope_y * dy,
               e.plane.slope_x + later * e.change.slope_x + e.change.xx * dx + e.change.xy * dy,
               e.plane.slope_y + later * e.change.slope_y + e.change.xy * dx + e.change.yy * dy};
  now.water = e.water + later * e.change.velocity;

  const auto [z, q] = in_level_axes(now.plane, at.z, rotation(state, b));
  const double shift = z - e.z, w = q.w - e.q.w;
  const Vec3<double> v{q.x - e.q.x, q.y - e.q.y, q.z - e.q.z}, v1{e.q.x, e.q.y, e.q.z};
  const Vec3<double> turn = 2.0 * (e.q.w * v - w * v1 + cross(v1, v));
  const double extent = immersion_.extent(body);
  if (shift * shift + extent * extent * dot(turn, turn) > most2_[b]) return find(state, body);
  const Submerged& s = e.below;
  now.below.volume =
      std::max(0.0, s.volume - (s.waterplane * shift + s.wy * turn.x - s.wx * turn.y));
  now.below.moment = s.moment + cross(turn, s.moment) -
                     Vec3<double>{s.wx * shift + s.wxy * turn.x - s.wxx * turn.y,
                                  s.wy * shift + s.wyy * turn.x - s.wxy * turn.y, 0};
  now.is_new = false;
}

std::array<double*, SubmersionInWaves::numbers> SubmersionInWaves::numbers_of(Expansion& e) {
  SurfacePlane& plane = e.plane;
  Vec3<double>& water = e.water;
  Waves::Change& c = e.change;
  Submerged& s = e.below;
  Quat<double>& q = e.q;
  return {&e.at.x,        &e.at.y,     &e.at.z,     &e.time,     &plane.level,  &plane.slope_x,
          &plane.slope_y, &water.x,    &water.y,    &water.z,    &c.level,      &c.slope_x,
          &c.slope_y,     &c.xx,       &c.xy,       &c.yy,       &c.velocity.x, &c.velocity.y,
          &c.velocity.z,  &e.z,        &q.w,        &q.x,        &q.y,          &q.z,
          &s.volume,      &s.moment.x, &s.moment.y, &s.moment.z, &s.waterplane, &s.wx,
          &s.wy,          &s.wxx,      &s.wxy,      &s.wyy};
}

void SubmersionInWaves::persist(Archive& archive) {
  archive.common("steps_since_found", since_);
  std::vector<std::int32_t> bodies;
  std::vector<double> rows;
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    bodies.push_back(body);
    Expansion& e = item(expansions_, body);
    if (archive.loading() && archive.renumbers()) {  // a body that joins is looked at at once
      constexpr double far_away = 1e9;               // [m]
      e = {};
      e.z = far_away;
      e.q.w = 1;
    }
    for (const double* number : numbers_of(e)) rows.push_back(*number);
  }
  archive.rows("submerged", bodies, rows, static_cast<int>(numbers));
  if (!archive.loading()) return;
  const double* row = rows.data();
  for (Expansion& e : expansions_)
    for (double* number : numbers_of(e)) *number = *row++;
}

}  // namespace floe
