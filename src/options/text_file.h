/// \file
/// Texts that a user names: scenes, tables, outlines.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <functional>
#include <string>

namespace floe {

/// Reads a text file on rank 0 for all ranks. Collective.
/// \param what  begins the message: "scene a.yaml", "sheet: outline: 'a.json'"
/// \param most  largest file [B]
/// \param near_to  returns words for the message if there is no such file, for example a similar
/// name
/// \throws InputError if the file is not regular, cannot be read or is too large
std::string read_text_file(const std::string& what, const std::string& path, std::size_t most,
                           MPI_Comm comm,
                           const std::function<std::string(const std::string&)>& near_to = {});

}  // namespace floe
