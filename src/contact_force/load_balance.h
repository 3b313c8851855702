/// \file
/// Load balance of contacts: ranks with few contacts compute overlaps for ranks with many.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <span>
#include <vector>

#include "active_contacts/contacts.h"
#include "base/ghosts.h"

namespace floe {

/// Numbers of pairs whose overlaps one rank computes for another: shares[giver][taker].
/// \param pairs  number of pairs with history of each rank
std::vector<std::vector<std::int64_t>> shared_pairs(std::span<const std::int64_t> pairs);

/// Distributes the overlaps of contacts over ranks. Forces do not depend on the rank that computes
/// an overlap: pairs stay on the ranks of their bodies, with their history and in their order, and
/// only overlaps are sent.
class ContactLoadBalance {
 public:
  explicit ContactLoadBalance(MPI_Comm comm);

  /// Distributes overlaps anew, after each build of the pair list. Collective.
  void plan(Contacts& contacts);
  /// Calls contacts.evaluate(), with the overlaps that other ranks have computed. Collective.
  /// \param wrenches  on the involved bodies, by slot
  void evaluate(Contacts& contacts, std::span<ContactWrench> wrenches);

 private:
  void assign(const std::vector<std::vector<std::int64_t>>& shares,
              std::span<const BodyPair> offloaded, Contacts& contacts);
  std::span<PairOverlap> overlaps(std::size_t first, std::size_t count) {
    return std::span(buffer_).subspan(first, count);
  }

  MPI_Comm comm_;
  bool shared_ = false;                       ///< some rank has offloaded pairs
  std::size_t taken_on_ = 0, offloaded_ = 0;  ///< numbers of pairs
  std::vector<PairOverlap> buffer_;           ///< of pairs taken on, then of offloaded pairs
  Ghosts ghosts_;
};

}  // namespace floe
