#include "active_contacts/active_contacts.h"

#include <algorithm>

namespace floe {

void ActiveContacts::start(std::size_t slots) {
  pairs_.clear();
  touching_ = 0;
  on_bodies_.resize(slots);
}

ContactBlock& ActiveContacts::add(std::span<const std::int32_t> pairs, std::int64_t counted) {
  touching_ += counted;
  const std::size_t block = pairs_.size() / lanes;
  pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
  if (block == blocks_.size()) blocks_.resize(2 * block + 16);
  return blocks_[block];
}

void ActiveContacts::begin_forces() {
  std::fill(on_bodies_.begin(), on_bodies_.end(), TermWrenches{});
  std::fill(on_parts_.begin(), on_parts_.end(), TermWrenches{});
}

}  // namespace floe
