#include "simulation/build.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contact_force/contact.h"
#include "explicit/explicit.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "floe/mesh/cuts.h"
#include "forces/gravity.h"
#include "implicit/implicit.h"
#include "run/expected_cost.h"
#include "scene/reading.h"
#include "session/signals.h"
#include "simulation/lattice_command.h"
#include "simulation/mesh_file.h"
#include "simulation/path_options.h"
#include "simulation/plan.h"
#include "water/added_mass.h"
#include "water/buoyancy.h"
#include "water/drag.h"

namespace floe {
namespace {

constexpr std::uint8_t z_rx_ry =
    0b011100;  ///< bits of the components out of the plane, of x y z rx ry rz

/// Height of a sheet's mid-plane [m]: a floating sheet has the draft h rho_i/rho_w, one without
/// buoyancy lies at z = 0.
double mid_plane(const Scene& scene) {
  if (!scene.forces.buoyancy) return 0;
  const double relative_density = scene.ice.density / scene.water_density;
  if (relative_density >= 1)
    throw InputError("ice: density: " + text_of(scene.ice.density) +
                     " must be < water: density, or the sheet sinks");
  return scene.thickness * (0.5 - relative_density);
}

/// Makes cells end on the scene's cuts. \return what became of each cut
std::vector<FittedCut> fit_cuts(const Scene& scene, MPI_Comm comm, Tessellation& cells,
                                MeshReport& report) {
  std::vector<CutLine> lines;
  for (const Cut& c : scene.cuts) lines.push_back({c.from, c.to});
  FittedCells fitted = fit_to_cuts(scene.sheet, std::move(cells), lines, comm);
  cells = std::move(fitted.cells);
  double length = 0, followed = 0;
  std::vector<std::string> apart;
  for (std::size_t k = 0; k < fitted.cuts.size(); ++k) {
    const FittedCut& cut = fitted.cuts[k];
    length += cut.length, followed += cut.followed;
    if (std::abs(cut.followed - cut.length) > 1e-6 * cut.length)
      apart.push_back(scene.cuts[k].name);
  }
  if (!apart.empty())
    report.cuts = "cut: " + apart.front() +
                  (apart.size() > 1 ? " and " + std::to_string(apart.size() - 1) + " more" : "") +
                  ": the cells do not end on " + (apart.size() > 1 ? "them" : "it") +
                  " everywhere (" + text_of(followed) + " of " + text_of(length) +
                  " m of all cuts), but the cuts follow the cells: they are short, or near each "
                  "other or the outline, for sheet: element_size: " +
                  text_of(scene.sheet.element_size);
  return std::move(fitted.cuts);
}

Lattice mesh_sheet(const Scene& scene, MPI_Comm comm, MeshReport& report,
                   std::vector<FittedCut>& cuts) {
  const SheetSection section{scene.thickness, mid_plane(scene), scene.ice, scene.shear_factor,
                             scene.torsion};
  check_size(scene, free_memory(comm), size(comm));
  Tessellation cells;
  {
    const Timed timed(Event::mesh);
    Progress progress("mesh", scene.sheet.iterations);
    const auto show = [&](int iteration, double move) {
      stop_if_asked(comm);
      char note[48];
      std::snprintf(note, sizeof note, "largest move %.2g l", move);
      progress.update(iteration, note);
    };
    cells = scene.mesh_file.empty()
                ? tessellate(scene.sheet, comm, show)
                : tessellate_with_file(scene.sheet, scene.mesh_file, comm, show, report.keep);
  }
  report.largest_move = cells.largest_move;  // of the relaxation, as are the iterations
  report.iterations = cells.iterations;
  if (!scene.cuts.empty() && scene.fit_cuts) {
    const Timed timed(Event::mesh);
    cuts = fit_cuts(scene, comm, cells, report);
  }
  report.energy_ratio = cells.energy_ratio;
  report.degenerate = cells.degenerate;
  const Timed timed(Event::lattice);
  return make_sheet(cells, section);
}

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

Lattice make_lattice(const Scene& scene, MPI_Comm comm, MeshReport& report) {
  if (!scene.has_sheet) require_lattice_file(scene, comm);
  std::vector<FittedCut> fitted(scene.cuts.size());
  Lattice lattice =
      scene.has_sheet ? mesh_sheet(scene, comm, report, fitted) : read_lattice(scene.lattice_file);
  const Timed timed(Event::lattice);
  if (scene.forces.beam && lattice.beams.size() == 0)
    throw InputError(scene.has_sheet
                         ? "sheet: element_size: the sheet has a single cell and no beam"
                         : "forces: beam: '" + scene.lattice_file + "' has no beams");
  if (!scene.forces.beam) lattice.beams = {};  // loose bodies
  if (scene.calibrate != Calibrate::none)
    report.calibration = calibrate(lattice, scene.ice, scene.calibrate, scene.beam.shear);
  if (scene.forces.fracture && (scene.fracture.calibrate || scene.fracture.flexural_strength > 0))
    report.strength = calibrate_strength(scene, lattice, comm);
  for (std::size_t k = 0; k < scene.cuts.size(); ++k) {
    const Cut& c = scene.cuts[k];
    const std::int32_t before = lattice.beams.size();
    cut(lattice, c.from, c.to, fitted[k].pairs);
    if (lattice.beams.size() == before && !c.may_miss)
      throw InputError("cut: " + c.name + ": crosses no beam; it would have no effect");
  }
  if (scene.has_sheet) (void)reorder(lattice);  // a file keeps its own order
  auto& all = lattice.sets["all"];
  all.resize(static_cast<std::size_t>(lattice.bodies.size()));
  std::iota(all.begin(), all.end(), 0);
  for (const Region& region : scene.regions)
    add_region(lattice, region.name, region.box, "region: " + region.name + ": box");
  return lattice;
}

void set_initial(const Scene& scene, Lattice& lattice) {
  Bodies& bodies = lattice.bodies;
  std::vector<const Initial*> of_body(scene.initials.empty() ? 0 : bodies.position.size());
  for (const Initial& initial : scene.initials) {
    bodies.velocity.resize(bodies.position.size(), Point3{});
    bodies.angular_velocity.resize(bodies.position.size(), Point3{});
    for (const std::int32_t body : lattice.set(initial.set, "initial: " + initial.name + ": set")) {
      const Initial*& other = item(of_body, body);
      if (other != nullptr)
        throw InputError("initial: " + initial.name + ": set: body " + std::to_string(body) +
                         " has its motion from 'initial: " + other->name +
                         "' already; sets of two sections must not overlap");
      other = &initial;
      item(bodies.velocity, body) = initial.velocity;
      item(bodies.angular_velocity, body) = initial.angular_velocity;
    }
  }
}

std::string checkpoint_file(const Scene& scene) { return scene.output.dir + "/checkpoint.h5"; }

template <class Space>
std::unique_ptr<Run> make_run(const Scene& scene, Model<Space>& model,
                              const OutOfPlane* out_of_plane, const RunHooks& hooks,
                              ObserverOf<Space> observer) {
  if (scene.path_control.arc)
    return make_path_run(model, path_options(scene, model, hooks), std::move(observer),
                         out_of_plane);
  if (scene.integrator == Integrator::quasistatic)
    return make_quasistatic_run(model,
                                {.end = scene.time.end,
                                 .dt = scene.time.dt,
                                 .most_steps = scene.limit.steps,
                                 .on_plan = hooks.on_plan},
                                std::move(observer), out_of_plane);
  ExplicitOptions options;
  options.end = scene.time.end;
  options.dt = scene.time.dt;
  options.velocity_limit = scene.limit.velocity;
  options.energy_limit = scene.limit.energy_error;
  options.history = scene.output.history;
  options.fields = scene.output.fields;
  options.most_steps = scene.limit.steps;
  options.on_plan = hooks.on_plan;
  options.checkpoint = {.file = scene.check_only ? "" : checkpoint_file(scene),
                        .every = scene.checkpoint.every,
                        .at_end = scene.checkpoint.at_end,
                        .stop_file = scene.output.dir + "/STOP",
                        .restart = scene.checkpoint.restart,
                        .lattice = hooks.lattice_id,
                        .obstacles = fingerprint(scene.obstacles),
                        .options = scene.options_yaml,
                        .scene = scene.path,
                        .wall_time = scene.checkpoint.wall_time,
                        .prepare = hooks.prepare,
                        .others = hooks.others};
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (scene.integrator == Integrator::implicit)
      return make_implicit_run(model, options, std::move(observer));
  }
  options.safety = scene.time.safety;
  options.allow_unstable = scene.time.allow_unstable;
  return make_explicit_run(model, options, std::move(observer));
}

namespace {

/// Refuses a load's point that is far from its body: the body carries loads on itself or on its
/// beams. Where a lattice has no outline, the limit is the largest distance that a body of this
/// inertia and with these beams can reach.
void check_point(const PlacedLoad& placed, const Lattice& lattice) {
  const auto body = static_cast<std::size_t>(placed.bodies.front());
  const Bodies& bodies = lattice.bodies;
  const Point3& inertia = bodies.inertia[body];
  // Largest distance over radius of gyration: a rod has 1.7, a cone 2.5.
  constexpr double widest = 4;
  double reach =
      widest * std::sqrt(std::max({inertia.x, inertia.y, inertia.z}) / bodies.mass[body]);
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

}  // namespace

std::vector<PlacedLoad> place_loads(const Scene& scene, const Lattice& lattice) {
  std::vector<PlacedLoad> placed;
  for (const Load& load : scene.loads) {
    const bool beside = scene.has_sheet && load.point &&
                        (2 * std::abs((*load.point)[0]) > scene.sheet.length ||
                         2 * std::abs((*load.point)[1]) > scene.sheet.width);
    if (beside) throw InputError("load: " + load.name + ": point: lies outside the sheet");
    placed.push_back(place(load, lattice));
    if (load.point && !scene.has_sheet) check_point(placed.back(), lattice);
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
    const Waves waves(part, scene.gravity, scene.waves, scene.drag.current);
    add_by(std::make_shared<SubmersionInWaves>(part, waves, scene.water_pace, shared), scene,
           model);
  } else {
    add_by(std::make_shared<Submersion>(part, scene.water_pace, shared), scene, model);
  }
}

}  // namespace

template <class Space>
void add_forces(const Scene& scene, const std::vector<PlacedLoad>& loads, Model<Space>& model,
                const Lattice* lattice) {
  const Part& part = model.part();
  if constexpr (std::is_same_v<Space, Spatial>) {  // fracture, and forces along z
    if (scene.forces.fracture) {
      BreakableForce breakable = make_breakable_beams(
          part, scene.beam, scene.fracture,
          lattice != nullptr && scene.fracture.propagation == Propagation::energy
              ? find_junctions(*lattice)
              : Junctions{});
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
    for (const auto& [mass, moment] :
         scene.added_mass_plate ? added_of_plates(part, scene.water_density)
                                : added_by_parts(part, scene.water_density, *scene.added_mass_axes))
      added.push_back({mass, moment});
    model.set_added_inertia(std::move(added));
  }
  for (const PlacedLoad& load : loads)
    model.add_force(make_load<Space>(part, load, scene.beam.kinematics));
}

template <class Space>
void add_contact(const Scene& scene, const Lattice& lattice, Model<Space>& model) {
  if constexpr (std::is_same_v<Space, Spatial>) {
    if (!scene.forces.contact) return;
    const auto prescribed = model.prescribed();
    const bool any =
        std::any_of(prescribed.begin(), prescribed.end(), [](auto b) { return b != 0; });
    PrescribedMotion motion;
    if (any)
      motion = {.bits = {prescribed.begin(), prescribed.end()},
                .accelerations = [&model](double time, std::span<double> values) {
                  model.prescribe_accelerations(time, values);
                }};
    auto contact =
        make_contact(model.part(), lattice, scene.contact, scene.obstacles, std::move(motion));
    const std::string& overlap = contact->overlap_at_start();
    if (scene.check_only && !overlap.empty() && rank() == 0) warn(overlap);
    model.add_force(std::move(contact));
  }
}

bool needs_shapes(const Scene& scene) {
  return scene.forces.buoyancy || scene.forces.drag || scene.forces.contact ||
         scene.fracture.propagation == Propagation::energy;
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

template std::unique_ptr<Run> make_run(const Scene&, Model<Spatial>&, const OutOfPlane*,
                                       const RunHooks&, Observer<Spatial>);
template std::unique_ptr<Run> make_run(const Scene&, Model<Planar>&, const OutOfPlane*,
                                       const RunHooks&, Observer<Planar>);
template void add_forces(const Scene&, const std::vector<PlacedLoad>&, Model<Spatial>&,
                         const Lattice*);
template void add_forces(const Scene&, const std::vector<PlacedLoad>&, Model<Planar>&,
                         const Lattice*);
template void add_contact(const Scene&, const Lattice&, Model<Spatial>&);
template void add_contact(const Scene&, const Lattice&, Model<Planar>&);
template void release_setup(const Scene&, Model<Spatial>&);
template void release_setup(const Scene&, Model<Planar>&);
template void hold_free_motions(const Scene&, const Lattice&, Model<Spatial>&);
template void hold_free_motions(const Scene&, const Lattice&, Model<Planar>&);

}  // namespace floe
