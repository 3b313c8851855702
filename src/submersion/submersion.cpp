#include "submersion/submersion.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>

#include "floe/base/petsc.h"

namespace floe {
namespace {

constexpr double far_away = 1e9;  ///< place of a body that has not been looked at [m]

/// The numbers of an expansion, in the order in which checkpoints and back ends have them.
std::array<Lanes*, 15> numbers_in(Expansion<Lanes>& e) {
  Waterplane<Lanes>& w = e.waterplane;
  return {&e.z,        &e.q.w,  &e.q.x, &e.q.y, &e.q.z, &e.volume, &e.moment.x, &e.moment.y,
          &e.moment.z, &w.area, &w.x,   &w.y,   &w.xx,  &w.xy,     &w.yy};
}

}  // namespace

const Part& require_shapes(const Part& part, std::string_view force) {
  if (part.shapes.empty() && part.owned > 0)
    throw InputError("forces: " + std::string(force) +
                     " needs bodies with a shape; the lattice file has no /shapes");
  return part;
}

Submersion::Submersion(const Part& part, int pace, bool shared, TimeTable level)
    : part_(part),
      immersion_(part, pace > 1 ? Wet::by_points : Wet::by_sphere, std::move(level)),
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
  const Immersion::Cut cut = immersion_.cut_of_block(state, block, m.u.z, m.q);
  expansions_[block] = {m.u.z, m.q, cut.below.volume, cut.below.moment, cut.waterplane};
  new_[block] = static_cast<std::uint8_t>(~0U);
  return cut.below;
}

/// Finds the bodies of a block anew that have moved too far, and leaves the others.
Immersion::Lane Submersion::find_some(const State<Spatial>& state, std::size_t block,
                                      const BlockMotion& m, const FollowedBlock& followed) {
  Expansion<Lanes> old = expansions_[block];
  Immersion::Lane now = find(state, block, m);
  new_[block] = 0;
  const auto to = numbers_in(expansions_[block]), from = numbers_in(old);
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

void Submersion::persist(Archive& archive) {
  archive.common("steps_since_found", since_);
  std::vector<std::int32_t> bodies(static_cast<std::size_t>(part_.owned));
  std::iota(bodies.begin(), bodies.end(), 0);
  std::vector<double> rows;
  read(rows, since_);
  if (archive.loading() && archive.renumbers()) {  // bodies that join are looked at at once
    constexpr std::size_t z = 0, w = 1;
    for (std::size_t k = 0; k < rows.size(); ++k)
      rows[k] = k % numbers == z ? far_away : k % numbers == w ? 1 : 0;
  }
  archive.rows("submerged", bodies, rows, static_cast<int>(numbers));
  if (archive.loading()) set_numbers(rows);
}

void Submersion::read(std::vector<double>& rows, std::int64_t& steps) const {
  steps = since_;
  rows.clear();
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    Expansion<Lanes> of = expansions_[b / lanes];
    for (const Lanes* number : numbers_in(of)) rows.push_back((*number)[b % lanes]);
  }
}

void Submersion::write(std::span<const double> rows, std::int64_t steps) {
  since_ = steps;
  set_numbers(rows);
}

void Submersion::set_numbers(std::span<const double> rows) {
  for (std::size_t k = 0; k < expansions_.size() * lanes; ++k) {
    const double* row = &rows[immersion_.body_of(k / lanes, k % lanes) * numbers];
    for (Lanes* number : numbers_in(expansions_[k / lanes])) (*number)[k % lanes] = *row++;
  }
}

DeviceWater& Submersion::describe(DeviceModel& model) {
  if (model.water) return *model.water;
  DeviceWater& water = model.water.emplace();
  water.level = [this](double time) { return immersion_.level(time); };
  water.pace = pace_;
  water.by_points = immersion_.wet() == Wet::by_points;
  if (has_pace()) water.kept = this;
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    const Prism<double> p = immersion_.prism(static_cast<std::size_t>(body));
    water.prisms.push_back({p.axes.w, p.axes.x, p.axes.y, p.axes.z, p.z, p.bottom, p.top, p.area,
                            p.x, p.y, p.xx, p.xy, p.yy, p.radius2});
    water.extents.push_back(immersion_.extent(body));
    const double most = largest_move * immersion_.mean_thickness(body);
    water.most2.push_back(0.5 * most * most);
    const VolumeProperties& all = immersion_.all_of_body(body);
    water.wholes.push_back({all.volume, all.centroid.x, all.centroid.y, all.centroid.z});
  }
  water.shapes = &part_.shapes;
  return water;
}

}  // namespace floe
