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
      : immersion_(with_shapes(part)),
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
  bool add_tangent(const State<Spatial>&, Tangent<Spatial>&) const override { return false; }
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
  struct alignas(64) Block {
    std::array<double, lanes> values;
  };
  static const Part& with_shapes(const Part& part) {
    if (part.shapes.empty() && part.owned > 0)
      throw InputError("forces: drag needs bodies with a shape; the lattice file has no /shapes");
    return part;
  }
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
