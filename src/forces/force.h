/// \file
/// What every force does, and the roles that some have and integrators ask for.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
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

/// A force with a tangent, for integrators that solve equations.
template <class Space>
class HasTangent {
 public:
  /// Adds minus the derivative of the wrenches to displacements and rotations; false if nothing was
  /// added.
  virtual bool add_tangent(const State<Space>& state, Tangent<Space>& tangent) const = 0;

 protected:
  ~HasTangent() = default;
};

/// A force that depends on velocities, for integrators that solve equations.
template <class Space>
class Damps {
 public:
  /// Adds minus the derivative of the wrenches to the velocities.
  virtual void add_damping(const State<Space>& state, Tangent<Space>& tangent) const = 0;
  /// Adds the wrenches that take energy by the bodies' velocities, which no potential accounts for.
  virtual void add_losses(const State<Space>& state, Wrenches<Space>& wrenches) const = 0;

 protected:
  ~Damps() = default;
};

/// A force with power that no potential of it accounts for, for integrators that integrate the
/// power themselves.
template <class Space>
class DoesWork {
 public:
  /// Power on this rank's bodies in the last evaluation, which was at `state` [W]; negative where
  /// bodies lose energy.
  virtual double power(const State<Space>& state) const = 0;
  /// Takes over the integral of power() over a step [J].
  virtual void take_work(double work) = 0;

 protected:
  ~DoesWork() = default;
};

/// A force that limits the step of explicit dynamics.
template <class Space>
class LimitsStep {
 public:
  /// An upper bound of the stiffness against a unit displacement of an owned body [N/m].
  virtual double stiffness_bound(std::int32_t body) const = 0;

  /// Upper bounds of M^-1 K [1/s^2] and M^-1 C [1/s].
  struct Rates {
    double stiffness = 0, damping = 0;
  };
  /// Stiffness and damping that the present state does not show (contacts that have not formed),
  /// added to what the search for the stable step measures; where it is not zero the force takes no
  /// part in the measurement. Default: none.
  virtual Rates hidden_stiffness() const { return {}; }

  /// A cheap estimate of the fastest rate at which the force alone moves or stops one of this
  /// rank's bodies [1/s], where that rate changes in a run (bodies come to the water, beams are
  /// pressed, drag grows with the speed). Where the sum over forces has grown, the stable step is
  /// found anew. Either all ranks give a number or none does.
  virtual std::optional<double> rate_estimate(const State<Space>& /*state*/) const { return {}; }

  /// The longest step for another reason than stability (travel of bodies against their widths)
  /// [s], and that reason, for this rank's bodies.
  struct Limit {
    double dt = std::numeric_limits<double>::infinity();
    std::string reason;
  };
  virtual Limit step_limit(const State<Space>& /*state*/) const { return {}; }

 protected:
  ~LimitsStep() = default;
};

/// A force that takes over what an accepted step changes: damage, slip, dissipated energy.
template <class Space>
class Commits {
 public:
  /// After a step of leapfrog, whose velocities lag half a step, or a load step. \param dt  [s]
  virtual void commit(const State<Space>& state, double dt) = 0;
  /// Whether wrenches depend on what commit() took over: then only integrators that evaluate once a
  /// step, and never take one back, can use the force.
  virtual bool has_history() const { return false; }

 protected:
  ~Commits() = default;
};

/// A force with numbers that a checkpoint keeps.
class Persists {
 public:
  virtual void persist(Archive& archive) = 0;

 protected:
  ~Persists() = default;
};

/// A force that depends on the time explicitly.
class DependsOnTime {
 public:
  /// Time after which the force no longer depends on the time (the end of its ramp) [s].
  virtual double time_dependent_until() const = 0;

 protected:
  ~DependsOnTime() = default;
};

/// A force that acts between bodies once no beam joins them any more.
class TakesBrokenPairs {
 public:
  /// Makes pairs whose beam broke eligible from the next evaluation on; their present overlap
  /// counts as stress-free. Collective; each rank may name pairs of its own. \param pairs  global
  /// bodies
  virtual void release(std::span<const std::array<std::int32_t, 2>> pairs) = 0;

 protected:
  ~TakesBrokenPairs() = default;
};

/// Something that a user must hear of once, as a body that passes through another.
struct Remark {
  double time = 0;  ///< [s]
  std::string text;
};
/// A force that has remarks.
class Remarks {
 public:
  /// Those since the last call, on this rank.
  virtual std::vector<Remark> take_remarks() = 0;

 protected:
  ~Remarks() = default;
};

/// What a force can do beside adding wrenches; null: it cannot.
template <class Space>
struct Roles {
  HasTangent<Space>* tangent = nullptr;
  Damps<Space>* damping = nullptr;
  DoesWork<Space>* work = nullptr;
  LimitsStep<Space>* step = nullptr;
  Commits<Space>* commits = nullptr;
  Persists* persists = nullptr;
  TakesBrokenPairs* broken_pairs = nullptr;
  DependsOnTime* time = nullptr;
  Remarks* remarks = nullptr;
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
  /// Adds the force's wrenches on owned bodies at state.time [N, N m]. Keeps by-products of the
  /// evaluation (powers, lists of pairs); history changes by Commits::commit() only.
  virtual void add(const State<Space>& state, Wrenches<Space>& wrenches) = 0;
  /// Energies and counts of this rank's share, at the state of the last evaluation.
  virtual void report(const State<Space>& state, Columns& columns) const = 0;
  virtual Roles<Space> roles() { return {}; }
};

}  // namespace floe
