/// \file
/// The lattice's beams (model.md section 2). The pointwise energy and gradient are in
/// src/beams/kernel.h.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "beams/stiffness.h"
#include "floe/beams/beam_options.h"
#include "forces/force.h"

namespace floe {

/// Stiffness of beam m of `beams` (model.md section 2).
BeamStiffness beam_stiffness(const Beams& beams, std::int32_t m, Shear shear);

/// The triad of beam m at rest.
Triad<double> beam_triad(const Bodies& bodies, const Beams& beams, std::int32_t m);
/// Whether its third axis is z, to rounding.
bool is_flat(const Bodies& bodies, const Beams& beams, std::int32_t m);

/// Dashpots of beam m on the six strains, c = 2 zeta sqrt(m_s k_s): m_s is the harmonic mean of the
/// two bodies' masses for Delta and the shears, of their moments of inertia at rest about the
/// beam's axis 1, 2, 3 for the rotations (model.md section 8; the harmonic mean keeps the stable
/// step at large mass ratios).
BeamStiffness beam_damping(const Part& part, std::int32_t m, const BeamStiffness& stiffness,
                           const BeamOptions& options);

/// A beam is folded where the cosine of the angle from its mean triad to its chord is less.
inline constexpr double folded_cosine = 0.2;

/// What a beam carries at its middle: N, Q_2, Q_3 [N] and T, M_2, M_3 [N m], in its mean triad.
using BeamSection = std::array<double, 6>;

/// The beams as a force; knows what each beam carries.
/// Beams with dashpots (damping_ratio > 0) read velocities too; the power they lost in the last
/// evaluation is taken over by commit().
template <class Space>
class BeamForce : public Force<Space> {
 public:
  /// Per local beam of the part.
  virtual std::vector<BeamSection> sections(const State<Space>& state) const = 0;
  /// Number of this rank's beams whose chord stands across their ends (more than 78 degrees from
  /// the mean triad): there the energy has equilibria that no beam has, reached by steps that are
  /// too large.
  virtual std::int64_t folded(const State<Space>& state) const = 0;
};

/// \param part  must outlive the force
template <class Space>
std::unique_ptr<BeamForce<Space>> make_beam_force(const Part& part, const BeamOptions& options);

}  // namespace floe
