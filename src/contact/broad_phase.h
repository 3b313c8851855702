/// \file
/// The broad phase: pairs of neighbouring bodies, by a uniform grid of cells that is filled by
/// sorting.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/pair.h"
#include "floe/geometry/periods.h"

namespace floe {

/// Finds the pairs of spheres whose surfaces are no farther apart than `reach`.
/// \param centres     of all spheres [m]
/// \param radii       of all spheres [m]; one with a radius < 0 is left out
/// \param reach       [m]
/// \param wanted      per sphere; a pair needs one sphere at least with a value other than 0
/// \param[out] pairs  unsorted, the smaller index first
/// \param periods     the nearest images of two spheres count
void near_pairs(std::span<const Vec3<double>> centres, std::span<const double> radii, double reach,
                std::span<const std::uint8_t> wanted, std::vector<BodyPair>& pairs,
                const Periods& periods = {});

}  // namespace floe
