/// \file
/// The far edge of a sheet that goes on behind it (model.md, "Ice without end").
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "floe/forces/boundary.h"
#include "forces/force.h"

namespace floe {

/// The part of the edge that a body has.
struct EdgeArea {
  std::int32_t body;  ///< global index
  double area;        ///< [m^2]
};

/// The ice behind the far edge.
struct FarIce {
  Boundary motion;        ///< its x and y
  double normal = 0;      ///< impedance along x, rho c [Pa s/m]
  double tangential = 0;  ///< the same along y
  double spring = 0;      ///< stiffness along x of the ice behind [Pa/m]
  double offset = 0;      ///< by which it is ahead of its motion, since it is compressed [m]
  /// In place of the motion: mean pressure on the edge, times the motion's ramp [Pa], and the time
  /// over which the edge's mean velocity is taken [s].
  std::optional<double> pressure;
  double response = 0;
  std::int64_t strip = 0;  ///< whose edge it is
};

/// Dashpots that do not reflect waves of the sheet (Lysmer & Kuhlemeyer 1969), on velocities
/// relative to those of the ice behind, beside a spring to its place; or to the mean velocity of
/// the edge itself, beside a pressure.
template <class Space>
class FarEdge : public Force<Space> {
 public:
  /// Mean pressure on the edge since it has been that of its strip [Pa]; the same bits on any
  /// number of ranks. Collective.
  virtual double mean_pressure() const = 0;
};

/// \param part  must outlive the force
template <class Space>
std::unique_ptr<FarEdge<Space>> make_far_edge(const Part& part, const std::vector<EdgeArea>& areas,
                                              const FarIce& ice);

}  // namespace floe
