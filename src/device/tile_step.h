/// \file
/// One step of leapfrog of the bodies of a tile with the beams that touch them: beams, gravity,
/// loads, boundaries, and what the water has left (model.md, "Explicit dynamics"). The physics is
/// that of src/beams/kernel.h and src/leapfrog/rigid_body_step.h; here are loops and memory only.
#pragma once

#include <cstdint>

#include "beams/kernel.h"
#include "device/breaking.h"
#include "device/contact_step.h"
#include "device/halts.h"
#include "device/launch.h"
#include "device/soa.h"
#include "forces/support_law.h"
#include "leapfrog/held_body.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// Where the records of bodies have what, as Spatial.
enum Record : int { u_at = 0, q_at = 3, v_at = 7, w_at = 10, momentum_at = 13, of_record = 16 };

/// One run among those that are stepped together.
struct RunOfTiles {
  double dt, before;     ///< as Steps
  std::int64_t motions;  ///< where its motions begin in the table, of the first step
  std::int32_t motion_count;
  std::int64_t wrenches;  ///< likewise its loads' wrenches
  std::int32_t load_count;
};

/// Memory of the tiles' steps, of all runs.
struct Memory {
  // Tiles.
  const std::int32_t *first_body, *first_slot, *run;
  // Slots.
  const std::int32_t *i, *j;
  Soa constants;  ///< frame, length, stiffnesses; dashpots
  // Bodies.
  const std::int32_t *first_end, *ends;
  Soa bodies;             ///< 1/m, 1/I, axes
  const double* weights;  ///< null: none
  Soa records[2];         ///< step k reads those of k % 2 and writes the others
  double* beam_works;     ///< per body [J]; null: beams have no dashpots
  /// Of the water on each body: drag along x, y, z, buoyancy, and its moments about x and y; null
  /// numbers: none [N, N m].
  Soa water;
  double *drag_works, *buoyancy_works;  ///< per body [J]; null: no drag; still water
  // Held bodies.
  const std::int32_t* held_row;  ///< per body; null: none is held
  const std::uint8_t* held_bits;
  const std::int32_t* held_motions;  ///< six per held body
  double* held_works;
  const double* motions;
  // Loads on bodies.
  const std::int32_t* first_load;  ///< per body, and one more; null: none is loaded
  const std::int32_t* load;        ///< among those of its run
  Soa arms;
  double* load_works;
  const double* wrenches;
  // Supports of bodies.
  const std::int32_t* support_of;  ///< per body, -1: none; null: no body has one
  const double* supports;          ///< arm, stiffness, damping of each
  double* support_works;
  // Runs.
  const RunOfTiles* runs;
  Halts halts;
  std::uint64_t *speed2, *spin2;  ///< largest squares as bits, which are in the same order
  BreakingMemory breaking;
  ContactMemory contacts;
};

/// Reads the frame of a beam at rest, as few numbers as it has.
template <template <class> class Frame>
struct FrameOf;
template <>
struct FrameOf<FlatFrame> {
  static constexpr int size = 2;
  FLOE_KERNEL static FlatFrame<double> get(const Soa& c, std::int64_t slot) {
    return {c.at(0, slot), c.at(1, slot)};
  }
};
template <>
struct FrameOf<AnyFrame> {
  static constexpr int size = 9;
  FLOE_KERNEL static AnyFrame<double> get(const Soa& c, std::int64_t slot) {
    return {c.vector(0, slot), c.vector(3, slot), c.vector(6, slot)};
  }
};
template <>
struct FrameOf<EccentricFrame> {
  static constexpr int size = 15;
  FLOE_KERNEL static EccentricFrame<double> get(const Soa& c, std::int64_t slot) {
    return {FrameOf<AnyFrame>::get(c, slot), c.vector(9, slot), c.vector(12, slot)};
  }
};

inline constexpr int of_matrix = 36, of_support = 3 + 2 * of_matrix;

/// The end of a step, for one body at a time.
struct BodyStep {
  Memory memory;
  int step;

  FLOE_KERNEL BodyMotion<double> motion(std::int64_t b) const {
    const Soa& from = memory.records[step % 2];
    return {from.vector(u_at, b), from.quaternion(q_at, b), from.vector(v_at, b),
            from.vector(w_at, b), from.vector(momentum_at, b)};
  }
  /// A body of a run that stands still.
  FLOE_KERNEL void stay(std::int64_t b) const {
    const Soa &from = memory.records[step % 2], &to = memory.records[(step + 1) % 2];
    for (int n = 0; n < of_record; ++n) to.at(n, b) = from.at(n, b);
  }
  /// Moves a body of run r by all that acts on it; returns its motion after the step.
  FLOE_KERNEL BodyMotion<double> move(std::int32_t r, std::int64_t b, const BodyMotion<double>& old,
                                      const Vec3<double>& force, const Vec3<double>& moment) const {
    const RunOfTiles& run = memory.runs[r];
    const Soa& to = memory.records[(step + 1) % 2];
    const double dt = run.dt, before = step == 0 ? run.before : run.dt;
    const BodyConstants<double> c{memory.bodies.at(0, b), memory.bodies.vector(1, b),
                                  memory.bodies.quaternion(4, b)};
    BodyMotion<double> now = old;
    leap(c, now, force, moment, dt);
    hold(run, b, c, old, moment, now);
    add_works_of_loads(run, b, old, now, dt, before);
    add_works_of_support(b, old, now, dt, before);
    add_works_of_water(b, old, now, dt, before);
    put(to, u_at, b, now.u);
    to.at(q_at, b) = now.q.w;
    put(to, q_at + 1, b, {now.q.x, now.q.y, now.q.z});
    put(to, v_at, b, now.v);
    put(to, w_at, b, now.w);
    put(to, momentum_at, b, now.momentum);
    raise(&memory.speed2[r], dot(now.v, now.v));
    raise(&memory.spin2[r], dot(now.w, now.w));
    return now;
  }

  FLOE_KERNEL static void put(const Soa& to, int number, std::int64_t b, const Vec3<double>& v) {
    to.at(number, b) = v.x;
    to.at(number + 1, b) = v.y;
    to.at(number + 2, b) = v.z;
  }

  FLOE_KERNEL const double* wrench_of(const RunOfTiles& run, std::int32_t load) const {
    return memory.wrenches + run.wrenches +
           6 * (static_cast<std::int64_t>(step) * run.load_count + memory.load[load]);
  }
  /// The arm of a load goes with its body (src/forces/dead_load.cpp).
  FLOE_KERNEL void add_loads(const RunOfTiles& run, std::int64_t b, const BodyMotion<double>& m,
                             Vec3<double>& force, Vec3<double>& moment) const {
    if (memory.first_load == nullptr) return;
    for (std::int32_t l = memory.first_load[b]; l < memory.first_load[b + 1]; ++l) {
      const double* w = wrench_of(run, l);
      const Vec3<double> f{w[0], w[1], w[2]}, arm = rotate(m.q, memory.arms.vector(0, l));
      force = force + f;
      moment = moment + (Vec3<double>{w[3], w[4], w[5]} + cross(arm, f));
    }
  }
  /// Half of the step before with the velocities there, and half of this one: LeapfrogWork,
  /// "at_once".
  FLOE_KERNEL void add_works_of_loads(const RunOfTiles& run, std::int64_t b,
                                      const BodyMotion<double>& old, const BodyMotion<double>& now,
                                      double dt, double before) const {
    if (memory.first_load == nullptr) return;
    for (std::int32_t l = memory.first_load[b]; l < memory.first_load[b + 1]; ++l) {
      const double* w = wrench_of(run, l);
      const Vec3<double> f{w[0], w[1], w[2]}, arm = rotate(old.q, memory.arms.vector(0, l));
      const Vec3<double> moment = Vec3<double>{w[3], w[4], w[5]} + cross(arm, f);
      memory.load_works[l] += 0.5 * (before * (dot(f, old.v) + dot(moment, old.w)) +
                                     dt * (dot(f, now.v) + dot(moment, now.w)));
    }
  }

  FLOE_KERNEL bool is_supported(std::int64_t b) const {
    return memory.support_of != nullptr && memory.support_of[b] >= 0;
  }
  FLOE_KERNEL SupportedBody<double> supported_body(std::int64_t b,
                                                   const BodyMotion<double>& m) const {
    const double* s = memory.supports + std::int64_t{of_support} * memory.support_of[b];
    return supported(s + 3, s + 3 + of_matrix, Vec3<double>{s[0], s[1], s[2]}, m.u, m.q, m.v, m.w);
  }
  FLOE_KERNEL void add_support(std::int64_t b, const BodyMotion<double>& m, Vec3<double>& force,
                               Vec3<double>& moment) const {
    if (!is_supported(b)) return;
    const SupportedBody<double> s = supported_body(b, m);
    force = force + s.wrench.force;
    moment = moment + s.moment;
  }
  FLOE_KERNEL void add_works_of_support(std::int64_t b, const BodyMotion<double>& old,
                                        const BodyMotion<double>& now, double dt,
                                        double before) const {
    if (!is_supported(b)) return;
    const SupportWrenchOf<double> lost = supported_body(b, old).damping;
    memory.support_works[memory.support_of[b]] +=
        0.5 * (before * (dot(lost.force, old.v) + dot(lost.moment, old.w)) +
               dt * (dot(lost.force, now.v) + dot(lost.moment, now.w)));
  }

  FLOE_KERNEL void add_works_of_water(std::int64_t b, const BodyMotion<double>& old,
                                      const BodyMotion<double>& now, double dt,
                                      double before) const {
    if (memory.drag_works != nullptr) {
      const Vec3<double> drag = memory.water.vector(0, b);
      memory.drag_works[b] += 0.5 * (before * dot(drag, old.v) + dt * dot(drag, now.v));
    }
    if (memory.buoyancy_works != nullptr) {
      const double f = memory.water.at(3, b), x = memory.water.at(4, b), y = memory.water.at(5, b);
      const auto power = [&](const BodyMotion<double>& m) {
        return f * m.v.z + x * m.w.x + y * m.w.y;
      };
      memory.buoyancy_works[b] += 0.5 * (before * power(old) + dt * power(now));
    }
  }

  FLOE_KERNEL void hold(const RunOfTiles& run, std::int64_t b, const BodyConstants<double>& c,
                        const BodyMotion<double>& old, const Vec3<double>& moment,
                        BodyMotion<double>& now) const {
    if (memory.held_row == nullptr || memory.held_row[b] < 0) return;
    const std::int64_t row = memory.held_row[b];
    const double* at_start =
        memory.motions + run.motions + std::int64_t{2} * step * run.motion_count;
    double starts[6] = {}, ends[6] = {};  // NOLINT: std::array is no type of kernels everywhere
    for (int n = 0; n < 6; ++n) {
      const std::int32_t motion = memory.held_motions[6 * row + n];
      if (motion < 0) continue;
      starts[n] = at_start[motion];
      ends[n] = at_start[run.motion_count + motion];
    }
    const HeldBody<double> held{memory.held_bits[row], starts, ends, run.dt};
    double work = hold_displacements(held, c.inverse_mass, old, now);
    if (held.bits >> 3 != 0) work += hold_rotations(held, c, old, moment, now);
    memory.held_works[row] += work;
  }
};

/// Step k of a launch, for one tile at a time: beam() for each of its beams, then body() for each
/// of its bodies.
template <bool damped, bool breakable, template <class> class Frame>
struct TileStep : BodyStep {
  using Kernel = BeamKernel<Kinematics::corotational>;
  static constexpr int first = FrameOf<Frame>::size, of_beam = first + 7 + (damped ? 6 : 0);
  /// What a beam leaves for its bodies: force, moments, and the power that its dashpots lose.
  static constexpr int shares = damped ? 10 : 9;

  FLOE_KERNEL std::int32_t beams(std::int32_t tile) const {
    return memory.first_slot[tile + 1] - memory.first_slot[tile];
  }
  FLOE_KERNEL std::int32_t bodies(std::int32_t tile) const {
    return memory.first_body[tile + 1] - memory.first_body[tile];
  }

  /// \param shared  room of a tile, number by number
  FLOE_KERNEL void beam(std::int32_t tile, std::int32_t k, double* shared) const {
    const RunOfTiles& run = memory.runs[memory.run[tile]];
    if (memory.halts.stands(memory.run[tile], step)) return;
    const std::int64_t slot = memory.first_slot[tile] + k;
    const Soa &c = memory.constants, &r = memory.records[step % 2];
    const BeamConstants<double, Frame> beam{FrameOf<Frame>::get(c, slot), c.at(first, slot),
                                            c.at(first + 1, slot),        c.at(first + 2, slot),
                                            c.at(first + 3, slot),        c.at(first + 4, slot),
                                            c.at(first + 5, slot),        c.at(first + 6, slot)};
    const std::int32_t i = memory.i[slot], j = memory.j[slot];
    const std::int64_t room = beams(tile);
    bool cracked = false;
    if constexpr (breakable) {
      const Soa& cracks = memory.breaking.cracks;
      cracked = cracks.at(Damage::kappa, slot) > 0;
      if (cracked && cracks.at(Damage::damage, slot) == 1) {
        for (int n = 0; n < shares; ++n) shared[n * room + k] = 0;
        forget_dashpots(slot);
        return;
      }
    }
    const BeamStrains<double> s =
        Kernel::strains(beam, Vec3<double>(r.vector(u_at, j) - r.vector(u_at, i)),
                        r.quaternion(q_at, i), r.quaternion(q_at, j));
    BeamStress<double> stress = elastic_stress(beam, s);
    const auto rates = [&] {
      return Kernel::rates(beam, s, Vec3<double>(r.vector(v_at, j) - r.vector(v_at, i)),
                           r.vector(w_at, i), r.vector(w_at, j));
    };
    Softening left;
    if constexpr (breakable) {
      const BreakableBeam<Kernel, decltype(beam)> breaking{
          memory.breaking, memory.breaking.runs[memory.run[tile]], slot, beam, s, stress};
      if (cracked || !breaking.holds()) {
        left = breaking.soften(cracked, rates, step, step == 0 ? run.before : run.dt,
                               memory.run[tile], [&] { return middle(slot, i, j, r, s); });
        auto soft = beam;
        soft.kn *= left.axial;
        soft.ksz *= left.rest, soft.ksy *= left.rest, soft.kt *= left.rest;
        soft.kby *= left.rest, soft.kbz *= left.rest;
        stress = elastic_stress(soft, s);
      }
    }
    if constexpr (damped) {
      const BeamStress<double> rate = rates();
      const auto dashpot = [&](int d) {
        return (d == 0 ? left.axial : left.rest) * c.at(first + 7 + d, slot);
      };
      const BeamStress<double> viscous{
          dashpot(0) * rate.n,
          dashpot(1) * rate.qy,
          dashpot(2) * rate.qz,
          {dashpot(3) * rate.c.x, dashpot(4) * rate.c.y, dashpot(5) * rate.c.z}};
      double& lost = shared[9 * room + k];
      lost = power(viscous, rate);
      if constexpr (breakable) lost += power(remember_dashpots(slot, viscous), rate);
      stress = stress + viscous;
    }
    const BeamGradient<double> g = Kernel::gradient(beam, s, stress);
    const auto put = [&](int at, const Vec3<double>& v) {
      shared[at * room + k] = v.x;
      shared[(at + 1) * room + k] = v.y;
      shared[(at + 2) * room + k] = v.z;
    };
    put(0, g.force);
    put(3, g.moment_i);
    put(6, g.moment_j);
  }

  FLOE_KERNEL void body(std::int32_t tile, std::int32_t k, const double* shared) const {
    const std::int32_t r = memory.run[tile];
    const RunOfTiles& run = memory.runs[r];
    const std::int64_t b = memory.first_body[tile] + k;
    const bool has_contacts = memory.contacts.others.numbers != nullptr;
    if (memory.halts.stands(r, step)) {
      if (!has_contacts) stay(b);
      return;
    }
    const double dt = run.dt, before = step == 0 ? run.before : run.dt;
    const BodyMotion<double> old = motion(b);
    Vec3<double> force{0, 0, 0}, moment{0, 0, 0};
    sum_beams(tile, b, shared,
              breakable    ? 0.5 * before
              : before > 0 ? dt
                           : 0.25 * dt,
              force, moment);
    if (memory.weights != nullptr) force.z -= memory.weights[b];
    if (memory.water.numbers != nullptr) {
      force = force + memory.water.vector(0, b);
      force.z += memory.water.at(3, b);
      moment.x += memory.water.at(4, b);
      moment.y += memory.water.at(5, b);
    }
    add_loads(run, b, old, force, moment);
    add_support(b, old, force, moment);
    if (has_contacts) {  // which are yet to come
      put(memory.contacts.others, 0, b, force);
      put(memory.contacts.others, 3, b, moment);
      return;
    }
    (void)move(r, b, old, force, moment);
  }

 private:
  FLOE_KERNEL static double power(const BeamStress<double>& stress,
                                  const BeamStress<double>& rate) {
    return stress.n * rate.n + stress.qy * rate.qy + stress.qz * rate.qz + dot(stress.c, rate.c);
  }
  /// Returns the forces of dashpots at the start of the last step, and keeps the present ones.
  FLOE_KERNEL BeamStress<double> remember_dashpots(std::int64_t slot,
                                                   const BeamStress<double>& now) const {
    const SoaOf<float>& kept = memory.breaking.viscous;
    const auto at = [&](int n) { return static_cast<double>(kept.at(n, slot)); };
    const BeamStress<double> before{at(0), at(1), at(2), {at(3), at(4), at(5)}};
    const auto put = [&](int n, double value) { kept.at(n, slot) = static_cast<float>(value); };
    put(0, now.n), put(1, now.qy), put(2, now.qz), put(3, now.c.x), put(4, now.c.y);
    put(5, now.c.z);
    return before;
  }
  FLOE_KERNEL void forget_dashpots(std::int64_t slot) const {
    if constexpr (damped)
      for (int n = 0; n < 6; ++n) memory.breaking.viscous.at(n, slot) = 0;
  }
  /// Returns the middle between the ends of a beam [m].
  FLOE_KERNEL Vec3<double> middle(std::int64_t slot, std::int32_t i, std::int32_t j, const Soa& r,
                                  const BeamStrains<double>& s) const {
    Vec3<double> both = r.vector(u_at, i) + r.vector(u_at, j);
    if constexpr (is_eccentric_frame<Frame>) both = both + s.arm_i + s.arm_j;
    return memory.breaking.constants.vector(Breaking::middle, slot) + 0.5 * both;
  }

  /// \param time  by which the power that dashpots lose counts: LeapfrogWork, "never", or where
  ///              beams break "in_next_evaluation" [s]
  FLOE_KERNEL void sum_beams(std::int32_t tile, std::int64_t b, const double* shared, double time,
                             Vec3<double>& force, Vec3<double>& moment) const {
    const std::int64_t room = beams(tile);
    const auto get = [&](int at, std::int64_t k) {
      return Vec3<double>{shared[at * room + k], shared[(at + 1) * room + k],
                          shared[(at + 2) * room + k]};
    };
    double lost = 0;
    for (std::int32_t e = memory.first_end[b]; e < memory.first_end[b + 1]; ++e) {
      const std::int64_t k = memory.ends[e] / 2;
      if (memory.ends[e] % 2 == 0) {
        force = force + get(0, k);
        moment = moment - get(3, k);
        if constexpr (damped) lost += shared[9 * room + k];
      } else {
        force = force - get(0, k);
        moment = moment - get(6, k);
      }
    }
    if constexpr (damped) memory.beam_works[b] -= time * lost;
  }
};

}  // namespace
}  // namespace floe::device
