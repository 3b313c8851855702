/// \file
/// Static equilibrium as a SNES problem (model.md, "Static solution").
///
/// Unknowns x (blocks of n per body, PETSc's rows) are the displacement u [m] and the running sum
/// of rotation increments times the model's length scale [m]. Whenever a tangent is formed,
/// increments are spins, so that the tangent is exact (StaticRotations). The residual is minus the
/// wrenches (moments divided by the length scale) [N], zero where unknowns are prescribed.
///
/// Where all forces are linear in the unknowns the tangent is constant: it is assembled and
/// factorised once in a run, and a load step is one solve.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "floe/base/petsc.h"
#include "run/work_ledger.h"
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

  /// Solves for the state at `time`, starting from the present one. Beams that may break do so
  /// until none is overloaded. Returns false and restores the state before if Newton's method
  /// fails; why() then gives the reason. Collective.
  /// \param overload_limit  largest allowed s of undamaged beams before the first of them breaks;
  ///   above it the step is refused
  bool solve(double time, double overload_limit = std::numeric_limits<double>::infinity());

  /// Sets a function that is called in each Newton iteration with the iteration's number, from 0.
  void set_on_iteration(std::function<void(std::int64_t)> on_iteration) {
    on_iteration_ = std::move(on_iteration);
  }
  /// Sets a function that is called before each factorisation.
  void set_on_factorisation(std::function<void()> on_factorisation) {
    on_factorisation_ = std::move(on_factorisation);
  }

  const State<Space>& state() const { return state_; }
  const Wrenches<Space>& wrenches() const { return wrenches_; }
  /// Works of the forces up to the state [J], as Model::report() takes them.
  std::span<const double> works() const { return works_.all(); }
  std::int64_t newton_iterations() const { return iterations_; }
  std::int64_t factorisations() const { return assemblies_; }
  const std::string& why() const { return why_; }
  /// Whether the last failure came after beams had broken, so that only dynamics can go on.
  bool collapsed() const { return collapsed_; }
  /// Diagonal of the box around all bodies, at least a body's own size [m].
  double extent() const { return extent_; }
  /// Whether the last failure was a request to stop.
  bool stopped() const { return stopped_; }
  /// Largest reaction of a pin relative to the forces in equilibrium. Above rounding, a load pushes
  /// a motion that nothing holds. Collective.
  double pin_reaction() const;
  /// Whether pins carry reactions only because Newton's method stopped early: solves from the
  /// present state to the default tolerance and compares the reactions with `small`. Leaves the
  /// state undefined. Collective.
  bool is_stopped_early(double small);
  /// Tolerances of Newton's method in the form of options.
  std::string tolerances() const;
  /// Number of negative eigenvalues of the tangent at the present state: if there are any, the
  /// equilibrium is unstable; -1 if the solver is not Cholesky by MUMPS, which counts them. Costs a
  /// factorisation if forces are not linear, and another one for the part that a planar model
  /// leaves out. To be called last, since it replaces the tangent. Collective.
  std::int64_t unstable_modes(const OutOfPlane* rest);

 protected:  // PathEquilibrium moves the state along a path
  struct Saved {
    State<Space> state;
    StaticRotations<Space> rotations;
    std::vector<PetscScalar> x;
  };

  /// Sizes of forces (2-norms over all ranks) at the present state [N], and the tolerance of the
  /// residual.
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

  struct Energies {
    double stored = 0, external = 0, dissipated = 0;
  };

  static constexpr std::size_t turns = n - Space::translations;

  void set_defaults();
  void begin_anew_after_failure();
  void take(Vec x);    ///< sets the state from the unknowns and updates ghosts
  void rebase(Vec x);  ///< moves the reference of the rotations to the present state
  void fill_residual(Vec f);
  /// Factor from a wrench component to a residual component: 1, or 1/length scale for moments.
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
  Energies energies() const;
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
  WorkLedger works_;
  StaticRotations<Space> rotations_;
  /// Per owned body: square of the accumulated rotation [rad^2]. Rounding grows even when the
  /// quaternion returns to rest, so a full turn counts as one.
  std::vector<double> turned2_;
  std::vector<double> stiffness_;  ///< per owned body, for the rounding level [N/m]
  /// Whether to keep a factorisation that still converges (not if the user set a lag).
  bool adaptive_ = true;
  bool small_turns_ = false;  ///< the prediction of this step turned no body far
  /// Norm of the residual [N], and its ratio to that of the iteration before.
  double last_norm_ = 0, contraction_ = 1;
  /// Squared norms of the wrenches of each external force, summed, on this rank [N^2].
  double external2_ = 0;
  /// Extent of the lattice [m]; largest prescribed displacement [m].
  double extent_ = 0, prescribed_ = 0;
  Tangent<Space> tangent_;
  Handle<Vec> x_, f_, step_;
  Handle<SNES> snes_;
  std::int64_t iterations_ = 0, assemblies_ = 0;
  bool constant_ = false;  ///< the assembled tangent holds for any state
  std::function<void(std::int64_t)> on_iteration_ = [](std::int64_t) {};
  std::function<void()> on_factorisation_ = [] {};
  std::string why_;
  std::optional<State<Space>> before_breaks_;  ///< in the last step, before beams broke or softened
  bool collapsed_ = false, stopped_ = false;
};

}  // namespace floe
