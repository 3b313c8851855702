#include "forces/support.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "floe/base/item.h"

namespace floe {
namespace {

class Supports final : public Force<Spatial>,
                       public DoesWork<Spatial>,
                       public LimitsStep<Spatial>,
                       public Remarks,
                       public OnDevice {
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
  Roles<Spatial> roles() override {
    return {.work = this, .step = this, .remarks = this, .device = this};
  }

  void describe(DeviceModel& model) override {
    model.support_work = model.next_work;
    for (const Held& held : all_)
      model.supports.push_back(
          {held.local, held.arm, held.support.stiffness, held.support.damping});
  }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    time_ = state.time;
    for (Held& held : all_) {
      if (held.local < 0) continue;
      const auto b = static_cast<std::size_t>(held.local);
      const SupportedBody<double> now =
          supported(held.support.stiffness, held.support.damping, held.arm, displacement(state, b),
                    rotation(state, b), velocity(state, b), angular_velocity(state, b));
      held.shift = now.shift, held.turn = now.turn;
      held.wrench = now.wrench, held.damping = now.damping;
      floe::add(wrenches, b, now.wrench.force, now.moment);
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

double spring_energy(const SupportMatrix& stiffness, const Vec3<double>& shift,
                     const Vec3<double>& turn) {
  const auto [force, moment] = product_of(stiffness, shift, turn);
  return 0.5 * (dot(force, shift) + dot(moment, turn));
}

std::unique_ptr<Force<Spatial>> make_supports(const Part& part, std::vector<Support> supports) {
  return std::make_unique<Supports>(part, std::move(supports));
}

}  // namespace floe
