/// \file
/// A scene: all user input, as plain structs with defaults. It is read once, in one place, from the
/// table of options (src/scene/keys.cpp); lower layers know no names of keys.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/beams/beam_options.h"
#include "floe/beams/calibration.h"
#include "floe/contact/obstacle.h"
#include "floe/contact_laws/contact_options.h"
#include "floe/explicit/backend.h"
#include "floe/forces/boundary.h"
#include "floe/forces/load.h"
#include "floe/forces/mooring_line.h"
#include "floe/forces/support.h"
#include "floe/fracture/fracture_options.h"
#include "floe/lattice/lattice.h"
#include "floe/mesh/tessellation.h"
#include "floe/options/given.h"
#include "floe/water/drag_options.h"
#include "floe/water/wave_options.h"

namespace floe {

enum class Integrator { quasistatic, explicit_, implicit };

/// Whether a run takes the planar model: where the scene allows it, always (or the scene is
/// refused), never.
enum class Planarity { automatic, always, never };

struct Region {
  std::string name;
  std::array<double, 6> box{};  ///< x0, x1, y0, y1, z0, z1 [m]
  bool edge = false;            ///< of bodies with an edge of the sheet in the box, not a centroid
};

struct Cut {
  std::string name;
  Point2 from{}, to{};  ///< [m]
  /// Whether the cut may cross no beam, since the command line changed the sheet.
  bool may_miss = false;
};

struct Initial {
  std::string name, set;
  Point3 velocity{};          ///< [m/s]
  Point3 angular_velocity{};  ///< [rad/s]
};

/// Where faces of bodies are frozen together at the start, and how well.
struct Bonds {
  double gap = 0;  ///< widest gap between two faces that are [m]
  bool given = false, in_box = false;
  /// Where the middle of the faces lies: x0, x1, y0, y1, z0, z1 [m].
  std::array<double, 6> box{-1e9, 1e9, -1e9, 1e9, -1e9, 1e9};
  double young = 4e9;               ///< [Pa]
  double strength = 1, energy = 1;  ///< factors of those of fracture
};

/// How the thickness of a sheet varies over its plan.
struct ThicknessField {
  std::string file;                     ///< a grid; empty: none
  double deviation = 0;                 ///< standard deviation of a random field [m]; 0: none
  std::array<double, 2> correlation{};  ///< its correlation lengths in x and y [m]
  std::uint64_t seed = 1;
  /// of each polygon of the outline [m], NaN: as the field says; empty: not by polygon
  std::vector<double> of_polygon{};
  bool varies() const { return !file.empty() || deviation > 0 || !of_polygon.empty(); }
};

/// Where an outline comes from: as placed, but before it was simplified.
struct OutlineSource {
  std::string file;                   ///< empty: a rectangle
  double simplify = 0;                ///< tolerance [m]; where polygons have their own: the largest
  double least_simplify = 0;          ///< the least [m]
  std::vector<std::int32_t> feature;  ///< of each polygon, from 1
  std::vector<double> thickness;      ///< of each polygon in the file [m]; NaN: none
  bool has_thickness = false;         ///< whether these are taken
  std::size_t corners = 0;            ///< of all rings
  double area = 0;                    ///< [m^2]
  double moved = 0;                   ///< area between it and the simplified one [m^2]
};

/// A floe with a section of its own.
struct Floe {
  std::string name;
  OutlineSource outline;
  std::size_t first = 0, polygons = 0;  ///< its polygons in the outline of the plan
  double element_size = 2;              ///< [m]
  std::uint64_t seed = 1;
  std::vector<double> thickness;    ///< of each polygon [m]; empty: that of the sheet
  double strength = 1, energy = 1;  ///< factors of those of fracture
};

/// An obstacle that forces move: a body of the model.
struct Structure {
  std::size_t obstacle = 0;              ///< number of the obstacle, whose name it has
  double mass = 0;                       ///< [kg]
  std::optional<Point3> inertia;         ///< about axes of the world through its centre [kg m^2]
  std::optional<Point3> centre;          ///< of mass [m]; none: that of its shape
  std::array<double, 6> added_mass{};    ///< along and about axes of the world [kg, kg m^2]
  bool floats = false;                   ///< whether weight and water act on it
  SupportMatrix stiffness{}, damping{};  ///< of its support
  std::optional<double> damping_ratio;   ///< in place of the damping
  std::optional<Point3> support_point;   ///< at rest [m]; none: its centre of mass
};

/// A mooring line of a structure, whose body is known once there is a lattice.
struct SceneLine {
  std::size_t structure = 0;  ///< number of the structure
  MooringLine line;
};

/// A table that a file of the scene gives.
struct SceneTable {
  std::string key, file;
  std::vector<std::vector<double>> rows;
};

/// The input of a run.
struct Scene {
  std::string path;  ///< the scene file
  std::string name;  ///< its stem
  Integrator integrator = Integrator::quasistatic;
  Planarity planar = Planarity::automatic;
  Periods periods;            ///< after which the model repeats itself
  double inertia_factor = 1;  ///< by which the moments of inertia of all bodies are multiplied
  struct {
    bool beam = false, fracture = false, gravity = false, buoyancy = false, drag = false,
         contact = false;
  } forces;
  bool has_sheet = false;  ///< whether a sheet is meshed; otherwise lattice_file is read
  bool fit_cuts = true;    ///< whether the sheet's cells end on the lines of cuts
  SheetPlan sheet;
  OutlineSource outline;    ///< of the sheet
  std::vector<Floe> floes;  ///< whose polygons are the sheet's; empty: the sheet is one
  /// Ice that joins the sheet's left side, strip by strip, and leaves.
  struct {
    bool on = false;
    double strip = 0;                                         ///< length of a strip [m]
    double length = std::numeric_limits<double>::infinity();  ///< of all ice, with the sheet [m]
    /// Outside this box {x0, x1, y0, y1, z0, z1} pieces leave [m]; none: all stay.
    std::optional<std::array<double, 6>> region;
    /// Whether the far edge has dashpots and a spring in place of a prescribed motion.
    bool absorbs = false;
    Point3 velocity{};  ///< with absorbs: of the ice behind [m/s]
    Ramp ramp;          ///< of that velocity
    double spring = 0;  ///< with absorbs: length of ice of the spring's stiffness [m]; 0: none
    /// With absorbs, in place of the velocity: mean pressure of the ice behind on the edge, which
    /// rises by the ramp, and the time over which the edge's own mean velocity is taken [s].
    std::optional<double> pressure;  // [Pa]
    double response = 0;
  } supply;
  std::string mesh_file;  ///< file of the sheet's relaxed generators; empty: none
  double thickness = 1;   ///< of the sheet [m]; the mean of a random field
  ThicknessField thickness_field;
  Ice ice;
  double shear_factor = 5.0 / 6.0;
  Torsion torsion = Torsion::saint_venant;
  std::string lattice_file;
  std::vector<Region> regions;
  std::vector<Cut> cuts;
  Bonds bonds;
  BeamOptions beam;
  FractureOptions fracture;
  Calibrate calibrate = Calibrate::none;
  double gravity = 9.81;        ///< [m/s^2]
  double water_density = 1010;  ///< [kg/m^3]
  Backend backend = Backend::cpu;
  int water_pace = 1;  ///< the submerged parts are found in every step of this number
  DragOptions drag;
  WaveOptions waves;
  double added_mass = 0;  ///< relative to the mass of water that a body displaces at rest
  /// The same along the principal axes of a body, and for the moments about them.
  std::optional<std::array<double, 6>> added_mass_axes;
  bool added_mass_plate = false;  ///< each body's added mass is that of a floating disc
  ContactOptions contact;
  std::vector<Obstacle> obstacles;
  std::vector<Structure> structures;
  std::vector<SceneLine> lines;
  std::vector<Boundary> boundaries;
  std::vector<Load> loads;
  struct {
    double end = 1;
    double dt = 0;  ///< step [s]; 0: one step, from the stable step, or from the error
    double safety = 0.9;
    bool allow_unstable = false;
  } time;
  struct {
    double velocity = 1000;             ///< [m/s]
    double energy_error = 0.1;          ///< relative to the energies that moved
    double steps = 1e11, frames = 1e5;  ///< a run that needs more is refused
    double disk = 1000;                 ///< [GB]
    double memory = 0;                  ///< [GB]; 0: by free memory
  } limit;
  /// Statics along a path, with the load factor as an unknown.
  struct {
    bool arc = false;
    double arc_length = 0, arc_length_min = 0, arc_length_max = 0;  ///< [m]; 0: chosen
    std::int64_t steps = 1000;
    std::optional<double> load_factor;  ///< the path ends there
    std::string monitor;                ///< load or boundary whose displacement may end it
    int component = 0;                  ///< of this displacement
    double displacement = 0;            ///< [m]
    double growth = 0.05;
  } path_control;
  std::vector<Initial> initials;
  struct {
    bool tension = false, bending = false;
    bool may_go = false;  ///< the file asks for a report that the command line may prevent
  } report;
  struct {
    std::string dir;         ///< default out/NAME
    bool overwrite = false;  ///< take a folder that would be refused
    double history = 0;      ///< 0: every load step; explicit: 200 rows
    double fields = 0;       ///< 0: first and last state only
    double pressure = 0;     ///< between samples of pressures on obstacles; 0: none
  } output;
  struct {
    double every = 600;   ///< wall time between two [s]
    bool at_end = false;  ///< the scene has the section: a checkpoint at the end too
    /// Wall time of the process [s]: the run stops before it is over.
    double wall_time = std::numeric_limits<double>::infinity();
    std::string restart;  ///< file to go on from; empty: from time 0
  } checkpoint;
  /// When bodies move between ranks.
  struct {
    double threshold = 1.15;    ///< largest load of a rank over the mean; 1: at each look
    std::int64_t every = 1000;  ///< steps between looks
  } partition;
  /// Key and path of each file that the scene names.
  std::vector<std::pair<std::string, std::string>> inputs;
  /// Their numbers, as far as they are tables: a run that goes on must have the same.
  std::vector<SceneTable> tables;
  bool check_only = false;
  std::string options_yaml;  ///< contents of options.yaml: every option as used, PETSc's as given
  std::vector<std::string> remarks;      ///< for the first lines of a run
  std::vector<std::string> warnings;     ///< about numbers that suggest mistaken units
  std::set<std::string> unused_options;  ///< PETSc's, which no error reports if they are never read
};

/// Returns the plan area of a floe [m^2].
double area_of(const Scene& scene, const Floe& floe);

/// Reads the scene from the user's options. Collective.
/// \param path  path of the scene's file, whose stem is the scene's name
/// \throws InputError with one line that names the key, the value and the allowed values
Scene read_scene(const std::string& path, const UserOptions& user);

/// Texts of the table of options: for `floe -help`, as Markdown (docs/options.md), and as a part of
/// the man page (options_man()).
std::string options_help();
std::string options_markdown();

/// Returns the help of one section or key ("sheet", "sheet_length"); empty if there is none.
std::string options_topic(const std::string& topic);
/// Returns the table of options as a part of the man page.
std::string options_man();

}  // namespace floe
