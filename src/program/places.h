/// \file
/// Where the program lies, and what came with it.
#pragma once

#include <filesystem>

namespace floe::program {

/// The file of this program, whatever links lead to it and whether or not the loader was called by
/// name (ld.so floe). Empty if the system does not say.
std::filesystem::path program_file();

/// The folder with tools/ and input/ that belongs to this program: PREFIX/share/floe of an
/// installation, share/floe beside a program that has not been installed. Empty if there is none.
std::filesystem::path share_folder();

}  // namespace floe::program
