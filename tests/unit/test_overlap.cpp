// The overlap of convex polyhedra against CGAL's intersection of half-spaces with exact numbers,
// and against closed forms.
#include <CGAL/Convex_hull_3/dual/halfspace_intersection_3.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polyhedron_3.h>
#include <gtest/gtest.h>

#include <cmath>
#include <list>
#include <numbers>

#include "geometry/separation.h"
#include "support/graph_overlap.h"
#include "support/polyhedra.h"
#include "support/record.h"

namespace floe {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Exact = Kernel::FT;

/// Facets of the exact intersection, and what is asked of it.
struct Reference {
  double volume = 0;
  Vec3<double> first{};   ///< int r dV
  Vec3<double> area{};    ///< of facets on B
  Vec3<double> moment{};  ///< int r x dA over them, about the origin
};

/// A lazy number's own to_double stops at five digits.
double rounded(const Exact& number) { return CGAL::to_double(CGAL::exact(number)); }

Kernel::Point_3 exact(const Vec3<double>& p) { return {p.x, p.y, p.z}; }

/// Planes through three corners of each face, from the coordinates as they are.
std::vector<Kernel::Plane_3> planes_of(const Shapes& s, std::int32_t body,
                                       const std::vector<Vec3<double>>& placed) {
  std::vector<Kernel::Plane_3> planes;
  const auto b = static_cast<std::size_t>(body);
  for (std::int32_t f = s.face_of[b]; f < s.face_of[b + 1]; ++f) {
    const std::int32_t c = s.corner_of[static_cast<std::size_t>(f)];
    const std::int32_t n = s.corner_of[static_cast<std::size_t>(f) + 1] - c;
    const auto at = [&](std::int32_t k) {
      return exact(placed[static_cast<std::size_t>(s.corners[static_cast<std::size_t>(c + k)] -
                                                   s.vertex_of[b])]);
    };
    planes.emplace_back(at(0), at(n / 3), at(2 * n / 3));
  }
  return planes;
}

Reference exact_overlap(const std::vector<Kernel::Plane_3>& a,
                        const std::vector<Kernel::Plane_3>& b, const Vec3<double>& guess) {
  std::list<Kernel::Plane_3> all(a.begin(), a.end());
  all.insert(all.end(), b.begin(), b.end());
  // CGAL's search for a point inside ends on the boundary at times; any point that is inside by
  // exact signs will do, and ours is tried first.
  const auto is_inside = [&](const Kernel::Point_3& point) {
    return std::all_of(all.begin(), all.end(),
                       [&](const auto& q) { return q.has_on_negative_side(point); });
  };
  // CGAL 6 has std::optional where 5 has boost's.
  decltype(CGAL::halfspace_intersection_interior_point_3(all.begin(), all.end())) inner =
      exact(guess);
  if (!is_inside(*inner)) {
    inner = CGAL::halfspace_intersection_interior_point_3(all.begin(), all.end());
    if (!inner || !is_inside(*inner)) return {};
  }
  CGAL::Polyhedron_3<Kernel> p;
  CGAL::halfspace_intersection_3(all.begin(), all.end(), p, inner);
  Exact volume6 = 0, x24 = 0, y24 = 0, z24 = 0;
  Reference r;
  for (auto f = p.facets_begin(); f != p.facets_end(); ++f) {
    auto h = f->facet_begin();
    const auto o = h->vertex()->point();
    Kernel::Plane_3 plane(o, h->next()->vertex()->point(), h->next()->next()->vertex()->point());
    const bool on_b = std::any_of(b.begin(), b.end(), [&](const auto& q) { return q == plane; });
    ++h;
    for (auto first = f->facet_begin(); h->next() != first; ++h) {
      const auto q = h->vertex()->point(), s = h->next()->vertex()->point();
      const Exact v =
          CGAL::determinant(o.x(), o.y(), o.z(), q.x(), q.y(), q.z(), s.x(), s.y(), s.z());
      volume6 += v;
      const auto x = o.x() + q.x() + s.x(), y = o.y() + q.y() + s.y(), z = o.z() + q.z() + s.z();
      x24 += v * x, y24 += v * y, z24 += v * z;
      if (!on_b) continue;
      const auto n = CGAL::cross_product(q - o, s - o);
      r.area = r.area + 0.5 * Vec3<double>{rounded(n.x()), rounded(n.y()), rounded(n.z())};
      const auto m = CGAL::cross_product(Kernel::Vector_3(x, y, z), n);
      r.moment =
          r.moment + (1.0 / 6) * Vec3<double>{rounded(m.x()), rounded(m.y()), rounded(m.z())};
    }
  }
  r.volume = rounded(volume6) / 6;
  r.first = (1.0 / 24) * Vec3<double>{rounded(x24), rounded(y24), rounded(z24)};
  return r;
}

/// One pair in B's frame: how A lies there.
struct Pair {
  Shapes shapes;  ///< A, then B
  Quat<double> q{1, 0, 0, 0};
  Vec3<double> x{};
  bool clear = true;  ///< no face of A lies in a face of B, both looking the same way
};

double scale_of(const Pair& pair) {
  return std::min(volume_properties(pair.shapes, 0).volume,
                  volume_properties(pair.shapes, 1).volume);
}

/// The largest differences from the exact numbers, each over its own scale.
struct Largest {
  double volume = 0, first = 0, area = 0, moment = 0;
};

constexpr double tolerance = 1e-10;

void expect_exact(const Pair& pair, const Overlap& o, const Reference& r, const std::string& what,
                  Largest& largest) {
  const double scale = scale_of(pair), l = std::cbrt(scale);
  for (const double number : {o.volume, o.centroid.x, o.centroid.y, o.centroid.z, o.area.x,
                              o.area.y, o.area.z, o.moment.x, o.moment.y, o.moment.z})
    ASSERT_TRUE(std::isfinite(number)) << what;
  ASSERT_GE(o.volume, 0) << what;
  const auto expect = [&](double error, double& of_all) {
    of_all = std::max(of_all, error);
    ASSERT_LE(error, tolerance) << what;
  };
  expect(std::abs(o.volume - r.volume) / scale, largest.volume);
  expect(length(o.volume * o.centroid - r.first) / (scale * l), largest.first);
  if (r.volume < 1e-9 * scale || !pair.clear) return;  // which facets are B's is rounding's choice
  expect(length(o.area - r.area) / (l * l), largest.area);
  expect(length(o.moment + cross(o.centroid, o.area) - r.moment) / scale, largest.moment);
}

/// Both clippers, and how often each way was gone.
struct Clippers {
  Clipper loops;
  GraphClipper graph;
  int pairs = 0, full = 0, replayed = 0;
  int other_bits = 0;  ///< of a replay than of a full pass
};

/// Compares the overlaps of all ways with the exact one: Clipper, the full pass of GraphClipper,
/// and its replay of cuts that were recorded at the same place and a little off it.
void expect_exact(const Pair& pair, Clippers& clippers, const Vec3<double>& off,
                  const std::string& what, Largest& largest) {
  const auto a = test::placed(pair.shapes, 0, pair.q, pair.x);
  const auto b = test::placed(pair.shapes, 1, {1, 0, 0, 0}, {0, 0, 0});
  std::vector<HalfSpace> planes;
  append_half_spaces(pair.shapes, 1, planes);
  const Overlap o = clippers.loops.overlap(pair.shapes, 0, a, planes);
  const Reference r =
      exact_overlap(planes_of(pair.shapes, 0, a), planes_of(pair.shapes, 1, b), o.centroid);
  expect_exact(pair, o, r, what, largest);
  ++clippers.pairs;
  const test::GraphBody body(pair.shapes, 0);
  CutRecord record;
  const auto full = body.overlap(clippers.graph, pair.q, pair.x, planes, record);
  if (!full) return;
  ++clippers.full;
  ASSERT_FALSE(clippers.graph.replayed());
  expect_exact(pair, *full, r, what + ", graph", largest);
  for (const Vec3<double>& away : {Vec3<double>{}, off}) {
    if (!body.overlap(clippers.graph, pair.q, pair.x + away, planes, record)) continue;
    const auto again = body.overlap(clippers.graph, pair.q, pair.x, planes, record);
    clippers.replayed += clippers.graph.replayed() ? 1 : 0;
    clippers.other_bits += test::same_bits(*again, *full) ? 0 : 1;
  }
}

void record_error(const std::string& pairs, const std::string& what, double error) {
  test::verify({.section = "Overlap of polyhedra against exact numbers",
                .quantity = pairs + ": largest error of the " + what,
                .value = error,
                .reference = 0.0,
                .tolerance = tolerance});
}

/// \param full      least part of the pairs for which GraphClipper has room
/// \param replayed  least part of its overlaps that are replays
void expect_replays(const Clippers& clippers, double full, double replayed) {
  EXPECT_EQ(clippers.other_bits, 0);
  EXPECT_GT(clippers.full, full * clippers.pairs);
  EXPECT_GT(clippers.replayed, replayed * 2 * clippers.full);
}

TEST(Overlap, RandomPolyhedraAgreeWithExactNumbers) {
  test::Random random(7);
  Clippers clippers;
  Largest largest;
  const int count = test::full_form() ? 90000 : 700;
  for (int k = 0; k < count; ++k) {
    Pair pair;
    for (int body = 0; body < 2; ++body)
      test::append_random(pair.shapes, random, static_cast<int>(random.uniform(0, 8)),
                          {random.uniform(0.1, 1), random.uniform(0.3, 2), random.uniform(0.3, 2)});
    pair.q = random.rotation(random.uniform(0, 3));
    pair.x = random.vector(1.2);
    const Vec3<double> off = random.vector(1e-3);
    expect_exact(pair, clippers, off, "pair " + std::to_string(k), largest);
    if (HasFatalFailure()) break;
  }
  expect_replays(clippers, 0.9, 0.7);
  const std::string pairs = test::text("%d random pairs", count);
  record_error(pairs, "volume over the smaller body's, V", largest.volume);
  record_error(pairs, "volume's first moment over V^(4/3)", largest.first);
  record_error(pairs, "area vector over V^(2/3)", largest.area);
  record_error(pairs, "area's moment over V", largest.moment);
}

/// Boxes of which faces, edges or vertices fall together, all but so, or that hold each other.
TEST(Overlap, DegeneratePositionsAgreeWithExactNumbers) {
  test::Random random(8);
  Clippers clippers;
  Largest largest;
  const int count = test::full_form() ? 10000 : 300;
  const std::array<double, 6> nearly{0, 1e-16, 1e-14, 1e-12, 1e-9, 1e-6};
  for (int k = 0; k < count; ++k) {
    Pair pair;
    const bool random_shape = k % 2 == 1;
    const auto pick = [&](std::initializer_list<double> of) {
      return *(of.begin() + static_cast<std::ptrdiff_t>(
                                random.uniform(0, static_cast<double>(of.size()) - 1e-9)));
    };
    if (random_shape) {
      test::append_random(pair.shapes, random, 4);
      Shapes copy = pair.shapes;
      std::vector<Point3> v = copy.vertices;
      std::vector<std::vector<std::int32_t>> faces;
      for (std::size_t f = 0; f + 1 < copy.corner_of.size(); ++f)
        faces.emplace_back(copy.corners.begin() + copy.corner_of[f],
                           copy.corners.begin() + copy.corner_of[f + 1]);
      test::append_body(pair.shapes, v, faces);
    } else {
      test::append_box(pair.shapes, pick({1, 0.5, 1e-3}), pick({1, 2}), pick({1, 0.5}));
      test::append_box(pair.shapes, 1, pick({1, 2}), pick({1, 1e-4}));
    }
    pair.clear = false;
    // Places at which faces, edges or corners of the boxes meet, and turns by quarters.
    pair.x = {pick({0, 0.25, 0.5, 0.75, 1}), pick({0, 0.5, 1, 1.5}), pick({0, 0.25, 0.5, 1})};
    const double quarter = 0.5 * 3.14159265358979323846;
    const double turns = std::floor(random.uniform(0, 4));
    pair.q = exp_rotation({0, 0, random_shape ? 0 : turns * quarter});
    // A little off.
    const auto little = [&] { return nearly[static_cast<std::size_t>(random.uniform(0, 5.999))]; };
    pair.x = pair.x + little() * random.direction();
    pair.q = product(random.rotation(little()), pair.q);
    const Vec3<double> off = little() * random.direction();
    expect_exact(pair, clippers, off, "pair " + std::to_string(k), largest);
    if (HasFatalFailure()) break;
  }
  expect_replays(clippers, 0.9, 0.2);
  const std::string pairs = test::text("%d pairs of which faces, edges or corners meet", count);
  record_error(pairs, "volume over the smaller body's, V", largest.volume);
  record_error(pairs, "volume's first moment over V^(4/3)", largest.first);
}

TEST(Overlap, OfBoxesIsABox) {
  Shapes s;
  test::append_box(s, 2, 2, 2);
  test::append_box(s, 4, 6, 8);
  std::vector<HalfSpace> planes;
  append_half_spaces(s, 1, planes);
  Clipper clipper;
  const auto a = test::placed(s, 0, {1, 0, 0, 0}, {2.5, 0.5, 1});  // 0.5 deep through x = 2
  const Overlap o = clipper.overlap(s, 0, a, planes);
  EXPECT_NEAR(o.volume, 0.5 * 2 * 2, 1e-15);
  EXPECT_NEAR(o.centroid.x, 1.75, 1e-15);
  EXPECT_NEAR(o.centroid.y, 0.5, 1e-15);
  EXPECT_NEAR(o.centroid.z, 1, 1e-15);
  EXPECT_NEAR(o.area.x, 4, 1e-15);
  EXPECT_NEAR(o.area.y, 0, 1e-15);
  EXPECT_NEAR(o.area.z, 0, 1e-15);
  EXPECT_NEAR(length(o.moment), 0, 1e-15);
  EXPECT_EQ(clipper.overlap(s, 0, test::placed(s, 0, {1, 0, 0, 0}, {4, 0, 0}), planes).volume, 0);
}

/// Closed forms of a rectangle of the sides a, b: J2 = diag(a^3 b, a b^3)/12; of a square the mean
/// distance from the centre is (sqrt(2) + asinh(1))/6 a = 0.3826 a. The rule of four points along
/// edges errs by 6e-5 of the reach of a square
/// and by 2.3e-4 of this one's.
TEST(Overlap, PatchOfAFaceHasItsMomentsAndReach) {
  Shapes s;
  test::append_box(s, 2, 3, 2);
  Clipper clipper;
  test::Random random(4);
  for (int k = 0; k < 20; ++k) {  // turned about the normal and away from the origin
    const double turn = 0.3 * k;
    const Quat<double> q = exp_rotation({0, 0, turn});
    const std::vector<HalfSpace> floor{{{0, 0, 1}, 0}};
    const Vec3<double> at{random.uniform(-9, 9), random.uniform(-9, 9), 0.8};  // 0.2 deep
    const Patch p = clipper.overlap(s, 0, test::placed(s, 0, q, at), floor, true).patch;
    EXPECT_NEAR(p.area, 6, 1e-13);
    EXPECT_NEAR(length(p.middle - Vec3<double>{at.x, at.y, 0}), 0, 1e-13);
    const Vec3<double> along{std::cos(turn), std::sin(turn), 0}, across{-along.y, along.x, 0};
    EXPECT_NEAR(length(p.rocking(along) - (2 * 27 / 12.0) * along), 0, 1e-12);
    EXPECT_NEAR(length(p.rocking(across) - (8 * 3 / 12.0) * across), 0, 1e-12);
    EXPECT_NEAR(p.uu + p.vv, (8 * 3 + 2 * 27) / 12.0, 1e-12);
    EXPECT_NEAR(p.largest(), 2 * 27 / 12.0, 1e-12);
    // Of a rectangle: d = hypot(a, b), (a b d/6 + a^3 asinh(b/a)/12 + b^3 asinh(a/b)/12) [m^3].
    const double reach =
        6 * std::hypot(2, 3) / 6 + 8 * std::asinh(1.5) / 12 + 27 * std::asinh(2 / 3.0) / 12;
    EXPECT_NEAR(p.reach, reach, 2.5e-4 * reach);
  }
  test::append_box(s, 1, 1, 1);
  const std::vector<HalfSpace> floor{{{0, 0, 1}, 0}};
  const Overlap square =
      clipper.overlap(s, 1, test::placed(s, 1, {1, 0, 0, 0}, {5, 0, 0.4}), floor, true);
  EXPECT_NEAR(square.patch.reach / square.patch.area, (std::sqrt(2) + std::asinh(1)) / 6, 2.5e-5);
  EXPECT_NEAR(square.patch.reach / square.patch.area, 0.3826, 5e-5);
  const Overlap plain = clipper.overlap(s, 1, test::placed(s, 1, {1, 0, 0, 0}, {5, 0, 0.4}), floor);
  EXPECT_EQ(plain.patch.area, 0);
  EXPECT_EQ(plain.volume, square.volume);
}

/// Of n triangles from the centre of a polygon in a circle: (2R/3) of the disc as n grows.
TEST(Overlap, PatchOfADiscReachesTwoThirdsOfItsRadius) {
  Clipper clipper;
  const std::vector<HalfSpace> floor{{{0, 0, 1}, 0}};
  double last = 1;
  for (const int n : {16, 32, 64}) {
    std::vector<Point2> polygon;
    for (int k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      polygon.push_back({1.5 * std::cos(angle), 1.5 * std::sin(angle)});
    }
    Shapes s;
    append_prism(s, polygon, -0.5, 0.5);
    const auto placed = test::placed(s, 0, {1, 0, 0, 0}, {2, 7, 0.4});
    const Patch p = clipper.overlap(s, 0, placed, floor, true).patch;
    const double error = std::abs(p.reach / p.area - 1.0);
    EXPECT_LT(error, 0.26 * last);  // of second order in 1/n
    last = error;
    const double inner = (1.5 * 1.5 / 4) * p.area;  // J2 of a disc: R^2/4 times its area
    EXPECT_NEAR(p.rocking({1, 0, 0}).x, inner, 15.0 / (n * n) * inner);
  }
  EXPECT_LT(last, 2e-3);
}

/// A corner cuts the floor's plane in a triangle; a floor's corner in a body has three facets,
/// whose centroid, moments and reach an independent sum over small pieces gives.
TEST(Overlap, PatchOfACornerIsThatOfItsPieces) {
  Shapes s;
  test::append_box(s, 2, 2, 2);
  Clipper clipper;
  // B's octant x, y, z < 0 with three faces reaches by c into a box: facets are squares of side c.
  const std::vector<HalfSpace> octant{{{1, 0, 0}, 0}, {{0, 1, 0}, 0}, {{0, 0, 1}, 0}};
  constexpr double c = 0.6;
  const Overlap o =
      clipper.overlap(s, 0, test::placed(s, 0, {1, 0, 0, 0}, {1 - c, 1 - c, 1 - c}), octant, true);
  ASSERT_NEAR(o.volume, c * c * c, 1e-14);
  const Vec3<double> n = (1 / length(o.area)) * o.area;
  Vec3<double> first{}, turning{};  // T w of a w across n
  const Vec3<double> w = cross(n, {0.3, -0.8, 0.1});
  double area = 0, reach = 0;
  const auto each = [&](auto&& take) {
    constexpr int m = 200;
    for (int side = 0; side < 3; ++side)
      for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j) {
          const double u = -c * (i + 0.5) / m, v = -c * (j + 0.5) / m;
          const Vec3<double> r = side == 0   ? Vec3<double>{0, u, v}
                                 : side == 1 ? Vec3<double>{u, 0, v}
                                             : Vec3<double>{u, v, 0};
          const Vec3<double> out{side == 0 ? 1.0 : 0, side == 1 ? 1.0 : 0, side == 2 ? 1.0 : 0};
          take(r, out, c * c / (m * m));
        }
  };
  each([&](const Vec3<double>& r, const Vec3<double>&, double a) {
    area += a;
    first = first + a * r;
  });
  const Vec3<double> middle = (1 / area) * first;
  each([&](const Vec3<double>& at, const Vec3<double>& out, double a) {
    const Vec3<double> r = at - middle;
    turning = turning + a * dot(cross(r, n), w) * cross(r, n);
    reach += a * dot(out, n) * length(r - dot(r, n) * n);
  });
  EXPECT_NEAR(o.patch.area, area, 1e-12);
  EXPECT_NEAR(length(o.patch.middle - middle), 0, 1e-12);
  EXPECT_NEAR(length(o.patch.rocking(w) - turning), 0, 1e-5);
  EXPECT_GT(length(turning), 0.01);
  EXPECT_NEAR(o.patch.reach, reach, 1e-3 * reach);
}

/// The change of volume with the place of A is -S, with its turning the moment of S: what makes a
/// potential of V exact.
TEST(Overlap, VolumeChangesByTheAreaVector) {
  test::Random random(9);
  Clipper clipper;
  Shapes s;
  for (int body = 0; body < 2; ++body) test::append_random(s, random, 6);
  std::vector<HalfSpace> planes;
  append_half_spaces(s, 1, planes);
  const Quat<double> q = random.rotation(0.7);
  const Vec3<double> x{0.9, 0.4, -0.3};
  const auto volume = [&](const Quat<double>& turn, const Vec3<double>& move) {
    return clipper.overlap(s, 0, test::placed(s, 0, product(turn, q), x + move), planes).volume;
  };
  const Overlap o = clipper.overlap(s, 0, test::placed(s, 0, q, x), planes);
  ASSERT_GT(o.volume, 0.01);
  const double step = 1e-5;
  const Vec3<double> turning = o.moment + cross(o.centroid - x, o.area);
  for (int k = 0; k < 3; ++k) {
    const Vec3<double> e{k == 0 ? step : 0, k == 1 ? step : 0, k == 2 ? step : 0};
    const double by_move = (volume({1, 0, 0, 0}, e) - volume({1, 0, 0, 0}, -1.0 * e)) / (2 * step);
    const double by_turn =
        (volume(exp_rotation(e), {}) - volume(exp_rotation(-1.0 * e), {})) / (2 * step);
    const double s_k = k == 0 ? o.area.x : k == 1 ? o.area.y : o.area.z;
    const double t_k = k == 0 ? turning.x : k == 1 ? turning.y : turning.z;
    EXPECT_NEAR(by_move, -s_k, 1e-8);
    EXPECT_NEAR(by_turn, -t_k, 1e-8);
  }
}

/// Axes that are found separate; where the polyhedra overlap none is found.
TEST(Separation, FindsAnAxisOnlyWhereThereIsOne) {
  test::Random random(10);
  Clipper clipper;
  int apart = 0, found = 0;
  for (int k = 0; k < 2000; ++k) {
    Shapes s;
    for (int body = 0; body < 2; ++body)
      test::append_random(s, random, static_cast<int>(random.uniform(0, 6)));
    const Quat<double> q = random.rotation(random.uniform(0, 3));
    const auto a = test::placed(s, 0, q, random.vector(2.2));
    const auto b = test::placed(s, 1, {1, 0, 0, 0}, {});
    std::vector<HalfSpace> planes;
    append_half_spaces(s, 1, planes);
    const bool overlap = clipper.overlap(s, 0, a, planes).volume > 0;
    Vec3<double> axis{0, 0, 1};
    const double gap = separate(a, b, axis, 20);
    if (gap > 0) {
      EXPECT_FALSE(overlap) << k;
      EXPECT_NEAR(length(axis), 1, 1e-12);
      EXPECT_NEAR(gap_along(a, b, axis), gap, 1e-15);
    }
    apart += overlap ? 0 : 1;
    found += gap > 0 ? 1 : 0;
  }
  EXPECT_GT(apart, 500);
  EXPECT_GT(found, 0.97 * apart);
}

}  // namespace
}  // namespace floe
