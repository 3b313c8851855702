/// \file
/// Still water on the bodies of a tile in one step: buoyancy and drag (model.md, "Water"). The
/// physics is that of src/submersion and src/water; here are loops and memory only.
#pragma once

#include <cstdint>

#include "device/tile_step.h"
#include "submersion/below_water.h"
#include "submersion/follow.h"
#include "water/drag_law.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// The water of a run.
struct WaterOfRun {
  double weight_density;       ///< rho g [N/m^3]; 0: no buoyancy
  double linear, coefficient;  ///< of drag
  std::int32_t drags;
  std::int32_t pace, since;  ///< submerged parts are found anew where since % pace is 0
  std::int32_t by_points;    ///< Wet
  std::int64_t motions;      ///< where the first step's level and current begin
};

/// Memory of the water's steps.
struct WaterMemory {
  const WaterOfRun* waters;  ///< per run
  const double* motions;     ///< four per step: level [m], current [m/s]
  Soa prisms;                ///< numbers of Prism
  Soa wholes;                ///< volume, centroid
  const double *extents, *most2, *area_per_volume;
  const std::int32_t *first_vertex, *first_face;  ///< per body, and one more
  const std::int32_t *first_corner, *corners;     ///< per face, and one more; vertices
  const double* vertices;                         ///< x, y, z of each
  Soa expansions;  ///< z, q, volume, moment, waterplane; no run has a pace: null
};
inline constexpr int of_expansion = 15;

/// A body for below_water(). Its vertices are placed where they are asked for.
struct WaterBody {
  const WaterMemory& water;
  std::int64_t b;

  struct Faces {
    const WaterMemory& water;
    std::int64_t b;
    Triad<double> axes;

    constexpr std::int32_t vertices() const {
      return water.first_vertex[b + 1] - water.first_vertex[b];
    }
    constexpr Vec3<double> at(std::int64_t v) const {
      const double* x = water.vertices + 3 * v;
      return axes.to_world(Vec3<double>{x[0], x[1], x[2]});
    }
    constexpr Vec3<double> vertex(std::int32_t v) const { return at(water.first_vertex[b] + v); }
    constexpr std::int32_t first_face() const { return water.first_face[b]; }
    constexpr std::int32_t end_face() const { return water.first_face[b + 1]; }
    constexpr std::int32_t first_corner(std::int32_t f) const { return water.first_corner[f]; }
    constexpr Vec3<double> corner(std::int32_t c) const { return at(water.corners[c]); }
  };

  constexpr Prism<double> prism() const {
    const Soa& p = water.prisms;
    return {p.quaternion(0, b), p.at(4, b),  p.at(5, b),  p.at(6, b),  p.at(7, b), p.at(8, b),
            p.at(9, b),         p.at(10, b), p.at(11, b), p.at(12, b), p.at(13, b)};
  }
  constexpr double extent() const { return water.extents[b]; }
  constexpr Submerged whole(const Triad<double>& axes) const {
    Submerged s;
    s.volume = water.wholes.at(0, b);
    s.moment = s.volume * axes.to_world(water.wholes.vector(1, b));
    return s;
  }
  constexpr Faces placed(const Triad<double>& axes) const { return {water, b, axes}; }
};

/// The water in step k of a launch. It leaves forces in Memory::water, which TileStep adds.
struct WaterStep {
  Memory memory;
  WaterMemory water;
  int step;

  FLOE_KERNEL std::int32_t beams(std::int32_t) const { return 0; }
  FLOE_KERNEL void beam(std::int32_t, std::int32_t, double*) const {}
  FLOE_KERNEL std::int32_t bodies(std::int32_t tile) const {
    return memory.first_body[tile + 1] - memory.first_body[tile];
  }

  FLOE_KERNEL void body(std::int32_t tile, std::int32_t k, const double*) const {
    const std::int32_t run = memory.run[tile];
    if (memory.halts.stands(run, step)) return;
    const std::int64_t b = memory.first_body[tile] + k;
    const WaterOfRun& of = water.waters[run];
    const double* motion = water.motions + of.motions + std::int64_t{4} * step;
    const Soa& from = memory.records[step % 2];
    const double z = from.at(u_at + 2, b) - motion[0];
    const Submerged s = submerged(of, b, z, from.quaternion(q_at, b));
    Vec3<double> drag{0, 0, 0};
    if (of.drags != 0) {
      const Vec3<double> v = from.vector(v_at, b) - Vec3<double>{motion[1], motion[2], motion[3]};
      const double area = s.volume * water.area_per_volume[b];
      drag = of.coefficient > 0 ? drag_force<true>(of.linear, of.coefficient, area, v)
                                : drag_force<false>(of.linear, of.coefficient, area, v);
    }
    const Soa& to = memory.water;
    to.at(0, b) = drag.x;
    to.at(1, b) = drag.y;
    to.at(2, b) = drag.z;
    to.at(3, b) = of.weight_density * s.volume;
    to.at(4, b) = of.weight_density * s.moment.y;
    to.at(5, b) = -of.weight_density * s.moment.x;
  }

 private:
  /// \param z  displacement over the water
  FLOE_KERNEL Submerged submerged(const WaterOfRun& of, std::int64_t b, double z,
                                  const Quat<double>& q) const {
    const WaterBody body{water, b};
    const Wet wet = of.by_points != 0 ? Wet::by_points : Wet::by_sphere;
    const auto find = [&] { return below_water(body, of_unit_length(q), body.prism().z + z, wet); };
    if (of.pace == 1) return find();
    const Soa& e = water.expansions;
    if ((of.since + step) % of.pace != 0) {
      const Expansion<double> kept{
          e.at(0, b),
          e.quaternion(1, b),
          e.at(5, b),
          e.vector(6, b),
          {e.at(9, b), e.at(10, b), e.at(11, b), e.at(12, b), e.at(13, b), e.at(14, b)}};
      const Followed<double> f = followed(kept, z, q);
      const double extent = water.extents[b];
      // As Submersion: (a + b)^2 <= 2 (a^2 + b^2)
      if (!(f.shift * f.shift + extent * extent * f.turn2 - water.most2[b] > 0)) {
        Submerged s;
        s.volume = f.volume < 0 ? 0 : f.volume;
        s.moment = f.moment;
        return s;
      }
    }
    const Submerged s = find();
    e.at(0, b) = z;
    e.at(1, b) = q.w;
    e.at(2, b) = q.x;
    e.at(3, b) = q.y;
    e.at(4, b) = q.z;
    e.at(5, b) = s.volume;
    e.at(6, b) = s.moment.x;
    e.at(7, b) = s.moment.y;
    e.at(8, b) = s.moment.z;
    e.at(9, b) = s.waterplane;
    e.at(10, b) = s.wx;
    e.at(11, b) = s.wy;
    e.at(12, b) = s.wxx;
    e.at(13, b) = s.wxy;
    e.at(14, b) = s.wyy;
    return s;
  }
};

}  // namespace
}  // namespace floe::device
