/// \file
/// Wrenches of supports on structures.
#pragma once

#include <memory>
#include <vector>

#include "floe/forces/support.h"
#include "forces/force.h"

namespace floe {

/// The wrench of a support.
struct SupportWrench {
  Vec3<double> force, moment;  ///< on the body; the moment about the support's point [N, N m]
};

/// Springs of a support, in axes of the world at rest: displacement d of its point and rotation
/// vector t of the body have the potential U = (d, t) K (d, t) / 2. The force is -dU/dd. Since
/// dt/dtime = J^-1(t) w with the left Jacobian J of rotations, the moment is -J^-T(t) dU/dt with
///   J^-T = I + [t]/2 + (1/t^2 - (1 + cos t)/(2 t sin t)) [t]^2
/// (Sola, Deray & Atchuthan 2018, eq. 146), [t] the cross product by t.
SupportWrench spring_wrench(const SupportMatrix& stiffness, const Vec3<double>& shift,
                            const Vec3<double>& turn);
/// The potential of the springs [J].
double spring_energy(const SupportMatrix& stiffness, const Vec3<double>& shift,
                     const Vec3<double>& turn);

/// Springs and dashpots of structures, and the columns of their motions. Dashpots act on velocity
/// and spin as they are, by C (velocity of the point, spin).
/// \param part  must outlive the force
std::unique_ptr<Force<Spatial>> make_supports(const Part& part, std::vector<Support> supports);

}  // namespace floe
