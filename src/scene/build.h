/// \file
/// From a scene to what runs: sheet -> lattice -> model -> forces, and back to a summary.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "floe/scene.h"
#include "forces/dead_load.h"
#include "output/output.h"
#include "output/size.h"
#include "statics/quasistatic.h"

namespace floe {

/// What a sheet's strength is, and what its beams must have for it to be the given one (model.md
/// section 12).
struct StrengthCalibration {
  double along_x = 1, along_y = 1;  ///< of the uncalibrated sheet at its first break, over sigma_t
  double factor = 1;                ///< for the beams' strengths
};

/// What mesh and calibration say of themselves.
struct MeshReport {
  double energy_ratio = 0;
  double largest_move = 0;
  int iterations = 0;
  std::int64_t degenerate = 0;
  std::optional<Calibration> calibration;
  std::optional<StrengthCalibration> strength;
  std::function<void()> keep = [] {
  };  ///< writes the mesh's file, if it is to be written. Collective
};

/// Meshes the sheet or reads the file, makes cuts and regions, orders bodies and beams. Collective;
/// the lattice is whole and the same on every rank. \throws InputError for what a file or a scene
/// has wrong
Lattice make_lattice(const Scene& scene, MPI_Comm comm, MeshReport& report);

/// Stretches the whole, unscattered sheet along x and along y, in its plane and for small
/// displacements, each time to where the first beam reaches its strength. Collective.
/// \param lattice  with the sets left, right, bottom and top
StrengthCalibration calibrate_strength(const Scene& scene, const Lattice& lattice, MPI_Comm comm);

/// Gives the beams what makes the scene's strengths the sheet's.
void strengthen(Scene& scene, const StrengthCalibration& c);
/// One line for the user.
std::string text_of(const StrengthCalibration& c);

/// Sets the velocities of the scene's `initial` sections. \throws InputError for an unknown set
void set_initial(const Scene& scene, Lattice& lattice);

/// What a scene does not need, decided once.
struct ModelChoice {
  bool planar = false;      ///< nothing loads, moves or prescribes anything out of the plane
  std::string needs_space;  ///< why it is not planar; empty if it is, or need not be
  std::string text;         ///< one line: "planar, linear, undamped, no water, no contact"
};
/// \throws InputError if the scene says `planar: true` and cannot be
ModelChoice choose_model(const Scene& scene, const Lattice& lattice);

/// Where an explicit run writes its checkpoints.
std::string checkpoint_file(const Scene& scene);

/// Runs the scene's integrator. Collective.
/// \param rest  what a planar model leaves out; null for a spatial one
/// \param lattice_id  its fingerprint, for checkpoints
/// \param on_plan  is told what the run will do before its first step; false: it is not made
/// \param prepare  as CheckpointOptions::prepare
/// \param others  what checkpoints keep beside the integrator's state
template <class Space>
RunResult integrate(const Scene& scene, Model<Space>& model, const OutOfPlane* rest,
                    const std::string& lattice_id, const OnPlan& on_plan,
                    const ObserverOf<Space>& observer,
                    const std::function<void(const std::vector<std::string>&)>& prepare,
                    const std::function<void(Archive&)>& others);

/// Lines that say what a run is going to do and to take. \param memory  of all ranks, at present
/// [bytes]   \throws InputError if it needs more than the scene's limits allow
std::string plan_text(const Scene& scene, const RunPlan& plan, const OutputSize& size,
                      double memory);

/// The scene's loads on the lattice's bodies. \throws InputError for an unknown set
std::vector<PlacedLoad> place_loads(const Scene& scene, const Lattice& lattice);

/// Adds the forces that the scene names to the model, and its loads.
/// \throws InputError if the lattice cannot carry one (buoyancy without shapes)
template <class Space>
void add_forces(const Scene& scene, const std::vector<PlacedLoad>& loads, Model<Space>& model);

/// Adds contacts, if the scene names them. \param lattice  whole
/// \throws InputError if bodies have no shapes or are not convex
template <class Space>
void add_contact(const Scene& scene, const Lattice& lattice, Model<Space>& model);

/// Whether some force looks at the bodies' shapes.
bool needs_shapes(const Scene& scene);

/// Lets go of what only making the forces needed. Beside that a large sheet's steps are small.
template <class Space>
void release_setup(const Scene& scene, Model<Space>& model);

/// Takes free rigid motions out of a static problem.
/// \throws InputError if a load pushes one of them: the scene has no equilibrium
template <class Space>
void hold_free_motions(const Scene& scene, const Lattice& lattice, Model<Space>& model);

/// What a planar model of a static problem leaves out.
OutOfPlane out_of_plane(const Scene& scene, const Lattice& lattice,
                        const std::vector<PlacedLoad>& loads, const Part& part);

/// \throws InputError if the scene is not the test that it wants reported; if the command line may
/// be the cause, the report is left out with a remark instead
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
