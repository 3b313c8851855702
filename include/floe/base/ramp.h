/// \file
/// The linear rise of motions and loads.
#pragma once

namespace floe {

/// A linear rise from 0 to 1 over `seconds`, constant at 1 afterwards (0 s: a jump at time 0).
struct Ramp {
  double seconds = 0;
  /// Along a path of statics: the rise goes on at all times, before 0 and after `seconds`, and a
  /// jump has always been.
  bool endless = false;

  /// Returns the factor at `time` [s].
  double value(double time) const {
    if (endless) return seconds > 0 ? time / seconds : 1;
    if (time >= seconds) return 1;
    return time > 0 ? time / seconds : 0;
  }
  /// Returns the integral of the factor from 0 to `time` [s].
  double integral(double time) const {
    if (endless) return seconds > 0 ? 0.5 * time * time / seconds : time;
    if (time <= 0) return 0;
    return time >= seconds ? time - 0.5 * seconds : 0.5 * time * time / seconds;
  }
  /// Returns the rate of the factor at `time` [1/s], from the right; 0 for a jump.
  double slope(double time) const { return time >= 0 && time < seconds ? 1.0 / seconds : 0.0; }
};

}  // namespace floe
