#include "scene_model/structures.h"

#include <algorithm>
#include <cmath>
#include <Eigen/Eigenvalues>
#include <utility>

#include "floe/base/item.h"
#include "forces/mooring_line.h"
#include "forces/support.h"
#include "geometry/append_faces.h"

namespace floe {
namespace {

/// Mass, centre and principal axes of a structure.
struct Placement {
  Point3 centre;
  Quat<double> axes{1, 0, 0, 0};
  Point3 moments;
};

Placement placement(const Obstacle& obstacle, const Structure& structure) {
  const VolumeProperties volume = volume_properties(obstacle.shape, 0);
  Placement p{.centre = structure.centre.value_or(obstacle.point + volume.centroid), .moments = {}};
  if (structure.inertia) {
    p.moments = *structure.inertia;
    return p;
  }
  Eigen::Matrix3d tensor;
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 3; ++column)
      tensor(row, column) = structure.mass / volume.volume *
                            volume.inertia[static_cast<std::size_t>(3 * row + column)];
  const double off =
      std::max({std::abs(tensor(0, 1)), std::abs(tensor(0, 2)), std::abs(tensor(1, 2))});
  constexpr double rounding = 1e-12;
  if (off <= rounding * tensor.trace()) {  // axes of the world, whatever the order of moments
    p.moments = {tensor(0, 0), tensor(1, 1), tensor(2, 2)};
    return p;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  const Eigen::Vector3d moments = solver.eigenvalues();
  const auto column = [&](Eigen::Index k) {
    const Eigen::Vector3d v = solver.eigenvectors().col(k);
    return Vec3<double>{v(0), v(1), v(2)};
  };
  const Vec3<double> e1 = column(0), e2 = column(1);
  p.axes = normalised(quaternion(Triad<double>{e1, e2, cross(e1, e2)}));
  p.moments = {moments(0), moments(1), moments(2)};
  return p;
}

/// Moments of inertia about axes of the world through the centre [kg m^2].
Point3 moments_in_world(const Placement& p) {
  const Triad<double> axes = triad(p.axes);
  Point3 moments{};
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3<double> along{};
    along[k] = 1;
    const Vec3<double> a = axes.to_local(along);
    moments[k] = p.moments.x * a.x * a.x + p.moments.y * a.y * a.y + p.moments.z * a.z * a.z;
  }
  return moments;
}

/// An obstacle in another frame.
void move_to(Obstacle& obstacle, const Point3& centre, const Triad<double>& axes) {
  const Vec3<double> apart = obstacle.point - centre;
  const auto move = [&](std::vector<Vec3<double>>& points) {
    for (Vec3<double>& r : points) r = axes.to_local(r + apart);
  };
  for (ConvexPart& part : obstacle.parts) {
    for (HalfSpace& plane : part.planes)
      plane = {axes.to_local(plane.normal), plane.offset + dot(plane.normal, apart)};
    move(part.vertices);
    for (InnerFace& face : part.inner_faces) move(face.corners);
  }
  move(obstacle.shape.vertices);
  for (SurfacePatch& patch : obstacle.patches) {
    patch.centre = axes.to_local(patch.centre + apart);
    patch.normal = axes.to_local(patch.normal);
    for (auto* polygons : {&patch.pieces, &patch.covered})
      for (SurfacePatch::Polygon& polygon : *polygons) move(polygon);
  }
  obstacle.point = centre;
}

}  // namespace

void add_structures(const Scene& scene, Lattice& lattice) {
  Bodies& bodies = lattice.bodies;
  if (scene.structures.empty()) return;
  if (lattice.shapes.empty())
    throw InputError("forces: contact needs bodies with a shape; the lattice file has no /shapes");
  for (const Structure& structure : scene.structures) {
    Obstacle obstacle = scene.obstacles[structure.obstacle];
    const Placement p = placement(obstacle, structure);
    if (lattice.sets.contains(obstacle.name))
      throw InputError("obstacle: names: the lattice has a set '" + obstacle.name +
                       "' already; choose another name");
    move_to(obstacle, p.centre, triad(p.axes));
    lattice.sets[obstacle.name] = {bodies.size()};
    bodies.dry.resize(bodies.position.size(), 0);
    bodies.dry.push_back(structure.floats ? 0 : 1);
    if (!bodies.velocity.empty()) bodies.velocity.push_back({});
    if (!bodies.angular_velocity.empty()) bodies.angular_velocity.push_back({});
    bodies.position.push_back(p.centre);
    bodies.orientation.push_back({p.axes.w, p.axes.x, p.axes.y, p.axes.z});
    bodies.mass.push_back(structure.mass);
    bodies.inertia.push_back(p.moments);
    append_bodies(lattice.shapes, obstacle.shape);
  }
}

std::vector<Obstacle> obstacles_on(const Scene& scene, const Lattice& lattice) {
  std::vector<Obstacle> obstacles = scene.obstacles;
  for (const Structure& structure : scene.structures) {
    Obstacle& obstacle = obstacles[structure.obstacle];
    const std::int32_t body = lattice.sets.at(obstacle.name).front();
    const auto [w, x, y, z] = item(lattice.bodies.orientation, body);
    move_to(obstacle, item(lattice.bodies.position, body), triad(Quat<double>{w, x, y, z}));
    obstacle.body = body;
  }
  return obstacles;
}

void add_supports(const Scene& scene, Model<Spatial>& model) {
  if (scene.structures.empty()) return;
  const Part& part = model.part();
  const auto count = static_cast<std::int32_t>(scene.structures.size());
  std::vector<Support> supports;
  std::vector<Model<Spatial>::AddedInertia> added = model.added_inertia();
  added.resize(static_cast<std::size_t>(part.owned));
  bool any = !model.added_inertia().empty();
  for (std::int32_t k = 0; k < count; ++k) {
    const Structure& s = scene.structures[static_cast<std::size_t>(k)];
    const Obstacle& obstacle = scene.obstacles[s.obstacle];
    const Placement p = placement(obstacle, s);
    Support support{.name = obstacle.name,
                    .body = part.global_bodies - count + k,
                    .point = s.support_point.value_or(p.centre),
                    .stiffness = s.stiffness,
                    .damping = s.damping};
    if (s.damping_ratio) {
      const Vec3<double> arm = p.centre - support.point;
      const auto& [mx, my, mz, mrx, mry, mrz] = s.added_mass;
      const Point3 about = moments_in_world(p);
      const std::array<double, 6> inertia{s.mass + mx,
                                          s.mass + my,
                                          s.mass + mz,
                                          about.x + mrx + s.mass * (arm.y * arm.y + arm.z * arm.z),
                                          about.y + mry + s.mass * (arm.x * arm.x + arm.z * arm.z),
                                          about.z + mrz + s.mass * (arm.x * arm.x + arm.y * arm.y)};
      for (std::size_t c = 0; c < 6; ++c)
        support.damping[7 * c] = 2 * *s.damping_ratio * std::sqrt(s.stiffness[7 * c] * inertia[c]);
    }
    supports.push_back(std::move(support));
    const std::int32_t local = part.local_index(supports.back().body);
    const bool has_added =
        std::any_of(s.added_mass.begin(), s.added_mass.end(), [](double m) { return m > 0; });
    any = any || has_added;
    if (has_added && p.axes.w != 1)
      throw InputError("obstacle: " + obstacle.name +
                       ": added_mass: needs a shape whose principal axes are those of the world, "
                       "or 'inertia'");
    if (local < 0 || local >= part.owned) continue;
    item(added, local) = {{s.added_mass[0], s.added_mass[1], s.added_mass[2]},
                          {s.added_mass[3], s.added_mass[4], s.added_mass[5]}};
  }
  if (any) model.set_added_inertia(std::move(added));
  model.add_force(make_supports(part, std::move(supports)));
  std::vector<MooringLine> lines;
  for (const SceneLine& line : scene.lines) {
    lines.push_back(line.line);
    lines.back().body = part.global_bodies - count + static_cast<std::int32_t>(line.structure);
  }
  if (!lines.empty()) model.add_force(make_mooring_lines(part, std::move(lines)));
}

}  // namespace floe
