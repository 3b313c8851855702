#include "output/fields.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

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

}  // namespace

Fields::Fields(const std::string& dir, const Lattice& lattice, std::int64_t keep)
    : dir_(dir), lattice_(lattice) {
  set_topology();
  if (keep >= 0) {
    cut_back(static_cast<std::size_t>(keep));
    write_xmf();  // a run killed before its first frame's name was written has none yet
  } else {
    file_.emplace(Hdf5File::create_growing(dir + "/fields.h5"));
    write_mesh();
  }
}

void Fields::set_topology() {
  const Shapes& s = lattice_.shapes;
  std::vector<std::int32_t>& topology = topology_of_faces_;
  for (std::int32_t b = 0; b < s.bodies(); ++b) {
    const auto body = static_cast<std::size_t>(b);
    for (std::int32_t f = s.face_of[body]; f < s.face_of[body + 1]; ++f) {
      const auto face = static_cast<std::size_t>(f);
      topology.push_back(xdmf_polygon);
      topology.push_back(s.corner_of[face + 1] - s.corner_of[face]);
      topology.insert(topology.end(), s.corners.begin() + s.corner_of[face],
                      s.corners.begin() + s.corner_of[face + 1]);
      body_of_face_.push_back(b);
    }
  }
  if (s.empty()) {  // bodies without a shape are shown as points
    for (std::int32_t b = 0; b < lattice_.bodies.size(); ++b) {
      topology.push_back(b);
      body_of_face_.push_back(b);
    }
  }
  points_ = s.empty() ? lattice_.bodies.position.size() : s.vertices.size();
  topology_ = topology.size();
}

void Fields::write_mesh() {
  file_->write("/mesh/topology", topology_of_faces_);
  file_->write("/mesh/body", body_of_face_);
  if (lattice_.beams.size() > 0)
    file_->write("/mesh/beams",
                 std::span<const std::int32_t>(lattice_.beams.bodies[0].data(),
                                               2 * lattice_.beams.bodies.size()),
                 2);
  file_->flush();
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
  const std::size_t n = lattice_.bodies.position.size();
  std::vector<double> centres(3 * n), points;
  points.reserve(3 * points_);
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t k = 0; k < 3; ++k)
      centres[3 * b + k] = lattice_.bodies.position[b][k] + frame.displacement[3 * b + k];
    if (lattice_.shapes.empty()) continue;
    const auto [w, x, y, z] = lattice_.bodies.orientation[b];
    const double* q = &frame.rotation[4 * b];
    const Triad<double> axes =
        triad(product(normalised({q[0], q[1], q[2], q[3]}), Quat<double>{w, x, y, z}));
    for (std::int32_t v = lattice_.shapes.vertex_of[b]; v < lattice_.shapes.vertex_of[b + 1]; ++v) {
      const Point3& r = lattice_.shapes.vertices[static_cast<std::size_t>(v)];
      const Vec3<double> p = axes.to_world({r[0], r[1], r[2]});
      points.insert(points.end(),
                    {centres[3 * b] + p.x, centres[3 * b + 1] + p.y, centres[3 * b + 2] + p.z});
    }
  }
  file_->write(group + "/centres", centres, 3);
  file_->write(group + "/points", lattice_.shapes.empty() ? centres : points, 3);
  file_->write(group + "/bodies_displacement", frame.displacement, 3);
  file_->write(group + "/bodies_rotation", frame.rotation_vector, 3);
  std::vector<float> displacement, rotation;
  displacement.reserve(3 * body_of_face_.size());
  rotation.reserve(3 * body_of_face_.size());
  for (const std::int32_t body : body_of_face_) {
    for (std::size_t k = 0; k < 3; ++k) {
      displacement.push_back(
          static_cast<float>(frame.displacement[3 * static_cast<std::size_t>(body) + k]));
      rotation.push_back(
          static_cast<float>(frame.rotation_vector[3 * static_cast<std::size_t>(body) + k]));
    }
  }
  file_->write(group + "/face_displacement", displacement, 3);
  file_->write(group + "/face_rotation", rotation, 3);
}

/// Stresses of the section (model.md section 9): sigma = N/A + |M_2| h/(2 I_y) + |M_3| w/(2 I_z),
/// and tau = |Q|/A + |T| (3 + 1.8 b/a)/(a b^2) with a >= b the sides. Without sides: N/A and |Q|/A.
void Fields::write_beams(const std::string& group, const Frame& frame) {
  const Beams& beams = lattice_.beams;
  const auto m = static_cast<std::size_t>(beams.size());
  std::vector<double> force(3 * m), moment(3 * m), stress(2 * m);
  for (std::size_t k = 0; k < m; ++k) {
    const double* s = &frame.sections[6 * k];
    std::copy_n(s, 3, &force[3 * k]);
    std::copy_n(s + 3, 3, &moment[3 * k]);
    double sigma = s[0] / beams.area[k], tau = std::hypot(s[1], s[2]) / beams.area[k];
    if (!beams.width.empty() && !beams.height.empty()) {
      const double w = beams.width[k], h = beams.height[k], a = std::max(w, h), b = std::min(w, h);
      sigma += std::abs(s[4]) * h / (2 * beams.inertia_y[k]) +
               std::abs(s[5]) * w / (2 * beams.inertia_z[k]);
      tau += std::abs(s[3]) * (3 + 1.8 * b / a) / (a * b * b);
    }
    stress[2 * k] = sigma;
    stress[2 * k + 1] = tau;
  }
  file_->write(group + "/beams_force", force, 3);
  file_->write(group + "/beams_moment", moment, 3);
  file_->write(group + "/beams_stress", stress, 2);
  std::vector<double> sigma(m), tau(m);
  for (std::size_t k = 0; k < m; ++k) {
    sigma[k] = stress[2 * k];
    tau[k] = stress[2 * k + 1];
  }
  file_->write(group + "/tensile_stress", sigma);
  file_->write(group + "/shear_stress", tau);
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
      const double* u = &frame.displacement[3 * static_cast<std::size_t>(b)];
      const double* q = &frame.rotation[4 * static_cast<std::size_t>(b)];
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
  const std::string group = group_name(k), faces = std::to_string(body_of_face_.size());
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
      << attribute("face_displacement", group, body_of_face_.size(), 3, "Cell", 4)
      << attribute("face_rotation", group, body_of_face_.size(), 3, "Cell", 4) << "      </Grid>\n";
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
