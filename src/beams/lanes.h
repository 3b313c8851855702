/// \file
/// Constants of beams in blocks, one beam per lane, and the wrenches of a block: the loop in which
/// explicit steps spend most of their time. Gather and scatter are register transposes. A body
/// sums the wrenches of its beams in the order of the beams, so sums do not depend on lanes, ranks
/// or runs.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/simd.h"
#include "beams/kernel_lanes.h"
#include "floe/lattice/state.h"

namespace floe {

/// Number of doubles in a frame.
template <template <class> class Frame>
inline constexpr std::size_t frame_size = sizeof(Frame<double>) / sizeof(double);

/// Constants, on a scalar, of a beam in lanes with this frame.
template <class C, template <class> class Frame>
using ScalarConstants =
    std::conditional_t<is_eccentric_frame<Frame>, BeamConstants<C, EccentricFrame>,
                       BeamConstants<C, AnyFrame>>;

/// Copies the numbers of a lane from another block.
template <class Values>
void copy_lane(Values& to, std::size_t lane, const Values& from, std::size_t other) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k][lane] = from[k][other];
}

/// Constants of a block of beams, number by number and lane by lane: frame, l0, six stiffnesses.
template <template <class> class Frame>
struct alignas(64) BeamBlock {
  static constexpr std::size_t first = frame_size<Frame>;
  using Scalar = ScalarConstants<double, Frame>;
  std::array<std::array<double, lanes>, first + 7> values;
  std::array<std::int32_t, lanes> i, j;  ///< local bodies

  void set(std::size_t lane, const Scalar& c) {
    std::size_t k = 0;
    const auto put = [&](double value) { values[k++][lane] = value; };
    const AnyFrame<double>& rest = c.rest;
    const auto& [e1, e2, e3] = rest;
    if constexpr (std::is_same_v<Frame<double>, FlatFrame<double>>) {
      for (const double value : {e1.x, e1.y}) put(value);
    } else {
      for (const double value : {e1.x, e1.y, e1.z, e2.x, e2.y, e2.z, e3.x, e3.y, e3.z}) put(value);
    }
    if constexpr (is_eccentric) {
      for (const Vec3<double>& o : {c.rest.offset_i, c.rest.offset_j})
        for (const double value : {o.x, o.y, o.z}) put(value);
    }
    for (const double value : {c.l0, c.kn, c.ksz, c.ksy, c.kt, c.kby, c.kbz}) put(value);
  }
  /// Takes over the beam in lane `other` of another block.
  void take(std::size_t lane, const BeamBlock& from, std::size_t other) {
    copy_lane(values, lane, from.values, other);
    i[lane] = from.i[other];
    j[lane] = from.j[other];
  }
  Scalar get(std::size_t lane) const {
    const auto at = [&](std::size_t k) { return values[k][lane]; };
    if constexpr (is_flat) {
      return with_frame(AnyFrame<double>{{at(0), at(1), 0}, {-at(1), at(0), 0}, {0, 0, 1}}, at);
    } else {
      return with_frame(frame<double>(at), at);
    }
  }
  BeamConstants<Lanes, Frame> get() const {
    const auto at = [&](std::size_t k) { return load(values[k].data()); };
    return with_frame(frame<Lanes>(at), at);
  }

 private:
  static constexpr bool is_flat = std::is_same_v<Frame<double>, FlatFrame<double>>;
  static constexpr bool is_eccentric = is_eccentric_frame<Frame>;

  template <class C>
  static Frame<C> frame(auto at) {
    const auto three = [&](std::size_t k) { return Vec3<C>{at(k), at(k + 1), at(k + 2)}; };
    if constexpr (is_flat) {
      return {at(0), at(1)};
    } else if constexpr (is_eccentric) {
      return {{three(0), three(3), three(6)}, three(9), three(12)};
    } else {
      return {three(0), three(3), three(6)};
    }
  }
  template <class C, template <class> class Any>
  static BeamConstants<C, Any> with_frame(Any<C> frame, auto at) {
    return {frame,         at(first),     at(first + 1), at(first + 2),
            at(first + 3), at(first + 4), at(first + 5), at(first + 6)};
  }
};

/// Dashpots of a block of beams.
struct alignas(64) DashpotBlock {
  std::array<std::array<double, lanes>, 6> values;  ///< on the six strains [N s/m, N m s]
  std::array<double, lanes> counts;  ///< 1 for beams whose energy this rank counts, else 0
  BeamDashpots get(std::size_t lane) const {
    BeamDashpots c{};
    for (std::size_t k = 0; k < 6; ++k) c[k] = values[k][lane];
    return c;
  }
  void set(std::size_t lane, const BeamStiffness& c, bool counts_here) {
    const std::array<double, 6> all{c.kn, c.ksz, c.ksy, c.kt, c.kby, c.kbz};
    for (std::size_t k = 0; k < all.size(); ++k) values[k][lane] = all[k];
    counts[lane] = counts_here ? 1.0 : 0.0;
  }
  void take(std::size_t lane, const DashpotBlock& from, std::size_t other) {
    copy_lane(values, lane, from.values, other);
    counts[lane] = from.counts[other];
  }
};

/// Displacements u, velocities v, spins w and rotations q of bodies, one body per lane.
struct LaneBodies {
  Vec3<Lanes> u, v, w;
  Quat<Lanes> q;
};

/// Loads the records of the given bodies into lanes.
template <bool with_velocity>
[[gnu::always_inline]] inline LaneBodies gather(const double* records,
                                                const std::array<std::int32_t, lanes>& bodies) {
  const auto four = [&](std::size_t offset) __attribute__((always_inline)) {
    return gather_four([&](std::size_t lane) __attribute__((always_inline)) {
      return records + static_cast<std::size_t>(bodies[lane]) * Spatial::record + offset;
    });
  };
  const auto [ux, uy, uz, qw] = four(0);
  const auto [qx, qy, qz, vx] = four(4);
  LaneBodies b;  // what is not asked for stays undefined: zeros would lie in memory
  b.u = {ux, uy, uz};
  b.q = {qw, qx, qy, qz};
  if constexpr (with_velocity) {
    const auto [vy, vz, wx, wy] = four(8);
    const auto last = four(12);
    b.v = {vx, vy, vz};
    b.w = {wx, wy, last[0]};
  }
  return b;
}

/// Subtracts the gradients of a block from the wrenches of its bodies, in the order of the lanes.
/// The last two of the eight doubles of a wrench are padding and stay as they are.
inline void scatter(const std::array<std::int32_t, lanes>& i,
                    const std::array<std::int32_t, lanes>& j, const BeamGradient<Lanes>& g,
                    double* wrenches) {
  const Pairs force(g.force.x, g.force.y), force_i(g.force.z, -g.moment_i.x),
      force_j(g.force.z, g.moment_j.x), moment_i(g.moment_i.y, g.moment_i.z),
      moment_j(g.moment_j.y, g.moment_j.z);
  const auto add = [&]<std::size_t lane>() {
    double* wi = wrenches + static_cast<std::size_t>(i[lane]) * Spatial::wrench;
    add_row(wi, row_of<lane>(force, force_i));
    subtract_pair(wi + 4, pair_of<lane>(moment_i));
    double* wj = wrenches + static_cast<std::size_t>(j[lane]) * Spatial::wrench;
    subtract_row(wj, row_of<lane>(force, force_j));
    subtract_pair(wj + 4, pair_of<lane>(moment_j));
  };
  [&]<std::size_t... lane>(std::index_sequence<lane...>) { (add.template operator()<lane>(), ...); }
  (std::make_index_sequence<lanes>{});
}

/// Power of section forces at the given strain rates [W].
inline Lanes power(const BeamStress<Lanes>& stress, const BeamStress<Lanes>& rate) {
  return stress.n * rate.n + stress.qy * rate.qy + stress.qz * rate.qz + dot(stress.c, rate.c);
}

/// Strength hook of beams that cannot break.
struct Unbreakable {};

/// Adds the wrenches of one block.
/// \param dashpots  null unless damped
/// \param records   of the local bodies, Spatial::record doubles each
/// \param wrenches  of the local bodies, Spatial::wrench doubles each
/// \param strength  hook of beams that may break: if strength.gives_way(forces, strains), the block
///                  goes to strength.add() instead; strength.store() gets the forces of dashpots
/// \returns the power lost in the dashpots of the beams that this rank counts, per lane [W]
template <Kinematics kinematics, bool damped, template <class> class Frame,
          class Strength = Unbreakable>
[[gnu::always_inline]] inline Lanes add_block(const BeamBlock<Frame>& block,
                                              const DashpotBlock* dashpots, const double* records,
                                              double* wrenches,
                                              const Strength& strength = Strength{}) {
  using Kernel = BeamKernel<kinematics>;
  const BeamConstants<Lanes, Frame> beam = block.get();
  const LaneBodies i = gather<damped>(records, block.i), j = gather<damped>(records, block.j);
  const BeamStrains<Lanes> s = Kernel::strains(beam, j.u - i.u, i.q, j.q);
  BeamStress<Lanes> stress = elastic_stress(beam, s);
  if constexpr (!std::is_same_v<Strength, Unbreakable>) {
    if (strength.gives_way(stress, s)) [[unlikely]]
      return strength.add();
  }
  Lanes lost(0.0);
  if constexpr (damped) {
    const BeamStress<Lanes> rate = Kernel::rates(beam, s, j.v - i.v, i.w, j.w);
    const auto dashpot = [&](std::size_t k) { return load(dashpots->values[k].data()); };
    const BeamStress<Lanes> viscous{
        dashpot(0) * rate.n,
        dashpot(1) * rate.qy,
        dashpot(2) * rate.qz,
        {dashpot(3) * rate.c.x, dashpot(4) * rate.c.y, dashpot(5) * rate.c.z}};
    const Lanes counts = load(dashpots->counts.data());
    lost = counts * power(viscous, rate);
    if constexpr (!std::is_same_v<Strength, Unbreakable>) strength.store(viscous, rate, counts);
    stress = {stress.n + viscous.n, stress.qy + viscous.qy, stress.qz + viscous.qz,
              stress.c + viscous.c};
  }
  const BeamGradient<Lanes> g = Kernel::gradient(beam, s, stress);
  scatter(block.i, block.j, g, wrenches);
  return lost;
}

}  // namespace floe
