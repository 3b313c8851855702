#include "statics/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/audit.h"
#include "base/collectives.h"
#include "base/format.h"
#include "floe/files/log.h"
#include "model/newton.h"
#include "session/signals.h"

namespace floe {
namespace {

constexpr double default_rtol = 1e-10, petsc_atol = 1e-50;

/// Diagonal of the box around all bodies, and at least a body's own size [m].
double extent(const Part& part) {
  std::array<double, 7>
      all;  // maxima of the coordinates, of minus the coordinates, of the radius of gyration
  all.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    for (std::size_t k = 0; k < 3; ++k) {
      all[k] = std::max(all[k], part.bodies.position[b][k]);
      all[3 + k] = std::max(all[3 + k], -part.bodies.position[b][k]);
    }
    all[6] = std::max(all[6], std::sqrt(part.bodies.inertia[b][2] / part.bodies.mass[b]));
  }
  largest_over_ranks(all, part.comm);
  return all[6] + std::hypot(all[0] + all[3], all[1] + all[4], all[2] + all[5]);
}

}  // namespace

template <class Space>
Equilibrium<Space>::Equilibrium(Model<Space>& model)
    : model_(model),
      part_(model.part()),
      state_(static_cast<std::size_t>(part_.local)),
      wrenches_(static_cast<std::size_t>(part_.local)),
      share_(static_cast<std::size_t>(part_.local)),
      works_(model),
      rotations_(static_cast<std::size_t>(part_.owned), model.kinematics()),
      turned2_(static_cast<std::size_t>(part_.owned), 0.0),
      tangent_(part_, model.held(), model.length_scale(), typical_stiffness(model),
               tangent_options()) {
  for (std::int32_t b = 0; b < part_.owned; ++b) {
    double sum = 0;
    for (const auto& force : model.forces()) {
      if (const auto* role = force->roles().step) sum += role->stiffness_bound(b);
    }
    stiffness_.push_back(sum);
  }
  extent_ = floe::extent(part_);
  check(MatCreateVecs(tangent_.matrix(), x_.put(), f_.put()));
  check(VecDuplicate(x_, step_.put()));
  attach_rigid_modes(model, model.held(), tangent_.matrix());
  check(SNESCreate(part_.comm, snes_.put()));
  check(SNESSetFunction(snes_, f_, residual, this));
  check(SNESSetJacobian(snes_, tangent_.matrix(), tangent_.matrix(), jacobian, this));
  set_defaults();
  check(SNESSetConvergenceTest(snes_, converged, this, nullptr));
}

/// Drops a factor that MUMPS failed to compute: with a smaller load step the matrix may be regular
/// again.
template <class Space>
void Equilibrium<Space>::begin_anew_after_failure() {
  KSP ksp = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  if (drop_failed_factor(ksp)) {
    check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
    let_mumps_count(ksp);
  }
}

/// Sets defaults that PETSc's own options override.
template <class Space>
void Equilibrium<Space>::set_defaults() {
  set_newton_defaults(snes_);
  check(SNESSetTolerances(snes_, PETSC_DEFAULT, default_rtol, 0.0, 30, PETSC_DEFAULT));
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  check(KSPGetPC(ksp, &pc));
  check(KSPSetFromOptions(ksp));
  check(SNESSetFromOptions(snes_));
  PetscBool lag_given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, "-snes_lag_jacobian", &lag_given));
  adaptive_ = lag_given == PETSC_FALSE;
  check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
  let_mumps_count(ksp);
}

template <class Space>
std::array<double, Equilibrium<Space>::turns> Equilibrium<Space>::turn_of(
    const PetscScalar* unknowns) const {
  std::array<double, turns> t;
  const double scale = 1.0 / model_.length_scale();
  for (std::size_t k = 0; k < turns; ++k) t[k] = scale * unknowns[Space::translations + k];
  return t;
}

template <class Space>
void Equilibrium<Space>::take(Vec x) {
  const PetscScalar* values = nullptr;
  check(VecGetArrayRead(x, &values));
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    const PetscScalar* v = values + b * n;
    double* record = state_.record(b);
    std::copy_n(v, Space::translations, record);
    const auto turn = turn_of(v);
    turned2_[b] = 0;
    for (const double t : turn) turned2_[b] += t * t;
    rotations_.take(b, turn, record);
  }
  check(VecRestoreArrayRead(x, &values));
  part_.ghosts.update(state_.records, Space::record);
}

template <class Space>
void Equilibrium<Space>::rebase(Vec x) {
  const PetscScalar* values = nullptr;
  check(VecGetArrayRead(x, &values));
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b)
    rotations_.rebase(b, turn_of(values + b * n), state_.record(b));
  check(VecRestoreArrayRead(x, &values));
}

/// Computes the residual, evaluating force by force: the convergence test needs the size of the
/// external forces and of the reactions.
template <class Space>
void Equilibrium<Space>::fill_residual(Vec f) {
  const Timed timed(Event::forces);
  external2_ = model_.evaluate_apart(state_, wrenches_, share_).apart;
  const auto owned = static_cast<std::size_t>(part_.owned) * n;
  PetscScalar* values = nullptr;
  check(VecGetArrayWrite(f, &values));
  for (std::size_t k = 0; k < owned; ++k) {
    const double value = -wrenches_.at(k) * weight(k);
    const bool held = (model_.held()[k / n] >> (k % n) & 1U) != 0;
    if (held) external2_ += value * value;
    values[k] = held ? 0.0 : value;
  }
  check(VecRestoreArrayWrite(f, &values));
}

template <class Space>
void Equilibrium<Space>::assemble(std::span<const double> increments) {
  const Timed timed(Event::tangent);
  tangent_.begin(increments);
  constant_ = model_.kinematics() == Kinematics::linear && model_.fracture() == nullptr;
  for (const auto& force : model_.forces()) {
    const auto* role = force->roles().tangent;
    const bool has_tangent = role != nullptr && role->add_tangent(state_, tangent_);
    if (force.get() != model_.beams() && has_tangent) constant_ = false;
  }
  tangent_.end();
  ++assemblies_;
  on_factorisation_();
}

template <class Space>
PetscErrorCode Equilibrium<Space>::residual(SNES snes, Vec x, Vec f, void* self) noexcept {
  auto& me = *static_cast<Equilibrium*>(self);
  me.take(x);
  me.fill_residual(f);
  PetscReal norm = 0;
  check(VecNorm(f, NORM_2, &norm));
  if (!std::isfinite(norm)) check(SNESSetFunctionDomainError(snes));
  return 0;
}

/// Whether to keep the factorisation, since a new one costs a dozen solves. That of the prediction
/// is kept while each iteration takes a digit off the residual. After a prediction with large
/// rotations it is not tried.
template <class Space>
bool Equilibrium<Space>::keeps_factorisation() const {
  constexpr double a_digit = 0.1;
  return adaptive_ && small_turns_ && contraction_ <= a_digit;
}

template <class Space>
PetscErrorCode Equilibrium<Space>::jacobian(SNES, Vec x, Mat, Mat, void* self) noexcept {
  auto& me = *static_cast<Equilibrium*>(self);
  me.begin_anew_after_failure();
  if (me.constant_ || me.keeps_factorisation()) return 0;
  me.take(x);
  me.rebase(x);
  me.assemble();
  return 0;
}

/// Size of the forces that balance (external forces and reactions), and the rounding level of the
/// beams' forces.
template <class Space>
typename Equilibrium<Space>::Scale Equilibrium<Space>::scale_of_forces() const {
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  double noise2 = 0;
  const double l = model_.length_scale();
  for (std::size_t b = 0; b < stiffness_.size(); ++b) {
    const Vec3<double> u = displacement(state_, b);
    noise2 += stiffness_[b] * stiffness_[b] * (dot(u, u) + l * l * turned2_[b]);
  }
  const auto all = sum_over_ranks(std::array{external2_, noise2}, part_.comm);
  return {std::sqrt(all[0]), rounding * std::sqrt(all[1])};
}

/// Whether a body is so far from rest that rounding hides any load: an overloaded sheet that sinks
/// for ever is not in equilibrium.
template <class Space>
bool Equilibrium<Space>::is_lost() const {
  constexpr double far = 100;  // times the lattice's extent
  double farthest2 = 0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    const Vec3<double> u = displacement(state_, b);
    farthest2 = std::max(farthest2, dot(u, u));
  }
  return std::sqrt(largest_over_ranks(farthest2, part_.comm)) > far * (extent_ + prescribed_);
}

template <class Space>
PetscErrorCode Equilibrium<Space>::converged(SNES snes, PetscInt it, PetscReal, PetscReal,
                                             PetscReal norm, SNESConvergedReason* reason,
                                             void* self) noexcept {
  auto& me = *static_cast<Equilibrium*>(self);
  me.contraction_ = it > 0 && me.last_norm_ > 0 ? norm / me.last_norm_ : 0.0;
  me.last_norm_ = norm;
  me.audit("Newton's method");
  me.on_iteration_(it);
  PetscReal atol = 0, rtol = 0;
  check(SNESGetTolerances(snes, &atol, &rtol, nullptr, nullptr, nullptr));
  *reason = SNES_CONVERGED_ITERATING;
  me.stopped_ = StopSignals::came(me.part_.comm);
  if (me.stopped_) {
    *reason = SNES_DIVERGED_INNER;
    return 0;
  }
  if (!std::isfinite(norm)) {
    *reason = SNES_DIVERGED_FUNCTION_DOMAIN;
    return 0;
  }
  if (norm > me.scale_of_forces().tolerance(rtol, atol)) return 0;
  *reason = me.is_lost() ? SNES_DIVERGED_DTOL : SNES_CONVERGED_FNORM_RELATIVE;
  return 0;
}

/// Increments that bring prescribed unknowns to their values at a time, n per local body; empty if
/// no prescribed unknown moves. Stores the largest prescribed displacement. Collective.
template <class Space>
std::vector<double> Equilibrium<Space>::increments_to(double time) {
  std::vector<double> target(static_cast<std::size_t>(part_.local) * n),
      increments(target.size(), 0.0);
  model_.prescribe(time, target);
  const double l = model_.length_scale();
  const PetscScalar* x = nullptr;
  check(VecGetArrayRead(x_, &x));
  double moves = 0, size = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if ((model_.prescribed()[k / n] >> (k % n) & 1U) == 0) continue;
    increments[k] = target[k] * (k % n < Space::translations ? 1.0 : l) - x[k];
    if (increments[k] != 0) moves = 1;
    if (k % n < Space::translations) size = std::max(size, std::abs(target[k]));
  }
  check(VecRestoreArrayRead(x_, &x));
  std::array<double, 2> all{moves, size};
  largest_over_ranks(all, part_.comm);
  prescribed_ = all[1];
  if (all[0] == 0) return {};
  // Owners know the present values of their unknowns, so ghosts receive the increments.
  part_.ghosts.update(increments, n);
  return increments;
}

/// Fills the right-hand side of the linear step. With a new tangent it is -F_f - K_fc d_c. With a
/// constant, factorised tangent the prescribed unknowns are moved first, and -F_f is the right-hand
/// side.
template <class Space>
void Equilibrium<Space>::fill_right_hand_side(std::vector<double>& increments) {
  if (constant_) {
    PetscScalar* x = nullptr;
    check(VecGetArray(x_, &x));
    for (std::size_t k = 0; k < increments.size() && k < tangent_.lift().size(); ++k)
      x[k] += increments[k];
    check(VecRestoreArray(x_, &x));
    increments.clear();
    take(x_);
    fill_residual(f_);
    check(VecScale(f_, -1.0));
    return;
  }
  rebase(x_);
  assemble(increments);
  PetscScalar* f = nullptr;
  check(VecGetArray(f_, &f));
  for (std::size_t k = 0; k < tangent_.lift().size(); ++k) f[k] = -f[k] - tangent_.lift()[k];
  check(VecRestoreArray(f_, &f));
}

/// Moves prescribed unknowns to their values at the new time, and all other unknowns with them, by
/// one linear solve with the tangent of the present state, K_ff d_f = -F_f - K_fc d_c.
template <class Space>
bool Equilibrium<Space>::predict(double time) {
  std::vector<double> increments = increments_to(time);
  state_.set_time(time);
  take(x_);
  fill_residual(f_);
  PetscReal norm = 0;
  check(VecNorm(f_, NORM_2, &norm));
  PetscReal atol = 0, rtol = 0;
  check(SNESGetTolerances(snes_, &atol, &rtol, nullptr, nullptr, nullptr));
  small_turns_ = false;
  if (increments.empty() && norm <= scale_of_forces().tolerance(rtol, atol)) return true;

  fill_right_hand_side(increments);
  const Timed timed(Event::solve);
  KSP ksp = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  begin_anew_after_failure();
  check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
  check(KSPSolve(ksp, f_, step_));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp, &reason));
  if (reason < 0) {
    require_memory(ksp);
    why_ = std::string("the linear solver failed (") + KSPConvergedReasons[reason] + ")";
    return false;
  }
  ++iterations_;
  PetscScalar* d = nullptr;
  double turn = 0;
  check(VecGetArray(step_, &d));
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if ((model_.held()[k / n] >> (k % n) & 1U) != 0) d[k] = increments.empty() ? 0 : increments[k];
    if (k % n >= Space::translations) turn = std::max(turn, std::abs(d[k]) / model_.length_scale());
  }
  check(VecRestoreArray(step_, &d));
  constexpr double small_turn = 0.02;  // [rad]
  small_turns_ = largest_over_ranks(turn, part_.comm) < small_turn;
  check(VecAXPY(x_, 1.0, step_));
  return true;
}

template <class Space>
void Equilibrium<Space>::audit(const char* where) const {
  if (!auditing()) return;
  Vec update = nullptr;
  check(SNESGetSolutionUpdate(snes_, &update));
  floe::audit(part_.comm, where,
              std::array{object_of(tangent_.matrix()), object_of(x_.get()), object_of(f_.get()),
                         object_of(step_.get()), object_of(update)},
              std::array{state_.time, last_norm_});
}

template <class Space>
typename Equilibrium<Space>::Saved Equilibrium<Space>::save() const {
  Saved saved{state_, rotations_, {}};
  const PetscScalar* x = nullptr;
  check(VecGetArrayRead(x_, &x));
  saved.x.assign(x, x + static_cast<std::size_t>(part_.owned) * n);
  check(VecRestoreArrayRead(x_, &x));
  return saved;
}

template <class Space>
void Equilibrium<Space>::restore(const Saved& saved) {
  state_ = saved.state;
  rotations_ = saved.rotations;
  PetscScalar* x = nullptr;
  check(VecGetArrayWrite(x_, &x));
  std::copy(saved.x.begin(), saved.x.end(), x);
  check(VecRestoreArrayWrite(x_, &x));
  fill_residual(f_);
}

template <class Space>
bool Equilibrium<Space>::solve(double time, double overload_limit) {
  const Saved before = save();
  why_.clear();
  stopped_ = StopSignals::came(part_.comm);
  if (stopped_) return false;
  collapsed_ = false;
  before_breaks_.reset();
  if (!balance(time) || (model_.fracture() != nullptr && !let_break(time, overload_limit))) {
    restore(before);
    return false;
  }
  fill_residual(f_);
  audit("a load step");
  for (std::size_t k = 0; k < model_.forces().size(); ++k) {
    const Roles<Space> roles = model_.forces()[k]->roles();
    if (roles.work != nullptr)
      roles.work->add_works(before.state, before_breaks_ ? *before_breaks_ : state_, works_.of(k));
    if (roles.commits != nullptr) roles.commits->commit(state_, time - before.state.time);
  }
  return true;
}

/// Sums of what the forces store, of the work of loads and of what beams have dissipated [J].
template <class Space>
typename Equilibrium<Space>::Energies Equilibrium<Space>::energies() const {
  Energies all;
  for (const auto& [name, value] : model_.report(state_, works_.all())) {
    if (name == "energy_fracture")
      all.dissipated += value;
    else if (name == "energy_external")
      all.external += value;
    else if (name.rfind("energy_", 0) == 0 && name != "energy_load" && name != "energy_released" &&
             name != "energy_damping")
      all.stored += value;
  }
  return all;
}

/// Lets beams break, one at a time, the most overloaded first, and others soften; each change is
/// followed by a new equilibrium. The path passes through states that are in equilibrium except for
/// the beams that break, as under slow loading. Loads and prescribed motions rest meanwhile. What
/// the stored energy falls by, with the work of the loads, and no beam dissipates is released.
template <class Space>
bool Equilibrium<Space>::let_break(double time, double overload_limit) {
  if constexpr (std::is_same_v<Space, Spatial>) {
    Fracture& fracture = *model_.fracture();
    if (const double overload = fracture.overload(state_); overload > overload_limit) {
      why_ = "a beam would be loaded to " + std::to_string(overload) + " times its strength";
      return false;
    }
    constexpr int most_rounds = 1000;  // of softening without a break
    int rounds = 0;
    const Energies whole = energies();
    for (Advance done = fracture.advance(state_); done != Advance::none;
         done = fracture.advance(state_)) {
      if (!before_breaks_) before_breaks_ = state_;
      rounds = done == Advance::broke ? 0 : rounds + 1;
      if (rounds <= most_rounds && balance(time)) continue;
      if (why_.empty()) why_ = "damage does not come to rest";
      collapsed_ = !stopped_;
      fracture.retreat();
      return false;
    }
    if (before_breaks_) {
      for (std::size_t k = 0; k < model_.forces().size(); ++k) {
        if (const auto* work = model_.forces()[k]->roles().work)
          work->add_works(*before_breaks_, state_, works_.of(k));
      }
      const Energies left = energies();
      fracture.add_released(whole.stored - left.stored + left.external - whole.external +
                            whole.dissipated - left.dissipated);
    }
    return true;
  } else {  // planar beams do not break
    return (void)time, (void)overload_limit, true;
  }
}

/// Solves by Newton's method from the present state for equilibrium at `time`. After a failure the
/// state is undefined.
template <class Space>
bool Equilibrium<Space>::balance(double time) {
  if (!predict(time)) return false;
  const Timed timed(Event::solve);
  check(SNESSolve(snes_, nullptr, x_));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt taken = 0;
  check(SNESGetConvergedReason(snes_, &reason));
  check(SNESGetIterationNumber(snes_, &taken));
  iterations_ += taken;
  if (stopped_) {
    why_ = "stopped on request";
    return false;
  }
  if (reason < 0) {
    KSP ksp = nullptr;
    check(SNESGetKSP(snes_, &ksp));
    require_memory(ksp);
    why_ = reason == SNES_DIVERGED_DTOL
               ? "nothing holds the bodies within 100 times the lattice's extent (does it sink?)"
               : std::string("Newton failed (") + SNESConvergedReasons[reason] + " after " +
                     std::to_string(taken) + " iterations)";
    return false;
  }
  take(x_);
  if (const std::int64_t folded = count_folded(); folded > 0) {
    why_ = std::to_string(folded) + " beams folded over";
    return false;
  }
  return true;
}

template <class Space>
std::int64_t Equilibrium<Space>::count_folded() const {
  if (model_.beams() == nullptr) return 0;
  return sum_over_ranks(model_.beams()->folded(state_), part_.comm);
}

/// Assembles the tangent on z, rx, ry at a planar state into the matrix of the planar tangent,
/// which has the same size and pattern, so that MUMPS need not analyse the matrix again. No entry
/// couples z, rx, ry with x, y, rz (mirror symmetry), so the two tangents together have the
/// negative eigenvalues of the spatial tangent (Sylvester's law of inertia).
template <class Space>
void Equilibrium<Space>::assemble_out_of_plane(const OutOfPlane& rest) {
  const Timed timed(Event::tangent);
  if constexpr (std::is_same_v<Space, Planar>) {
    constexpr std::uint8_t z_rx_ry = 0b011100;
    Tangent<Spatial> tangent(part_, rest.held, model_.length_scale(), typical_stiffness(model_),
                             tangent_.matrix(), z_rx_ry);
    const State<Spatial> all = in_space(state_, false);
    tangent.begin();
    for (const auto& force : rest.forces) {
      if (const auto* role = force->roles().tangent) (void)role->add_tangent(all, tangent);
    }
    tangent.end();
    ++assemblies_;
    on_factorisation_();
  }
}

template <class Space>
std::int64_t Equilibrium<Space>::unstable_modes(const OutOfPlane* rest) {
  KSP ksp = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  const auto use_tangent = [&] {
    check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
  };
  use_tangent();
  if (mumps_cholesky(ksp) == nullptr) return -1;
  if (!constant_) {
    rebase(x_);
    assemble();
    use_tangent();
  }
  const Timed timed(Event::solve);
  std::int64_t negative = negative_pivots(ksp);
  // With linear kinematics in-plane forces have no effect out of the plane.
  if (rest != nullptr && model_.kinematics() != Kinematics::linear) {
    assemble_out_of_plane(*rest);
    use_tangent();
    negative += negative_pivots(ksp);
  }
  return negative;
}

template <class Space>
double Equilibrium<Space>::pin_reaction() const {
  double largest = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    const bool pinned = ((model_.held()[k / n] & ~model_.prescribed()[k / n]) >> (k % n) & 1U) != 0;
    if (pinned) largest = std::max(largest, std::abs(wrenches_.at(k)) * weight(k));
  }
  largest = largest_over_ranks(largest, part_.comm);
  const Scale size = scale_of_forces();
  return largest > size.rounding ? largest / size.forces
                                 : 0.0;  // without any load all reactions are rounding
}

template <class Space>
bool Equilibrium<Space>::is_stopped_early(double small) {
  PetscReal atol = 0, rtol = 0, stol = 0;
  PetscInt most = 0, calls = 0;
  check(SNESGetTolerances(snes_, &atol, &rtol, &stol, &most, &calls));
  if (rtol <= default_rtol && atol <= petsc_atol) return false;
  check(SNESSetTolerances(snes_, 0.0, default_rtol, stol, std::max<PetscInt>(most, 30), calls));
  const bool solved = balance(state_.time);
  if (solved) fill_residual(f_);
  check(SNESSetTolerances(snes_, atol, rtol, stol, most, calls));
  return solved && pin_reaction() <= small;
}

template <class Space>
std::string Equilibrium<Space>::tolerances() const {
  PetscReal atol = 0, rtol = 0;
  check(SNESGetTolerances(snes_, &atol, &rtol, nullptr, nullptr, nullptr));
  return "-snes_rtol " + text(rtol) + (atol > petsc_atol ? ", -snes_atol " + text(atol) : "");
}

template class Equilibrium<Spatial>;
template class Equilibrium<Planar>;

}  // namespace floe
