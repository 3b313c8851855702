/// \file
/// Expected size of the output of a run, before the run is made.
#pragma once

#include <cstddef>

#include "floe/lattice/lattice.h"

namespace floe {

/// Approximate sizes on disk [B].
struct OutputSize {
  double once = 0;        ///< lattice.h5 and the mesh of the frames
  double frame = 0;       ///< a frame, in fields.h5 and fields.xmf
  double row = 0;         ///< a row of history.csv
  double checkpoint = 0;  ///< a checkpoint of dynamics
};

/// Estimates the size of a run's output.
/// \param lattice  whole, not packed
/// \param breakable  whether beams may break
/// \param boundaries, loads, obstacles  numbers of these in the scene
OutputSize output_size(const Lattice& lattice, bool breakable, std::size_t boundaries,
                       std::size_t loads, std::size_t obstacles);

}  // namespace floe
