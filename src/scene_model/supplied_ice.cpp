#include "scene_model/supplied_ice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/union_find.h"
#include "floe/base/item.h"
#include "scene_model/scene_model.h"
#include "scene_model/structures.h"

namespace floe {
namespace {

SheetPlan plan_of_strip(const Scene& scene) {
  SheetPlan plan = scene.sheet;
  plan.length = scene.supply.strip;
  return plan;
}

/// Number of strips in a length, which is a whole number of them to rounding.
std::int32_t strips_in(double length, double strip) {
  return static_cast<std::int32_t>(std::lround(length / strip));
}

}  // namespace

SuppliedIce::SuppliedIce(const Scene& scene, MPI_Comm comm)
    : scene_(scene),
      edge_(far_edge(scene)),
      strips_(plan_of_strip(scene), comm),
      each_(strips_.cells_of_each()),
      next_(strips_in(scene.sheet.length, scene.supply.strip)) {
  names_.resize(static_cast<std::size_t>(next_) * static_cast<std::size_t>(each_));
  std::iota(names_.begin(), names_.end(), 0);
}

/// x of the middle of a strip [m].
double SuppliedIce::middle(std::int32_t strip) const {
  return 0.5 * scene_.sheet.length - (strip + 0.5) * scene_.supply.strip;
}

std::vector<std::int32_t> SuppliedIce::present_strips() const {
  std::vector<std::int32_t> strips;
  for (const std::int32_t name : names_)
    if (strips.empty() || strips.back() != name / each_) strips.push_back(name / each_);
  return strips;
}

double SuppliedIce::energy_ratio() {
  double sum = 0;
  const std::vector<std::int32_t> strips = present_strips();
  for (const std::int32_t k : strips) sum += strips_.strip(k).energy_ratio;
  return sum / static_cast<double>(strips.size());
}

/// The cells of the present bodies. The facets of the far edge towards the next strip mark its
/// cells as those of the left side.
Tessellation SuppliedIce::cells() {
  Tessellation cells;
  const std::vector<std::int32_t> strips = present_strips();
  std::map<std::int32_t, std::vector<std::int32_t>> index;  // of each cell of a strip; -1: gone
  for (const std::int32_t k : strips) index[k].assign(static_cast<std::size_t>(each_), -1);
  for (std::size_t b = 0; b < names_.size(); ++b)
    item(index[names_[b] / each_], names_[b] % each_) = static_cast<std::int32_t>(b);
  cells.offset.assign(1, 0);
  edge_areas_.clear();
  double whole = 0;
  for (const std::int32_t k : strips) {
    const StripCells& strip = strips_.strip(k);
    const double x = middle(k);
    const std::vector<std::int32_t>& own = index[k];
    std::vector<std::uint8_t> sides = strip.sides;
    std::vector<double> open(static_cast<std::size_t>(each_), 0.0);  // width towards the next
    for (const Facet& facet : strip.to_next) {
      if (k + 1 != next_) break;
      item(sides, facet.cells[0]) |= side_left;
      item(open, facet.cells[0]) += facet.width;
      whole += facet.width;
    }
    for (std::int32_t c = 0; c < each_; ++c) {
      if (item(own, c) < 0) continue;
      for (std::int32_t v = item(strip.offset, c); v < item(strip.offset, c + 1); ++v)
        cells.vertices.push_back({item(strip.vertices, v)[0] + x, item(strip.vertices, v)[1]});
      cells.offset.push_back(static_cast<std::int32_t>(cells.vertices.size()));
      cells.generators.push_back({x, 0});
      cells.sides.push_back(item(sides, c));
      if (item(open, c) > 0) edge_areas_.push_back({item(own, c), item(open, c)});
    }
    const auto join = [&](const std::vector<Facet>& facets, const std::vector<std::int32_t>& to) {
      for (const auto& [pair, width, shift] : facets) {
        const std::int32_t a = item(own, pair[0]), b = item(to, pair[1]);
        if (a >= 0 && b >= 0) cells.facets.push_back({{a, b}, width, shift});
      }
    };
    join(strip.inside, own);
    const auto other = index.find(k + 1);
    if (other != index.end()) join(strip.to_next, other->second);
  }
  std::sort(cells.facets.begin(), cells.facets.end(),
            [](const Facet& a, const Facet& b) { return a.cells < b.cells; });
  // The edge winds; together its parts have the area of the sheet's section.
  for (EdgeArea& edge : edge_areas_) edge.area *= scene_.sheet.width * scene_.thickness / whole;
  strips_.forget(strips);
  return cells;
}

Lattice SuppliedIce::lattice() {
  Lattice lattice = make_sheet(cells(), section_of(scene_));
  beams_ = lattice.beams.bodies;
  auto& all = lattice.sets["all"];
  all.resize(names_.size());
  std::iota(all.begin(), all.end(), 0);
  if (scene_.inertia_factor != 1) {
    for (Point3& moments : lattice.bodies.inertia) moments = scene_.inertia_factor * moments;
  }
  add_structures(scene_, lattice);
  names_of_bodies_ = names_;
  const auto structures = static_cast<std::int32_t>(scene_.structures.size());
  for (std::int32_t k = 0; k < structures; ++k)
    names_of_bodies_.push_back(std::numeric_limits<std::int32_t>::max() - structures + k);
  return lattice;
}

bool SuppliedIce::is_due(double way) const {
  return way >= static_cast<double>(looks_ + 1) * scene_.supply.strip;
}

bool SuppliedIce::can_join() const {
  return (next_ + 1) * scene_.supply.strip <= scene_.supply.length * (1 + 1e-12);
}

std::vector<std::int32_t> SuppliedIce::leaving(const IceNow& now) const {
  std::vector<std::int32_t> gone;
  if (!scene_.supply.region) return gone;
  const auto& [x0, x1, y0, y1, z0, z1] = *scene_.supply.region;
  UnionFind pieces(names_.size());
  for (std::size_t m = 0; m < beams_.size(); ++m) {
    if (!std::binary_search(now.broken.begin(), now.broken.end(), static_cast<std::int32_t>(m)))
      pieces.unite(beams_[m][0], beams_[m][1]);
  }
  const std::vector<std::int32_t> piece = pieces.representatives();
  std::vector<std::uint8_t> stays(names_.size(), 0);  // by representative
  for (std::size_t b = 0; b < names_.size(); ++b) {
    const Point3& p = now.places[b];
    const bool inside = p.x >= x0 && p.x <= x1 && p.y >= y0 && p.y <= y1 && p.z >= z0 && p.z <= z1;
    // The far edge moves as it is told to, wherever it is.
    if (inside || names_[b] / each_ + 1 == next_) item(stays, piece[b]) = 1;
  }
  for (std::size_t b = 0; b < names_.size(); ++b)
    if (item(stays, piece[b]) == 0) gone.push_back(static_cast<std::int32_t>(b));
  return gone;
}

/// Changes the names by work, and makes the lattice anew.
template <class Work>
SuppliedIce::Change SuppliedIce::changed(Work&& work) {
  const std::vector<std::int32_t> names = names_;
  const std::vector<std::array<std::int32_t, 2>> beams = beams_;
  work();
  Change change{.lattice = lattice(), .indices = {}};
  Renumbering& after = change.indices;
  const auto place = [](const auto& sorted, const auto& value) {
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), value);
    return found != sorted.end() && *found == value
               ? static_cast<std::int32_t>(found - sorted.begin())
               : -1;
  };
  for (const std::int32_t name : names) after.bodies.push_back(place(names_, name));
  for (std::size_t k = 0; k < scene_.structures.size(); ++k)  // behind all ice
    after.bodies.push_back(static_cast<std::int32_t>(names_.size() + k));
  for (const auto& [i, j] : beams) {
    const std::int32_t a = item(after.bodies, i), b = item(after.bodies, j);
    after.beams.push_back(a < 0 || b < 0 ? -1 : place(beams_, std::array<std::int32_t, 2>{a, b}));
  }
  return change;
}

SuppliedIce::Change SuppliedIce::leave(const std::vector<std::int32_t>& gone) {
  return changed([&] {
    std::vector<std::int32_t> kept;
    for (std::size_t b = 0; b < names_.size(); ++b)
      if (!std::binary_search(gone.begin(), gone.end(), static_cast<std::int32_t>(b)))
        kept.push_back(names_[b]);
    names_ = std::move(kept);
  });
}

SuppliedIce::Change SuppliedIce::join(double strain) {
  offset_ += strain * scene_.supply.strip;
  return changed([&] {
    for (std::int32_t c = 0; c < each_; ++c) names_.push_back(next_ * each_ + c);
    ++next_;
  });
}

void SuppliedIce::persist(Archive& archive) {
  std::vector<double> names(names_.begin(), names_.end());
  std::int64_t next = next_;
  archive.common("names", names);
  archive.common("next_strip", next, 1);
  archive.common("looks", looks_);
  archive.common("offset", offset_);
  if (!archive.loading()) return;
  names_.clear();
  for (const double name : names) names_.push_back(static_cast<std::int32_t>(name));
  next_ = static_cast<std::int32_t>(next);
}

Boundary far_edge(const Scene& scene) {
  if (scene.supply.absorbs) {
    Boundary behind;
    behind.fixed = {true, true, false, false, false, false};
    behind.velocity = scene.supply.velocity;
    behind.ramp = scene.supply.ramp;
    return behind;
  }
  return *std::find_if(scene.boundaries.begin(), scene.boundaries.end(),
                       [](const Boundary& b) { return b.set == "left" && b.fixed[0]; });
}

}  // namespace floe
