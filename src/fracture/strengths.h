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
/// FurtherStrength of a beam at a crack's tip: its shear strength along axis 3 is bounded as that
/// in torsion. Under pressure it has the parabola tau^2 = sigma_b^2 + sigma_b p, of the form of
/// Griffith's for closed cracks, and does not crush: its strength at initiation decides on that.
/// \param tip, whole  strengths at the tip, at initiation
FurtherStrength<double> further_at_tip(const Strength<double>& tip, const Strength<double>& whole,
                                       const FurtherStrength<double>& further);

/// Strength of a local beam at a crack's tip: sigma_m = sqrt(2 E G_f/(2.6 l0)) of its elongation
/// and bending in the plane, sigma_b = sqrt(6 E G_f/(4 l0)) of bending out of the plane, shear and
/// torsion, none above that of its initiation (model.md, "Fracture"). \param whole  at initiation
Strength<double> tip_strength(const Part& part, std::int32_t beam, const FractureOptions& options,
                              const Strength<double>& whole);

}  // namespace floe
