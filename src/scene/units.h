/// \file
/// Detection of numbers that are wrong by a thousand or a million, as mistaken units are.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "floe/scene.h"

namespace floe {

/// Returns " is it meant in GPa?" if `value`, read in that unit instead of `unit`, would be from
/// `least` to `most`; else an empty string.
std::string unit_question(double value, std::string_view unit, double least, double most);

/// Returns a line for each number of a scene's sheet, water, fracture and contact that is far from
/// the usual range for ice.
std::vector<std::string> unusual_numbers(const Scene& scene);

}  // namespace floe
