/// \file
/// A lattice file that is not there yet.
#pragma once

#include <string>

#include "floe/base/petsc.h"
#include "floe/scene.h"

namespace floe {

/// Collective. \throws InputError if the scene's lattice file is not there, with the command that
/// makes it if the scene's comments hold one
void require_lattice_file(const Scene& scene, MPI_Comm comm);

/// The command in a scene's comments that writes `file`: what stands in a comment line up to "&&",
/// if that has the path as a word; empty if there is none.
std::string command_that_makes(const std::string& file, const std::string& scene_text);

}  // namespace floe
