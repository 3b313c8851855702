/// \file
/// From a scene to a run: sheet -> lattice -> model -> forces, and back to a summary.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "floe/scene.h"
#include "forces/dead_load.h"
#include "output/output.h"
#include "run/run.h"
#include "run_folder/size.h"
#include "statics/quasistatic.h"

namespace floe {

/// Strengths of a sheet before its calibration, and the factors on its beams that give the sheet
/// the scene's strengths (model.md, "Fracture").
struct StrengthCalibration {
  /// Nominal stress at the first break over the given strength.
  struct Test {
    double along_x = 1, along_y = 1;
  };
  std::optional<Test> tension;  ///< of the uncalibrated sheet; none: only bending is calibrated
  double factor = 1;            ///< of the beams' strengths
  Test bending;                 ///< of the sheet that is calibrated in tension
  double bending_factor = 1;    ///< FractureOptions::bending_factor
};

/// Results of mesh and calibration.
struct MeshReport {
  double energy_ratio = 0;
  double largest_move = 0;
  int iterations = 0;
  std::int64_t degenerate = 0;
  std::optional<Calibration> calibration;
  std::optional<StrengthCalibration> strength;
  std::string cuts;  ///< a remark on cuts on which cells do not end; empty: there are none
  std::function<void()> keep = [] {
    /// Writes the mesh's file, if one is to be written. Collective.
  };
};

/// Meshes the sheet or reads the file, makes cuts and regions, orders bodies and beams. The lattice
/// is whole and the same on every rank. Collective.
/// \throws InputError for errors in the file or the scene
Lattice make_lattice(const Scene& scene, MPI_Comm comm, MeshReport& report);

/// Measures a sheet's strengths: stretches and bends the whole sheet, its beams without scatter,
/// along x and along y with small displacements, each time until the first beam (in bending away
/// from the ends) reaches its strength (model.md, "Fracture"). Collective.
/// \param lattice  with the sets left, right, bottom and top
StrengthCalibration calibrate_strength(const Scene& scene, const Lattice& lattice, MPI_Comm comm);

/// Multiplies the strengths in the scene by the factor of the calibration, and sets the weight of
/// bending.
void strengthen(Scene& scene, const StrengthCalibration& c);
/// Describes the calibration in one line for the user.
std::string text_of(const StrengthCalibration& c);

/// Sets the velocities of the scene's `initial` sections. \throws InputError for an unknown set
void set_initial(const Scene& scene, Lattice& lattice);

/// Choice of the model: the parts that a scene does not need, decided once.
struct ModelChoice {
  bool planar = false;  ///< nothing loads, moves or prescribes anything out of the plane
  std::string
      needs_space;   ///< reason why it is not planar; empty if it is, or if any model would do
  std::string text;  ///< one line: "planar, linear, undamped, no water, no contact"
};
/// Chooses the model. \throws InputError if the scene asks for `planar: true` and is not planar
ModelChoice choose_model(const Scene& scene, const Lattice& lattice);

/// Returns the path of a run's checkpoint.
std::string checkpoint_file(const Scene& scene);

/// The surroundings of a run.
struct RunHooks {
  std::string lattice_id;  ///< fingerprint of the lattice, for checkpoints
  OnPlan on_plan;          ///< receives the plan before the first step; false: no run is made
  std::function<void(const std::vector<std::string>&)> prepare;  ///< CheckpointOptions::prepare
  std::function<void(Archive&)> others;                          ///< CheckpointOptions::others
  const std::vector<PlacedLoad>* loads = nullptr;                ///< for static: monitor
};

/// Makes the run of the scene's integrator. Collective.
/// \param out_of_plane  the part that a planar model leaves out; null for a spatial model
template <class Space>
std::unique_ptr<Run> make_run(const Scene& scene, Model<Space>& model,
                              const OutOfPlane* out_of_plane, const RunHooks& hooks,
                              ObserverOf<Space> observer);

/// Returns the lines that describe the plan of a run and what it needs.
/// \param memory  of all ranks, at present [bytes]
/// \throws InputError if the run needs more than the scene's limits allow
std::string plan_text(const Scene& scene, const RunPlan& plan, const OutputSize& size,
                      double memory);

/// Places the scene's loads on the lattice's bodies. \throws InputError for an unknown set or a
/// point beside the lattice
std::vector<PlacedLoad> place_loads(const Scene& scene, const Lattice& lattice);

/// Adds the scene's forces and loads to the model.
/// \param lattice  whole; needed for `fracture: propagation: energy`, which looks at its facets
/// \throws InputError if the lattice cannot carry one (buoyancy without shapes)
template <class Space>
void add_forces(const Scene& scene, const std::vector<PlacedLoad>& loads, Model<Space>& model,
                const Lattice* lattice = nullptr);

/// Adds contact, if the scene names it.
/// \param lattice  whole
/// \throws InputError if bodies have no shapes or are not convex
template <class Space>
void add_contact(const Scene& scene, const Lattice& lattice, Model<Space>& model);

/// Whether any force needs the bodies' shapes.
bool needs_shapes(const Scene& scene);

/// Frees data that only the set-up of forces needed: beside these data the steps of a large sheet
/// need little memory.
template <class Space>
void release_setup(const Scene& scene, Model<Space>& model);

/// Pins the free rigid motions of a static problem. Collective.
/// \throws InputError if a load pushes one of them, so that the scene has no equilibrium
template <class Space>
void hold_free_motions(const Scene& scene, const Lattice& lattice, Model<Space>& model);

/// Returns the part of a static problem that a planar model leaves out.
OutOfPlane out_of_plane(const Scene& scene, const Lattice& lattice,
                        const std::vector<PlacedLoad>& loads, const Part& part);

/// Checks that the scene is the test that it wants reported. If the command line may be the cause
/// that it is not, the report is dropped with a remark.
/// \throws InputError if the scene is not that test for another reason
void check_reports(Scene& scene);

/// summary.json of a run, and the lines that a user reads at its end.
struct Summary {
  std::string json, text;
};
template <class Space>
Summary summarise(const Scene& scene, const ModelChoice& choice, const Model<Space>& model,
                  const MeshReport& mesh, const RunResult& result, const Sample& first,
                  const Sample& last, double wall_seconds);

}  // namespace floe
