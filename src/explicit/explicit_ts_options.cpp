#include "explicit/explicit_ts_options.h"

#include <petscts.h>

#include <array>
#include <map>

#include "explicit/leapfrog.h"
#include "floe/base/petsc.h"
#include "run/ts_options.h"

namespace floe {
namespace {

/// Refuses options of solvers: TS would read them for a solver that is never used.
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

/// Returns why a TS type of PETSc cannot step rigid bodies with dashpots.
std::string reason_against(const std::string& type) {
  static const std::map<std::string, const char*> known{
      {"basicsymplectic",
       "each of its halves sees its conjugate half only: no damping, no rotation that depends on "
       "the angular momentum"},
      {"euler", "it is unstable for vibrations at any step"},
      {"ssp", "it is made for upwind fluxes; rk has the same orders at a wider stability region"},
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

std::string chosen_type() {
  std::string type = ts_option("-ts_type").value_or(ts_leapfrog);
  if (type != ts_leapfrog && type != TSRK)
    throw InputError("ts_type: '" + type + "' cannot step this scene: " + reason_against(type) +
                     " (integrator: explicit steps with " + ts_leapfrog + " or rk)");
  return type;
}

/// Refuses options that TS would read without effect, or that would upset samples and checkpoints.
void refuse_without_effect(const std::string& type) {
  refuse_ts_times("explicit");
  for (const char* option : {"-ts_rk_multirate", "-ts_rk_dtratio", "-ts_use_splitrhsfunction"})
    refuse_ts_option(option, "all bodies take the same step", "explicit");
  const std::string adaptivity = ts_option("-ts_adapt_type").value_or(TSADAPTNONE);
  if (type != TSRK && adaptivity != TSADAPTNONE)
    throw InputError("ts_adapt_type: '" + adaptivity + "' is for -ts_type rk; the step of " + type +
                     " is fixed");
  if (adaptivity != TSADAPTNONE) return;
  for (const char* option :
       {"-ts_rtol", "-ts_atol", "-ts_max_reject", "-ts_adapt_safety", "-ts_adapt_reject_safety",
        "-ts_adapt_clip", "-ts_adapt_dt_min", "-ts_adapt_dt_max", "-ts_adapt_always_accept",
        "-ts_adapt_wnormtype", "-ts_adapt_max_ignore"})
    refuse_ts_option(option, "the step is fixed (-ts_type rk -ts_adapt_type basic adapts it)",
                     "explicit");
}

}  // namespace

std::string explicit_type() {
  refuse_solvers();
  std::string type = chosen_type();
  refuse_without_effect(type);
  return type;
}

}  // namespace floe
