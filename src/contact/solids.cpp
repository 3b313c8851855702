#include "contact/solids.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/append_faces.h"
#include "geometry/convex_polygon.h"
#include "geometry/overlap.h"

namespace floe {
namespace {

/// Returns the least extent of a polyhedron along the normals of its faces [m]; infinite without
/// vertices.
double least_width(std::span<const Vec3<double>> vertices, std::span<const HalfSpace> planes) {
  double least = std::numeric_limits<double>::infinity();
  if (vertices.empty()) return least;
  for (const HalfSpace& plane : planes) {
    double low = plane.offset;
    for (const Vec3<double>& r : vertices) low = std::min(low, dot(plane.normal, r));
    least = std::min(least, plane.offset - low);
  }
  return least;
}

/// Returns the area of a face [m^2].
double face_area(const Shapes& shapes, std::int32_t face) {
  const auto corner = [&](std::int32_t c) {
    return item(shapes.vertices, item(shapes.corners, c));
  };
  const std::int32_t begin = item(shapes.corner_of, face), end = item(shapes.corner_of, face + 1);
  Vec3<double> twice{};
  for (std::int32_t c = begin + 1; c + 1 < end; ++c)
    twice = twice + cross(corner(c) - corner(begin), corner(c + 1) - corner(begin));
  return 0.5 * length(twice);
}

Solids::Faces faces_of(const Shapes& shapes, std::int32_t body) {
  const std::int32_t begin = item(shapes.face_of, body), end = item(shapes.face_of, body + 1);
  Solids::Faces faces{.number = end - begin};
  for (std::int32_t f = begin; f < end; ++f) {
    const double area = face_area(shapes, f);
    faces.area += area;
    faces.widest = std::max(faces.widest, area);
  }
  return faces;
}

}  // namespace

Solids::Solids(const Shapes& shapes, std::span<const double> masses,
               std::vector<Obstacle> obstacles, double inertia_factor,
               std::span<const Point3> inertia)
    : shapes_(shapes), obstacles_(std::move(obstacles)), inertia_factor_(inertia_factor) {
  Graphs graphs;
  for (std::int32_t b = 0; b < shapes_.bodies(); ++b) {
    add(b, item(masses, b), graphs);
    faces_.push_back(faces_of(shapes_, b));
  }
  add_parts(graphs);
  for (const Obstacle& o : obstacles_) {
    if (!o.is_carried()) continue;
    obstacles_touch_ =
        obstacles_touch_ || std::any_of(obstacles_.begin(), obstacles_.end(),
                                        [&](const Obstacle& p) { return may_touch(o, p); });
    carriers_.push_back(o.body);
    for (const ConvexPart& part : o.parts)  // each inner face is one of both parts
      for (const InnerFace& face : part.inner_faces)
        item(faces_, o.body).area -= length(area_vector(face.corners));
  }
  std::sort(carriers_.begin(), carriers_.end());
  carriers_.erase(std::unique(carriers_.begin(), carriers_.end()), carriers_.end());
  if (!carriers_.empty()) carries_.assign(bodies_.size(), 0);
  for (const std::int32_t b : carriers_) {
    const Point3& moments = inertia[static_cast<std::size_t>(b)];
    item(bodies_, b).inverse.moments = {1 / moments.x, 1 / moments.y, 1 / moments.z};
    item(carries_, b) = 1;
  }
  for (const Obstacle& o : obstacles_)
    if (o.is_carried() && !o.is_ice) item(carries_, o.body) = structure;
  for (const Body& body : bodies_) thinnest_ = std::min(thinnest_, body.width);
  for (const Part& part : parts_) thinnest_ = std::min(thinnest_, part.width);
}

void Solids::add_parts(Graphs& known) {
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    double radius = 0, thickest = 0;
    for (const ConvexPart& part : obstacles_[k].parts) {
      for (const Vec3<double>& r : part.vertices) radius = std::max(radius, length(r));
      thickest = std::max(thickest, least_width(part.vertices, part.planes));
    }
    for (const ConvexPart& part : obstacles_[k].parts)
      parts_.push_back({.obstacle = k,
                        .radius = radius,
                        .width = thickest,
                        .first_coordinate = add_lists(part.vertices)});
    if (obstacles_[k].is_carried()) {
      const std::int32_t first = carried_shapes_.bodies();
      append_bodies(carried_shapes_, shapes_of_parts(obstacles_[k]));
      for (std::size_t p = first_part_.back(); p < parts_.size(); ++p) {
        parts_[p].shape = first + static_cast<std::int32_t>(p - first_part_.back());
        parts_[p].graph = add_graph(carried_shapes_, parts_[p].shape, known);
      }
    }
    first_part_.push_back(parts_.size());
  }
}

/// Returns the place of the first coordinate.
std::size_t Solids::add_lists(std::span<const Vec3<double>> vertices) {
  const std::size_t first = coordinates_.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < VertexLists::padded(vertices.size()); ++k)
      coordinates_.push_back(vertices[std::min(k, vertices.size() - 1)][axis]);
  }
  return first;
}

/// Returns the place of the graph of a body in graphs_, or -1.
/// \param known  places of the graphs in graphs_
std::int32_t Solids::add_graph(const Shapes& shapes, std::int32_t body, Graphs& known) {
  const std::optional<EdgeGraph> graph = edge_graph(shapes, body);
  if (!graph) return -1;
  const auto [place, is_new] = known.try_emplace(*graph, static_cast<std::int32_t>(graphs_.size()));
  if (is_new) graphs_.push_back(*graph);
  return place->second;
}

void Solids::add(std::int32_t body, double mass, Graphs& known) {
  Body added;
  added.first_vertex = item(shapes_.vertex_of, body);
  added.vertices = item(shapes_.vertex_of, body + 1) - added.first_vertex;
  added.first_plane = static_cast<std::int32_t>(planes_.size());
  for (std::int32_t v = item(shapes_.vertex_of, body); v < item(shapes_.vertex_of, body + 1); ++v) {
    added.radius = std::max(added.radius, length(item(shapes_.vertices, v)));
  }
  const auto first = static_cast<std::size_t>(added.first_vertex);
  added.first_coordinate = add_lists(
      std::span(shapes_.vertices).subspan(first, static_cast<std::size_t>(added.vertices)));
  added.graph = add_graph(shapes_, body, known);
  append_half_spaces(shapes_, body, planes_);
  added.planes = static_cast<std::int32_t>(planes_.size()) - added.first_plane;
  const VolumeProperties properties = volume_properties(shapes_, body);
  added.size = std::cbrt(properties.volume);
  added.mass = mass;
  const double per_density = properties.volume / mass;
  const auto inverse = [&](std::size_t k) {
    return per_density / (inertia_factor_ * properties.inertia[4 * k]);
  };
  added.inverse = {.mass = 1 / mass, .moments = {inverse(0), inverse(1), inverse(2)}};
  bodies_.push_back(added);
  bodies_.back().width = least_width(vertices(body), planes(body));
}

bool Solids::has_friction(const ContactOptions& options) const {
  const auto rubs = [](const auto& of) {
    return of.friction > 0 || of.friction_wet.value_or(0) > 0;
  };
  return rubs(options) || std::any_of(obstacles_.begin(), obstacles_.end(), rubs);
}

double Solids::mean_radius() const {
  const auto structures =
      static_cast<std::size_t>(std::count(carries_.begin(), carries_.end(), structure));
  if (bodies_.size() == structures) {
    double least = std::numeric_limits<double>::infinity();
    for (const Body& body : bodies_) least = std::min(least, body.size);
    return least;
  }
  double mean = 0;
  const auto number = static_cast<double>(bodies_.size() - structures);
  for (std::int32_t b = 0; b < bodies(); ++b)
    if (!is_structure(b)) mean += item(bodies_, b).radius / number;
  return mean;
}

}  // namespace floe
