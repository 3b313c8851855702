#include "contact/law.h"

#include <algorithm>
#include <cmath>

namespace floe {
namespace {

/// The stored tangential force, turned into the tangent plane of the present normal at equal size;
/// scaled down if the stiffness has fallen.
Vec3<double> carried(const PairHistory& memory, const Vec3<double>& normal, double shear) {
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
                           const PairHistory& memory, bool newly_eligible, StoredEnergy& stored) {
  ContactForce c;
  stored = {};
  c.memory = memory;
  if (newly_eligible) c.memory.plastic = o.volume;
  const double area = length(o.area);
  if (area <= 1e-12 * pair.area) {  // one body lies inside the other: no direction for a force
    c.memory.tangential = {};
    return c;
  }
  c.normal = (1 / area) * o.area;
  const bool potential = options.law == ContactLaw::potential;
  // Elastic force per volume of overlap [N/m^3].
  const double rate = potential ? pair.stiffness * area / pair.area : pair.stiffness;
  const double yield = options.plastic_limit * area;
  if (rate * (o.volume - c.memory.plastic) > yield) c.memory.plastic = o.volume - yield / rate;
  const double left = std::max(o.volume - c.memory.plastic, 0.0);
  c.elastic = rate * left;
  const double approach = -dot(motion.velocity, c.normal);
  const double dashpot = 2 * options.damping_ratio * std::sqrt(pair.mass * pair.stiffness * area);
  const double pressing = std::min(std::max(c.elastic + dashpot * approach, 0.0), yield);
  c.viscous = pressing - c.elastic;
  if (potential) {
    c.couple = (pair.stiffness * left / pair.area) * o.moment;
    stored.normal = 0.5 * pair.stiffness * left * left / pair.area;
  } else if (pair.half_space && c.memory.plastic == 0) {
    stored.normal = pair.stiffness * o.volume * depth;
  } else {
    stored.normal = 0.5 * pair.stiffness * left * left / area;
  }
  const double shear = 0.6 * pair.stiffness * area;
  Vec3<double> tangential = carried(memory, c.normal, shear);
  const double size = length(tangential), most = pair.friction * pressing;
  if (size > most) tangential = (most / size) * tangential;
  stored.tangential = 0.5 * dot(tangential, tangential) / shear;
  c.memory.shear = shear;
  c.memory.tangential = tangential;
  return c;
}

PairHistory slid(const ContactForce& contact, const RelativeMotion& motion,
                 const Vec3<double>& mean_spin, double dt) {
  PairHistory memory = contact.memory;
  const Vec3<double>& n = contact.normal;
  if (dot(n, n) == 0 || memory.shear == 0) return memory;
  const double turn = dt * dot(mean_spin, n);
  const Vec3<double> turned =
      std::cos(turn) * memory.tangential + std::sin(turn) * cross(n, memory.tangential);
  const Vec3<double> slip = motion.velocity - dot(motion.velocity, n) * n;
  memory.tangential = turned - (dt * memory.shear) * slip;
  return memory;
}

}  // namespace floe
