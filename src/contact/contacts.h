/// \file
/// All contacts of a model: poses, velocities and shapes in, wrenches out, once per step.
///
/// A pair of bodies is A, with the smaller global index, and B; obstacle k as B has the index
/// -1 - k. Pairs are sorted, and each is computed by the same instructions wherever it is: what a
/// body gets does not depend on how bodies are spread over ranks.
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

/// A body in the world: centroid and principal axes.
struct Pose {
  Vec3<double> x;
  Quat<double> q;
};
struct MovingPose {
  Pose pose;
  Vec3<double> velocity, spin;
};
/// About the body's centroid.
struct ContactWrench {
  Vec3<double> force{}, moment{};
};

class Contacts {
 public:
  /// \param shapes  of all bodies, in their principal axes   \param masses  of all bodies [kg]
  /// \param joined  pairs with an unbroken beam, sorted, the smaller index first
  Contacts(const Shapes& shapes, std::span<const double> masses,
           std::vector<std::array<std::int32_t, 2>> joined, const ContactOptions& options,
           std::vector<Obstacle> obstacles);

  /// How far a vertex may move between two builds [m]: half the reach of the list of pairs.
  double slack() const { return 0.5 * reach_; }
  /// Distance of body's farthest vertex from its centroid [m].
  double radius(std::int32_t body) const { return solids_[static_cast<std::size_t>(body)].radius; }
  /// Whether pairs may have become eligible since the last build.
  bool changed() const { return changed_; }

  /// Lists the pairs that may touch before some vertex has moved by slack(). History goes with its
  /// pair. \param poses  of all bodies   \param here  bodies whose wrenches are wanted
  void build(std::span<const Pose> poses, std::span<const std::uint8_t> here, double time);
  /// Bodies that are in a listed pair, sorted: evaluate() wants these, in this order.
  std::span<const std::int32_t> involved() const { return involved_; }

  /// The overlap of a pair, in world axes from A's centroid; volume 0: there is none.
  struct PairOverlap {
    Overlap overlap;
    double depth = 0;  ///< of its centroid below the first face of B [m]
  };
  /// Listed pairs that remember something: their overlaps are most of an evaluation.
  std::size_t with_history() const { return histories_.size(); }
  /// The last `count` of them: until the next build their overlaps come from another rank.
  std::vector<std::array<std::int32_t, 2>> offload(std::size_t count);
  /// Pairs whose overlaps another rank wants until the next build: their bodies are involved.
  void take_on(std::span<const std::array<std::int32_t, 2>> pairs);

  /// Before an evaluation. \param bodies  the involved ones
  void place(std::span<const MovingPose> bodies, double time);
  /// Meetings of the taken_on pairs, in their order.
  void overlaps_taken_on(std::span<PairOverlap> overlaps);
  /// Adds the contacts' wrenches on involved bodies, as placed; changes no history.
  /// \param offloaded  called when the overlaps of the offloaded pairs are needed, if there are any
  void evaluate(std::span<ContactWrench> wrenches,
                const std::function<std::span<const PairOverlap>()>& offloaded = {});
  /// Takes over what the last evaluation found. \param bodies  after the step: velocities half a
  /// step on   \param dt  the step [s]
  void commit(std::span<const MovingPose> bodies, double dt);

  /// The beam between two bodies is broken: they may touch from now on, without an energy.
  void release(std::array<std::int32_t, 2> pair);

  const ContactOptions& options() const { return options_; }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  /// Distance of obstacle k's farthest vertex from the origin of its frame [m].
  double obstacle_radius(std::size_t k) const { return obstacle_radius_[k]; }
  /// Force and moment about its frame's origin on obstacle k, in the last evaluation, of bodies
  /// that are here.
  const ContactWrench& on_obstacle(std::size_t k) const { return on_obstacle_[k]; }
  /// Contacts counted here with a force, in the last evaluation.
  std::int64_t touching() const { return touching_; }
  std::size_t listed() const { return pairs_.size(); }
  bool obstacle_listed() const;
  /// Counted pairs of the last evaluation, A and B, of which one lies wholly inside the other:
  /// they press on each other nowhere.
  std::vector<std::array<std::int32_t, 2>> enclosed() const;

  /// How far the bodies of a pair lie in each other.
  struct Penetration {
    std::int32_t a = 0, b = 0;
    double depth = 0;  ///< common part of both extents along the contact's normal [m]
    double share =
        0;  ///< of the smaller size: a body's cube root of its volume, an obstacle's width
  };
  /// Of the counted pairs of the last evaluation that press on each other, by pair.
  std::vector<Penetration> penetrations() const;

  /// What no contact should meet, at its first time.
  struct Event {
    bool happened = false;
    double time = 0;  ///< [s]
    std::int32_t a = 0, b = 0;
  };
  /// The first committed counted pair of which one lies wholly inside the other; and whose elastic
  /// term gave way by more than a quarter of the thinner one's width: beyond the middle of a plate,
  /// an overlap presses towards its other side.
  const Event& first_enclosed() const { return enclosed_; }
  const Event& first_pressed_through() const { return pressed_through_; }

  /// The least width of body or obstacle (-1 - k), between planes along its faces [m]; infinite
  /// for a half-space.
  double width_of(std::int32_t body) const;
  /// The least width of all bodies and obstacles [m].
  double thinnest() const { return thinnest_; }
  /// Pieces joined by beams, as of the last build, or at first.
  std::int32_t pieces() const { return pieces_; }
  ContactEnergies energies() const;

  /// Bounds of M^-1 K and M^-1 C of any contacts that may come (docs/model.md, "Contact", has the
  /// estimate).
  struct Rates {
    double stiffness = 0;  ///< [1/s^2]
    double damping = 0;    ///< [1/s]
  };
  Rates rates() const;

  /// What goes to a checkpoint: rows of `width` numbers per pair with history that is counted here.
  static constexpr std::size_t width = 7;
  std::vector<double> history() const;
  /// Rows of all pairs, sorted; the next build takes them over. \param changed  whether
  /// pairs had become eligible since the last build.
  void restore(std::span<const double> rows, bool changed);
  /// Work and energies that go on over a restart.
  ContactBooks& books() { return books_; }
  std::vector<std::array<std::int32_t, 2>> released() const { return released_; }

 private:
  /// What a step asks of a body that does not change, side by side.
  struct Solid {
    std::int32_t first_vertex, vertices;
    std::int32_t first_plane, planes;
    double size;    ///< cube root of the volume [m]
    double mass;    ///< [kg]
    double radius;  ///< of the farthest vertex [m]
    double width;   ///< the least, between planes along its faces [m]
  };
  struct Pair {
    std::int32_t a, b;            ///< bodies; b < 0: obstacle -1 - b
    std::int32_t slot_a, slot_b;  ///< among the involved
    bool counted, newly_eligible, offloaded;
    Vec3<double> axis;  ///< along which they were apart last, from B to A
    double safe = 0;    ///< as long as their travels add up to less, there is still a gap [m]
  };
  /// A contact of the last evaluation.
  struct ActiveContact {
    std::int32_t pair;
    Vec3<double> centre;  ///< from A's centroid
    ContactForce contact;
    bool deep;  ///< its elastic term gives way by more than a quarter of the thinner one's width
  };
  struct PairWithHistory {
    std::int32_t a, b;
    std::int32_t pair;  ///< -1: from a checkpoint
    PairHistory memory;
  };
  struct Placed {
    Vec3<double> x;
    Triad<double> axes;
    Vec3<double> velocity{}, spin{};
    double travelled = 0;  ///< no point of it has gone farther since the last build [m]
  };
  /// Over the contacts that are counted here: what they store [J], and their power [W]: elastic,
  /// viscous, friction, of moving obstacles.
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
  /// \param position, motion  the times of its place and of its velocities [s]
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
  std::vector<std::uint8_t> outer_;  ///< per body: whether it is on the surface of its piece
  std::int32_t pieces_ = 0;
  ContactOptions options_;
  std::vector<Obstacle> obstacles_;
  double reach_ = 0;
  bool changed_ = true, first_ = true;
  bool at_rest_;  ///< until the first commit: what overlaps is stress-free
  Event enclosed_, pressed_through_;
  double thinnest_ = std::numeric_limits<double>::infinity();
  std::vector<double> obstacle_width_;
  bool some_newly_eligible_ = false;  ///< some pair is

  std::vector<Pair> pairs_, taken_on_;
  std::vector<std::int32_t> involved_;
  std::vector<PairWithHistory> histories_,
      next_histories_;  ///< of pairs that touch, sorted as the pairs
  std::vector<ActiveContact> active_;
  std::vector<Placed> placed_;           ///< per slot, of the last evaluation
  std::vector<Placed> obstacles_at_;     ///< in the last evaluation
  std::vector<double> obstacle_radius_;  ///< of the farthest vertex from the frame's origin [m]
  double time_ = 0;                      ///< of the last evaluation
  bool placed_before_ = false;           ///< since the last build
  std::vector<ContactWrench> on_obstacle_;
  Clipper clipper_;
  std::vector<Vec3<double>> work_a_, work_b_;  ///< placed vertices
  std::int64_t touching_ = 0;
  Totals totals_;  ///< of the last evaluation

  ContactBooks books_;
};

}  // namespace floe
