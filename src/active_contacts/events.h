/// \file
/// First occurrences of what contacts should not do.
#pragma once

#include <cstdint>

#include "contact/pair.h"

namespace floe {

/// The first occurrence of an event.
struct ContactEvent {
  bool happened = false;
  double time = 0;            ///< [s]
  std::int32_t a = 0, b = 0;  ///< indices of the pair
};

/// Events among the committed counted pairs.
class ContactEvents {
 public:
  /// Notes the events of a contact.
  /// \param enclosed  whether one body lies inside the other
  /// \param deep      is_deep()
  /// \param time      of the evaluation [s]
  void note(bool enclosed, bool deep, const Pair& pair, double time) {
    ContactEvent& first = enclosed ? enclosed_ : pressed_through_;
    if (first.happened || !(enclosed || deep)) return;
    first = {.happened = true, .time = time, .a = pair.a, .b = pair.b};
  }

  /// Returns the first pair of which one lies wholly inside the other.
  const ContactEvent& first_enclosed() const { return enclosed_; }
  /// Returns the first pair whose elastic depth (V - V_p)/|S| exceeds a quarter of the least width
  /// of the thinner one: beyond the middle of a plate an overlap presses towards the other side of
  /// the plate.
  const ContactEvent& first_pressed_through() const { return pressed_through_; }

 private:
  ContactEvent enclosed_, pressed_through_;
};

}  // namespace floe
