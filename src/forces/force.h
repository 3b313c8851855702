/// \file
/// What every force offers. Evaluation never changes history; only commit does.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/lattice/state.h"
#include "forces/tangent.h"
#include "lattice/archive.h"
#include "lattice/partition.h"

namespace floe {

/// Named numbers for history.csv and summary.json, in order; each rank gives its share, the sum is
/// reported.
class Columns {
 public:
  void add(std::string name, double value) { values_.emplace_back(std::move(name), value); }
  const std::vector<std::pair<std::string, double>>& values() const { return values_; }
  std::vector<std::pair<std::string, double>>& values() { return values_; }

 private:
  std::vector<std::pair<std::string, double>> values_;
};

/// One virtual call per force per evaluation; what is not named in a scene has no object.
template <class Space>
class Force {
 public:
  Force() = default;
  Force(const Force&) = delete;
  Force& operator=(const Force&) = delete;
  virtual ~Force() = default;

  virtual std::string_view name() const = 0;
  /// Adds the force's wrenches on owned bodies at state.time [N, N m].
  virtual void add(const State<Space>& state, Wrenches<Space>& wrenches) const = 0;
  /// Adds minus the derivative of the wrenches; false if the force has none.
  virtual bool add_tangent(const State<Space>& state, Tangent<Space>& tangent) const = 0;
  /// Adds minus the derivative of the wrenches to the velocities, if they depend on them.
  virtual void add_damping(const State<Space>& /*state*/, Tangent<Space>& /*tangent*/) const {}
  /// Adds the wrenches that take energy by the bodies' velocities, which no potential accounts for;
  /// false if there are none.
  virtual bool add_losses(const State<Space>& /*state*/, Wrenches<Space>& /*wrenches*/) const {
    return false;
  }
  /// An upper bound of the force's stiffness against a unit displacement of an owned body [N/m].
  virtual double stiffness_bound(std::int32_t body) const = 0;
  /// Upper bounds of M^-1 K [1/s^2] and M^-1 C [1/s] of a force that says so itself, because
  /// differences of its wrenches at a state would not tell (contacts that are yet to come). Zeros:
  /// they do.
  struct Rates {
    double stiffness = 0, damping = 0;
  };
  virtual Rates hidden_stiffness() const { return {}; }
  /// The longest step for a reason that is no stability of a mode (ways of bodies against their
  /// widths) [s], and that reason, for this rank's bodies. Default: none.
  struct StepLimit {
    double dt = std::numeric_limits<double>::infinity();
    std::string reason;
  };
  virtual StepLimit step_limit(const State<Space>& /*state*/) const { return {}; }
  /// Takes over what an accepted step changes (damage, slip, dissipated energy; the latter as for
  /// leapfrog, whose velocities lag half a step). \param dt step [s]
  virtual void commit(const State<Space>& /*state*/, double /*dt*/) {}
  /// Whether wrenches depend on what commit() took over: then only integrators that evaluate once a
  /// step, and never take one back, can use the force.
  virtual bool has_history() const { return false; }
  /// When what the force does by the clock alone has come to its end (a load's ramp) [s]; 0: at
  /// once.
  virtual double time_dependent_until() const { return 0; }
  /// A cheap measure of the fastest rate at which the force alone moves or stops one of this rank's
  /// bodies [1/s], of forces for which that changes in a run (bodies come to the water, beams are
  /// pressed, drag grows with the speed). Where the sum over forces has grown, the stable step is
  /// found anew in time. Alike on all ranks: all give a number, or none does.
  virtual std::optional<double> rate_estimate(const State<Space>& /*state*/) const { return {}; }

  /// Power on this rank's bodies of what no potential of the force accounts for, in its last
  /// evaluation, which was at `state` [W]; negative where bodies lose energy.
  virtual double power(const State<Space>& /*state*/) const { return 0; }
  /// Takes over the integral of power() over a step, from integrators that find it themselves
  /// instead of calling commit() [J].
  virtual void take_work(double /*work*/) {}
  /// Something that a user must hear of once, as a body that passes through another.
  struct Remark {
    double time = 0;  ///< [s]
    std::string text;
  };
  /// What came since the last call, on this rank.
  virtual std::vector<Remark> take_remarks() { return {}; }
  /// Energies and counts of this rank's share.
  virtual void report(const State<Space>& state, Columns& columns) const = 0;
  /// History to and from a checkpoint; a force without history has nothing to keep.
  virtual void persist(Archive& /*checkpoint*/) {}
};

}  // namespace floe
