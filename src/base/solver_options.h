/// \file
/// PETSc's own options: what floe asks of their values.
#pragma once

#include <string>
#include <string_view>

namespace floe {

/// Why a value of an option of PETSc's is refused, in one line; empty if there is nothing against
/// it. A table says what numbers and words floe relies on; no number may be nan or infinite. What
/// PETSc itself refuses later is not known here; files are petsc_file_problem()'s.
/// \param name  without its dash; any prefix (sub_, mg_levels_) is passed over
std::string solver_option_problem(std::string_view name, std::string_view value);

/// For `-help snes` or `-help snes_rtol`: the options of PETSc's whose names begin with the topic
/// and of which floe asks more than PETSc, a line each, and where PETSc explains its options.
/// Empty if the topic is none of PETSc's families.
std::string solver_options_help(std::string_view topic);

}  // namespace floe
