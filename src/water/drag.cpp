#include "water/drag.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"
#include "submersion/immersion.h"
#include "water/drag_law.h"

namespace floe {
namespace {

/// Velocities of the bodies of a block, and their wet areas A_p V/V_0 with V the submerged volume.
struct MovingBlock {
  Vec3<Lanes> v;
  Lanes area;
};

struct alignas(64) LaneNumbers {
  std::array<double, lanes> values;
};

/// Wet areas A_p V/V_0 of the owned bodies.
template <class Space>
class WettedBodies;

template <>
class WettedBodies<Spatial> {
 public:
  explicit WettedBodies(const Part& part)
      : WettedBodies(std::make_shared<Submersion>(require_shapes(part, "drag"), 1, false)) {}
  explicit WettedBodies(std::shared_ptr<Submersion> submersion)
      : submersion_(std::move(submersion)),
        immersion_(submersion_->immersion()),
        area_per_volume_(immersion_.blocks()) {
    for (std::size_t k = 0; k < immersion_.blocks() * lanes; ++k) {
      const auto body = static_cast<std::int32_t>(immersion_.body_of(k / lanes, k % lanes));
      area_per_volume_[k / lanes].values[k % lanes] =
          immersion_.volume(body) > 0 ? immersion_.plan_area(body) / immersion_.volume(body) : 0;
    }
  }
  DeviceWater& describe(DeviceModel& model) const {
    DeviceWater& water = submersion_->describe(model);
    for (std::size_t b = 0; b < water.prisms.size(); ++b)
      water.area_per_volume.push_back(per_volume(b));
    return water;
  }
  std::size_t blocks() const { return immersion_.blocks(); }
  MovingBlock block(const State<Spatial>& state, std::size_t block) const {
    const BlockMotion m = block_motion<true>(immersion_, state, block);
    const Lanes volume = submersion_->knows_volumes()
                             ? submersion_->volume(block)
                             : immersion_.of_block(state, block, m.u.z, m.q).volume;
    return {m.v, volume * load(area_per_volume_[block].values.data())};
  }
  /// Wet area of one body [m^2].
  double area(const State<Spatial>& state, std::size_t b) const {
    return per_volume(b) * immersion_.of(state, static_cast<std::int32_t>(b)).volume;
  }
  /// Derivative of the wet area to z, rx, ry: dV = -(W u_z + W_y t_x - W_x t_y), with the
  /// waterplane W and its moments.
  std::array<double, 3> slope(const State<Spatial>& state, std::size_t b) const {
    const Submerged s = immersion_.of(state, static_cast<std::int32_t>(b));
    if (s.volume == 0) return {};
    return {-per_volume(b) * s.waterplane, -per_volume(b) * s.wy, per_volume(b) * s.wx};
  }

 private:
  double per_volume(std::size_t b) const { return area_per_volume_[b / lanes].values[b % lanes]; }

  std::shared_ptr<Submersion> submersion_;
  const Immersion& immersion_;
  std::vector<LaneNumbers> area_per_volume_;  ///< A_p/V_0 of each body [1/m]
};

/// In the plane the submerged volume does not change.
template <>
class WettedBodies<Planar> {
 public:
  explicit WettedBodies(const Part& part) : owned_(static_cast<std::size_t>(part.owned)) {
    const WettedBodies<Spatial> bodies(part);
    const State<Spatial> rest(static_cast<std::size_t>(part.local));
    area_.resize(bodies.blocks());
    for (std::size_t k = 0; k < bodies.blocks() * lanes; ++k)
      area_[k / lanes].values[k % lanes] = bodies.area(rest, std::min(k, owned_ - 1));
  }
  std::size_t blocks() const { return area_.size(); }
  MovingBlock block(const State<Planar>& state, std::size_t block) const {
    const auto [x, y, turn, none] = gather_four([&](std::size_t lane) {
      return state.record(std::min(block * lanes + lane, owned_ - 1)) + Planar::velocity;
    });
    return {{x, y, Lanes(0.0)}, load(area_[block].values.data())};
  }
  double area(const State<Planar>&, std::size_t b) const {
    return area_[b / lanes].values[b % lanes];
  }

 private:
  std::size_t owned_;
  std::vector<LaneNumbers> area_;  ///< [m^2]
};

/// Drag on the owned bodies. The forces of the last evaluation are kept, for their power with the
/// velocities after the step.
template <class Space>
class Drag final : public Force<Space>,
                   public HasTangent<Space>,
                   public Damps<Space>,
                   public DoesWork<Space>,
                   public LimitsStep<Space>,
                   public OnDevice {
 public:
  Drag(const Part& part, WettedBodies<Space> bodies, const DragOptions& options)
      : part_(part),
        bodies_(std::move(bodies)),
        water_(options.water()),
        linear_(options.linear),
        coefficient_(0.5 * options.density * options.coefficient),
        quadratic_(options.coefficient > 0),
        forces_(static_cast<std::size_t>(part.owned)) {}

  std::string_view name() const override { return "drag"; }
  Roles<Space> roles() override {
    return {.tangent = this, .damping = this, .work = this, .step = this, .device = this};
  }
  void describe(DeviceModel& model) override {
    if constexpr (std::is_same_v<Space, Spatial>) {
      DeviceWater& water = bodies_.describe(model);
      water.drag_work = model.next_work;
      water.linear = linear_;
      water.coefficient = coefficient_;
      water.current = [this](double time) { return water_.velocity(time); };
    }
  }

  void add(const State<Space>& state, Wrenches<Space>& wrenches) override {
    power_ = quadratic_ ? add<true>(state, wrenches, forces_.data())
                        : add<false>(state, wrenches, forces_.data());
  }
  /// Adds the derivative of F to the submerged volume to K only: it is not symmetric, and small
  /// compared with the tangent of buoyancy.
  bool add_tangent(const State<Space>& state, Tangent<Space>& tangent) const override {
    if constexpr (std::is_same_v<Space, Spatial>) {
      if (tangent.symmetric()) return false;
      for (std::size_t b = 0; b < forces_.size(); ++b) {
        const Vec3<double> per_area = factor(state, b) * speed(state, b);
        const std::array<double, 3> slope = bodies_.slope(state, b);
        Tangent<Spatial>::Block k{};
        for (std::size_t r = 0; r < 3; ++r) {
          for (std::size_t c = 0; c < 3; ++c) k[r * 6 + 2 + c] = per_area[r] * slope[c];
        }
        tangent.add_body(static_cast<std::int32_t>(b), k);
      }
      return true;
    } else {
      return (void)state, (void)tangent, false;
    }
  }
  void add_damping(const State<Space>& state, Tangent<Space>& tangent) const override {
    constexpr std::size_t n = Space::unknowns;
    for (std::size_t b = 0; b < forces_.size(); ++b) {
      const Vec3<double> v = speed(state, b);
      const double size = std::sqrt(dot(v, v)), area = bodies_.area(state, b);
      const double rise = size > 0 ? coefficient_ / size * area : 0;
      typename Tangent<Space>::Block c{};
      for (std::size_t r = 0; r < Space::translations; ++r) {
        c[r * n + r] = area * factor(state, b);
        for (std::size_t k = 0; k < Space::translations; ++k) c[r * n + k] += rise * v[r] * v[k];
      }
      tangent.add_body(static_cast<std::int32_t>(b), c);
    }
  }
  void add_losses(const State<Space>& state, Wrenches<Space>& wrenches) const override {
    (void)(quadratic_ ? add<true>(state, wrenches, nullptr) : add<false>(state, wrenches, nullptr));
  }
  double stiffness_bound(std::int32_t) const override { return 0; }

  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Space>& state, std::span<double> out) const override {
    double power = 0;
    for (std::size_t b = 0; b < forces_.size(); ++b) {
      const double* v = state.record(b) + Space::velocity;
      double mine = 0;
      for (std::size_t k = 0; k < Space::translations; ++k) mine += forces_[b][k] * v[k];
      power += mine;
    }
    out.front() = power;
  }

  /// Derivative of the force to the velocity along the flow, over the mass.
  std::optional<double> rate_estimate(const State<Space>& state) const override {
    using std::sqrt;
    const Vec3<double> water = water_.velocity(state.time);
    const Vec3<Lanes> current{water.x, water.y, water.z};
    double fastest = 0;
    for (std::size_t block = 0; block < bodies_.blocks(); ++block) {
      const MovingBlock m = bodies_.block(state, block);
      const Vec3<Lanes> v = m.v - current;
      const Lanes drag = (linear_ + 2.0 * coefficient_ * sqrt(dot(v, v))) * m.area;
      for (std::size_t b = block * lanes; b < std::min((block + 1) * lanes, forces_.size()); ++b)
        fastest = std::max(fastest, drag[b % lanes] / part_.bodies.mass[b]);
    }
    return fastest;
  }

  void report(const State<Space>&, std::span<const double> works, Columns& columns) const override {
    columns.add("energy_drag", 0.0 - works.front());
  }

 private:
  /// Adds the wrenches.
  /// \param forces  receives the force on each owned body [N]; may be null
  /// \returns the power on the bodies [W]
  template <bool quadratic>
  [[gnu::flatten]] double add(const State<Space>& state, Wrenches<Space>& wrenches,
                              std::array<double, 4>* forces) const {
    const Vec3<double> water = water_.velocity(state.time);
    const Vec3<Lanes> current{water.x, water.y, water.z};
    double sum = 0;
    for (std::size_t block = 0; block < bodies_.blocks(); ++block) {
      const MovingBlock m = bodies_.block(state, block);
      const Vec3<Lanes> v = m.v - current;
      const Vec3<Lanes> force = drag_force<quadratic>(linear_, coefficient_, m.area, v);
      const Lanes power = dot(force, m.v);
      std::array<Row, lanes> rows;
      scatter_four({force.x, force.y, force.z, Lanes(0.0)}, rows);
      for (std::size_t b = block * lanes; b < std::min((block + 1) * lanes, forces_.size()); ++b) {
        add_row(wrenches.of(b), rows[b % lanes]);
        if (forces != nullptr) store_row(forces[b].data(), rows[b % lanes]);
        sum += power[b % lanes];
      }
    }
    return sum;
  }
  /// Velocity of an owned body relative to the water [m/s].
  Vec3<double> speed(const State<Space>& state, std::size_t b) const {
    return velocity(state, b) - water_.velocity(state.time);
  }
  /// Drag on an owned body per wet area and speed [N s/m^3].
  double factor(const State<Space>& state, std::size_t b) const {
    const Vec3<double> v = speed(state, b);
    return linear_ + coefficient_ * std::sqrt(dot(v, v));
  }

  const Part& part_;
  WettedBodies<Space> bodies_;
  WaterMotion water_;
  double linear_, coefficient_;  ///< c [N s/m^3] and rho_w C_d/2 [N s^2/m^4]
  bool quadratic_;
  std::vector<std::array<double, 4>> forces_;  ///< of the last evaluation [N], padded
  double power_ = 0;                           ///< of the last evaluation [W]
};

}  // namespace

template <class Space>
std::unique_ptr<Force<Space>> make_drag(const Part& part, const DragOptions& options) {
  return std::make_unique<Drag<Space>>(part, WettedBodies<Space>(part), options);
}
std::unique_ptr<Force<Spatial>> make_drag(std::shared_ptr<Submersion> submersion,
                                          const DragOptions& options) {
  const Part& part = submersion->part();
  return std::make_unique<Drag<Spatial>>(part, WettedBodies<Spatial>(std::move(submersion)),
                                         options);
}

template std::unique_ptr<Force<Spatial>> make_drag<Spatial>(const Part&, const DragOptions&);
template std::unique_ptr<Force<Planar>> make_drag<Planar>(const Part&, const DragOptions&);

}  // namespace floe
