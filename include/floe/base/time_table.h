/// \file
/// Values that change with time as a table says.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace floe {

/// Columns of values against time. Between rows each column is straight (linear), or a cubic that
/// is monotone where the rows are (smooth: Fritsch & Carlson 1980, SIAM J. Numer. Anal. 17, with
/// the slopes of Fritsch & Butland 1984, SIAM J. Sci. Stat. Comput. 5): it passes no row's value
/// by. Before the first and after the last row the values stay; a periodic table repeats itself at
/// all times. All functions of time are from the right, and the same on every rank; copies share
/// the rows. A lookup is a binary search.
class TimeTable {
 public:
  enum class Interpolation { linear, smooth };

  TimeTable() = default;
  /// \param rows  each a time [s] and one value per column; two at least, times rise
  /// \param periodic  the last row has the values of the first
  /// \throws std::invalid_argument
  TimeTable(const std::vector<std::vector<double>>& rows, Interpolation interpolation,
            bool periodic);

  bool empty() const { return data_ == nullptr; }
  std::size_t columns() const;

  double value(std::size_t column, double time) const;
  double rate(std::size_t column, double time) const;    ///< [1/s of the values']
  double second(std::size_t column, double time) const;  ///< rate of the rate
  /// Integral of the value from time 0 [s times the values'].
  double integral(std::size_t column, double time) const;

  /// Largest size of the value, and of the rate, at all times.
  double largest(std::size_t column) const;
  double largest_rate(std::size_t column) const;

  /// Times of the rows [s].
  std::vector<double> times() const;
  /// Times of the rows, each time that they come, after 0 and up to `end` [s].
  std::vector<double> times_until(double end) const;

 private:
  struct Data;
  struct Place;
  Place place(double time) const;
  double antiderivative(std::size_t column, double time) const;
  std::shared_ptr<const Data> data_;
};

}  // namespace floe
