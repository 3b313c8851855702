#include "floe/beams/moduli.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "beams/beam_force.h"
#include "floe/base/item.h"

namespace floe {
namespace {

/// Per body: 1 unless it is in the set of a side of the sheet.
std::vector<std::uint8_t> inner_bodies(const Lattice& lattice) {
  std::vector<std::uint8_t> inner(lattice.bodies.position.size(), 1);
  for (const char* side : {"left", "right", "bottom", "top"}) {
    const auto set = lattice.sets.find(side);
    if (set == lattice.sets.end()) continue;
    for (const std::int32_t body : set->second) item(inner, body) = 0;
  }
  return inner;
}

/// X, to which the corrections are proportional: relaxation saturates a little in very irregular
/// cells (measured; model.md, "Effective moduli of the lattice, calibrated sheets").
double saturated(double irregularity) { return irregularity / (1 + 0.6 * irregularity); }

}  // namespace

LatticeRatios lattice_ratios(const Lattice& lattice, Shear shear) {
  const std::vector<std::uint8_t> inner = inner_bodies(lattice);
  // Per body, from sums over its facets with the normal at phi: T = sum w exp(3i phi),
  // S = sum w/l, and the plan area sum w l/4. All are times h, which cancels.
  std::vector<std::complex<double>> unbalanced(inner.size());
  std::vector<double> stiffness(inner.size()), plan(inner.size());
  double axial = 0, sliding = 0, bending = 0, bending_l2 = 0, twisting_l2 = 0, transverse_l2 = 0;
  std::complex<double> fourth = 0;
  const Beams& beams = lattice.beams;
  for (std::int32_t m = 0; m < beams.size(); ++m) {
    const auto k = static_cast<std::size_t>(m);
    const auto i = static_cast<std::size_t>(beams.bodies[k][0]),
               j = static_cast<std::size_t>(beams.bodies[k][1]);
    const double l = beams.length[k], section = beams.area[k];
    const Point3 way = chord(lattice.bodies, beams, m);
    const std::complex<double> normal(way[0] / l, way[1] / l);
    const std::complex<double> square = normal * normal, third = section * square * normal;
    unbalanced[i] += third, unbalanced[j] -= third;
    for (const std::size_t body : {i, j})
      stiffness[body] += section / l, plan[body] += section * l / 4;

    const double share = inner[i] + inner[j];
    const BeamStiffness s = beam_stiffness(beams, m, shear);
    axial += share * s.kn * l * l, sliding += share * s.ksz * l * l;
    fourth += share * s.kn * l * l * square * square;
    bending += share * s.kby, bending_l2 += share * s.kby * l * l;
    twisting_l2 += share * s.kt * l * l, transverse_l2 += share * s.ksy * l * l;
  }
  double relaxing = 0, area = 0;
  for (std::size_t body = 0; body < inner.size(); ++body) {
    if (!inner[body]) continue;
    relaxing += std::norm(unbalanced[body]) / stiffness[body];
    area += plan[body];
  }
  return {sliding / axial, twisting_l2 / bending_l2, transverse_l2 / (4 * bending), relaxing / area,
          fourth / axial};
}

double in_plane_stiffness(double r, double irregularity, Shear shear) {
  const double chi = saturated(irregularity);
  const double equal = (0.229 - 0.527 * r + 0.370 * r * r) / (1 + 1.18 * r);
  switch (shear) {
    case Shear::one_point:
      return (1 + r) / 4 - chi * equal;
    case Shear::exact:  // k_s/k_n is less where facets are narrow
      return (1 + r) / 4 - chi * 0.77 * equal;
    case Shear::none:  // k_s/k_n = (w/l)^2, whatever the material
      return (1 + r) / 4 - chi * 0.124;
  }
  return (1 + r) / 4;
}

double twist_stiffness(double g, double transverse, double irregularity) {
  return (1 + g) / 4 - saturated(irregularity) * (1 - g) * (1 - g) /
                           (2.9 + 7.6 * std::cbrt(transverse) + 5.3 * g);
}

LatticeModuli lattice_moduli(const LatticeRatios& ratios, double poisson, Shear shear) {
  const double g = in_plane_stiffness(ratios.shear, ratios.irregularity, shear);
  const double s = twist_stiffness(ratios.torsion, ratios.transverse, ratios.irregularity);
  constexpr double k = 0.5;  // both K*/E_b and D*(1 + nu_b*) 12/(2 E_b h^3)
  return {4 * k * g / (k + g), (k - g) / (k + g), g, k, (k + s) * (1 - poisson * poisson),
          (k - s) / (k + s)};
}

LatticeModuli lattice_moduli(double size, double thickness, const Ice& ice, double shear_factor,
                             Shear shear, Torsion torsion) {
  const double w = size / std::sqrt(3.0), h = thickness;
  const double iy = w * h * h * h / 12.0, iz = h * w * w * w / 12.0;
  Beams one;  // all beams of the regular lattice are alike
  one.bodies = {{0, 1}};
  one.area = {w * h};
  one.inertia_y = {iy};
  one.inertia_z = {iz};
  one.torsion = {torsion == Torsion::polar ? iy + iz : saint_venant_torsion(w, h)};
  one.length = {size};
  one.young = {ice.young};
  one.shear_modulus = {ice.young / (2.0 * (1.0 + ice.poisson))};
  one.shear_factor = {shear_factor};
  const BeamStiffness k = beam_stiffness(one, 0, shear);
  return lattice_moduli({k.ksz / k.kn, k.kt / k.kby, k.ksy * size * size / (4 * k.kby), 0, 0},
                        ice.poisson, shear);
}

}  // namespace floe
