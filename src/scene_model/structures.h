/// \file
/// Structures as bodies of the model.
#pragma once

#include <vector>

#include "floe/contact/obstacle.h"
#include "floe/forces/support.h"
#include "floe/lattice/lattice.h"
#include "floe/scene.h"
#include "model/model.h"

namespace floe {

/// Appends the structures of a scene to its lattice, each as a body behind all others and as a set
/// of its name. They are not in the set all.
void add_structures(const Scene& scene, Lattice& lattice);
/// Returns the obstacles of a scene, those that bodies of its lattice carry in these bodies'
/// frames.
std::vector<Obstacle> obstacles_on(const Scene& scene, const Lattice& lattice);
/// Adds supports, mooring lines and added masses of structures, after all other added masses.
void add_supports(const Scene& scene, Model<Spatial>& model);

}  // namespace floe
