#include "solve/ts_options.h"

#include <array>
#include <map>
#include <string>

#include "floe/base/log.h"
#include "floe/base/petsc.h"
#include "solve/leapfrog.h"

namespace floe {
namespace {

/// TS would read options of solvers for a solver that it never uses.
void refuse_solvers() {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::string found;
  for (PetscInt k = 0; k < count && found.empty(); ++k) {
    const std::string name = names[k];
    for (const char* family : {"snes_", "ksp_", "pc_", "mat_"}) {
      if (name.rfind(family, 0) == 0) found = name;
    }
  }
  check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  if (!found.empty())
    throw InputError(found + ": integrator: explicit solves no system of equations");
}

/// Why a type of PETSc's cannot step rigid bodies with dashpots.
std::string reason_against(const std::string& type) {
  static const std::map<std::string, const char*> known{
      {"basicsymplectic",
       "each of its halves sees its conjugate half only: no damping, no rotation that depends on "
       "the angular momentum"},
      {"euler", "it is unstable for vibrations at any step"},
      {"ssp", "it is made for upwind fluxes and steps vectors, not rotations"},
      {"rk", "it steps vectors, and rotations as state of its own are not built in yet"},
      {"alpha2", "it is implicit, and restarts whenever rotations are renormalised"}};
  static constexpr std::array implicit{"beuler",  "cn",    "theta",  "alpha", "bdf",      "rosw",
                                       "arkimex", "dirk",  "irk",    "glle",  "sundials", "gl",
                                       "mimex",   "eimex", "radau5", "pseudo"};
  if (const auto found = known.find(type); found != known.end()) return found->second;
  for (const char* name : implicit) {
    if (type == name) return "it is implicit: it solves systems of equations";
  }
  return "no such type is known here";
}

void refuse_types() {
  std::array<char, 64> type{};
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, nullptr, "-ts_type", type.data(), type.size(), &given));
  const std::string name = type.data();
  if (given && name != ts_leapfrog)
    throw InputError("ts_type: '" + name + "' cannot step this scene: " + reason_against(name) +
                     " (integrator: explicit steps with " + ts_leapfrog + ")");
}

}  // namespace

void refuse_options_of_others() {
  refuse_solvers();
  refuse_types();
}

}  // namespace floe
