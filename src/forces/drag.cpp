#include "floe/forces/drag.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/lattice/memory.h"
#include "forces/immersion.h"

namespace floe {
namespace {

/// The ledger: velocities are known half a step apart, so the force F_n at t_n does the work
/// dt/2 F_n.(v_n-1/2 + v_n+1/2). That is what the kinetic energy m v_n-1/2.v_n+1/2 / 2 of a free
/// body loses, to rounding. The first half is a by-product of evaluation; a report at t_n counts
/// it, commit adds the second half.
class Drag final : public Force<Spatial> {
 public:
  Drag(const Part& part, const DragOptions& options)
      : part_(part),
        immersion_(with_shapes(part)),
        current_{options.current[0], options.current[1], options.current[2]},
        linear_(options.linear),
        coefficient_(0.5 * options.density * options.coefficient),
        quadratic_(options.coefficient > 0),
        area_per_volume_(immersion_.blocks()),
        forces_(static_cast<std::size_t>(part.owned)) {
    for (std::size_t k = 0; k < immersion_.blocks() * lanes; ++k) {
      const auto body = static_cast<std::int32_t>(immersion_.body_of(k / lanes, k % lanes));
      area_per_volume_[k / lanes].values[k % lanes] =
          immersion_.plan_area(body) / immersion_.volume(body);
    }
  }

  std::string_view name() const override { return "drag"; }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) const override {
    quadratic_ ? add<true>(state, wrenches) : add<false>(state, wrenches);
  }
  /// F goes with the submerged volume: -dF = -(F/V) dV, dV = -(W u_z + W_y t_x - W_x t_y) with the
  /// waterplane W and its moments. Nothing symmetric, and little beside buoyancy's.
  bool add_tangent(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    if (tangent.symmetric()) return false;
    for (std::size_t b = 0; b < forces_.size(); ++b) {
      const auto body = static_cast<std::int32_t>(b);
      const Submerged s = immersion_.of(state, body);
      if (s.volume == 0) continue;
      const Vec3<double> per_volume = (-factor(state, b)) * speed(state, b);
      const std::array<double, 3> f{per_volume.x, per_volume.y, per_volume.z};
      Tangent<Spatial>::Block k{};
      for (std::size_t r = 0; r < 3; ++r) {
        k[r * 6 + 2] = f[r] * s.waterplane;
        k[r * 6 + 3] = f[r] * s.wy;
        k[r * 6 + 4] = -f[r] * s.wx;
      }
      tangent.add_body(body, k);
    }
    return true;
  }
  void add_damping(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    for (std::size_t b = 0; b < forces_.size(); ++b) {
      const auto body = static_cast<std::int32_t>(b);
      const double volume = immersion_.of(state, body).volume;
      const Vec3<double> v = speed(state, b);
      const std::array<double, 3> along{v.x, v.y, v.z};
      const double size = std::sqrt(dot(v, v));
      const double rise =
          size > 0 ? coefficient_ / size * volume * area_per_volume_[b / lanes].values[b % lanes]
                   : 0;
      Tangent<Spatial>::Block c{};
      for (std::size_t r = 0; r < 3; ++r) {
        c[r * 6 + r] = volume * factor(state, b);
        for (std::size_t k = 0; k < 3; ++k) c[r * 6 + k] += rise * along[r] * along[k];
      }
      tangent.add_body(body, c);
    }
  }
  bool add_losses(const State<Spatial>& state, Wrenches<Spatial>& wrenches) const override {
    add(state, wrenches);
    return true;
  }
  double stiffness_bound(std::int32_t) const override { return 0; }

  void commit(const State<Spatial>& state, double dt) override {
    double power = 0;
    for (std::size_t b = 0; b < forces_.size(); ++b) {
      const double* v = state.record(b) + Spatial::velocity;
      power += forces_[b][0] * v[0] + forces_[b][1] * v[1] + forces_[b][2] * v[2];
    }
    lost_ -= 0.5 * (last_dt_ * power_ + dt * power);
    last_dt_ = dt;
  }

  double power(const State<Spatial>&) const override { return power_; }
  void take_work(double work) override { lost_ -= work; }

  /// Of the derivative of the force to the velocity, along the flow.
  std::optional<double> fastest_rate(const State<Spatial>& state) const override {
    using std::sqrt;
    const Vec3<Lanes> current{current_.x, current_.y, current_.z};
    double fastest = 0;
    for (std::size_t block = 0; block < immersion_.blocks(); ++block) {
      const BlockMotion m = block_motion<true>(immersion_, state, block);
      const Vec3<Lanes> v = m.v - current;
      const Lanes factor = linear_ + 2.0 * coefficient_ * sqrt(dot(v, v));
      const Lanes volume = immersion_.of_block(state, block, m.u.z, m.q).volume;
      const Lanes drag = factor * (volume * load(area_per_volume_[block].values.data()));
      for (std::size_t lane = 0; lane < lanes; ++lane)
        fastest = std::max(fastest, drag[lane] / mass_of(block, lane));
    }
    return fastest;
  }

  void remember(Memory& checkpoint) override {
    checkpoint.share("energy_drag", lost_);
    checkpoint.common("last_dt", last_dt_);
  }

  void report(const State<Spatial>&, Columns& columns) const override {
    columns.add("energy_drag", lost_ - 0.5 * last_dt_ * power_);
  }

 private:
  template <bool quadratic>
  [[gnu::flatten]] void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) const {
    using std::sqrt;
    const Vec3<Lanes> current{current_.x, current_.y, current_.z};
    power_ = 0;
    for (std::size_t block = 0; block < immersion_.blocks(); ++block) {
      const BlockMotion m = block_motion<true>(immersion_, state, block);
      const Vec3<Lanes> v = m.v - current;
      Lanes factor(linear_);
      if constexpr (quadratic) factor += coefficient_ * sqrt(dot(v, v));
      const Lanes volume = immersion_.of_block(state, block, m.u.z, m.q).volume;
      const Lanes drag = -(factor * (volume * load(area_per_volume_[block].values.data())));
      const Vec3<Lanes> force = drag * v;
      const Lanes power = dot(force, m.v);
      std::array<detail::Four, lanes> rows;
      scatter_four<Lanes>({force.x, force.y, force.z, Lanes(0.0)}, rows);
      for (std::size_t b = block * lanes; b < std::min((block + 1) * lanes, forces_.size()); ++b) {
        add_four(wrenches.of(b), rows[b % lanes]);
        __builtin_memcpy(forces_[b].data(), &rows[b % lanes], sizeof rows[0]);
        power_ += power[b % lanes];
      }
    }
  }
  double mass_of(std::size_t block, std::size_t lane) const {
    return part_.bodies.mass[immersion_.body_of(block, lane)];
  }
  struct alignas(64) Block {
    std::array<double, lanes> values;
  };
  /// Velocity of an owned body against the water, and the drag over it and over V [N s/m^4].
  Vec3<double> speed(const State<Spatial>& state, std::size_t b) const {
    const double* v = state.record(b) + Spatial::velocity;
    return Vec3<double>{v[0], v[1], v[2]} - current_;
  }
  double factor(const State<Spatial>& state, std::size_t b) const {
    const Vec3<double> v = speed(state, b);
    return (linear_ + coefficient_ * std::sqrt(dot(v, v))) *
           area_per_volume_[b / lanes].values[b % lanes];
  }
  static const Part& with_shapes(const Part& part) {
    if (part.shapes.empty() && part.owned > 0)
      throw InputError("forces: drag needs bodies with a shape; the lattice file has no /shapes");
    return part;
  }
  const Part& part_;
  Immersion immersion_;
  Vec3<double> current_;
  double linear_, coefficient_;  ///< c [N s/m^3] and rho_w C_d/2 [N s^2/m^4]
  bool quadratic_;
  std::vector<Block> area_per_volume_;  ///< A_plan/volume of each body [1/m]
  mutable std::vector<std::array<double, 4>>
      forces_;                ///< of the last evaluation [N], padded; a by-product
  mutable double power_ = 0;  ///< of the last evaluation [W]; a by-product
  double lost_ = 0;           ///< [J]
  double last_dt_ = 0;        ///< of the step that led to the last state [s]
};

}  // namespace

template <>
std::unique_ptr<Force<Spatial>> make_drag<Spatial>(const Part& part, const DragOptions& options) {
  return std::make_unique<Drag>(part, options);
}

}  // namespace floe
