// What a scene needs: which are planar, and why others are not.
#include <gtest/gtest.h>

#include <functional>

#include "floe/base/petsc.h"
#include "scene_model/scene_model.h"
#include "support/lattices.h"
#include "support/static_solution.h"

namespace floe {
namespace {

/// A sheet that is pulled, held in all that is out of plane.
Scene pulled(Integrator integrator = Integrator::quasistatic) {
  Scene scene;
  scene.integrator = integrator;
  scene.forces.beam = true;
  Boundary left, right;
  left.name = left.set = "left", left.fixed = {true, false, true, true, true, false};
  left.velocity = Point3{};
  right.name = right.set = "right", right.fixed[0] = right.fixed[5] = true;
  right.displacement = Point3{0.01, 0, 0}, right.angular_velocity = {0, 0, 0.1};
  scene.boundaries = {left, right};
  Load load;
  load.name = "push", load.set = "top", load.force = {1, 2, 0}, load.moment = {0, 0, 3};
  scene.loads = {load};
  return scene;
}

std::string why(const Scene& scene, const Lattice& lattice) {
  return choose_model(scene, lattice).needs_space;
}

TEST(ModelChoice, APulledSheetIsPlanar) {
  const Lattice lattice = test::sheet(6, 5, 1);
  for (const Integrator integrator : {Integrator::quasistatic, Integrator::explicit_}) {
    Scene scene = pulled(integrator);
    EXPECT_TRUE(choose_model(scene, lattice).planar) << why(scene, lattice);
    scene.forces.drag = true;
    scene.drag.linear = 5, scene.drag.current = {1, -1, 0};
    EXPECT_TRUE(choose_model(scene, lattice).planar);
    scene.planar = Planarity::never;
    EXPECT_FALSE(choose_model(scene, lattice).planar);
    EXPECT_EQ(why(scene, lattice), "model: planar: false");
  }
}

TEST(ModelChoice, WhatPointsOutOfPlaneNeedsSpace) {
  const Lattice lattice = test::sheet(6, 5, 1);
  const std::vector<std::pair<const char*, std::function<void(Scene&)>>> cases{
      {"gravity", [](Scene& s) { s.forces.gravity = true; }},
      {"buoyancy", [](Scene& s) { s.forces.gravity = s.forces.buoyancy = true; }},
      {"current", [](Scene& s) { s.drag.current[2] = 0.1; }},
      {"load: push", [](Scene& s) { s.loads[0].force[2] = 1; }},
      {"load: push", [](Scene& s) { s.loads[0].moment[0] = 1; }},
      {"load: push", [](Scene& s) { s.loads[0].moment[1] = 1; }},
      {"boundary: left",
       [](Scene& s) {
         s.boundaries[0].velocity = Point3{0, 0, 0.1};
       }},
      {"boundary: left", [](Scene& s) { s.boundaries[0].angular_velocity[1] = 0.1; }},
      {"boundary: right", [](Scene& s) {
         s.boundaries[1].displacement = Point3{0, 0, 0.1};
       }}};
  for (const auto& [reason, change] : cases) {
    Scene scene = pulled();
    change(scene);
    EXPECT_NE(why(scene, lattice).find(reason), std::string::npos) << why(scene, lattice);
    EXPECT_FALSE(choose_model(scene, lattice).planar);
    scene.planar = Planarity::always;
    try {
      (void)choose_model(scene, lattice);
      ADD_FAILURE() << reason;
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.rfind("model: planar: true", 0), 0U) << text;
      EXPECT_NE(text.find(reason), std::string::npos) << text;
    }
  }
}

TEST(ModelChoice, ALatticeThatIsNotFlatNeedsSpace) {
  const Lattice flat = test::sheet(6, 5, 1);
  const Scene scene = pulled(), moving = pulled(Integrator::explicit_);
  Lattice raised = flat;
  raised.bodies.position[3][2] += 1e-9;
  EXPECT_EQ(why(scene, raised), "body 3 is not at the same height as body 0");
  Lattice rolled = flat;  // the sections' axes 2 and 3 exchanged
  rolled.beams.axis_y[2] = {0, 0, 1};
  EXPECT_EQ(why(scene, rolled), "axis 3 of the section of beam 2 is not along z");
  Lattice upside_down = flat;
  upside_down.beams.axis_y[4] = -upside_down.beams.axis_y[4];
  EXPECT_EQ(why(scene, upside_down), "axis 3 of the section of beam 4 is not along z");

  // Inertia and velocities matter to what moves only.
  Lattice tilted = flat;
  tilted.bodies.orientation[1] = {std::cos(0.1), std::sin(0.1), 0, 0};
  EXPECT_EQ(why(scene, tilted), "");
  EXPECT_EQ(why(moving, tilted), "body 1 has no principal axis along z");
  tilted.bodies.orientation[1] = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // axis 2 along z
  EXPECT_EQ(why(moving, tilted), "");
  tilted.bodies.orientation[1] = {std::cos(0.1), std::sin(0.1), 0, 0};
  tilted.bodies.inertia[1] = {7, 7, 7};  // any axis is principal
  EXPECT_EQ(why(moving, tilted), "");
  for (const Point3& spin : {Point3{1e-3, 0, 0}, Point3{0, 1e-3, 0}}) {
    Lattice spinning = flat;
    spinning.bodies.velocity.resize(flat.bodies.position.size(), Point3{1, 2, 0});
    spinning.bodies.angular_velocity.resize(flat.bodies.position.size(), Point3{0, 0, 1});
    EXPECT_EQ(why(moving, spinning), "");
    spinning.bodies.angular_velocity[2] = spin;
    EXPECT_EQ(why(moving, spinning), "body 2 has an initial velocity out of the x-y plane");
    spinning.bodies.angular_velocity[2] = {0, 0, 0};
    spinning.bodies.velocity[5][2] = 1;
    EXPECT_EQ(why(moving, spinning), "body 5 has an initial velocity out of the x-y plane");
  }
}

TEST(ModelChoice, RungeKuttaNeedsSpace) {
  const test::PetscOption type("-ts_type", "rk");
  const Lattice lattice = test::sheet(6, 5, 1);
  EXPECT_EQ(why(pulled(Integrator::explicit_), lattice), "-ts_type rk steps bodies in space");
  EXPECT_TRUE(choose_model(pulled(), lattice).planar);
}

TEST(ModelChoice, OneLineSaysThem) {
  const Lattice lattice = test::sheet(6, 5, 1);
  Scene scene = pulled(Integrator::explicit_);
  const auto text = [&] { return choose_model(scene, lattice).text; };
  EXPECT_EQ(text(), "planar, co-rotational, undamped, no water, unbreakable, no contact");
  scene.beam.kinematics = Kinematics::linear;
  scene.beam.damping_ratio = 1;
  EXPECT_EQ(text(), "planar, linear, damped, no water, unbreakable, no contact");
  scene.forces.gravity = scene.forces.buoyancy = true;
  EXPECT_EQ(text(), "spatial, linear, damped, unbreakable, no contact");
  scene.forces.fracture = scene.forces.contact = true;
  EXPECT_EQ(text(), "spatial, linear, damped, breakable");
  scene.forces.beam = scene.forces.fracture = false;
  EXPECT_EQ(text(), "spatial");
  scene = pulled();
  EXPECT_EQ(text(), "planar, co-rotational, no water, unbreakable, no contact");
}

/// Beams of long sheets are flat too, whatever the rounding of their axes.
TEST(ModelChoice, AllBeamsOfALargeSheetAreFlat) {
  SheetPlan plan;
  plan.length = plan.width = 120, plan.element_size = 1, plan.iterations = 2;
  const Lattice lattice = make_sheet(tessellate(plan, PETSC_COMM_SELF), {});
  for (std::int32_t m = 0; m < lattice.beams.size(); ++m)
    EXPECT_TRUE(is_flat(lattice.bodies, lattice.beams, m)) << m;
}

}  // namespace
}  // namespace floe
