/// \file
/// The measure of the bodies' rotations in the strains of beams.
#pragma once

namespace floe {

enum class Kinematics {
  corotational,  ///< any rotation (Crisfield 1990, 1997)
  linear,        ///< small displacements and rotations: strains are linear in the unknowns
};

}  // namespace floe
