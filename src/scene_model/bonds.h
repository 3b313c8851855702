/// \file
/// Bonds: beams between bodies that touch or nearly touch, where the water between them froze.
#pragma once

#include <cstdint>
#include <string>

#include "floe/lattice/lattice.h"
#include "floe/scene.h"

namespace floe {

/// Bonds that were made.
struct BondReport {
  std::int64_t number = 0;
  double area = 0;                     ///< of all interfaces [m^2]
  double least_gap = 0, most_gap = 0;  ///< between the faces; below 0: they overlap [m]
};

/// Describes them: "4 between faces, 2 m^2; gaps from 0 to 0.01 m".
std::string text_of(const BondReport& report);

/// Adds a beam for each interface (geometry/interface.h) of two bodies that no beam joins yet, of
/// at most `gap` between its faces and with its centre in the box. The beam is normal to the
/// interface, through its centre, and ends at the feet of the bodies' centroids; its section has
/// the interface's area and second moments. Interfaces with a third body in between, to which beams
/// join both, are none (cells of a sheet that almost meet), nor are those smaller than 1e-3
/// V^(2/3), V the volume of the smaller body. \throws InputError if the lattice has no shapes, or
/// if there is no interface
BondReport add_bonds(const Scene& scene, Lattice& lattice);

}  // namespace floe
