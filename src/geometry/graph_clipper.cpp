#include "geometry/graph_clipper.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/simd.h"
#include "geometry/facet_integrals.h"

namespace floe {
namespace {

constexpr std::size_t low = Points::low;
constexpr std::size_t most_planes = std::numeric_limits<std::uint8_t>::max();

constexpr std::uint64_t bit(std::size_t k) { return std::uint64_t{1} << k; }
/// Returns a mask of the first n bits, n < 64.
constexpr std::uint64_t first_bits(std::size_t n) { return bit(n) - 1; }
constexpr std::size_t lowest_bit(std::uint64_t mask) {
  return static_cast<std::size_t>(std::countr_zero(mask));
}
constexpr std::size_t count(std::uint64_t mask) {
  return static_cast<std::size_t>(std::popcount(mask));
}
constexpr std::uint8_t byte(std::size_t k) { return static_cast<std::uint8_t>(k); }

/// Calls `use` with the number of each bit that is 1.
template <class Use>
void for_each_bit(std::uint64_t mask, Use use) {
  for (; mask != 0; mask &= mask - 1) use(lowest_bit(mask));
}

FewLanes height(const HalfSpace& plane, const Points& points, std::size_t slot) {
  const Vec3<FewLanes> r{load_few(points.x.data() + slot), load_few(points.y.data() + slot),
                         load_few(points.z.data() + slot)};
  return dot(plane.normal, r);
}

FewLanes load_anywhere(const double* p) { return {p, std::experimental::element_aligned}; }

/// Fills the list from `begin` to `end` up to a whole number of registers with the apex; returns
/// the new end.
Triple* pad(const Triple* begin, Triple* end, std::uint8_t apex) {
  while ((end - begin) % static_cast<std::ptrdiff_t>(few_lanes) != 0) *end++ = {apex, apex, apex};
  return end;
}

}  // namespace

template <class Visit>
void GraphClipper::Planes::for_each_but_first(Visit visit) const {
  std::size_t number = 0;
  for (const HalfSpace& plane : b) {
    if (number != first && !visit(plane, number, true)) return;
    ++number;
  }
  for (const HalfSpace& plane : further.b) {
    if (!visit(plane, number++, true)) return;
  }
  for (const HalfSpace& plane : further.a) {
    if (!visit(plane, number++, false)) return;
  }
}

void GraphClipper::place(const VertexLists& vertices, const Triad<double>& axes,
                         const Vec3<double>& x) {
  vertices_ = vertices.number;
  origin_of_a_ = x;
  for (std::size_t k = 0; k < vertices_; k += few_lanes) {
    const Vec3<FewLanes> r{load_anywhere(vertices.x + k), load_anywhere(vertices.y + k),
                           load_anywhere(vertices.z + k)};
    const auto coordinate = [&](double origin, double e1, double e2, double e3) {
      return origin + (r.x * e1 + r.y * e2 + r.z * e3);
    };
    const auto put = [&](const FewLanes& c, std::array<double, Points::slots>& list) {
      c.copy_to(list.data() + low + k, std::experimental::vector_aligned);
    };
    put(coordinate(x.x, axes.e1.x, axes.e2.x, axes.e3.x), points_.x);
    put(coordinate(x.y, axes.e1.y, axes.e2.y, axes.e3.y), points_.y);
    put(coordinate(x.z, axes.e1.z, axes.e2.z, axes.e3.z), points_.z);
  }
}

bool GraphClipper::overlap(const EdgeGraph& a, std::span<const HalfSpace> planes, bool with_patch,
                           const FurtherPlanes& further, CutRecord& record, Overlap& found) {
  replayed_ = false;
  Planes all{.b = planes, .further = further};
  if (all.number() > most_planes) return false;
  all.first = first_plane(planes);
  const bool known = record.cuts > 0 && record.first == all.first &&
                     record.planes == all.number() && record.further_of_b == further.b.size();
  replayed_ = known && replay(all, record);
  if (!replayed_ && !clip(a, all, record)) return false;
  if (alive_ != 0) set_integrals(found, points_, record.facets(), with_patch);
  return true;
}

void GraphClipper::facets_on_b(const CutRecord& record, FacetsOnB& facets) const {
  facets.clear();
  const auto at = [&](std::uint8_t slot) {
    return Vec3<double>{points_.x[slot], points_.y[slot], points_.z[slot]};
  };
  const Facets of = record.facets();
  for (const Triple& t : of.triangles.first(of.on_b))
    facets.corners.insert(facets.corners.end(), {at(t.a), at(t.b), at(t.c)});
  for (const Triple& edge : of.rim)
    if (edge.a != edge.b) facets.edges.push_back({at(edge.a), at(edge.b)});
}

/// Returns the plane of B farthest below A's origin: it removes most of A as a rule, and the later
/// cuts are then small.
std::uint8_t GraphClipper::first_plane(std::span<const HalfSpace> planes) const {
  std::size_t first = 0;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const double height_of_a = dot(planes[k].normal, origin_of_a_) - planes[k].offset;
    if (height_of_a > highest) {
      highest = height_of_a;
      first = k;
    }
  }
  return byte(first);
}

/// Sets the distances of the points in the slots from `begin` to `end`, at least; returns a mask of
/// the slots that are inside.
std::uint64_t GraphClipper::inside(const HalfSpace& plane, std::size_t begin, std::size_t end) {
  std::uint64_t mask = 0;
  for (std::size_t k = begin; k < end; k += few_lanes) {
    const FewLanes distance = height(plane, points_, k) - plane.offset;
    distance.copy_to(distance_.data() + k, std::experimental::vector_aligned);
    mask |= not_above_zero(distance) << k;
  }
  return mask;
}

/// Returns a mask of A's placed vertices that are inside.
std::uint32_t GraphClipper::placed_inside(const HalfSpace& plane) {
  return static_cast<std::uint32_t>(inside(plane, low, low + vertices_) >> low &
                                    first_bits(vertices_));
}

/// Returns a mask of the vertices that are left and inside.
std::uint32_t GraphClipper::left_inside(const HalfSpace& plane) {
  const auto end = static_cast<std::size_t>(std::bit_width(alive_));
  return static_cast<std::uint32_t>(inside(plane, 0, end) & alive_);
}

/// Copies the vertices of A that the first cut keeps, and their distances, to the lowest slots.
void GraphClipper::settle(std::uint32_t inside) {
  std::size_t to = 0;
  for_each_bit(inside, [&](std::size_t vertex) {
    const std::size_t from = low + vertex;
    points_.x[to] = points_.x[from];
    points_.y[to] = points_.y[from];
    points_.z[to] = points_.z[from];
    distance_[to++] = distance_[from];
  });
}

/// Makes new vertices; returns a mask of them. The inside end has a distance of at most 0, the
/// outside end one above 0, so no divisor vanishes.
std::uint64_t GraphClipper::make_points(std::span<const Triple> points) {
  std::uint64_t made = 0;
  for (const auto [u, v, w] : points) {
    const double t = distance_[u] / (distance_[u] - distance_[v]);  // in [0, 1)
    points_.x[w] = points_.x[u] + t * (points_.x[v] - points_.x[u]);
    points_.y[w] = points_.y[u] + t * (points_.y[v] - points_.y[u]);
    points_.z[w] = points_.z[u] + t * (points_.z[v] - points_.z[u]);
    made |= bit(w);
  }
  return made;
}

/// Repeats the arithmetic of a record. Returns false if a plane leaves other vertices inside.
bool GraphClipper::replay(const Planes& planes, const CutRecord& record) {
  const CutRecord::Cut* cut = record.cut.data();
  const CutRecord::Cut* const end = cut + record.cuts;
  const Triple* point = record.triple.data();
  const auto repeat = [&](std::uint64_t inside) {
    const Triple* const last = record.triple.data() + cut++->points;
    alive_ = inside | make_points({point, last});
    point = last;
  };
  const std::uint32_t placed = placed_inside(planes.b[planes.first]);
  if (placed != cut->inside) return false;
  settle(placed);
  repeat(first_bits(count(placed)));
  bool same = true;
  planes.for_each_but_first([&](const HalfSpace& plane, std::size_t number, bool) {
    const bool cuts = cut != end && cut->plane == number;
    const std::uint64_t inside = left_inside(plane);
    same = inside == (cuts ? cut->inside : alive_);
    if (same && cuts) repeat(inside);
    return same && alive_ != 0;
  });
  return same;
}

/// The full pass. Makes a record; returns false if there is no room.
bool GraphClipper::clip(const EdgeGraph& a, const Planes& planes, CutRecord& record) {
  record.cuts = record.points = 0;
  record.first = planes.first;
  record.planes = byte(planes.number());
  record.further_of_b = byte(planes.further.b.size());
  const std::uint32_t placed = placed_inside(planes.b[planes.first]);
  start(a, placed);
  if (!cut(of_a_, true)) return false;
  bool noted = note_cut(record, placed, planes.first);
  bool room = true;
  planes.for_each_but_first([&](const HalfSpace& plane, std::size_t number, bool on_b) {
    const std::uint32_t inside = left_inside(plane);
    if (inside == alive_) return true;
    room = cut(inside, on_b);
    if (!room) return false;
    noted = noted && note_cut(record, inside, number);
    return alive_ != 0;
  });
  if (!room || !noted) record.cuts = record.points = 0;
  if (room && alive_ != 0) note_facets(record);
  return room;
}

/// Begins the graph as that of A before the first cut. The vertices that stay are settled.
void GraphClipper::start(const EdgeGraph& a, std::uint32_t inside) {
  settle(inside);
  for (std::size_t h = 0; h < 2 * std::size_t{a.edges}; ++h) origin_[h] = byte(low + a.origin[h]);
  next_ = a.next;
  on_b_ = {};
  edges_ = a.edges < 64 ? first_bits(a.edges) : ~std::uint64_t{0};
  std::copy(a.star.begin(), a.star.end(), star_.begin() + low);
  std::size_t to = 0;
  for_each_bit(inside, [&](std::size_t vertex) {
    star_[to] = a.star[vertex];
    for_each_bit(a.star[vertex], [&](std::size_t e) {
      origin_[a.origin[2 * e] == vertex ? 2 * e : 2 * e + 1] = byte(to);
    });
    ++to;
  });
  of_a_ = first_bits(to);
  alive_ = of_a_ | (first_bits(vertices_) & ~std::uint64_t{inside}) << low;
}

/// Clips the graph; returns false if there is no room.
bool GraphClipper::cut(std::uint64_t inside, bool on_b) {
  new_ = 0;
  // An edge with both ends outside is in two stars, one that crosses the plane is in one.
  std::uint64_t crossing = 0, outside = 0;
  for_each_bit(alive_ & ~inside, [&](std::size_t vertex) {
    crossing ^= star_[vertex];
    outside |= star_[vertex];
  });
  const std::size_t number = count(crossing);
  const std::size_t free_slots = low - count(alive_ & first_bits(low));
  if (number > free_slots || number > EdgeGraph::most_edges - count(edges_)) return false;
  add_vertices(crossing, inside);
  add_edges(crossing, on_b);
  alive_ = inside | make_points({new_points_.data(), new_});
  of_a_ &= inside;
  edges_ &= ~(outside & ~crossing);
  return true;
}

/// Ends each crossing edge at a new vertex.
void GraphClipper::add_vertices(std::uint64_t crossing, std::uint64_t inside) {
  std::uint64_t free = ~alive_;
  for_each_bit(crossing, [&](std::size_t e) {
    const std::size_t begins_inside = inside >> origin_[2 * e] & 1;
    const std::size_t leaves = 2 * e + (1 - begins_inside), enters = 2 * e + begins_inside;
    const std::size_t w = lowest_bit(free);
    free &= free - 1;
    new_points_[new_++] = {origin_[leaves], origin_[enters], byte(w)};
    origin_[enters] = byte(w);
    star_[w] = bit(e);
  });
}

/// Adds the edges along the plane: one for each crossing half-edge that leaves, in its face, and
/// its twin in the cap. Crossing edge number k has the new vertex number k.
void GraphClipper::add_edges(std::uint64_t crossing, bool on_b) {
  PerHalfEdge arrives, departs;  // per crossing edge: half-edges of the cap at its new vertex
  std::uint64_t free = ~edges_;
  std::size_t k = 0;
  for_each_bit(crossing, [&](std::size_t e) {
    const std::uint8_t w = new_points_[k++].c;
    const std::size_t leaves = origin_[2 * e] == w ? 2 * e + 1 : 2 * e;
    std::size_t enters = next_[leaves];
    while ((crossing >> (enters / 2) & 1) == 0) enters = next_[enters];
    const std::size_t added = lowest_bit(free);
    free &= free - 1;
    edges_ |= bit(added);
    const std::size_t in_face = 2 * added, in_cap = 2 * added + 1;
    origin_[in_face] = w;
    origin_[in_cap] = origin_[enters];
    star_[w] |= bit(added);
    star_[origin_[enters]] |= bit(added);
    next_[leaves] = byte(in_face);
    next_[in_face] = byte(enters);
    on_b_[in_face] = on_b_[leaves];
    on_b_[in_cap] = on_b ? 1 : 0;
    arrives[e] = byte(in_cap);
    departs[enters / 2] = byte(in_cap);
  });
  for_each_bit(crossing, [&](std::size_t e) { next_[arrives[e]] = departs[e]; });
}

/// Returns false if there is no room in the record.
bool GraphClipper::note_cut(CutRecord& record, std::uint32_t inside, std::size_t plane) const {
  if (record.cuts == CutRecord::most_cuts || record.points + new_ > CutRecord::most_points)
    return false;
  std::copy_n(new_points_.begin(), new_, record.triple.begin() + record.points);
  record.points = byte(record.points + new_);
  record.cut[record.cuts++] = {.inside = inside, .plane = byte(plane), .points = record.points};
  return true;
}

/// A vertex of A as apex spares the faces of A at this vertex.
void GraphClipper::note_facets(CutRecord& record) const {
  record.slots = byte(static_cast<std::size_t>(std::bit_width(alive_)));
  record.apex = byte(lowest_bit(of_a_ != 0 ? of_a_ : alive_));
  Triple* const begin = record.triple.data() + record.points;
  Triple* const end_on_b = pad(begin, add_triangles(begin, record.apex, true), record.apex);
  Triple* const end = pad(end_on_b, add_triangles(end_on_b, record.apex, false), record.apex);
  record.on_b = byte(static_cast<std::size_t>(end_on_b - begin));
  record.triangles = byte(static_cast<std::size_t>(end - begin));
  record.rim = byte(static_cast<std::size_t>(pad(end, add_rim(end), record.apex) - end));
}

/// Adds the triangles of the faces on B, or of the other faces without the apex, to a list; returns
/// its end.
Triple* GraphClipper::add_triangles(Triple* to, std::uint8_t apex, bool on_b) const {
  std::array<std::uint64_t, 2> wanted{edges_, edges_};  // of half-edges 2e and 2e + 1
  const auto take = [&](std::size_t h) {
    wanted[h % 2] &= ~bit(h / 2);
    return origin_[h];
  };
  for (std::size_t side = 0; side < 2; ++side) {
    while (wanted[side] != 0) {
      const std::size_t first = 2 * lowest_bit(wanted[side]) + side;
      Triple* const begin = to;
      std::size_t h = next_[first];
      const std::uint8_t p = take(first);
      std::uint8_t q = take(h);
      bool has_apex = p == apex || q == apex;
      for (h = next_[h]; h != first; h = next_[h]) {
        const std::uint8_t r = take(h);
        has_apex = has_apex || r == apex;
        *to++ = {p, q, r};
        q = r;
      }
      const bool adds = on_b ? on_b_[first] != 0 : on_b_[first] == 0 && !has_apex;
      if (!adds) to = begin;
    }
  }
  return to;
}

/// Adds the rim of the facets on B to a list; returns its end.
Triple* GraphClipper::add_rim(Triple* to) const {
  for_each_bit(edges_, [&](std::size_t e) {
    if (on_b_[2 * e] == on_b_[2 * e + 1]) return;
    const std::size_t h = on_b_[2 * e] != 0 ? 2 * e : 2 * e + 1;
    *to++ = {origin_[h], origin_[h ^ 1], origin_[h]};
  });
  return to;
}

}  // namespace floe
