#include "solve/ts_options.h"

#include <petscts.h>

#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <string>

#include "floe/base/log.h"
#include "floe/base/petsc.h"
#include "solve/leapfrog.h"
#include "solve/liealpha.h"

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

/// Value of an option of PETSc's; empty if it is not given.
std::optional<std::string> value_of(const char* option) {
  std::array<char, 64> value{};
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, nullptr, option, value.data(), value.size(), &given));
  return given ? std::optional<std::string>(value.data()) : std::nullopt;
}

std::string chosen_type() {
  std::string type = value_of("-ts_type").value_or(ts_leapfrog);
  if (type != ts_leapfrog && type != TSRK)
    throw InputError("ts_type: '" + type + "' cannot step this scene: " + reason_against(type) +
                     " (integrator: explicit steps with " + ts_leapfrog + " or rk)");
  return type;
}

void refuse(const char* option, const std::string& why, const char* integrator = "explicit") {
  if (value_of(option))
    throw InputError(std::string(option + 1) + ": integrator: " + integrator +
                     " does not take it: " + why);
}

/// Options that would upset samples and checkpoints.
void refuse_times(const char* integrator) {
  for (const char* option : {"-ts_init_time", "-ts_time_span"})
    refuse(option, "runs start at time 0 or from a checkpoint, samples are output: history",
           integrator);
  refuse("-ts_exact_final_time", "runs end at their end", integrator);
}

/// Options that TS would read without effect, or that would upset samples and checkpoints.
void refuse_without_effect(const std::string& type) {
  refuse_times("explicit");
  for (const char* option : {"-ts_rk_multirate", "-ts_rk_dtratio", "-ts_use_splitrhsfunction"})
    refuse(option, "all bodies take the same step");
  const std::string adaptivity = value_of("-ts_adapt_type").value_or(TSADAPTNONE);
  if (type != TSRK && adaptivity != TSADAPTNONE)
    throw InputError("ts_adapt_type: '" + adaptivity + "' is for -ts_type rk; the step of " + type +
                     " is fixed");
  if (adaptivity != TSADAPTNONE) return;
  for (const char* option :
       {"-ts_rtol", "-ts_atol", "-ts_max_reject", "-ts_adapt_safety", "-ts_adapt_reject_safety",
        "-ts_adapt_clip", "-ts_adapt_dt_min", "-ts_adapt_dt_max", "-ts_adapt_always_accept",
        "-ts_adapt_wnormtype", "-ts_adapt_max_ignore"})
    refuse(option, "the step is fixed (-ts_type rk -ts_adapt_type basic adapts it)");
}

}  // namespace

std::optional<std::int64_t> given_max_steps() {
  const auto text = value_of("-ts_max_steps");
  if (!text) return {};
  std::int64_t value = -1;
  const char* end = text->data() + text->size();
  const auto [stop, error] = std::from_chars(text->data(), end, value);
  constexpr std::int64_t most = 1'000'000'000'000'000;
  if (error != std::errc{} || stop != end || value < 0 || value > most)
    throw InputError("ts_max_steps: " + (text->empty() ? "no value given," : *text) +
                     " must be an integer >= 0, <= 1e15");
  return value;
}

HiddenMaxSteps::HiddenMaxSteps() : value_(value_of("-ts_max_steps")) {
  if (value_) check(PetscOptionsSetValue(nullptr, "-ts_max_steps", "1"));
}

HiddenMaxSteps::~HiddenMaxSteps() {
  if (!value_) return;
  (void)PetscOptionsSetValue(nullptr, "-ts_max_steps", value_->c_str());
  PetscBool asked_for = PETSC_FALSE;  // it is no option that nothing has asked for
  (void)PetscOptionsHasName(nullptr, nullptr, "-ts_max_steps", &asked_for);
}

std::string explicit_type() {
  refuse_solvers();
  std::string type = chosen_type();
  refuse_without_effect(type);
  return type;
}

void check_implicit_options() {
  const std::string type = value_of("-ts_type").value_or(ts_liealpha);
  if (type == TSALPHA2)
    throw InputError(
        "ts_type: 'alpha2' cannot step this scene: it forgets its history when a step's rotations "
        "are taken over (integrator: implicit steps with liealpha, the same method at "
        "-ts_liealpha_radius 1)");
  if (type != ts_liealpha)
    throw InputError("ts_type: '" + type +
                     "' cannot step this scene: it does not know rotations "
                     "(integrator: implicit steps with liealpha)");
  refuse_times("implicit");
}

}  // namespace floe
