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

}  // namespace floe
