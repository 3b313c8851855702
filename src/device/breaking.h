/// \file
/// Damage and breaks of the beams of tiles (model.md, "Fracture"). The law is that of
/// src/fracture_laws/law.h; here is its memory only.
#pragma once

#include <cstdint>

#include "beams/kernel.h"
#include "device/engine.h"
#include "device/halts.h"
#include "device/launch.h"
#include "device/soa.h"
#include "fracture_laws/law.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// The law of a run's beams.
struct BreakingOfRun {
  std::int32_t general;  ///< Criterion::general
  std::int32_t crushes;
  std::int32_t halts;  ///< after a step in which a beam has broken
  std::int64_t times;  ///< where the times of its queued steps begin
};

/// Memory of breakable beams, per slot.
struct BreakingMemory {
  const BreakingOfRun* runs;
  const double* times;   ///< of the queued steps [s]
  const double* limits;  ///< twice the energy that a whole beam may hold before it is looked at [J]
  Soa constants;         ///< as Breaking::beams
  Soa cracks;            ///< as Damage::cracks
  SoaOf<float> viscous;  ///< forces of dashpots at the start of the last step; null: none
  std::uint64_t* grown;  ///< per run: not 0 if the damage of a beam has grown
  Halts halts;
};

/// A breakable beam in one step.
template <class Kernel, class Constants>
struct BreakableBeam {
  const BreakingMemory& memory;
  const BreakingOfRun& run;
  std::int64_t slot;
  const Constants& beam;
  const BeamStrains<double>& strains;
  const BeamStress<double>& force;  ///< of the undamaged springs

  constexpr double number(int n) const { return memory.constants.at(n, slot); }
  constexpr Strength<double> strength() const {
    return {number(0), number(1), number(2), number(3), number(4)};
  }
  constexpr FurtherStrength<double> further() const {
    constexpr int first = Breaking::further;
    return {number(first), number(first + 1), number(first + 2)};
  }
  constexpr double of_crack(int n) const { return memory.cracks.at(n, slot); }
  constexpr Crack crack() const {
    Crack c;
    c.kappa = of_crack(Damage::kappa), c.damage = of_crack(Damage::damage);
    c.ultimate = of_crack(Damage::ultimate), c.mode_mix = of_crack(Damage::mode_mix);
    c.nominal = of_crack(Damage::nominal), c.dissipated = of_crack(Damage::dissipated);
    c.at_tip = of_crack(Damage::at_tip) != 0, c.crushed = of_crack(Damage::crushed) != 0;
    return c;
  }

  /// Whether nothing can happen to a beam without a crack.
  constexpr bool holds() const {
    const double twice = force.n * strains.delta + force.qy * strains.gamma_y +
                         force.qz * strains.gamma_z + dot(force.c, strains.psi);
    return !(twice > memory.limits[slot]);
  }

  /// Lets the damage grow at this state, and returns what is left of the beam's stiffnesses.
  /// \param known  the beam has a crack
  /// \param rates  of the strains
  /// \param step   of the launch \param dt  length of the last step [s] \param of_run  index
  /// \param middle  returns the middle between the ends at this state [m]
  template <class Rates, class Middle>
  FLOE_KERNEL Softening soften(bool known, const Rates& rates, int step, double dt,
                               std::int32_t of_run, const Middle& middle) const {
    Crack now = known ? crack() : Crack{};
    double s2 = 0;
    bool crushing = false;
    if (run.general != 0) {
      const Criteria<double> both = criteria(strength(), further(), force, run.crushes != 0);
      s2 = std::max(both.tension, both.pressure);
      crushing = run.crushes != 0 && both.pressure > 1 && both.pressure > both.tension;
    } else {
      s2 = criterion(strength(), force);
    }
    if (s2 > now.kappa * now.kappa || (known && !now.crushed && crushing)) {
      const double before = now.damage;
      const BeamStress<double> strain{strains.delta, strains.gamma_y, strains.gamma_z, strains.psi};
      DamageEnergy energy = damage_energy(force, strain);
      Crack next = grown(known ? &now : nullptr, std::sqrt(s2), crushing, false, energy,
                         number(Breaking::area), number(Breaking::toughness),
                         number(Breaking::toughness + 1));
      const DamageEnergy path = energy_over_step(next, force, strain, rates(), dt);
      if (next.broken()) {
        if (run.halts != 0) memory.halts.halt(of_run, step, Made::beam_broke);
        const Vec3<double> place = middle();
        memory.cracks.at(Damage::time, slot) = memory.times[run.times + step];
        memory.cracks.at(Damage::place, slot) = place.x;
        memory.cracks.at(Damage::place + 1, slot) = place.y;
        memory.cracks.at(Damage::place + 2, slot) = place.z;
      }
      now = dissipating(next, before, crushing, energy, path).crack;
      keep(now);
      raise(&memory.grown[of_run], 1);
      known = true;
    }
    if (!known) return {};
    return softening(now.damage, strains.delta <= 0 && !now.crushed, now.broken());
  }

 private:
  FLOE_KERNEL void keep(const Crack& c) const {
    const auto put = [&](int n, double value) { memory.cracks.at(n, slot) = value; };
    put(Damage::kappa, c.kappa), put(Damage::damage, c.damage);
    put(Damage::ultimate, c.ultimate), put(Damage::mode_mix, c.mode_mix);
    put(Damage::nominal, c.nominal), put(Damage::dissipated, c.dissipated);
    put(Damage::at_tip, c.at_tip ? 1 : 0), put(Damage::crushed, c.crushed ? 1 : 0);
  }
};

}  // namespace
}  // namespace floe::device
