/// \file
/// Ice, and the properties of the sections of the beams made from it (model.md, "Beam").
#pragma once

namespace floe {

/// Isotropic linear elastic ice.
struct Ice {
  double young = 4e9;    ///< E_b, Young's modulus given to the beams [Pa]
  double poisson = 0.3;  ///< nu
  double density = 920;  ///< [kg/m^3]
};

enum class Torsion {
  saint_venant,  ///< Saint-Venant's series for the rectangle
  polar,         ///< I_y + I_z
};

/// Returns the Saint-Venant torsion constant of an a x b rectangle [m^4] (Timoshenko & Goodier,
/// Theory of Elasticity, art. 109: J = a b^3 (1/3 - 64/pi^5 (b/a) sum tanh(n pi a/2b)/n^5)).
/// \param a, b  sides [m]
double saint_venant_torsion(double a, double b);

}  // namespace floe
