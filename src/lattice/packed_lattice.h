/// \file
/// A lattice in less memory, for the time between its uses.
#pragma once

#include <array>
#include <optional>

#include "floe/lattice/lattice.h"

namespace floe {

/// Packs the parts of a sheet's lattice that can be restored: shapes that are prisms of one
/// thickness, properties that all beams share, and bodies that a Part holds too. A large sheet's
/// lattice takes most of rank 0's memory during the set-up of a run.
class PackedLattice {
 public:
  /// Replaces the shapes by prisms, if they are prisms of one thickness.
  void pack_shapes(Lattice& lattice);
  /// Replaces each property that all beams share by one number.
  void pack_beams(Lattice& lattice);
  /// \param copy  equal bodies, which must live until unpack(); if they differ, the lattice keeps
  /// its own
  void pack_bodies(Lattice& lattice, const Bodies& copy);
  /// Restores the lattice to the last bit.
  void unpack(Lattice& lattice);

 private:
  std::optional<Prisms> prisms_;
  const Bodies* bodies_ = nullptr;
  std::array<std::optional<double>, 4> shared_;  ///< of young, shear_modulus, shear_factor, height
};

}  // namespace floe
