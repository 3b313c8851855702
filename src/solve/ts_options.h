/// \file
/// What of PETSc's options dynamics takes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace floe {

/// The stepper's type: `leapfrog`, or what -ts_type says. \throws InputError for options of solvers
/// (-snes_*, -ksp_*, -pc_*, -mat_*), types that cannot step the bodies of a scene, and options of
/// TS that would have no effect, naming the option and the reason
std::string explicit_type();

/// \throws InputError for an -ts_type other than `liealpha` and for options of TS that would upset
/// samples and checkpoints, naming the option and the reason
void check_implicit_options();

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
