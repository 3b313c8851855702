/// \file
/// The command line and the text of a scene, looked at before PETSc takes them: PETSc aborts, hangs
/// or says nothing where a user needs one clear line.
#pragma once

#include <functional>
#include <string>

#include "floe/base/petsc.h"

namespace floe {

/// What the command line asks to be printed instead of a run.
enum class Help { none, text, markdown };

/// Looks for -help and -help_markdown anywhere on the command line; needs no scene.
Help wants_help(int argc, const char* const* argv);

/// The path of the scene, the first word of the command line.
/// \throws InputError if it is missing, or for stray words, --key, -key=value, and what PETSc would
/// take
///         from elsewhere (-options_file and its kin).
std::string check_command_line(int argc, const char* const* argv);

/// Checks that PETSc can read the scene: a regular file, one YAML document, a map of plain keys to
/// values, lists of plain values or maps; no key given twice, nor two that join to one name.
/// Collective: rank 0 reads, all ranks throw the same. \throws InputError with the file's name and
/// the line.
/// \param near_to  words to be added to the message if there is no such file, as a similar name
void read_scene_text(const std::string& path, MPI_Comm comm = MPI_COMM_WORLD,
                     const std::function<std::string(const std::string&)>& near_to = {});

}  // namespace floe
