/// \file
/// Pairs of a body A with a body or an obstacle B.
///
/// Notation: of two bodies A is the one with the smaller global index. Obstacles consist of convex
/// parts; part k of all parts of all obstacles has the index -1 - k, so B is a part of an obstacle
/// where its index is below 0. A is a part of an obstacle in pairs of two obstacles; a body carries
/// the obstacle of A then.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "floe/base/rotation.h"

namespace floe {

using BodyPair = std::array<std::int32_t, 2>;  ///< indices of A and B

/// Whether an index is that of a part of an obstacle.
constexpr bool is_obstacle(std::int32_t index) { return index < 0; }
/// Returns the number k of the part with an index.
constexpr std::size_t part_number(std::int32_t index) {
  return static_cast<std::size_t>(-1 - index);
}
/// Returns the index of part k.
constexpr std::int32_t part_index(std::size_t k) { return -1 - static_cast<std::int32_t>(k); }

/// A pair of the list. Every step looks at all of them, so they are small.
struct Pair {
  std::int32_t a = 0, b = 0;  ///< global bodies; below 0: part -1 - index of obstacles
  /// slots of the bodies, of that which carries an obstacle too; -1 for an obstacle on its own
  std::int32_t slot_a = -1, slot_b = -1;
  bool counted : 1 = false;         ///< this rank owns A, and so counts the pair's energies
  bool newly_eligible : 1 = false;  ///< the first overlap of the pair counts as stress-free
  bool broken : 1 = false;          ///< a beam between A and B broke: they have new faces
  bool offloaded : 1 = false;       ///< another rank computes the overlap of the pair
  bool one_of_several : 1 = false;  ///< A or B is one of several parts, or both are obstacles
  bool met : 1 = false;             ///< of these: it overlapped in the last evaluation
  std::int16_t face = -1;  ///< of the last gap: number of a plane of B, then of A; -1: axis
  std::int32_t cuts = -1;  ///< place of the record of its cuts (NarrowPhase); -1: none
  Vec3<double> axis{};     ///< of the last gap that no face had, a unit vector from B to A
  double safe = 0;         ///< the pair has a gap while the travels of A and B add up to less [m]
};
static_assert(sizeof(Pair) == 56);

}  // namespace floe
