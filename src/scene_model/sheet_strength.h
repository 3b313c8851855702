/// \file
/// Strengths of a sheet, and the factors on its beams that give it those of the scene.
#pragma once

#include <optional>
#include <string>

#include "floe/base/petsc.h"
#include "floe/scene.h"

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

}  // namespace floe
