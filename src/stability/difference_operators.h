/// \file
/// Stiffness and damping of a model at a state as linear maps, by differences of its forces.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/collectives.h"
#include "model/model.h"

namespace floe {

/// The maps M^-1/2 K M^-1/2 and M^-1/2 C M^-1/2 on mass-weighted coordinates, of which a vector
/// holds this rank's share.
template <class Space>
class Operators {
 public:
  using Vector = Eigen::VectorXd;
  static constexpr int n = Space::unknowns;
  using Components = std::array<double, static_cast<std::size_t>(n)>;
  using Rates = typename LimitsStep<Space>::Rates;

  /// \param state  must outlive this object
  Operators(const Model<Space>& model, const State<Space>& state)
      : model_(model),
        part_(model.part()),
        state_(state),
        moved_(state),
        forward_(static_cast<std::size_t>(part_.local)),
        backward_(forward_) {
    // Stiffness is measured with all velocities zero, so that dashpots do not contribute.
    double fastest2 = 0;
    for (std::size_t b = 0; b < static_cast<std::size_t>(part_.local); ++b) {
      const Vec3<double> speed = velocity(state, b);
      fastest2 = std::max(fastest2, floe::dot(speed, speed));
      std::fill_n(moved_.record(b) + Space::velocity, Space::record - Space::velocity, 0.0);
    }
    speed_ = std::sqrt(largest_over_ranks(fastest2, part_.comm));
    for (const auto& force : model.forces()) {
      const auto* role = force->roles().step;
      if (role == nullptr) continue;
      bound_.stiffness += role->hidden_stiffness().stiffness;
      bound_.damping += role->hidden_stiffness().damping;
    }
  }

  int evaluations() const { return evaluations_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(part_.owned) * n; }

  double dot(const Vector& a, const Vector& b) const {
    return sum_over_ranks(a.dot(b), part_.comm);
  }

  /// Returns the world components of a body from mass-weighted ones, whose rotations are along the
  /// body's principal axes. Prescribed components are zero.
  Components unweighted(const Vector& z, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    const auto i = static_cast<Eigen::Index>(body) * n;
    const Components root = roots(body);
    Components x;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = z[i + static_cast<Eigen::Index>(k)] / root[k];
    turn<true>(b, x);
    for (std::size_t k = 0; k < x.size(); ++k) {
      if ((model_.prescribed()[b] >> k & 1U) != 0) x[k] = 0;
    }
    return x;
  }

  /// Computes stiffness and damping times z; `damping` is empty if no force damps. The differences
  /// step by 1e-6 of the length scale and of a radian. Collective.
  void apply(const Vector& z, Vector& stiffness, Vector& damping) {
    double largest = 0;
    for (std::int32_t b = 0; b < part_.owned; ++b) {
      const auto x = unweighted(z, b);
      for (std::size_t k = 0; k < x.size(); ++k)
        largest = std::max(
            largest, std::abs(x[k]) / (k < Space::translations ? model_.length_scale() : 1.0));
    }
    largest = largest_over_ranks(largest, part_.comm);
    const double step = largest > 0 ? 1e-6 / largest : 0.0;
    stiffness = difference(z, step, 0);
    if (step > 0) stiffness *= 0.5 / step;
    stiffness += bound_.stiffness * z;
    if (!damped_) return;
    difference_damping(z, step, damping);
    if (step > 0 && !decided_) decide(damping);
  }
  /// Whether any force damps; valid after the first apply().
  bool is_damped() const { return damped_; }
  /// Bounds of stiffness and damping of the forces that take no part in the differences.
  const Rates& bound() const { return bound_; }

 private:
  /// M^-1/2 times the forces at displacements -step z and velocities -speed z, minus those at +step
  /// z and +speed z.
  Vector difference(const Vector& z, double step, double speed) {
    displace(z, step, speed);
    evaluate(forward_);
    displace(z, -step, -speed);
    evaluate(backward_);
    return weighted(backward_, forward_);
  }

  /// \param step  step of displacements that makes them 1e-6 of the length scale and of a radian
  void difference_damping(const Vector& z, double step, Vector& damping) {
    if (speed_ < slow || step == 0) {
      if (at_rest_.values.empty()) {
        at_rest_ = forward_;
        displace(z, 0, 0);
        evaluate(at_rest_);
      }
      displace(z, 0, 1);
      evaluate(forward_);
      damping = weighted(at_rest_, forward_);
      return;
    }
    // Quadratic drag depends on the present velocities, so the difference is taken about them, by
    // 1e-3 of them to either side; otherwise the images of a search's vectors would not be those of
    // one linear map. Changes below 1e-6 m/s would be lost in the rounding of large forces, and
    // quadratic drag at such speeds is negligible.
    const double change = 1e6 * step * std::max(1e-3 * speed_, slow) / model_.length_scale();
    damping = difference(z, 0, change);
    damping *= 0.5 / change;
  }

  /// Decides whether the model is damped. The first vector of every search is random, so if its
  /// image is exactly zero the damping is zero, and further images are neither computed nor kept.
  void decide(Vector& damping) {
    const double mine = damping.size() > 0 ? damping.cwiseAbs().maxCoeff() : 0;
    const double largest = largest_over_ranks(mine, part_.comm);
    decided_ = true;
    damped_ = largest > 0;
    if (damped_) return;
    damping = {};
    at_rest_.values = {};
  }

  void evaluate(Wrenches<Space>& wrenches) {
    std::fill(wrenches.values.begin(), wrenches.values.end(), 0.0);
    for (const auto& force : model_.forces()) {
      const auto* role = force->roles().step;
      if (role == nullptr || role->hidden_stiffness().stiffness == 0) force->add(moved_, wrenches);
    }
    ++evaluations_;
  }
  /// Rotates the rotation components from a body's principal axes to the world, or back. In the
  /// plane both are the same.
  template <bool to_world>
  void turn(std::size_t b, Components& x) const {
    if constexpr (std::is_same_v<Space, Spatial>) {
      const auto [w, qx, qy, qz] = part_.bodies.orientation[b];
      const Triad<double> axes =
          triad(product(normalised(rotation(state_, b)), Quat<double>{w, qx, qy, qz}));
      const Vec3<double> t{x[3], x[4], x[5]};
      const Vec3<double> turned = to_world ? axes.to_world(t) : axes.to_local(t);
      x[3] = turned.x, x[4] = turned.y, x[5] = turned.z;
    }
  }
  /// Square roots of the mass and of the moments of inertia.
  Components roots(std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    Components root;
    root.fill(std::sqrt(model_.inertial_mass()[b]));
    if constexpr (std::is_same_v<Space, Spatial>) {
      for (std::size_t k = 0; k < 3; ++k) root[3 + k] = std::sqrt(part_.bodies.inertia[b][k]);
    } else {
      root[2] = std::sqrt(inertia_about(part_.bodies, body, {0, 0, 1}));
    }
    return root;
  }
  /// Rotates a record's rotation by `by` times the rotation components of x.
  void turn_record(std::size_t b, const Components& x, double by, double* r) const {
    if constexpr (std::is_same_v<Space, Spatial>) {
      const Vec3<double> spin{by * x[3], by * x[4], by * x[5]};
      Quat<double> q = rotation(state_, b);
      if (model_.kinematics() == Kinematics::linear) {
        q = {1, q.x + 0.5 * spin.x, q.y + 0.5 * spin.y, q.z + 0.5 * spin.z};
      } else {
        q = product(exp_rotation(spin), q);
      }
      r[3] = q.w, r[4] = q.x, r[5] = q.y, r[6] = q.z;
    } else {
      r[Space::rotation] += by * x[2];
    }
  }

  /// Moves all bodies by `by` times z and changes their velocities by `speed` times z; speed 0: all
  /// velocities are zero.
  void displace(const Vector& z, double by, double speed) {
    const double from = speed_ < slow ? 0 : 1;
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto b = static_cast<std::size_t>(body);
      const Components x = unweighted(z, body);
      double* r = moved_.record(b);
      std::copy_n(state_.record(b), Space::velocity, r);
      for (std::size_t k = 0; k < Space::translations; ++k) r[k] += by * x[k];
      turn_record(b, x, by, r);
      constexpr auto at = static_cast<std::size_t>(Space::velocity);
      for (std::size_t k = 0; k < x.size(); ++k)
        r[at + k] = speed != 0 ? from * state_.record(b)[at + k] + speed * x[k] : 0.0;
    }
    part_.ghosts.update(moved_.records, Space::record);
  }

  /// M^-1/2 (a - b); prescribed components are zero.
  Vector weighted(const Wrenches<Space>& a, const Wrenches<Space>& b) const {
    Vector y(size());
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto index = static_cast<std::size_t>(body);
      Components f{};
      for (std::size_t k = 0; k < f.size(); ++k) {
        if ((model_.prescribed()[index] >> k & 1U) == 0) f[k] = a.of(index)[k] - b.of(index)[k];
      }
      turn<false>(index, f);
      const Components root = roots(body);
      for (std::size_t k = 0; k < f.size(); ++k)
        y[static_cast<Eigen::Index>(body) * n + static_cast<Eigen::Index>(k)] = f[k] / root[k];
    }
    return y;
  }

  const Model<Space>& model_;
  const Part& part_;
  static constexpr double slow = 1e-6;  // [m/s]: quadratic drag is negligible below
  const State<Space>& state_;
  State<Space> moved_;
  Wrenches<Space> forward_, backward_, at_rest_;
  double speed_ = 0;
  Rates bound_;
  bool damped_ = true, decided_ = false;
  int evaluations_ = 0;
};

}  // namespace floe
