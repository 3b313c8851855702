/// \file
/// The energy ledger of a dynamic run.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lattice/archive.h"

namespace floe {

/// Energies at a sample, summed over ranks, and the error of their balance.
class Ledger {
 public:
  /// Takes the energies of a sample [J].
  /// \param forces  the forces' columns, summed over ranks
  /// \param kinetic  kinetic energy
  /// \param boundary  work of the boundaries since the start
  /// \param joined  energy of the bodies that have joined since the start, less that of those that
  ///   have left
  void take(const std::vector<std::pair<std::string, double>>& forces, double kinetic,
            double boundary, double joined = 0);
  /// Returns the energies that the balance counts at a state: stored and lost, less external work
  /// [J]. Parameters as of take().
  static double balance(const std::vector<std::pair<std::string, double>>& forces, double kinetic,
                        double boundary);

  /// Error of the balance [J]. relative_error() divides it by the largest sum of moved energies.
  double error() const { return error_; }
  double relative_error() const;
  /// Sets the energy below which differences count as rounding and are not judged [J].
  void set_floor(double floor) { floor_ = floor; }
  void persist(Archive& archive);
  std::vector<std::pair<std::string, double>> columns() const;

 private:
  std::map<std::string, double> first_;
  bool started_ = false;
  double offset_ = 0, kinetic_ = 0, boundary_ = 0, error_ = 0, largest_ = 0,
         floor_ = std::numeric_limits<double>::min();
};

}  // namespace floe
