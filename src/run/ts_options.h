/// \file
/// What of PETSc's options of TS all integrators in time ask for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace floe {

/// Value of an option, as "-ts_type"; nothing if it is not given.
std::optional<std::string> ts_option(const char* option);

/// \throws InputError that names the option and the reason, if it is given
void refuse_ts_option(const char* option, const std::string& why, const char* integrator);

/// Refuses options that would upset samples and checkpoints. \throws InputError
void refuse_ts_times(const char* integrator);

/// -ts_max_steps, beyond PETSc's 32 bits; nothing if it is not given. \throws InputError
std::optional<std::int64_t> given_max_steps();

/// During its life PETSc sees a small -ts_max_steps, if one is given: it could not read all that
/// given_max_steps() can.
class HiddenMaxSteps {
 public:
  HiddenMaxSteps();
  ~HiddenMaxSteps();
  HiddenMaxSteps(const HiddenMaxSteps&) = delete;
  HiddenMaxSteps& operator=(const HiddenMaxSteps&) = delete;

 private:
  std::optional<std::string> value_;
};

}  // namespace floe
