/// \file
/// How large the output of a run will be, before it is made.
#pragma once

#include <cstddef>

#include "floe/lattice/lattice.h"

namespace floe {

/// Bytes on disk, about.
struct OutputSize {
  double once = 0;        ///< lattice.h5 and the mesh of the frames
  double frame = 0;       ///< of fields.h5 and fields.xmf
  double row = 0;         ///< of history.csv
  double checkpoint = 0;  ///< of dynamics
};

/// \param lattice  whole, nothing of it folded   \param breakable  beams may break
OutputSize output_size(const Lattice& lattice, bool breakable, std::size_t boundaries,
                       std::size_t loads, std::size_t obstacles);

}  // namespace floe
