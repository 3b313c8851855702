/// \file
/// Terms that contact laws share: crushing, the viscous term and friction (model.md, "Contact").
#pragma once

#include <algorithm>
#include <cmath>

#include "contact_laws/response.h"
#include "floe/contact_laws/contact_options.h"

namespace floe {

/// Constants of the terms that laws share.
struct SharedConstants {
  double damping_ratio = 0;    ///< zeta of the viscous term
  PlasticLimit plastic_limit;  ///< sigma_p

  explicit SharedConstants(const ContactOptions& options)
      : damping_ratio(options.damping_ratio), plastic_limit(options.plastic_limit) {}
};

/// Returns sigma_p of a contact [Pa].
/// \param area      of the contact [m^2]
/// \param approach  speed of approach [m/s]
inline double plastic_pressure(const PlasticLimit& limit, double area, double approach) {
  double pressure = limit.pressure;
  if (limit.exponent != 0)
    pressure = std::clamp(pressure * std::pow(area / limit.area, -limit.exponent), limit.least,
                          limit.most);
  if (limit.fast != 1 && approach > 0)
    pressure *= limit.fast + (1 - limit.fast) * std::exp(-approach / limit.speed);
  return pressure;
}

/// Returns the part of the last step in which the dashpot acts: in the first step of a touch the
/// impulse of the half step before t_n counts from the time t_c of the touch on, which is at most
/// a step ago.
/// \param approach  speed of approach in the middle of the last step [m/s]
inline double touched_for(const ContactState& state, double approach) {
  const double dt = state.last.dt;
  if (state.last.touched || !(dt > 0) || !(approach > 0)) return dt;
  return std::min(dt, state.overlap.volume / (state.area * approach));
}

/// A dashpot c = 2 zeta sqrt(stiffness/yields) as it acts over a step on a velocity that c itself
/// slows down: with c/(1 + (dt/2) c yields).
struct StepDashpot {
  double slows = 0;      ///< 1 + (dt/2) c yields
  double over_step = 0;  ///< c/slows

  /// \param yields  relative acceleration per force of the dashpot
  StepDashpot(double damping_ratio, double stiffness, double yields, double dt) {
    const double rate = 2 * damping_ratio * std::sqrt(stiffness * yields);  // c yields
    slows = 1 + 0.5 * dt * rate;
    over_step = rate / (yields * slows);
  }
};

/// Returns the dashpots of a contact: 2 zeta sqrt(m_eff k) of the viscous pressure along n, and of
/// friction 2 zeta sqrt(m_t k_t) against slip, 1/m_t the mean over the directions across n, and
/// alike against spin.
/// \param stiffness     along n
/// \param springs       stiffnesses of the springs of friction
/// \param touched       part of the last step in which the pair touched [s]
/// \param inverse_area  1/|S|
inline Dashpots dashpots_of(double damping_ratio, const ContactState& state, double stiffness,
                            const PairHistory& springs, double touched, double inverse_area) {
  const Patch& patch = state.overlap.patch;
  const double dt = state.last.dt;
  const Vec3<double>& n = state.normal;
  const Vec3<double> middle = patch.area > 0 ? patch.middle : state.overlap.centroid;
  const StepDashpot along(damping_ratio, stiffness, state.mobility.along(middle, n), dt);
  Dashpots d;
  d.counts = state.last.touched || !(dt > 0) ? 1.0 : (touched + 0.5 * dt) / dt;
  d.normal = d.counts * along.over_step;
  d.arm = middle - state.overlap.centroid;
  d.area = along.slows * along.over_step * inverse_area;
  d.widest = std::sqrt(std::max(patch.largest(), 0.0) * inverse_area);
  d.turning = state.mobility.turning();
  if (state.pair.friction > 0) {
    const double slides = state.mobility.across(state.overlap.centroid, n),
                 turns = dot(n, d.turning * n);
    d.slip = StepDashpot(damping_ratio, springs.springs.stiffness, slides, dt).over_step;
    if (turns > 0)
      d.twist = StepDashpot(damping_ratio, springs.twist.stiffness, turns, dt).over_step;
  }
  return d;
}

/// Returns the springs of friction advanced by the slip of the last step, before their limit.
/// \param stiffness  k_t [N/m], and that against spin about n [N m]
inline Friction advanced_springs(const ContactState& state, double stiffness, double twist,
                                 const PairHistory& memory, double touched) {
  const Vec3<double>& n = state.normal;
  const Vec3<double>& v = state.motion.velocity;
  const Vec3<double> before =
      turned(carried(memory.springs, n, stiffness), n, state.last.mean_turn);
  return {.force = before - (touched * stiffness) * (v - dot(v, n) * n),
          .couple = carried(memory.twist, twist) - touched * twist * dot(state.motion.spin, n)};
}

/// Finds a contact with an elastic force along the normal, before its dashpots act.
/// \param term    of the law
/// \param memory  history of the pair
/// \param trial   filled
inline void find_trial_along(const SharedConstants& constants, const ContactState& state,
                             const ElasticTerm& term, const PairHistory& memory,
                             ContactTrial& trial) {
  const double approach = -dot(state.motion.velocity, state.normal);
  const double yield = plastic_pressure(constants.plastic_limit, state.area, approach) * state.area;
  const double volume = state.overlap.volume;
  const Patch& patch = state.overlap.patch;
  trial.normal = state.normal;
  trial.memory = memory;
  double& plastic = trial.memory.plastic;
  if (term.rate * (volume - plastic) > yield) plastic = volume - yield / term.rate;
  const double pressed = state.elastic_volume(plastic);
  trial.elastic = term.rate * pressed;
  trial.couple = pressed * term.couple;
  trial.yield = yield;
  trial.friction = state.pair.friction;
  const double inverse_area = 1 / state.area;
  trial.reach = patch.reach * inverse_area;
  const double stiffness = 0.6 * term.stiffness,
               twist = stiffness * ((patch.uu + patch.vv) * inverse_area);
  const double touched = touched_for(state, approach);
  trial.springs = advanced_springs(state, stiffness, twist, memory, touched);
  trial.memory.springs.stiffness = stiffness;
  trial.memory.twist.stiffness = twist;
  trial.volume = volume;
  trial.area = state.area;
  trial.depth = state.depth;
  trial.pair = state.pair;
  trial.dt = state.last.dt;
  if (constants.damping_ratio == 0) return;
  trial.dashpots = dashpots_of(constants.damping_ratio, state, term.stiffness, trial.memory,
                               touched, inverse_area);
  trial.patch = patch;
}

/// Returns the force of a contact without its dashpots.
inline ContactForce without_dashpots(const ContactTrial& trial) {
  const double pressing = std::min(trial.elastic, trial.yield);
  const Friction springs = within(trial.springs, trial.friction * pressing, trial.reach);
  return {.normal = trial.normal,
          .elastic = trial.elastic,
          .viscous = pressing - trial.elastic,
          .couple = trial.couple,
          .viscous_couple = {},
          .friction = springs,
          .springs = springs};
}

/// Returns the couple -(c/|S|) T omega of the viscous pressure, of the spin across n that it slows
/// down itself.
inline Vec3<double> rocking_couple(const ContactTrial& trial, const Vec3<double>& across) {
  const double w2 = dot(across, across);
  if (!(w2 > 0)) return {};
  const Dashpots& d = trial.dashpots;
  const Vec3<double> tw = trial.patch.rocking(across);
  const double slows = 0.5 * trial.dt * d.area * dot(across, tw) * dot(across, d.turning * across);
  return (-d.counts * d.area * w2 * w2 / (w2 * w2 + slows)) * tw;
}

/// Returns the couple of the viscous pressure under its limits. Where the force along the normal is
/// cut, couples are cut by the same factor; none exceeds what the force can carry over the facets.
/// \param viscous  before any limit: force along n and couple of the pressure
inline Vec3<double> limited_couple(const ContactTrial& trial, double viscous,
                                   const Vec3<double>& rocking, double pressing) {
  if (!(pressing > 0)) return -trial.couple;
  const double raw = trial.elastic + viscous;
  Vec3<double> couple = (pressing - trial.elastic) * cross(trial.dashpots.arm, trial.normal);
  couple = couple + (pressing < raw ? pressing / raw : 1.0) * rocking;
  const double most = pressing * trial.dashpots.widest, size2 = dot(couple, couple);
  if (size2 > most * most) couple = (most / std::sqrt(size2)) * couple;
  // An elastic couple ends with the force along the normal.
  if (pressing < trial.elastic) couple = couple + (pressing / trial.elastic - 1) * trial.couple;
  return couple;
}

/// Returns the force of a contact with its dashpots.
/// \param predicted  motion of A relative to B at c on which dashpots act
inline ContactForce with_dashpots(const ContactTrial& trial, const RelativeMotion& predicted) {
  const Vec3<double>&n = trial.normal, &v = predicted.velocity, &w = predicted.spin;
  const Dashpots& d = trial.dashpots;
  const double about = dot(w, n);
  const Vec3<double> across = w - about * n;
  const double viscous = -d.normal * dot(v + cross(w, d.arm), n);
  const double pressing = std::min(std::max(trial.elastic + viscous, 0.0), trial.yield);
  const double most = trial.friction * pressing;
  ContactForce force{
      .normal = n,
      .elastic = trial.elastic,
      .viscous = pressing - trial.elastic,
      .couple = trial.couple,
      .viscous_couple = limited_couple(trial, viscous, rocking_couple(trial, across), pressing),
      .friction = {},
      .springs = within(trial.springs, most, trial.reach)};
  force.friction = within({.force = force.springs.force - d.slip * (v - dot(v, n) * n),
                           .couple = force.springs.couple - d.twist * about},
                          most, trial.reach);
  return force;
}

}  // namespace floe
