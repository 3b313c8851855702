#include "lattice/pieces.h"

#include "base/union_find.h"

namespace floe {

std::vector<std::int32_t> connected_pieces(const Lattice& lattice,
                                           const std::vector<std::uint8_t>& broken) {
  UnionFind pieces(lattice.bodies.position.size());
  for (std::size_t m = 0; m < lattice.beams.bodies.size(); ++m) {
    if (!broken.empty() && broken[m] != 0) continue;
    const auto& [i, j] = lattice.beams.bodies[m];
    pieces.unite(i, j);
  }
  return pieces.representatives();
}

}  // namespace floe
