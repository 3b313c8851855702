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
  const std::int32_t body = item(pairs, all[0].pair).a;
  if (all.size() > 1) {
    const auto [turn, x] = Relative(a, b);
    planes_a_.clear();
    for (const HalfSpace& plane : solids.planes(body)) planes_a_.push_back(placed(plane, turn, x));
    for (const HalfSpace& plane : wear.of(body)) planes_a_.push_back(placed(plane, turn, x));
  }
  const std::size_t number = find_meetings(solids, pairs);
  joined_.resize(std::max(joined_.size(), number));
  const std::span<Joined> contacts(joined_.data(), number);
  for (Joined& contact : contacts) contact.pair = -1, contact.known.clear();
  choose_pairs(solids, pairs, known, contacts);
  for (std::size_t k = 0; k < number; ++k) sum(with_patch, a, b, k);
  std::sort(contacts.begin(), contacts.end(),
            [](const Joined& p, const Joined& q) { return p.pair < q.pair; });
  return contacts;
}

/// Finds where met parts meet inside A, and numbers the contacts. \returns their number
std::size_t PartContacts::find_meetings(const Solids& solids, std::span<const Pair> pairs) {
  const std::span<Met> all = met();
  meetings_ = 0;
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
      if (meetings_ == meeting_room_.size()) meeting_room_.emplace_back();
      Meeting& meeting = meeting_room_[meetings_++];
      meeting.part = one;
      meeting.corners.assign(corners_.begin(), corners_.end());
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
      return is_next_to(solids, item(pairs, met.pair), item(pairs, pair));
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
  for (Meeting& meeting : std::span(meeting_room_.data(), meetings_)) {
    if (!is_of(all[meeting.part])) continue;
    for (Vec3<double>& r : meeting.corners) r = origin + b.axes.to_world(r);
    whole_.leave_out(meeting.corners);
  }
  joined.overlap = {.overlap = whole_.sum(with_patch), .depth = 0};
}

}  // namespace floe
