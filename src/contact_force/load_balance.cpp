#include "contact_force/load_balance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/collectives.h"

namespace floe {
namespace {

/// Part of the time of a contact that its overlap takes (measured by bench/contact_bench); the rest
/// stays on the rank of the pair.
constexpr double part_of_overlap = 0.7;
/// Sharing fewer pairs is not worth a message.
constexpr double fewest = 64;
constexpr int numbers = sizeof(Contacts::PairOverlap) / sizeof(double);
static_assert(sizeof(Contacts::PairOverlap) == numbers * sizeof(double));

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
  const auto me = static_cast<std::size_t>(rank(comm_));
  const auto shares = shared_pairs(
      all_gathered(std::vector{static_cast<std::int64_t>(contacts.with_history())}, comm_));
  std::int64_t mine = 0;
  shared_ = false;
  for (std::size_t r = 0; r < shares.size(); ++r) {
    for (const std::int64_t count : shares[r]) {
      shared_ = shared_ || count > 0;
      if (r == me) mine += count;
    }
  }
  if (!shared_) return;

  std::vector<std::int32_t> offloaded;
  for (const auto& pair : contacts.offload(static_cast<std::size_t>(mine)))
    offloaded.insert(offloaded.end(), pair.begin(), pair.end());
  offloaded_ = static_cast<std::size_t>(mine);
  // All ranks know all offloaded pairs, giver by giver. The pairs of a giver go to its takers in
  // the order of the takers.
  const std::vector<std::int32_t> all = all_gathered(offloaded, comm_);
  std::vector<std::array<std::int32_t, 2>> taken_on;
  std::vector<std::int32_t> takers, places;
  std::vector<std::int32_t> taken(shares.size(), 0);
  std::size_t at = 0;
  for (std::size_t giver = 0; giver < shares.size(); ++giver) {
    for (std::size_t taker = 0; taker < shares.size(); ++taker) {
      for (std::int64_t k = 0; k < shares[giver][taker]; ++k, ++at) {
        if (taker == me) taken_on.push_back({all[2 * at], all[2 * at + 1]});
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

std::span<Contacts::PairOverlap> ContactLoadBalance::overlaps(std::size_t first,
                                                              std::size_t count) {
  return std::span(buffer_).subspan(first, count);
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
    return std::span<const Contacts::PairOverlap>(overlaps(taken_on_, offloaded_));
  };
  contacts.evaluate(wrenches, arrive);
  (void)arrive();
}

}  // namespace floe
