/// \file
/// One beam: strain energy and its exact gradient, on any scalar (model.md, "Beam").
///
/// A shear-flexible beam joins the centroids of two rigid bodies i and j, which are displaced by
/// u_i, u_j and rotated by q_i, q_j from the state at rest. The triad of the beam at rest is T,
/// with e1 along the beam. All is computed in T, where the chord at rest is (l0, 0, 0) and small
/// rotations are small numbers. So strains keep their relative precision down to 1e-12, where
/// components in world axes would be rounded to 1e-16 of l0.
///
///     d = T^T (u_j - u_i), e = (l0, 0, 0) + d, l = |e|
///     a, b = q_i, q_j with vector parts in T     the triads that the bodies carry, seen from T
///     r = a* b = (w, v), with the sign for w >= 0
///     psi = 2 atan2(|v|, w) v/|v|                relative rotation [rad]
///     m = (a + b)/|a + b|, E = R_m^T e           the chord in the mean triad
///     Delta = d.(2 (l0, 0, 0) + d)/(l + l0)      elongation [m], exact at any rotation and strain
///     gamma_y = l0 E_2/l, gamma_z = l0 E_3/l     the chord against the mean triad, as a length [m]
///     U = 1/2 (kn Delta^2 + ksz gamma_y^2 + ksy gamma_z^2
///              + kt psi_1^2 + kby psi_2^2 + kbz psi_3^2)
///
/// With g = asin|v|/|v| = (phi/2)/sin(phi/2), phi = |psi|:  psi = 2 g v.
#pragma once

#include <array>
#include <cmath>

#include "base/simd.h"
#include "beams/stiffness.h"
#include "floe/base/rotation.h"
#include "floe/lattice/kinematics.h"

namespace floe {

/// A triad of any orientation, to take vectors from world axes to the triad and back.
template <class C>
struct AnyFrame {
  Vec3<C> e1, e2, e3;

  template <class T>
  Vec3<T> to_local(const Vec3<T>& v) const {
    return {dot(e1, v), dot(e2, v), dot(e3, v)};
  }
  template <class T>
  Vec3<T> to_world(const Vec3<T>& v) const {
    return {T(T(e1.x * v.x) + T(e2.x * v.y)) + T(e3.x * v.z),
            T(T(e1.y * v.x) + T(e2.y * v.y)) + T(e3.y * v.z),
            T(T(e1.z * v.x) + T(e2.z * v.y)) + T(e3.z * v.z)};
  }
};
/// A triad with e3 along z and e1 = (c, s, 0), as every beam of a sheet has. It has fewer numbers
/// to load and to multiply.
template <class C>
struct FlatFrame {
  C c, s;

  template <class T>
  Vec3<T> to_local(const Vec3<T>& v) const {
    return {T(c * v.x) + T(s * v.y), T(c * v.y) - T(s * v.x), v.z};
  }
  template <class T>
  Vec3<T> to_world(const Vec3<T>& v) const {
    return {T(c * v.x) - T(s * v.y), T(s * v.x) + T(c * v.y), v.z};
  }
};

/// Constants of a beam.
template <class C, template <class> class Frame = AnyFrame>
struct BeamConstants {
  Frame<C> rest;                 ///< triad at rest
  C l0;                          ///< length at rest [m]
  C kn, ksz, ksy, kt, kby, kbz;  ///< stiffnesses [N/m, N m]
};

/// The six strains, and intermediate results that the gradient needs.
template <class T>
struct BeamStrains {
  T delta, gamma_y, gamma_z;  ///< [m]
  Vec3<T> psi;                ///< [rad]
  T l, inverse_l;             ///< present length of the chord [m], and 1/l
  Vec3<T> chord;              ///< E, components of the chord in the mean triad [m]
  Triad<T> mean;              ///< R_m, in the triad at rest
  Vec3<T> v;                  ///< vector part of the relative rotation
  T g, h;                     ///< g; h = (1 - g)/|v|^2
  T half_tau;                 ///< tau/2 = half_tau v, half_tau = 1/(2 (1 + w)) = 1/|a + b|^2
};

/// Derivative of U with respect to u_j (= minus that to u_i) [N] and to the spins of i and j [N m].
template <class T>
struct BeamGradient {
  Vec3<T> force, moment_i, moment_j;
};

/// Functions of s2 = |v|^2 that rotations need: h = (1 - asin(s)/s)/s2 and inverse_sum =
/// 1/|a + b| = 1/sqrt(2 (1 + w)), with w = sqrt(1 - s2). Below |v| = 0.1 (a relative rotation of 11
/// degrees) they are summed as series, whose first omitted terms are 1e-17; above it the closed
/// forms are used.
template <class T>
struct HalfAngle {
  T h, inverse_sum;
};
template <class T>
HalfAngle<T> half_angle_series(const T& s2) {
  // Estrin's scheme: a block waits for these sums, and the dependency chain of Horner's scheme
  // would be twice as long.
  const T x2 = T(s2 * s2), x4 = T(x2 * x2);
  const auto sum = [&](double c0, double c1, double c2, double c3, double c4, double c5, double c6,
                       double c7) {
    const T low = T(T(c1 * s2) + c0) + T(x2 * T(T(c3 * s2) + c2)),
            high = T(T(c5 * s2) + c4) + T(x2 * T(T(c7 * s2) + c6));
    return T(low + T(x4 * high));
  };
  // asin(s)/s = sum c_k s^2k, c_k = (2k)!/(4^k k!^2 (2k+1)) (Abramowitz & Stegun 4.4.40)
  const T arc = sum(1.0 / 6.0, 3.0 / 40.0, 5.0 / 112.0, 35.0 / 1152.0, 63.0 / 2816.0,
                    231.0 / 13312.0, 143.0 / 10240.0, 6435.0 / 557056.0);
  // 1/sqrt(2 (1 + sqrt(1 - s2))) = 1/2 C(s2/4)^(1/2), C the generating function of the Catalan
  // numbers: terms
  // binomial(2k + 1/2, k)/(4k + 1) (s2/4)^k/2 (Graham, Knuth & Patashnik, (5.60))
  const T inverse = sum(0.5, 1.0 / 16.0, 7.0 / 256.0, 33.0 / 2048.0, 715.0 / 65536.0,
                        4199.0 / 524288.0, 52003.0 / 8388608.0, 334305.0 / 67108864.0);
  return {T(-arc), inverse};
}
inline constexpr double series_limit = 0.01;  ///< of s2
/// \param w  cosine of half the relative rotation, >= 0
template <class T>
HalfAngle<T> half_angle(const T& s2, const T& w) {
  using std::atan2;
  using std::sqrt;
  if (s2 < series_limit) return half_angle_series(s2);
  const T s = sqrt(s2);
  return {T(T(1.0 - T(atan2(s, w) / s)) / s2), T(1.0 / sqrt(T(2.0 * T(1.0 + w))))};
}
/// Computes the closed forms in the lanes that need them, one by one: such lanes are rare (a beam
/// bent by 11 degrees).
[[gnu::noinline, gnu::cold]] inline void half_angle_one_by_one(const Lanes& s2, const Lanes& w,
                                                               HalfAngle<Lanes>& f) {
  for (std::size_t k = 0; k < lanes; ++k) {
    if (s2[k] < series_limit) continue;
    const HalfAngle<double> one = half_angle(double(s2[k]), double(w[k]));
    f.h[k] = one.h;
    f.inverse_sum[k] = one.inverse_sum;
  }
}
inline HalfAngle<Lanes> half_angle(const Lanes& s2, const Lanes& w) {
  HalfAngle<Lanes> f = half_angle_series(s2);
  if (all_of(s2 < series_limit)) [[likely]]
    return f;
  half_angle_one_by_one(s2, w, f);
  return f;
}

/// q and -q are the same rotation: chooses the sign of b, and of r = a* b with it, so that
/// r.w >= 0.
template <class T>
void take_shorter_way(Quat<T>& b, Quat<T>& r) {
  const auto sign = sign_of(r.w);
  for (Quat<T>* q : {&b, &r}) *q = {T(sign * q->w), T(sign * q->x), T(sign * q->y), T(sign * q->z)};
}
inline void take_shorter_way(Quat<Lanes>& b, Quat<Lanes>& r) {
  if (none_of(r.w < 0.0)) [[likely]]
    return;
  take_shorter_way<Lanes>(b, r);
}

/// Co-rotational strains (Crisfield 1990, 1997): strains against a triad that moves with the beam.
/// \param d       u_j - u_i [m], world axes
/// \param qi, qj  rotations of the bodies from rest
template <class T, class Constants>
BeamStrains<T> corotational_strains(const Constants& beam, const Vec3<T>& d, const Quat<T>& qi,
                                    const Quat<T>& qj) {
  using std::sqrt;
  BeamStrains<T> s;
  const Vec3<T> ai = beam.rest.to_local(Vec3<T>{qi.x, qi.y, qi.z}),
                bj = beam.rest.to_local(Vec3<T>{qj.x, qj.y, qj.z});
  const Quat<T> a{qi.w, ai.x, ai.y, ai.z};
  Quat<T> b{qj.w, bj.x, bj.y, bj.z};
  Quat<T> r = product(conjugate(a), b);
  take_shorter_way(b, r);
  s.v = {r.x, r.y, r.z};
  const T s2 = dot(s.v, s.v);
  const HalfAngle<T> f = half_angle(s2, r.w);
  s.h = f.h;
  s.g = 1.0 - T(s2 * s.h);
  s.psi = T(2.0 * s.g) * s.v;
  s.half_tau = f.inverse_sum * f.inverse_sum;
  s.mean = triad(Quat<T>{T(f.inverse_sum * T(a.w + b.w)), T(f.inverse_sum * T(a.x + b.x)),
                         T(f.inverse_sum * T(a.y + b.y)), T(f.inverse_sum * T(a.z + b.z))});

  const Vec3<T> stretch = beam.rest.to_local(d);
  const Vec3<T> e{T(beam.l0 + stretch.x), stretch.y, stretch.z};
  s.l = sqrt(dot(e, e));
  s.chord = s.mean.to_local(e);
  const T sum = T(s.l + beam.l0);
  const T both = T(1.0 / T(s.l * sum));  // one division for 1/l and 1/(l + l0)
  s.inverse_l = both * sum;
  s.delta = dot(stretch, Vec3<T>{T(beam.l0 + e.x), stretch.y, stretch.z}) * T(both * s.l);
  const T ratio = T(beam.l0 * s.inverse_l);
  s.gamma_y = ratio * s.chord.y;
  s.gamma_z = ratio * s.chord.z;
  return s;
}

/// Strains linear in displacements and rotation vectors. Sets the six strains only.
/// \param d       u_j - u_i [m], world axes
/// \param qi, qj  linearised quaternions (1, x, y, z) of rotation vectors 2 (x, y, z)
template <class T, class Constants>
BeamStrains<T> linear_strains(const Constants& beam, const Vec3<T>& d, const Quat<T>& qi,
                              const Quat<T>& qj) {
  BeamStrains<T> s;
  const Vec3<T> chord = beam.rest.to_local(d);
  const Vec3<T> sum = beam.rest.to_local(Vec3<T>{T(qi.x + qj.x), T(qi.y + qj.y), T(qi.z + qj.z)});
  s.delta = chord.x;
  s.gamma_y = chord.y - T(beam.l0 * sum.z);
  s.gamma_z = chord.z + T(beam.l0 * sum.y);
  s.psi = 2.0 * beam.rest.to_local(Vec3<T>{T(qj.x - qi.x), T(qj.y - qi.y), T(qj.z - qi.z)});
  return s;
}

/// Strain energy U [J].
template <class T, class Constants>
T beam_energy(const Constants& beam, const BeamStrains<T>& s) {
  return T(0.5 * (beam.kn * s.delta * s.delta + beam.ksz * s.gamma_y * s.gamma_y +
                  beam.ksy * s.gamma_z * s.gamma_z + beam.kt * s.psi.x * s.psi.x +
                  beam.kby * s.psi.y * s.psi.y + beam.kbz * s.psi.z * s.psi.z));
}

/// Section forces, conjugate to the six strains: forces [N] on Delta, gamma_y, gamma_z and moments
/// [N m] on psi. Also serves for the strains themselves and for their rates.
template <class T>
struct BeamStress {
  T n, qy, qz;
  Vec3<T> c;
};

/// Section forces of the springs.
template <class T, class Constants>
BeamStress<T> elastic_stress(const Constants& beam, const BeamStrains<T>& s) {
  return {T(beam.kn * s.delta),
          T(beam.ksz * s.gamma_y),
          T(beam.ksy * s.gamma_z),
          {T(beam.kt * s.psi.x), T(beam.kby * s.psi.y), T(beam.kbz * s.psi.z)}};
}

template <class T>
BeamStress<T> operator+(const BeamStress<T>& a, const BeamStress<T>& b) {
  return {T(a.n + b.n), T(a.qy + b.qy), T(a.qz + b.qz), a.c + b.c};
}

/// Dashpots on the six strains [N s/m, N m s].
using BeamDashpots = std::array<double, 6>;

/// Section forces of the dashpots at the given strain rates.
template <class T>
BeamStress<T> viscous_stress(const BeamDashpots& c, const BeamStress<T>& rate) {
  return {T(c[0] * rate.n),
          T(c[1] * rate.qy),
          T(c[2] * rate.qz),
          {T(c[3] * rate.c.x), T(c[4] * rate.c.y), T(c[5] * rate.c.z)}};
}

/// Exact gradient B^T stress of the co-rotational strains (model.md, "Beam").
template <class T, class Constants>
BeamGradient<T> corotational_gradient(const Constants& beam, const BeamStrains<T>& s,
                                      const BeamStress<T>& stress) {
  const T& inverse = s.inverse_l;
  const T stretch = T(beam.l0 * inverse);
  const T &qy = stress.qy, &qz = stress.qz;
  const Vec3<T>& c = stress.c;
  const T along =
      T(T(stress.n - T(T(stretch * inverse) * T(T(qy * s.chord.y) + T(qz * s.chord.z)))) * inverse);
  const Vec3<T> n{T(along * s.chord.x), T(T(along * s.chord.y) + T(stretch * qy)),
                  T(T(along * s.chord.z) + T(stretch * qz))};
  const Vec3<T> p = cross(n, s.chord);
  const Vec3<T> q = s.g * c + T(s.h * dot(s.v, c)) * s.v;
  const Vec3<T> z = q + s.half_tau * cross(s.v, p);
  const Vec3<T> half = 0.5 * p;
  return {beam.rest.to_world(s.mean.to_world(n)), beam.rest.to_world(s.mean.to_world(half - z)),
          beam.rest.to_world(s.mean.to_world(half + z))};
}

/// Rates B v of the co-rotational strains, with the same B as the gradient. In the mean triad, with
/// v = v_j - v_i, the mean spin w = (w_i + w_j)/2 and the relative spin d = w_j - w_i: the triad
/// spins with w_m = w - tau x d/2, the chord has the rate v - w_m x E, and psi has the rate S^-1 d
/// (model.md, "Beam").
/// \param velocity        v_j - v_i [m/s], world axes
/// \param spin_i, spin_j  w_i, w_j [rad/s], world axes
template <class T, class Constants>
BeamStress<T> corotational_rates(const Constants& beam, const BeamStrains<T>& s,
                                 const Vec3<T>& velocity, const Vec3<T>& spin_i,
                                 const Vec3<T>& spin_j) {
  const auto local = [&](const Vec3<T>& v) { return s.mean.to_local(beam.rest.to_local(v)); };
  const Vec3<T> d = local(spin_j - spin_i), mean = local(0.5 * (spin_i + spin_j));
  const Vec3<T> turn = mean - s.half_tau * cross(s.v, d);
  const Vec3<T> chord_rate = local(velocity) - cross(turn, s.chord);
  const T& inverse = s.inverse_l;
  const T stretch_rate = T(dot(s.chord, chord_rate) * inverse);
  const T ratio = T(beam.l0 * inverse);
  return {stretch_rate, T(ratio * T(chord_rate.y - T(T(s.chord.y * inverse) * stretch_rate))),
          T(ratio * T(chord_rate.z - T(T(s.chord.z * inverse) * stretch_rate))),
          s.g * d + T(s.h * dot(s.v, d)) * s.v};
}

/// Rates of the linear strains; parameters as for corotational_rates().
template <class T, class Constants>
BeamStress<T> linear_rates(const Constants& beam, const Vec3<T>& velocity, const Vec3<T>& spin_i,
                           const Vec3<T>& spin_j) {
  const Vec3<T> chord = beam.rest.to_local(velocity),
                mean = beam.rest.to_local(0.5 * (spin_i + spin_j));
  return {chord.x, T(chord.y - T(beam.l0 * mean.z)), T(chord.z + T(beam.l0 * mean.y)),
          beam.rest.to_local(spin_j - spin_i)};
}

/// Exact gradient B^T stress of the linear strains.
template <class T, class Constants>
BeamGradient<T> linear_gradient(const Constants& beam, const BeamStress<T>& stress) {
  const T &qy = stress.qy, &qz = stress.qz;
  const Vec3<T>& c = stress.c;
  const Vec3<T> half{T(0.0 * qy), T((0.5 * beam.l0) * qz), T((-0.5 * beam.l0) * qy)};
  return {beam.rest.to_world(Vec3<T>{stress.n, qy, qz}), beam.rest.to_world(half - c),
          beam.rest.to_world(half + c)};
}

/// The kernel for one choice of kinematics, which is made outside the loop over beams.
template <Kinematics kinematics>
struct BeamKernel {
  static constexpr bool is_linear = kinematics == Kinematics::linear;
  template <class T, class Constants>
  static BeamStrains<T> strains(const Constants& beam, const Vec3<T>& d, const Quat<T>& qi,
                                const Quat<T>& qj) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_strains(beam, d, qi, qj);
    } else {
      return corotational_strains(beam, d, qi, qj);
    }
  }
  template <class T, class Constants>
  static BeamGradient<T> gradient(const Constants& beam, const BeamStrains<T>& s,
                                  const BeamStress<T>& stress) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_gradient(beam, stress);
    } else {
      return corotational_gradient(beam, s, stress);
    }
  }
  template <class T, class Constants>
  static BeamGradient<T> gradient(const Constants& beam, const BeamStrains<T>& s) {
    return gradient(beam, s, elastic_stress(beam, s));
  }
  template <class T, class Constants>
  static BeamStress<T> rates(const Constants& beam, const BeamStrains<T>& s,
                             const Vec3<T>& velocity, const Vec3<T>& spin_i,
                             const Vec3<T>& spin_j) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_rates(beam, velocity, spin_i, spin_j);
    } else {
      return corotational_rates(beam, s, velocity, spin_i, spin_j);
    }
  }
};

}  // namespace floe
