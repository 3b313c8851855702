/// \file
/// Mooring lines of structures (model.md, "Structures").
#pragma once

#include <string>
#include <vector>

#include "floe/base/motion_table.h"
#include "floe/base/ramp.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// The tension of a line against the distance of its ends: straight between the rows of a table,
/// and beyond its ends as in the row next to these; never below 0. Rows: lengths rise, tensions do
/// not fall.
class TensionCurve {
 public:
  struct Row {
    double length, tension;  ///< [m, N]
  };
  TensionCurve() = default;
  /// \throws std::invalid_argument for less than two rows, or rows that do not rise
  explicit TensionCurve(std::vector<Row> rows);

  double tension(double length) const;  ///< [N]
  double slope(double length) const;    ///< [N/m]; 0 where slack
  double energy(double length) const;   ///< work of lengthening it from where it is slack [J]
  double steepest() const;              ///< largest slope [N/m]
  /// Length at which it has a tension > 0 [m].
  double length_at(double tension) const;
  /// Makes all lengths longer by so much [m].
  void lengthen(double by);

 private:
  std::size_t piece(double length) const;
  double rise(std::size_t piece) const;
  std::vector<Row> rows_;
  std::vector<double> energy_;  ///< at the rows, from where the line is slack [J]
};

/// A line from a structure to the ground, or to an anchor that moves: by its velocity times the
/// integral of the ramp, or by a table.
struct MooringLine {
  std::string name;
  std::int32_t body = -1;       ///< global index of the structure
  Point3 fairlead{}, anchor{};  ///< ends, the fairlead at rest [m]
  TensionCurve curve;
  double damping = 0;        ///< along the taut line [N s/m]
  Point3 anchor_velocity{};  ///< after the ramp [m/s]
  Ramp anchor_ramp{};
  MotionTable anchor_table{};  ///< in place of these; empty: none

  bool moves() const { return !anchor_table.empty() || !(anchor_velocity == Point3{}); }
  Point3 anchor_at(double time) const;           ///< [m]
  Point3 anchor_velocity_at(double time) const;  ///< [m/s]
};

}  // namespace floe
