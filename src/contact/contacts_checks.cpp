// Checks of contacts: depths of overlaps, and bodies that enclose or pass through each other.

#include <algorithm>
#include <cmath>

#include "contact/contacts.h"

namespace floe {

double Contacts::width_of(std::int32_t body) const {
  return body < 0 ? obstacle_width_[static_cast<std::size_t>(-1 - body)]
                  : solids_[static_cast<std::size_t>(body)].width;
}

/// Along the normal n from B to A, B reaches up to `high` and A down to `low`; both are taken from
/// the centroid of A. The depth is the extent of the overlap along n where only corners or edges
/// overlap, and the distance by which two faces would have to part.
std::vector<Contacts::Penetration> Contacts::penetrations() const {
  std::vector<Penetration> found;
  for (const ActiveContact& touch : active_) {
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    const Vec3<double>& n = touch.contact.normal;
    if (!pair.counted || dot(n, n) == 0) continue;
    const Placed& a = placed_[static_cast<std::size_t>(pair.slot_a)];
    const Placed& b = partner(pair);
    const Vec3<double> along_a = a.axes.to_local(n), along_b = b.axes.to_local(n);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& r : vertices(pair.a)) low = std::min(low, dot(along_a, r));
    for (const auto& r : vertices(pair.b)) high = std::max(high, dot(along_b, r));
    if (vertices(pair.b).empty()) high = planes(pair.b)[0].offset;
    const double depth = high + dot(n, b.x - a.x) - low;
    double smaller = solids_[static_cast<std::size_t>(pair.a)].size;
    if (pair.b >= 0)
      smaller = std::min(smaller, solids_[static_cast<std::size_t>(pair.b)].size);
    else
      smaller = std::min(smaller, width_of(pair.b));
    found.push_back({pair.a, pair.b, depth, depth / smaller});
  }
  return found;
}

void Contacts::note_events(const ActiveContact& touch) {
  const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
  const Vec3<double>& n = touch.contact.normal;
  const bool inside = dot(n, n) == 0;
  if (inside && !enclosed_.happened) enclosed_ = {true, time_, pair.a, pair.b};
  if (!inside && touch.deep && !pressed_through_.happened)
    pressed_through_ = {true, time_, pair.a, pair.b};
}

}  // namespace floe
