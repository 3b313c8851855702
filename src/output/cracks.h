/// \file
/// breaks.h5: the log of broken beams, and the fragments into which the sheet has broken.
///
///     /time [s], /beam, /bodies (k x 2), /place (k x 3) [m], /mode_mix, /energy, /nominal_energy
///     [J], /brittle (0 or 1)       per broken beam, in the order of (time, beam)
///     /fragments/of_body (n), /fragments/bodies, /fragments/mass [kg]    largest mass first
#pragma once

#include <string>
#include <vector>

#include "floe/lattice/lattice.h"
#include "fracture/fracture.h"

namespace floe {

/// Writes breaks.h5. All calls are collective. The whole file is written anew when beams have
/// broken since it was last written, so it is never older than the last row of history.csv.
class CrackLog {
 public:
  /// \param lattice  rank 0 keeps a reference
  /// \param fracture, part  must outlive this object
  CrackLog(std::string dir, const Lattice& lattice, const Fracture& fracture, const Part& part)
      : dir_(std::move(dir)), lattice_(lattice), fracture_(&fracture), part_(part) {}

  /// Goes on with another object for the same cracks.
  void follow(const Fracture& fracture) { fracture_ = &fracture; }
  /// Goes on with other bodies and beams, in the lattice that was given: the file is written anew.
  void follow_lattice() { written_ = -1; }

  /// Writes the file if there are new breaks. Returns the number of fragments, on all ranks.
  double update();

 private:
  std::vector<Break> gather() const;
  void find_fragments(const std::vector<Break>& breaks);
  void write(const std::vector<Break>& breaks) const;

  std::string dir_;
  const Lattice& lattice_;
  const Fracture* fracture_;
  const Part& part_;
  std::int64_t written_ = -1;  ///< number of breaks on file; -1: no file yet
  std::vector<std::int32_t> fragment_of_, bodies_;
  std::vector<double> mass_;
};

}  // namespace floe
