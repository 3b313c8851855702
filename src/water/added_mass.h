/// \file
/// Water that bodies take along, by direction (model.md, "Water").
#pragma once

#include <array>
#include <vector>

#include "lattice/partition.h"

namespace floe {

/// Added masses along the principal axes of a body [kg] and added moments about them [kg m^2].
struct AddedAlongAxes {
  Vec3<double> mass, moment;
};

/// Parts of the mass of the water that each owned body displaces at rest, and of the moments of
/// inertia of that water, taken as the body's own times displaced mass over mass.
/// \param parts    of the mass along axes 1, 2, 3, then of the moments about them
/// \param density  of the water [kg/m^3]
/// \throws InputError if the lattice has no shapes
std::vector<AddedAlongAxes> added_by_parts(const Part& part, double density,
                                           const std::array<double, 6>& parts);

/// Each owned body as a thin disc of its plan area that floats on the water, alone: half of the
/// added mass 8/3 rho a^3 along the axis and of the moment 16/45 rho a^5 about a diameter of a disc
/// of radius a in unbounded water (Lamb 1932, Hydrodynamics, chapter V; Newman 1977, Marine
/// Hydrodynamics, chapter 4; half at the surface: Korotkin 2009, Added Masses of Ship Structures,
/// chapter 5), for motions that are fast against waves of the disc's size. The disc's axis is the
/// principal axis that is nearest to z at rest. \throws InputError as above
std::vector<AddedAlongAxes> added_of_plates(const Part& part, double density);

}  // namespace floe
