/// \file
/// Corners of simplified outlines, moved so that areas stay what they were.
#pragma once

#include <vector>

#include "floe/mesh/outline.h"

namespace floe::mesh {

/// A ring, and one of some of its corners, in the same order from the same first.
struct SimplifiedRing {
  const Ring* given;
  Ring* fewer;
  double area;  ///< that the ring is to have, signed [m^2]
};

/// Signed area of a ring, positive if it is counter-clockwise [m^2].
double signed_area(const Ring& ring);

/// Moves corners so that each ring has its area and each edge lies in the middle of the chain of
/// corners that it replaces, in the sense of least squares. Corners that rings share stay shared.
void restore_areas(const std::vector<SimplifiedRing>& rings);

/// Returns the largest distance of a given corner from the edge that takes its place [m].
double largest_deviation(const SimplifiedRing& ring, const Ring& before);

/// Returns the area between a ring and its simplification [m^2].
/// \param before  the corners of the simplification before they moved
double area_between(const SimplifiedRing& ring, const Ring& before);

}  // namespace floe::mesh
