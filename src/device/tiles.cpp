#include "device/tiles.h"

#include <algorithm>

#include "floe/base/item.h"

namespace floe::device {

Tiles make_tiles(std::span<const Lattice> lattices, std::int32_t most_bodies,
                 std::int32_t most_slots) {
  Tiles tiles;
  tiles.first_body = {0};
  tiles.first_slot = {0};
  tiles.first_end = {0};
  std::int32_t bodies_before = 0, beams_before = 0;
  for (std::size_t r = 0; r < lattices.size(); ++r) {
    const Lattice& lattice = lattices[r];
    std::vector<std::vector<std::int32_t>> beams_of(static_cast<std::size_t>(lattice.bodies));
    const auto beams = static_cast<std::int32_t>(lattice.ends.size());
    for (std::int32_t m = 0; m < beams; ++m) {
      for (const std::int32_t body : item(lattice.ends, m)) item(beams_of, body).push_back(m);
    }
    std::vector<std::int32_t> slot_of(lattice.ends.size(), -1);  // in the tile that is being filled
    std::vector<std::int32_t> in_tile;
    const auto begin = [&](std::int32_t first) { return bodies_before + first; };
    for (std::int32_t first = 0, next = 0; first < lattice.bodies; first = next) {
      // As many bodies as there is room for.
      in_tile.clear();
      for (; next < lattice.bodies && next - first < most_bodies; ++next) {
        const std::size_t had = in_tile.size();
        for (const std::int32_t m : item(beams_of, next)) {
          if (item(slot_of, m) >= 0) continue;
          item(slot_of, m) = 0;
          in_tile.push_back(m);
        }
        if (next == first || static_cast<std::int32_t>(in_tile.size()) <= most_slots) continue;
        for (std::size_t k = had; k < in_tile.size(); ++k) item(slot_of, in_tile[k]) = -1;
        in_tile.resize(had);
        break;
      }
      std::sort(in_tile.begin(), in_tile.end());
      for (std::size_t k = 0; k < in_tile.size(); ++k) {
        const std::int32_t m = in_tile[k];
        item(slot_of, m) = static_cast<std::int32_t>(k);
        tiles.beam.push_back(beams_before + m);
        tiles.i.push_back(begin(item(lattice.ends, m)[0]));
        tiles.j.push_back(begin(item(lattice.ends, m)[1]));
      }
      for (std::int32_t b = first; b < next; ++b) {
        for (const std::int32_t m : item(beams_of, b))
          tiles.ends.push_back(2 * item(slot_of, m) + (item(lattice.ends, m)[0] == b ? 0 : 1));
        tiles.first_end.push_back(static_cast<std::int32_t>(tiles.ends.size()));
      }
      for (const std::int32_t m : in_tile) item(slot_of, m) = -1;
      tiles.first_body.push_back(begin(next));
      tiles.first_slot.push_back(static_cast<std::int32_t>(tiles.beam.size()));
      tiles.run.push_back(static_cast<std::int32_t>(r));
      tiles.most_slots = std::max(tiles.most_slots, static_cast<std::int32_t>(in_tile.size()));
      tiles.most_bodies = std::max(tiles.most_bodies, next - first);
    }
    bodies_before += lattice.bodies;
    beams_before += beams;
  }
  return tiles;
}

}  // namespace floe::device
