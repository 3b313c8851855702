/// \file
/// One beam: strain energy and its exact gradient, on any scalar (physics.md section 2).
///
/// Two rigid bodies i and j, displaced by u_i, u_j and rotated by q_i, q_j from the state at rest, are joined by a
/// shear-flexible beam from centroid to centroid.
///   e0 = X_j - X_i, d = u_j - u_i, e = e0 + d, l = |e|, l0 = |e0|;  t0 the beam's triad at rest
///   a = q_i t0, b = q_j t0   the triads that the two bodies carry
///   r = a* b = (w, v)        with the sign that makes w >= 0
///   psi = 2 atan2(|v|, w) v/|v|                       relative rotation [rad]
///   m = (a + b)/|a + b|, E = R_m^T e                  the chord in the mean triad
///   Delta = d.(2 e0 + d)/(l + l0)                     elongation [m], exact at any rotation and strain
///   gamma_y = l0 E_2/l, gamma_z = l0 E_3/l            shear of the chord against the mean triad, as a length [m]
///   U = 1/2 (kn Delta^2 + ksz gamma_y^2 + ksy gamma_z^2 + kt psi_1^2 + kby psi_2^2 + kbz psi_3^2)
/// With g = asin|v|/|v| = (phi/2)/sin(phi/2), phi = |psi|:  psi = 2 g v.
#pragma once

#include <cmath>

#include "floe/base/rotation.h"
#include "floe/forces/beam.h"

namespace floe {

/// What a beam is at rest: chord e0 [m], its length, triad t0, stiffnesses [N/m, N m].
template <class C>
struct BeamConstants {
  Vec3<C> e0;
  C l0;
  Quat<C> t0;
  C kn, ksy, ksz, kt, kby, kbz;
};

/// The six strains, and what the gradient needs with them.
template <class T>
struct BeamStrains {
  T delta, gamma_y, gamma_z;  ///< [m]
  Vec3<T> psi;                ///< [rad]
  T l;                        ///< present length of the chord [m]
  Vec3<T> chord;              ///< E, components of the chord in the mean triad [m]
  Triad<T> mean;              ///< R_m
  Vec3<T> v;                  ///< vector part of the relative rotation
  T w, g, h;                  ///< its scalar part; g; h = (1 - g)/|v|^2
};

/// Derivative of U with respect to u_j (= minus that to u_i) [N] and to the spins of i and j [N m].
template <class T>
struct BeamGradient {
  Vec3<T> force, moment_i, moment_j;
};

/// h(s2) = (1 - asin(s)/s)/s2 with s2 = s^2 = |v|^2 and w = sqrt(1 - s2). Below |v| = 0.1 (a relative rotation of
/// 11 degrees) the series, whose first term left out is 1e-17; above it the closed form.
template <class T>
T asin_remainder(const T& s2, const T& w) {
  using std::atan2;
  using std::sqrt;
  if (s2 < 0.01) {
    // asin(s)/s = sum c_k s^2k, c_k = (2k)!/(4^k k!^2 (2k+1)) (Abramowitz & Stegun 4.4.40)
    T sum = T(6435.0 / 557056.0) * s2 + T(143.0 / 10240.0);
    sum = T(sum * s2) + 231.0 / 13312.0;
    sum = T(sum * s2) + 63.0 / 2816.0;
    sum = T(sum * s2) + 35.0 / 1152.0;
    sum = T(sum * s2) + 5.0 / 112.0;
    sum = T(sum * s2) + 3.0 / 40.0;
    sum = T(sum * s2) + 1.0 / 6.0;
    return T(-sum);
  }
  const T s = sqrt(s2);
  return T(T(1.0 - T(atan2(s, w) / s)) / s2);
}

/// Co-rotational strains (Crisfield 1990, 1997: strains against a triad that goes with the beam).
/// \param d  u_j - u_i [m]   \param qi, qj  rotations of the bodies from rest
template <class T, class C>
BeamStrains<T> corotational_strains(const BeamConstants<C>& beam, const Vec3<T>& d, const Quat<T>& qi,
                                    const Quat<T>& qj) {
  using std::sqrt;
  BeamStrains<T> s;
  const Quat<T> a = product(qi, beam.t0);
  Quat<T> b = product(qj, beam.t0);
  const Quat<T> r = product(conjugate(a), b);
  const double sign = r.w < 0.0 ? -1.0 : 1.0;  // q and -q are the same rotation
  b = {T(sign * b.w), T(sign * b.x), T(sign * b.y), T(sign * b.z)};
  s.w = sign * r.w;
  s.v = {T(sign * r.x), T(sign * r.y), T(sign * r.z)};
  Quat<T> m{T(a.w + b.w), T(a.x + b.x), T(a.y + b.y), T(a.z + b.z)};
  const T inverse = T(1.0 / sqrt(T(T(m.w * m.w) + T(m.x * m.x)) + T(T(m.y * m.y) + T(m.z * m.z))));
  s.mean = triad(Quat<T>{T(inverse * m.w), T(inverse * m.x), T(inverse * m.y), T(inverse * m.z)});

  const Vec3<T> e{T(beam.e0.x + d.x), T(beam.e0.y + d.y), T(beam.e0.z + d.z)};
  s.l = sqrt(dot(e, e));
  s.chord = s.mean.to_local(e);
  const Vec3<T> twice{T(beam.e0.x + e.x), T(beam.e0.y + e.y), T(beam.e0.z + e.z)};
  s.delta = dot(d, twice) / T(s.l + beam.l0);
  const T stretch = T(beam.l0 / s.l);
  s.gamma_y = stretch * s.chord.y;
  s.gamma_z = stretch * s.chord.z;
  const T s2 = dot(s.v, s.v);
  s.h = asin_remainder(s2, s.w);
  s.g = 1.0 - T(s2 * s.h);
  s.psi = T(2.0 * s.g) * s.v;
  return s;
}

/// Strains linear in displacements and in rotation vectors, 2 (x, y, z) of a linearised quaternion (1, x, y, z).
template <class T, class C>
BeamStrains<T> linear_strains(const BeamConstants<C>& beam, const Vec3<T>& d, const Quat<T>& qi,
                              const Quat<T>& qj) {
  BeamStrains<T> s;
  const Triad<C> rest = triad(beam.t0);
  const auto local = [&](const Vec3<T>& x) {
    return Vec3<T>{dot(rest.e1, x), dot(rest.e2, x), dot(rest.e3, x)};
  };
  const Vec3<T> chord = local(d);
  const Vec3<T> sum = local({T(qi.x + qj.x), T(qi.y + qj.y), T(qi.z + qj.z)});
  s.delta = chord.x;
  s.gamma_y = chord.y - T(beam.l0 * sum.z);
  s.gamma_z = chord.z + T(beam.l0 * sum.y);
  s.psi = 2.0 * local({T(qj.x - qi.x), T(qj.y - qi.y), T(qj.z - qi.z)});
  return s;
}

template <class T, class C>
T beam_energy(const BeamConstants<C>& beam, const BeamStrains<T>& s) {
  return T(0.5 * (beam.kn * s.delta * s.delta + beam.ksz * s.gamma_y * s.gamma_y + beam.ksy * s.gamma_z * s.gamma_z +
                  beam.kt * s.psi.x * s.psi.x + beam.kby * s.psi.y * s.psi.y + beam.kbz * s.psi.z * s.psi.z));
}

/// Exact gradient of beam_energy for co-rotational strains (formula: physics.md section 2, "Exact gradient").
template <class T, class C>
BeamGradient<T> corotational_gradient(const BeamConstants<C>& beam, const BeamStrains<T>& s) {
  const T inverse = T(1.0 / s.l);
  const T stretch = T(beam.l0 * inverse);
  const T qy = T(beam.ksz * s.gamma_y), qz = T(beam.ksy * s.gamma_z);
  const T along = T(T(T(beam.kn * s.delta) -
                      T(T(stretch * inverse) * T(T(qy * s.chord.y) + T(qz * s.chord.z)))) * inverse);
  const Vec3<T> n{T(along * s.chord.x), T(T(along * s.chord.y) + T(stretch * qy)),
                  T(T(along * s.chord.z) + T(stretch * qz))};
  const Vec3<T> p = cross(n, s.chord);
  const Vec3<T> c{T(beam.kt * s.psi.x), T(beam.kby * s.psi.y), T(beam.kbz * s.psi.z)};
  const Vec3<T> q = s.g * c + T(s.h * dot(s.v, c)) * s.v;
  const Vec3<T> z = q + T(0.5 / T(1.0 + s.w)) * cross(s.v, p);
  const Vec3<T> half = 0.5 * p;
  return {s.mean.to_world(n), s.mean.to_world(half - z), s.mean.to_world(half + z)};
}

/// Exact gradient of beam_energy for linear strains.
template <class T, class C>
BeamGradient<T> linear_gradient(const BeamConstants<C>& beam, const BeamStrains<T>& s) {
  const Triad<C> rest = triad(beam.t0);
  const auto world = [&](const Vec3<T>& x) {
    return Vec3<T>{T(T(rest.e1.x * x.x) + T(rest.e2.x * x.y)) + T(rest.e3.x * x.z),
                   T(T(rest.e1.y * x.x) + T(rest.e2.y * x.y)) + T(rest.e3.y * x.z),
                   T(T(rest.e1.z * x.x) + T(rest.e2.z * x.y)) + T(rest.e3.z * x.z)};
  };
  const T qy = T(beam.ksz * s.gamma_y), qz = T(beam.ksy * s.gamma_z);
  const Vec3<T> half{T(0.0 * qy), T((0.5 * beam.l0) * qz), T((-0.5 * beam.l0) * qy)};
  const Vec3<T> c{T(beam.kt * s.psi.x), T(beam.kby * s.psi.y), T(beam.kbz * s.psi.z)};
  return {world({T(beam.kn * s.delta), qy, qz}), world(half - c), world(half + c)};
}

/// The kernel for one choice of kinematics, picked outside the loop over beams.
template <Kinematics kinematics>
struct BeamKernel {
  template <class T, class C>
  static BeamStrains<T> strains(const BeamConstants<C>& beam, const Vec3<T>& d, const Quat<T>& qi, const Quat<T>& qj) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_strains(beam, d, qi, qj);
    } else {
      return corotational_strains(beam, d, qi, qj);
    }
  }
  template <class T, class C>
  static BeamGradient<T> gradient(const BeamConstants<C>& beam, const BeamStrains<T>& s) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_gradient(beam, s);
    } else {
      return corotational_gradient(beam, s);
    }
  }
};

}  // namespace floe
