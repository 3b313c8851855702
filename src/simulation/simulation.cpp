// A scene's run, from the lock of its folder to its summary.
#include "floe/simulation.h"

#include <cmath>
#include <limits>
#include <optional>

#include "files/files.h"
#include "files/run_log.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/beams/moduli.h"
#include "floe/files/log.h"
#include "floe/options/options.h"
#include "floe/session/session.h"
#include "floe/session/unused_options.h"
#include "floe/session/version.h"
#include "lattice/packed_lattice.h"
#include "output/output.h"
#include "run/run.h"
#include "run_folder/run_folder.h"
#include "scene/restart.h"
#include "scene_model/scene_model.h"
#include "scene_model/supplied_ice.h"
#include "session/run_place.h"
#include "session/signals.h"
#include "simulation/plan.h"
#include "simulation/scene_run.h"
#include "simulation/summary.h"

namespace floe {
namespace {

constexpr int exit_failed = 1;

using Columns = std::vector<std::pair<std::string, double>>;

/// The initial state, kept until the output folder exists.
template <class Space>
struct First {
  State<Space> state;
  Wrenches<Space> wrenches;
  Columns columns, forces;
};

std::vector<std::string> names_of(const Columns& forces, const Columns& integrator) {
  std::vector<std::string> names;
  for (const Columns* columns : {&forces, &integrator}) {
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

/// Returns the moduli of a sheet's lattice; of a regular one where all bodies lie on its sides.
LatticeModuli moduli_of(const Scene& scene, const Lattice& lattice) {
  const LatticeRatios ratios = lattice_ratios(lattice, scene.beam.shear);
  if (std::isfinite(ratios.irregularity))
    return lattice_moduli(ratios, scene.ice.poisson, scene.beam.shear);
  return lattice_moduli(scene.sheet.element_size, scene.thickness, scene.ice, scene.shear_factor,
                        scene.beam.shear, scene.torsion);
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

/// What a simulation has before its model.
struct Setting {
  Scene scene;
  SimulationSettings settings;
  std::optional<RunFolder> folder;  ///< none if the scene is only checked
  MeshReport mesh;
  Lattice lattice;
  ModelChoice choice;

  void say(const std::string& text) const {
    if (settings.talks && rank() == 0) print(text);
  }
  /// Prints the scene's warnings. Bad input ends with a single line, so they come only when the run
  /// is known to be possible.
  void say_warnings() const {
    if (!settings.talks || rank() != 0) return;
    for (const std::string& warning : scene.warnings)
      print_error("floe: warning: " + warning + "\n");
  }
};

/// The scene's claim to its output folder.
FolderWish wish_of(const Scene& scene) {
  return {scene.output.dir, scene.path, scene.inputs, scene.output.overwrite,
          !scene.checkpoint.restart.empty()};
}

/// The model of a simulation and its run, in space or in the plane.
class Running {
 public:
  virtual ~Running() = default;
  virtual bool prepare() = 0;
  virtual bool advance(double until) = 0;
  virtual Results finish() = 0;
  virtual double time() const = 0;
  virtual std::vector<BodyState> bodies() const = 0;
  virtual const Part& part() const = 0;
};

template <class Space>
class RunningIn final : public Running {
 public:
  RunningIn(Setting& setting, const Simulation::Observer& observer);

  bool prepare() override { return run_->prepare(); }
  bool advance(double until) override { return run_->advance(until); }
  Results finish() override;
  double time() const override { return run_->time(); }
  std::vector<BodyState> bodies() const override;
  const Part& part() const override { return model_->part(); }

 private:
  void open(const std::vector<std::string>& columns);
  void prepare_output(const std::vector<std::string>& columns) {
    if (!output_) open(columns);
  }
  void equip(const Lattice& lattice);
  void add_far_edge();
  void divide(const std::vector<std::int32_t>& owner);
  BalanceOptions balance();
  std::optional<SupplyOptions> supply();
  void divide(Lattice lattice, const std::vector<std::int32_t>& owner);
  Renumbering change(SuppliedIce::Change change, const IceNow& now);
  void persist_ice(Archive& archive);
  PresentMesh present_mesh() const;
  bool plan(const RunPlan& plan);
  void observe(const Accepted<Space>& accepted);
  void show(std::int64_t step);
  void persist(Archive& archive);

  Setting& setting_;
  const Simulation::Observer& observer_;
  const Scene& scene_ = setting_.scene;
  const bool is_static_ = scene_.integrator == Integrator::quasistatic;
  const std::string lattice_id_ = fingerprint(setting_.lattice);
  const OutputSize size_of_output_ =
      output_size(setting_.lattice, scene_.forces.fracture, scene_.boundaries.size(),
                  scene_.loads.size(), scene_.obstacles.size());
  PackedLattice packed_;
  /// The lattice once more, for moves of bodies between ranks; empty where none can move.
  Lattice whole_;
  PackedLattice packed_whole_;
  LatticeModuli moduli_ = setting_.scene.supply.absorbs
                              ? moduli_of(setting_.scene, setting_.lattice)
                              : LatticeModuli{};             ///< over that of the ice
  double young_ = moduli_.young * setting_.scene.ice.young;  ///< of the sheet [Pa]
  const FarEdge<Space>* far_edge_ = nullptr;
  std::int64_t mesh_frame_ = 0;  ///< first frame of the mesh of the present bodies, on a restart
  std::vector<std::int32_t> owner_;  ///< of the bodies since ice has joined or left last
  std::vector<PlacedLoad> loads_;
  std::optional<Model<Space>> model_;
  std::optional<OutOfPlane> out_of_plane_;
  std::unique_ptr<Output<Space>> output_;
  std::optional<OutputArchive> restart_;  // history of the files to go on with, from a checkpoint
  std::optional<First<Space>> first_;
  const State<Space>* state_ = nullptr;  // of the last accepted state
  std::unique_ptr<Run> run_;
};

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
                   .loads = &loads_},
                  [this](const Accepted<Space>& accepted) { observe(accepted); });
}

/// Gives the model its forces.
template <class Space>
void RunningIn<Space>::equip(const Lattice& lattice) {
  add_forces(scene_, loads_, *model_, &lattice);
  add_far_edge();
  add_contact(scene_, lattice, *model_);
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
  if (!can_move) return options;
  whole_ = setting_.lattice;
  packed_whole_.pack_shapes(whole_);
  packed_whole_.pack_beams(whole_);
  options.divide = [this](const std::vector<std::int32_t>& owner) { divide(owner); };
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
PresentMesh RunningIn<Space>::present_mesh() const {
  if (mesh_frame_ == 0) return {};
  return {.first = mesh_frame_, .names = setting_.mesh.ice->names_of_bodies()};
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

}  // namespace

struct Simulation::Impl : Setting {
  Observer observer;
  std::unique_ptr<Running> running;
  std::optional<Results> results;
  bool prepared = false, ended = false;

  Impl(Scene given, const SimulationSettings& with);
  ~Impl();
  void lock();
  void make_lattice_and_choose_model();
  bool advance(double until);
  const Results& end();
  void note_failure(const Verdict& why, bool failed) {
    if (folder && rank() == 0 && (folder->has_begun() || failed)) folder->fail(why.what());
    set_last_words({});
    ended = true;
  }
  void say_that_it_is_valid();
  /// Runs work; if an error ends the run, the folder's summary says so.
  template <class Work>
  auto guarded(Work&& work) {
    try {
      return work();
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
  set_last_words({});
}

void Simulation::Impl::lock() {
  folder.emplace(wish_of(scene), PETSC_COMM_WORLD);
  set_last_words([this](const std::string& why) {
    if (folder && (folder->has_begun() || run_place().code == exit_failed)) {
      folder->fail(why);
    } else {
      folder.reset();  // removes all that was made
    }
  });
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

bool Simulation::Impl::advance(double until) {
  if (ended) return false;
  return guarded([&] {
    if (!prepared) ended = !running->prepare();
    prepared = true;
    if (ended && scene.check_only) say_that_it_is_valid();
    ended = ended || !running->advance(until);
    return !ended;
  });
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

}  // namespace floe
