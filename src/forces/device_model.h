/// \file
/// What forces tell a back end that computes their steps by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "floe/geometry/polyhedron.h"
#include "forces/device_contacts.h"

namespace floe {

/// Findings about submerged parts that steps keep: Submersion, with a pace.
class KeptParts {
 public:
  /// Numbers of each body after each other, and steps since all were found.
  virtual void read(std::vector<double>& numbers, std::int64_t& steps) const = 0;
  virtual void write(std::span<const double> numbers, std::int64_t steps) = 0;

 protected:
  ~KeptParts() = default;
};
/// Still water on the bodies.
struct DeviceWater {
  double weight_density = 0;  ///< rho g [N/m^3]; 0: no buoyancy
  std::optional<std::size_t> buoyancy_work, drag_work;
  double linear = 0, coefficient = 0;          ///< of drag: c [N s/m^3], rho C_d/2 [N s^2/m^4]
  std::function<double(double time)> level;    ///< [m]
  std::function<Point3(double time)> current;  ///< empty: no drag [m/s]
  int pace = 1;
  bool by_points = false;  ///< Wet
  KeptParts* kept = nullptr;
  // Per body:
  std::vector<std::array<double, 14>> prisms;  ///< numbers of Prism
  std::vector<double> extents;                 ///< [m]
  std::vector<double> most2;  ///< half the square of the largest move at a pace [m^2]
  std::vector<std::array<double, 4>> wholes;  ///< volume [m^3] and centroid [m]
  std::vector<double> area_per_volume;        ///< plan area over volume [1/m]; of drag
  const Shapes* shapes = nullptr;
};

/// Histories of beams that break.
class KeptCracks {
 public:
  /// Numbers of each beam's crack after each other, kappa 0 where there is none, as
  /// device::Damage; and the forces of dashpots at the start of the last step, six per beam, or
  /// none.
  virtual void read(std::vector<double>& cracks, std::vector<float>& viscous) const = 0;
  /// \param cracks  empty: as they were
  /// \param dt      length of the last step [s]
  virtual void write(std::span<const double> cracks, std::span<const float> viscous, double dt) = 0;

 protected:
  ~KeptCracks() = default;
};
/// Beams that break, in the order of DeviceModel::beams.
struct DeviceBreaking {
  /// Of a beam: five strengths, area [m^2], G_f and G_s [J/m^2], the middle between its ends at
  /// rest (3) [m], three further strengths of the general criterion (fracture_laws/law.h).
  std::vector<std::array<double, 14>> beams;
  std::vector<double> limits;  ///< twice the energy below which the strength does not matter [J]
  bool general = false;        ///< by the general criterion
  bool crushes = false;        ///< beams have a compressive strength
  KeptCracks* kept = nullptr;
};

/// The numbers of forces, for a back end that keeps the state in memory of its own and steps it
/// there (src/device). Bodies are those of a part that is the whole lattice.
struct DeviceModel {
  struct Beam {
    std::array<std::int32_t, 2> bodies;
    std::array<double, 9> triad;       ///< axes 1, 2, 3 at rest, world axes
    std::array<double, 6> offsets;     ///< of the ends from the centroids at rest [m]
    double length;                     ///< at rest [m]
    std::array<double, 6> stiffness;   ///< kn ksz ksy [N/m], kt kby kbz [N m]
    std::array<double, 6> dashpots{};  ///< on the six strains [N s/m, N m s]
  };
  /// A dead wrench that is the same for some bodies, at an arm that turns with each of them.
  struct Load {
    std::size_t work;  ///< index of its work among those of all forces
    std::vector<std::int32_t> bodies;
    Point3 arm;  ///< from the centroid to the force, at rest [m]
    /// Force and moment on each body at a time [N, N m].
    std::function<std::array<double, 6>(double time)> wrench;
  };

  std::vector<Beam> beams;      ///< in the order in which bodies sum them
  std::size_t beam_work = 0;    ///< index of the dashpots' work among those of all forces
  bool damped = false;          ///< beams have dashpots
  std::vector<double> weights;  ///< per body: along -z [N]; empty: none
  std::vector<Load> loads;
  /// Springs and dashpots on a body (support_law.h).
  struct Support {
    std::int32_t body;
    Point3 arm;  ///< from the centroid to their point, at rest [m]
    std::array<double, 36> stiffness, damping;
  };
  std::vector<Support> supports;
  std::size_t support_work = 0;  ///< index of their dashpots' work among those of all forces
  std::optional<DeviceWater> water;
  std::optional<DeviceBreaking> breaking;
  std::optional<DeviceContacts> contacts;
  /// What a force has that back ends do not have yet, as messages name it; empty: nothing.
  std::string missing;

  /// Index of the first work of the force that is asked.
  std::size_t next_work = 0;
};

}  // namespace floe
