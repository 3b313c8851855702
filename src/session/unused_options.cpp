#include "floe/session/unused_options.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "options/option_names.h"
#include "session/blame.h"

namespace floe {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

/// Returns the options that were never queried so far, without their dash.
Pairs unused_options() {
  PetscInt n = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &n, &names, &values));
  Pairs options;
  for (PetscInt k = 0; k < n; ++k) options.emplace_back(names[k], values[k] ? values[k] : "");
  check(PetscOptionsLeftRestore(nullptr, &n, &names, &values));
  return options;
}

/// Whether PETSc queries the option only in PetscFinalize.
bool is_asked_for_at_the_end(std::string_view name) {
  constexpr std::array late{"citations", "get_total_flops", "mpidump", "objects_dump",
                            "stack_view"};
  return std::find(late.begin(), late.end(), name) != late.end() || name.starts_with("options_") ||
         name.starts_with("malloc_");
}

/// Whether the option is of a viewer, which PETSc may query at any time.
bool is_viewer(std::string_view name) {
  return name.find("_view") != std::string_view::npos || name.starts_with("viewer_");
}

}  // namespace

void reject_unused_options(const std::set<std::string>& exempt) {
  std::string verdict;
  for (const auto& [name, value] : unused_options()) {
    if (exempt.contains(name) || is_viewer(name) || is_asked_for_at_the_end(name)) continue;
    const std::string near = nearest_petsc_option(name);
    verdict = name + ": nothing in this run has asked for this PETSc option" +
              (near.empty() ? "" : "; is it '" + near + "'?");
    break;
  }
  throw_verdict(verdict, PETSC_COMM_WORLD);  // a rank may have queried fewer options than rank 0
  solver_options_are_good();
}

void warn_unused_options() {
  if (rank() != 0) return;
  for (const auto& [name, value] : unused_options()) {
    if (is_asked_for_at_the_end(name)) continue;
    warn(name + ": nothing in this run has asked for this option");
  }
}

}  // namespace floe
