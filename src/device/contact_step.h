/// \file
/// Contacts of a step on an engine (model.md, "Contact"): overlaps, what the law makes of them,
/// dashpots, and the sums for bodies and obstacles. The physics is that of src/contact_laws and
/// src/contact/pair_overlap.h; here are loops and memory only.
#pragma once

#include <cstdint>
#include <type_traits>

#include "contact/pair_overlap.h"
#include "contact_laws/overlap.h"
#include "contact_laws/potential.h"
#include "contact_laws/trial.h"
#include "device/engine.h"
#include "device/soa.h"
#include "device/warp_clipper.h"
#include "floe/geometry/periods.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// Numbers of a struct of doubles.
template <class Struct>
inline constexpr int numbers_in = static_cast<int>(sizeof(Struct) / sizeof(double));
template <class Struct>
FLOE_KERNEL void put_struct(const Soa& to, std::int64_t of, const Struct& what) {
  static_assert(std::is_trivially_copyable_v<Struct>);
  const auto* numbers = reinterpret_cast<const double*>(&what);
  for (int n = 0; n < numbers_in<Struct>; ++n) to.at(n, of) = numbers[n];
}
template <class Struct>
FLOE_KERNEL void get_struct(const Soa& from, std::int64_t of, Struct& what) {
  static_assert(std::is_trivially_copyable_v<Struct>);
  auto* numbers = reinterpret_cast<double*>(&what);
  for (int n = 0; n < numbers_in<Struct>; ++n) numbers[n] = from.at(n, of);
}

/// The overlap of a pair, and x_A - x_B.
struct MetPair {
  PairOverlap met;
  Vec3<double> apart;
};
/// A wrench on A, and on B with the other sign, about their centroids.
struct PairWrench {
  Vec3<double> force, on_a, on_b;
};
/// The terms of the wrench of a contact.
struct PairTerms {
  PairWrench elastic, viscous, friction;
};
/// Forces and moments of the terms on a body, and their powers.
struct TermSums {
  Vec3<double> force[3], moment[3];  // NOLINT: as kernels have them

  FLOE_KERNEL Vec3<double> all_forces() const { return (force[0] + force[1]) + force[2]; }
  FLOE_KERNEL Vec3<double> all_moments() const { return (moment[0] + moment[1]) + moment[2]; }
  FLOE_KERNEL double power(int term, const Vec3<double>& v, const Vec3<double>& w) const {
    return dot(force[term], v) + dot(moment[term], w);
  }
};
inline constexpr int of_history = PairHistory::numbers;

/// The contacts of a run.
struct ContactsOfRun {
  std::int32_t any;  ///< 0: the run has none
  std::int32_t potential, damps, with_patch, wears;
  SharedConstants constants;
  Periods periods;
  double slack;
  std::int64_t first_pair, pairs;  ///< of the list
  std::int64_t obstacles;          ///< where their first step begins in the table
  std::int32_t first_obstacle, obstacle_count;
  std::int64_t accelerations;  ///< likewise of prescribed motions
};

/// Memory of contacts. A solid is a body or, after all bodies, an obstacle.
struct ContactMemory {
  const ContactsOfRun* runs;  ///< null: no run has contacts
  std::int32_t bodies;
  // Per solid, and one more; their vertices and planes.
  const std::int32_t *first_vertex, *first_plane;
  const double* vertices;
  const HalfSpace* planes;
  const std::int32_t* graph;
  const EdgeGraph* graphs;
  const double* radius;
  // Bodies.
  const HalfSpace* worn;                      ///< WornPlane::most per body; null: no run wears
  const std::int32_t* worn_planes;            ///< number of these
  Soa rest;                                   ///< centroids [m]
  Soa inverse;                                ///< 1/m and 1/I
  Soa listed;                                 ///< displacements and rotations at the last list
  Soa others;                                 ///< force and moment of all forces but contacts
  Soa predicted;                              ///< velocity and spin on which dashpots act
  Soa works;                                  ///< by elastic, viscous, friction's terms
  const std::int32_t *first_end, *end_count;  ///< their pairs
  const std::int32_t* ends;                   ///< 2 pair + 0 or 1, in the order of pairs
  // Obstacles.
  const double* motions;  ///< of the queued steps
  const std::int32_t* run_of_obstacle;
  const std::int32_t* carriers;  ///< bodies; -1: none
  const std::int32_t *first_of_obstacle, *count_of_obstacle, *pairs_of_obstacle;
  double* obstacle_forces;  ///< six per obstacle
  double* obstacle_works;   ///< four per obstacle
  // Pairs.
  const std::int32_t* run_of_block;  ///< per 128 pairs
  const std::int32_t *a, *b;         ///< solids
  Soa constants;                     ///< DevicePairs::constants
  std::int32_t* face;                ///< at which they were apart: of B, then of A
  std::uint8_t *states, *touch;      ///< DevicePairs::State; overlaps in this step
  Soa met, history, trials, sums, terms;
  Soa crushes;  ///< DevicePairs::crush
  const double* accelerations;

  FLOE_KERNEL std::int32_t body_of(std::int32_t solid) const {
    return solid < bodies ? solid : carriers[solid - bodies];
  }
};
inline constexpr int of_block = most_threads;  ///< pairs of a block

/// Where a thread or warp of a step finds its pair.
template <class Memory>
struct PairStep {
  Memory memory;
  int step;

  FLOE_KERNEL std::int32_t beams(std::int32_t) const { return 0; }
  FLOE_KERNEL void beam(std::int32_t, std::int32_t, double*) const {}
  FLOE_KERNEL std::int32_t bodies(std::int32_t) const { return of_block; }

 protected:
  FLOE_KERNEL std::int32_t run_of(std::int64_t pair) const {
    return memory.contacts.run_of_block[pair / of_block];
  }
  /// Whether a place in memory has a pair, of a run that makes the step.
  FLOE_KERNEL bool is_in_step(std::int64_t pair) const {
    const std::int32_t run = run_of(pair);
    return pair < memory.contacts.runs[run].first_pair + memory.contacts.runs[run].pairs &&
           !memory.halts.stands(run, step);
  }
  FLOE_KERNEL bool is_body(std::int32_t solid) const { return solid < memory.contacts.bodies; }
  /// Returns a body itself, the body that carries an obstacle, or -1.
  FLOE_KERNEL std::int32_t body_of(std::int32_t solid) const {
    return memory.contacts.body_of(solid);
  }
  FLOE_KERNEL double before(std::int32_t run) const {
    return step == 0 ? memory.runs[run].before : memory.runs[run].dt;
  }
  FLOE_KERNEL const double* motion_of(std::int32_t run, std::int32_t solid) const {
    const ContactsOfRun& of = memory.contacts.runs[run];
    const std::int64_t k = solid - memory.contacts.bodies - of.first_obstacle;
    return memory.contacts.motions + of.obstacles +
           30 * (static_cast<std::int64_t>(step) * of.obstacle_count + k);
  }
  FLOE_KERNEL static Vec3<double> vector(const double* from) { return {from[0], from[1], from[2]}; }

  FLOE_KERNEL Placed placed(std::int32_t run, std::int32_t solid) const {
    const std::int64_t body = body_of(solid);
    if (body < 0) {
      const double* m = motion_of(run, solid);
      return {vector(m),
              {vector(m + 3), vector(m + 6), vector(m + 9)},
              vector(m + 12),
              vector(m + 15),
              0};
    }
    const Soa& r = memory.records[step % 2];
    return {memory.contacts.rest.vector(0, body) + r.vector(0, body),
            triad(product(r.quaternion(3, body), memory.bodies.quaternion(4, body))),
            r.vector(7, body), r.vector(10, body), 0};
  }
};

FLOE_KERNEL inline BodyMobility mobility_of(const Soa& inverse, std::int64_t body,
                                            const Triad<double>& axes) {
  return {inverse.at(0, body), SymmetricMatrix::along(axes, inverse.vector(1, body))};
}

/// Finds the overlaps of pairs, a warp for each.
template <class Memory>
struct OverlapStep : PairStep<Memory> {
  using Room = ClipRoom;

  FLOE_KERNEL void warp(std::int32_t pair, const Warp& warp, Room& room) const {
    if (!this->is_in_step(pair)) return;
    const ContactMemory& c = this->memory.contacts;
    const std::int32_t run = this->run_of(pair), a = c.a[pair], b = c.b[pair];
    const ContactsOfRun& of = c.runs[run];
    const Placed of_a = this->placed(run, a);
    Placed of_b = this->placed(run, b);
    MetPair found{};
    found.apart = of_a.x - of_b.x;
    if (of.periods.any()) {
      found.apart = of.periods.nearest(found.apart);
      of_b.x = of_a.x - found.apart;
    }
    const Relative place(of_a, of_b);
    WarpClipper clipper(warp, room);
    const std::int32_t first = c.first_vertex[a], planes_of_b = c.first_plane[b];
    clipper.place(c.vertices + 3 * static_cast<std::int64_t>(first), c.first_vertex[a + 1] - first,
                  place.turn, place.x);
    const bool touched = (c.states[pair] & DevicePairsTouching) != 0;
    bool touches = false;
    if (touched || !is_apart(pair, warp, clipper, place)) {
      if (!clipper.overlap(c.graphs[c.graph[a]], c.planes + planes_of_b,
                           c.first_plane[b + 1] - planes_of_b, of.with_patch != 0,
                           further(of.wears != 0, a, b), found.met.overlap)) {
        this->memory.halts.halt(run, this->step, Made::no_room);
        found.met.overlap = {};
      }
      take_to_world(found.met, c.planes[planes_of_b], c.radius[a], of_a, of_b, of.with_patch != 0);
      touches = found.met.overlap.volume > 0;
    }
    warp.each([&](int lane) {
      if (lane != 0) return;
      c.touch[pair] = touches ? 1 : 0;
      if (touches) put_struct(c.met, pair, found);
    });
  }

 private:
  static constexpr std::uint8_t DevicePairsTouching = 1;

  FLOE_KERNEL WarpClipper::Further further(bool wears, std::int32_t a, std::int32_t b) const {
    const ContactMemory& c = this->memory.contacts;
    if (!wears) return {};
    const bool of_b = this->is_body(b);
    const auto at = [&](std::int64_t body) { return c.worn + WornPlane::most * body; };
    return {at(a), of_b ? at(b) : nullptr, c.worn_planes[a], of_b ? c.worn_planes[b] : 0};
  }

  /// Whether a face has a gap: first that of the last gap. A face is a plane of B, or, counted on,
  /// of A. Pairs that only an axis between edges separates are clipped, to nothing.
  FLOE_KERNEL bool is_apart(std::int32_t pair, const Warp& warp, const WarpClipper& clipper,
                            const Relative& place) const {
    const ContactMemory& c = this->memory.contacts;
    const std::int32_t a = c.a[pair], b = c.b[pair];
    const double least = rounding_of_gaps * c.radius[a];
    const std::int32_t planes_of_b = c.first_plane[b + 1] - c.first_plane[b],
                       vertices_of_b = c.first_vertex[b + 1] - c.first_vertex[b],
                       all = vertices_of_b == 0
                                 ? planes_of_b
                                 : planes_of_b + c.first_plane[a + 1] - c.first_plane[a];
    const double* b_at = c.vertices + 3 * static_cast<std::int64_t>(c.first_vertex[b]);
    const auto has_gap = [&](std::int32_t face) {
      if (face < planes_of_b) return clipper.is_beyond(c.planes[c.first_plane[b] + face], least);
      // The plane of A in the frame of B, from which the vertices of B are to be beyond.
      const HalfSpace plane =
          floe::placed(c.planes[c.first_plane[a] + face - planes_of_b], place.turn, place.x);
      for (std::int32_t begin = 0; begin < vertices_of_b; begin += Warp::lanes) {
        const std::uint32_t near = warp.ballot([&](int lane) {
          if (begin + lane >= vertices_of_b) return false;
          const double* v = b_at + 3 * static_cast<std::int64_t>(begin + lane);
          return !(dot(plane.normal, Vec3<double>{v[0], v[1], v[2]}) - plane.offset > least);
        });
        if (near != 0) return false;
      }
      return true;
    };
    const std::int32_t last = c.face[pair];
    if (last >= 0 && last < all && has_gap(last)) return true;
    for (std::int32_t face = 0; face < all; ++face) {
      if (face == last || !has_gap(face)) continue;
      warp.each([&](int lane) {
        if (lane == 0) c.face[pair] = face;
      });
      return true;
    }
    return false;
  }
};

/// Adds the wrenches of a contact's force to those on A and B.
FLOE_KERNEL inline PairWrench wrench_of(const Vec3<double>& force, const Vec3<double>& couple,
                                        const Vec3<double>& arm_a, const Vec3<double>& arm_b) {
  return {force, cross(arm_a, force) + couple, cross(arm_b, force) + couple};
}
FLOE_KERNEL inline PairTerms terms_of(const ContactForce& f, const Vec3<double>& arm_a,
                                      const Vec3<double>& arm_b) {
  return {wrench_of(f.elastic * f.normal, f.couple, arm_a, arm_b),
          wrench_of(f.viscous * f.normal, f.viscous_couple, arm_a, arm_b),
          wrench_of(f.friction.force, f.friction.couple * f.normal, arm_a, arm_b)};
}

/// Ends the step of a pair: terms, and the history.
FLOE_KERNEL inline void keep_contact(const ContactMemory& c, std::int64_t pair,
                                     const ContactTrial& trial, const ContactForce& force,
                                     const MetPair& met) {
  const Vec3<double>& arm = met.met.overlap.centroid;
  put_struct(c.terms, pair, terms_of(force, arm, arm + met.apart));
  PairHistory now = trial.memory;
  now.springs.force = force.springs.force;
  now.twist.couple = force.springs.couple;
  c.history.at(0, pair) = now.plastic;
  c.history.at(1, pair) = now.springs.stiffness;
  c.history.at(2, pair) = now.springs.force.x;
  c.history.at(3, pair) = now.springs.force.y;
  c.history.at(4, pair) = now.springs.force.z;
  c.history.at(5, pair) = now.twist.stiffness;
  c.history.at(6, pair) = now.twist.couple;
}

/// Finds the contacts of pairs that overlap: all that does not depend on velocities to come.
template <class Memory>
struct TrialStep : PairStep<Memory> {
  FLOE_KERNEL void body(std::int32_t block, std::int32_t k, const double*) const {
    const std::int64_t pair = static_cast<std::int64_t>(block) * of_block + k;
    if (!this->is_in_step(pair)) return;
    const ContactMemory& c = this->memory.contacts;
    const std::uint8_t state = c.states[pair];
    const std::int32_t run = this->run_of(pair), a = c.a[pair], b = c.b[pair];
    if (c.touch[pair] == 0) {
      const bool wears = (state & crushed) != 0;
      c.states[pair] = wears ? parted : 0;
      if (wears) this->memory.halts.halt(run, this->step, Made::parted);
      return;
    }
    const ContactsOfRun& of = c.runs[run];
    MetPair met;
    get_struct(c.met, pair, met);
    const Placed of_a = this->placed(run, a), of_b = this->placed(run, b);
    const Vec3<double>& centre = met.met.overlap.centroid;
    const bool wet = of_a.x.z + centre.z < 0, touched = (state & 1) != 0, fresh = (state & 2) != 0;
    const PairConstants constants{c.constants.at(0, pair), c.constants.at(1, pair),
                                  c.constants.at(wet ? 3 : 2, pair), c.constants.at(4, pair)};
    const PairHistory known = touched ? history(pair) : PairHistory{};
    Mobility mobility;
    mobility.a = mobility_of(c.inverse, a, of_a.axes);
    const std::int32_t moves = this->body_of(b);
    if (moves >= 0) mobility.b = mobility_of(c.inverse, moves, of_b.axes);
    mobility.apart = met.apart;
    const RelativeMotion motion =
        relative_motion(BodyVelocity{of_a.velocity, of_a.spin},
                        BodyVelocity{of_b.velocity, of_b.spin}, centre, met.apart);
    const LastStep last{this->before(run), touched || fresh, 0};
    const Vec3<double> mean_spin = 0.5 * (of_a.spin + of_b.spin);
    ContactTrial trial;
    const auto find = [&](const auto& law) {
      find_trial(law, constants, met.met.overlap, met.met.depth, motion, mobility, last, mean_spin,
                 known, fresh && !touched, trial);
    };
    if (of.potential != 0) {
      find(PotentialLaw(of.constants));
    } else {
      find(OverlapLaw(of.constants));
    }
    const bool crushes =
        of.wears != 0 && take_crush(pair, (state & crushed) != 0, known.plastic, fresh && !touched,
                                    trial, of_a.axes, of_b.axes);
    c.states[pair] = static_cast<std::uint8_t>(crushes ? 1 | crushed : 1);
    const ContactForce force = without_dashpots(trial);
    if (of.damps == 0) return keep_contact(c, pair, trial, force, met);
    put_struct(c.trials, pair, trial);
    put_struct(c.sums, pair,
               wrench_of(force.force(), force.whole_couple(), centre, centre + met.apart));
  }

 private:
  static constexpr std::uint8_t crushed = 4, parted = 8;  // of DevicePairs::State

  /// Notes what a contact crushes (Crushing::take()). Returns whether it has crushed anything since
  /// the pair touched.
  FLOE_KERNEL bool take_crush(std::int64_t pair, bool known, double before, bool fresh,
                              const ContactTrial& trial, const Triad<double>& axes_a,
                              const Triad<double>& axes_b) const {
    const Soa& crushes = this->memory.contacts.crushes;
    const double after = trial.memory.plastic;
    if (fresh) before = after;  // it is born with it
    if (!(after > before)) return known;
    if (!known) crushes.at(0, pair) = before;
    crushes.at(1, pair) = after;
    const Vec3<double> a = axes_a.to_local(trial.normal), b = axes_b.to_local(trial.normal);
    const double normals[6] = {a.x, a.y, a.z, b.x, b.y, b.z};  // NOLINT: registers
    for (int n = 0; n < 6; ++n) crushes.at(2 + n, pair) = normals[n];
    return true;
  }
  FLOE_KERNEL PairHistory history(std::int64_t pair) const {
    const Soa& h = this->memory.contacts.history;
    PairHistory known;
    known.plastic = h.at(0, pair);
    known.springs.stiffness = h.at(1, pair);
    known.springs.force = h.vector(2, pair);
    known.twist.stiffness = h.at(5, pair);
    known.twist.couple = h.at(6, pair);
    return known;
  }
};

/// Adds the dashpots of contacts.
template <class Memory>
struct DashpotStep : PairStep<Memory> {
  FLOE_KERNEL void body(std::int32_t block, std::int32_t k, const double*) const {
    const std::int64_t pair = static_cast<std::int64_t>(block) * of_block + k;
    const ContactMemory& c = this->memory.contacts;
    if (!this->is_in_step(pair) || c.touch[pair] == 0) return;
    const std::int32_t run = this->run_of(pair);
    if (c.runs[run].damps == 0) return;
    MetPair met;
    get_struct(c.met, pair, met);
    ContactTrial trial;
    get_struct(c.trials, pair, trial);
    const RelativeMotion motion = relative_motion(
        predicted(run, c.a[pair]), predicted(run, c.b[pair]), met.met.overlap.centroid, met.apart);
    keep_contact(c, pair, trial, with_dashpots(trial, motion), met);
  }

 private:
  FLOE_KERNEL BodyVelocity predicted(std::int32_t run, std::int32_t solid) const {
    if (const std::int32_t body = this->body_of(solid); body >= 0) {
      const Soa& p = this->memory.contacts.predicted;
      return {p.vector(0, body), p.vector(3, body)};
    }
    const double* m = this->motion_of(run, solid);
    return {this->vector(m + 18), this->vector(m + 21)};
  }
};

/// Sums what a body's contacts add up to, in the order of the pairs.
FLOE_KERNEL inline TermSums contact_terms(const ContactMemory& c, std::int64_t b) {
  TermSums sums{};
  for (std::int32_t e = c.first_end[b]; e < c.first_end[b] + c.end_count[b]; ++e) {
    const std::int64_t pair = c.ends[e] / 2;
    if (c.touch[pair] == 0) continue;
    const bool on_b = c.ends[e] % 2 != 0;
    for (int t = 0; t < 3; ++t) {
      const Vec3<double> force = c.terms.vector(9 * t, pair),
                         moment = c.terms.vector(9 * t + (on_b ? 6 : 3), pair);
      sums.force[t] = on_b ? sums.force[t] - force : sums.force[t] + force;
      sums.moment[t] = on_b ? sums.moment[t] - moment : sums.moment[t] + moment;
    }
  }
  return sums;
}

/// Sums the forces on obstacles, a warp for each: the largest so far, impulses and works.
template <class Memory>
struct ObstacleStep : PairStep<Memory> {
  struct Room {
    double none;
  };

  FLOE_KERNEL void warp(std::int32_t obstacle, const Warp& warp, Room&) const {
    const ContactMemory& c = this->memory.contacts;
    const std::int32_t run = c.run_of_obstacle[obstacle];
    if (this->memory.halts.stands(run, this->step)) return;
    double all[18];  // NOLINT: registers
    const std::int32_t first = c.first_of_obstacle[obstacle];
    const auto touches = [&](std::int32_t e) {
      return c.touch[c.pairs_of_obstacle[first + e]] != 0;
    };
    // Which pairs are listed beside those that touch changes no bit.
    warp.sums_of<18>(all, c.count_of_obstacle[obstacle], touches, [&](std::int32_t e, double* of) {
      const std::int64_t pair = c.pairs_of_obstacle[first + e];
      for (int t = 0; t < 3; ++t) {
        for (int n = 0; n < 3; ++n) {
          of[6 * t + n] -= c.terms.at(9 * t + n, pair);
          of[6 * t + 3 + n] -= c.terms.at(9 * t + 6 + n, pair);
        }
      }
    });
    warp.each([&](int lane) {
      if (lane != 0) return;
      TermSums sums;
      for (int t = 0; t < 3; ++t) {
        sums.force[t] = this->vector(all + 6 * t);
        sums.moment[t] = this->vector(all + 6 * t + 3);
      }
      take(obstacle, run, sums);
    });
  }

 private:
  FLOE_KERNEL void take(std::int32_t obstacle, std::int32_t run, const TermSums& sums) const {
    const ContactMemory& c = this->memory.contacts;
    const double dt = this->memory.runs[run].dt, before = this->before(run);
    const Vec3<double> force = sums.all_forces(), moment = sums.all_moments();
    double* kept = c.obstacle_forces + 6 * static_cast<std::int64_t>(obstacle);
    const double f[3] = {force.x, force.y, force.z};  // NOLINT: registers
    if (dot(force, force) > dot(this->vector(kept), this->vector(kept)))
      for (int n = 0; n < 3; ++n) kept[n] = f[n];
    for (int n = 0; n < 3; ++n) kept[3 + n] += dt * f[n];
    if (c.carriers[obstacle] >= 0) return;  // its body has these works
    const double* m = this->motion_of(run, c.bodies + obstacle);
    const Vec3<double> v = this->vector(m + 12), w = this->vector(m + 15),
                       v_next = this->vector(m + 24), w_next = this->vector(m + 27);
    double* works = c.obstacle_works + 4 * static_cast<std::int64_t>(obstacle);
    for (int t = 0; t < 3; ++t)
      works[t] += 0.5 * (before * sums.power(t, v, w) + dt * sums.power(t, v_next, w_next));
    works[3] -= 0.5 * (before * (dot(force, v) + dot(moment, w)) +
                       dt * (dot(force, v_next) + dot(moment, w_next)));
  }
};

}  // namespace
}  // namespace floe::device
