#include <algorithm>
#include <cmath>
#include <string>

#include "explicit/explicit.h"
#include "floe/base/petsc.h"
#include "scene_model/scene_model.h"

namespace floe {
namespace {

bool any_out_of_plane(const Point3& translation, const Point3& rotation) {
  return translation[2] != 0 || rotation[0] != 0 || rotation[1] != 0;
}

/// Returns the first reason in the scene that needs space; empty if there is none.
std::string scene_needs_space(const Scene& scene) {
  if (scene.forces.buoyancy) return "forces: buoyancy acts along z";
  if (scene.forces.gravity) return "forces: gravity acts along z";
  if (scene.forces.contact) return "forces: contact acts in space";
  if (scene.forces.fracture) return "forces: fracture breaks beams in space";
  if (scene.integrator == Integrator::implicit) return "integrator: implicit moves bodies in space";
  if (scene.waves.any()) return "waves move bodies along z";
  if (scene.added_mass_plate || scene.added_mass_axes)
    return "water: added mass by direction moves bodies in space";
  if (scene.drag.faces) return "water: drag: faces acts in space";
  if (scene.drag.current[2] != 0) return "water: current has a z component";
  if (!scene.drag.current_table.empty() && scene.drag.current_table.largest(2) > 0)
    return "water: current_table has a z component";
  if (!scene.drag.level_table.empty()) return "water: level_table moves the water along z";
  for (const Load& load : scene.loads) {
    const auto in_table = [&](std::size_t k) {
      return !load.table.empty() && load.table.largest(k) > 0;
    };
    if (any_out_of_plane(load.force, load.moment) || in_table(2) || in_table(3) || in_table(4))
      return "load: " + load.name + " acts out of the x-y plane";
  }
  for (const Boundary& boundary : scene.boundaries) {
    const Point3 still{};
    if (any_out_of_plane(boundary.displacement.value_or(still), boundary.angular_velocity) ||
        any_out_of_plane(boundary.velocity.value_or(still), still) || boundary.table.has(2) ||
        boundary.table.has(3) || boundary.table.has(4))
      return "boundary: " + boundary.name + " moves out of the x-y plane";
  }
  return {};
}

/// Whether z is a principal axis of a body, so that it can turn about z in the plane: the tensor of
/// inertia times z is along z to rounding.
bool turns_in_plane(const Bodies& bodies, std::int32_t body) {
  constexpr double rounding = 1e-12;
  const auto b = static_cast<std::size_t>(body);
  const auto [w, x, y, z] = bodies.orientation[b];
  const Triad<double> axes = triad(Quat<double>{w, x, y, z});
  const Vec3<double> a = axes.to_local({0, 0, 1});
  const Point3& inertia = bodies.inertia[b];
  const Vec3<double> l = axes.to_world({inertia.x * a.x, inertia.y * a.y, inertia.z * a.z});
  return std::hypot(l.x, l.y) <= rounding * l.z;
}

/// Returns the first reason in the lattice, or in its initial motion, that needs space; empty if
/// there is none.
std::string lattice_needs_space(const Scene& scene, const Lattice& lattice) {
  const Bodies& bodies = lattice.bodies;
  const bool moves = scene.integrator != Integrator::quasistatic;
  for (std::int32_t body = 0; body < bodies.size(); ++body) {
    const auto b = static_cast<std::size_t>(body);
    const std::string which = "body " + std::to_string(body);
    if (bodies.position[b][2] != bodies.position[0][2])
      return which + " is not at the same height as body 0";
    if (!moves) continue;
    const Point3 still{};
    if (any_out_of_plane(bodies.velocity.empty() ? still : bodies.velocity[b],
                         bodies.angular_velocity.empty() ? still : bodies.angular_velocity[b]))
      return which + " has an initial velocity out of the x-y plane";
    if (!turns_in_plane(bodies, body)) return which + " has no principal axis along z";
  }
  if (!lattice.beams.image.empty()) return "beams join images of bodies";
  if (!lattice.beams.offsets.empty()) return "beams do not end at the centroids of bodies";
  for (std::int32_t m = 0; m < lattice.beams.size(); ++m) {
    if (!is_flat(bodies, lattice.beams, m))
      return "axis 3 of the section of beam " + std::to_string(m) + " is not along z";
  }
  return {};
}

std::string why_space(const Scene& scene, const Lattice& lattice) {
  if (std::string why = scene_needs_space(scene); !why.empty()) return why;
  if (scene.integrator == Integrator::explicit_) {
    if (std::string why = explicit_needs_space(scene.backend); !why.empty()) return why;
  }
  return lattice_needs_space(scene, lattice);
}

}  // namespace

ModelChoice choose_model(const Scene& scene, const Lattice& lattice) {
  ModelChoice choice;
  if (scene.planar == Planarity::never) {
    choice.needs_space = "model: planar: false";
  } else {
    choice.needs_space = why_space(scene, lattice);
  }
  choice.planar = choice.needs_space.empty();
  if (scene.planar == Planarity::always && !choice.planar)
    throw InputError("model: planar: true leaves out what this scene needs: " + choice.needs_space);

  choice.text = choice.planar ? "planar" : "spatial";
  if (scene.forces.beam)
    choice.text += scene.beam.kinematics == Kinematics::linear ? ", linear" : ", co-rotational";
  if (scene.forces.beam && scene.integrator != Integrator::quasistatic)
    choice.text += scene.beam.damping_ratio > 0 ? ", damped" : ", undamped";
  if (!scene.forces.buoyancy && !scene.forces.drag) choice.text += ", no water";
  if (scene.forces.beam) choice.text += scene.forces.fracture ? ", breakable" : ", unbreakable";
  if (!scene.forces.contact) choice.text += ", no contact";
  if (scene.backend != Backend::cpu)
    choice.text += std::string(", steps by ") + name_of(scene.backend);
  return choice;
}

}  // namespace floe
