/// \file
/// Wrenches of supports on structures.
#pragma once

#include <memory>
#include <vector>

#include "floe/forces/support.h"
#include "forces/force.h"
#include "forces/support_law.h"

namespace floe {

using SupportWrench = SupportWrenchOf<double>;

/// The potential of the springs [J].
double spring_energy(const SupportMatrix& stiffness, const Vec3<double>& shift,
                     const Vec3<double>& turn);

/// Springs and dashpots of structures, and the columns of their motions. Dashpots act on velocity
/// and spin as they are, by C (velocity of the point, spin).
/// \param part  must outlive the force
std::unique_ptr<Force<Spatial>> make_supports(const Part& part, std::vector<Support> supports);

}  // namespace floe
