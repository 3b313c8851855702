#include "paths/path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "floe/files/log.h"
#include "paths/path_equilibrium.h"
#include "run/expected_cost.h"

namespace floe {
namespace {

constexpr double smallest_fraction = 1.0 / 4096;  // of the first arc length
/// Factorisations of a step after which the arc length stays; fewer lengthen, more shorten it by
/// the square root of the ratio (Crisfield 1981, Bellini & Chulya 1987). Iterations that keep a
/// factorisation do not count: there the path is nearly straight.
constexpr double wanted_tangents = 5;
// Of the forces in balance; larger pin reactions mean that a free motion is loaded.
constexpr double pin_tolerance = 1e-6;

template <class Space>
class PathRun final : public Run {
 public:
  PathRun(Model<Space>& model, PathOptions<Space> options, Observer<Space> observer,
          const OutOfPlane* rest)
      : model_(model), options_(std::move(options)), observer_(std::move(observer)), rest_(rest) {}

  bool prepare() override;
  bool advance(double until) override;
  double time() const override { return static_cast<double>(result_.steps); }
  const RunResult& outcome() const override { return result_; }

 private:
  enum class Stand { prepared, running, ended };

  void begin();
  void choose_arc();
  void step();
  void accept();
  void not_solved();
  void note_limit_point();
  void end_with(std::string message, bool done = false);
  void finish(const std::string& why);
  std::string next_step() const { return "step " + std::to_string(result_.steps + 1); }
  double sign() const { return options_.load_factor && *options_.load_factor < 0 ? -1 : 1; }

  Model<Space>& model_;
  const PathOptions<Space> options_;
  const Observer<Space> observer_;
  const OutOfPlane* rest_;
  double arc_ = 0, arc_min_ = 0, arc_max_ = 0;
  std::optional<PathEquilibrium<Space>> equilibrium_;
  std::optional<Progress> progress_;
  /// Length of the path and load factor of the last three states, the newest last.
  std::array<std::array<double, 2>, 3> trail_{};
  RunResult result_;
  Stand stand_ = Stand::prepared;
};

template <class Space>
bool PathRun<Space>::prepare() {
  if (static_cast<double>(options_.steps) > options_.most_steps)
    throw InputError("static: steps: " + std::to_string(options_.steps) + " are more than " +
                     text(options_.most_steps) + " (limit: steps)");
  RunPlan plan;
  plan.end = static_cast<double>(options_.steps);
  plan.steps = plan.end;
  plan.bytes =
      factorisation_cost(static_cast<double>(model_.part().global_bodies) * Space::unknowns,
                         size(model_.part().comm))
          .bytes;
  PathSettings<Space> settings;
  settings.full_time = options_.full_time;
  settings.sense = sign();
  settings.growth = options_.growth;
  if (options_.ends_at) settings.monitored = options_.ends_at->displacement;
  equilibrium_.emplace(model_, std::move(settings));
  return !options_.on_plan || options_.on_plan(plan);
}

template <class Space>
bool PathRun<Space>::advance(double until) {
  if (stand_ == Stand::prepared) begin();
  while (stand_ == Stand::running) {
    if (time() >= until) return true;
    step();
  }
  return false;
}

/// Finds the equilibrium without load factor.
template <class Space>
void PathRun<Space>::begin() {
  stand_ = Stand::running;
  progress_.emplace("steps along the path", static_cast<double>(options_.steps));
  equilibrium_->set_on_iteration([this](std::int64_t it) {
    progress_->update(time(), next_step() + ", iteration " + std::to_string(it));
  });
  result_.path.emplace();
  if (!equilibrium_->solve(0.0)) {
    result_.stopped = equilibrium_->stopped();
    return end_with(result_.stopped ? "stopped on request at the first state"
                                    : "no equilibrium at load factor 0: " + equilibrium_->why());
  }
  equilibrium_->begin();
  choose_arc();
  accept();
}

/// Chooses the arc lengths that the user did not give.
template <class Space>
void PathRun<Space>::choose_arc() {
  constexpr double part = 0.1, most = 0.01, longest = 0.05;
  const double extent = equilibrium_->extent();
  arc_ = options_.arc;
  if (arc_ == 0) {
    arc_ = std::min(most * extent, equilibrium_->arc_of(part * options_.load_factor.value_or(1)));
    if (!(arc_ > 0)) arc_ = most * extent;
  }
  arc_min_ = options_.arc_min > 0 ? options_.arc_min : smallest_fraction * arc_;
  arc_max_ = options_.arc_max > 0 ? options_.arc_max : std::max(arc_, longest * extent);
  arc_ = std::min(arc_, arc_max_);
}

template <class Space>
void PathRun<Space>::step() {
  if (result_.steps >= options_.steps)
    return finish("after " + std::to_string(options_.steps) + " steps");
  if (!equilibrium_->propose(arc_, time() + 1)) return not_solved();
  const std::int64_t tangents = equilibrium_->tangents_of_step();
  std::string end;
  const double from = equilibrium_->factor_before(), to = equilibrium_->factor();
  const auto crosses = [](double a, double b, double value) {
    return a != value && (a - value) * (b - value) <= 0;
  };
  if (options_.load_factor && crosses(from, to, *options_.load_factor)) {
    end = "at load factor " + text(*options_.load_factor);
    if (!equilibrium_->beams_changed() && !equilibrium_->move_to_factor(*options_.load_factor))
      return not_solved();
  } else if (options_.ends_at && crosses(equilibrium_->monitored_before(),
                                         equilibrium_->monitored(), options_.ends_at->value)) {
    end = "at the displacement " + text(options_.ends_at->value) + " m";
    if (!equilibrium_->beams_changed() &&
        !equilibrium_->move_to_displacement(options_.ends_at->value))
      return not_solved();
  }
  const bool elastic = !equilibrium_->beams_changed();
  equilibrium_->accept();
  ++result_.steps;
  result_.dt = equilibrium_->last_arc();
  accept();
  progress_->update(time(), "load factor " + text(equilibrium_->factor()));
  if (elastic) {
    constexpr double most = 2;
    const double ratio =
        std::sqrt(wanted_tangents / static_cast<double>(std::max<std::int64_t>(1, tangents)));
    arc_ = std::clamp(arc_ * std::clamp(ratio, 1 / most, most), arc_min_, arc_max_);
  }
  if (end.empty() && equilibrium_->came_apart()) end = equilibrium_->why();
  if (!end.empty()) finish(end);
}

/// Shortens the arc, or ends the run.
template <class Space>
void PathRun<Space>::not_solved() {
  if (equilibrium_->stopped()) {
    result_.stopped = true;
    return end_with("stopped on request at step " + std::to_string(result_.steps) +
                    "; a static run keeps no checkpoint");
  }
  if (equilibrium_->came_apart()) return finish(equilibrium_->why());
  if (equilibrium_->collapsed())
    return end_with("the path ends at load factor " + text(equilibrium_->factor()) + ": " +
                    equilibrium_->why() + "; continue with integrator: explicit");
  arc_ *= 0.5;
  if (arc_ < arc_min_)
    end_with("no equilibrium beyond load factor " + text(equilibrium_->factor()) + ", step " +
             std::to_string(result_.steps) + " (arc length cut to " + text(arc_) +
             " m): " + equilibrium_->why());
}

template <class Space>
void PathRun<Space>::accept() {
  result_.newton_iterations = equilibrium_->newton_iterations();
  PathResult& path = *result_.path;
  path.load_factor = equilibrium_->factor();
  path.length = equilibrium_->length();
  path.snap_backs += equilibrium_->snapped_back() ? 1 : 0;
  note_limit_point();
  // The load factor may fall; files need times that grow.
  State<Space> shown = equilibrium_->state();
  shown.set_time(time());
  observer_({.state = shown,
             .wrenches = equilibrium_->wrenches(),
             .step = result_.steps,
             .columns = {{"load_factor", path.load_factor},
                         {"arc_length", path.length},
                         {"snap_back", equilibrium_->snapped_back() ? 1.0 : 0.0},
                         {"energy_boundary", equilibrium_->boundary_work()}},
             .forces = model_.report(equilibrium_->state(), equilibrium_->works())});
}

/// Notes a largest or smallest load factor of the last three states: the vertex of the parabola
/// through them over the length of the path.
template <class Space>
void PathRun<Space>::note_limit_point() {
  PathResult& path = *result_.path;
  std::rotate(trail_.begin(), trail_.begin() + 1, trail_.end());
  trail_.back() = {path.length, path.load_factor};
  if (result_.steps < 2) return;
  const auto& [a, b, c] = trail_;
  const double left = (b[1] - a[1]) / (b[0] - a[0]), right = (c[1] - b[1]) / (c[0] - b[0]);
  if (!(left * right < 0)) return;
  const double curvature = (right - left) / (c[0] - a[0]);
  const double slope = left + curvature * (b[0] - a[0]);  // at the middle state
  path.limit_points.push_back(
      {result_.steps - 1, b[1] - 0.25 * slope * slope / curvature, left > 0});
}

template <class Space>
void PathRun<Space>::end_with(std::string message, bool done) {
  stand_ = Stand::ended;
  result_.done = done;
  result_.message = std::move(message);
  progress_.reset();
}

/// Ends the path where it should end, and decides whether the last equilibrium is stable.
template <class Space>
void PathRun<Space>::finish(const std::string& why) {
  result_.path->end = why;
  if (!equilibrium_->came_apart()) result_.unstable_modes = equilibrium_->unstable_modes(rest_);
  result_.factorisations = equilibrium_->factorisations();
  end_with("", true);
}

}  // namespace

template <class Space>
std::unique_ptr<Run> make_path_run(Model<Space>& model, PathOptions<Space> options,
                                   ObserverOf<Space> observer, const OutOfPlane* rest) {
  return std::make_unique<PathRun<Space>>(model, std::move(options), std::move(observer), rest);
}

template std::unique_ptr<Run> make_path_run(Model<Spatial>&, PathOptions<Spatial>,
                                            Observer<Spatial>, const OutOfPlane*);
template std::unique_ptr<Run> make_path_run(Model<Planar>&, PathOptions<Planar>, Observer<Planar>,
                                            const OutOfPlane*);

}  // namespace floe
