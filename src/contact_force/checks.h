/// \file
/// Checks of contacts with messages for the user: bodies that overlap at the start, that move too
/// far in a step, or that lie inside another.
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "active_contacts/contacts.h"
#include "forces/force.h"

namespace floe {

/// Refuses enclosed pairs of the last evaluation. Collective.
/// \throws InputError if a body lies wholly inside another or inside an obstacle
void refuse_enclosed(const Contacts& contacts, MPI_Comm comm);

/// Checks the overlaps of the last evaluation: pairs that overlap at the start without having been
/// pressed together burst apart. Collective.
/// \returns a line on overlaps of more than 1e-3 of the smaller size, empty without any
/// \throws InputError for more than a tenth of the smaller size, unless overlaps at the start are
/// stress-free
std::string check_overlaps(const Contacts& contacts, MPI_Comm comm);

/// Limit of the step by the travel of bodies, since longer steps might jump over a contact: in one
/// step the fastest body of this rank and another as fast, or the fastest obstacle, approach each
/// other by a tenth of the least width of all bodies and obstacles.
LimitsStep<Spatial>::Limit travel_limit(const Solids& solids, const Part& part,
                                        const State<Spatial>& state);

/// Remarks on the first event of each kind: a pair enclosed, a pair pressed through.
class ContactRemarks {
 public:
  /// New remarks since the last call, on this rank.
  std::vector<Remark> take(const Contacts& contacts);
  /// Saves or loads what some rank has told. Collective.
  void persist(Archive& archive, MPI_Comm comm);

 private:
  bool told_enclosed_ = false, told_pressed_through_ = false;
};

}  // namespace floe
