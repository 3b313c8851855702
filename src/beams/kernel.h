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
///     a, b = q_i, q_j, of the two signs of b that with |b - a| <= |b + a|
///     tau = Im((a + b)* (b - a))/|a + b|^2       tan(phi/4) about the axis of rotation
///     psi = 4 atan(|tau|) tau/|tau|              relative rotation [rad], phi = |psi|
///     m = (a + b)/|a + b|, E = R_m^T e           the chord in the mean triad
///     Delta = d.(2 (l0, 0, 0) + d)/(l + l0)      elongation [m], exact at any rotation and strain
///     gamma_y = l0 E_2/l, gamma_z = l0 E_3/l     the chord against the mean triad, as a length [m]
///     U = 1/2 (kn Delta^2 + ksz gamma_y^2 + ksy gamma_z^2
///              + kt psi_1^2 + kby psi_2^2 + kbz psi_3^2)
///
/// With x = |b - a|^2/4 = sin^2(phi/4):  |a + b|^2 = 4 (1 - x), |tau|^2 = x/(1 - x). With
/// g = (phi/2)/sin(phi/2):  psi = 4 g (1 - x) tau. tau and m have their vector parts in T.
///
/// An eccentric beam joins points of the bodies at o_i, o_j from their centroids at rest. These
/// arms turn with the bodies, a = R o: d is T^T (u_j + a_j - o_j - u_i - a_i + o_i), and a force f
/// on the end of an arm is the force f and the moment a x f on the body (model.md, "Beam").
///
/// This text is that of every back end: the lanes of a processor (kernel_lanes.h) and devices.
#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "beams/stiffness.h"
#include "floe/base/rotation.h"
#include "floe/lattice/kinematics.h"

namespace floe {

/// A triad of any orientation, to take vectors from world axes to the triad and back.
template <class C>
struct AnyFrame {
  Vec3<C> e1, e2, e3;

  template <class T>
  constexpr Vec3<T> to_local(const Vec3<T>& v) const {
    return {dot(e1, v), dot(e2, v), dot(e3, v)};
  }
  template <class T>
  constexpr Vec3<T> to_world(const Vec3<T>& v) const {
    return {T(T(e1.x * v.x) + T(e2.x * v.y)) + T(e3.x * v.z),
            T(T(e1.y * v.x) + T(e2.y * v.y)) + T(e3.y * v.z),
            T(T(e1.z * v.x) + T(e2.z * v.y)) + T(e3.z * v.z)};
  }
};
/// The triad of an eccentric beam, and the offsets of its ends.
template <class C>
struct EccentricFrame : AnyFrame<C> {
  Vec3<C> offset_i, offset_j;  ///< from the centroids, at rest, world axes [m]
};
template <template <class> class Frame>
inline constexpr bool is_eccentric_frame = std::is_same_v<Frame<double>, EccentricFrame<double>>;
/// A triad with e3 along z and e1 = (c, s, 0), as every beam of a sheet has. It has fewer numbers
/// to load and to multiply.
template <class C>
struct FlatFrame {
  C c, s;

  template <class T>
  constexpr Vec3<T> to_local(const Vec3<T>& v) const {
    return {T(c * v.x) + T(s * v.y), T(c * v.y) - T(s * v.x), v.z};
  }
  template <class T>
  constexpr Vec3<T> to_world(const Vec3<T>& v) const {
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
  Vec3<T> e;                  ///< the chord in the triad at rest [m]
  Vec3<T> tau;                ///< tan(phi/4) about the axis of the relative rotation
  T g, h;                     ///< g; h = (1 - g)/|tau|^2
  Vec3<T> arm_i, arm_j;       ///< a of eccentric beams, world axes [m]; of others undefined
};

/// Derivative of U with respect to u_j (= minus that to u_i) [N] and to the spins of i and j [N m].
template <class T>
struct BeamGradient {
  Vec3<T> force, moment_i, moment_j;
};

/// A relative rotation, by the quaternions a and b of the two ends.
template <class T>
struct Between {
  Quat<T> b;           ///< with the sign for which |b - a| <= |b + a|
  Quat<T> difference;  ///< b - a
  T square;            ///< |b - a|^2 = 4 x
  T h;                 ///< (1 - g)/|tau|^2
};

/// h as a series in x = square/4. From asin(s)/(s sqrt(1 - s^2)) = sum g_k s^2k, g_k = 4^k k!^2/(2k
/// + 1)! (Abramowitz & Stegun 4.4.40, times 1/sqrt(1 - s^2); Gradshteyn & Ryzhik 1.645.2), which is
/// g at s = sin(phi/4):  h = -g_1 - sum (g_k+1 - g_k) x^k. Below series_limit (a relative rotation
/// of 11 degrees) the first omitted term is 6e-18.
template <class T>
constexpr T remainder_series(const T& square) {
  // Estrin's scheme: the dependency chain of Horner's scheme would be twice as long.
  const T square2 = T(square * square);
  const T low = T(T((2.0 / 60.0) * square) - 2.0 / 3.0),
          middle = T(T((16.0 / 20160.0) * square) + 8.0 / 1680.0),
          high = T(T((256.0 / 9225216.0) * square) + 128.0 / 887040.0);
  return T(low + T(square2 * T(middle + T(square2 * high))));
}
inline constexpr double series_limit = 0.01;  ///< of Between::square

template <class T>
constexpr Quat<T> operator-(const Quat<T>& a, const Quat<T>& b) {
  return {T(a.w - b.w), T(a.x - b.x), T(a.y - b.y), T(a.z - b.z)};
}
template <class T>
constexpr T dot(const Quat<T>& a, const Quat<T>& b) {
  return T(T(a.w * b.w) + T(a.x * b.x)) + T(T(a.y * b.y) + T(a.z * b.z));
}

/// The relative rotation of the ends' quaternions: of b and -b, which are the same rotation, the
/// one nearer to a.
template <class T>
constexpr Between<T> between(const Quat<T>& a, const Quat<T>& b) {
  using std::atan2;
  using std::sqrt;
  Between<T> r;
  r.b = b;
  r.difference = b - a;
  r.square = dot(r.difference, r.difference);
  if (r.square > 2.0) {
    r.b = {T(-b.w), T(-b.x), T(-b.y), T(-b.z)};
    r.difference = r.b - a;
    r.square = dot(r.difference, r.difference);
  }
  r.h = remainder_series(r.square);
  if (r.square < series_limit) return r;
  const T sum = T(4.0 - r.square);  // |a + b|^2
  const T g = T(4.0 * atan2(sqrt(r.square), sqrt(sum))) / sqrt(T(r.square * sum));
  r.h = T(T(1.0 - g) * sum) / r.square;
  return r;
}
/// The triad of the rotation q/|q|. \param inverse  1/|q|^2
template <class T>
constexpr Triad<T> triad(const Quat<T>& q, const T& inverse) {
  const T twice = T(inverse + inverse);
  const Quat<T> s{T(twice * q.w), T(twice * q.x), T(twice * q.y), T(twice * q.z)};
  const T xy = T(s.x * q.y), xz = T(s.x * q.z), yz = T(s.y * q.z);
  const T rest = T(1.0 - T(s.z * q.z)), across = T(1.0 - T(s.x * q.x));
  return {{T(rest - T(s.y * q.y)), T(xy + T(s.w * q.z)), T(xz - T(s.w * q.y))},
          {T(xy - T(s.w * q.z)), T(across - T(s.z * q.z)), T(yz + T(s.w * q.x))},
          {T(xz + T(s.w * q.y)), T(yz - T(s.w * q.x)), T(across - T(s.y * q.y))}};
}

/// Co-rotational strains (Crisfield 1990, 1997): strains against a triad that moves with the beam.
/// \param d       u_j - u_i [m], world axes
/// \param qi, qj  rotations of the bodies from rest
template <class T, class Constants>
constexpr BeamStrains<T> corotational_strains(const Constants& beam, const Vec3<T>& d,
                                              const Quat<T>& qi, const Quat<T>& qj) {
  using std::sqrt;
  BeamStrains<T> s;
  const Between<T> r = between(qi, qj);
  const Quat<T>& m = r.difference;
  const Quat<T> p{T(qi.w + r.b.w), T(qi.x + r.b.x), T(qi.y + r.b.y), T(qi.z + r.b.z)};
  const T sum2 = T(4.0 - r.square), inverse2 = T(1.0 / sum2);  // |a + b|^2
  const Vec3<T> sum{p.x, p.y, p.z}, difference{m.x, m.y, m.z};
  const Vec3<T> turn = p.w * difference - m.w * sum - cross(sum, difference);
  s.tau = beam.rest.to_local(inverse2 * turn);
  s.h = r.h;
  s.g = 1.0 - T(T(r.square * inverse2) * s.h);
  s.psi = T(s.g * sum2) * s.tau;
  const Vec3<T> axis = beam.rest.to_local(sum);
  s.mean = triad(Quat<T>{p.w, axis.x, axis.y, axis.z}, inverse2);

  const Vec3<T> stretch = beam.rest.to_local(d);
  s.e = {T(beam.l0 + stretch.x), stretch.y, stretch.z};
  s.l = sqrt(dot(s.e, s.e));
  s.chord = s.mean.to_local(s.e);
  const T lengths = T(s.l + beam.l0);
  const T both = T(1.0 / T(s.l * lengths));  // one division for 1/l and 1/(l + l0)
  s.inverse_l = both * lengths;
  s.delta = dot(stretch, Vec3<T>{T(beam.l0 + s.e.x), stretch.y, stretch.z}) * T(both * s.l);
  const T ratio = T(beam.l0 * s.inverse_l);
  s.gamma_y = ratio * s.chord.y;
  s.gamma_z = ratio * s.chord.z;
  return s;
}

/// Strains linear in displacements and rotation vectors. Sets the six strains only.
/// \param d       u_j - u_i [m], world axes
/// \param qi, qj  linearised quaternions (1, x, y, z) of rotation vectors 2 (x, y, z)
template <class T, class Constants>
constexpr BeamStrains<T> linear_strains(const Constants& beam, const Vec3<T>& d, const Quat<T>& qi,
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
constexpr T beam_energy(const Constants& beam, const BeamStrains<T>& s) {
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
constexpr BeamStress<T> elastic_stress(const Constants& beam, const BeamStrains<T>& s) {
  return {T(beam.kn * s.delta),
          T(beam.ksz * s.gamma_y),
          T(beam.ksy * s.gamma_z),
          {T(beam.kt * s.psi.x), T(beam.kby * s.psi.y), T(beam.kbz * s.psi.z)}};
}

template <class T>
constexpr BeamStress<T> operator+(const BeamStress<T>& a, const BeamStress<T>& b) {
  return {T(a.n + b.n), T(a.qy + b.qy), T(a.qz + b.qz), a.c + b.c};
}

/// Dashpots on the six strains [N s/m, N m s].
using BeamDashpots = std::array<double, 6>;

/// Section forces of the dashpots at the given strain rates.
template <class T>
constexpr BeamStress<T> viscous_stress(const BeamDashpots& c, const BeamStress<T>& rate) {
  return {T(c[0] * rate.n),
          T(c[1] * rate.qy),
          T(c[2] * rate.qz),
          {T(c[3] * rate.c.x), T(c[4] * rate.c.y), T(c[5] * rate.c.z)}};
}

/// Exact gradient B^T stress of the co-rotational strains (model.md, "Beam").
template <class T, class Constants>
constexpr BeamGradient<T> corotational_gradient(const Constants& beam, const BeamStrains<T>& s,
                                                const BeamStress<T>& stress) {
  const T& inverse = s.inverse_l;
  const T stretch = T(beam.l0 * inverse);
  const T &qy = stress.qy, &qz = stress.qz;
  const Vec3<T>& c = stress.c;
  const T along =
      T(T(stress.n - T(T(stretch * inverse) * T(T(qy * s.chord.y) + T(qz * s.chord.z)))) * inverse);
  const Vec3<T> n{T(along * s.chord.x), T(T(along * s.chord.y) + T(stretch * qy)),
                  T(T(along * s.chord.z) + T(stretch * qz))};
  const Vec3<T> q = s.g * c + T(s.h * dot(s.tau, c)) * s.tau;
  const Vec3<T> z = s.mean.to_world(q + 0.5 * cross(s.tau, cross(n, s.chord)));
  const Vec3<T> force = s.mean.to_world(n), p = cross(force, s.e);  // in the triad at rest
  return {beam.rest.to_world(force), beam.rest.to_world(0.5 * p - z),
          beam.rest.to_world(0.5 * p + z)};
}

/// Rates B v of the co-rotational strains, with the same B as the gradient. In the mean triad, with
/// v = v_j - v_i, the mean spin w = (w_i + w_j)/2 and the relative spin d = w_j - w_i: the triad
/// spins with w_m = w - tau x d/2, the chord has the rate v - w_m x E, and psi has the rate S^-1 d
/// (model.md, "Beam").
/// \param velocity        v_j - v_i [m/s], world axes
/// \param spin_i, spin_j  w_i, w_j [rad/s], world axes
template <class T, class Constants>
constexpr BeamStress<T> corotational_rates(const Constants& beam, const BeamStrains<T>& s,
                                           const Vec3<T>& velocity, const Vec3<T>& spin_i,
                                           const Vec3<T>& spin_j) {
  const auto local = [&](const Vec3<T>& v) { return s.mean.to_local(beam.rest.to_local(v)); };
  const Vec3<T> d = local(spin_j - spin_i), mean = local(0.5 * (spin_i + spin_j));
  const Vec3<T> turn = mean - 0.5 * cross(s.tau, d);
  const Vec3<T> chord_rate = local(velocity) - cross(turn, s.chord);
  const T& inverse = s.inverse_l;
  const T stretch_rate = T(dot(s.chord, chord_rate) * inverse);
  const T ratio = T(beam.l0 * inverse);
  return {stretch_rate, T(ratio * T(chord_rate.y - T(T(s.chord.y * inverse) * stretch_rate))),
          T(ratio * T(chord_rate.z - T(T(s.chord.z * inverse) * stretch_rate))),
          s.g * d + T(s.h * dot(s.tau, d)) * s.tau};
}

/// Rates of the linear strains; parameters as for corotational_rates().
template <class T, class Constants>
constexpr BeamStress<T> linear_rates(const Constants& beam, const Vec3<T>& velocity,
                                     const Vec3<T>& spin_i, const Vec3<T>& spin_j) {
  const Vec3<T> chord = beam.rest.to_local(velocity),
                mean = beam.rest.to_local(0.5 * (spin_i + spin_j));
  return {chord.x, T(chord.y - T(beam.l0 * mean.z)), T(chord.z + T(beam.l0 * mean.y)),
          beam.rest.to_local(spin_j - spin_i)};
}

/// Exact gradient B^T stress of the linear strains.
template <class T, class Constants>
constexpr BeamGradient<T> linear_gradient(const Constants& beam, const BeamStress<T>& stress) {
  const T &qy = stress.qy, &qz = stress.qz;
  const Vec3<T>& c = stress.c;
  const Vec3<T> half{T(0.0 * qy), T((0.5 * beam.l0) * qz), T((-0.5 * beam.l0) * qy)};
  return {beam.rest.to_world(Vec3<T>{stress.n, qy, qz}), beam.rest.to_world(half - c),
          beam.rest.to_world(half + c)};
}

/// What the end of an arm moves by as its body turns: (R - 1) o, or in linear kinematics the
/// rotation vector times o.
/// \param q  rotation of the body from rest, or its linearised quaternion
template <Kinematics kinematics, class T, class C>
constexpr Vec3<T> move_of_end(const Quat<T>& q, const Vec3<C>& o) {
  const Vec3<T> offset{T(o.x), T(o.y), T(o.z)}, axis{q.x, q.y, q.z};
  const Vec3<T> turn = cross(axis, offset) + cross(axis, offset);
  if constexpr (kinematics == Kinematics::linear) return turn;
  return q.w * turn + cross(axis, turn);
}

/// The kernel for one choice of kinematics, which is made outside the loop over beams.
template <Kinematics kinematics>
struct BeamKernel {
  static constexpr bool is_linear = kinematics == Kinematics::linear;
  template <class Constants>
  static constexpr bool is_eccentric = requires(const Constants& c) {
    c.rest.offset_i;
  };

  template <class T, class Constants>
  static constexpr BeamStrains<T> strains(const Constants& beam, const Vec3<T>& d,
                                          const Quat<T>& qi, const Quat<T>& qj) {
    if constexpr (is_eccentric<Constants>) {
      const auto &oi = beam.rest.offset_i, &oj = beam.rest.offset_j;
      const Vec3<T> i = move_of_end<kinematics>(qi, oi), j = move_of_end<kinematics>(qj, oj);
      BeamStrains<T> s = centric_strains(beam, Vec3<T>(d + (j - i)), qi, qj);
      s.arm_i = {T(oi.x), T(oi.y), T(oi.z)}, s.arm_j = {T(oj.x), T(oj.y), T(oj.z)};
      if constexpr (!is_linear) s.arm_i = s.arm_i + i, s.arm_j = s.arm_j + j;
      return s;
    } else {
      return centric_strains(beam, d, qi, qj);
    }
  }
  template <class T, class Constants>
  static constexpr BeamGradient<T> gradient(const Constants& beam, const BeamStrains<T>& s,
                                            const BeamStress<T>& stress) {
    BeamGradient<T> g = [&] {
      if constexpr (is_linear) {
        return linear_gradient(beam, stress);
      } else {
        return corotational_gradient(beam, s, stress);
      }
    }();
    if constexpr (is_eccentric<Constants>) {
      g.moment_i = g.moment_i - cross(s.arm_i, g.force);
      g.moment_j = g.moment_j + cross(s.arm_j, g.force);
    }
    return g;
  }
  template <class T, class Constants>
  static constexpr BeamGradient<T> gradient(const Constants& beam, const BeamStrains<T>& s) {
    return gradient(beam, s, elastic_stress(beam, s));
  }
  template <class T, class Constants>
  static constexpr BeamStress<T> rates(const Constants& beam, const BeamStrains<T>& s,
                                       const Vec3<T>& velocity, const Vec3<T>& spin_i,
                                       const Vec3<T>& spin_j) {
    if constexpr (is_eccentric<Constants>) {
      const Vec3<T> between = cross(spin_j, s.arm_j) - cross(spin_i, s.arm_i);
      return centric_rates(beam, s, Vec3<T>(velocity + between), spin_i, spin_j);
    } else {
      return centric_rates(beam, s, velocity, spin_i, spin_j);
    }
  }

 private:
  template <class T, class Constants>
  static constexpr BeamStrains<T> centric_strains(const Constants& beam, const Vec3<T>& d,
                                                  const Quat<T>& qi, const Quat<T>& qj) {
    if constexpr (is_linear) {
      return linear_strains(beam, d, qi, qj);
    } else {
      return corotational_strains(beam, d, qi, qj);
    }
  }
  template <class T, class Constants>
  static constexpr BeamStress<T> centric_rates(const Constants& beam, const BeamStrains<T>& s,
                                               const Vec3<T>& velocity, const Vec3<T>& spin_i,
                                               const Vec3<T>& spin_j) {
    if constexpr (is_linear) {
      return linear_rates(beam, velocity, spin_i, spin_j);
    } else {
      return corotational_rates(beam, s, velocity, spin_i, spin_j);
    }
  }
};

}  // namespace floe
