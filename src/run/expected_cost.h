/// \file
/// Expected time and memory of a run of a sheet, before the run is made.
///
/// The formulas are fitted to runs of sheets of 3,000 to 30,000 bodies on the machine of
/// docs/bench. They are meant to be good to a factor of 3 (docs/decisions, "Planned time of static
/// and implicit runs") for lattices whose beams lie as those of a sheet; blocks of layers take
/// longer.
#pragma once

#include "floe/base/petsc.h"

namespace floe {

/// Cost of the Cholesky factorisation of a sheet's tangent by MUMPS.
struct FactorisationCost {
  double seconds;        ///< assembly included
  double solve_seconds;  ///< of one solve with the factor and one residual
  double bytes;          ///< of matrix and factor, over all ranks
};
/// \param unknowns  number of unknowns of the whole sheet
FactorisationCost factorisation_cost(double unknowns, int ranks);

/// Source of the estimate, as the plan of such a run states it.
inline constexpr const char* sheets_like_it = "what sheets of this size take, roughly";

/// Returns the memory of a run on `ranks` ranks, solvers not counted, since every rank builds the
/// whole lattice [B].
double lattice_bytes(double bodies, int ranks);

/// Whether a lattice has no more beams per body than a sheet.
inline bool is_like_a_sheet(double bodies, double beams) { return beams <= 3.5 * bodies; }

/// Returns the memory that the system would give to new processes, summed over the machines of the
/// ranks [B]: free memory within the limit of the process's cgroup. Infinite if it is not known.
/// Collective.
double free_memory(MPI_Comm comm);

}  // namespace floe
