#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <span>
#include <utility>

#include "files/hdf5.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/base/rotation.h"
#include "floe/lattice/lattice.h"
#include "geometry/overlap.h"
#include "lattice/shapes_file.h"
#include "options/option_values.h"
#include "options/spelling.h"

namespace floe {
namespace {

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

/// Reads and checks datasets; every error message names the file and the dataset.
class Reader {
 public:
  explicit Reader(const std::string& path, std::string key = "lattice_file")
      : path_(path), key_(std::move(key)), file_(Hdf5File::open(path, key_)) {}

  [[noreturn]] void refuse(const std::string& dataset, const std::string& why) const {
    throw InputError(key_ + ": '" + path_ + "': " + dataset + ": " + why);
  }
  const Hdf5File& file() const { return file_; }

  std::vector<double> scalars(const std::string& name, std::size_t count,
                              bool positive = true) const {
    std::vector<double> values = file_.read(name);
    expect(name, values.size(), count);
    for (std::size_t k = 0; k < count; ++k) {
      check_size(name, "entry", k, values[k]);
      if (positive) check_positive(name, "entry", k, values[k]);
    }
    return values;
  }

  /// Reads rows of a type that holds nothing but numbers, which its operator[] returns.
  template <class Row>
  std::vector<Row> rows(const std::string& name, std::size_t count) const {
    constexpr std::size_t columns = sizeof(Row) / sizeof(double);
    const std::vector<double> values = file_.read(name, columns);
    expect(name, values.size() / columns, count);
    std::vector<Row> out(count);
    for (std::size_t k = 0; k < values.size(); ++k) {
      check_size(name, "row", k / columns, values[k]);
      out[k / columns][k % columns] = values[k];
    }
    return out;
  }

  std::vector<std::int32_t> indices(const std::string& name, std::size_t limit,
                                    int columns = 1) const {
    std::vector<std::int32_t> values = file_.read_indices(name, columns);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] < 0 || static_cast<std::size_t>(values[k]) >= limit)
        refuse(name, "entry " + std::to_string(k) + " is " + std::to_string(values[k]) +
                         ", must be between 0 and " + std::to_string(limit) + " (exclusive)");
    }
    return values;
  }

  void check_positive(const std::string& name, const char* what, std::size_t k,
                      double value) const {
    constexpr double least = 1e-30;
    if (!(value >= least))
      refuse(name, std::string(what) + " " + std::to_string(k) + " is " + text_of(value) +
                       ", must be > 0" + (value > 0 ? " and at least 1e-30" : ""));
  }

 private:
  /// Limits the size of values, so that products and quotients of a few of them are finite.
  void check_size(const std::string& name, const char* what, std::size_t k, double value) const {
    constexpr double largest = 1e30;
    if (!(std::abs(value) <= largest))
      refuse(name, std::string(what) + " " + std::to_string(k) + " has the value " +
                       text_of(value) + ", must be finite and at most 1e30 in size");
  }
  void expect(const std::string& name, std::size_t actual, std::size_t count) const {
    if (actual != count)
      refuse(name, "has " + std::to_string(actual) + " rows, must have " + std::to_string(count));
  }
  std::string path_, key_;
  Hdf5File file_;
};

Bodies read_bodies(const Reader& in) {
  Bodies b;
  const auto n = static_cast<std::size_t>(in.file().shape("/bodies/position").first);
  if (n == 0) in.refuse("/bodies/position", "there must be at least one body");
  b.position = in.rows<Point3>("/bodies/position", n);
  b.orientation = in.rows<std::array<double, 4>>("/bodies/orientation", n);
  for (std::size_t k = 0; k < n; ++k) {
    auto& [w, x, y, z] = b.orientation[k];
    const double norm = std::sqrt(w * w + x * x + y * y + z * z);
    if (std::abs(norm - 1) > 1e-6)
      in.refuse("/bodies/orientation",
                "row " + std::to_string(k) + " is not a unit quaternion (w x y z)");
    // Quaternions that floe wrote are unit to rounding and must keep their bits.
    if (std::abs(norm - 1) > 1e-15) b.orientation[k] = {w / norm, x / norm, y / norm, z / norm};
  }
  b.mass = in.scalars("/bodies/mass", n);
  b.inertia = in.rows<Point3>("/bodies/inertia", n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto& [i1, i2, i3] = b.inertia[k];
    for (const double moment : {i1, i2, i3}) in.check_positive("/bodies/inertia", "row", k, moment);
  }
  if (in.file().has("/bodies/velocity")) b.velocity = in.rows<Point3>("/bodies/velocity", n);
  if (in.file().has("/bodies/angular_velocity"))
    b.angular_velocity = in.rows<Point3>("/bodies/angular_velocity", n);
  return b;
}

/// Ends at the centroids are no offsets: such beams are computed faster.
void read_offsets(const Reader& in, Beams& beams) {
  const auto rows = in.rows<std::array<double, 6>>("/beams/offsets", beams.bodies.size());
  const auto nothing = [](const std::array<double, 6>& row) {
    return std::all_of(row.begin(), row.end(), [](double x) { return x == 0; });
  };
  if (std::all_of(rows.begin(), rows.end(), nothing)) return;
  for (const auto& [ix, iy, iz, jx, jy, jz] : rows)
    beams.offsets.push_back({Point3{ix, iy, iz}, Point3{jx, jy, jz}});
}

void read_axes(const Reader& in, const Bodies& bodies, Beams& beams) {
  const std::size_t m = beams.bodies.size();
  beams.length = in.scalars("/beams/length", m);
  beams.axis_y = in.rows<Point3>("/beams/axis_y", m);
  for (std::size_t k = 0; k < m; ++k) {
    const Vec3<double> e = chord(bodies, beams, static_cast<std::int32_t>(k));
    const double distance = std::sqrt(dot(e, e));
    if (std::abs(distance - beams.length[k]) > 1e-9 * distance || distance == 0)
      in.refuse("/beams/length", "row " + std::to_string(k) + " is " + text_of(beams.length[k]) +
                                     ", but its " + (beams.offsets.empty() ? "bodies" : "ends") +
                                     " are " + text_of(distance) + " m apart");
    const Vec3<double>& y = beams.axis_y[k];
    const Vec3<double> normal = cross(e, y);
    if (std::abs(std::sqrt(dot(y, y)) - 1) > 1e-6 ||
        std::sqrt(dot(normal, normal)) < 1e-6 * distance)
      in.refuse("/beams/axis_y",
                "row " + std::to_string(k) + " must be a unit vector that is not along the beam");
  }
}

/// Refuses a second beam between the same bodies, which would double a stiffness by mistake.
void check_pairs(const Reader& in, const std::vector<std::array<std::int32_t, 2>>& pairs) {
  const bool sorted = std::adjacent_find(pairs.begin(), pairs.end(), std::greater_equal()) ==
                      pairs.end();  // as floe writes them
  if (sorted) return;
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return pairs[a] < pairs[b]; });
  for (std::size_t k = 1; k < order.size(); ++k) {
    const std::size_t a = order[k - 1], b = order[k];
    if (pairs[a] == pairs[b])
      in.refuse("/beams/bodies", "rows " + std::to_string(a) + " and " + std::to_string(b) +
                                     " both join bodies " + std::to_string(pairs[a][0]) + " and " +
                                     std::to_string(pairs[a][1]));
  }
}

Beams read_beams(const Reader& in, const Bodies& bodies) {
  Beams beams;
  const auto n = static_cast<std::size_t>(bodies.size());
  if (!in.file().has("/beams/bodies")) return beams;  // loose blocks
  const std::vector<std::int32_t> pairs = in.indices("/beams/bodies", n, 2);
  const std::size_t m = pairs.size() / 2;
  for (std::size_t k = 0; k < m; ++k) {
    if (pairs[2 * k] == pairs[2 * k + 1])
      in.refuse("/beams/bodies", "row " + std::to_string(k) + " joins body " +
                                     std::to_string(pairs[2 * k]) + " to itself");
    if (pairs[2 * k] > pairs[2 * k + 1])
      in.refuse("/beams/bodies", "row " + std::to_string(k) + " must have the smaller index first");
    beams.bodies.push_back({pairs[2 * k], pairs[2 * k + 1]});
  }
  check_pairs(in, beams.bodies);
  beams.area = in.scalars("/beams/area", m);
  beams.inertia_y = in.scalars("/beams/inertia_y", m);
  beams.inertia_z = in.scalars("/beams/inertia_z", m);
  beams.torsion = in.scalars("/beams/torsion", m);
  beams.young = in.scalars("/beams/young", m);
  beams.shear_modulus = in.scalars("/beams/shear_modulus", m);
  beams.shear_factor = in.scalars("/beams/shear_factor", m);
  if (in.file().has("/beams/shear_factor_y"))
    beams.shear_factor_y = in.scalars("/beams/shear_factor_y", m);
  if (in.file().has("/beams/width")) beams.width = in.scalars("/beams/width", m);
  if (in.file().has("/beams/height")) beams.height = in.scalars("/beams/height", m);
  if (in.file().has("/beams/offsets")) read_offsets(in, beams);
  if (in.file().has("/beams/image")) beams.image = in.rows<Point3>("/beams/image", m);
  if (in.file().has("/beams/strength")) beams.strength = in.scalars("/beams/strength", m);
  if (in.file().has("/beams/energy")) beams.energy = in.scalars("/beams/energy", m);
  read_axes(in, bodies, beams);
  return beams;
}

/// Checks that offsets start at 0, do not decrease, and end at `end`.
void check_offsets(const Reader& in, const std::string& name,
                   const std::vector<std::int32_t>& offsets, std::size_t groups, std::size_t end) {
  if (offsets.size() != groups + 1)
    in.refuse(name, "must have " + std::to_string(groups + 1) + " entries");
  if (offsets.front() != 0 || static_cast<std::size_t>(offsets.back()) != end ||
      !std::is_sorted(offsets.begin(), offsets.end()))
    in.refuse(name, "must grow from 0 to " + std::to_string(end));
}

/// Where the centroid of a body has to be in the frame of its vertices.
enum class Centroid { at_origin, anywhere };

/// Checks that the faces of each body close and are counter-clockwise seen from outside, and that
/// the centroid is where it has to be.
void check_solids(const Reader& in, const Shapes& s, Centroid centroid) {
  for (std::int32_t b = 0; b < s.bodies(); ++b) {
    const auto body = static_cast<std::size_t>(b);
    const std::string name = "body " + std::to_string(b);
    if (s.face_of[body + 1] - s.face_of[body] < 4)
      in.refuse("/shapes/face_of", name + " must have 4 faces or more");
    for (auto f = static_cast<std::size_t>(s.face_of[body]);
         f < static_cast<std::size_t>(s.face_of[body + 1]); ++f) {
      if (s.corner_of[f + 1] - s.corner_of[f] < 3)
        in.refuse("/shapes/corner_of", name + ": a face must have 3 corners or more");
    }
    if (const auto edge = open_edge(s, b))
      in.refuse("/shapes/corners", name + ": faces must close: the edge from vertex " +
                                       std::to_string((*edge)[0]) + " to " +
                                       std::to_string((*edge)[1]) +
                                       " must be in two faces, once in each direction");
    const VolumeProperties p = volume_properties(s, b);
    if (!(p.volume > 0))
      in.refuse("/shapes/corners",
                name + ": faces must be counter-clockwise seen from outside, around a volume > 0");
    if (centroid == Centroid::anywhere) continue;
    constexpr double centred = 1e-6;  // relative to the body's size
    if (std::hypot(p.centroid.x, p.centroid.y, p.centroid.z) > centred * std::cbrt(p.volume))
      in.refuse("/shapes/vertices", name + ": the centroid must be the origin");
  }
}

Shapes read_shapes(const Reader& in, std::size_t bodies, Centroid centroid) {
  Shapes s;
  if (!in.file().has("/shapes")) return s;
  s.vertices = in.rows<Point3>("/shapes/vertices",
                               static_cast<std::size_t>(in.file().shape("/shapes/vertices").first));
  s.corners = in.indices("/shapes/corners", s.vertices.size());
  s.corner_of = in.indices("/shapes/corner_of", s.corners.size() + 1);
  s.face_of = in.indices("/shapes/face_of", s.corner_of.size());
  s.vertex_of = in.indices("/shapes/vertex_of", s.vertices.size() + 1);
  if (s.corner_of.empty()) in.refuse("/shapes/corner_of", "must not be empty");
  check_offsets(in, "/shapes/corner_of", s.corner_of, s.corner_of.size() - 1, s.corners.size());
  check_offsets(in, "/shapes/face_of", s.face_of, bodies, s.corner_of.size() - 1);
  check_offsets(in, "/shapes/vertex_of", s.vertex_of, bodies, s.vertices.size());
  for (std::size_t b = 0; b < bodies; ++b) {
    for (std::int32_t c = item(s.corner_of, s.face_of[b]); c < item(s.corner_of, s.face_of[b + 1]);
         ++c) {
      const std::int32_t v = item(s.corners, c);
      if (v < s.vertex_of[b] || v >= s.vertex_of[b + 1])
        in.refuse("/shapes/corners",
                  "entry " + std::to_string(c) + " is not a vertex of body " + std::to_string(b));
    }
  }
  check_solids(in, s, centroid);
  return s;
}

std::string quoted(const std::string& name) {
  const std::string text = shown(name);
  return text.starts_with('\'') ? text : "'" + text + "'";
}

}  // namespace

const std::vector<std::int32_t>& Lattice::set(const std::string& name,
                                              const std::string& key) const {
  if (const auto found = sets.find(name); found != sets.end()) {
    if (found->second.empty())
      throw InputError(key + ": the set " + quoted(name) + " has no bodies");
    return found->second;
  }
  constexpr std::size_t most = 12;
  std::vector<std::string_view> names;
  std::string known;
  for (const auto& [other, bodies_of_set] : sets) {
    names.emplace_back(other);
    if (names.size() <= most) known += (known.empty() ? "" : ", ") + shown(other);
  }
  if (names.size() > most) known += " and " + std::to_string(names.size() - most) + " more";
  const std::string near = nearest_word(name, names);
  throw InputError(key + ": there is no set " + quoted(name) +
                   (near.empty() ? "" : " (is it " + quoted(near) + "?)") + "; the scene has " +
                   known);
}

Lattice read_lattice(const std::string& file) {
  const Reader in(file);
  Lattice lattice;
  lattice.bodies = read_bodies(in);
  const auto n = static_cast<std::size_t>(lattice.bodies.size());
  lattice.beams = read_beams(in, lattice.bodies);
  lattice.shapes = read_shapes(in, n, Centroid::at_origin);
  if (in.file().has("/sets")) {
    for (const std::string& name : in.file().members("/sets")) {
      auto& set = lattice.sets[name] = in.indices("/sets/" + name, n);
      std::sort(set.begin(), set.end());
      set.erase(std::unique(set.begin(), set.end()), set.end());
    }
  }
  auto& all = lattice.sets["all"];
  all.resize(n);
  for (std::size_t k = 0; k < n; ++k) all[k] = static_cast<std::int32_t>(k);
  return lattice;
}

namespace {

void check_convex(const Reader& in, const Shapes& shapes) {
  constexpr double rounding = 1e-6;
  for (std::int32_t b = 0; b < shapes.bodies(); ++b) {
    const double size = std::cbrt(volume_properties(shapes, b).volume);
    if (concavity(shapes, b) > rounding * size)
      in.refuse("/shapes", (shapes.bodies() > 1 ? "body " + std::to_string(b) : "the polyhedron") +
                               " is not convex, or a face of it is not plane");
  }
}

}  // namespace

Shapes read_polyhedra(const std::string& file, const std::string& key) {
  const Reader in(file, key);
  if (!in.file().has("/shapes")) in.refuse("/shapes", "is not there");
  const std::int64_t entries = in.file().shape("/shapes/face_of").first;
  if (entries < 2) in.refuse("/shapes/face_of", "must have 2 entries or more");
  Shapes shapes = read_shapes(in, static_cast<std::size_t>(entries - 1), Centroid::anywhere);
  check_convex(in, shapes);
  return shapes;
}

void write_shapes(Hdf5File& file, const Shapes& shapes) {
  file.write("/shapes/vertices", shapes.vertices);
  file.write("/shapes/corners", shapes.corners);
  file.write("/shapes/corner_of", shapes.corner_of);
  file.write("/shapes/face_of", shapes.face_of);
  file.write("/shapes/vertex_of", shapes.vertex_of);
}

void write_lattice(const Lattice& lattice, const std::string& path,
                   std::span<const NamedShape> obstacles) {
  Hdf5File file = Hdf5File::create(path);
  const Bodies& b = lattice.bodies;
  file.write("/bodies/position", b.position);
  file.write("/bodies/orientation",
             std::span<const double>(b.orientation[0].data(), 4 * b.orientation.size()), 4);
  file.write("/bodies/mass", b.mass);
  file.write("/bodies/inertia", b.inertia);
  if (!b.velocity.empty()) file.write("/bodies/velocity", b.velocity);
  if (!b.angular_velocity.empty()) file.write("/bodies/angular_velocity", b.angular_velocity);

  const Beams& m = lattice.beams;
  if (m.size() > 0) {
    file.write("/beams/bodies",
               std::span<const std::int32_t>(m.bodies[0].data(), 2 * m.bodies.size()), 2);
    file.write("/beams/area", m.area);
    file.write("/beams/inertia_y", m.inertia_y);
    file.write("/beams/inertia_z", m.inertia_z);
    file.write("/beams/torsion", m.torsion);
    file.write("/beams/length", m.length);
    file.write("/beams/young", m.young);
    file.write("/beams/shear_modulus", m.shear_modulus);
    file.write("/beams/shear_factor", m.shear_factor);
    if (!m.shear_factor_y.empty()) file.write("/beams/shear_factor_y", m.shear_factor_y);
    file.write("/beams/axis_y", m.axis_y);
    if (!m.width.empty()) file.write("/beams/width", m.width);
    if (!m.height.empty()) file.write("/beams/height", m.height);
    if (!m.offsets.empty()) {
      std::vector<double> rows;
      for (const auto& ends : m.offsets)
        for (const Point3& o : ends) rows.insert(rows.end(), {o[0], o[1], o[2]});
      file.write("/beams/offsets", std::span<const double>(rows), 6);
    }
    if (!m.image.empty()) file.write("/beams/image", m.image);
    if (!m.strength.empty()) file.write("/beams/strength", m.strength);
    if (!m.energy.empty()) file.write("/beams/energy", m.energy);
  }
  for (const auto& [name, set] : lattice.sets) {
    if (name != "all") file.write("/sets/" + name, set);
  }
  if (!lattice.shapes.empty()) write_shapes(file, lattice.shapes);
  for (const NamedShape& named : obstacles) {
    const std::string group = "/obstacles/" + named.name;
    file.write(group + "/vertices", named.shape.vertices);
    file.write(group + "/corners", named.shape.corners);
    file.write(group + "/corner_of", named.shape.corner_of);
    if (named.patch_areas.empty()) continue;
    file.write(group + "/patch_centre", named.patch_centres);
    file.write(group + "/patch_normal", named.patch_normals);
    file.write(group + "/patch_area", named.patch_areas);
    file.write(group + "/patch_size", std::span<const double>(named.patch_sizes), 2);
  }
  file.close();
}

}  // namespace floe
