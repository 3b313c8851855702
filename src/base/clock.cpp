#include "base/clock.h"

#include <chrono>

namespace floe {
namespace {

using Clock = std::chrono::steady_clock;
/// As near to the beginning as a library can be.
const Clock::time_point began = Clock::now();

}  // namespace

double seconds_of_process() { return std::chrono::duration<double>(Clock::now() - began).count(); }

}  // namespace floe
