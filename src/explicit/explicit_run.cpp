#include "explicit/explicit_run.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/collectives.h"
#include "base/format.h"

namespace floe {
namespace {

/// Time of the other work of a step, relative to an evaluation of all forces.
constexpr double moving = 0.25;

}  // namespace

template <class Space>
ExplicitRun<Space>::ExplicitRun(std::string_view type, Model<Space>& model,
                                const ExplicitOptions& options, Observer<Space> observer)
    : DynamicRun<Space>("explicit", type, model, options, std::move(observer)),
      explicit_options_(options) {
  this->show_every(50);
}

template <class Space>
StableStep ExplicitRun<Space>::look() {
  this->settle();
  const double began = MPI_Wtime();
  StableStep stable = find_stable_step();
  seconds_an_evaluation_ = (MPI_Wtime() - began) / std::max(stable.evaluations, 1);
  if (const auto limit = step_limit(); limit.dt < stable.dt) {
    stable.dt = limit.dt;
    stable.limit = limit.reason;
  }
  evaluations_ = stable.evaluations;
  last_look_ = this->done();
  last_stable_ = stable.dt;
  last_rate_ = rate_estimate();
  last_own_ = own_stiffness();
  return stable;
}

template <class Space>
void ExplicitRun<Space>::choose_step() {
  const StableStep stable = look();
  this->result().stable_dt = stable.dt;
  this->result().limited_by = stable.limit;
  const double given = this->options().dt;
  if (given > stable.dt && !explicit_options_.allow_unstable)
    throw InputError(this->dt_key() + ": " + text(given) + " must be <= " + text(stable.dt) +
                     " [s], the stable step, limited by the " + stable.limit +
                     " (time: allow_unstable: true takes it all the same)");
  const double wanted = given > 0 ? given : automatic(stable.dt);
  if (!std::isfinite(wanted))
    throw InputError("time: dt: auto finds no force that limits the step; give one");
  this->plan(wanted);
}

/// The step that `dt: auto` takes [s].
/// \param stable  the stable step [s]
template <class Space>
double ExplicitRun<Space>::automatic(double stable) const {
  double dt = explicit_options_.safety * stable;
  for (const auto& force : this->model().forces()) {
    if (const auto* role = force->roles().step) dt = std::min(dt, role->resolved_step());
  }
  return dt;
}

/// The motion for which `dt: auto` takes a shorter step than for stability; empty if none.
template <class Space>
std::string ExplicitRun<Space>::resolved_motion() const {
  double least = explicit_options_.safety * last_stable_;
  std::string motion;
  for (const auto& force : this->model().forces()) {
    const auto* role = force->roles().step;
    if (role == nullptr || !(role->resolved_step() < least)) continue;
    least = role->resolved_step();
    motion = role->resolved_motion();
  }
  return motion;
}

/// Sum over the forces of their fastest rates [1/s], each the largest over ranks; 0 if no force
/// gives one. Collective.
template <class Space>
double ExplicitRun<Space>::rate_estimate() {
  std::vector<double> rates;
  for (const auto& force : this->model().forces()) {
    const auto* role = force->roles().step;
    if (role == nullptr) continue;
    if (const auto rate = role->rate_estimate(this->state())) rates.push_back(*rate);
  }
  if (rates.empty()) return 0;
  largest_over_ranks(rates, this->model().part().comm);
  return std::accumulate(rates.begin(), rates.end(), 0.0);
}

/// Shortest of the steps that forces require for reasons other than stability. Collective.
template <class Space>
typename LimitsStep<Space>::Limit ExplicitRun<Space>::step_limit() {
  typename LimitsStep<Space>::Limit least;
  for (const auto& force : this->model().forces()) {
    const auto* role = force->roles().step;
    if (role == nullptr) continue;
    if (auto limit = role->step_limit(this->state()); limit.dt < least.dt) least = limit;
  }
  const MPI_Comm comm = this->model().part().comm;
  const RankedValue of_all = least_of_ranks({least.dt, rank(comm)}, comm);
  least.dt = of_all.value;
  broadcast(least.reason, comm, of_all.index);
  return least;
}

/// Sum of the forces' own stiffness bounds [1/s^2].
template <class Space>
double ExplicitRun<Space>::own_stiffness() {
  double sum = 0;
  for (const auto& force : this->model().forces()) {
    if (const auto* role = force->roles().step) sum += role->hidden_stiffness().stiffness;
  }
  return sum;
}

/// Smallest stable step that allows the present dt [s].
template <class Space>
double ExplicitRun<Space>::needed() const {
  return this->options().dt > 0 ? this->dt() : this->dt() / (0.5 * (1 + explicit_options_.safety));
}

template <class Space>
bool ExplicitRun<Space>::look_is_due() {
  if (explicit_options_.allow_unstable || this->done() == 0) return false;
  if (this->ice_has_changed()) return true;
  if (own_stiffness() > last_own_) return true;
  // A step costs about one evaluation, the rates less than half of one.
  constexpr std::int64_t now_and_then = 100, least = 1000, share = 100;
  if (this->done() - last_look_ >= std::max(least, share * evaluations_)) return true;
  if (!this->sampled_when_due() && this->done() % now_and_then != 0) return false;
  if (step_limit().dt < needed()) return true;
  const double rate = rate_estimate();
  return rate > last_rate_ && !(last_stable_ * (last_rate_ / rate) >= needed());
}

template <class Space>
bool ExplicitRun<Space>::keep_step_stable() {
  if (!look_is_due()) return true;
  const StableStep stable = look();
  if (stable.dt < this->result().stable_dt) {
    this->result().stable_dt = stable.dt;
    this->result().limited_by = stable.limit;
  }
  const bool resolved = this->options().dt > 0 || this->dt() <= automatic(stable.dt) ||
                        automatic(stable.dt) == explicit_options_.safety * stable.dt;
  if (needed() <= stable.dt && resolved) return true;
  if (this->options().dt > 0) {
    this->give_up(
        "the stable step has fallen to " + text(stable.dt) + " s, below dt, at time " +
        text(this->time()) + " s, limited by the " + stable.limit +
        " (time: dt: auto would take shorter steps from there on; allow_unstable: true goes on "
        "all the same)");
    return false;
  }
  if (!(this->options().end / automatic(stable.dt) <= this->options().most_steps)) {
    this->give_up("the stable step has fallen to " + text(stable.dt) + " s at time " +
                  text(this->time()) + " s, limited by the " + stable.limit +
                  ": more steps to time: end than are made (limit: steps)");
    return false;
  }
  const double before = this->dt();
  this->replan(automatic(stable.dt));
  step_changed(before);
  return true;
}

template <class Space>
void ExplicitRun<Space>::add_to(RunPlan& plan) const {
  if (!(this->options().dt > 0)) plan.resolves = resolved_motion();
  if (!(seconds_an_evaluation_ > 0)) return;  // after a restart no search has been timed
  plan.seconds_a_step = evaluations_a_step() * (1 + moving) * seconds_an_evaluation_;
  plan.measured = std::to_string(evaluations_) + " evaluations of the forces";
}

template <class Space>
void ExplicitRun<Space>::persist_own(Archive& archive) {
  std::string stepper = this->result().stepper;
  archive.common("stepper", stepper);
  if (stepper != this->result().stepper)
    throw OtherRun("checkpoint: restart: '" + this->options().checkpoint.restart +
                   "' is of steps by '" + stepper + "', this run's are by '" +
                   this->result().stepper + "'");
  archive.common("last_look", last_look_);
  archive.common("look_evaluations", evaluations_);
  archive.common("look_stable_dt", last_stable_, not_negative_or_infinite);
  archive.common("look_rate", last_rate_, not_negative);
  archive.common("look_own_stiffness", last_own_, not_negative);
}

template class ExplicitRun<Spatial>;
template class ExplicitRun<Planar>;

}  // namespace floe
