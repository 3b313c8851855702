/// \file
/// PETSc options of TS that all integrators in time read or refuse.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace floe {

/// Returns the value of an option such as "-ts_type", nothing if it is not given.
std::optional<std::string> ts_option(const char* option);

/// Refuses an option if it is given. \throws InputError that names the option and the reason
void refuse_ts_option(const char* option, const std::string& why, const char* integrator);

/// Refuses TS options that would upset samples and checkpoints. \throws InputError
void refuse_ts_times(const char* integrator);

/// Returns -ts_max_steps, which may exceed PETSc's 32 bits; nothing if it is not given. \throws
/// InputError
std::optional<std::int64_t> given_max_steps();

/// While it lives PETSc sees a small -ts_max_steps if the option is given, since PETSc cannot read
/// values of more than 32 bits.
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
