#include "forces/program_force.h"

#include <algorithm>
#include <utility>

#include "base/collectives.h"
#include "floe/base/item.h"

namespace floe {
namespace {

std::string words_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& known) {
    return known.what();
  } catch (...) {
    return "an unknown error";
  }
}

class ProgramForce final : public Force<Spatial>,
                           public DoesWork<Spatial>,
                           public LimitsStep<Spatial>,
                           public PreparesSteps<Spatial>,
                           public Commits<Spatial>,
                           public Persists {
 public:
  ProgramForce(const Part& part, BodyForce force)
      : part_(part), program_(std::move(force)), bodies_(std::make_shared<BodyArrays>()) {
    const auto owned = static_cast<std::size_t>(part.owned);
    BodyArrays& b = *bodies_;
    b.index.assign(part.global.begin(), part.global.begin() + part.owned);
    b.mass.assign(part.bodies.mass.begin(), part.bodies.mass.begin() + part.owned);
    b.position.resize(owned), b.orientation.resize(owned);
    b.velocity.resize(owned), b.spin.resize(owned);
    b.force.resize(owned), b.moment.resize(owned);
  }

  std::string_view name() const override { return "program"; }
  Roles<Spatial> roles() override {
    return {.work = this, .step = this, .prepares = this, .commits = this, .persists = this};
  }

  /// Asks the program, once per step. Collective.
  void before_evaluation(const State<Spatial>& state) override {
    if (is_known_) return;
    BodyArrays& b = *bodies_;
    b.time = state.time;
    for (std::size_t k = 0; k < b.index.size(); ++k) {
      b.position[k] = part_.bodies.position[k] + displacement(state, k);
      b.orientation[k] = rotation(state, k);
      b.velocity[k] = velocity(state, k);
      b.spin[k] = angular_velocity(state, k);
    }
    std::fill(b.force.begin(), b.force.end(), Vec3<double>{});
    std::fill(b.moment.begin(), b.moment.end(), Vec3<double>{});
    std::exception_ptr why;
    try {
      program_.set(bodies_);
    } catch (...) {
      why = std::current_exception();
    }
    const bool failed =
        size(part_.comm) > 1 ? on_any_rank(why != nullptr, part_.comm) : why != nullptr;
    if (failed)
      throw CallbackFailed("a force of the program failed" +
                               (why ? ": " + words_of(why) : std::string(" on another rank")),
                           why);
    is_known_ = true;
  }
  void after_evaluation() override {}
  void commit(const State<Spatial>&, double) override { is_known_ = false; }
  void persist(Archive& archive) override {
    if (archive.loading()) is_known_ = false;
  }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    const BodyArrays& b = *bodies_;
    for (std::size_t k = 0; k < b.index.size(); ++k)
      floe::add(wrenches, k, b.force[k], b.moment[k]);
    power_ = power_with(state);
  }

  double stiffness_bound(std::int32_t body) const override {
    return program_.stiffness * item(part_.bodies.mass, body);
  }
  Rates hidden_stiffness() const override {
    return {.stiffness = program_.stiffness, .damping = program_.damping};
  }

  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    out.front() = power_with(state);
  }
  void report(const State<Spatial>&, std::span<const double> works,
              Columns& columns) const override {
    columns.add("energy_external", works.front());
  }

 private:
  double power_with(const State<Spatial>& state) const {
    const BodyArrays& b = *bodies_;
    double sum = 0;
    for (std::size_t k = 0; k < b.index.size(); ++k)
      sum += dot(b.force[k], velocity(state, k)) + dot(b.moment[k], angular_velocity(state, k));
    return sum;
  }

  const Part& part_;
  BodyForce program_;
  std::shared_ptr<BodyArrays> bodies_;
  bool is_known_ = false;  ///< whether the forces are those of the present step
  double power_ = 0;       ///< in the last evaluation [W]
};

class AppliedWrenches final : public Force<Spatial>, public DoesWork<Spatial>, public Persists {
 public:
  AppliedWrenches(const Part& part, std::shared_ptr<std::vector<AppliedWrench>> wrenches)
      : part_(part), wrenches_(std::move(wrenches)) {}

  std::string_view name() const override { return "applied"; }
  Roles<Spatial> roles() override { return {.work = this, .persists = this}; }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    for_each([&](std::size_t body, const AppliedWrench& w) {
      floe::add(wrenches, body, w.force, w.moment);
    });
    power_ = power_with(state);
  }
  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    out.front() = power_with(state);
  }
  void report(const State<Spatial>&, std::span<const double> works,
              Columns& columns) const override {
    columns.add("energy_external", works.front());
  }
  void persist(Archive& archive) override {
    std::vector<double> numbers;
    for (const auto& [body, f, m] : *wrenches_)
      numbers.insert(numbers.end(), {f.x, f.y, f.z, m.x, m.y, m.z});
    const std::size_t known = numbers.size();
    archive.common("wrenches", numbers);
    for (std::size_t k = 0; archive.loading() && numbers.size() == known && 6 * k < known; ++k) {
      const double* v = &numbers[6 * k];
      (*wrenches_)[k].force = {v[0], v[1], v[2]};
      (*wrenches_)[k].moment = {v[3], v[4], v[5]};
    }
  }

 private:
  template <class Work>
  void for_each(Work&& work) const {
    for (const AppliedWrench& wrench : *wrenches_) {
      const std::int32_t local = part_.local_index(wrench.body);
      if (local >= 0 && local < part_.owned) work(static_cast<std::size_t>(local), wrench);
    }
  }
  double power_with(const State<Spatial>& state) const {
    double sum = 0;
    for_each([&](std::size_t body, const AppliedWrench& w) {
      sum += dot(w.force, velocity(state, body)) + dot(w.moment, angular_velocity(state, body));
    });
    return sum;
  }

  const Part& part_;
  std::shared_ptr<std::vector<AppliedWrench>> wrenches_;
  double power_ = 0;  ///< in the last evaluation [W]
};

}  // namespace

std::unique_ptr<Force<Spatial>> make_program_force(const Part& part, BodyForce force) {
  return std::make_unique<ProgramForce>(part, std::move(force));
}

std::unique_ptr<Force<Spatial>> make_applied_wrenches(
    const Part& part, std::shared_ptr<std::vector<AppliedWrench>> wrenches) {
  return std::make_unique<AppliedWrenches>(part, std::move(wrenches));
}

}  // namespace floe
