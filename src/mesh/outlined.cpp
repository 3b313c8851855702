// Cells of a sheet of any outline: those of rectangles, fitted to the outline's edges, as far as
// they lie inside.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "floe/base/item.h"
#include "floe/geometry/polyhedron.h"
#include "floe/mesh/cuts.h"
#include "mesh/cut_generators.h"

namespace floe {
namespace {

constexpr double margin = 3;  ///< over l, of the meshed rectangle around a polygon

std::uint8_t side_of(const Point2& normal) {
  constexpr double rounding = 1e-9;  // edges at 45 degrees belong to left or right
  if (std::abs(normal[0]) >= (1 - rounding) * std::abs(normal[1]))
    return normal[0] < 0 ? side_left : side_right;
  return normal[1] < 0 ? side_bottom : side_top;
}

Point2 from_box(const MeshedBox& box, const Point2& p) {
  const auto& [c, s] = box.axis;
  return {box.centre[0] + (c * p[0] - s * p[1]), box.centre[1] + (s * p[0] + c * p[1])};
}
Point2 to_box(const MeshedBox& box, const Point2& p) {
  const auto& [c, s] = box.axis;
  const double x = p[0] - box.centre[0], y = p[1] - box.centre[1];
  return {c * x + s * y, c * y - s * x};
}

/// The sides of a cell of a box that has been turned.
std::uint8_t turned(std::uint8_t sides, const MeshedBox& box) {
  const auto& [c, s] = box.axis;
  std::uint8_t result = 0;
  if (sides & side_left) result |= side_of({-c, -s});
  if (sides & side_right) result |= side_of({c, s});
  if (sides & side_bottom) result |= side_of({s, -c});
  if (sides & side_top) result |= side_of({-s, c});
  return result;
}

/// Appends the cells inside a polygon.
/// \param fitted  cells that end on the polygon, in the frame of its box
/// \param index  of the polygon in its outline
/// \param cut_of_line  of the fitted lines, to which those of `fitted` are added: per line, its cut
void keep_inside(const FittedCells& fitted, const RingedPolygon& polygon, std::int32_t index,
                 const MeshedBox& box, const std::vector<std::size_t>& cut_of_line,
                 OutlinedCells& kept) {
  const Tessellation& t = fitted.cells;
  Tessellation& all = kept.cells;
  std::vector<std::int32_t> number(t.generators.size(), -1);
  for (std::size_t k = 0; k < t.generators.size(); ++k) {
    const Point2 z = from_box(box, t.generators[k]);
    if (!box.is_polygon && !contains(polygon, z)) continue;
    number[k] = static_cast<std::int32_t>(all.generators.size());
    all.generators.push_back(z);
    for (std::int32_t v = t.offset[k]; v < t.offset[k + 1]; ++v)
      all.vertices.push_back(from_box(box, item(t.vertices, v)));
    all.offset.push_back(static_cast<std::int32_t>(all.vertices.size()));
    all.sides.push_back(box.is_polygon ? turned(t.sides[k], box) : 0);
    kept.polygon.push_back(index);
  }
  for (const Facet& facet : t.facets) {
    const auto [a, b] = facet.cells;
    const std::int32_t i = item(number, a), j = item(number, b);
    if (i >= 0 && j >= 0) {
      all.facets.push_back({{i, j}, facet.width});
    } else if (i >= 0 || j >= 0) {  // on the outline: halfway between images of each other
      const Point2 &in = item(t.generators, i >= 0 ? a : b),
                   &out = item(t.generators, i >= 0 ? b : a);
      item(all.sides, std::max(i, j)) |= side_of({out[0] - in[0], out[1] - in[1]});
    }
  }
  all.degenerate += t.degenerate;
  for (std::size_t k = 0; k < cut_of_line.size(); ++k) {
    const FittedCut& part = fitted.cuts[fitted.cuts.size() - cut_of_line.size() + k];
    FittedCut& cut = kept.cuts[cut_of_line[k]];
    cut.length += part.length, cut.followed += part.followed;
    for (const auto& [a, b] : part.pairs)
      if (item(number, a) >= 0 && item(number, b) >= 0)
        cut.pairs.push_back({item(number, a), item(number, b)});
  }
}

/// The part of a convex polygon on each side of a line: where a p_x + b p_y < c, and the rest. Both
/// have the same corners on the line.
std::array<Ring, 2> halves(const Ring& ring, const Point2& normal, double c) {
  std::array<Ring, 2> parts;
  const auto height = [&](const Point2& p) { return normal[0] * p[0] + normal[1] * p[1] - c; };
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Point2 &p = ring[k], &q = ring[(k + 1) % ring.size()];
    const double hp = height(p), hq = height(q);
    parts[hp < 0 ? 0 : 1].push_back(p);
    if ((hp < 0) == (hq < 0)) continue;
    const double t = hp / (hp - hq);
    const Point2 on{p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])};
    parts[0].push_back(on), parts[1].push_back(on);
  }
  for (Ring& part : parts) {  // a corner on the line
    part.erase(std::unique(part.begin(), part.end()), part.end());
    if (part.size() > 1 && part.front() == part.back()) part.pop_back();
  }
  return parts;
}

/// Direction in which a polygon extends most.
Point2 long_axis(const Ring& ring) {
  const PlanProperties p = plan_properties(ring);
  const double angle = std::atan2(2 * p.xy, p.xx - p.yy) / 2;
  return {std::cos(angle), std::sin(angle)};
}

/// Cuts a convex polygon into cells of one area, one behind the other along its long axis.
std::vector<Ring> row_of_cells(const Ring& ring, int number) {
  const Point2 axis = long_axis(ring);
  const auto along = [&](const Point2& p) { return axis[0] * p[0] + axis[1] * p[1]; };
  const double each = plan_properties(ring).area / number;
  std::vector<Ring> cells;
  Ring rest = ring;
  for (int k = 1; k < number; ++k) {
    double low = along(rest.front()), high = low;
    for (const Point2& p : rest) low = std::min(low, along(p)), high = std::max(high, along(p));
    for (int step = 0; step < 60; ++step) {
      const double middle = (low + high) / 2;
      const Ring part = halves(rest, axis, middle)[0];
      (part.size() < 3 || plan_properties(part).area < each ? low : high) = middle;
    }
    std::array<Ring, 2> parts = halves(rest, axis, high);
    cells.push_back(std::move(parts[0]));
    rest = std::move(parts[1]);
  }
  cells.push_back(std::move(rest));
  return cells;
}

bool has_edge(const Ring& ring, const Point2& from, const Point2& to) {
  for (std::size_t k = 0; k < ring.size(); ++k)
    if (ring[k] == from && ring[(k + 1) % ring.size()] == to) return true;
  return false;
}

/// Appends a polygon as cells in a row.
void add_row(const Ring& ring, int number, std::int32_t index, OutlinedCells& kept) {
  Tessellation& all = kept.cells;
  const std::vector<Ring> cells = row_of_cells(ring, number);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Ring& cell = cells[k];
    const auto here = static_cast<std::int32_t>(all.generators.size());
    std::uint8_t sides = 0;
    for (std::size_t v = 0; v < cell.size(); ++v) {
      const Point2 &a = cell[v], &b = cell[(v + 1) % cell.size()];
      if (k > 0 && has_edge(cells[k - 1], b, a)) continue;
      if (k + 1 < cells.size() && has_edge(cells[k + 1], b, a))
        all.facets.push_back({{here, here + 1}, std::hypot(b[0] - a[0], b[1] - a[1])});
      else
        sides |= side_of({b[1] - a[1], a[0] - b[0]});
    }
    all.generators.push_back(plan_properties(cell).centroid);
    all.vertices.insert(all.vertices.end(), cell.begin(), cell.end());
    all.offset.push_back(static_cast<std::int32_t>(all.vertices.size()));
    all.sides.push_back(sides);
    kept.polygon.push_back(index);
  }
}

/// Sets the measures of quality of the cells (see Tessellation).
void measure(OutlinedCells& cells, const SheetPlan& plan) {
  Tessellation& t = cells.cells;
  struct Group {  // of cells that should be of one size
    double area = 0, cells = 0;
  };
  std::vector<Group> groups(plan.of_polygon.empty() ? 1 : plan.of_polygon.size());
  double energy = 0, move = 0, best = 0;
  for (std::size_t k = 0; k < t.generators.size(); ++k) {
    const std::span cell(t.vertices.data() + t.offset[k], t.vertices.data() + t.offset[k + 1]);
    const PlanProperties p = plan_properties(cell);
    const double x = p.centroid[0] - t.generators[k][0], y = p.centroid[1] - t.generators[k][1];
    Group& group = plan.of_polygon.empty() ? groups.front() : item(groups, cells.polygon[k]);
    group.area += p.area, group.cells += 1;
    energy += p.xx + p.yy + p.area * (x * x + y * y);
    move = std::max(move, std::hypot(x, y) / plan.size_of(cells.polygon[k]));
  }
  for (const Group& group : groups)
    if (group.cells > 0)
      best += 5 / (18 * std::numbers::sqrt3) * group.area * group.area / group.cells;
  t.energy_ratio = energy / best;
  t.largest_move = move;
}

/// The edges of a polygon, ring after ring, in the frame of its box.
std::vector<CutLine> edges_of(const RingedPolygon& polygon, const MeshedBox& box) {
  std::vector<CutLine> lines;
  for (const Ring& ring : polygon) {
    for (std::size_t k = 0; k < ring.size(); ++k)
      lines.push_back({to_box(box, ring[k]), to_box(box, ring[(k + 1) % ring.size()])});
  }
  return lines;
}

/// The plan without its outline.
SheetPlan rules_of(const SheetPlan& plan) {
  return {.element_size = plan.element_size,
          .seed = plan.seed,
          .relaxation = plan.relaxation,
          .iterations = plan.iterations,
          .tolerance = plan.tolerance};
}

bool is_convex(const Ring& ring) {
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Point2 &a = ring[k], &b = ring[(k + 1) % ring.size()], &c = ring[(k + 2) % ring.size()];
    if ((b[0] - a[0]) * (c[1] - b[1]) < (b[1] - a[1]) * (c[0] - b[0])) return false;
  }
  return true;
}

/// The area of a polygon without its holes over the mean area of cells.
double cells_in(const RingedPolygon& polygon, double l) {
  return 2 / (std::numbers::sqrt3 * l * l) * plan_properties(polygon.front()).area;
}

/// The rectangle around a polygon, whose sides are multiples of l, so that floes of about one size
/// share a relaxed mesh.
MeshedBox rectangle_around(const RingedPolygon& polygon, const SheetPlan& rules) {
  const auto [least, most] = box_of(polygon);
  MeshedBox box{rules, {(least[0] + most[0]) / 2, (least[1] + most[1]) / 2}};
  const double l = rules.element_size;
  box.plan.length = (std::ceil((most[0] - least[0]) / l) + 2 * margin) * l;
  box.plan.width = (std::ceil((most[1] - least[1]) / l) + 2 * margin) * l;
  return box;
}

/// Whether rows of cells find room along all edges of a polygon.
bool has_room(const RingedPolygon& polygon, const SheetPlan& plan) {
  const MeshedBox box = rectangle_around(polygon, rules_of(plan));
  const mesh::CutGraph graph = mesh::make_cut_graph(box.plan, edges_of(polygon, box));
  const mesh::CutGenerators placed = mesh::place_generators(graph, box.plan);
  return std::none_of(placed.pairs.begin(), placed.pairs.end(),
                      [](const auto& pairs) { return pairs.empty(); });
}

/// \param rules  of this polygon
/// \param own  empty, or the polygon's plan
MeshedBox box_of_plan(const RingedPolygon& polygon, const SheetPlan& rules,
                      std::span<const PolygonPlan> own) {
  if (!own.empty() && own.front().rectangle) {
    const auto& [length, width, centre, axis] = *own.front().rectangle;
    MeshedBox box{rules, centre, axis, true};
    box.plan.length = length, box.plan.width = width;
    return box;
  }
  MeshedBox box = rectangle_around(polygon, rules);
  if (cells_in_a_row(polygon, rules) > 0)  // its box is not used
    box.plan.length = box.plan.width = rules.element_size;
  return box;
}

/// The lengths, element size and seed of a rectangle, by which boxes share a relaxed mesh.
using MeshKey = std::tuple<double, double, double, std::uint64_t>;
MeshKey key_of(const SheetPlan& plan) {
  return {plan.length, plan.width, plan.element_size, plan.seed};
}

/// Mirrors the generators of a rectangle that others have used already: in x, in y, in both, so
/// that floes of one size do not all have the same cells.
void mirror(std::vector<Point2>& generators, int use) {
  const double x = use % 2 == 0 ? 1 : -1, y = use / 2 % 2 == 0 ? 1 : -1;
  for (Point2& z : generators) z = {x * z[0], y * z[1]};
}

}  // namespace

bool is_one_cell(const RingedPolygon& polygon, double l) {
  constexpr double largest = 1.5;  // over the mean area of cells
  constexpr double longest = 3;    // over l
  constexpr std::size_t most_corners = 12;
  const auto [least, most] = box_of(polygon);
  return polygon.size() == 1 && polygon.front().size() <= most_corners &&
         std::hypot(most[0] - least[0], most[1] - least[1]) <= longest * l &&
         cells_in(polygon, l) <= largest && is_convex(polygon.front());
}

int cells_in_a_row(const RingedPolygon& polygon, const SheetPlan& plan) {
  constexpr double most = 20, each = 1.5;  // over the mean area of cells
  if (is_one_cell(polygon, plan.element_size)) return 1;
  const double cells = cells_in(polygon, plan.element_size);
  if (polygon.size() != 1 || cells > most || !is_convex(polygon.front()) || has_room(polygon, plan))
    return 0;
  return std::max(1, static_cast<int>(std::lround(cells / each)));
}

bool can_be_followed(const RingedPolygon& polygon, const SheetPlan& plan) {
  return is_one_cell(polygon, plan.element_size) || has_room(polygon, plan);
}

std::vector<MeshedBox> meshed_boxes(const SheetPlan& plan) {
  if (plan.outline.empty()) return {{plan, {}}};
  SheetPlan rules = rules_of(plan);
  std::vector<MeshedBox> boxes;
  for (std::size_t k = 0; k < plan.outline.polygons().size(); ++k) {
    std::span<const PolygonPlan> own;
    if (!plan.of_polygon.empty()) {
      own = {&plan.of_polygon[k], 1};
      rules.element_size = own.front().element_size, rules.seed = own.front().seed;
    }
    boxes.push_back(box_of_plan(plan.outline.polygons()[k], rules, own));
  }
  return boxes;
}

std::vector<Tessellation> tessellate(const std::vector<MeshedBox>& boxes, MPI_Comm comm,
                                     const std::function<void(int, double)>& on_iteration) {
  std::map<MeshKey, std::size_t> of_size;
  std::vector<Tessellation> cells;
  for (const MeshedBox& box : boxes) {
    const auto [same, is_new] = of_size.try_emplace(key_of(box.plan), cells.size());
    Tessellation made = is_new ? tessellate(box.plan, comm, on_iteration) : cells[same->second];
    cells.push_back(std::move(made));
  }
  return cells;
}

OutlinedCells fit_to_outline(const SheetPlan& plan, std::vector<Tessellation> relaxed,
                             std::span<const CutLine> cuts, MPI_Comm comm) {
  const std::vector<MeshedBox> boxes = meshed_boxes(plan);
  OutlinedCells result;
  result.cells.offset.assign(1, 0);
  result.cuts.resize(cuts.size());
  std::map<MeshKey, int> uses;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const RingedPolygon& polygon = plan.outline.polygons()[k];
    const MeshedBox& box = boxes[k];
    std::vector<CutLine> lines;
    if (!box.is_polygon) lines = edges_of(polygon, box);
    const std::size_t edges = lines.size();
    std::vector<std::size_t> cut_of_line;
    result.cells.iterations = std::max(result.cells.iterations, relaxed[k].iterations);
    const auto index = static_cast<std::int32_t>(k);
    const int in_a_row = box.is_polygon ? 0 : cells_in_a_row(polygon, box.plan);
    if (in_a_row > 0) {
      for (std::size_t c = 0; c < cuts.size(); ++c)
        for (const auto& [from, to] : clipped(polygon, cuts[c]))
          result.cuts[c].length += std::hypot(to[0] - from[0], to[1] - from[1]);
      add_row(polygon.front(), in_a_row, index, result);
      continue;
    }
    for (std::size_t c = 0; c < cuts.size(); ++c) {
      for (const CutLine& part : clipped(polygon, cuts[c])) {
        lines.push_back({to_box(box, part.from), to_box(box, part.to)});
        cut_of_line.push_back(c);
      }
    }
    if (!box.is_polygon) mirror(relaxed[k].generators, uses[key_of(box.plan)]++);
    const FittedCells fitted = fit_to_cuts(box.plan, std::move(relaxed[k]), lines, comm);
    std::size_t ring = 0, first = 0;
    for (std::size_t e = 0; e < edges; ++e) {
      if (e == first + polygon[ring].size()) first = e, ++ring;
      const Point2 &a = lines[e].from, &b = lines[e].to;
      const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
      if (std::abs(fitted.cuts[e].followed - length) <= 1e-6 * length) continue;
      const std::size_t n = polygon[ring].size(), at = e - first;
      result.unfollowed.push_back({k, ring, at, {polygon[ring][at], polygon[ring][(at + 1) % n]}});
    }
    if (result.unfollowed.empty()) keep_inside(fitted, polygon, index, box, cut_of_line, result);
  }
  if (result.unfollowed.empty())
    measure(result, plan);
  else
    result.cells = {};
  return result;
}

std::vector<BoundaryEdge> boundary_edges(const Tessellation& cells) {
  struct Hash {
    std::size_t operator()(const std::array<double, 4>& edge) const {
      std::size_t hash = 0;
      for (const double x : edge)
        hash = (hash ^ std::hash<double>()(x)) * 0x9E3779B97F4A7C15U + (hash >> 29U);
      return hash;
    }
  };
  const auto key = [](const Point2& p, const Point2& q) {
    return std::array{p[0], p[1], q[0], q[1]};
  };
  const auto each = [&](auto&& visit) {
    for (std::int32_t k = 0; k + 1 < static_cast<std::int32_t>(cells.offset.size()); ++k) {
      const std::int32_t begin = item(cells.offset, k), end = item(cells.offset, k + 1);
      for (std::int32_t v = begin; v < end; ++v)
        visit(k, item(cells.vertices, v), item(cells.vertices, v + 1 < end ? v + 1 : begin));
    }
  };
  std::unordered_map<std::array<double, 4>, int, Hash> directed;
  directed.reserve(cells.vertices.size());
  each([&](std::int32_t, const Point2& p, const Point2& q) { ++directed[key(p, q)]; });
  std::vector<BoundaryEdge> edges;
  each([&](std::int32_t k, const Point2& p, const Point2& q) {
    if (!directed.contains(key(q, p))) edges.push_back({k, p, q});
  });
  return edges;
}

}  // namespace floe
