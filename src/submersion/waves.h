/// \file
/// Linear (Airy) waves: a moving surface of the water (model.md, "Water").
#pragma once

#include <vector>

#include "floe/water/wave_options.h"
#include "lattice/partition.h"
#include "submersion/surface.h"

namespace floe {

/// One wave: eta = amplitude cos(kx x + ky y - omega t + phase).
struct WaveComponent {
  double amplitude = 0;         ///< [m]
  double kx = 0, ky = 0;        ///< wave vector [1/m]
  double number = 0;            ///< its size k [1/m]
  double omega = 0, phase = 0;  ///< [rad/s, rad]
};

/// Wave number of an angular frequency: omega^2 = g k tanh(k H) (Airy 1845; Dean & Dalrymple 1991,
/// eq. 3.34), to rounding. [1/m]
double wave_number(double omega, double gravity, double depth);

/// The waves that the options ask for. A JONSWAP sea is `components` waves of equal height at the
/// medians of equal shares of the spectrum's energy between half and three times the peak's
/// frequency; their phases are random.
std::vector<WaveComponent> wave_components(const WaveOptions& options, double gravity);

/// Waves as a surface of the water. Pressure and velocity decay with depth: a body feels level and
/// slope of each wave times the decay at its draft at rest, and the velocity of the water at half
/// of it.
class Waves {
 public:
  static constexpr bool moves = true;

  /// \param part     with shapes
  /// \param gravity  [m/s^2]
  /// \param water    its current is added to the velocity of the waves, its level to theirs
  /// \throws InputError if a wave is shorter than 8 bodies; collective
  Waves(const Part& part, double gravity, const WaveOptions& options, WaterMotion water);

  SurfacePlane plane(std::size_t b, const Vec3<double>& at, double time) const;
  Vec3<double> velocity(std::size_t b, const Vec3<double>& at, double time) const;
  /// How plane() and velocity() change: with the time [1/s of theirs], and slopes with the place.
  struct Change {
    double level, slope_x, slope_y;
    double xx, xy, yy;      ///< second derivatives of the surface [1/m]
    Vec3<double> velocity;  ///< [m/s^2]
  };
  Change change(std::size_t b, const Vec3<double>& at, double time) const;
  /// Returns the motion of the water without the waves.
  const WaterMotion& water() const { return water_; }
  /// Bound of SurfacePlane::steepness().
  double most_steepness() const { return most_steepness_; }

 private:
  struct Decay {
    double pressure, along, up;  ///< at the draft; of the horizontal and vertical velocity
  };
  std::size_t first(std::size_t b) const { return draft_of_[b] * waves_.size(); }
  double rise(double time) const { return ramp_ > 0 && time < ramp_ ? time / ramp_ : 1.0; }

  std::vector<WaveComponent> waves_;
  std::vector<std::size_t> draft_of_;  ///< per owned body: its draft
  std::vector<Decay> decay_;           ///< per draft, of each wave
  double ramp_;
  WaterMotion water_;
  double most_steepness_ = 1;
};

}  // namespace floe
