#include "scene_model/bonds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include "contact/broad_phase.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/lattice/material.h"
#include "geometry/interface.h"
#include "lattice/permute.h"
#include "scene/reading.h"

namespace floe {
namespace {

/// Vertices of all bodies in the world, in the order of the shapes [m].
std::vector<Point3> placed_vertices(const Lattice& lattice) {
  const Shapes& shapes = lattice.shapes;
  std::vector<Point3> placed;
  placed.reserve(shapes.vertices.size());
  for (std::int32_t b = 0; b < shapes.bodies(); ++b) {
    const auto& [w, x, y, z] = item(lattice.bodies.orientation, b);
    const Triad<double> axes = triad(Quat<double>{w, x, y, z});
    for (std::int32_t v = item(shapes.vertex_of, b); v < item(shapes.vertex_of, b + 1); ++v)
      placed.push_back(item(lattice.bodies.position, b) + axes.to_world(item(shapes.vertices, v)));
  }
  return placed;
}

/// The pairs of bodies within `reach` of each other that no beam joins, sorted.
std::vector<std::array<std::int32_t, 2>> loose_pairs(const Lattice& lattice, double reach) {
  const Shapes& shapes = lattice.shapes;
  std::vector<double> radii;
  for (std::int32_t b = 0; b < shapes.bodies(); ++b) {
    double radius = 0;
    for (std::int32_t v = item(shapes.vertex_of, b); v < item(shapes.vertex_of, b + 1); ++v)
      radius = std::max(radius, length(item(shapes.vertices, v)));
    radii.push_back(radius);
  }
  std::vector<BodyPair> near;
  const std::vector<std::uint8_t> wanted(radii.size(), 1);
  near_pairs(lattice.bodies.position, radii, reach, wanted, near);
  std::vector<std::array<std::int32_t, 2>> joined = lattice.beams.bodies, pairs;
  std::sort(joined.begin(), joined.end());
  for (const auto& [i, j] : near) {
    const std::array<std::int32_t, 2> pair{i, j};
    if (!std::binary_search(joined.begin(), joined.end(), pair)) pairs.push_back(pair);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Bodies that beams join to each body, sorted.
std::vector<std::vector<std::int32_t>> neighbours(const Lattice& lattice) {
  std::vector<std::vector<std::int32_t>> all(lattice.bodies.position.size());
  for (const auto& [i, j] : lattice.beams.bodies)
    item(all, i).push_back(j), item(all, j).push_back(i);
  for (auto& of_body : all) std::sort(of_body.begin(), of_body.end());
  return all;
}

bool is_in(const std::array<double, 6>& box, const Point3& p) {
  return p.x >= box[0] && p.x <= box[1] && p.y >= box[2] && p.y <= box[3] && p.z >= box[4] &&
         p.z <= box[5];
}

/// Gives optional columns their values where there are none yet: beams that end at centroids, a
/// shear factor for both directions, the scene's own strength.
void fill_columns(Beams& beams, std::size_t size) {
  beams.offsets.resize(size, {Point3{}, Point3{}});
  beams.strength.resize(size, 1.0);
  beams.energy.resize(size, 1.0);
}

void append(Beams& beams, const Bodies& bodies, const std::array<std::int32_t, 2>& pair,
            const Interface& face, const Scene& scene) {
  const auto& [i, j] = pair;
  const Point3 xi = item(bodies.position, i), xj = item(bodies.position, j);
  const double from = dot(xi - face.centre, face.normal), to = dot(xj - face.centre, face.normal);
  // A rectangle of the interface's area and ratio of second moments.
  const double slender = std::sqrt(face.most / std::max(face.least, 1e-12 * face.most));
  const double width = std::sqrt(face.area * slender), height = face.area / width;
  const Bonds& bonds = scene.bonds;
  beams.bodies.push_back(pair);
  beams.area.push_back(face.area);
  beams.inertia_y.push_back(std::max(face.least, 1e-12 * face.most));
  beams.inertia_z.push_back(face.most);
  beams.torsion.push_back(saint_venant_torsion(width, height));
  beams.length.push_back(to - from);
  beams.young.push_back(bonds.young);
  beams.shear_modulus.push_back(bonds.young / (2 * (1 + scene.ice.poisson)));
  beams.shear_factor.push_back(scene.shear_factor);
  beams.axis_y.push_back(face.axis);
  beams.width.push_back(width);
  beams.height.push_back(height);
  beams.offsets.push_back(
      {face.centre + from * face.normal - xi, face.centre + to * face.normal - xj});
  beams.strength.push_back(bonds.strength);
  beams.energy.push_back(bonds.energy);
}

}  // namespace

std::string text_of(const BondReport& report) {
  return std::to_string(report.number) + " between faces, " + text_of(report.area) +
         " m^2; gaps from " + text_of(report.least_gap) + " to " + text_of(report.most_gap) + " m";
}

BondReport add_bonds(const Scene& scene, Lattice& lattice) {
  if (lattice.shapes.empty())
    throw InputError("bonds: gap: '" + scene.lattice_file +
                     "' has no /shapes, and bonds are between faces");
  const Shapes& shapes = lattice.shapes;
  Beams& beams = lattice.beams;
  const auto before = beams.bodies.size();
  if (before > 0 && (beams.width.size() != before || beams.height.size() != before))
    throw InputError("bonds: gap: '" + scene.lattice_file +
                     "' has no /beams/width and /beams/height, and bonds have them");
  const std::vector<Point3> placed = placed_vertices(lattice);
  const auto vertices = [&](std::int32_t b) {
    const auto first = static_cast<std::size_t>(item(shapes.vertex_of, b));
    return std::span(placed).subspan(
        first, static_cast<std::size_t>(item(shapes.vertex_of, b + 1)) - first);
  };
  const auto near = neighbours(lattice);
  const auto is_between = [&](std::int32_t i, std::int32_t j, const Point3& middle) {
    std::vector<std::int32_t> both;
    std::set_intersection(item(near, i).begin(), item(near, i).end(), item(near, j).begin(),
                          item(near, j).end(), std::back_inserter(both));
    return std::any_of(both.begin(), both.end(), [&](std::int32_t k) {
      return is_inside(shapes, k, vertices(k), middle, 1e-3 * scene.bonds.gap);
    });
  };
  fill_columns(beams, before);
  BondReport report;
  for (const auto& pair : loose_pairs(lattice, scene.bonds.gap)) {
    const auto [i, j] = pair;
    const std::optional<Interface> face =
        find_interface(shapes, i, j, vertices(i), vertices(j), scene.bonds.gap);
    constexpr double least = 1e-3;
    if (!face || !is_in(scene.bonds.box, face->centre) || is_between(i, j, face->centre)) continue;
    const double volume =
        std::min(volume_properties(shapes, i).volume, volume_properties(shapes, j).volume);
    const double along =
        dot(item(lattice.bodies.position, j) - item(lattice.bodies.position, i), face->normal);
    if (face->area < least * std::cbrt(volume * volume) || !(along > 0)) continue;
    append(beams, lattice.bodies, pair, *face, scene);
    report.least_gap = report.number == 0 ? face->gap : std::min(report.least_gap, face->gap);
    report.most_gap = report.number == 0 ? face->gap : std::max(report.most_gap, face->gap);
    report.area += face->area;
    ++report.number;
  }
  if (report.number == 0)
    throw InputError("bonds: gap: " + text_of(scene.bonds.gap) +
                     ": no two bodies without a beam between them have faces this near" +
                     (scene.bonds.in_box ? " in bonds: box" : ""));
  if (!beams.shear_factor_y.empty())
    beams.shear_factor_y.resize(beams.bodies.size(), scene.shear_factor);
  if (before == 0) return report;
  // A lattice's beams are sorted by their bodies.
  std::vector<std::int32_t> order(beams.bodies.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::int32_t>(k);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return item(beams.bodies, a) < item(beams.bodies, b);
  });
  permute(beams, order);
  return report;
}

}  // namespace floe
