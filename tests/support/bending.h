/// \file
/// A floating sheet under a point load against the infinite plate (model.md, "Bending on water";
/// paper, "Bending of an Ice Sheet").
#pragma once

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "floe/beams/moduli.h"
#include "support/static_solution.h"

namespace floe::test {

inline constexpr double point_load = 1e4;  ///< [N], downwards

/// A sheet on water, nothing prescribed, with a point load at the plan's centre that comes after
/// time 0.
inline Scene bending_scene(double length, double thickness, double element_size,
                           std::uint64_t seed = 1) {
  Scene scene;
  scene.has_sheet = true;
  scene.sheet = {length, length, element_size, seed, Relaxation::lloyd, 150, 0};
  scene.thickness = thickness;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = true;
  Load centre;
  centre.name = "centre";
  centre.point = Point2{0, 0};
  centre.force = {0, 0, -point_load};
  centre.ramp.seconds = 1;
  scene.loads = {centre};
  return scene;
}

/// Infinite plate of bending stiffness D on water under a point load P: characteristic length l_c =
/// (D/k)^(1/4), k = rho_w g, deflection w0 = P/(8 k l_c^2) under the load.
struct Wyman {
  double characteristic, centre;

  Wyman(const Scene& scene, double plate_stiffness) {
    const double k = scene.water_density * scene.gravity;
    characteristic = std::pow(plate_stiffness / k, 0.25);
    centre = point_load / (8 * k * characteristic * characteristic);
  }
  /// Of the material that the sheet's beams are made of.
  static Wyman of_material(const Scene& scene) {
    const double h = scene.thickness, nu = scene.ice.poisson;
    return {scene, scene.ice.young * h * h * h / (12 * (1 - nu * nu))};
  }
  /// Of the plate that the infinite regular lattice is.
  static Wyman of_lattice(const Scene& scene) {
    const LatticeModuli moduli =
        lattice_moduli(scene.sheet.element_size, scene.thickness, scene.ice, scene.shear_factor,
                       scene.beam.shear, scene.torsion);
    const double h = scene.thickness, nu = scene.ice.poisson;
    return {scene, moduli.bending * scene.ice.young * h * h * h / (12 * (1 - nu * nu))};
  }
  double at(double r) const;  ///< deflection at distance r from the load [m]
};

/// w/w0 = -(4/pi) kei(x), x = r/l_c. kei x = Im K0(x exp(i pi/4)), K0(z) = int_0^inf exp(-z cosh t)
/// dt: the trapezoid rule converges faster than any power on this integrand (it and its derivatives
/// vanish at both ends).
inline double wyman_profile(double x) {
  constexpr double step = 1e-3;
  const double s = x / std::numbers::sqrt2;
  double kei = -0.5 * std::exp(-s) * std::sin(s);
  for (double t = step;; t += step) {
    const double c = s * std::cosh(t);
    if (c > 45) break;
    kei -= std::exp(-c) * std::sin(c);
  }
  return -4 / std::numbers::pi * kei * step;
}

inline double Wyman::at(double r) const { return centre * wyman_profile(r / characteristic); }

inline double deflection_under_load(const StaticSolution& s) {
  return displacement_of_load(s, s.first()).z - displacement_of_load(s, s.last()).z;
}

/// Along X = 0, 0 <= Y <= L/2: bodies with their centroid within l/2 of it, each against the plate
/// at its own distance from the load; the largest difference over w0.
struct Departure {
  double largest = 0;
  int points = 0;
};
inline Departure profile_departure(const Wyman& plate, const Lattice& lattice, const Scene& scene,
                                   const StaticSolution& s) {
  Departure d;
  for (std::size_t b = 0; b < lattice.bodies.position.size(); ++b) {
    const auto& [x, y, z] = lattice.bodies.position[b];
    if (std::abs(x) > scene.sheet.element_size / 2 || y < 0) continue;
    const double w = displacement(s.first(), b).z - displacement(s.last(), b).z;
    d.largest = std::max(d.largest, std::abs(w - plate.at(std::hypot(x, y))) / plate.centre);
    ++d.points;
  }
  return d;
}

}  // namespace floe::test
