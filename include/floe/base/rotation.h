/// \file
/// Vectors and unit quaternions on any scalar: double, a vector of lanes, or a scalar that carries
/// derivatives.
///
/// Notation: quaternions are (w, x, y, z); q rotates body to world, v_world = q v_body q*; products
/// compose right to left; exp_rotation(t) is the rotation by |t| about t. Spins are spatial: q(t) =
/// exp(t) q.
///
/// Functions that steps use are constexpr templates, which a compiler for devices can take too.
#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace floe {

/// A vector by its three components, in storage too: no more than x, y and z, in this order.
template <class T>
struct Vec3 {
  T x, y, z;

  /// Returns component `index`: 0 is x, 1 is y, 2 is z. Builds with assertions check the index.
  constexpr T& operator[](std::size_t index) {
    assert(index < 3);
    return index == 0 ? x : index == 1 ? y : z;
  }
  constexpr const T& operator[](std::size_t index) const {
    assert(index < 3);
    return index == 0 ? x : index == 1 ? y : z;
  }
};
static_assert(sizeof(Vec3<double>) == 3 * sizeof(double));
static_assert(std::is_aggregate_v<Vec3<double>> && std::is_trivially_copyable_v<Vec3<double>>);

template <class T>
constexpr bool operator==(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

template <class T>
constexpr Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {T(a.x + b.x), T(a.y + b.y), T(a.z + b.z)};
}
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {T(a.x - b.x), T(a.y - b.y), T(a.z - b.z)};
}
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a) {
  return {T(-a.x), T(-a.y), T(-a.z)};
}
template <class S, class T>
constexpr Vec3<T> operator*(const S& s, const Vec3<T>& a) {
  return {T(s * a.x), T(s * a.y), T(s * a.z)};
}
template <class S, class T>
constexpr T dot(const Vec3<S>& a, const Vec3<T>& b) {
  return T(a.x * b.x) + T(a.y * b.y) + T(a.z * b.z);
}
template <class T>
constexpr T length(const Vec3<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {T(a.y * b.z) - T(a.z * b.y), T(a.z * b.x) - T(a.x * b.z), T(a.x * b.y) - T(a.y * b.x)};
}

template <class T>
struct Quat {
  T w, x, y, z;
};

/// Returns the quaternion product a b: first the rotation b, then a. The scalars may differ (a
/// derivative type times constants).
template <class S, class T>
constexpr auto product(const Quat<S>& a, const Quat<T>& b) {
  using P = std::conditional_t<std::is_arithmetic_v<S>, T, S>;
  return Quat<P>{P(P(a.w * b.w) - P(a.x * b.x)) - P(P(a.y * b.y) + P(a.z * b.z)),
                 P(P(a.w * b.x) + P(a.x * b.w)) + P(P(a.y * b.z) - P(a.z * b.y)),
                 P(P(a.w * b.y) + P(a.y * b.w)) + P(P(a.z * b.x) - P(a.x * b.z)),
                 P(P(a.w * b.z) + P(a.z * b.w)) + P(P(a.x * b.y) - P(a.y * b.x))};
}
template <class T>
constexpr Quat<T> conjugate(const Quat<T>& q) {
  return {q.w, T(-q.x), T(-q.y), T(-q.z)};
}

/// The columns of the rotation matrix of a unit quaternion: the images of the three axes.
template <class T>
struct Triad {
  Vec3<T> e1, e2, e3;
  /// Returns the components in the triad of a world vector.
  constexpr Vec3<T> to_local(const Vec3<T>& v) const {
    return {dot(e1, v), dot(e2, v), dot(e3, v)};
  }
  /// Returns the world vector with the given components in the triad.
  constexpr Vec3<T> to_world(const Vec3<T>& v) const {
    return T(v.x) * e1 + T(v.y) * e2 + T(v.z) * e3;
  }
};
template <class T>
constexpr Triad<T> triad(const Quat<T>& q) {
  const T xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z,
          yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{T(1.0 - 2.0 * T(yy + zz)), T(2.0 * T(xy + wz)), T(2.0 * T(xz - wy))},
          {T(2.0 * T(xy - wz)), T(1.0 - 2.0 * T(xx + zz)), T(2.0 * T(yz + wx))},
          {T(2.0 * T(xz + wy)), T(2.0 * T(yz - wx)), T(1.0 - 2.0 * T(xx + yy))}};
}

template <class T = double>
constexpr Vec3<T> rotate(const Quat<T>& q, const Vec3<T>& v) {
  return triad(q).to_world(v);
}

/// Returns the unit quaternion of the rotation by |t| about t, to rounding for any t.
template <class T = double>
constexpr Quat<T> exp_rotation(const Vec3<T>& t) {
  const T angle2 = dot(t, t);
  const T angle = std::sqrt(angle2);
  // sin(a/2)/a as a series: the next term is a^4/3840, below rounding for a < 1e-3.
  const T s = angle < 1e-3 ? 0.5 - angle2 / 48.0 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * t.x, s * t.y, s * t.z};
}

/// Returns the rotation vector t of a unit quaternion, |t| <= pi.
template <class T = double>
constexpr Vec3<T> log_rotation(const Quat<T>& q) {
  const T sign = q.w < 0 ? -1.0 : 1.0;
  const T s = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
  const T factor = s < 1e-8 ? 2.0 : 2.0 * std::atan2(s, sign * q.w) / s;
  return {sign * factor * q.x, sign * factor * q.y, sign * factor * q.z};
}

template <class T = double>
constexpr Quat<T> normalised(const Quat<T>& q) {
  const T n = 1.0 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {n * q.w, n * q.x, n * q.y, n * q.z};
}

/// Returns the unit quaternion of a right-handed orthonormal triad (Shepperd's choice of the
/// largest component).
inline Quat<double> quaternion(const Triad<double>& r) {
  const double xx = r.e1.x, yy = r.e2.y, zz = r.e3.z, trace = xx + yy + zz;
  if (trace >= xx && trace >= yy && trace >= zz) {
    return normalised({1.0 + trace, r.e2.z - r.e3.y, r.e3.x - r.e1.z, r.e1.y - r.e2.x});
  }
  if (xx >= yy && xx >= zz) {
    return normalised({r.e2.z - r.e3.y, 1.0 + 2.0 * xx - trace, r.e1.y + r.e2.x, r.e3.x + r.e1.z});
  }
  if (yy >= zz) {
    return normalised({r.e3.x - r.e1.z, r.e1.y + r.e2.x, 1.0 + 2.0 * yy - trace, r.e2.z + r.e3.y});
  }
  return normalised({r.e1.y - r.e2.x, r.e3.x + r.e1.z, r.e2.z + r.e3.y, 1.0 + 2.0 * zz - trace});
}

}  // namespace floe
