/// \file
/// Effective constants of a lattice: its outermost bodies are given the motion of a uniform strain
/// or curvature, and mean stresses and strains are taken over bodies inside (model.md, "Effective
/// moduli of the lattice, calibrated sheets").
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "support/static_solution.h"

namespace floe::test {

/// A motion of the plane as displacement and rotation at (x, y).
using Motion = std::function<std::array<double, 6>(double x, double y)>;

/// A symmetric 2 x 2 tensor as (xx, yy, xy).
using Tensor = std::array<double, 3>;

/// In the plane, u = e.x.
inline Motion stretching(const Tensor& e) {
  return [e](double x, double y) {
    return std::array<double, 6>{e[0] * x + e[2] * y, e[2] * x + e[1] * y, 0, 0, 0, 0};
  };
}

/// Out of the plane with curvature c = -grad grad w; rotations follow the slope.
inline Motion bending(const Tensor& c) {
  return [c](double x, double y) {
    const double w_x = -(c[0] * x + c[2] * y), w_y = -(c[2] * x + c[1] * y);
    return std::array<double, 6>{0, 0, (w_x * x + w_y * y) / 2, w_y, -w_x, 0};
  };
}

inline constexpr std::array<bool, 6> all_fixed{true, true, true, true, true, true};

/// Gives each body of the set `rim` the motion that its place has; components not in `fixed` stay
/// free. Each of these bodies has a set rimN of its own.
inline std::vector<Boundary> rim_moves(const Lattice& lattice, const Motion& motion,
                                       const std::array<bool, 6>& fixed) {
  std::vector<Boundary> boundaries;
  for (const std::int32_t body : lattice.sets.at("rim")) {
    const Point3& x = lattice.bodies.position[static_cast<std::size_t>(body)];
    const std::array<double, 6> m = motion(x[0], x[1]);
    Boundary b;
    b.name = b.set = "rim" + std::to_string(body);
    b.fixed = fixed;
    b.velocity = Point3{m[0], m[1], m[2]};  // over one second
    b.angular_velocity = {m[3], m[4], m[5]};
    boundaries.push_back(b);
  }
  return boundaries;
}

/// Makes the bodies on a sheet's four sides its rim.
inline void add_rim(Lattice& sheet) {
  auto& rim = sheet.sets["rim"];
  for (const char* side : {"left", "right", "bottom", "top"})
    rim.insert(rim.end(), sheet.sets.at(side).begin(), sheet.sets.at(side).end());
  std::sort(rim.begin(), rim.end());
  rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
  for (const std::int32_t body : rim) sheet.sets["rim" + std::to_string(body)] = {body};
}

/// Bodies to take means over, and the area of their cells [m^2].
struct Window {
  std::vector<double> inside;  ///< per body of the lattice: 1 or 0
  double area = 0;
};

inline Window one_body(const Lattice& lattice, std::int32_t body, double cell) {
  Window w{std::vector<double>(lattice.bodies.position.size(), 0.0), cell};
  w.inside[static_cast<std::size_t>(body)] = 1;
  return w;
}

/// Bodies further than `margin` from the sides of a sheet of this plan.
inline Window inner_window(const Lattice& lattice, const Scene& scene, double margin) {
  Window w;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const Point3& x = lattice.bodies.position[b];
    const bool inside = std::abs(x[0]) < scene.sheet.length / 2 - margin &&
                        std::abs(x[1]) < scene.sheet.width / 2 - margin;
    w.inside.push_back(inside ? 1 : 0);
    if (inside) w.area += lattice.bodies.mass[b] / (scene.ice.density * scene.thickness);
  }
  return w;
}

/// What beams carry on average over the cells of a window, per unit length of the sheet: membrane
/// forces [N/m], bending moments [N], transverse forces [N/m]. Half of each beam belongs to each
/// cell.
struct Resultants {
  Tensor membrane{}, moment{};
  std::array<double, 2> transverse{};
};

inline Resultants resultants(const Lattice& lattice, const StaticSolution& s,
                             const Window& window) {
  Resultants r;
  const Beams& beams = lattice.beams;
  const std::vector<BeamSection> sections = s.model->beams()->sections(s.last());
  for (std::size_t m = 0; m < sections.size(); ++m) {
    const auto i = static_cast<std::size_t>(beams.bodies[m][0]),
               j = static_cast<std::size_t>(beams.bodies[m][1]);
    const double half_beams = window.inside[i] + window.inside[j];
    if (half_beams == 0) continue;
    const Point3 &p = lattice.bodies.position[i], &q = lattice.bodies.position[j];
    const double l = beams.length[m], share = half_beams * l / (2 * window.area);
    const std::array<double, 2> n{(q[0] - p[0]) / l, (q[1] - p[1]) / l}, across{-n[1], n[0]};
    const auto [axial, in_plane, out_of_plane, torque, moment, in_plane_bending] = sections[m];
    // Force (N, Q) and the strain along the beam do work N n.eps.n + Q across.eps.n on it; moments
    // M_2 and T likewise with the curvature kappa = -grad grad w: relative rotations of its ends
    // are l n.kappa.n and -l n.kappa.across.
    const auto add = [&](Tensor& sum, double along, double mixed) {
      sum[0] += share * (along * n[0] * n[0] + mixed * n[0] * across[0]);
      sum[1] += share * (along * n[1] * n[1] + mixed * n[1] * across[1]);
      sum[2] += share * (along * n[0] * n[1] + mixed * 0.5 * (n[0] * across[1] + n[1] * across[0]));
    };
    add(r.membrane, axial, in_plane);
    add(r.moment, moment, -torque);
    for (std::size_t k = 0; k < 2; ++k) r.transverse[k] += share * out_of_plane * n[k];
  }
  return r;
}

/// Mean gradient, symmetric part, of a vector field over a window's cells, from the means of the
/// field's values on the two sides of each facet (Gauss). \param field  two components per body
inline Tensor mean_gradient(const Lattice& lattice, const Window& window,
                            const std::vector<std::array<double, 2>>& field) {
  Tensor mean{};
  const Beams& beams = lattice.beams;
  for (std::size_t m = 0; m < beams.bodies.size(); ++m) {
    const auto i = static_cast<std::size_t>(beams.bodies[m][0]),
               j = static_cast<std::size_t>(beams.bodies[m][1]);
    const double outward = window.inside[i] - window.inside[j];
    if (outward == 0) continue;
    const Point3 &p = lattice.bodies.position[i], &q = lattice.bodies.position[j];
    const double share = outward * beams.width[m] / (beams.length[m] * window.area);
    const std::array<double, 2> n{share * (q[0] - p[0]), share * (q[1] - p[1])},
        v{(field[i][0] + field[j][0]) / 2, (field[i][1] + field[j][1]) / 2};
    mean[0] += n[0] * v[0], mean[1] += n[1] * v[1], mean[2] += 0.5 * (n[0] * v[1] + n[1] * v[0]);
  }
  return mean;
}

/// A response (xx, yy, xy) to each of three unit strains or curvatures (xx, yy, xy), column by
/// column.
using Response = std::array<Tensor, 3>;

/// The response to uniform mean strains, from three states with whatever mean strains they have.
inline Response per_strain(const Response& response, const Response& strain) {
  Eigen::Matrix3d r, e;
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) {
      r(c, k) = response[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)];
      e(c, k) = strain[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)];
    }
  }
  r *= e.inverse();
  Response out;
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c)
      out[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)] = r(c, k);
  }
  return out;
}

/// Constants of the isotropic response nearest to a measured one, from its two invariants: half the
/// sum and half the difference of C_xx,xx and C_xx,yy; and the largest difference of any entry,
/// over C_xx,xx.
struct Isotropic {
  double bulk, shape, departure;
  double direct() const { return bulk + shape; }
  double poisson() const { return (bulk - shape) / (bulk + shape); }
  double young() const { return 4 * bulk * shape / (bulk + shape); }
};
inline Isotropic isotropic(const Response& c) {
  Isotropic i{};
  i.bulk = (c[0][0] + c[1][1] + c[0][1] + c[1][0]) / 4;
  i.shape = ((c[0][0] + c[1][1] - c[0][1] - c[1][0]) / 4 + c[2][2] / 2) / 2;
  const double direct = i.bulk + i.shape, cross = i.bulk - i.shape;
  const Response exact{{{direct, cross, 0}, {cross, direct, 0}, {0, 0, 2 * i.shape}}};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t m = 0; m < 3; ++m)
      i.departure = std::max(i.departure, std::abs(c[k][m] - exact[k][m]) / direct);
  }
  return i;
}

/// Response of a sheet's inside per unit strain [N/m] or curvature [N m], from three linear static
/// solutions. \param sheet  with a rim (add_rim)
inline Response homogenise(Scene scene, const Lattice& sheet, const Window& window, bool in_plane) {
  scene.beam.kinematics = Kinematics::linear;
  Response response, strain;
  for (std::size_t k = 0; k < 3; ++k) {
    Tensor unit{};
    unit[k] = 1e-6;
    scene.boundaries = rim_moves(sheet, in_plane ? stretching(unit) : bending(unit), all_fixed);
    const StaticSolution s = solve_static(scene, sheet);
    if (!s.result.done) return {};
    const Resultants r = resultants(sheet, s, window);
    response[k] = in_plane ? r.membrane : r.moment;
    std::vector<std::array<double, 2>> field;
    for (std::size_t b = 0; b < sheet.bodies.position.size(); ++b) {
      const Vec3<double> u = displacement(s.last(), b), turn = log_rotation(rotation(s.last(), b));
      // -grad w follows the rotations.
      field.push_back(in_plane ? std::array{u.x, u.y} : std::array{turn.y, -turn.x});
    }
    strain[k] = mean_gradient(sheet, window, field);
  }
  return per_strain(response, strain);
}

}  // namespace floe::test
