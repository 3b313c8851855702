/// \file
/// Faces of bodies that other bodies shelter from the water's flow (model.md, "Water").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lattice/archive.h"
#include "lattice/partition.h"

namespace floe {

template <class>
struct State;
struct Spatial;

/// Finds the sheltered faces of the owned bodies: those that a whole beam joins to another body,
/// and those that have another body within a distance along their normal. The second are found
/// anew, from the places of all bodies, before bodies can have moved far. Every rank holds the
/// shapes of all bodies. Obstacles, and structures that do not float, shelter nothing.
class Shelter {
 public:
  /// Collective.
  /// \param part      with shapes; must outlive this object
  /// \param distance  within which a body shelters a face [m]; 0: beams only
  Shelter(const Part& part, double distance);

  bool renews() const { return distance_ > 0; }
  /// Whether face `face` (an index of Part::shapes) is sheltered.
  bool operator()(std::int32_t face) const {
    const auto f = static_cast<std::size_t>(face);
    return joined_[f] != 0 || near_[f] != 0;
  }
  /// Finds faces near other bodies anew if it is time. Collective.
  /// \param state  of owned bodies, after a step
  void after_step(const State<Spatial>& state);
  /// Takes the beams of pairs of global bodies as broken. Collective; a rank may name other pairs.
  void release(std::span<const std::array<std::int32_t, 2>> pairs);
  /// Saves or loads which faces are sheltered, and when they are found anew. Collective.
  void persist(Archive& archive);

 private:
  /// Where a body is: centroid and principal axes.
  struct Pose {
    Vec3<double> at{};
    Quat<double> axes{1, 0, 0, 0};
  };
  void gather_shapes();
  void choose_large();
  void join_faces();
  void gather_poses(const State<Spatial>& state);
  void find_near();
  void sort_cells();
  bool any_near(std::int32_t body, const Vec3<double>& from, const Vec3<double>& along) const;
  bool hits(std::int32_t other, const Vec3<double>& from, const Vec3<double>& along) const;
  std::int64_t cell_of(const Vec3<double>& at, int dx, int dy, int dz) const;

  const Part& part_;
  double distance_;
  double next_ = 0;                   ///< time at which faces are found anew [s]
  Shapes shapes_;                     ///< of all bodies, in global order
  std::vector<Vec3<double>> normal_;  ///< outward, per face of all bodies, in the body's axes
  std::vector<Vec3<double>> middle_;  ///< mean of the corners, likewise [m]
  std::vector<double> radius_;        ///< per body: of its farthest vertex [m]
  double widest_ = 0;                 ///< the largest of them but large_ [m]
  std::vector<std::int32_t> large_;   ///< bodies in no cell
  double fastest_ = 0;                ///< speed of a point of a body [m/s]
  std::vector<Pose> poses_;           ///< of all bodies
  std::vector<std::pair<std::int64_t, std::int32_t>> cells_;  ///< cell and body, sorted
  /// Per face of the owned bodies: number of whole beams, and whether a body is near.
  std::vector<std::uint8_t> joined_, near_;
  struct Joint {
    std::array<std::int32_t, 2> pair;  ///< global bodies
    std::int32_t face;                 ///< of an owned body
  };
  std::vector<Joint> joints_;  ///< sorted by pair
};

/// Unit outward normals of all faces, in the axes of their bodies.
std::vector<Vec3<double>> face_normals(const Shapes& shapes);

}  // namespace floe
