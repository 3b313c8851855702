/// \file
/// Check of an output folder: whether its contents let a run write its results there.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace floe {

/// Checks the names of a run's results in a folder without changing anything.
/// \param names  files that a run writes; the folder fields is checked too
/// \throws InputError if one of the names exists as something else (a folder, a device, a pipe, a
///   link that leads nowhere), or as a file that may not be changed
void check_result_files(const std::string& dir, std::span<const std::string_view> names);

}  // namespace floe
