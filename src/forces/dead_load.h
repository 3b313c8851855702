/// \file
/// Dead loads of a scene as a force.
#pragma once

#include <memory>
#include <vector>

#include "floe/forces/load.h"
#include "floe/lattice/kinematics.h"
#include "forces/force.h"

namespace floe {

/// A load and the bodies that carry it: equal shares, each force at a body-fixed point.
struct PlacedLoad {
  Load load;
  std::vector<std::int32_t> bodies;  ///< global indices
  Point3 arm{};                      ///< from the centroid to the point of the force, at rest [m]
};

/// Finds the bodies that carry a load: those of its set, or the one body whose centroid is nearest
/// in plan to its point.
/// \throws InputError for an unknown set
PlacedLoad place(const Load& load, const Lattice& lattice);

/// Makes a load a force of a model (model.md, "Bending on water").
/// \param part        must outlive the force
/// \param kinematics  linear: arms do not turn with their bodies in the wrench
template <class Space>
std::unique_ptr<Force<Space>> make_load(const Part& part, PlacedLoad load,
                                        Kinematics kinematics = Kinematics::corotational);

}  // namespace floe
