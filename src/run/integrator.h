/// \file
/// Common types of integrators, which take a model from its first state to the scene's end and hand
/// every accepted state to an observer.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "floe/run/result.h"
#include "model/model.h"
#include "model/rank_balance.h"
#include "run/checkpoint.h"
#include "run/supply.h"

namespace floe {

/// An accepted state and the data of the step that led to it.
template <class Space>
struct Accepted {
  const State<Space>& state;
  const Wrenches<Space>& wrenches;  ///< of all forces, on owned bodies
  std::int64_t step;                ///< 0: the initial state
  /// Columns of the integrator itself (energies).
  std::vector<std::pair<std::string, double>> columns = {};
  bool last = false;  ///< no further state follows
  /// Columns of the forces at this state.
  std::vector<std::pair<std::string, double>> forces = {};
};

template <class Space>
using Observer = std::function<void(const Accepted<Space>&)>;
/// For functions that deduce the space from a model, so that a lambda can be the argument.
template <class Space>
using ObserverOf = std::type_identity_t<Observer<Space>>;

/// Settings of a run of an integrator that moves bodies.
struct DynamicOptions {
  double end = 1;
  double dt = 0;                 ///< step [s]; 0: the integrator chooses
  double velocity_limit = 1000;  ///< largest speed of a body [m/s]
  /// Largest error of the energy balance relative to the energies that moved.
  double energy_limit = 0.1;
  double history = 0;                      ///< time between samples [s]; 0: 200 over the run
  double fields = 0;                       ///< time between further samples for frames [s]; 0: none
  double pressure = 0;                     ///< the same for pressures on obstacles
  double most_steps = default_most_steps;  ///< a run that needs more steps is refused
  OnPlan on_plan = nullptr;
  CheckpointOptions checkpoint;
  std::optional<BalanceOptions> balance;  ///< given: the run keeps account of its ranks
  std::optional<SupplyOptions> supply;    ///< given: ice joins and leaves
  /// Divides the model by owner, with new forces at rest; needed to go back to a saved state.
  std::function<void(const std::vector<std::int32_t>& owner)> remake;
};

}  // namespace floe
