// Only this file of the stage includes CGAL, whose headers take long to compile.
#include "solid/predicates.h"

#include <CGAL/box_intersection_d.h>
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/convex_hull_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <map>
#include <utility>

namespace floe {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point cgal(const Point3& p) { return {p.x, p.y, p.z}; }

/// Whether all points lie in one plane, exactly.
bool are_flat(const std::vector<Point>& points) {
  if (points.size() < 4) return true;
  const Point& a = points.front();
  const auto b = std::find_if(points.begin(), points.end(), [&](const Point& p) { return p != a; });
  if (b == points.end()) return true;
  const auto c = std::find_if(points.begin(), points.end(),
                              [&](const Point& p) { return !CGAL::collinear(a, *b, p); });
  if (c == points.end()) return true;
  return std::all_of(points.begin(), points.end(),
                     [&](const Point& p) { return CGAL::coplanar(a, *b, *c, p); });
}

using Mesh = CGAL::Surface_mesh<Point>;

/// Returns the corners of the faces of a hull. Triangles in one plane are one face, and points on
/// straight edges are no corners: these depend on addresses in CGAL's search.
std::vector<std::vector<Point>> faces_of(const Mesh& mesh) {
  std::vector<std::int32_t> face(mesh.number_of_faces(), -1);
  const auto face_at = [&](Mesh::Face_index f) -> std::int32_t& {
    return face[static_cast<std::size_t>(f)];
  };
  const auto corners_of = [&](Mesh::Face_index f) {
    const auto h = mesh.halfedge(f);
    return std::array{mesh.point(mesh.source(h)), mesh.point(mesh.target(h)),
                      mesh.point(mesh.target(mesh.next(h)))};
  };
  std::vector<std::vector<Point>> found;
  for (const auto seed : mesh.faces()) {
    const auto [a, b, c] = corners_of(seed);
    if (face_at(seed) >= 0 || CGAL::collinear(a, b, c)) continue;
    const auto number = static_cast<std::int32_t>(found.size());
    std::vector<Mesh::Face_index> todo{seed};
    face_at(seed) = number;
    std::vector<Mesh::Face_index> all;
    while (!todo.empty()) {
      all.push_back(todo.back());
      todo.pop_back();
      for (const auto h : mesh.halfedges_around_face(mesh.halfedge(all.back()))) {
        const auto next = mesh.face(mesh.opposite(h));
        if (face_at(next) >= 0) continue;
        const auto corners = corners_of(next);
        if (!std::all_of(corners.begin(), corners.end(),
                         [&, &p = a, &q = b, &r = c](const Point& corner) {
                           return CGAL::coplanar(p, q, r, corner);
                         }))
          continue;
        face_at(next) = number;
        todo.push_back(next);
      }
    }
    // A convex polygon: its boundary is one loop.
    Mesh::Halfedge_index first = Mesh::null_halfedge();
    for (const auto f : all) {
      for (const auto h : mesh.halfedges_around_face(mesh.halfedge(f)))
        if (face_at(mesh.face(mesh.opposite(h))) != number) first = h;
    }
    std::vector<Point> loop;
    auto h = first;
    do {
      loop.push_back(mesh.point(mesh.source(h)));
      h = mesh.next(h);
      while (face_at(mesh.face(mesh.opposite(h))) == number) h = mesh.next(mesh.opposite(h));
    } while (h != first);
    std::vector<Point> corners;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Point& before = corners.empty() ? loop.back() : corners.back();
      if (!CGAL::collinear(before, loop[k], loop[(k + 1) % loop.size()]))
        corners.push_back(loop[k]);
    }
    if (corners.size() > 3 && CGAL::collinear(corners.back(), corners[0], corners[1]))
      corners.erase(corners.begin());
    if (corners.size() >= 3) found.push_back(std::move(corners));
  }
  return found;
}

}  // namespace

Surface convex_hull(std::span<const Point3> points) {
  std::vector<Point> all;
  all.reserve(points.size());
  for (const Point3& p : points) all.push_back(cgal(p));
  Surface hull;
  if (are_flat(all)) return hull;
  Mesh mesh;
  CGAL::convex_hull_3(all.begin(), all.end(), mesh);
  auto faces = faces_of(mesh);

  // Vertices and triangles in an order that goes with the coordinates.
  std::vector<Point> vertices;
  for (const auto& corners : faces) vertices.insert(vertices.end(), corners.begin(), corners.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const Point& p : vertices) hull.vertices.push_back({p.x(), p.y(), p.z()});
  for (auto& corners : faces) {
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    const auto index = [&](std::size_t k) {
      return static_cast<std::int32_t>(
          std::lower_bound(vertices.begin(), vertices.end(), corners[k]) - vertices.begin());
    };
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      hull.triangles.push_back({index(0), index(k), index(k + 1)});
  }
  std::sort(hull.triangles.begin(), hull.triangles.end());
  return hull;
}

std::optional<Filling> fill(std::span<const Point2> points,
                            std::span<const std::array<std::int32_t, 2>> edges) {
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
  using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
  using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
      Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
      CGAL::No_constraint_intersection_requiring_constructions_tag>;
  using Edge = std::array<std::int32_t, 2>;

  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> vertices;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto before = triangulation.number_of_vertices();
    vertices.push_back(triangulation.insert({points[k][0], points[k][1]}));
    if (triangulation.number_of_vertices() == before) return {};  // two points at one place
    vertices.back()->info() = static_cast<std::int32_t>(k);
  }
  std::map<Edge, int> net;  // by (smaller, larger) point: how often forth minus how often back
  for (const auto& [a, b] : edges) net[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
  for (const auto& [edge, times] : net) {
    if (times == 0) continue;
    const auto a = vertices[static_cast<std::size_t>(edge[0])];
    const auto b = vertices[static_cast<std::size_t>(edge[1])];
    try {
      triangulation.insert_constraint(a, b);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      return {};
    }
    if (!triangulation.is_edge(a, b)) return {};
  }
  if (triangulation.dimension() < 2) return Filling{};

  // Winding numbers, from the unbounded region inwards.
  std::map<Triangulation::Face_handle, int> winding;
  std::vector<Triangulation::Face_handle> todo{triangulation.infinite_face()};
  winding[todo.front()] = 0;
  while (!todo.empty()) {
    const auto face = todo.back();
    todo.pop_back();
    const int here = winding[face];
    for (int i = 0; i < 3; ++i) {
      const auto next = face->neighbor(i);
      if (winding.contains(next)) continue;
      int there = here;
      const auto from = face->vertex(CGAL::Triangulation_cw_ccw_2::ccw(i));
      const auto to = face->vertex(CGAL::Triangulation_cw_ccw_2::cw(i));
      if (!triangulation.is_infinite(from) && !triangulation.is_infinite(to)) {
        // The face is on the left of from -> to.
        const std::int32_t a = from->info(), b = to->info();
        if (const auto found = net.find({std::min(a, b), std::max(a, b)}); found != net.end())
          there -= a < b ? found->second : -found->second;
      }
      winding[next] = there;
      todo.push_back(next);
    }
  }
  Filling filling;
  for (const auto face : triangulation.finite_face_handles()) {
    if (winding[face] == 0) continue;
    filling.triangles.push_back(
        {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    filling.times.push_back(winding[face]);
  }
  return filling;
}

std::optional<std::array<std::int32_t, 2>> crossing_triangles(const Surface& surface) {
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;
  const auto corner = [&](std::int32_t triangle, std::size_t k) {
    return surface.triangles[static_cast<std::size_t>(triangle)][k];
  };
  const auto place = [&](std::int32_t vertex) {
    return cgal(surface.vertices[static_cast<std::size_t>(vertex)]);
  };
  const auto triangle_of = [&](std::int32_t t) {
    return Kernel::Triangle_3(place(corner(t, 0)), place(corner(t, 1)), place(corner(t, 2)));
  };
  std::vector<Box> boxes;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto index = static_cast<std::int32_t>(t);
    boxes.emplace_back(triangle_of(index).bbox(), index);
  }
  const auto meet = [&](std::int32_t a, std::int32_t b) {
    std::vector<std::int32_t> common, only_a, only_b;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = corner(a, k);
      const bool shared = v == corner(b, 0) || v == corner(b, 1) || v == corner(b, 2);
      (shared ? common : only_a).push_back(v);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = corner(b, k);
      if (std::find(common.begin(), common.end(), v) == common.end()) only_b.push_back(v);
    }
    switch (common.size()) {
      case 0:
        return CGAL::do_intersect(triangle_of(a), triangle_of(b));
      case 1: {
        const Kernel::Segment_3 of_a(place(only_a[0]), place(only_a[1]));
        const Kernel::Segment_3 of_b(place(only_b[0]), place(only_b[1]));
        return CGAL::do_intersect(of_a, triangle_of(b)) || CGAL::do_intersect(of_b, triangle_of(a));
      }
      case 2: {
        const Point p = place(common[0]), q = place(common[1]);
        const Point r = place(only_a[0]), s = place(only_b[0]);
        return CGAL::coplanar(p, q, r, s) &&
               CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
      }
      default:
        return true;
    }
  };
  std::optional<std::array<std::int32_t, 2>> first;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& one, const Box& other) {
    const std::array pair{std::min(one.info(), other.info()), std::max(one.info(), other.info())};
    if ((!first || pair < *first) && meet(pair[0], pair[1])) first = pair;
  });
  return first;
}

}  // namespace floe
