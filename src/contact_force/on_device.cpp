#include "contact_force/on_device.h"

#include <algorithm>
#include <tuple>

#include "active_contacts/stiffness.h"
#include "contact_force/expiry.h"

namespace floe {
namespace {

/// Whether a crush is of a pair before this one in the order of the list.
bool is_before(const Crush& crush, const Pair& pair) {
  return std::tie(crush.a, crush.b) < std::tie(pair.a, pair.b);
}

/// What lists of pairs need.
void add_listing(const Contacts& contacts, const Part& part, DeviceContacts& of) {
  const ContactOptions& options = contacts.options();
  of.reach = contacts.list().reach();
  of.young = options.young, of.young_broken = options.young_broken.value_or(options.young);
  of.friction = options.friction, of.friction_wet = options.friction_wet.value_or(options.friction);
  for (const Obstacle& o : contacts.solids().obstacles())
    of.frictions.push_back({o.friction, o.friction_wet.value_or(o.friction)});
  const Eligibility& eligibility = contacts.list().eligibility();
  for (const auto* pairs : {&eligibility.joined(), &eligibility.released()})
    for (const auto& [a, b] : *pairs)
      of.beams.push_back({part.local_index(a), part.local_index(b)});
}

/// Who may touch.
void add_eligible(const Contacts& contacts, const Part& part, DevicePairs& pairs) {
  const Eligibility& eligibility = contacts.list().eligibility();
  for (std::int32_t local = 0; local < part.owned; ++local) {
    const std::int32_t b = item(part.global, local);
    pairs.pieces.push_back(eligibility.piece(b));
    pairs.on_surface.push_back(eligibility.on_surface(b) ? 1 : 0);
    pairs.left_out.push_back(contacts.list().is_left_out(contacts.solids(), b) ? 1 : 0);
  }
  for (const auto& [a, b] : eligibility.released())
    pairs.broken.push_back({part.local_index(a), part.local_index(b)});
}

/// \param n  DevicePairs::crush
Crush crush_of(const std::array<std::int32_t, 2>& bodies,
               const std::array<double, DevicePairs::crush>& n, const Part& part) {
  const auto global = [&](std::int32_t b) { return is_obstacle(b) ? b : item(part.global, b); };
  return {.a = global(bodies[0]),
          .b = global(bodies[1]),
          .normal_a = {n[2], n[3], n[4]},
          .normal_b = {n[5], n[6], n[7]},
          .before = n[0],
          .plastic = n[1]};
}

}  // namespace

std::string missing_on_devices(const Contacts& contacts) {
  const Solids& solids = contacts.solids();
  for (const Obstacle& obstacle : solids.obstacles())
    if (obstacle.parts.size() > 1)
      return obstacle.is_ice ? "bodies of several convex parts"
                             : "obstacles of several convex parts";
  if (solids.obstacles_touch())
    return "contact of structures with other obstacles ('touches: ice' is without)";
  for (std::int32_t b = 0; b < solids.bodies(); ++b)
    if (solids.graph(b) == nullptr && !solids.carries(b))
      return "contact of bodies with more than 32 vertices or 64 edges";
  return {};
}

DeviceContacts on_device(const Contacts& contacts, const Part& part) {
  const Solids& solids = contacts.solids();
  const ContactOptions& options = contacts.options();
  const PlasticLimit& limit = options.plastic_limit;
  DeviceContacts of;
  of.potential = options.law == ContactLaw::potential;
  of.damping_ratio = options.damping_ratio;
  of.with_patch = options.damping_ratio > 0 || solids.has_friction(options);
  of.plastic_limit = {limit.pressure, limit.area, limit.exponent, limit.least,
                      limit.most,     limit.fast, limit.speed};
  of.wears = contacts.wears();
  of.periods = options.periods;
  of.slack = contacts.list().slack();
  add_listing(contacts, part, of);
  std::vector<const EdgeGraph*> graphs;
  const auto solid = [&](std::int32_t index) {
    DeviceContacts::Solid s;
    const auto vertices = solids.vertices(index);
    const auto planes = solids.planes(index);
    s.vertices.assign(vertices.begin(), vertices.end());
    s.planes.assign(planes.begin(), planes.end());
    s.radius = solids.radius(index);
    s.width = solids.width(index);
    if (is_obstacle(index)) return s;
    s.size = solids.size(index);
    const EdgeGraph* graph = solids.graph(index);  // most bodies share one with others
    if (graph != nullptr) {                        // a body that carries obstacles touches as these
      const auto known = std::find(graphs.begin(), graphs.end(), graph);
      s.graph = static_cast<std::int32_t>(known - graphs.begin());
      if (known == graphs.end()) graphs.push_back(graph), of.graphs.push_back(*graph);
    }
    const InverseInertia inverse = solids.inverse_inertia(index);
    s.inverse = {inverse.mass, inverse.moments.x, inverse.moments.y, inverse.moments.z};
    return s;
  };
  for (std::int32_t b = 0; b < part.owned; ++b) of.solids.push_back(solid(item(part.global, b)));
  of.obstacles = solids.obstacles().size();
  for (const Obstacle& o : solids.obstacles())
    of.carriers.push_back(o.is_carried() ? part.local_index(o.body) : -1);
  for (std::size_t k = 0; k < of.obstacles; ++k) of.solids.push_back(solid(part_index(k)));
  of.obstacle = [&solids](std::size_t k, double time, double before, double dt) {
    const Obstacle& obstacle = solids.obstacles()[k];
    const Placed now = place_of(obstacle, time, time - 0.5 * before);
    const ObstacleMotion& m = obstacle.motion;
    DeviceContacts::ObstacleStep numbers;
    std::size_t n = 0;
    for (const Vec3<double>& v :
         {now.x, now.axes.e1, now.axes.e2, now.axes.e3, now.velocity, now.spin, m.rate(time),
          m.spin(time), m.rate(time + 0.5 * dt), m.spin(time + 0.5 * dt)}) {
      for (const double x : {v.x, v.y, v.z}) numbers[n++] = x;
    }
    return numbers;
  };
  of.obstacle_travel = [&solids](double from, double to) {
    double most = 0;
    for (std::size_t k = 0; k < solids.obstacles().size(); ++k)
      most = std::max(most, obstacle_travel(solids, k, from, to));
    return most;
  };
  return of;
}

DevicePairs pairs_on_device(const Contacts& contacts, const Part& part) {
  const Solids& solids = contacts.solids();
  const auto local = [&](std::int32_t index) {
    return is_obstacle(index) ? index : part.local_index(index);
  };
  ContactHistory::Cursor histories(contacts.history());
  std::span<const Crush> crushed = contacts.crushing().records();  // in list order
  DevicePairs pairs;
  add_eligible(contacts, part, pairs);
  std::int32_t index = 0;
  for (const Pair& pair : contacts.list().pairs()) {
    const PairConstants dry = pair_constants(solids, contacts.options(), pair, false),
                        wet = pair_constants(solids, contacts.options(), pair, true);
    const PairHistory* memory = histories.of(index++);
    pairs.bodies.push_back({local(pair.a), local(pair.b)});
    pairs.numbers.push_back({dry.stiffness, dry.area, dry.friction, wet.friction, dry.half_space,
                             std::min(solids.width(pair.a), solids.width(pair.b))});
    pairs.histories.push_back((memory != nullptr ? *memory : PairHistory{}).as_numbers());
    pairs.states.push_back(
        static_cast<std::uint8_t>((memory != nullptr ? DevicePairs::touching : 0) |
                                  (pair.newly_eligible ? DevicePairs::stress_free : 0)));
    if (!contacts.wears()) continue;
    auto& crush = pairs.crushes.emplace_back();
    while (!crushed.empty() && is_before(crushed[0], pair)) crushed = crushed.subspan(1);
    if (crushed.empty() || crushed[0].a != pair.a || crushed[0].b != pair.b) continue;
    const Crush& c = crushed[0];
    crush = {c.before,     c.plastic,    c.normal_a.x, c.normal_a.y,
             c.normal_a.z, c.normal_b.x, c.normal_b.y, c.normal_b.z};
    pairs.states.back() |= DevicePairs::crushed;
  }
  return pairs;
}

std::vector<Crush> crushes(const DevicePairs& pairs, const Part& part) {
  std::vector<Crush> found;
  for (std::size_t k = 0; k < pairs.crushes.size(); ++k)
    if ((pairs.states[k] & DevicePairs::crushed) != 0)
      found.push_back(crush_of(pairs.bodies[k], pairs.crushes[k], part));
  return found;
}

std::vector<Crush> crushes(std::span<const PartedPair> pairs, const Part& part) {
  std::vector<Crush> found;
  for (const auto& [bodies, crush] : pairs) found.push_back(crush_of(bodies, crush, part));
  return found;
}

std::vector<WornPlane> worn_on_device(const Contacts& contacts, const Part& part,
                                      std::span<const std::int32_t> bodies) {
  std::vector<WornPlane> planes;
  for (const std::int32_t body : bodies)
    for (const HalfSpace& left : contacts.worn().of(body))
      planes.push_back({part.local_index(body), left});
  return planes;
}

std::vector<double> history_rows(const DevicePairs& pairs, const Part& part) {
  std::vector<double> rows;
  for (std::size_t k = 0; k < pairs.bodies.size(); ++k) {
    if ((pairs.states[k] & DevicePairs::touching) == 0) continue;
    for (const std::int32_t b : pairs.bodies[k])
      rows.push_back(static_cast<double>(is_obstacle(b) ? b : item(part.global, b)));
    rows.insert(rows.end(), pairs.histories[k].begin(), pairs.histories[k].end());
  }
  return rows;
}

}  // namespace floe
