// The force of beams that crack: the beams of spatial_lanes.h with strengths and damage.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/collectives.h"
#include "beams/spatial_lanes.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "fracture/cracks.h"
#include "fracture/fracture.h"
#include "fracture/lanes.h"
#include "fracture_laws/strengths.h"
#include "fracture_laws/tip_beams.h"

namespace floe {
namespace {

/// Breakable beams of a part: a force, and the cracks of its beams.
template <Kinematics kinematics, bool damped, template <class> class Frame>
class BreakableBeams final : public SpatialBeams<kinematics, damped, Frame>,
                             public Commits<Spatial>,
                             public Persists,
                             public KeptCracks,
                             public Fracture {
  using Base = SpatialBeams<kinematics, damped, Frame>;
  using Base::blocks_, Base::dashpots_, Base::part_, Base::constants, Base::for_each, Base::record;
  using typename Base::Pointwise;
  using Constants = typename Base::Constants;

 public:
  BreakableBeams(const Part& part, const BeamOptions& beams, const FractureOptions& options,
                 Junctions junctions)
      : Base(part, beams),
        beams_(beams),
        options_(options),
        kind_(needed_criterion(options)),
        crushes_(options.compressive_strength > 0),
        whole_further_(further_strength(options)),
        strengths_(blocks_.size(), StrengthBlock{}),
        further_(kind_ == Criterion::general ? blocks_.size() : 0),
        damaged_(blocks_.size(), 0),
        cracks_(part.beams.bodies.size()),
        viscous_(damped ? blocks_.size() : 0),
        viscous_now_(viscous_),
        limits_(blocks_.size()) {
    const auto all = strengths(part, options);
    for (LimitBlock& limit : limits_) limit.values.fill(boundless);
    for (std::size_t m = 0; m < all.size(); ++m) {
      strengths_[m / lanes].set(m % lanes, all[m]);
      if (!further_.empty()) further_[m / lanes].set(m % lanes, whole_further_);
      set_limit(static_cast<std::int32_t>(m));
    }
    order_blocks();
    for (std::size_t lane = 0; lane < lanes; ++lane) whole_further_block_.set(lane, whole_further_);
    if (options.propagation == Propagation::energy) {
      if (junctions.facet_of.empty() && cracks_.beams() > 0)
        throw std::invalid_argument("make_breakable_beams: propagation: energy needs junctions");
      tips_.emplace(part, options, kinematics == Kinematics::linear, std::move(junctions));
      whole_ = strengths_;
      set_all_strengths();
    }
  }

  Roles<Spatial> roles() override {
    Roles<Spatial> roles = Base::roles();
    roles.commits = this;
    roles.persists = this;
    if (tips_) roles.device = nullptr;
    return roles;
  }

  void describe(DeviceModel& model) override {
    Base::describe(model);
    DeviceBreaking breaking;
    breaking.general = kind_ == Criterion::general;
    breaking.crushes = crushes_;
    breaking.kept = this;
    for (std::int32_t m = 0; m < part_.beams.size(); ++m) {
      const std::size_t b = this->slot(m) / lanes, lane = this->slot(m) % lanes;
      const Strength<double> s = whole_strength(m);
      const double of_ice = factor(part_.beams.energy, m);
      const Vec3<double> middle = 0.5 * (centre_at_rest(m, 0) + centre_at_rest(m, 1));
      breaking.beams.push_back({s.axial, s.bending_y, s.bending_z, s.shear, s.torsion, area(m),
                                of_ice * options_.energy, of_ice * options_.energy_shear, middle.x,
                                middle.y, middle.z, whole_further_.transverse,
                                whole_further_.pressure, whole_further_.friction});
      breaking.limits.push_back(limits_[b].values[lane]);
    }
    model.breaking = std::move(breaking);
  }

  /// A block with an overloaded or damaged beam is added as a whole, with softened stiffnesses. So
  /// every beam is computed by the same instructions, whatever its neighbours in the block.
  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    kind_ == Criterion::plain ? add_by<Criterion::plain>(state, wrenches)
                              : add_by<Criterion::general>(state, wrenches);
  }

  template <Criterion kind>
  [[gnu::flatten]] void add_by(const State<Spatial>& state, Wrenches<Spatial>& wrenches) {
    growing_.clear();
    overloaded_.clear();
    const double* records = state.records.data();
    double* values = wrenches.values.data();
    const bool far = Base::bodies_are_far(state);
    Lanes lost(0.0), lost_before(0.0);
    for (std::size_t k = 0; k < live_.size(); ++k) {
      const std::size_t b = live_[k],
                        soon = live_[std::min(k + Base::blocks_ahead, live_.size() - 1)];
      prefetch(blocks_[soon]);
      prefetch(limits_[soon]);
      if constexpr (damped) {
        prefetch(dashpots_[soon]);
        prefetch(viscous_[soon]);
      }
      if (far) {
        const std::size_t next = std::min(k + Base::blocks_ahead / 2, live_.size() - 1);
        Base::prefetch_bodies(blocks_[live_[next]], records, values);
      }
      const BeamBlock<Frame>* block = &blocks_[b];
      const DashpotBlock* dashpots = damped ? &dashpots_[b] : nullptr;
      const LimitBlock* limit = &limits_[b];
      const auto take_softened = [&] {
        soften(b, state);
        block = &soft_block_, dashpots = &soft_dashpots_, limit = &unbreakable_;
      };
      if (damaged_[b] != 0) take_softened();
      bool again = false;
      do {
        again = false;
        const auto give_way = [&] {
          take_softened();
          again = true;
          return Lanes(0.0);
        };
        lost +=
            add_block<kinematics, damped>(*block, dashpots, records, values,
                                          BreakableBlock<kind, decltype(give_way)>{
                                              *limit, strengths_[b], further_of(kind, further_, b),
                                              crushes_, give_way, damped ? &viscous_[b] : nullptr,
                                              damped ? &viscous_now_[b] : nullptr, &lost_before});
      } while (again);
    }
    if constexpr (damped) {
      this->power_lost_ = reduce(lost);
      power_before_ = reduce(lost_before);
    }
  }

  /// Adds the tangent at the damage of the last commit; for a beam that softens this is the secant.
  bool add_tangent(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    Tangent<Spatial>::PairBlock block;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      if (broken(m)) return;
      Pointwise::tangent(present(m, state), nullptr, record(state, i), record(state, j),
                         tangent.symmetric(), block);
      tangent.add_pair(i, j, block);
    });
    return true;
  }

  /// Makes the damage of the last evaluation (dynamics) or of advance() (statics) history.
  void commit(const State<Spatial>& state, double dt) override {
    if constexpr (damped) std::swap(viscous_, viscous_now_);
    for (const Growth& g : growing_) take(g);
    growing_.clear();
    if (std::exchange(packed_, false)) order_blocks();
    dt_ = dt;
    released_.clear();
    for (const std::int32_t m : newly_broken_) {
      const auto [i, j] = item(part_.beams.bodies, m);
      released_.push_back({item(part_.global, i), item(part_.global, j)});
    }
    if (tips_ && options_.dynamic) follow(tips_->propagate(newly_broken_, overloaded_, state));
    newly_broken_.clear();
    if (!options_.dynamic) {
      kept_ = cracks_.all();
      kept_energy_ = dissipated_;
      kept_released_ = released_energy_;
      if (tips_) tips_->keep();
    }
  }

  /// The forces of dashpots jump when beams break. Those at the start of the last step are kept,
  /// since the energy balance of leapfrog is exact for linear strains with both.
  LaterPowers later_powers() const override { return LaterPowers::in_next_evaluation; }
  void kept_powers(std::span<double> out) const override { out.front() = -power_before_; }

  void report(const State<Spatial>& state, std::span<const double> works,
              Columns& columns) const override {
    Base::report(state, works, columns);
    double fracture = dissipated_;
    std::array<double, 4> counts{};  // damaged, broken, brittle, crushed
    const auto count = [&](const Crack& c, double sign) {
      counts[0] += sign;
      if (c.broken()) counts[1] += sign;
      if (c.brittle()) counts[2] += sign;
      if (c.broken() && c.crushed) counts[3] += sign;
    };
    for (const Crack& c : cracks_.all()) {
      if (counts_here(c.beam)) count(c, 1);
    }
    // The findings of the last evaluation count, although they become history at the commit only.
    for (const Growth& g : growing_) {
      if (!counts_here(g.crack.beam)) continue;
      fracture += g.dissipated;
      if (const Crack* before = crack(g.crack.beam)) count(*before, -1);
      count(g.crack, 1);
    }
    columns.add("energy_fracture", fracture);
    if (!options_.dynamic) columns.add("energy_released", released_energy_);
    columns.add("beams_damaged", counts[0]);
    columns.add("beams_broken", counts[1]);
    columns.add("beams_brittle", counts[2]);
    if (crushes_) columns.add("beams_crushed", counts[3]);
  }

  void persist(Archive& archive) override {
    archive.share("energy_fracture", dissipated_);
    archive.common("last_dt", dt_);
    std::vector<Crack> mine;
    for (const Crack& c : cracks_.all()) {
      if (!counts_here(c.beam)) continue;
      mine.push_back(c);
      mine.back().beam = item(part_.global_beam, c.beam);
    }
    persist_cracks(archive, part_, mine);
    if constexpr (damped) remember_dashpots(archive);
    if (tips_) {
      const TipBeams::Change change = tips_->persist(archive, mine);
      for (const std::int32_t m : change.doomed) mark(this->slot(m) / lanes);
      if (archive.loading()) set_all_strengths();
    }
    if (archive.loading()) set_cracks(std::move(mine));
    if (std::exchange(packed_, false)) order_blocks();
  }

  // -- Histories that a back end keeps
  void read(std::vector<double>& cracks, std::vector<float>& viscous) const override {
    cracks = cracks_.as_numbers();
    viscous.clear();
    if constexpr (damped) {
      for (std::size_t m = 0; m < cracks_.beams(); ++m)
        for_viscous(static_cast<std::int32_t>(m),
                    [&](const float& value) { viscous.push_back(value); });
    }
  }
  void write(std::span<const double> cracks, std::span<const float> viscous, double dt) override {
    growing_.clear();
    dt_ = dt;
    // The sum does not depend on how often somebody has asked.
    if (!cracks.empty()) dissipated_ = 0;
    for (std::size_t m = 0; m < cracks_.beams() && !cracks.empty(); ++m) {
      const auto of = cracks.subspan(Cracks::numbers * m).first<Cracks::numbers>();
      const Crack now = Cracks::of_numbers(static_cast<std::int32_t>(m), of);
      const Crack* known = crack(now.beam);
      dissipated_ += now.dissipated;
      if (!(now.kappa > 0)) continue;
      if (known == nullptr || known->kappa != now.kappa || known->damage != now.damage) put(now);
    }
    if (std::exchange(packed_, false)) order_blocks();
    std::size_t next = 0;
    for (std::size_t m = 0; m < cracks_.beams() && !viscous.empty(); ++m)
      for_viscous(static_cast<std::int32_t>(m), [&](float& value) { value = viscous[next++]; });
  }

  std::int64_t folded(const State<Spatial>& state) const override {
    std::int64_t count = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      count += !broken(m) && Pointwise::is_folded(constants(m), record(state, i), record(state, j));
    });
    return count;
  }

  std::vector<BeamSection> sections(const State<Spatial>& state) const override {
    std::vector<BeamSection> all;
    all.reserve(part_.beams.bodies.size());
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      all.push_back(
          broken(m) ? BeamSection{}
                    : Pointwise::section(present(m, state), record(state, i), record(state, j)));
    });
    return all;
  }

  // -- Fracture
  double damage(std::int32_t beam) const override {
    const Crack* c = crack(beam);
    return c != nullptr ? c->damage : 0.0;
  }
  std::vector<Break> breaks() const override {
    std::vector<Break> all;
    for (const Crack& c : cracks_.all()) {
      if (c.broken() && counts_here(c.beam))
        all.push_back({c.time, item(part_.global_beam, c.beam), c.place, c.mode_mix, c.dissipated,
                       c.nominal, c.brittle(), c.at_tip, area(c.beam)});
    }
    return all;
  }
  std::span<const std::array<std::int32_t, 2>> released() const override { return released_; }

  double overload(const State<Spatial>& state) const override {
    double most = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Lanes s2 = whole_criterion(b, state);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::int32_t m = beam_at(b, lane);
        if (m != none && crack(m) == nullptr) most = std::max(most, double(s2[lane]));
      }
    }
    most = std::sqrt(largest_over_ranks(most, part_.comm));
    for (const TipOverload& tip : overloads_at_tips(state)) most = std::max(most, tip.s);
    return most;
  }

  double nearness_to_change(const State<Spatial>& state, double growth) const override {
    double most = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Lanes s2 = whole_criterion(b, state);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::int32_t m = beam_at(b, lane);
        if (m == none) continue;
        const Crack* c = crack(m);
        if (c != nullptr && c->broken()) continue;
        const double limit =
            c == nullptr ? 1 : c->kappa + growth * std::min(c->kappa, c->ultimate - 1);
        most = std::max(most, std::sqrt(s2[lane]) / limit);
      }
    }
    most = largest_over_ranks(most, part_.comm);
    for (const TipOverload& tip : overloads_at_tips(state)) most = std::max(most, tip.s);
    return most;
  }

  Advance advance(const State<Spatial>& state) override {
    constexpr double rounding = 1e-6;  // relative growth of s below this counts as none
    growing_.clear();
    RankedValue worst{0, -1};  // largest s/kappa of the beams that would break
    const std::vector<TipOverload> at_tips = overloads_at_tips(state);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Lanes s2 = whole_criterion(b, state);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::int32_t m = beam_at(b, lane);
        if (m == none) continue;
        const std::int32_t beam = item(part_.global_beam, m);
        const double s = std::sqrt(s2[lane]), s_tip = overload_of(beam, at_tips);
        if (s_tip > 1 + rounding && s_tip > s) {  // else as elsewhere, by s
          growing_.push_back(growth(m, s, state, true));
          if (s_tip > worst.value) worst = {s_tip, beam};
          continue;
        }
        if (broken(m) || (s <= kappa(m) * (1 + rounding) && !crushes_damaged(m, state))) continue;
        growing_.push_back(growth(m, s, state));
        if (growing_.back().crack.broken() && s / kappa(m) > worst.value)
          worst = {s / kappa(m), beam};
      }
    }
    worst = largest_of_ranks(worst, part_.comm);
    bool softened = false;
    for (const Growth& g : growing_) {
      const bool chosen = item(part_.global_beam, g.crack.beam) == worst.index;
      if (g.crack.broken() && !chosen) continue;
      take(g);
      softened = true;
    }
    growing_.clear();
    if (std::exchange(packed_, false)) order_blocks();
    softened = on_any_rank(softened, part_.comm);
    if (tips_ && worst.index >= 0) follow(tips_->lose(static_cast<std::int32_t>(worst.index)));
    if (worst.index >= 0) return Advance::broke;
    return softened ? Advance::softened : Advance::none;
  }

  void retreat() override {
    for (const Crack& c : cracks_.clear()) restore(c.beam);
    newly_broken_.clear();
    for (const Crack& c : kept_) put(c);
    if (std::exchange(packed_, false)) order_blocks();
    if (tips_) {
      tips_->retreat();
      set_all_strengths();
    }
    dissipated_ = kept_energy_;
    released_energy_ = kept_released_;
  }

  void add_released(double energy) override {
    if (rank(part_.comm) == 0) released_energy_ += energy;
  }

 private:
  static constexpr std::int32_t none = -1;
  static constexpr double boundless = std::numeric_limits<double>::infinity();

  /// Visits the forces of a beam's dashpots at the start of the last step.
  template <class Visit>
  void for_viscous(std::int32_t m, Visit visit) {
    for (auto& values : viscous_[this->slot(m) / lanes].values)
      visit(values[this->slot(m) % lanes]);
  }
  template <class Visit>
  void for_viscous(std::int32_t m, Visit visit) const {
    for (const auto& values : viscous_[this->slot(m) / lanes].values)
      visit(values[this->slot(m) % lanes]);
  }

  bool counts_here(std::int32_t m) const { return item(part_.counts_here, m) != 0; }
  const Crack* crack(std::int32_t m) const { return cracks_.of(m); }
  bool broken(std::int32_t m) const { return cracks_.is_broken(m); }
  bool is_whole(std::int32_t m) const override { return !broken(m); }
  double kappa(std::int32_t m) const { return cracks_.kappa(m); }
  static const FurtherBlock* further_of(Criterion kind, const std::vector<FurtherBlock>& all,
                                        std::size_t b) {
    return kind == Criterion::plain ? nullptr : &all[b];
  }
  /// s^2 of the undamaged beams of a block, which decides on damage. The hook in add() only selects
  /// the blocks for which it is computed.
  Lanes criterion_of(const std::vector<StrengthBlock>& of, const std::vector<FurtherBlock>& further,
                     std::size_t b, const State<Spatial>& state) const {
    return block_criterion<kinematics>(blocks_[b], of[b], further_of(kind_, further, b), crushes_,
                                       state.records.data());
  }
  /// The same by the strengths at initiation, and by those at tips where beams are tip beams.
  Lanes whole_criterion(std::size_t b, const State<Spatial>& state) const {
    if (!tips_) return criterion_of(strengths_, further_, b, state);
    if (kind_ == Criterion::plain) return criterion_of(whole_, further_, b, state);
    return block_criterion<kinematics>(blocks_[b], whole_[b], &whole_further_block_, crushes_,
                                       state.records.data());
  }
  Lanes tip_criterion(std::size_t b, const State<Spatial>& state) const {
    return tips_ ? criterion_of(strengths_, further_, b, state) : Lanes(0.0);
  }
  /// Whether pressure is the worst for beam m, with s > 1, under these elastic section forces.
  bool crushes(std::int32_t m, const BeamStress<double>& force) const {
    if (!crushes_) return false;
    const Criteria<double> s2 = criteria(whole_strength(m), whole_further_, force, true);
    return s2.pressure > 1 && s2.pressure > s2.tension;
  }
  /// Whether pressure breaks beam m, which was damaged otherwise before.
  bool crushes_damaged(std::int32_t m, const State<Spatial>& state) const {
    const Crack* c = crack(m);
    return crushes_ && c != nullptr && !c->broken() && !c->crushed &&
           crushes(m, elastic_stress(constants(m), strains(m, state)));
  }
  double area(std::int32_t m) const {
    return item(part_.beams.width, m) * item(part_.beams.height, m);
  }

  // -- Tips of cracks; without Propagation::energy there are none.
  /// Strengths at initiation, also of beams at tips.
  Strength<double> whole_strength(std::int32_t m) const {
    return (tips_ ? whole_ : strengths_)[this->slot(m) / lanes].get(this->slot(m) % lanes);
  }
  void set_strength(std::int32_t m) {
    const std::size_t b = this->slot(m) / lanes, lane = this->slot(m) % lanes;
    TipBeams::Strengths now{whole_[b].get(lane), whole_further_};
    if (!broken(m) && tips_->weakens(m, now.first)) now = tips_->armed(m, now);
    strengths_[b].set(lane, now.first);
    if (kind_ != Criterion::plain) further_[b].set(lane, now.further);
    set_limit(m);
  }
  void set_all_strengths() {
    for (std::int32_t m = 0; m < part_.beams.size(); ++m) set_strength(m);
  }
  /// Takes over what a change of tips means for local beams.
  void follow(const TipBeams::Change& change) {
    for (const std::int32_t m : change.strengths) set_strength(m);
    for (const std::int32_t m : change.doomed) mark(this->slot(m) / lanes);
  }
  /// s_t of a local beam by the strengths of tips, 0 if it is not at one.
  double stress_at_tip(std::int32_t m, const State<Spatial>& state) const {
    if (broken(m) || !tips_->weakens(m, whole_strength(m))) return 0;
    return std::sqrt(criterion(tip_strength(part_, m, options_),
                               elastic_stress(constants(m), strains(m, state))));
  }
  /// Statics: tip beams of this rank with s_t > TipBeams::armed_from, and their s_t.
  std::vector<ArmedBeam> armed(const State<Spatial>& state) const {
    std::vector<ArmedBeam> all;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Lanes s2 = tip_criterion(b, state);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::int32_t m = beam_at(b, lane);
        if (m == none || !(s2[lane] > 1)) continue;
        if (const double s = stress_at_tip(m, state); s > TipBeams::armed_from)
          all.push_back({s, m});
      }
    }
    return all;
  }
  /// Statics: overloads of beams at tips, those of all ranks, sorted by beam. Collective.
  std::vector<TipOverload> overloads_at_tips(const State<Spatial>& state) const {
    return tips_ ? tips_->overloads(armed(state), state) : std::vector<TipOverload>{};
  }

  BeamStrains<double> strains(std::int32_t m, const State<Spatial>& state) const {
    const auto [i, j] = item(part_.beams.bodies, m);
    return Pointwise::strains(constants(m), record(state, i), record(state, j));
  }
  static Softening softening(const Crack& c, const BeamStrains<double>& s) {
    return floe::softening(c.damage, s.delta <= 0 && !c.crushed, c.broken());
  }
  static BeamStress<double> as_stress(const BeamStrains<double>& s) {
    return {s.delta, s.gamma_y, s.gamma_z, s.psi};
  }
  /// Constants of beam m, softened by its damage at the present strains.
  Constants present(std::int32_t m, const State<Spatial>& state) const {
    Constants c = constants(m);
    if (const Crack* k = crack(m)) {
      const Softening left = softening(*k, strains(m, state));
      c.kn *= left.axial;
      for (double* rest : {&c.ksz, &c.ksy, &c.kt, &c.kby, &c.kbz}) *rest *= left.rest;
    }
    return c;
  }

  double stored(const State<Spatial>& state) const override {
    double energy = 0;
    for_each([&](std::int32_t m, std::int32_t i, std::int32_t j) {
      if (counts_here(m) && !broken(m))
        energy += Pointwise::energy(present(m, state), record(state, i), record(state, j));
    });
    for (const Growth& g : growing_) {
      if (counts_here(g.crack.beam)) energy -= g.released;
    }
    return energy;
  }

  /// Growth of the damage of beam m, whose s has passed kappa. In dynamics the dissipated energy is
  /// that of the forces of this state on the strains of the last one,
  /// 1/2 e_n k e_(n-1) (D_n - D_(n-1)), which makes the energy balance of leapfrog exact for linear
  /// strains (work by the mean of the forces at the two ends of a step). In statics, on a
  /// proportional path from rest, it is U_1 s kappa (D - D_old) with s at most s_u, exact for any
  /// step: sum_k U_1 k^2 D'(k) dk.
  /// \param at_tip  the beam breaks at a tip, and dissipates what it stores
  [[gnu::noinline, gnu::cold]] Growth growth(std::int32_t m, double s, const State<Spatial>& state,
                                             bool at_tip = false) const {
    const auto [i, j] = item(part_.beams.bodies, m);
    const Constants c = constants(m);
    const BeamStrains<double> e = strains(m, state);
    const BeamStress<double> strain = as_stress(e), force = elastic_stress(c, e);
    DamageEnergy energy = damage_energy(force, strain);
    const Crack* known = crack(m);
    const double before = known != nullptr ? known->damage : 0, passed = kappa(m);
    const bool crushing = !at_tip && crushes(m, force);
    const double of_ice = factor(part_.beams.energy, m);
    Crack next = grown(known, s, crushing, at_tip, energy, area(m), of_ice * options_.energy,
                       of_ice * options_.energy_shear);
    next.beam = m;
    DamageEnergy path = energy;
    if (options_.dynamic) {
      path = energy_over_step(next, force, strain, rates(c, e, record(state, i), record(state, j)),
                              dt_);
    } else if (!breaks_at_once(known, crushing, at_tip)) {
      // A beam that jumps beyond s_u dissipates what is left of G A; the rest is released.
      const double most = next.brittle() ? s : std::min(s, next.ultimate);
      for (double* part : {&path.stretch, &path.shear, &path.bending})
        *part *= most == s ? passed / s : passed * most / (s * s);
    }
    if (next.broken()) {
      next.time = state.time;
      next.place = 0.5 * (end_of(m, 0, state) + end_of(m, 1, state));
    }
    return dissipating(next, before, crushing, energy, path);
  }

  /// Returns where the centroid of a beam's body is at rest, on the beam's side of the period [m].
  Vec3<double> centre_at_rest(std::int32_t m, std::size_t end) const {
    const Vec3<double> at = item(part_.bodies.position, item(part_.beams.bodies, m)[end]);
    return end == 1 && !part_.beams.image.empty() ? at + item(part_.beams.image, m) : at;
  }
  /// Returns where an end of a beam is [m].
  Vec3<double> end_of(std::int32_t m, std::size_t end, const State<Spatial>& state) const {
    const auto body = static_cast<std::size_t>(item(part_.beams.bodies, m)[end]);
    const Vec3<double> at = centre_at_rest(m, end) + displacement(state, body);
    if (part_.beams.offsets.empty()) return at;
    return at + rotate(normalised(rotation(state, body)), offset(part_.beams, m, end));
  }

  static BeamStress<double> rates(const Constants& c, const BeamStrains<double>& e, const double* i,
                                  const double* j) {
    const auto three = [](const double* r) { return Vec3<double>{r[0], r[1], r[2]}; };
    return BeamKernel<kinematics>::rates(
        c, e, three(j + Spatial::velocity) - three(i + Spatial::velocity),
        three(i + Spatial::angular_velocity), three(j + Spatial::angular_velocity));
  }

  /// Computes the softened copy of block b, which has a beam that is damaged or may become so at
  /// this state; notes growths of damage (dynamics).
  [[gnu::noinline, gnu::cold, gnu::flatten]] void soften(std::size_t b,
                                                         const State<Spatial>& state) {
    const Lanes s2 = whole_criterion(b, state), at_tips = tip_criterion(b, state);  // may be armed
    std::array<Softening, lanes> left{};
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::int32_t m = beam_at(b, lane);
      if (m == none) continue;
      const Crack* c = crack(m);
      const double passed = kappa(m);
      const bool falls = tips_ && tips_->is_doomed(m);
      if (options_.dynamic && at_tips[lane] > 1 && !falls) {
        if (const double s = stress_at_tip(m, state); s > TipBeams::armed_from)
          overloaded_.push_back({s, m});
      }
      if (options_.dynamic && falls && !broken(m)) {
        growing_.push_back(growth(m, std::sqrt(s2[lane]), state, true));
        c = &growing_.back().crack;
      } else if (options_.dynamic && !broken(m) &&
                 (s2[lane] > passed * passed || crushes_damaged(m, state))) {
        growing_.push_back(growth(m, std::sqrt(s2[lane]), state));
        c = &growing_.back().crack;
      }
      if (c != nullptr) left[lane] = softening(*c, strains(m, state));
    }
    soft_block_ = softened(blocks_[b], left);
    if constexpr (damped) soft_dashpots_ = softened(dashpots_[b], left);
  }

  /// Makes a growth of damage history.
  void take(const Growth& g) {
    put(g.crack);
    if (g.crack.broken()) newly_broken_.push_back(g.crack.beam);
    if (!counts_here(g.crack.beam)) return;
    dissipated_ += g.dissipated;
  }

  /// Saves or loads the forces of dashpots at the start of the last step, which the losses of the
  /// next step depend on.
  void remember_dashpots(Archive& archive) {
    std::vector<std::int32_t> beams;
    for (std::int32_t m = 0; m < part_.beams.size(); ++m) {
      if (archive.loading() || counts_here(m)) beams.push_back(m);
    }
    std::vector<double> rows;
    const auto each = [&](auto visit) {
      for (const std::int32_t m : beams) for_viscous(m, visit);
    };
    each([&](float value) { rows.push_back(static_cast<double>(value)); });
    archive.beam_rows("viscous", beams, rows, 6);
    std::size_t k = 0;
    each([&](float& value) { value = static_cast<float>(rows[k++]); });
  }

  /// Enters a crack. A broken beam has no stiffness, joins a body to itself and goes to the end of
  /// its group of blocks, of which only the blocks with another beam are computed.
  void put(const Crack& c) {
    cracks_.put(c);
    if (c.broken()) {
      const std::size_t b = this->slot(c.beam) / lanes, lane = this->slot(c.beam) % lanes;
      BeamBlock<Frame>& block = blocks_[b];
      Constants nothing = block.get(lane);
      for (double* k :
           {&nothing.kn, &nothing.ksz, &nothing.ksy, &nothing.kt, &nothing.kby, &nothing.kbz})
        *k = 0;
      block.set(lane, nothing);
      block.j[lane] = block.i[lane];
      if constexpr (damped) {
        for (auto& values : dashpots_[b].values) values[lane] = 0;
        for (auto* viscous : {&viscous_, &viscous_now_})  // either may stay where none computes it
          for (auto& values : (*viscous)[b].values) values[lane] = 0;
      }
      pack(static_cast<std::size_t>(c.beam) / group);
    } else {
      mark(this->slot(c.beam) / lanes);
    }
  }

  /// Makes beam m undamaged again.
  void restore(std::int32_t m) {
    this->set(m, beams_);
    pack(static_cast<std::size_t>(m) / group);
  }

  /// Updates damaged_ of block b.
  void mark(std::size_t b) {
    damaged_[b] = 0;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::int32_t m = beam_at(b, lane);
      if (m == none) continue;
      const Crack* c = crack(m);
      if (c != nullptr && !c->broken()) damaged_[b] = 1;
      if (tips_ && tips_->is_doomed(m)) damaged_[b] = 1;
    }
  }

  // -- Order of the beams in the blocks. Beams lie in groups; in each the broken ones come last.
  // The order follows from which beams are broken, so it is the same after a restart, and bodies
  // get the shares of their beams in the order of the beams, whatever blocks these lie in.
  /// Beams of a group: a break moves the beams of its group only.
  static constexpr std::size_t group = 64;

  /// The beam in a lane of a block; none for the lanes that fill up the last block.
  std::int32_t beam_at(std::size_t b, std::size_t lane) const {
    const std::size_t at = b * lanes + lane;
    if (at >= cracks_.beams()) return none;
    return beams_at_.empty() ? static_cast<std::int32_t>(at) : beams_at_[at];
  }
  /// Puts the broken beams of a group last.
  void pack(std::size_t g) {
    if (beams_at_.empty()) {
      beams_at_.resize(cracks_.beams());
      std::iota(beams_at_.begin(), beams_at_.end(), 0);
      this->slots_ = beams_at_;
    }
    const std::size_t first = g * group, last = std::min(first + group, cracks_.beams());
    std::array<std::size_t, group> from{};  // slot in the group that a slot's numbers come from
    std::size_t to = 0;
    for (const bool gone : {false, true}) {
      for (std::size_t m = first; m < last; ++m) {
        const auto beam = static_cast<std::int32_t>(m);
        if (broken(beam) == gone) from[to++] = this->slot(beam) - first;
      }
    }
    const std::span<const std::size_t> moves(from.data(), to);
    permute(blocks_, first, moves);
    if constexpr (damped) permute(dashpots_, first, moves);
    permute(strengths_, first, moves);
    permute(limits_, first, moves);
    if constexpr (damped) permute(viscous_, first, moves), permute(viscous_now_, first, moves);
    if (!further_.empty()) permute(further_, first, moves);
    if (tips_) permute(whole_, first, moves);
    std::array<std::int32_t, group> beams{};
    for (std::size_t k = 0; k < to; ++k) beams[k] = beams_at_[first + from[k]];
    for (std::size_t k = 0; k < to; ++k) {
      beams_at_[first + k] = beams[k];
      item(this->slots_, beams[k]) = static_cast<std::int32_t>(first + k);
    }
    for (std::size_t b = first / lanes; b * lanes < last; ++b) mark(b);
    packed_ = true;
  }
  /// Moves the numbers of beams between the lanes of the blocks from slot `first` on.
  /// \param from  per slot: the slot, counted from `first`, whose numbers it gets
  template <class Block>
  static void permute(std::vector<Block>& blocks, std::size_t first,
                      std::span<const std::size_t> from) {
    std::array<Block, group / lanes> old;
    std::copy_n(blocks.begin() + static_cast<std::ptrdiff_t>(first / lanes),
                (from.size() + lanes - 1) / lanes, old.begin());
    for (std::size_t k = 0; k < from.size(); ++k)
      blocks[(first + k) / lanes].take(k % lanes, old[from[k] / lanes], from[k] % lanes);
  }
  /// Lists the blocks that have a beam which is not broken.
  void order_blocks() {
    live_.clear();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (!broken(beam_at(b, 0))) live_.push_back(static_cast<std::uint32_t>(b));
    }
  }

  /// Sets the strain energy from which on the strength of beam m is looked at.
  void set_limit(std::int32_t m) {
    constexpr double margin = 0.999;
    const std::size_t b = this->slot(m) / lanes, lane = this->slot(m) % lanes;
    const FurtherStrength<double> further =
        further_.empty() ? FurtherStrength<double>{} : further_[b].get(lane);
    const double per_energy = overload_per_energy(constants(m), strengths_[b].get(lane),
                                                  further_.empty() ? nullptr : &further, crushes_);
    limits_[b].values[lane] = per_energy > 0 ? margin / per_energy : boundless;
  }

  /// Enters the cracks of local beams. \param all  cracks of all ranks, with global beams
  void set_cracks(std::vector<Crack> all) {
    for (Crack& c : all) {
      const auto found =
          std::lower_bound(part_.global_beam.begin(), part_.global_beam.end(), c.beam);
      if (found == part_.global_beam.end() || *found != c.beam) continue;
      c.beam = static_cast<std::int32_t>(found - part_.global_beam.begin());
      put(c);
    }
  }

  const BeamOptions beams_;
  const FractureOptions options_;
  const Criterion kind_;
  const bool crushes_;                           ///< beams have a compressive strength
  const FurtherStrength<double> whole_further_;  ///< of beams that are not at tips
  FurtherBlock whole_further_block_;             ///< the same in all lanes
  std::vector<StrengthBlock> strengths_;
  std::vector<FurtherBlock> further_;  ///< with Criterion::general
  std::vector<std::uint8_t> damaged_;  ///< per block: has a beam that is damaged but not broken
  Cracks cracks_;
  std::vector<Crack> kept_;                 ///< statics: at the last commit
  std::vector<std::int32_t> newly_broken_;  ///< local beams, since the last commit
  std::vector<std::array<std::int32_t, 2>> released_;
  std::vector<ViscousBlock> viscous_;      ///< forces of dashpots at the start of the last step
  std::vector<ViscousBlock> viscous_now_;  ///< in the last evaluation, a by-product
  double power_before_ = 0;                ///< of viscous_ at the rates of the last evaluation [W]
  std::vector<LimitBlock> limits_;
  std::vector<std::int32_t> beams_at_;  ///< per slot; empty while no beam has broken
  std::vector<std::uint32_t> live_;     ///< blocks with a beam that is not broken
  bool packed_ = false;                 ///< the order has changed since live_ was made
  const LimitBlock unbreakable_ = [] {
    LimitBlock limit;
    limit.values.fill(boundless);
    return limit;
  }();
  BeamBlock<Frame> soft_block_;  ///< work space of soften()
  DashpotBlock soft_dashpots_;
  std::vector<Growth> growing_;              ///< by-product of the last evaluation, no history
  double dissipated_ = 0, kept_energy_ = 0;  ///< by counted beams; the same at the last commit [J]
  /// Statics, on rank 0: energy that breaks released; the same at the last commit [J].
  double released_energy_ = 0, kept_released_ = 0;
  std::optional<TipBeams> tips_;       ///< with Propagation::energy
  std::vector<StrengthBlock> whole_;   ///< strengths at initiation, also of beams at tips
  std::vector<ArmedBeam> overloaded_;  ///< dynamics: in the last evaluation, a by-product
  double dt_ = 0;                      ///< length of the last step [s]
};

template <Kinematics kinematics, bool damped, template <class> class Frame>
BreakableForce make_with(const Part& part, const BeamOptions& beams,
                         const FractureOptions& fracture, Junctions junctions) {
  auto force = std::make_unique<BreakableBeams<kinematics, damped, Frame>>(part, beams, fracture,
                                                                           std::move(junctions));
  Fracture* cracks = force.get();
  return {std::move(force), cracks};
}

template <Kinematics kinematics>
BreakableForce make_kinematic(const Part& part, const BeamOptions& beams,
                              const FractureOptions& fracture, Junctions junctions) {
  const auto make = [&]<template <class> class Frame>() {
    return beams.damping_ratio > 0
               ? make_with<kinematics, true, Frame>(part, beams, fracture, std::move(junctions))
               : make_with<kinematics, false, Frame>(part, beams, fracture, std::move(junctions));
  };
  if (any_eccentric(part)) return make.template operator()<EccentricFrame>();
  if (all_flat(part)) return make.template operator()<FlatFrame>();
  return make.template operator()<AnyFrame>();
}

}  // namespace

BreakableForce make_breakable_beams(const Part& part, const BeamOptions& beams,
                                    const FractureOptions& fracture, Junctions junctions) {
  return beams.kinematics == Kinematics::linear
             ? make_kinematic<Kinematics::linear>(part, beams, fracture, std::move(junctions))
             : make_kinematic<Kinematics::corotational>(part, beams, fracture,
                                                        std::move(junctions));
}

}  // namespace floe
