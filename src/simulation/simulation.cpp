// A scene's run, from the lock of its folder to its summary.
#include <algorithm>
#include <limits>
#include <type_traits>

#include "device/make_engine.h"
#include "explicit/explicit_ts_options.h"
#include "files/files.h"
#include "floe/base/item.h"
#include "floe/files/log.h"
#include "floe/options/options.h"
#include "floe/scene/restart.h"
#include "floe/session/session.h"
#include "floe/session/unused_options.h"
#include "floe/session/version.h"
#include "session/run_place.h"
#include "session/signals.h"
#include "simulation/running.h"

namespace floe {
namespace {

constexpr int exit_failed = 1;

std::vector<std::string> names_of(const NamedValues& forces, const NamedValues& integrator) {
  std::vector<std::string> names;
  for (const NamedValues* columns : {&forces, &integrator}) {
    for (const auto& [name, value] : *columns) names.push_back(name);
  }
  return names;
}

/// Returns the direction of strips of bodies of which each rank owns one: where ice piles up before
/// an obstacle, every rank then has its share of the pile.
Vec3<double> strips_of(const Scene& scene, const Lattice& lattice) {
  if (!scene.forces.contact || scene.obstacles.empty()) return {};
  const std::vector<Point3>& places = lattice.bodies.position;
  Vec3<double> sum{};
  for (const Point3& place : places) sum = sum + place;
  return way_to_nearest(scene.obstacles, (1.0 / static_cast<double>(places.size())) * sum);
}

/// Refuses a folder with files of another run, which would be cut back.
void require_same_run(const Scene& scene, const RunFolder& folder, const std::string& run) {
  if (run.empty())
    throw InputError("checkpoint: restart: '" + scene.checkpoint.restart +
                     "': output/run is empty");
  if (folder.run().empty() || folder.run() == run) return;  // empty: copied without its .lock
  throw InputError("checkpoint: restart: '" + scene.checkpoint.restart +
                   "' is of another run than the files in " + scene.output.dir +
                   "; a run goes on in the folder where it began");
}

/// Describes what a program does to a model: a checkpoint of that is no other run's.
std::string part_of_program(const SimulationSettings& settings) {
  std::string text;
  for (const std::string& name : settings.coupled)
    text += (text.empty() ? " moves or loads " : ", ") + name;
  if (!settings.forces.empty())
    text += (text.empty() ? " gives " : " and gives ") + std::to_string(settings.forces.size()) +
            (settings.forces.size() == 1 ? " force" : " forces");
  return text.empty() ? text : "; a program" + text;
}

/// The scene's claim to its output folder.
FolderWish wish_of(const Scene& scene) {
  return {scene.output.dir, scene.path, scene.inputs, scene.output.overwrite,
          !scene.checkpoint.restart.empty()};
}

}  // namespace

/// Makes the model: this rank's part of the lattice, boundaries, forces.
template <class Space>
RunningIn<Space>::RunningIn(Setting& setting, const Simulation::Observer& observer)
    : setting_(setting), observer_(observer) {
  run_place().stage = "before the first state";
  Lattice& lattice = setting_.lattice;
  if (!needs_shapes(scene_)) packed_.pack_shapes(lattice);
  loads_ = place_loads(scene_, lattice);
  model_.emplace(lattice, PETSC_COMM_WORLD, scene_.boundaries, strips_of(scene_, lattice));
  equip(lattice);
  if (is_static_) hold_free_motions(scene_, lattice, *model_);
  if (is_static_ && setting_.choice.planar)
    out_of_plane_ = out_of_plane(scene_, lattice, loads_, model_->part());
  release_setup(scene_, *model_);
  BalanceOptions balance = this->balance();
  packed_.pack_shapes(lattice);
  packed_.pack_beams(lattice);
  if (size() == 1) packed_.pack_bodies(lattice, model_->part().bodies);
  run_ = make_run(scene_, *model_, out_of_plane_ ? &*out_of_plane_ : nullptr,
                  {.lattice_id = lattice_id_,
                   .on_plan = [this](const RunPlan& p) { return plan(p); },
                   .prepare =
                       [this](const std::vector<std::string>& columns) {
                         // Files must be on disk before a checkpoint that refers to them.
                         prepare_output(columns);
                         output_->sync();
                       },
                   .others = [this](Archive& archive) { persist(archive); },
                   .balance = std::move(balance),
                   .supply = supply(),
                   .program = part_of_program(setting_.settings),
                   .remake = setting_.settings.goes_back && can_go_back(scene_)
                                 ? [this](const std::vector<std::int32_t>& owner) { divide(owner); }
                                 : std::function<void(const std::vector<std::int32_t>&)>{},
                   .wants_pause = setting_.settings.wants_pause,
                   .loads = &loads_},
                  [this](const Accepted<Space>& accepted) { observe(accepted); });
}

/// Gives the model its forces.
template <class Space>
void RunningIn<Space>::equip(const Lattice& lattice) {
  add_forces(scene_, loads_, *model_, &lattice);
  if constexpr (std::is_same_v<Space, Spatial>) add_forces_of_program();
  add_far_edge();
  contact_ = add_contact(scene_, lattice, *model_);
}

/// Adds the forces of the program that made the simulation.
template <class Space>
void RunningIn<Space>::add_forces_of_program() {
  if constexpr (std::is_same_v<Space, Spatial>) {
    std::size_t wrench = 0;
    for (std::size_t k = 0; k < scene_.structures.size(); ++k) {
      if (!is_coupled(setting_, scene_.obstacles[scene_.structures[k].obstacle].name)) continue;
      if (wrench == applied_->size()) applied_->emplace_back();
      (*applied_)[wrench++].body = body_of(k);  // another one after ice has joined
    }
    if (!applied_->empty()) model_->add_force(make_applied_wrenches(model_->part(), applied_));
    for (const BodyForce& force : setting_.settings.forces)
      model_->add_force(make_program_force(model_->part(), force));
  }
}

/// Adds the ice behind the far edge, with impedances of the sheet's own lattice (model.md, "Ice
/// without end").
template <class Space>
void RunningIn<Space>::add_far_edge() {
  if (!scene_.supply.absorbs) return;
  const SuppliedIce& ice = *setting_.mesh.ice;
  const LatticeModuli& m = moduli_;
  const double density = scene_.ice.density * (1 + scene_.added_mass);
  const FarIce behind{.motion = ice.edge(),
                      .normal = std::sqrt(density * young_ / (1 - m.poisson * m.poisson)),
                      .tangential = std::sqrt(density * m.shear * scene_.ice.young),
                      .spring = scene_.supply.spring > 0 ? young_ / scene_.supply.spring : 0,
                      .offset = ice.offset(),
                      .pressure = scene_.supply.pressure,
                      .response = scene_.supply.response,
                      .strip = ice.last_strip()};
  auto edge = make_far_edge<Space>(model_->part(), ice.edge_areas(), behind);
  far_edge_ = edge.get();
  model_->add_force(std::move(edge));
}

/// Settings of moves of bodies between ranks. Where there can be some, the lattice is kept.
template <class Space>
BalanceOptions RunningIn<Space>::balance() {
  BalanceOptions options{.threshold = scene_.partition.threshold,
                         .every = scene_.partition.every,
                         .strips = strips_of(scene_, setting_.lattice),
                         .divide = {}};
  const bool can_move = scene_.forces.contact && size() > 1 &&
                        scene_.integrator == Integrator::explicit_ && !scene_.check_only;
  if (!can_move && !(setting_.settings.goes_back && can_go_back(scene_))) return options;
  whole_ = setting_.lattice;
  packed_whole_.pack_shapes(whole_);
  packed_whole_.pack_beams(whole_);
  if (can_move) options.divide = [this](const std::vector<std::int32_t>& owner) { divide(owner); };
  return options;
}

/// Divides the model anew. Collective.
template <class Space>
void RunningIn<Space>::divide(const std::vector<std::int32_t>& owner) {
  if (output_) output_->prepare_to_follow();
  packed_whole_.unpack(whole_);
  model_->divide(whole_, owner);
  equip(whole_);
  release_setup(scene_, *model_);
  packed_whole_.pack_shapes(whole_);
  packed_whole_.pack_beams(whole_);
  if (output_) output_->follow();
}

/// Settings of a run whose ice joins and leaves.
template <class Space>
std::optional<SupplyOptions> RunningIn<Space>::supply() {
  if (!scene_.supply.on || scene_.check_only) return {};
  SuppliedIce& ice = *setting_.mesh.ice;
  SupplyOptions options;
  options.edge = ice.edge();
  options.others = static_cast<std::int32_t>(scene_.structures.size());
  options.is_due = [&ice](double way) { return ice.is_due(way); };
  // After a restart the files are open from the first sample on only; they follow all changes.
  options.before_change = [this](const auto& columns) { prepare_output(columns); };
  options.leaving = [&ice](const IceNow& now) { return ice.leaving(now); };
  options.leave = [this, &ice](const IceNow& now, const std::vector<std::int32_t>& gone) {
    return change(ice.leave(gone), now);
  };
  options.can_join = [&ice] { return ice.can_join(); };
  options.join = [this, &ice](const IceNow& now, double strain) {
    return change(ice.join(strain), now);
  };
  if (scene_.supply.absorbs)
    options.free_edge = {.bodies =
                             [&ice] {
                               std::vector<std::int32_t> bodies;
                               for (const EdgeArea& edge : ice.edge_areas())
                                 bodies.push_back(edge.body);
                               return bodies;
                             },
                         .strain = [this] { return far_edge_->mean_pressure() / young_; },
                         .is_pushed = scene_.supply.pressure.has_value()};
  options.end_look = [&ice] { ice.end_look(); };
  options.persist = [this](Archive& archive) { persist_ice(archive); };
  return options;
}

/// Divides the model anew after ice has joined or left, by present places. Collective.
template <class Space>
Renumbering RunningIn<Space>::change(SuppliedIce::Change change, const IceNow& now) {
  std::vector<Point3> at = change.lattice.bodies.position;
  for (Point3& p : at) p = p + Vec3<double>{now.edge[0], now.edge[1], 0};  // where they join
  const std::vector<std::int32_t>& after = change.indices.bodies;
  for (std::size_t b = 0; b < after.size(); ++b)
    if (after[b] >= 0) item(at, after[b]) = now.places[b];
  owner_ = owners_by_load(at, {}, size(), strips_of(scene_, change.lattice));
  divide(std::move(change.lattice), owner_);
  return std::move(change.indices);
}

/// Divides a model of another lattice. Collective.
template <class Space>
void RunningIn<Space>::divide(Lattice lattice, const std::vector<std::int32_t>& owner) {
  if (output_) output_->prepare_to_follow();
  model_->divide(lattice, owner);
  equip(lattice);
  release_setup(scene_, *model_);
  if (output_) {
    output_->follow(lattice, setting_.mesh.ice->names_of_bodies());
  } else {
    packed_ = {};
    setting_.lattice = lattice;
  }
  if (whole_.bodies.position.empty()) return;  // bodies do not move between ranks
  packed_whole_ = {};
  whole_ = std::move(lattice);
  packed_whole_.pack_shapes(whole_);
  packed_whole_.pack_beams(whole_);
}

/// Saves which bodies exist, or loads them and divides the model so. Collective.
template <class Space>
void RunningIn<Space>::persist_ice(Archive& archive) {
  SuppliedIce& ice = *setting_.mesh.ice;
  ice.persist(archive);
  std::vector<double> owner(owner_.begin(), owner_.end());
  std::int64_t ranks = size();
  archive.common("owner", owner);
  archive.common("owner_ranks", ranks, 1);
  if (output_) mesh_frame_ = output_->mesh();
  archive.common("mesh_frame", mesh_frame_);
  if (!archive.loading()) return;
  Lattice lattice = ice.lattice();
  const bool as_before = ranks == size() && !owner.empty();
  owner_.assign(owner.begin(), owner.end());
  if (!as_before)
    owner_ = owners_by_load(lattice.bodies.position, {}, size(), strips_of(scene_, lattice));
  divide(std::move(lattice), owner_);
}

/// Opens the output folder, once all options are known to be understood, so that bad input leaves
/// no folder behind: solvers read some of their options in the first step.
template <class Space>
void RunningIn<Space>::open(const std::vector<std::string>& columns) {
  RunFolder& folder = *setting_.folder;
  reject_unused_options(scene_.unused_options);
  if (restart_) {
    require_same_run(scene_, folder, restart_->run);
    require_files(scene_.output.dir, *restart_,
                  columns_of(scene_.boundaries, scene_.loads, columns, scene_.forces.fracture),
                  PETSC_COMM_WORLD);
  }
  setting_.say_warnings();
  folder.begin(restart_ ? restart_->run : "");
  if (restart_) make_newest(scene_.checkpoint.restart, checkpoint_file(scene_), PETSC_COMM_WORLD);
  setting_.mesh.keep();
  setting_.mesh.keep = [] {};
  if (rank() == 0) packed_.unpack(setting_.lattice);  // other ranks need positions only
  output_ = std::make_unique<Output<Space>>(OutputOptions{.dir = scene_.output.dir,
                                                          .history = scene_.output.history,
                                                          .fields = scene_.output.fields,
                                                          .pressure = scene_.output.pressure,
                                                          .obstacles = shapes_of(scene_.obstacles)},
                                            std::move(setting_.lattice), *model_, loads_,
                                            scene_.options_yaml, restart_ ? &*restart_ : nullptr,
                                            present_mesh());
  if (first_) {
    output_->accept({.state = first_->state,
                     .wrenches = first_->wrenches,
                     .step = 0,
                     .columns = first_->columns,
                     .forces = first_->forces});
    show(0);
  }
  first_.reset();
}

template <class Space>
bool RunningIn<Space>::plan(const RunPlan& plan) {
  const std::string text =
      plan_text(scene_, plan, size_of_output_, 1e6 * resident_memory_mb(PETSC_COMM_WORLD));
  if (scene_.check_only) setting_.say_warnings();
  setting_.say(text);
  return !scene_.check_only;
}

template <class Space>
void RunningIn<Space>::observe(const Accepted<Space>& accepted) {
  state_ = &accepted.state;
  if (accepted.step == 0 && scene_.integrator != Integrator::explicit_) {
    first_ = First<Space>{accepted.state, accepted.wrenches, accepted.columns, accepted.forces};
    return;
  }
  prepare_output(names_of(accepted.forces, accepted.columns));
  output_->accept(accepted);
  setting_.folder->note(accepted.state.time, accepted.step);
  run_place() = {"", accepted.state.time, accepted.step, 0};
  show(accepted.step);
}

/// Hands the last sample to the observer.
template <class Space>
void RunningIn<Space>::show(std::int64_t step) {
  if (observer_) observer_({output_->last().time, step, columns_of(output_->last())});
}

template <class Space>
void RunningIn<Space>::persist(Archive& archive) {
  if (archive.loading()) {
    restart_.emplace().persist(archive);
    return;
  }
  OutputArchive files = output_->archive();
  files.run = setting_.folder->run();
  files.persist(archive);
}

/// Writes the last files and the summary.
template <class Space>
Results RunningIn<Space>::finish() {
  RunResult result = run_->outcome();
  if (!result.done && !result.stopped && result.message.empty())
    result.message = "ended at time " + std::to_string(run_->time()) + " s by its program";
  prepare_output({});  // a run without even a first state leaves a summary that says so
  const bool goes_on = result.stopped && !is_static_;  // from its checkpoint
  if (!goes_on) output_->finish();
  Summary summary =
      summarise(scene_, setting_.choice, *model_, setting_.mesh, result, output_->first(),
                output_->last(), MPI_Wtime() - setting_.settings.began);
  setting_.folder->finish(summary.json);
  return {std::move(result), std::move(summary.json), std::move(summary.text)};
}

template <class Space>
std::vector<BodyState> RunningIn<Space>::bodies() const {
  std::vector<BodyState> all;
  if (state_ == nullptr) return all;
  const Part& part = model_->part();
  for (std::size_t b = 0; b < static_cast<std::size_t>(part.owned); ++b) {
    all.push_back({part.global[b], part.bodies.position[b] + displacement(*state_, b),
                   rotation(*state_, b), velocity(*state_, b), angular_velocity(*state_, b)});
  }
  return all;
}

struct Simulation::Impl : Setting {
  Observer observer;
  std::unique_ptr<Running> running;
  std::optional<Results> results;
  bool prepared = false, ended = false;
  std::optional<LastWords> last_words;

  Impl(Scene given, const SimulationSettings& with);
  ~Impl();
  void take_coupling();
  std::size_t coupled_obstacle(const std::string& name) const;
  std::optional<std::size_t> structure_of(std::size_t obstacle) const;
  bool prepare();
  Running& prepared_run();
  void lock();
  void make_lattice_and_choose_model();
  bool advance(double until);
  const Results& end();
  void note_failure(const Verdict& why, bool failed) {
    if (folder && rank() == 0 && (folder->has_begun() || failed)) folder->fail(why.what());
    last_words.reset();
    ended = true;
  }
  void say_that_it_is_valid();
  /// Runs work; if an error ends the run, the folder's summary says so.
  template <class Work>
  auto guarded(Work&& work) {
    try {
      return work();
    } catch (const CallbackFailed&) {
      if (running == nullptr) ended = true;
      throw;  // the run may go on
    } catch (const RunFailed& error) {
      note_failure(error, true);
      throw;
    } catch (const Verdict& error) {
      note_failure(error, false);
      throw;
    }
  }
};

Simulation::Impl::Impl(Scene given, const SimulationSettings& with) {
  scene = std::move(given);
  settings = with;
  if (settings.began == 0) settings.began = MPI_Wtime();
  guarded([&] {
    check_reports(scene);
    device::check_is_built(name_of(scene.backend));
    take_coupling();
    if (!scene.check_only) lock();
    make_lattice_and_choose_model();
    if (choice.planar) {
      running = std::make_unique<RunningIn<Planar>>(*this, observer);
    } else {
      running = std::make_unique<RunningIn<Spatial>>(*this, observer);
    }
  });
}

Simulation::Impl::~Impl() {
  if (folder && folder->has_begun() && !results && !ended && rank() == 0)
    folder->fail("ended by the program that made it");
}

void Simulation::Impl::lock() {
  folder.emplace(wish_of(scene), PETSC_COMM_WORLD);
  last_words.emplace(
      [this](const std::string& why) {
        if (folder && (folder->has_begun() || run_place().code == exit_failed)) {
          folder->fail(why);
        } else {
          folder.reset();  // removes all that was made
        }
      },
      [this](const char* why) { return folder && folder->fail_in_crash(why); });
}

void Simulation::Impl::make_lattice_and_choose_model() {
  run_place().stage = "while the lattice was made";
  lattice = make_lattice(scene, PETSC_COMM_WORLD, mesh);
  stop_if_asked(PETSC_COMM_WORLD);
  set_initial(scene, lattice);
  if (mesh.strength) strengthen(scene, *mesh.strength);
  choice = choose_model(scene, lattice);
  for (const std::string& remark : scene.remarks) say(remark + "\n");
  const std::string& why = choice.needs_space;
  say("model: " + choice.text + (why.empty() ? "" : " (" + why + ")") + "\n");
  const std::string processors = built_for(PETSC_COMM_WORLD);
  const bool mixed = processors != built_for();
  say("library: built for " + processors +
      (mixed ? "; results differ by rounding from those of one level\n" : "\n"));
  if (!mesh.outline.empty()) say(mesh.outline + "\n");
  if (!mesh.cuts.empty()) say(mesh.cuts + "\n");
  if (mesh.bonds) say("bonds: " + text_of(*mesh.bonds) + "\n");
  if (mesh.strength) say("strength: " + text_of(*mesh.strength) + "\n");
}

bool Simulation::Impl::prepare() {
  if (ended) return false;
  return guarded([&] {
    if (!prepared) ended = !running->prepare();
    prepared = true;
    if (ended && scene.check_only) say_that_it_is_valid();
    return !ended;
  });
}

bool Simulation::Impl::advance(double until) {
  if (!prepare()) return false;
  return guarded([&] {
    ended = !running->advance(until);
    return !ended;
  });
}

/// The run, once it is prepared and has not been brought to its end by results().
Running& Simulation::Impl::prepared_run() {
  if (!prepared) (void)prepare();
  if (results) throw InputError("the simulation has been brought to its end");
  return *running;
}

/// Checks what the program moves and loads, and marks it.
void Simulation::Impl::take_coupling() {
  if (settings.coupled.empty() && settings.forces.empty()) return;
  if (scene.integrator != Integrator::explicit_ || explicit_type() != "leapfrog")
    throw InputError(
        "a program moves obstacles and gives forces only with integrator: explicit "
        "by leapfrog");
  for (const std::string& name : settings.coupled) {
    const std::size_t k = coupled_obstacle(name);
    if (!structure_of(k)) scene.obstacles[k].motion.is_driven = true;
  }
  if (settings.forces.empty()) return;
  if (scene.planar == Planarity::always)
    throw InputError("model: planar: forces of a program act in space");
  scene.planar = Planarity::never;
}

/// Number of a coupled obstacle. \throws InputError if there is none
std::size_t Simulation::Impl::coupled_obstacle(const std::string& name) const {
  std::string known;
  for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
    known += (k > 0 ? ", " : "") + scene.obstacles[k].name;
    if (scene.obstacles[k].name != name) continue;
    if (is_coupled(*this, name)) return k;
    throw InputError("coupled: obstacle '" + name +
                     "' is not coupled: name it when the simulation "
                     "is made");
  }
  throw InputError("coupled: '" + name + "' is no obstacle of the scene (" +
                   (known.empty() ? "it has none" : known) + ")");
}

std::optional<std::size_t> Simulation::Impl::structure_of(std::size_t obstacle) const {
  for (std::size_t s = 0; s < scene.structures.size(); ++s)
    if (scene.structures[s].obstacle == obstacle) return s;
  return {};
}

void Simulation::Impl::say_that_it_is_valid() {
  say("scene is valid: " + std::to_string(running->part().global_bodies) + " bodies, " +
      std::to_string(running->part().global_beams) + " beams\n");
  const std::string problem = RunFolder::problem(wish_of(scene), PETSC_COMM_WORLD);
  if (!problem.empty()) say("but a run would be refused now: " + problem + "\n");
}

const Results& Simulation::Impl::end() {
  if (results) return *results;
  if (scene.check_only) {
    results.emplace();
  } else {
    guarded([&] { results = running->finish(); });
  }
  ended = true;
  return *results;
}

Simulation::Simulation(Scene scene, const SimulationSettings& settings)
    : impl_(std::make_unique<Impl>(std::move(scene), settings)) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

void Simulation::on_sample(Observer observer) { impl_->observer = std::move(observer); }
bool Simulation::step_to(double time) { return impl_->advance(time); }
const Results& Simulation::run() {
  (void)impl_->advance(std::numeric_limits<double>::infinity());
  return impl_->end();
}
const Results& Simulation::results() { return impl_->end(); }
double Simulation::time() const { return impl_->running->time(); }
const Scene& Simulation::scene() const { return impl_->scene; }
std::vector<BodyState> Simulation::bodies() const { return impl_->running->bodies(); }

bool Simulation::prepare() { return impl_->prepare(); }
double Simulation::dt() const { return impl_->running->outcome().dt; }
bool Simulation::has_ended() const { return impl_->ended; }
const RunResult& Simulation::outcome() const {
  return impl_->results ? impl_->results->run : impl_->running->outcome();
}
BodyTable Simulation::all_bodies() const { return impl_->running->all_bodies(); }
BeamTable Simulation::beams() const { return impl_->running->beams(); }
std::vector<ContactOfPair> Simulation::contacts() { return impl_->prepared_run().contacts(); }
std::vector<std::pair<std::string, double>> Simulation::columns() {
  return impl_->prepared_run().columns();
}
std::vector<ObstacleNow> Simulation::obstacles() { return impl_->prepared_run().obstacles(); }
std::vector<std::string> Simulation::obstacle_names() const {
  std::vector<std::string> names;
  for (const Obstacle& obstacle : impl_->scene.obstacles) names.push_back(obstacle.name);
  return names;
}

void Simulation::prescribe(const std::string& obstacle, const PlaceAndMotion& to,
                           std::optional<double> until) {
  const std::size_t k = impl_->coupled_obstacle(obstacle);
  const Obstacle& o = impl_->scene.obstacles[k];
  if (impl_->structure_of(k))
    throw InputError("prescribe: obstacle '" + obstacle + "' has a mass: forces move it (apply)");
  const Quat<double>& q = to.orientation;
  const bool turns = length(to.spin) > 0 || q.x != 0 || q.y != 0 || q.z != 0;
  if (o.is_half_space() && turns)
    throw InputError("prescribe: obstacle '" + obstacle + "' is a half-space, which does not turn");
  Running& run = impl_->prepared_run();
  if (until && !(*until > run.time()))
    throw InputError("prescribe: until " + std::to_string(*until) + " must be > " +
                     std::to_string(run.time()) + " [s], the present time");
  run.drive(k, to, until);
}

void Simulation::apply(const std::string& obstacle, const Vec3<double>& force,
                       const Vec3<double>& moment) {
  const auto structure = impl_->structure_of(impl_->coupled_obstacle(obstacle));
  if (!structure)
    throw InputError("apply: obstacle '" + obstacle +
                     "' has no mass: its motion is prescribed (prescribe)");
  impl_->prepared_run().apply(*structure, force, moment);
}

std::shared_ptr<const SavedState> Simulation::save() {
  if (!impl_->settings.goes_back)
    throw InputError("save: the simulation was made without goes_back");
  return impl_->prepared_run().save();
}

void Simulation::restore(const SavedState& state) {
  impl_->prepared_run().restore(state);
  impl_->ended = false;
}

}  // namespace floe
