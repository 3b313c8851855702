/// \file
/// Asks a force for what it can do, as integrators do; where it cannot, nothing happens.
#pragma once

#include "forces/force.h"

namespace floe {

template <class Space>
void commit(Force<Space>& force, const State<Space>& state, double dt) {
  if (auto* role = force.roles().commits) role->commit(state, dt);
}
template <class Space>
bool add_tangent(Force<Space>& force, const State<Space>& state, Tangent<Space>& tangent) {
  const auto* role = force.roles().tangent;
  return role != nullptr && role->add_tangent(state, tangent);
}
template <class Space>
void add_damping(Force<Space>& force, const State<Space>& state, Tangent<Space>& tangent) {
  if (const auto* role = force.roles().damping) role->add_damping(state, tangent);
}
/// Whether the force has any.
template <class Space>
bool add_losses(Force<Space>& force, const State<Space>& state, Wrenches<Space>& wrenches) {
  const auto* role = force.roles().damping;
  if (role != nullptr) role->add_losses(state, wrenches);
  return role != nullptr;
}
/// The powers of the last evaluation; none if the force does no work.
template <class Space>
std::vector<double> powers(Force<Space>& force) {
  const auto* role = force.roles().work;
  std::vector<double> all(role != nullptr ? role->works() : 0);
  if (role != nullptr) role->powers(all);
  return all;
}
/// The columns of the force. \param works  empty: it has done no work yet
template <class Space>
Columns report(Force<Space>& force, const State<Space>& state, std::vector<double> works = {}) {
  const auto* role = force.roles().work;
  if (works.empty()) works.resize(role != nullptr ? role->works() : 0);
  Columns columns;
  force.report(state, works, columns);
  return columns;
}
template <class Space>
double stiffness_bound(Force<Space>& force, std::int32_t body) {
  const auto* role = force.roles().step;
  return role != nullptr ? role->stiffness_bound(body) : 0.0;
}
template <class Space>
std::optional<double> rate_estimate(Force<Space>& force, const State<Space>& state) {
  const auto* role = force.roles().step;
  return role != nullptr ? role->rate_estimate(state) : std::nullopt;
}

}  // namespace floe
