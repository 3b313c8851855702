/// \file
/// The nonlinear equations of static equilibrium as a SNES problem.
///
/// Unknowns x (blocks of n per body, PETSc's rows): displacement u [m] and the running sum of
/// rotation increments times the model's length scale; whenever a tangent is formed increments are
/// spins, so that it is exact (StaticRotations). The residual is minus the wrenches (moments
/// divided by the length scale), zero where unknowns are prescribed.
///
/// Where all forces are linear in the unknowns the tangent is one and the same: it is assembled and
/// factorised once in a run, and a load step is one solve.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "floe/base/petsc.h"
#include "statics/quasistatic.h"
#include "statics/static_rotations.h"

namespace floe {

template <class Space>
class Equilibrium {
 public:
  static constexpr int n = Space::unknowns;

  explicit Equilibrium(Model<Space>& model);
  Equilibrium(const Equilibrium&) = delete;
  Equilibrium& operator=(const Equilibrium&) = delete;

  /// Solves for the state at `time`, starting from the present one. Returns false, with the state
  /// as before, if Newton fails; why() then says so.
  /// Beams that may break do so until none is overloaded. \param overload_limit  on the largest s
  /// of undamaged beams before the first of them breaks: above it the step is refused
  bool solve(double time, double overload_limit = std::numeric_limits<double>::infinity());

  /// Called in each of Newton's iterations, with its number from 0.
  void set_on_iteration(std::function<void(std::int64_t)> on_iteration) {
    on_iteration_ = std::move(on_iteration);
  }
  /// Called before each factorisation.
  void set_on_factorisation(std::function<void()> on_factorisation) {
    on_factorisation_ = std::move(on_factorisation);
  }

  const State<Space>& state() const { return state_; }
  const Wrenches<Space>& wrenches() const { return wrenches_; }
  std::int64_t newton_iterations() const { return iterations_; }
  std::int64_t factorisations() const { return assemblies_; }
  const std::string& why() const { return why_; }
  /// Whether the last failure came after beams had broken: the way on is dynamic.
  bool collapsed() const { return collapsed_; }
  /// Whether the last failure was a request to stop.
  bool stopped() const { return stopped_; }
  /// Largest reaction of a pin over the size of the forces in equilibrium: above rounding, a load
  /// pushes a motion that nothing holds.
  double pin_reaction() const;
  /// Whether the pins' reactions are there only because Newton's method stopped early: solves on
  /// from the present state, to the default tolerance, and looks whether they are below `small`
  /// then. Leaves the state anywhere.
  bool is_stopped_early(double small);
  /// The tolerances that Newton's method has, as options.
  std::string tolerances() const;
  /// Number of negative eigenvalues of the tangent at the present state: more than none is an
  /// unstable equilibrium. Costs a factorisation if forces are not linear, and one more for what a
  /// planar model leaves out; -1 if the solver is not Cholesky by MUMPS, which tells. To be asked
  /// last.
  std::int64_t unstable_modes(const OutOfPlane* rest);

 private:
  struct Saved {
    State<Space> state;
    StaticRotations<Space> rotations;
    std::vector<PetscScalar> x;
  };

  /// Sizes (2-norms over all ranks) at the present state [N]. What the residual must fall below.
  struct Scale {
    double forces;    ///< of external forces and reactions
    double rounding;  ///< of the beams' forces
    double tolerance(double rtol, double atol) const {
      return std::max({rtol * forces, rounding, atol});
    }
  };

  static PetscErrorCode residual(SNES, Vec x, Vec f, void* self) noexcept;
  static PetscErrorCode jacobian(SNES, Vec x, Mat, Mat, void* self) noexcept;
  static PetscErrorCode converged(SNES, PetscInt it, PetscReal xnorm, PetscReal gnorm, PetscReal f,
                                  SNESConvergedReason*, void* self) noexcept;

  static constexpr std::size_t turns = n - Space::translations;

  void set_defaults();
  void begin_anew_after_failure();
  void take(Vec x);    ///< state of the unknowns, ghosts included
  void rebase(Vec x);  ///< moves the reference of the rotations to the present state
  void fill_residual(Vec f);
  /// Forces' share of a component of the residual [N].
  double weight(std::size_t k) const {
    return k % n < Space::translations ? 1.0 : 1.0 / model_.length_scale();
  }
  std::array<double, turns> turn_of(const PetscScalar* unknowns) const;
  void assemble(std::span<const double> increments = {});
  void assemble_out_of_plane(const OutOfPlane& rest);
  std::vector<double> increments_to(double time);
  void fill_right_hand_side(std::vector<double>& increments);
  bool predict(double time);
  bool balance(double time);
  bool let_break(double time, double overload_limit);
  bool keeps_factorisation() const;
  Scale scale_of_forces() const;
  bool is_lost() const;
  std::int64_t count_folded() const;
  void audit(const char* where) const;
  Saved save() const;
  void restore(const Saved& saved);

  Model<Space>& model_;
  const Part& part_;
  State<Space> state_;
  Wrenches<Space> wrenches_, share_;
  StaticRotations<Space> rotations_;
  /// Owned bodies: square of the rotation so far [rad^2]. A full turn counts as one, although its
  /// quaternion is that of rest: what it took to get there has left rounding.
  std::vector<double> turned2_;
  std::vector<double> stiffness_;  ///< per owned body, for the rounding level [N/m]
  bool adaptive_ =
      true;  ///< whether to keep a factorisation that still converges (not if the user set a lag)
  bool small_turns_ = false;                ///< the prediction of this step turned no body by much
  double last_norm_ = 0, contraction_ = 1;  ///< of the residual, over the last iteration
  double external2_ = 0;  ///< squared norm of each external force's wrenches, summed, this rank
  double extent_ = 0,
         prescribed_ = 0;  ///< of the lattice; largest displacement that is prescribed [m]
  Tangent<Space> tangent_;
  Handle<Vec> x_, f_, step_;
  Handle<SNES> snes_;
  std::int64_t iterations_ = 0, assemblies_ = 0;
  bool constant_ = false;  ///< the assembled tangent is that of any state
  std::function<void(std::int64_t)> on_iteration_ = [](std::int64_t) {};
  std::function<void()> on_factorisation_ = [] {};
  std::string why_;
  bool collapsed_ = false, stopped_ = false;
};

}  // namespace floe
