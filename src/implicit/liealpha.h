/// \file
/// PETSc TS type `liealpha`: the generalised-alpha method for second-order systems whose
/// configuration may contain rotations (model.md, "Implicit dynamics"; Chung & Hulbert 1993; Arnold
/// & Bruels 2007; Bruels & Cardona 2010). It is an own type because PETSc's alpha2 (3.18) starts
/// with an acceleration that is only of first order, discards its history when the solution is
/// changed between steps, and gives no access to its acceleration, so that a run could not go on
/// from a checkpoint.
///
/// The equations F(t, X, V, A) = 0 (TSSetI2Function, TSSetI2Jacobian) hold at the end of each step:
///
///     X1 = X0 + h V0 + h^2 ((1/2 - beta) a0 + beta a1)
///     V1 = V0 + h ((1 - gamma) a0 + gamma a1)
///     (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) A1 + alpha_f A0
///     alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1),
///     gamma = 1/2 + alpha_f - alpha_m, beta = (gamma + 1/2)^2/4
///
/// with `a` the method's own acceleration, A at about t + (alpha_m - alpha_f) h, and rho =
/// -ts_liealpha_radius the spectral radius for frequencies that the step does not resolve: 1
/// conserves the energy of a linear system (the trapezoidal rule), 0 removes these frequencies in
/// one step.
///
/// Rotations: a component of X may be the running sum of a rotation's increments, q = q_ref exp(X -
/// X_ref), if the problem moves q_ref and X_ref to the present state after each accepted step
/// (TSSetPostStep) and never writes X. A step then turns by exp of the increment in X, as in the
/// papers, and a rejected step leaves nothing behind.
#pragma once

#include <petscts.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "floe/base/petsc.h"

namespace floe {

/// Name of the type in PETSc.
inline constexpr const char* ts_liealpha = "liealpha";

/// Registers the type with PETSc, once.
void register_liealpha();

/// X, V, A and the method's own acceleration at one time.
struct LieAlphaStage {
  Vec x, v, a, own;
};

/// Functions of a problem that the type needs beside PETSc's second-order functions.
struct LieAlphaProblem {
  /// Computes A at a start from F(t, x, v, A) = 0; only the problem can invert its mass matrix.
  std::function<void(double t, Vec x, Vec v, Vec a)> start;
  /// Sets prescribed components to their values at t, and to 0 in `own`. F and its derivative leave
  /// these components out. May be empty.
  std::function<void(double t, const LieAlphaStage& stage)> prescribe;
  /// A motion to which errors are relative while the motion so far is smaller; may be null.
  Vec expected = nullptr;
};

/// Sets the problem of a TS of this type. \param problem  must outlive the TS
void set_liealpha_problem(TS ts, const LieAlphaProblem* problem);

/// History of the type that a restart needs, beside X and V of TS2SetSolution.
struct LieAlphaHistory {
  Vec a, own;            ///< at t_n, the type's own vectors
  double last_step = 0;  ///< length of the step that led to t_n; 0 at a start
  PetscInt delay = 0;    ///< number of steps that TSAdapt still waits before it lets the step grow
};
/// Returns the present history; the TS must be set up. That of a start if no step has been made.
LieAlphaHistory liealpha_memory(TS ts);
/// Newton's iterations so far, which PETSc counts with 32 bits only.
std::int64_t liealpha_iterations(TS ts);
/// All vectors of the type, for audits.
std::vector<Vec> liealpha_vectors(TS ts);
/// Lets the next step go on from the vectors of liealpha_memory(), whose values have been loaded,
/// instead of starting.
void resume_liealpha(TS ts, const LieAlphaHistory& memory);

}  // namespace floe
