#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>

#include "floe/base/log.h"
#include "floe/solve/integrator.h"
#include "solve/leapfrog.h"
#include "solve/motion.h"
#include "solve/stable_step.h"
#include "solve/ts_options.h"

namespace floe {
namespace {

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

/// Energies at a sample and what the balance says (all ranks).
class Ledger {
 public:
  /// \param forces  sums over ranks of what the forces report   \param boundary  work of the
  /// boundaries
  void take(const std::vector<std::pair<std::string, double>>& forces, double kinetic,
            double boundary) {
    double stored = kinetic, lost = 0, external = boundary;
    double size = std::abs(kinetic) + std::abs(boundary);
    for (const auto& [name, value] : forces) {
      if (name.rfind("energy_", 0) == 0) floor_ = std::max(floor_, rounding * std::abs(value));
      if (name == "energy_damping" || name == "energy_drag" || name == "energy_fracture") {
        lost += value;
        size += std::abs(value);  // a current gives energy
      } else if (name == "energy_external") {
        external += value;
        size += std::abs(value);
      } else if (name != "energy_load" && name.rfind("energy_", 0) == 0) {
        stored += value;
        size += std::abs(value - first_.try_emplace(name, value).first->second);
      }
    }
    if (!started_) {
      offset_ = stored + lost - external;
      started_ = true;
    }
    kinetic_ = kinetic;
    boundary_ = boundary;
    error_ = stored + lost - external - offset_;
    largest_ = std::max(largest_, size);
  }

  /// Error of the balance [J], and over the largest sum of energies that moved so far.
  double error() const { return error_; }
  double relative_error() const { return std::abs(error_) / std::max(largest_, floor_); }
  /// Energies below this are rounding and are not judged [J].
  void set_floor(double floor) { floor_ = floor; }
  void remember(Memory& memory) {
    memory.common("started", started_);
    for (const auto& [name, value] :
         std::initializer_list<std::pair<const char*, double*>>{{"offset", &offset_},
                                                                {"kinetic", &kinetic_},
                                                                {"boundary", &boundary_},
                                                                {"error", &error_},
                                                                {"largest", &largest_}})
      memory.common(name, *value);
    std::string names;
    std::vector<double> values;
    for (const auto& [name, value] : first_) {
      names += name + " ";
      values.push_back(value);
    }
    memory.common("first_names", names);
    memory.common("first_values", values);
    std::istringstream words(names);
    std::size_t k = 0;
    for (std::string name; words >> name && k < values.size();) first_[name] = values[k++];
  }
  std::vector<std::pair<std::string, double>> columns() const {
    return {{"energy_kinetic", kinetic_},
            {"energy_boundary", boundary_},
            {"energy_balance_error", error_}};
  }

 private:
  static constexpr double rounding = 1e-12;
  std::map<std::string, double> first_;
  bool started_ = false;
  double offset_ = 0, kinetic_ = 0, boundary_ = 0, error_ = 0, largest_ = 0,
         floor_ = std::numeric_limits<double>::min();
};

/// The run between two samples: forces, step, limits.
class ExplicitRun {
 public:
  ExplicitRun(Model<Spatial>& model, const ExplicitOptions& options,
              const Observer<Spatial>& observer)
      : model_(model),
        options_(options),
        observer_(observer),
        motion_(model),
        state_(static_cast<std::size_t>(model.part().local)),
        wrenches_(static_cast<std::size_t>(model.part().local)) {
    motion_.start(state_, model.part().bodies.velocity, model.part().bodies.angular_velocity);
    evaluate();
    // What strains of 1e-12 everywhere would store.
    double mine = 0, all = 0;
    const double strain = 1e-12 * model.length_scale();
    for (std::int32_t b = 0; b < model.part().owned; ++b) {
      for (const auto& force : model.forces()) mine += force->stiffness_bound(b) * strain * strain;
    }
    MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, model.part().comm);
    ledger_.set_floor(std::max(all, std::numeric_limits<double>::min()));
  }

  State<Spatial>& state() { return state_; }

  /// Fixes the step: the given one, or from the stable step; both divide the run into equal steps.
  void choose_step(double given, RunResult& result) {
    const StableStep stable = stable_step(model_, state_);
    evaluate();  // forces keep by-products of their last evaluation: the power they take
    result.stable_dt = stable.dt;
    result.limited_by = stable.limit;
    if (given > stable.dt && !options_.allow_unstable)
      throw InputError("time: dt: " + text(given) + " must be <= " + text(stable.dt) +
                       " [s], the stable step, limited by the " + stable.limit +
                       " (time: allow_unstable: true takes it all the same)");
    const double wanted = given > 0 ? given : options_.safety * stable.dt;
    if (!std::isfinite(wanted))
      throw InputError("time: dt: auto finds no force that limits the step; give one");
    steps_ = static_cast<std::int64_t>(std::ceil(options_.end / wanted * (1 - 1e-12)));
    steps_ = std::max<std::int64_t>(steps_, 1);
    dt_ = options_.end / static_cast<double>(steps_);
    result.dt = dt_;
    set_sampling();
    motion_.stagger(state_, wrenches_, dt_);
    model_.part().ghosts.update(state_.records, Spatial::record);
  }

  /// All that a run goes on from. Collective.
  void remember(Memory& memory, RunResult& result) {
    const double mine = largest_;
    MPI_Allreduce(&mine, &largest_, 1, MPI_DOUBLE, MPI_MAX, model_.part().comm);
    memory.enter("run");
    memory.common("step", done_);
    memory.common("steps", steps_);
    memory.common("time", state_.time);
    memory.common("dt", dt_);
    memory.common("stable_dt", result.stable_dt);
    memory.common("limited_by", result.limited_by);
    memory.common("next_sample", next_sample_);
    memory.common("sampled_step", sampled_);
    memory.common("largest_velocity2", largest_);
    double work = motion_.boundary_work();
    memory.share("boundary_work", work);
    motion_.set_boundary_work(work);
    memory.enter("ledger");
    ledger_.remember(memory);
    memory.enter("bodies");
    std::vector<std::int32_t> owned(static_cast<std::size_t>(model_.part().owned));
    std::iota(owned.begin(), owned.end(), 0);
    memory.rows("records", owned, std::span(state_.records).first(owned.size() * Spatial::record),
                Spatial::record);
    for (std::size_t k = 0; k < model_.forces().size(); ++k) {
      memory.enter("force_" + std::to_string(k) + "_" + std::string(model_.forces()[k]->name()));
      model_.forces()[k]->remember(memory);
    }
  }

  /// After remember() has loaded a checkpoint: its step is kept, the end may lie further on.
  void go_on(RunResult& result) {
    result.dt = dt_;
    steps_ = static_cast<std::int64_t>(std::ceil(options_.end / dt_ * (1 - 1e-12)));
    if (steps_ < done_)
      throw InputError("time: end: " + text(options_.end) + " must be >= " + text(state_.time) +
                       " [s], the time of the checkpoint");
    set_sampling();
    model_.part().ghosts.update(state_.records, Spatial::record);
  }

  double dt() const { return dt_; }
  std::int64_t steps() const { return steps_; }
  std::int64_t done() const { return done_; }
  const std::string& why() const { return why_; }

  /// The forces at t_n are known: samples that are due see them, then bodies move to t_n+1.
  bool step(double dt) {
    if (done_ > 0) evaluate();
    if (due() && !sample()) return false;
    const double v2 = motion_.step(state_, wrenches_, dt);
    for (const auto& force : model_.forces()) force->commit(state_, dt);
    ++done_;
    state_.time = static_cast<double>(done_) * dt;
    largest_ = std::isfinite(v2) ? std::max(largest_, v2) : v2;
    if (done_ % check_every == 0 && !within_limits()) return false;
    return true;
  }

  /// The last state, whose forces no step has asked for.
  bool finish() {
    if (sampled_ == done_) return true;  // as a checkpoint at the end of a run leaves it
    evaluate();
    return sample(true);
  }

  /// Collective: all ranks agree.
  bool within_limits() {
    double mine = std::isfinite(largest_) ? largest_ : std::numeric_limits<double>::infinity(),
           all = 0;
    MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, model_.part().comm);
    if (std::sqrt(all) <= options_.velocity_limit) return true;
    why_ = (std::isfinite(all) ? "a velocity of " + text(std::sqrt(all)) + " m/s"
                               : std::string("a velocity that is not finite")) +
           " at time " + text(state_.time) + " s, " + where() + " (limit: velocity " +
           text(options_.velocity_limit) + " m/s)";
    return false;
  }

 private:
  static constexpr std::int64_t check_every = 100;

  void evaluate() {
    model_.part().ghosts.update(state_.records, Spatial::record);
    model_.evaluate(state_, wrenches_);
  }

  void set_sampling() {
    sample_every_ = {options_.history > 0 ? options_.history : options_.end / 200, options_.fields};
  }

  /// The first state at or after the time, rounding aside: as the output counts too.
  bool due() const { return state_.time >= next_sample_ - early * dt_; }

  /// Hands the state at t_n out, if it is good.
  bool sample(bool last = false) {
    if (!within_limits()) return false;
    const auto [kinetic, boundary] = motion_.energies(state_, wrenches_, dt_);
    const std::array<double, 2> mine{kinetic, boundary};
    std::array<double, 2> all{};
    MPI_Allreduce(mine.data(), all.data(), 2, MPI_DOUBLE, MPI_SUM, model_.part().comm);
    const auto reported = model_.report(state_);
    ledger_.take(reported, all[0], all[1]);
    if (!(ledger_.relative_error() <= options_.energy_limit)) {
      why_ = "the energy balance is off by " + text(ledger_.relative_error()) +
             " of the energies at time " + text(state_.time) + " s (limit: energy_error " +
             text(options_.energy_limit) + ")";
      return false;
    }
    observer_({state_, wrenches_, done_, ledger_.columns(), last, reported});
    sampled_ = done_;
    next_sample_ = std::numeric_limits<double>::infinity();
    for (const double every : sample_every_) {
      if (every > 0)
        next_sample_ =
            std::min(next_sample_, every * (std::floor((state_.time + early * dt_) / every) + 1));
    }
    return true;
  }

  /// The body that is fastest now.
  std::string where() const {
    struct {
      double speed2 = -1;
      int rank = 0;
    } mine, best;
    std::size_t at = 0;
    const Part& part = model_.part();
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
      const double* v = state_.record(b) + Spatial::velocity;
      double speed2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      if (!std::isfinite(speed2)) speed2 = std::numeric_limits<double>::max();
      if (speed2 > mine.speed2) {
        mine.speed2 = speed2;
        at = b;
      }
    }
    mine.rank = rank(part.comm);
    MPI_Allreduce(&mine, &best, 1, MPI_DOUBLE_INT, MPI_MAXLOC, part.comm);
    std::array<double, 4> facts{};
    if (best.rank == mine.rank) {
      const Point3& x = part.bodies.position[at];
      facts = {static_cast<double>(part.global[at]), x[0], x[1], x[2]};
    }
    MPI_Bcast(facts.data(), 4, MPI_DOUBLE, best.rank, part.comm);
    return "body " + text(facts[0]) + " at (" + text(facts[1]) + ", " + text(facts[2]) + ", " +
           text(facts[3]) + ")";
  }

  Model<Spatial>& model_;
  const ExplicitOptions& options_;
  const Observer<Spatial>& observer_;
  Motion motion_;
  State<Spatial> state_;
  Wrenches<Spatial> wrenches_;
  Ledger ledger_;
  std::array<double, 2> sample_every_{};
  static constexpr double early = 1e-6;  // of a step
  double dt_ = 0, next_sample_ = 0, largest_ = 0;
  std::int64_t steps_ = 0, done_ = 0, sampled_ = -1;
  std::string why_;
};

}  // namespace

RunResult run_explicit(Model<Spatial>& model, const ExplicitOptions& given_options,
                       const Observer<Spatial>& observer) {
  refuse_options_of_others();
  ExplicitOptions options = given_options;  // -ts_dt, -ts_max_time, -ts_max_steps win
  register_leapfrog();
  const StopSignals signals;
  RunResult result;
  ExplicitRun run(model, options, observer);
  const Part& part = model.part();
  Handle<Vec> solution;
  check(VecCreateMPIWithArray(part.comm, Spatial::record, part.owned * Spatial::record,
                              PETSC_DETERMINE, run.state().records.data(), solution.put()));
  Handle<TS> ts;
  check(TSCreate(part.comm, ts.put()));
  check(TSSetType(ts, ts_leapfrog));
  check(TSSetSolution(ts, solution));
  check(TSSetTimeStep(ts, options.dt > 0 ? options.dt : -1.0));
  check(TSSetMaxTime(ts, options.end));
  check(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_STEPOVER));
  check(TSSetMaxSteps(ts, std::numeric_limits<PetscInt>::max()));
  check(TSSetFromOptions(ts));
  PetscReal given = 0;
  PetscInt most = 0;
  check(TSGetTimeStep(ts, &given));
  check(TSGetMaxTime(ts, &options.end));
  check(TSGetMaxSteps(ts, &most));
  Checkpoints checkpoints(options.checkpoint, part);
  const auto remember = [&](Memory& memory) { run.remember(memory, result); };
  if (options.checkpoint.restart.empty()) {
    run.choose_step(given, result);
  } else {
    checkpoints.load(remember);
    run.go_on(result);
    check(TSSetStepNumber(ts, static_cast<PetscInt>(run.done())));
    check(TSSetTime(ts, run.state().time));
  }
  const std::int64_t before = run.done();
  check(TSSetTimeStep(ts, run.dt()));
  check(TSSetMaxSteps(ts, static_cast<PetscInt>(std::min<std::int64_t>(run.steps(), most))));
  check(TSSetMaxTime(ts, std::numeric_limits<PetscReal>::max()));  // the number of steps decides
  check(TSSetErrorIfStepFails(ts, PETSC_FALSE));

  Progress progress("explicit", options.end);
  const auto advance = [&](double dt) {
    const bool good = run.step(dt);
    constexpr std::int64_t now_and_then = 50;
    if (run.done() % now_and_then == 0)
      progress.update(run.state().time,
                      "step " + std::to_string(run.done()) + " of " + std::to_string(run.steps()));
    const auto wish = good ? checkpoints.wish(run.done()) : Checkpoints::Wish::none;
    if (wish == Checkpoints::Wish::none) return good;
    if (!run.within_limits()) return false;  // no checkpoint of a state that is lost already
    checkpoints.save(remember);
    result.stopped = wish == Checkpoints::Wish::stop;
    return !result.stopped;
  };
  std::exception_ptr error;  // what a user can put right must not end in a callback of PETSc
  LeapfrogStep step = [&](double dt) {
    try {
      return advance(dt);
    } catch (const InputError&) {
      error = std::current_exception();
      return false;
    }
  };
  set_leapfrog_step(ts, &step);
  {
    const Timed timed(Event::solve);
    check(TSSolve(ts, nullptr));
    if (error) std::rethrow_exception(error);
    TSConvergedReason reason = TS_CONVERGED_ITERATING;
    check(TSGetConvergedReason(ts, &reason));
    result.done = reason > 0 && run.finish();
  }
  if (result.done && options.checkpoint.at_end) checkpoints.save(remember);
  result.steps = run.done();
  result.steps_now = run.done() - before;
  result.message = run.why();
  if (result.stopped)
    result.message = "stopped on request at time " + text(run.state().time) + " s, step " +
                     std::to_string(run.done()) + " of " + std::to_string(run.steps());
  return result;
}

}  // namespace floe
