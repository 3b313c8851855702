/// \file
/// The viscous term of a contact from the restitution of an impact (model.md, "Contact").
#pragma once

namespace floe {

/// Returns the damping ratio zeta with which a central impact of a face returns the part e of its
/// speed: without tension e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)), and its continuation for
/// zeta > 1.
/// \param restitution  e, in (0, 1]
double damping_ratio_of(double restitution);

}  // namespace floe
