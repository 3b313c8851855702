/// \file
/// Elements of sequences by signed index: bodies, pairs, faces and slots are counted by
/// std::int32_t, sequences by std::size_t.
#pragma once

#include <cassert>
#include <concepts>
#include <cstddef>
#include <iterator>

namespace floe {

/// Returns element `index` of a vector, span or array. Builds with assertions check the index.
template <class Sequence, std::signed_integral Index>
decltype(auto) item(Sequence& sequence, Index index) {
  assert(index >= 0 && static_cast<std::size_t>(index) < std::size(sequence));
  return sequence[static_cast<std::size_t>(index)];
}

}  // namespace floe
