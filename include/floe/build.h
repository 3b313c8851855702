/// \file
/// From a scene to what runs: sheet -> lattice -> model -> forces, and back to a summary.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "floe/forces/load.h"
#include "floe/output/output.h"
#include "floe/scene.h"
#include "floe/solve/integrator.h"

namespace floe {

/// What mesh and calibration say of themselves.
struct MeshReport {
  double energy_ratio = 0;
  double largest_move = 0;
  int iterations = 0;
  std::int64_t degenerate = 0;
  std::optional<Calibration> calibration;
};

/// Meshes the sheet or reads the file, makes cuts and regions, orders bodies and beams. Collective;
/// the lattice is whole and the same on every rank. \throws InputError for what a file or a scene
/// has wrong
Lattice make_lattice(const Scene& scene, MPI_Comm comm, MeshReport& report);

/// Sets the velocities of the scene's `initial` sections. \throws InputError for an unknown set
void set_initial(const Scene& scene, Lattice& lattice);

/// Where an explicit run writes its checkpoints.
std::string checkpoint_file(const Scene& scene);

/// Runs the scene's integrator. Collective. \param lattice_id  its fingerprint, for checkpoints
/// \param prepare  opens the output that a checkpoint goes with, if it is not open
/// \param others  what checkpoints keep beside the integrator's state
RunResult integrate(const Scene& scene, Model<Spatial>& model, const std::string& lattice_id,
                    const Observer<Spatial>& observer, const std::function<void()>& prepare,
                    const std::function<void(Memory&)>& others);

/// The scene's loads on the lattice's bodies. \throws InputError for an unknown set
std::vector<PlacedLoad> place_loads(const Scene& scene, const Lattice& lattice);

/// Adds the forces that the scene names to the model, and its loads.
/// \throws InputError if the lattice cannot carry one (buoyancy without shapes)
void add_forces(const Scene& scene, const std::vector<PlacedLoad>& loads, Model<Spatial>& model);

/// Adds contacts, if the scene names them. \param lattice  whole
/// \throws InputError if bodies have no shapes or are not convex
void add_contact(const Scene& scene, const Lattice& lattice, Model<Spatial>& model);

/// Takes free rigid motions out of a static problem.
/// \throws InputError if a load pushes one of them: the scene has no equilibrium
void hold_free_motions(const Scene& scene, const Lattice& lattice, Model<Spatial>& model);

/// \throws InputError if the scene is not the test that it wants reported
void check_reports(const Scene& scene);

/// summary.json of a run, and the lines that a user reads at its end.
struct Summary {
  std::string json, text;
};
Summary summarise(const Scene& scene, const Model<Spatial>& model, const MeshReport& mesh,
                  const RunResult& result, const Sample& first, const Sample& last,
                  double wall_seconds);

}  // namespace floe
