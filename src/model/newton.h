/// \file
/// What Newton's method on a model's unknowns takes, in statics and in dynamics: matrices, solvers,
/// defaults.
#pragma once

#include <span>

#include "model/model.h"

namespace floe {

/// The storage and form of the tangent that the chosen preconditioner wants: Cholesky takes blocked
/// symmetric storage, LU the exact unsymmetric K, everything else (GAMG, hypre, ...) plain rows.
/// -mat_type wins.
TangentOptions tangent_options();

/// A typical diagonal of the free unknowns for the prescribed ones, so that the matrix stays well
/// scaled [N/m]. Collective.
template <class Space>
double typical_stiffness(const Model<Space>& model);

/// Preonly + Cholesky by MUMPS.
void set_cholesky(KSP ksp);

/// Newton without line search, preonly + Cholesky by MUMPS: options read later win.
void set_newton_defaults(SNES snes);

/// The rigid modes (six, in the plane three) as near-nullspace: what algebraic multigrid needs to
/// know of an elastic body. \param held  n bits per local body: unknowns that do not move
template <class Space>
void attach_rigid_modes(const Model<Space>& model, std::span<const std::uint8_t> held, Mat matrix);

/// The factor of a solver that is Cholesky by MUMPS and has its operators; null for any other.
Mat mumps_cholesky(KSP ksp);

/// Before the first factorisation: on several ranks MUMPS counts negative pivots only if its root
/// front is not shared out.
void let_mumps_count(KSP ksp);

/// Number of negative eigenvalues of a solver's matrix, which is factorised if it is not yet; -1 if
/// the solver does not tell. Collective.
std::int64_t negative_pivots(KSP ksp);

/// Has the library of dense algebra take its buffers while there is memory. \throws std::bad_alloc
void claim_blas_memory();

/// Before a matrix is factorised anew: drops a factor whose making failed. PETSc does not call
/// MUMPS again for a factor that MUMPS once gave up, and solves with what is not there
/// ("INFOG(1)=-3"). True if there was one. Collective.
bool drop_failed_factor(KSP ksp);

/// After a linear solve that failed. \throws RunFailed if the factorisation had too little memory,
/// which no smaller step mends. On all ranks alike.
void require_memory(KSP ksp);

}  // namespace floe
