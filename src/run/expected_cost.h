/// \file
/// What a run of a sheet will take, before it is known.
///
/// Formulas fitted to runs of sheets of 3,000 to 30,000 bodies on the machine of docs/bench: meant
/// to be good to a factor of 3 (docs/decisions, "Planned time of static and implicit runs") for
/// lattices whose beams lie as a sheet's; blocks of layers take longer.
#pragma once

#include "floe/base/petsc.h"

namespace floe {

/// Of the Cholesky factorisation of a sheet's tangent by MUMPS.
struct FactorisationCost {
  double seconds;        ///< assembly included
  double solve_seconds;  ///< of one solve with it, and one residual
  double bytes;          ///< matrix and factor, over all ranks
};
/// \param unknowns  of the whole sheet
FactorisationCost factorisation_cost(double unknowns, int ranks);

/// What a plan of such a run says it rests on.
inline constexpr const char* sheets_like_it = "what sheets of this size take, roughly";

/// Memory of a run on `ranks` ranks beside solvers: each builds the whole lattice [B].
double lattice_bytes(double bodies, int ranks);

/// Whether a lattice has no more beams per body than a sheet.
inline bool is_like_a_sheet(double bodies, double beams) { return beams <= 3.5 * bodies; }

/// Archive that the system would give to new work, summed over the machines of the ranks: what is
/// free, within the limit of the group of processes (cgroup) that it runs in; infinite if it is not
/// known. Collective. [B]
double free_memory(MPI_Comm comm);

}  // namespace floe
