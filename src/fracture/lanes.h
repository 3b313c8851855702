/// \file
/// Strengths of beams in blocks of lanes. The loop over an intact sheet pays for one test per
/// block; blocks with a beam that gives way, or is damaged, are looked at beam by beam.
#pragma once

#include "beams/lanes.h"
#include "fracture/law.h"

namespace floe {

struct alignas(64) StrengthBlock {
  std::array<std::array<double, lanes>, 5> values;

  void set(std::size_t lane, const Strength<double>& s) {
    const std::array<double, 5> all{s.axial, s.bending_y, s.bending_z, s.shear, s.torsion};
    for (std::size_t k = 0; k < all.size(); ++k) values[k][lane] = all[k];
  }
  Strength<Lanes> get() const {
    const auto at = [&](std::size_t k) { return load(values[k].data()); };
    return {at(0), at(1), at(2), at(3), at(4)};
  }
};

/// s^2 of a block's beams at the given records.
template <Kinematics kinematics, template <class> class Frame>
Lanes block_criterion(const BeamBlock<Frame>& block, const StrengthBlock& strength,
                      const double* records) {
  const LaneBodies i = gather<false>(records, block.i), j = gather<false>(records, block.j);
  const BeamConstants<Lanes, Frame> beam = block.get();
  return criterion(strength.get(), elastic_stress(beam, BeamKernel<kinematics>::strains(
                                                            beam, j.u - i.u, i.q, j.q)));
}

/// What a block's dashpots put on its beams.
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
};

/// The hook of add_block() for beams that may break.
template <class Add>
struct BreakableBlock {
  const StrengthBlock& strength;
  Add add;                               ///< what happens instead; returns the power lost
  const ViscousBlock* before = nullptr;  ///< with dashpots: at the last step's start
  ViscousBlock* now = nullptr;
  Lanes* lost_before = nullptr;  ///< power of those at the present rates, summed up

  void store(const BeamStress<Lanes>& viscous, const BeamStress<Lanes>& rate,
             const Lanes& counts) const {
    *lost_before += counts * power(before->get(), rate);
    now->set(viscous);
  }
  bool gives_way(const BeamStress<Lanes>& elastic) const {
    constexpr double nearly = 1 - 1e-9;
    return any_of(criterion(strength.get(), elastic) > nearly);
  }
};
template <class Add, class... Dashpots>
BreakableBlock(const StrengthBlock&, Add, Dashpots...) -> BreakableBlock<Add>;

/// A copy with the parts of its beams' stiffnesses that damage leaves.
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
