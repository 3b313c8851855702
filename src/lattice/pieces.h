/// \file
/// Connected pieces of a lattice.
#pragma once

#include <cstdint>
#include <vector>

#include "floe/lattice/lattice.h"

namespace floe {

/// Returns, per body, the first body of its piece. A piece consists of bodies joined by unbroken
/// beams.
/// \param broken  per beam, 0 if the beam holds; empty: all beams hold
std::vector<std::int32_t> connected_pieces(const Lattice& lattice,
                                           const std::vector<std::uint8_t>& broken = {});

}  // namespace floe
