/// \file
/// Reading a scene, part by part. Each function reads its keys from the options and stores their
/// values in the scene. All throw InputError alike on all ranks.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "floe/options/options.h"
#include "floe/scene.h"
#include "scene/table_file.h"

namespace floe {

/// Sets that every sheet has; the last one, every lattice.
inline constexpr std::array<std::string_view, 5> sheet_sets{"left", "right", "bottom", "top",
                                                            "all"};

/// Formats a number with at most six digits.
std::string text_of(double value);

/// Reads ice without end, after all that it depends on. \throws InputError for what it does not go
/// with
void read_supply(Options& options, Scene& scene);
/// Reads which forces act, and refuses keys that have no effect without them.
void read_forces(Options& options, Scene& scene);
/// Reads the sheet and its ice, or the lattice file.
void read_lattice_source(Options& options, Scene& scene);
/// Reads the outline of a sheet whose element size is known, and refuses keys that have no effect
/// with it or without it. \return whether there is one. Collective.
bool read_outline(Options& options, Scene& scene);
/// Reads the plan of floes that have sections of their own: where they are, how large their cells
/// are, how thick they are. Collective.
void read_floes(Options& options, Scene& scene);
/// Reads the outline of a floe whose name, element size and seed are known. Collective.
/// \param size_key  of its element size, for messages
Outline read_outline_of_floe(Options& options, Floe& floe, const std::string& size_key,
                             Scene& scene);
/// Reads the place of a rectangular floe.
PolygonPlan::Rectangle read_rectangle_of_floe(Options& options, Floe& floe,
                                              const std::string& size_key);
/// Whether the file of an outline gives the thickness of its floes.
/// \throws InputError if it gives that of some only, or one that is out of range
/// \param outline_key  of the file
/// \param thickness_key  that takes their place
bool has_thickness(const OutlineSource& outline, const std::string& outline_key,
                   const std::string& thickness_key);
void read_regions_and_cuts(Options& options, Scene& scene);
/// Reads which faces are frozen together, after the lattice's source and the fracture.
void read_bonds(Options& options, Scene& scene);
void read_fracture(Options& options, Scene& scene);
void read_water(Options& options, Scene& scene);
/// Reads contacts and obstacles.
void read_contact(Options& options, Scene& scene);
/// Reads prescribed motions, and loads.
void read_boundaries(Options& options, Scene& scene);
void read_loads(Options& options, Scene& scene);
/// Reads whether statics follow a path.
void read_path_choice(Options& options, Scene& scene);
/// Reads how they follow it, after loads, boundaries and time.
void read_path_control(Options& options, Scene& scene);

/// What a table in time may have, and what its columns are called.
struct TableKeys {
  std::string key;  ///< of the file: "load: NAME: table", "water: level_table"
  std::vector<std::string_view> replaces;  ///< keys that do not go with it
  std::vector<TableColumn> columns;
};
/// A table in time as read: all allowed columns, and which of them the file has; the others are 0.
struct ReadTable {
  TimeTable table;
  std::vector<bool> has;
};
/// Reads a table in time, with its keys `interpolation` and `periodic`, if it is given; else the
/// table is empty. Collective. \throws InputError
ReadTable read_time_table(Options& options, Scene& scene, const TableKeys& keys,
                          const std::string& name = {});
/// The same for a motion.
/// \param rotations  columns that say the rotation: none, or rx ry rz, or their rates too
enum class TableRotations { none, vector, components };
MotionTable read_motion_table(Options& options, Scene& scene, const std::string& key,
                              const std::vector<std::string_view>& replaces,
                              TableRotations rotations, const std::string& name);
/// Refuses a motion that is displaced at time 0, where bodies are where the scene places them.
void require_start(const MotionTable& motion, const std::string& label);

/// Reads an obstacle that has a mass.
Structure read_structure(Options& options, Obstacle& obstacle);
/// Refuses the keys of a structure where an obstacle has no mass.
void refuse_structure(Options& options, const std::string& name);
/// Reads the mooring lines of structures.
void read_lines(Options& options, Scene& scene);
/// Checks structures against the rest of the scene, when all is read. \throws InputError
void check_structures(const Scene& scene);

}  // namespace floe
