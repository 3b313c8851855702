#include "explicit/first_order_system.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "floe/base/item.h"

namespace floe {
namespace {

Vec3<double> three(const double* x) { return {x[0], x[1], x[2]}; }
Quat<double> four(const double* x) { return {x[0], x[1], x[2], x[3]}; }
void put(const Vec3<double>& v, double* x) { x[0] = v.x, x[1] = v.y, x[2] = v.z; }
void put(const Quat<double>& q, double* x) { x[0] = q.w, x[1] = q.x, x[2] = q.y, x[3] = q.z; }
Vec3<double> times(const Vec3<double>& a, const Vec3<double>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
Vec3<double> over(const Vec3<double>& a, const Vec3<double>& b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}

}  // namespace

FirstOrderSystem::FirstOrderSystem(const Model<Spatial>& model)
    : model_(model), owned_(static_cast<std::size_t>(model.part().owned)) {
  const Bodies& all = model.part().bodies;
  for (std::size_t b = 0; b < owned_; ++b) {
    bodies_.push_back({model.inertial_mass()[b], all.inertia[b], four(all.orientation[b].data())});
    if (model.prescribed()[b] != 0) held_.push_back(static_cast<std::int32_t>(b));
  }
  for (const auto& force : model.forces()) {
    if (const auto* role = force->roles().work) works_ += role->works();
  }
  offset_.resize(held_.size() * 3);
  place_.resize(static_cast<std::size_t>(model.part().local) * Spatial::unknowns);
  rate_ = acceleration_ = place_;
}

double FirstOrderSystem::begin(State<Spatial>& state) {
  const Bodies& all = model_.part().bodies;
  for (std::size_t b = 0; b < owned_; ++b) {
    double* r = state.record(b);
    if (!all.velocity.empty()) put(all.velocity[b], r + Spatial::velocity);
    if (!all.angular_velocity.empty()) put(all.angular_velocity[b], r + Spatial::angular_velocity);
    const Triad<double> axes =
        triad(product(normalised(four(r + Spatial::rotation)), bodies_[b].axes));
    const Vec3<double> w = axes.to_local(three(r + Spatial::angular_velocity));
    put(axes.to_world(times(bodies_[b].inertia, w)), r + Spatial::angular_momentum);
  }
  go_on(state);
  const double before = kinetic(state);
  prescribe(state);
  return kinetic(state) - before - work_of_state(state);
}

void FirstOrderSystem::go_on(const State<Spatial>& state) {
  if (held_.empty()) return;
  model_.prescribe(state.time, place_);
  for (std::size_t h = 0; h < held_.size(); ++h) {
    const auto b = static_cast<std::size_t>(held_[h]);
    for (std::size_t k = 0; k < 3; ++k)
      offset_[3 * h + k] = state.record(b)[k] - place_[b * Spatial::unknowns + k];
  }
}

Vec3<double> FirstOrderSystem::spin(const Body& body, const Quat<double>& q,
                                    const Vec3<double>& l) const {
  const Triad<double> axes = triad(product(q, body.axes));
  return axes.to_world(over(axes.to_local(l), body.inertia));
}

void FirstOrderSystem::to_records(std::span<const double> y, double time,
                                  State<Spatial>& state) const {
  for (std::size_t b = 0; b < owned_; ++b) {
    const double* from = &y[b * width];
    double* r = state.record(b);
    std::copy_n(from + displacement, 3, r + Spatial::displacement);
    const Quat<double> q = normalised(four(from + rotation));
    put(q, r + Spatial::rotation);
    std::copy_n(from + velocity, 3, r + Spatial::velocity);
    const Vec3<double> l = three(from + momentum);
    put(spin(bodies_[b], q, l), r + Spatial::angular_velocity);
    put(l, r + Spatial::angular_momentum);
  }
  state.set_time(time);
  prescribe(state);
}

void FirstOrderSystem::prescribe(State<Spatial>& state) const {
  if (held_.empty()) return;
  model_.prescribe(state.time, place_);
  model_.prescribe_rates(state.time, rate_);
  for (std::size_t h = 0; h < held_.size(); ++h) {
    const auto b = static_cast<std::size_t>(held_[h]);
    double* r = state.record(b);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = b * Spatial::unknowns + k;
      if (!fixed(b, k)) continue;
      r[Spatial::displacement + k] = place_[at] + offset_[3 * h + k];
      r[Spatial::velocity + k] = rate_[at];
    }
    hold_spin(b, &rate_[b * Spatial::unknowns + 3], r);
  }
}

/// Computes the angular velocity of a body from its prescribed components and the free components
/// of the angular momentum, and then the remaining components of the angular momentum.
void FirstOrderSystem::hold_spin(std::size_t b, const double* rate, double* r) const {
  const std::array<bool, 3> held{fixed(b, 3), fixed(b, 4), fixed(b, 5)};
  if (!held[0] && !held[1] && !held[2]) return;
  const Triad<double> axes = triad(product(four(r + Spatial::rotation), bodies_[b].axes));
  Eigen::Matrix3d turn;
  turn << axes.e1.x, axes.e2.x, axes.e3.x, axes.e1.y, axes.e2.y, axes.e3.y, axes.e1.z, axes.e2.z,
      axes.e3.z;
  const Vec3<double>& principal = bodies_[b].inertia;
  const Eigen::Matrix3d inertia =
      turn * Eigen::Vector3d(principal.x, principal.y, principal.z).asDiagonal() * turn.transpose();
  Eigen::Map<Eigen::Vector3d> omega(r + Spatial::angular_velocity);
  Eigen::Map<Eigen::Vector3d> l(r + Spatial::angular_momentum);
  // All rows are in units of inertia, so that pivots are comparable.
  const double scale = inertia.trace();
  Eigen::Matrix3d a = inertia;
  Eigen::Vector3d right = l;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (!item(held, k)) continue;
    a.row(k) = scale * Eigen::RowVector3d::Unit(k);
    right[k] = scale * rate[k];
  }
  omega = a.partialPivLu().solve(right);
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (item(held, k)) omega[k] = rate[k];
  }
  l = inertia * omega;
}

void FirstOrderSystem::from_records(const State<Spatial>& state, std::span<double> y) const {
  for (std::size_t b = 0; b < owned_; ++b) {
    const double* r = state.record(b);
    double* to = &y[b * width];
    std::copy_n(r + Spatial::displacement, 3, to + displacement);
    std::copy_n(r + Spatial::rotation, 4, to + rotation);
    std::copy_n(r + Spatial::velocity, 3, to + velocity);
    std::copy_n(r + Spatial::angular_momentum, 3, to + momentum);
  }
  std::fill(y.begin() + static_cast<std::ptrdiff_t>(bodies_size()), y.end(), 0.0);
}

void FirstOrderSystem::rates(const State<Spatial>& state, const Wrenches<Spatial>& wrenches,
                             std::span<double> rates) const {
  for (std::size_t b = 0; b < owned_; ++b) {
    const double* r = state.record(b);
    const double* w = wrenches.of(b);
    double* to = &rates[b * width];
    std::copy_n(r + Spatial::velocity, 3, to + displacement);
    const Vec3<double> omega = three(r + Spatial::angular_velocity);
    put(product(Quat<double>{0, 0.5 * omega.x, 0.5 * omega.y, 0.5 * omega.z},
                four(r + Spatial::rotation)),
        to + rotation);
    put((1.0 / bodies_[b].mass) * three(w), to + velocity);
    put(three(w + 3), to + momentum);
  }
  double boundary = 0;
  if (!held_.empty()) model_.prescribe_accelerations(state.time, acceleration_);
  for (const std::int32_t body : held_) {
    const auto b = static_cast<std::size_t>(body);
    const double* r = state.record(b);
    double* to = &rates[b * width];
    for (std::size_t k = 0; k < 3; ++k) {
      if (fixed(b, k)) {
        boundary -= wrenches.of(b)[k] * r[Spatial::velocity + k];
        to[displacement + k] = to[velocity + k] = 0;
      }
      if (fixed(b, 3 + k)) {
        boundary -= wrenches.of(b)[3 + k] * r[Spatial::angular_velocity + k] +
                    r[Spatial::angular_momentum + k] * acceleration_[b * Spatial::unknowns + 3 + k];
        to[momentum + k] = 0;
      }
    }
  }
  std::span<double> powers = rates.subspan(bodies_size());
  for (const auto& force : model_.forces()) {
    const auto* role = force->roles().work;
    if (role == nullptr) continue;
    role->powers(powers.first(role->works()));
    powers = powers.subspan(role->works());
  }
  powers.front() = boundary;
}

double FirstOrderSystem::kinetic(const State<Spatial>& state) const {
  double sum = 0;
  for (std::size_t b = 0; b < owned_; ++b) {
    const double* r = state.record(b);
    const Vec3<double> v = three(r + Spatial::velocity);
    sum += 0.5 * (bodies_[b].mass * dot(v, v) +
                  dot(three(r + Spatial::angular_velocity), three(r + Spatial::angular_momentum)));
  }
  return sum;
}

double FirstOrderSystem::work_of_state(const State<Spatial>& state) const {
  double sum = 0;
  for (const std::int32_t body : held_) {
    const auto b = static_cast<std::size_t>(body);
    const double* r = state.record(b);
    for (std::size_t k = 0; k < 3; ++k) {
      if (fixed(b, k))
        sum += 0.5 * bodies_[b].mass * r[Spatial::velocity + k] * r[Spatial::velocity + k];
      if (fixed(b, 3 + k))
        sum += r[Spatial::angular_velocity + k] * r[Spatial::angular_momentum + k];
    }
  }
  return sum;
}

double FirstOrderSystem::largest_speed2(const State<Spatial>& state) const {
  // The sum keeps numbers that are not finite, which a maximum would lose.
  double largest = 0, sum = 0;
  for (std::size_t b = 0; b < owned_; ++b) {
    const Vec3<double> v = three(state.record(b) + Spatial::velocity);
    const double speed2 = dot(v, v);
    largest = std::max(largest, speed2);
    sum += speed2;
  }
  return std::isfinite(sum) ? largest : sum;
}

}  // namespace floe
