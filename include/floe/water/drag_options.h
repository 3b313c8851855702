/// \file
/// Drag of the water, as a scene states it.
#pragma once

#include "floe/geometry/polyhedron.h"
#include "floe/water/water_motion.h"

namespace floe {

/// Options of drag (model.md, "Water").
struct DragOptions {
  double linear = 0;          ///< c of the linear law [N s/m^3] (the paper: Stokes)
  double coefficient = 0;     ///< C_d of the quadratic law
  double density = 1010;      ///< rho_w [kg/m^3]
  Point3 current{};           ///< velocity of the water [m/s]
  TimeTable current_table{};  ///< of the current, in place of it; empty: none
  TimeTable level_table{};    ///< of the water's level [m]; empty: 0

  bool faces = false;  ///< drag on the wetted faces, by the three numbers below
  double form = 0;     ///< C_d of faces that move against the water
  double skin = 0;     ///< C_s of the flow along faces
  double shelter = 0;  ///< a face with another body within this distance feels no drag [m]

  WaterMotion water() const { return {current, current_table, level_table}; }
};

}  // namespace floe
