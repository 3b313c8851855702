/// \file
/// Forces by which a program acts on bodies: its own, and wrenches that it sets between steps.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "floe/forces/body_force.h"
#include "forces/force.h"

namespace floe {

/// Makes a force of a program. Reports its work as energy_external.
/// \param part  must outlive the force
std::unique_ptr<Force<Spatial>> make_program_force(const Part& part, BodyForce force);

/// Wrenches on bodies, about their centroids, in world axes.
struct AppliedWrench {
  std::int32_t body = 0;  ///< index in the lattice
  Vec3<double> force{};   ///< [N]
  Vec3<double> moment{};  ///< [N m]
};

/// Makes a force of wrenches that a program sets, the same on all ranks. Reports their work as
/// energy_external. A checkpoint keeps the wrenches.
/// \param part      must outlive the force
std::unique_ptr<Force<Spatial>> make_applied_wrenches(
    const Part& part, std::shared_ptr<std::vector<AppliedWrench>> wrenches);

}  // namespace floe
