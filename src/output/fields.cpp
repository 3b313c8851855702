#include "output/fields.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "floe/base/files.h"
#include "floe/base/rotation.h"
#include "floe/output/output.h"

namespace floe {
namespace {

std::string group_name(std::size_t k) {
  char name[32];
  std::snprintf(name, sizeof name, "/t%06zu", k);
  return name;
}

constexpr int xdmf_polygon = 3;

std::string item(const std::string& where, const std::string& dimensions, const char* type,
                 int precision) {
  return "<DataItem Format=\"HDF\" NumberType=\"" + std::string(type) + "\" Precision=\"" +
         std::to_string(precision) + "\" Dimensions=\"" + dimensions + "\">fields.h5:" + where +
         "</DataItem>";
}

std::string attribute(const std::string& name, const std::string& group, std::size_t rows,
                      int columns, const char* centre, int precision) {
  const std::string dimensions =
      std::to_string(rows) + (columns > 1 ? " " + std::to_string(columns) : "");
  return "        <Attribute Name=\"" + name + "\" AttributeType=\"" +
         (columns == 3   ? "Vector"
          : columns == 1 ? "Scalar"
                         : "Matrix") +
         "\" Center=\"" + centre + "\">" +
         item(group + "/" + name, dimensions, "Float", precision) + "</Attribute>\n";
}

std::span<const double> numbers(const std::vector<Point3>& rows) {
  return {rows.empty() ? nullptr : rows[0].data(), 3 * rows.size()};
}

}  // namespace

Fields::Fields(const std::string& dir, const Lattice& lattice, std::int64_t keep)
    : dir_(dir), lattice_(lattice) {
  const Shapes& s = lattice.shapes;
  const std::size_t n = lattice.bodies.position.size();  // points, if bodies have no shapes
  points_ = s.empty() ? n : s.vertices.size();
  faces_ = s.empty() ? n : s.corner_of.size() - 1;
  topology_ = s.empty() ? n : s.corners.size() + 2 * faces_;
  if (keep >= 0) {
    cut_back(static_cast<std::size_t>(keep));
    write_xmf();  // a run killed before its first frame's name was written has none yet
  } else {
    file_.emplace(Hdf5File::create_growing(dir + "/fields.h5"));
    write_mesh();
  }
}

void Fields::write_mesh() {
  const Shapes& s = lattice_.shapes;
  // What comes next: corner `corner` of face `face`, after the face's code and number of corners.
  std::size_t face = 0;
  std::int32_t corner = -2;
  file_->write_blocks<std::int32_t>(
      "/mesh/topology", static_cast<std::int64_t>(topology_), 1,
      [&](std::int64_t first, std::span<std::int32_t> values) {
        if (s.empty()) std::iota(values.begin(), values.end(), static_cast<std::int32_t>(first));
        if (s.empty()) return;
        for (std::int32_t& value : values) {
          const std::int32_t begin = s.corner_of[face], count = s.corner_of[face + 1] - begin;
          value = corner == -2   ? xdmf_polygon
                  : corner == -1 ? count
                                 : s.corners[static_cast<std::size_t>(begin + corner)];
          if (++corner < count) continue;
          corner = -2;
          ++face;
        }
      });
  std::int32_t body = 0;
  file_->write_blocks<std::int32_t>("/mesh/body", static_cast<std::int64_t>(faces_), 1,
                                    [&](std::int64_t first, std::span<std::int32_t> values) {
                                      for (std::int32_t& value : values)
                                        value = body = body_of_face(first++, body);
                                    });
  if (lattice_.beams.size() > 0)
    file_->write("/mesh/beams",
                 std::span<const std::int32_t>(lattice_.beams.bodies[0].data(),
                                               2 * lattice_.beams.bodies.size()),
                 2);
  file_->flush();
}

/// \param from  a body whose faces begin at `face` or before
std::int32_t Fields::body_of_face(std::int64_t face, std::int32_t from) const {
  if (lattice_.shapes.empty()) return static_cast<std::int32_t>(face);
  while (face >= lattice_.shapes.face_of[static_cast<std::size_t>(from) + 1]) ++from;
  return from;
}

void Fields::require(const std::string& dir, std::int64_t frames) {
  const std::string path = dir + "/fields.h5", key = "checkpoint: restart";
  const Hdf5File file = Hdf5File::open(path, key);
  for (std::int64_t k = 0; k < frames; ++k) {
    if (!file.has(group_name(static_cast<std::size_t>(k))))
      throw InputError(key + ": '" + path + "' has " + std::to_string(k) +
                       " frames, the checkpoint knows of " + std::to_string(frames));
  }
}

/// Keeps the mesh and the first frames. Later ones are left behind in the old file, whose copy
/// takes its place: HDF5 gives no room back, and a process killed here loses nothing.
void Fields::cut_back(std::size_t keep) {
  const std::string path = dir_ + "/fields.h5", key = "checkpoint: restart";
  bool as_it_is = false;
  {
    const Hdf5File old = Hdf5File::open(path, key);
    for (std::size_t k = 0; k < keep; ++k) {
      if (!old.has(group_name(k)))
        throw InputError(key + ": '" + path + "' has " + std::to_string(k) +
                         " frames, the checkpoint knows of " + std::to_string(keep));
      times_.push_back(old.read_attribute(group_name(k), "time"));
      breakable_ = old.has(group_name(k) + "/damage");
      const std::string cracks = group_name(k) + "/cracks";
      cracks_.push_back(old.has(cracks) ? static_cast<std::size_t>(old.shape(cracks).first) : 0);
    }
    as_it_is = !old.has(group_name(keep));
    if (!as_it_is) {
      // HDF5 1.10 crashes where its copy of an object meets a full disk.
      Hdf5File kept = Hdf5File::create(path, std::filesystem::file_size(path));
      kept.copy(old, "/mesh");
      for (std::size_t k = 0; k < keep; ++k) kept.copy(old, group_name(k));
      write_xmf();  // before the frames go: a run killed in between leaves no name of a frame that
                    // is gone
      kept.close();
    }
  }
  file_.emplace(Hdf5File::open_growing(path));
}

void Fields::write(const Frame& frame) {
  const std::string group = group_name(times_.size());
  file_->stage(group);
  write_bodies(group, frame);
  if (lattice_.beams.size() > 0) write_beams(group, frame);
  cracks_.push_back(0);
  breakable_ = !frame.damage.empty();
  if (breakable_) write_cracks(group, frame);
  file_->attribute(group, "time", frame.time);
  file_->publish();
  times_.push_back(frame.time);
  write_xmf();  // after it is on disk: it never names a frame that is not
}

void Fields::write_bodies(const std::string& group, const Frame& frame) {
  const std::vector<Point3>& rest = lattice_.bodies.position;
  const auto centre = [&](std::size_t b, std::size_t k) {
    return rest[b][k] + frame.displacement[b][k];
  };
  const auto centres = [&](std::int64_t first, std::span<double> values) {
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = centre(static_cast<std::size_t>(first) + k / 3, k % 3);
  };
  const auto rows = static_cast<std::int64_t>(rest.size());
  file_->write_blocks<double>(group + "/centres", rows, 3, centres);
  const Shapes& s = lattice_.shapes;
  std::size_t body = 0;
  file_->write_blocks<double>(group + "/points", static_cast<std::int64_t>(points_), 3,
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
                                  const Point3& r = s.vertices[v];
                                  const Vec3<double> p = axes.to_world({r[0], r[1], r[2]});
                                  values[k] = centre(body, 0) + p.x;
                                  values[k + 1] = centre(body, 1) + p.y;
                                  values[k + 2] = centre(body, 2) + p.z;
                                }
                              });
  file_->write(group + "/bodies_displacement", numbers(frame.displacement), 3);
  file_->write(group + "/bodies_rotation", numbers(frame.rotation_vector), 3);
  write_on_faces(group + "/face_displacement", frame.displacement);
  write_on_faces(group + "/face_rotation", frame.rotation_vector);
}

Triad<double> Fields::axes_of(std::size_t body, const Frame& frame) const {
  const auto [w, x, y, z] = lattice_.bodies.orientation[body];
  const auto& q = frame.rotation[body];
  return triad(product(normalised({q[0], q[1], q[2], q[3]}), Quat<double>{w, x, y, z}));
}

void Fields::write_on_faces(const std::string& name, const std::vector<Point3>& of_bodies) {
  std::int32_t body = 0;
  file_->write_blocks<float>(name, static_cast<std::int64_t>(faces_), 3,
                             [&](std::int64_t first, std::span<float> values) {
                               for (std::size_t k = 0; k < values.size(); k += 3) {
                                 body = body_of_face(first++, body);
                                 const Point3& row = of_bodies[static_cast<std::size_t>(body)];
                                 std::copy(row.begin(), row.end(), &values[k]);
                               }
                             });
}

/// Stresses of the section (model.md section 9): sigma = N/A + |M_2| h/(2 I_y) + |M_3| w/(2 I_z),
/// and tau = |Q|/A + |T| (3 + 1.8 b/a)/(a b^2) with a >= b the sides. Without sides: N/A and |Q|/A.
void Fields::write_beams(const std::string& group, const Frame& frame) {
  const Beams& beams = lattice_.beams;
  const auto m = static_cast<std::int64_t>(beams.size());
  // \param value  of component k of beam m
  const auto write = [&](const char* name, std::size_t columns, auto value) {
    file_->write_blocks<double>(group + name, m, static_cast<int>(columns),
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

/// A broken section lay halfway between its bodies' centroids; each body has carried its side
/// along.
void Fields::write_cracks(const std::string& group, const Frame& frame) {
  const Beams& beams = lattice_.beams;
  std::vector<double> points;
  std::vector<std::int32_t> corners, beam;
  for (std::size_t m = 0; m < frame.damage.size(); ++m) {
    if (frame.damage[m] < 1) continue;
    const auto [i, j] = beams.bodies[m];
    const auto at = [&](std::int32_t b) {
      const Point3& x = lattice_.bodies.position[static_cast<std::size_t>(b)];
      return Vec3<double>{x[0], x[1], x[2]};
    };
    const Vec3<double> chord = at(j) - at(i);
    const Vec3<double> e1 = (1 / std::sqrt(dot(chord, chord))) * chord;
    Vec3<double> e2{beams.axis_y[m][0], beams.axis_y[m][1], beams.axis_y[m][2]};
    e2 = e2 - dot(e2, e1) * e1;
    e2 = (1 / std::sqrt(dot(e2, e2))) * e2;
    const Vec3<double> y = (0.5 * beams.width[m]) * e2, z = (0.5 * beams.height[m]) * cross(e1, e2);
    for (const std::int32_t b : {i, j}) {
      const Point3& u = frame.displacement[static_cast<std::size_t>(b)];
      const auto& q = frame.rotation[static_cast<std::size_t>(b)];
      const Vec3<double> middle = 0.5 * (at(i) + at(j)) - at(b);
      for (const Vec3<double>& corner :
           {middle - y - z, middle + y - z, middle + y + z, middle - y + z}) {
        const Vec3<double> p = at(b) + Vec3<double>{u[0], u[1], u[2]} +
                               rotate(normalised(Quat<double>{q[0], q[1], q[2], q[3]}), corner);
        corners.push_back(static_cast<std::int32_t>(points.size() / 3));
        points.insert(points.end(), {p.x, p.y, p.z});
      }
      beam.push_back(static_cast<std::int32_t>(m));
    }
  }
  file_->write(group + "/damage", frame.damage);
  if (beam.empty()) return;
  file_->write(group + "/crack_points", points, 3);
  file_->write(group + "/cracks", corners, 4);
  file_->write(group + "/crack_beam", beam);
  cracks_.back() = beam.size();
}

std::string Fields::cracks_grid(std::size_t k) const {
  const std::string group = group_name(k), faces = std::to_string(cracks_[k]);
  return "      <Grid Name=\"cracks\">\n        <Topology TopologyType=\"Quadrilateral\" "
         "NumberOfElements=\"" +
         faces + "\">" + item(group + "/cracks", faces + " 4", "Int", 4) +
         "</Topology>\n        <Geometry GeometryType=\"XYZ\">" +
         item(group + "/crack_points", std::to_string(4 * cracks_[k]) + " 3", "Float", 8) +
         "</Geometry>\n        <Attribute Name=\"beam\" AttributeType=\"Scalar\" Center=\"Cell\">" +
         item(group + "/crack_beam", faces, "Int", 4) + "</Attribute>\n      </Grid>\n";
}

/// The grids of one time: bodies as polygons, beams as lines, faces of cracks.
std::string Fields::grid(std::size_t k) const {
  const std::string group = group_name(k), faces = std::to_string(faces_);
  const std::size_t n = lattice_.bodies.position.size(), m = lattice_.beams.bodies.size();
  std::ostringstream out;
  out.precision(17);
  out << "    <Grid Name=\"sheet\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
      << "      <Time Value=\"" << times_[k] << "\"/>\n"
      << "      <Grid Name=\"bodies\">\n        <Topology TopologyType=\""
      << (lattice_.shapes.empty() ? "Polyvertex\" NodesPerElement=\"1" : "Mixed")
      << "\" NumberOfElements=\"" << faces << "\">"
      << item("/mesh/topology", std::to_string(topology_), "Int", 4) << "</Topology>\n"
      << "        <Geometry GeometryType=\"XYZ\">"
      << item(group + "/points", std::to_string(points_) + " 3", "Float", 8)
      << "</Geometry>\n        <Attribute Name=\"body\" AttributeType=\"Scalar\" Center=\"Cell\">"
      << item("/mesh/body", faces, "Int", 4) << "</Attribute>\n"
      << attribute("face_displacement", group, faces_, 3, "Cell", 4)
      << attribute("face_rotation", group, faces_, 3, "Cell", 4) << "      </Grid>\n";
  if (m > 0) {
    out << "      <Grid Name=\"beams\">\n        <Topology TopologyType=\"Polyline\" "
           "NodesPerElement=\"2\" "
        << "NumberOfElements=\"" << m << "\">"
        << item("/mesh/beams", std::to_string(m) + " 2", "Int", 4)
        << "</Topology>\n        <Geometry GeometryType=\"XYZ\">"
        << item(group + "/centres", std::to_string(n) + " 3", "Float", 8) << "</Geometry>\n"
        << attribute("bodies_displacement", group, n, 3, "Node", 8)
        << attribute("bodies_rotation", group, n, 3, "Node", 8)
        << attribute("beams_force", group, m, 3, "Cell", 8)
        << attribute("beams_moment", group, m, 3, "Cell", 8)
        << attribute("tensile_stress", group, m, 1, "Cell", 8)
        << attribute("shear_stress", group, m, 1, "Cell", 8)
        << (breakable_ ? attribute("damage", group, m, 1, "Cell", 8) : "") << "      </Grid>\n";
  }
  if (cracks_[k] > 0) out << cracks_grid(k);
  out << "    </Grid>\n";
  return out.str();
}

void Fields::write_xmf() const {
  std::string text =
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
      "  <Grid Name=\"floe\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::size_t k = 0; k < times_.size(); ++k) text += grid(k);
  write_whole(dir_ + "/fields.xmf", text + "  </Grid>\n</Domain>\n</Xdmf>\n");
}

}  // namespace floe
