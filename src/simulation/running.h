/// \file
/// A simulation's model and its run. Their life is in simulation.cpp, what a program sees of them
/// and does to them in program_view.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "contact_force/contact.h"
#include "files/run_log.h"
#include "floe/base/petsc.h"
#include "floe/beams/moduli.h"
#include "floe/simulation.h"
#include "forces/program_force.h"
#include "lattice/packed_lattice.h"
#include "output/output.h"
#include "run/run.h"
#include "run_folder/run_folder.h"
#include "scene_model/scene_model.h"
#include "scene_model/supplied_ice.h"
#include "simulation/plan.h"
#include "simulation/scene_run.h"
#include "simulation/summary.h"

namespace floe {

using NamedValues = std::vector<std::pair<std::string, double>>;

/// The initial state, kept until the output folder exists.
template <class Space>
struct First {
  State<Space> state;
  Wrenches<Space> wrenches;
  NamedValues columns, forces;
};

/// Returns the moduli of a sheet's lattice; of a regular one where all bodies lie on its sides.
inline LatticeModuli moduli_of(const Scene& scene, const Lattice& lattice) {
  const LatticeRatios ratios = lattice_ratios(lattice, scene.beam.shear);
  if (std::isfinite(ratios.irregularity))
    return lattice_moduli(ratios, scene.ice.poisson, scene.beam.shear);
  return lattice_moduli(scene.sheet.element_size, scene.thickness, scene.ice, scene.shear_factor,
                        scene.beam.shear, scene.torsion);
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

/// Whether a run of the scene may go back to a saved state.
inline bool can_go_back(const Scene& scene) {
  return scene.integrator == Integrator::explicit_ && scene.backend == Backend::cpu &&
         !scene.check_only;
}

/// Whether a program moves or loads an obstacle.
inline bool is_coupled(const Setting& setting, const std::string& obstacle) {
  const std::vector<std::string>& names = setting.settings.coupled;
  return std::find(names.begin(), names.end(), obstacle) != names.end();
}

/// Of one simulation.
class KeptState final : public SavedState {
 public:
  const void* of = nullptr;
  std::unique_ptr<const RunState> run;
  std::optional<OutputState> output;  ///< none: no file was written
};

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
  virtual const RunResult& outcome() const = 0;
  virtual BodyTable all_bodies() const = 0;
  virtual BeamTable beams() const = 0;
  virtual std::vector<ContactOfPair> contacts() = 0;
  virtual NamedValues columns() = 0;
  virtual std::vector<ObstacleNow> obstacles() = 0;
  virtual void drive(std::size_t k, const PlaceAndMotion& to, std::optional<double> until) = 0;
  virtual void apply(std::size_t structure, const Vec3<double>& force,
                     const Vec3<double>& moment) = 0;
  virtual std::shared_ptr<const SavedState> save() = 0;
  virtual void restore(const SavedState& state) = 0;
};

/// The same for one kind of model.
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
  const RunResult& outcome() const override { return run_->outcome(); }
  BodyTable all_bodies() const override;
  BeamTable beams() const override;
  std::vector<ContactOfPair> contacts() override;
  NamedValues columns() override;
  std::vector<ObstacleNow> obstacles() override;
  void drive(std::size_t k, const PlaceAndMotion& to, std::optional<double> until) override;
  void apply(std::size_t structure, const Vec3<double>& force, const Vec3<double>& moment) override;
  std::shared_ptr<const SavedState> save() override;
  void restore(const SavedState& state) override;

 private:
  const State<Space>* state() const;
  std::int32_t body_of(std::size_t structure) const {
    return model_->part().global_bodies - static_cast<std::int32_t>(scene_.structures.size()) +
           static_cast<std::int32_t>(structure);
  }
  void open(const std::vector<std::string>& columns);
  void prepare_output(const std::vector<std::string>& columns) {
    if (!output_) open(columns);
  }
  void equip(const Lattice& lattice);
  void add_forces_of_program();
  void add_far_edge();
  void divide(const std::vector<std::int32_t>& owner);
  BalanceOptions balance();
  std::optional<SupplyOptions> supply();
  void divide(Lattice lattice, const std::vector<std::int32_t>& owner);
  Renumbering change(SuppliedIce::Change change, const IceNow& now);
  void persist_ice(Archive& archive);
  PresentMesh present_mesh() const {
    if (mesh_frame_ == 0) return {};
    return {.first = mesh_frame_, .names = setting_.mesh.ice->names_of_bodies()};
  }
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
  Contact* contact_ = nullptr;           // null without contact
  bool keeps_contacts_ = false;          // of contacts the forces
  std::shared_ptr<std::vector<AppliedWrench>> applied_ =
      std::make_shared<std::vector<AppliedWrench>>();
  std::unique_ptr<Run> run_;
};

}  // namespace floe
