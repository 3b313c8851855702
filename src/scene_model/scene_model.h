/// \file
/// From a scene to a model: sheet -> lattice -> model -> forces.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "floe/scene.h"
#include "forces/dead_load.h"
#include "model/model.h"
#include "scene_model/bonds.h"
#include "scene_model/sheet_strength.h"
#include "scene_model/thickness.h"
#include "statics/quasistatic.h"

namespace floe {

class Contact;
class SuppliedIce;

/// Results of mesh and calibration.
struct MeshReport {
  double energy_ratio = 0;
  double largest_move = 0;
  int iterations = 0;
  std::int64_t degenerate = 0;
  std::optional<Calibration> calibration;
  std::optional<StrengthCalibration> strength;
  std::optional<ThicknessReport> thickness;  ///< of a sheet whose thickness varies
  std::optional<BondReport> bonds;           ///< of a scene with bonds
  std::string outline;  ///< a line on the sheet's outline; empty: the sheet is a rectangle
  std::string cuts;     ///< a remark on cuts on which cells do not end; empty: there are none
  std::shared_ptr<SuppliedIce> ice;  ///< of a sheet without end
  std::function<void()> keep = [] {
    /// Writes the mesh's file, if one is to be written. Collective.
  };
};

/// Meshes the sheet or reads the file, makes cuts and regions, orders bodies and beams. The lattice
/// is whole and the same on every rank. Collective.
/// \throws InputError for errors in the file or the scene
Lattice make_lattice(const Scene& scene, MPI_Comm comm, MeshReport& report);

/// The section of the scene's sheet.
SheetSection section_of(const Scene& scene);

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
/// \return the force, which the model owns; null without contact
/// \throws InputError if bodies have no shapes or are not convex
template <class Space>
Contact* add_contact(const Scene& scene, const Lattice& lattice, Model<Space>& model);

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

}  // namespace floe
