/// \file
/// Tips of cracks: junctions of three facets of which exactly one is gone (model.md, "Fracture").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "floe/lattice/lattice.h"

namespace floe {

/// Places in plan where three bodies, and so three facets, meet. Those on the outline are none.
struct Junctions {
  static constexpr std::int32_t none = -1;
  /// Per junction: the global beams of its facets; none where a cut took the beam.
  std::vector<std::array<std::int32_t, 3>> beams;
  /// Per global beam: the junctions at the ends of its facet, or none.
  std::vector<std::array<std::int32_t, 2>> of_beam;
};

/// Finds the junctions of a lattice of prisms from the vertices of its shapes. Not collective.
/// \throws InputError if the lattice has beams and no shapes
Junctions find_junctions(const Lattice& lattice);

/// The junctions of the whole lattice with the beams that are gone; every rank holds the same.
class CrackTips {
 public:
  explicit CrackTips(Junctions junctions);

  /// Whether exactly one of the three facets at an end of this beam's facet is gone, and the beam
  /// is not. \param beam  global index
  bool is_tip(std::int32_t beam) const;
  /// Notes that a beam is gone. \return whether it was not before
  bool lose(std::int32_t beam);
  /// Makes all beams whole again; cuts stay.
  void reset();
  /// Calls `visit` for each beam that shares a junction with a beam, itself included.
  void for_neighbours(std::int32_t beam, auto&& visit) const {
    visit(beam);
    for (const std::int32_t junction : junctions_.of_beam[static_cast<std::size_t>(beam)]) {
      if (junction == Junctions::none) continue;
      for (const std::int32_t other : junctions_.beams[static_cast<std::size_t>(junction)]) {
        if (other != Junctions::none && other != beam) visit(other);
      }
    }
  }

 private:
  Junctions junctions_;
  std::vector<std::uint8_t> gone_;  ///< per global beam
  std::vector<std::uint8_t> lost_;  ///< per junction: number of its facets that are gone
};

}  // namespace floe
