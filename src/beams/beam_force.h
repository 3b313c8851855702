/// \file
/// The beams of a lattice as a force (model.md, "Beam"). The energy and the gradient of one beam
/// are in src/beams/kernel.h.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "beams/stiffness.h"
#include "floe/beams/beam_options.h"
#include "forces/force.h"

namespace floe {

/// Stiffnesses of beam m of `beams`.
BeamStiffness beam_stiffness(const Beams& beams, std::int32_t m, Shear shear);

/// Triad of beam m at rest, in world axes.
Triad<double> beam_triad(const Bodies& bodies, const Beams& beams, std::int32_t m);
/// Whether axis 3 of beam m at rest is z, to rounding.
bool is_flat(const Bodies& bodies, const Beams& beams, std::int32_t m);

/// Dashpots of beam m on the six strains [N s/m, N m s], c = 2 zeta sqrt(m_s k_s). For Delta and
/// the shears m_s is the harmonic mean of the masses of the two bodies, for the rotations that of
/// their moments of inertia at rest about axes 1, 2, 3 of the beam (model.md, "Explicit dynamics").
/// The harmonic mean keeps the stable step at large mass ratios.
/// \param stiffness  of the beam
BeamStiffness beam_damping(const Part& part, std::int32_t m, const BeamStiffness& stiffness,
                           const BeamOptions& options);

/// A beam is folded if the cosine of the angle from its mean triad to its chord is not above this.
inline constexpr double folded_cosine = 0.2;

/// Section forces at the middle of a beam: N, Q_2, Q_3 [N] and T, M_2, M_3 [N m], in its mean
/// triad.
using BeamSection = std::array<double, 6>;

/// The beams of a part as a force. With dashpots (damping_ratio > 0) the wrenches depend on
/// velocities too, and the force does work.
template <class Space>
class BeamForce : public Force<Space> {
 public:
  /// Section forces per local beam of the part, without those of dashpots.
  virtual std::vector<BeamSection> sections(const State<Space>& state) const = 0;
  /// Number of this rank's beams whose chord stands across their ends, more than 78 degrees from
  /// the mean triad. There the energy has equilibria that real beams do not have; steps that are
  /// too large lead to them.
  virtual std::int64_t folded(const State<Space>& state) const = 0;
};

/// Makes the force of the beams of a part. Collective.
/// \param part  must outlive the force
template <class Space>
std::unique_ptr<BeamForce<Space>> make_beam_force(const Part& part, const BeamOptions& options);

}  // namespace floe
