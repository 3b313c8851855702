// A force against its own potential and tangent.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "forces/force.h"
#include "support/roles.h"
#include "support/states.h"

namespace floe::test {

using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Six per body, without the padding.
inline std::vector<double> wrenches_of(Force<Spatial>& force, const State<Spatial>& state) {
  Wrenches<Spatial> w(state.records.size() / Spatial::record);
  force.add(state, w);
  std::vector<double> values(state.records.size() / Spatial::record * Spatial::unknowns);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = w.at(k);
  return values;
}

/// Sum of the energies that a force reports [J].
/// \param works  empty: the force has done no work yet
inline double potential_of(Force<Spatial>& force, const State<Spatial>& state,
                           const std::vector<double>& works = {}) {
  const Columns columns = report(force, state, works);
  double sum = 0;
  for (const auto& [name, value] : columns.values()) sum += value;
  return sum;
}

/// All entries of a matrix on one rank; a symmetric format gives its upper triangle on both sides.
inline Dense dense(Mat matrix) {
  PetscInt n = 0;
  check(MatGetSize(matrix, &n, nullptr));
  PetscBool upper = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATSEQSBAIJ, &upper));
  Dense all = Dense::Zero(n, n);
  for (PetscInt r = 0; r < n; ++r) {
    for (PetscInt c = upper ? r : 0; c < n; ++c) {
      check(MatGetValues(matrix, 1, &r, 1, &c, &all(r, c)));
      if (upper) all(c, r) = all(r, c);
    }
  }
  return all;
}

/// The force's tangent with rotations in rad (length scale 1) and nothing held, on one rank.
inline Dense tangent_of(Force<Spatial>& force, const Part& part, const State<Spatial>& state,
                        const TangentOptions& options) {
  const std::vector<std::uint8_t> held(static_cast<std::size_t>(part.local), 0);
  Tangent<Spatial> tangent(part, held, 1.0, 0.0, options);
  tangent.begin();
  (void)add_tangent(force, state, tangent);
  tangent.end();
  return dense(tangent.matrix());
}

/// Minus the derivative of a force's wrenches by finite differences: K on spins q -> exp(t) q.
inline Dense jacobian_of(Force<Spatial>& force, const State<Spatial>& state, double step) {
  const auto n = static_cast<Eigen::Index>(state.records.size() / Spatial::record * 6);
  Dense k(n, n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const auto values = [&](double amount) {
      State<Spatial> moved = state;
      move(moved, static_cast<std::size_t>(c / 6), static_cast<int>(c % 6), amount);
      return wrenches_of(force, moved);
    };
    const std::vector<double> slope = derivative<double>(values, step);
    for (Eigen::Index r = 0; r < n; ++r) k(r, c) = -slope[static_cast<std::size_t>(r)];
  }
  return k;
}

/// Wrenches = -gradient of the reported potential.
inline void expect_wrenches_from_potential(Force<Spatial>& force, const State<Spatial>& state,
                                           double step, double tolerance) {
  const std::vector<double> w = wrenches_of(force, state);
  const double scale =
      Eigen::Map<const Eigen::VectorXd>(w.data(), static_cast<Eigen::Index>(w.size())).norm();
  for (std::size_t k = 0; k < w.size(); ++k) {
    const auto value = [&](double amount) {
      State<Spatial> moved = state;
      move(moved, k / 6, static_cast<int>(k % 6), amount);
      return std::vector<double>{potential_of(force, moved)};
    };
    EXPECT_NEAR(w[k], -derivative<double>(value, step)[0], tolerance * scale) << "unknown " << k;
  }
}

/// The exact form of the tangent is the Jacobian K; the symmetric one is K + skew(m)/2, m = minus
/// the moment, in every storage.
inline void expect_tangent_from_wrenches(Force<Spatial>& force, const Part& part,
                                         const State<Spatial>& state, double step,
                                         double tolerance) {
  const Dense k = jacobian_of(force, state, step);
  const double scale = k.norm();
  EXPECT_LT((tangent_of(force, part, state, {MATAIJ, false}) - k).norm(), tolerance * scale);
  Dense h = k;
  const std::vector<double> w = wrenches_of(force, state);
  for (Eigen::Index b = 0; b < h.rows(); b += 6) {
    const double* m = &w[static_cast<std::size_t>(b) + 3];
    Eigen::Matrix3d skew;
    skew << 0, m[2], -m[1], -m[2], 0, m[0], m[1], -m[0], 0;
    h.block<3, 3>(b + 3, b + 3) += 0.5 * skew;
  }
  const Dense symmetric = tangent_of(force, part, state, {MATAIJ, true});
  EXPECT_LT((symmetric - symmetric.transpose()).norm(), 1e-13 * scale);
  EXPECT_LT((symmetric - h).norm(), tolerance * scale);
  EXPECT_LT((tangent_of(force, part, state, {MATSBAIJ, true}) - symmetric).norm(), 1e-15 * scale);
}

}  // namespace floe::test
