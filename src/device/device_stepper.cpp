#include "device/device_stepper.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/collectives.h"
#include "floe/base/item.h"

namespace floe::device {
namespace {

/// What the engines have, for messages.
constexpr auto they_have =
    "it has beams, also those that break, gravity, loads, boundaries, buoyancy and drag in water "
    "without waves, "
    "and contact of convex bodies with each other and with convex obstacles and structures";

/// Returns what a user calls a force that a back end does not have.
std::string in_words(std::string_view force, const Model<Spatial>& model) {
  if (force == "line") return "mooring lines";
  if (force == "far_edge") return "supply: pressure";
  if (force == "program" || force == "applied") return "forces of programs";
  if (force == "beam")
    return model.kinematics() == Kinematics::linear ? "linear beams"
                                                    : "fracture: propagation: energy";
  if (force == "buoyancy") return "waves";
  if (force == "drag") return "water: drag: faces";
  return "force '" + std::string(force) + "' with its options";
}

/// Does work of an engine, whose errors end the run.
template <class Work>
auto of_engine(Work&& work) {
  try {
    return work();
  } catch (const Failed& error) {
    throw RunFailed(error.what());
  }
}

void add_beams(const DeviceModel& numbers, const std::vector<std::int32_t>& place,
               Lattice& lattice) {
  lattice.damped = numbers.damped;
  for (const DeviceModel::Beam& beam : numbers.beams) {
    lattice.ends.push_back({item(place, beam.bodies[0]), item(place, beam.bodies[1])});
    std::array<double, Lattice::of_beam> all{};
    auto at = std::copy(beam.triad.begin(), beam.triad.end(), all.begin());
    at = std::copy(beam.offsets.begin(), beam.offsets.end(), at);
    *at++ = beam.length;
    at = std::copy(beam.stiffness.begin(), beam.stiffness.end(), at);
    std::copy(beam.dashpots.begin(), beam.dashpots.end(), at);
    lattice.beams.push_back(all);
    const auto& t = beam.triad;
    // As FlatFrame has it, to the last bit.
    lattice.flat = lattice.flat && t[2] == 0 && t[5] == 0 && t[6] == 0 && t[7] == 0 && t[8] == 1 &&
                   t[3] == -t[1] && t[4] == t[0];
    lattice.eccentric = lattice.eccentric || std::any_of(beam.offsets.begin(), beam.offsets.end(),
                                                         [](double o) { return o != 0; });
  }
}

void add_held(const Model<Spatial>& model, const std::vector<std::int32_t>& place,
              Lattice& lattice) {
  std::vector<std::int32_t> rows(place.size(), -1);
  const auto& boundaries = model.boundaries();
  const std::span<const std::uint8_t> bits = model.prescribed();
  lattice.motions = static_cast<std::int32_t>(6 * boundaries.size());
  for (std::size_t n = 0; n < boundaries.size(); ++n) {
    for (const std::int32_t body : boundaries[n].bodies) {
      std::int32_t& row = item(rows, body);
      if (row < 0) {
        row = static_cast<std::int32_t>(lattice.held.size());
        lattice.held.push_back({item(place, body), item(bits, body), {-1, -1, -1, -1, -1, -1}});
      }
      for (std::size_t k = 0; k < 6; ++k) {
        if (boundaries[n].boundary.fixed[k])
          item(lattice.held, row).motions[k] = static_cast<std::int32_t>(6 * n + k);
      }
    }
  }
}

void add_loads(const DeviceModel& numbers, const std::vector<std::int32_t>& place,
               Lattice& lattice) {
  lattice.loads = static_cast<std::int32_t>(numbers.loads.size());
  for (std::int32_t l = 0; l < lattice.loads; ++l) {
    const DeviceModel::Load& load = item(numbers.loads, l);
    for (const std::int32_t body : load.bodies)
      lattice.loaded.push_back({item(place, body), l, {load.arm.x, load.arm.y, load.arm.z}});
  }
  std::stable_sort(lattice.loaded.begin(), lattice.loaded.end(),
                   [](const auto& a, const auto& b) { return a.body < b.body; });
}

/// Appends the shape of a body.
void add_shape(const Shapes& shapes, std::int32_t body, Water& water) {
  const std::int32_t first = item(shapes.vertex_of, body), end = item(shapes.vertex_of, body + 1);
  const std::int32_t before = water.first_vertex.back();
  for (std::int32_t v = first; v < end; ++v) {
    const Point3& x = item(shapes.vertices, v);
    water.vertices.push_back({x.x, x.y, x.z});
  }
  for (std::int32_t f = item(shapes.face_of, body); f < item(shapes.face_of, body + 1); ++f) {
    for (std::int32_t c = item(shapes.corner_of, f); c < item(shapes.corner_of, f + 1); ++c)
      water.corners.push_back(before + item(shapes.corners, c) - first);
    water.first_corner.push_back(static_cast<std::int32_t>(water.corners.size()));
  }
  water.first_vertex.push_back(before + end - first);
  water.first_face.push_back(static_cast<std::int32_t>(water.first_corner.size()) - 1);
}

Water in_order(const DeviceWater& of, const std::vector<std::int32_t>& order) {
  Water water;
  water.weight_density = of.weight_density;
  water.linear = of.linear, water.coefficient = of.coefficient;
  water.drags = of.drag_work.has_value();
  water.level_moves = of.buoyancy_work.has_value();
  water.by_points = of.by_points;
  water.pace = of.pace;
  for (const std::int32_t b : order) {
    water.prisms.push_back(item(of.prisms, b));
    water.wholes.push_back(item(of.wholes, b));
    water.extents.push_back(item(of.extents, b));
    water.most2.push_back(item(of.most2, b));
    if (water.drags) water.area_per_volume.push_back(item(of.area_per_volume, b));
    add_shape(*of.shapes, b, water);
  }
  return water;
}

Listing listing_of(const DeviceContacts& of, const Part& part,
                   const std::vector<std::int32_t>& order, const std::vector<std::int32_t>& place) {
  Listing l;
  l.reach = of.reach;
  l.young = of.young, l.young_broken = of.young_broken;
  l.friction = of.friction, l.friction_wet = of.friction_wet;
  l.frictions = of.frictions;
  for (const std::int32_t b : order) {
    l.sizes.push_back(item(of.solids, b).size);
    l.widths.push_back(item(of.solids, b).width);
    l.ranks.push_back(item(part.global, b));
  }
  for (std::size_t k = 0; k < of.obstacles; ++k)
    l.widths.push_back(of.solids[order.size() + k].width);
  for (const auto& [a, b] : of.beams) l.beams.push_back({item(place, a), item(place, b)});
  return l;
}

Contacts in_order(const DeviceContacts& of, const Part& part,
                  const std::vector<std::int32_t>& order, const std::vector<std::int32_t>& place) {
  Contacts c;
  c.potential = of.potential, c.with_patch = of.with_patch, c.wears = of.wears;
  c.damping_ratio = of.damping_ratio, c.plastic_limit = of.plastic_limit;
  c.periods = {of.periods.length.x, of.periods.length.y, of.periods.length.z};
  c.slack = of.slack;
  c.obstacles = static_cast<std::int32_t>(of.obstacles);
  c.graphs = of.graphs;
  const auto add = [&](const DeviceContacts::Solid& solid) {
    for (const Vec3<double>& x : solid.vertices) c.vertices.push_back({x.x, x.y, x.z});
    c.planes.insert(c.planes.end(), solid.planes.begin(), solid.planes.end());
    c.first_vertex.push_back(static_cast<std::int32_t>(c.vertices.size()));
    c.first_plane.push_back(static_cast<std::int32_t>(c.planes.size()));
    c.graph.push_back(solid.graph);
    c.radius.push_back(solid.radius);
  };
  for (const std::int32_t b : order) {
    add(item(of.solids, b));
    c.inverse.push_back(item(of.solids, b).inverse);
    const Point3& x = item(part.bodies.position, b);
    c.rest.push_back({x.x, x.y, x.z});
  }
  for (std::size_t k = 0; k < of.obstacles; ++k) add(of.solids[order.size() + k]);
  c.listing = listing_of(of, part, order, place);
  for (const std::int32_t b : of.carriers) c.carriers.push_back(b < 0 ? -1 : item(place, b));
  return c;
}

}  // namespace

DescribedModel describe(const Model<Spatial>& model, const std::string& backend) {
  const Part& part = model.part();
  const auto refuse = [&](const std::string& what) {
    throw InputError("backend: " + backend + " has no " + what + " yet: " + they_have +
                     "; backend: cpu has all");
  };
  if (size(part.comm) > 1) refuse("runs on several ranks");
  if (!model.added_inertia().empty()) refuse("obstacle: NAME: added_mass");
  DescribedModel described;
  DeviceModel& numbers = described.numbers;
  for (const auto& force : model.forces()) {
    const Roles<Spatial> roles = force->roles();
    if (roles.device == nullptr) refuse(in_words(force->name(), model));
    roles.device->describe(numbers);
    if (!numbers.missing.empty()) refuse(numbers.missing);
    if (roles.work != nullptr) numbers.next_work += roles.work->works();
  }

  Lattice& lattice = described.lattice;
  lattice.bodies = part.owned;
  described.order = hilbert_order(part.bodies.position);
  std::vector<std::int32_t> place(described.order.size());
  for (std::int32_t d = 0; d < lattice.bodies; ++d) {
    const std::int32_t b = item(described.order, d);
    item(place, b) = d;
    const Point3& inertia = item(part.bodies.inertia, b);
    const auto [w, x, y, z] = item(part.bodies.orientation, b);
    lattice.constants.push_back({1 / item(model.inertial_mass(), b), 1 / inertia.x, 1 / inertia.y,
                                 1 / inertia.z, w, x, y, z});
    if (!numbers.weights.empty()) lattice.weights.push_back(item(numbers.weights, b));
  }
  add_beams(numbers, place, lattice);
  add_held(model, place, lattice);
  add_loads(numbers, place, lattice);
  for (const DeviceModel::Support& one : numbers.supports)
    lattice.supports.push_back(
        {item(place, one.body), {one.arm.x, one.arm.y, one.arm.z}, one.stiffness, one.damping});
  if (numbers.water) lattice.water = in_order(*numbers.water, described.order);
  if (const auto& b = numbers.breaking)
    lattice.breaking = Breaking{b->general, b->crushes, b->beams, b->limits};
  if (numbers.contacts)
    lattice.contacts = in_order(*numbers.contacts, part, described.order, place);
  lattice.halts_at_breaks = numbers.contacts && numbers.breaking;
  described.place = std::move(place);
  return described;
}

DeviceStepper::DeviceStepper(const Model<Spatial>& model, DescribedModel described,
                             std::unique_ptr<Engine> engine)
    : model_(model),
      described_(std::move(described)),
      engine_(std::move(engine)),
      room_(described_.order.size() * Engine::record),
      listed_(static_cast<std::size_t>(model.part().local)) {
  static_assert(Engine::record == Spatial::record);
}

void DeviceStepper::put(const State<Spatial>& state, const WorkParts& works) {
  works_ = works;
  of_engine([&] {
    engine_->forget_works(0);
    engine_->put_works(0, works.since);
  });
  constexpr std::size_t n = Engine::record;
  for (std::size_t d = 0; d < described_.order.size(); ++d)
    std::copy_n(state.record(static_cast<std::size_t>(described_.order[d])), n, &room_[d * n]);
  of_engine([&] { engine_->put(0, room_); });
  if (const auto& breaking = described_.numbers.breaking) {
    Damage damage;
    breaking->kept->read(damage.cracks, damage.viscous);
    of_engine([&] { engine_->put_damage(0, damage); });
    std::vector<std::array<std::int32_t, 2>> known;
    broken_.assign(described_.numbers.beams.size(), 0);
    note_broken(damage.cracks, known);
  }
  if (const auto& contacts = described_.numbers.contacts) {
    std::vector<double> forces;
    for (const auto& of : contacts->kept->obstacle_forces())
      forces.insert(forces.end(), of.begin(), of.end());
    of_engine([&] { engine_->put_obstacles(0, forces); });
    if (contacts->wears) put_worn(contacts->kept->worn());
    list_pairs(state);
  }
  const KeptParts* kept = kept_parts();
  if (kept == nullptr) return;
  kept->read(kept_, since_);
  std::vector<double> ordered(kept_.size());
  for (std::size_t d = 0; d < described_.order.size(); ++d)
    std::copy_n(&kept_[static_cast<std::size_t>(described_.order[d]) * of_kept], of_kept,
                &ordered[d * of_kept]);
  of_engine([&] { engine_->put_submerged(0, ordered); });
}

void DeviceStepper::get_records(State<Spatial>& state) {
  constexpr std::size_t n = Engine::record;
  of_engine([&] { engine_->get(0, room_); });
  for (std::size_t d = 0; d < described_.order.size(); ++d)
    std::copy_n(&room_[d * n], n, state.record(static_cast<std::size_t>(described_.order[d])));
}

/// Makes the list of pairs for a state, which the engine has.
void DeviceStepper::list_pairs(const State<Spatial>& state) {
  const DeviceContacts& contacts = *described_.numbers.contacts;
  pairs_ = contacts.kept->list(state);
  listed_at_ = state.time;
  Pairs pairs{{}, pairs_.numbers, pairs_.histories, pairs_.states, pairs_.crushes, eligible()};
  const auto solid = [&](std::int32_t index) {
    return index >= 0 ? item(described_.place, index)
                      : static_cast<std::int32_t>(described_.place.size()) - 1 - index;
  };
  for (const auto& [a, b] : pairs_.bodies) pairs.solids.push_back({solid(a), solid(b)});
  of_engine([&] { engine_->put_pairs(0, std::move(pairs)); });
}

/// Who may touch, of the list of pairs.
Eligible DeviceStepper::eligible() const {
  Eligible of;
  for (const std::int32_t b : described_.order) {
    of.pieces.push_back(item(pairs_.pieces, b));
    of.states.push_back(
        static_cast<std::uint8_t>((item(pairs_.on_surface, b) != 0 ? Eligible::on_surface : 0) |
                                  (item(pairs_.left_out, b) != 0 ? Eligible::left_out : 0)));
  }
  for (const auto& [a, b] : pairs_.broken)
    of.broken.push_back({item(described_.place, a), item(described_.place, b)});
  return of;
}

void DeviceStepper::put_worn(const std::vector<floe::WornPlane>& planes) {
  std::vector<WornPlane> ordered;
  for (const auto& [body, left] : planes) ordered.push_back({item(described_.place, body), left});
  if (!ordered.empty()) of_engine([&] { engine_->put_worn(0, ordered); });
}

/// Wears bodies off by the contacts that have parted in the last step.
void DeviceStepper::wear_bodies() {
  std::vector<PartedPair> parted;
  for (const auto& [solids, crush] : of_engine([&] { return engine_->get_parted(0); }))
    parted.push_back({{body_or_obstacle(solids[0]), body_or_obstacle(solids[1])}, crush});
  put_worn(described_.numbers.contacts->kept->wear(parted));
}

/// What the model calls a solid of the engine.
std::int32_t DeviceStepper::body_or_obstacle(std::int32_t solid) const {
  const auto bodies = static_cast<std::int32_t>(described_.order.size());
  return solid < bodies ? item(described_.order, solid) : bodies - 1 - solid;
}

/// Brings the pairs, with histories and states.
void DeviceStepper::get_pairs() {
  Pairs now;
  of_engine([&] { engine_->get_pairs(0, now); });
  pairs_.bodies.clear();
  for (const auto& [a, b] : now.solids)
    pairs_.bodies.push_back({body_or_obstacle(a), body_or_obstacle(b)});
  pairs_.numbers = std::move(now.numbers);
  pairs_.histories = std::move(now.histories);
  pairs_.states = std::move(now.states);
  pairs_.crushes = std::move(now.crushes);
}

/// Hands what the engine has of contacts back to the processor.
void DeviceStepper::keep_contacts() {
  const DeviceContacts& contacts = *described_.numbers.contacts;
  get_pairs();
  contacts.kept->take(pairs_, steps_of_list_, last_dt_);
  steps_of_list_ = 0;
  std::vector<double> numbers(6 * contacts.obstacles);
  of_engine([&] { engine_->get_obstacles(0, numbers); });
  std::vector<std::array<double, 6>> forces(contacts.obstacles);
  for (std::size_t k = 0; k < forces.size(); ++k)
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(6 * k), 6, forces[k].begin());
  contacts.kept->set_obstacle_forces(forces);
}

/// Notes the broken beams; appends the bodies of those that were not broken before.
void DeviceStepper::note_broken(std::span<const double> cracks,
                                std::vector<std::array<std::int32_t, 2>>& fresh) {
  for (std::size_t m = 0; m < broken_.size() && !cracks.empty(); ++m) {
    if (broken_[m] != 0 || cracks[m * Damage::numbers + Damage::damage] != 1) continue;
    broken_[m] = 1;
    const auto [i, j] = described_.numbers.beams[m].bodies;
    fresh.push_back({item(model_.part().global, i), item(model_.part().global, j)});
  }
}

/// Lets bodies touch whose beams have broken since the last call.
void DeviceStepper::release_broken() {
  std::vector<std::array<std::int32_t, 2>> pairs;
  const Damage damage = of_engine([&] { return engine_->get_damage(0); });
  note_broken(damage.cracks, pairs);
  for (const auto& force : model_.forces())
    if (auto* role = force->roles().broken_pairs) role->release(pairs);
}

/// Makes a new list of pairs between two steps: the engine does, where nothing has broken.
/// \param time  of the state of the engine [s]
void DeviceStepper::renew_pairs(double time, bool broke) {
  if (!broke && contacts_are_possible() && list_on_engine(time)) return;
  keep_contacts();
  get_records(listed_);
  listed_.time = time;
  list_pairs(listed_);
}

/// Returns false where the processor has to make the list.
bool DeviceStepper::list_on_engine(double time) {
  const DeviceContacts& contacts = *described_.numbers.contacts;
  constexpr std::size_t of_place = 12;
  std::vector<double> places;
  for (std::size_t k = 0; k < contacts.obstacles; ++k) {
    const auto numbers = contacts.obstacle(k, time, last_dt_, last_dt_);
    places.insert(places.end(), numbers.begin(), numbers.begin() + of_place);
  }
  if (!of_engine([&] { return engine_->list_pairs(0, places); })) return false;
  listed_at_ = time;
  return true;
}

void DeviceStepper::get(State<Spatial>& state) {
  get_records(state);
  state.fastest = fastest_;
  state.fastest_spin = fastest_spin_;
  if (const auto& breaking = described_.numbers.breaking) {
    const Damage damage = of_engine([&] { return engine_->get_damage(0); });
    breaking->kept->write(damage.cracks, damage.viscous, last_dt_);
  }
  if (described_.numbers.contacts) keep_contacts();
  KeptParts* kept = kept_parts();
  if (kept == nullptr) return;
  std::vector<double> ordered(described_.order.size() * of_kept);
  of_engine([&] { engine_->get_submerged(0, ordered); });
  kept_.resize(ordered.size());
  for (std::size_t d = 0; d < described_.order.size(); ++d)
    std::copy_n(&ordered[d * of_kept], of_kept,
                &kept_[static_cast<std::size_t>(described_.order[d]) * of_kept]);
  kept->write(kept_, since_);
}

void DeviceStepper::queue(double time, double dt, double before) {
  const auto& contacts = described_.numbers.contacts;
  if (contacts && contacts->obstacle_travel(listed_at_, time) > contacts->slack) {
    make_steps();
    renew_pairs(time, false);
  }
  if (steps_.count == 0) {
    steps_ = {.count = 0, .dt = dt, .before = before, .since = static_cast<int>(since_)};
  } else if (dt != steps_.dt) {
    throw std::logic_error("steps of one queue are equal");
  }
  ++steps_.count;
  last_dt_ = dt;
  times_.push_back(time);
  if (contacts) queue_contacts(*contacts, time, dt, before);
  if (described_.numbers.breaking) steps_.times.push_back(time);
  for (const double at : {time, time + dt}) {
    for (const PlacedBoundary& placed : model_.boundaries()) {
      const std::array<double, 6> values = placed.boundary.value(at);
      steps_.motions.insert(steps_.motions.end(), values.begin(), values.end());
    }
  }
  for (const DeviceModel::Load& load : described_.numbers.loads) {
    const std::array<double, 6> wrench = load.wrench(time);
    steps_.wrenches.insert(steps_.wrenches.end(), wrench.begin(), wrench.end());
  }
  if (const auto& water = described_.numbers.water) {
    const Point3 current = water->current ? water->current(time) : Point3{};
    for (const double number : {water->level(time), current.x, current.y, current.z})
      steps_.water.push_back(number);
    since_ = (since_ + 1) % water->pace;
  }
}

void DeviceStepper::queue_contacts(const DeviceContacts& contacts, double time, double dt,
                                   double before) {
  for (std::size_t k = 0; k < contacts.obstacles; ++k) {
    const DeviceContacts::ObstacleStep numbers = contacts.obstacle(k, time, before, dt);
    steps_.obstacles.insert(steps_.obstacles.end(), numbers.begin(), numbers.end());
  }
  if (!(contacts.damping_ratio > 0)) return;
  for (const PlacedBoundary& placed : model_.boundaries()) {
    const std::array<double, 6> values = placed.boundary.acceleration(time);
    steps_.accelerations.insert(steps_.accelerations.end(), values.begin(), values.end());
  }
}

/// Makes the queued steps, with new lists of pairs where these expire.
void DeviceStepper::make_steps() {
  while (steps_.count > 0) {
    const Made made = of_engine([&] {
      engine_->step({&steps_, 1});
      return engine_->made(0);
    });
    steps_of_list_ += made.steps;
    if ((made.why & Made::no_room) != 0)
      throw RunFailed(
          "an overlap of two bodies has more corners than a back end has room for "
          "(backend: cpu has)");
    const double time = item(times_, made.steps - 1) + steps_.dt;
    drop(made.steps);
    if (!described_.numbers.contacts) continue;
    if ((made.why & Made::parted) != 0) wear_bodies();
    const bool broke = (made.why & Made::beam_broke) != 0;
    if (broke) release_broken();
    if (broke || (made.why & Made::list_expired) != 0) renew_pairs(time, broke);
  }
}

double DeviceStepper::flush() {
  make_steps();
  if (made_ == 0) return 0;
  made_ = 0;
  const Findings found = of_engine([&] { return engine_->findings(0); });
  fastest_ = std::sqrt(found.speed2);
  fastest_spin_ = std::sqrt(found.spin2);
  return found.speed2;
}

/// Takes the first steps off the queue: they are made.
void DeviceStepper::drop(int count) {
  if (count <= 0) throw std::logic_error("an engine makes at least the step at which a run halts");
  const auto of = [&](std::vector<double>& table) {
    const std::size_t each = table.size() / static_cast<std::size_t>(steps_.count);
    table.erase(table.begin(), table.begin() + static_cast<std::ptrdiff_t>(each) * count);
  };
  for (auto* table : {&steps_.motions, &steps_.wrenches, &steps_.water, &steps_.times,
                      &steps_.accelerations, &steps_.obstacles})
    of(*table);
  times_.erase(times_.begin(), times_.begin() + count);
  made_ += count;
  if (const auto& water = described_.numbers.water)
    steps_.since = static_cast<int>((steps_.since + count) % water->pace);
  steps_.before = steps_.dt;
  steps_.count -= count;
}

double DeviceStepper::take_works(std::span<double> works) {
  works_.since = of_engine([&] { return engine_->works(0); });
  return sum(works_, works).value();
}

std::optional<double> DeviceStepper::sum(const WorkParts& parts, std::span<double> works) const {
  const Lattice& lattice = described_.lattice;
  const auto fits = [](const std::vector<double>& some, std::size_t size) {
    return some.empty() || some.size() == size;
  };
  const auto bodies = static_cast<std::size_t>(lattice.bodies);
  const Works& since = parts.since;
  if (parts.until.size() != works.size() || !fits(since.beams, bodies) ||
      !fits(since.held, lattice.held.size()) || !fits(since.loaded, lattice.loaded.size()) ||
      !fits(since.drag, bodies) || !fits(since.buoyancy, bodies) ||
      !fits(since.supports, lattice.supports.size()) || !fits(since.contacts, 3 * bodies) ||
      !fits(since.obstacles,
            lattice.contacts ? 4 * static_cast<std::size_t>(lattice.contacts->obstacles) : 0))
    return {};
  std::copy(parts.until.begin(), parts.until.end(), works.begin());
  for (const double work : since.beams) works[described_.numbers.beam_work] += work;
  for (std::size_t l = 0; l < since.loaded.size(); ++l)
    works[item(described_.numbers.loads, lattice.loaded[l].load).work] += since.loaded[l];
  for (const double work : since.supports) works[described_.numbers.support_work] += work;
  const auto add = [&](const std::vector<double>& some, const std::optional<std::size_t>& force) {
    if (!force) return;  // of other runs in the launch
    for (const double work : some) works[*force] += work;
  };
  if (const auto& water = described_.numbers.water) {
    add(since.drag, water->drag_work);
    add(since.buoyancy, water->buoyancy_work);
  }
  if (const auto& contacts = described_.numbers.contacts) {
    for (std::size_t k = 0; k < since.contacts.size(); ++k)
      works[contacts->work + k % 3] += since.contacts[k];
    for (std::size_t k = 0; k < since.obstacles.size(); ++k)
      works[contacts->work + k % 4] += since.obstacles[k];
  }
  double boundaries = 0;
  for (const double work : since.held) boundaries += work;
  return parts.boundaries + boundaries;
}

}  // namespace floe::device
