#include "contact_force/contact.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/collectives.h"
#include "contact_force/checks.h"
#include "contact_force/expiry.h"
#include "contact_force/halo.h"
#include "contact_force/load_balance.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

std::vector<std::array<std::int32_t, 2>> sorted(std::vector<std::array<std::int32_t, 2>> pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

class DistributedContact final : public Contact,
                                 public LimitsStep<Spatial>,
                                 public Commits<Spatial>,
                                 public Persists,
                                 public TakesBrokenPairs,
                                 public Remarks {
 public:
  DistributedContact(const Part& part, const Lattice& lattice, const ContactOptions& options,
                     std::vector<Obstacle> obstacles)
      : part_(part),
        contacts_(lattice.shapes, lattice.bodies.mass, sorted(lattice.beams.bodies), options,
                  std::move(obstacles)),
        halo_(part),
        balance_(part.comm),
        expiry_(contacts_, part.global_bodies),
        here_(static_cast<std::size_t>(part.global_bodies), 0),
        peak_(contacts_.obstacles().size()),
        impulse_(contacts_.obstacles().size()),
        rates_(contacts_.rates()),
        possible_(contacts_.pieces() > 1 || lattice.beams.bodies.empty()) {
    for (std::int32_t b = 0; b < part.owned; ++b)
      here_[static_cast<std::size_t>(part.global[static_cast<std::size_t>(b)])] = 1;
  }

  std::string_view name() const override { return "contact"; }
  Roles<Spatial> roles() override {
    return {.step = this, .commits = this, .persists = this, .broken_pairs = this, .remarks = this};
  }
  bool has_history() const override { return true; }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    if (contacts_.changed() || !expiry_.started() || expiry_.is_due(state, part_, contacts_, dt_))
      build(state);
    halo_.gather(state, bodies_);
    std::fill(mine_.begin(), mine_.end(), ContactWrench{});
    contacts_.place(bodies_, state.time);
    balance_.evaluate(contacts_, mine_);
    if (!possible_ && near_) possible_ = anywhere(contacts_.touching() > 0);
    const std::vector<std::int32_t>& local = halo_.local();
    for (std::size_t k = 0; k < local.size(); ++k) {
      if (local[k] < 0) continue;
      double* w = wrenches.of(static_cast<std::size_t>(local[k]));
      const ContactWrench& c = mine_[k];
      w[0] += c.force.x, w[1] += c.force.y, w[2] += c.force.z;
      w[3] += c.moment.x, w[4] += c.moment.y, w[5] += c.moment.z;
    }
  }
  double stiffness_bound(std::int32_t body) const override {
    return rates_.stiffness * part_.bodies.mass[static_cast<std::size_t>(body)];
  }
  Rates hidden_stiffness() const override {
    return possible_ ? Rates{rates_.stiffness, rates_.damping} : Rates{};
  }

  const std::string& overlap_at_start() const override { return overlap_at_start_; }
  Limit step_limit(const State<Spatial>& state) const override {
    return travel_limit(contacts_, part_, state);
  }
  std::vector<Remark> take_remarks() override {
    std::vector<Remark> remarks = remarks_.take(contacts_);
    if (!overlap_told_ && !overlap_at_start_.empty() && rank(part_.comm) == 0)
      remarks.push_back({0, overlap_at_start_});
    overlap_told_ = true;
    return remarks;
  }

  /// Checks the contacts of the state at rest. The pair list is made anew when the run starts.
  /// Collective. \throws InputError as for make_contact()
  void check_start() {
    const State<Spatial> rest(static_cast<std::size_t>(part_.local));
    Wrenches<Spatial> none(static_cast<std::size_t>(part_.local));
    add(rest, none);
    expiry_ = PairListExpiry(contacts_, part_.global_bodies);
    refuse_enclosed(contacts_, part_.comm);
    overlap_at_start_ = check_overlaps(contacts_, part_.comm);
  }

  void commit(const State<Spatial>& state, double dt) override {
    halo_.gather(state, bodies_);
    contacts_.commit(bodies_, dt);
    expiry_.after_step(state, dt);
    dt_ = dt;
    watch_obstacles(dt);
  }

  void release(std::span<const std::array<std::int32_t, 2>> pairs) override {
    std::vector<std::int32_t> mine;
    for (const auto& pair : pairs) mine.insert(mine.end(), pair.begin(), pair.end());
    const std::vector<std::int32_t> all = all_gathered(mine, part_.comm);
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
    columns.add("contacts_enclosed", static_cast<double>(contacts_.enclosed().size()));
    const bool first = rank(part_.comm) == 0;  // peaks and means are alike on all ranks
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

  void persist(Archive& archive) override;

 private:
  static void put(Columns& columns, const std::string& name, const Vec3<double>& v) {
    columns.add(name + "_x", v.x);
    columns.add(name + "_y", v.y);
    columns.add(name + "_z", v.z);
  }

  bool anywhere(bool here) const {
    return size(part_.comm) > 1 ? on_any_rank(here, part_.comm) : here;
  }

  void build(const State<Spatial>& state) {
    contacts_.build(halo_.poses(state), here_, state.time);
    possible_ = possible_ || contacts_.pieces() > 1;
    if (!possible_) possible_ = anywhere(contacts_.obstacle_listed());
    if (!possible_) near_ = anywhere(contacts_.listed() > 0);
    balance_.plan(contacts_);
    halo_.choose(contacts_.involved());
    bodies_.resize(contacts_.involved().size());
    mine_.resize(bodies_.size());
    expiry_.start(state, part_.owned);
  }

  /// Updates peak and impulse of the forces on obstacles. With several ranks this takes one sum
  /// over the ranks per step.
  void watch_obstacles(double dt) {
    const std::size_t n = peak_.size();
    if (n == 0) return;
    std::vector<Vec3<double>>& forces = forces_;
    forces.clear();
    for (std::size_t k = 0; k < n; ++k) forces.push_back(contacts_.on_obstacle(k).force);
    if (size(part_.comm) > 1) sum_over_ranks(std::span(&forces[0].x, 3 * n), part_.comm);
    for (std::size_t k = 0; k < n; ++k) {
      if (dot(forces[k], forces[k]) > dot(peak_[k], peak_[k])) peak_[k] = forces[k];
      impulse_[k] = impulse_[k] + dt * forces[k];
    }
    time_ += dt;
  }

  const Part& part_;
  Contacts contacts_;
  ContactHalo halo_;
  ContactLoadBalance balance_;
  PairListExpiry expiry_;
  std::vector<MovingPose> bodies_;
  std::vector<ContactWrench> mine_;
  std::vector<std::uint8_t> here_;
  std::vector<Vec3<double>> peak_, impulse_, forces_;
  Contacts::Rates rates_;
  /// Whether the stable step allows for contacts: with more than one piece or without beams (which
  /// would keep the step short), and once an obstacle is listed or bodies of the one piece overlap.
  bool possible_;
  bool near_ = false;         ///< pairs are listed, on some rank
  double dt_ = 0, time_ = 0;  ///< last step, and sum of all steps [s]
  std::string overlap_at_start_;
  bool overlap_told_ = false;
  ContactRemarks remarks_;
};

/// The histories of pairs are saved and loaded. Once contacts are possible, a restart builds the
/// pair list from the state, since results do not depend on the list any more; before that the list
/// of the run is built again, since it decides when contacts become possible.
void DistributedContact::persist(Archive& archive) {
  ContactBooks& books = contacts_.books();
  archive.share("work_elastic", books.work.elastic);
  archive.share("work_viscous", books.work.viscous);
  archive.share("work_friction", books.work.friction);
  archive.share("work_obstacles", books.work.obstacles);
  archive.share("stored_at_start", books.stored_at_start);
  archive.common("last_dt", books.last_dt, not_negative);
  archive.common("start_is_known", books.start_is_known);
  archive.common("dt", dt_);
  archive.common("time", time_);
  std::vector<double> rows = contacts_.history(), pairs;
  if (!archive.loading()) {
    const std::vector<double> all = all_gathered(rows, part_.comm);
    // In list order, independent of the ranks.
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
  archive.common("changed", changed);
  archive.common("possible", possible_);
  PairListExpiry watch = expiry_;
  if (!possible_) watch.persist(archive, part_);  // the list decides when contacts are possible
  archive.common("pairs", rows);
  archive.common("released", pairs);
  for (std::size_t k = 0; k < peak_.size(); ++k) {
    const std::string& obstacle = contacts_.obstacles()[k].name;
    for (auto& [key, vector] :
         {std::pair<std::string, Vec3<double>*>{"peak_", &peak_[k]}, {"impulse_", &impulse_[k]}}) {
      archive.common(key + obstacle + "_x", vector->x);
      archive.common(key + obstacle + "_y", vector->y);
      archive.common(key + obstacle + "_z", vector->z);
    }
  }
  if (!archive.loading()) return;
  overlap_told_ = true;  // the run has given this remark at its start
  for (std::size_t k = 0; k + 1 < pairs.size(); k += 2)
    contacts_.release(
        {static_cast<std::int32_t>(pairs[k]), static_cast<std::int32_t>(pairs[k + 1])});
  contacts_.restore(rows, changed);
  expiry_ = PairListExpiry(contacts_, part_.global_bodies);
  if (possible_ || changed) return;
  build(watch.at_build(part_));  // the same list as before the restart
  expiry_ = watch;
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
  auto contact = std::make_unique<DistributedContact>(part, lattice, options, std::move(obstacles));
  contact->check_start();
  return contact;
}

}  // namespace floe
