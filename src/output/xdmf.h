/// \file
/// The text of fields.xmf, by which ParaView finds the frames in HDF5 files.
#pragma once

#include <cstddef>
#include <string>

namespace floe {

/// Sizes that all frames share.
struct GridSizes {
  std::size_t points = 0, faces = 0;  ///< vertices and polygons of the bodies
  std::size_t topology = 0;           ///< length of /mesh/topology
  std::size_t bodies = 0, beams = 0;
  bool shapes = false;  ///< whether bodies have shapes; else they are points
};

/// Place of a frame, and its own data.
struct GridPlace {
  std::string file, group;  ///< HDF5 file, relative to the folder of fields.xmf; "/t000000"
  double time = 0;
  std::size_t cracks = 0;  ///< number of faces of cracks
  bool breakable = false;  ///< whether the frame has the beams' damage
};

/// Returns the grids of one time: bodies as polygons, beams as lines, faces of cracks.
std::string xdmf_grid(const GridSizes& sizes, const std::string& mesh_file, const GridPlace& place);

/// Returns an include of all grids of another document. \param file  relative to the folder of the
/// including document
std::string xdmf_include(const std::string& file);

/// Returns a whole document. \param grids  grids and includes, in order of time
std::string xdmf_document(const std::string& grids);

}  // namespace floe
