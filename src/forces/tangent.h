/// \file
/// The tangent stiffness matrix: blocks of bodies and pairs of bodies, inserted into a PETSc
/// matrix.
///
/// Unknowns are displacements [m] and rotations times the length scale of the lattice [m], so all
/// entries are in N/m: the rotation rows and columns of a block are divided by that length.
///
/// Differentiation of the gradient to rotations gives K = H - skew(m)/2, with H the Hessian and m
/// the moment gradient of the block. H = K + skew(m)/2 is assembled, unless the exact K is asked
/// for (model.md, "Beam").
///
/// In dynamics the rotation unknowns of a body may stand in a frame that moves with the body, and
/// the matrix also takes derivatives to velocities, since a change of the unknowns changes the
/// velocities too: weigh().
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/lattice/state.h"
#include "lattice/partition.h"

namespace floe {

/// Returns the index of an entry in rows of `columns` numbers.
constexpr std::size_t entry_of(std::int32_t row, std::int32_t columns, std::int32_t column) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

/// Storage of the matrix, and whether K or its symmetric form H is assembled.
struct TangentOptions {
  const char* type = MATSBAIJ;  ///< PETSc's matrix type, unless -mat_type names another
  bool symmetric = true;        ///< H instead of K
};

/// Frame of the rotation unknowns of a body: two 3 x 3 matrices, row-major.
struct TurnFrame {
  std::array<double, 9> rows;     ///< moment in world axes to the rows of the unknowns
  std::array<double, 9> columns;  ///< change of the unknowns to the spin in world axes
};

/// Assembles the tangent of a part's bodies, block by block.
template <class Space>
class Tangent {
 public:
  static constexpr int n = Space::unknowns;
  using Block = std::array<double, static_cast<std::size_t>(n* n)>;  ///< row-major
  using PairBlock =
      std::array<double, static_cast<std::size_t>(4 * n * n)>;  ///< (i, j) x (i, j), row-major

  /// Creates the matrix, with a block for each body and each beam. Collective.
  /// \param part          must outlive the tangent
  /// \param held          prescribed unknowns: n bits per local body; must outlive the tangent
  /// \param length_scale  length that rotations are multiplied by [m]
  /// \param held_diagonal diagonal entry of a prescribed unknown [N/m]
  Tangent(const Part& part, std::span<const std::uint8_t> held, double length_scale,
          double held_diagonal, const TangentOptions& options);
  /// Assembles H for some of the unknowns only, into a given matrix.
  /// \param matrix    has blocks of as many rows as a body has selected unknowns
  /// \param unknowns  selected unknowns of a body, one bit each
  Tangent(const Part& part, std::span<const std::uint8_t> held, double length_scale,
          double held_diagonal, Mat matrix, std::uint8_t unknowns);

  bool symmetric() const { return symmetric_; }
  Mat matrix() const { return matrix_; }

  /// Empties the matrix, and resets weigh() to the factor 1 without frames. Collective.
  /// \param increments  of the prescribed unknowns, n per local body [m]; if not empty, lift()
  ///                    collects the columns of these unknowns times their increments
  void begin(std::span<const double> increments = {});
  /// Sets how the blocks that follow are transformed.
  /// \param factor  multiplies the blocks
  /// \param frames  of the rotation unknowns, one per local body; empty: world axes. Must outlive
  ///                the calls that follow
  void weigh(double factor, std::span<const TurnFrame> frames);
  /// Adds the own stiffness of an owned body; does nothing for a ghost.
  /// \param body   local index
  /// \param block  n x n in world axes [N/m, N, N m]; H if symmetric(), else K
  void add_body(std::int32_t body, const Block& block);
  /// Adds the stiffness between two bodies. Only rows of owned bodies are added: each rank adds its
  /// own.
  /// \param i, j   local indices
  /// \param block  2n x 2n in world axes [N/m, N, N m]; H if symmetric(), else K
  void add_pair(std::int32_t i, std::int32_t j, const PairBlock& block);
  /// Adds the diagonal of the prescribed unknowns and assembles. Collective.
  void end();

  /// Columns of the prescribed unknowns times their increments, n per owned body [N]; 0 in
  /// prescribed rows.
  std::span<const double> lift() const { return lift_; }

 private:
  void set_scale(double length_scale);
  void prepare_rows(std::int32_t body, std::span<double> rows, int columns);
  void turn_rows(std::int32_t body, std::span<double> rows, int columns) const;
  void turn_columns(std::int32_t body, std::span<double> block, int first, int columns) const;
  void insert(std::span<const std::int32_t> rows, std::span<const std::int32_t> columns,
              double* block);
  bool is_held(std::int32_t body, int k) const { return (item(held_, body) >> k & 1U) != 0; }

  const Part& part_;
  std::span<const std::uint8_t> held_;
  double held_diagonal_;
  std::array<double, static_cast<std::size_t>(n)> scale_;
  bool symmetric_;
  std::vector<std::size_t> unknowns_;  ///< of a body, in the matrix
  Handle<Mat> matrix_;
  double factor_ = 1;
  std::span<const TurnFrame> frames_;
  std::span<const double> increments_;
  std::vector<double> lift_;
};

}  // namespace floe
