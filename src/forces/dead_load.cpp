#include "forces/dead_load.h"

#include <Eigen/Core>

#include <limits>

#include "floe/base/item.h"

namespace floe {
namespace {

/// Axis (0, 1, 2) about which a rotation unknown turns a body.
template <class Space>
constexpr int turns_about(int unknown) {
  return item(Space::components, unknown) - 3;
}

/// A dead force F and moment M: wrench (F, a x F + M) on each body, with a = R r the turned arm.
/// The force has the potential -F.(u + a). A dead moment has no potential, and its exact tangent K
/// has a skew part. With linear kinematics a = r in the wrench, which is therefore constant, and
/// a = r + theta x r in the potential.
template <class Space>
class DeadLoad final : public Force<Space>,
                       public HasTangent<Space>,
                       public DoesWork<Space>,
                       public DependsOnTime,
                       public OnDevice {
 public:
  DeadLoad(const Part& part, PlacedLoad placed, Kinematics kinematics)
      : load_(std::move(placed.load)), part_(part), linear_(kinematics == Kinematics::linear) {
    share_ = 1.0 / static_cast<double>(placed.bodies.size());
    for (const std::int32_t body : placed.bodies) {
      const std::int32_t local = part.local_index(body);
      if (local >= 0 && local < part.owned) bodies_.push_back(local);
    }
    arm_ = placed.arm;
    arms_.resize(bodies_.size());
  }

  std::string_view name() const override { return "load"; }
  Roles<Space> roles() override {
    return {.tangent = this, .work = this, .time = this, .device = linear_ ? nullptr : this};
  }

  void describe(DeviceModel& model) override {
    model.loads.push_back({model.next_work, bodies_, arm_, [this](double time) {
                             const Vec3<double> f = force(time), m = moment(time);
                             return std::array{f.x, f.y, f.z, m.x, m.y, m.z};
                           }});
  }

  void add(const State<Space>& state, Wrenches<Space>& wrenches) override {
    force_ = force(state.time), moment_ = moment(state.time);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const auto b = static_cast<std::size_t>(bodies_[k]);
      arms_[k] = linear_ ? arm_ : turned_arm(state, b);
      floe::add(wrenches, b, force_, moment_ + cross(arms_[k], force_));
    }
    power_ = power_with(state);
  }

  /// The second variation of -F.a along a spin t is (F.a)|t|^2 - (F.t)(a.t).
  bool add_tangent(const State<Space>& state, Tangent<Space>& tangent) const override {
    if (linear_) return false;
    const Vec3<double> f = force(state.time);
    for (const std::int32_t body : bodies_) {
      const Vec3<double> a = turned_arm(state, static_cast<std::size_t>(body));
      Eigen::Matrix3d k;
      for (int r = 0; r < 3; ++r) {
        for (int s = 0; s < 3; ++s) {
          const auto i = static_cast<std::size_t>(r), j = static_cast<std::size_t>(s);
          k(r, s) = (r == s ? dot(f, a) : 0.0) - 0.5 * (f[i] * a[j] + a[i] * f[j]);
        }
      }
      if (!tangent.symmetric()) {
        // K = H - skew(g)/2 with g = -(a x F) the moment gradient of the force; the applied moment
        // is constant and adds nothing.
        const Vec3<double> g = cross(f, a);
        k(0, 1) += 0.5 * g.z, k(1, 0) -= 0.5 * g.z;
        k(0, 2) -= 0.5 * g.y, k(2, 0) += 0.5 * g.y;
        k(1, 2) += 0.5 * g.x, k(2, 1) -= 0.5 * g.x;
      }
      typename Tangent<Space>::Block block{};
      constexpr int n = Space::unknowns;
      for (int r = Space::translations; r < n; ++r) {
        for (int s = Space::translations; s < n; ++s)
          block[entry_of(r, n, s)] = k(turns_about<Space>(r), turns_about<Space>(s));
      }
      tangent.add_body(body, block);
    }
    return true;
  }

  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Space>& state, std::span<double> out) const override {
    out.front() = power_with(state);
  }
  /// Adds the mean force times the displacement of its point, and the mean moment times the
  /// rotation vector of the way.
  void add_works(const State<Space>& from, const State<Space>& to,
                 std::span<double> works) const override {
    const Vec3<double> f = force(to.time) + force(from.time),
                       m = moment(to.time) + moment(from.time);
    for (const std::int32_t body : bodies_) {
      const Place now = place_of(to, body), before = place_of(from, body);
      const Vec3<double> turn = log_rotation(product(now.q, conjugate(before.q)));
      works.front() += 0.5 * (dot(f, now.at - before.at) + dot(m, turn));
    }
  }
  std::vector<double> changes(double end) const override {
    return load_.table.empty() ? std::vector{load_.ramp.seconds} : load_.table.times_until(end);
  }

  /// Reports the potential of the dead force; applied moments have none.
  void report(const State<Space>& state, std::span<const double> works,
              Columns& columns) const override {
    const Vec3<double> f = force(state.time);
    double energy = 0;
    for (const std::int32_t body : bodies_) {
      const auto b = static_cast<std::size_t>(body);
      energy -= dot(f, displacement(state, b) + (turned_arm(state, b) - arm_));
    }
    columns.add("energy_load", energy);
    columns.add("energy_external", works.front());
  }

 private:
  Vec3<double> force(double time) const {
    if (!load_.table.empty()) return share_ * load_.force_at(time);
    return (share_ * load_.ramp.value(time)) * load_.force;
  }
  Vec3<double> moment(double time) const {
    if (!load_.table.empty()) return share_ * load_.moment_at(time);
    return (share_ * load_.ramp.value(time)) * load_.moment;
  }
  Vec3<double> turned_arm(const State<Space>& state, std::size_t body) const {
    if (linear_) return arm_ + cross(linear_rotation(state, body), arm_);
    return rotate(rotation(state, body), arm_);
  }

  /// Power of the wrenches of the last evaluation with the velocities of a state [W].
  double power_with(const State<Space>& state) const {
    double sum = 0;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const auto b = static_cast<std::size_t>(bodies_[k]);
      const Vec3<double> spin = angular_velocity(state, b);
      sum += dot(force_, velocity(state, b) + cross(spin, arms_[k])) + dot(moment_, spin);
    }
    return sum;
  }

  /// Displacement of the point where the force acts [m], and rotation of its body.
  struct Place {
    Vec3<double> at;
    Quat<double> q;
  };
  Place place_of(const State<Space>& state, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    return {displacement(state, b) + (turned_arm(state, b) - arm_), normalised(rotation(state, b))};
  }

  Load load_;
  const Part& part_;
  std::vector<std::int32_t> bodies_;
  double share_ = 1;
  bool linear_;
  Vec3<double> arm_{};
  // By-products of the last evaluation:
  Vec3<double> force_{}, moment_{};  ///< on each body [N, N m]
  std::vector<Vec3<double>> arms_;   ///< per body: from the centroid to the force [m]
  double power_ = 0;                 ///< [W]
};

}  // namespace

PlacedLoad place(const Load& load, const Lattice& lattice) {
  PlacedLoad placed{load, {}, {}};
  if (!load.point) {
    placed.bodies = lattice.set(load.set, "load: " + load.name + ": set");
    return placed;
  }
  const Point2 p = *load.point;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) {
    const Point3& x = item(lattice.bodies.position, b);
    const double dx = p[0] - x[0], dy = p[1] - x[1], distance = dx * dx + dy * dy;
    if (distance >= nearest) continue;
    nearest = distance;
    placed.bodies = {b};
    placed.arm = {dx, dy, 0.0};
  }
  return placed;
}

template <class Space>
std::unique_ptr<Force<Space>> make_load(const Part& part, PlacedLoad load, Kinematics kinematics) {
  return std::make_unique<DeadLoad<Space>>(part, std::move(load), kinematics);
}

template std::unique_ptr<Force<Spatial>> make_load<Spatial>(const Part&, PlacedLoad, Kinematics);
template std::unique_ptr<Force<Planar>> make_load<Planar>(const Part&, PlacedLoad, Kinematics);

}  // namespace floe
