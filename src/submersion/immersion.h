/// \file
/// The submerged part of each body, below the level of the water: exact at any place and tilt
/// (model.md, "Water").
///
/// Notation: (x, y, c) are the principal axes of a body with the origin at its centroid. R takes
/// them to the world, and (s_x, s_y) = (R_31, R_32)/R_33 is the slope of the plan. The plan of a
/// prism along c has the area A and the moments S, I about the origin. The water surface is at
/// c_w(x, y) = c_0 - s_x x - s_y y, c_0 = -z(centroid)/R_33. While the water cuts only the sides,
/// all integrals of c from the bottom to c_w are polynomials of A, S and I.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/simd.h"
#include "floe/base/item.h"
#include "floe/lattice/state.h"
#include "lattice/partition.h"
#include "submersion/surface.h"

namespace floe {

/// A body at rest, and its plan if the body is a prism along axis 3. Other bodies get an infinite
/// circumradius, so that sides_only() is false for them.
template <class T>
struct Prism {
  Quat<T> axes;              ///< principal axes
  T z;                       ///< height of the centroid [m]
  T bottom, top;             ///< end faces on axis 3 [m]
  T area, x, y, xx, xy, yy;  ///< A, S and I of the plan [m^2, m^3, m^4]
  T radius2;                 ///< square of the circumradius about axis 3 [m^2]
  static constexpr std::size_t numbers = 14;
};

/// The submerged part of a prism of which the water cuts only the sides.
template <class T>
struct PrismBelow {
  Triad<T> axes;          ///< principal axes in the world
  T upright, sx, sy, c0;  ///< 1/R_33; slopes; c_0, the water over the centroid along axis 3 [m]
  T volume;               ///< [m^3]
  Vec3<T> moment;         ///< int r dV, world axes about the centroid [m^4]
};

/// Submerged part of a prism if the water cuts only the sides (else the result has no meaning).
/// \param rotation  from rest, of unit length
/// \param z         height of the centroid over the water [m]
template <class T>
PrismBelow<T> prism_below(const Prism<T>& b, const Quat<T>& rotation, const T& z) {
  PrismBelow<T> p;
  p.axes = triad(product(rotation, b.axes));
  p.upright = 1.0 / p.axes.e3.z;
  p.sx = p.axes.e1.z * p.upright;
  p.sy = p.axes.e2.z * p.upright;
  p.c0 = -(z * p.upright);
  const T depth = p.c0 - b.bottom;
  const T along = p.sx * b.x + p.sy * b.y;
  const T tilt_x = p.sx * b.xx + p.sy * b.xy, tilt_y = p.sx * b.xy + p.sy * b.yy;
  p.volume = b.area * depth - along;
  p.moment = p.axes.to_world(
      {T(depth * b.x - tilt_x), T(depth * b.y - tilt_y),
       T(0.5 * T(depth * T(T(p.c0 + b.bottom) * b.area) + T(p.sx * tilt_x + p.sy * tilt_y)) -
         p.c0 * along)});
  return p;
}

/// The waterplane of a body: its area [m^2], and its moments about the body's centroid [m^3, m^4].
template <class T>
struct Waterplane {
  T area, x, y, xx, xy, yy;
};

/// Waterplane of a prism of which the water cuts only the sides.
template <class T>
Waterplane<T> waterplane_of(const Prism<T>& b, const PrismBelow<T>& p) {
  const auto& [e1, e2, e3] = p.axes;
  // The point of the waterplane at (x, y) of the plan has the world coordinates p0 + p1 x + p2 y,
  // q0 + q1 x + q2 y from the centroid.
  const T p0 = e3.x * p.c0, p1 = e1.x - e3.x * p.sx, p2 = e2.x - e3.x * p.sy;
  const T q0 = e3.y * p.c0, q1 = e1.y - e3.y * p.sx, q2 = e2.y - e3.y * p.sy;
  const T px = p1 * b.x + p2 * b.y, qx = q1 * b.x + q2 * b.y;
  return {T(p.upright * b.area),
          T(p.upright * (p0 * b.area + px)),
          T(p.upright * (q0 * b.area + qx)),
          T(p.upright * (p0 * (p0 * b.area + 2.0 * px) + p1 * (p1 * b.xx + p2 * b.xy) +
                         p2 * (p1 * b.xy + p2 * b.yy))),
          T(p.upright * (p0 * (q0 * b.area + qx) + q0 * px + p1 * (q1 * b.xx + q2 * b.xy) +
                         p2 * (q1 * b.xy + q2 * b.yy))),
          T(p.upright * (q0 * (q0 * b.area + 2.0 * qx) + q1 * (q1 * b.xx + q2 * b.xy) +
                         q2 * (q1 * b.xy + q2 * b.yy)))};
}

/// Whether the water cuts only the sides of a prism.
/// \param axes  principal axes in the world
/// \param z     height of the centroid over the water [m]
template <class T>
auto sides_only(const Prism<T>& b, const Triad<T>& axes, const T& z) {
  // Heights over the water of the points where axis 3 meets the end faces. The heights of the
  // corners differ from these by at most sqrt(reach2).
  const T bottom = z + axes.e3.z * b.bottom, top = z + axes.e3.z * b.top;
  const T reach2 = b.radius2 * T(axes.e1.z * axes.e1.z + axes.e2.z * axes.e2.z);
  return axes.e3.z > 0.0 && bottom < 0.0 && top > 0.0 && bottom * bottom > reach2 &&
         top * top > reach2;
}

/// A quaternion scaled to unit length. A linearised quaternion (1, theta/2) is longer than 1 and
/// would enlarge the body.
template <class T>
Quat<T> of_unit_length(const Quat<T>& q) {
  using std::sqrt;
  const T n = 1.0 / sqrt(T(T(q.w * q.w) + T(q.x * q.x)) + T(T(q.y * q.y) + T(q.z * q.z)));
  return {n * q.w, n * q.x, n * q.y, n * q.z};
}

/// Computes the submerged parts of the owned bodies of a part.
class Immersion {
 public:
  /// How the submerged parts of bodies that lie below the surface are found: by clipping, unless
  /// all of a sphere about the body is below, or by the body's lowest and highest points. The
  /// volumes differ by rounding.
  enum class Wet { by_sphere, by_points };
  /// \param part  with shapes; must outlive this object
  /// \param level  of the water, one column; empty: z = 0
  explicit Immersion(const Part& part, Wet wet = Wet::by_sphere, TimeTable level = {});

  bool has_level() const { return !level_.empty(); }
  /// Level of the water [m].
  double level(double time) const { return level_.empty() ? 0.0 : level_.value(0, time); }

  /// Submerged part of an owned body; moments are about its centroid, in world axes.
  Submerged of(const State<Spatial>& state, std::int32_t body) const;
  /// The part below another plane, exact as well, in the axes that SurfacePlane::to_level() takes
  /// the world's axes to.
  Submerged below(const State<Spatial>& state, std::int32_t body, const SurfacePlane& plane) const;
  /// The same by clipping the polyhedron, for any body.
  Submerged by_clipping(const State<Spatial>& state, std::int32_t body) const;

  /// Volumes [m^3] and moments [m^4] of the submerged parts of the bodies of a block.
  struct Lane {
    Lanes volume;
    Vec3<Lanes> moment;
  };
  /// Submerged parts of the bodies of one block. Lane k has body block * lanes + k; lanes beyond
  /// the last owned body repeat that body.
  /// \param uz  displacements of the bodies along z, over the water [m]
  /// \param q   rotations of the bodies from rest
  Lane of_block(const State<Spatial>& state, std::size_t block, const Lanes& uz,
                const Quat<Lanes>& q) const {
    const Prism<Lanes> b = blocks_[block].get();
    const Lanes z = b.z + uz;
    const PrismBelow<Lanes> p = prism_below<Lanes>(b, of_unit_length(q), z);
    Lane below{p.volume, p.moment};
    const auto good = sides_only<Lanes>(b, p.axes, z);
    if (!all_of(good)) [[unlikely]] {
      for (std::size_t lane = 0; lane < lanes; ++lane)
        if (!good[lane]) replace(state, block, lane, below);
    }
    return below;
  }
  /// The same with the waterplanes, by which the submerged parts change as bodies move.
  struct Cut {
    Lane below;
    Waterplane<Lanes> waterplane;
  };
  Cut cut_of_block(const State<Spatial>& state, std::size_t block, const Lanes& uz,
                   const Quat<Lanes>& q) const {
    const Prism<Lanes> b = blocks_[block].get();
    const Lanes z = b.z + uz;
    const PrismBelow<Lanes> p = prism_below<Lanes>(b, of_unit_length(q), z);
    Cut cut{{p.volume, p.moment}, waterplane_of<Lanes>(b, p)};
    const auto good = sides_only<Lanes>(b, p.axes, z);
    if (!all_of(good)) {
      for (std::size_t lane = 0; lane < lanes; ++lane)
        if (!good[lane]) replace(state, block, lane, cut);
    }
    return cut;
  }
  std::size_t blocks() const { return blocks_.size(); }
  /// Owned body in a lane of a block.
  std::size_t body_of(std::size_t block, std::size_t lane) const {
    return std::min(block * lanes + lane, whole_.size() - 1);
  }

  /// Height of an owned body's centroid over the water [m].
  double height(const State<Spatial>& state, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    return part_.bodies.position[b][2] + state.record(b)[2] - level(state.time);
  }
  /// Centroid of an owned body [m].
  Vec3<double> centroid(const State<Spatial>& state, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    return part_.bodies.position[b] + displacement(state, b);
  }
  /// Distance of the farthest vertex of an owned body from its centroid [m].
  double extent(std::int32_t body) const { return item(extent_, body); }
  /// Volume of an owned body [m^3].
  double volume(std::int32_t body) const { return item(whole_, body).volume; }
  /// Area of an owned body at rest seen from above [m^2].
  double plan_area(std::int32_t body) const;
  /// Volume of an owned body over that area [m]; 0 for one that no water reaches (Bodies::dry).
  double mean_thickness(std::int32_t body) const {
    return volume(body) > 0 ? volume(body) / plan_area(body) : 0;
  }
  /// Whether the surface cuts an owned body other than through its sides only.
  bool is_cut_across(const State<Spatial>& state, std::int32_t body) const;
  /// Whether an owned body is a prism along its axis 3.
  bool is_prism(std::int32_t body) const {
    return prism(static_cast<std::size_t>(body)).radius2 < std::numeric_limits<double>::infinity();
  }

 private:
  struct alignas(64) Block {
    std::array<std::array<double, lanes>, Prism<double>::numbers> values;
    template <class T>
    static Prism<T> assemble(auto at) {
      return {{at(0), at(1), at(2), at(3)},
              at(4),
              at(5),
              at(6),
              at(7),
              at(8),
              at(9),
              at(10),
              at(11),
              at(12),
              at(13)};
    }
    Prism<Lanes> get() const {
      return assemble<Lanes>([&](std::size_t k) { return load(values[k].data()); });
    }
  };
  Prism<double> prism(std::size_t body) const {
    const Block& block = blocks_[body / lanes];
    return Block::assemble<double>([&](std::size_t k) { return block.values[k][body % lanes]; });
  }
  Prism<double> find_prism(std::size_t body) const;
  Submerged placed(std::int32_t body, const Quat<double>& rotation, double z) const;
  void replace(const State<Spatial>& state, std::size_t block, std::size_t lane, Lane& below) const;
  void replace(const State<Spatial>& state, std::size_t block, std::size_t lane, Cut& cut) const;
  Submerged clipped(std::int32_t body, const Triad<double>& axes, double z) const;
  Submerged whole(std::int32_t body, const Triad<double>& axes) const;
  void place_vertices(std::int32_t body, const Triad<double>& axes) const;

  const Part& part_;
  Wet wet_;
  TimeTable level_;
  std::vector<Block> blocks_;
  std::vector<VolumeProperties> whole_;
  std::vector<double> extent_;          ///< distance of the farthest vertex from the centroid [m]
  mutable std::vector<Point3> placed_;  ///< work space of the clipping
};

/// Displacements u, velocities v and rotations q of the bodies of a block, one body per lane; u_z
/// is over the level of the water.
struct BlockMotion {
  Vec3<Lanes> u, v;
  Quat<Lanes> q;
};
/// Loads the motion of the bodies of a block into lanes.
/// \tparam with_velocity  velocities too; else they are not set
template <bool with_velocity>
BlockMotion block_motion(const Immersion& immersion, const State<Spatial>& state,
                         std::size_t block) {
  const auto four = [&](std::size_t offset) {
    return gather_four(
        [&](std::size_t lane) { return state.record(immersion.body_of(block, lane)) + offset; });
  };
  const auto a = four(0), b = four(4);
  const Lanes z = a[2] - immersion.level(state.time);
  BlockMotion m{{a[0], a[1], z}, {}, {a[3], b[0], b[1], b[2]}};
  if constexpr (with_velocity) {
    const auto c = four(8);
    m.v = {b[3], c[0], c[1]};
  }
  return m;
}

}  // namespace floe
