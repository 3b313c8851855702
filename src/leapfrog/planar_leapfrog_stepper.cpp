#include "leapfrog/planar_leapfrog_stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/simd.h"

namespace floe {

PlanarLeapfrogStepper::PlanarLeapfrogStepper(const Model<Planar>& model)
    : model_(model), part_(model.part()) {
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    const auto b = static_cast<std::size_t>(body);
    const double mass = 1 / model.inertial_mass()[b];
    inverse_.push_back({{mass, mass, 1 / inertia_about(part_.bodies, body, {0, 0, 1}), 0}});
    if (model.prescribed()[b] != 0) held_.push_back(body);
  }
  saved_.resize(held_.size() * Planar::record);
  now_.resize(static_cast<std::size_t>(part_.local) * n);
  next_ = now_;
}

void PlanarLeapfrogStepper::start(State<Planar>& state, const std::vector<Point3>& velocity,
                                  const std::vector<Point3>& spin) const {
  for (std::size_t b = 0; b < inverse_.size(); ++b) {
    double* v = state.record(b) + Planar::velocity;
    if (!velocity.empty()) v[0] = velocity[b][0], v[1] = velocity[b][1];
    if (!spin.empty()) v[2] = spin[b][2];
  }
}

void PlanarLeapfrogStepper::stagger(State<Planar>& state, const Wrenches<Planar>& wrenches,
                                    double dt) const {
  for (std::size_t b = 0; b < inverse_.size(); ++b) {
    double* v = state.record(b) + Planar::velocity;
    for (std::size_t k = 0; k < n; ++k) {
      if (!fixed(b, k)) v[k] -= 0.5 * dt * inverse_[b].values[k] * wrenches.of(b)[k];
    }
  }
}

/// Steps all bodies as if they were free. A record is two rows: places and their rates.
double PlanarLeapfrogStepper::step_free(State<Planar>& state, const Wrenches<Planar>& wrenches,
                                        double dt) const {
  Row largest{}, sum{};
  for (std::size_t b = 0; b < inverse_.size(); ++b) {
    double* record = state.record(b);
    const Row v = load_row(record + Planar::velocity) +
                  dt * (load_row(inverse_[b].values.data()) * load_row(wrenches.of(b)));
    store_row(record, load_row(record) + dt * v);
    store_row(record + Planar::velocity, v);
    const Row speed2 = pair_sums(v * v);
    if (is_held(b)) continue;  // it moves otherwise
    largest = larger(speed2, largest);
    sum = sum + speed2;  // keeps numbers that are not finite, which a maximum would lose
  }
  return std::isfinite(sum[0]) ? largest[0] : std::numeric_limits<double>::quiet_NaN();
}

void PlanarLeapfrogStepper::prescribe(double time, double dt) const {
  if (held_.empty()) return;
  model_.prescribe(time, now_);
  model_.prescribe(time + dt, next_);
}

double PlanarLeapfrogStepper::step(State<Planar>& state, const Wrenches<Planar>& wrenches,
                                   double dt) {
  const auto record_of = [&](std::size_t k) {
    return state.record(static_cast<std::size_t>(held_[k]));
  };
  for (std::size_t k = 0; k < held_.size(); ++k)
    std::copy_n(record_of(k), Planar::record, &saved_[k * Planar::record]);
  double largest = step_free(state, wrenches, dt);
  prescribe(state.time, dt);
  for (std::size_t k = 0; k < held_.size(); ++k) {
    step_held(held_[k], &saved_[k * Planar::record], record_of(k), dt);
    const double* v = record_of(k) + Planar::velocity;
    const double speed2 = v[0] * v[0] + v[1] * v[1];
    if (!std::isnan(largest) && !(speed2 <= largest)) largest = speed2;
  }
  state.time += dt;
  return largest;
}

/// Gives prescribed unknowns the velocity that takes them to their prescribed places, by an impulse
/// of the boundary. Its work is that impulse times the mean velocity.
void PlanarLeapfrogStepper::step_held(std::int32_t body, const double* before, double* record,
                                      double dt) {
  const auto b = static_cast<std::size_t>(body);
  for (std::size_t k = 0; k < n; ++k) {
    if (!fixed(b, k)) continue;
    double& v = record[Planar::velocity + k];
    const double wanted = given(b, k, dt);
    boundary_work_ +=
        (wanted - v) / inverse_[b].values[k] * 0.5 * (wanted + before[Planar::velocity + k]);
    v = wanted;
    record[k] = before[k] + dt * wanted;
  }
}

PlanarLeapfrogStepper::Energies PlanarLeapfrogStepper::energies(const State<Planar>& state,
                                                                const Wrenches<Planar>& wrenches,
                                                                double dt) const {
  prescribe(state.time, dt);
  Energies sum{0, boundary_work_};
  for (std::size_t b = 0; b < inverse_.size(); ++b) {
    const double* v = state.record(b) + Planar::velocity;
    const double* f = wrenches.of(b);
    for (std::size_t k = 0; k < n; ++k) {
      const double inverse = inverse_[b].values[k];
      const double next = fixed(b, k) ? given(b, k, dt) : v[k] + dt * inverse * f[k];
      sum.kinetic += 0.5 * v[k] * next / inverse;
      // Half the impulse that the boundary gives at t_n belongs to the step before.
      if (fixed(b, k)) sum.boundary += 0.5 * v[k] * ((next - v[k]) / inverse - dt * f[k]);
    }
  }
  return sum;
}

std::array<double, 6> PlanarLeapfrogStepper::momentum(const State<Planar>& state,
                                                      const Wrenches<Planar>& wrenches,
                                                      double dt) const {
  std::array<double, 6> total{};
  for (std::size_t b = 0; b < inverse_.size(); ++b) {
    const double* r = state.record(b);
    const Point3& x = part_.bodies.position[b];
    std::array<double, n> p{};
    for (std::size_t k = 0; k < n; ++k)
      p[k] = r[Planar::velocity + k] / inverse_[b].values[k] + 0.5 * dt * wrenches.of(b)[k];
    total[0] += p[0];
    total[1] += p[1];
    total[5] += p[2] + (x[0] + r[0]) * p[1] - (x[1] + r[1]) * p[0];
  }
  return total;
}

}  // namespace floe
