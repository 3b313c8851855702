#include "paths/path_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/collectives.h"
#include "base/union_find.h"
#include "floe/base/item.h"
#include "floe/files/log.h"
#include "model/newton.h"
#include "paths/root_search.h"
#include "session/signals.h"

namespace floe {
namespace {

/// s over its limit at which a beam gives way, above the rounding that Fracture::advance() allows,
/// and the tolerance of it.
constexpr double limit_passed = 3e-6, limit_tolerance = 1e-6;

}  // namespace

template <class Space>
PathEquilibrium<Space>::PathEquilibrium(Model<Space>& model, PathSettings<Space> settings)
    : Base(model),
      settings_(std::move(settings)),
      sense_(settings_.sense),
      per_factor_(static_cast<std::size_t>(part_.local) * n, 0.0),
      before_{.saved = this->save(), .residual = {}, .energies = {}},
      pull_(static_cast<std::size_t>(part_.local)) {
  for (Handle<Vec>* v : {&start_, &right_, &along_, &pull_vector_, &trial_, &last_})
    check(VecDuplicate(x_, v->put()));
  std::vector<double> at_zero(per_factor_.size(), 0.0);
  model_.prescribe(0, at_zero);
  model_.prescribe(settings_.full_time, per_factor_);
  double moves = 0;
  for (std::size_t k = 0; k < per_factor_.size(); ++k) {
    per_factor_[k] -= at_zero[k];
    if (k % n >= Space::translations) per_factor_[k] *= model_.length_scale();
    moves = std::max(moves, std::abs(per_factor_[k]));
  }
  moves_boundaries_ = largest_over_ranks(moves, part_.comm) > 0;
}

template <class Space>
double PathEquilibrium<Space>::dot(Vec a, Vec b) const {
  PetscScalar sum = 0;
  check(VecDot(a, b, &sum));
  return sum;
}

template <class Space>
double PathEquilibrium<Space>::arc_length(Vec v) const {
  return std::sqrt(dot(v, v) / static_cast<double>(part_.global_bodies));
}

template <class Space>
void PathEquilibrium<Space>::begin() {
  factor_ = 0;
  fill_residual(f_);
  keep_before();
  if (model_.fracture() != nullptr) pieces_at_start_ = number_of_pieces();
}

template <class Space>
void PathEquilibrium<Space>::keep_before() {
  before_.saved = save();
  before_.factor = factor_;
  if (settings_.monitored) before_.monitored = settings_.monitored(state_);
  before_.residual.assign(static_cast<std::size_t>(part_.owned) * n, 0.0);
  for (std::size_t k = 0; k < before_.residual.size(); ++k) {
    if (per_factor_[k] != 0) before_.residual[k] = -wrenches_.at(k) * this->weight(k);
  }
  if (model_.fracture() != nullptr) before_.energies = energies();
}

/// Sets the time and the prescribed unknowns of the load factor.
template <class Space>
void PathEquilibrium<Space>::place() {
  const double time = factor_ * settings_.full_time;
  state_.set_time(time);
  std::vector<double> target(static_cast<std::size_t>(part_.local) * n);
  model_.prescribe(time, target);
  PetscScalar* x = nullptr;
  check(VecGetArray(x_, &x));
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if ((model_.prescribed()[k / n] >> (k % n) & 1U) == 0) continue;
    x[k] = target[k] * (k % n < Space::translations ? 1.0 : model_.length_scale());
  }
  check(VecRestoreArray(x_, &x));
}

/// Solves with the present tangent; false if the solver failed.
template <class Space>
bool PathEquilibrium<Space>::solve_linear(Vec right, Vec solution) {
  const Timed timed(Event::solve);
  KSP ksp = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  check(KSPSolve(ksp, right, solution));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp, &reason));
  if (reason >= 0) return true;
  require_memory(ksp);
  why_ = std::string("the linear solver failed (") + KSPConvergedReasons[reason] + ")";
  return false;
}

/// Forms the tangent of the present state and du_q.
template <class Space>
bool PathEquilibrium<Space>::form() {
  this->begin_anew_after_failure();
  this->rebase(x_);
  this->assemble(per_factor_);
  formed_ = true;
  KSP ksp = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
  // The loads are linear in the load factor, so this difference is their derivative.
  const double time = state_.time;
  Wrenches<Space> from(static_cast<std::size_t>(part_.local));
  std::fill(pull_.values.begin(), pull_.values.end(), 0.0);
  for (const auto& force : model_.forces()) {
    if (force->roles().time == nullptr) continue;
    state_.set_time(time);
    force->add(state_, from);
    state_.set_time(time + settings_.full_time);
    force->add(state_, pull_);
  }
  state_.set_time(time);
  PetscScalar* q = nullptr;
  check(VecGetArrayWrite(pull_vector_, &q));
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    const bool held = (model_.held()[k / n] >> (k % n) & 1U) != 0;
    q[k] = held ? 0.0 : (pull_.at(k) - from.at(k)) * this->weight(k) - tangent_.lift()[k];
  }
  check(VecRestoreArrayWrite(pull_vector_, &q));
  if (!solve_linear(pull_vector_, along_)) return false;
  PetscScalar* d = nullptr;
  check(VecGetArray(along_, &d));
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if ((model_.held()[k / n] >> (k % n) & 1U) != 0) d[k] = per_factor_[k];
  }
  check(VecRestoreArray(along_, &d));
  return true;
}

template <class Space>
double PathEquilibrium<Space>::arc_of(double change) {
  if (!form()) return 0;
  return std::abs(change) * arc_length(along_);
}

/// Change of the load factor by the arc. First along the tangent, in the direction of the last
/// step; then the root of |u - u_0 + du_r + dlambda du_q| = arc with the larger projection on the
/// step so far (Crisfield 1981).
template <class Space>
std::optional<double> PathEquilibrium<Space>::change_by_arc(double arc, std::int64_t it) {
  const double bodies = static_cast<double>(part_.global_bodies);
  const double a = dot(along_, along_);
  if (!(a > 0)) {
    why_ = "the load moves nothing";
    return {};
  }
  if (it == 0) {
    const double sense = has_direction_ ? (dot(along_, last_) < 0 ? -1.0 : 1.0) : sense_;
    return sense * arc * std::sqrt(bodies / a);
  }
  check(VecWAXPY(trial_, -1.0, start_, x_));  // the step so far
  const double so_far = dot(trial_, along_);
  check(VecAXPY(trial_, 1.0, right_));
  const double b = dot(trial_, along_), c = dot(trial_, trial_) - arc * arc * bodies;
  const double root = b * b - a * c;
  if (!(root >= 0)) {
    why_ = "no equilibrium at this arc length";
    return {};
  }
  return (-b + (so_far < 0 ? -1.0 : 1.0) * std::sqrt(root)) / a;
}

template <class Space>
std::optional<double> PathEquilibrium<Space>::change_by_reading(const Reading& reading) {
  const auto value = [&](double outward) {
    const double change = reading.far ? sense_ * outward : outward;
    check(VecWAXPY(trial_, 1.0, right_, x_));
    check(VecAXPY(trial_, change, along_));
    take(trial_);
    return reading.value();
  };
  const double tolerance = 0.1 * reading.tolerance;
  const auto root =
      reading.far ? far_end(value, unit_, tolerance) : near_root(value, unit_, tolerance);
  if (!root) {
    came_apart_ = reading.far && value(0) <= 0;
    why_ = came_apart_   ? "where no load brings another beam to its strength"
           : reading.far ? "at no load factor do all beams hold"
                         : "the monitored displacement does not follow the load factor";
    return {};
  }
  return reading.far ? sense_ * *root : *root;
}

template <class Space>
std::optional<double> PathEquilibrium<Space>::change_of_factor(const Goal& goal, std::int64_t it) {
  if (goal.factor) return *goal.factor - factor_;
  if (goal.arc) return change_by_arc(*goal.arc, it);
  return change_by_reading(*goal.reading);
}

template <class Space>
bool PathEquilibrium<Space>::is_met(const Goal& goal, std::int64_t it) const {
  if (goal.arc) return it > 0;
  if (goal.factor) return factor_ == *goal.factor;
  return std::abs(goal.reading->value()) <= goal.reading->tolerance;
}

/// Evaluates the present state: true if it is the equilibrium that meets the goal, false if
/// Newton's method must stop, nothing if it goes on.
template <class Space>
std::optional<bool> PathEquilibrium<Space>::is_there(const Goal& goal, std::int64_t it) {
  PetscReal atol = 0, rtol = 0, norm = 0;
  PetscInt most = 0;
  check(SNESGetTolerances(snes_, &atol, &rtol, nullptr, &most, nullptr));
  take(x_);
  fill_residual(f_);
  check(VecNorm(f_, NORM_2, &norm));
  // The first residual after a prediction says nothing on contraction. On an arc the tangent of
  // the prediction may be nearly singular, where it leads astray.
  contraction_ = it > 1 && last_norm_ > 0 ? norm / last_norm_ : goal.arc ? 1.0 : 0.0;
  last_norm_ = norm;
  on_iteration_(it);
  stopped_ = StopSignals::came(part_.comm);
  if (stopped_) {
    why_ = "stopped on request";
  } else if (!std::isfinite(norm)) {
    why_ = "Newton's method went astray";
  } else if (norm <= this->scale_of_forces().tolerance(rtol, atol) && is_met(goal, it)) {
    return true;
  } else if (it == most) {
    why_ = "Newton's method did not converge in " + std::to_string(most) + " iterations";
  } else {
    return {};
  }
  return false;
}

/// Largest rotation in a vector of unknowns [rad].
template <class Space>
double PathEquilibrium<Space>::largest_turn(Vec v) const {
  double turn = 0;
  const PetscScalar* values = nullptr;
  check(VecGetArrayRead(v, &values));
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if (k % n >= Space::translations) turn = std::max(turn, std::abs(values[k]));
  }
  check(VecRestoreArrayRead(v, &values));
  return largest_over_ranks(turn, part_.comm) / model_.length_scale();
}

/// Makes a Newton iteration, with the residual of the present state in f_.
template <class Space>
bool PathEquilibrium<Space>::iterate(const Goal& goal, std::int64_t it) {
  const bool keep = formed_ && (constant_ || (it > 0 && this->keeps_factorisation()));
  if (!keep && !form()) return false;
  check(VecScale(f_, -1.0));
  if (!solve_linear(f_, right_)) return false;
  ++iterations_;
  PetscScalar* d = nullptr;
  check(VecGetArray(right_, &d));
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if ((model_.held()[k / n] >> (k % n) & 1U) != 0) d[k] = 0;
  }
  check(VecRestoreArray(right_, &d));
  const std::optional<double> change = change_of_factor(goal, it);
  if (!change) return false;
  check(VecAXPY(right_, *change, along_));
  constexpr double small_turn = 0.02;  // [rad]
  if (it == 0) small_turns_ = largest_turn(right_) < small_turn;
  check(VecAXPY(x_, 1.0, right_));
  factor_ = goal.factor ? *goal.factor : factor_ + *change;
  place();
  return true;
}

/// Solves by Newton's method from the present state for the equilibrium that meets the goal. After
/// a failure the state is undefined.
template <class Space>
bool PathEquilibrium<Space>::go(const Goal& goal) {
  check(VecCopy(x_, start_));
  small_turns_ = false;
  std::optional<bool> there;
  for (std::int64_t it = 0; !(there = is_there(goal, it)); ++it) {
    if (!iterate(goal, it)) return false;
  }
  if (!*there) return false;
  if (const std::int64_t folded = this->count_folded(); folded > 0) {
    why_ = std::to_string(folded) + " beams folded over";
    return false;
  }
  if (this->is_lost()) {
    why_ = "nothing holds the bodies within 100 times the lattice's extent";
    return false;
  }
  return true;
}

/// s over the s at which a beam next changes, the largest of all beams.
template <class Space>
double PathEquilibrium<Space>::nearness(double growth) const {
  if constexpr (std::is_same_v<Space, Spatial>)
    return model_.fracture()->nearness_to_change(state_, growth);
  return (void)growth, 0.0;
}

template <class Space>
typename PathEquilibrium<Space>::Reading PathEquilibrium<Space>::at_limit(double growth) const {
  return {[this, growth] { return nearness(growth) - (1 + limit_passed); }, true, limit_tolerance};
}

/// Whether the proposed step makes more than 60 degrees with the last one: on a smooth path a sign
/// that it leads back, or to another path.
template <class Space>
bool PathEquilibrium<Space>::turns_back() {
  if (!has_direction_) return false;
  check(VecWAXPY(trial_, -1.0, start_, x_));
  return dot(trial_, last_) < 0.5 * std::sqrt(dot(trial_, trial_) * dot(last_, last_));
}

/// A step in which no beam changes: an arc, or as far as the next beam's limit.
template <class Space>
bool PathEquilibrium<Space>::elastic_step(double arc) {
  if (go({.arc = arc, .factor = {}})) {
    if (turns_back()) {
      why_ = "the path turns too sharply";
      return false;
    }
    if (model_.fracture() == nullptr) return true;
    if (nearness(0) <= 1 + limit_passed + limit_tolerance) return true;
    // The limit lies within the arc.
    sense_ = factor_ < before_.factor ? -1 : 1;
    unit_ = std::max(std::abs(factor_ - before_.factor), 1e-300);
    const Reading limit = at_limit(0);
    return go({.arc = {}, .factor = {}, .reading = &limit});
  }
  return false;
}

template <class Space>
bool PathEquilibrium<Space>::propose(double arc, double step) {
  why_.clear();
  tangents_before_ = this->factorisations();
  changed_ = came_apart_ = collapsed_ = false;
  stopped_ = StopSignals::came(part_.comm);
  if (stopped_) return false;
  const bool at_event = model_.fracture() != nullptr && nearness(0) > 1 + limit_tolerance;
  if (at_event ? break_beams(step) : elastic_step(arc)) return true;
  reject();
  return false;
}

/// Moves on from the proposed equilibrium, which stays a single step with it.
template <class Space>
bool PathEquilibrium<Space>::move(const Goal& goal) {
  if (go(goal)) return true;
  reject();
  return false;
}

template <class Space>
bool PathEquilibrium<Space>::move_to_factor(double factor) {
  return move({.arc = {}, .factor = factor});
}

template <class Space>
bool PathEquilibrium<Space>::move_to_displacement(double displacement) {
  unit_ = std::max(std::abs(factor_ - before_.factor), 1e-300);
  const Reading reading{
      [this, displacement] { return settings_.monitored(state_) - displacement; }, false,
      1e-10 *
          std::max({std::abs(displacement), std::abs(monitored()), std::abs(before_.monitored)})};
  return move({.arc = {}, .factor = {}, .reading = &reading});
}

/// Lets the beams at their limit change: all that soften, and of those that break the most
/// overloaded one. Then the load factor goes to where the next beam is at its limit: in a snap-back
/// it falls. If it would rise after a break, the step ends at the old load factor, and elastic
/// steps follow.
template <class Space>
bool PathEquilibrium<Space>::break_beams(double step) {
  if constexpr (std::is_same_v<Space, Spatial>) {
    Fracture& fracture = *model_.fracture();
    changed_ = true;
    unit_ = 0.1 * (factor_ != 0 ? std::abs(factor_) : 1.0);
    const Reading grown = at_limit(settings_.growth), limit = at_limit(0);
    const bool softens = grown.value() < -limit_passed + limit_tolerance;
    if (softens && !go({.arc = {}, .factor = {}, .reading = &grown})) {
      collapsed_ = !stopped_;
      return false;
    }
    const double time = state_.time;
    state_.set_time(step);
    const Advance done = fracture.advance(state_);
    state_.set_time(time);
    if (done == Advance::none) {
      why_ = "no beam gives way at its limit";
      collapsed_ = true;
      return false;
    }
    const bool broke = done == Advance::broke;
    bool found = go({.arc = {}, .factor = {}, .reading = &limit});
    const bool rose = found && broke && sense_ * (factor_ - before_.factor) > 0;
    if (rose || came_apart_) found = go({.arc = {}, .factor = before_.factor});
    if (found || stopped_) return found;
    if (const std::int64_t pieces = number_of_pieces(); pieces > pieces_at_start_) {
      came_apart_ = true;
      why_ = "where the lattice came apart into " + std::to_string(pieces) + " pieces";
    }
    collapsed_ = !came_apart_;
    return false;
  }
  return (void)step, false;
}

/// Number of pieces that unbroken beams connect. Collective.
template <class Space>
std::int64_t PathEquilibrium<Space>::number_of_pieces() const {
  std::vector<std::int32_t> joined;
  for (std::int32_t m = 0; m < part_.beams.size(); ++m) {
    if (item(part_.counts_here, m) == 0) continue;
    if (model_.fracture() != nullptr && model_.fracture()->damage(m) == 1) continue;
    for (const std::int32_t b : item(part_.beams.bodies, m))
      joined.push_back(item(part_.global, b));
  }
  const std::vector<std::int32_t> all = all_gathered(joined, part_.comm);
  UnionFind pieces(static_cast<std::size_t>(part_.global_bodies));
  for (std::size_t k = 0; k + 2 <= all.size(); k += 2) pieces.unite(all[k], all[k + 1]);
  std::int64_t count = 0;
  for (std::int32_t b = 0; b < part_.global_bodies; ++b) count += pieces.find(b) == b ? 1 : 0;
  return count;
}

template <class Space>
void PathEquilibrium<Space>::reject() {
  factor_ = before_.factor;
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (model_.fracture() != nullptr && changed_) model_.fracture()->retreat();
  }
  restore(before_.saved);
}

/// Work of the prescribed motions in the proposed step, by the mean of their forces [J].
template <class Space>
double PathEquilibrium<Space>::boundary_work_of_step() const {
  if (!moves_boundaries_) return 0;
  double work = 0;
  for (std::size_t k = 0; k < before_.residual.size(); ++k) {
    const double now = -wrenches_.at(k) * this->weight(k);
    work += 0.5 * (before_.residual[k] + now) * per_factor_[k] * (factor_ - before_.factor);
  }
  return sum_over_ranks(work, part_.comm);
}

template <class Space>
void PathEquilibrium<Space>::add_works() {
  for (std::size_t k = 0; k < model_.forces().size(); ++k) {
    if (const auto* work = model_.forces()[k]->roles().work)
      work->add_works(before_.saved.state, state_, works_.of(k));
  }
}

template <class Space>
void PathEquilibrium<Space>::accept() {
  fill_residual(f_);
  audit("a step along the path");
  const double boundary_work = boundary_work_of_step();
  boundary_work_ += boundary_work;
  add_works();
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (changed_) {
      const Energies left = energies(), &whole = before_.energies;
      model_.fracture()->add_released(whole.stored - left.stored + left.external - whole.external +
                                      boundary_work + whole.dissipated - left.dissipated);
    }
  }
  for (const auto& force : model_.forces()) {
    const Roles<Space> roles = force->roles();
    if (roles.commits != nullptr) roles.commits->commit(state_, 0);
  }
  PetscScalar* x = nullptr;
  check(VecGetArrayWrite(start_, &x));
  std::copy(before_.saved.x.begin(), before_.saved.x.end(), x);
  check(VecRestoreArrayWrite(start_, &x));
  check(VecWAXPY(last_, -1.0, start_, x_));
  last_arc_ = arc_length(last_);
  length_ += last_arc_;
  has_direction_ = !changed_;
  const double change = factor_ - before_.factor;
  if (!changed_ && change != 0) sense_ = change < 0 ? -1 : 1;
  const bool back = settings_.sense * change < 0;
  snapped_back_ = back && (moves_boundaries_ || settings_.sense * dot(pull_vector_, last_) < 0);
  keep_before();
}

template class PathEquilibrium<Spatial>;
template class PathEquilibrium<Planar>;

}  // namespace floe
