/// \file
/// Overlaps by the lanes of a warp: the rule of src/geometry/graph_clipper.h, where a vertex, an
/// edge or a triangle has a lane. What GraphClipper decides one after the other is decided side by
/// side here, by masks that all lanes share, to the same points in the same slots.
#pragma once

#include <cmath>
#include <cstdint>

#include "device/launch.h"
#include "floe/geometry/half_space.h"
#include "geometry/across.h"
#include "geometry/edge_graph.h"
#include "geometry/overlap.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// What a warp keeps in shared memory. The vertices of the overlap are in the lower slots, those of
/// A before the first cut in the upper ones.
struct ClipRoom {
  static constexpr int low = static_cast<int>(EdgeGraph::most_vertices), slots = 2 * low,
                       edges = static_cast<int>(EdgeGraph::most_edges);
  double x[slots], y[slots], z[slots], distance[slots];
  std::uint64_t star[slots];  ///< per vertex a mask of its edges
  // Per half-edge, as EdgeGraph, and whether its face is on B:
  std::uint8_t origin[2 * edges], next[2 * edges], on_b[2 * edges];
  std::uint8_t from[low], to[low], made[low];   ///< new vertices: ends inside, outside, slot
  std::uint8_t arrives[edges], departs[edges];  ///< half-edges of the cap at a crossing edge
};
static_assert(ClipRoom::low == Warp::lanes);

FLOE_KERNEL inline std::uint64_t bit(int k) { return std::uint64_t{1} << k; }
FLOE_KERNEL inline std::uint64_t first_bits(int n) {
  return n < 64 ? bit(n) - 1 : ~std::uint64_t{0};
}
/// Returns the number of bit n, counted from 0, of those that are 1.
FLOE_KERNEL inline int bit_number(std::uint64_t mask, int n) {
  for (; n > 0; --n) mask &= mask - 1;
  return lowest_bit(mask);
}

/// Clips A, which is placed in B's frame.
class WarpClipper {
 public:
  /// Planes beside those of the shapes: A's in its frame, B's.
  struct Further {
    const HalfSpace *a, *b;
    int of_a, of_b;
  };

  FLOE_KERNEL WarpClipper(const Warp& warp, ClipRoom& room) : warp_(warp), room_(room) {}

  /// Places A. \param vertices  x, y, z of each \param axes, x  of A's frame in B's
  FLOE_KERNEL void place(const double* vertices, int number, const Triad<double>& axes,
                         const Vec3<double>& x) {
    vertices_ = number;
    origin_ = x;
    axes_ = axes;
    warp_.each([&](int lane) {
      if (lane >= number) return;
      const double* v = vertices + 3 * lane;
      const auto coordinate = [&](double origin, double e1, double e2, double e3) {
        return origin + (v[0] * e1 + v[1] * e2 + v[2] * e3);
      };
      room_.x[low + lane] = coordinate(x.x, axes.e1.x, axes.e2.x, axes.e3.x);
      room_.y[low + lane] = coordinate(x.y, axes.e1.y, axes.e2.y, axes.e3.y);
      room_.z[low + lane] = coordinate(x.z, axes.e1.z, axes.e2.z, axes.e3.z);
    });
  }

  /// Whether all of A is more than `least` beyond a plane [m].
  FLOE_KERNEL bool is_beyond(const HalfSpace& plane, double least) const {
    return warp_.ballot([&](int lane) {
      return lane < vertices_ && !(dot(plane.normal, point(low + lane)) - plane.offset > least);
    }) == 0;
  }

  /// Sets the overlap of A and B, unless there is none. Returns false if at some cut there are more
  /// vertices or edges than there is room for.
  /// \param planes   B's
  /// \param further  what bounds A and B beside their shapes
  /// \param found    zeros
  FLOE_KERNEL bool overlap(const EdgeGraph& a, const HalfSpace* planes, int number, bool with_patch,
                           const Further& further, Overlap& found) {
    const int first = first_plane(planes, number);
    const std::uint64_t placed = inside(planes[first], low) & first_bits(vertices_);
    start(a, placed);
    if (!cut(of_a_, true)) return false;
    const auto clips = [&](const HalfSpace& plane, bool on_b) {
      const std::uint64_t in = inside(plane, 0) & alive_;
      return in == alive_ || cut(in, on_b);
    };
    for (int k = 0; k < number && alive_ != 0; ++k)
      if (k != first && !clips(planes[k], true)) return false;
    for (int k = 0; k < further.of_b && alive_ != 0; ++k)
      if (!clips(further.b[k], true)) return false;
    for (int k = 0; k < further.of_a && alive_ != 0; ++k)
      if (!clips(floe::placed(further.a[k], axes_, origin_), false)) return false;
    if (alive_ != 0) integrate(with_patch, found);
    return true;
  }

 private:
  static constexpr int low = ClipRoom::low, most_edges = ClipRoom::edges;

  FLOE_KERNEL Vec3<double> point(int slot) const {
    return {room_.x[slot], room_.y[slot], room_.z[slot]};
  }

  /// The plane of B farthest below A's origin, which removes most of A as a rule.
  FLOE_KERNEL int first_plane(const HalfSpace* planes, int number) const {
    int first = 0;
    double highest = 0;
    for (int k = 0; k < number; ++k) {
      const double height = dot(planes[k].normal, origin_) - planes[k].offset;
      if (k > 0 && !(height > highest)) continue;
      highest = height;
      first = k;
    }
    return first;
  }

  /// Sets the distances from a plane of 32 slots, and returns a mask of those inside.
  FLOE_KERNEL std::uint64_t inside(const HalfSpace& plane, int begin) {
    return warp_.ballot([&](int lane) {
      const double distance = dot(plane.normal, point(begin + lane)) - plane.offset;
      room_.distance[begin + lane] = distance;
      return distance <= 0;
    });
  }

  /// Begins the graph as that of A before the first cut. The vertices that stay are settled in the
  /// lowest slots. \param inside  mask of A's vertices
  FLOE_KERNEL void start(const EdgeGraph& a, std::uint64_t inside) {
    const auto place_of = [inside](int v) {
      return (inside >> v & 1) != 0 ? count_bits(inside & first_bits(v)) : low + v;
    };
    warp_.each([&](int lane) {
      for (int h = lane; h < 2 * a.edges; h += Warp::lanes) {
        room_.origin[h] = static_cast<std::uint8_t>(place_of(a.origin.data()[h]));
        room_.next[h] = a.next.data()[h];
        room_.on_b[h] = 0;
      }
      if (lane >= vertices_) return;
      const int from = low + lane, to = place_of(lane);
      room_.star[from] = a.star.data()[lane];
      room_.star[to] = a.star.data()[lane];
      room_.x[to] = room_.x[from];
      room_.y[to] = room_.y[from];
      room_.z[to] = room_.z[from];
      room_.distance[to] = room_.distance[from];
    });
    edges_ = first_bits(a.edges);
    of_a_ = first_bits(count_bits(inside));
    alive_ = of_a_ | (first_bits(vertices_) & ~inside) << low;
  }

  /// Clips by the plane from which the distances are. Returns false if there is no room.
  /// \param on_b  whether the plane is B's
  FLOE_KERNEL bool cut(std::uint64_t inside, bool on_b) {
    // An edge with both ends outside is in two stars, one that crosses the plane is in one.
    std::uint64_t crossing = 0, outside = 0;
    for (std::uint64_t left = alive_ & ~inside; left != 0; left &= left - 1) {
      const std::uint64_t star = room_.star[lowest_bit(left)];
      crossing ^= star;
      outside |= star;
    }
    const int number = count_bits(crossing);
    if (number > low - count_bits(alive_ & first_bits(low)) ||
        number > most_edges - count_bits(edges_))
      return false;
    add_vertices(crossing, inside);
    add_edges(crossing, on_b);
    warp_.each([&](int lane) {
      if (lane >= number) return;
      const int u = room_.from[lane], v = room_.to[lane], w = room_.made[lane];
      // The end inside has a distance of at most 0, the other above 0: no divisor vanishes.
      const double t = room_.distance[u] / (room_.distance[u] - room_.distance[v]);
      room_.x[w] = room_.x[u] + t * (room_.x[v] - room_.x[u]);
      room_.y[w] = room_.y[u] + t * (room_.y[v] - room_.y[u]);
      room_.z[w] = room_.z[u] + t * (room_.z[v] - room_.z[u]);
    });
    alive_ = inside | lowest_of(~alive_, number);
    of_a_ &= inside;
    edges_ = (edges_ | lowest_of(~edges_, number)) & ~(outside & ~crossing);
    return true;
  }

  /// Returns the lowest n bits of a mask.
  FLOE_KERNEL static std::uint64_t lowest_of(std::uint64_t mask, int n) {
    std::uint64_t rest = mask;
    for (; n > 0; --n) rest &= rest - 1;
    return mask & ~rest;
  }
  /// Calls work(edge, its number among the crossing ones) for the crossing edges.
  template <class Work>
  FLOE_KERNEL void for_crossing(std::uint64_t crossing, const Work& work) const {
    warp_.each([&](int lane) {
      for (int e = lane; e < most_edges; e += Warp::lanes)
        if ((crossing >> e & 1) != 0) work(e, count_bits(crossing & first_bits(e)));
    });
  }

  /// Ends each crossing edge at a new vertex.
  FLOE_KERNEL void add_vertices(std::uint64_t crossing, std::uint64_t inside) {
    for_crossing(crossing, [&](int e, int k) {
      const int begins_inside = static_cast<int>(inside >> room_.origin[2 * e] & 1);
      const int leaves = 2 * e + (1 - begins_inside), enters = 2 * e + begins_inside;
      const int w = bit_number(~alive_, k);
      room_.from[k] = room_.origin[leaves];
      room_.to[k] = room_.origin[enters];
      room_.made[k] = static_cast<std::uint8_t>(w);
      room_.origin[enters] = static_cast<std::uint8_t>(w);
      room_.star[w] = bit(e);
    });
  }

  /// Adds the edges along the plane: one for each crossing half-edge that leaves, in its face, and
  /// its twin in the cap.
  FLOE_KERNEL void add_edges(std::uint64_t crossing, bool on_b) {
    for_crossing(crossing, [&](int e, int k) {
      const int w = room_.made[k];
      const int leaves = room_.origin[2 * e] == w ? 2 * e + 1 : 2 * e;
      int enters = room_.next[leaves];
      while ((crossing >> (enters / 2) & 1) == 0) enters = room_.next[enters];
      const int added = bit_number(~edges_, k), in_face = 2 * added, in_cap = 2 * added + 1;
      room_.origin[in_face] = static_cast<std::uint8_t>(w);
      room_.origin[in_cap] = room_.origin[enters];
      room_.star[w] |= bit(added);
      room_.next[leaves] = static_cast<std::uint8_t>(in_face);
      room_.next[in_face] = static_cast<std::uint8_t>(enters);
      room_.on_b[in_face] = room_.on_b[leaves];
      room_.on_b[in_cap] = on_b ? 1 : 0;
      room_.arrives[e] = static_cast<std::uint8_t>(in_cap);
      room_.departs[enters / 2] = static_cast<std::uint8_t>(in_cap);
    });
    // Each new vertex is the end of one new edge and the beginning of another.
    for_crossing(crossing, [&](int e, int) {
      const int in_cap = room_.arrives[e];
      room_.star[room_.origin[in_cap]] |= bit(in_cap / 2);
      room_.next[in_cap] = room_.departs[e];
    });
  }

  /// Calls use(p, q, r) for the triangles of the facets: corners from the apex. A half-edge has the
  /// triangle of its ends and the first corner of its face.
  template <class Use>
  FLOE_KERNEL void for_triangles(int lane, int apex, const Use& use) const {
    const Vec3<double> origin = point(apex);
    for (int h = lane; h < 2 * most_edges; h += Warp::lanes) {
      if ((edges_ >> (h / 2) & 1) == 0) continue;
      int first = h;
      bool has_apex = false;
      for (int other = room_.next[h]; other != h; other = room_.next[other]) {
        first = other < first ? other : first;
        has_apex = has_apex || room_.origin[other] == apex;
      }
      if (h == first || room_.next[h] == first) continue;
      const bool on_b = room_.on_b[h] != 0;
      if (!on_b && (has_apex || room_.origin[h] == apex)) continue;  // its cones are flat
      use(point(room_.origin[first]) - origin, point(room_.origin[h]) - origin,
          point(room_.origin[room_.next[h]]) - origin, on_b);
    }
  }

  /// The sums of set_integrals() (src/geometry/facet_integrals.cpp), triangle by triangle.
  FLOE_KERNEL void integrate(bool with_patch, Overlap& o) const {
    enum Sum : int {
      volume6,
      moment24,
      area2 = moment24 + 3,
      moment6 = area2 + 3,
      area = moment6 + 3,
      first3,
      squares12 = first3 + 3,
      products12 = squares12 + 3,
      numbers = products12 + 3
    };
    const int apex = lowest_bit(of_a_ != 0 ? of_a_ : alive_);
    double sum[numbers];  // NOLINT: registers
    warp_.sums<numbers>(sum, [&](int lane, double* of) {
      const auto add = [&](int at, const Vec3<double>& v) {
        of[at] += v.x, of[at + 1] += v.y, of[at + 2] += v.z;
      };
      for_triangles(
          lane, apex,
          [&](const Vec3<double>& p, const Vec3<double>& q, const Vec3<double>& r, bool on_b) {
            const Vec3<double> twice = cross(q - p, r - p), s = p + q + r;
            const double v = dot(p, twice);
            of[volume6] += v;
            add(moment24, v * s);
            if (!on_b) return;
            add(area2, twice);
            add(moment6, cross(s, twice));
            if (!with_patch) return;
            const double a = 0.5 * length(twice);
            const auto product = [&](double Vec3<double>::*x, double Vec3<double>::*y) {
              return a * ((p.*x * p.*y + q.*x * q.*y) + (r.*x * r.*y + s.*x * s.*y));
            };
            constexpr auto x = &Vec3<double>::x, y = &Vec3<double>::y, z = &Vec3<double>::z;
            of[area] += a;
            add(first3, a * s);
            add(squares12, {product(x, x), product(y, y), product(z, z)});
            add(products12, {product(y, z), product(z, x), product(x, y)});
          });
    });
    const auto at = [&](int k) { return Vec3<double>{sum[k], sum[k + 1], sum[k + 2]}; };
    if (!(sum[volume6] > 0)) return;
    o.volume = (1.0 / 6) * sum[volume6];
    const Vec3<double> c = (0.25 / sum[volume6]) * at(moment24);
    o.centroid = point(apex) + c;
    o.area = 0.5 * at(area2);
    o.moment = (1.0 / 6) * at(moment6) - cross(c, o.area);
    const double size = length(o.area);
    if (!with_patch || !(size > 0) || !(sum[area] > 0)) return;
    const auto [u, v] = basis_across((1 / size) * o.area);
    const Vec3<double> middle = (1 / (3 * sum[area])) * at(first3), squares = at(squares12),
                       products = at(products12);
    const Across<double> m{dot(u, middle), dot(v, middle)};
    const auto moments = [&](const Vec3<double>& w) {
      return Vec3<double>{squares.x * w.x + products.z * w.y + products.y * w.z,
                          products.z * w.x + squares.y * w.y + products.x * w.z,
                          products.y * w.x + products.x * w.y + squares.z * w.z};
    };
    const Vec3<double> of_u = moments(u), of_v = moments(v);
    o.patch.area = sum[area];
    o.patch.middle = point(apex) + middle;
    o.patch.u = u;
    o.patch.v = v;
    o.patch.uu = (1.0 / 12) * dot(u, of_u) - sum[area] * m.u * m.u;
    o.patch.vv = (1.0 / 12) * dot(v, of_v) - sum[area] * m.v * m.v;
    o.patch.uv = (1.0 / 12) * dot(u, of_v) - sum[area] * m.u * m.v;
    o.patch.reach = reach(apex, o.patch.u, o.patch.v, m);
  }

  /// Sums along the rim of the facets on B: an edge between two of them adds nothing.
  FLOE_KERNEL double reach(int apex, const Vec3<double>& u, const Vec3<double>& v,
                           const Across<double>& middle) const {
    const Vec3<double> origin = point(apex);
    double sum = 0;
    warp_.sums<1>(&sum, [&](int lane, double* of) {
      for (int e = lane; e < most_edges; e += Warp::lanes) {
        if ((edges_ >> e & 1) == 0 || room_.on_b[2 * e] == room_.on_b[2 * e + 1]) continue;
        const int h = room_.on_b[2 * e] != 0 ? 2 * e : 2 * e + 1;
        const auto across = [&](int end) {
          const Vec3<double> r = point(room_.origin[end]) - origin;
          return Across<double>{dot(u, r) - middle.u, dot(v, r) - middle.v};
        };
        *of += reach_of_edge(across(h), across(h ^ 1));
      }
    });
    return sum;
  }

  Warp warp_;
  ClipRoom& room_;
  int vertices_ = 0;
  Triad<double> axes_{};   ///< of A's frame in B's
  Vec3<double> origin_{};  ///< likewise [m]
  std::uint64_t alive_ = 0, edges_ = 0,
                of_a_ = 0;  ///< masks of slots, edges, slots of A's vertices
};

}  // namespace
}  // namespace floe::device
