#include "active_contacts/history.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "floe/base/item.h"

namespace floe {

void ContactHistory::move(std::int32_t from, std::int32_t to, std::span<const Pair> pairs) {
  const auto of = [&](std::int32_t pair) {
    return std::lower_bound(entries_.begin(), entries_.end(), pair,
                            [](const Entry& entry, std::int32_t p) { return entry.pair < p; });
  };
  const auto moved = of(from);
  const PairHistory memory = moved->memory;
  entries_.erase(moved);
  const auto there = of(to);
  if (there != entries_.end() && there->pair == to) {
    there->memory = joined(there->memory, memory);
  } else {
    const Pair& pair = item(pairs, to);
    entries_.insert(there, {.a = pair.a, .b = pair.b, .pair = to, .memory = memory});
  }
}

/// Both the histories and the pairs are sorted by (A, B), but for the few pairs of two obstacles,
/// which come first in both.
void ContactHistory::take_over(std::span<Pair> pairs) {
  next_.clear();
  const auto first = entries_.cbegin();
  const auto of_bodies =
      std::find_if(first, entries_.cend(), [](const Entry& e) { return !is_obstacle(e.a); });
  auto entry = of_bodies;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    Pair& p = pairs[k];
    const auto is_of = [&](const Entry& e) { return e.a == p.a && e.b == p.b; };
    if (is_obstacle(p.a)) {
      entry = std::find_if(first, of_bodies, is_of);
      if (entry == of_bodies) continue;
    } else {
      while (entry != entries_.cend() && std::tie(entry->a, entry->b) < std::tie(p.a, p.b)) ++entry;
      if (entry == entries_.cend() || !is_of(*entry)) continue;
    }
    p.newly_eligible = false;
    next_.push_back(
        {.a = p.a, .b = p.b, .pair = static_cast<std::int32_t>(k), .memory = entry->memory});
  }
  std::swap(entries_, next_);
}

std::vector<double> ContactHistory::rows(std::span<const Pair> pairs) const {
  std::vector<double> rows;
  for (const Entry& entry : entries_) {
    if (entry.pair >= 0 && !item(pairs, entry.pair).counted) continue;
    const auto numbers = entry.memory.as_numbers();
    rows.insert(rows.end(), {static_cast<double>(entry.a), static_cast<double>(entry.b)});
    rows.insert(rows.end(), numbers.begin(), numbers.end());
  }
  return rows;
}

void ContactHistory::restore(std::span<const double> rows) {
  entries_.clear();
  for (std::size_t k = 0; k + width <= rows.size(); k += width) {
    const std::span<const double> row = rows.subspan(k, width);
    entries_.push_back({.a = static_cast<std::int32_t>(row[0]),
                        .b = static_cast<std::int32_t>(row[1]),
                        .pair = -1,
                        .memory = PairHistory::from(row.last<PairHistory::numbers>())});
  }
}

}  // namespace floe
