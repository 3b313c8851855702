/// \file
/// Motions by a table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "floe/base/rotation.h"
#include "floe/base/time_table.h"

namespace floe {

/// A motion whose components x, y, z, rx, ry, rz are columns of a table, each as a displacement or
/// rotation [m, rad] or as its rate [m/s, rad/s]; components without a column stay 0.
struct MotionTable {
  struct Column {
    std::int32_t number = -1;  ///< of the table; -1: none
    bool is_rate = false;      ///< the displacement is its integral from time 0
  };
  TimeTable table;
  std::array<Column, 6> columns{};

  bool empty() const { return table.empty(); }
  bool has(std::size_t component) const { return columns[component].number >= 0; }
  double value(std::size_t component, double time) const;         ///< [m, rad]
  double rate(std::size_t component, double time) const;          ///< [m/s, rad/s], from the right
  double acceleration(std::size_t component, double time) const;  ///< [m/s^2, rad/s^2]
  /// Largest size of rate() at all times.
  double largest_rate(std::size_t component) const;

  /// Displacement and its rate [m, m/s].
  Vec3<double> way(double time) const;
  Vec3<double> velocity(double time) const;
  /// Rotation vector and its rate [rad, rad/s], which is no angular velocity.
  Vec3<double> turn(double time) const;
  Vec3<double> turning(double time) const;
  /// Upper bounds, for all times, of |velocity()| and |turning()|.
  double largest_speed() const;
  double largest_turning() const;
};

/// Angular velocity in axes of the world of the rotation exp([t]x) whose vector t changes by
/// `rate`: w = rate + (1 - cos a)/a^2 t x rate + (a - sin a)/a^3 t x (t x rate), a = |t| (Solà et
/// al. 2018, eq. 145). It is no larger than the rate.
Vec3<double> spin_of(const Vec3<double>& turn, const Vec3<double>& rate);

}  // namespace floe
