/// \file
/// What Newton's method on a model's unknowns takes, in statics and in dynamics: matrices, solvers,
/// defaults.
#pragma once

#include <span>

#include "floe/solve/model.h"

namespace floe {

/// The storage and form of the tangent that the chosen preconditioner wants: Cholesky takes blocked
/// symmetric storage, LU the exact unsymmetric K, everything else (GAMG, hypre, ...) plain rows.
/// -mat_type wins.
TangentOptions tangent_options();

/// A typical diagonal of the free unknowns for the prescribed ones, so that the matrix stays well
/// scaled [N/m]. Collective.
double typical_stiffness(const Model<Spatial>& model);

/// Newton without line search, preonly + Cholesky by MUMPS: options read later win.
void set_newton_defaults(SNES snes);

/// The six rigid modes as near-nullspace: what algebraic multigrid needs to know of an elastic
/// body. \param held  n bits per local body: unknowns that do not move
void attach_rigid_modes(const Model<Spatial>& model, std::span<const std::uint8_t> held,
                        Mat matrix);

}  // namespace floe
