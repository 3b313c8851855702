#include "contact/part_contacts.h"

#include <algorithm>

#include "geometry/convex_polygon.h"

namespace floe {
namespace {

/// Returns the number of the part of a pair in its obstacle.
std::int32_t part_of(const Solids& solids, const Pair& pair) {
  const std::size_t first = solids.parts_of(solids.obstacle_number(pair.b))[0];
  return static_cast<std::int32_t>(part_number(pair.b) - first);
}

bool is_next_to(const Solids& solids, const Pair& one, const Pair& other) {
  const auto& faces = solids.part(one.b).inner_faces;
  const std::int32_t part = part_of(solids, other);
  return std::any_of(faces.begin(), faces.end(),
                     [&](const InnerFace& face) { return face.other == part; });
}

/// Places half-spaces in another frame. \param axes, x  axes and origin of theirs in the other
void place(std::span<const HalfSpace> planes, const Triad<double>& axes, const Vec3<double>& x,
           std::vector<HalfSpace>& placed) {
  placed.clear();
  for (const HalfSpace& plane : planes) {
    const Vec3<double> normal = axes.to_world(plane.normal);
    placed.push_back({normal, plane.offset + dot(normal, x)});
  }
}

}  // namespace

void PartContacts::add(std::int32_t index, const Pair& pair, const PairOverlap& overlap,
                       const NarrowPhase& narrow) {
  if (number_ == room_.size()) room_.emplace_back();
  Met& met = room_[number_++];
  met.pair = index;
  met.overlap = overlap;
  narrow.facets_on_b(pair, met.facets);
}

std::span<const PartContacts::Joined> PartContacts::join(const Solids& solids, const Wear& wear,
                                                         bool with_patch,
                                                         std::span<const Pair> pairs,
                                                         const Placed& a, const Placed& b,
                                                         std::span<const std::int32_t> known) {
  joined_.clear();
  const std::span<Met> all = met();
  if (all.empty()) return joined_;
  const std::int32_t body = item(pairs, all[0].pair).a;
  if (all.size() > 1) {
    const Triad<double> turn{b.axes.to_local(a.axes.e1), b.axes.to_local(a.axes.e2),
                             b.axes.to_local(a.axes.e3)};
    const Vec3<double> x = b.axes.to_local(a.x - b.x);
    place(wear.of(body), turn, x, worn_);
    place(solids.planes(body), turn, x, planes_a_);
    planes_a_.insert(planes_a_.end(), worn_.begin(), worn_.end());
  }
  joined_.resize(find_meetings(solids, pairs));
  choose_pairs(solids, pairs, known);
  for (std::size_t k = 0; k < joined_.size(); ++k) sum(with_patch, a, b, k);
  std::sort(joined_.begin(), joined_.end(),
            [](const Joined& p, const Joined& q) { return p.pair < q.pair; });
  return joined_;
}

/// Finds where met parts meet inside A, and numbers the contacts. \returns their number
std::size_t PartContacts::find_meetings(const Solids& solids, std::span<const Pair> pairs) {
  const std::span<Met> all = met();
  meetings_.clear();
  for (std::size_t k = 0; k < all.size(); ++k) all[k].contact = k;
  if (all.size() == 1) return 1;
  for (std::size_t one = 0; one < all.size(); ++one) {
    for (const InnerFace& face : solids.part(item(pairs, all[one].pair).b).inner_faces) {
      std::size_t other = one + 1;  // parts descend in the list, so each face is found once
      while (other < all.size() && part_of(solids, item(pairs, all[other].pair)) != face.other)
        ++other;
      if (other == all.size()) continue;
      corners_ = face.corners;
      for (const HalfSpace& plane : planes_a_) {
        if (corners_.size() < 3) break;
        cut(corners_, plane, work_);
      }
      if (corners_.size() < 3) continue;
      meetings_.push_back({one, other, corners_});
      const std::size_t from = all[other].contact, to = all[one].contact;
      for (Met& met : all)
        if (met.contact == std::max(from, to)) met.contact = std::min(from, to);
    }
  }
  std::size_t number = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::size_t first = all[k].contact;
    all[k].contact = first == k ? number++ : all[first].contact;
  }
  return number;
}

/// Gives histories to contacts, and each contact its pair: that of its history as long as A touches
/// the part, else that of the largest overlap.
void PartContacts::choose_pairs(const Solids& solids, std::span<const Pair> pairs,
                                std::span<const std::int32_t> known) {
  const std::span<Met> all = met();
  for (const std::int32_t pair : known) {
    auto found =
        std::find_if(all.begin(), all.end(), [&](const Met& met) { return met.pair == pair; });
    if (found != all.end()) {
      Joined& contact = joined_[found->contact];
      if (contact.pair < 0) contact.pair = pair;
      contact.known.push_back(pair);
      continue;
    }
    found = std::find_if(all.begin(), all.end(), [&](const Met& met) {
      return is_next_to(solids, item(pairs, met.pair), item(pairs, pair));
    });
    if (found != all.end()) joined_[found->contact].known.push_back(pair);
  }
  for (std::size_t k = 0; k < joined_.size(); ++k) {
    if (joined_[k].pair >= 0) continue;
    double most = 0;
    for (const Met& met : all) {
      if (met.contact != k || !(met.overlap.overlap.volume > most)) continue;
      most = met.overlap.overlap.volume;
      joined_[k].pair = met.pair;
    }
  }
}

void PartContacts::sum(bool with_patch, const Placed& a, const Placed& b, std::size_t contact) {
  Joined& joined = joined_[contact];
  const auto is_of = [&](const Met& met) { return met.contact == contact; };
  const std::span<Met> all = met();
  if (std::count_if(all.begin(), all.end(), is_of) == 1) {
    joined.overlap = std::find_if(all.begin(), all.end(), is_of)->overlap;
    return;
  }
  const Vec3<double> origin = b.x - a.x;
  whole_.clear();
  for (const Met& met : all)
    if (is_of(met)) whole_.add(met.overlap.overlap, met.facets, b.axes, origin);
  for (Meeting& meeting : meetings_) {
    if (!is_of(all[meeting.one])) continue;
    for (Vec3<double>& r : meeting.corners) r = origin + b.axes.to_world(r);
    whole_.leave_out(meeting.corners);
  }
  joined.overlap = {.overlap = whole_.sum(with_patch), .depth = 0};
}

}  // namespace floe
