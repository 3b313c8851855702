/// \file
/// A seal on a file: its first 512 bytes hold the length of the file and the checksum of all later
/// bytes, so that a change of any bit is detected.
#pragma once

#include <cstddef>
#include <string>

namespace floe {

/// Size of a seal at the beginning of a file [bytes] (HDF5 calls this space the user block).
inline constexpr std::size_t seal_size = 512;

/// Writes the seal of a file whose first seal_size bytes are reserved for it. \throws FileError
void seal(const std::string& path);

/// Returns the damage of a sealed file, as in "is damaged: it has 10 bytes, not 20"; empty if the
/// file is unchanged. Also empty for a file that is not regular or cannot be opened: the reader
/// that opens it reports that.
std::string seal_problem(const std::string& path);

}  // namespace floe
