/// \file
/// New indices of bodies and beams where some join or leave a lattice.
#pragma once

#include <cstdint>
#include <vector>

namespace floe {

/// Per body and per beam of the lattice before: its index in the lattice after; -1: it has left.
/// The order stays.
struct Renumbering {
  std::vector<std::int32_t> bodies, beams;
};

}  // namespace floe
