/// \file
/// Powers and energies of contacts.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "contact_laws/response.h"

namespace floe {

/// Power of the terms of contacts on the bodies [W], or the integral of this power [J].
struct ContactPower {
  static constexpr std::size_t terms = 4;

  double elastic = 0, viscous = 0, friction = 0;
  double obstacles = 0;  ///< of moving obstacles on bodies

  /// Returns the terms that write() has written.
  static ContactPower of(std::span<const double> numbers) {
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
  }
  /// Writes the terms. \param out  of length `terms`
  void write(std::span<double> out) const {
    const std::array<double, terms> all{elastic, viscous, friction, obstacles};
    std::copy(all.begin(), all.end(), out.begin());
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

/// Energy that contacts stored in the first evaluation that was committed. Crushing counts from
/// there.
struct StoredAtStart {
  double energy = 0;      ///< [J]
  bool is_known = false;  ///< whether an evaluation was committed

  /// \param stored  in a committed evaluation
  void take(const StoredEnergy& stored) {
    if (!is_known) energy = stored.normal + stored.tangential;
    is_known = true;
  }
};

/// Returns the energies at the time of an evaluation.
/// \param work    until then [J]
/// \param stored  in the evaluation
inline ContactEnergies contact_energies(const ContactPower& work, const StoredEnergy& stored,
                                        const StoredAtStart& start) {
  ContactEnergies e;
  e.stored = stored.normal + stored.tangential;
  e.viscous = -work.viscous;
  e.friction = -work.friction - stored.tangential;
  e.crushing = start.is_known ? start.energy - work.elastic - stored.normal : 0.0;
  e.external = work.obstacles;
  return e;
}

}  // namespace floe
