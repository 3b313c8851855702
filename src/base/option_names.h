/// \file
/// Which names an option may have: PETSc's families, and the known name nearest to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "floe/base/options.h"

namespace floe {

/// Whether PETSc or one of the packages under it could ask for an option of this name.
bool is_petsc_option(std::string_view name);

/// The known name nearest to `name` (joined with "_"): a key of the table as in YAML, or, if that
/// is nearer, one of PETSc's families with the rest of the name. Empty if nothing is near.
std::string nearest_option(std::string_view name, std::span<const OptionSpec> table);

/// The well-known option of the same PETSc family that `name` may be a misspelling of, or nothing.
std::string nearest_petsc_option(std::string_view name);

}  // namespace floe
