// The lattice: numbering, Hilbert curve, its file, free rigid motions and the pins that hold them.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <numeric>

#include "floe/base/petsc.h"
#include "forces/dead_load.h"
#include "forces/gravity.h"
#include "model/model.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/random.h"
#include "water/buoyancy.h"

namespace floe {
namespace {

using test::row;

// -- numbering
// --------------------------------------------------------------------------------------

std::int32_t bandwidth(const Lattice& lattice) {
  std::int32_t widest = 0;
  for (const auto& [i, j] : lattice.beams.bodies) widest = std::max(widest, j - i);
  return widest;
}

Vec3<double> axis_3(const Lattice& lattice, std::size_t m) {
  const auto [i, j] = lattice.beams.bodies[m];
  const Vec3<double> e = lattice.bodies.position[static_cast<std::size_t>(j)] -
                         lattice.bodies.position[static_cast<std::size_t>(i)];
  return (1 / lattice.beams.length[m]) * cross(e, lattice.beams.axis_y[m]);
}

TEST(Reorder, NarrowsTheBandAndSortsTheBeams) {
  Lattice s = test::sheet(24, 24, 1);
  const std::int32_t before = bandwidth(s);
  std::vector<std::int32_t> order = reorder(s);
  EXPECT_LT(bandwidth(s), before / 5);
  EXPECT_LT(bandwidth(s), 3 * 24);
  EXPECT_TRUE(std::is_sorted(s.beams.bodies.begin(), s.beams.bodies.end()));
  for (const auto& [i, j] : s.beams.bodies) EXPECT_LT(i, j);
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(order[k], static_cast<std::int32_t>(k));
}

TEST(Reorder, EverythingFollowsItsBody) {
  const Lattice before = test::sheet(9, 6, 1);
  Lattice after = before;
  after.bodies.velocity = after.bodies.position;
  const std::vector<std::int32_t> order = reorder(after);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto old = static_cast<std::size_t>(order[k]);
    EXPECT_EQ(after.bodies.position[k], before.bodies.position[old]);
    EXPECT_EQ(after.bodies.velocity[k], before.bodies.position[old]);
    EXPECT_EQ(after.bodies.orientation[k], before.bodies.orientation[old]);
    EXPECT_EQ(after.bodies.mass[k], before.bodies.mass[old]);
    EXPECT_EQ(after.bodies.inertia[k], before.bodies.inertia[old]);
    const VolumeProperties a = volume_properties(after.shapes, static_cast<std::int32_t>(k)),
                           b = volume_properties(before.shapes, order[k]);
    EXPECT_EQ(a.volume, b.volume);
    EXPECT_EQ(a.inertia, b.inertia);
  }
  for (const auto& [name, set] : after.sets) {
    std::vector<std::int32_t> old;
    for (const std::int32_t body : set) old.push_back(order[static_cast<std::size_t>(body)]);
    std::sort(old.begin(), old.end());
    EXPECT_EQ(old, before.sets.at(name)) << name;
    EXPECT_TRUE(std::is_sorted(set.begin(), set.end())) << name;
  }
  for (std::size_t m = 0; m < after.beams.bodies.size(); ++m)
    EXPECT_NEAR(axis_3(after, m).z, 1, 1e-12);
}

TEST(Reorder, KeepsTheForces) {
  Lattice before = test::sheet(9, 6, 1);
  before.beams.shear_factor_y = before.beams.length;
  for (std::int32_t m = 0; m < before.beams.size(); ++m) {
    const double up = 0.01 * m;
    before.beams.offsets.push_back({Point3{0, 0, up}, {0, 0, up}});
  }
  Lattice after = before;
  const std::vector<std::int32_t> order = reorder(after);
  const Part old_part = partition(before, PETSC_COMM_SELF),
             new_part = partition(after, PETSC_COMM_SELF);
  const State<Spatial> old_state = test::deformed(old_part, 0.1, 1);
  State<Spatial> new_state = old_state;
  for (std::size_t k = 0; k < order.size(); ++k)
    std::copy_n(old_state.record(static_cast<std::size_t>(order[k])), Spatial::record,
                new_state.record(k));
  const BeamOptions options{Shear::exact, Kinematics::corotational};
  const auto old_force = make_beam_force<Spatial>(old_part, options),
             new_force = make_beam_force<Spatial>(new_part, options);
  const std::vector<double> a = test::wrenches_of(*old_force, old_state),
                            b = test::wrenches_of(*new_force, new_state);
  const double scale = std::abs(*std::max_element(a.begin(), a.end()));
  for (std::size_t k = 0; k < b.size(); ++k)
    EXPECT_NEAR(b[k], a[static_cast<std::size_t>(order[k / 6]) * 6 + k % 6], 1e-12 * scale);
}

// -- Hilbert curve
// ----------------------------------------------------------------------------------

TEST(Hilbert, VisitsEveryPointAndStaysClose) {
  std::vector<Point3> points;
  for (int k = 0; k < 1024; ++k) points.push_back({1.0 * (k % 32), 1.0 * (k / 32), -7});
  const std::vector<std::int32_t> order = hilbert_order(points);
  std::vector<std::int32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 0; k < sorted.size(); ++k)
    ASSERT_EQ(sorted[k], static_cast<std::int32_t>(k));
  double way = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Point3 &a = points[static_cast<std::size_t>(order[k - 1])],
                 &b = points[static_cast<std::size_t>(order[k])];
    way += std::hypot(a[0] - b[0], a[1] - b[1]);
  }
  EXPECT_LT(way, 2 * 1024);
}

TEST(Hilbert, DegenerateExtents) {
  EXPECT_TRUE(hilbert_order({}).empty());
  EXPECT_EQ(hilbert_order({{1, 2, 3}}), std::vector<std::int32_t>{0});
  EXPECT_EQ(hilbert_order({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}), (std::vector<std::int32_t>{0, 1, 2}));
  const std::vector<std::int32_t> line =
      hilbert_order({{3, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(std::vector<std::int32_t>(line.begin(), line.end()),
            (std::vector<std::int32_t>{3, 1, 2, 0}));
}

// -- owners
// -----------------------------------------------------------------------------------------

/// Sum of the loads of each owner.
std::vector<double> sums(const std::vector<std::int32_t>& owner, const std::vector<double>& loads,
                         int ranks) {
  std::vector<double> all(static_cast<std::size_t>(ranks), 0.0);
  for (std::size_t b = 0; b < owner.size(); ++b)
    all.at(static_cast<std::size_t>(owner[b])) += loads[b];
  return all;
}

/// 40 x 20 places, in plan.
std::vector<Point3> grid() {
  std::vector<Point3> places;
  for (int k = 0; k < 800; ++k) places.push_back({1.0 * (k % 40), 1.0 * (k / 40), 0});
  return places;
}

TEST(OwnersByLoad, PartsHaveEqualLoads) {
  const std::vector<Point3> places = grid();
  std::vector<double> loads;  // a pile at the far end of one side
  for (const Point3& p : places) loads.push_back(p.x > 30 && p.y > 12 ? 20 : 1);
  const double mean = std::accumulate(loads.begin(), loads.end(), 0.0);
  for (const Vec3<double>& strips : {Vec3<double>{}, Vec3<double>{1, 0, 0}}) {
    for (const int ranks : {1, 2, 3, 5}) {
      const std::vector<std::int32_t> owner = owners_by_load(places, loads, ranks, strips);
      for (const double sum : sums(owner, loads, ranks))
        EXPECT_NEAR(sum, mean / ranks, 20) << ranks;  // the load of a body
    }
  }
  // Strips along x are cut at heights of y, where half of the load is below.
  const std::vector<std::int32_t> owner = owners_by_load(places, loads, 2, {1, 0, 0});
  for (std::size_t b = 0; b < owner.size(); ++b) {
    if (places[b].y < 14) {
      EXPECT_EQ(owner[b], 0);
    }
    if (places[b].y > 15) {
      EXPECT_EQ(owner[b], 1);
    }
  }
}

TEST(OwnersByLoad, EveryRankOwnsABody) {
  const std::vector<Point3> places{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  for (const std::vector<double>& loads :
       {std::vector<double>{1e9, 1, 1, 1, 1}, std::vector<double>{1, 1, 1, 1, 1e9}}) {
    for (const int ranks : {2, 3, 5}) {
      const std::vector<double> all = sums(owners_by_load(places, loads, ranks, {}), loads, ranks);
      EXPECT_GE(*std::min_element(all.begin(), all.end()), 1) << ranks;
    }
  }
  EXPECT_THROW((void)owners_by_load(places, {}, 6, {}), InputError);
}

TEST(OwnersByLoad, BodiesThatAreAlikeAreSharedByNumber) {
  const std::vector<Point3> places = grid();
  const std::vector<double> alike(places.size(), 3.0);
  for (const int ranks : {2, 5}) {
    EXPECT_EQ(owners_by_load(places, alike, ranks, {1, 0, 0}),
              owners_by_load(places, {}, ranks, {1, 0, 0}));
  }
}

// -- the file
// ---------------------------------------------------------------------------------------

/// A lattice file in a folder of its own, and ways to spoil it.
class LatticeFile {
 public:
  explicit LatticeFile(const Lattice& lattice) {
    folder_ = std::filesystem::temp_directory_path() / ("floe_lattice_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    write_lattice(lattice, path());
  }
  ~LatticeFile() { std::filesystem::remove_all(folder_); }
  LatticeFile(const LatticeFile&) = delete;
  LatticeFile& operator=(const LatticeFile&) = delete;

  std::string path() const { return (folder_ / "lattice.h5").string(); }

  void change(const std::string& name, int columns,
              const std::function<void(std::vector<double>&)>& edit) {
    std::vector<double> values = Hdf5File::open(path()).read(name, columns);
    edit(values);
    put(name, values, columns);
  }
  /// Integer datasets become integers of 64 bits, which floe must take too.
  void change_indices(const std::string& name, int columns,
                      const std::function<void(std::vector<long long>&)>& edit) {
    const std::vector<std::int32_t> old = Hdf5File::open(path()).read_indices(name, columns);
    std::vector<long long> values(old.begin(), old.end());
    edit(values);
    put(name, values, columns);
  }
  void remove(const std::string& name) {
    const hid_t file = H5Fopen(path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(file, name.c_str(), H5P_DEFAULT);
    H5Fclose(file);
  }
  template <class T>
  void put(const std::string& name, const std::vector<T>& values, int columns) {
    remove(name);
    const hsize_t extent[] = {values.size() / static_cast<hsize_t>(columns),
                              static_cast<hsize_t>(columns)};
    const hid_t space = H5Screate_simple(columns > 1 ? 2 : 1, extent, nullptr);
    put(name, std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_LLONG, space,
        values.data());
  }
  void put_text(const std::string& name) {
    remove(name);
    const hid_t type = H5Tcopy(H5T_C_S1);
    put(name, type, H5Screate(H5S_SCALAR), "a");
    H5Tclose(type);
  }
  void put_texts(const std::string& name, std::size_t count) {
    remove(name);
    const hid_t type = H5Tcopy(H5T_C_S1);
    const hsize_t extent = count;
    put(name, type, H5Screate_simple(1, &extent, nullptr), std::string(count, 'a').data());
    H5Tclose(type);
  }

 private:
  void put(const std::string& name, hid_t type, hid_t space, const void* values) {
    const hid_t file = H5Fopen(path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t data =
        H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Dclose(data);
    H5Sclose(space);
    H5Fclose(file);
  }
  std::filesystem::path folder_;
};

void expect_same(const Lattice& a, const Lattice& b) {
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_EQ(a.bodies.orientation, b.bodies.orientation);
  EXPECT_EQ(a.bodies.mass, b.bodies.mass);
  EXPECT_EQ(a.bodies.inertia, b.bodies.inertia);
  EXPECT_EQ(a.bodies.velocity, b.bodies.velocity);
  EXPECT_EQ(a.bodies.angular_velocity, b.bodies.angular_velocity);
  EXPECT_EQ(a.beams.bodies, b.beams.bodies);
  EXPECT_EQ(a.beams.area, b.beams.area);
  EXPECT_EQ(a.beams.inertia_y, b.beams.inertia_y);
  EXPECT_EQ(a.beams.inertia_z, b.beams.inertia_z);
  EXPECT_EQ(a.beams.torsion, b.beams.torsion);
  EXPECT_EQ(a.beams.length, b.beams.length);
  EXPECT_EQ(a.beams.young, b.beams.young);
  EXPECT_EQ(a.beams.shear_modulus, b.beams.shear_modulus);
  EXPECT_EQ(a.beams.shear_factor, b.beams.shear_factor);
  EXPECT_EQ(a.beams.shear_factor_y, b.beams.shear_factor_y);
  EXPECT_EQ(a.beams.axis_y, b.beams.axis_y);
  EXPECT_EQ(a.beams.width, b.beams.width);
  EXPECT_EQ(a.beams.height, b.beams.height);
  EXPECT_EQ(a.beams.offsets, b.beams.offsets);
  EXPECT_EQ(a.sets, b.sets);
  EXPECT_EQ(a.shapes.vertices, b.shapes.vertices);
  EXPECT_EQ(a.shapes.corners, b.shapes.corners);
  EXPECT_EQ(a.shapes.corner_of, b.shapes.corner_of);
  EXPECT_EQ(a.shapes.face_of, b.shapes.face_of);
  EXPECT_EQ(a.shapes.vertex_of, b.shapes.vertex_of);
}

TEST(LatticeFile, ComesBackBitForBit) {
  Lattice s = test::sheet(20, 20, 1, true);
  reorder(s);
  s.bodies.velocity = s.bodies.position;
  s.bodies.angular_velocity = s.bodies.inertia;
  expect_same(read_lattice(LatticeFile(s).path()), s);
  expect_same(read_lattice(LatticeFile(row(3)).path()), row(3));  // no shapes, no widths
  s.beams.shear_factor_y = s.beams.length;
  expect_same(read_lattice(LatticeFile(s).path()), s);
  // Ends that move along with each other keep the length.
  test::Random random(1);
  for (std::int32_t m = 0; m < s.beams.size(); ++m) {
    const Point3 off = random.vector(0.3);
    s.beams.offsets.push_back({off, off});
  }
  expect_same(read_lattice(LatticeFile(s).path()), s);
  const Lattice loose = row(1);  // no beams
  expect_same(read_lattice(LatticeFile(loose).path()), loose);
}

TEST(LatticeFile, IntegersOfAnyWidthAndUnsortedSetsAreTaken) {
  LatticeFile file(row(3));
  file.change_indices("/beams/bodies", 2, [](auto&) {});
  file.put("/sets/last", std::vector<long long>{2, 0, 2}, 1);
  const Lattice read = read_lattice(file.path());
  EXPECT_EQ(read.beams.bodies, row(3).beams.bodies);
  EXPECT_EQ(read.sets.at("last"), (std::vector<std::int32_t>{0, 2}));
}

/// Spoils a sheet's file; reading it must name the file, the dataset and what is wrong.
void expect_refused(const std::string& dataset, const std::string& why,
                    const std::function<void(LatticeFile&)>& spoil) {
  LatticeFile file(test::sheet(3, 3, 1));
  spoil(file);
  try {
    (void)read_lattice(file.path());
    ADD_FAILURE() << dataset << ": " << why << ": was read";
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find(file.path()), std::string::npos) << what;
    EXPECT_NE(what.find(dataset), std::string::npos) << what;
    EXPECT_NE(what.find(why), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

TEST(LatticeFile, WrongValuesAreRefused) {
  const auto first = [](double value) { return [value](std::vector<double>& v) { v[0] = value; }; };
  const auto spoil = [](const char* name, int columns, auto edit) {
    return [=](LatticeFile& file) { file.change(name, columns, edit); };
  };
  expect_refused("/bodies/mass", "> 0", spoil("/bodies/mass", 1, first(-1)));
  expect_refused("/bodies/mass", "finite", spoil("/bodies/mass", 1, first(std::nan(""))));
  expect_refused("/bodies/inertia", "> 0", spoil("/bodies/inertia", 3, first(0)));
  expect_refused("/bodies/position", "finite", spoil("/bodies/position", 3, first(INFINITY)));
  expect_refused("/bodies/orientation", "unit quaternion",
                 spoil("/bodies/orientation", 4, first(2)));
  expect_refused("/beams/length", "apart", spoil("/beams/length", 1, first(0.5)));
  expect_refused("/beams/axis_y", "unit vector", spoil("/beams/axis_y", 3, first(2)));
  for (const char* name : {"area", "inertia_y", "inertia_z", "torsion", "young", "shear_modulus",
                           "shear_factor", "width", "height"}) {
    const std::string dataset = "/beams/" + std::string(name);
    expect_refused(dataset, "> 0", [&](LatticeFile& f) { f.change(dataset, 1, first(-1)); });
  }
}

TEST(LatticeFile, WrongIndicesAreRefused) {
  const auto first = [](long long value) {
    return [value](std::vector<long long>& v) { v[0] = value; };
  };
  const auto spoil = [](const char* name, int columns, auto edit) {
    return [=](LatticeFile& file) { file.change_indices(name, columns, edit); };
  };
  for (const long long outside : {-1LL, 1000LL, 1LL << 40}) {
    expect_refused("/beams/bodies", "must be between", spoil("/beams/bodies", 2, first(outside)));
    expect_refused("/sets/left", "must be between", spoil("/sets/left", 1, first(outside)));
    expect_refused("/shapes/corners", "must be between",
                   spoil("/shapes/corners", 1, first(outside)));
    expect_refused("/shapes/face_of", "", spoil("/shapes/face_of", 1, first(outside)));
  }
  expect_refused("/beams/bodies", "itself",
                 spoil("/beams/bodies", 2, [](auto& v) { v[1] = v[0]; }));
  expect_refused("/beams/bodies", "smaller index first",
                 spoil("/beams/bodies", 2, [](auto& v) { std::swap(v[0], v[1]); }));
  expect_refused("/shapes/corners", "not a vertex of body",
                 spoil("/shapes/corners", 1, [](auto& v) { v[0] = v.back(); }));
  expect_refused("/shapes/vertex_of", "grow",
                 spoil("/shapes/vertex_of", 1, [](auto& v) { std::swap(v[1], v[2]); }));
}

TEST(LatticeFile, ShapesThatAreNoSolidsAreRefused) {
  expect_refused("/shapes/corners", "counter-clockwise", [](LatticeFile& f) {
    const Shapes old = read_lattice(f.path()).shapes;
    f.change_indices("/shapes/corners", 1, [&](auto& v) {
      for (std::size_t face = 0; face + 1 < old.corner_of.size(); ++face)
        std::reverse(v.begin() + old.corner_of[face], v.begin() + old.corner_of[face + 1]);
    });
  });
  expect_refused("/shapes/vertices", "centroid", [](LatticeFile& f) {
    f.change("/shapes/vertices", 3, [](auto& v) {
      for (double& x : v) x += 0.1;
    });
  });
  expect_refused("/shapes/corner_of", "3 corners", [](LatticeFile& f) {
    f.change_indices("/shapes/corner_of", 1, [](auto& v) { v[1] = 1; });
  });
}

TEST(LatticeFile, WrongShapesAndTypesAreRefused) {
  const auto shorter = [](std::vector<double>& v) { v.pop_back(); };
  for (const char* name : {"/bodies/mass", "/beams/area", "/beams/width", "/beams/length"})
    expect_refused(name, "rows", [&](LatticeFile& f) { f.change(name, 1, shorter); });
  for (const char* name : {"/bodies/position", "/bodies/inertia", "/beams/axis_y"})
    expect_refused(name, "must be n x 3",
                   [&](LatticeFile& f) { f.put(name, std::vector<double>(8, 1.0), 2); });
  expect_refused("/beams/bodies", "must be n x 2", [](LatticeFile& f) {
    f.put("/beams/bodies", std::vector<long long>{0, 1}, 1);
  });
  expect_refused("/beams/bodies", "integers", [](LatticeFile& f) {
    f.put("/beams/bodies", std::vector<double>{0, 1}, 2);
  });
  for (const char* name :
       {"/bodies/position", "/bodies/orientation", "/bodies/mass", "/bodies/inertia", "/beams/area",
        "/beams/axis_y", "/beams/torsion", "/shapes/vertices", "/shapes/face_of"})
    expect_refused(name, "missing", [&](LatticeFile& f) { f.remove(name); });
  expect_refused("/bodies/mass", "dimensions", [](LatticeFile& f) { f.put_text("/bodies/mass"); });
  expect_refused("/bodies/mass", "numbers",
                 [](LatticeFile& f) { f.put_texts("/bodies/mass", 11); });
  expect_refused("/sets/left", "integers", [](LatticeFile& f) { f.put_texts("/sets/left", 2); });
  expect_refused("/shapes/face_of", "entries",
                 [](LatticeFile& f) { f.put("/shapes/face_of", std::vector<long long>{0}, 1); });
}

// -- free rigid motions
// -----------------------------------------------------------------------------

using Held = std::vector<std::uint8_t>;

Boundary fix(const std::string& set, const std::string& components) {
  Boundary b;
  b.name = b.set = set;
  for (std::size_t k = 0; k < 6; ++k)
    b.fixed[k] = (" " + components + " ").find(" " + std::string(component_names[k]) + " ") !=
                 std::string::npos;
  return b;
}

/// Displacement or rotation (times the radius) of a body in a free motion.
double moved(const Lattice& lattice, const FreeMotion& m, std::int32_t body, int component) {
  const auto& c = m.coefficients;
  if (component >= 3) return c[static_cast<std::size_t>(component)];
  const Point3& x = lattice.bodies.position[static_cast<std::size_t>(body)];
  const Vec3<double> arm{(x[0] - m.centre[0]) / m.radius, (x[1] - m.centre[1]) / m.radius,
                         (x[2] - m.centre[2]) / m.radius};
  const Vec3<double> turn = cross(Vec3<double>{c[3], c[4], c[5]}, arm);
  return std::array{c[0] + turn.x, c[1] + turn.y,
                    c[2] + turn.z}[static_cast<std::size_t>(component)];
}

/// Smallest pivot of Gaussian elimination, rows exchanged: 0 if the square matrix is singular.
double smallest_pivot(std::vector<std::vector<double>> a) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < a.size(); ++c) {
    std::size_t best = c;
    for (std::size_t r = c + 1; r < a.size(); ++r) {
      if (std::abs(a[r][c]) > std::abs(a[best][c])) best = r;
    }
    std::swap(a[c], a[best]);
    smallest = std::min(smallest, std::abs(a[c][c]));
    if (smallest == 0) return 0;
    for (std::size_t r = c + 1; r < a.size(); ++r) {
      for (std::size_t k = a.size(); k-- > c;) a[r][k] -= a[r][c] / a[c][c] * a[c][k];
    }
  }
  return smallest;
}

/// Free motions of a lattice with some boundaries: as many as expected, none moves a held unknown,
/// and the pins, one per motion, hold them all: by rank, and by asking again.
FreeMotions expect_free(std::size_t count, const Lattice& lattice,
                        const std::vector<Boundary>& boundaries, const Held& floating = {}) {
  Held held = prescribed_components(lattice, boundaries);
  const FreeMotions free = free_motions(lattice, held, floating);
  EXPECT_EQ(free.motions.size(), count);
  EXPECT_EQ(free.pins.size(), count);
  for (const FreeMotion& m : free.motions) {
    for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) {
      for (int k = 0; k < 6; ++k) {
        if (free.piece[static_cast<std::size_t>(b)] == m.piece &&
            (held[static_cast<std::size_t>(b)] >> k & 1) != 0) {
          EXPECT_NEAR(moved(lattice, m, b, k), 0, 1e-6);
        }
      }
    }
  }
  if (count == 0) return free;
  std::vector<std::vector<double>> at_pins;
  for (const Pin& pin : free.pins) {
    EXPECT_EQ(held[static_cast<std::size_t>(pin.body)] >> pin.component & 1, 0);
    auto& row_of_pin = at_pins.emplace_back();
    for (const FreeMotion& m : free.motions) {
      const bool same_piece = free.piece[static_cast<std::size_t>(pin.body)] == m.piece;
      row_of_pin.push_back(same_piece ? moved(lattice, m, pin.body, pin.component) : 0.0);
    }
  }
  EXPECT_GT(smallest_pivot(std::move(at_pins)), 0.05);
  for (const Pin& pin : free.pins)
    held[static_cast<std::size_t>(pin.body)] |= static_cast<std::uint8_t>(1U << pin.component);
  EXPECT_TRUE(free_motions(lattice, held, floating).motions.empty());
  return free;
}

void expect_no_part_in(const FreeMotions& free, const std::vector<std::size_t>& components) {
  for (const FreeMotion& m : free.motions) {
    for (const std::size_t k : components) EXPECT_NEAR(m.coefficients[k], 0, 1e-12) << k;
  }
}

TEST(FreeMotions, TensionLeavesFour) {
  const Lattice s = test::sheet(8, 8, 1);
  expect_no_part_in(expect_free(4, s, {fix("left", "x"), fix("right", "x")}), {0, 5});
  expect_no_part_in(expect_free(3, s, {fix("left", "x"), fix("right", "x y")}), {0, 1, 5});
  expect_free(0, s, {fix("left", "x y z")});
  expect_free(0, s, {fix("left", "x y z rx ry rz")});
}

TEST(FreeMotions, EachPieceHasItsOwn) {
  const Lattice s = test::sheet(8, 8, 1);
  expect_free(6, s, {});
  Lattice halves = s;
  cut(halves, {0, -5}, {0, 5});
  const FreeMotions free = expect_free(12, halves, {});
  EXPECT_EQ(std::count(free.piece.begin(), free.piece.end(), 0) +
                std::count(free.piece.begin(), free.piece.end(), free.motions.back().piece),
            s.bodies.size());
  expect_free(6, halves, {fix("left", "x y z rx ry rz")});
}

TEST(FreeMotions, WaterHoldsThree) {
  const Lattice s = test::sheet(8, 8, 1, true);
  const Held floating(s.bodies.mass.size(), 1);
  expect_no_part_in(expect_free(3, s, {}, floating), {2, 3, 4});
  expect_free(1, s, {fix("left", "x")}, floating);  // several bodies held in x do not turn about z
}

TEST(FreeMotions, SingleBody) {
  const Lattice one = row(1);
  expect_free(6, one, {});
  expect_no_part_in(expect_free(3, one, {fix("all", "x y z")}), {0, 1, 2});
  expect_no_part_in(expect_free(3, one, {fix("all", "rx ry rz")}), {3, 4, 5});
  expect_free(0, one, {fix("all", "x y z rx ry rz")});
}

TEST(FreeMotions, RowOfBodiesTurnsAboutItsAxisUnlessOneBodyMayNot) {
  const Lattice along_x = row(9);
  expect_no_part_in(expect_free(1, along_x, {fix("first", "x y z"), fix("last", "x y z")}),
                    {0, 1, 2, 4, 5});
  expect_free(0, along_x, {fix("first", "x y z rx"), fix("last", "x y z")});
  expect_free(3, along_x, {fix("first", "x y z")});
  expect_free(0, along_x, {fix("first", "x y z rx ry rz")});
  const Lattice aslant = test::frame({{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}, {{0, 1}, {1, 2}});
  expect_free(1, aslant, {fix("first", "x y z"), fix("last", "x y z")});
  for (const char* one : {"rx", "ry", "rz"})
    expect_free(0, aslant, {fix("first", "x y z"), fix("last", std::string("x y z ") + one)});
}

TEST(FreeMotions, FarFromTheOriginAndVeryLong) {
  Lattice far = test::sheet(8, 8, 1);
  for (Point3& x : far.bodies.position) x = x + Point3{1e6, -2e6, 5e5};
  expect_free(6, far, {});
  expect_free(4, far, {fix("left", "x"), fix("right", "x")});
  const Lattice longest = row(3000);
  expect_free(1, longest, {fix("first", "x y z"), fix("last", "x y z")});
  expect_free(0, longest, {fix("all", "x y z"), fix("last", "rx")});
}

TEST(FreeMotions, AvoidedBodiesAreNotPinned) {
  const Lattice s = test::sheet(8, 8, 1);
  const FreeMotions usual = free_motions(s, Held(s.bodies.mass.size(), 0), {});
  Held avoid(s.bodies.mass.size(), 0);
  for (const Pin& pin : usual.pins) avoid[static_cast<std::size_t>(pin.body)] = 1;
  const FreeMotions other = free_motions(s, Held(s.bodies.mass.size(), 0), {}, avoid);
  EXPECT_EQ(other.pins.size(), 6U);
  for (const Pin& pin : other.pins) EXPECT_EQ(avoid[static_cast<std::size_t>(pin.body)], 0);
}

// -- loads on free motions
// --------------------------------------------------------------------------

Load push(const std::string& set, const Point3& force, const Point3& moment = {}) {
  Load load;
  load.name = "p", load.set = set, load.force = force, load.moment = moment;
  load.ramp.seconds = 1;
  return load;
}

/// What require_balance says of a lattice with boundaries and loads at time 1; empty if it is
/// content.
std::string imbalance(const Lattice& lattice, const std::vector<Boundary>& boundaries,
                      const std::vector<Load>& loads, bool floats = false) {
  Model<Spatial> model(lattice, PETSC_COMM_SELF, boundaries);
  model.set_beams(make_beam_force<Spatial>(model.part(), {}), Kinematics::corotational);
  for (const Load& load : loads)
    model.add_force(make_load<Spatial>(model.part(), place(load, lattice)));
  Held floating;
  if (floats) {
    model.add_force(make_gravity<Spatial>(model.part(), 9.81));
    model.add_force(make_buoyancy<Spatial>(model.part(), 1010 * 9.81));
    floating.assign(lattice.bodies.mass.size(), 1);
  }
  try {
    require_balance(model, lattice,
                    free_motions(lattice, prescribed_components(lattice, boundaries), floating), 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RequireBalance, RaisesOnLoadedFreeMotionsOnly) {
  const Lattice s = test::sheet(8, 8, 1);
  const std::vector<Boundary> tension{fix("left", "x"), fix("right", "x")};
  EXPECT_EQ(imbalance(s, tension, {}), "");
  EXPECT_EQ(imbalance(s, tension, {push("all", {5, 0, 0})}), "");
  EXPECT_EQ(imbalance(s, {}, {push("all", {5, 0, 0}), push("all", {-5, 0, 0})}), "");
  EXPECT_EQ(imbalance(s, {fix("left", "x y z")}, {push("top", {1, 2, 3}, {4, 5, 6})}), "");
  EXPECT_NE(imbalance(s, tension, {push("top", {0, 1, 0})}).find("translation along y"),
            std::string::npos);
  EXPECT_NE(imbalance(s, {}, {push("all", {0, 0, 1})}).find("translation along z"),
            std::string::npos);
  EXPECT_NE(imbalance(s, tension, {push("all", {}, {1, 0, 0})}).find("rotation about x"),
            std::string::npos);
  EXPECT_NE(imbalance(s, {}, {push("top", {5, 0, 0}), push("bottom", {-5, 0, 0})}), "");
  EXPECT_NE(
      imbalance(s, {},
                {push("all", {1e-3, 0, 0}), push("top", {1e3, 0, 0}), push("top", {-1e3, 0, 0})}),
      "");
}

TEST(RequireBalance, FloatingSheetCarriesVerticalLoadsOnly) {
  const Lattice s = test::sheet(8, 8, 1, true);
  EXPECT_EQ(imbalance(s, {}, {}, true), "");
  EXPECT_EQ(imbalance(s, {}, {push("left", {0, 0, -5})}, true), "");
  EXPECT_NE(imbalance(s, {}, {push("left", {5, 0, 0})}, true), "");
}

}  // namespace
}  // namespace floe
