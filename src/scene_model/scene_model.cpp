#include "scene_model/scene_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "contact_force/contact.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "forces/gravity.h"
#include "scene/reading.h"
#include "scene_model/structures.h"
#include "water/added_mass.h"
#include "water/buoyancy.h"
#include "water/drag.h"

namespace floe {
namespace {

constexpr std::uint8_t z_rx_ry =
    0b011100;  ///< bits of the components out of the plane, of x y z rx ry rz

/// Marks the bodies that the water surface cuts when they are at rest.
std::vector<std::uint8_t> bodies_at_surface(const Lattice& lattice) {
  std::vector<std::uint8_t> at(static_cast<std::size_t>(lattice.bodies.size()), 0);
  const Shapes& shapes = lattice.shapes;
  for (std::size_t b = 0; b < at.size() && !shapes.empty(); ++b) {
    const auto [w, x, y, z] = lattice.bodies.orientation[b];
    const Triad<double> axes = triad(Quat<double>{w, x, y, z});
    bool above = false, below = false;
    for (std::int32_t v = shapes.vertex_of[b]; v < shapes.vertex_of[b + 1]; ++v) {
      const double height =
          lattice.bodies.position[b].z + axes.to_world(item(shapes.vertices, v)).z;
      above = above || height > 0;
      below = below || height < 0;
    }
    at[b] = above && below;
  }
  return at;
}

}  // namespace

namespace {

/// Refuses a load's point that is far from its body: the body carries loads on itself or on its
/// beams. Where a lattice has no outline, the limit is the largest distance that a body of this
/// inertia and with these beams can reach.
/// \param factor  moments of inertia over those of the body's mass
void check_point(const PlacedLoad& placed, const Lattice& lattice, double factor) {
  const auto body = static_cast<std::size_t>(placed.bodies.front());
  const Bodies& bodies = lattice.bodies;
  const Point3& inertia = bodies.inertia[body];
  // Largest distance over radius of gyration: a rod has 1.7, a cone 2.5.
  constexpr double widest = 4;
  double reach = widest * std::sqrt(std::max({inertia.x, inertia.y, inertia.z}) /
                                    (factor * bodies.mass[body]));
  for (std::size_t m = 0; m < lattice.beams.bodies.size(); ++m) {
    const auto& [a, b] = lattice.beams.bodies[m];
    if (a == placed.bodies.front() || b == placed.bodies.front())
      reach = std::max(reach, lattice.beams.length[m]);
  }
  const double distance = std::hypot(placed.arm[0], placed.arm[1]);
  if (distance > reach)
    throw InputError("load: " + placed.load.name + ": point: lies " + text_of(distance) +
                     " m from the nearest body (" + std::to_string(placed.bodies.front()) +
                     "), which reaches no farther than " + text_of(reach) + " m");
}

/// Whether a point lies beside the sheet.
bool is_beside(const Point2& p, const SheetPlan& sheet) {
  if (sheet.outline.empty())
    return 2 * std::abs(p[0]) > sheet.length || 2 * std::abs(p[1]) > sheet.width;
  constexpr double rounding = 1e-9;  // a point on the outline is not beside it
  return !sheet.outline.contains(p) && sheet.outline.distance(p) > rounding * sheet.element_size;
}

}  // namespace

std::vector<PlacedLoad> place_loads(const Scene& scene, const Lattice& lattice) {
  std::vector<PlacedLoad> placed;
  for (const Load& load : scene.loads) {
    if (scene.has_sheet && load.point && is_beside(*load.point, scene.sheet))
      throw InputError("load: " + load.name + ": point: lies outside the sheet");
    placed.push_back(place(load, lattice));
    if (load.point && !scene.has_sheet) check_point(placed.back(), lattice, scene.inertia_factor);
  }
  return placed;
}

namespace {

/// Adds buoyancy, and the drag that shares its submerged parts.
template <class Water>
void add_by(const std::shared_ptr<Water>& submersion, const Scene& scene, Model<Spatial>& model) {
  const bool buoyancy = scene.forces.buoyancy;
  if (buoyancy) model.add_force(make_buoyancy(submersion, scene.water_density * scene.gravity));
  if (!scene.forces.drag) return;
  if constexpr (std::is_same_v<Water, Submersion>) {
    if (!scene.drag.faces) return model.add_force(make_drag(submersion, scene.drag));
  }
  model.add_force(make_face_drag(submersion, scene.drag, !buoyancy));
}

/// Adds the forces of the water that need space.
void add_water(const Scene& scene, Model<Spatial>& model) {
  const bool apart = !scene.drag.faces && !scene.waves.any();  // drag at centroids in still water
  if (!scene.forces.buoyancy && (!scene.forces.drag || apart)) return;
  const Part& part = model.part();
  require_shapes(part, scene.forces.buoyancy ? "buoyancy" : "drag");
  // At a pace drag on faces asks for the volumes that it has found itself.
  const bool shared = scene.forces.drag && (scene.forces.buoyancy || scene.water_pace > 1);
  if (scene.waves.any()) {
    const Waves waves(part, scene.gravity, scene.waves, scene.drag.water());
    add_by(std::make_shared<SubmersionInWaves>(part, waves, scene.water_pace, shared), scene,
           model);
  } else {
    add_by(std::make_shared<Submersion>(part, scene.water_pace, shared, scene.drag.level_table),
           scene, model);
  }
}

}  // namespace

template <class Space>
void add_forces(const Scene& scene, const std::vector<PlacedLoad>& loads, Model<Space>& model,
                const Lattice* lattice) {
  const Part& part = model.part();
  if constexpr (std::is_same_v<Space, Spatial>) {  // fracture, and forces along z
    if (scene.forces.fracture) {
      const bool by_energy = scene.fracture.propagation == Propagation::energy;
      if (by_energy && lattice == nullptr)
        throw std::invalid_argument("add_forces: propagation: energy looks at the whole lattice");
      BreakableForce breakable = make_breakable_beams(
          part, scene.beam, scene.fracture,
          by_energy ? find_junctions(*lattice, scene.beam.shear) : Junctions{});
      model.set_fracture(breakable.fracture);
      model.set_beams(std::move(breakable.force), scene.beam.kinematics);
    }
  }
  if (scene.forces.beam && !scene.forces.fracture)
    model.set_beams(make_beam_force<Space>(part, scene.beam), scene.beam.kinematics);
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (scene.forces.gravity) model.add_force(make_gravity<Spatial>(part, scene.gravity));
    add_water(scene, model);
  }
  if (scene.forces.drag && !scene.forces.buoyancy && !scene.drag.faces && !scene.waves.any())
    model.add_force(make_drag<Space>(part, scene.drag));
  if (scene.added_mass > 0)
    model.add_mass(displaced_mass(part, scene.added_mass * scene.water_density));
  if (scene.added_mass_plate || scene.added_mass_axes) {
    std::vector<typename Model<Space>::AddedInertia> added;
    // Moments of the water are parts of what the bodies have without the factor on theirs.
    std::array<double, 6> parts = scene.added_mass_axes.value_or(std::array<double, 6>{});
    for (std::size_t k = 3; k < 6; ++k) parts[k] /= scene.inertia_factor;
    for (const auto& [mass, moment] : scene.added_mass_plate
                                          ? added_of_plates(part, scene.water_density)
                                          : added_by_parts(part, scene.water_density, parts))
      added.push_back({mass, moment});
    model.set_added_inertia(std::move(added));
  }
  if constexpr (std::is_same_v<Space, Spatial>) add_supports(scene, model);
  for (const PlacedLoad& load : loads)
    model.add_force(make_load<Space>(part, load, scene.beam.kinematics));
}

template <class Space>
Contact* add_contact(const Scene& scene, const Lattice& lattice, Model<Space>& model) {
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (!scene.forces.contact) return nullptr;
    const auto prescribed = model.prescribed();
    const bool any =
        std::any_of(prescribed.begin(), prescribed.end(), [](auto b) { return b != 0; });
    PrescribedMotion motion;
    if (any)
      motion = {.bits = {prescribed.begin(), prescribed.end()},
                .accelerations = [&model](double time, std::span<double> values) {
                  model.prescribe_accelerations(time, values);
                }};
    ContactOptions options = scene.contact;
    options.inertia_factor = scene.inertia_factor;
    options.periods = scene.periods;
    auto contact = make_contact(model.part(), lattice, options, obstacles_on(scene, lattice),
                                std::move(motion));
    const std::string& overlap = contact->overlap_at_start();
    if (scene.check_only && !overlap.empty() && rank() == 0) warn(overlap);
    Contact* const added = contact.get();
    model.add_force(std::move(contact));
    return added;
  }
  return nullptr;
}

bool needs_shapes(const Scene& scene) {
  return scene.forces.buoyancy || scene.forces.drag || scene.forces.contact ||
         (scene.forces.fracture && scene.fracture.propagation == Propagation::energy);
}

template <class Space>
void release_setup(const Scene& scene, Model<Space>& model) {
  if (!scene.forces.fracture) model.release_sections();  // cracks need the widths of their beams
  if (!scene.forces.buoyancy && !scene.forces.drag) model.release_shapes();
}

template <class Space>
void hold_free_motions(const Scene& scene, const Lattice& lattice, Model<Space>& model) {
  std::vector<std::uint8_t> prescribed = prescribed_components(lattice, scene.boundaries);
  if constexpr (std::is_same_v<Space, Planar>) {
    for (std::uint8_t& bits : prescribed) bits |= z_rx_ry;
  }
  const std::vector<std::uint8_t> floating =
      scene.forces.buoyancy ? bodies_at_surface(lattice) : std::vector<std::uint8_t>{};
  const FreeMotions free = free_motions(lattice, prescribed, floating);
  require_balance(model, lattice, free, scene.time.end);
  model.pin(free.pins);
}

OutOfPlane out_of_plane(const Scene& scene, const Lattice& lattice,
                        const std::vector<PlacedLoad>& loads, const Part& part) {
  OutOfPlane rest;
  rest.forces.push_back(make_beam_force<Spatial>(part, scene.beam));
  for (const PlacedLoad& load : loads)
    rest.forces.push_back(make_load<Spatial>(part, load, scene.beam.kinematics));
  std::vector<std::uint8_t> prescribed = prescribed_components(lattice, scene.boundaries);
  for (std::uint8_t& bits : prescribed) bits |= static_cast<std::uint8_t>(~z_rx_ry & 0b111111);
  for (const Pin& pin : free_motions(lattice, prescribed, {}).pins)
    item(prescribed, pin.body) |= static_cast<std::uint8_t>(1U << pin.component);
  for (const std::int32_t body : part.global) rest.held.push_back(item(prescribed, body));
  return rest;
}

template void add_forces(const Scene&, const std::vector<PlacedLoad>&, Model<Spatial>&,
                         const Lattice*);
template void add_forces(const Scene&, const std::vector<PlacedLoad>&, Model<Planar>&,
                         const Lattice*);
template Contact* add_contact(const Scene&, const Lattice&, Model<Spatial>&);
template Contact* add_contact(const Scene&, const Lattice&, Model<Planar>&);
template void release_setup(const Scene&, Model<Spatial>&);
template void release_setup(const Scene&, Model<Planar>&);
template void hold_free_motions(const Scene&, const Lattice&, Model<Spatial>&);
template void hold_free_motions(const Scene&, const Lattice&, Model<Planar>&);

}  // namespace floe
