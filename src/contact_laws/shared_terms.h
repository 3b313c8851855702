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

  SharedConstants() = default;
  explicit SharedConstants(const ContactOptions& options)
      : damping_ratio(options.damping_ratio), plastic_limit(options.plastic_limit) {}
};

/// Returns sigma_p of a contact [Pa].
/// \param area      of the contact [m^2]
/// \param approach  speed of approach [m/s]
template <class T = double>
constexpr T plastic_pressure(const PlasticLimit& limit, T area, T approach) {
  T pressure = limit.pressure;
  if (limit.exponent != 0)
    pressure = std::clamp(pressure * std::pow(area / limit.area, -limit.exponent), limit.least,
                          limit.most);
  if (limit.fast != 1 && approach > 0)
    pressure *= limit.fast + (1 - limit.fast) * std::exp(-approach / limit.speed);
  return pressure;
}
/// The same lane by lane.
template <class T>
constexpr T plastic_pressures(const PlasticLimit& limit, const T& area, const T& approach) {
  if (limit.exponent == 0 && limit.fast == 1) return limit.pressure;
  return by_lane([&](double a, double v) { return plastic_pressure(limit, a, v); }, area, approach);
}

/// Returns the part of the last step in which the dashpot acts: in the first step of a touch the
/// impulse of the half step before t_n counts from the time t_c of the touch on, which is at most
/// a step ago.
/// \param approach  speed of approach in the middle of the last step [m/s]
template <class T>
constexpr T touched_for(const ContactStateOf<T>& state, const T& approach) {
  const T& dt = state.last.dt;
  const auto begins = !state.last.touched && dt > 0.0 && approach > 0.0;
  const T since = state.overlap.volume / chosen(begins, T(state.area * approach), T(1.0));
  return chosen(begins, smaller_of(dt, since), dt);
}

/// A dashpot c = 2 zeta sqrt(stiffness/yields) as it acts over a step on a velocity that c itself
/// slows down: with c/(1 + (dt/2) c yields).
template <class T>
struct StepDashpot {
  T slows = 0;      ///< 1 + (dt/2) c yields
  T over_step = 0;  ///< c/slows

  /// \param yields  relative acceleration per force of the dashpot
  constexpr StepDashpot(double damping_ratio, const T& stiffness, const T& yields, const T& dt) {
    using std::sqrt;
    const T rate = 2 * damping_ratio * sqrt(T(stiffness * yields));  // c yields
    slows = 1.0 + 0.5 * dt * rate;
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
template <class T>
constexpr DashpotsOf<T> dashpots_of(double damping_ratio, const ContactStateOf<T>& state,
                                    const T& stiffness, const PairHistoryOf<T>& springs,
                                    const T& touched, const T& inverse_area) {
  using std::sqrt;
  const PatchOf<T>& patch = state.overlap.patch;
  const T& dt = state.last.dt;
  const Vec3<T>& n = state.normal;
  const Vec3<T> middle = chosen(patch.area > 0.0, patch.middle, state.overlap.centroid);
  const StepDashpot<T> along(damping_ratio, stiffness, state.mobility.along(middle, n), dt);
  DashpotsOf<T> d;
  const auto whole = state.last.touched || !(dt > 0.0);
  d.counts = chosen(whole, T(1.0), T((touched + 0.5 * dt) / chosen(whole, T(1.0), dt)));
  d.normal = d.counts * along.over_step;
  d.arm = middle - state.overlap.centroid;
  d.area = along.slows * along.over_step * inverse_area;
  d.widest = sqrt(T(larger_of(patch.largest(), T(0.0)) * inverse_area));
  d.turning = state.mobility.turning();
  const auto rubs = state.pair.friction > 0.0;
  if (none_of(rubs)) return d;
  const T slides = state.mobility.across(state.overlap.centroid, n), turns = dot(n, d.turning * n);
  const StepDashpot<T> slip(damping_ratio, springs.springs.stiffness, slides, dt);
  d.slip = chosen(rubs, slip.over_step, T(0.0));
  const auto twists = rubs && turns > 0.0;
  const StepDashpot<T> twist(damping_ratio, springs.twist.stiffness, chosen(twists, turns, T(1.0)),
                             dt);
  d.twist = chosen(twists, twist.over_step, T(0.0));
  return d;
}

/// Returns the springs of friction advanced by the slip of the last step, before their limit.
/// \param stiffness  k_t [N/m], and that against spin about n [N m]
template <class T>
constexpr FrictionOf<T> advanced_springs(const ContactStateOf<T>& state, const T& stiffness,
                                         const T& twist, const PairHistoryOf<T>& memory,
                                         const T& touched) {
  const Vec3<T>& n = state.normal;
  const Vec3<T>& v = state.motion.velocity;
  const Vec3<T> before = turned(carried(memory.springs, n, stiffness), n, state.last.mean_turn);
  return {.force = before - (touched * stiffness) * (v - dot(v, n) * n),
          .couple = carried(memory.twist, twist) - touched * twist * dot(state.motion.spin, n)};
}

/// Finds a contact with an elastic force along the normal, before its dashpots act.
/// \param term    of the law
/// \param memory  history of the pair
/// \param trial   filled
template <class T>
constexpr void find_trial_along(const SharedConstants& constants, const ContactStateOf<T>& state,
                                const ElasticTermOf<T>& term, const PairHistoryOf<T>& memory,
                                ContactTrialOf<T>& trial) {
  const T approach = -dot(state.motion.velocity, state.normal);
  const T yield = plastic_pressures(constants.plastic_limit, state.area, approach) * state.area;
  const T volume = state.overlap.volume;
  const PatchOf<T>& patch = state.overlap.patch;
  trial.normal = state.normal;
  trial.memory = memory;
  T& plastic = trial.memory.plastic;
  const auto crushes = term.rate * (volume - plastic) > yield;
  plastic = chosen(crushes, T(volume - yield / term.rate), plastic);
  const T pressed = state.elastic_volume(plastic);
  trial.elastic = term.rate * pressed;
  trial.couple = pressed * term.couple;
  trial.yield = yield;
  trial.friction = state.pair.friction;
  const T inverse_area = 1.0 / state.area;
  trial.reach = patch.reach * inverse_area;
  const T stiffness = 0.6 * term.stiffness,
          twist = stiffness * ((patch.uu + patch.vv) * inverse_area);
  const T touched = touched_for(state, approach);
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
template <class T>
constexpr ContactForceOf<T> without_dashpots(const ContactTrialOf<T>& trial) {
  const T pressing = smaller_of(trial.elastic, trial.yield);
  const FrictionOf<T> springs = within(trial.springs, T(trial.friction * pressing), trial.reach);
  return {.normal = trial.normal,
          .elastic = trial.elastic,
          .viscous = pressing - trial.elastic,
          .couple = trial.couple,
          .viscous_couple = {},
          .friction = springs,
          .springs = springs};
}

/// Returns the couple -(c/|S|) T omega of the viscous pressure, of the spin across n that it slows
/// down itself. The spin of a body that comes to rest falls for ever; below 1e-75 rad/s, where its
/// fourth power is no longer a number, it counts as 0.
template <class T>
constexpr Vec3<T> rocking_couple(const ContactTrialOf<T>& trial, const Vec3<T>& across) {
  constexpr double least = 1e-150;
  const T w2 = dot(across, across);
  const auto rocks = w2 > least;
  const DashpotsOf<T>& d = trial.dashpots;
  const Vec3<T> tw = trial.patch.rocking(across);
  const T slows = 0.5 * trial.dt * d.area * dot(across, tw) * dot(across, d.turning * across);
  const T share = -d.counts * d.area * w2 * w2 / chosen(rocks, T(w2 * w2 + slows), T(1.0));
  return chosen(rocks, share * tw, Vec3<T>{});
}

/// Returns the couple of the viscous pressure under its limits. Where the force along the normal is
/// cut, couples are cut by the same factor; none exceeds what the force can carry over the facets.
/// \param viscous  before any limit: force along n and couple of the pressure
template <class T>
constexpr Vec3<T> limited_couple(const ContactTrialOf<T>& trial, const T& viscous,
                                 const Vec3<T>& rocking, const T& pressing) {
  using std::sqrt;
  const T raw = trial.elastic + viscous;
  const auto presses = pressing > 0.0, cut = pressing < raw;
  Vec3<T> couple = (pressing - trial.elastic) * cross(trial.dashpots.arm, trial.normal);
  couple = couple + chosen(cut, T(pressing / chosen(cut, raw, T(1.0))), T(1.0)) * rocking;
  const T most = pressing * trial.dashpots.widest, size2 = dot(couple, couple);
  const auto wide = size2 > most * most;
  couple = chosen(wide, T(most / sqrt(chosen(wide, size2, T(1.0)))), T(1.0)) * couple;
  // An elastic couple ends with the force along the normal.
  const auto tears = pressing < trial.elastic;
  const T share = pressing / chosen(tears, trial.elastic, T(1.0)) - 1.0;
  couple = chosen(tears, couple + share * trial.couple, couple);
  return chosen(presses, couple, -trial.couple);
}

/// Returns the force of a contact with its dashpots.
/// \param predicted  motion of A relative to B at c on which dashpots act
template <class T>
constexpr ContactForceOf<T> with_dashpots(const ContactTrialOf<T>& trial,
                                          const RelativeMotionOf<T>& predicted) {
  const Vec3<T>&n = trial.normal, &v = predicted.velocity, &w = predicted.spin;
  const DashpotsOf<T>& d = trial.dashpots;
  const T about = dot(w, n);
  const Vec3<T> across = w - about * n;
  const T viscous = -d.normal * dot(v + cross(w, d.arm), n);
  const T pressing = smaller_of(larger_of(T(trial.elastic + viscous), T(0.0)), trial.yield);
  const T most = trial.friction * pressing;
  ContactForceOf<T> force{
      .normal = n,
      .elastic = trial.elastic,
      .viscous = pressing - trial.elastic,
      .couple = trial.couple,
      .viscous_couple = limited_couple(trial, viscous, rocking_couple(trial, across), pressing),
      .friction = {},
      .springs = within(trial.springs, most, trial.reach)};
  const FrictionOf<T> damped{.force = force.springs.force - d.slip * (v - dot(v, n) * n),
                             .couple = force.springs.couple - d.twist * about};
  force.friction = within(damped, most, trial.reach);
  return force;
}

}  // namespace floe
