/// \file
/// Stiffnesses of a beam. Like the kernels, this header needs neither PETSc nor MPI.
#pragma once

namespace floe {

/// The six stiffnesses of a beam: axial, shear (from I_z, from I_y), torsion, bending about axes 2
/// and 3.
struct BeamStiffness {
  double kn, ksz, ksy;  ///< [N/m]
  double kt, kby, kbz;  ///< [N m]
};

}  // namespace floe
