#include "contact/surface_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "base/format.h"
#include "contact/part_faces.h"
#include "floe/base/petsc.h"
#include "geometry/convex_polygon.h"

namespace floe {
namespace {

using Polygon = SurfacePatch::Polygon;

/// The squares in a plane.
struct Squares {
  HalfSpace plane;
  Vec3<double> across, up;  ///< unit vectors in the plane
  double size, lift;        ///< of the squares; height of z = 0 along `up` [m]

  Squares(const HalfSpace& of, double squares, double height_of_water) : plane(of), size(squares) {
    const Vec3<double>& n = plane.normal;
    const Vec3<double> vertical{0, 0, 1};
    const double level = std::sqrt(n.x * n.x + n.y * n.y);
    constexpr double flat = 1e-6;
    if (level < flat) {
      across = {1, 0, 0};
      up = cross(n, across);
      lift = -0.5 * size;
    } else {
      across = (1 / level) * cross(vertical, n);
      up = cross(n, across);
      lift = (height_of_water - plane.offset * n.z) / level;
    }
  }
  /// Returns where a point is, in squares.
  std::array<double, 2> at(const Vec3<double>& r) const {
    return {dot(across, r) / size + 0.5, (dot(up, r) - lift) / size};
  }
  /// Cuts a polygon of the plane down to a square.
  void cut_to(Polygon& polygon, std::int32_t i, std::int32_t j, Polygon& work) const {
    const double low = size * (i - 0.5), bottom = lift + size * j;
    cut(polygon, {-1.0 * across, -low}, work);
    cut(polygon, {across, low + size}, work);
    cut(polygon, {-1.0 * up, -bottom}, work);
    cut(polygon, {up, bottom + size}, work);
  }
};

/// Adds area and centre of a polygon, times a weight.
void add(SurfacePatch& patch, const Polygon& polygon, double weight) {
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Vec3<double>&a = polygon[0], &b = polygon[k], &c = polygon[k + 1];
    const double area = weight * 0.5 * length(cross(b - a, c - a));
    patch.area += area;
    patch.centre = patch.centre + (area / 3) * (a + b + c);
  }
}

/// All patches of an obstacle, by plane and square.
class Cutting {
 public:
  Cutting(const Obstacle& obstacle, double size) : obstacle_(obstacle), size_(size) {}

  /// Shares a polygon out to the patches of its plane. \param covers  it is where two parts meet
  void add(const HalfSpace& plane, const Polygon& polygon, bool covers) {
    const std::size_t k = place_of(plane);
    const Squares& squares = planes_[k];
    std::array<double, 2> low{1e300, 1e300}, high{-1e300, -1e300};
    for (const Vec3<double>& r : polygon) {
      const auto at = squares.at(r);
      for (std::size_t c = 0; c < 2; ++c)
        low[c] = std::min(low[c], at[c]), high[c] = std::max(high[c], at[c]);
    }
    constexpr double most = 1e6;
    if ((high[0] - low[0] + 1) * (high[1] - low[1] + 1) + static_cast<double>(patches_.size()) >
        most)
      throw InputError("output: pressure_patch: " + text(size_) + " [m] makes more than " +
                       text(most) + " patches on obstacle '" + obstacle_.name + "'");
    constexpr double edge = 1e-9;  // of a square
    const auto first = [&](std::size_t c) {
      return static_cast<std::int32_t>(std::floor(low[c] + edge));
    };
    const auto last = [&](std::size_t c) {
      return static_cast<std::int32_t>(std::floor(high[c] - edge));
    };
    for (std::int32_t i = first(0); i <= last(0); ++i) {
      for (std::int32_t j = first(1); j <= last(1); ++j) {
        Polygon piece = polygon;
        squares.cut_to(piece, i, j, work_);
        if (piece.size() < 3) continue;
        SurfacePatch& patch = patches_[{k, i, j}];
        patch.normal = squares.plane.normal;
        floe::add(patch, piece, covers ? -1 : 1);
        (covers ? patch.covered : patch.pieces).push_back(std::move(piece));
      }
    }
  }

  std::vector<SurfacePatch> done() {
    constexpr double speck = 1e-6;  // of a square
    std::vector<SurfacePatch> found;
    for (auto& [key, patch] : patches_) {
      if (patch.area <= speck * size_ * size_) continue;
      patch.centre = (1 / patch.area) * patch.centre;
      const Squares& squares = planes_[std::get<0>(key)];
      std::array<double, 2> low{1e300, 1e300}, high{-1e300, -1e300};
      for (const Polygon& piece : patch.pieces) {
        for (const Vec3<double>& r : piece) {
          patch.radius = std::max(patch.radius, length(r - patch.centre));
          const auto at = squares.at(r);
          for (std::size_t c = 0; c < 2; ++c)
            low[c] = std::min(low[c], at[c]), high[c] = std::max(high[c], at[c]);
        }
      }
      patch.width = size_ * (high[0] - low[0]);
      patch.height = size_ * (high[1] - low[1]);
      found.push_back(std::move(patch));
    }
    return found;
  }

 private:
  std::size_t place_of(const HalfSpace& plane) {
    const double near = 1e-9 * obstacle_.radius();
    const auto known = std::find_if(planes_.begin(), planes_.end(), [&](const Squares& squares) {
      return is_same(squares.plane, plane, near);
    });
    if (known != planes_.end()) return static_cast<std::size_t>(known - planes_.begin());
    planes_.emplace_back(plane, size_, -obstacle_.point.z);
    return planes_.size() - 1;
  }

  const Obstacle& obstacle_;
  double size_;
  std::vector<Squares> planes_;
  std::map<std::tuple<std::size_t, std::int32_t, std::int32_t>, SurfacePatch> patches_;
  Polygon work_;
};

}  // namespace

std::vector<SurfacePatch> surface_patches(const Obstacle& obstacle, double size) {
  const double near = 1e-9 * obstacle.radius();
  Cutting cutting(obstacle, size);
  for (const ConvexPart& part : obstacle.parts) {
    for (const HalfSpace& plane : different_planes(part, near)) {
      const Polygon face = face_in(part, plane, near);
      if (face.empty()) continue;
      cutting.add(plane, face, false);
      const auto is_in_plane = [&, &plane = plane](const Vec3<double>& r) {
        return std::abs(dot(r, plane.normal) - plane.offset) < near;
      };
      for (const InnerFace& inner : part.inner_faces)
        if (dot(area_vector(inner.corners), plane.normal) > 0 &&
            std::all_of(inner.corners.begin(), inner.corners.end(), is_in_plane))
          cutting.add(plane, inner.corners, true);
    }
  }
  return cutting.done();
}

double area_inside(const SurfacePatch& patch, std::span<const HalfSpace> planes, Polygon& polygon,
                   Polygon& work) {
  double area = 0;
  const auto add = [&](const std::vector<Polygon>& polygons, double weight) {
    for (const Polygon& whole : polygons) {
      polygon = whole;
      for (const HalfSpace& plane : planes) {
        if (polygon.size() < 3) break;
        cut(polygon, plane, work);
      }
      if (polygon.size() > 2) area += weight * length(area_vector(polygon));
    }
  };
  add(patch.pieces, 1);
  add(patch.covered, -1);
  return std::max(area, 0.0);
}

}  // namespace floe
