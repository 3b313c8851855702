/// \file
/// Copies of other ranks' body records, filled by a PetscSF.
#pragma once

#include <petscsf.h>

#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/petsc.h"

namespace floe {

/// Local arrays hold `owned` records of this rank, then the ghosts in the order of the
/// constructor's arguments.
class Ghosts {
 public:
  Ghosts() = default;
  /// Collective.
  /// \param owned  number of records that this rank owns
  /// \param owner, remote  per ghost: the rank that owns it, and its local index on that rank
  Ghosts(MPI_Comm comm, std::int32_t owned, std::span<const std::int32_t> owner,
         std::span<const std::int32_t> remote);
  Ghosts(Ghosts&&) noexcept;
  Ghosts& operator=(Ghosts&&) noexcept;
  ~Ghosts();

  /// Fills the ghosts' records from their owners. Collective.
  /// \param records  (owned + ghosts) x width, row-major
  /// \param width  doubles per record
  void update(std::span<double> records, int width) const {
    begin(records, width);
    end(records, width);
  }
  /// update() in two parts. Between begin() and end() neither owned records nor ghosts may be
  /// accessed. Collective.
  void begin(std::span<double> records, int width) const;
  void end(std::span<double> records, int width) const;

  std::int32_t owned() const { return owned_; }
  std::int32_t ghosts() const { return ghosts_; }

 private:
  MPI_Datatype record_type(int width) const;
  Handle<PetscSF> sf_;
  std::int32_t owned_ = 0, ghosts_ = 0;
  bool alone_ = true;
  mutable std::vector<std::pair<int, MPI_Datatype>> types_;
};

}  // namespace floe
