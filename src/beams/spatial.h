/// \file
/// The beam kernel on spatial body records: gradient, energy, section forces, tangent.
#pragma once

#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>

#include <algorithm>
#include <array>

#include "beams/beam_force.h"
#include "beams/kernel.h"
#include "floe/base/item.h"
#include "floe/lattice/state.h"

namespace floe {

/// The kernel on spatial body records. Parameters i and j of its functions are the records of the
/// two bodies.
/// \tparam Frame  AnyFrame or EccentricFrame
template <Kinematics kinematics, template <class> class Frame = AnyFrame>
struct SpatialBeam {
  using Space = Spatial;
  using Constants = BeamConstants<double, Frame>;
  using Dashpots = BeamDashpots;
  using Kernel = BeamKernel<kinematics>;
  static constexpr int n = Space::unknowns;

  /// Constants of beam m of a part.
  static Constants make(const Part& part, std::int32_t m, Shear shear) {
    Constants c{};
    const auto [e1, e2, e3] = beam_triad(part.bodies, part.beams, m);
    c.rest.e1 = e1, c.rest.e2 = e2, c.rest.e3 = e3;
    if constexpr (Kernel::template is_eccentric<Constants>) {
      c.rest.offset_i = offset(part.beams, m, 0);
      c.rest.offset_j = offset(part.beams, m, 1);
    }
    c.l0 = item(part.beams.length, m);
    const BeamStiffness s = beam_stiffness(part.beams, m, shear);
    c.kn = s.kn, c.ksz = s.ksz, c.ksy = s.ksy, c.kt = s.kt, c.kby = s.kby, c.kbz = s.kbz;
    return c;
  }
  /// Constants of a beam of unit length without stiffness, to fill up a block.
  static Constants none() {
    Constants c{};
    c.rest.e1 = {1, 0, 0}, c.rest.e2 = {0, 1, 0}, c.rest.e3 = {0, 0, 1};
    c.l0 = 1;
    return c;
  }
  /// The larger of the two shear stiffnesses [N/m].
  static double shear_stiffness(const Constants& c) { return std::max(c.ksy, c.ksz); }

  static BeamStrains<double> strains(const Constants& c, const double* i, const double* j) {
    return Kernel::strains(c, relative(i, j), rotation_of(i), rotation_of(j));
  }

  static double energy(const Constants& c, const double* i, const double* j) {
    return beam_energy(c, strains(c, i, j));
  }

  static bool is_folded(const Constants& c, const double* i, const double* j) {
    if constexpr (kinematics == Kinematics::linear) return false;
    const BeamStrains<double> s = strains(c, i, j);
    return !(s.chord.x > folded_cosine * s.l);
  }

  static BeamSection section(const Constants& c, const double* i, const double* j) {
    const BeamStrains<double> s = strains(c, i, j);
    return {c.kn * s.delta, c.ksz * s.gamma_y, c.ksy * s.gamma_z,
            c.kt * s.psi.x, c.kby * s.psi.y,   c.kbz * s.psi.z};
  }

  /// Minus the wrenches of the dashpots.
  static BeamGradient<double> damping_force(const Constants& c, const BeamDashpots& dashpots,
                                            const double* i, const double* j) {
    const BeamStrains<double> s = strains(c, i, j);
    return Kernel::gradient(c, s, viscous_stress(dashpots, rates<double>(c, s, i, j)));
  }

  /// 12 x 12 damping matrix B^T c B on the velocities (v_i, w_i, v_j, w_j). The columns of B are
  /// the strain rates of a unit velocity of j relative to i and of unit spins.
  static void damping(const Constants& c, const BeamDashpots& dashpots, const double* i,
                      const double* j, std::array<double, 4 * n * n>& k) {
    const BeamStrains<double> s = strains(c, i, j);
    std::array<std::array<double, 6>, 9> b{};
    for (std::size_t a = 0; a < 9; ++a) {
      std::array<Vec3<double>, 3> unit{};
      (a % 3 == 0 ? unit[a / 3].x : a % 3 == 1 ? unit[a / 3].y : unit[a / 3].z) = 1;
      const BeamStress<double> r = Kernel::rates(c, s, unit[0], unit[1], unit[2]);
      b[a] = {r.n, r.qy, r.qz, r.c.x, r.c.y, r.c.z};
    }
    // Column of B that belongs to an unknown, and its sign.
    constexpr std::array<std::size_t, 12> column{0, 1, 2, 3, 4, 5, 0, 1, 2, 6, 7, 8};
    const auto sign = [](std::size_t unknown) { return unknown < 3 ? -1.0 : 1.0; };
    for (std::size_t row = 0; row < 12; ++row) {
      for (std::size_t col = 0; col < 12; ++col) {
        double sum = 0;
        for (std::size_t m = 0; m < 6; ++m)
          sum += dashpots[m] * b[column[row]][m] * b[column[col]][m];
        k[row * 12 + col] = sign(row) * sign(col) * sum;
      }
    }
  }

  /// 12 x 12 tangent on (u_i, theta_i, u_j, theta_j), by forward differentiation of the gradient in
  /// nine directions: the relative displacement and the two spins.
  /// \param dashpots   if not null, includes the derivative of their force to the displacements
  /// \param symmetric  H = K + skew(m)/2 instead of K
  ///
  /// The attribute flatten inlines Eigen's loops over nine derivatives: without it the assembly of
  /// input/bending.yaml at 320 m takes 2.5 times as long.
  [[gnu::flatten]] static void tangent(const Constants& c, const BeamDashpots* dashpots,
                                       const double* i, const double* j, bool symmetric,
                                       std::array<double, 4 * n * n>& k) {
    using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 9, 1>>;
    const Vec3<double> d0 = relative(i, j);
    const Vec3<Dual> d{Dual(d0.x, 9, 0), Dual(d0.y, 9, 1), Dual(d0.z, 9, 2)};
    const BeamStrains<Dual> s =
        Kernel::strains(c, d, spun<Dual>(rotation_of(i), 3), spun<Dual>(rotation_of(j), 6));
    BeamStress<Dual> stress = elastic_stress(c, s);
    if (dashpots != nullptr) stress = stress + viscous_stress(*dashpots, rates<Dual>(c, s, i, j));
    const BeamGradient<Dual> g = Kernel::gradient(c, s, stress);
    k.fill(0);
    const std::array<const Dual*, 3> force{&g.force.x, &g.force.y, &g.force.z};
    const std::array<const Dual*, 3> mi{&g.moment_i.x, &g.moment_i.y, &g.moment_i.z};
    const std::array<const Dual*, 3> mj{&g.moment_j.x, &g.moment_j.y, &g.moment_j.z};
    const auto put = [&](int row, const Dual& value, double sign) {
      for (int a = 0; a < 3; ++a) {
        const auto at = [&](int column) -> double& { return item(k, row * 2 * n + column); };
        const auto& by = value.derivatives();
        at(a) = -sign * by[a];  // u_i enters through d = u_j - u_i only
        at(3 + a) = sign * by[3 + a];
        at(6 + a) = sign * by[a];
        at(9 + a) = sign * by[6 + a];
      }
    };
    for (int a = 0; a < 3; ++a) {
      const auto b = static_cast<std::size_t>(a);
      put(a, *force[b], -1);
      put(3 + a, *mi[b], 1);
      put(6 + a, *force[b], 1);
      put(9 + a, *mj[b], 1);
    }
    if (symmetric && kinematics == Kinematics::corotational) {
      add_half_skew(k, 3, {g.moment_i.x.value(), g.moment_i.y.value(), g.moment_i.z.value()});
      add_half_skew(k, 9, {g.moment_j.x.value(), g.moment_j.y.value(), g.moment_j.z.value()});
    }
  }

 private:
  static Vec3<double> relative(const double* i, const double* j) {
    return {j[0] - i[0], j[1] - i[1], j[2] - i[2]};
  }
  template <class T>
  static Vec3<T> vector_at(const double* r, int offset) {
    return {T(r[offset]), T(r[offset + 1]), T(r[offset + 2])};
  }
  /// Strain rates at the velocities of the bodies.
  template <class T>
  static BeamStress<T> rates(const Constants& c, const BeamStrains<T>& s, const double* i,
                             const double* j) {
    return Kernel::rates(c, s, vector_at<T>(j, Space::velocity) - vector_at<T>(i, Space::velocity),
                         vector_at<T>(i, Space::angular_velocity),
                         vector_at<T>(j, Space::angular_velocity));
  }
  static Quat<double> rotation_of(const double* r) {
    return {r[Space::rotation], r[Space::rotation + 1], r[Space::rotation + 2],
            r[Space::rotation + 3]};
  }

  /// A rotation with its derivatives to the three components of a spin: dq = (0, spin) q/2, or
  /// (0, spin)/2 in linear kinematics.
  template <class Dual>
  static Quat<Dual> spun(const Quat<double>& q, int first) {
    Quat<Dual> out{Dual(q.w), Dual(q.x), Dual(q.y), Dual(q.z)};
    for (int a = 0; a < 3; ++a) {
      const Quat<double> spin{0, a == 0 ? 0.5 : 0, a == 1 ? 0.5 : 0, a == 2 ? 0.5 : 0};
      const Quat<double> dq = kinematics == Kinematics::linear ? spin : product(spin, q);
      const int at = first + a;
      out.w.derivatives()[at] = dq.w;
      out.x.derivatives()[at] = dq.x;
      out.y.derivatives()[at] = dq.y;
      out.z.derivatives()[at] = dq.z;
    }
    return out;
  }

  static void add_half_skew(std::array<double, 4 * n * n>& k, int at, const Vec3<double>& m) {
    const auto entry = [&](int row, int column) -> double& {
      return item(k, (at + row) * 2 * n + at + column);
    };
    entry(0, 1) -= 0.5 * m.z, entry(1, 0) += 0.5 * m.z;
    entry(0, 2) += 0.5 * m.y, entry(2, 0) -= 0.5 * m.y;
    entry(1, 2) -= 0.5 * m.x, entry(2, 1) += 0.5 * m.x;
  }
};

}  // namespace floe
