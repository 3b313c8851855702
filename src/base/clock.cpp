#include "base/clock.h"

#include <chrono>

namespace floe {
namespace {

using Clock = std::chrono::steady_clock;
/// The start of the process, as closely as a library can know it.
const Clock::time_point began = Clock::now();

}  // namespace

double seconds_of_process() { return std::chrono::duration<double>(Clock::now() - began).count(); }

}  // namespace floe
