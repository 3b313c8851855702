#include "contact/eligibility.h"

#include <algorithm>
#include <utility>

#include "base/union_find.h"

namespace floe {

Eligibility::Eligibility(const Solids& solids, std::vector<BodyPair> joined)
    : joined_(std::move(joined)) {
  update(solids);
}

bool Eligibility::release(BodyPair pair) {
  if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
  const auto found = std::lower_bound(joined_.begin(), joined_.end(), pair);
  if (found == joined_.end() || *found != pair) return false;  // released before
  joined_.erase(found);
  released_.push_back(pair);
  return true;
}

void Eligibility::update(const Solids& solids) {
  const std::int32_t bodies = solids.bodies();
  const auto n = static_cast<std::size_t>(bodies);
  fresh_.assign(released_.begin() + static_cast<std::ptrdiff_t>(known()), released_.end());
  broken_ = released_;
  std::sort(fresh_.begin(), fresh_.end());
  std::sort(broken_.begin(), broken_.end());
  piece_before_ = piece_;
  on_surface_before_ = on_surface_;
  std::vector<std::int32_t> beams(n, 0);
  UnionFind pieces(n);
  for (const auto& [a, b] : joined_) {
    ++item(beams, a);
    ++item(beams, b);
    pieces.unite(a, b);
  }
  piece_ = pieces.representatives();
  on_surface_.resize(n);
  pieces_ = 0;
  for (std::int32_t b = 0; b < bodies; ++b) {
    if (item(piece_, b) == b && !solids.is_structure(b)) ++pieces_;
    item(on_surface_, b) = item(beams, b) < solids.faces(b).number - 2 ? 1 : 0;
  }
  for (const auto& [a, b] : released_) item(on_surface_, a) = item(on_surface_, b) = 1;
}

bool Eligibility::may_touch(std::int32_t a, std::int32_t b) const {
  if (item(piece_, a) != item(piece_, b)) return true;
  return on_surface(a) && on_surface(b) &&
         !std::binary_search(joined_.begin(), joined_.end(), BodyPair{a, b});
}

bool Eligibility::became_eligible(std::int32_t a, std::int32_t b) const {
  if (piece_before_.empty() || item(piece_before_, a) != item(piece_before_, b)) return false;
  return item(on_surface_before_, a) == 0 || item(on_surface_before_, b) == 0 ||
         std::binary_search(fresh_.begin(), fresh_.end(), BodyPair{a, b});
}

bool Eligibility::beam_broke(const BodyPair& pair) const {
  return std::binary_search(broken_.begin(), broken_.end(), pair);
}

}  // namespace floe
