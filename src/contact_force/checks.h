/// \file
/// What a user should hear of contacts: bodies that overlap at the start, that move too far in a
/// step, or that lie inside another.
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "contact/contacts.h"
#include "forces/force.h"

namespace floe {

/// Of the last evaluation. Collective. \throws InputError if a body lies wholly inside another or
/// an obstacle
void refuse_enclosed(const Contacts& contacts, MPI_Comm comm);

/// Pairs that overlap without having been pressed together burst apart. Collective.
/// \returns a line on overlaps of more than 1e-3 of the smaller size, empty without any
/// \throws InputError for more than a tenth, unless what overlaps is taken as rest
std::string check_overlaps(const Contacts& contacts, MPI_Comm comm);

/// The step in which the fastest body of this rank and another as fast, or the fastest obstacle,
/// come nearer by a tenth of the least width of all: longer steps might jump over a contact.
LimitsStep<Spatial>::Limit travel_limit(const Contacts& contacts, const Part& part,
                                        const State<Spatial>& state);

/// Tells each kind of event once.
class ContactRemarks {
 public:
  std::vector<Remark> take(const Contacts& contacts);

 private:
  bool told_enclosed_ = false, told_pressed_through_ = false;
};

}  // namespace floe
