#include "submersion/submersion.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "floe/base/petsc.h"

namespace floe {
namespace {

constexpr double far_away = 1e9;  ///< place of a body that has not been looked at [m]

}  // namespace

const Part& require_shapes(const Part& part, std::string_view force) {
  if (part.shapes.empty() && part.owned > 0)
    throw InputError("forces: " + std::string(force) +
                     " needs bodies with a shape; the lattice file has no /shapes");
  return part;
}

Submersion::Submersion(const Part& part, int pace, bool shared, TimeTable level)
    : part_(part),
      immersion_(part, pace > 1 ? Immersion::Wet::by_points : Immersion::Wet::by_sphere,
                 std::move(level)),
      pace_(pace),
      shared_(shared) {
  if (shared) volumes_.resize(immersion_.blocks());
  if (!has_pace()) return;
  new_.resize(immersion_.blocks());
  expansions_.resize(immersion_.blocks());
  sizes_.resize(immersion_.blocks());
  for (std::size_t block = 0; block < sizes_.size(); ++block) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto body = static_cast<std::int32_t>(immersion_.body_of(block, lane));
      const double extent = immersion_.extent(body);
      const double most = largest_move * immersion_.mean_thickness(body);
      sizes_[block].extent2[lane] = extent * extent;
      sizes_[block].most2[lane] = 0.5 * most * most;
    }
  }
}

Immersion::Lane Submersion::find(const State<Spatial>& state, std::size_t block,
                                 const BlockMotion& m) {
  expansions_[block] = {m.u.z, m.q, immersion_.cut_of_block(state, block, m.u.z, m.q)};
  new_[block] = static_cast<std::uint8_t>(~0U);
  return expansions_[block].cut.below;
}

/// Finds the bodies of a block anew that have moved too far, and leaves the others.
Immersion::Lane Submersion::find_some(const State<Spatial>& state, std::size_t block,
                                      const BlockMotion& m, const Followed& followed) {
  Expansion old = expansions_[block];
  Immersion::Lane now = find(state, block, m);
  new_[block] = 0;
  const auto to = numbers_of(expansions_[block]), from = numbers_of(old);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if (followed.apart[lane] > 0) {
      new_[block] = static_cast<std::uint8_t>(new_[block] | 1U << lane);
      continue;
    }
    for (std::size_t n = 0; n < numbers; ++n) (*to[n])[lane] = double((*from[n])[lane]);
    now.volume[lane] = double(followed.now.volume[lane]);
    now.moment.x[lane] = double(followed.now.moment.x[lane]);
    now.moment.y[lane] = double(followed.now.moment.y[lane]);
  }
  return now;
}

std::array<Lanes*, Submersion::numbers> Submersion::numbers_of(Expansion& e) {
  auto& [below, w] = e.cut;
  return {&e.z,
          &e.q.w,
          &e.q.x,
          &e.q.y,
          &e.q.z,
          &below.volume,
          &below.moment.x,
          &below.moment.y,
          &below.moment.z,
          &w.area,
          &w.x,
          &w.y,
          &w.xx,
          &w.xy,
          &w.yy};
}

void Submersion::persist(Archive& archive) {
  archive.common("steps_since_found", since_);
  std::vector<std::int32_t> bodies;
  std::vector<double> rows;
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    bodies.push_back(body);
    const auto b = static_cast<std::size_t>(body);
    for (const Lanes* number : numbers_of(expansions_[b / lanes]))
      rows.push_back((*number)[b % lanes]);
  }
  if (archive.loading() && archive.renumbers()) {  // bodies that join are looked at at once
    constexpr std::size_t z = 0, w = 1;
    for (std::size_t k = 0; k < rows.size(); ++k)
      rows[k] = k % numbers == z ? far_away : k % numbers == w ? 1 : 0;
  }
  archive.rows("submerged", bodies, rows, static_cast<int>(numbers));
  if (!archive.loading()) return;
  for (std::size_t k = 0; k < expansions_.size() * lanes; ++k) {
    const double* row = &rows[immersion_.body_of(k / lanes, k % lanes) * numbers];
    for (Lanes* number : numbers_of(expansions_[k / lanes])) (*number)[k % lanes] = *row++;
  }
}

}  // namespace floe
