#include "floe/forces/moduli.h"

#include <cmath>

namespace floe {

LatticeModuli lattice_moduli(double size, double thickness, const Ice& ice, double shear_factor,
                             Shear shear, Torsion torsion) {
  const double w = size / std::sqrt(3.0), h = thickness;
  const double shear_modulus = ice.young / (2.0 * (1.0 + ice.poisson));
  const double iy = w * h * h * h / 12.0, iz = h * w * w * w / 12.0;
  Beams one;  // the lattice's only kind of beam
  one.bodies = {{0, 1}};
  one.area = {w * h};
  one.inertia_y = {iy};
  one.inertia_z = {iz};
  one.torsion = {torsion == Torsion::polar ? iy + iz : saint_venant_torsion(w, h)};
  one.length = {size};
  one.young = {ice.young};
  one.shear_modulus = {shear_modulus};
  one.shear_factor = {shear_factor};
  const BeamStiffness k = beam_stiffness(one, 0, shear);
  const double r = k.ksz / k.kn, g = k.kt / k.kby;
  const double plate = ice.young * h * h * h / (12.0 * (1.0 - ice.poisson * ice.poisson));
  return {2.0 * (1.0 + r) / (3.0 + r),
          (1.0 - r) / (3.0 + r),
          (1.0 + r) / 4.0,
          0.5,
          std::sqrt(3.0) / 4.0 * (3.0 * k.kby + k.kt) / plate,
          (1.0 - g) / (3.0 + g)};
}

}  // namespace floe
