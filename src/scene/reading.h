/// \file
/// Reading a scene, part by part. Each function reads its keys from the options and stores their
/// values in the scene. All throw InputError alike on all ranks.
#pragma once

#include <string>

#include "floe/options/options.h"
#include "floe/scene.h"

namespace floe {

/// Formats a number with at most six digits.
std::string text_of(double value);

/// Reads ice without end, after all that it depends on. \throws InputError for what it does not go
/// with
void read_supply(Options& options, Scene& scene);
/// Reads which forces act, and refuses keys that have no effect without them.
void read_forces(Options& options, Scene& scene);
/// Reads the sheet and its ice, or the lattice file.
void read_lattice_source(Options& options, Scene& scene);
/// Reads the outline of a sheet whose element size is known, and refuses keys that have no effect
/// with it or without it. \return whether there is one. Collective.
bool read_outline(Options& options, Scene& scene);
void read_regions_and_cuts(Options& options, Scene& scene);
/// Reads which faces are frozen together, after the lattice's source and the fracture.
void read_bonds(Options& options, Scene& scene);
void read_fracture(Options& options, Scene& scene);
void read_water(Options& options, Scene& scene);
/// Reads contacts and obstacles.
void read_contact(Options& options, Scene& scene);
/// Reads prescribed motions, and loads.
void read_boundaries(Options& options, Scene& scene);
void read_loads(Options& options, Scene& scene);
/// Reads whether statics follow a path.
void read_path_choice(Options& options, Scene& scene);
/// Reads how they follow it, after loads, boundaries and time.
void read_path_control(Options& options, Scene& scene);

}  // namespace floe
