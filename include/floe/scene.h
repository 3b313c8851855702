/// \file
/// A scene: everything a user says, as plain structs with defaults. Read once, in one place, from
/// the table of options (src/scene/keys.cpp); nothing below this layer knows a key's name.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "floe/forces/beam.h"
#include "floe/forces/boundary.h"
#include "floe/lattice/lattice.h"
#include "floe/mesh/tessellation.h"

namespace floe {

enum class Integrator { quasistatic };

struct Region {
  std::string name;
  std::array<double, 6> box{};  ///< x0, x1, y0, y1, z0, z1 [m]
};

struct Cut {
  std::string name;
  Point2 from{}, to{};  ///< [m]
};

struct Scene {
  std::string path;  ///< the scene file
  std::string name;  ///< its stem
  Integrator integrator = Integrator::quasistatic;
  struct {
    bool beam = false, gravity = false, buoyancy = false;
  } forces;
  bool has_sheet = false;  ///< a sheet is meshed; otherwise lattice_file is read
  SheetPlan sheet;
  double thickness = 1;  ///< of the sheet [m]
  Ice ice;
  double shear_factor = 5.0 / 6.0;
  Torsion torsion = Torsion::saint_venant;
  std::string lattice_file;
  std::vector<Region> regions;
  std::vector<Cut> cuts;
  BeamOptions beam;
  double gravity = 9.81;        ///< [m/s^2]
  double water_density = 1010;  ///< [kg/m^3]
  std::vector<Boundary> boundaries;
  std::vector<Load> loads;
  struct {
    double end = 1;
    double dt = 0;  ///< 0: one step
  } time;
  struct {
    bool tension = false, bending = false;
  } report;
  struct {
    std::string dir;     ///< default out/NAME
    double history = 0;  ///< 0: every load step
    double fields = 0;   ///< 0: first and last state only
  } output;
  bool check_only = false;
  std::string options_yaml;  ///< every option as used, PETSc's as given: what options.yaml holds
};

/// Reads the scene from PETSc's options database (the file and the command line are in it by then).
/// \throws InputError with one line that names the key, the value and what is allowed.
Scene read_scene(const std::string& path);

/// The text of `floe -help`, and the same table as Markdown (docs/options.md).
std::string options_help();
std::string options_markdown();

}  // namespace floe
