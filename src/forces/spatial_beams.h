/// \file
/// The beams of a part in blocks of lanes, as a force.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "forces/beam_blocks.h"
#include "forces/beam_spatial.h"

namespace floe {

/// Whether the triads of a part's beams all have their third axis along z, to rounding. Collective:
/// forces must not depend on how bodies are shared.
inline bool is_flat(const Part& part) {
  constexpr double rounding = 4e-16;
  int flat = 1;
  for (std::int32_t m = 0; m < part.beams.size() && flat == 1; ++m) {
    const auto [e1, e2, e3] = beam_triad(part, m);
    flat = e1.z == 0 && std::abs(e2.z) <= rounding && std::abs(e2.x + e1.y) <= rounding &&
           std::abs(e2.y - e1.x) <= rounding;
  }
  MPI_Allreduce(MPI_IN_PLACE, &flat, 1, MPI_INT, MPI_MIN, part.comm);
  return flat == 1;
}

/// Loops over the beams of a part; kinematics, damping and frames are chosen outside them.
template <Kinematics kinematics, bool damped, template <class> class Frame>
class SpatialBeams : public BeamForce<Spatial> {
 public:
  using Pointwise = SpatialBeam<kinematics>;

  SpatialBeams(const Part& part, const BeamOptions& options)
      : part_(part),
        blocks_((part.beams.bodies.size() + lanes - 1) / lanes, BeamBlock<Frame>{}),
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
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const std::size_t soon = std::min(b + blocks_ahead, blocks_.size() - 1);
      prefetch(blocks_[soon]);
      if constexpr (damped) prefetch(dashpots_[soon]);
      lost += add_block<kinematics, damped>(blocks_[b], damped ? &dashpots_[b] : nullptr, records,
                                            values);
    }
    if constexpr (damped) power_lost_ = reduce(lost);
  }

  bool add_tangent(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    Tangent<Spatial>::PairBlock block;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      // Without symmetry the dashpots' force is followed as the beam turns, which is little.
      const BeamDashpots c = damped ? dashpots(m) : BeamDashpots{};
      const BeamDashpots* followed = damped && !tangent.symmetric() ? &c : nullptr;
      Pointwise::tangent(constants(m), followed, record(state, i), record(state, j),
                         tangent.symmetric(), block);
      tangent.add_pair(i, j, block);
    });
    return true;
  }

  void add_damping(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    if constexpr (damped) {
      Tangent<Spatial>::PairBlock block;
      for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
        Pointwise::damping(constants(m), dashpots(m), record(state, i), record(state, j), block);
        tangent.add_pair(i, j, block);
      });
    }
  }

  bool add_losses(const State<Spatial>& state, Wrenches<Spatial>& wrenches) const override {
    if constexpr (damped) {
      for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
        const BeamGradient<double> g =
            Pointwise::damping_force(constants(m), dashpots(m), record(state, i), record(state, j));
        const auto put = [&](std::int32_t body, double sign, const Vec3<double>& moment) {
          double* w = wrenches.of(static_cast<std::size_t>(body));
          w[0] += sign * g.force.x, w[1] += sign * g.force.y, w[2] += sign * g.force.z;
          w[3] -= moment.x, w[4] -= moment.y, w[5] -= moment.z;
        };
        put(i, 1, g.moment_i);
        put(j, -1, g.moment_j);
      });
    }
    return damped;
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

  double power(const State<Spatial>&) const override { return -power_lost_; }
  void take_work(double work) override { lost_ -= work; }

  /// Of the stiffnesses that change with a beam's length, against the lighter of its bodies: k_n,
  /// and k_s (l0/l)^2 + |N|/l across.
  std::optional<double> fastest_rate(const State<Spatial>& state) const override {
    if (kinematics == Kinematics::linear) return {};
    double fastest2 = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      const auto c = constants(m);
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      const Point3 &from = part_.bodies.position[a], &to = part_.bodies.position[b];
      const Vec3<double> chord = Vec3<double>{to[0] - from[0], to[1] - from[1], to[2] - from[2]} +
                                 (displacement(state, b) - displacement(state, a));
      const double l = std::sqrt(dot(chord, chord)), stretch = c.l0 / l;
      const double across =
          std::max(c.ksy, c.ksz) * stretch * stretch + std::abs(c.kn * (l - c.l0)) / l;
      fastest2 = std::max(
          fastest2, std::max(c.kn, across) / std::min(part_.bodies.mass[a], part_.bodies.mass[b]));
    });
    return std::sqrt(fastest2);
  }

  void report(const State<Spatial>& state, Columns& columns) const override {
    columns.add("energy_strain", stored(state));
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

 protected:
  /// Energy of the beams that this rank counts [J].
  virtual double stored(const State<Spatial>& state) const {
    double energy = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      if (part_.counts_here[static_cast<std::size_t>(m)])
        energy += Pointwise::energy(constants(m), record(state, i), record(state, j));
    });
    return energy;
  }

  /// Constants stream through once per step; fetched this far ahead they cost 15 ns per beam and
  /// not 17.
  static constexpr std::size_t blocks_ahead = 4;

  void set(std::int32_t m, const BeamOptions& options) {
    const auto k = static_cast<std::size_t>(m);
    BeamBlock<Frame>& block = blocks_[k / lanes];
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
  BeamDashpots dashpots(std::int32_t m) const {
    return dashpots_[static_cast<std::size_t>(m) / lanes].get(static_cast<std::size_t>(m) % lanes);
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
  std::vector<BeamBlock<Frame>> blocks_;
  std::vector<DashpotBlock> dashpots_;
  std::vector<double> stiffness_;
  mutable double power_lost_ = 0;  ///< in the last evaluation [W]; a by-product, no history
  double lost_ = 0;                ///< [J]
  double step_ = 0;                ///< the last one [s]
};

}  // namespace floe
