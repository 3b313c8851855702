/// \file
/// Files that options of PETSc's name: those of its viewers, logs and lists of citations. PETSc
/// makes some while it begins, some in a solve, some at its end.
#pragma once

#include <string>
#include <string_view>

#include "floe/options/given.h"

namespace floe {

/// Why the file or the window of an option cannot be had, in one line; empty if there is nothing
/// against it.
/// \param name  without its dash
/// \param all  every option of PETSc's: `display` and `draw_type` say where windows are drawn
std::string petsc_file_problem(std::string_view name, std::string_view value,
                               const GivenOptions& all);

/// Remembers the files that options name and that are not there yet: what drop_petsc_files() takes
/// away. Before PETSc begins.
void note_petsc_files(const GivenOptions& options);

}  // namespace floe
