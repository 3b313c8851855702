#include "contact_force/load_balance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/collectives.h"
#include "floe/base/item.h"

namespace floe {
namespace {

/// Part of the time of a contact that its overlap takes (profile of the pile of
/// input/ice_slope.yaml: 37 and 23 % of a step); the rest stays on the rank of the pair.
constexpr double part_of_overlap = 0.6;
/// Sharing fewer pairs is not worth a message.
constexpr double fewest = 64;
constexpr int numbers = sizeof(PairOverlap) / sizeof(double);
static_assert(sizeof(PairOverlap) == numbers * sizeof(double));

}  // namespace

std::vector<std::vector<std::int64_t>> shared_pairs(std::span<const std::int64_t> pairs) {
  const std::size_t n = pairs.size();
  std::vector<std::vector<std::int64_t>> shares(n, std::vector<std::int64_t>(n, 0));
  double mean = 0;
  for (const std::int64_t p : pairs) mean += static_cast<double>(p) / static_cast<double>(n);
  // A rank should compute as many overlaps as bring its work to the mean, together with the work
  // that stays with its own pairs.
  std::vector<double> spare(n);
  for (std::size_t r = 0; r < n; ++r) {
    const auto own = static_cast<double>(pairs[r]);
    const double wanted = (mean - (1 - part_of_overlap) * own) / part_of_overlap;
    spare[r] = std::max(wanted, 0.0) - own;
  }
  for (std::size_t giver = 0, taker = 0; giver < n && taker < n;) {
    const double count = std::floor(std::min(-spare[giver], spare[taker]));
    if (-spare[giver] < fewest) {
      ++giver;
    } else if (spare[taker] < fewest) {
      ++taker;
    } else {
      shares[giver][taker] = static_cast<std::int64_t>(count);
      spare[giver] += count;
      spare[taker] -= count;
    }
  }
  return shares;
}

ContactLoadBalance::ContactLoadBalance(MPI_Comm comm) : comm_(comm) {}

void ContactLoadBalance::plan(Contacts& contacts) {
  if (size(comm_) == 1) return;
  const auto shares = shared_pairs(
      all_gathered(std::vector{static_cast<std::int64_t>(contacts.offloadable())}, comm_));
  std::vector<std::int64_t> given;  // number of pairs that each rank offloads
  given.reserve(shares.size());
  for (const auto& row : shares)
    given.push_back(std::accumulate(row.begin(), row.end(), std::int64_t{0}));
  shared_ = std::any_of(given.begin(), given.end(), [](std::int64_t count) { return count > 0; });
  if (!shared_) return;

  offloaded_ = static_cast<std::size_t>(item(given, rank(comm_)));
  std::vector<std::int32_t> mine;
  for (const BodyPair& pair : contacts.offload(offloaded_))
    mine.insert(mine.end(), pair.begin(), pair.end());
  const std::vector<std::int32_t> all = all_gathered(mine, comm_);
  std::vector<BodyPair> offloaded;
  for (std::size_t k = 0; k + 1 < all.size(); k += 2) offloaded.push_back({all[k], all[k + 1]});
  assign(shares, offloaded, contacts);
}

/// Takes on the pairs that are assigned to this rank. The pairs of a giver go to its takers in the
/// order of the takers. Collective.
/// \param offloaded  by all ranks, giver by giver
void ContactLoadBalance::assign(const std::vector<std::vector<std::int64_t>>& shares,
                                std::span<const BodyPair> offloaded, Contacts& contacts) {
  const auto me = static_cast<std::size_t>(rank(comm_));
  std::vector<BodyPair> taken_on;
  std::vector<std::int32_t> takers, places;
  std::vector<std::int32_t> taken(shares.size(), 0);
  auto next = offloaded.begin();
  for (std::size_t giver = 0; giver < shares.size(); ++giver) {
    for (std::size_t taker = 0; taker < shares.size(); ++taker) {
      for (std::int64_t k = 0; k < shares[giver][taker]; ++k, ++next) {
        if (taker == me) taken_on.push_back(*next);
        if (giver == me) {
          takers.push_back(static_cast<std::int32_t>(taker));
          places.push_back(taken[taker]);
        }
        ++taken[taker];
      }
    }
  }
  taken_on_ = taken_on.size();
  contacts.take_on(taken_on);
  buffer_.assign(taken_on_ + offloaded_, {});
  ghosts_ = Ghosts(comm_, static_cast<std::int32_t>(taken_on_), takers, places);
}

void ContactLoadBalance::evaluate(Contacts& contacts, std::span<ContactWrench> wrenches) {
  if (!shared_) {
    contacts.evaluate(wrenches);
    return;
  }
  contacts.overlaps_taken_on(overlaps(0, taken_on_));
  const std::span<double> records(buffer_.empty() ? nullptr : &buffer_[0].overlap.volume,
                                  numbers * buffer_.size());
  ghosts_.begin(records, numbers);
  bool arrived = false;
  const auto arrive = [&] {
    if (!arrived) ghosts_.end(records, numbers);
    arrived = true;
    return std::span<const PairOverlap>(overlaps(taken_on_, offloaded_));
  };
  contacts.evaluate(wrenches, arrive);
  (void)arrive();
}

}  // namespace floe
