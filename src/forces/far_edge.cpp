#include "forces/far_edge.h"

#include <algorithm>
#include <cmath>

#include "base/collectives.h"
#include "floe/base/item.h"

namespace floe {
namespace {

template <class Space>
class Dashpots final : public FarEdge<Space>,
                       public DoesWork<Space>,
                       public LimitsStep<Space>,
                       public Commits<Space>,
                       public Persists {
 public:
  Dashpots(const Part& part, const std::vector<EdgeArea>& areas, const FarIce& ice)
      : part_(part), ice_(ice) {
    for (const EdgeArea& edge : areas) {
      whole_ += edge.area;
      const std::int32_t local = part.local_index(edge.body);
      if (local < 0 || local >= part.owned) continue;
      bodies_.push_back(local);
      areas_.push_back(edge.area);
    }
    forces_.resize(bodies_.size());
    means_.resize(2 * bodies_.size());
    lags_.resize(2 * bodies_.size());
    impulses_.resize(bodies_.size());
  }

  std::string_view name() const override { return "far_edge"; }
  Roles<Space> roles() override {
    return {.work = this, .step = this, .commits = this, .persists = this};
  }

  void add(const State<Space>& state, Wrenches<Space>& wrenches) override {
    const std::array<double, 6> place = ice_.motion.value(state.time),
                                rate = ice_.motion.rate(state.velocity_time);
    const double pressure =
        ice_.pressure ? *ice_.pressure * ice_.motion.ramp.value(state.time) : 0.0;
    if (ice_.pressure && !has_means_) begin_means(state);
    power_ = 0;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const auto b = static_cast<std::size_t>(bodies_[k]);
      const Vec3<double> u = displacement(state, b), v = velocity(state, b);
      const double x = ice_.pressure ? means_[2 * k] : rate[0],
                   y = ice_.pressure ? means_[2 * k + 1] : rate[1];
      const Vec3<double> force =
          areas_[k] * Vec3<double>{ice_.normal * (x - v.x) + pressure +
                                       ice_.spring * (place[0] + ice_.offset - u.x),
                                   ice_.tangential * (y - v.y), 0};
      forces_[k] = force;
      lags_[2 * k] = x - v.x, lags_[2 * k + 1] = y - v.y;
      power_ += dot(force, v);
      floe::add(wrenches, b, force, {});
    }
  }

  double stiffness_bound(std::int32_t body) const override {
    const auto at = std::find(bodies_.begin(), bodies_.end(), body);
    return at == bodies_.end() ? 0 : ice_.spring * item(areas_, at - bodies_.begin());
  }

  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Space>& state, std::span<double> out) const override {
    out.front() = 0;
    for (std::size_t k = 0; k < bodies_.size(); ++k)
      out.front() += dot(forces_[k], velocity(state, static_cast<std::size_t>(bodies_[k])));
  }

  void commit(const State<Space>& state, double dt) override {
    for (std::size_t k = 0; k < bodies_.size(); ++k) impulses_[k] += dt * forces_[k].x;
    time_ += dt;
    if (!ice_.pressure) return;
    const double share = -std::expm1(-dt / ice_.response);  // of dm/dt = (v - m)/response
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const Vec3<double> v = velocity(state, static_cast<std::size_t>(bodies_[k]));
      means_[2 * k] += share * (v.x - means_[2 * k]);
      means_[2 * k + 1] += share * (v.y - means_[2 * k + 1]);
    }
  }

  void report(const State<Space>&, std::span<const double> works, Columns& columns) const override {
    columns.add("energy_external", works.front());
    Vec3<double> sum{};
    for (const Vec3<double>& force : forces_) sum = sum + force;
    columns.add("far_edge_force_x", sum.x);
    columns.add("far_edge_force_y", sum.y);
  }

  void persist(Archive& archive) override {
    std::int64_t strip = ice_.strip;
    archive.common("strip", strip);
    archive.common("time", time_, not_negative);
    archive.rows("impulse", bodies_, impulses_, 1);
    if (ice_.pressure) {
      archive.rows("mean_velocity", bodies_, means_, 2);
      archive.common("has_means", has_means_);
      if (!archive.loading())
        for (const std::size_t c : {0U, 1U})
          lag_[c] =
              sum_over_edge([&](std::size_t k) { return areas_[k] * lags_[2 * k + c]; }) / whole_;
      archive.common("lag_x", lag_[0]);
      archive.common("lag_y", lag_[1]);
    }
    if (strip == ice_.strip) return;
    time_ = 0;  // of an edge that is no more
    std::fill(impulses_.begin(), impulses_.end(), 0.0);
    has_means_ = false;
  }

  double mean_pressure() const override {
    const double sum = sum_over_edge([&](std::size_t k) { return impulses_[k]; });
    return time_ > 0 ? sum / (time_ * whole_) : 0;
  }

 private:
  /// Sums over the bodies of the edge in their order, whatever the ranks. Collective.
  template <class Value>
  double sum_over_edge(Value&& value) const {
    std::vector<double> mine;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      mine.push_back(item(part_.global, bodies_[k]));
      mine.push_back(value(k));
    }
    const std::vector<double> all = all_gathered(mine, part_.comm);
    std::vector<std::array<double, 2>> in_order(all.size() / 2);
    for (std::size_t k = 0; k < in_order.size(); ++k) in_order[k] = {all[2 * k], all[2 * k + 1]};
    std::sort(in_order.begin(), in_order.end());
    double sum = 0;
    for (const auto& [body, of_body] : in_order) sum += of_body;
    return sum;
  }

  /// To bodies that have just become the edge the ice behind goes as it went to the edge before.
  void begin_means(const State<Space>& state) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const Vec3<double> v = velocity(state, static_cast<std::size_t>(bodies_[k]));
      means_[2 * k] = v.x + lag_[0], means_[2 * k + 1] = v.y + lag_[1];
    }
    has_means_ = true;
  }

  const Part& part_;
  FarIce ice_;
  double whole_ = 0;                  ///< area of the edge [m^2]
  std::vector<std::int32_t> bodies_;  ///< owned ones at the edge
  std::vector<double> areas_, impulses_;
  std::vector<double> means_;    ///< of velocities along x and y, with a pressure [m/s]
  std::vector<double> lags_;     ///< of the velocities in the last evaluation [m/s]
  std::array<double, 2> lag_{};  ///< mean over the edge when the strip before joined [m/s]
  bool has_means_ = false;
  std::vector<Vec3<double>> forces_;  ///< in the last evaluation
  double power_ = 0, time_ = 0;
};

}  // namespace

template <class Space>
std::unique_ptr<FarEdge<Space>> make_far_edge(const Part& part, const std::vector<EdgeArea>& areas,
                                              const FarIce& ice) {
  return std::make_unique<Dashpots<Space>>(part, areas, ice);
}

template std::unique_ptr<FarEdge<Spatial>> make_far_edge(const Part&, const std::vector<EdgeArea>&,
                                                         const FarIce&);
template std::unique_ptr<FarEdge<Planar>> make_far_edge(const Part&, const std::vector<EdgeArea>&,
                                                        const FarIce&);

}  // namespace floe
