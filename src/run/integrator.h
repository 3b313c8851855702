/// \file
/// Integrators take a model from its first state to the scene's end and hand every accepted state
/// to an observer: what they have in common.
#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "floe/run/result.h"
#include "model/model.h"
#include "run/checkpoint.h"

namespace floe {

/// An accepted state, with what is known of the step that led to it.
template <class Space>
struct Accepted {
  const State<Space>& state;
  const Wrenches<Space>& wrenches;  ///< of all forces, on owned bodies
  std::int64_t step;                ///< 0: the initial state
  std::vector<std::pair<std::string, double>> columns =
      {};             ///< what the integrator itself knows (energies)
  bool last = false;  ///< no other will follow
  std::vector<std::pair<std::string, double>> forces =
      {};  ///< what the forces reported then; empty: they can still be asked
};

template <class Space>
using Observer = std::function<void(const Accepted<Space>&)>;
/// Where the space follows from a model, so that a lambda will do.
template <class Space>
using ObserverOf = std::type_identity_t<Observer<Space>>;

/// What an integrator that moves bodies is told.
struct DynamicOptions {
  double end = 1;
  double dt = 0;                 ///< 0: the integrator's own choice
  double velocity_limit = 1000;  ///< of any body [m/s]
  double energy_limit = 0.1;     ///< of the energy balance's error over the energies that move
  double history = 0;            ///< time between samples [s]; 0: 200 over the run
  double fields = 0;             ///< further samples, for frames [s]; 0: none
  double most_steps = default_most_steps;  ///< a run that needs more is refused
  OnPlan on_plan = nullptr;
  CheckpointOptions checkpoint;
};

}  // namespace floe
