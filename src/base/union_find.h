/// \file
/// Disjoint sets of indices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "floe/base/item.h"

namespace floe {

/// Union-find with path halving (Tarjan & van Leeuwen 1984). The representative of a set is its
/// lowest member, so it does not depend on the order of the unions.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  /// Returns the representative of the set of `member`.
  std::int32_t find(std::int32_t member) {
    auto at = static_cast<std::size_t>(member);
    while (static_cast<std::size_t>(parent_[at]) != at) {
      parent_[at] = item(parent_, parent_[at]);
      at = static_cast<std::size_t>(parent_[at]);
    }
    return static_cast<std::int32_t>(at);
  }
  /// Merges the sets of a and b.
  void unite(std::int32_t a, std::int32_t b) {
    a = find(a), b = find(b);
    item(parent_, std::max(a, b)) = std::min(a, b);
  }
  /// Returns the lowest member of each index's set.
  std::vector<std::int32_t> representatives() {
    for (std::size_t k = 0; k < parent_.size(); ++k)
      parent_[k] = find(static_cast<std::int32_t>(k));
    return parent_;
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace floe
