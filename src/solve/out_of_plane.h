/// \file
/// The stability of planar equilibria against motion out of plane.
#pragma once

#include "floe/solve/integrator.h"

namespace floe {

/// Number of negative eigenvalues of the tangent on z, rx, ry at a planar state. There it has no
/// entry that couples these with x, y, rz (mirror symmetry), so that this number and that of the
/// planar tangent make up the spatial one's (Sylvester's law of inertia), at half its size each.
/// Costs a factorisation, by MUMPS. Collective.
std::int64_t unstable_modes(const Model<Planar>& model, const OutOfPlane& rest,
                            const State<Planar>& state);

}  // namespace floe
