/// \file
/// Constants of beams in blocks, one beam per lane, and the wrenches of a block: the loop that
/// every step of every long run spends its time in. Gather and scatter are register transposes;
/// bodies get their beams' shares in the order of the beams, so sums do not depend on lanes, ranks
/// or runs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "floe/base/simd.h"
#include "floe/lattice/state.h"
#include "forces/beam_kernel.h"

namespace floe {

/// What beams are at rest, number by number, lane by lane.
struct alignas(64) BeamBlock {
  std::array<std::array<double, lanes>, 16> values;  ///< rest triad (9), l0, six stiffnesses
  std::array<std::int32_t, lanes> i, j;              ///< local bodies

  void set(std::size_t lane, const BeamConstants<double>& c) {
    const std::array<double, 16> all{c.rest.e1.x, c.rest.e1.y, c.rest.e1.z, c.rest.e2.x,
                                     c.rest.e2.y, c.rest.e2.z, c.rest.e3.x, c.rest.e3.y,
                                     c.rest.e3.z, c.l0,        c.kn,        c.ksz,
                                     c.ksy,       c.kt,        c.kby,       c.kbz};
    for (std::size_t k = 0; k < all.size(); ++k) values[k][lane] = all[k];
  }
  template <class C, class Read>
  static BeamConstants<C> assemble(Read at) {
    return {{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, {at(6), at(7), at(8)}},
            at(9),
            at(10),
            at(11),
            at(12),
            at(13),
            at(14),
            at(15)};
  }
  BeamConstants<double> get(std::size_t lane) const {
    return assemble<double>([&](std::size_t k) { return values[k][lane]; });
  }
  BeamConstants<Lanes> get() const {
    return assemble<Lanes>([&](std::size_t k) { return load(values[k].data()); });
  }
};

/// Dashpots of a block: on the six strains, and 1 where this rank counts the beam's energy.
struct alignas(64) DashpotBlock {
  std::array<std::array<double, lanes>, 6> values;
  std::array<double, lanes> counts;
};

/// A block's bodies, one per lane.
struct LaneBodies {
  Vec3<Lanes> u, v, w;
  Quat<Lanes> q;
};

template <bool with_velocity>
LaneBodies gather(const double* records, const std::array<std::int32_t, lanes>& bodies) {
  const auto four = [&](std::size_t offset) {
    return gather_four([&](std::size_t lane) {
      return records + static_cast<std::size_t>(bodies[lane]) * Spatial::record + offset;
    });
  };
  const auto [ux, uy, uz, qw] = four(0);
  const auto [qx, qy, qz, vx] = four(4);
  LaneBodies b{{ux, uy, uz}, {}, {}, {qw, qx, qy, qz}};
  if constexpr (with_velocity) {
    const auto [vy, vz, wx, wy] = four(8);
    const auto last = four(12);
    b.v = {vx, vy, vz};
    b.w = {wx, wy, last[0]};
  }
  return b;
}

/// Adds the wrenches of one block; returns the power lost in its dashpots, lane by lane.
template <Kinematics kinematics, bool damped>
[[gnu::always_inline]] inline Lanes add_block(const BeamBlock& block, const DashpotBlock* dashpots,
                                              const double* records, double* wrenches) {
  using Kernel = BeamKernel<kinematics>;
  const BeamConstants<Lanes> beam = block.get();
  const LaneBodies i = gather<damped>(records, block.i), j = gather<damped>(records, block.j);
  const BeamStrains<Lanes> s = Kernel::strains(beam, j.u - i.u, i.q, j.q);
  BeamStress<Lanes> stress = elastic_stress(beam, s);
  Lanes lost(0.0);
  if constexpr (damped) {
    const BeamStress<Lanes> rate = Kernel::rates(beam, s, j.v - i.v, i.w, j.w);
    const auto dashpot = [&](std::size_t k) { return load(dashpots->values[k].data()); };
    const BeamStress<Lanes> viscous{
        dashpot(0) * rate.n,
        dashpot(1) * rate.qy,
        dashpot(2) * rate.qz,
        {dashpot(3) * rate.c.x, dashpot(4) * rate.c.y, dashpot(5) * rate.c.z}};
    lost = load(dashpots->counts.data()) * (viscous.n * rate.n + viscous.qy * rate.qy +
                                            viscous.qz * rate.qz + dot(viscous.c, rate.c));
    stress = {stress.n + viscous.n, stress.qy + viscous.qy, stress.qz + viscous.qz,
              stress.c + viscous.c};
  }
  const BeamGradient<Lanes> g = Kernel::gradient(beam, s, stress);
  const Lanes zero(0.0);
  std::array<detail::Four, lanes> fi, mi, fj, mj;
  scatter_four<Lanes>({g.force.x, g.force.y, g.force.z, -g.moment_i.x}, fi);
  scatter_four<Lanes>({-g.moment_i.y, -g.moment_i.z, zero, zero}, mi);
  scatter_four<Lanes>({-g.force.x, -g.force.y, -g.force.z, -g.moment_j.x}, fj);
  scatter_four<Lanes>({-g.moment_j.y, -g.moment_j.z, zero, zero}, mj);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    double* wi = wrenches + static_cast<std::size_t>(block.i[lane]) * Spatial::wrench;
    add_four(wi, fi[lane]);
    add_four(wi + 4, mi[lane]);
    double* wj = wrenches + static_cast<std::size_t>(block.j[lane]) * Spatial::wrench;
    add_four(wj, fj[lane]);
    add_four(wj + 4, mj[lane]);
  }
  return lost;
}

}  // namespace floe
