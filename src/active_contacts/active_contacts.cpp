#include "active_contacts/active_contacts.h"

#include <algorithm>

namespace floe {

void ActiveContacts::start(std::size_t slots) {
  size_ = 0;
  touching_ = 0;
  on_bodies_.resize(slots);
}

void ActiveContacts::begin_forces() {
  std::fill(on_bodies_.begin(), on_bodies_.end(), TermWrenches{});
  std::fill(on_obstacles_.begin(), on_obstacles_.end(), TermWrenches{});
}

}  // namespace floe
