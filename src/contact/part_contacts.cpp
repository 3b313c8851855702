#include "contact/part_contacts.h"

#include <algorithm>

#include "geometry/convex_polygon.h"

namespace floe {
namespace {

/// Returns the number of a part in its obstacle.
std::int32_t part_of(const Solids& solids, std::int32_t index) {
  const std::size_t first = solids.parts_of(solids.obstacle_number(index))[0];
  return static_cast<std::int32_t>(part_number(index) - first);
}

bool is_next_to(const Solids& solids, std::int32_t one, std::int32_t other) {
  const auto& faces = solids.part(one).inner_faces;
  const std::int32_t part = part_of(solids, other);
  return std::any_of(faces.begin(), faces.end(),
                     [&](const InnerFace& face) { return face.other == part; });
}

/// Whether the parts of two pairs are the same or next to each other, in A and in B.
bool are_next(const Solids& solids, const Pair& one, const Pair& other) {
  return (one.a == other.a || is_next_to(solids, one.a, other.a)) &&
         (one.b == other.b || is_next_to(solids, one.b, other.b));
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
  const std::span<Met> all = met();
  if (all.empty()) return {};
  const std::size_t number = find_meetings(solids, wear, pairs, a, b);
  joined_.resize(std::max(joined_.size(), number));
  const std::span<Joined> contacts(joined_.data(), number);
  for (Joined& contact : contacts) contact.pair = -1, contact.known.clear();
  choose_pairs(solids, pairs, known, contacts);
  for (std::size_t k = 0; k < number; ++k) sum(solids, pairs, with_patch, a, b, k);
  std::sort(contacts.begin(), contacts.end(),
            [](const Joined& p, const Joined& q) { return p.pair < q.pair; });
  return contacts;
}

/// Finds where met parts meet inside A and B, and numbers the contacts. \returns their number
std::size_t PartContacts::find_meetings(const Solids& solids, const Wear& wear,
                                        std::span<const Pair> pairs, const Placed& a,
                                        const Placed& b) {
  const std::span<Met> all = met();
  meetings_ = 0;
  for (std::size_t k = 0; k < all.size(); ++k) all[k].contact = k;
  if (all.size() == 1) return 1;
  const auto [turn, x] = Relative(a, b);
  std::int32_t of = 0;
  for (std::size_t one = 0; one < all.size(); ++one) {
    const Pair& pair = item(pairs, all[one].pair);
    if (one == 0 || pair.a != of) {
      of = pair.a;
      planes_a_.clear();
      for (const auto& planes : {solids.planes(of), wear.of(of)})
        for (const HalfSpace& plane : planes) planes_a_.push_back(placed(plane, turn, x));
    }
    find_meetings_in_a(solids, pairs, one);
    if (!is_obstacle(of)) continue;
    const auto [turn_b, x_b] = Relative(b, a);
    planes_b_.clear();
    for (const HalfSpace& plane : solids.planes(pair.b))
      planes_b_.push_back(placed(plane, turn_b, x_b));
    find_meetings_in_b(solids, pairs, one);
  }
  std::size_t number = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::size_t first = all[k].contact;
    all[k].contact = first == k ? number++ : all[first].contact;
  }
  return number;
}

/// Finds where the part of B of an overlap meets others inside the same part of A. Parts descend in
/// the list, so each face is found once.
void PartContacts::find_meetings_in_a(const Solids& solids, std::span<const Pair> pairs,
                                      std::size_t one) {
  const std::span<Met> all = met();
  const Pair& pair = item(pairs, all[one].pair);
  for (const InnerFace& face : solids.part(pair.b).inner_faces) {
    for (std::size_t other = one + 1; other < all.size(); ++other) {
      const Pair& next = item(pairs, all[other].pair);
      if (next.a != pair.a) break;
      if (part_of(solids, next.b) != face.other) continue;
      corners_ = face.corners;
      if (!is_inside(planes_a_)) break;
      if (meetings_ == meeting_room_.size()) meeting_room_.emplace_back();
      Meeting& meeting = meeting_room_[meetings_++];
      meeting.part = one;
      meeting.corners.assign(corners_.begin(), corners_.end());
      unite(one, other);
      break;
    }
  }
}

/// Finds where the part of A of an overlap meets others inside the same part of B.
void PartContacts::find_meetings_in_b(const Solids& solids, std::span<const Pair> pairs,
                                      std::size_t one) {
  const std::span<Met> all = met();
  const Pair& pair = item(pairs, all[one].pair);
  for (const InnerFace& face : solids.part(pair.a).inner_faces) {
    for (std::size_t other = one + 1; other < all.size(); ++other) {
      const Pair& next = item(pairs, all[other].pair);
      if (next.b != pair.b || part_of(solids, next.a) != face.other) continue;
      corners_ = face.corners;
      if (is_inside(planes_b_)) unite(one, other);
      break;
    }
  }
}

/// Cuts corners_ off at planes. \returns whether something is left
bool PartContacts::is_inside(std::span<const HalfSpace> planes) {
  for (const HalfSpace& plane : planes) {
    if (corners_.size() < 3) return false;
    cut(corners_, plane, work_);
  }
  return corners_.size() >= 3;
}

/// Makes the contacts of two overlaps one.
void PartContacts::unite(std::size_t one, std::size_t other) {
  const std::span<Met> all = met();
  const std::size_t from = all[other].contact, to = all[one].contact;
  for (Met& met : all)
    if (met.contact == std::max(from, to)) met.contact = std::min(from, to);
}

/// Gives histories to contacts, and each contact its pair: that of its history as long as A touches
/// the part, else that of the largest overlap.
void PartContacts::choose_pairs(const Solids& solids, std::span<const Pair> pairs,
                                std::span<const std::int32_t> known, std::span<Joined> contacts) {
  const std::span<Met> all = met();
  for (const std::int32_t pair : known) {
    auto found =
        std::find_if(all.begin(), all.end(), [&](const Met& met) { return met.pair == pair; });
    if (found != all.end()) {
      Joined& contact = contacts[found->contact];
      if (contact.pair < 0) contact.pair = pair;
      contact.known.push_back(pair);
      continue;
    }
    found = std::find_if(all.begin(), all.end(), [&](const Met& met) {
      return are_next(solids, item(pairs, met.pair), item(pairs, pair));
    });
    if (found != all.end()) contacts[found->contact].known.push_back(pair);
  }
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    if (contacts[k].pair >= 0) continue;
    double most = 0;
    for (const Met& met : all) {
      if (met.contact != k || !(met.overlap.overlap.volume > most)) continue;
      most = met.overlap.overlap.volume;
      contacts[k].pair = met.pair;
    }
  }
}

void PartContacts::sum(const Solids& solids, std::span<const Pair> pairs, bool with_patch,
                       const Placed& a, const Placed& b, std::size_t contact) {
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
  for (Meeting& meeting : std::span(meeting_room_.data(), meetings_)) {
    if (!is_of(all[meeting.part])) continue;
    for (Vec3<double>& r : meeting.corners) r = origin + b.axes.to_world(r);
    whole_.leave_out(meeting.corners);
  }
  joined.overlap = {.overlap = whole_.sum(with_patch), .depth = 0};
  const std::int32_t of_b = item(pairs, joined.pair).b;
  if (!solids.is_half_space(of_b)) return;
  const HalfSpace& face = solids.planes(of_b)[0];
  const Vec3<double> centroid = b.axes.to_local(joined.overlap.overlap.centroid - origin);
  joined.overlap.depth = face.offset - dot(face.normal, centroid);
}

}  // namespace floe
