/// \file
/// One beam in the plane: strain energy and its exact gradient, on any scalar, and the same on
/// planar body records. This is the spatial kernel (kernel.h) for bodies that turn about z only and
/// a section whose axis 3 is z (model.md, "Planar models").
///
/// Two rigid bodies i and j are displaced by u_i, u_j and turned by theta_i, theta_j from the state
/// at rest. As in the spatial kernel, all is computed in the axes T of the beam at rest, with axis
/// 1 along the beam:
///
///     d = T^T (u_j - u_i), e = (l0, 0) + d, l = |e|
///     m = (theta_i + theta_j)/2, E = R(m)^T e     the chord against the mean of the two ends
///     Delta = d.(2 (l0, 0) + d)/(l + l0)          elongation [m], exact at any rotation and strain
///     gamma = l0 E_2/l                            shear, as a length [m]
///     psi = theta_j - theta_i                     relative rotation [rad], of any size
///     U = 1/2 (kn Delta^2 + ks gamma^2 + kb psi^2)
///
/// The spatial kernel computes psi from quaternions, which tell it up to half a turn only; within
/// half a turn both kernels agree.
#pragma once

#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/sine_cosine.h"
#include "beams/beam_force.h"
#include "beams/kernel.h"
#include "floe/base/item.h"
#include "floe/lattice/state.h"

namespace floe {

template <class T>
struct Vec2 {
  T x, y;
};
template <class T>
Vec2<T> operator-(const Vec2<T>& a, const Vec2<T>& b) {
  return {T(a.x - b.x), T(a.y - b.y)};
}

/// Axes turned by an angle of cosine c and sine s, to take vectors to these axes and back.
template <class C>
struct Turned {
  C c, s;

  template <class T>
  Vec2<T> to_local(const Vec2<T>& v) const {
    return {T(c * v.x) + T(s * v.y), T(c * v.y) - T(s * v.x)};
  }
  template <class T>
  Vec2<T> to_world(const Vec2<T>& v) const {
    return {T(c * v.x) - T(s * v.y), T(s * v.x) + T(c * v.y)};
  }
};

/// Constants of a beam.
template <class C>
struct PlanarConstants {
  Turned<C> rest;  ///< axes at rest
  C l0;            ///< length at rest [m]
  C kn, ks, kb;    ///< stiffnesses [N/m, N/m, N m]
};

/// The three strains, and intermediate results that the gradient needs.
template <class T>
struct PlanarStrains {
  T delta, gamma;  ///< [m]
  T psi;           ///< [rad]
  T l, inverse_l;  ///< present length of the chord [m], and 1/l
  Vec2<T> chord;   ///< E [m]
  Turned<T> mean;  ///< R(m)
};

/// Section forces, conjugate to the strains: forces [N] on Delta and gamma, a moment [N m] on psi.
/// Also serves for the rates of the strains.
template <class T>
struct PlanarStress {
  T n, q, c;
};

template <class T>
PlanarStress<T> operator+(const PlanarStress<T>& a, const PlanarStress<T>& b) {
  return {T(a.n + b.n), T(a.q + b.q), T(a.c + b.c)};
}

/// Section forces of the dashpots at the given strain rates.
template <class T, class C>
PlanarStress<T> viscous_stress(const std::array<C, 3>& c, const PlanarStress<T>& rate) {
  return {T(c[0] * rate.n), T(c[1] * rate.q), T(c[2] * rate.c)};
}

/// Derivative of U with respect to u_j (= minus that to u_i) [N] and to the angles of i and j [N
/// m].
template <class T>
struct PlanarGradient {
  Vec2<T> force;
  T moment_i, moment_j;
};

/// Co-rotational strains: strains against axes that turn with the beam.
/// \param d               u_j - u_i [m], world axes
/// \param turn_i, turn_j  angles of the bodies [rad]
template <class T, class C>
PlanarStrains<T> corotational_strains(const PlanarConstants<C>& beam, const Vec2<T>& d,
                                      const T& turn_i, const T& turn_j) {
  using std::sqrt;
  PlanarStrains<T> s;
  const auto [sine, cosine] = sine_cosine(T(0.5 * T(turn_i + turn_j)));
  s.mean = {cosine, sine};
  s.psi = turn_j - turn_i;
  const Vec2<T> stretch = beam.rest.to_local(d);
  const Vec2<T> e{T(beam.l0 + stretch.x), stretch.y};
  s.l = sqrt(T(T(e.x * e.x) + T(e.y * e.y)));
  s.chord = s.mean.to_local(e);
  const T sum = T(s.l + beam.l0);
  const T both = T(1.0 / T(s.l * sum));  // one division for 1/l and 1/(l + l0)
  s.inverse_l = both * sum;
  s.delta = T(T(stretch.x * T(beam.l0 + e.x)) + T(stretch.y * stretch.y)) * T(both * s.l);
  s.gamma = T(beam.l0 * s.inverse_l) * s.chord.y;
  return s;
}

/// Strains linear in displacements and angles. Sets the three strains only.
template <class T, class C>
PlanarStrains<T> linear_strains(const PlanarConstants<C>& beam, const Vec2<T>& d, const T& turn_i,
                                const T& turn_j) {
  PlanarStrains<T> s;
  const Vec2<T> chord = beam.rest.to_local(d);
  s.delta = chord.x;
  s.gamma = chord.y - T((0.5 * beam.l0) * T(turn_i + turn_j));
  s.psi = turn_j - turn_i;
  return s;
}

/// Strain energy U [J].
template <class T, class C>
T beam_energy(const PlanarConstants<C>& beam, const PlanarStrains<T>& s) {
  return T(0.5 *
           (beam.kn * s.delta * s.delta + beam.ks * s.gamma * s.gamma + beam.kb * s.psi * s.psi));
}

/// Section forces of the springs.
template <class T, class C>
PlanarStress<T> elastic_stress(const PlanarConstants<C>& beam, const PlanarStrains<T>& s) {
  return {T(beam.kn * s.delta), T(beam.ks * s.gamma), T(beam.kb * s.psi)};
}

/// Exact gradient B^T stress of the co-rotational strains: the spatial gradient with moments along
/// z, along which tau x P has no component.
template <class T, class C>
PlanarGradient<T> corotational_gradient(const PlanarConstants<C>& beam, const PlanarStrains<T>& s,
                                        const PlanarStress<T>& stress) {
  const T ratio = T(beam.l0 * s.inverse_l);
  const T along =
      T(T(stress.n - T(T(ratio * s.inverse_l) * T(stress.q * s.chord.y))) * s.inverse_l);
  const Vec2<T> n{T(along * s.chord.x), T(T(along * s.chord.y) + T(ratio * stress.q))};
  const T half = 0.5 * T(T(n.x * s.chord.y) - T(n.y * s.chord.x));
  return {beam.rest.to_world(s.mean.to_world(n)), T(half - stress.c), T(half + stress.c)};
}

/// Exact gradient B^T stress of the linear strains.
template <class T, class C>
PlanarGradient<T> linear_gradient(const PlanarConstants<C>& beam, const PlanarStress<T>& stress) {
  const T half = T((-0.5 * beam.l0) * stress.q);
  return {beam.rest.to_world(Vec2<T>{stress.n, stress.q}), T(half - stress.c), T(half + stress.c)};
}

/// Rates B v of the co-rotational strains; the mean triad turns with the mean spin.
/// \param velocity        v_j - v_i [m/s], world axes
/// \param spin_i, spin_j  rates of the angles [rad/s]
template <class T, class C>
PlanarStress<T> corotational_rates(const PlanarConstants<C>& beam, const PlanarStrains<T>& s,
                                   const Vec2<T>& velocity, const T& spin_i, const T& spin_j) {
  const Vec2<T> v = s.mean.to_local(beam.rest.to_local(velocity));
  const T spin = 0.5 * T(spin_i + spin_j);
  const Vec2<T> rate{T(v.x + T(spin * s.chord.y)), T(v.y - T(spin * s.chord.x))};
  const T stretch = T(T(T(s.chord.x * rate.x) + T(s.chord.y * rate.y)) * s.inverse_l);
  return {stretch,
          T(T(beam.l0 * s.inverse_l) * T(rate.y - T(T(s.chord.y * s.inverse_l) * stretch))),
          T(spin_j - spin_i)};
}

/// Rates of the linear strains; parameters as for corotational_rates().
template <class T, class C>
PlanarStress<T> linear_rates(const PlanarConstants<C>& beam, const Vec2<T>& velocity,
                             const T& spin_i, const T& spin_j) {
  const Vec2<T> chord = beam.rest.to_local(velocity);
  return {chord.x, T(chord.y - T((0.5 * beam.l0) * T(spin_i + spin_j))), T(spin_j - spin_i)};
}

/// The kernel for one choice of kinematics, which is made outside the loop over beams.
template <Kinematics kinematics>
struct PlanarKernel {
  static constexpr bool is_linear = kinematics == Kinematics::linear;
  template <class T, class C>
  static PlanarStrains<T> strains(const PlanarConstants<C>& beam, const Vec2<T>& d, const T& turn_i,
                                  const T& turn_j) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_strains(beam, d, turn_i, turn_j);
    } else {
      return corotational_strains(beam, d, turn_i, turn_j);
    }
  }
  template <class T, class C>
  static PlanarGradient<T> gradient(const PlanarConstants<C>& beam, const PlanarStrains<T>& s,
                                    const PlanarStress<T>& stress) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_gradient(beam, stress);
    } else {
      return corotational_gradient(beam, s, stress);
    }
  }
  template <class T, class C>
  static PlanarStress<T> rates(const PlanarConstants<C>& beam, const PlanarStrains<T>& s,
                               const Vec2<T>& velocity, const T& spin_i, const T& spin_j) {
    if constexpr (kinematics == Kinematics::linear) {
      return linear_rates(beam, velocity, spin_i, spin_j);
    } else {
      return corotational_rates(beam, s, velocity, spin_i, spin_j);
    }
  }
};

/// The kernel on planar body records. Parameters i and j of its functions are the records of the
/// two bodies.
template <Kinematics kinematics>
struct PlanarBeam {
  using Space = Planar;
  using Constants = PlanarConstants<double>;
  using Dashpots = std::array<double, 3>;  ///< on Delta, gamma, psi [N s/m, N s/m, N m s]
  using Kernel = PlanarKernel<kinematics>;
  static constexpr int n = Space::unknowns;

  /// Constants of beam m of a part; axis 3 of its section is z.
  static Constants make(const Part& part, std::int32_t m, Shear shear) {
    const auto k = static_cast<std::size_t>(m);
    const auto [i, j] = part.beams.bodies[k];
    const Point3& xi = item(part.bodies.position, i);
    const Point3& xj = item(part.bodies.position, j);
    const double x = xj[0] - xi[0], y = xj[1] - xi[1], inverse = 1.0 / std::sqrt(x * x + y * y);
    const BeamStiffness s = beam_stiffness(part.beams, m, shear);
    return {{inverse * x, inverse * y}, part.beams.length[k], s.kn, s.ksz, s.kbz};
  }
  /// Constants of a beam of unit length without stiffness, to fill up a block.
  static Constants none() { return {{1, 0}, 1, 0, 0, 0}; }
  static double shear_stiffness(const Constants& c) { return c.ks; }

  static PlanarStrains<double> strains(const Constants& c, const double* i, const double* j) {
    return Kernel::strains(c, relative(i, j), i[Space::rotation], j[Space::rotation]);
  }

  static double energy(const Constants& c, const double* i, const double* j) {
    return beam_energy(c, strains(c, i, j));
  }

  static bool is_folded(const Constants& c, const double* i, const double* j) {
    if constexpr (kinematics == Kinematics::linear) return false;
    const PlanarStrains<double> s = strains(c, i, j);
    return !(s.chord.x > folded_cosine * s.l);
  }

  static BeamSection section(const Constants& c, const double* i, const double* j) {
    const PlanarStress<double> s = elastic_stress(c, strains(c, i, j));
    return {s.n, s.q, 0, 0, 0, s.c};
  }

  /// Minus the wrenches of the dashpots, as spatial vectors.
  static BeamGradient<double> damping_force(const Constants& c, const Dashpots& dashpots,
                                            const double* i, const double* j) {
    const PlanarStrains<double> s = strains(c, i, j);
    const PlanarGradient<double> g =
        Kernel::gradient(c, s, viscous_stress(dashpots, rates<double>(c, s, i, j)));
    return {{g.force.x, g.force.y, 0}, {0, 0, g.moment_i}, {0, 0, g.moment_j}};
  }

  /// 6 x 6 damping matrix B^T c B on the velocities (v_i, w_i, v_j, w_j).
  static void damping(const Constants& c, const Dashpots& dashpots, const double* i,
                      const double* j, std::array<double, 4 * n * n>& k) {
    const PlanarStrains<double> s = strains(c, i, j);
    std::array<std::array<double, 3>, 2 * n> b{};
    for (std::size_t a = 0; a < b.size(); ++a) {
      std::array<double, 2 * n> unit{};
      unit[a] = 1;
      const PlanarStress<double> r =
          Kernel::rates(c, s, Vec2<double>{unit[3] - unit[0], unit[4] - unit[1]}, unit[2], unit[5]);
      b[a] = {r.n, r.q, r.c};
    }
    for (std::size_t row = 0; row < b.size(); ++row) {
      for (std::size_t col = 0; col < b.size(); ++col) {
        k[row * b.size() + col] = 0;
        for (std::size_t m = 0; m < 3; ++m)
          k[row * b.size() + col] += dashpots[m] * b[row][m] * b[col][m];
      }
    }
  }

  /// 6 x 6 tangent on (u_i, theta_i, u_j, theta_j), by forward differentiation of the gradient in
  /// four directions: the relative displacement and the two angles. K and H are the same here.
  /// \param dashpots  if not null, includes the derivative of their force to the displacements
  static void tangent(const Constants& c, const Dashpots* dashpots, const double* i,
                      const double* j, bool /*symmetric*/, std::array<double, 4 * n * n>& k) {
    using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 4, 1>>;
    const Vec2<double> d0 = relative(i, j);
    const Vec2<Dual> d{Dual(d0.x, 4, 0), Dual(d0.y, 4, 1)};
    const Dual turn_i(i[Space::rotation], 4, 2), turn_j(j[Space::rotation], 4, 3);
    const PlanarStrains<Dual> s = Kernel::strains(c, d, turn_i, turn_j);
    PlanarStress<Dual> stress = elastic_stress(c, s);
    if (dashpots != nullptr) stress = stress + viscous_stress(*dashpots, rates<Dual>(c, s, i, j));
    const PlanarGradient<Dual> g = Kernel::gradient(c, s, stress);
    const auto put = [&](std::size_t row, const Dual& value, double sign) {
      const auto& by = value.derivatives();
      // u_i enters through d = u_j - u_i only.
      const std::array<double, 2 * n> entries{-by[0], -by[1], by[2], by[0], by[1], by[3]};
      for (std::size_t column = 0; column < entries.size(); ++column)
        k[row * 2 * n + column] = sign * entries[column];
    };
    put(0, g.force.x, -1), put(1, g.force.y, -1), put(2, g.moment_i, 1);
    put(3, g.force.x, 1), put(4, g.force.y, 1), put(5, g.moment_j, 1);
  }

 private:
  static Vec2<double> relative(const double* i, const double* j) {
    return {j[0] - i[0], j[1] - i[1]};
  }
  /// Strain rates at the velocities of the bodies.
  template <class T>
  static PlanarStress<T> rates(const Constants& c, const PlanarStrains<T>& s, const double* i,
                               const double* j) {
    const double *v = i + Space::velocity, *w = j + Space::velocity;
    return Kernel::rates(c, s, Vec2<T>{T(w[0] - v[0]), T(w[1] - v[1])}, T(v[2]), T(w[2]));
  }
};

}  // namespace floe
