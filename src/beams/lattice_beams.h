/// \file
/// The force of the beams of a part, computed in blocks of lanes.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "base/simd.h"
#include "beams/beam_force.h"
#include "floe/base/item.h"

namespace floe {

/// Loops over the beams of a part. Space, kinematics, frames and damping are template parameters,
/// so the loops do not branch on them.
/// \tparam Beam    SpatialLanes or PlanarLanes: one beam on body records, and in lanes
/// \tparam damped  beams have dashpots
template <class Beam, bool damped>
class LatticeBeams : public BeamForce<typename Beam::Space>,
                     public HasTangent<typename Beam::Space>,
                     public Damps<typename Beam::Space>,
                     public DoesWork<typename Beam::Space>,
                     public LimitsStep<typename Beam::Space>,
                     public BearsLoad<typename Beam::Space>,
                     public OnDevice {
 public:
  using Pointwise = Beam;
  using Space = typename Beam::Space;
  using Block = typename Beam::Block;
  using DashpotBlock = typename Beam::DashpotBlock;
  using Constants = typename Beam::Constants;
  using Dashpots = typename Beam::Dashpots;

  LatticeBeams(const Part& part, const BeamOptions& options)
      : part_(part),
        blocks_((part.beams.bodies.size() + lanes - 1) / lanes, Block{}),
        dashpots_(damped ? blocks_.size() : 0, DashpotBlock{}),
        stiffness_(static_cast<std::size_t>(part.local)) {
    // Beams without stiffness, on body 0, fill up the last block.
    for (std::size_t m = part.beams.bodies.size(); m < blocks_.size() * lanes; ++m)
      blocks_[m / lanes].set(m % lanes, Beam::none());
    for (std::int32_t m = 0; m < part.beams.size(); ++m) {
      set(m, options);
      const Constants c = constants(m);
      for (const std::int32_t body : item(part.beams.bodies, m))
        item(stiffness_, body) += std::max(c.kn, Beam::shear_stiffness(c));
    }
  }

  std::string_view name() const override { return "beam"; }
  Roles<Space> roles() override {
    Roles<Space> roles{.tangent = this, .step = this};
    if constexpr (damped) roles.damping = this, roles.work = this;
    roles.load = this;
    if (std::is_same_v<Space, Spatial> && !Beam::Kernel::is_linear) roles.device = this;
    return roles;
  }

  void describe(DeviceModel& model) override {
    if constexpr (std::is_same_v<Space, Spatial>) {
      model.damped = damped;
      model.beam_work = model.next_work;
      for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
        const Constants c = constants(m);
        const AnyFrame<double>& t = c.rest;
        DeviceModel::Beam beam{
            {i, j},
            {t.e1.x, t.e1.y, t.e1.z, t.e2.x, t.e2.y, t.e2.z, t.e3.x, t.e3.y, t.e3.z},
            {},
            c.l0,
            {c.kn, c.ksz, c.ksy, c.kt, c.kby, c.kbz}};
        if constexpr (Beam::Kernel::template is_eccentric<Constants>) {
          const auto &a = c.rest.offset_i, &b = c.rest.offset_j;
          beam.offsets = {a.x, a.y, a.z, b.x, b.y, b.z};
        }
        if constexpr (damped) beam.dashpots = dashpots(m);
        model.beams.push_back(beam);
      });
    }
  }

  void add_load(const State<Space>& /*state*/, std::span<double> load) const override {
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      add_load_of(m, i, load);
      add_load_of(m, j, load);
    });
  }

  /// The attribute flatten inlines the whole kernel: between functions lanes would pass through
  /// memory.
  [[gnu::flatten]] void add(const State<Space>& state, Wrenches<Space>& wrenches) override {
    const double* records = state.records.data();
    double* values = wrenches.values.data();
    const bool far = bodies_are_far(state);
    Lanes lost(0.0);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const std::size_t soon = std::min(b + blocks_ahead, blocks_.size() - 1);
      prefetch(blocks_[soon]);
      if constexpr (damped) prefetch(dashpots_[soon]);
      if (far) {
        const std::size_t next = std::min(b + blocks_ahead / 2, blocks_.size() - 1);
        prefetch_bodies(blocks_[next], records, values);
      }
      lost +=
          Beam::template add<damped>(blocks_[b], damped ? &dashpots_[b] : nullptr, records, values);
    }
    if constexpr (damped) power_lost_ = reduce(lost);
  }

  bool add_tangent(const State<Space>& state, Tangent<Space>& tangent) const override {
    typename Tangent<Space>::PairBlock block;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      // The derivative of the dashpots' force, which turns with the beam, is small and not
      // symmetric: only K has it.
      const Dashpots c = damped ? dashpots(m) : Dashpots{};
      const Dashpots* followed = damped && !tangent.symmetric() ? &c : nullptr;
      Beam::tangent(constants(m), followed, record(state, i), record(state, j), tangent.symmetric(),
                    block);
      tangent.add_pair(i, j, block);
    });
    return true;
  }

  void add_damping(const State<Space>& state, Tangent<Space>& tangent) const override {
    if constexpr (damped) {
      typename Tangent<Space>::PairBlock block;
      for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
        Beam::damping(constants(m), dashpots(m), record(state, i), record(state, j), block);
        tangent.add_pair(i, j, block);
      });
    }
  }

  void add_losses(const State<Space>& state, Wrenches<Space>& wrenches) const override {
    if constexpr (damped) {
      for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
        const auto [force, moment_i, moment_j] =
            Beam::damping_force(constants(m), dashpots(m), record(state, i), record(state, j));
        floe::add(wrenches, static_cast<std::size_t>(i), force, -1.0 * moment_i);
        floe::add(wrenches, static_cast<std::size_t>(j), -1.0 * force, -1.0 * moment_j);
      });
    }
  }

  double stiffness_bound(std::int32_t body) const override { return item(stiffness_, body); }

  void powers(std::span<double> out) const override { out.front() = -power_lost_; }
  /// The power comes out of the loop that adds the wrenches. With other velocities it would take
  /// another pass over all beams.
  LaterPowers later_powers() const override { return LaterPowers::never; }

  /// Estimated from the stiffnesses of a beam at its present length, over the mass of its lighter
  /// body: k_n along the beam, and k_s (l0/l)^2 + |N|/l across. Linear beams have none, since their
  /// stiffnesses do not change.
  std::optional<double> rate_estimate(const State<Space>& state) const override {
    if (Beam::Kernel::is_linear) return {};
    double fastest2 = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      const Constants c = constants(m);
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      const Vec3<double> image =
          part_.beams.image.empty() ? Vec3<double>{} : item(part_.beams.image, m);
      const Vec3<double> apart = (part_.bodies.position[b] - part_.bodies.position[a]) +
                                 (displacement(state, b) - displacement(state, a)) + image;
      const double l = std::sqrt(dot(apart, apart)), stretch = c.l0 / l;
      const double across =
          Beam::shear_stiffness(c) * stretch * stretch + std::abs(c.kn * (l - c.l0)) / l;
      fastest2 = std::max(
          fastest2, std::max(c.kn, across) / std::min(part_.bodies.mass[a], part_.bodies.mass[b]));
    });
    return std::sqrt(fastest2);
  }

  void report(const State<Space>& state, std::span<const double> works,
              Columns& columns) const override {
    columns.add("energy_strain", stored(state));
    if constexpr (damped) columns.add("energy_damping", 0.0 - works.front());
  }

  std::int64_t folded(const State<Space>& state) const override {
    std::int64_t count = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      count += Beam::is_folded(constants(m), record(state, i), record(state, j));
    });
    return count;
  }

  std::vector<BeamSection> sections(const State<Space>& state) const override {
    std::vector<BeamSection> all;
    all.reserve(part_.beams.bodies.size());
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      all.push_back(Beam::section(constants(m), record(state, i), record(state, j)));
    });
    return all;
  }

 protected:
  /// Whether a step still computes the beam.
  virtual bool is_whole(std::int32_t /*beam*/) const { return true; }
  /// Adds half of a beam's time to one of its bodies, if this rank owns it. A damped beam of a
  /// breaking sheet took 20 ns (input/ice_slope.yaml before it touches, AVX-512).
  void add_load_of(std::int32_t beam, std::int32_t body, std::span<double> load) const {
    constexpr double ns_of_beam = 20;
    if (body < part_.owned && is_whole(beam)) item(load, body) += 0.5 * ns_of_beam;
  }
  /// Energy of the beams that this rank counts [J].
  virtual double stored(const State<Space>& state) const {
    double energy = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      if (item(part_.counts_here, m))
        energy += Beam::energy(constants(m), record(state, i), record(state, j));
    });
    return energy;
  }

  /// Number of blocks that the loop prefetches ahead. The constants stream through the cache once
  /// per step; a beam costs 15 ns with the prefetch and 17 ns without.
  static constexpr std::size_t blocks_ahead = 4;

  /// Whether the bodies fill more than the caches near a core. Then their records are prefetched as
  /// well (a million bodies: 33 -> 30 ns); else that would only cost.
  static bool bodies_are_far(const State<Space>& state) {
    return state.records.size() * sizeof(double) > std::size_t{16} << 20;
  }
  /// Prefetches the second bodies of a block. Its first bodies were second bodies before.
  static void prefetch_bodies(const Block& block, const double* records, const double* wrenches) {
    for (const std::int32_t j : block.j) {
      const double* r = records + static_cast<std::size_t>(j) * Space::record;
      __builtin_prefetch(r);
      __builtin_prefetch(r + 8);
      __builtin_prefetch(wrenches + static_cast<std::size_t>(j) * Space::wrench, 1);
    }
  }

  /// Enters beam m as it is at rest, undamaged. Bounds of stiffness stay.
  void set(std::int32_t m, const BeamOptions& options) {
    const std::size_t k = slot(m);
    Block& block = blocks_[k / lanes];
    const Constants c = Beam::make(part_, m, options.shear);
    block.set(k % lanes, c);
    const auto [i, j] = item(part_.beams.bodies, m);
    block.i[k % lanes] = i;
    block.j[k % lanes] = j;
    if constexpr (damped) {
      const BeamStiffness springs = beam_stiffness(part_.beams, m, options.shear);
      dashpots_[k / lanes].set(k % lanes, beam_damping(part_, m, springs, options),
                               item(part_.counts_here, m) != 0);
    }
  }
  /// Where beam m lies: in lane slot % lanes of block slot / lanes.
  std::size_t slot(std::int32_t m) const {
    return static_cast<std::size_t>(slots_.empty() ? m : item(slots_, m));
  }
  Constants constants(std::int32_t m) const {
    return blocks_[slot(m) / lanes].get(slot(m) % lanes);
  }
  Dashpots dashpots(std::int32_t m) const {
    return dashpots_[slot(m) / lanes].get(slot(m) % lanes);
  }
  static const double* record(const State<Space>& state, std::int32_t body) {
    return state.record(static_cast<std::size_t>(body));
  }
  void for_each(auto&& visit) const {
    for (std::int32_t m = 0; m < part_.beams.size(); ++m) {
      const auto [i, j] = item(part_.beams.bodies, m);
      visit(m, i, j);
    }
  }

  const Part& part_;
  std::vector<Block> blocks_;
  std::vector<DashpotBlock> dashpots_;
  std::vector<std::int32_t> slots_;  ///< per local beam; empty: beams lie in their order
  std::vector<double> stiffness_;    ///< per local body: bound, summed over its beams [N/m]
  double power_lost_ = 0;            ///< in dashpots, in the last evaluation [W]
};

}  // namespace floe
