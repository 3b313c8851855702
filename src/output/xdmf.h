/// \file
/// The text of fields.xmf: what ParaView reads to find the frames in HDF5 files.
#pragma once

#include <cstddef>
#include <string>

namespace floe {

/// Numbers that all frames share.
struct GridSizes {
  std::size_t points = 0, faces = 0;  ///< vertices and polygons of the bodies
  std::size_t topology = 0;           ///< numbers of /mesh/topology
  std::size_t bodies = 0, beams = 0;
  bool shapes = false;  ///< bodies have shapes; else they are points
};

/// Where a frame is, and what is its own.
struct GridPlace {
  std::string file, group;  ///< HDF5 file, from the folder of fields.xmf; "/t000000"
  double time = 0;
  std::size_t cracks = 0;  ///< faces of cracks
  bool breakable = false;  ///< the frame has the beams' damage
};

/// The grids of one time: bodies as polygons, beams as lines, faces of cracks.
std::string xdmf_grid(const GridSizes& sizes, const std::string& mesh_file, const GridPlace& place);

/// Stands for all grids of another document. \param file  from the folder of the one it stands in
std::string xdmf_include(const std::string& file);

/// A whole document. \param grids  and includes, in the order of time
std::string xdmf_document(const std::string& grids);

}  // namespace floe
