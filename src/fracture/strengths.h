/// \file
/// Strengths of the beams of a part.
#pragma once

#include <vector>

#include "fracture/fracture.h"
#include "fracture/law.h"

namespace floe {

/// Strengths of the local beams of a part, with Weibull's scatter. Collective.
/// \throws InputError if the lattice does not give the sides of the sections
std::vector<Strength<double>> strengths(const Part& part, const FractureOptions& options);

/// Whether the criterion of beams needs FurtherStrength.
Criterion needed_criterion(const FractureOptions& options);
/// FurtherStrength of all beams but those at tips.
FurtherStrength<double> further_strength(const FractureOptions& options);

/// Strength of a local beam at a crack's tip: sigma_m = sqrt(2 E G_f/(2.45 l0)) of its elongation
/// and bending in the plane, sigma_b = sqrt(6 E G_f/(4 l0)) of bending out of the plane, shear and
/// torsion (model.md, "Fracture").
Strength<double> tip_strength(const Part& part, std::int32_t beam, const FractureOptions& options);

}  // namespace floe
