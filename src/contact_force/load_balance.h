/// \file
/// Ranks with many contacts have part of their overlaps worked out by ranks with few.
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "base/ghosts.h"
#include "contact/contacts.h"

namespace floe {

/// How many pairs each rank works out for each other one: shares[giver][taker]. \param pairs  of
/// each rank
std::vector<std::vector<std::int64_t>> shared_pairs(std::span<const std::int64_t> pairs);

/// Forces do not depend on who works out an overlap: pairs stay where their bodies are, with their
/// history and in their order, and only overlaps travel.
class ContactLoadBalance {
 public:
  explicit ContactLoadBalance(MPI_Comm comm);

  /// After each build of the list: decides anew. Collective.
  void plan(Contacts& contacts);
  /// contacts.evaluate, with what is shared. Collective.
  void evaluate(Contacts& contacts, std::span<ContactWrench> wrenches);

 private:
  std::span<Contacts::PairOverlap> overlaps(std::size_t first, std::size_t count);

  MPI_Comm comm_;
  bool shared_ = false;  ///< on any rank
  std::size_t taken_on_ = 0, offloaded_ = 0;
  std::vector<Contacts::PairOverlap> buffer_;  ///< of taken_on pairs, then of offloaded ones
  Ghosts ghosts_;
};

}  // namespace floe
