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

/// The elastic force of a law, proportional to V - V_p.
struct ElasticTerm {
  double rate = 0;        ///< force per volume [N/m^3]
  Vec3<double> couple{};  ///< couple about the centroid of the overlap per volume [N m/m^3]
  double root = 0;        ///< square root of the stiffness along n [(N/m)^1/2]
};

/// Force and couple of a pressure over the facets.
struct Pressure {
  double force = 0;       ///< along n [N]
  Vec3<double> couple{};  ///< about the centroid of the overlap [N m]
};

/// Returns the part of the last step in which the dashpot acts: in the first step of a touch the
/// impulse of the half step before t_n counts from the time t_c of the touch on, which is at most
/// a step ago.
/// \param approach  speed of approach in the middle of the last step [m/s]
inline double touched_for(const ContactState& state, double approach) {
  const double dt = state.last.dt;
  if (state.last.touched || !(dt > 0) || !(approach > 0)) return dt;
  return std::min(dt, state.overlap.volume / (state.area * approach));
}

/// Returns the viscous pressure before any limit: the force -c v_n n at the middle of the facets
/// and the couple -(c/|S|) T omega, with the velocities at t_n that the pressure itself slows down:
/// v* = v/(1 + (dt/2) c/m_eff), v predicted with all other forces.
inline Pressure viscous_pressure(const SharedConstants& constants, const ContactState& state,
                                 double root, double touched) {
  if (constants.damping_ratio == 0 || state.predicted == nullptr) return {};
  const Vec3<double>& n = state.normal;
  const Patch& patch = state.overlap.patch;
  const double dt = state.last.dt, half = 0.5 * dt;
  const Vec3<double> middle = patch.area > 0 ? patch.middle : state.overlap.centroid;
  const double yields = state.mobility.along(middle, n);
  const double c = 2 * constants.damping_ratio * root / std::sqrt(yields);
  const double counts = state.last.touched || !(dt > 0) ? 1.0 : (touched + half) / dt;
  const RelativeMotion& motion = *state.predicted;
  const Vec3<double> velocity =
      motion.velocity + cross(motion.spin, middle - state.overlap.centroid);
  Pressure viscous{.force = -counts * c * dot(velocity, n) / (1 + half * c * yields)};
  const Vec3<double> w = motion.spin - dot(motion.spin, n) * n, tw = patch.rocking(w);
  const double w2 = dot(w, w);
  if (w2 > 0) {
    const double per_area = c / state.area;
    const double slows = per_area * (dot(w, tw) / w2) * (state.mobility.about(w) / w2);
    viscous.couple = (-counts * per_area / (1 + half * slows)) * tw;
  }
  return viscous;
}

/// Advances the springs of friction by the slip of the last step and cuts them.
/// \param stiffness  k_t [N/m]
inline void advance_springs(const ContactState& state, double stiffness, const PairHistory& memory,
                            double touched, double most, double reach, double twist_arm2,
                            PairHistory& now) {
  const Vec3<double>& n = state.normal;
  const Vec3<double>& v = state.motion.velocity;
  const Vec3<double> before =
      turned(carried(memory.springs, n, stiffness), n, state.last.mean_turn);
  const double twist = stiffness * twist_arm2;
  const Friction springs =
      within({.force = before - (touched * stiffness) * (v - dot(v, n) * n),
              .couple = carried(memory.twist, twist) - touched * twist * dot(state.motion.spin, n)},
             most, reach);
  now.springs = {.stiffness = stiffness, .force = springs.force};
  now.twist = {.stiffness = twist, .couple = springs.couple};
}

/// Returns what the dashpots of friction add: 2 zeta sqrt(m_t k_t) against slip and alike against
/// spin, 1/m_t the mean over the directions across n.
inline Friction friction_dashpots(const SharedConstants& constants, const ContactState& state,
                                  const PairHistory& now) {
  const Vec3<double>& n = state.normal;
  const Vec3<double>& at = state.overlap.centroid;
  const double half = 0.5 * state.last.dt;
  const Patch& patch = state.overlap.patch;
  const double yields =
      0.5 * (state.mobility.along(at, patch.u) + state.mobility.along(at, patch.v));
  const double c = 2 * constants.damping_ratio * std::sqrt(now.springs.stiffness / yields);
  const Vec3<double>& v = state.predicted->velocity;
  Friction dashpots{.force = (-c / (1 + half * c * yields)) * (v - dot(v, n) * n)};
  const double turns = state.mobility.about(n);
  if (turns > 0) {
    const double d = 2 * constants.damping_ratio * std::sqrt(now.twist.stiffness / turns);
    dashpots.couple = (-d / (1 + half * d * turns)) * dot(state.predicted->spin, n);
  }
  return dashpots;
}

/// Returns the couple of the viscous pressure under its limits. Where the force along the normal is
/// cut, couples are cut by the same factor; none exceeds what the force can carry over the facets.
inline Vec3<double> limited_couple(const ContactState& state, const Pressure& elastic,
                                   const Pressure& viscous, double pressing, double largest) {
  if (!(pressing > 0)) return -elastic.couple;
  const double raw = elastic.force + viscous.force;
  const Patch& patch = state.overlap.patch;
  const Vec3<double> arm = patch.area > 0 ? patch.middle - state.overlap.centroid : Vec3<double>{};
  const double factor = pressing < raw ? pressing / raw : 1.0;
  Vec3<double> couple =
      factor * viscous.couple + (pressing - elastic.force) * cross(arm, state.normal);
  const double most = pressing * std::sqrt(std::max(largest, 0.0) / state.area);
  const double size = length(couple);
  if (size > most) couple = (most / size) * couple;
  // An elastic couple ends with the force along the normal.
  if (pressing < elastic.force) couple = couple + (pressing / elastic.force - 1) * elastic.couple;
  return couple;
}

/// Returns the response of a contact with an elastic force along the normal, without the energy
/// that this force stores.
/// \param term    of the law
/// \param memory  history of the pair
inline ContactResponse elastic_response(const SharedConstants& constants, const ContactState& state,
                                        const ElasticTerm& term, const PairHistory& memory) {
  const double approach = -dot(state.motion.velocity, state.normal);
  const double yield = plastic_pressure(constants.plastic_limit, state.area, approach) * state.area;
  const double volume = state.overlap.volume;
  PairHistory now = memory;
  if (term.rate * (volume - now.plastic) > yield) now.plastic = volume - yield / term.rate;
  const double pressed = state.elastic_volume(now.plastic);
  const Pressure elastic{.force = term.rate * pressed, .couple = pressed * term.couple};
  const double touched = touched_for(state, approach);
  const Pressure viscous = viscous_pressure(constants, state, term.root, touched);
  const double pressing = std::min(std::max(elastic.force + viscous.force, 0.0), yield);

  const Patch& patch = state.overlap.patch;
  const double most = state.pair.friction * pressing, reach = patch.reach / state.area;
  advance_springs(state, 0.6 * term.root * term.root, memory, touched, most, reach,
                  (patch.uu + patch.vv) / state.area, now);

  ContactResponse response;
  ContactForce& contact = response.contact;
  contact.normal = state.normal;
  contact.elastic = elastic.force;
  contact.viscous = pressing - elastic.force;
  contact.couple = elastic.couple;
  contact.friction = {.force = now.springs.force, .couple = now.twist.couple};
  if (constants.damping_ratio > 0 && state.predicted != nullptr) {
    contact.viscous_couple = limited_couple(state, elastic, viscous, pressing, patch.largest());
    const Friction dashpots = friction_dashpots(constants, state, now);
    contact.friction = within({.force = contact.friction.force + dashpots.force,
                               .couple = contact.friction.couple + dashpots.couple},
                              most, reach);
  }
  contact.memory = now;
  response.stored.tangential = now.springs.energy() + now.twist.energy();
  return response;
}

}  // namespace floe
