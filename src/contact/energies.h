/// \file
/// Work and energies of contacts in steps of leapfrog. Velocities lag half a step behind places, so
/// the forces of an evaluation do work over half of the step before it and half of the step after
/// it.
#pragma once

#include "contact_laws/response.h"

namespace floe {

/// Power of the terms of contacts on the bodies [W], or the integral of this power [J].
struct ContactPower {
  double elastic = 0, viscous = 0, friction = 0;
  double obstacles = 0;  ///< power of moving obstacles on bodies

  /// Adds last_dt/2 times the power `before` and dt/2 times the power `after`.
  void add_half_step(double last_dt, const ContactPower& before, double dt,
                     const ContactPower& after) {
    elastic += 0.5 * (last_dt * before.elastic + dt * after.elastic);
    viscous += 0.5 * (last_dt * before.viscous + dt * after.viscous);
    friction += 0.5 * (last_dt * before.friction + dt * after.friction);
    obstacles += 0.5 * (last_dt * before.obstacles + dt * after.obstacles);
  }
};

/// Energies of the counted pairs [J]: stored now, and lost or done so far.
struct ContactEnergies {
  double stored = 0;    ///< in normal and tangential springs
  double viscous = 0;   ///< lost to the viscous term
  double friction = 0;  ///< lost to sliding
  double crushing = 0;  ///< work of the elastic term that is not stored: that of crushing, and that
                        ///< which the law `overlap` does not give back between polyhedra
  double external = 0;  ///< done on bodies by moving obstacles
};

/// Work of the counted contacts over a run.
struct ContactBooks {
  ContactPower work;            ///< up to the middle of the last step [J]
  double last_dt = 0;           ///< length of the last step [s]
  double stored_at_start = 0;   ///< in the first committed evaluation [J]
  bool start_is_known = false;  ///< whether a step was taken over

  /// Takes over a step.
  /// \param before, after  power in the evaluation, with the velocities half a step before it and
  ///                       half a step after it
  /// \param stored         energy in the evaluation
  /// \param dt             length of the step after the evaluation [s]
  void take(const ContactPower& before, const ContactPower& after, const StoredEnergy& stored,
            double dt) {
    if (!start_is_known) stored_at_start = stored.normal + stored.tangential;
    start_is_known = true;
    work.add_half_step(last_dt, before, dt, after);
    last_dt = dt;
  }

  /// Energies at the time of an evaluation.
  /// \param power   in the evaluation, with the velocities half a step before it
  /// \param stored  energy in the evaluation
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
