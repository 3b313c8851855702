#include "solve/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "floe/base/log.h"
#include "solve/newton.h"

namespace floe {
namespace {

constexpr std::size_t reference_size = 7;  // q_ref (w x y z) and the rotation sum there (x y z)

/// Diagonal of the box around all bodies, and at least a body's own size [m].
double extent(const Part& part) {
  std::array<double, 7> mine, all;  // high, minus low, radius of gyration
  mine.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    for (std::size_t k = 0; k < 3; ++k) {
      mine[k] = std::max(mine[k], part.bodies.position[b][k]);
      mine[3 + k] = std::max(mine[3 + k], -part.bodies.position[b][k]);
    }
    mine[6] = std::max(mine[6], std::sqrt(part.bodies.inertia[b][2] / part.bodies.mass[b]));
  }
  MPI_Allreduce(mine.data(), all.data(), 7, MPI_DOUBLE, MPI_MAX, part.comm);
  return all[6] + std::hypot(all[0] + all[3], all[1] + all[4], all[2] + all[5]);
}

}  // namespace

Equilibrium::Equilibrium(Model<Spatial>& model)
    : model_(model),
      part_(model.part()),
      state_(static_cast<std::size_t>(part_.local)),
      wrenches_(static_cast<std::size_t>(part_.local)),
      share_(static_cast<std::size_t>(part_.local)),
      reference_(static_cast<std::size_t>(part_.owned) * reference_size, 0.0),
      turned2_(static_cast<std::size_t>(part_.owned), 0.0),
      tangent_(part_, model.held(), model.length_scale(), typical_stiffness(model),
               tangent_options()) {
  for (std::int32_t b = 0; b < part_.owned; ++b) {
    reference_[static_cast<std::size_t>(b) * reference_size] = 1;
    double sum = 0;
    for (const auto& force : model.forces()) sum += force->stiffness_bound(b);
    stiffness_.push_back(sum);
  }
  extent_ = extent(part_);
  check(MatCreateVecs(tangent_.matrix(), x_.put(), f_.put()));
  check(VecDuplicate(x_, step_.put()));
  attach_rigid_modes(model, model.held(), tangent_.matrix());
  check(SNESCreate(part_.comm, snes_.put()));
  check(SNESSetFunction(snes_, f_, residual, this));
  check(SNESSetJacobian(snes_, tangent_.matrix(), tangent_.matrix(), jacobian, this));
  set_defaults();
  check(SNESSetConvergenceTest(snes_, converged, this, nullptr));
}

/// Defaults that PETSc's own options override.
void Equilibrium::set_defaults() {
  set_newton_defaults(snes_);
  check(SNESSetTolerances(snes_, PETSC_DEFAULT, 1e-10, 0.0, 30, PETSC_DEFAULT));
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  check(KSPGetPC(ksp, &pc));
  check(KSPSetFromOptions(ksp));
  check(SNESSetFromOptions(snes_));
  PetscBool lag_given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, "-snes_lag_jacobian", &lag_given));
  adaptive_ = lag_given == PETSC_FALSE;
  // On several ranks MUMPS counts negative pivots (unstable_modes) only if its root front is not
  // shared out.
  if (size(part_.comm) == 1) return;
  PetscBool cholesky = PETSC_FALSE;
  MatSolverType package = nullptr;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCCHOLESKY, &cholesky));
  check(PCFactorGetMatSolverType(pc, &package));
  if (cholesky == PETSC_FALSE || package == nullptr || std::strcmp(package, MATSOLVERMUMPS) != 0)
    return;
  Mat factor = nullptr;
  check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
  check(PCFactorSetUpMatSolverType(pc));
  check(PCFactorGetMatrix(pc, &factor));
  check(MatMumpsSetIcntl(factor, 13, 1));
}

void Equilibrium::take(Vec x) {
  const PetscScalar* values = nullptr;
  check(VecGetArrayRead(x, &values));
  const double scale = 1.0 / model_.length_scale();
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    const PetscScalar* v = values + b * n;
    double* record = state_.record(b);
    for (std::size_t k = 0; k < 3; ++k) record[k] = v[k];
    double* q = record + Spatial::rotation;
    turned2_[b] = scale * scale * (v[3] * v[3] + v[4] * v[4] + v[5] * v[5]);
    if (model_.kinematics() == Kinematics::linear) {
      q[0] = 1;
      for (std::size_t k = 0; k < 3; ++k) q[1 + k] = 0.5 * scale * v[3 + k];
      continue;
    }
    const double* r = &reference_[b * reference_size];
    const Vec3<double> spin{scale * v[3] - r[4], scale * v[4] - r[5], scale * v[5] - r[6]};
    const Quat<double> now =
        normalised(product(exp_rotation(spin), Quat<double>{r[0], r[1], r[2], r[3]}));
    q[0] = now.w, q[1] = now.x, q[2] = now.y, q[3] = now.z;
  }
  check(VecRestoreArrayRead(x, &values));
  part_.ghosts.update(state_.records, Spatial::record);
}

void Equilibrium::rebase(Vec x) {
  const PetscScalar* values = nullptr;
  check(VecGetArrayRead(x, &values));
  const double scale = 1.0 / model_.length_scale();
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    const double* q = state_.record(b) + Spatial::rotation;
    double* r = &reference_[b * reference_size];
    std::copy(q, q + 4, r);
    for (std::size_t k = 0; k < 3; ++k) r[4 + k] = scale * values[b * n + 3 + k];
  }
  check(VecRestoreArrayRead(x, &values));
}

/// Wrenches force by force: the size of what must balance is the external forces' and the
/// reactions'.
void Equilibrium::fill_residual(Vec f) {
  const Timed timed(Event::forces);
  const double scale = 1.0 / model_.length_scale();
  external2_ = model_.evaluate_apart(state_, wrenches_, share_).apart;
  const auto owned = static_cast<std::size_t>(part_.owned) * n;
  PetscScalar* values = nullptr;
  check(VecGetArrayWrite(f, &values));
  for (std::size_t k = 0; k < owned; ++k) {
    const double value = -wrenches_.at(k) * (k % n < 3 ? 1.0 : scale);
    const bool held = (model_.held()[k / n] >> (k % n) & 1U) != 0;
    if (held) external2_ += value * value;
    values[k] = held ? 0.0 : value;
  }
  check(VecRestoreArrayWrite(f, &values));
}

void Equilibrium::assemble(std::span<const double> increments) {
  const Timed timed(Event::tangent);
  tangent_.begin(increments);
  for (const auto& force : model_.forces()) (void)force->add_tangent(state_, tangent_);
  tangent_.end();
}

PetscErrorCode Equilibrium::residual(SNES snes, Vec x, Vec f, void* self) noexcept {
  auto& me = *static_cast<Equilibrium*>(self);
  me.take(x);
  me.fill_residual(f);
  PetscReal norm = 0;
  check(VecNorm(f, NORM_2, &norm));
  if (!std::isfinite(norm)) check(SNESSetFunctionDomainError(snes));
  return 0;
}

/// A factorisation costs a dozen solves. The one of the prediction serves on while each iteration
/// takes a digit off the residual; after a prediction that turned bodies far it is not even tried.
bool Equilibrium::keeps_factorisation() const {
  constexpr double a_digit = 0.1;
  return adaptive_ && small_turns_ && contraction_ <= a_digit;
}

PetscErrorCode Equilibrium::jacobian(SNES, Vec x, Mat, Mat, void* self) noexcept {
  auto& me = *static_cast<Equilibrium*>(self);
  if (me.keeps_factorisation()) return 0;
  me.take(x);
  me.rebase(x);
  me.assemble();
  return 0;
}

/// Relative to the forces that balance (external ones and reactions), never below the rounding of
/// the beams' own.
Equilibrium::Scale Equilibrium::scale_of_forces() const {
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  double noise2 = 0;
  const double l = model_.length_scale();
  for (std::size_t b = 0; b < stiffness_.size(); ++b) {
    const Vec3<double> u = displacement(state_, b);
    noise2 += stiffness_[b] * stiffness_[b] * (dot(u, u) + l * l * turned2_[b]);
  }
  const std::array<double, 2> mine{external2_, noise2};
  std::array<double, 2> all{};
  MPI_Allreduce(mine.data(), all.data(), 2, MPI_DOUBLE, MPI_SUM, part_.comm);
  return {std::sqrt(all[0]), rounding * std::sqrt(all[1])};
}

/// So far from rest that rounding hides any load: an overloaded sheet that sinks for ever is no
/// equilibrium.
bool Equilibrium::is_lost() const {
  constexpr double far = 100;  // times the lattice's extent
  double mine = 0, all = 0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    const Vec3<double> u = displacement(state_, b);
    mine = std::max(mine, dot(u, u));
  }
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, part_.comm);
  return std::sqrt(all) > far * (extent_ + prescribed_);
}

PetscErrorCode Equilibrium::converged(SNES snes, PetscInt it, PetscReal, PetscReal, PetscReal norm,
                                      SNESConvergedReason* reason, void* self) noexcept {
  auto& me = *static_cast<Equilibrium*>(self);
  me.contraction_ = it > 0 && me.last_norm_ > 0 ? norm / me.last_norm_ : 0.0;
  me.last_norm_ = norm;
  PetscReal atol = 0, rtol = 0;
  check(SNESGetTolerances(snes, &atol, &rtol, nullptr, nullptr, nullptr));
  *reason = SNES_CONVERGED_ITERATING;
  if (!std::isfinite(norm)) {
    *reason = SNES_DIVERGED_FNORM_NAN;
    return 0;
  }
  if (norm > me.scale_of_forces().tolerance(rtol, atol)) return 0;
  *reason = me.is_lost() ? SNES_DIVERGED_DTOL : SNES_CONVERGED_FNORM_RELATIVE;
  return 0;
}

/// Brings prescribed unknowns to their values at the new time, and all others along: one linear
/// solve with the tangent of the present state, K_ff d_f = -F_f - K_fc d_c.
bool Equilibrium::predict(double time) {
  std::vector<double> target(static_cast<std::size_t>(part_.local) * n),
      increments(target.size(), 0.0);
  model_.prescribe(time, target);
  const double l = model_.length_scale();
  // Ghosts' unknowns are wanted too: their present values come with their owners' increments.
  PetscScalar* x = nullptr;
  check(VecGetArray(x_, &x));
  double moves = 0, size = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if ((model_.prescribed()[k / n] >> (k % n) & 1U) == 0) continue;
    increments[k] = target[k] * (k % n < 3 ? 1.0 : l) - x[k];
    if (increments[k] != 0) moves = 1;
    if (k % n < 3) size = std::max(size, std::abs(target[k]));
  }
  check(VecRestoreArray(x_, &x));
  part_.ghosts.update(increments, n);
  const std::array<double, 2> mine{moves, size};
  std::array<double, 2> all{};
  MPI_Allreduce(mine.data(), all.data(), 2, MPI_DOUBLE, MPI_MAX, part_.comm);
  const bool anyone_moves = all[0] > 0;
  prescribed_ = all[1];

  state_.time = time;
  take(x_);
  fill_residual(f_);
  PetscReal norm = 0;
  check(VecNorm(f_, NORM_2, &norm));
  PetscReal atol = 0, rtol = 0;
  check(SNESGetTolerances(snes_, &atol, &rtol, nullptr, nullptr, nullptr));
  small_turns_ = false;
  if (!anyone_moves && norm <= scale_of_forces().tolerance(rtol, atol)) return true;

  rebase(x_);
  assemble(increments);
  PetscScalar* f = nullptr;
  check(VecGetArray(f_, &f));
  for (std::size_t k = 0; k < tangent_.lift().size(); ++k) f[k] = -f[k] - tangent_.lift()[k];
  check(VecRestoreArray(f_, &f));
  const Timed timed(Event::solve);
  KSP ksp = nullptr;
  check(SNESGetKSP(snes_, &ksp));
  check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
  check(KSPSolve(ksp, f_, step_));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp, &reason));
  if (reason < 0) {
    why_ = std::string("the linear solver failed (") + KSPConvergedReasons[reason] + ")";
    return false;
  }
  ++iterations_;
  PetscScalar* d = nullptr;
  double turn = 0;
  check(VecGetArray(step_, &d));
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    if ((model_.held()[k / n] >> (k % n) & 1U) != 0) d[k] = increments[k];
    if (k % n >= 3) turn = std::max(turn, std::abs(d[k]) / l);
  }
  check(VecRestoreArray(step_, &d));
  double largest_turn = 0;
  MPI_Allreduce(&turn, &largest_turn, 1, MPI_DOUBLE, MPI_MAX, part_.comm);
  constexpr double small_turn = 0.02;  // [rad]
  small_turns_ = largest_turn < small_turn;
  check(VecAXPY(x_, 1.0, step_));
  return true;
}

Equilibrium::Saved Equilibrium::save() const {
  Saved saved{state_, reference_, {}};
  const PetscScalar* x = nullptr;
  check(VecGetArrayRead(x_, &x));
  saved.x.assign(x, x + static_cast<std::size_t>(part_.owned) * n);
  check(VecRestoreArrayRead(x_, &x));
  return saved;
}

void Equilibrium::restore(const Saved& saved) {
  state_ = saved.state;
  reference_ = saved.reference;
  PetscScalar* x = nullptr;
  check(VecGetArrayWrite(x_, &x));
  std::copy(saved.x.begin(), saved.x.end(), x);
  check(VecRestoreArrayWrite(x_, &x));
  fill_residual(f_);
}

bool Equilibrium::solve(double time, double overload_limit) {
  const Saved before = save();
  why_.clear();
  collapsed_ = false;
  if (!balance(time) || (model_.fracture() != nullptr && !let_break(time, overload_limit))) {
    restore(before);
    return false;
  }
  fill_residual(f_);
  for (const auto& force : model_.forces()) force->commit(state_, time - before.state.time);
  return true;
}

/// Beams break one at a time, the most overloaded first, and others soften, each time to a new
/// balance: states that are in balance but for the beams that break, as slow loading passes
/// through them.
bool Equilibrium::let_break(double time, double overload_limit) {
  Fracture& fracture = *model_.fracture();
  if (const double overload = fracture.overload(state_); overload > overload_limit) {
    why_ = "a beam would be loaded to " + std::to_string(overload) + " times its strength";
    return false;
  }
  constexpr int most_rounds = 1000;  // of softening without a break
  int rounds = 0;
  for (Advance done = fracture.advance(state_); done != Advance::none;
       done = fracture.advance(state_)) {
    rounds = done == Advance::broke ? 0 : rounds + 1;
    if (rounds <= most_rounds && balance(time)) continue;
    if (why_.empty()) why_ = "damage does not come to rest";
    collapsed_ = true;
    fracture.retreat();
    return false;
  }
  return true;
}

/// Newton's method from the present state to equilibrium at `time`; leaves the state anywhere if it
/// fails.
bool Equilibrium::balance(double time) {
  if (!predict(time)) return false;
  const Timed timed(Event::solve);
  check(SNESSolve(snes_, nullptr, x_));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt taken = 0;
  check(SNESGetConvergedReason(snes_, &reason));
  check(SNESGetIterationNumber(snes_, &taken));
  iterations_ += taken;
  if (reason < 0) {
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

std::int64_t Equilibrium::count_folded() const {
  if (model_.beams() == nullptr) return 0;
  const std::int64_t mine = model_.beams()->folded(state_);
  std::int64_t all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_INT64_T, MPI_SUM, part_.comm);
  return all;
}

std::int64_t Equilibrium::unstable_modes() {
  KSP ksp = nullptr;
  PC pc = nullptr;
  Mat factor = nullptr;
  MatSolverType package = nullptr;
  PetscBool cholesky = PETSC_FALSE;
  check(SNESGetKSP(snes_, &ksp));
  check(KSPGetPC(ksp, &pc));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCCHOLESKY, &cholesky));
  if (cholesky == PETSC_FALSE) return -1;
  check(PCFactorGetMatSolverType(pc, &package));
  if (package == nullptr || std::strcmp(package, MATSOLVERMUMPS) != 0) return -1;
  rebase(x_);
  assemble();
  const Timed timed(Event::solve);
  check(KSPSetOperators(ksp, tangent_.matrix(), tangent_.matrix()));
  check(KSPSetUp(ksp));
  check(PCFactorGetMatrix(pc, &factor));
  PetscInt negative = 0;
  constexpr PetscInt number_of_negative_pivots = 12;  // MUMPS users' guide, INFOG(12)
  check(MatMumpsGetInfog(factor, number_of_negative_pivots, &negative));
  return negative;
}

double Equilibrium::pin_reaction() const {
  const double scale = 1.0 / model_.length_scale();
  double largest = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
    const bool pinned = ((model_.held()[k / n] & ~model_.prescribed()[k / n]) >> (k % n) & 1U) != 0;
    if (pinned) largest = std::max(largest, std::abs(wrenches_.at(k)) * (k % n < 3 ? 1.0 : scale));
  }
  double all = 0;
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, part_.comm);
  const Scale size = scale_of_forces();
  return all > size.rounding ? all / size.forces
                             : 0.0;  // without any load all reactions are rounding
}

}  // namespace floe
