/// \file
/// All contacts of a model: computes wrenches from shapes, poses and velocities, once per step
/// (model.md, "Contact").
///
/// A pair consists of body A, with the smaller global index, and of body or obstacle B; obstacle k
/// has the index -1 - k. Pairs are sorted, and every rank computes a pair by the same instructions.
/// So the wrench of a body does not depend on how bodies are distributed over ranks.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "contact/energies.h"
#include "contact/law.h"
#include "floe/contact/obstacle.h"

namespace floe {

/// Place of a body in the world.
struct Pose {
  Vec3<double> x;  ///< centroid [m]
  Quat<double> q;  ///< principal axes to world
};
/// Place and motion of a body.
struct MovingPose {
  Pose pose;
  Vec3<double> velocity, spin;  ///< [m/s, rad/s], world axes
};
/// Wrench of contacts on a body, about its centroid [N, N m].
struct ContactWrench {
  Vec3<double> force{}, moment{};
};

/// The contacts of the bodies of one rank. No function is collective: exchange between ranks is
/// left to the caller.
class Contacts {
 public:
  /// \param shapes     of all bodies, in their principal axes
  /// \param masses     of all bodies [kg]
  /// \param joined     pairs with an unbroken beam, sorted, the smaller index first
  /// \param options    law and constants
  /// \param obstacles  may be empty
  Contacts(const Shapes& shapes, std::span<const double> masses,
           std::vector<std::array<std::int32_t, 2>> joined, const ContactOptions& options,
           std::vector<Obstacle> obstacles);

  /// Distance that a vertex may travel between two builds [m]: half the reach of the pair list.
  double slack() const { return 0.5 * reach_; }
  /// Distance of the farthest vertex of a body from its centroid [m].
  double radius(std::int32_t body) const { return solids_[static_cast<std::size_t>(body)].radius; }
  /// Whether pairs may have become eligible since the last build.
  bool changed() const { return changed_; }

  /// Lists the pairs that may touch before some vertex has moved by slack(). Pairs that stay in the
  /// list keep their history.
  /// \param poses  of all bodies
  /// \param here   per body: 1 if this rank needs its wrench
  /// \param time   of the poses [s]
  void build(std::span<const Pose> poses, std::span<const std::uint8_t> here, double time);
  /// Bodies in the listed pairs and in those taken on, sorted. Their places in this list are the
  /// slots.
  std::span<const std::int32_t> involved() const { return involved_; }

  /// The overlap of a pair, in world axes from the centroid of A; no overlap: volume 0.
  struct PairOverlap {
    Overlap overlap;
    double depth = 0;  ///< of the centroid of the overlap below the first face of B [m]
  };
  /// Number of listed pairs with history. Their overlaps are most of the work of an evaluation.
  std::size_t with_history() const { return histories_.size(); }
  /// Marks the last `count` pairs with history as offloaded: until the next build another rank
  /// computes their overlaps.
  /// \returns these pairs, in list order
  std::vector<std::array<std::int32_t, 2>> offload(std::size_t count);
  /// Takes on pairs of other ranks: until the next build this rank computes their overlaps, and
  /// their bodies are involved.
  void take_on(std::span<const std::array<std::int32_t, 2>> pairs);

  /// Sets the places and motions of bodies and obstacles for an evaluation.
  /// \param bodies  the involved ones, by slot
  /// \param time    of their poses [s]
  void place(std::span<const MovingPose> bodies, double time);
  /// Computes the overlaps of the pairs taken on.
  /// \param overlaps  filled, in the order of take_on()
  void overlaps_taken_on(std::span<PairOverlap> overlaps);
  /// Adds the wrenches of the contacts at the places set by place(); changes no history.
  /// \param wrenches   on the involved bodies, by slot
  /// \param offloaded  returns the overlaps of the offloaded pairs, in their order; called when the
  ///                   first of these overlaps is needed
  void evaluate(std::span<ContactWrench> wrenches,
                const std::function<std::span<const PairOverlap>()>& offloaded = {});
  /// Makes the findings of the last evaluation history: friction, crushing, energies.
  /// \param bodies  the involved ones after the step, by slot; velocities are half a step after the
  ///                evaluation
  /// \param dt      length of the step [s]
  void commit(std::span<const MovingPose> bodies, double dt);

  /// Makes a pair whose beam broke eligible from the next build on; its overlap at that time counts
  /// as stress-free.
  void release(std::array<std::int32_t, 2> pair);

  const ContactOptions& options() const { return options_; }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  /// Distance of the farthest vertex of obstacle k from the origin of its frame [m].
  double obstacle_radius(std::size_t k) const { return obstacle_radius_[k]; }
  /// Force [N] and moment about the origin of its frame [N m] of this rank's bodies on obstacle k,
  /// in the last evaluation.
  const ContactWrench& on_obstacle(std::size_t k) const { return on_obstacle_[k]; }
  /// Number of overlapping counted pairs in the last evaluation.
  std::int64_t touching() const { return touching_; }
  /// Number of listed pairs.
  std::size_t listed() const { return pairs_.size(); }
  /// Whether a listed pair has an obstacle.
  bool obstacle_listed() const;
  /// Counted pairs (A, B) of the last evaluation of which one lies wholly inside the other, without
  /// a force.
  std::vector<std::array<std::int32_t, 2>> enclosed() const;

  /// Depth of the overlap of a pair.
  struct Penetration {
    std::int32_t a = 0, b = 0;
    double depth = 0;  ///< common part of both extents along the normal of the contact [m]
    double share =
        0;  ///< depth over the smaller size: cube root of a body's volume, width of an obstacle
  };
  /// Penetrations of the counted pairs of the last evaluation that have a normal, in list order.
  std::vector<Penetration> penetrations() const;

  /// First occurrence of something that contacts should not do.
  struct Event {
    bool happened = false;
    double time = 0;  ///< [s]
    std::int32_t a = 0, b = 0;
  };
  /// First committed counted pair of which one lies wholly inside the other.
  const Event& first_enclosed() const { return enclosed_; }
  /// First committed counted pair whose elastic depth (V - V_p)/|S| exceeds a quarter of the least
  /// width of the thinner one: beyond the middle of a plate an overlap presses towards the other
  /// side of the plate.
  const Event& first_pressed_through() const { return pressed_through_; }

  /// Least width of a body or of obstacle -1 - k, between planes along its faces [m]; infinite for
  /// a half-space.
  double width_of(std::int32_t body) const;
  /// Least width of all bodies and obstacles [m].
  double thinnest() const { return thinnest_; }
  /// Number of pieces joined by beams, as of the last build; before it, of construction.
  std::int32_t pieces() const { return pieces_; }
  /// Energies of the counted pairs at the last evaluation.
  ContactEnergies energies() const;

  /// Bounds of M^-1 K and M^-1 C for all contacts that may form (estimate: model.md, "Contact").
  struct Rates {
    double stiffness = 0;  ///< [1/s^2]
    double damping = 0;    ///< [1/s]
  };
  Rates rates() const;

  /// Numbers per pair in a checkpoint: A, B, V_p, k_t and the three components of F_t.
  static constexpr std::size_t width = 7;
  /// Rows of `width` numbers for the counted pairs with history.
  std::vector<double> history() const;
  /// Empties the pair list and sets the histories that the next build takes over.
  /// \param rows     of the pairs of all ranks, sorted by pair
  /// \param changed  whether pairs had become eligible since the last build
  void restore(std::span<const double> rows, bool changed);
  /// Work and energies over the whole run, which a checkpoint keeps.
  ContactBooks& books() { return books_; }
  /// Pairs whose beam broke, in the order of release().
  std::vector<std::array<std::int32_t, 2>> released() const { return released_; }

 private:
  /// Constants of a body that an evaluation needs, side by side in memory.
  struct Solid {
    std::int32_t first_vertex, vertices;
    std::int32_t first_plane, planes;
    double size;    ///< cube root of the volume [m]
    double mass;    ///< [kg]
    double radius;  ///< distance of the farthest vertex from the centroid [m]
    double width;   ///< least width, between planes along its faces [m]
  };
  /// A listed pair. Of a pair whose bodies are on two ranks only the rank of A counts energies.
  struct Pair {
    std::int32_t a, b;            ///< bodies; b < 0: obstacle -1 - b
    std::int32_t slot_a, slot_b;  ///< slots of the bodies; -1 for an obstacle
    bool counted, newly_eligible, offloaded;
    Vec3<double> axis;  ///< of the last gap, from B to A
    double safe = 0;    ///< the pair has a gap while its travels add up to less than this [m]
  };
  /// A contact of the last evaluation.
  struct ActiveContact {
    std::int32_t pair;
    Vec3<double> centre;  ///< from the centroid of A
    ContactForce contact;
    bool deep;  ///< elastic depth above a quarter of the least width of the thinner one
  };
  struct PairWithHistory {
    std::int32_t a, b;
    std::int32_t pair;  ///< index in pairs_; -1: from a checkpoint
    PairHistory memory;
  };
  /// Place and motion of a body or obstacle in an evaluation.
  struct Placed {
    Vec3<double> x;
    Triad<double> axes;
    Vec3<double> velocity{}, spin{};
    double travelled = 0;  ///< bound of the travel of its points since the last build [m]
  };
  /// Stored energy [J] and power [W] of the counted contacts in an evaluation.
  struct Totals {
    StoredEnergy stored;
    ContactPower power;
  };

  void add_solid(std::int32_t body, double mass);
  void note_events(const ActiveContact& touch);
  bool on_surface(std::int32_t body) const { return outer_[static_cast<std::size_t>(body)] != 0; }
  bool may_touch(std::int32_t a, std::int32_t b) const;
  void find_pieces();
  void list_bodies(std::span<const Placed> placed, std::span<const std::uint8_t> here);
  void list_obstacles(std::span<const Placed> placed, std::span<const std::uint8_t> here,
                      double time);
  void list(std::int32_t a, std::int32_t b, const Placed& at_a, const Placed& at_b, bool counted);
  void take_histories();
  std::span<const Vec3<double>> vertices(std::int32_t body) const;
  std::span<const HalfSpace> planes(std::int32_t body) const;
  /// Place and motion of an obstacle.
  /// \param obstacle  -1 - k
  /// \param position  time of its place [s]
  /// \param motion    time of its velocities [s]
  Placed at_time(std::int32_t obstacle, double position, double motion) const;
  PairConstants constants(std::int32_t a, std::int32_t b) const;
  double gap(Pair& pair, const Placed& a, const Placed& b, int tries);
  PairOverlap overlap_of(const Pair& pair, const Placed& a, const Placed& b);
  void touch(std::int32_t index, const Placed& b, const PairOverlap& overlap_of,
             const PairHistory* memory, std::span<ContactWrench> wrenches);
  const Placed& partner(const Pair& pair) const {
    return pair.b < 0 ? obstacles_at_[static_cast<std::size_t>(-1 - pair.b)]
                      : placed_[static_cast<std::size_t>(pair.slot_b)];
  }
  void find_involved();
  static double farthest_travel(const Placed& from, const Placed& to, double radius);
  static RelativeMotion relative(const Placed& a, const Placed& b, const Vec3<double>& centre);
  static void add_power(const ActiveContact& touch, const RelativeMotion& motion,
                        ContactPower& power);
  static double power_of_obstacle(const ActiveContact& touch, const Placed& a,
                                  const Placed& obstacle);

  Shapes shapes_;
  std::vector<Vec3<double>> vertices_;
  std::vector<HalfSpace> planes_;
  std::vector<Solid> solids_;
  std::vector<double> surface_, widest_;  ///< area of all faces, of the largest [m^2]
  std::vector<std::array<std::int32_t, 2>> joined_, released_;
  std::vector<std::int32_t> faces_, piece_;  ///< per body
  std::vector<std::uint8_t> outer_;          ///< per body: 1 on the surface of its piece
  std::int32_t pieces_ = 0;
  ContactOptions options_;
  std::vector<Obstacle> obstacles_;
  double reach_ = 0;
  bool changed_ = true, first_ = true;
  bool at_rest_;  ///< until the first commit, with initial_overlap: stress_free
  Event enclosed_, pressed_through_;
  double thinnest_ = std::numeric_limits<double>::infinity();
  std::vector<double> obstacle_width_;
  bool some_newly_eligible_ = false;  ///< some listed pair is newly eligible

  std::vector<Pair> pairs_, taken_on_;
  std::vector<std::int32_t> involved_;
  std::vector<PairWithHistory> histories_,
      next_histories_;  ///< of pairs that touched at the last commit, in list order
  std::vector<ActiveContact> active_;
  std::vector<Placed> placed_;           ///< per slot, in the last evaluation
  std::vector<Placed> obstacles_at_;     ///< per obstacle, in the last evaluation
  std::vector<double> obstacle_radius_;  ///< of the farthest vertex from the frame's origin [m]
  double time_ = 0;                      ///< of the last evaluation [s]
  bool placed_before_ = false;           ///< place() was called since the last build
  std::vector<ContactWrench> on_obstacle_;
  Clipper clipper_;
  std::vector<Vec3<double>> work_a_, work_b_;  ///< work space: placed vertices
  std::int64_t touching_ = 0;
  Totals totals_;  ///< in the last evaluation

  ContactBooks books_;
};

}  // namespace floe
