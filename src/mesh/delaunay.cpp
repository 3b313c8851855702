// Only this file includes CGAL, whose headers take 10 s and 0.7 GB to compile.
#include "mesh/delaunay.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace floe::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<std::int32_t, Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel, Structure>;

// Error bounds of the two determinants below (Shewchuk 1997, "A" filters); epsilon = 2^-53.
// Determinants within the bounds go to CGAL's exact predicates.
constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2;
constexpr double orientation_bound = (3 + 16 * epsilon) * epsilon;
constexpr double circle_bound = (10 + 96 * epsilon) * epsilon;

Kernel::Point_2 cgal(const Point2& p) { return {p[0], p[1]}; }

bool left_turn(const Point2& a, const Point2& b, const Point2& c) {
  const double l = (a[0] - c[0]) * (b[1] - c[1]), r = (a[1] - c[1]) * (b[0] - c[0]);
  const double det = l - r, error = orientation_bound * (std::abs(l) + std::abs(r));
  if (det > error) return true;
  if (det < -error) return false;
  return CGAL::orientation(cgal(a), cgal(b), cgal(c)) == CGAL::LEFT_TURN;
}

/// Whether d lies strictly inside the circle through a, b, c (counter-clockwise).
bool inside_circle(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const double ax = a[0] - d[0], ay = a[1] - d[1], bx = b[0] - d[0], by = b[1] - d[1];
  const double cx = c[0] - d[0], cy = c[1] - d[1];
  const double bc = bx * cy, cb = cx * by, ca = cx * ay, ac = ax * cy, ab = ax * by, ba = bx * ay;
  const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const double det = a2 * (bc - cb) + b2 * (ca - ac) + c2 * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * a2 + (std::abs(ca) + std::abs(ac)) * b2 +
                           (std::abs(ab) + std::abs(ba)) * c2;
  const double error = circle_bound * permanent;
  if (det > error) return true;
  if (det < -error) return false;
  return CGAL::side_of_oriented_circle(cgal(a), cgal(b), cgal(c), cgal(d)) ==
         CGAL::ON_POSITIVE_SIDE;
}

}  // namespace

void Delaunay::build(std::vector<Point2> points) {
  points_ = std::move(points);
  ++builds_;
  Triangulation triangulation;
  Triangulation::Face_handle hint;
  const auto n = static_cast<std::int32_t>(points_.size());
  for (std::int32_t k = 0; k < n; ++k) {
    const auto vertex = triangulation.insert(cgal(points_[k]), hint);
    vertex->info() = k;
    hint = vertex->face();
  }
  if (static_cast<std::int32_t>(triangulation.number_of_vertices()) != n)
    throw InputError("sheet: two generators of the mesh coincide");

  // Triangles are numbered by their first half-edge, which starts at the lowest vertex. Neighbours
  // in the plane are then neighbours in memory, and the numbering does not depend on CGAL.
  using Corners = std::array<std::int32_t, 3>;
  std::vector<std::pair<Corners, Triangulation::Face_handle>> faces;
  faces.reserve(triangulation.number_of_faces());
  for (const auto face : triangulation.finite_face_handles()) {
    Corners c{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    faces.emplace_back(c, face);
  }
  std::sort(faces.begin(), faces.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto face : triangulation.all_face_handles()) face->info() = -1;
  for (std::size_t t = 0; t < faces.size(); ++t)
    faces[t].second->info() = static_cast<std::int32_t>(t);

  origin_.resize(3 * faces.size());
  twin_.resize(3 * faces.size());
  outgoing_.assign(n, -1);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(faces.size()); ++t) {
    const auto& [corners, face] = faces[t];
    for (int k = 0; k < 3; ++k) {
      const std::int32_t e = 3 * t + k;
      origin_[e] = corners[k];
      if (outgoing_[corners[k]] < 0) outgoing_[corners[k]] = e;
    }
  }
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(faces.size()); ++t) {
    const auto& [corners, face] = faces[t];
    for (int i = 0; i < 3; ++i) {  // CGAL's edge i is opposite vertex i and starts at vertex i + 1
      const auto start = face->vertex(Triangulation::ccw(i))->info();
      const auto end = face->vertex(Triangulation::cw(i))->info();
      const std::int32_t across = face->neighbor(i)->info();
      std::int32_t e = 3 * t, f = 3 * across;
      while (origin_[e] != start) ++e;
      if (across >= 0)
        while (origin_[f] != end) ++f;
      twin_[e] = across < 0 ? -1 : f;
    }
  }
}

bool Delaunay::turns_left(std::int32_t t) const {
  const std::size_t e = 3 * static_cast<std::size_t>(t);
  return left_turn(points_[origin_[e]], points_[origin_[e + 1]], points_[origin_[e + 2]]);
}

bool Delaunay::is_delaunay(std::int32_t e) const {
  const std::int32_t f = twin_[e];
  if (f < 0) return true;
  return !inside_circle(points_[origin_[e]], points_[origin_[next(e)]],
                        points_[origin_[previous(e)]], points_[origin_[previous(f)]]);
}

//         pl                  pl
//        /||\                /  \         .
//       / || \              / a  \        .
//    p0/  ||  \p1   ->   p0/______\p1
//      \ a||b /            \   b  /
//       \ || /              \    /
//        \||/                \  /
//         pr                  pr
void Delaunay::flip(std::int32_t a) {
  const std::int32_t b = twin_[a];
  const std::int32_t al = next(a), ar = previous(a), bl = previous(b), br = next(b);
  const std::int32_t pr = origin_[a], pl = origin_[b], p0 = origin_[ar], p1 = origin_[bl];
  const std::int32_t beyond_a = twin_[bl], beyond_b = twin_[ar];
  origin_[a] = p1;
  origin_[b] = p0;
  twin_[a] = beyond_a;
  if (beyond_a >= 0) twin_[beyond_a] = a;
  twin_[b] = beyond_b;
  if (beyond_b >= 0) twin_[beyond_b] = b;
  twin_[ar] = bl;
  twin_[bl] = ar;
  outgoing_[pl] = al;
  outgoing_[pr] = br;
}

void Delaunay::repair(std::vector<std::int32_t> edges) {
  while (!edges.empty()) {
    const std::int32_t a = edges.back();
    edges.pop_back();
    if (is_delaunay(a)) continue;
    const std::int32_t b = twin_[a];
    flip(a);
    for (const std::int32_t e : {a, next(a), b, next(b)}) edges.push_back(e);
  }
}

void Delaunay::move(std::span<const Point2> points, const Share& share) {
  std::copy(points.begin(), points.end(), points_.begin());
  // Each rank checks its share of the triangles; -1 stands for a triangle that is turned over.
  const std::int32_t begin = share.begin(triangles()), end = share.end(triangles());
  std::vector<std::int32_t> bad;
  for (std::int32_t t = begin; t < end; ++t) {
    if (!turns_left(t)) {
      bad.assign(1, -1);
      break;
    }
    for (std::int32_t e = 3 * t; e < 3 * t + 3; ++e)
      if (e < twin_[e] && !is_delaunay(e)) bad.push_back(e);
  }
  share.concatenate(bad);
  if (std::find(bad.begin(), bad.end(), -1) != bad.end())
    build(std::move(points_));
  else
    repair(std::move(bad));
}

}  // namespace floe::mesh
