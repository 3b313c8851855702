#include "lattice/pieces.h"

#include <algorithm>
#include <numeric>

namespace floe {

/// Union-find with path halving.
std::vector<std::int32_t> connected_pieces(const Lattice& lattice,
                                           const std::vector<std::uint8_t>& broken) {
  std::vector<std::int32_t> parent(lattice.bodies.position.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t b) {
    while (parent[static_cast<std::size_t>(b)] != b) {
      auto& up = parent[static_cast<std::size_t>(b)];
      up = parent[static_cast<std::size_t>(up)];
      b = up;
    }
    return b;
  };
  for (std::size_t m = 0; m < lattice.beams.bodies.size(); ++m) {
    if (!broken.empty() && broken[m] != 0) continue;
    const auto& [i, j] = lattice.beams.bodies[m];
    const std::int32_t a = root(i), b = root(j);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  for (std::size_t b = 0; b < parent.size(); ++b) parent[b] = root(static_cast<std::int32_t>(b));
  return parent;
}

}  // namespace floe
