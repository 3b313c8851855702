/// \file
/// Ice and the section properties of the beams made from it (model.md sections 2 and 3).
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

/// Saint-Venant torsion constant of an a x b rectangle [m^4]
/// (Timoshenko & Goodier, Theory of Elasticity, art. 109: J = a b^3 (1/3 - 64/pi^5 (b/a) sum tanh(n
/// pi a/2b)/n^5)).
double saint_venant_torsion(double a, double b);

}  // namespace floe
