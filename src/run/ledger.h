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

/// Energies at a sample and what the balance says (all ranks).
class Ledger {
 public:
  /// \param forces  sums over ranks of what the forces report   \param boundary  work of the
  /// boundaries
  void take(const std::vector<std::pair<std::string, double>>& forces, double kinetic,
            double boundary);

  /// Error of the balance [J], and over the largest sum of energies that moved so far.
  double error() const { return error_; }
  double relative_error() const;
  /// Energies below this are rounding and are not judged [J].
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
