#include "run/ts_options.h"

#include <petscsys.h>

#include <array>
#include <charconv>

#include "floe/base/petsc.h"

namespace floe {

std::optional<std::string> ts_option(const char* option) {
  std::array<char, 64> value{};
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, nullptr, option, value.data(), value.size(), &given));
  return given ? std::optional<std::string>(value.data()) : std::nullopt;
}

void refuse_ts_option(const char* option, const std::string& why, const char* integrator) {
  if (ts_option(option))
    throw InputError(std::string(option + 1) + ": integrator: " + integrator +
                     " does not take it: " + why);
}

void refuse_ts_times(const char* integrator) {
  for (const char* option : {"-ts_init_time", "-ts_time_span"})
    refuse_ts_option(option,
                     "runs start at time 0 or from a checkpoint, samples are output: history",
                     integrator);
  refuse_ts_option("-ts_exact_final_time", "runs end at their end", integrator);
}

std::optional<std::int64_t> given_max_steps() {
  const auto text = ts_option("-ts_max_steps");
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

HiddenMaxSteps::HiddenMaxSteps() : value_(ts_option("-ts_max_steps")) {
  if (value_) check(PetscOptionsSetValue(nullptr, "-ts_max_steps", "1"));
}

HiddenMaxSteps::~HiddenMaxSteps() {
  if (!value_) return;
  (void)PetscOptionsSetValue(nullptr, "-ts_max_steps", value_->c_str());
  // PETSc must not report the option as unused.
  PetscBool asked_for = PETSC_FALSE;
  (void)PetscOptionsHasName(nullptr, nullptr, "-ts_max_steps", &asked_for);
}

}  // namespace floe
