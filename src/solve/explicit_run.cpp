#include "solve/explicit_run.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "solve/text.h"

namespace floe {

ExplicitRun::ExplicitRun(std::string_view type, Model<Spatial>& model,
                         const ExplicitOptions& options, const Observer<Spatial>& observer)
    : DynamicRun("explicit", type, model, options, observer), explicit_options_(options) {}

StableStep ExplicitRun::look() {
  const StableStep stable = find_stable_step();
  evaluations_ = stable.evaluations;
  last_look_ = done();
  last_stable_ = stable.dt;
  last_rate_ = fastest_rate();
  last_own_ = own_stiffness();
  return stable;
}

void ExplicitRun::choose_step() {
  const StableStep stable = look();
  result().stable_dt = stable.dt;
  result().limited_by = stable.limit;
  const double given = options().dt;
  if (given > stable.dt && !explicit_options_.allow_unstable)
    throw InputError("time: dt: " + text(given) + " must be <= " + text(stable.dt) +
                     " [s], the stable step, limited by the " + stable.limit +
                     " (time: allow_unstable: true takes it all the same)");
  const double wanted = given > 0 ? given : explicit_options_.safety * stable.dt;
  if (!std::isfinite(wanted))
    throw InputError("time: dt: auto finds no force that limits the step; give one");
  plan(wanted);
}

/// Sum of the forces' own fastest rates, of all ranks' bodies; 0 if none has any.
double ExplicitRun::fastest_rate() {
  std::vector<double> rates;
  for (const auto& force : model().forces()) {
    if (const auto rate = force->fastest_rate(state())) rates.push_back(*rate);
  }
  if (rates.empty()) return 0;
  MPI_Allreduce(MPI_IN_PLACE, rates.data(), static_cast<int>(rates.size()), MPI_DOUBLE, MPI_MAX,
                model().part().comm);
  return std::accumulate(rates.begin(), rates.end(), 0.0);
}

/// Sum of the bounds that forces give themselves [1/s^2].
double ExplicitRun::own_stiffness() {
  double sum = 0;
  for (const auto& force : model().forces()) sum += force->own_rates().stiffness;
  return sum;
}

/// The least stable step that dt is taken with.
double ExplicitRun::needed() const {
  return options().dt > 0 ? dt() : dt() / (0.5 * (1 + explicit_options_.safety));
}

bool ExplicitRun::look_is_due() {
  if (explicit_options_.allow_unstable || done() == 0) return false;
  if (own_stiffness() > last_own_) return true;
  // A step costs about an evaluation, and the rates less than half of it.
  constexpr std::int64_t now_and_then = 100, least = 1000, share = 100;
  if (done() - last_look_ >= std::max(least, share * evaluations_)) return true;
  if (!sampled() && done() % now_and_then != 0) return false;
  const double rate = fastest_rate();
  return rate > last_rate_ && !(last_stable_ * (last_rate_ / rate) >= needed());
}

bool ExplicitRun::keep_step_stable(TS ts) {
  if (!look_is_due()) return true;
  const StableStep stable = look();
  if (stable.dt < result().stable_dt) {
    result().stable_dt = stable.dt;
    result().limited_by = stable.limit;
  }
  if (needed() <= stable.dt) return true;
  if (options().dt > 0) {
    give_up("the stable step has fallen to " + text(stable.dt) + " s, below dt, at time " +
            text(time()) + " s, limited by the " + stable.limit +
            " (time: dt: auto would take shorter steps from there on; allow_unstable: true goes on "
            "all the same)");
    return false;
  }
  const double before = dt();
  replan(ts, explicit_options_.safety * stable.dt);
  step_changed(ts, before);
  return true;
}

void ExplicitRun::remember_own(Memory& memory) {
  memory.common("last_look", last_look_);
  memory.common("look_evaluations", evaluations_);
  memory.common("look_stable_dt", last_stable_);
  memory.common("look_rate", last_rate_);
  memory.common("look_own_stiffness", last_own_);
}

}  // namespace floe
