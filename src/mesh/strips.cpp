#include "floe/mesh/strips.h"

#include <algorithm>
#include <cmath>

#include "mesh/periodic.h"

namespace floe {
namespace {

/// Mixes two numbers to the seed of a strip (Steele, Lea & Flood 2014: SplitMix64).
std::uint64_t seed_of(std::uint64_t seed, std::int32_t strip) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15U * (static_cast<std::uint64_t>(strip) + 1);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return (z ^ (z >> 31U)) >> 1U;
}

}  // namespace

/// Distance from a joint within which generators follow it [m].
double Strips::zone() const { return std::min(0.25 * plan_.length, 5 * plan_.element_size); }

const Strips::Points& Strips::relaxed(std::int32_t k) {
  const auto found = relaxed_.find(k);
  if (found != relaxed_.end()) return found->second;
  SheetPlan plan = plan_;
  plan.seed = seed_of(plan_.seed, k);
  Tessellation alone = tessellate(plan, comm_);
  energy_ratio_[k] = alone.energy_ratio;
  return relaxed_[k] = std::move(alone.generators);
}

/// The generators of strips k and k + 1, each relaxed by itself, from the middle of their joint.
Strips::Points Strips::of_joint(std::int32_t k) {
  Points points;
  for (const std::int32_t strip : {k, k + 1}) {
    const double shift = (strip == k ? 0.5 : -0.5) * plan_.length;
    for (const auto& [x, y] : relaxed(strip)) points.push_back({x + shift, y});
  }
  return points;
}

const Strips::Points& Strips::joint(std::int32_t k) {
  const auto found = joints_.find(k);
  if (found != joints_.end()) return found->second;
  Points points = of_joint(k);
  SheetPlan plan = plan_;
  plan.length = 2 * plan_.length;
  std::vector<std::size_t> near;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (std::abs(points[p][0]) < zone()) near.push_back(p);
  mesh::relax_some(plan, points, near, comm_);
  return joints_[k] = std::move(points);
}

/// Generators of a strip from its middle, those near the given joints in their last places; joint j
/// is that of strips j and j + 1.
Strips::Points Strips::settled(std::int32_t strip, std::initializer_list<std::int32_t> joints) {
  Points points = relaxed(strip);
  const std::size_t n = points.size();
  for (const std::int32_t j : joints) {
    if (j < 0) continue;
    const bool is_left = j == strip;  // of the strip
    const double side = (is_left ? -0.5 : 0.5) * plan_.length;
    const Points &after = joint(j), &before = relaxed(strip);
    for (std::size_t p = 0; p < n; ++p) {
      if (std::abs(before[p][0] - side) < zone())
        points[p] = {after[p + (is_left ? 0 : n)][0] + side, after[p + (is_left ? 0 : n)][1]};
    }
  }
  return points;
}

const StripCells& Strips::strip(std::int32_t k) {
  const auto found = cells_.find(k);
  if (found != cells_.end()) return found->second;
  // The strip between its neighbours, of which only those cells count that are next to it.
  const bool is_first = k == 0;
  SheetPlan plan = plan_;
  plan.length = (is_first ? 2 : 3) * plan_.length;
  const double middle = is_first ? 0.5 * plan_.length : 0;  // of strip k in this plan
  const auto n = static_cast<std::size_t>(cells_of_each());
  Points points;
  const auto add = [&](const Points& strip, double shift) {
    for (const auto& [x, y] : strip) points.push_back({x + shift, y});
  };
  add(settled(k, {k - 1, k}), middle);
  add(settled(k + 1, {k}), middle - plan_.length);
  if (!is_first) add(settled(k - 1, {k - 1}), middle + plan_.length);
  const Tessellation around = tessellate(plan, std::move(points));

  StripCells cells;
  cells.energy_ratio = energy_ratio_.at(k);
  cells.offset.assign(around.offset.begin(),
                      around.offset.begin() + static_cast<std::ptrdiff_t>(n) + 1);
  for (std::size_t v = 0; v < static_cast<std::size_t>(cells.offset.back()); ++v)
    cells.vertices.push_back({around.vertices[v][0] - middle, around.vertices[v][1]});
  cells.sides.assign(around.sides.begin(), around.sides.begin() + static_cast<std::ptrdiff_t>(n));
  const auto own = static_cast<std::int32_t>(n);
  for (const auto& [pair, width, shift] : around.facets) {
    const auto [i, j] = pair;
    if (i < own && j < own) cells.inside.push_back({{i, j}, width, shift});
    if (i < own && j >= own && j < 2 * own) cells.to_next.push_back({{i, j - own}, width, shift});
  }
  return cells_[k] = std::move(cells);
}

void Strips::forget(std::span<const std::int32_t> kept) {
  const std::int32_t last = kept.empty() ? 0 : kept.back();
  const auto is_old = [&](const auto& of) { return of.first < last; };  // the next needs no other
  std::erase_if(relaxed_, is_old);
  std::erase_if(energy_ratio_, is_old);
  std::erase_if(joints_, is_old);
  std::erase_if(cells_, [&](const auto& of) {
    return !std::binary_search(kept.begin(), kept.end(), of.first);
  });
}

}  // namespace floe
