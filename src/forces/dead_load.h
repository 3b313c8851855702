/// \file
/// Dead loads of a scene as a force.
#pragma once

#include <memory>
#include <vector>

#include "floe/forces/load.h"
#include "floe/lattice/kinematics.h"
#include "forces/force.h"

namespace floe {

/// A load resolved on bodies: each carries the same share; the force acts at a body-fixed point.
struct PlacedLoad {
  Load load;
  std::vector<std::int32_t> bodies;  ///< global indices
  Point3 arm{};                      ///< from the centroid to where the force acts, at rest [m]
};

/// Finds the bodies of a load: those of its set, or the one whose centroid is nearest in plan to
/// its point. \throws InputError for an unknown set
PlacedLoad place(const Load& load, const Lattice& lattice);

/// \param part  must outlive the force
template <class Space>
std::unique_ptr<Force<Space>> make_load(const Part& part, PlacedLoad load,
                                        Kinematics kinematics = Kinematics::corotational);

}  // namespace floe
