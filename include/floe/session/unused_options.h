/// \file
/// Options of PETSc that nothing in a run queries.
#pragma once

#include <set>
#include <string>

namespace floe {

/// Throws InputError that names the first option of PETSc's database that was never queried.
/// Collective. Call it after the first solve, because MUMPS reads options late. Viewers are exempt:
/// PETSc may query them at the end.
/// \param exempt  names of further exempt options
void reject_unused_options(const std::set<std::string>& exempt = {});

/// Warns on rank 0's standard error of every option that was never queried. Call it at the end of a
/// run.
void warn_unused_options();

}  // namespace floe
