/// \file
/// A lattice that waits in less memory.
#pragma once

#include <array>
#include <optional>

#include "floe/lattice/lattice.h"

namespace floe {

/// What a sheet's lattice can do without while nobody looks at it: shapes, where they are prisms of
/// one thickness, properties that all beams share, and bodies that are a part's as well. A large
/// sheet's lattice is most of rank 0's memory during a run's set-up.
class PackedLattice {
 public:
  void pack_shapes(Lattice& lattice);
  void pack_beams(Lattice& lattice);
  /// \param copy  of the bodies, must live until unpack(); if it differs, the bodies stay
  void pack_bodies(Lattice& lattice, const Bodies& copy);
  /// As it was, to the last bit.
  void unpack(Lattice& lattice);

 private:
  std::optional<Prisms> prisms_;
  const Bodies* bodies_ = nullptr;
  std::array<std::optional<double>, 4> shared_;  ///< of young, shear_modulus, shear_factor, height
};

}  // namespace floe
