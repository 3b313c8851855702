#include "statics/quasistatic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/format.h"
#include "floe/base/log.h"
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

}  // namespace

template <class Space>
RunResult run_quasistatic(Model<Space>& model, const TimeSpan& time,
                          const ObserverOf<Space>& observer, const OutOfPlane* rest) {
  RunResult result;
  const double given = time.dt > 0 ? std::min(time.dt, time.end) : time.end;
  RunPlan plan;
  plan.end = time.end;
  plan.dt = given;
  plan.given = time.dt > 0;
  plan.steps = std::ceil(time.end / given * (1 - 1e-12));
  const double unknowns = static_cast<double>(model.part().global_bodies) * Space::unknowns;
  const FactorisationCost cost = factorisation_cost(unknowns, size(model.part().comm));
  add_cost(model, cost, plan);
  if (!(plan.steps <= time.most_steps))
    throw InputError("time: dt: " + text(given) + " would take " + text(plan.steps) +
                     " load steps to time: end " + text(time.end) + ", at most " +
                     text(time.most_steps) + " are made (limit: steps)");
  Equilibrium<Space> equilibrium(model);
  if (time.on_plan && !time.on_plan(plan)) return result;
  const auto accept = [&](std::int64_t step) {
    result.newton_iterations = equilibrium.newton_iterations();
    observer({equilibrium.state(), equilibrium.wrenches(), step});
  };

  const auto balanced = [&](double at) {
    const double reaction = equilibrium.pin_reaction();
    if (reaction <= pin_tolerance) return true;
    const std::string tolerances = equilibrium.tolerances();
    result.message = "no equilibrium at time " + text(at) + ": ";
    if (equilibrium.is_stopped_early(pin_tolerance)) {
      result.message += "Newton's method stopped where " + text(reaction) +
                        " of the forces were not in balance (" + tolerances + "); at most " +
                        text(pin_tolerance) +
                        " may be: take a smaller tolerance (the default: -snes_rtol 1e-10)";
    } else {
      result.message += "a motion that nothing holds is loaded (by " + text(reaction) +
                        " of the forces), or has gone far; prescribe it with `fix`";
    }
    return false;
  };

  Progress progress("load steps", time.end);
  double now = 0, dt = given;
  const auto announce = [&](const std::string& what) {
    progress.announce(now, what + ", factorising " + text(unknowns) + " unknowns", cost.seconds);
  };
  equilibrium.set_on_factorisation([&] { announce("step " + std::to_string(result.steps + 1)); });
  equilibrium.set_on_iteration([&](std::int64_t it) {
    progress.update(
        now, "step " + std::to_string(result.steps + 1) + ", iteration " + std::to_string(it));
  });
  const auto stop = [&](double at) {
    result.stopped = true;
    result.message = "stopped on request at time " + text(at) + ", load step " +
                     std::to_string(result.steps) + "; a static run keeps no checkpoint";
    return result;
  };
  if (!equilibrium.solve(0.0)) {
    if (equilibrium.stopped()) return stop(0);
    result.message = "no equilibrium at time 0: " + equilibrium.why() +
                     "; a ramp on loads and motions would let them come in steps";
    return result;
  }
  if (!balanced(0.0)) return result;
  accept(0);
  constexpr double rounding = 1e-12;  // a shorter remainder, in parts of a step, is no step
  while (time.end - now > rounding * given) {
    const double left = time.end - now;
    // Steps are equal and the last one ends at the end: a remainder within rounding of a step is a
    // step.
    const double step = dt >= left * (1 - rounding) ? left : dt;
    const double next = step == left ? time.end : now + step;
    const bool divisible = 0.5 * step >= smallest_fraction * given;
    const double overload_limit =
        divisible ? 1 + overload_tolerance : std::numeric_limits<double>::infinity();
    if (!equilibrium.solve(next, overload_limit)) {
      if (equilibrium.stopped()) return stop(now);
      dt = 0.5 * step;
      if (equilibrium.collapsed()) {
        result.message = "dynamic failure at load factor " + text(next / time.end) +
                         ": continue with integrator: explicit (no equilibrium once beams break: " +
                         equilibrium.why() + ")";
        return result;
      }
      if (!divisible) {
        result.message = "no equilibrium beyond time " + text(now) + " (load step cut to " +
                         text(step) + "): " + equilibrium.why();
        return result;
      }
      continue;
    }
    if (!balanced(next)) return result;
    now = next;
    ++result.steps;
    result.dt = step;
    accept(result.steps);
    progress.update(now, "step " + std::to_string(result.steps) + ", " +
                             std::to_string(equilibrium.newton_iterations()) + " iterations");
    dt = std::min(given, 2 * dt);
  }
  result.done = true;
  equilibrium.set_on_factorisation([&] { announce("stability of the last state"); });
  result.unstable_modes = equilibrium.unstable_modes(rest);
  result.factorisations = equilibrium.factorisations();
  return result;
}

template RunResult run_quasistatic(Model<Spatial>&, const TimeSpan&, const Observer<Spatial>&,
                                   const OutOfPlane*);
template RunResult run_quasistatic(Model<Planar>&, const TimeSpan&, const Observer<Planar>&,
                                   const OutOfPlane*);

}  // namespace floe
