/// \file
/// Checks of the values of PETSc's own options.
#pragma once

#include <string>
#include <string_view>

namespace floe {

/// Returns why a value of an option of PETSc is refused, in one line; empty if it is accepted. A
/// table holds the ranges and words on which floe relies; no number may be nan or infinite. PETSc
/// itself may still refuse an accepted value later; petsc_file_problem() checks files.
/// \param name  without its dash; any prefix (sub_, mg_levels_) is ignored
std::string solver_option_problem(std::string_view name, std::string_view value);

/// Returns the help for `-help snes` or `-help snes_rtol`: a line for each option of PETSc whose
/// name begins with the topic and whose range floe checks, and the address of PETSc's manual. Empty
/// if the topic is not one of PETSc's families.
std::string solver_options_help(std::string_view topic);

}  // namespace floe
