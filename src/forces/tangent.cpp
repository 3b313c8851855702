#include "forces/tangent.h"

#include <algorithm>
#include <numeric>

#include "floe/base/item.h"

namespace floe {
namespace {

/// Exact number of blocks per owned block row, for preallocation: in this rank's columns and in
/// those of other ranks, of the whole matrix and of its upper triangle.
struct RowCounts {
  std::vector<PetscInt> here, elsewhere, here_upper, elsewhere_upper;
};

RowCounts count_blocks(const Part& part) {
  const auto owned = static_cast<std::size_t>(part.owned);
  std::vector<std::vector<PetscInt>> neighbours(owned);
  for (std::int32_t b = 0; b < part.owned; ++b) item(neighbours, b).push_back(b);
  for (const auto& [i, j] : part.beams.bodies) {
    if (i < part.owned) item(neighbours, i).push_back(j);
    if (j < part.owned) item(neighbours, j).push_back(i);
  }
  RowCounts counts{std::vector<PetscInt>(owned), std::vector<PetscInt>(owned),
                   std::vector<PetscInt>(owned), std::vector<PetscInt>(owned)};
  for (std::size_t b = 0; b < owned; ++b) {
    auto& list = neighbours[b];
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    for (const PetscInt other : list) {
      const bool is_here = other < part.owned;
      const bool upper = item(part.row, other) >= part.row[b];
      ++(is_here ? counts.here : counts.elsewhere)[b];
      if (upper) ++(is_here ? counts.here_upper : counts.elsewhere_upper)[b];
    }
  }
  return counts;
}

}  // namespace

template <class Space>
Tangent<Space>::Tangent(const Part& part, std::span<const std::uint8_t> held, double length_scale,
                        double held_diagonal, const TangentOptions& options)
    : part_(part), held_(held), held_diagonal_(held_diagonal), symmetric_(options.symmetric) {
  set_scale(length_scale);
  unknowns_.resize(n);
  std::iota(unknowns_.begin(), unknowns_.end(), std::size_t{0});
  const RowCounts counts = count_blocks(part);
  check(MatCreate(part.comm, matrix_.put()));
  check(MatSetSizes(matrix_, n * part.owned, n * part.owned, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetBlockSize(matrix_, n));
  check(MatSetType(matrix_, options.type));
  check(MatSetFromOptions(matrix_));
  check(MatXAIJSetPreallocation(matrix_, n, counts.here.data(), counts.elsewhere.data(),
                                counts.here_upper.data(), counts.elsewhere_upper.data()));
  check(MatSetOption(matrix_, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  check(MatSetOption(matrix_, MAT_SYMMETRIC, options.symmetric ? PETSC_TRUE : PETSC_FALSE));
  PetscBool upper_only = PETSC_FALSE;
  check(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(matrix_.get()), &upper_only,
                                  MATSEQSBAIJ, MATMPISBAIJ, ""));
  if (upper_only) check(MatSetOption(matrix_, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
}

template <class Space>
Tangent<Space>::Tangent(const Part& part, std::span<const std::uint8_t> held, double length_scale,
                        double held_diagonal, Mat matrix, std::uint8_t unknowns)
    : part_(part), held_(held), held_diagonal_(held_diagonal), symmetric_(true) {
  set_scale(length_scale);
  for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
    if ((unknowns >> k & 1U) != 0) unknowns_.push_back(k);
  }
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  *matrix_.put() = matrix;
}

template <class Space>
void Tangent<Space>::set_scale(double length_scale) {
  for (int k = 0; k < n; ++k) item(scale_, k) = k < Space::translations ? 1.0 : 1.0 / length_scale;
}

template <class Space>
void Tangent<Space>::begin(std::span<const double> increments) {
  check(MatZeroEntries(matrix_));
  increments_ = increments;
  weigh(1, {});
  lift_.assign(entry_of(part_.owned, n, 0), 0.0);
}

template <class Space>
void Tangent<Space>::weigh(double factor, std::span<const TurnFrame> frames) {
  factor_ = factor;
  frames_ = frames;
}

/// Takes the rotation rows of a body from world axes to the frame of the unknowns. A planar body
/// has one rotation, which is the same in all frames.
template <class Space>
void Tangent<Space>::turn_rows(std::int32_t body, std::span<double> rows, int columns) const {
  if constexpr (n - Space::translations == 3) {
    const auto& by = item(frames_, body).rows;
    for (int c = 0; c < columns; ++c) {
      const auto at = [&](int k) -> double& {
        return rows[entry_of(Space::translations + k, columns, c)];
      };
      const std::array<double, 3> old{at(0), at(1), at(2)};
      for (int k = 0; k < 3; ++k) {
        const std::size_t r = entry_of(k, 3, 0);
        at(k) = by[r] * old[0] + by[r + 1] * old[1] + by[r + 2] * old[2];
      }
    }
  }
}

/// Takes the rotation columns of a body from world axes to the frame of the unknowns.
/// \param first    column of the first unknown of the body
/// \param columns  number of columns of the block
template <class Space>
void Tangent<Space>::turn_columns(std::int32_t body, std::span<double> block, int first,
                                  int columns) const {
  if constexpr (n - Space::translations == 3) {
    const auto& by = item(frames_, body).columns;
    const int rows = static_cast<int>(block.size()) / columns;
    for (int r = 0; r < rows; ++r) {
      double* row = &block[entry_of(r, columns, first + Space::translations)];
      const std::array<double, 3> old{row[0], row[1], row[2]};
      for (std::size_t k = 0; k < 3; ++k)
        row[k] = old[0] * by[k] + old[1] * by[3 + k] + old[2] * by[6 + k];
    }
  }
}

/// Turns and scales the rows of a body, and sets the rows of prescribed unknowns to zero.
template <class Space>
void Tangent<Space>::prepare_rows(std::int32_t body, std::span<double> rows, int columns) {
  if (!frames_.empty()) turn_rows(body, rows, columns);
  for (int k = 0; k < n; ++k) {
    const double factor = is_held(body, k) ? 0.0 : factor_ * item(scale_, k);
    for (int c = 0; c < columns; ++c) rows[entry_of(k, columns, c)] *= factor;
  }
}

/// Adds a block to the matrix, reduced to the unknowns that the matrix has.
/// \param rows, columns  local bodies
/// \param block          (rows x n) by (columns x n), row-major; overwritten
template <class Space>
void Tangent<Space>::insert(std::span<const std::int32_t> rows,
                            std::span<const std::int32_t> columns, double* block) {
  const std::size_t width = unknowns_.size(), all = n;
  if (width < all) {  // kept entries move to the front, in place: none moves past one still unread
    double* to = block;
    for (std::size_t r = 0; r < rows.size() * width; ++r) {
      const double* row = block + (r / width * all + unknowns_[r % width]) * columns.size() * all;
      for (std::size_t c = 0; c < columns.size() * width; ++c)
        *to++ = row[c / width * all + unknowns_[c % width]];
    }
  }
  std::array<PetscInt, 2> row{}, column{};
  for (std::size_t k = 0; k < rows.size(); ++k) row[k] = item(part_.row, rows[k]);
  for (std::size_t k = 0; k < columns.size(); ++k) column[k] = item(part_.row, columns[k]);
  check(MatSetValuesBlocked(matrix_, static_cast<PetscInt>(rows.size()), row.data(),
                            static_cast<PetscInt>(columns.size()), column.data(), block,
                            ADD_VALUES));
}

template <class Space>
void Tangent<Space>::add_body(std::int32_t body, const Block& block) {
  if (body >= part_.owned) return;
  Block a = block;
  if (!frames_.empty()) turn_columns(body, a, 0, n);
  prepare_rows(body, a, n);
  for (int c = 0; c < n; ++c) {
    const bool held = is_held(body, c);
    const std::size_t index = entry_of(body, n, 0);
    for (int k = 0; k < n; ++k) {
      double& entry = a[entry_of(k, n, c)];
      entry *= item(scale_, c);
      if (!held) continue;
      if (!increments_.empty())
        lift_[index + static_cast<std::size_t>(k)] +=
            entry * increments_[index + static_cast<std::size_t>(c)];
      entry = 0;
    }
  }
  insert({&body, 1}, {&body, 1}, a.data());
}

template <class Space>
void Tangent<Space>::add_pair(std::int32_t i, std::int32_t j, const PairBlock& block) {
  PairBlock a = block;
  const std::array<std::int32_t, 2> body{i, j};
  if (!frames_.empty()) {
    turn_columns(i, a, 0, 2 * n);
    turn_columns(j, a, n, 2 * n);
  }
  constexpr std::size_t half = entry_of(n, 2 * n, 0);
  prepare_rows(i, std::span(a).first(half), 2 * n);
  prepare_rows(j, std::span(a).subspan(half), 2 * n);
  for (int c = 0; c < 2 * n; ++c) {
    const std::int32_t column_body = item(body, c / n);
    const bool held = is_held(column_body, c % n);
    for (int k = 0; k < 2 * n; ++k) {
      double& entry = a[entry_of(k, 2 * n, c)];
      entry *= item(scale_, c % n);
      if (!held) continue;
      const std::int32_t row_body = item(body, k / n);
      if (!increments_.empty() && row_body < part_.owned)
        lift_[entry_of(row_body, n, k % n)] += entry * increments_[entry_of(column_body, n, c % n)];
      entry = 0;
    }
  }
  const bool own_i = i < part_.owned, own_j = j < part_.owned;
  if (own_i && own_j) {
    insert(body, body, a.data());
  } else if (own_i) {
    insert({&i, 1}, body, a.data());
  } else if (own_j) {
    insert({&j, 1}, body, a.data() + half);
  }
}

template <class Space>
void Tangent<Space>::end() {
  weigh(1, {});
  for (std::int32_t body = 0; body < part_.owned; ++body) {
    Block diagonal{};
    for (int k = 0; k < n; ++k)
      diagonal[entry_of(k, n, k)] = is_held(body, k) ? held_diagonal_ : 0.0;
    insert({&body, 1}, {&body, 1}, diagonal.data());
  }
  check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
}

template class Tangent<Spatial>;
template class Tangent<Planar>;

}  // namespace floe
