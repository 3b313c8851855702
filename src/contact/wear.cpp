#include "contact/wear.h"

#include <algorithm>
#include <limits>

namespace floe {

std::array<double, WearCut::numbers> WearCut::as_numbers() const {
  return {static_cast<double>(a),
          static_cast<double>(b),
          static_cast<double>(body),
          left.normal.x,
          left.normal.y,
          left.normal.z,
          left.offset,
          volume};
}

WearCut WearCut::from(std::span<const double, numbers> n) {
  return {.a = static_cast<std::int32_t>(n[0]),
          .b = static_cast<std::int32_t>(n[1]),
          .body = static_cast<std::int32_t>(n[2]),
          .left = {.normal = {n[3], n[4], n[5]}, .offset = n[6]},
          .volume = n[7]};
}

Wear::Worn& Wear::worn_of(const Solids& solids, std::int32_t body) {
  if (place_.empty()) place_.assign(static_cast<std::size_t>(solids.bodies()), -1);
  std::int32_t& place = item(place_, body);
  if (place < 0) {
    place = static_cast<std::int32_t>(worn_.size());
    worn_.push_back({.body = body});
  }
  return item(worn_, place);
}

void Wear::add(const Solids& solids, const WearCut& cut) {
  Worn& worn = worn_of(solids, cut.body);
  // A plane that no longer bounds what is left has all of it on its inner side.
  Clipper clipper;
  const auto bounds = [&](const HalfSpace& plane) {
    std::vector<HalfSpace> planes{{-1.0 * plane.normal, -plane.offset}, cut.left};
    for (std::size_t k = 0; k < worn.planes; ++k) {
      if (&worn.left[k] != &plane) planes.push_back(worn.left[k]);
    }
    return clipper.overlap(solids.shapes(), cut.body, solids.vertices(cut.body), planes).volume > 0;
  };
  std::array<bool, most> keeps{};
  for (std::size_t k = 0; k < worn.planes; ++k) keeps[k] = bounds(worn.left[k]);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < worn.planes; ++k) {
    if (!keeps[k]) continue;
    worn.left[kept] = worn.left[k];
    worn.volume[kept++] = worn.volume[k];
  }
  if (kept == most) {
    const auto least = std::min_element(worn.volume.begin(), worn.volume.end());
    const std::ptrdiff_t k = least - worn.volume.begin();
    std::copy(least + 1, worn.volume.end(), least);
    std::copy(worn.left.begin() + k + 1, worn.left.end(), worn.left.begin() + k);
    --kept;
  }
  worn.left[kept] = cut.left;
  worn.volume[kept] = cut.volume;
  worn.planes = kept + 1;
}

std::vector<std::int32_t> Wear::bodies() const {
  std::vector<std::int32_t> all;
  for (const Worn& worn : worn_) all.push_back(worn.body);
  return all;
}

std::vector<double> Wear::rows() const {
  std::vector<double> rows;
  for (const Worn& worn : worn_) {
    for (std::size_t k = 0; k < worn.planes; ++k) {
      const auto numbers =
          WearCut{.body = worn.body, .left = worn.left[k], .volume = worn.volume[k]}.as_numbers();
      rows.insert(rows.end(), numbers.begin(), numbers.end());
    }
  }
  return rows;
}

void Wear::restore(const Solids& solids, std::span<const double> rows) {
  place_.clear();
  worn_.clear();
  for (std::size_t k = 0; k + WearCut::numbers <= rows.size(); k += WearCut::numbers) {
    const WearCut cut = WearCut::from(rows.subspan(k).first<WearCut::numbers>());
    Worn& worn = worn_of(solids, cut.body);
    worn.left[worn.planes] = cut.left;
    worn.volume[worn.planes++] = cut.volume;
  }
}

/// Volume of the body within planes_ [m^3].
double CapFinder::volume(const Solids& solids, std::int32_t body) {
  return clipper_.overlap(solids.shapes(), body, solids.vertices(body), planes_).volume;
}

CapFinder::Cap CapFinder::find(const Solids& solids, const Wear& wear, std::int32_t body,
                               const Vec3<double>& out, double wanted) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3<double>& r : solids.vertices(body)) {
    low = std::min(low, dot(out, r));
    high = std::max(high, dot(out, r));
  }
  const std::span<const HalfSpace> worn = wear.of(body);
  planes_.assign(worn.begin(), worn.end());
  planes_.push_back({out, high});
  wanted = std::min(wanted, 0.5 * volume(solids, body));
  planes_.back() = {-1.0 * out, -low};
  // The cap above an offset falls from the whole to nothing between low and high.
  const auto above = [&](double offset) {
    planes_.back().offset = -offset;
    return volume(solids, body);
  };
  constexpr int halvings = 60;
  const auto search = [&](double level) {
    double a = low, b = high;
    for (int k = 0; k < halvings; ++k) {
      const double middle = 0.5 * (a + b);
      (above(middle) > level ? a : b) = middle;
    }
    return 0.5 * (a + b);
  };
  const double offset = search(wanted);
  return {.left = {.normal = out, .offset = offset}, .height = search(0) - offset};
}

}  // namespace floe
