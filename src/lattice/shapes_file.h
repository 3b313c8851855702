/// \file
/// Shapes of bodies in files: the group /shapes (layout: model.md, "Files").
#pragma once

#include <string>

#include "files/hdf5.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Reads the convex polyhedra in a file's /shapes, one or more; their origins may be anywhere.
/// \param key  the option that named the file, for messages
/// \throws InputError if the file has no such polyhedra
Shapes read_polyhedra(const std::string& file, const std::string& key);

/// Writes the group /shapes. \throws FileError
void write_shapes(Hdf5File& file, const Shapes& shapes);

}  // namespace floe
