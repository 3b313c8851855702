/// \file
/// Message for a lattice file that does not exist yet.
#pragma once

#include <string>

#include "floe/base/petsc.h"
#include "floe/scene.h"

namespace floe {

/// Checks that the scene's lattice file exists. Collective.
/// \throws InputError if it does not, with the command that makes it if a comment of the scene has
///   one
void require_lattice_file(const Scene& scene, MPI_Comm comm);

/// Finds the command in a scene's comments that writes `file`: the text of a comment line that
/// begins with "floe " or "tools/", up to the end of the first command ("&&" joins them) that has
/// the path as a word; empty if there is none.
std::string command_that_makes(const std::string& file, const std::string& scene_text);

}  // namespace floe
