/// \file
/// Strengths of the beams of a part.
#pragma once

#include <vector>

#include "beams/beam_force.h"
#include "floe/fracture/fracture_options.h"
#include "fracture_laws/law.h"

namespace floe {

/// Strengths of the local beams of a part, with Weibull's scatter. Collective.
/// \throws InputError if the lattice does not give the sides of the sections
std::vector<Strength<double>> strengths(const Part& part, const FractureOptions& options);

/// Whether the criterion of beams needs FurtherStrength.
Criterion needed_criterion(const FractureOptions& options);
/// FurtherStrength of all beams but those at tips.
FurtherStrength<double> further_strength(const FractureOptions& options);

/// Largest s of the beams of all ranks under given section forces, undamaged and without scatter of
/// strengths. Collective.
/// \param sections  one per local beam
double overload(const Part& part, const std::vector<BeamSection>& sections,
                FractureOptions fracture);

/// Weibull factor of the strengths of a beam: (A_ref/A)^(1/m) (-ln U)^(1/m)/Gamma(1 + 1/m), with U
/// uniform in (0, 1) from the seed and the beam.
/// \param beam        global index
/// \param modulus     m
/// \param area_ratio  A/A_ref
double weibull_factor(std::uint64_t seed, std::int32_t beam, double modulus, double area_ratio);

/// Strength of a local beam at a crack's tip: sigma_m = sqrt(2 E G_f/(2.45 l0)) of its elongation
/// and bending in the plane, sigma_b = sqrt(6 E G_f/(4 l0)) of bending out of the plane, shear and
/// torsion (model.md, "Fracture").
Strength<double> tip_strength(const Part& part, std::int32_t beam, const FractureOptions& options);

}  // namespace floe
