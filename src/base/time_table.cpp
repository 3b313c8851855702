#include "floe/base/time_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace floe {
namespace {

/// a + b s + c s^2 + d s^3, s from the beginning of a piece, and its integral up to there from the
/// first row.
struct Cubic {
  double a = 0, b = 0, c = 0, d = 0, before = 0;

  double value(double s) const { return a + s * (b + s * (c + s * d)); }
  double rate(double s) const { return b + s * (2 * c + s * (3 * d)); }
  double second(double s) const { return 2 * c + s * (6 * d); }
  double integral(double s) const {
    return before + s * (a + s * (b / 2 + s * (c / 3 + s * (d / 4))));
  }
};

/// Slope at a row between pieces of lengths h and slopes delta: a harmonic mean, 0 at an extremum.
double slope_between(double h0, double delta0, double h1, double delta1) {
  if (!(delta0 * delta1 > 0)) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / delta0 + w1 / delta1);
}

/// Slope at an end: that of the parabola through three rows, as far as it keeps the shape.
double slope_at_end(double h0, double delta0, double h1, double delta1) {
  const double slope = ((2 * h0 + h1) * delta0 - h0 * delta1) / (h0 + h1);
  if (!(slope * delta0 > 0)) return 0;
  if (delta0 * delta1 <= 0 && std::abs(slope) > 3 * std::abs(delta0)) return 3 * delta0;
  return slope;
}

/// Slopes at the rows of one column of a smooth table.
std::vector<double> slopes_of(const std::vector<double>& h, const std::vector<double>& delta,
                              bool periodic) {
  const std::size_t n = h.size();  // pieces
  std::vector<double> slopes(n + 1);
  if (n == 1) return {delta[0], delta[0]};
  for (std::size_t k = 1; k < n; ++k)
    slopes[k] = slope_between(h[k - 1], delta[k - 1], h[k], delta[k]);
  if (periodic) {
    slopes[0] = slopes[n] = slope_between(h[n - 1], delta[n - 1], h[0], delta[0]);
  } else {
    slopes[0] = slope_at_end(h[0], delta[0], h[1], delta[1]);
    slopes[n] = slope_at_end(h[n - 1], delta[n - 1], h[n - 2], delta[n - 2]);
  }
  return slopes;
}

}  // namespace

/// Pieces between rows; before the first and after the last one are pieces that stay.
struct TimeTable::Data {
  std::vector<double> times;
  std::size_t columns = 0;
  bool periodic = false;
  std::vector<Cubic> pieces;    ///< times.size() - 1 times columns
  std::vector<double> first;    ///< per column: value in the first row
  std::vector<double> last;     ///< in the last row
  std::vector<double> whole;    ///< integral from the first row to the last
  std::vector<double> to_zero;  ///< antiderivative at time 0
  double span() const { return times.back() - times.front(); }
};

/// Where a time lies.
struct TimeTable::Place {
  enum { before, within, after } where = within;
  std::size_t piece = 0;  ///< within
  double s = 0;     ///< from the piece's row; before and after: from the first or last row [s]
  double laps = 0;  ///< whole periods from the first row
};

TimeTable::TimeTable(const std::vector<std::vector<double>>& rows, Interpolation interpolation,
                     bool periodic) {
  if (rows.size() < 2 || rows.front().size() < 2)
    throw std::invalid_argument("TimeTable: less than two rows or no column");
  auto data = std::make_shared<Data>();
  data->columns = rows.front().size() - 1;
  data->periodic = periodic;
  for (const std::vector<double>& row : rows) {
    if (row.size() != rows.front().size())
      throw std::invalid_argument("TimeTable: rows of different length");
    if (!data->times.empty() && !(row[0] > data->times.back()))
      throw std::invalid_argument("TimeTable: times do not rise");
    data->times.push_back(row[0]);
  }
  const std::size_t n = rows.size() - 1;
  data->pieces.resize(n * data->columns);
  for (std::size_t c = 0; c < data->columns; ++c) {
    const auto y = [&](std::size_t k) { return rows[k][c + 1]; };
    if (periodic && y(0) != y(n))
      throw std::invalid_argument("TimeTable: the last row is not the first");
    std::vector<double> h(n), delta(n), slopes;
    for (std::size_t k = 0; k < n; ++k) {
      h[k] = rows[k + 1][0] - rows[k][0];
      delta[k] = (y(k + 1) - y(k)) / h[k];
    }
    if (interpolation == Interpolation::smooth) slopes = slopes_of(h, delta, periodic);
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
      Cubic& p = data->pieces[k * data->columns + c];
      p.a = y(k), p.b = delta[k], p.before = sum;
      if (!slopes.empty()) {  // Hermite's cubic
        p.b = slopes[k];
        p.c = (3 * delta[k] - 2 * slopes[k] - slopes[k + 1]) / h[k];
        p.d = (slopes[k] + slopes[k + 1] - 2 * delta[k]) / (h[k] * h[k]);
      }
      sum = p.integral(h[k]);
    }
    data->first.push_back(y(0)), data->last.push_back(y(n)), data->whole.push_back(sum);
  }
  data_ = data;
  for (std::size_t c = 0; c < data->columns; ++c) data->to_zero.push_back(antiderivative(c, 0));
}

std::size_t TimeTable::columns() const { return data_ ? data_->columns : 0; }

TimeTable::Place TimeTable::place(double time) const {
  const std::vector<double>& times = data_->times;
  Place at;
  if (data_->periodic) {
    const double span = data_->span();
    at.laps = std::floor((time - times.front()) / span);
    time -= at.laps * span;
    if (time >= times.back()) time = times.front(), at.laps += 1;  // by rounding
    time = std::max(time, times.front());
  } else if (time < times.front()) {
    return {Place::before, 0, time - times.front(), 0};
  } else if (time >= times.back()) {
    return {Place::after, 0, time - times.back(), 0};
  }
  const auto above = std::upper_bound(times.begin() + 1, times.end() - 1, time);
  at.piece = static_cast<std::size_t>(above - times.begin()) - 1;
  at.s = time - times[at.piece];
  return at;
}

double TimeTable::value(std::size_t column, double time) const {
  const Place at = place(time);
  if (at.where == Place::before) return data_->first[column];
  if (at.where == Place::after) return data_->last[column];
  return data_->pieces[at.piece * data_->columns + column].value(at.s);
}

double TimeTable::rate(std::size_t column, double time) const {
  const Place at = place(time);
  if (at.where != Place::within) return 0;
  return data_->pieces[at.piece * data_->columns + column].rate(at.s);
}

double TimeTable::second(std::size_t column, double time) const {
  const Place at = place(time);
  if (at.where != Place::within) return 0;
  return data_->pieces[at.piece * data_->columns + column].second(at.s);
}

/// Integral from the first row.
double TimeTable::antiderivative(std::size_t column, double time) const {
  const Place at = place(time);
  if (at.where == Place::before) return at.s * data_->first[column];
  if (at.where == Place::after) return data_->whole[column] + at.s * data_->last[column];
  const Cubic& piece = data_->pieces[at.piece * data_->columns + column];
  return at.laps * data_->whole[column] + piece.integral(at.s);
}

double TimeTable::integral(std::size_t column, double time) const {
  return antiderivative(column, time) - data_->to_zero[column];
}

double TimeTable::largest(std::size_t column) const {
  // A monotone piece is largest at one of its rows.
  double most = std::abs(data_->last[column]);
  for (std::size_t k = column; k < data_->pieces.size(); k += data_->columns)
    most = std::max(most, std::abs(data_->pieces[k].a));
  return most;
}

double TimeTable::largest_rate(std::size_t column) const {
  double most = 0;
  for (std::size_t k = 0; k + 1 < data_->times.size(); ++k) {
    const Cubic& p = data_->pieces[k * data_->columns + column];
    const double h = data_->times[k + 1] - data_->times[k];
    most = std::max({most, std::abs(p.rate(0)), std::abs(p.rate(h))});
    const double flat = p.d != 0 ? -p.c / (3 * p.d) : 0;
    if (flat > 0 && flat < h) most = std::max(most, std::abs(p.rate(flat)));
  }
  return most;
}

std::vector<double> TimeTable::times() const {
  return data_ ? data_->times : std::vector<double>{};
}

std::vector<double> TimeTable::times_until(double end) const {
  std::vector<double> times;
  if (empty()) return times;
  const double span = data_->span();
  double shift = data_->periodic ? span * std::floor(-data_->times.front() / span) : 0;
  for (;; shift += span) {
    for (const double row : data_->times) {
      const double time = row + shift;
      if (time > end) return times;
      if (time > 0 && (times.empty() || time > times.back())) times.push_back(time);
    }
    if (!data_->periodic) return times;
  }
}

}  // namespace floe
