// The equations of motion: tangent against finite differences, start, prescribed unknowns, sizes.
#include "implicit/second_order_system.h"

#include <gtest/gtest.h>

#include "run/numbers.h"
#include "scene_model/scene_model.h"
#include "support/force_checks.h"
#include "support/lattices.h"
#include "support/static_solution.h"

namespace floe {
namespace {

using test::Dense;
using Vector = Eigen::VectorXd;

/// Everything at once: damped beams, water, loads with arms and moments, bodies held in various
/// ways.
Scene everything() {
  Scene scene;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = true;
  scene.beam.damping_ratio = 0.6;
  scene.drag = {.linear = 4000, .coefficient = 900, .density = 1010, .current = {0.1, 0.2, 0}};
  scene.added_mass = 0.4;
  Boundary whole, part, flat;
  whole.name = whole.set = "left", whole.fixed.fill(true);
  whole.velocity = Point3{0.1, 0, 0.02}, whole.angular_velocity = {0.3, 0.1, -0.2};
  part.name = part.set = "right", part.fixed = {true, false, false, false, true, false};
  part.displacement = Point3{0.05, 0, 0}, part.angular_velocity = {0, 0.4, 0};
  whole.ramp.seconds = part.ramp.seconds = 0.5;
  flat.name = flat.set = "top", flat.fixed = {false, false, true, false, false, false};
  flat.velocity = Point3{0, 0, 0};
  scene.boundaries = {whole, part, flat};
  Load load;
  load.name = "p", load.point = Point2{0.2, 0.4}, load.force = {2e5, -1e5, -3e5};
  load.moment = {1e5, 2e5, -1e5};
  scene.loads = {load};
  return scene;
}

/// Equations of a small sheet at some state, its rotations' reference elsewhere.
struct Setting {
  Lattice lattice = test::sheet(5, 4, 1.3, true);
  Scene scene = everything();
  Model<Spatial> model{lattice, PETSC_COMM_SELF, without_overlap()};
  State<Spatial> state{lattice.bodies.position.size()};
  std::unique_ptr<SecondOrderSystem<Spatial>> equations;
  Handle<Vec> x, v, a, f;
  double time = 0.3;

  explicit Setting(Kinematics kinematics = Kinematics::corotational) {
    scene.beam.kinematics = kinematics;
    add_forces(scene, place_loads(scene, lattice), model);
    equations = std::make_unique<SecondOrderSystem<Spatial>>(model, state);
    for (auto* vector : {&x, &v, &a, &f}) *vector = equations->make_vector();
    // A first state far away, then a step from there. Linear kinematics is for small turns.
    const double large = kinematics == Kinematics::linear ? 1e-5 : 1;
    fill(x, 1, 0.4 * large);
    fill(v, 2, 3);
    equations->take(0, x, v);
    equations->rebase(x);
    const Vector first = numbers(x);
    fill(x, 4, 0.5 * large);
    put(x, first + numbers(x));
    fill(a, 3, 20);
  }
  /// Bodies of two sets that hold one unknown twice would be refused.
  std::vector<Boundary> without_overlap() const {
    return {scene.boundaries[0], scene.boundaries[1]};
  }
  void fill(Vec vector, std::uint64_t seed, double size) const {
    test::Random random(seed);
    const Numbers to(vector);
    for (double& value : *to) value = random.uniform(-size, size);
  }
  static Vector numbers(Vec vector) {
    const ReadNumbers from(vector);
    return Eigen::Map<const Vector>((*from).data(), static_cast<Eigen::Index>((*from).size()));
  }
  static void put(Vec vector, const Vector& values) {
    const Numbers to(vector);
    std::copy(values.begin(), values.end(), (*to).begin());
  }
  Vector residual(const Vector& at, const Vector& rate, const Vector& acceleration) {
    put(x, at), put(v, rate), put(a, acceleration);
    equations->residual(time, x, v, a, f);
    return numbers(f);
  }
  bool is_held(Eigen::Index k) const {
    return (model.prescribed()[static_cast<std::size_t>(k / 6)] >> (k % 6) & 1U) != 0;
  }

  /// dF/dX by differences; 0 in rows and columns of prescribed unknowns.
  Dense by_differences(double by_v, double by_a) {
    const Vector x0 = numbers(x), v0 = numbers(v), a0 = numbers(a);
    Dense j = Dense::Zero(x0.size(), x0.size());
    for (Eigen::Index c = 0; c < x0.size(); ++c) {
      if (is_held(c)) continue;
      const Vector unit = Vector::Unit(x0.size(), c);
      const auto at = [&](double e) -> Vector {
        return residual(x0 + e * unit, v0 + e * by_v * unit, a0 + e * by_a * unit);
      };
      const double e = 1e-4;
      j.col(c) = (8 * (at(e) - at(-e)) - (at(2 * e) - at(-2 * e))) / (12 * e);
    }
    put(x, x0), put(v, v0), put(a, a0);
    return j;
  }
  Dense assembled(double by_v, double by_a) {
    equations->assemble(time, x, v, a, by_v, by_a);
    Dense j = test::dense(equations->matrix());
    for (Eigen::Index k = 0; k < j.rows(); ++k) {
      if (is_held(k)) j(k, k) = 0;
    }
    return j;
  }
};

TEST(SecondOrderSystem, ExactTangentIsTheDerivative) {
  const test::PetscOption lu("-pc_type", "lu");
  for (const Kinematics kinematics : {Kinematics::corotational, Kinematics::linear}) {
    Setting s(kinematics);
    // With each part in turn the largest: places, velocities, accelerations.
    for (const auto& [by_v, by_a] :
         {std::pair{1e-3, 0.0}, std::pair{1e3, 0.0}, std::pair{1e-3, 1e6}, std::pair{30.0, 1e3}}) {
      const Dense expected = s.by_differences(by_v, by_a);
      const Dense got = s.assembled(by_v, by_a);
      EXPECT_LT((got - expected).norm(), 2e-7 * expected.norm())
          << by_v << " " << by_a << " " << static_cast<int>(kinematics);
    }
  }
}

TEST(SecondOrderSystem, SymmetricTangentIsNearTheExactOneForSmallTurns) {
  const auto matrix = [](const char* pc) {
    const test::PetscOption option("-pc_type", pc);
    Setting s;
    const Vector x0 = Setting::numbers(s.x);
    // Back to the reference, nearly; slow; as a large step has it.
    s.fill(s.x, 4, 1e-5);
    const Vector small = Setting::numbers(s.x);
    s.equations = std::make_unique<SecondOrderSystem<Spatial>>(s.model, s.state);
    Setting::put(s.x, small);
    s.fill(s.v, 5, 1e-3);
    s.fill(s.a, 6, 1e-3);
    return s.assembled(200, 4e4);
  };
  const Dense exact = matrix("lu"), symmetric = matrix("cholesky");
  EXPECT_LT((symmetric - symmetric.transpose()).norm(), 1e-14 * symmetric.norm());
  EXPECT_LT((symmetric - exact).norm(), 1e-4 * exact.norm());
  EXPECT_GT((symmetric - exact).norm(), 1e-9 * exact.norm());
}

TEST(SecondOrderSystem, StartAccelerationLeavesNoResidual) {
  Setting s;
  s.equations->acceleration(s.time, s.x, s.v, s.a);
  const Vector v = Setting::numbers(s.v), a = Setting::numbers(s.a);
  const Vector f = s.residual(Setting::numbers(s.x), v, a);
  const Vector without = s.residual(Setting::numbers(s.x), v, Vector::Zero(a.size()));
  EXPECT_LT(f.norm(), 1e-12 * without.norm());
  std::vector<double> given(static_cast<std::size_t>(a.size()));
  s.model.prescribe_accelerations(s.time, given);
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    if (!s.is_held(k)) continue;
    const double scale = k % 6 < 3 ? 1 : s.model.length_scale();
    EXPECT_DOUBLE_EQ(a[k], given[static_cast<std::size_t>(k)] * scale);
  }
}

TEST(SecondOrderSystem, PrescribedUnknownsFollowTheirBoundaries) {
  Setting s;
  const Handle<Vec> own = s.equations->make_vector();
  s.equations->prescribe(0.2, {s.x, s.v, s.a, own});
  s.equations->take(0.2, s.x, s.v);
  const double l = s.model.length_scale();
  for (const std::int32_t body : s.lattice.sets.at("right")) {
    const auto k = static_cast<Eigen::Index>(body) * 6;
    // displacement 0.05 m over a ramp of 0.5 s; 0.4 rad/s after it
    EXPECT_NEAR(Setting::numbers(s.x)[k], 0.02, 1e-15);
    EXPECT_NEAR(Setting::numbers(s.v)[k], 0.1, 1e-15);
    EXPECT_NEAR(Setting::numbers(s.a)[k], 0, 1e-15);
    EXPECT_NEAR(Setting::numbers(s.x)[k + 4] / l, 0.4 * 0.5 * 0.2 * 0.2 / 0.5, 1e-15);
    EXPECT_NEAR(Setting::numbers(s.v)[k + 4] / l, 0.4 * 0.2 / 0.5, 1e-15);
    EXPECT_NEAR(Setting::numbers(s.a)[k + 4] / l, 0.4 / 0.5, 1e-15);
    // In world axes, however the body has turned.
    EXPECT_NEAR(s.state.record(static_cast<std::size_t>(body))[Spatial::angular_velocity + 1],
                0.4 * 0.2 / 0.5, 1e-14);
  }
}

/// A free body's inertia forces are the rates of its momenta.
TEST(SecondOrderSystem, InertiaForcesAreTheRatesOfMomenta) {
  for (const bool held : {false, true}) {
    Lattice lattice;
    lattice.bodies.position = {{0.3, 0.1, -0.2}};
    const Quat<double> q = normalised({0.5, 0.4, -0.6, 0.2});
    lattice.bodies.orientation = {{q.w, q.x, q.y, q.z}};
    lattice.bodies.mass = {2};
    lattice.bodies.inertia = {{1, 2, 2.9}};
    lattice.sets["all"] = {0};
    Boundary none;
    none.name = "a", none.set = "all", none.fixed[3] = true;  // makes it turn in the world's frame
    Model<Spatial> model(lattice, PETSC_COMM_SELF,
                         held ? std::vector{none} : std::vector<Boundary>{});
    State<Spatial> state(1);
    SecondOrderSystem<Spatial> equations(model, state);
    const Handle<Vec> x = equations.make_vector(), v = equations.make_vector(),
                      a = equations.make_vector();
    const double l = model.length_scale();
    const Vector rate = (Vector(6) << 1, 2, 3, 0.4 * l, -0.9 * l, 0.7 * l).finished(),
                 acceleration =
                     (Vector(6) << 0.3, 0.1, -0.5, 0.8 * l, 0.2 * l, -0.6 * l).finished();
    // The angular momentum a moment before and after: V + h A, turned by exp(h V).
    const auto momentum = [&](double h) {
      Setting::put(x, h * rate);
      Setting::put(v, rate + h * acceleration);
      equations.take(h, x, v);
      return Eigen::Vector3d(state.record(0) + Spatial::angular_momentum);
    };
    const double h = 1e-4;
    const Eigen::Vector3d slope = (momentum(h) - momentum(-h)) / (2 * h);
    (void)momentum(0);
    Setting::put(a, acceleration);
    SecondOrderSystem<Spatial>::Forces forces;
    equations.forces(v, a, Wrenches<Spatial>(1), forces);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(forces.inertia[static_cast<std::size_t>(k)], 2 * acceleration[k], 1e-14);
      EXPECT_NEAR(forces.inertia[static_cast<std::size_t>(3 + k)] * l, slope[k], 1e-7) << held;
    }
    EXPECT_NEAR(equations.kinetic(v),
                0.5 * (2 * rate.head<3>().squaredNorm() +
                       rate.tail<3>().dot(
                           1 / l * Eigen::Vector3d(state.record(0) + Spatial::angular_momentum))),
                1e-14);
  }
}

}  // namespace
}  // namespace floe
