#include "run/dynamic_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/collectives.h"
#include "base/format.h"
#include "base/on_root.h"
#include "run/numbers.h"
#include "run/ts_options.h"

namespace floe {

template <class Space>
DynamicRun<Space>::DynamicRun(std::string_view what, std::string_view type, Model<Space>& model,
                              const DynamicOptions& options, Observer<Space> observer)
    : model_(model),
      options_(options),
      observer_(std::move(observer)),
      state_(static_cast<std::size_t>(model.part().local)),
      wrenches_(static_cast<std::size_t>(model.part().local)),
      works_(model),
      checkpoints_(options_.checkpoint, model.part()),
      what_(what),
      type_(type) {
  // Floor of the energies: the strain energy of strains of 1e-12 in all beams.
  double energy = 0;
  const double strain = 1e-12 * model.length_scale();
  for (std::int32_t b = 0; b < model.part().owned; ++b) {
    for (const auto& force : model.forces()) {
      if (const auto* role = force->roles().step)
        energy += role->stiffness_bound(b) * strain * strain;
    }
  }
  energy = sum_over_ranks(energy, model.part().comm);
  ledger_.set_floor(std::max(energy, std::numeric_limits<double>::min()));
  if (options_.balance) balance_.emplace(*options_.balance);
  ice_.bodies = model.part().global_bodies;
}

template <class Space>
void DynamicRun<Space>::read_options() {
  check(TSSetTimeStep(ts_, options_.dt > 0 ? options_.dt : -1.0));
  check(TSSetMaxTime(ts_, options_.end));
  check(TSSetExactFinalTime(ts_, TS_EXACTFINALTIME_STEPOVER));
  if (const auto given = given_max_steps()) most_steps_ = *given;
  {
    const HiddenMaxSteps hidden;
    check(TSSetFromOptions(ts_));
  }
  const double of_scene = options_.dt;
  check(TSGetTimeStep(ts_, &options_.dt));
  if (options_.dt > 0 && options_.dt != of_scene) dt_key_ = "ts_dt";
  check(TSGetMaxTime(ts_, &options_.end));
  given_ = options_.dt > 0;
}

template <class Space>
void DynamicRun<Space>::plan(double wanted) {
  const double steps = std::ceil(options_.end / wanted * (1 - 1e-12));
  if (!adaptive_) require_few_steps(steps, wanted);
  steps_ = adaptive_ ? 1 : std::max<std::int64_t>(static_cast<std::int64_t>(steps), 1);
  dt_ = adaptive_ ? std::min(wanted, options_.end) : options_.end / static_cast<double>(steps_);
  result_.dt = dt_;
  set_sampling();
}

template <class Space>
void DynamicRun<Space>::require_few_steps(double steps, double step) const {
  constexpr double countable = 1e18;  // fits 64 bits
  if (steps <= countable &&
      std::min(steps, static_cast<double>(most_steps_)) <= options_.most_steps)
    return;
  throw InputError(dt_key_ + ": " + text(step) + " s" +
                   (result_.limited_by.empty()
                        ? ""
                        : " (stable: " + text(result_.stable_dt) + " s, limited by the " +
                              result_.limited_by + ")") +
                   " would take " + text(steps) + " steps to time: end " + text(options_.end) +
                   " s, at most " + text(options_.most_steps) + " are made (limit: steps)");
}

template <class Space>
bool DynamicRun<Space>::announce() const {
  if (!options_.on_plan) return true;
  RunPlan plan;
  plan.end = options_.end;
  plan.dt = dt_;
  plan.adaptive = adaptive_;
  plan.given = given_;
  plan.stable_dt = result_.stable_dt;
  plan.limited_by = result_.limited_by;
  if (!adaptive_) plan.steps = static_cast<double>(std::min(steps_, most_steps_));
  plan.done = static_cast<double>(done_);
  add_to(plan);
  return options_.on_plan(plan);
}

template <class Space>
void DynamicRun<Space>::replan(double wanted) {
  if (adaptive_) {
    dt_ = std::min(dt_, wanted);
  } else {
    time_base_ = time_;
    step_base_ = done_;
    const double left = options_.end - time_;
    steps_ = static_cast<std::int64_t>(std::ceil(left / wanted * (1 - 1e-12)));
    dt_ = left / static_cast<double>(steps_);
    steps_ += done_;
    limit_steps();
  }
  result_.dt = dt_;
  check(TSSetTimeStep(ts_, dt_));
}

/// Saves or loads the whole history of the run. Collective.
template <class Space>
void DynamicRun<Space>::persist(Archive& archive) {
  if (!archive.loading()) bring_state();
  largest_ = largest_over_ranks(largest_, model_.part().comm);
  archive.enter("run");
  std::string type = type_;
  archive.common("type", type);
  if (type != type_)
    throw OtherRun("checkpoint: restart: '" + options_.checkpoint.restart + "' is of ts_type '" +
                   type + "', which keeps its state in another way than this run's '" + type_ +
                   "'");
  const std::string space = std::is_same_v<Space, Planar> ? "planar" : "spatial";
  std::string model = space;
  archive.common("model", model);
  if (model != space)
    throw OtherRun("checkpoint: restart: '" + options_.checkpoint.restart + "' is of a " + model +
                   " model, this run's is " + space + " (model: planar)");
  if (options_.supply && !archive.within_run()) {  // first, since all others are of these bodies
    persist_ice(archive);
    archive.enter("run");
  }
  archive.common("step", done_);
  archive.common("steps", steps_);
  archive.common("time", state_.time, not_negative);
  archive.common("dt", dt_, positive);
  archive.common("time_base", time_base_, not_negative);
  archive.common("step_base", step_base_);
  archive.common("stable_dt", result_.stable_dt, not_negative_or_infinite);
  archive.common("limited_by", result_.limited_by);
  archive.common("next_sample", next_sample_, not_negative_or_infinite);
  archive.common("sampled_step", sampled_, -1);
  archive.common("sampled_when_due", sampled_when_due_, -1);
  if (options_.supply) archive.common("ice_has_changed", ice_has_changed_);
  archive.common("largest_velocity2", largest_, not_negative);
  persist_own(archive);
  if (balance_) {
    archive.enter("balance");
    balance_->persist(archive, model_.part().comm);
  }
  archive.enter("ledger");
  ledger_.persist(archive);
  works_.persist(archive);
  archive.enter("bodies");
  const std::vector<std::int32_t> owned = owned_bodies(model_.part());
  archive.rows("records", owned, std::span(state_.records).first(owned.size() * Space::record),
               Space::record);
  for (std::size_t k = 0; k < model_.forces().size(); ++k) {
    archive.enter("force_" + std::to_string(k) + "_" + std::string(model_.forces()[k]->name()));
    if (auto* role = model_.forces()[k]->roles().persists) role->persist(archive);
  }
}

/// Saves which bodies exist, or loads them and begins with them. Collective.
template <class Space>
void DynamicRun<Space>::persist_ice(Archive& archive) {
  archive.enter("supply");
  options_.supply->persist(archive);
  ice_.persist(archive);
  if (archive.loading()) follow_division();
}

/// The run keeps the checkpoint's step; its end may lie later.
template <class Space>
bool DynamicRun<Space>::restart() {
  if (options_.checkpoint.restart.empty()) return false;
  checkpoints_.load([&](Archive& archive) { persist(archive); });
  result_.dt = dt_;
  const double steps = std::ceil((options_.end - time_base_) / dt_ * (1 - 1e-12));
  if (!adaptive_) {
    require_few_steps(steps, dt_);
    steps_ = step_base_ + static_cast<std::int64_t>(steps);
  }
  if (adaptive_ ? options_.end < state_.time : steps_ < done_)
    throw InputError("time: end: " + text(options_.end) + " must be >= " + text(state_.time) +
                     " [s], the time of the checkpoint");
  set_sampling();
  take_up_state();
  before_ = done_;
  known_ = -1;
  if (balance_) result_.moves = balance_->moves();
  if (balance_ && balance_->is_on() && !balance_->owner().empty()) move_bodies(balance_->owner());
  return true;
}

/// Goes on with the state that an archive has set. Collective.
template <class Space>
void DynamicRun<Space>::take_up_state() {
  model_.part().ghosts.update(state_.records, Space::record);
  time_ = state_.time;
  state_.set_time(time_);
}

/// Begins with the bodies of a model that has been divided anew. Collective.
template <class Space>
void DynamicRun<Space>::follow_division() {
  const auto bodies = static_cast<std::size_t>(model_.part().local);
  state_ = State<Space>(bodies);
  wrenches_ = Wrenches<Space>(bodies);
  follow_model();
}

/// Moves bodies to other ranks if that is worth it. Collective.
template <class Space>
void DynamicRun<Space>::move_bodies_if_due() {
  if (!balance_) return;
  if (balance_->is_due(done_) && looked_ != done_) {
    looked_ = done_;
    if (const auto owner = balance_->look(model_, state_)) move_bodies(*owner);
  }
  next_look_ = balance_->next_look(done_);
}

/// Divides the model anew. The state goes through an archive in memory, as through a checkpoint, so
/// no bit depends on it. Collective.
template <class Space>
void DynamicRun<Space>::move_bodies(const std::vector<std::int32_t>& owner) {
  divide([&] {
    options_.balance->divide(owner);
    return Renumbering{};
  });
  result_.moves = balance_->moves();
}

/// Divides the model anew by work, which returns the new indices of bodies and beams if they are
/// others; bodies that have joined begin with the far edge's motion. Collective.
template <class Space>
void DynamicRun<Space>::divide(const std::function<Renumbering()>& work) {
  take_remarks();
  const MPI_Comm comm = model_.part().comm;
  std::optional<Hdf5File> file;
  on_root(comm, [&] { file.emplace(Hdf5File::in_memory()); });
  Hdf5File* memory = file ? &*file : nullptr;
  Archive save(model_.part(), memory, Transfer::save);
  save.stay_in_run();
  persist(save);
  share_outcome(save.outcome(), comm);
  const Renumbering changed = work();
  follow_division();
  Archive load(model_.part(), memory, Transfer::load);
  load.stay_in_run();
  if (!changed.bodies.empty()) {
    load.renumber(changed);
    begin_joined();
  }
  persist(load);
  take_up_state();
}

/// Lets ice join and leave if that is due. Collective.
template <class Space>
void DynamicRun<Space>::change_ice_if_due() {
  if (!options_.supply || done_ % options_.supply->every != 0) return;
  while (options_.supply->is_due(way_of_edge())) {
    change_ice();
    options_.supply->end_look();
  }
}

/// By how much the far edge, or the ice behind it, has come nearer [m]. Collective.
template <class Space>
double DynamicRun<Space>::way_of_edge() const {
  const SupplyOptions& supply = *options_.supply;
  return supply.free_edge && supply.free_edge->is_pushed ? edge_motion()->shift[0]
                                                         : supply.edge.value(time_)[0];
}

/// Takes out what has left the region, and lets the next strip join. The energies of both are the
/// changes of the ledger's balance, by evaluations before and after. Collective.
template <class Space>
void DynamicRun<Space>::change_ice() {
  const SupplyOptions& supply = *options_.supply;
  evaluate();
  supply.before_change(column_names());
  double before = energy_balance();
  const IceNow now = ice_now();
  const std::vector<std::int32_t> gone = supply.leaving(now);
  const auto take = [&](IceAmount& amount, double sign) {
    evaluate();
    const double after = energy_balance();
    amount.energy += sign * (after - before);
    before = after;
    ice_.bodies = model_.part().global_bodies;
    ice_has_changed_ = true;
    if (balance_) balance_->forget();
  };
  if (!gone.empty()) {
    add_to(ice_.left,
           [&](std::int32_t body) { return std::binary_search(gone.begin(), gone.end(), body); });
    divide([&] { return supply.leave(now, gone); });
    take(ice_.left, -1);
  }
  const std::int32_t bodies = model_.part().global_bodies - supply.others;  // of ice
  if (supply.can_join()) {
    IceNow rest = ice_now();
    edge_ = edge_motion();
    const std::array<double, 6> behind = supply.edge.value(time_);
    rest.edge = edge_ ? edge_->shift : std::array{behind[0], behind[1]};
    const double strain = edge_ ? edge_->strain : 0;
    divide([&] { return supply.join(rest, strain); });
    const std::int32_t after = model_.part().global_bodies - supply.others;
    add_to(ice_.joined, [&](std::int32_t body) { return body >= bodies && body < after; });
    take(ice_.joined, 1);
  }
}

/// Prescribed places of all local bodies, as if all were at the far edge [m, rad].
template <class Space>
std::vector<double> DynamicRun<Space>::places_of_edge(double time) const {
  const std::array<double, 6> edge = options_.supply->edge.value(time);
  std::vector<double> values;
  for (std::int32_t b = 0; b < model_.part().local; ++b) {
    for (const int component : Space::components) values.push_back(item(edge, component));
  }
  model_.prescribe(time, values);
  return values;
}

/// Places all bodies as if they had joined now: as the far edge, or as their own boundaries have
/// it, with the velocities of the last half step.
template <class Space>
void DynamicRun<Space>::begin_joined() {
  for (std::size_t b = 0; edge_ && b < static_cast<std::size_t>(model_.part().local); ++b) {
    double* record = state_.record(b);
    for (std::size_t k = 0; k < 2; ++k) {
      record[Space::displacement + k] = edge_->shift[k];
      record[Space::velocity + k] = edge_->speed[k];
    }
    record[Space::displacement] += edge_->strain * (edge_->x - model_.part().bodies.position[b].x);
  }
  if (options_.supply->free_edge) return;
  const std::vector<double> now = places_of_edge(time_), last = places_of_edge(time_ - dt_);
  for (std::size_t b = 0; b < static_cast<std::size_t>(model_.part().local); ++b) {
    double* record = state_.record(b);
    for (std::size_t k = 0; k < Space::translations; ++k) {
      const std::size_t at = b * Space::unknowns + k;
      record[Space::displacement + k] = now[at];
      record[Space::velocity + k] = (now[at] - last[at]) / dt_;
    }
  }
}

/// Sums are over bodies in global order, whatever the ranks. Collective.
template <class Space>
auto DynamicRun<Space>::edge_motion() const -> std::optional<EdgeMotion> {
  if (!options_.supply->free_edge) return {};
  constexpr std::size_t width = 6;
  const Part& part = model_.part();
  const std::vector<std::int32_t> bodies = options_.supply->free_edge->bodies();
  std::vector<double> mine;
  for (const std::int32_t body : bodies) {
    const std::int32_t local = part.local_index(body);
    if (local < 0 || local >= part.owned) continue;
    const auto b = static_cast<std::size_t>(local);
    const Vec3<double> u = displacement(state_, b), v = velocity(state_, b);
    mine.insert(mine.end(),
                {static_cast<double>(body), part.bodies.position[b].x, u.x, u.y, v.x, v.y});
  }
  const std::vector<double> all = all_gathered(mine, part.comm);
  std::vector<std::array<double, width>> rows(all.size() / width);
  for (std::size_t k = 0; k < rows.size(); ++k)
    std::copy_n(&all[k * width], width, rows[k].begin());
  std::sort(rows.begin(), rows.end());
  EdgeMotion edge;
  const double share = 1 / static_cast<double>(rows.size());
  for (const auto& [body, x, ux, uy, vx, vy] : rows) {
    edge.x += share * x;
    edge.shift[0] += share * ux, edge.shift[1] += share * uy;
    edge.speed[0] += share * vx, edge.speed[1] += share * vy;
  }
  edge.strain = options_.supply->free_edge->strain();
  return edge;
}

/// Gathers the places of all bodies and the broken beams. Collective.
template <class Space>
IceNow DynamicRun<Space>::ice_now() const {
  constexpr std::size_t width = 4;
  const Part& part = model_.part();
  std::vector<double> mine, broken;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    const Vec3<double> at = part.bodies.position[b] + displacement(state_, b);
    mine.insert(mine.end(), {static_cast<double>(part.global[b]), at.x, at.y, at.z});
  }
  const std::vector<double> rows = all_gathered(mine, part.comm);
  IceNow now{.time = time_,
             .places = std::vector<Point3>(static_cast<std::size_t>(part.global_bodies)),
             .broken = {}};
  for (std::size_t k = 0; k < rows.size(); k += width)
    item(now.places, static_cast<std::int32_t>(rows[k])) = {rows[k + 1], rows[k + 2], rows[k + 3]};
  if (model_.fracture() == nullptr) return now;
  for (const Break& b : model_.fracture()->breaks()) broken.push_back(static_cast<double>(b.beam));
  for (const double beam : all_gathered(broken, part.comm))
    now.broken.push_back(static_cast<std::int32_t>(beam));
  std::sort(now.broken.begin(), now.broken.end());
  return now;
}

/// Adds number, mass and momentum of some bodies by their global indices. Collective.
template <class Space>
void DynamicRun<Space>::add_to(IceAmount& amount,
                               const std::function<bool(std::int32_t)>& counts) const {
  const Part& part = model_.part();
  std::array<double, 5> sums{};
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    if (!counts(part.global[b])) continue;
    const double mass = part.bodies.mass[b];
    const Vec3<double> v = velocity(state_, b);
    const std::array<double, 5> mine{1, mass, mass * v.x, mass * v.y, mass * v.z};
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += mine[k];
  }
  sums = sum_over_ranks(sums, part.comm);
  amount.bodies += sums[0];
  amount.mass += sums[1];
  for (std::size_t k = 0; k < 3; ++k) amount.momentum[k] += sums[2 + k];
}

/// Energies that the ledger's balance counts at the state, whose wrenches are known [J].
/// Collective.
template <class Space>
double DynamicRun<Space>::energy_balance() {
  const auto [kinetic, boundary] = energies();
  const auto all = sum_over_ranks(std::array{kinetic, boundary}, model_.part().comm);
  return Ledger::balance(model_.report(state_, works()), all[0], all[1]);
}

/// The columns of the integrator itself.
template <class Space>
std::vector<std::pair<std::string, double>> DynamicRun<Space>::ledger_columns() const {
  auto columns = ledger_.columns();
  if (options_.supply)
    for (const auto& column : ice_.columns()) columns.push_back(column);
  return columns;
}

template <class Space>
bool DynamicRun<Space>::advance(double until) {
  if (stand_ == Stand::ended) return false;
  pause_ = until;
  {
    const Timed timed(Event::solve);
    if (stand_ == Stand::prepared) begin_steps();
    const Return back = stand_ == Stand::running ? make_steps() : Return::failure;
    count_steps();
    bring_state();
    if (back == Return::pause) return true;
    if (back == Return::end) change_ice_if_due();
    result_.done = back == Return::end && finish();
  }
  end();
  return false;
}

/// Prepares the TS, and does the integrator's work before the first step.
template <class Space>
void DynamicRun<Space>::begin_steps() {
  check(TSSetTime(ts_, state_.time));
  check(TSSetTimeStep(ts_, dt_));
  if (adaptive_) {
    check(TSSetMaxTime(ts_, options_.end));
    check(TSSetExactFinalTime(ts_, TS_EXACTFINALTIME_MATCHSTEP));
  } else {
    check(TSSetMaxTime(ts_, std::numeric_limits<PetscReal>::max()));  // the number of steps decides
  }
  check(TSSetErrorIfStepFails(ts_, PETSC_FALSE));
  progress_.emplace(what_, options_.end);
  if (first()) stand_ = Stand::running;
}

/// Makes steps up to the pause or the end of the run.
template <class Space>
typename DynamicRun<Space>::Return DynamicRun<Space>::make_steps() {
  while (!is_paused()) {
    change_ice_if_due();
    move_bodies_if_due();
    begin_piece();
    const int ierr = TSSolve(ts_, nullptr);
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    if (ierr == PETSC_ERR_FP) {  // from the error estimate of an adaptive step
      why_ = "a number that is not finite after time " + text(time_) + " s";
      return Return::failure;
    }
    check(ierr);
    TSConvergedReason reason = TS_CONVERGED_ITERATING;
    check(TSGetConvergedReason(ts_, &reason));
    if (reason < 0) return Return::failure;
    if (is_last(reason)) return Return::end;
  }
  return Return::pause;
}

template <class Space>
void DynamicRun<Space>::count_steps() {
  result_.steps = done_;
  result_.steps_now = done_ - before_;
}

/// Takes down how the run ended.
template <class Space>
void DynamicRun<Space>::end() {
  stand_ = Stand::ended;
  if (result_.done && options_.checkpoint.at_end) write_checkpoint();
  take_remarks();
  progress_.reset();
  count_steps();
  result_.message = why_;
  if (result_.stopped)
    result_.message = stopped_by_ + " at time " + text(state_.time) + " s, " + step_text();
}

/// In the first piece the TS counts steps as the run does. Later pieces begin with step 1, since at
/// step 0 a TS starts anew and forgets the steps before.
template <class Space>
void DynamicRun<Space>::begin_piece() {
  const std::int64_t pieces = done_ / steps_of_a_piece;
  piece_ = pieces == 0 ? 0 : pieces * steps_of_a_piece - 1;
  check(TSSetStepNumber(ts_, static_cast<PetscInt>(done_ - piece_)));
  limit_steps();
}

/// Lets the TS step to the end of the piece or of the run, or to the pause.
template <class Space>
void DynamicRun<Space>::limit_steps() {
  const std::int64_t end = (done_ / steps_of_a_piece + 1) * steps_of_a_piece;
  const std::int64_t change = options_.supply
                                  ? (done_ / options_.supply->every + 1) * options_.supply->every
                                  : std::numeric_limits<std::int64_t>::max();
  const std::int64_t last =
      std::max(std::min({last_step(), end, pause_step(), next_look_, change}), done_);
  check(TSSetMaxSteps(ts_, static_cast<PetscInt>(last - piece_)));
}

/// First step of equal steps that ends at or after the pause; rounding aside.
template <class Space>
std::int64_t DynamicRun<Space>::pause_step() const {
  constexpr double countable = 1e18;  // fits 64 bits
  const double steps = std::ceil((pause_ - time_base_) / dt_ - early);
  if (adaptive_ || !(steps < countable)) return std::numeric_limits<std::int64_t>::max();
  return step_base_ + static_cast<std::int64_t>(steps);
}

template <class Space>
void DynamicRun<Space>::evaluate() {
  model_.part().ghosts.update(state_.records, Space::record);
  model_.evaluate(state_, wrenches_);
}

template <class Space>
bool DynamicRun<Space>::moved(double time, double speed2) {
  ++done_;
  state_.time = time_ = time;
  note_speed2(speed2);
  audit("a step");
  return done_ % check_every != 0 || within_limits();
}

template <class Space>
void DynamicRun<Space>::audit(const char* where) const {
  if (!auditing()) return;
  floe::audit(model_.part().comm, where, objects(),
              std::array{time_, dt_, next_sample_, static_cast<double>(done_),
                         static_cast<double>(steps_)});
}

template <class Space>
bool DynamicRun<Space>::look_around() {
  if (progress_ && done_ % show_every_ == 0) progress_->update(state_.time, step_text());
  const auto wish = checkpoints_.wish(done_);
  if (wish == Checkpoints::Wish::none) return true;
  if (wish == Checkpoints::Wish::pause) {
    pause_ = time_;
    if (!adaptive_) limit_steps();
    return true;
  }
  if (!within_limits()) return false;  // a state beyond the limits gets no checkpoint
  write_checkpoint();
  result_.stopped = wish != Checkpoints::Wish::write;
  stopped_by_ = wish == Checkpoints::Wish::stop
                    ? "stopped on request"
                    : "stopped, since checkpoint: wall_time is nearly over,";
  return !result_.stopped;
}

template <class Space>
void DynamicRun<Space>::write_checkpoint() {
  checkpoints_.save([&](Archive& archive) { persist(archive); }, column_names());
}

/// Names of the columns that sample() hands to the observer.
template <class Space>
std::vector<std::string> DynamicRun<Space>::column_names() const {
  std::vector<std::string> names;
  for (const auto& [name, value] : model_.report(state_, works_.all())) names.push_back(name);
  const Columns own = own_columns();
  for (const auto& [name, value] : own.values()) names.push_back(name);
  for (const auto& [name, value] : ledger_columns()) names.push_back(name);
  return names;
}

template <class Space>
std::string DynamicRun<Space>::step_text() const {
  return "step " + std::to_string(done_) + (adaptive_ ? "" : " of " + std::to_string(steps_));
}

/// Samples the last state, whose forces no step has evaluated.
template <class Space>
bool DynamicRun<Space>::finish() {
  if (sampled_ == done_)
    return true;  // a checkpoint at the end of a run was taken after its last sample
  evaluate();
  return sample(true);
}

/// Passes the forces' remarks since the last call on to the user, in order of time. Collective.
template <class Space>
void DynamicRun<Space>::take_remarks() {
  std::vector<double> times;
  std::vector<char> texts;  // each ended by a zero
  for (const auto& force : model_.forces()) {
    auto* role = force->roles().remarks;
    if (role == nullptr) continue;
    for (const Remark& remark : role->take_remarks()) {
      times.push_back(remark.time);
      texts.insert(texts.end(), remark.text.c_str(), remark.text.c_str() + remark.text.size() + 1);
    }
  }
  const MPI_Comm comm = model_.part().comm;
  times = all_gathered(times, comm);
  if (times.empty()) return;
  texts = all_gathered(texts, comm);
  if (rank(comm) != 0) return;
  std::vector<Remark> all;
  const char* next = texts.data();
  for (const double time : times) {
    all.push_back({time, next});
    next += all.back().text.size() + 1;
  }
  std::sort(all.begin(), all.end(), [](const Remark& a, const Remark& b) {
    return std::tie(a.time, a.text) < std::tie(b.time, b.text);
  });
  for (const Remark& remark : all) {
    warn(remark.text);
    result_.warnings.push_back(remark.text);
  }
}

/// Collective: all ranks get the same answer.
template <class Space>
bool DynamicRun<Space>::within_limits() {
  finish_steps();
  const double all = largest_over_ranks(largest_, model_.part().comm);
  if (std::sqrt(all) <= options_.velocity_limit) return true;
  why_ = (std::isfinite(all) ? "a velocity of " + text(std::sqrt(all)) + " m/s"
                             : std::string("a velocity that is not finite")) +
         " at time " + text(state_.time) + " s, " + where() + " (limit: velocity " +
         text(options_.velocity_limit) + " m/s)";
  return false;
}

template <class Space>
void DynamicRun<Space>::set_sampling() {
  sample_every_ = {options_.history > 0 ? options_.history : options_.end / 200, options_.fields,
                   options_.pressure};
}

/// A sample is due at the first state at or after its time, rounding aside; the output counts its
/// frames by the same rule.
template <class Space>
bool DynamicRun<Space>::due() const {
  return state_.time >= next_sample_ - early * dt_;
}

/// Hands the state to the observer if it is within the limits.
template <class Space>
bool DynamicRun<Space>::sample(bool last) {
  if (!within_limits()) return false;
  const auto [kinetic, boundary] = energies();
  const auto all = sum_over_ranks(std::array{kinetic, boundary}, model_.part().comm);
  take_remarks();
  auto reported = model_.report(state_, works());
  const Columns own = own_columns();
  for (const auto& [name, value] : own.values())
    reported.emplace_back(name, sum_over_ranks(value, model_.part().comm));
  ledger_.take(reported, all[0], all[1], ice_.joined.energy - ice_.left.energy);
  if (!(ledger_.relative_error() <= options_.energy_limit)) {
    why_ = "the energy balance is off by " + text(ledger_.relative_error()) +
           " of the energies at time " + text(state_.time) + " s (limit: energy_error " +
           text(options_.energy_limit) + ")";
    return false;
  }
  observer_({.state = state_,
             .wrenches = wrenches_,
             .step = done_,
             .columns = ledger_columns(),
             .last = last,
             .forces = reported});
  sampled_ = done_;
  if (due()) sampled_when_due_ = done_;
  next_sample_ = std::numeric_limits<double>::infinity();
  for (const double every : sample_every_) {
    if (every > 0)
      next_sample_ =
          std::min(next_sample_, every * (std::floor((state_.time + early * dt_) / every) + 1));
  }
  return true;
}

/// Describes the body that is fastest in the present state.
template <class Space>
std::string DynamicRun<Space>::where() {
  bring_state();
  const Part& part = model_.part();
  RankedValue mine{-1, rank(part.comm)};
  std::size_t at = 0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    const double* v = state_.record(b) + Space::velocity;
    double speed2 = 0;
    for (int k = 0; k < Space::translations; ++k) speed2 += v[k] * v[k];
    if (!std::isfinite(speed2)) speed2 = std::numeric_limits<double>::max();
    if (speed2 > mine.value) {
      mine.value = speed2;
      at = b;
    }
  }
  const RankedValue best = largest_of_ranks(mine, part.comm);
  std::array<double, 4> facts{};
  if (best.index == mine.index) {
    const Point3& x = part.bodies.position[at];
    facts = {static_cast<double>(part.global[at]), x[0], x[1], x[2]};
  }
  broadcast(facts, part.comm, best.index);
  return "body " + text(facts[0]) + " at (" + text(facts[1]) + ", " + text(facts[2]) + ", " +
         text(facts[3]) + ")";
}

template class DynamicRun<Spatial>;
template class DynamicRun<Planar>;

}  // namespace floe
