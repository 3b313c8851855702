/// \file
/// Matrices, solvers and defaults of Newton's method on a model's unknowns, in statics and in
/// implicit dynamics.
#pragma once

#include <span>

#include "model/model.h"

namespace floe {

/// Returns the storage and form of the tangent that the chosen preconditioner needs: blocked
/// symmetric storage for Cholesky, the exact unsymmetric K for LU, plain rows for all others (GAMG,
/// hypre, ...). -mat_type overrides the storage.
TangentOptions tangent_options();

/// Largest stiffness bound of any body [N/m], 1 if no force has one: the diagonal entry for
/// prescribed unknowns, by which the matrix stays well scaled. Collective.
template <class Space>
double typical_stiffness(const Model<Space>& model);

/// Sets a solver to preonly and Cholesky by MUMPS.
void set_cholesky(KSP ksp);

/// Sets Newton without line search, linear solves by preonly and Cholesky by MUMPS. Options read
/// later override these.
void set_newton_defaults(SNES snes);

/// Attaches the rigid modes (six in space, three in the plane) to the matrix as near-nullspace,
/// which algebraic multigrid needs for an elastic body. Collective.
/// \param held  n bits per local body: unknowns that do not move
template <class Space>
void attach_rigid_modes(const Model<Space>& model, std::span<const std::uint8_t> held, Mat matrix);

/// Returns the factor if the solver is Cholesky by MUMPS and has its operators, else null.
Mat mumps_cholesky(KSP ksp);

/// Keeps MUMPS's root front on one rank: on several ranks MUMPS counts negative pivots only then.
/// To be called before the first factorisation.
void let_mumps_count(KSP ksp);

/// Returns the number of negative eigenvalues of a solver's matrix, -1 if the solver does not count
/// them. Factorises the matrix if that has not been done. Collective.
std::int64_t negative_pivots(KSP ksp);

/// Makes the dense linear algebra library allocate its buffers while there is memory. \throws
/// std::bad_alloc
void claim_blas_memory();

/// Drops a factor whose factorisation failed, before the matrix is factorised again. After MUMPS
/// has given up a factor PETSc does not call MUMPS for that factor again and solves with nothing
/// ("INFOG(1)=-3"). True if there was such a factor. Collective.
bool drop_failed_factor(KSP ksp);

/// Checks why a linear solve failed. \throws RunFailed if the factorisation had too little memory,
/// which a smaller step does not cure; on all ranks alike
void require_memory(KSP ksp);

}  // namespace floe
