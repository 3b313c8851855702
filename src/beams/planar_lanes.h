/// \file
/// Constants of planar beams in blocks, one beam per lane, and the wrenches of a block: as lanes.h,
/// with half the numbers to gather and to scatter and a third of the arithmetic.
#pragma once

#include <array>
#include <cstdint>

#include "base/simd.h"
#include "beams/planar.h"

namespace floe {

/// Constants of a block of beams, number by number and lane by lane: axes, l0, three stiffnesses.
struct alignas(64) PlanarBlock {
  std::array<std::array<double, lanes>, 6> values;
  std::array<std::int32_t, lanes> i, j;  ///< local bodies

  void set(std::size_t lane, const PlanarConstants<double>& c) {
    const std::array<double, 6> all{c.rest.c, c.rest.s, c.l0, c.kn, c.ks, c.kb};
    for (std::size_t k = 0; k < all.size(); ++k) values[k][lane] = all[k];
  }
  template <class C>
  static PlanarConstants<C> assemble(auto at) {
    return {{at(0), at(1)}, at(2), at(3), at(4), at(5)};
  }
  PlanarConstants<double> get(std::size_t lane) const {
    return assemble<double>([&](std::size_t k) { return values[k][lane]; });
  }
  PlanarConstants<Lanes> get() const {
    return assemble<Lanes>([&](std::size_t k) { return load(values[k].data()); });
  }
};

/// Dashpots of a block of beams.
struct alignas(64) PlanarDashpotBlock {
  std::array<std::array<double, lanes>, 3> values;  ///< on Delta, gamma, psi
  std::array<double, lanes> counts;  ///< 1 for beams whose energy this rank counts, else 0

  void set(std::size_t lane, const BeamStiffness& c, bool counts_here) {
    values[0][lane] = c.kn, values[1][lane] = c.ksz, values[2][lane] = c.kbz;
    counts[lane] = counts_here ? 1.0 : 0.0;
  }
  std::array<double, 3> get(std::size_t lane) const {
    return {values[0][lane], values[1][lane], values[2][lane]};
  }
  std::array<Lanes, 3> get() const {
    return {load(values[0].data()), load(values[1].data()), load(values[2].data())};
  }
};

/// Loads four numbers of the record of each given body, one body per lane.
/// \param offset  of the first number in a record
inline std::array<Lanes, 4> gather_planar(const double* records,
                                          const std::array<std::int32_t, lanes>& bodies,
                                          std::size_t offset) {
  return gather_four([&](std::size_t lane) {
    return records + static_cast<std::size_t>(bodies[lane]) * Planar::record + offset;
  });
}

/// A planar beam on body records, and in lanes.
template <Kinematics kinematics>
struct PlanarLanes : PlanarBeam<kinematics> {
  using Block = PlanarBlock;
  using DashpotBlock = PlanarDashpotBlock;
  using Kernel = PlanarKernel<kinematics>;

  /// Adds the wrenches of one block.
  /// \param dashpots  null unless damped
  /// \returns the power lost in the dashpots of the beams that this rank counts, per lane [W]
  template <bool damped>
  [[gnu::always_inline]] static Lanes add(const Block& block, const DashpotBlock* dashpots,
                                          const double* records, double* wrenches) {
    const PlanarConstants<Lanes> beam = block.get();
    const auto i = gather_planar(records, block.i, 0), j = gather_planar(records, block.j, 0);
    const PlanarStrains<Lanes> s =
        Kernel::strains(beam, Vec2<Lanes>{j[0] - i[0], j[1] - i[1]}, i[2], j[2]);
    PlanarStress<Lanes> stress = elastic_stress(beam, s);
    Lanes lost(0.0);
    if constexpr (damped) {
      const auto vi = gather_planar(records, block.i, Planar::velocity),
                 vj = gather_planar(records, block.j, Planar::velocity);
      const PlanarStress<Lanes> rate =
          Kernel::rates(beam, s, Vec2<Lanes>{vj[0] - vi[0], vj[1] - vi[1]}, vi[2], vj[2]);
      const PlanarStress<Lanes> viscous = viscous_stress(dashpots->get(), rate);
      lost = load(dashpots->counts.data()) *
             (viscous.n * rate.n + viscous.q * rate.q + viscous.c * rate.c);
      stress = stress + viscous;
    }
    const PlanarGradient<Lanes> g = Kernel::gradient(beam, s, stress);
    const Lanes zero(0.0);
    const Pairs force(g.force.x, g.force.y), on_i(-g.moment_i, zero), on_j(g.moment_j, zero);
    const auto put = [&]<std::size_t lane>() {
      add_row(wrenches + static_cast<std::size_t>(block.i[lane]) * Planar::wrench,
              row_of<lane>(force, on_i));
      subtract_row(wrenches + static_cast<std::size_t>(block.j[lane]) * Planar::wrench,
                   row_of<lane>(force, on_j));
    };
    [&]<std::size_t... lane>(std::index_sequence<lane...>) {
      (put.template operator()<lane>(), ...);
    }
    (std::make_index_sequence<lanes>{});
    return lost;
  }
};

}  // namespace floe
