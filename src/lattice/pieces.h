/// \file
/// Connected pieces of a lattice.
#pragma once

#include <cstdint>
#include <vector>

#include "floe/lattice/lattice.h"

namespace floe {

/// Per body, the first body of the piece that it belongs to: bodies joined by beams, but for those
/// that are broken. \param broken  per beam, 0 if it holds; empty: all do
std::vector<std::int32_t> connected_pieces(const Lattice& lattice,
                                           const std::vector<std::uint8_t>& broken = {});

}  // namespace floe
