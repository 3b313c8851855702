/// \file
/// Reading a scene, part by part: each function takes its keys from the options and puts what they
/// say into the scene. All throw InputError alike on all ranks.
#pragma once

#include <string>

#include "floe/base/options.h"
#include "floe/scene.h"

namespace floe {

/// A number as people write it, six digits at most.
std::string text_of(double value);

/// Which forces act, and which keys have no effect without them.
void read_forces(Options& options, Scene& scene);
/// The sheet and its ice, or the lattice file.
void read_lattice_source(Options& options, Scene& scene);
void read_regions_and_cuts(Options& options, Scene& scene);
void read_fracture(Options& options, Scene& scene);
void read_water(Options& options, Scene& scene);
/// Contacts and obstacles.
void read_contact(Options& options, Scene& scene);
/// Prescribed motions, loads.
void read_boundaries(Options& options, Scene& scene);
void read_loads(Options& options, Scene& scene);

}  // namespace floe
