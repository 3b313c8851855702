#include "floe/forces/contact.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "floe/base/petsc.h"
#include "forces/all_gathered.h"
#include "forces/contact_exchange.h"
#include "forces/contact_sharing.h"

namespace floe {
namespace {

std::vector<std::array<std::int32_t, 2>> sorted(std::vector<std::array<std::int32_t, 2>> pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

/// Says when the list of pairs must be made anew: before a vertex has moved by the list's slack.
/// Steps say how fast the fastest body was, which bounds all ways; only when that bound has reached
/// the slack are the ways themselves looked at. A scene in which little moves pays next to nothing.
class Watch {
 public:
  explicit Watch(double radius = 0) : radius_(radius) {}
  void start(const State<Spatial>& state, std::int32_t owned) {
    at_build_.assign(state.records.begin(),
                     state.records.begin() + static_cast<std::ptrdiff_t>(owned) * Spatial::record);
    time_ = state.time;
    way_ = 0;
    asks_in_ = 0;
    started_ = true;
  }
  bool started() const { return started_; }
  /// A step was made.
  void went(const State<Spatial>& state, double dt) {
    // Spins change within a step as a body tumbles; that half as much again is far more.
    constexpr double tumbling = 1.5;
    speed_ = state.fastest + tumbling * radius_ * state.fastest_spin;
    way_ += dt * speed_;
  }
  /// Where bodies were at the last build, and when a look is due. Loading, build() goes between.
  void remember(Memory& memory, const Part& part) {
    std::vector<std::int32_t> owned(static_cast<std::size_t>(part.owned));
    std::iota(owned.begin(), owned.end(), 0);
    at_build_.resize(owned.size() * Spatial::record);
    memory.rows("at_build", owned, at_build_, Spatial::record);
    memory.common("build_time", time_);
    memory.common("asks_in", asks_in_);
    std::vector<double> all = all_gathered(std::vector{way_, speed_}, MPI_DOUBLE, part.comm);
    const std::size_t ranks = all.size();
    memory.common("ways_of_ranks", all);
    started_ = true;
    if (!memory.loading()) return;
    // On another number of ranks decisions may differ: each takes the largest.
    const auto me = static_cast<std::size_t>(rank(part.comm));
    for (const std::size_t k : {0UL, 1UL}) {
      double& mine = k == 0 ? way_ : speed_;
      mine = 0;
      for (std::size_t r = 0; 2 * r + k < all.size(); ++r) {
        if (all.size() != ranks || r == me) mine = std::max(mine, all[2 * r + k]);
      }
    }
  }
  State<Spatial> at_build(const Part& part) const {
    State<Spatial> state(static_cast<std::size_t>(part.local));
    std::copy(at_build_.begin(), at_build_.end(), state.records.begin());
    state.time = time_;
    return state;
  }
  /// The same on every rank.
  bool is_due(const State<Spatial>& state, const Part& part, const Contacts& contacts, double dt) {
    if (--asks_in_ > 0) return false;
    const auto [theirs, their_speed] = of_obstacles(contacts.obstacles(), state.time);
    std::array<double, 2> all =
        largest({std::max(way_, theirs), std::max(speed_, their_speed)}, part.comm);
    const double slack = contacts.slack();
    if (all[0] > slack) {
      way_ = ways(state, part, contacts);
      all[0] = largest({std::max(way_, theirs), 0}, part.comm)[0];
      constexpr double enough = 0.8;  // of the slack: what is left is not worth another look
      if (all[0] > enough * slack) return true;
    }
    if (size(part.comm) > 1) {        // a look costs a message
      constexpr double sudden = 100;  // what a body may gain between two looks [m/s]
      const double per_step = dt > 0 ? dt * (2 * all[1] + sudden) : slack;
      asks_in_ = static_cast<std::int64_t>(std::clamp((slack - all[0]) / per_step, 0.0, 1000.0));
    }
    return false;
  }

 private:
  static std::array<double, 2> largest(std::array<double, 2> mine, MPI_Comm comm) {
    if (size(comm) > 1) MPI_Allreduce(MPI_IN_PLACE, mine.data(), 2, MPI_DOUBLE, MPI_MAX, comm);
    return mine;
  }
  /// The farthest way of an obstacle's vertex since the list was made, and their largest speed.
  std::array<double, 2> of_obstacles(const std::vector<Obstacle>& obstacles, double time) const {
    std::array<double, 2> most{};
    for (const Obstacle& o : obstacles) {
      const ObstacleMotion& m = o.motion;
      if (m.at_rest()) continue;
      const double radius = o.radius();
      const Quat<double> turn = product(m.turn(time), conjugate(m.turn(time_)));
      most[0] = std::max(most[0], length(m.way(time) - m.way(time_)) +
                                      2 * radius * length({turn.x, turn.y, turn.z}));
      most[1] = std::max(most[1], m.largest_speed(radius));
    }
    return most;
  }
  /// The farthest way of a vertex of an owned body since the list was made.
  double ways(const State<Spatial>& state, const Part& part, const Contacts& contacts) const {
    double farthest = 0;
    for (std::int32_t b = 0; b < part.owned; ++b) {
      const auto k = static_cast<std::size_t>(b);
      const double* was = &at_build_[k * Spatial::record];
      const double* is = state.record(k);
      const Vec3<double> way{is[0] - was[0], is[1] - was[1], is[2] - was[2]};
      const Quat<double> turn = product(Quat<double>{is[3], is[4], is[5], is[6]},
                                        Quat<double>{was[3], -was[4], -was[5], -was[6]});
      farthest = std::max(farthest, length(way) + 2 * contacts.radius(part.global[k]) *
                                                      length({turn.x, turn.y, turn.z}));
    }
    return farthest;
  }

  double radius_;  ///< of the largest body [m]
  std::vector<double> at_build_;
  double time_ = 0;
  double way_ = 0;    ///< bound of the way of any vertex of this rank since the list was made [m]
  double speed_ = 0;  ///< bound of their speeds in the last step [m/s]
  std::int64_t asks_in_ = 0;
  bool started_ = false;
};

class ContactOfModel final : public Contact {
 public:
  ContactOfModel(const Part& part, const Lattice& lattice, const ContactOptions& options,
                 std::vector<Obstacle> obstacles)
      : part_(part),
        contacts_(lattice.shapes, lattice.bodies.mass, sorted(lattice.beams.bodies), options,
                  std::move(obstacles)),
        exchange_(part),
        sharing_(part.comm),
        watch_(largest_radius(contacts_, part.global_bodies)),
        here_(static_cast<std::size_t>(part.global_bodies), 0),
        peak_(contacts_.obstacles().size()),
        impulse_(contacts_.obstacles().size()),
        rates_(contacts_.rates()),
        possible_(contacts_.pieces() > 1 || lattice.beams.bodies.empty()) {
    for (std::int32_t b = 0; b < part.owned; ++b)
      here_[static_cast<std::size_t>(part.global[static_cast<std::size_t>(b)])] = 1;
  }

  std::string_view name() const override { return "contact"; }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) const override {
    if (contacts_.changed() || !watch_.started() || watch_.is_due(state, part_, contacts_, dt_))
      build(state);
    exchange_.gather(state, bodies_);
    std::fill(mine_.begin(), mine_.end(), ContactWrench{});
    contacts_.place(bodies_, state.time);
    sharing_.evaluate(contacts_, mine_);
    if (!possible_ && near_) possible_ = anywhere(contacts_.touching() > 0);
    const std::vector<std::int32_t>& local = exchange_.local();
    for (std::size_t k = 0; k < local.size(); ++k) {
      if (local[k] < 0) continue;
      double* w = wrenches.of(static_cast<std::size_t>(local[k]));
      const ContactWrench& c = mine_[k];
      w[0] += c.force.x, w[1] += c.force.y, w[2] += c.force.z;
      w[3] += c.moment.x, w[4] += c.moment.y, w[5] += c.moment.z;
    }
  }
  bool add_tangent(const State<Spatial>&, Tangent<Spatial>&) const override { return false; }
  double stiffness_bound(std::int32_t body) const override {
    return rates_.stiffness * part_.bodies.mass[static_cast<std::size_t>(body)];
  }
  Rates own_rates() const override {
    return possible_ ? Rates{rates_.stiffness, rates_.damping} : Rates{};
  }

  /// At rest; the run makes its own list. Collective.
  void refuse_enclosed() {
    const State<Spatial> rest(static_cast<std::size_t>(part_.local));
    Wrenches<Spatial> none(static_cast<std::size_t>(part_.local));
    add(rest, none);
    watch_ = Watch(largest_radius(contacts_, part_.global_bodies));
    std::vector<std::int32_t> mine;
    if (const auto pair = contacts_.enclosed()) mine.assign(pair->begin(), pair->end());
    const std::vector<std::int32_t> all = all_gathered(mine, MPI_INT32_T, part_.comm);
    if (all.empty()) return;
    std::array<std::int32_t, 2> first{all[0], all[1]};  // whatever the ranks
    for (std::size_t k = 2; k < all.size(); k += 2) first = std::min(first, {all[k], all[k + 1]});
    const std::string body = "body " + std::to_string(first[0]);
    if (first[1] >= 0)
      throw InputError("forces: contact: " + body + " and body " + std::to_string(first[1]) +
                       ": one lies wholly inside the other, they would feel nothing");
    const Obstacle& o = contacts_.obstacles()[static_cast<std::size_t>(-1 - first[1])];
    throw InputError("obstacle: " + o.name + ": " + body +
                     " lies wholly inside it: obstacles are solid, it would feel nothing");
  }

  void commit(const State<Spatial>& state, double dt) override {
    exchange_.gather(state, bodies_);
    contacts_.commit(bodies_, dt);
    watch_.went(state, dt);
    dt_ = dt;
    watch_obstacles(dt);
  }

  void release(std::span<const std::array<std::int32_t, 2>> pairs) override {
    std::vector<std::int32_t> mine;
    for (const auto& pair : pairs) mine.insert(mine.end(), pair.begin(), pair.end());
    const std::vector<std::int32_t> all = all_gathered(mine, MPI_INT32_T, part_.comm);
    for (std::size_t k = 0; k + 1 < all.size(); k += 2) contacts_.release({all[k], all[k + 1]});
  }

  void report(const State<Spatial>&, Columns& columns) const override {
    const ContactEnergies e = contacts_.energies();
    columns.add("energy_contact", e.stored);
    columns.add("energy_contact_viscous", e.viscous);
    columns.add("energy_friction", e.friction);
    columns.add("energy_crushing", e.crushing);
    bool moving = false;
    for (const Obstacle& o : contacts_.obstacles()) moving = moving || !o.motion.at_rest();
    if (moving) columns.add("energy_external", e.external);
    columns.add("contacts", static_cast<double>(contacts_.touching()));
    columns.add("contacts_enclosed", static_cast<double>(contacts_.enclosures()));
    const bool first = rank(part_.comm) == 0;  // of what all ranks know alike
    for (std::size_t k = 0; k < contacts_.obstacles().size(); ++k) {
      const std::string& obstacle = contacts_.obstacles()[k].name;
      const ContactWrench& w = contacts_.on_obstacle(k);
      put(columns, obstacle + "_force", w.force);
      put(columns, obstacle + "_moment", w.moment);
      put(columns, obstacle + "_peak_force", first ? peak_[k] : Vec3<double>{});
      const double share = first && time_ > 0 ? 1 / time_ : 0.0;
      put(columns, obstacle + "_mean_force", share * impulse_[k]);
    }
  }

  void remember(Memory& memory) override;

 private:
  static double largest_radius(const Contacts& contacts, std::int32_t bodies) {
    double largest = 0;
    for (std::int32_t b = 0; b < bodies; ++b) largest = std::max(largest, contacts.radius(b));
    return largest;
  }
  static void put(Columns& columns, const std::string& name, const Vec3<double>& v) {
    columns.add(name + "_x", v.x);
    columns.add(name + "_y", v.y);
    columns.add(name + "_z", v.z);
  }

  bool anywhere(bool here) const {
    int any = here ? 1 : 0;
    if (size(part_.comm) > 1) MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, part_.comm);
    return any != 0;
  }

  void build(const State<Spatial>& state) const {
    contacts_.build(exchange_.poses(state), here_, state.time);
    possible_ = possible_ || contacts_.pieces() > 1;
    if (!possible_) possible_ = anywhere(contacts_.obstacle_listed());
    if (!possible_) near_ = anywhere(contacts_.listed() > 0);
    sharing_.plan(contacts_);
    exchange_.choose(contacts_.involved());
    bodies_.resize(contacts_.involved().size());
    mine_.resize(bodies_.size());
    watch_.start(state, part_.owned);
  }

  /// Peak and impulse of the forces on obstacles; with several ranks a sum over them per step.
  void watch_obstacles(double dt) {
    const std::size_t n = peak_.size();
    if (n == 0) return;
    std::vector<Vec3<double>>& forces = forces_;
    forces.clear();
    for (std::size_t k = 0; k < n; ++k) forces.push_back(contacts_.on_obstacle(k).force);
    if (size(part_.comm) > 1)
      MPI_Allreduce(MPI_IN_PLACE, forces.data(), static_cast<int>(3 * n), MPI_DOUBLE, MPI_SUM,
                    part_.comm);
    for (std::size_t k = 0; k < n; ++k) {
      if (dot(forces[k], forces[k]) > dot(peak_[k], peak_[k])) peak_[k] = forces[k];
      impulse_[k] = impulse_[k] + dt * forces[k];
    }
    time_ += dt;
  }

  const Part& part_;
  mutable Contacts contacts_;
  mutable ContactExchange exchange_;
  mutable ContactSharing sharing_;
  mutable Watch watch_;
  mutable std::vector<MovingPose> bodies_;
  mutable std::vector<ContactWrench> mine_;
  std::vector<std::uint8_t> here_;
  std::vector<Vec3<double>> peak_, impulse_, forces_;
  Contacts::Rates rates_;
  /// Whether the stable step must bear contacts: with more than one piece or a lone body (no beam
  /// keeps its step short), and once an obstacle has come near or bodies of the one piece have met.
  mutable bool possible_;
  mutable bool near_ = false;  ///< pairs are listed, on some rank
  double dt_ = 0, time_ = 0;
};

/// The list of pairs is made anew, from the state once contacts are possible: then it does not show
/// in the results; what a pair remembers goes with it.
void ContactOfModel::remember(Memory& memory) {
  for (std::size_t k = 0; k < contacts_.sums().size(); ++k) {
    // The last step and whether the start is known are no sums.
    double& value = contacts_.sums()[k];
    const std::string key = "sum_" + std::to_string(k);
    k == 4 || k == 6 ? memory.common(key, value) : memory.share(key, value);
  }
  memory.common("dt", dt_);
  memory.common("time", time_);
  std::vector<double> rows = contacts_.history(), pairs;
  if (!memory.loading()) {
    const std::vector<double> all = all_gathered(rows, MPI_DOUBLE, part_.comm);
    // In list order, whatever the ranks.
    std::vector<std::array<double, Contacts::width>> in_order(all.size() / Contacts::width);
    for (std::size_t k = 0; k < in_order.size(); ++k)
      std::copy_n(&all[k * Contacts::width], Contacts::width, in_order[k].begin());
    std::sort(in_order.begin(), in_order.end());
    rows.clear();
    for (const auto& row : in_order) rows.insert(rows.end(), row.begin(), row.end());
    for (const auto& [a, b] : contacts_.released())
      pairs.insert(pairs.end(), {static_cast<double>(a), static_cast<double>(b)});
  }
  bool changed = contacts_.changed();
  memory.common("changed", changed);
  memory.common("possible", possible_);
  Watch watch = watch_;
  if (!possible_) watch.remember(memory, part_);  // what is listed decides when it becomes so
  memory.common("pairs", rows);
  memory.common("released", pairs);
  for (std::size_t k = 0; k < peak_.size(); ++k) {
    const std::string& obstacle = contacts_.obstacles()[k].name;
    for (auto& [key, vector] :
         {std::pair<std::string, Vec3<double>*>{"peak_", &peak_[k]}, {"impulse_", &impulse_[k]}}) {
      memory.common(key + obstacle + "_x", vector->x);
      memory.common(key + obstacle + "_y", vector->y);
      memory.common(key + obstacle + "_z", vector->z);
    }
  }
  if (!memory.loading()) return;
  for (std::size_t k = 0; k + 1 < pairs.size(); k += 2)
    contacts_.release(
        {static_cast<std::int32_t>(pairs[k]), static_cast<std::int32_t>(pairs[k + 1])});
  contacts_.restore(rows, changed);
  watch_ = Watch(largest_radius(contacts_, part_.global_bodies));
  if (possible_ || changed) return;
  build(watch.at_build(part_));  // the list that the run had
  watch_ = watch;
}

void check_shapes(const Lattice& lattice) {
  if (lattice.shapes.empty())
    throw InputError("forces: contact needs bodies with a shape; the lattice file has no /shapes");
  for (std::int32_t b = 0; b < lattice.bodies.size(); ++b) {
    const double size = std::cbrt(volume_properties(lattice.shapes, b).volume);
    constexpr double rounding = 1e-6;
    if (concavity(lattice.shapes, b) > rounding * size)
      throw InputError("forces: contact needs convex bodies; body " + std::to_string(b) +
                       " of the lattice is not convex, or a face of it is not plane");
  }
}

}  // namespace

std::unique_ptr<Contact> make_contact(const Part& part, const Lattice& lattice,
                                      const ContactOptions& options,
                                      std::vector<Obstacle> obstacles) {
  check_shapes(lattice);
  auto contact = std::make_unique<ContactOfModel>(part, lattice, options, std::move(obstacles));
  contact->refuse_enclosed();
  return contact;
}

}  // namespace floe
