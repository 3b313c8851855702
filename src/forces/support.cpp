#include "forces/support.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "floe/base/item.h"

namespace floe {
namespace {

/// The product of a matrix and (a, b), in two parts.
std::pair<Vec3<double>, Vec3<double>> product_of(const SupportMatrix& m, const Vec3<double>& a,
                                                 const Vec3<double>& b) {
  std::array<double, 6> sum{};
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t k = 0; k < 3; ++k)
      sum[row] += m[6 * row + k] * a[k] + m[6 * row + 3 + k] * b[k];
  }
  return {{sum[0], sum[1], sum[2]}, {sum[3], sum[4], sum[5]}};
}

/// 1/t^2 - (1 + cos t)/(2 t sin t); its series where t is small: both terms are large there.
double curvature(double t) {
  constexpr double small = 0.05;
  const double t2 = t * t;
  if (t < small) return 1.0 / 12 + t2 / 720 + t2 * t2 / 30240;
  return 1 / t2 - (1 + std::cos(t)) / (2 * t * std::sin(t));
}

class Supports final : public Force<Spatial>,
                       public DoesWork<Spatial>,
                       public LimitsStep<Spatial>,
                       public Remarks {
 public:
  Supports(const Part& part, std::vector<Support> supports) : part_(part) {
    for (Support& support : supports) {
      const std::int32_t local = part.local_index(support.body);
      const bool here = local >= 0 && local < part.owned;
      const Vec3<double> arm =
          here ? support.point - item(part.bodies.position, local) : Vec3<double>{};
      all_.push_back({std::move(support), here ? local : -1, arm, {}, {}, {}, {}});
    }
  }

  std::string_view name() const override { return "support"; }
  Roles<Spatial> roles() override { return {.work = this, .step = this, .remarks = this}; }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    time_ = state.time;
    for (Held& held : all_) {
      if (held.local < 0) continue;
      const auto b = static_cast<std::size_t>(held.local);
      place(state, held);
      const SupportWrench spring = spring_wrench(held.support.stiffness, held.shift, held.turn);
      const Vec3<double> arm = arm_of(state, held);
      const Vec3<double> v = velocity(state, b), w = angular_velocity(state, b);
      const auto [force, moment] = product_of(held.support.damping, v + cross(w, arm), w);
      held.damping = {-force, -moment + cross(arm, -force)};
      held.wrench = {spring.force - force, spring.moment - moment};
      floe::add(wrenches, b, held.wrench.force, held.wrench.moment + cross(arm, held.wrench.force));
    }
    power_ = power_with(state);
  }

  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    out.front() = power_with(state);
  }

  /// Of the translations, and of the rotations at the distance of the radius of gyration.
  double stiffness_bound(std::int32_t body) const override {
    double bound = 0;
    for (const Held& held : all_) {
      if (held.local != body) continue;
      const Point3& moments = item(part_.bodies.inertia, body);
      const double least = std::min({moments.x, moments.y, moments.z}),
                   gyration2 = least / item(part_.bodies.mass, body);
      const double arm2 = dot(held.arm, held.arm);
      for (std::size_t row = 0; row < 6; ++row) {
        double sum = 0;
        for (std::size_t k = 0; k < 6; ++k) {
          const double unit =
              (row < 3 ? 1 : 1 / std::sqrt(gyration2)) * (k < 3 ? 1 : 1 / std::sqrt(gyration2));
          sum += std::abs(held.support.stiffness[6 * row + k]) * unit;
        }
        bound = std::max(bound, sum * (1 + arm2 / gyration2));
      }
    }
    return bound;
  }

  void report(const State<Spatial>& state, std::span<const double> works,
              Columns& columns) const override {
    double energy = 0;
    for (const Held& held : all_)
      if (held.local >= 0) energy += spring_energy(held.support.stiffness, held.shift, held.turn);
    columns.add("energy_support", energy);
    columns.add("energy_damping", 0.0 - works.front());
    for (const Held& held : all_) {
      const bool here = held.local >= 0;
      const std::string& name = held.support.name;
      const auto of_three = [&](const std::string& what, const Vec3<double>& v) {
        const Vec3<double> shown = here ? v + Vec3<double>{} : Vec3<double>{};  // no -0
        columns.add(name + what + "x", shown.x);
        columns.add(name + what + "y", shown.y);
        columns.add(name + what + "z", shown.z);
      };
      const auto b = static_cast<std::size_t>(std::max(held.local, 0));
      const Vec3<double> w = here ? angular_velocity(state, b) : Vec3<double>{};
      of_three("_", held.shift);
      of_three("_r", held.turn);
      of_three("_velocity_",
               here ? velocity(state, b) + cross(w, arm_of(state, held)) : Vec3<double>{});
      of_three("_spin_", w);
      of_three("_support_force_", held.wrench.force);
      of_three("_support_moment_", held.wrench.moment);
    }
  }

  std::vector<Remark> take_remarks() override {
    constexpr double most = 1;  // [rad]
    std::vector<Remark> remarks;
    for (Held& held : all_) {
      if (held.told || !(length(held.turn) > most)) continue;
      held.told = true;
      remarks.push_back({time_, "obstacle: " + held.support.name +
                                    ": has turned by more than 1 rad, for which springs on a "
                                    "rotation vector are no model of a support"});
    }
    return remarks;
  }

 private:
  struct Held {
    Support support;
    std::int32_t local = -1;  ///< owned body; -1: on another rank
    Vec3<double> arm{};       ///< from the centroid to the point, at rest [m]
    Vec3<double> shift{}, turn{};
    SupportWrench wrench{};   ///< in the last evaluation, about the point
    SupportWrench damping{};  ///< of the dashpots, about the centroid
    bool told = false;
  };

  Vec3<double> arm_of(const State<Spatial>& state, const Held& held) const {
    return rotate(rotation(state, static_cast<std::size_t>(held.local)), held.arm);
  }
  void place(const State<Spatial>& state, Held& held) const {
    const auto b = static_cast<std::size_t>(held.local);
    held.shift = displacement(state, b) + (arm_of(state, held) - held.arm);
    held.turn = log_rotation(rotation(state, b));
  }
  double power_with(const State<Spatial>& state) const {
    double power = 0;
    for (const Held& held : all_) {
      if (held.local < 0) continue;
      const auto b = static_cast<std::size_t>(held.local);
      power += dot(held.damping.force, velocity(state, b)) +
               dot(held.damping.moment, angular_velocity(state, b));
    }
    return power;
  }

  const Part& part_;
  std::vector<Held> all_;
  double power_ = 0, time_ = 0;
};

}  // namespace

SupportWrench spring_wrench(const SupportMatrix& stiffness, const Vec3<double>& shift,
                            const Vec3<double>& turn) {
  const auto [force, g] = product_of(stiffness, shift, turn);
  const Vec3<double> once = cross(turn, g);
  const Vec3<double> moment = g + 0.5 * once + curvature(length(turn)) * cross(turn, once);
  return {-force, -moment};
}

double spring_energy(const SupportMatrix& stiffness, const Vec3<double>& shift,
                     const Vec3<double>& turn) {
  const auto [force, moment] = product_of(stiffness, shift, turn);
  return 0.5 * (dot(force, shift) + dot(moment, turn));
}

std::unique_ptr<Force<Spatial>> make_supports(const Part& part, std::vector<Support> supports) {
  return std::make_unique<Supports>(part, std::move(supports));
}

}  // namespace floe
