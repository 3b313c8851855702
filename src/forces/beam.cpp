#include "floe/forces/beam.h"

#include "forces/spatial_beams.h"

namespace floe {
namespace {

template <Kinematics kinematics>
std::unique_ptr<BeamForce<Spatial>> make_spatial(const Part& part, const BeamOptions& options) {
  const bool damped = options.damping_ratio > 0;
  if (is_flat(part)) {
    if (damped) return std::make_unique<SpatialBeams<kinematics, true, FlatFrame>>(part, options);
    return std::make_unique<SpatialBeams<kinematics, false, FlatFrame>>(part, options);
  }
  if (damped) return std::make_unique<SpatialBeams<kinematics, true, AnyFrame>>(part, options);
  return std::make_unique<SpatialBeams<kinematics, false, AnyFrame>>(part, options);
}

/// Moment of inertia at rest of a local body about a world axis.
double inertia_about(const Part& part, std::int32_t body, const Vec3<double>& axis) {
  const auto b = static_cast<std::size_t>(body);
  const auto [w, x, y, z] = part.bodies.orientation[b];
  const Vec3<double> a = triad(Quat<double>{w, x, y, z}).to_local(axis);
  const Point3& inertia = part.bodies.inertia[b];
  return inertia[0] * a.x * a.x + inertia[1] * a.y * a.y + inertia[2] * a.z * a.z;
}

}  // namespace

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
  const auto [i, j] = part.beams.bodies[static_cast<std::size_t>(m)];
  const auto harmonic = [](double a, double b) { return 2.0 * a * b / (a + b); };
  const auto dashpot = [&](double inertia, double stiffness) {
    return 2.0 * options.damping_ratio * std::sqrt(inertia * stiffness);
  };
  const double mass = harmonic(part.bodies.mass[static_cast<std::size_t>(i)],
                               part.bodies.mass[static_cast<std::size_t>(j)]);
  const Triad<double> t = beam_triad(part, m);
  const auto turning = [&](const Vec3<double>& axis) {
    return harmonic(inertia_about(part, i, axis), inertia_about(part, j, axis));
  };
  if (options.damping_modes == DampingModes::axial) return {dashpot(mass, k.kn), 0, 0, 0, 0, 0};
  return {dashpot(mass, k.kn),           dashpot(mass, k.ksz),
          dashpot(mass, k.ksy),          dashpot(turning(t.e1), k.kt),
          dashpot(turning(t.e2), k.kby), dashpot(turning(t.e3), k.kbz)};
}

template <class Space>
std::unique_ptr<BeamForce<Space>> make_beam_force(const Part& part, const BeamOptions& options) {
  if (options.kinematics == Kinematics::linear)
    return make_spatial<Kinematics::linear>(part, options);
  return make_spatial<Kinematics::corotational>(part, options);
}

template std::unique_ptr<BeamForce<Spatial>> make_beam_force<Spatial>(const Part&,
                                                                      const BeamOptions&);

}  // namespace floe
