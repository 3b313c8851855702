/// \file
/// The tangent stiffness matrix: blocks of bodies and pairs of bodies, inserted into a PETSc
/// matrix.
///
/// Unknowns are displacements [m] and rotations times the lattice's length scale [m], so that all
/// entries are in N/m whatever the units: a block's rotation rows and columns are divided by that
/// length.
///
/// On rotations, differentiation of the gradient gives K = H - skew(m)/2 with H the Hessian and m
/// the block's moment gradient; H = K + skew(m)/2 is assembled (model.md section 2), unless the
/// exact K was asked for.
///
/// In dynamics a body's rotation unknowns may stand in a frame that goes with it, and the same
/// matrix takes derivatives to velocities, which the unknowns move too: weigh().
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/lattice/partition.h"
#include "floe/lattice/state.h"

namespace floe {

/// How the matrix is stored and whether K or its symmetric form H is assembled.
struct TangentOptions {
  const char* type = MATSBAIJ;
  bool symmetric = true;
};

/// Rotation unknowns of a body in a frame of their own, row-major.
struct TurnFrame {
  std::array<double, 9> rows;     ///< takes a moment in the world to the unknowns' rows
  std::array<double, 9> columns;  ///< the spin in the world that a change of the unknowns is
};

/// Index of an entry in rows of `columns` numbers.
constexpr std::size_t entry_of(std::int32_t row, std::int32_t columns, std::int32_t column) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

template <class Space>
class Tangent {
 public:
  static constexpr int n = Space::unknowns;
  using Block = std::array<double, static_cast<std::size_t>(n* n)>;  ///< row-major
  using PairBlock =
      std::array<double, static_cast<std::size_t>(4 * n * n)>;  ///< (i, j) x (i, j), row-major

  /// \param held          n bits per local body: unknowns that are prescribed
  /// \param length_scale  [m]
  /// \param held_diagonal what stands on the diagonal of a prescribed unknown [N/m]
  Tangent(const Part& part, std::span<const std::uint8_t> held, double length_scale,
          double held_diagonal, const TangentOptions& options);
  /// Some of the unknowns only, into a matrix that is there: H in blocks of their number.
  /// \param unknowns  a bit for each of a body's that the matrix has
  Tangent(const Part& part, std::span<const std::uint8_t> held, double length_scale,
          double held_diagonal, Mat matrix, std::uint8_t unknowns);

  bool symmetric() const { return symmetric_; }
  Mat matrix() const { return matrix_; }

  /// Empties the matrix. If `increments` (n per local body, in the unknowns' units) is not empty,
  /// the columns of prescribed unknowns times their increments are collected in lift() while blocks
  /// come in.
  void begin(std::span<const double> increments = {});
  /// Blocks that follow are multiplied by `factor`, and their rotations are taken from the world to
  /// the unknowns' frames (one per local body; none: they stand in the world). begin() goes back to
  /// 1 and none. \param frames  must outlive what follows
  void weigh(double factor, std::span<const TurnFrame> frames);
  /// Adds a body's own stiffness. \param block n x n [N/m, N, N m]; already H or K as symmetric()
  /// says
  void add_body(std::int32_t body, const Block& block);
  /// Adds a pair's stiffness; rows of bodies that other ranks own are left to them.
  void add_pair(std::int32_t i, std::int32_t j, const PairBlock& block);
  /// Puts the prescribed unknowns' diagonal in and assembles. Collective.
  void end();

  /// K of prescribed columns times their increments, n per owned body; 0 on prescribed rows.
  std::span<const double> lift() const { return lift_; }

 private:
  void set_scale(double length_scale);
  void prepare_rows(std::int32_t body, std::span<double> rows, int columns);
  void turn_rows(std::int32_t body, std::span<double> rows, int columns) const;
  void turn_columns(std::int32_t body, std::span<double> block, int first, int columns) const;
  void insert(std::span<const std::int32_t> rows, std::span<const std::int32_t> columns,
              double* block);
  bool is_held(std::int32_t body, int k) const {
    return (held_[static_cast<std::size_t>(body)] >> k & 1U) != 0;
  }

  const Part& part_;
  std::span<const std::uint8_t> held_;
  double held_diagonal_;
  std::array<double, static_cast<std::size_t>(n)> scale_;
  bool symmetric_;
  std::vector<std::size_t> unknowns_;  ///< those that the matrix has
  Handle<Mat> matrix_;
  double factor_ = 1;
  std::span<const TurnFrame> frames_;
  std::span<const double> increments_;
  std::vector<double> lift_;
};

}  // namespace floe
