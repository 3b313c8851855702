#include <algorithm>
#include <cmath>
#include <span>

#include "floe/base/petsc.h"
#include "floe/lattice/lattice.h"

namespace floe {
namespace {

/// Returns cosine and sine of the angle from x to the axis along which the plan extends most. No
/// trigonometric function is used, so the same plan gives the same bits everywhere.
Point2 long_axis(const PlanProperties& plan) {
  const double d = plan.xx - plan.yy, r = std::hypot(d, 2 * plan.xy);
  // The axes of a square or a regular hexagon are rounding errors, so the world's axes are taken.
  if (r <= 1e-12 * (plan.xx + plan.yy)) return {1, 0};
  // c2 is the cosine of the double angle. It gives the larger of c and s; 2 c s gives the other.
  const double c2 = d / r;
  if (c2 >= 0) {
    const double c = std::sqrt((1 + c2) / 2);
    return {c, plan.xy / (r * c)};
  }
  const double s = std::copysign(std::sqrt((1 - c2) / 2), plan.xy);
  return {plan.xy / (r * s), s};
}

/// Returns the unit quaternion of the rotation about z with the given cosine c >= 0 and sine s.
std::array<double, 4> about_z(const Point2& axis) {
  const double w = std::sqrt((1 + axis[0]) / 2);
  return {w, 0, 0, axis[1] / (2 * w)};
}

/// Transforms a polygon (world, plan) to the frame of its centroid and axis.
void to_frame(std::span<const Point2> polygon, const Point2& centroid, const Point2& axis,
              std::vector<Point2>& local) {
  local.clear();
  for (const Point2& p : polygon) {
    const double x = p[0] - centroid[0], y = p[1] - centroid[1];
    local.push_back({axis[0] * x + axis[1] * y, axis[0] * y - axis[1] * x});
  }
}

void reserve(Lattice& lattice, std::size_t n, std::size_t corners, std::size_t m) {
  auto& [position, orientation, mass, inertia, velocity, spin] = lattice.bodies;
  position.reserve(n), orientation.reserve(n), mass.reserve(n), inertia.reserve(n);
  lattice.shapes.vertices.reserve(2 * corners);
  lattice.shapes.corners.reserve(6 * corners);
  lattice.shapes.corner_of.reserve(corners + 2 * n + 1);
  lattice.shapes.face_of.reserve(n + 1), lattice.shapes.vertex_of.reserve(n + 1);
  Beams& b = lattice.beams;
  b.bodies.reserve(m), b.axis_y.reserve(m);
  for (auto* v : {&b.area, &b.inertia_y, &b.inertia_z, &b.torsion, &b.length, &b.young,
                  &b.shear_modulus, &b.shear_factor, &b.width, &b.height}) {
    v->reserve(m);
  }
}

/// Height and middle of the part that two side faces have in common.
struct CommonFace {
  double height, middle;
};
CommonFace common_face(double hi, double zi, double hj, double zj) {
  if (hi == hj && zi == zj) return {hi, zi};
  const double bottom = std::max(zi - hi / 2, zj - hj / 2),
               top = std::min(zi + hi / 2, zj + hj / 2);
  return {top - bottom, (top + bottom) / 2};
}

/// \param h  height of the facet
void append_beam(Beams& beams, const Bodies& bodies, const Facet& facet, double h,
                 const SheetSection& section) {
  const auto [i, j] = facet.cells;
  const double w = facet.width;
  const double x = bodies.position[j][0] - bodies.position[i][0];
  const double y = bodies.position[j][1] - bodies.position[i][1] + facet.shift;
  const double length = std::hypot(x, y);
  const double out_of_plane = w * h * h * h / 12, in_plane = h * w * w * w / 12;
  beams.bodies.push_back(facet.cells);
  beams.area.push_back(w * h);
  beams.inertia_y.push_back(out_of_plane);
  beams.inertia_z.push_back(in_plane);
  beams.torsion.push_back(section.torsion == Torsion::saint_venant ? saint_venant_torsion(w, h)
                                                                   : out_of_plane + in_plane);
  beams.length.push_back(length);
  beams.young.push_back(section.ice.young);
  beams.shear_modulus.push_back(section.ice.young / (2 * (1 + section.ice.poisson)));
  beams.shear_factor.push_back(section.shear_factor);
  beams.axis_y.push_back({-y / length, x / length, 0});  // axis 1 x axis 2 = +z
  beams.width.push_back(w);
  beams.height.push_back(h);
}

}  // namespace

Lattice make_sheet(const Tessellation& cells, const SheetSection& section,
                   std::span<const double> thickness) {
  Lattice lattice;
  const auto n = static_cast<std::int32_t>(cells.generators.size());
  const auto thickness_of = [&](std::int32_t k) {
    return thickness.empty() ? section.thickness : thickness[static_cast<std::size_t>(k)];
  };
  reserve(lattice, cells.generators.size(), cells.vertices.size(), cells.facets.size());
  std::vector<Point2> local;
  for (std::int32_t k = 0; k < n; ++k) {
    const std::span polygon(cells.vertices.data() + cells.offset[k],
                            cells.vertices.data() + cells.offset[k + 1]);
    const PlanProperties plan = plan_properties(polygon);
    const Point2 axis = long_axis(plan);
    const double h = thickness_of(k);
    const double z =
        thickness.empty() ? section.mid_plane : h * (section.mid_plane / section.thickness);
    const double surface_density = section.ice.density * h, mass = surface_density * plan.area;
    // Second moments on the principal axes: `most` along axis 1, so the moment of inertia about
    // axis 1 is the least.
    const double mean = (plan.xx + plan.yy) / 2;
    const double half = std::hypot((plan.xx - plan.yy) / 2, plan.xy);
    const double most = mean + half, least = mean - half, slab = mass * h * h / 12;
    lattice.bodies.position.push_back({plan.centroid[0], plan.centroid[1], z});
    lattice.bodies.orientation.push_back(about_z(axis));
    lattice.bodies.mass.push_back(mass);
    lattice.bodies.inertia.push_back({surface_density * least + slab, surface_density * most + slab,
                                      surface_density * (plan.xx + plan.yy)});
    to_frame(polygon, plan.centroid, axis, local);
    append_prism(lattice.shapes, local, -h / 2, h / 2);
  }
  bool eccentric = false;
  for (const Facet& facet : cells.facets) {
    const auto [i, j] = facet.cells;
    const double zi = lattice.bodies.position[i][2], zj = lattice.bodies.position[j][2];
    const CommonFace face = common_face(thickness_of(i), zi, thickness_of(j), zj);
    append_beam(lattice.beams, lattice.bodies, facet, face.height, section);
    if (thickness.empty()) continue;
    lattice.beams.offsets.push_back({Point3{0, 0, face.middle - zi}, {0, 0, face.middle - zj}});
    eccentric = eccentric || face.middle != zi || face.middle != zj;
  }
  if (!eccentric) lattice.beams.offsets.clear();
  const auto crosses_seam = [](const Facet& facet) { return facet.shift != 0; };
  if (std::any_of(cells.facets.begin(), cells.facets.end(), crosses_seam)) {
    for (const Facet& facet : cells.facets) lattice.beams.image.push_back({0, facet.shift, 0});
  }

  constexpr std::pair<const char*, SheetSide> sides[] = {
      {"left", side_left}, {"right", side_right}, {"bottom", side_bottom}, {"top", side_top}};
  for (const auto& [name, side] : sides) {
    auto& set = lattice.sets[name];
    for (std::int32_t k = 0; k < n; ++k)
      if (cells.sides[k] & side) set.push_back(k);
  }
  return lattice;
}

void cut(Lattice& lattice, const Point2& a, const Point2& b,
         std::span<const std::array<std::int32_t, 2>> on_line) {
  std::vector<std::array<std::int32_t, 2>> pairs(on_line.begin(), on_line.end());
  std::sort(pairs.begin(), pairs.end());
  // A body whose centroid lies on the line of the saw counts as being to its right. A path of beams
  // from one side to the other is then cut exactly once, and beams along the line are not cut.
  const auto left_of = [](const Point2& p, const Point2& q, const Point3& x) {
    return (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]);
  };
  const auto crosses = [&](std::int32_t m) {
    const Point3& p = lattice.bodies.position[lattice.beams.bodies[m][0]];
    const Point3& q = lattice.bodies.position[lattice.beams.bodies[m][1]];
    if ((left_of(a, b, p) > 0) == (left_of(a, b, q) > 0)) return false;
    const Point2 p2{p[0], p[1]}, q2{q[0], q[1]};
    const double sa = left_of(p2, q2, {a[0], a[1], 0}), sb = left_of(p2, q2, {b[0], b[1], 0});
    return (sa <= 0 && sb >= 0) || (sa >= 0 && sb <= 0);
  };
  std::vector<std::int32_t> kept;
  for (std::int32_t m = 0; m < lattice.beams.size(); ++m)
    if (!crosses(m) && !std::binary_search(pairs.begin(), pairs.end(), lattice.beams.bodies[m]))
      kept.push_back(m);

  const auto keep = [&kept](auto& column) {
    if (column.empty()) return;  // optional arrays may be absent
    for (std::size_t k = 0; k < kept.size(); ++k) column[k] = column[kept[k]];
    column.resize(kept.size());
  };
  auto& [bodies, area, iy, iz, torsion, length, young, shear, factor, factor_y, axis, width, height,
         offsets, image, strength, energy] = lattice.beams;
  keep(bodies), keep(area), keep(iy), keep(iz), keep(torsion), keep(length), keep(young);
  keep(shear), keep(factor), keep(factor_y), keep(axis), keep(width), keep(height);
  keep(offsets), keep(image), keep(strength), keep(energy);
}

void add_region(Lattice& lattice, const std::string& name, const std::array<double, 6>& box,
                const std::string& key) {
  if (name == "all" || lattice.sets.contains(name))
    throw InputError(key + ": the lattice already has a set '" + name + "'; choose another name");
  std::vector<std::int32_t> inside;
  for (std::int32_t k = 0; k < lattice.bodies.size(); ++k) {
    const Point3& x = lattice.bodies.position[k];
    if (x[0] >= box[0] && x[0] <= box[1] && x[1] >= box[2] && x[1] <= box[3] && x[2] >= box[4] &&
        x[2] <= box[5])
      inside.push_back(k);
  }
  if (inside.empty()) throw InputError(key + ": no body has its centroid inside this box");
  lattice.sets[name] = std::move(inside);
}

}  // namespace floe
