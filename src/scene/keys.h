/// \file
/// The one table of floe's options.
#pragma once

#include <span>

#include "floe/base/options.h"

namespace floe {

/// All options of floe, sections together, in the order of docs/options.md.
std::span<const OptionSpec> scene_keys();

}  // namespace floe
