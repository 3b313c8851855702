/// \file
/// The submerged part of each body, below the level of the water: exact at any place and tilt
/// (model.md, "Water").
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
#include "submersion/below_water.h"
#include "submersion/prism.h"
#include "submersion/surface.h"

namespace floe {

/// Computes the submerged parts of the owned bodies of a part.
class Immersion {
 public:
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
    return floe::is_prism(prism(static_cast<std::size_t>(body)));
  }

  Wet wet() const { return wet_; }
  Prism<double> prism(std::size_t body) const {
    const Block& block = blocks_[body / lanes];
    return Block::assemble<double>([&](std::size_t k) { return block.values[k][body % lanes]; });
  }
  /// Volume and centroid of an owned body, in its own axes from their origin.
  const VolumeProperties& all_of_body(std::int32_t body) const { return item(whole_, body); }

 private:
  struct Placed;
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
  Prism<double> find_prism(std::size_t body) const;
  Submerged placed(std::int32_t body, const Quat<double>& rotation, double z) const;
  void replace(const State<Spatial>& state, std::size_t block, std::size_t lane, Lane& below) const;
  void replace(const State<Spatial>& state, std::size_t block, std::size_t lane, Cut& cut) const;
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
