/// \file
/// The thickness of a sheet's cells: one number, a grid from a file, a random field, or that of
/// each floe.
#pragma once

#include <cstdint>
#include <vector>

#include "floe/scene.h"

namespace floe {

/// Returns the thickness of each cell at its centroid, or of its floe [m]; empty if the sheet has
/// one thickness. All ranks read the file. \throws InputError if the file is no grid, has a value
/// out of range or does not reach a cell
/// \param polygon  of the outline, in which each cell lies
std::vector<double> thickness_of_cells(const Scene& scene, const Tessellation& cells,
                                       const std::vector<std::int32_t>& polygon);

/// Least, mean (by area) and most of the thicknesses of a sheet, and their standard deviation [m].
struct ThicknessReport {
  double least = 0, mean = 0, most = 0, deviation = 0;
};
ThicknessReport thickness_report(const Tessellation& cells, const std::vector<double>& thickness);

}  // namespace floe
