/// \file
/// Strengths of beams in blocks of lanes. The loop over an intact sheet costs one test more per
/// block; only blocks with a damaged beam, or one near its strength, are treated beam by beam.
#pragma once

#include <algorithm>
#include <array>

#include "base/simd.h"
#include "beams/lanes.h"
#include "fracture_laws/law.h"

namespace floe {

inline void drop_tension_where_pressed(const Lanes& stretch, Criteria<Lanes>& s2) {
  where(stretch < 0.0, s2.tension) = 0.0;
}

/// Strengths of a block of beams, number by number and lane by lane.
struct alignas(64) StrengthBlock {
  std::array<std::array<double, lanes>, 5> values;

  void set(std::size_t lane, const Strength<double>& s) {
    const std::array<double, 5> all{s.axial, s.bending_y, s.bending_z, s.shear, s.torsion};
    for (std::size_t k = 0; k < all.size(); ++k) values[k][lane] = all[k];
  }
  void take(std::size_t lane, const StrengthBlock& from, std::size_t other) {
    copy_lane(values, lane, from.values, other);
  }
  Strength<double> get(std::size_t lane) const {
    const auto at = [&](std::size_t k) { return values[k][lane]; };
    return {at(0), at(1), at(2), at(3), at(4)};
  }
  Strength<Lanes> get() const {
    const auto at = [&](std::size_t k) { return load(values[k].data()); };
    return {at(0), at(1), at(2), at(3), at(4)};
  }
};

/// FurtherStrength of a block of beams; of Criterion::general only.
struct alignas(64) FurtherBlock {
  std::array<std::array<double, lanes>, 3> values{};

  void set(std::size_t lane, const FurtherStrength<double>& s) {
    values[0][lane] = s.transverse, values[1][lane] = s.pressure, values[2][lane] = s.friction;
  }
  void take(std::size_t lane, const FurtherBlock& from, std::size_t other) {
    copy_lane(values, lane, from.values, other);
  }
  FurtherStrength<double> get(std::size_t lane) const {
    return {values[0][lane], values[1][lane], values[2][lane]};
  }
  FurtherStrength<Lanes> get() const {
    return {load(values[0].data()), load(values[1].data()), load(values[2].data())};
  }
};

/// s^2 of the beams of a block. \param further  null for Criterion::plain
inline Lanes block_criterion(const StrengthBlock& strength, const FurtherBlock* further,
                             bool crushes, const BeamStress<Lanes>& elastic) {
  if (further == nullptr) return criterion(strength.get(), elastic);
  const Criteria<Lanes> s2 = criteria(strength.get(), further->get(), elastic, crushes);
  return max(s2.tension, s2.pressure);
}

/// The same at the given body records.
template <Kinematics kinematics, template <class> class Frame>
Lanes block_criterion(const BeamBlock<Frame>& block, const StrengthBlock& strength,
                      const FurtherBlock* further, bool crushes, const double* records) {
  const LaneBodies i = gather<false>(records, block.i), j = gather<false>(records, block.j);
  const BeamConstants<Lanes, Frame> beam = block.get();
  return block_criterion(
      strength, further, crushes,
      elastic_stress(beam, BeamKernel<kinematics>::strains(beam, j.u - i.u, i.q, j.q)));
}

/// Section forces of the dashpots of a block [N, N m], in single precision.
struct alignas(64) ViscousBlock {
  std::array<std::array<float, lanes>, 6> values{};

  BeamStress<Lanes> get() const {
    const auto at = [&](std::size_t k) {
      return Lanes(values[k].data(), std::experimental::element_aligned);
    };
    return {at(0), at(1), at(2), {at(3), at(4), at(5)}};
  }
  void set(const BeamStress<Lanes>& s) {
    const std::array<Lanes, 6> all{s.n, s.qy, s.qz, s.c.x, s.c.y, s.c.z};
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k].copy_to(values[k].data(), std::experimental::element_aligned);
  }
  void take(std::size_t lane, const ViscousBlock& from, std::size_t other) {
    copy_lane(values, lane, from.values, other);
  }
};

/// What beams may hold before their strength must be looked at: twice the strain energy [J].
struct alignas(64) LimitBlock {
  std::array<double, lanes> values;
  void take(std::size_t lane, const LimitBlock& from, std::size_t other) {
    values[lane] = from.values[other];
  }
};

/// Bound of s^2 over twice the strain energy [1/J], for beams of these stiffnesses. By Cauchy and
/// Schwarz sigma^2 <= (sum a_k^2 k_k) (sum F_k^2/k_k) with the factors a_k of the forces F_k in
/// sigma and their stiffnesses k_k; so tau^2, with the other forces. The criterion of pressed beams
/// is at most (1 + <-sin phi>)^2 (p^2/4 + tau^2).
/// \param further  null for Criterion::plain
template <class Constants>
double overload_per_energy(const Constants& beam, const Strength<double>& s,
                           const FurtherStrength<double>* further, bool crushes) {
  const double weight = further != nullptr ? further->transverse : 1;
  double sigma2 = s.axial * s.axial * beam.kn + s.bending_y * s.bending_y * beam.kby +
                  s.bending_z * s.bending_z * beam.kbz;
  double tau2 = s.shear * s.shear * std::max(beam.ksz, weight * weight * beam.ksy) +
                s.torsion * s.torsion * beam.kt;
  if (further != nullptr && crushes) {
    const double factor = 1 + std::max(0.0, -further->friction);
    sigma2 *= std::max(1.0, factor * factor * further->pressure * further->pressure);
    tau2 *= factor * factor;
  }
  return std::max(sigma2, tau2);
}

/// The strength hook of add_block() for beams that may break. The last three are null without
/// dashpots.
template <Criterion kind, class Add>
struct BreakableBlock {
  const LimitBlock& limit;
  const StrengthBlock& strength;
  const FurtherBlock* further;  ///< null for Criterion::plain
  bool crushes;                 ///< beams have a compressive strength
  Add add;                      ///< called instead of adding the block; returns the power lost
  const ViscousBlock* before = nullptr;  ///< forces of dashpots at the start of the last step
  ViscousBlock* now = nullptr;           ///< receives the present forces of dashpots
  Lanes* lost_before = nullptr;          ///< sum of the power of `before` at the present rates [W]

  void store(const BeamStress<Lanes>& viscous, const BeamStress<Lanes>& rate,
             const Lanes& counts) const {
    *lost_before += counts * power(before->get(), rate);
    now->set(viscous);
  }
  bool gives_way(const BeamStress<Lanes>& elastic, const BeamStrains<Lanes>& s) const {
    // The strain energy tells of most blocks that they hold, with half the operations and without
    // the strengths.
    const Lanes twice = elastic.n * s.delta + elastic.qy * s.gamma_y + elastic.qz * s.gamma_z +
                        dot(elastic.c, s.psi);
    if (none_of(twice > load(limit.values.data()))) [[likely]]
      return false;
    constexpr double nearly = 1 - 1e-9;
    if constexpr (kind == Criterion::plain) {
      return any_of(criterion(strength.get(), elastic) > nearly);
    } else {
      return any_of(block_criterion(strength, further, crushes, elastic) > nearly);
    }
  }
};

/// Copies of a block and of its dashpots, with the values multiplied by the factors of damage.
template <template <class> class Frame>
BeamBlock<Frame> softened(const BeamBlock<Frame>& block, const std::array<Softening, lanes>& left) {
  BeamBlock<Frame> soft = block;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    soft.values[BeamBlock<Frame>::first + 1][lane] *= left[lane].axial;
    for (std::size_t k = 2; k < 7; ++k)
      soft.values[BeamBlock<Frame>::first + k][lane] *= left[lane].rest;
  }
  return soft;
}
inline DashpotBlock softened(const DashpotBlock& dashpots,
                             const std::array<Softening, lanes>& left) {
  DashpotBlock soft = dashpots;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    soft.values[0][lane] *= left[lane].axial;
    for (std::size_t k = 1; k < 6; ++k) soft.values[k][lane] *= left[lane].rest;
  }
  return soft;
}

}  // namespace floe
