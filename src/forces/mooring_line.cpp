#include "forces/mooring_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "floe/base/item.h"

namespace floe {

TensionCurve::TensionCurve(std::vector<Row> rows) : rows_(std::move(rows)) {
  if (rows_.size() < 2) throw std::invalid_argument("TensionCurve: less than two rows");
  for (std::size_t k = 1; k < rows_.size(); ++k) {
    if (!(rows_[k].length > rows_[k - 1].length) || !(rows_[k].tension >= rows_[k - 1].tension))
      throw std::invalid_argument("TensionCurve: rows do not rise");
  }
  // Before the first row the line goes slack along the first piece.
  const double first = rows_.front().tension, slope = rise(0);
  energy_.assign(1, slope > 0 ? 0.5 * first * first / slope : 0);
  for (std::size_t k = 1; k < rows_.size(); ++k)
    energy_.push_back(energy_.back() + 0.5 * (rows_[k].tension + rows_[k - 1].tension) *
                                           (rows_[k].length - rows_[k - 1].length));
}

/// Number of the piece between rows k and k + 1 in which a length lies, or that goes on to it.
std::size_t TensionCurve::piece(double length) const {
  const auto above = std::upper_bound(rows_.begin() + 1, rows_.end() - 1, length,
                                      [](double l, const Row& row) { return l < row.length; });
  return static_cast<std::size_t>(above - rows_.begin()) - 1;
}

double TensionCurve::rise(std::size_t piece) const {
  const Row &a = rows_[piece], &b = rows_[piece + 1];
  return (b.tension - a.tension) / (b.length - a.length);
}

double TensionCurve::tension(double length) const {
  const std::size_t k = piece(length);
  return std::max(0.0, rows_[k].tension + rise(k) * (length - rows_[k].length));
}

double TensionCurve::slope(double length) const {
  return tension(length) > 0 ? rise(piece(length)) : 0;
}

double TensionCurve::energy(double length) const {
  const double now = tension(length);
  if (now <= 0) return 0;
  const std::size_t k = piece(length);
  return energy_[k] + 0.5 * (rows_[k].tension + now) * (length - rows_[k].length);
}

double TensionCurve::steepest() const {
  double most = 0;
  for (std::size_t k = 0; k + 1 < rows_.size(); ++k) most = std::max(most, rise(k));
  return most;
}

double TensionCurve::length_at(double tension) const {
  std::size_t k = 0;
  while (k + 2 < rows_.size() && rows_[k + 1].tension < tension) ++k;
  return rows_[k].length + (tension - rows_[k].tension) / rise(k);
}

void TensionCurve::lengthen(double by) {
  for (Row& row : rows_) row.length += by;
}

Point3 MooringLine::anchor_at(double time) const {
  if (!moves()) return anchor;
  if (!anchor_table.empty()) return anchor + anchor_table.way(time);
  return anchor + anchor_ramp.integral(time) * anchor_velocity;
}

Point3 MooringLine::anchor_velocity_at(double time) const {
  if (!anchor_table.empty()) return anchor_table.velocity(time);
  return anchor_ramp.value(time) * anchor_velocity;
}

namespace {

class MooringLines final : public Force<Spatial>,
                           public DoesWork<Spatial>,
                           public LimitsStep<Spatial> {
 public:
  MooringLines(const Part& part, std::vector<MooringLine> lines) {
    for (MooringLine& line : lines) {
      moves_ = moves_ || line.moves();
      const std::int32_t local = part.local_index(line.body);
      const bool here = local >= 0 && local < part.owned;
      Held held{.line = std::move(line), .local = here ? local : -1};
      if (here) {
        held.rest = item(part.bodies.position, local);
        held.arm = held.line.fairlead - held.rest;
      }
      all_.push_back(std::move(held));
    }
  }

  std::string_view name() const override { return "line"; }
  Roles<Spatial> roles() override { return {.work = this, .step = this}; }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    for (Held& held : all_) {
      if (held.local < 0) continue;
      const auto b = static_cast<std::size_t>(held.local);
      const Vec3<double> arm = rotate(rotation(state, b), held.arm);
      const Vec3<double> way =
          held.line.anchor_at(state.time) - (held.rest + displacement(state, b) + arm);
      held.length = length(way);
      const Vec3<double> along = held.length > 0 ? (1 / held.length) * way : Vec3<double>{};
      const double elastic = held.line.curve.tension(held.length);
      const Vec3<double> v = velocity(state, b) + cross(angular_velocity(state, b), arm);
      // A line only pulls.
      held.along = along;
      const Vec3<double> against = held.line.moves() ? v - anchor_velocity(held, state) : v;
      const double viscous =
          elastic > 0 ? std::max(-elastic, -held.line.damping * dot(against, along)) : 0;
      held.viscous = viscous;
      held.tension = elastic + viscous;
      held.damping = viscous * along;
      held.damping_moment = cross(arm, held.damping);
      const Vec3<double> force = held.tension * along;
      floe::add(wrenches, b, force, cross(arm, force));
    }
    powers_with(state, powers_);
  }

  /// Powers of the dashpots, and of what moves the anchors.
  std::size_t works() const override { return 2; }
  void powers(std::span<double> out) const override {
    std::copy(powers_.begin(), powers_.end(), out.begin());
  }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    out[0] = power_with(state), out[1] = 0;
    for (const Held& held : all_) {
      if (held.local < 0 || !held.line.moves()) continue;
      const double away = dot(held.along, anchor_velocity(held, state));
      out[0] -= held.viscous * away;
      out[1] += held.tension * away;
    }
  }

  double stiffness_bound(std::int32_t body) const override {
    double bound = 0;
    for (const Held& held : all_)
      if (held.local == body) bound += held.line.curve.steepest();
    return bound;
  }

  void report(const State<Spatial>&, std::span<const double> works,
              Columns& columns) const override {
    double energy = 0;
    for (const Held& held : all_)
      if (held.local >= 0) energy += held.line.curve.energy(held.length);
    columns.add("energy_lines", energy);
    columns.add("energy_damping", 0.0 - works.front());
    if (moves_) columns.add("energy_external", works[1]);
    for (const Held& held : all_) {
      columns.add(held.line.name + "_tension", held.local >= 0 ? held.tension : 0.0);
      columns.add(held.line.name + "_length", held.local >= 0 ? held.length : 0.0);
    }
  }

 private:
  struct Held {
    MooringLine line;
    std::int32_t local = -1;  ///< owned body; -1: on another rank
    Vec3<double> rest{}, arm{};
    double length = 0, tension = 0;            ///< in the last evaluation [m, N]
    double viscous = 0;                        ///< part of the tension [N]
    Vec3<double> along{};                      ///< from the fairlead to the anchor
    Vec3<double> damping{}, damping_moment{};  ///< of the dashpot, about the centroid
  };

  /// Velocity of an anchor at the time of a state's velocities [m/s].
  static Vec3<double> anchor_velocity(const Held& held, const State<Spatial>& state) {
    return held.line.anchor_velocity_at(state.velocity_time);
  }

  double power_with(const State<Spatial>& state) const {
    double power = 0;
    for (const Held& held : all_) {
      if (held.local < 0) continue;
      const auto b = static_cast<std::size_t>(held.local);
      power += dot(held.damping, velocity(state, b)) +
               dot(held.damping_moment, angular_velocity(state, b));
    }
    return power;
  }

  std::vector<Held> all_;
  bool moves_ = false;              ///< whether an anchor moves
  std::array<double, 2> powers_{};  ///< of the last evaluation [W]
};

}  // namespace

std::unique_ptr<Force<Spatial>> make_mooring_lines(const Part& part,
                                                   std::vector<MooringLine> lines) {
  return std::make_unique<MooringLines>(part, std::move(lines));
}

}  // namespace floe
