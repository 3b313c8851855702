/// \file
/// Views of a PETSc vector's entries on this rank as a span, and their checkpoints.
#pragma once

#include <petscvec.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "floe/base/petsc.h"
#include "lattice/archive.h"

namespace floe {

/// Read and write access as long as the object lives. All ranks must make one or none, whatever
/// their share: access raises the vector's state, by which PETSc knows whether a cached norm is
/// valid.
class Numbers {
 public:
  explicit Numbers(Vec vec) : vec_(vec) {
    PetscInt size = 0;
    check(VecGetLocalSize(vec, &size));
    check(VecGetArray(vec, &data_));
    span_ = {data_, static_cast<std::size_t>(size)};
  }
  ~Numbers() { (void)VecRestoreArray(vec_, &data_); }
  Numbers(const Numbers&) = delete;
  Numbers& operator=(const Numbers&) = delete;
  std::span<double> operator*() const { return span_; }

 private:
  Vec vec_;
  double* data_ = nullptr;
  std::span<double> span_;
};

/// Read access as long as the object lives.
class ReadNumbers {
 public:
  explicit ReadNumbers(Vec vec) : vec_(vec) {
    PetscInt size = 0;
    check(VecGetLocalSize(vec, &size));
    check(VecGetArrayRead(vec, &data_));
    span_ = {data_, static_cast<std::size_t>(size)};
  }
  ~ReadNumbers() { (void)VecRestoreArrayRead(vec_, &data_); }
  ReadNumbers(const ReadNumbers&) = delete;
  ReadNumbers& operator=(const ReadNumbers&) = delete;
  std::span<const double> operator*() const { return span_; }

 private:
  Vec vec_;
  const double* data_ = nullptr;
  std::span<const double> span_;
};

/// Returns the local indices of the bodies that this rank owns.
inline std::vector<std::int32_t> owned_bodies(const Part& part) {
  std::vector<std::int32_t> owned(static_cast<std::size_t>(part.owned));
  std::iota(owned.begin(), owned.end(), 0);
  return owned;
}

/// Saves a vector of `width` numbers per body to a checkpoint or loads it. Saving does not change
/// the vector. Collective.
inline void persist(Archive& archive, const Part& part, const std::string& name, Vec vector,
                    int width) {
  std::vector<double> rows;
  {
    const ReadNumbers numbers(vector);
    rows.assign((*numbers).begin(), (*numbers).end());
  }
  archive.rows(name, owned_bodies(part), rows, width);
  if (archive.loading()) std::copy(rows.begin(), rows.end(), (*Numbers(vector)).begin());
}

}  // namespace floe
