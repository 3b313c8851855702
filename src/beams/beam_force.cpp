#include "beams/beam_force.h"

#include "beams/planar_lanes.h"
#include "beams/spatial_lanes.h"
#include "floe/base/item.h"

namespace floe {
namespace {

template <class Beam>
std::unique_ptr<BeamForce<typename Beam::Space>> make(const Part& part,
                                                      const BeamOptions& options) {
  if (options.damping_ratio > 0) return std::make_unique<LatticeBeams<Beam, true>>(part, options);
  return std::make_unique<LatticeBeams<Beam, false>>(part, options);
}

template <class Space, Kinematics kinematics>
std::unique_ptr<BeamForce<Space>> make(const Part& part, const BeamOptions& options) {
  if constexpr (std::is_same_v<Space, Planar>) {
    return make<PlanarLanes<kinematics>>(part, options);
  } else {
    if (any_eccentric(part)) return make<SpatialLanes<kinematics, EccentricFrame>>(part, options);
    if (all_flat(part)) return make<SpatialLanes<kinematics, FlatFrame>>(part, options);
    return make<SpatialLanes<kinematics, AnyFrame>>(part, options);
  }
}

}  // namespace

Triad<double> beam_triad(const Bodies& bodies, const Beams& beams, std::int32_t m) {
  const auto k = static_cast<std::size_t>(m);
  const Vec3<double> e0 = chord(bodies, beams, m);
  const Vec3<double> e1 = (1.0 / std::sqrt(dot(e0, e0))) * e0;
  const Vec3<double>& axis = beams.axis_y[k];
  Vec3<double> e2 = axis - dot(axis, e1) * e1;
  e2 = (1.0 / std::sqrt(dot(e2, e2))) * e2;
  return {e1, e2, cross(e1, e2)};
}

bool is_flat(const Bodies& bodies, const Beams& beams, std::int32_t m) {
  constexpr double rounding = 2e-15;  // of orthonormalisation
  const auto [e1, e2, e3] = beam_triad(bodies, beams, m);
  return e1.z == 0 && std::abs(e2.z) <= rounding && std::abs(e2.x + e1.y) <= rounding &&
         std::abs(e2.y - e1.x) <= rounding;
}

BeamStiffness beam_stiffness(const Beams& beams, std::int32_t m, Shear shear) {
  const auto k = static_cast<std::size_t>(m);
  const double e = beams.young[k], l = beams.length[k], iy = beams.inertia_y[k],
               iz = beams.inertia_z[k];
  const double ga = beams.shear_modulus[k] * beams.area[k] / l, factor_z = beams.shear_factor[k],
               factor_y = beams.shear_factor_y.empty() ? factor_z : beams.shear_factor_y[k];
  // 12 E I/(l^3 (1 + Phi)) with Phi = 12 E I/(kappa G A l^2): bending and shear in series.
  const auto transverse = [&](double inertia, double factor) {
    const double bending = 12.0 * e * inertia / (l * l * l), one_point = factor * ga;
    if (shear == Shear::one_point) return one_point;
    if (shear == Shear::none) return bending;
    return bending * one_point / (bending + one_point);
  };
  return {e * beams.area[k] / l,
          transverse(iz, factor_y),
          transverse(iy, factor_z),
          beams.shear_modulus[k] * beams.torsion[k] / l,
          e * iy / l,
          e * iz / l};
}

BeamStiffness beam_damping(const Part& part, std::int32_t m, const BeamStiffness& k,
                           const BeamOptions& options) {
  const auto& ends = item(part.beams.bodies, m);
  const std::int32_t i = ends[0], j = ends[1];
  const auto harmonic = [](double a, double b) { return 2.0 * a * b / (a + b); };
  const auto dashpot = [&](double inertia, double stiffness) {
    return 2.0 * options.damping_ratio * std::sqrt(inertia * stiffness);
  };
  const double mass = harmonic(item(part.bodies.mass, i), item(part.bodies.mass, j));
  const Triad<double> t = beam_triad(part.bodies, part.beams, m);
  const auto turning = [&](const Vec3<double>& axis) {
    return harmonic(inertia_about(part.bodies, i, axis), inertia_about(part.bodies, j, axis));
  };
  if (options.damping_modes == DampingModes::axial) return {dashpot(mass, k.kn), 0, 0, 0, 0, 0};
  return {dashpot(mass, k.kn),           dashpot(mass, k.ksz),
          dashpot(mass, k.ksy),          dashpot(turning(t.e1), k.kt),
          dashpot(turning(t.e2), k.kby), dashpot(turning(t.e3), k.kbz)};
}

template <class Space>
std::unique_ptr<BeamForce<Space>> make_beam_force(const Part& part, const BeamOptions& options) {
  if (options.kinematics == Kinematics::linear)
    return make<Space, Kinematics::linear>(part, options);
  return make<Space, Kinematics::corotational>(part, options);
}

template std::unique_ptr<BeamForce<Spatial>> make_beam_force<Spatial>(const Part&,
                                                                      const BeamOptions&);
template std::unique_ptr<BeamForce<Planar>> make_beam_force<Planar>(const Part&,
                                                                    const BeamOptions&);

}  // namespace floe
