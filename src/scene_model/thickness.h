/// \file
/// The thickness of a sheet's cells: one number, a grid from a file, or a random field.
#pragma once

#include <vector>

#include "floe/scene.h"

namespace floe {

/// Returns the thickness of each cell at its centroid [m]; empty if the sheet has one thickness.
/// All ranks read the file.
/// \throws InputError if the file is no grid, has a value out of range or does not reach a cell
std::vector<double> thickness_of_cells(const Scene& scene, const Tessellation& cells);

/// Least, mean (by area) and most of the thicknesses of a sheet, and their standard deviation [m].
struct ThicknessReport {
  double least = 0, mean = 0, most = 0, deviation = 0;
};
ThicknessReport thickness_report(const Tessellation& cells, const std::vector<double>& thickness);

}  // namespace floe
