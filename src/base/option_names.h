/// \file
/// Which names an option may have: PETSc's families, and the known name nearest to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "floe/base/options.h"

namespace floe {

/// PETSc cuts longer names (PETSC_MAX_OPTION_NAME) in silence.
inline constexpr std::size_t longest_petsc_option = 60;

/// Whether a word of a command line is an option: a dash and a letter (-0.5, -inf and - are
/// values).
bool is_option_word(std::string_view word);

/// PETSc does not tell upper from lower case: the name in lower case if it is then one of PETSc's.
std::string petsc_name(std::string_view name);

/// Whether an option of the environment is taken: one of PETSc's families, but not one that reads
/// further options, and of stepping in time (-ts_*) only what prints. What a scene computes is
/// written in the scene.
bool is_environment_option(std::string_view name);

/// Options by which PETSc would read further options before anybody can look at them.
bool reads_from_elsewhere(std::string_view name);

/// Whether PETSc or one of the packages under it could ask for an option of this name.
bool is_petsc_option(std::string_view name);

/// The known name nearest to `name` (joined with "_"): a key of the table as in YAML, or, if that
/// is nearer, one of PETSc's families with the rest of the name. Empty if nothing is near.
std::string nearest_option(std::string_view name, std::span<const OptionSpec> table);

/// The well-known option of the same PETSc family that `name` may be a misspelling of, or nothing.
std::string nearest_petsc_option(std::string_view name);

}  // namespace floe
