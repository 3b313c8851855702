// What a program sees of a simulation between its steps, and what it does to it.
#include <algorithm>
#include <tuple>

#include "base/collectives.h"
#include "base/union_find.h"
#include "floe/base/item.h"
#include "run/dynamic_run.h"
#include "simulation/running.h"

namespace floe {

/// The last accepted state; null before the first one.
template <class Space>
const State<Space>* RunningIn<Space>::state() const {
  if (auto* moving = dynamic_cast<DynamicRun<Space>*>(run_.get())) return &moving->state();
  return state_;
}

template <class Space>
BodyTable RunningIn<Space>::all_bodies() const {
  BodyTable table;
  const State<Space>* now = state();
  const Part& part = this->part();
  constexpr std::size_t width = 14;
  std::vector<double> mine;
  for (std::size_t b = 0; now != nullptr && b < static_cast<std::size_t>(part.owned); ++b) {
    const Vec3<double> x = part.bodies.position[b] + displacement(*now, b), v = velocity(*now, b),
                       w = angular_velocity(*now, b);
    const Quat<double> q = rotation(*now, b);
    mine.insert(mine.end(), {x.x, x.y, x.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z,
                             part.bodies.mass[b]});
  }
  const std::vector<double> all = all_gathered(mine, part.comm);
  const std::vector<std::int32_t> index = all_gathered(
      std::vector<std::int32_t>(part.global.begin(), part.global.begin() + part.owned), part.comm);
  const std::size_t n = all.size() / width;
  table.position.resize(n), table.orientation.resize(n), table.velocity.resize(n);
  table.spin.resize(n), table.mass.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double* v = &all[k * width];
    item(table.position, index[k]) = {v[0], v[1], v[2]};
    item(table.orientation, index[k]) = {v[3], v[4], v[5], v[6]};
    item(table.velocity, index[k]) = {v[7], v[8], v[9]};
    item(table.spin, index[k]) = {v[10], v[11], v[12]};
    item(table.mass, index[k]) = v[13];
  }
  if (setting_.mesh.ice) {
    const auto names = setting_.mesh.ice->names_of_bodies();
    table.index.assign(names.begin(), names.end());
  }
  for (auto k = static_cast<std::int32_t>(table.index.size()); k < static_cast<std::int32_t>(n);
       ++k)
    table.index.push_back(k);
  // Pieces that unbroken beams join
  std::vector<std::int32_t> joined;
  for (std::size_t m = 0; m < part.counts_here.size(); ++m) {
    const bool is_broken = model_->fracture() != nullptr &&
                           model_->fracture()->damage(static_cast<std::int32_t>(m)) >= 1;
    if (!part.counts_here[m] || is_broken) continue;
    for (const std::int32_t local : part.beams.bodies[m])
      joined.push_back(item(part.global, local));
  }
  joined = all_gathered(joined, part.comm);
  UnionFind pieces(n);
  for (std::size_t k = 0; k + 1 < joined.size(); k += 2) pieces.unite(joined[k], joined[k + 1]);
  const std::vector<std::int32_t> root = pieces.representatives();
  std::vector<double> mass(n, 0);
  for (std::size_t b = 0; b < n; ++b) item(mass, root[b]) += table.mass[b];
  std::vector<std::int32_t> order;
  for (std::size_t b = 0; b < n; ++b)
    if (root[b] == static_cast<std::int32_t>(b)) order.push_back(root[b]);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return item(mass, a) > item(mass, b); });
  std::vector<std::int32_t> number(n);
  for (std::size_t k = 0; k < order.size(); ++k)
    item(number, order[k]) = static_cast<std::int32_t>(k);
  for (std::size_t b = 0; b < n; ++b) table.fragment.push_back(item(number, root[b]));
  return table;
}

template <class Space>
BeamTable RunningIn<Space>::beams() const {
  BeamTable table;
  const State<Space>* now = state();
  const Model<Space>& model = *model_;  // NOLINT(bugprone-unchecked-optional-access): made first
  const Part& part = model.part();
  if (now == nullptr || model.beams() == nullptr) return table;
  if (auto* moving = dynamic_cast<DynamicRun<Space>*>(run_.get()))  // ghosts are of the last step
    part.ghosts.update(moving->state().records, Space::record);
  const std::vector<BeamSection> sections = model.beams()->sections(*now);
  constexpr std::size_t width = 7;
  std::vector<std::int32_t> beams;  // global beam and its bodies
  std::vector<double> values;
  for (std::size_t m = 0; m < part.counts_here.size(); ++m) {
    if (!part.counts_here[m]) continue;
    const auto& [a, b] = part.beams.bodies[m];
    beams.insert(beams.end(), {part.global_beam[m], item(part.global, a), item(part.global, b)});
    values.insert(values.end(), sections[m].begin(), sections[m].end());
    values.push_back(
        model.fracture() != nullptr ? model.fracture()->damage(static_cast<std::int32_t>(m)) : 0);
  }
  beams = all_gathered(beams, part.comm);
  values = all_gathered(values, part.comm);
  const std::size_t n = beams.size() / 3;
  table.bodies.resize(n), table.section.resize(n), table.damage.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t beam = beams[3 * k];
    item(table.bodies, beam) = {beams[3 * k + 1], beams[3 * k + 2]};
    std::copy_n(&values[k * width], 6, item(table.section, beam).begin());
    item(table.damage, beam) = values[k * width + 6];
  }
  return table;
}

template <class Space>
std::vector<ContactOfPair> RunningIn<Space>::contacts() {
  Contact* role = contact_;
  if (role == nullptr) return {};
  if (!keeps_contacts_) {
    keeps_contacts_ = true;
    role->keep_contacts();
    run_->forces_have_changed();
  }
  run_->know_forces();
  constexpr std::size_t width = 14;
  std::vector<double> mine;
  for (const ContactOfPair& c : role->contacts_here())
    mine.insert(mine.end(),
                {static_cast<double>(c.a), static_cast<double>(c.b),
                 static_cast<double>(c.obstacle), c.force.x, c.force.y, c.force.z, c.point.x,
                 c.point.y, c.point.z, c.normal.x, c.normal.y, c.normal.z, c.volume, c.area});
  const std::vector<double> rows = all_gathered(mine, part().comm);
  std::vector<ContactOfPair> all;
  for (std::size_t k = 0; k < rows.size(); k += width) {
    const double* v = &rows[k];
    all.push_back({.a = static_cast<std::int32_t>(v[0]),
                   .b = static_cast<std::int32_t>(v[1]),
                   .obstacle = static_cast<std::int32_t>(v[2]),
                   .force = {v[3], v[4], v[5]},
                   .point = {v[6], v[7], v[8]},
                   .normal = {v[9], v[10], v[11]},
                   .volume = v[12],
                   .area = v[13]});
  }
  std::stable_sort(all.begin(), all.end(), [](const ContactOfPair& a, const ContactOfPair& b) {
    return std::tie(a.a, a.b, a.obstacle) < std::tie(b.a, b.b, b.obstacle);
  });
  return all;
}

template <class Space>
NamedValues RunningIn<Space>::columns() {
  NamedValues now = run_->columns_now();
  if (!now.empty() || !output_) return now;
  return columns_of(output_->last());
}

template <class Space>
std::vector<ObstacleNow> RunningIn<Space>::obstacles() {
  Contact* role = contact_;
  std::vector<ObstacleNow> all;
  if (role == nullptr) return all;
  run_->know_forces();
  const auto wrenches = role->obstacle_wrenches();
  const Part& part = this->part();
  const State<Space>& now = *state();
  for (std::size_t k = 0; k < scene_.obstacles.size(); ++k) {
    ObstacleNow& o = all.emplace_back();
    o.name = scene_.obstacles[k].name;
    o.coupled = is_coupled(setting_, o.name);
    o.force = wrenches[k][0], o.moment = wrenches[k][1];
    o.impulse = role->impulse(k);
    for (std::size_t s = 0; s < scene_.structures.size(); ++s)
      if (scene_.structures[s].obstacle == k) o.body = body_of(s);
    if (o.body < 0) {
      const DrivenMotion::Place place = role->place_of_obstacle(k, run_->time());
      o.position = scene_.obstacles[k].point + place.way;
      o.orientation = place.turn, o.velocity = place.rate, o.spin = place.spin;
      continue;
    }
    std::array<double, 13> numbers{};
    const std::int32_t local = part.local_index(o.body);
    if (local >= 0 && local < part.owned) {
      const auto b = static_cast<std::size_t>(local);
      const Vec3<double> x = part.bodies.position[b] + displacement(now, b), v = velocity(now, b),
                         w = angular_velocity(now, b);
      const Quat<double> q = rotation(now, b);
      numbers = {x.x, x.y, x.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z};
    }
    const auto n = sum_over_ranks(numbers, part.comm);
    o.position = {n[0], n[1], n[2]};
    o.orientation = {n[3], n[4], n[5], n[6]};
    o.velocity = {n[7], n[8], n[9]}, o.spin = {n[10], n[11], n[12]};
  }
  return all;
}

template <class Space>
void RunningIn<Space>::drive(std::size_t k, const PlaceAndMotion& to, std::optional<double> until) {
  Contact* role = contact_;
  const double now = run_->time();
  DrivenMotion motion{.from = now, .until = now, .start = {}, .end = {}};
  motion.end = {.way = to.position - scene_.obstacles[k].point,
                .turn = normalised(to.orientation),
                .rate = to.velocity,
                .spin = to.spin};
  motion.start = motion.end;
  if (until) {
    motion.until = *until;
    motion.start = role->place_of_obstacle(k, now);
  }
  role->drive(k, motion);
  run_->forces_have_changed();
}

template <class Space>
void RunningIn<Space>::apply(std::size_t structure, const Vec3<double>& force,
                             const Vec3<double>& moment) {
  for (AppliedWrench& wrench : *applied_)
    if (wrench.body == body_of(structure)) wrench.force = force, wrench.moment = moment;
  run_->forces_have_changed();
}

template <class Space>
std::shared_ptr<const SavedState> RunningIn<Space>::save() {
  auto saved = std::make_shared<KeptState>();
  saved->of = this;
  saved->run = run_->save();
  if (output_) saved->output = output_->save();
  return saved;
}

template <class Space>
void RunningIn<Space>::restore(const SavedState& state) {
  const auto* kept = dynamic_cast<const KeptState*>(&state);
  if (kept == nullptr || kept->of != this)
    throw InputError("restore: the state is of another simulation");
  run_->restore(*kept->run);
  if (keeps_contacts_) contact_->keep_contacts();
  if (output_) output_->restore(kept->output.value_or(OutputState{}), present_mesh());
}

template const State<Spatial>* RunningIn<Spatial>::state() const;
template BodyTable RunningIn<Spatial>::all_bodies() const;
template BeamTable RunningIn<Spatial>::beams() const;
template std::vector<ContactOfPair> RunningIn<Spatial>::contacts();
template NamedValues RunningIn<Spatial>::columns();
template std::vector<ObstacleNow> RunningIn<Spatial>::obstacles();
template void RunningIn<Spatial>::drive(std::size_t, const PlaceAndMotion&, std::optional<double>);
template void RunningIn<Spatial>::apply(std::size_t, const Vec3<double>&, const Vec3<double>&);
template std::shared_ptr<const SavedState> RunningIn<Spatial>::save();
template void RunningIn<Spatial>::restore(const SavedState&);
template const State<Planar>* RunningIn<Planar>::state() const;
template BodyTable RunningIn<Planar>::all_bodies() const;
template BeamTable RunningIn<Planar>::beams() const;
template std::vector<ContactOfPair> RunningIn<Planar>::contacts();
template NamedValues RunningIn<Planar>::columns();
template std::vector<ObstacleNow> RunningIn<Planar>::obstacles();
template void RunningIn<Planar>::drive(std::size_t, const PlaceAndMotion&, std::optional<double>);
template void RunningIn<Planar>::apply(std::size_t, const Vec3<double>&, const Vec3<double>&);
template std::shared_ptr<const SavedState> RunningIn<Planar>::save();
template void RunningIn<Planar>::restore(const SavedState&);

}  // namespace floe
