/// \file
/// Steps of bodies with contacts: what dashpots of contacts act on, and the end of a step
/// (model.md, "Contact").
#pragma once

#include "device/contact_step.h"
#include "device/tile_step.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// The bodies of a tile, without its beams.
struct BodiesStep : BodyStep {
  FLOE_KERNEL std::int32_t beams(std::int32_t) const { return 0; }
  FLOE_KERNEL void beam(std::int32_t, std::int32_t, double*) const {}
  FLOE_KERNEL std::int32_t bodies(std::int32_t tile) const {
    return memory.first_body[tile + 1] - memory.first_body[tile];
  }
};

/// Predicts the velocities at the start of the step, by all forces but the dashpots of contacts.
struct PredictStep : BodiesStep {
  FLOE_KERNEL void body(std::int32_t tile, std::int32_t k, const double*) const {
    const std::int32_t r = memory.run[tile];
    const ContactMemory& c = memory.contacts;
    const std::int64_t b = memory.first_body[tile] + k;
    if (c.runs[r].damps == 0 || c.end_count[b] == 0 || memory.halts.stands(r, step)) return;
    Vec3<double> force{0, 0, 0}, moment{0, 0, 0};
    for (std::int32_t e = c.first_end[b]; e < c.first_end[b] + c.end_count[b]; ++e) {
      const std::int64_t pair = c.ends[e] / 2;
      if (c.touch[pair] == 0) continue;
      if (c.ends[e] % 2 == 0) {
        force = force + c.sums.vector(0, pair);
        moment = moment + c.sums.vector(3, pair);
      } else {
        force = force - c.sums.vector(0, pair);
        moment = moment - c.sums.vector(6, pair);
      }
    }
    force = force + c.others.vector(0, b);
    moment = moment + c.others.vector(3, b);
    const BodyMotion<double> now = motion(b);
    const BodyMobility body =
        mobility_of(c.inverse, b, triad(product(now.q, memory.bodies.quaternion(4, b))));
    Vec3<double> linear = body.mass * force, angular = body.turning * moment;
    prescribe(r, b, linear, angular);
    const double after = 0.5 * (step == 0 ? memory.runs[r].before : memory.runs[r].dt);
    put(c.predicted, 0, b, now.v + after * linear);
    put(c.predicted, 3, b, now.w + after * angular);
  }

 private:
  /// No force changes prescribed velocities.
  FLOE_KERNEL void prescribe(std::int32_t r, std::int64_t b, Vec3<double>& linear,
                             Vec3<double>& angular) const {
    if (memory.held_row == nullptr || memory.held_row[b] < 0) return;
    const double* of_step = memory.contacts.accelerations + memory.contacts.runs[r].accelerations +
                            static_cast<std::int64_t>(step) * memory.runs[r].motion_count;
    const auto given = [&](int n, double& value) {
      const std::int32_t motion =
          memory.held_motions[6 * static_cast<std::int64_t>(memory.held_row[b]) + n];
      if (motion >= 0) value = of_step[motion];
    };
    given(0, linear.x), given(1, linear.y), given(2, linear.z);
    given(3, angular.x), given(4, angular.y), given(5, angular.z);
  }
};

/// The end of a step: contacts and all other forces move the bodies.
struct MoveStep : BodiesStep {
  FLOE_KERNEL void body(std::int32_t tile, std::int32_t k, const double*) const {
    const std::int32_t r = memory.run[tile];
    const ContactMemory& c = memory.contacts;
    const std::int64_t b = memory.first_body[tile] + k;
    if (memory.halts.stands(r, step)) return stay(b);
    const BodyMotion<double> old = motion(b);
    const TermSums sums = contact_terms(c, b);
    const BodyMotion<double> now = move(r, b, old, c.others.vector(0, b) + sums.all_forces(),
                                        c.others.vector(3, b) + sums.all_moments());
    if (c.end_count[b] > 0) {
      const double dt = memory.runs[r].dt, before = step == 0 ? memory.runs[r].before : dt;
      for (int t = 0; t < 3; ++t)
        c.works.at(t, b) +=
            0.5 * (before * sums.power(t, old.v, old.w) + dt * sums.power(t, now.v, now.w));
    }
    if (c.runs[r].any != 0 && travel(b, now) > c.runs[r].slack)
      memory.halts.halt(r, step, Made::list_expired);
  }

 private:
  /// Bound of the travel of a body's vertices since its run's pairs were listed [m].
  FLOE_KERNEL double travel(std::int64_t b, const BodyMotion<double>& now) const {
    const Soa& was = memory.contacts.listed;
    const Vec3<double> way = now.u - was.vector(0, b);
    const Quat<double> turn = product(now.q, conjugate(was.quaternion(3, b)));
    return length(way) +
           2 * memory.contacts.radius[b] * length(Vec3<double>{turn.x, turn.y, turn.z});
  }
};

}  // namespace
}  // namespace floe::device
