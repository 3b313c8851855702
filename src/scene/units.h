/// \file
/// Numbers that are off by a thousand or a million, as they are where units were mistaken.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "floe/scene.h"

namespace floe {

/// " is it meant in GPa?", if `value` in that unit instead of `unit` would be from `least` to
/// `most`; else nothing.
std::string unit_question(double value, std::string_view unit, double least, double most);

/// One line per number of a scene's sheet, water and contacts that is far from what is usual for
/// ice.
std::vector<std::string> unusual_numbers(const Scene& scene);

}  // namespace floe
