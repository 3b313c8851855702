#include "floe/beams/calibration.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "beams/beam_force.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

/// The x > 0 at which an increasing function takes a value, by bisection. About 1e-9 if the
/// function is above the value there already.
double solve(const auto& increasing, double value) {
  double low = 1e-9, high = 1;
  while (increasing(high) < value) high *= 2;
  for (int k = 0; k < 100 && high - low > 1e-15 * high; ++k) {
    const double middle = (low + high) / 2;
    (increasing(middle) < value ? low : high) = middle;
  }
  return high;
}

/// Per beam: whether its facet ends on the edge of the sheet, that is, whether both bodies lie on
/// one side of the sheet.
std::vector<std::uint8_t> edge_beams(const Lattice& lattice) {
  std::vector<std::uint8_t> at_edge(lattice.beams.bodies.size(), 0);
  for (const char* side : {"left", "right", "bottom", "top"}) {
    std::vector<std::uint8_t> on_side(lattice.bodies.position.size(), 0);
    for (const std::int32_t body : lattice.sets.at(side)) item(on_side, body) = 1;
    for (std::size_t m = 0; m < at_edge.size(); ++m) {
      const auto [i, j] = lattice.beams.bodies[m];
      at_edge[m] |= item(on_side, i) & item(on_side, j);
    }
  }
  return at_edge;
}

/// exp(4i phi) of a beam's direction phi in the plan.
std::complex<double> fourfold(const Lattice& lattice, std::size_t m) {
  const Point3 way = chord(lattice.bodies, lattice.beams, static_cast<std::int32_t>(m));
  const std::complex<double> along(way[0], way[1]), square = along * along;
  return square * square / std::norm(square);
}

/// Gives a sheet the E, nu, D and nu_b of its ice. K and D(1 + nu) of the plate need k_n and k_by
/// times 1/(1 - nu), whatever the cells; G and D(1 - nu) then determine r and g.
void make_isotropic(Lattice& lattice, const Ice& ice, Calibration& c) {
  const double nu = ice.poisson;
  c.scale = 1 / (1 - nu);
  c.ratios.transverse /= c.scale;                  // k_sy stays
  const double shape = (1 - nu) / (2 * (1 + nu));  // G/(E_b scale) and D(1-nu) 12/(2 E_b h^3 scale)
  const double chi = c.ratios.irregularity;
  c.ratios.shear =
      solve([&](double r) { return in_plane_stiffness(r, chi, Shear::one_point); }, shape);
  c.ratios.torsion =
      solve([&](double g) { return twist_stiffness(g, c.ratios.transverse, chi); }, shape);

  // The directions of the beams are not quite evenly distributed. The part of the affine stiffness
  // k_n n n n n + k_s t n t n that turns four times has the factor k_n - k_s, so a k_s that varies
  // with the direction removes it; k_t likewise.
  const auto evened = [&](double ratio) {
    const std::complex<double> amplitude = 2 * (1 - ratio) * std::conj(c.ratios.texture);
    const double most = 0.9 * ratio;  // keeps all stiffnesses positive
    return amplitude * std::min(1.0, most / std::max(std::abs(amplitude), most));
  };
  const std::complex<double> shear_wave = evened(c.ratios.shear),
                             torsion_wave = evened(c.ratios.torsion);

  // An isotropic plate contracts freely at a free edge. The facets there are wider than inside and
  // would make the edge too stiff, so its beams are softened (measured).
  const double edge = 1 - 0.6 * nu;
  const std::vector<std::uint8_t> at_edge = edge_beams(lattice);
  Beams& b = lattice.beams;
  b.shear_factor_y.resize(at_edge.size());
  for (std::size_t m = 0; m < at_edge.size(); ++m) {
    b.young[m] *= c.scale * (at_edge[m] ? edge : 1.0);
    const std::complex<double> around = fourfold(lattice, m);
    const double r = c.ratios.shear + (shear_wave * around).real(),
                 g = c.ratios.torsion + (torsion_wave * around).real();
    b.shear_factor_y[m] = r * b.young[m] / b.shear_modulus[m];
    b.torsion[m] = g * b.young[m] * b.inertia_y[m] / b.shear_modulus[m];
  }
}

void scale_moduli(Beams& beams, double scale) {
  for (double& young : beams.young) young *= scale;
  for (double& shear_modulus : beams.shear_modulus) shear_modulus *= scale;
}

}  // namespace

Calibration calibrate(Lattice& lattice, const Ice& ice, Calibrate kind, Shear shear) {
  Calibration c;
  c.ratios = lattice_ratios(lattice, shear);
  if (!std::isfinite(c.ratios.irregularity))
    throw InputError("beam: calibrate: a sheet of " + std::to_string(lattice.bodies.size()) +
                     " bodies, all of them on its sides, is too small for it");
  if (kind == Calibrate::isotropic) {
    make_isotropic(lattice, ice, c);
  } else {
    c.scale = 1 / lattice_moduli(c.ratios, ice.poisson, shear).young;
    scale_moduli(lattice.beams, c.scale);
  }
  c.moduli = lattice_moduli(c.ratios, ice.poisson, shear);
  c.moduli.young *= c.scale, c.moduli.shear *= c.scale;
  c.moduli.bulk *= c.scale, c.moduli.bending *= c.scale;
  // Measured on sheets of 462 to 7391 bodies, from 5 Lloyd iterations to 150 of quasi_newton.
  const double formula = 0.001 * (1 + std::pow(c.ratios.irregularity / 0.15, 2));
  const double bodies = lattice.bodies.size();
  const auto scatter = [&](double of_one) {
    return std::hypot(formula, of_one / std::sqrt(bodies));
  };
  c.scatter = {scatter(0.055), scatter(0.04), scatter(0.04), scatter(0.03)};
  return c;
}

}  // namespace floe
