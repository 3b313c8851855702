/// \file
/// Static equilibria along a path on which the load factor is an unknown (model.md, "Static
/// solution", paths past limit points).
///
/// An iteration solves K du_r = -F and K du_q = q with one factorisation, q the derivative of the
/// loads to the load factor less the columns of prescribed unknowns; the change of the load factor
/// follows from the condition by which the step ends (Batoz & Dhatt 1979):
///
///     du = du_r + dlambda du_q
///
/// - the length of the step: |u - u_0| = arc, the cylindrical arc of Crisfield (1981), in
///   displacements and rotations times the length scale, without a term of the load;
/// - a given load factor;
/// - a reading of the state: a displacement, or the load of the beam that is nearest to breaking.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "statics/equilibrium.h"

namespace floe {

/// Settings of the equilibria along a path.
template <class Space>
struct PathSettings {
  double full_time = 1;  ///< pseudo-time at which loads and motions have the load factor 1 [s]
  double sense = 1;      ///< sign of the first change of the load factor
  /// Growth of s in a step of the softening beam that grows most, relative to s and to what is left
  /// of its range.
  double growth = 0.05;
  /// Displacement by which a path may end [m]; may be empty.
  std::function<double(const State<Space>&)> monitored = nullptr;
};

template <class Space>
class PathEquilibrium : public Equilibrium<Space> {
 public:
  PathEquilibrium(Model<Space>& model, PathSettings<Space> settings);

  /// Makes the present equilibrium the first of the path. Collective.
  void begin();
  /// Proposes the next equilibrium: at a given arc length, or nearer where a beam reaches its
  /// strength. If one has reached it already, it breaks or softens, and the load factor goes to
  /// where the next beam is at its limit. accept() or reject() must follow. False: no equilibrium
  /// was found; why() gives the reason and the state is that before. Collective.
  /// \param arc   root mean square over bodies of the step's displacements and rotations times the
  ///              length scale [m]
  /// \param step  number of the step, the time of breaks
  bool propose(double arc, double step);
  /// Moves the proposed equilibrium to a load factor, or to a monitored displacement [m]. False:
  /// the proposal is undone. Collective.
  bool move_to_factor(double factor);
  bool move_to_displacement(double displacement);
  /// Makes the proposed equilibrium the present one. Collective.
  void accept();
  /// Goes back to the equilibrium before the proposal. Collective.
  void reject();

  double factor() const { return factor_; }
  double factor_before() const { return before_.factor; }
  double monitored() const { return settings_.monitored(state_); }
  double monitored_before() const { return before_.monitored; }
  /// Length of the path to the last accepted equilibrium [m].
  double length() const { return length_; }
  /// Length of the last proposed or accepted step [m].
  double last_arc() const { return last_arc_; }
  /// Work of the prescribed motions until then [J], the same on all ranks.
  double boundary_work() const { return boundary_work_; }
  /// Whether in the last accepted step the load factor and the displacements in the direction of
  /// the load both went back, or the load factor where it moves a boundary.
  bool snapped_back() const { return snapped_back_; }
  /// Tangents that the last proposal factorised: few where the path is nearly straight.
  std::int64_t tangents_of_step() const { return this->factorisations() - tangents_before_; }
  /// Whether in the proposed step beams broke or softened.
  bool beams_changed() const { return changed_; }
  /// Whether the last failure came since no load brings another beam to its strength: what the
  /// load pulls has come apart.
  bool came_apart() const { return came_apart_; }
  /// Arc length of a step from the present equilibrium that changes the load factor by `change`, by
  /// its tangent [m]. 0 if the load moves nothing. Collective.
  double arc_of(double change);

 private:
  using Base = Equilibrium<Space>;
  using Base::audit, Base::balance, Base::energies, Base::fill_residual, Base::restore, Base::save,
      Base::take;
  using Base::collapsed_, Base::constant_, Base::contraction_, Base::f_, Base::iterations_,
      Base::last_norm_, Base::model_, Base::n, Base::on_iteration_, Base::part_, Base::small_turns_,
      Base::snes_, Base::state_, Base::step_, Base::stopped_, Base::tangent_, Base::why_,
      Base::works_, Base::wrenches_, Base::x_;
  using typename Base::Energies;
  using typename Base::Saved;

  /// A reading of the state that has a root where a step ends.
  struct Reading {
    std::function<double()> value;  ///< at the present state
    bool far;                       ///< convex in the load factor: the far end of what is at most 0
    double tolerance;               ///< of the value
  };
  /// The condition by which a step ends: one of the three.
  struct Goal {
    std::optional<double> arc, factor;  ///< [m], -
    const Reading* reading = nullptr;
  };
  /// The equilibrium before a proposal.
  struct Before {
    Saved saved;
    double factor = 0, monitored = 0;
    std::vector<double> residual;  ///< on prescribed unknowns: the boundaries' forces [N]
    Energies energies;
  };

  void keep_before();
  void place();
  bool form();
  bool solve_linear(Vec right, Vec solution);
  bool go(const Goal& goal);
  std::optional<bool> is_there(const Goal& goal, std::int64_t it);
  bool iterate(const Goal& goal, std::int64_t it);
  double largest_turn(Vec v) const;
  bool is_met(const Goal& goal, std::int64_t it) const;
  std::optional<double> change_of_factor(const Goal& goal, std::int64_t it);
  std::optional<double> change_by_arc(double arc, std::int64_t it);
  std::optional<double> change_by_reading(const Reading& reading);
  bool move(const Goal& goal);
  bool elastic_step(double arc);
  bool turns_back();
  bool break_beams(double step);
  std::int64_t number_of_pieces() const;
  double nearness(double growth) const;
  Reading at_limit(double growth) const;
  double boundary_work_of_step() const;
  void add_works();
  double dot(Vec a, Vec b) const;
  double arc_length(Vec v) const;

  const PathSettings<Space> settings_;
  double factor_ = 0, length_ = 0, last_arc_ = 0, boundary_work_ = 0;
  double sense_;  ///< of the load factor on the branch where the load of the beams grows
  bool has_direction_ = false;  ///< the last step gives the direction of the next one
  bool moves_boundaries_ = false;
  bool formed_ = false, changed_ = false, came_apart_ = false, snapped_back_ = false;
  std::int64_t tangents_before_ = 0, pieces_at_start_ = 1;
  double unit_ = 1;                 ///< typical change of the load factor in searches
  std::vector<double> per_factor_;  ///< prescribed unknowns per load factor, n per local body
  Before before_;
  Wrenches<Space> pull_;
  /// Start of a step; du_r; du_q; q; a trial; the last accepted step.
  Handle<Vec> start_, right_, along_, pull_vector_, trial_, last_;
};

}  // namespace floe
