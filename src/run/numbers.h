/// \file
/// A vector's numbers on this rank as a span.
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

/// To read and write, as long as the object lives. By all ranks or by none, whatever their share:
/// it raises the vector's state, by which PETSc knows whether a norm is still good.
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

/// To read.
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

/// Local indices of a rank's own bodies.
inline std::vector<std::int32_t> owned_bodies(const Part& part) {
  std::vector<std::int32_t> owned(static_cast<std::size_t>(part.owned));
  std::iota(owned.begin(), owned.end(), 0);
  return owned;
}

/// A vector of `width` numbers per body, to and from a checkpoint; saving does not touch it.
/// Collective.
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
