#include "geometry/facet_integrals.h"

#include <cmath>
#include <tuple>

#include "base/simd.h"
#include "geometry/across.h"

namespace floe {
namespace {

constexpr std::size_t padded(std::size_t n) { return (n + lanes - 1) / lanes * lanes; }

/// Returns x at one corner of each of `lanes` entries.
template <class Entry>
Lanes gather(const double* x, const Entry* entries, std::uint8_t Entry::*corner) {
  return Lanes([&](auto k) { return x[entries[k].*corner]; });
}

/// Returns one corner of each of `lanes` triangles, from the apex.
Vec3<Lanes> corners(const Points& points, const Facets::Triangle* triangles,
                    std::uint8_t Facets::Triangle::*corner, const Vec3<double>& apex) {
  return {gather(points.x.data(), triangles, corner) - apex.x,
          gather(points.y.data(), triangles, corner) - apex.y,
          gather(points.z.data(), triangles, corner) - apex.z};
}

double sum_of(const Lanes& x) { return std::experimental::reduce(x); }
Vec3<double> sum_of(const Vec3<Lanes>& r) { return {sum_of(r.x), sum_of(r.y), sum_of(r.z)}; }

Vec3<double> point(const Points& points, std::size_t slot) {
  return {points.x[slot], points.y[slot], points.z[slot]};
}

constexpr Lanes::value_type zero = 0;
Vec3<Lanes> zeros() { return {zero, zero, zero}; }

/// Sums over triangles. All r are from the apex.
struct Sums {
  Lanes volume6 = zero;
  Vec3<Lanes> moment24 = zeros();
  Vec3<Lanes> area2 = zeros(), moment6 = zeros();  ///< of the facets on B
  Lanes area = zero;                               ///< of the facets on B
  Vec3<Lanes> first3 = zeros();                    ///< 3 int r |dA| over the facets on B
};

/// The triangles of the facets on B with their areas, and all vertices across S.
struct PatchWork {
  alignas(64) std::array<double, Facets::most_triangles> area;
  alignas(64) std::array<double, Points::low> u, v;
};

/// Sums cones over the triangles, with a vertex of the overlap as apex, so that all numbers are as
/// small as the overlap.
Sums sum_triangles(const Points& points, const Facets& facets, PatchWork* patch) {
  const Vec3<double> apex = point(points, facets.apex);
  Sums sums;
  for (std::size_t k = 0; k < facets.triangles; k += lanes) {
    const Facets::Triangle* triangles = facets.triangle.data() + k;
    const Vec3<Lanes> p = corners(points, triangles, &Facets::Triangle::p, apex);
    const Vec3<Lanes> q = corners(points, triangles, &Facets::Triangle::q, apex);
    const Vec3<Lanes> r = corners(points, triangles, &Facets::Triangle::r, apex);
    const Vec3<Lanes> twice = cross(q - p, r - p);
    const Vec3<Lanes> sum = p + q + r;
    const Lanes v = dot(p, twice);
    sums.volume6 += v;
    sums.moment24 = sums.moment24 + v * sum;
    if (k >= facets.on_b) continue;
    sums.area2 = sums.area2 + twice;
    sums.moment6 = sums.moment6 + cross(sum, twice);
    if (patch == nullptr) continue;
    const Lanes area = 0.5 * length(twice);
    area.copy_to(patch->area.data() + k, std::experimental::vector_aligned);
    sums.area += area;
    sums.first3 = sums.first3 + area * sum;
  }
  return sums;
}

/// Second moments about the apex: 12 times the integrals over the facets on B. A triangle with
/// corners p_k, s their sum, has int r r^T dA = (A/12) (sum p_k p_k^T + s s^T).
struct SecondMoments {
  double uu, vv, uv;
};
SecondMoments sum_second_moments(const Facets& facets, const PatchWork& work) {
  Lanes uu = zero, vv = zero, uv = zero;
  for (std::size_t k = 0; k < facets.on_b; k += lanes) {
    const Facets::Triangle* triangles = facets.triangle.data() + k;
    const auto across = [&](std::uint8_t Facets::Triangle::*corner) {
      return Across<Lanes>{gather(work.u.data(), triangles, corner),
                           gather(work.v.data(), triangles, corner)};
    };
    const Across<Lanes> a = across(&Facets::Triangle::p), b = across(&Facets::Triangle::q),
                        c = across(&Facets::Triangle::r);
    const Across<Lanes> s{a.u + b.u + c.u, a.v + b.v + c.v};
    const Lanes area = load(work.area.data() + k);
    uu += area * ((a.u * a.u + b.u * b.u) + (c.u * c.u + s.u * s.u));
    vv += area * ((a.v * a.v + b.v * b.v) + (c.v * c.v + s.v * s.v));
    uv += area * ((a.u * a.v + b.u * b.v) + (c.u * c.v + s.u * s.v));
  }
  return {sum_of(uu), sum_of(vv), sum_of(uv)};
}

/// Sums along the rim of the facets on B. An edge between two of these facets is in both, once in
/// each direction, and so adds nothing.
double sum_reach(const Facets& facets, const PatchWork& work, const Across<double>& middle) {
  Lanes reach = zero;
  for (std::size_t k = 0; k < facets.rim; k += lanes) {
    const Facets::Edge* edges = facets.edge.data() + k;
    const auto across = [&](std::uint8_t Facets::Edge::*end) {
      return Across<Lanes>{gather(work.u.data(), edges, end) - middle.u,
                           gather(work.v.data(), edges, end) - middle.v};
    };
    reach += reach_of_edge(across(&Facets::Edge::a), across(&Facets::Edge::b));
  }
  return sum_of(reach);
}

/// \param n  unit vector along S
Patch patch_of(const Points& points, const Facets& facets, const Vec3<double>& n, const Sums& sums,
               PatchWork& work) {
  Patch patch;
  patch.area = sum_of(sums.area);
  if (!(patch.area > 0)) return {};
  std::tie(patch.u, patch.v) = basis_across(n);
  const Vec3<double> apex = point(points, facets.apex);
  for (std::size_t k = 0; k < facets.slots; k += lanes) {
    const Vec3<Lanes> r{load(points.x.data() + k) - apex.x, load(points.y.data() + k) - apex.y,
                        load(points.z.data() + k) - apex.z};
    dot(patch.u, r).copy_to(work.u.data() + k, std::experimental::vector_aligned);
    dot(patch.v, r).copy_to(work.v.data() + k, std::experimental::vector_aligned);
  }
  const Vec3<double> middle = (1 / (3 * patch.area)) * sum_of(sums.first3);
  const Across<double> m{dot(patch.u, middle), dot(patch.v, middle)};
  const SecondMoments about_apex = sum_second_moments(facets, work);
  patch.middle = apex + middle;
  patch.uu = about_apex.uu / 12 - patch.area * m.u * m.u;
  patch.vv = about_apex.vv / 12 - patch.area * m.v * m.v;
  patch.uv = about_apex.uv / 12 - patch.area * m.u * m.v;
  patch.reach = sum_reach(facets, work, m);
  return patch;
}

}  // namespace

Overlap facet_integrals(const Points& points, const Facets& facets, bool with_patch) {
  PatchWork work;
  const Sums sums = sum_triangles(points, facets, with_patch ? &work : nullptr);
  const double volume6 = sum_of(sums.volume6);
  Overlap o;
  if (!(volume6 > 0)) return o;
  o.volume = volume6 / 6;
  const Vec3<double> c = (0.25 / volume6) * sum_of(sums.moment24);
  o.centroid = point(points, facets.apex) + c;
  o.area = 0.5 * sum_of(sums.area2);
  o.moment = (1.0 / 6) * sum_of(sums.moment6) - cross(c, o.area);
  const double area = length(o.area);
  if (with_patch && area > 0) o.patch = patch_of(points, facets, (1 / area) * o.area, sums, work);
  return o;
}

}  // namespace floe
