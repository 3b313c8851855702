#include "floe/lattice/state.h"

namespace floe {

State<Spatial> in_space(const State<Planar>& state, bool linear) {
  const std::size_t bodies = state.records.size() / Planar::record;
  State<Spatial> all(bodies);
  all.time = state.time;
  all.velocity_time = state.velocity_time;
  for (std::size_t b = 0; b < bodies; ++b) {
    double* r = all.record(b);
    const Vec3<double> u = displacement(state, b), t = linear_rotation(state, b),
                       v = velocity(state, b), w = angular_velocity(state, b);
    const Quat<double> q = linear ? Quat<double>{1, 0, 0, 0.5 * t.z} : rotation(state, b);
    r[0] = u.x, r[1] = u.y;
    r[Spatial::rotation] = q.w, r[Spatial::rotation + 3] = q.z;
    r[Spatial::velocity] = v.x, r[Spatial::velocity + 1] = v.y;
    r[Spatial::angular_velocity + 2] = w.z;
  }
  return all;
}

}  // namespace floe
