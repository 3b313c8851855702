/// \file
/// The place of the program, and of the files that belong to it.
#pragma once

#include <filesystem>

namespace floe::program {

/// Returns the file of this program, also if links lead to it or the loader was called by name
/// (ld.so floe). Empty if the system does not say.
std::filesystem::path program_file();

/// Returns the folder with tools/ and input/ that belongs to this program: PREFIX/share/floe of an
/// installation, share/floe beside a program that has not been installed. Empty if there is none.
std::filesystem::path share_folder();

}  // namespace floe::program
