#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "floe/mesh/cuts.h"
#include "run/expected_cost.h"
#include "scene/reading.h"
#include "scene_model/lattice_command.h"
#include "scene_model/mesh_file.h"
#include "scene_model/scene_model.h"
#include "scene_model/size_check.h"
#include "scene_model/thickness.h"
#include "session/signals.h"

namespace floe {
namespace {

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
  const std::vector<double> thickness = thickness_of_cells(scene, cells);
  if (!thickness.empty()) report.thickness = thickness_report(cells, thickness);
  return make_sheet(cells, section, thickness);
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
  if (scene.inertia_factor != 1) {
    for (Point3& moments : lattice.bodies.inertia) moments = scene.inertia_factor * moments;
  }
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

}  // namespace floe
