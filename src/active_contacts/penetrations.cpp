#include "active_contacts/penetrations.h"

#include <algorithm>

namespace floe {
namespace {

/// Returns the smaller size of a pair [m].
double smaller_size(const Solids& solids, const Pair& pair) {
  const double size_of_b = is_obstacle(pair.b) ? solids.width(pair.b) : solids.size(pair.b);
  return std::min(solids.size(pair.a), size_of_b);
}

}  // namespace

/// The depth is the extent of the overlap along the normal where only corners or edges overlap, and
/// the distance by which two faces would have to part.
std::vector<Penetration> penetrations(const Solids& solids, const PairList& list,
                                      const Places& places,
                                      std::span<const ActiveContact> contacts) {
  std::vector<Penetration> found;
  for (const ActiveContact& active : contacts) {
    const Pair& pair = list.pair(active.pair);
    if (!pair.counted || active.is_enclosed()) continue;
    const Vec3<double>& n = active.trial.normal;
    const Placed &a = places.of_a(pair), &b = places.of_b(pair);
    const auto [low, high] = reaches(solids, pair, a, b, n);
    const double depth = high + dot(n, b.x - a.x) - low;
    found.push_back(
        {.a = pair.a, .b = pair.b, .depth = depth, .share = depth / smaller_size(solids, pair)});
  }
  return found;
}

bool is_deep(const Solids& solids, const Pair& pair, const ContactTrial& contact) {
  constexpr double holds = 0.25;
  const double elastic = contact.volume - contact.memory.plastic;
  return elastic > holds * std::min(solids.width(pair.a), solids.width(pair.b)) * contact.area;
}

}  // namespace floe
