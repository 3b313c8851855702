#include "floe/forces/buoyancy.h"

#include <algorithm>
#include <vector>

#include "floe/base/petsc.h"

namespace floe {
namespace {

/// With r from the body's centroid, V the submerged part and W its cut by the water (areas and
/// moments of both are in Submerged): force rho g V, moment rho g (m_y, -m_x, 0), m = int_V r dV,
/// and by Reynolds' theorem
///   delta int_V f dV = int_V delta f dV - int_W f (u_z + t_x r_y - t_y r_x) dA   for a spin t.
class Buoyancy final : public Force<Spatial> {
 public:
  Buoyancy(const Part& part, double weight_density) : part_(part), weight_(weight_density) {
    if (part.shapes.empty() && part.owned > 0)
      throw InputError(
          "forces: buoyancy needs bodies with a shape; the lattice file has no /shapes");
  }

  std::string_view name() const override { return "buoyancy"; }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) const override {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const Submerged s = below_water(state, body);
      double* w = wrenches.of(static_cast<std::size_t>(body));
      w[2] += weight_ * s.volume;
      w[3] += weight_ * s.moment[1];
      w[4] -= weight_ * s.moment[0];
    }
  }

  bool add_tangent(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const Submerged s = below_water(state, body);
      Tangent<Spatial>::Block k{};
      const auto at = [&k](int row, int column) -> double& {
        return k[static_cast<std::size_t>(row * 6 + column)];
      };
      at(2, 2) = weight_ * s.waterplane;
      at(2, 3) = at(3, 2) = weight_ * s.wy;
      at(2, 4) = at(4, 2) = -weight_ * s.wx;
      at(3, 3) = weight_ * (s.wyy + s.moment[2]);
      at(4, 4) = weight_ * (s.wxx + s.moment[2]);
      at(3, 4) = at(4, 3) = -weight_ * s.wxy;
      // The exact derivative to t_z stands in the last column only; half of it in each is the
      // Hessian.
      const double share = tangent.symmetric() ? 0.5 : 1.0;
      at(3, 5) = -share * weight_ * s.moment[0];
      at(4, 5) = -share * weight_ * s.moment[1];
      if (tangent.symmetric()) {
        at(5, 3) = at(3, 5);
        at(5, 4) = at(4, 5);
      }
      tangent.add_body(body, k);
    }
    return true;
  }

  double stiffness_bound(std::int32_t body) const override {
    // The cut of a convex body by a plane is at most three times its mean cut, volume over height
    // (a cone's base).
    double low = 0, high = 0;
    const auto b = static_cast<std::size_t>(body);
    for (std::int32_t v = part_.shapes.vertex_of[b]; v < part_.shapes.vertex_of[b + 1]; ++v) {
      low = std::min(low, part_.shapes.vertices[static_cast<std::size_t>(v)][2]);
      high = std::max(high, part_.shapes.vertices[static_cast<std::size_t>(v)][2]);
    }
    return 3.0 * weight_ * volume_properties(part_.shapes, body).volume / (high - low);
  }

  /// Potential of the displaced water: rho g times int_V (-z) dV, the work to push the body down
  /// from the air.
  void report(const State<Spatial>& state, Columns& columns) const override {
    double energy = 0;
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const Submerged s = below_water(state, body);
      const auto b = static_cast<std::size_t>(body);
      const double z = part_.bodies.position[b][2] + displacement(state, b).z;
      energy -= weight_ * (s.moment[2] + z * s.volume);
    }
    columns.add("energy_water", energy);
  }

 private:
  Submerged below_water(const State<Spatial>& state, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    const auto [w, x, y, z] = part_.bodies.orientation[b];
    // A linearised quaternion (1, theta/2) is longer than 1 and would swell the body.
    const Triad<double> axes =
        triad(product(normalised(rotation(state, b)), Quat<double>{w, x, y, z}));
    const Shapes& shapes = part_.shapes;
    placed_.clear();
    for (std::int32_t v = shapes.vertex_of[b]; v < shapes.vertex_of[b + 1]; ++v) {
      const Point3& r = shapes.vertices[static_cast<std::size_t>(v)];
      const Vec3<double> p = axes.to_world({r[0], r[1], r[2]});
      placed_.push_back({p.x, p.y, p.z});
    }
    const double centre = part_.bodies.position[b][2] + displacement(state, b).z;
    return submerged(shapes, body, placed_, -centre);
  }

  const Part& part_;
  double weight_;
  mutable std::vector<Point3> placed_;  ///< work space of below_water
};

}  // namespace

template <>
std::unique_ptr<Force<Spatial>> make_buoyancy<Spatial>(const Part& part, double weight_density) {
  return std::make_unique<Buoyancy>(part, weight_density);
}

}  // namespace floe
