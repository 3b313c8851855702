// PETSc's options in a run: their sources, and the options that were never queried.
#include <algorithm>
#include <array>
#include <set>

#include "session/blame.h"
#include "floe/files/log.h"
#include "floe/options/options.h"
#include "options/option_names.h"
#include "options/option_values.h"

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

std::string Options::petsc(std::string_view name) const {
  const auto found = petsc_.find(name);
  return found == petsc_.end() ? "" : found->second.value;
}

void Options::leave_out(std::string_view family, bool of_scene) {
  std::erase_if(petsc_, [&](const auto& entry) {
    const auto& [name, given] = entry;
    const bool drop = given.source == Source::environment || given.source == Source::checkpoint ||
                      (given.source == Source::scene && of_scene);
    if (!drop || !name.starts_with(family)) return false;
    check(PetscOptionsClearValue(nullptr, ("-" + name).c_str()));
    if (given.source == Source::environment) {
      ignored_[name] = given;
    } else {
      idle_.push_back({name, "nothing in this run would ask for it"});
    }
    return true;
  });
}

std::set<std::string> Options::may_stay_unused() const {
  const bool commanded = std::any_of(petsc_.begin(), petsc_.end(), [](const auto& entry) {
    return entry.second.source == Source::command_line;
  });
  std::set<std::string> names;
  for (const auto& [name, given] : petsc_) {
    if (given.source == Source::environment || given.source == Source::checkpoint ||
        (given.source == Source::scene && commanded))
      names.insert(name);
  }
  return names;
}

std::string Options::environment_remark() const {
  std::vector<std::string> taken, left;
  for (const auto& [name, given] : petsc_) {
    if (given.source != Source::environment) continue;
    taken.push_back("-" + name + (given.value.empty() ? "" : " " + shown(given.value)) +
                    in_brackets(given.place));
  }
  for (const auto& [name, given] : ignored_)
    left.push_back("-" + shown(name) + in_brackets(given.place));
  if (taken.empty() && left.empty()) return {};
  return "options of the environment: " + (taken.empty() ? "none taken" : some_of(taken)) +
         (left.empty() ? "" : "; not taken: " + some_of(left));
}
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
