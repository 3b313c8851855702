/// \file
/// Convex parts of solids in files, and kept for later runs.
#pragma once

#include <mpi.h>

#include <string>

#include "floe/solid/solid_file.h"
#include "solid/convex_parts.h"

namespace floe {

/// Writes convex parts: the group /shapes of lattice files, and the other numbers as attributes of
/// it. Call on one rank. \throws FileError
void write_parts(const ConvexParts& parts, const std::string& file);
/// Reads what write_parts() wrote. Call on one rank. \throws InputError
ConvexParts read_parts(const std::string& file, const std::string& key);

/// Where parts are kept: $XDG_CACHE_HOME/floe, else $HOME/.cache/floe; empty without either.
std::string parts_folder();

/// Returns the convex parts of a solid. Parts are kept in `folder` under a name that goes with the
/// bytes of the solid's file and with all other arguments, and taken from there the next time, with
/// the same bits; a damaged file is made anew. Call on one rank.
/// \param folder  made if it is not there; if it cannot be written, nothing is kept. Empty: nothing
/// is kept
/// \param key     the option that named the file, for messages
/// \throws InputError as read_surface(), check_surface() and convex_parts()
ConvexParts parts_of(const SolidFile& solid, const std::string& key, const std::string& folder);

/// The same for all ranks: rank 0 finds the parts, in parts_folder(). Collective.
ConvexParts parts_of(const SolidFile& solid, const std::string& key, MPI_Comm comm);

}  // namespace floe
