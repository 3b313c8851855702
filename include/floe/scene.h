/// \file
/// A scene: everything a user says, as plain structs with defaults. Read once, in one place, from
/// the table of options (src/scene/keys.cpp); nothing below this layer knows a key's name.
#pragma once

#include <array>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/base/given.h"
#include "floe/beams/beam_options.h"
#include "floe/beams/calibration.h"
#include "floe/contact/contact_options.h"
#include "floe/contact/obstacle.h"
#include "floe/forces/boundary.h"
#include "floe/forces/load.h"
#include "floe/fracture/fracture_options.h"
#include "floe/lattice/lattice.h"
#include "floe/mesh/tessellation.h"
#include "floe/water/drag_options.h"

namespace floe {

enum class Integrator { quasistatic, explicit_, implicit };

/// Whether a model may leave out what does not move: by itself, always (or refuse), never.
enum class Planarity { automatic, always, never };

struct Region {
  std::string name;
  std::array<double, 6> box{};  ///< x0, x1, y0, y1, z0, z1 [m]
};

struct Cut {
  std::string name;
  Point2 from{}, to{};  ///< [m]
  /// The command line changed the sheet under it, so that it may cross no beam any more.
  bool may_miss = false;
};

struct Initial {
  std::string name, set;
  Point3 velocity{};          ///< [m/s]
  Point3 angular_velocity{};  ///< [rad/s]
};

struct Scene {
  std::string path;  ///< the scene file
  std::string name;  ///< its stem
  Integrator integrator = Integrator::quasistatic;
  Planarity planar = Planarity::automatic;
  struct {
    bool beam = false, fracture = false, gravity = false, buoyancy = false, drag = false,
         contact = false;
  } forces;
  bool has_sheet = false;  ///< a sheet is meshed; otherwise lattice_file is read
  SheetPlan sheet;
  std::string mesh_file;  ///< where the sheet's relaxed generators are kept; empty: nowhere
  double thickness = 1;   ///< of the sheet [m]
  Ice ice;
  double shear_factor = 5.0 / 6.0;
  Torsion torsion = Torsion::saint_venant;
  std::string lattice_file;
  std::vector<Region> regions;
  std::vector<Cut> cuts;
  BeamOptions beam;
  FractureOptions fracture;
  Calibrate calibrate = Calibrate::none;
  double gravity = 9.81;        ///< [m/s^2]
  double water_density = 1010;  ///< [kg/m^3]
  DragOptions drag;
  double added_mass = 0;  ///< of the water that a body displaces at rest
  ContactOptions contact;
  std::vector<Obstacle> obstacles;
  std::vector<Boundary> boundaries;
  std::vector<Load> loads;
  struct {
    double end = 1;
    double dt = 0;  ///< 0: one step, from the stable step, or from the error
    double safety = 0.9;
    bool allow_unstable = false;
  } time;
  struct {
    double velocity = 1000;             ///< [m/s]
    double energy_error = 0.1;          ///< of the energies that moved
    double steps = 1e11, frames = 1e5;  ///< a run that needs more is refused
    double disk = 1000;                 ///< [GB]
    double memory = 0;                  ///< [GB]; 0: by what is free
  } limit;
  std::vector<Initial> initials;
  struct {
    bool tension = false, bending = false;
    bool may_go = false;  ///< asked for by the file, under a command line that may prevent it
  } report;
  struct {
    std::string dir;         ///< default out/NAME
    bool overwrite = false;  ///< take a folder that would be refused
    double history = 0;      ///< 0: every load step; explicit: 200 rows
    double fields = 0;       ///< 0: first and last state only
  } output;
  struct {
    double every = 600;   ///< wall time between two [s]
    bool at_end = false;  ///< the scene has the section: one at the end too
    /// Of the process, by the clock: a stop before it is over [s].
    double wall_time = std::numeric_limits<double>::infinity();
    std::string restart;  ///< file to go on from; empty: from time 0
  } checkpoint;
  /// Key and path of each file that the scene names.
  std::vector<std::pair<std::string, std::string>> inputs;
  bool check_only = false;
  std::string options_yaml;  ///< every option as used, PETSc's as given: what options.yaml holds
  std::vector<std::string> remarks;      ///< for the first lines of a run
  std::vector<std::string> warnings;     ///< numbers that look as if units were mistaken
  std::set<std::string> unused_options;  ///< PETSc's that no error says if nothing asks for them
};

/// Reads the scene from what the user gave. Collective.
/// \param path  of the scene's file: its stem is the scene's name
/// \throws InputError with one line that names the key, the value and what is allowed.
Scene read_scene(const std::string& path, const UserOptions& user);

/// The text of `floe -help`, the same table as Markdown (docs/options.md), and as part of the man
/// page.
std::string options_help();
std::string options_markdown();

/// Help of one section or key ("sheet", "sheet_length"); empty if there is no such thing.
std::string options_topic(const std::string& topic);
std::string options_man();

}  // namespace floe
