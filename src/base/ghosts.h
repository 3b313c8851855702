/// \file
/// Copies of other ranks' body records, kept up to date by a PetscSF.
#pragma once

#include <petscsf.h>

#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/petsc.h"

namespace floe {

/// Local arrays hold `owned` records of this rank and then its ghosts, in the order given here.
class Ghosts {
 public:
  Ghosts() = default;
  /// Collective. \param owner, remote  for each ghost: the rank that owns it and its local index
  /// there
  Ghosts(MPI_Comm comm, std::int32_t owned, std::span<const std::int32_t> owner,
         std::span<const std::int32_t> remote);
  Ghosts(Ghosts&&) noexcept;
  Ghosts& operator=(Ghosts&&) noexcept;
  ~Ghosts();

  /// Fills the ghosts' records from their owners'. Collective.
  /// \param records  (owned + ghosts) x width, row-major
  void update(std::span<double> records, int width) const {
    begin(records, width);
    end(records, width);
  }
  /// The same in two parts, between which neither owned records nor ghosts are touched.
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
