/// \file
/// What contacts tell a back end that computes their steps by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "floe/geometry/half_space.h"
#include "floe/geometry/periods.h"
#include "floe/lattice/state.h"
#include "geometry/edge_graph.h"

namespace floe {

/// The pairs of bodies, or of a body and an obstacle, that may touch.
struct DevicePairs {
  /// Numbers of a pair: k_v [Pa/m], A_r [m^2], mu, mu below water, 1 if B is a half-space, least
  /// width of the thinner one [m].
  static constexpr std::size_t constants = 6;
  /// Numbers of its history, as PairHistory::as_numbers().
  static constexpr std::size_t history = 7;
  /// Numbers of what it has crushed where bodies wear: V_p before and now [m^3], the normal when it
  /// last crushed in the frames of A and B.
  static constexpr std::size_t crush = 8;
  /// What a pair is at the end of the last step, in bits. One that has crushed ice and parted in
  /// this step wears a body off.
  enum State : std::uint8_t { touching = 1, stress_free = 2, crushed = 4, parted = 8 };

  std::vector<std::array<std::int32_t, 2>> bodies;  ///< A, B; -1 - k: obstacle k
  std::vector<std::array<double, constants>> numbers;
  std::vector<std::array<double, history>> histories;  ///< of pairs that touch
  std::vector<std::uint8_t> states;
  std::vector<std::array<double, crush>> crushes;  ///< of pairs that have crushed; empty: no wear

  // Who may touch (contact/eligibility.h), for lists that a back end makes by itself.
  std::vector<std::int32_t> pieces;                 ///< per body: number of its piece
  std::vector<std::uint8_t> on_surface;             ///< per body
  std::vector<std::uint8_t> left_out;               ///< per body: it touches nothing as ice
  std::vector<std::array<std::int32_t, 2>> broken;  ///< pairs of which a beam has broken
};

/// What a pair had crushed that has parted in the last step. Bodies as in DevicePairs.
struct PartedPair {
  std::array<std::int32_t, 2> bodies{};
  std::array<double, DevicePairs::crush> crush{};
};
/// A plane beyond which a body has nothing left, in the frame of the body.
struct WornPlane {
  std::int32_t body = 0;
  HalfSpace left;
};

/// Contacts as they are kept on the processor.
class KeptContacts {
 public:
  /// Makes the list of the pairs that may touch before a vertex has moved by the slack.
  virtual DevicePairs list(const State<Spatial>& state) = 0;
  /// Takes over what steps that were made elsewhere have left.
  /// \param pairs  of list(), with histories and states of now
  /// \param steps  number of these steps \param dt  their length [s]
  virtual void take(const DevicePairs& pairs, std::int64_t steps, double dt) = 0;
  /// Returns all planes of worn bodies, body by body.
  virtual std::vector<WornPlane> worn() const = 0;
  /// Wears bodies off by pairs that have parted; returns all planes of these bodies.
  virtual std::vector<WornPlane> wear(std::span<const PartedPair> pairs) = 0;
  /// Per obstacle: the largest force so far and the integral of the force [N, N s].
  virtual std::vector<std::array<double, 6>> obstacle_forces() const = 0;
  virtual void set_obstacle_forces(std::span<const std::array<double, 6>> forces) = 0;
  /// Whether the stable step allows for contacts; as long as it does not, whether an evaluation at
  /// every step is to tell that bodies are about to touch.
  virtual bool are_possible() const = 0;
  virtual bool watches() const = 0;

 protected:
  ~KeptContacts() = default;
};

/// Contacts of bodies with each other and with obstacles.
struct DeviceContacts {
  bool potential = false;    ///< the law: potential; else overlap
  double damping_ratio = 0;  ///< zeta
  bool with_patch = false;   ///< the law asks for integrals over the area
  bool wears = false;        ///< bodies lose what contacts crush
  /// sigma_p: pressure, area, exponent, least, most, fast, speed, as PlasticLimit.
  std::array<double, 7> plastic_limit{};
  Periods periods;
  double slack = 0;      ///< of the list [m]
  std::size_t work = 0;  ///< index of the first of its four works among those of all forces
  KeptContacts* kept = nullptr;

  // For lists that a back end makes by itself.
  double reach = 0;                                ///< largest gap of a listed pair [m]
  double young = 0, young_broken = 0;              ///< E_c [Pa], that where a beam has broken
  double friction = 0, friction_wet = 0;           ///< mu between bodies, that below still water
  std::vector<std::array<double, 2>> frictions;    ///< per obstacle, as above
  std::vector<std::array<std::int32_t, 2>> beams;  ///< pairs, those of broken ones too

  /// Shapes of the bodies, then of the obstacles, in their frames.
  struct Solid {
    std::vector<Vec3<double>> vertices;  ///< none: a half-space
    std::vector<HalfSpace> planes;
    std::int32_t graph = -1;  ///< among the graphs; obstacles have none
    double radius = 0;        ///< distance of the farthest vertex from the origin [m]
    double size = 0;          ///< L of a body [m]
    double width = 0;         ///< least width [m]
    /// 1/m, 1/I about the axes of the body, as contacts count them; zeros for an obstacle.
    std::array<double, 4> inverse{};
  };
  std::vector<Solid> solids;
  std::vector<EdgeGraph> graphs;
  std::size_t obstacles = 0;
  std::vector<std::int32_t> carriers;  ///< per obstacle: the body that carries it; -1: none

  /// Numbers of an obstacle in a step: origin and axes of its frame at its start; velocity and spin
  /// half of the step before earlier, at its start, and half of the step later.
  static constexpr std::size_t of_obstacle = 30;
  using ObstacleStep = std::array<double, of_obstacle>;
  /// \param before, dt  lengths of the step before and of the step [s]
  std::function<ObstacleStep(std::size_t obstacle, double time, double before, double dt)> obstacle;
  /// Returns the largest travel of a vertex of an obstacle between two times [m].
  std::function<double(double from, double to)> obstacle_travel;
};

}  // namespace floe
