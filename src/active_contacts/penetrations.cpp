#include "active_contacts/penetrations.h"

#include <algorithm>

namespace floe {
namespace {

/// Returns the smaller size of a pair [m].
double smaller_size(const Solids& solids, const Pair& pair) {
  const auto size = [&](std::int32_t index) {
    return is_obstacle(index) ? solids.width(index) : solids.size(index);
  };
  return std::min(size(pair.a), size(pair.b));
}

}  // namespace

/// The depth is the extent of the overlap along the normal where only corners or edges overlap, and
/// the distance by which two faces would have to part.
std::vector<Penetration> penetrations(const Solids& solids, const PairList& list,
                                      const Places& places, const ActiveContacts& contacts) {
  std::vector<Penetration> found;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Pair& pair = list.pair(contacts.pair(k));
    if (!pair.counted || contacts.is_enclosed(k)) continue;
    const Vec3<double> n = contacts.normal(k);
    Placed image;
    const Placed &a = places.of_a(pair), &b = places.image_of_b(pair, image);
    const auto [low, high] = reaches(solids, pair, a, b, n);
    const double depth = high + dot(n, b.x - a.x) - low;
    found.push_back(
        {.a = pair.a, .b = pair.b, .depth = depth, .share = depth / smaller_size(solids, pair)});
  }
  return found;
}

}  // namespace floe
