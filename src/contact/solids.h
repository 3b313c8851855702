/// \file
/// The rigid bodies and parts of obstacles that may touch: shapes, sizes and masses.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "contact/pair.h"
#include "contact_laws/mobility.h"
#include "floe/base/item.h"
#include "floe/contact/obstacle.h"
#include "floe/contact_laws/contact_options.h"
#include "floe/geometry/half_space.h"
#include "floe/geometry/polyhedron.h"
#include "geometry/edge_graph.h"
#include "geometry/vertex_lists.h"

namespace floe {

/// All bodies of the model, and the obstacles. An index is that of a body, or, below 0, that of a
/// part of an obstacle (contact/pair.h).
class Solids {
 public:
  /// \param shapes     of all bodies, in their principal axes
  /// \param masses     of all bodies [kg]
  /// \param obstacles  may be empty
  /// \param inertia_factor  moments of inertia over those of the shapes
  /// \param inertia  principal moments of all bodies, of which those of bodies that carry obstacles
  ///   count [kg m^2]; empty if none does
  Solids(const Shapes& shapes, std::span<const double> masses, std::vector<Obstacle> obstacles,
         double inertia_factor = 1, std::span<const Point3> inertia = {});

  std::int32_t bodies() const { return shapes_.bodies(); }
  const Shapes& shapes() const { return shapes_; }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  /// Returns the number of parts of all obstacles.
  std::size_t parts() const { return parts_.size(); }
  /// Returns the numbers of the parts of obstacle k: from the first, up to that of the second.
  std::array<std::size_t, 2> parts_of(std::size_t k) const {
    return {first_part_[k], first_part_[k + 1]};
  }
  /// Gives obstacle k another motion by a program, or takes it back.
  void drive(std::size_t k, const std::optional<DrivenMotion>& motion) {
    obstacles_[k].motion.driven = motion;
  }
  /// Returns the number of the obstacle of a part with an index below 0.
  std::size_t obstacle_number(std::int32_t index) const { return part_of(index).obstacle; }
  /// Returns the obstacle of a part with an index below 0.
  const Obstacle& obstacle(std::int32_t index) const { return obstacles_[obstacle_number(index)]; }
  /// Returns the part with an index below 0.
  const ConvexPart& part(std::int32_t index) const {
    const Part& of = part_of(index);
    return obstacles_[of.obstacle].parts[part_number(index) - first_part_[of.obstacle]];
  }
  /// Whether an index is that of one of several parts of an obstacle.
  bool is_one_of_several(std::int32_t index) const {
    return is_obstacle(index) && obstacle(index).parts.size() > 1;
  }

  /// Returns the vertices in the frame of the body or obstacle [m]; a half-space has none.
  std::span<const Vec3<double>> vertices(std::int32_t index) const {
    if (is_obstacle(index)) return part(index).vertices;
    const Body& body = item(bodies_, index);
    return {shapes_.vertices.data() + body.first_vertex, static_cast<std::size_t>(body.vertices)};
  }
  /// Returns the vertices by coordinates.
  VertexLists vertex_lists(std::int32_t index) const {
    const std::size_t first = is_obstacle(index) ? part_of(index).first_coordinate
                                                 : item(bodies_, index).first_coordinate;
    const std::size_t number = vertices(index).size(), length = VertexLists::padded(number);
    const double* x = coordinates_.data() + first;
    return {.x = x, .y = x + length, .z = x + 2 * length, .number = number};
  }
  /// Returns the graph of the surface of a body, or of a part that a body carries; null if it has
  /// too many vertices.
  const EdgeGraph* graph(std::int32_t index) const {
    const std::int32_t graph =
        is_obstacle(index) ? part_of(index).graph : item(bodies_, index).graph;
    return graph < 0 ? nullptr : &item(graphs_, graph);
  }
  /// Returns the shapes among which that of a body is, or of a part that a body carries.
  const Shapes& shapes_with(std::int32_t index) const {
    return is_obstacle(index) ? carried_shapes_ : shapes_;
  }
  /// Returns the number of its shape among these.
  std::int32_t shape_number(std::int32_t index) const {
    return is_obstacle(index) ? part_of(index).shape : index;
  }
  /// Returns the planes of the faces, in the frame of the body or obstacle.
  std::span<const HalfSpace> planes(std::int32_t index) const {
    if (is_obstacle(index)) return part(index).planes;
    const Body& body = item(bodies_, index);
    return {planes_.data() + body.first_plane, static_cast<std::size_t>(body.planes)};
  }
  /// Whether a body carries obstacles: it touches as these.
  bool carries(std::int32_t body) const { return !carries_.empty() && item(carries_, body) != 0; }
  /// Whether an index is that of ice: a body, or a part of one.
  bool is_ice(std::int32_t index) const { return !is_obstacle(index) || obstacle(index).is_ice; }
  /// Whether a body is a structure: it carries obstacles that are not ice.
  bool is_structure(std::int32_t body) const {
    return !carries_.empty() && item(carries_, body) == structure;
  }
  /// Returns a body itself, the body that carries a part, or -1 for a part that no body carries.
  std::int32_t body_of(std::int32_t index) const {
    return is_obstacle(index) ? obstacle(index).body : index;
  }
  /// Returns the bodies that carry obstacles, sorted.
  const std::vector<std::int32_t>& carriers() const { return carriers_; }
  bool is_half_space(std::int32_t index) const {
    return is_obstacle(index) && part(index).vertices.empty();
  }

  /// Returns the cube root of the volume of a body, or of that which carries a part [m]; 0 for a
  /// part that no body carries.
  double size(std::int32_t index) const {
    const std::int32_t body = body_of(index);
    return body < 0 ? 0 : item(bodies_, body).size;
  }
  /// Returns the mass of a body [kg].
  double mass(std::int32_t body) const { return item(bodies_, body).mass; }
  /// Returns the inverse mass and moments of inertia of a body with the density of its shape, the
  /// moments times their factor; zeros for an obstacle.
  InverseInertia inverse_inertia(std::int32_t index) const {
    return is_obstacle(index) ? InverseInertia{} : item(bodies_, index).inverse;
  }
  /// Whether any pair rubs.
  bool has_friction(const ContactOptions& options) const;
  /// Returns the distance of the farthest vertex from the centroid of a body or, of a part, from
  /// the origin of the frame of its obstacle [m].
  double radius(std::int32_t index) const {
    return is_obstacle(index) ? part_of(index).radius : item(bodies_, index).radius;
  }
  /// Returns the least width of a body or obstacle, between planes along its faces [m]; infinite
  /// for a half-space. Of several parts it is that of the thickest part.
  double width(std::int32_t index) const {
    return is_obstacle(index) ? part_of(index).width : item(bodies_, index).width;
  }
  /// Whether obstacles may touch each other.
  bool obstacles_touch() const { return obstacles_touch_; }
  /// Returns the mean radius of all bodies but structures [m]; if there is no other, the least
  /// size.
  double mean_radius() const;
  /// Returns the least width of all bodies and obstacles [m].
  double thinnest() const { return thinnest_; }

  /// The faces of a body.
  struct Faces {
    std::int32_t number = 0;
    double area = 0;    ///< of all faces [m^2]
    double widest = 0;  ///< area of the largest face [m^2]
  };
  const Faces& faces(std::int32_t body) const { return item(faces_, body); }

 private:
  /// What an evaluation needs of a body, side by side in memory.
  struct Body {
    std::int32_t first_vertex = 0, vertices = 0;
    std::int32_t first_plane = 0, planes = 0;
    std::size_t first_coordinate = 0;  ///< in coordinates_: lists of x, y, z
    std::int32_t graph = -1;           ///< in graphs_
    double size = 0, mass = 0, radius = 0, width = 0;
    InverseInertia inverse;
  };
  /// What an evaluation needs of a part of an obstacle.
  struct Part {
    std::size_t obstacle = 0;
    double radius = 0, width = 0;
    std::size_t first_coordinate = 0;
    std::int32_t graph = -1, shape = -1;  ///< if a body carries it: in graphs_, carried_shapes_
  };

  const Part& part_of(std::int32_t index) const { return parts_[part_number(index)]; }
  using Graphs = std::map<EdgeGraph, std::int32_t>;
  void add_parts(Graphs& known);
  std::size_t add_lists(std::span<const Vec3<double>> vertices);
  std::int32_t add_graph(const Shapes& shapes, std::int32_t body, Graphs& known);
  void add(std::int32_t body, double mass, Graphs& known);

  Shapes shapes_;
  std::vector<Obstacle> obstacles_;
  double inertia_factor_;
  std::vector<double> coordinates_;
  std::vector<EdgeGraph> graphs_;  ///< different ones: most bodies share one with others
  std::vector<HalfSpace> planes_;
  std::vector<Body> bodies_;
  std::vector<Faces> faces_;                ///< per body
  std::vector<Part> parts_;                 ///< of all obstacles
  Shapes carried_shapes_;                   ///< of the parts that bodies carry
  std::vector<std::size_t> first_part_{0};  ///< per obstacle, then the number of parts
  static constexpr std::uint8_t structure = 2;
  std::vector<std::uint8_t> carries_;   ///< per body: 1 for ice, or structure; empty: none does
  std::vector<std::int32_t> carriers_;  ///< sorted
  bool obstacles_touch_ = false;
  double thinnest_ = std::numeric_limits<double>::infinity();
};

}  // namespace floe
