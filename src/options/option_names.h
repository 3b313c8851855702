/// \file
/// The permitted names of options: PETSc's families, and the known name nearest to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "floe/options/options.h"

namespace floe {

/// Longest name of an option of PETSc; PETSc silently cuts longer ones (PETSC_MAX_OPTION_NAME).
inline constexpr std::size_t longest_petsc_option = 60;

/// Whether a word of a command line is an option: a dash and a letter (-0.5, -inf and - are
/// values).
bool is_option_word(std::string_view word);

/// Returns the name in lower case if that is an option of PETSc, which ignores case; else the name
/// itself.
std::string petsc_name(std::string_view name);

/// Whether an option of the environment is taken: one of PETSc's families, except options that read
/// further options, and except options of time stepping (-ts_*) that do more than print. A scene
/// alone must determine its results.
bool is_environment_option(std::string_view name);

/// Whether PETSc would read further options by this one, without a check by floe.
bool reads_from_elsewhere(std::string_view name);

/// Whether PETSc, or a package under PETSc, may query an option of this name.
bool is_petsc_option(std::string_view name);

/// Returns the known name nearest to `name` (joined with "_"): a key of the table as in YAML, or,
/// if nearer, a family of PETSc with the rest of the name. Empty if no name is near.
std::string nearest_option(std::string_view name, std::span<const OptionSpec> table);

/// Returns the well-known option of the same family of PETSc that `name` may misspell; empty if
/// there is none.
std::string nearest_petsc_option(std::string_view name);

}  // namespace floe
