#include "solve/explicit_run.h"

#include <algorithm>
#include <cmath>

#include "solve/text.h"

namespace floe {

template <class Space>
ExplicitRun<Space>::ExplicitRun(std::string_view type, Model<Space>& model,
                                const ExplicitOptions& options, const Observer<Space>& observer)
    : DynamicRun<Space>("explicit", type, model, options, observer),
      explicit_options_(options),
      rates_(model.forces().size(), -1) {}

template <class Space>
StableStep ExplicitRun<Space>::look() {
  const StableStep stable = find_stable_step();
  evaluations_ = stable.evaluations;
  last_look_ = this->done();
  return stable;
}

template <class Space>
void ExplicitRun<Space>::choose_step() {
  (void)is_faster();
  const StableStep stable = look();
  this->result().stable_dt = stable.dt;
  this->result().limited_by = stable.limit;
  const double given = this->options().dt;
  if (given > stable.dt && !explicit_options_.allow_unstable)
    throw InputError("time: dt: " + text(given) + " must be <= " + text(stable.dt) +
                     " [s], the stable step, limited by the " + stable.limit +
                     " (time: allow_unstable: true takes it all the same)");
  const double wanted = given > 0 ? given : explicit_options_.safety * stable.dt;
  if (!std::isfinite(wanted))
    throw InputError("time: dt: auto finds no force that limits the step; give one");
  this->plan(wanted);
}

/// Whether a force moves or stops bodies a fifth faster than it ever did when this was last true.
template <class Space>
bool ExplicitRun<Space>::is_faster() {
  std::vector<double> rates(rates_.size(), -1);
  bool any = false;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    if (const auto rate = this->model().forces()[k]->fastest_rate(this->state())) {
      rates[k] = *rate;
      any = true;
    }
  }
  if (!any) return false;
  MPI_Allreduce(MPI_IN_PLACE, rates.data(), static_cast<int>(rates.size()), MPI_DOUBLE, MPI_MAX,
                this->model().part().comm);
  constexpr double much = 1.2;
  bool faster = false;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    if (!(rates[k] > much * std::max(rates_[k], 0.0))) continue;
    rates_[k] = rates[k];
    faster = true;
  }
  return faster;
}

template <class Space>
bool ExplicitRun<Space>::look_is_due() {
  if (explicit_options_.allow_unstable) return false;
  // A step costs about an evaluation, and the rates a tenth of it.
  constexpr std::int64_t now_and_then = 20, least = 1000, share = 100;
  return this->done() - last_look_ >= std::max(least, share * evaluations_) ||
         (this->done() % now_and_then == 0 && this->done() > 0 && is_faster());
}

template <class Space>
bool ExplicitRun<Space>::keep_step_stable(TS ts) {
  if (!look_is_due()) return true;
  const StableStep stable = look();
  if (stable.dt < this->result().stable_dt) {
    this->result().stable_dt = stable.dt;
    this->result().limited_by = stable.limit;
  }
  const double safety = explicit_options_.safety, before = this->dt();
  if (this->options().dt > 0) {
    if (before <= stable.dt) return true;
    this->give_up(
        "the stable step has fallen to " + text(stable.dt) + " s, below dt, at time " +
        text(this->time()) + " s, limited by the " + stable.limit +
        " (time: dt: auto would take shorter steps from there on; allow_unstable: true goes on "
        "all the same)");
    return false;
  }
  if (before <= 0.5 * (1 + safety) * stable.dt) return true;
  this->replan(ts, safety * stable.dt);
  step_changed(ts, before);
  return true;
}

template <class Space>
void ExplicitRun<Space>::remember_own(Memory& memory) {
  memory.common("last_look", last_look_);
  memory.common("look_evaluations", evaluations_);
  memory.common("rates", rates_);
}

template class ExplicitRun<Spatial>;
template class ExplicitRun<Planar>;

}  // namespace floe
