#include "floe/forces/beam.h"

#include <algorithm>

#include "forces/beam_blocks.h"
#include "forces/beam_spatial.h"

namespace floe {
namespace {

/// Loops over the beams of a part; kinematics and damping are chosen outside them.
template <Kinematics kinematics, bool damped>
class SpatialBeams final : public BeamForce<Spatial> {
 public:
  using Pointwise = SpatialBeam<kinematics>;

  SpatialBeams(const Part& part, const BeamOptions& options)
      : part_(part),
        blocks_((part.beams.bodies.size() + lanes - 1) / lanes, BeamBlock{}),
        dashpots_(damped ? blocks_.size() : 0, DashpotBlock{}),
        stiffness_(static_cast<std::size_t>(part.local)) {
    BeamConstants<double>
        none{};  // fills the last block up: of unit length, without stiffness, on body 0
    none.rest = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    none.l0 = 1;
    for (std::size_t m = part.beams.bodies.size(); m < blocks_.size() * lanes; ++m)
      blocks_[m / lanes].set(m % lanes, none);
    for (std::int32_t m = 0; m < part.beams.size(); ++m) set(m, options);
  }

  std::string_view name() const override { return "beam"; }

  /// flatten: everything of the kernel in one body, or lanes travel through memory between its
  /// functions.
  [[gnu::flatten]] void add(const State<Spatial>& state,
                            Wrenches<Spatial>& wrenches) const override {
    const double* records = state.records.data();
    double* values = wrenches.values.data();
    Lanes lost(0.0);
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      lost += add_block<kinematics, damped>(blocks_[b], damped ? &dashpots_[b] : nullptr, records,
                                            values);
    if constexpr (damped) power_lost_ = reduce(lost);
  }

  bool add_tangent(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    Tangent<Spatial>::PairBlock block;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      Pointwise::tangent(constants(m), record(state, i), record(state, j), tangent.symmetric(),
                         block);
      tangent.add_pair(i, j, block);
    });
    return true;
  }

  double stiffness_bound(std::int32_t body) const override {
    return stiffness_[static_cast<std::size_t>(body)];
  }

  void commit(const State<Spatial>&, double dt) override {
    if constexpr (damped) {
      lost_ += (step_ > 0 ? dt : 0.25 * dt) * power_lost_;  // of the first power, see report()
      step_ = dt;
    }
  }

  void report(const State<Spatial>& state, Columns& columns) const override {
    double energy = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      if (part_.counts_here[static_cast<std::size_t>(m)])
        energy += Pointwise::energy(constants(m), record(state, i), record(state, j));
    });
    columns.add("energy_strain", energy);
    // Leapfrog's velocities lag half a step: at t_n the sum has the powers up to n - 3/2, and what
    // is due of the last one makes the balance of second order (summation by parts of the power
    // v_{n+1/2} C (v_{n-1/2} + v_{n+1/2})/2 that the scheme loses between t_n and t_n+1). The same
    // share of the very first power is left out.
    if constexpr (damped) columns.add("energy_damping", lost_ + 0.75 * step_ * power_lost_);
  }

  void remember(Memory& checkpoint) override {
    if constexpr (damped) {
      checkpoint.share("energy_damping", lost_);
      checkpoint.common("step", step_);
    }
  }

  std::int64_t folded(const State<Spatial>& state) const override {
    std::int64_t count = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      count += Pointwise::is_folded(constants(m), record(state, i), record(state, j));
    });
    return count;
  }

  std::vector<BeamSection> sections(const State<Spatial>& state) const override {
    std::vector<BeamSection> all;
    all.reserve(part_.beams.bodies.size());
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      all.push_back(Pointwise::section(constants(m), record(state, i), record(state, j)));
    });
    return all;
  }

 private:
  void set(std::int32_t m, const BeamOptions& options) {
    const auto k = static_cast<std::size_t>(m);
    BeamBlock& block = blocks_[k / lanes];
    const BeamConstants<double> c = Pointwise::make(part_, m, options.shear);
    block.set(k % lanes, c);
    const auto [i, j] = part_.beams.bodies[k];
    block.i[k % lanes] = i;
    block.j[k % lanes] = j;
    for (const std::int32_t body : {i, j})
      stiffness_[static_cast<std::size_t>(body)] += std::max({c.kn, c.ksy, c.ksz});
    if constexpr (damped) {
      const BeamStiffness d =
          beam_damping(part_, m, {c.kn, c.ksz, c.ksy, c.kt, c.kby, c.kbz}, options);
      const std::array<double, 6> all{d.kn, d.ksz, d.ksy, d.kt, d.kby, d.kbz};
      for (std::size_t s = 0; s < 6; ++s) dashpots_[k / lanes].values[s][k % lanes] = all[s];
      dashpots_[k / lanes].counts[k % lanes] = part_.counts_here[k] ? 1.0 : 0.0;
    }
  }
  BeamConstants<double> constants(std::int32_t m) const {
    return blocks_[static_cast<std::size_t>(m) / lanes].get(static_cast<std::size_t>(m) % lanes);
  }
  static const double* record(const State<Spatial>& state, std::int32_t body) {
    return state.record(static_cast<std::size_t>(body));
  }
  void for_each(auto&& visit) const {
    for (std::int32_t m = 0; m < part_.beams.size(); ++m) {
      const auto [i, j] = part_.beams.bodies[static_cast<std::size_t>(m)];
      visit(m, i, j);
    }
  }

  const Part& part_;
  std::vector<BeamBlock> blocks_;
  std::vector<DashpotBlock> dashpots_;
  std::vector<double> stiffness_;
  mutable double power_lost_ = 0;  ///< in the last evaluation [W]; a by-product, no history
  double lost_ = 0;                ///< [J]
  double step_ = 0;                ///< the last one [s]
};

template <Kinematics kinematics>
std::unique_ptr<BeamForce<Spatial>> make_spatial(const Part& part, const BeamOptions& options) {
  if (options.damping_ratio > 0)
    return std::make_unique<SpatialBeams<kinematics, true>>(part, options);
  return std::make_unique<SpatialBeams<kinematics, false>>(part, options);
}

/// Moment of inertia at rest of a local body about a world axis.
double inertia_about(const Part& part, std::int32_t body, const Vec3<double>& axis) {
  const auto b = static_cast<std::size_t>(body);
  const auto [w, x, y, z] = part.bodies.orientation[b];
  const Vec3<double> a = triad(Quat<double>{w, x, y, z}).to_local(axis);
  const Point3& inertia = part.bodies.inertia[b];
  return inertia[0] * a.x * a.x + inertia[1] * a.y * a.y + inertia[2] * a.z * a.z;
}

}  // namespace

BeamStiffness beam_stiffness(const Beams& beams, std::int32_t m, Shear shear) {
  const auto k = static_cast<std::size_t>(m);
  const double e = beams.young[k], l = beams.length[k], iy = beams.inertia_y[k],
               iz = beams.inertia_z[k];
  const double ga = beams.shear_modulus[k] * beams.area[k] / l, factor_z = beams.shear_factor[k],
               factor_y = beams.shear_factor_y.empty() ? factor_z : beams.shear_factor_y[k];
  // 12 E I/(l^3 (1 + Phi)) with Phi = 12 E I/(kappa G A l^2): bending and shear in series.
  const auto transverse = [&](double inertia, double factor) {
    const double bending = 12.0 * e * inertia / (l * l * l), one_point = factor * ga;
    if (shear == Shear::one_point) return one_point;
    if (shear == Shear::none) return bending;
    return bending * one_point / (bending + one_point);
  };
  return {e * beams.area[k] / l,
          transverse(iz, factor_y),
          transverse(iy, factor_z),
          beams.shear_modulus[k] * beams.torsion[k] / l,
          e * iy / l,
          e * iz / l};
}

BeamStiffness beam_damping(const Part& part, std::int32_t m, const BeamStiffness& k,
                           const BeamOptions& options) {
  const auto [i, j] = part.beams.bodies[static_cast<std::size_t>(m)];
  const auto harmonic = [](double a, double b) { return 2.0 * a * b / (a + b); };
  const auto dashpot = [&](double inertia, double stiffness) {
    return 2.0 * options.damping_ratio * std::sqrt(inertia * stiffness);
  };
  const double mass = harmonic(part.bodies.mass[static_cast<std::size_t>(i)],
                               part.bodies.mass[static_cast<std::size_t>(j)]);
  const Triad<double> t = beam_triad(part, m);
  const auto turning = [&](const Vec3<double>& axis) {
    return harmonic(inertia_about(part, i, axis), inertia_about(part, j, axis));
  };
  if (options.damping_modes == DampingModes::axial) return {dashpot(mass, k.kn), 0, 0, 0, 0, 0};
  return {dashpot(mass, k.kn),           dashpot(mass, k.ksz),
          dashpot(mass, k.ksy),          dashpot(turning(t.e1), k.kt),
          dashpot(turning(t.e2), k.kby), dashpot(turning(t.e3), k.kbz)};
}

template <class Space>
std::unique_ptr<BeamForce<Space>> make_beam_force(const Part& part, const BeamOptions& options) {
  if (options.kinematics == Kinematics::linear)
    return make_spatial<Kinematics::linear>(part, options);
  return make_spatial<Kinematics::corotational>(part, options);
}

template std::unique_ptr<BeamForce<Spatial>> make_beam_force<Spatial>(const Part&,
                                                                      const BeamOptions&);

}  // namespace floe
