#include "floe/contact/law.h"

#include <algorithm>
#include <cmath>

namespace floe {
namespace {

double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

/// The stored force in the tangent plane of today's normal, as long as it was; falls with the
/// stiffness.
Vec3<double> carried(const PairMemory& memory, const Vec3<double>& normal, double shear) {
  const Vec3<double>& f = memory.tangential;
  const double before = length(f);
  if (before == 0) return {};
  const Vec3<double> in_plane = f - dot(f, normal) * normal;
  const double size = length(in_plane);
  if (size == 0) return {};
  const double falls = shear < memory.shear ? shear / memory.shear : 1.0;
  return (falls * before / size) * in_plane;
}

}  // namespace

double damping_ratio_of(double restitution) {
  const auto returned = [](double zeta) {
    const double s = 1 - zeta * zeta;
    if (std::abs(s) < 1e-12) return std::exp(-2.0);
    return s > 0 ? std::exp(-2 * zeta * std::acos(zeta) / std::sqrt(s))
                 : std::exp(-2 * zeta * std::acosh(zeta) / std::sqrt(-s));
  };
  double low = 0, high = 1;
  while (returned(high) > restitution) high *= 2;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (returned(middle) > restitution ? low : high) = middle;
  }
  return restitution >= 1 ? 0.0 : 0.5 * (low + high);
}

ContactForce contact_force(const ContactOptions& options, const PairConstants& pair,
                           const Overlap& o, double depth, const RelativeMotion& motion,
                           const PairMemory& memory, bool fresh) {
  ContactForce c;
  c.memory = memory;
  if (fresh) c.memory.plastic = o.volume;
  const double area = length(o.area);
  if (area <= 1e-12 * pair.area) {  // one lies inside the other: there is no way out to prefer
    c.memory.tangential = {};
    return c;
  }
  const Vec3<double> normal = (1 / area) * o.area;
  const bool potential = options.law == ContactLaw::potential;
  // Elastic force per volume of overlap [N/m^3].
  const double rate = potential ? pair.stiffness * area / pair.area : pair.stiffness;
  const double yield = options.plastic_limit * area;
  if (rate * (o.volume - c.memory.plastic) > yield) c.memory.plastic = o.volume - yield / rate;
  const double left = std::max(o.volume - c.memory.plastic, 0.0);
  const double elastic = rate * left;
  const double approach = -dot(motion.velocity, normal);
  const double dashpot = 2 * options.damping_ratio * std::sqrt(pair.mass * pair.stiffness * area);
  const double pressing = std::min(std::max(elastic + dashpot * approach, 0.0), yield);
  c.elastic = elastic * normal;
  c.viscous = (pressing - elastic) * normal;
  if (potential) {
    c.couple = (pair.stiffness * left / pair.area) * o.moment;
    c.normal_energy = 0.5 * pair.stiffness * left * left / pair.area;
  } else if (pair.half_space && c.memory.plastic == 0) {
    c.normal_energy = pair.stiffness * o.volume * depth;
  } else {
    c.normal_energy = 0.5 * pair.stiffness * left * left / area;
  }
  const double shear = 0.6 * pair.stiffness * area;
  c.tangential = carried(memory, normal, shear);
  const double size = length(c.tangential), most = pair.friction * pressing;
  if (size > most) c.tangential = (most / size) * c.tangential;
  c.tangential_energy = 0.5 * dot(c.tangential, c.tangential) / shear;
  c.memory.normal = normal;
  c.memory.shear = shear;
  c.memory.tangential = c.tangential;
  return c;
}

void slide(PairMemory& memory, const RelativeMotion& motion, const Vec3<double>& mean_spin,
           double dt) {
  const Vec3<double>& n = memory.normal;
  if (memory.shear == 0) return;
  const double turn = dt * dot(mean_spin, n);
  const Vec3<double> turned =
      std::cos(turn) * memory.tangential + std::sin(turn) * cross(n, memory.tangential);
  const Vec3<double> slip = motion.velocity - dot(motion.velocity, n) * n;
  memory.tangential = turned - (dt * memory.shear) * slip;
}

}  // namespace floe
