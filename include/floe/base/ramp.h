/// \file
/// The linear rise of motions and loads.
#pragma once

namespace floe {

/// Linear rise from 0 to 1 over `seconds`, 1 from then on (0 s: 1 at once).
struct Ramp {
  double seconds = 0;

  /// Factor at `time`.
  double value(double time) const {
    if (time >= seconds) return 1;
    return time > 0 ? time / seconds : 0;
  }
  /// Its integral from 0 to `time` [s].
  double integral(double time) const {
    if (time <= 0) return 0;
    return time >= seconds ? time - 0.5 * seconds : 0.5 * time * time / seconds;
  }
  /// Its rate [1/s], from the right; 0 if it rises at once.
  double slope(double time) const { return time >= 0 && time < seconds ? 1.0 / seconds : 0.0; }
};

}  // namespace floe
