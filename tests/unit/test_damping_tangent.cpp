// What depends on velocities: derivatives against finite differences, losses, and unknowns in
// frames of their own.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "beams/beam_force.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/roles.h"
#include "water/drag.h"

namespace floe {
namespace {

using test::Dense;

/// A floating sheet, displaced, turned, moving and spinning.
struct Moving {
  Lattice lattice = test::sheet(4, 4, 1.3, true);
  Part part = partition(lattice, PETSC_COMM_SELF);
  State<Spatial> state = test::deformed(part, 0.05, 0.3);
  Moving() {
    for (std::size_t b = 0; b < static_cast<std::size_t>(part.local); ++b) {
      test::Random random(50 + b);
      const Vec3<double> v = random.vector(2), w = random.vector(3);
      double* r = state.record(b) + Spatial::velocity;
      r[0] = v.x, r[1] = v.y, r[2] = v.z, r[3] = w.x, r[4] = w.y, r[5] = w.z;
    }
  }
};

std::vector<std::unique_ptr<Force<Spatial>>> forces_of(const Part& part,
                                                       const std::vector<Kinematics>& kinds = {
                                                           Kinematics::corotational,
                                                           Kinematics::linear}) {
  std::vector<std::unique_ptr<Force<Spatial>>> forces;
  for (const Kinematics kinematics : kinds) {
    for (const DampingModes modes : {DampingModes::all, DampingModes::axial})
      forces.push_back(make_beam_force<Spatial>(
          part, {.kinematics = kinematics, .damping_ratio = 0.7, .damping_modes = modes}));
  }
  forces.push_back(make_drag<Spatial>(
      part, {.linear = 300, .coefficient = 1.2, .density = 1025, .current = {0.3, -0.2, 0.1}}));
  return forces;
}

/// Minus the derivative of the wrenches to the velocities.
Dense damping_by_differences(Force<Spatial>& force, const State<Spatial>& state) {
  const auto n = static_cast<Eigen::Index>(state.records.size() / Spatial::record * 6);
  Dense c(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto values = [&](double amount) {
      State<Spatial> moved = state;
      moved.record(static_cast<std::size_t>(k / 6))[Spatial::velocity + k % 6] += amount;
      return test::wrenches_of(force, moved);
    };
    const std::vector<double> slope = test::derivative<double>(values, 1e-3);
    for (Eigen::Index r = 0; r < n; ++r) c(r, k) = -slope[static_cast<std::size_t>(r)];
  }
  return c;
}

Dense damping_of(Force<Spatial>& force, const Part& part, const State<Spatial>& state,
                 const TangentOptions& options, double factor = 1,
                 std::span<const TurnFrame> frames = {}) {
  const std::vector<std::uint8_t> held(static_cast<std::size_t>(part.local), 0);
  Tangent<Spatial> tangent(part, held, 1.0, 0.0, options);
  tangent.begin();
  tangent.weigh(factor, frames);
  add_damping(force, state, tangent);
  tangent.end();
  return test::dense(tangent.matrix());
}

TEST(DampingTangent, IsTheDerivativeToVelocities) {
  const Moving m;
  for (const auto& force : forces_of(m.part)) {
    const Dense c = damping_by_differences(*force, m.state);
    ASSERT_GT(c.norm(), 0);
    for (const auto* type : {MATAIJ, MATSBAIJ}) {
      const Dense got = damping_of(*force, m.part, m.state, {type, true});
      EXPECT_LT((got - c).norm(), 1e-8 * c.norm()) << force->name();
      EXPECT_LT((got - got.transpose()).norm(), 1e-14 * c.norm());
    }
  }
}

TEST(DampingTangent, ExactTangentFollowsWhatVelocitiesDo) {
  const Moving m;
  for (const auto& force : forces_of(m.part, {Kinematics::corotational})) {
    const Dense k = test::tangent_of(*force, m.part, m.state, {MATAIJ, false});
    State<Spatial> still = m.state;
    for (std::int32_t b = 0; b < m.part.local; ++b)
      std::fill_n(still.record(static_cast<std::size_t>(b)) + Spatial::velocity, 6, 0.0);
    const Dense without = test::tangent_of(*force, m.part, still, {MATAIJ, false});
    const Dense expected = test::jacobian_of(*force, m.state, 1e-4);
    EXPECT_LT((k - expected).norm(), 1e-7 * expected.norm()) << force->name();
    if (force->name() == "drag") {
      EXPECT_GT((k - without).norm(), 0.1 * k.norm());
    }
  }
}

TEST(DampingTangent, LossesAreWhatVelocitiesAdd) {
  const Moving m;
  State<Spatial> still = m.state;
  for (std::int32_t b = 0; b < m.part.local; ++b)
    std::fill_n(still.record(static_cast<std::size_t>(b)) + Spatial::velocity, 6, 0.0);
  for (const auto& force : forces_of(m.part)) {
    const std::vector<double> with = test::wrenches_of(*force, m.state);
    std::vector<double> without = test::wrenches_of(*force, still);
    // Drag has no other part; with a current it acts on a body at rest too.
    if (force->name() == "drag") std::fill(without.begin(), without.end(), 0.0);
    Wrenches<Spatial> losses(static_cast<std::size_t>(m.part.local));
    ASSERT_TRUE(add_losses(*force, m.state, losses));
    double scale = 0;
    for (std::size_t k = 0; k < with.size(); ++k) scale = std::max(scale, std::abs(with[k]));
    for (std::size_t k = 0; k < with.size(); ++k)
      EXPECT_NEAR(losses.at(k), with[k] - without[k], 1e-12 * scale) << force->name();
  }
}

TEST(TurnFrames, TakeRowsAndColumnsOfRotations) {
  const Moving m;
  const auto beams = make_beam_force<Spatial>(m.part, {.damping_ratio = 1});
  const Dense plain = damping_of(*beams, m.part, m.state, {MATAIJ, false});
  std::vector<TurnFrame> frames;
  Dense left = Dense::Identity(plain.rows(), plain.cols()), right = left;
  for (std::int32_t b = 0; b < m.part.local; ++b) {
    test::Random random(900 + static_cast<std::uint64_t>(b));
    TurnFrame frame;
    for (double& x : frame.rows) x = random.uniform(-1, 1);
    for (double& x : frame.columns) x = random.uniform(-1, 1);
    frames.push_back(frame);
    using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    left.block<3, 3>(6 * b + 3, 6 * b + 3) = Eigen::Map<const Block>(frame.rows.data());
    right.block<3, 3>(6 * b + 3, 6 * b + 3) = Eigen::Map<const Block>(frame.columns.data());
  }
  const Dense expected = 2.5 * left * plain * right;
  const Dense got = damping_of(*beams, m.part, m.state, {MATAIJ, false}, 2.5, frames);
  EXPECT_LT((got - expected).norm(), 1e-13 * expected.norm());
  const auto drag = make_drag<Spatial>(m.part, {.linear = 300});
  const Dense body = damping_of(*drag, m.part, m.state, {MATAIJ, false}, 2.5, frames);
  EXPECT_LT((body - 2.5 * damping_of(*drag, m.part, m.state, {MATAIJ, false})).norm(),
            1e-13 * body.norm());
}

}  // namespace
}  // namespace floe
