/// \file
/// Scenes of loose blocks in contact, stepped from outside.
#pragma once

#include "contact_force/contact.h"
#include "contact_laws/restitution.h"
#include "stability/stable_step.h"
#include "support/blocks.h"
#include "support/dynamics.h"

namespace floe::test {

inline Scene contact_scene(double young, double friction, double restitution, bool gravity = true) {
  Scene scene;
  scene.integrator = Integrator::explicit_;
  scene.forces.contact = true;
  scene.forces.gravity = gravity;
  scene.contact.young = young;
  scene.contact.friction = friction;
  scene.contact.damping_ratio = damping_ratio_of(restitution);
  return scene;
}

/// Adds an obstacle with the scene's friction.
inline Obstacle& append_obstacle(Scene& scene, const std::string& name, Obstacle obstacle) {
  obstacle.name = name;
  obstacle.friction = scene.contact.friction;
  return scene.obstacles.emplace_back(std::move(obstacle));
}

/// Sets a newly_eligible model's step to a part of the stable one, and says how long it is.
inline double start(Dynamics& d, double part = 0.5) {
  const double dt = part * stable_step(d.model(), d.state()).dt;
  d.evaluate();
  d.set_step(dt);
  return dt;
}

/// Half a step before the state's time.
inline Vec3<double> velocity(const Dynamics& d, std::size_t body) {
  const double* r = const_cast<Dynamics&>(d).state().record(body);
  return {r[7], r[8], r[9]};
}

}  // namespace floe::test
