/// \file
/// Whether what lies in an output folder lets a run write its results there.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace floe {

/// \param names  of the files that a run writes; beside these there is the folder fields
/// \throws InputError if one of the names is there as something else (a folder, a device, a pipe, a
/// link that leads nowhere), or as a file that may not be changed. Nothing is touched.
void check_result_files(const std::string& dir, std::span<const std::string_view> names);

}  // namespace floe
