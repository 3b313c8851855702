#include "run_folder/size.h"

namespace floe {

/// Counts the datasets of write_lattice(), Fields and DynamicRun::persist(), and the overhead of
/// HDF5 for each of them and of XDMF for each frame.
OutputSize output_size(const Lattice& lattice, bool breakable, std::size_t boundaries,
                       std::size_t loads, std::size_t obstacles) {
  constexpr double real = 8, single = 4, index = 4;
  constexpr double frame_overhead = 14e3, file_overhead = 30e3, number_in_text = 13;
  const auto bodies = static_cast<double>(lattice.bodies.size());
  const auto beams = static_cast<double>(lattice.beams.size());
  const Shapes& s = lattice.shapes;
  const auto vertices = s.empty() ? bodies : static_cast<double>(s.vertices.size());
  const auto faces = s.empty() ? bodies : static_cast<double>(s.corner_of.size() - 1);
  const auto corners = static_cast<double>(s.corners.size());

  OutputSize size;
  const double lattice_file = bodies * 11 * real + beams * (2 * index + 13 * real) +
                              vertices * 3 * real + corners * index + faces * index;
  const double mesh = (corners + 3 * faces) * index + beams * 2 * index;
  size.once = lattice_file + mesh + 2 * file_overhead;
  size.frame = vertices * 3 * real + bodies * 9 * real + faces * 6 * single +
               beams * (10 + (breakable ? 1 : 0)) * real + frame_overhead;
  size.row = number_in_text * static_cast<double>(12 + 9 * boundaries + 3 * loads + 12 * obstacles);
  size.checkpoint = bodies * (16 * real + index) + file_overhead;
  return size;
}

}  // namespace floe
