/// \file
/// Work and energies of contacts, as a step of leapfrog takes them over: velocities lag half a step
/// behind places, so the power of an evaluation counts for half of the step before it and half of
/// the one after.
#pragma once

#include "contact/law.h"

namespace floe {

/// Power of the terms of contacts on the bodies [W], or its integral [J].
struct ContactPower {
  double elastic = 0, viscous = 0, friction = 0;
  double obstacles = 0;  ///< of moving obstacles

  /// Adds half of dt times a power.
  void add_half_step(double last_dt, const ContactPower& before, double dt,
                     const ContactPower& after) {
    elastic += 0.5 * (last_dt * before.elastic + dt * after.elastic);
    viscous += 0.5 * (last_dt * before.viscous + dt * after.viscous);
    friction += 0.5 * (last_dt * before.friction + dt * after.friction);
    obstacles += 0.5 * (last_dt * before.obstacles + dt * after.obstacles);
  }
};

/// What contacts have taken so far and store now [J]; of pairs whose A is counted here.
struct ContactEnergies {
  double stored = 0;    ///< in normal and tangential springs
  double viscous = 0;   ///< lost to the viscous term
  double friction = 0;  ///< lost to sliding
  double crushing = 0;  ///< work of the elastic term that is not stored: what stays crushed, and
                        ///< what law `overlap` does not give back between polyhedra
  double external = 0;  ///< done on bodies by moving obstacles
};

/// The books of all contacts that are counted here, over a run.
struct ContactBooks {
  ContactPower work;           ///< up to the middle of the last step [J]
  double last_dt = 0;          ///< the last step [s]
  double stored_at_start = 0;  ///< [J]
  bool start_is_known = false;

  /// Takes a step over. \param before, after  power with the velocities half a step before and
  /// after the evaluation   \param stored  in the evaluation
  void take(const ContactPower& before, const ContactPower& after, const StoredEnergy& stored,
            double dt) {
    if (!start_is_known) stored_at_start = stored.normal + stored.tangential;
    start_is_known = true;
    work.add_half_step(last_dt, before, dt, after);
    last_dt = dt;
  }

  /// At the time of an evaluation, of which `power` is with the velocities half a step before.
  ContactEnergies energies(const ContactPower& power, const StoredEnergy& stored) const {
    ContactPower now = work;
    now.add_half_step(last_dt, power, 0, {});
    ContactEnergies e;
    e.stored = stored.normal + stored.tangential;
    e.viscous = -now.viscous;
    e.friction = -now.friction - stored.tangential;
    e.crushing = start_is_known ? stored_at_start - now.elastic - stored.normal : 0.0;
    e.external = now.obstacles;
    return e;
  }
};

}  // namespace floe
