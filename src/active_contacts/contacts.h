/// \file
/// All contacts of a model: computes wrenches from shapes, poses and velocities, once per step
/// (model.md, "Contact").
///
/// The parts: Solids (what may touch), PairList with Eligibility and near_pairs() (the pairs that
/// may touch), Places and NarrowPhase (places, gaps and overlaps of an evaluation), a law of
/// contact_laws, ActiveContacts (forces and energies of an evaluation), ContactHistory (springs and
/// crushed volumes from step to step), Crushing and Wear (what bodies lose by crushing),
/// ContactEvents and penetrations() (checks).
///
/// Pairs are sorted, and every rank computes a pair by the same instructions. So the wrench of a
/// body does not depend on how bodies are distributed over ranks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "active_contacts/active_contacts.h"
#include "active_contacts/crushing.h"
#include "active_contacts/energies.h"
#include "active_contacts/events.h"
#include "active_contacts/history.h"
#include "active_contacts/penetrations.h"
#include "active_contacts/stiffness.h"
#include "contact/narrow_phase.h"
#include "contact/pair_list.h"
#include "contact/part_contacts.h"
#include "contact/places.h"
#include "contact/solids.h"
#include "contact/wear.h"
#include "contact_laws/laws.h"
#include "floe/geometry/contact_of_pair.h"

namespace floe {

/// Overlapping pairs of an evaluation whose contacts are not found yet, at most one per lane.
struct MetPairs {
  /// What a contact depends on beside its overlap, history and motion.
  template <class T>
  struct GivenOf {
    PairConstantsOf<T> constants;
    T thinner = 0;         ///< least width of the thinner one of A and B [m]
    T touched = 0;         ///< 1 where the pair touched when the last step began, else 0
    T newly_eligible = 0;  ///< 1 where the overlap is stress-free, else 0
  };

  std::size_t number = 0;
  std::int64_t counted = 0;
  std::array<std::int32_t, lanes> pairs;  ///< indices in the list
  std::array<GivenOf<double>, lanes> given;
  std::array<PairOverlap, lanes> overlaps;
  std::array<const PairHistory*, lanes> memories;
};

/// The contacts of the bodies of one rank. No function is collective: exchange between ranks is
/// left to the caller.
class Contacts {
 public:
  /// Returns the overlaps of the offloaded pairs, in their order.
  using OffloadedOverlaps = std::function<std::span<const PairOverlap>()>;

  /// \param shapes     of all bodies, in their principal axes
  /// \param masses     of all bodies [kg]
  /// \param joined     pairs with an unbroken beam, sorted, the smaller index first
  /// \param options    law and constants
  /// \param obstacles  may be empty
  /// \param inertia    principal moments of all bodies, where some carry obstacles [kg m^2]
  Contacts(const Shapes& shapes, std::span<const double> masses, std::vector<BodyPair> joined,
           const ContactOptions& options, std::vector<Obstacle> obstacles,
           std::span<const Point3> inertia = {});

  const Solids& solids() const { return solids_; }
  const PairList& list() const { return list_; }
  const ContactHistory& history() const { return history_; }
  const ContactOptions& options() const { return options_; }

  /// Gives obstacle k another motion. A new list is due.
  void drive(std::size_t k, const DrivenMotion& motion) { solids_.drive(k, motion); }
  void stop_driving(std::size_t k) { solids_.drive(k, {}); }

  /// Makes the pair list anew. Pairs that stay in the list keep their history.
  /// \param poses  of all bodies
  /// \param here   per body: 1 if this rank needs its wrench
  /// \param time   of the poses [s]
  void build(std::span<const Pose> poses, std::span<const std::uint8_t> here, double time);
  /// Returns the number of pairs with history whose overlaps another rank may compute.
  std::size_t offloadable() const;
  /// Offloads the last `count` of these: until the next build another rank computes their
  /// overlaps, which are most of the work of an evaluation.
  /// \returns these pairs, in list order
  std::vector<BodyPair> offload(std::size_t count);
  /// Takes on pairs of other ranks: until the next build this rank computes their overlaps, and
  /// their bodies are involved.
  void take_on(std::span<const BodyPair> pairs);

  /// Sets the places and motions of bodies and obstacles for an evaluation.
  /// \param bodies         the involved ones, by slot
  /// \param time           of their poses [s]
  /// \param velocity_time  of their velocities [s]
  void place(std::span<const MovingPose> bodies, double time, double velocity_time);
  /// Computes the overlaps of the pairs taken on.
  /// \param overlaps  filled, in the order of take_on()
  void overlaps_taken_on(std::span<PairOverlap> overlaps);
  /// Sets the wrenches of the contacts at the places set by place(), without dashpots; changes no
  /// history.
  /// \param wrenches   on the involved bodies, by slot; overwritten
  /// \param offloaded  called when the first overlap of an offloaded pair is needed
  void evaluate(std::span<ContactWrench> wrenches, const OffloadedOverlaps& offloaded = {});
  /// Whether there are dashpots, which damp() adds.
  bool damps() const { return options_.damping_ratio > 0; }
  /// Returns the acceleration of an involved body by a wrench, at the places set by place().
  Acceleration acceleration(std::int32_t slot, const ContactWrench& wrench) const;
  /// Sets the wrenches of the last evaluate() anew, now with dashpots, which act on the velocities
  /// to which accelerations take the bodies at t_n (model.md, "Contact").
  /// \param accelerations  of the involved bodies at t_n by all forces but dashpots, by slot
  /// \param wrenches       on the involved bodies, by slot; overwritten
  void damp(std::span<const Acceleration> accelerations, std::span<ContactWrench> wrenches);
  /// Makes the findings of the last evaluation history: friction, crushing.
  void commit();
  /// Whether bodies lose what contacts crush.
  bool wears() const { return options_.wear && options_.plastic_limit.given(); }
  /// Returns the cuts by the counted contacts that parted in the last commit.
  std::span<const WearCut> cuts() const { return cuts_; }
  /// Returns the cuts by contacts that parted in a step that was made elsewhere.
  std::vector<WearCut> cuts_of(std::span<const Crush> parted);
  /// Wears bodies off, on every rank by the cuts of all ranks, sorted by pair.
  void wear(std::span<const WearCut> cuts);
  const Wear& worn() const { return wear_; }
  const Crushing& crushing() const { return crushing_; }
  /// Makes a pair whose beam broke eligible from the next build on; its overlap at that time counts
  /// as stress-free.
  void release(const BodyPair& pair) { list_.release(pair); }

  /// Returns the force [N] and the moment about the origin of its frame [N m] on obstacle k in the
  /// last evaluation: of the bodies of this rank, or, if a body carries it, of all bodies where
  /// this rank needs that body's wrench and else nothing. Obstacles of one body share its wrench.
  ContactWrench on_obstacle(std::size_t k) const {
    const std::int32_t body = solids_.obstacles()[k].body;
    if (body < 0) return on_parts_of(k);
    return item(needed_, body) != 0 ? active_.on_body(list_.slot_of(body)).sum() : ContactWrench{};
  }
  /// Keeps the force of each contact, for on_obstacle_of().
  void keep_forces() { active_.keep_forces(); }
  /// Returns the number of contacts of the last evaluation, until it is committed.
  std::size_t contacts() const { return active_.size(); }
  /// A contact of an obstacle with a body, or with another obstacle in its place; all in the frame
  /// of the obstacle but the force.
  struct OnObstacle {
    std::int32_t obstacle = -1;               ///< number; -1: it is a contact between bodies
    bool counted = false;                     ///< this rank owns the body
    Vec3<double> force{};                     ///< on the obstacle, in world axes [N]
    Vec3<double> centre{}, normal{};          ///< of the contact; out of the obstacle
    Triad<double> axes{};                     ///< of the body
    Vec3<double> x{};                         ///< its centroid [m]
    double radius = 0;                        ///< [m]
    std::span<const HalfSpace> planes, worn;  ///< that bound it, in its own frame
  };
  /// \param on_a  whether the obstacle is that of A, of pairs of two obstacles; else that of B
  OnObstacle on_obstacle_of(std::size_t contact, bool on_a) const;
  /// Returns a contact of the last evaluation, where forces are kept.
  ContactOfPair contact_of(std::size_t contact) const;
  /// Whether this rank counts a contact.
  bool is_counted(std::size_t contact) const { return list_.pair(active_.pair(contact)).counted; }
  /// Returns the number of overlapping counted pairs in the last evaluation.
  std::int64_t touching() const { return active_.touching(); }
  /// Adds the power of the contacts of the last evaluation on an involved body that moves so.
  void add_power(std::int32_t slot, const Vec3<double>& velocity, const Vec3<double>& spin,
                 ContactPower& power) const {
    active_.on_body(slot).add_power(velocity, spin, power);
  }
  /// Adds the power of these contacts on obstacles, and of the obstacles, whose motions are those
  /// at a time [s].
  void add_power_on_obstacles(double velocity_time, ContactPower& power) const {
    for (std::size_t k = 0; k < solids_.parts(); ++k) {
      const Obstacle& obstacle = solids_.obstacle(part_index(k));
      if (obstacle.is_carried()) continue;
      active_.add_power_on_part(k, obstacle.motion.rate(velocity_time),
                                obstacle.motion.spin(velocity_time), power);
    }
  }
  /// Returns the energies of the counted pairs at the last evaluation.
  /// \param work  until then [J]
  ContactEnergies energies(const ContactPower& work) const {
    return contact_energies(work, stored(), start_);
  }
  /// Returns the counted pairs of the last evaluation of which one lies wholly inside the other,
  /// without a force.
  std::vector<BodyPair> enclosed() const;
  /// Returns the penetrations of the counted pairs of the last evaluation that have a normal, in
  /// list order.
  std::vector<Penetration> penetrations() const;
  const ContactEvents& events() const { return events_; }
  /// Returns bounds of M^-1 K and M^-1 C for all contacts that may form.
  ContactRates rates() const { return contact_rates(solids_, options_, law_); }

  /// Takes over the histories of steps that were made elsewhere; the next build assigns them.
  /// \param rows  of ContactHistory::width numbers, sorted by pair
  /// \param crushed  what pairs that touch have crushed, likewise
  void take_steps(std::span<const double> rows, std::vector<Crush> crushed) {
    history_.restore(rows);
    crushing_.set(std::move(crushed));
    list_.end_step();
    active_.clear();
  }
  /// Returns rows of ContactHistory::width numbers for the counted pairs with history.
  std::vector<double> history_rows() const { return history_.rows(list_.pairs()); }
  /// Empties the pair list and sets the histories that the next build takes over.
  /// \param rows      of the pairs of all ranks, sorted by pair
  /// \param released  pairs whose beam broke, in the order of release()
  /// \param known     number of these that the last build knew
  void restore(std::span<const double> rows, std::span<const BodyPair> released, std::size_t known);
  /// Sets what contacts have crushed and what bodies have lost.
  /// \param crushed  rows of Crushing, of the pairs of all ranks
  /// \param worn     rows of Wear
  /// \param here     per body: 1 if this rank owns it
  void restore_wear(std::span<const double> crushed, std::span<const double> worn,
                    std::span<const std::uint8_t> here);
  /// The energy stored at the start, which a checkpoint keeps.
  StoredAtStart& stored_at_start() { return start_; }

 private:
  template <IsContactLaw Law>
  void evaluate_pairs(const Law& law, const OffloadedOverlaps& offloaded);
  template <IsContactLaw Law>
  std::int32_t meet_parts(const Law& law, std::int32_t first, ContactHistory::Cursor& histories);
  void follow_parts();
  ContactWrench on_parts_of(std::size_t obstacle) const;
  template <IsContactLaw Law>
  void touch(const Law& law, std::int32_t index, const PairHistory* memory);
  template <IsContactLaw Law>
  void find_trials(const Law& law);
  RelativeMotionOf<Lanes> predicted_motion(const ContactBlock& active,
                                           std::span<const std::int32_t> pairs) const;
  StoredEnergy stored() const;
  void find_crushed();
  WearCut cut_of(const Crush& crush);

  Solids solids_;
  ContactOptions options_;
  ContactLaws law_;
  PairList list_;
  Places places_;
  NarrowPhase narrow_;
  MetPairs met_;
  PartContacts parts_;
  std::vector<std::int32_t> known_;               ///< work space of meet_parts()
  std::vector<const PairHistory*> known_memory_;  ///< the same
  std::deque<PairHistory> joined_memory_;         ///< of contacts that have become one
  /// Pairs with history whose contacts another pair stands for since the last evaluation, and this.
  std::vector<std::array<std::int32_t, 2>> followed_;
  ActiveContacts active_;
  double last_dt_ = 0;  ///< length of the last step [s]
  ContactHistory history_;
  Crushing crushing_;
  Wear wear_;
  CapFinder caps_;
  std::vector<WearCut> cuts_;         ///< of the last commit
  std::vector<std::uint8_t> needed_;  ///< per body, where some carry obstacles
  StoredAtStart start_;
  ContactEvents events_;
};

}  // namespace floe
