/// \file
/// Tiles: the work of a block of threads of a device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/engine.h"

namespace floe::device {

/// The bodies of all runs in tiles. A tile owns bodies that follow each other, of one run, and
/// computes every beam that touches one of them, as a rank does. So a beam between two tiles is
/// computed in both, and no tile waits for another within a step.
struct Tiles {
  // Per tile, and one more:
  std::vector<std::int32_t> first_body, first_slot;
  std::vector<std::int32_t> run;  ///< per tile
  // Per slot, which is a beam in a tile:
  std::vector<std::int32_t> beam;  ///< among those of all runs
  std::vector<std::int32_t> i, j;  ///< its bodies, among those of all runs
  // Per body, and one more: where its ends begin. An end is 2 slot (in the tile) + 0 or 1, in the
  // order of the beams.
  std::vector<std::int32_t> first_end, ends;
  std::int32_t most_slots = 0, most_bodies = 0;
};

/// \param most_bodies  of a tile
/// \param most_slots   of a tile, unless a single body has more beams
Tiles make_tiles(std::span<const Lattice> lattices, std::int32_t most_bodies,
                 std::int32_t most_slots);

}  // namespace floe::device
