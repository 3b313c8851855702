// PETSc's options in a run, and their sources.
#include <algorithm>
#include <set>

#include "floe/options/options.h"
#include "options/option_values.h"

namespace floe {

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

}  // namespace floe
