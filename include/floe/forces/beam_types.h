/// \file
/// What kernels of beams share with those who ask for them; free of PETSc and MPI.
#pragma once

namespace floe {

enum class Kinematics {
  corotational,  ///< any rotation (Crisfield 1990, 1997)
  linear,        ///< small displacements and rotations: strains are linear in the unknowns
};

/// The six stiffnesses of a beam: axial, shear (from I_z, from I_y), torsion, bending about axes 2
/// and 3.
struct BeamStiffness {
  double kn, ksz, ksy;  ///< [N/m]
  double kt, kby, kbz;  ///< [N m]
};

}  // namespace floe
