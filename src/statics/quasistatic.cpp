#include "statics/quasistatic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/format.h"
#include "floe/files/log.h"
#include "run/expected_cost.h"
#include "statics/equilibrium.h"

namespace floe {
namespace {

// Smallest part of the given step before a run is given up.
constexpr double smallest_fraction = 1.0 / 4096;
/// Steps that would load a beam beyond its strength by more than this part are halved first.
constexpr double overload_tolerance = 0.005;
// Of the forces in balance; larger pin reactions mean that a free motion is loaded.
constexpr double pin_tolerance = 1e-6;

/// Adds expected time and memory to a plan, by whether the tangent is constant.
template <class Space>
void add_cost(const Model<Space>& model, const FactorisationCost& cost, RunPlan& plan) {
  plan.bytes = cost.bytes;
  const Part& part = model.part();
  if (!is_like_a_sheet(static_cast<double>(part.global_bodies),
                       static_cast<double>(part.global_beams)))
    return;
  const bool linear = model.kinematics() == Kinematics::linear && model.fracture() == nullptr;
  constexpr double at_the_ends = 2;  // at time 0, and for the stability at the end
  const double once = (linear ? 1 : at_the_ends) * cost.seconds;
  const double each = linear ? 2 * cost.solve_seconds : 1.5 * cost.seconds;
  plan.seconds_a_step = once / plan.steps + each;
  plan.measured = model.fracture() == nullptr
                      ? sheets_like_it
                      : "what sheets of this size take while no beam breaks, roughly";
}

/// A static run: load steps, which are halved where Newton fails or a beam would be overloaded.
template <class Space>
class QuasistaticRun final : public Run {
 public:
  QuasistaticRun(Model<Space>& model, TimeSpan span, Observer<Space> observer,
                 const OutOfPlane* rest)
      : model_(model),
        span_(std::move(span)),
        observer_(std::move(observer)),
        rest_(rest),
        given_(span_.dt > 0 ? std::min(span_.dt, span_.end) : span_.end),
        dt_(given_) {}

  bool prepare() override;
  bool advance(double until) override;
  double time() const override { return now_; }
  const RunResult& outcome() const override { return result_; }

 private:
  enum class Stand { prepared, running, ended };

  RunPlan plan() const;
  void begin();
  void load_step();
  void accept();
  bool is_balanced(double at);
  void not_solved(double step, double next, bool divisible);
  void stop(double at);
  void end_with(std::string message);
  void finish();
  void announce(const std::string& what) {
    progress_->announce(now_, what + ", factorising " + text(unknowns_) + " unknowns",
                        cost_.seconds);
  }
  std::string next_step() const { return "step " + std::to_string(result_.steps + 1); }

  Model<Space>& model_;
  const TimeSpan span_;
  const Observer<Space> observer_;
  const OutOfPlane* rest_;
  const double given_;   // load step of the user [s]
  double now_ = 0, dt_;  // time of the last equilibrium, next load step [s]
  const double unknowns_ = static_cast<double>(model_.part().global_bodies) * Space::unknowns;
  const FactorisationCost cost_ = factorisation_cost(unknowns_, size(model_.part().comm));
  std::optional<Equilibrium<Space>> equilibrium_;
  std::optional<Progress> progress_;
  RunResult result_;
  Stand stand_ = Stand::prepared;
};

template <class Space>
RunPlan QuasistaticRun<Space>::plan() const {
  RunPlan plan;
  plan.end = span_.end;
  plan.dt = given_;
  plan.given = span_.dt > 0;
  plan.steps = std::ceil(span_.end / given_ * (1 - 1e-12));
  add_cost(model_, cost_, plan);
  return plan;
}

template <class Space>
bool QuasistaticRun<Space>::prepare() {
  const RunPlan planned = plan();
  if (!(planned.steps <= span_.most_steps))
    throw InputError("time: dt: " + text(given_) + " would take " + text(planned.steps) +
                     " load steps to time: end " + text(span_.end) + ", at most " +
                     text(span_.most_steps) + " are made (limit: steps)");
  equilibrium_.emplace(model_);
  return !span_.on_plan || span_.on_plan(planned);
}

template <class Space>
bool QuasistaticRun<Space>::advance(double until) {
  constexpr double rounding = 1e-12;  // a shorter remainder, in parts of a step, is no step
  if (stand_ == Stand::prepared) begin();
  while (stand_ == Stand::running && span_.end - now_ > rounding * given_) {
    if (now_ >= until - rounding * given_) return true;
    load_step();
  }
  if (stand_ == Stand::running) finish();
  return false;
}

/// Finds the equilibrium at time 0.
template <class Space>
void QuasistaticRun<Space>::begin() {
  stand_ = Stand::running;
  progress_.emplace("load steps", span_.end);
  equilibrium_->set_on_factorisation([this] { announce(next_step()); });
  equilibrium_->set_on_iteration([this](std::int64_t it) {
    progress_->update(now_, next_step() + ", iteration " + std::to_string(it));
  });
  if (!equilibrium_->solve(0.0)) {
    if (equilibrium_->stopped()) return stop(0);
    return end_with("no equilibrium at time 0: " + equilibrium_->why() +
                    "; a ramp on loads and motions would let them come in steps");
  }
  if (is_balanced(0.0)) accept();
}

/// Finds the next equilibrium, or halves the load step.
template <class Space>
void QuasistaticRun<Space>::load_step() {
  constexpr double rounding = 1e-12;
  const double left = span_.end - now_;
  // Steps are equal and the last one ends at the end: a remainder within rounding of a step is a
  // step.
  const double step = dt_ >= left * (1 - rounding) ? left : dt_;
  const double next = step == left ? span_.end : now_ + step;
  const bool divisible = 0.5 * step >= smallest_fraction * given_;
  const double overload_limit =
      divisible ? 1 + overload_tolerance : std::numeric_limits<double>::infinity();
  if (!equilibrium_->solve(next, overload_limit)) return not_solved(step, next, divisible);
  if (!is_balanced(next)) return;
  now_ = next;
  ++result_.steps;
  result_.dt = step;
  accept();
  progress_->update(now_, "step " + std::to_string(result_.steps) + ", " +
                              std::to_string(equilibrium_->newton_iterations()) + " iterations");
  dt_ = std::min(given_, 2 * dt_);
}

/// Halves the load step if Newton's method failed and a shorter step may help; else ends the run.
template <class Space>
void QuasistaticRun<Space>::not_solved(double step, double next, bool divisible) {
  if (equilibrium_->stopped()) return stop(now_);
  dt_ = 0.5 * step;
  if (equilibrium_->collapsed())
    return end_with("dynamic failure at load factor " + text(next / span_.end) +
                    ": continue with integrator: explicit (no equilibrium once beams break: " +
                    equilibrium_->why() + ")");
  if (!divisible)
    end_with("no equilibrium beyond time " + text(now_) + " (load step cut to " + text(step) +
             "): " + equilibrium_->why());
}

template <class Space>
void QuasistaticRun<Space>::accept() {
  result_.newton_iterations = equilibrium_->newton_iterations();
  const State<Space>& state = equilibrium_->state();
  observer_({.state = state,
             .wrenches = equilibrium_->wrenches(),
             .step = result_.steps,
             .forces = model_.report(state, equilibrium_->works())});
}

/// Whether the pins carry nothing; else the run ends here.
template <class Space>
bool QuasistaticRun<Space>::is_balanced(double at) {
  const double reaction = equilibrium_->pin_reaction();
  if (reaction <= pin_tolerance) return true;
  const std::string begin = "no equilibrium at time " + text(at) + ": ";
  if (equilibrium_->is_stopped_early(pin_tolerance)) {
    end_with(begin + "Newton's method stopped where " + text(reaction) +
             " of the forces were not in balance (" + equilibrium_->tolerances() + "); at most " +
             text(pin_tolerance) +
             " may be: take a smaller tolerance (the default: -snes_rtol 1e-10)");
  } else {
    end_with(begin + "a motion that nothing holds is loaded (by " + text(reaction) +
             " of the forces), or has gone far; prescribe it with `fix`");
  }
  return false;
}

template <class Space>
void QuasistaticRun<Space>::stop(double at) {
  result_.stopped = true;
  end_with("stopped on request at time " + text(at) + ", load step " +
           std::to_string(result_.steps) + "; a static run keeps no checkpoint");
}

template <class Space>
void QuasistaticRun<Space>::end_with(std::string message) {
  stand_ = Stand::ended;
  result_.message = std::move(message);
  progress_.reset();
}

/// Decides whether the last equilibrium is stable.
template <class Space>
void QuasistaticRun<Space>::finish() {
  stand_ = Stand::ended;
  result_.done = true;
  equilibrium_->set_on_factorisation([this] { announce("stability of the last state"); });
  result_.unstable_modes = equilibrium_->unstable_modes(rest_);
  result_.factorisations = equilibrium_->factorisations();
  progress_.reset();
}

}  // namespace

template <class Space>
std::unique_ptr<Run> make_quasistatic_run(Model<Space>& model, TimeSpan span,
                                          ObserverOf<Space> observer, const OutOfPlane* rest) {
  return std::make_unique<QuasistaticRun<Space>>(model, std::move(span), std::move(observer), rest);
}

template std::unique_ptr<Run> make_quasistatic_run(Model<Spatial>&, TimeSpan, Observer<Spatial>,
                                                   const OutOfPlane*);
template std::unique_ptr<Run> make_quasistatic_run(Model<Planar>&, TimeSpan, Observer<Planar>,
                                                   const OutOfPlane*);

}  // namespace floe
