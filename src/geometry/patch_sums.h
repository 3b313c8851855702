/// \file
/// The sums of Overlap::patch over triangles of the facets on B.
#pragma once

#include <tuple>

#include "geometry/across.h"
#include "geometry/overlap.h"

namespace floe {

/// Adds triangles, then gives the patch without its reach. A triangle with corners p_k, s their
/// sum, has int r r^T dA = (A/12) (sum p_k p_k^T + s s^T).
class PatchSums {
 public:
  /// \param n     unit vector along S
  /// \param apex  a point near the facets, so that numbers are small
  PatchSums(const Vec3<double>& n, const Vec3<double>& apex) : apex_(apex) {
    std::tie(sum_.u, sum_.v) = basis_across(n);
  }

  /// Returns the components of a vector across S.
  Across<double> across(const Vec3<double>& r) const { return {dot(sum_.u, r), dot(sum_.v, r)}; }

  /// Adds a triangle. \param p, q, r  corners, from the apex [m] \param weight  of its area
  void add(const Vec3<double>& p, const Vec3<double>& q, const Vec3<double>& r, double weight = 1) {
    const Across<double> a = across(p), b = across(q), c = across(r);
    const Across<double> s{a.u + b.u + c.u, a.v + b.v + c.v};
    const double area = 0.5 * weight * length(cross(q - p, r - p));
    sum_.area += area;
    first_ = first_ + area * (p + q + r);
    uu_ += area * ((a.u * a.u + b.u * b.u) + (c.u * c.u + s.u * s.u));
    vv_ += area * ((a.v * a.v + b.v * b.v) + (c.v * c.v + s.v * s.v));
    uv_ += area * ((a.u * a.v + b.u * b.v) + (c.u * c.v + s.u * s.v));
  }

  /// Returns the patch of all triangles but for its reach; zeros without area.
  Patch patch() const {
    if (!(sum_.area > 0)) return {};
    const Vec3<double> middle = (1 / (3 * sum_.area)) * first_;
    const Across<double> m = across(middle);
    Patch sum = sum_;
    sum.middle = apex_ + middle;
    sum.uu = uu_ / 12 - sum.area * m.u * m.u;
    sum.vv = vv_ / 12 - sum.area * m.v * m.v;
    sum.uv = uv_ / 12 - sum.area * m.u * m.v;
    return sum;
  }

 private:
  Patch sum_;
  Vec3<double> apex_, first_{};      ///< int r dA, from the apex
  double uu_ = 0, vv_ = 0, uv_ = 0;  ///< 12 times those about the apex
};

}  // namespace floe
