/// \file
/// A seal on a file: its first 512 bytes say how long it is and the checksum of what follows, so
/// that no bit of it can change unseen.
#pragma once

#include <cstddef>
#include <string>

namespace floe {

/// Bytes that a seal takes at the beginning of a file (HDF5 calls them its user block).
inline constexpr std::size_t seal_size = 512;

/// Writes the seal of a file that has the room for it. \throws FileError
void seal(const std::string& path);

/// What is wrong with a sealed file, as in "is damaged: it has 10 bytes of 20"; empty if it is as
/// it was sealed. Of what is no regular file, or cannot be read, nothing is said: whoever opens it
/// will see.
std::string seal_problem(const std::string& path);

}  // namespace floe
