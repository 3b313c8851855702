#include "output/frame.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "floe/base/item.h"
#include "floe/base/rotation.h"

namespace floe {
namespace {

constexpr int xdmf_polygon = 3;

}  // namespace

FrameWriter::FrameWriter(const Lattice& lattice) : lattice_(lattice) {
  const Shapes& s = lattice.shapes;
  sizes_.bodies = lattice.bodies.position.size();
  sizes_.beams = lattice.beams.bodies.size();
  sizes_.shapes = !s.empty();
  sizes_.points = s.empty() ? sizes_.bodies : s.vertices.size();
  sizes_.faces = s.empty() ? sizes_.bodies : s.corner_of.size() - 1;
  sizes_.topology = s.empty() ? sizes_.bodies : s.corners.size() + 2 * sizes_.faces;
}

std::size_t FrameWriter::write(Hdf5File& file, const std::string& group, const Frame& frame) const {
  write_bodies(file, group, frame);
  if (sizes_.beams > 0) write_beams(file, group, frame);
  const std::size_t cracks = frame.damage.empty() ? 0 : write_cracks(file, group, frame);
  file.attribute(group, "time", frame.time);
  return cracks;
}

void FrameWriter::write_mesh(Hdf5File& file) const {
  const Shapes& s = lattice_.shapes;
  // State of the loop: the next value is corner `corner` of face `face`; -2 and -1 stand for the
  // face's code and its number of corners.
  std::size_t face = 0;
  std::int32_t corner = -2;
  file.write_blocks<std::int32_t>(
      "/mesh/topology", static_cast<std::int64_t>(sizes_.topology), 1,
      [&](std::int64_t first, std::span<std::int32_t> values) {
        if (s.empty()) std::iota(values.begin(), values.end(), static_cast<std::int32_t>(first));
        if (s.empty()) return;
        for (std::int32_t& value : values) {
          const std::int32_t begin = s.corner_of[face], count = s.corner_of[face + 1] - begin;
          value =
              corner == -2 ? xdmf_polygon
              : corner == -1
                  ? count
                  : s.corners[static_cast<std::size_t>(begin) + static_cast<std::size_t>(corner)];
          if (++corner < count) continue;
          corner = -2;
          ++face;
        }
      });
  std::int32_t body = 0;
  file.write_blocks<std::int32_t>("/mesh/body", static_cast<std::int64_t>(sizes_.faces), 1,
                                  [&](std::int64_t first, std::span<std::int32_t> values) {
                                    for (std::int32_t& value : values)
                                      value = body = body_of_face(first++, body);
                                  });
  if (lattice_.beams.size() > 0)
    file.write("/mesh/beams",
               std::span<const std::int32_t>(lattice_.beams.bodies[0].data(),
                                             2 * lattice_.beams.bodies.size()),
               2);
}

/// Returns the body of a face. \param from  a body whose faces begin at `face` or before
std::int32_t FrameWriter::body_of_face(std::int64_t face, std::int32_t from) const {
  if (lattice_.shapes.empty()) return static_cast<std::int32_t>(face);
  while (face >= lattice_.shapes.face_of[static_cast<std::size_t>(from) + 1]) ++from;
  return from;
}

void FrameWriter::write_bodies(Hdf5File& file, const std::string& group, const Frame& frame) const {
  const std::vector<Point3>& rest = lattice_.bodies.position;
  const auto centre = [&](std::size_t b, std::size_t k) {
    return rest[b][k] + frame.displacement[b][k];
  };
  const auto centres = [&](std::int64_t first, std::span<double> values) {
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = centre(static_cast<std::size_t>(first) + k / 3, k % 3);
  };
  const auto rows = static_cast<std::int64_t>(rest.size());
  file.write_blocks<double>(group + "/centres", rows, 3, centres);
  const Shapes& s = lattice_.shapes;
  std::size_t body = 0;
  file.write_blocks<double>(group + "/points", static_cast<std::int64_t>(sizes_.points), 3,
                            [&](std::int64_t first, std::span<double> values) {
                              if (s.empty()) return centres(first, values);
                              Triad<double> axes = axes_of(body, frame);
                              for (std::size_t k = 0; k < values.size(); k += 3) {
                                const auto v = static_cast<std::size_t>(first) + k / 3;
                                if (v >= static_cast<std::size_t>(s.vertex_of[body + 1])) {
                                  while (v >= static_cast<std::size_t>(s.vertex_of[body + 1]))
                                    ++body;
                                  axes = axes_of(body, frame);
                                }
                                const Vec3<double> p = axes.to_world(s.vertices[v]);
                                values[k] = centre(body, 0) + p.x;
                                values[k + 1] = centre(body, 1) + p.y;
                                values[k + 2] = centre(body, 2) + p.z;
                              }
                            });
  file.write(group + "/bodies_displacement", frame.displacement);
  file.write(group + "/bodies_rotation", frame.rotation_vector);
  write_on_faces(file, group + "/face_displacement", frame.displacement);
  write_on_faces(file, group + "/face_rotation", frame.rotation_vector);
}

Triad<double> FrameWriter::axes_of(std::size_t body, const Frame& frame) const {
  const auto [w, x, y, z] = lattice_.bodies.orientation[body];
  const auto& q = frame.rotation[body];
  return triad(product(normalised({q[0], q[1], q[2], q[3]}), Quat<double>{w, x, y, z}));
}

void FrameWriter::write_on_faces(Hdf5File& file, const std::string& name,
                                 const std::vector<Point3>& of_bodies) const {
  std::int32_t body = 0;
  file.write_blocks<float>(name, static_cast<std::int64_t>(sizes_.faces), 3,
                           [&](std::int64_t first, std::span<float> values) {
                             for (std::size_t k = 0; k < values.size(); k += 3) {
                               body = body_of_face(first++, body);
                               const Point3& row = item(of_bodies, body);
                               for (std::size_t n = 0; n < 3; ++n)
                                 values[k + n] = static_cast<float>(row[n]);
                             }
                           });
}

/// Writes forces, moments and stresses of the section (model.md, "Files"): sigma = N/A + |M_2| h/(2
/// I_y) + |M_3| w/(2 I_z), and tau = |Q|/A + |T| (3 + 1.8 b/a)/(a b^2) with a >= b the sides.
/// Without sides: N/A and |Q|/A.
void FrameWriter::write_beams(Hdf5File& file, const std::string& group, const Frame& frame) const {
  const Beams& beams = lattice_.beams;
  const auto m = static_cast<std::int64_t>(beams.size());
  // \param value  function that returns component k of beam m
  const auto write = [&](const char* name, std::size_t columns, auto value) {
    file.write_blocks<double>(group + name, m, static_cast<int>(columns),
                              [&](std::int64_t first, std::span<double> values) {
                                for (std::size_t k = 0; k < values.size(); ++k)
                                  values[k] = value(static_cast<std::size_t>(first) + k / columns,
                                                    k % columns);
                              });
  };
  const bool has_sides = !beams.width.empty() && !beams.height.empty();
  const auto tensile = [&](std::size_t k) {
    const BeamSection& s = frame.sections[k];
    const double bent = has_sides ? std::abs(s[4]) * beams.height[k] / (2 * beams.inertia_y[k]) +
                                        std::abs(s[5]) * beams.width[k] / (2 * beams.inertia_z[k])
                                  : 0;
    return s[0] / beams.area[k] + bent;
  };
  const auto shear = [&](std::size_t k) {
    const BeamSection& s = frame.sections[k];
    const double tau = std::hypot(s[1], s[2]) / beams.area[k];
    if (!has_sides) return tau;
    const double a = std::max(beams.width[k], beams.height[k]),
                 b = std::min(beams.width[k], beams.height[k]);
    return tau + std::abs(s[3]) * (3 + 1.8 * b / a) / (a * b * b);
  };
  write("/beams_force", 3, [&](std::size_t b, std::size_t k) { return frame.sections[b][k]; });
  write("/beams_moment", 3, [&](std::size_t b, std::size_t k) { return frame.sections[b][3 + k]; });
  write("/beams_stress", 2,
        [&](std::size_t b, std::size_t k) { return k == 0 ? tensile(b) : shear(b); });
  write("/tensile_stress", 1, [&](std::size_t b, std::size_t) { return tensile(b); });
  write("/shear_stress", 1, [&](std::size_t b, std::size_t) { return shear(b); });
}

/// Writes the two faces of each broken section. The section lay halfway between its beam's ends;
/// each body has carried its face along.
std::size_t FrameWriter::write_cracks(Hdf5File& file, const std::string& group,
                                      const Frame& frame) const {
  const Beams& beams = lattice_.beams;
  std::vector<double> points;
  std::vector<std::int32_t> corners, beam;
  for (std::size_t m = 0; m < frame.damage.size(); ++m) {
    if (frame.damage[m] < 1) continue;
    const auto [i, j] = beams.bodies[m];
    const auto at = [&](std::int32_t b) { return item(lattice_.bodies.position, b); };
    const auto index = static_cast<std::int32_t>(m);
    const Vec3<double> along = chord(lattice_.bodies, beams, index);
    const Vec3<double> first = at(i) + offset(beams, index, 0), second = first + along;
    const Vec3<double> e1 = (1 / std::sqrt(dot(along, along))) * along;
    Vec3<double> e2 = beams.axis_y[m];
    e2 = e2 - dot(e2, e1) * e1;
    e2 = (1 / std::sqrt(dot(e2, e2))) * e2;
    const Vec3<double> y = (0.5 * beams.width[m]) * e2, z = (0.5 * beams.height[m]) * cross(e1, e2);
    for (const std::int32_t b : {i, j}) {
      const auto& q = item(frame.rotation, b);
      const Vec3<double> middle = 0.5 * (first + second) - at(b);
      for (const Vec3<double>& corner :
           {middle - y - z, middle + y - z, middle + y + z, middle - y + z}) {
        const Vec3<double> p = at(b) + item(frame.displacement, b) +
                               rotate(normalised(Quat<double>{q[0], q[1], q[2], q[3]}), corner);
        corners.push_back(static_cast<std::int32_t>(points.size() / 3));
        points.insert(points.end(), {p.x, p.y, p.z});
      }
      beam.push_back(index);
    }
  }
  file.write(group + "/damage", frame.damage);
  if (beam.empty()) return 0;
  file.write(group + "/crack_points", points, 3);
  file.write(group + "/cracks", corners, 4);
  file.write(group + "/crack_beam", beam);
  return beam.size();
}

}  // namespace floe
