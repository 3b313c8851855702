/// \file
/// Shapes of bodies in files: the group /shapes (layout: model.md, "Files").
#pragma once

#include <string>

#include "files/hdf5.h"
#include "floe/geometry/polyhedron.h"
#include "floe/lattice/lattice.h"  // IWYU pragma: export

namespace floe {

/// Writes the group /shapes. \throws FileError
void write_shapes(Hdf5File& file, const Shapes& shapes);

}  // namespace floe
