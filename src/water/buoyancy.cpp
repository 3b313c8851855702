#include "water/buoyancy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "submersion/immersion.h"
#include "submersion/waves.h"

namespace floe {
namespace {

/// Upper bound of the stiffness of buoyancy against heave of an owned body [N/m].
double heave_bound(const Immersion& immersion, const Part& part, double weight_density,
                   std::int32_t body) {
  // The waterplane of a convex body is at most three times its mean horizontal section, which is
  // volume over height (the base of a cone).
  double low = 0, high = 0;
  const auto b = static_cast<std::size_t>(body);
  for (std::int32_t v = part.shapes.vertex_of[b]; v < part.shapes.vertex_of[b + 1]; ++v) {
    low = std::min(low, item(part.shapes.vertices, v)[2]);
    high = std::max(high, item(part.shapes.vertices, v)[2]);
  }
  return high > low ? 3.0 * weight_density * immersion.volume(body) / (high - low) : 0.0;
}

/// Adds the level of still water [m]; one rank tells it.
void add_level(double level, const Part& part, Columns& columns) {
  columns.add("water_level", rank(part.comm) == 0 ? level : 0.0);
}

/// Buoyancy of the owned bodies. With r from the centroid of a body, its submerged part V and its
/// waterplane W (Submerged has the volume, the area and the moments): force rho g V, moment
/// rho g (m_y, -m_x, 0), m = int_V r dV. By Reynolds' theorem, for a displacement u and a spin t,
///   delta int_V f dV = int_V delta f dV - int_W f (u_z + t_x r_y - t_y r_x) dA.
class Buoyancy final : public Force<Spatial>,
                       public HasTangent<Spatial>,
                       public DoesWork<Spatial>,
                       public LimitsStep<Spatial>,
                       public BearsLoad<Spatial>,
                       public OnDevice {
 public:
  Buoyancy(std::shared_ptr<Submersion> submersion, double weight_density)
      : part_(submersion->part()),
        submersion_(std::move(submersion)),
        immersion_(submersion_->immersion()),
        owned_(static_cast<std::size_t>(part_.owned)),
        weight_(weight_density) {
    if (immersion_.has_level()) last_.resize(owned_);
  }

  std::string_view name() const override { return "buoyancy"; }
  Roles<Spatial> roles() override {
    Roles<Spatial> roles{
        .tangent = this, .step = this, .prepares = submersion_.get(), .load = this};
    if (immersion_.has_level()) roles.work = this;
    if (submersion_->has_pace())
      roles.commits = submersion_.get(), roles.persists = submersion_.get();
    roles.device = this;
    return roles;
  }

  void describe(DeviceModel& model) override {
    DeviceWater& water = submersion_->describe(model);
    water.weight_density = weight_;
    if (immersion_.has_level()) water.buoyancy_work = model.next_work;
  }

  /// Bodies that are clipped: 290 ns each time (docs/decisions/53), every k-th step. All others
  /// take the same time as each other.
  void add_load(const State<Spatial>& state, std::span<double> load) const override {
    constexpr double ns_of_clipping = 290;
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      if (immersion_.is_cut_across(state, body))
        item(load, body) += ns_of_clipping / submersion_->pace();
    }
  }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    Submersion& submersion = *submersion_;
    const auto find = [&state, &immersion = immersion_](std::size_t block) {
      const BlockMotion m = block_motion<false>(immersion, state, block);
      return immersion.of_block(state, block, m.u.z, m.q);
    };
    if (submersion.is_paced()) {
      add_by(wrenches, [&](std::size_t block) { return submersion.at_pace(state, block); });
      submersion.volumes_are_kept();
    } else if (submersion.wants_volumes()) {
      add_by(wrenches, [&](std::size_t block) {
        const Immersion::Lane below = find(block);
        submersion.keep_volume(block, below.volume);
        return below;
      });
      submersion.volumes_are_kept();
    } else {
      add_by(wrenches, find);
    }
    if (!last_.empty()) powers_with(state, std::span(&power_, 1));
  }

  /// Below a level that changes, as in waves, the water's pressure does work, and has no potential.
  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    double power = 0;
    for (std::size_t b = 0; b < last_.size(); ++b) {
      const Vec3<double> spin = angular_velocity(state, b);
      power += last_[b][0] * velocity(state, b).z + last_[b][1] * spin.x + last_[b][2] * spin.y;
    }
    out.front() = power;
  }

  bool add_tangent(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const Submerged s = immersion_.of(state, body);
      Tangent<Spatial>::Block k{};
      const auto at = [&k](int row, int column) -> double& { return k[entry_of(row, 6, column)]; };
      at(2, 2) = weight_ * s.waterplane;
      at(2, 3) = at(3, 2) = weight_ * s.wy;
      at(2, 4) = at(4, 2) = -weight_ * s.wx;
      at(3, 3) = weight_ * (s.wyy + s.moment[2]);
      at(4, 4) = weight_ * (s.wxx + s.moment[2]);
      at(3, 4) = at(4, 3) = -weight_ * s.wxy;
      // K has the derivative to t_z in its last column only; the Hessian has half of it in the last
      // column and half in the last row.
      const double share = tangent.symmetric() ? 0.5 : 1.0;
      at(3, 5) = -share * weight_ * s.moment[0];
      at(4, 5) = -share * weight_ * s.moment[1];
      if (tangent.symmetric()) {
        at(5, 3) = at(3, 5);
        at(5, 4) = at(4, 5);
      }
      tangent.add_body(body, k);
    }
    return true;
  }

  double stiffness_bound(std::int32_t body) const override {
    return heave_bound(immersion_, part_, weight_, body);
  }

  /// Approximate rate of heave, with volume^(2/3) for the waterplane. Bodies that the surface does
  /// not cut have no stiffness.
  std::optional<double> rate_estimate(const State<Spatial>& state) const override {
    double fastest2 = 0;
    for (std::size_t block = 0; block < immersion_.blocks(); ++block) {
      const BlockMotion m = block_motion<false>(immersion_, state, block);
      const Lanes volume = immersion_.of_block(state, block, m.u.z, m.q).volume;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t b = immersion_.body_of(block, lane);
        const double whole = immersion_.volume(static_cast<std::int32_t>(b));
        if (volume[lane] > 0 && volume[lane] < whole)
          fastest2 = std::max(fastest2, weight_ * std::cbrt(whole * whole) / part_.bodies.mass[b]);
      }
    }
    return std::sqrt(fastest2);
  }

  /// Reports the potential of the displaced water: rho g times int_V (-z) dV, the work of pushing
  /// the body from the air into the water.
  void report(const State<Spatial>& state, std::span<const double> works,
              Columns& columns) const override {
    if (immersion_.has_level()) {
      add_level(immersion_.level(state.time), part_, columns);
      columns.add("energy_external", works.front());
      return;
    }
    double energy = 0;
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const Submerged s = immersion_.of(state, body);
      energy -= weight_ * (s.moment[2] + immersion_.height(state, body) * s.volume);
    }
    columns.add("energy_water", energy);
  }

 private:
  /// Adds the wrenches. \param below  function from a block to its submerged parts
  template <class Below>
  [[gnu::flatten]] void add_by(Wrenches<Spatial>& wrenches, Below below_of) {
    const Lanes zero(0.0);
    for (std::size_t block = 0; block < immersion_.blocks(); ++block) {
      const Immersion::Lane below = below_of(block);
      const Lanes turn_y = -weight_ * below.moment.x;
      std::array<Row, lanes> rows;
      scatter_four({zero, zero, weight_ * below.volume, weight_ * below.moment.y}, rows);
      for (std::size_t b = block * lanes; b < std::min<std::size_t>((block + 1) * lanes, owned_);
           ++b) {
        double* w = wrenches.of(b);
        add_row(w, rows[b % lanes]);
        w[4] += turn_y[b % lanes];
        if (!last_.empty())
          last_[b] = {weight_ * below.volume[b % lanes], weight_ * below.moment.y[b % lanes],
                      turn_y[b % lanes]};
      }
    }
  }

  const Part& part_;
  std::shared_ptr<Submersion> submersion_;
  const Immersion& immersion_;
  std::size_t owned_;
  double weight_;
  /// Of the last evaluation, below a level that changes: force along z and moments about x and y of
  /// each owned body [N, N m], and their power [W].
  std::vector<std::array<double, 3>> last_;
  double power_ = 0;
};

/// Buoyancy below waves. In axes in which the local plane is level the pressure is that of still
/// water with the weight rho g |(-slope, 1)|; the wrench is turned back.
class BuoyancyInWaves final : public Force<Spatial>,
                              public DoesWork<Spatial>,
                              public LimitsStep<Spatial>,
                              public DependsOnTime {
 public:
  BuoyancyInWaves(std::shared_ptr<SubmersionInWaves> submersion, double weight_density)
      : part_(submersion->part()),
        submersion_(std::move(submersion)),
        immersion_(submersion_->immersion()),
        weight_(weight_density),
        waves_(submersion_->waves()),
        forces_(static_cast<std::size_t>(part_.owned)),
        moments_(forces_) {}

  std::string_view name() const override { return "buoyancy"; }
  Roles<Spatial> roles() override {
    Roles<Spatial> roles{.work = this, .step = this, .prepares = submersion_.get(), .time = this};
    if (submersion_->has_pace())
      roles.commits = submersion_.get(), roles.persists = submersion_.get();
    return roles;
  }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    const bool known = submersion_->knows_volumes();
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto b = static_cast<std::size_t>(body);
      if (known) {
        add_to(wrenches, b, submersion_->plane(b), submersion_->below(b));
      } else {
        const SurfacePlane plane = waves_.plane(b, immersion_.centroid(state, body), state.time);
        add_to(wrenches, b, plane, immersion_.below(state, body, plane));
      }
    }
    powers_with(state, std::span(&power_, 1));
  }

  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    double power = 0;
    for (std::size_t b = 0; b < forces_.size(); ++b)
      power += dot(forces_[b], velocity(state, b)) + dot(moments_[b], angular_velocity(state, b));
    out.front() = power;
  }

  double stiffness_bound(std::int32_t body) const override {
    return waves_.most_steepness() * heave_bound(immersion_, part_, weight_, body);
  }
  /// As in still water, for every body: the surface may reach it at any time.
  std::optional<double> rate_estimate(const State<Spatial>&) const override {
    double fastest2 = 0;
    for (std::int32_t body = 0; body < part_.owned; ++body)
      fastest2 = std::max(
          fastest2, heave_bound(immersion_, part_, weight_, body) / item(part_.bodies.mass, body));
    return std::sqrt(waves_.most_steepness() * fastest2);
  }
  std::vector<double> changes(double end) const override { return {end}; }

  void report(const State<Spatial>& state, std::span<const double> works,
              Columns& columns) const override {
    if (const WaterMotion& water = waves_.water(); !water.level_table.empty())
      add_level(water.level(state.time), part_, columns);
    columns.add("energy_external", works.front());
  }

 private:
  void add_to(Wrenches<Spatial>& wrenches, std::size_t b, const SurfacePlane& plane,
              const Submerged& s) {
    const Vec3<double> arm = rotate(conjugate(plane.to_level()), s.moment);
    const Vec3<double> pressure{-weight_ * plane.slope_x, -weight_ * plane.slope_y, weight_};
    forces_[b] = s.volume * pressure;
    moments_[b] = cross(arm, pressure);
    floe::add(wrenches, b, forces_[b], moments_[b]);
  }

  const Part& part_;
  std::shared_ptr<SubmersionInWaves> submersion_;
  const Immersion& immersion_;
  double weight_;
  const Waves& waves_;
  std::vector<Vec3<double>> forces_, moments_;  ///< of the last evaluation [N, N m]
  double power_ = 0;                            ///< of the last evaluation [W]
};

}  // namespace

std::unique_ptr<Force<Spatial>> make_buoyancy_in_waves(const Part& part, double weight_density,
                                                       double gravity, const WaveOptions& waves) {
  return make_buoyancy(
      std::make_shared<SubmersionInWaves>(require_shapes(part, "buoyancy"),
                                          Waves(part, gravity, waves, {}), 1, false),
      weight_density);
}
std::unique_ptr<Force<Spatial>> make_buoyancy(std::shared_ptr<SubmersionInWaves> submersion,
                                              double weight_density) {
  return std::make_unique<BuoyancyInWaves>(std::move(submersion), weight_density);
}

template <>
std::unique_ptr<Force<Spatial>> make_buoyancy<Spatial>(const Part& part, double weight_density) {
  return make_buoyancy(std::make_shared<Submersion>(require_shapes(part, "buoyancy"), 1, false),
                       weight_density);
}
std::unique_ptr<Force<Spatial>> make_buoyancy(std::shared_ptr<Submersion> submersion,
                                              double weight_density) {
  return std::make_unique<Buoyancy>(std::move(submersion), weight_density);
}

std::vector<double> displaced_mass(const Part& part, double density) {
  const Immersion immersion(require_shapes(part, "buoyancy"));
  const State<Spatial> rest(static_cast<std::size_t>(part.local));
  std::vector<double> mass;
  mass.reserve(static_cast<std::size_t>(part.owned));
  for (std::int32_t body = 0; body < part.owned; ++body)
    mass.push_back(density * immersion.of(rest, body).volume);
  return mass;
}

}  // namespace floe
