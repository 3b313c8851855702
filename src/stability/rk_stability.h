/// \file
/// Largest stable steps of explicit Runge-Kutta methods (model.md, "Explicit dynamics":
/// Runge-Kutta).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "stability/stable_step.h"

namespace floe {

/// Stability polynomial R of y_{n+1} = R(lambda dt) y_n: 1 + z b^T (1 - z A)^-1 (1, ..., 1)^T, a
/// polynomial since A is strictly lower triangular.
class StabilityPolynomial {
 public:
  /// \param a  s x s, row-major
  /// \param b  s
  StabilityPolynomial(std::span<const double> a, std::span<const double> b);

  std::complex<double> operator()(std::complex<double> z) const;
  std::span<const double> coefficients() const { return coefficients_; }

  /// Returns the largest dt [s] up to which no solution of x'' + c x' + k x = 0 grows by more than
  /// `growth` in a step; infinity if both k and c are 0.
  /// \param stiffness  k [1/s^2], >= 0
  /// \param damping  c [1/s], >= 0
  double largest_step(double stiffness, double damping, double growth = little) const;

  static constexpr double little = 1e-9;  ///< 0.1 % in a million steps

 private:
  std::vector<double> coefficients_;
};

/// Returns a step below which no vibration about the state grows by more than `growth` in a step.
/// Any eigenvector phi of lambda^2 M + lambda C + K, scaled to phi* M phi = 1, has lambda^2 + c
/// lambda + k = 0 with c = phi* C phi and k = phi* K phi. These pairs lie in the joint numerical
/// range of M^-1 C and M^-1 K, which is convex. A polygon of supporting lines encloses it, each
/// line from the largest eigenvalue of a combination of the two. The polygon is refined where it
/// limits the step, until its dt is within 1 % of that of the pairs found. So all forces count,
/// whether damping is proportional or not. Collective.
StableStep rk_stable_step(const StabilityPolynomial& polynomial, const Model<Spatial>& model,
                          const State<Spatial>& state, double growth = StabilityPolynomial::little);

}  // namespace floe
