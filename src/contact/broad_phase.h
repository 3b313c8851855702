/// \file
/// Which bodies are near each other: a uniform grid of cells, filled by sorting.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "floe/base/rotation.h"

namespace floe {

using BodyPair = std::array<std::int32_t, 2>;  ///< the smaller index first

/// Pairs of spheres whose surfaces are no farther apart than `reach`, unsorted, of those where
/// `wanted` is set for one at least. \param centres, radii  of all; a radius < 0 leaves one out
void near_pairs(std::span<const Vec3<double>> centres, std::span<const double> radii, double reach,
                std::span<const std::uint8_t> wanted, std::vector<BodyPair>& pairs);

}  // namespace floe
