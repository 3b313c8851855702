/// \file
/// The table of all options of floe.
#pragma once

#include <span>

#include "floe/options/options.h"

namespace floe {

/// All options of floe, grouped by sections, in the order of docs/options.md.
std::span<const OptionSpec> scene_keys();

}  // namespace floe
