#include "contact_force/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "active_contacts/contacts.h"
#include "base/collectives.h"
#include "contact_force/checks.h"
#include "contact_force/expiry.h"
#include "contact_force/halo.h"
#include "contact_force/load_balance.h"
#include "contact_force/obstacle_forces.h"
#include "contact_force/on_device.h"
#include "contact_force/patch_forces.h"
#include "contact_laws/restitution.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "geometry/connected_parts.h"

namespace floe {
namespace {

std::vector<BodyPair> sorted(std::vector<BodyPair> pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Returns 1 for each body of the model that this rank owns, else 0.
std::vector<std::uint8_t> owned_bodies(const Part& part) {
  std::vector<std::uint8_t> here(static_cast<std::size_t>(part.global_bodies), 0);
  for (std::int32_t b = 0; b < part.owned; ++b) item(here, item(part.global, b)) = 1;
  return here;
}

/// Returns rows, each of which begins with A and B, of all ranks in list order, independent of the
/// ranks. Each row counts once: ranks that have loaded a checkpoint and not yet made their lists
/// have all rows. Collective.
template <std::size_t width>
std::vector<double> rows_of_all(const std::vector<double>& mine, MPI_Comm comm) {
  std::vector<double> all = all_gathered(mine, comm);
  std::vector<std::array<double, width>> in_order(all.size() / width);
  for (std::size_t k = 0; k < in_order.size(); ++k)
    std::copy_n(&all[k * width], width, in_order[k].begin());
  std::sort(in_order.begin(), in_order.end());
  in_order.erase(std::unique(in_order.begin(), in_order.end()), in_order.end());
  all.clear();
  for (const auto& row : in_order) all.insert(all.end(), row.begin(), row.end());
  return all;
}

std::vector<double> as_numbers(const std::vector<BodyPair>& pairs) {
  std::vector<double> numbers;
  for (const auto& [a, b] : pairs)
    numbers.insert(numbers.end(), {static_cast<double>(a), static_cast<double>(b)});
  return numbers;
}

std::vector<BodyPair> as_pairs(const std::vector<double>& numbers) {
  std::vector<BodyPair> pairs;
  for (std::size_t k = 0; k + 1 < numbers.size(); k += 2)
    pairs.push_back(
        {static_cast<std::int32_t>(numbers[k]), static_cast<std::int32_t>(numbers[k + 1])});
  return pairs;
}

/// Returns the number of obstacles that are not ice; they come first.
std::size_t named(const std::vector<Obstacle>& obstacles) {
  return static_cast<std::size_t>(std::count_if(obstacles.begin(), obstacles.end(),
                                                [](const Obstacle& o) { return !o.is_ice; }));
}

class DistributedContact final : public Contact,
                                 public DoesWork<Spatial>,
                                 public LimitsStep<Spatial>,
                                 public Commits<Spatial>,
                                 public Persists,
                                 public TakesBrokenPairs,
                                 public Remarks,
                                 public BearsLoad<Spatial>,
                                 public ActsOnPatches,
                                 public OnDevice,
                                 public KeptContacts {
 public:
  DistributedContact(const Part& part, const Lattice& lattice, const ContactOptions& options,
                     std::vector<Obstacle> obstacles, PrescribedMotion prescribed)
      : part_(part),
        contacts_(lattice.shapes, lattice.bodies.mass, sorted(lattice.beams.bodies), options,
                  std::move(obstacles), lattice.bodies.inertia),
        halo_(part),
        balance_(part.comm),
        expiry_(contacts_.solids(), part_),
        obstacle_forces_(named(contacts_.solids().obstacles())),
        patch_forces_(contacts_.solids().obstacles()),
        here_(owned_bodies(part)),
        prescribed_(std::move(prescribed)),
        prescribed_accelerations_(6 * prescribed_.bits.size()),
        rates_(contacts_.rates()),
        steps_per_touch_(contacts_.options().damping_ratio > damping_ratio_of(0.4) ? 14 : 11),
        possible_(pieces() > 1 || lattice.beams.bodies.empty()) {
    if (patch_forces_.is_on()) contacts_.keep_forces();
  }

  std::string_view name() const override { return "contact"; }
  Roles<Spatial> roles() override {
    return {.work = this,
            .step = this,
            .commits = this,
            .persists = this,
            .broken_pairs = this,
            .remarks = this,
            .load = this,
            .patches = patch_forces_.is_on() ? this : nullptr,
            .device = this};
  }

  void add_load(const State<Spatial>& state, std::span<double> load) const override;

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    if (contacts_.list().changed() || !expiry_.started() ||
        expiry_.is_due(state, part_, contacts_, dt_))
      build(state);
    halo_.gather(state, bodies_);
    contacts_.place(bodies_, state.time, state.velocity_time);
    balance_.evaluate(contacts_, mine_);
    if (contacts_.damps()) add_dashpots(state, wrenches);
    power_ = power_with(state);
    if (!possible_ && obstacle_near_) possible_ = anywhere(is_near_obstacle(state));
    if (!possible_ && near_) possible_ = anywhere(contacts_.touching() > 0);
    const std::vector<std::int32_t>& local = halo_.local();
    for (std::size_t k = 0; k < local.size(); ++k) {
      if (local[k] >= 0)
        floe::add(wrenches, static_cast<std::size_t>(local[k]), mine_[k].force, mine_[k].moment);
    }
  }
  double stiffness_bound(std::int32_t body) const override {
    return rates_.stiffness * item(part_.bodies.mass, body);
  }
  Rates hidden_stiffness() const override {
    return possible_ ? Rates{.stiffness = rates_.stiffness, .damping = rates_.damping} : Rates{};
  }

  /// Half a period of a touch by the largest face of a body is 11 steps, 14 for e < 0.4
  /// (zeta > 0.34): then e errs by at most 2 %.
  double resolved_step() const override {
    if (!possible_) return std::numeric_limits<double>::infinity();
    return std::numbers::pi / (steps_per_touch_ * std::sqrt(rates_.touch));
  }
  std::string resolved_motion() const override {
    return "a touch by the largest face of body " + std::to_string(rates_.touching) + " in " +
           std::to_string(steps_per_touch_) + " steps";
  }
  const std::string& overlap_at_start() const override { return overlap_at_start_; }
  Limit step_limit(const State<Spatial>& state) const override {
    return travel_limit(contacts_.solids(), part_, state);
  }
  std::vector<Remark> take_remarks() override {
    std::vector<Remark> remarks = remarks_.take(contacts_);
    if (!overlap_told_ && !overlap_at_start_.empty() && rank(part_.comm) == 0)
      remarks.push_back({.time = 0, .text = overlap_at_start_});
    overlap_told_ = true;
    return remarks;
  }

  /// Checks the contacts of the state at rest. The pair list is made anew when the run starts.
  /// Collective. \throws InputError as for make_contact()
  void check_start() {
    const State<Spatial> rest(static_cast<std::size_t>(part_.local));
    Wrenches<Spatial> none(static_cast<std::size_t>(part_.local));
    add(rest, none);
    expiry_ = PairListExpiry(contacts_.solids(), part_);
    refuse_enclosed(contacts_, part_.comm);
    overlap_at_start_ = check_overlaps(contacts_, part_.comm);
  }

  void commit(const State<Spatial>& state, double dt) override {
    contacts_.commit();
    if (contacts_.wears()) wear_bodies();
    expiry_.after_step(state, dt);
    dt_ = dt;
    obstacle_forces_.take(contacts_, dt, part_.comm);
  }

  PatchSample sample_patches(double time) override {
    return patch_forces_.sample(contacts_, obstacle_forces_.now(contacts_, part_.comm), time,
                                part_.comm);
  }

  DrivenMotion::Place place_of_obstacle(std::size_t k, double time) const override {
    const ObstacleMotion& motion = obstacles()[k].motion;
    return {.way = motion.way(time),
            .turn = motion.turn(time),
            .rate = motion.rate(time),
            .spin = motion.spin(time)};
  }
  std::vector<std::array<Vec3<double>, 2>> obstacle_wrenches() const override {
    std::vector<std::array<Vec3<double>, 2>> wrenches;
    for (std::size_t k = 0; k < obstacles().size(); ++k) {
      const ContactWrench w = contacts_.on_obstacle(k);
      wrenches.push_back({w.force, w.moment});
    }
    if (!wrenches.empty())
      sum_over_ranks(std::span(&wrenches[0][0].x, 6 * wrenches.size()), part_.comm);
    return wrenches;
  }
  const Vec3<double>& impulse(std::size_t k) const override { return obstacle_forces_.impulse(k); }
  /// Results do not depend on when a list is made, so the next evaluation makes a new one.
  void drive(std::size_t k, const DrivenMotion& motion) override {
    contacts_.drive(k, motion);
    expiry_ = PairListExpiry(contacts_.solids(), part_);
  }
  void keep_contacts() override { contacts_.keep_forces(); }
  std::vector<ContactOfPair> contacts_here() const override {
    std::vector<ContactOfPair> all;
    for (std::size_t k = 0; k < contacts_.contacts(); ++k)
      if (contacts_.is_counted(k)) all.push_back(contacts_.contact_of(k));
    return all;
  }

  std::size_t works() const override { return ContactPower::terms; }
  void powers(std::span<double> out) const override { power_.write(out); }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    power_with(state).write(out);
  }

  void release(std::span<const BodyPair> pairs) override {
    std::vector<std::int32_t> mine;
    for (const BodyPair& pair : pairs) mine.insert(mine.end(), pair.begin(), pair.end());
    const std::vector<std::int32_t> all = all_gathered(mine, part_.comm);
    for (std::size_t k = 0; k + 1 < all.size(); k += 2) contacts_.release({all[k], all[k + 1]});
  }

  void report(const State<Spatial>&, std::span<const double> works,
              Columns& columns) const override {
    const ContactEnergies e = contacts_.energies(ContactPower::of(works));
    columns.add("energy_contact", e.stored);
    columns.add("energy_contact_viscous", e.viscous);
    columns.add("energy_friction", e.friction);
    columns.add("energy_crushing", e.crushing);
    const std::vector<Obstacle>& obstacles = contacts_.solids().obstacles();
    if (std::any_of(obstacles.begin(), obstacles.end(),
                    [](const Obstacle& o) { return !o.is_carried() && !o.motion.at_rest(); }))
      columns.add("energy_external", e.external);
    columns.add("contacts", static_cast<double>(contacts_.touching()));
    columns.add("contacts_enclosed", static_cast<double>(contacts_.enclosed().size()));
    obstacle_forces_.report(contacts_, rank(part_.comm) == 0, columns);
  }

  void persist(Archive& archive) override;

  void describe(DeviceModel& model) override {
    model.missing = patch_forces_.is_on() ? "output: pressure" : missing_on_devices(contacts_);
    if (!model.missing.empty()) return;
    model.contacts = on_device(contacts_, part_);
    model.contacts->work = model.next_work;
    model.contacts->kept = this;
  }
  DevicePairs list(const State<Spatial>& state) override {
    build(state);
    return pairs_on_device(contacts_, part_);
  }
  /// The next evaluation makes a new list, on which results do not depend.
  void take(const DevicePairs& pairs, std::int64_t steps, double dt) override {
    if (steps == 0) return;
    contacts_.take_steps(history_rows(pairs, part_), crushes(pairs, part_));
    expiry_ = PairListExpiry(contacts_.solids(), part_);
    for (std::int64_t n = 0; n < steps; ++n) obstacle_forces_.add_time(dt);
    dt_ = dt;
  }
  std::vector<WornPlane> worn() const override {
    return worn_on_device(contacts_, part_, contacts_.worn().bodies());
  }
  std::vector<WornPlane> wear(std::span<const PartedPair> pairs) override {
    const auto cuts = contacts_.cuts_of(crushes(pairs, part_));
    contacts_.wear(cuts);
    std::vector<std::int32_t> bodies;
    for (const WearCut& cut : cuts) bodies.push_back(cut.body);
    std::sort(bodies.begin(), bodies.end());
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    return worn_on_device(contacts_, part_, bodies);
  }
  std::vector<std::array<double, 6>> obstacle_forces() const override {
    return obstacle_forces_.numbers();
  }
  void set_obstacle_forces(std::span<const std::array<double, 6>> forces) override {
    obstacle_forces_.set_numbers(forces);
  }
  bool are_possible() const override { return possible_; }
  bool watches() const override { return !possible_ && (near_ || obstacle_near_); }

 private:
  const std::vector<Obstacle>& obstacles() const { return contacts_.solids().obstacles(); }
  std::int32_t pieces() const { return contacts_.list().eligibility().pieces(); }
  bool anywhere(bool here) const {
    return size(part_.comm) > 1 ? on_any_rank(here, part_.comm) : here;
  }
  ContactPower power_with(const State<Spatial>& state) const;
  void build(const State<Spatial>& state);
  bool is_near_obstacle(const State<Spatial>& state) const;
  void wear_bodies();
  void persist_motion(std::size_t k, Archive& archive);
  void add_dashpots(const State<Spatial>& state, const Wrenches<Spatial>& others);
  void accelerate(const Wrenches<Spatial>& others);
  void restore(const std::vector<double>& rows, std::span<const BodyPair> released,
               std::size_t known);

  const Part& part_;
  Contacts contacts_;
  ContactHalo halo_;
  ContactLoadBalance balance_;
  PairListExpiry expiry_;
  ObstacleForces obstacle_forces_;
  PatchForces patch_forces_;
  std::vector<std::uint8_t> here_;  ///< per body of the model: 1 if this rank owns it
  PrescribedMotion prescribed_;
  std::vector<double> prescribed_accelerations_;  ///< six per local body
  std::vector<MovingPose> bodies_;                ///< by slot
  std::vector<ContactWrench> mine_;               ///< by slot
  std::vector<Acceleration> accelerations_;  ///< by slot, by all forces but dashpots of contacts
  ContactPower power_;                       ///< in the last evaluation
  ContactRates rates_;
  int steps_per_touch_;
  /// Whether the stable step allows for contacts: with more than one piece or without beams (which
  /// would keep the step short), and once a body is near an obstacle or overlaps another. When a
  /// list is made has no say in it, since that depends on the ranks.
  bool possible_;
  bool near_ = false;           ///< pairs are listed, on some rank
  bool obstacle_near_ = false;  ///< a body may become near an obstacle, on some rank
  double dt_ = 0;               ///< last step [s]
  std::string overlap_at_start_;
  bool overlap_told_ = false;
  ContactRemarks remarks_;
};

/// Makes the pair list and what depends on it. Collective.
void DistributedContact::build(const State<Spatial>& state) {
  contacts_.build(halo_.poses(state), here_, state.time);
  const PairList& list = contacts_.list();
  possible_ = possible_ || pieces() > 1;
  if (!possible_) near_ = anywhere(list.size() > 0);
  if (!possible_) obstacle_near_ = anywhere(!list.may_become_near().empty());
  balance_.plan(contacts_);
  halo_.choose(list.involved());
  bodies_.resize(list.involved().size());
  mine_.resize(bodies_.size());
  accelerations_.resize(bodies_.size());
  expiry_.start(state, part_.owned);
}

/// Whether a body of this rank is near an obstacle.
bool DistributedContact::is_near_obstacle(const State<Spatial>& state) const {
  const PairList& list = contacts_.list();
  const auto pairs = list.may_become_near();
  return std::any_of(pairs.begin(), pairs.end(), [&](const BodyPair& pair) {
    const auto local = static_cast<std::size_t>(part_.local_index(pair[0]));
    const auto& [w, x, y, z] = part_.bodies.orientation[local];
    const Placed place{.x = part_.bodies.position[local] + displacement(state, local),
                       .axes = triad(product(rotation(state, local), Quat<double>{w, x, y, z}))};
    const Obstacle& obstacle = contacts_.solids().obstacle(pair[1]);
    if (!obstacle.is_carried())
      return list.is_near(contacts_.solids(), pair[0], place, pair[1],
                          place_of(obstacle, state.time, state.time));
    const Pose& carrier = item(bodies_, list.slot_of(obstacle.body)).pose;
    return list.is_near(contacts_.solids(), pair[0], place, pair[1],
                        {.x = carrier.x, .axes = triad(carrier.q)});
  });
}

/// Wears bodies off by what contacts that parted in this step have crushed. Collective.
void DistributedContact::wear_bodies() {
  const std::span<const WearCut> mine = contacts_.cuts();
  if (size(part_.comm) == 1) {
    contacts_.wear(mine);
    return;
  }
  if (!on_any_rank(!mine.empty(), part_.comm)) return;
  std::vector<double> numbers;
  for (const WearCut& cut : mine) {
    const auto row = cut.as_numbers();
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  const std::vector<double> rows = rows_of_all<WearCut::numbers>(numbers, part_.comm);
  std::vector<WearCut> all;
  for (std::size_t k = 0; k < rows.size(); k += WearCut::numbers)
    all.push_back(WearCut::from(std::span(rows).subspan(k).first<WearCut::numbers>()));
  contacts_.wear(all);
}

/// Returns the power of this rank's share of the last evaluation's contacts with the velocities of
/// a state: the wrenches of owned bodies are complete here, and each obstacle's is of this rank's
/// bodies.
ContactPower DistributedContact::power_with(const State<Spatial>& state) const {
  ContactPower power;
  const std::vector<std::int32_t>& local = halo_.local();
  for (std::size_t k = 0; k < local.size(); ++k) {
    if (local[k] < 0) continue;
    const auto b = static_cast<std::size_t>(local[k]);
    contacts_.add_power(static_cast<std::int32_t>(k), velocity(state, b),
                        angular_velocity(state, b), power);
  }
  contacts_.add_power_on_obstacles(state.velocity_time, power);
  return power;
}

/// Evaluates the contacts with their dashpots, which act on the velocities to which all other
/// forces take the bodies at t_n. Collective. \param others  wrenches of the other forces, complete
/// for owned bodies
void DistributedContact::add_dashpots(const State<Spatial>& state,
                                      const Wrenches<Spatial>& others) {
  if (!prescribed_.bits.empty()) prescribed_.accelerations(state.time, prescribed_accelerations_);
  accelerate(others);
  halo_.complete(accelerations_);
  contacts_.damp(accelerations_, mine_);
}

/// A pair that touches takes 480 ns, overlap and law, half for each body (input/ice_slope.yaml's
/// pile at 100.5 s, AVX-512). Pairs with history count, which a checkpoint keeps, not the list,
/// which a restart makes anew.
void DistributedContact::add_load(const State<Spatial>&, std::span<double> load) const {
  constexpr double ns_of_touch = 480;
  for (const ContactHistory::Entry& entry : contacts_.history().entries()) {
    for (const std::int32_t body : {entry.a, entry.b}) {
      const std::int32_t local = is_obstacle(body) ? -1 : part_.local_index(body);
      if (local >= 0 && local < part_.owned) item(load, local) += 0.5 * ns_of_touch;
    }
  }
}

/// Finds the accelerations of owned bodies by the wrenches of contacts and all others.
void DistributedContact::accelerate(const Wrenches<Spatial>& others) {
  const std::vector<std::int32_t>& local = halo_.local();
  for (std::size_t k = 0; k < local.size(); ++k) {
    if (local[k] < 0) continue;
    const double* w = others.of(static_cast<std::size_t>(local[k]));
    Acceleration a = contacts_.acceleration(
        static_cast<std::int32_t>(k), {.force = mine_[k].force + Vec3<double>{w[0], w[1], w[2]},
                                       .moment = mine_[k].moment + Vec3<double>{w[3], w[4], w[5]}});
    const unsigned bits = prescribed_.bits.empty() ? 0U : item(prescribed_.bits, local[k]);
    const std::size_t row = 6 * static_cast<std::size_t>(local[k]);
    for (std::size_t c = 0; c < 3 && bits != 0; ++c) {  // no force changes these velocities
      if ((bits >> c & 1U) != 0) a.linear[c] = prescribed_accelerations_[row + c];
      if ((bits >> (3 + c) & 1U) != 0) a.angular[c] = prescribed_accelerations_[row + 3 + c];
    }
    accelerations_[k] = a;
  }
}

/// The histories of pairs are saved and loaded. A restart builds the pair list from the state,
/// since results do not depend on when a list was made.
void DistributedContact::persist(Archive& archive) {
  StoredAtStart& start = contacts_.stored_at_start();
  if (archive.within_run()) remarks_.persist(archive, part_.comm);
  archive.share("stored_at_start", start.energy);
  archive.common("start_is_known", start.is_known);
  archive.common("dt", dt_);
  obstacle_forces_.persist_time(archive);
  std::vector<double> rows, released, crushed, worn;
  if (!archive.loading()) {
    rows = rows_of_all<ContactHistory::width>(contacts_.history_rows(), part_.comm);
    crushed = rows_of_all<Crush::numbers>(contacts_.crushing().rows(), part_.comm);
    worn = contacts_.worn().rows();
    released = as_numbers(contacts_.list().eligibility().released());
  }
  archive.common("possible", possible_);
  archive.common("pairs", rows);
  archive.common("crushed", crushed);
  archive.common("worn", worn);
  archive.renumber_bodies(rows, ContactHistory::width, {0, 1});
  archive.renumber_bodies(crushed, Crush::numbers, {0, 1});
  archive.renumber_bodies(worn, WearCut::numbers, {2});
  if (archive.loading()) contacts_.restore_wear(crushed, worn, here_);
  archive.common("released", released);
  auto known = static_cast<std::int64_t>(contacts_.list().settled());
  archive.common("known", known);
  if (archive.renumbers() && archive.loading()) {
    const auto end = released.begin() + 2 * static_cast<std::ptrdiff_t>(known);
    std::vector<double> old(released.begin(), end), fresh(end, released.end());
    archive.renumber_bodies(old, 2, {0, 1});
    archive.renumber_bodies(fresh, 2, {0, 1});
    known = static_cast<std::int64_t>(old.size() / 2);
    released = std::move(old);
    released.insert(released.end(), fresh.begin(), fresh.end());
  }
  obstacle_forces_.persist(contacts_.solids().obstacles(), archive);
  for (std::size_t k = 0; k < obstacles().size(); ++k)
    if (obstacles()[k].motion.is_driven) persist_motion(k, archive);
  if (archive.loading()) restore(rows, as_pairs(released), static_cast<std::size_t>(known));
}

/// Saves or loads the motion that a program has given an obstacle.
void DistributedContact::persist_motion(std::size_t k, Archive& archive) {
  const Obstacle& obstacle = obstacles()[k];
  std::vector<double> numbers;  // empty: none
  if (const auto& driven = obstacle.motion.driven) {
    numbers = {driven->from, driven->until};
    for (const auto& [way, turn, rate, spin] : {driven->start, driven->end})
      numbers.insert(numbers.end(), {way.x, way.y, way.z, turn.w, turn.x, turn.y, turn.z, rate.x,
                                     rate.y, rate.z, spin.x, spin.y, spin.z});
  }
  archive.common("motion_" + obstacle.name, numbers);
  constexpr std::size_t length = 28;
  if (!archive.loading()) return;
  if (numbers.size() != length) return contacts_.stop_driving(k);
  const auto place = [&](std::size_t at) {
    const double* v = &numbers[at];
    return DrivenMotion::Place{.way = {v[0], v[1], v[2]},
                               .turn = {v[3], v[4], v[5], v[6]},
                               .rate = {v[7], v[8], v[9]},
                               .spin = {v[10], v[11], v[12]}};
  };
  contacts_.drive(k,
                  {.from = numbers[0], .until = numbers[1], .start = place(2), .end = place(15)});
}

/// Goes on from a checkpoint.
/// \param rows      histories of the pairs of all ranks
/// \param released  pairs whose beam broke, in this order
/// \param known     number of these that the last build knew
void DistributedContact::restore(const std::vector<double>& rows,
                                 std::span<const BodyPair> released, std::size_t known) {
  overlap_told_ = true;  // the run has given this remark at its start
  contacts_.restore(rows, released, known);
  expiry_ = PairListExpiry(contacts_.solids(), part_);
}

/// Appends what the bodies of the lattice that have several convex parts touch with.
/// \throws InputError if a body is not convex otherwise, or its parts overlap
void add_bodies_of_parts(const Lattice& lattice, const ContactOptions& options,
                         std::vector<Obstacle>& obstacles) {
  if (lattice.shapes.empty())
    throw InputError("forces: contact needs bodies with a shape; the lattice file has no /shapes");
  std::vector<std::uint8_t> carries(lattice.bodies.position.size(), 0);
  for (const Obstacle& o : obstacles)
    if (o.is_carried()) item(carries, o.body) = 1;
  const auto is_convex = [](const Shapes& shapes, std::int32_t body) {
    constexpr double rounding = 1e-6;
    return concavity(shapes, body) <= rounding * std::cbrt(volume_properties(shapes, body).volume);
  };
  for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) {
    if (item(carries, b) != 0 || is_convex(lattice.shapes, b)) continue;
    const Shapes parts = connected_parts(lattice.shapes, b);
    const std::string body = "body " + std::to_string(b) + " of the lattice";
    for (std::int32_t k = 0; k < parts.bodies(); ++k)
      if (parts.bodies() == 1 || !is_convex(parts, k))
        throw InputError(
            "forces: contact needs convex bodies, or bodies of convex parts that "
            "share no vertices; " +
            body + " is not convex, or a face of it is not plane");
    Obstacle ice = polyhedra(parts, {});
    ice.body = b;
    ice.is_ice = true;
    ice.friction = options.friction;
    ice.friction_wet = options.friction_wet;
    if (overlap_of_parts(ice)) throw InputError("forces: contact: parts of " + body + " overlap");
    obstacles.push_back(std::move(ice));
  }
}

}  // namespace

std::unique_ptr<Contact> make_contact(const Part& part, const Lattice& lattice,
                                      const ContactOptions& options,
                                      std::vector<Obstacle> obstacles,
                                      PrescribedMotion prescribed) {
  add_bodies_of_parts(lattice, options, obstacles);
  auto contact = std::make_unique<DistributedContact>(part, lattice, options, std::move(obstacles),
                                                      std::move(prescribed));
  contact->check_start();
  return contact;
}

}  // namespace floe
