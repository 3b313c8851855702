/// \file
/// Waves of the water, as a scene states them.
#pragma once

#include <cstdint>
#include <limits>

namespace floe {

/// Options of waves (model.md, "Water").
struct WaveOptions {
  enum class Spectrum { regular, jonswap };
  Spectrum spectrum = Spectrum::regular;
  double height = 0;    ///< crest to trough, or H_s [m]; 0: no waves
  double period = 0;    ///< T, or T_p of the peak [s]
  double gamma = 3.3;   ///< peak enhancement of JONSWAP
  int components = 50;  ///< number of waves that make a JONSWAP sea
  std::uint64_t seed = 1;
  double direction = 0;  ///< in which they travel, from x to y [rad]
  double phase = 0;      ///< of a regular wave at the origin at time 0 [rad]
  double depth = std::numeric_limits<double>::infinity();  ///< of the water [m]
  double ramp = 0;  ///< their heights rise over this time [s]
  bool any() const { return height > 0; }
};

}  // namespace floe
