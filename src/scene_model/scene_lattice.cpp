#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "floe/mesh/cuts.h"
#include "geometry/connected_parts.h"
#include "run/expected_cost.h"
#include "scene/reading.h"
#include "scene_model/bonds.h"
#include "scene_model/lattice_command.h"
#include "scene_model/mesh_file.h"
#include "scene_model/scene_model.h"
#include "scene_model/size_check.h"
#include "scene_model/structures.h"
#include "scene_model/supplied_ice.h"
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

/// Returns a remark on cuts on which cells do not end; empty if there are none.
std::string remark_on(const std::vector<FittedCut>& cuts, const Scene& scene) {
  double length = 0, followed = 0;
  std::vector<std::string> apart;
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    const FittedCut& cut = cuts[k];
    length += cut.length, followed += cut.followed;
    if (std::abs(cut.followed - cut.length) > 1e-6 * cut.length)
      apart.push_back(scene.cuts[k].name);
  }
  if (apart.empty()) return {};
  return "cut: " + apart.front() +
         (apart.size() > 1 ? " and " + std::to_string(apart.size() - 1) + " more" : "") +
         ": the cells do not end on " + (apart.size() > 1 ? "them" : "it") + " everywhere (" +
         text_of(followed) + " of " + text_of(length) +
         " m of all cuts), but the cuts follow the cells: they are short, or near each other or "
         "the outline, for " +
         (scene.floes.empty() ? "sheet: element_size: " : "cells of ") +
         text_of(scene.sheet.element_size) + (scene.floes.empty() ? "" : " m");
}

/// The floe that has a polygon of the outline; none: the sheet has it.
const Floe* floe_of(const Scene& scene, std::size_t polygon) {
  const auto found = std::find_if(scene.floes.begin(), scene.floes.end(), [&](const Floe& floe) {
    return polygon < floe.first + floe.polygons;
  });
  return found == scene.floes.end() ? nullptr : &*found;
}

[[noreturn]] void refuse(const UnfollowedEdge& edge, std::size_t others, const Scene& scene) {
  const auto& [from, to] = edge.line;
  const Floe* floe = floe_of(scene, edge.polygon);
  const OutlineSource& source = floe == nullptr ? scene.outline : floe->outline;
  const auto& polygons = scene.sheet.outline.polygons();
  const std::size_t first = floe == nullptr ? 0 : floe->first,
                    n = floe == nullptr ? polygons.size() : floe->polygons;
  const Outline outline({polygons.begin() + static_cast<std::ptrdiff_t>(first),
                         polygons.begin() + static_cast<std::ptrdiff_t>(first + n)});
  const std::string section = floe == nullptr ? "sheet: " : "floe: " + floe->name + ": ";
  const double l = scene.sheet.size_of(static_cast<std::int32_t>(edge.polygon));
  throw InputError(
      section + "outline: '" + source.file +
      "': " + name_of_ring(outline, edge.polygon - first, edge.ring) + ": no cells of " + section +
      "element_size: " + text_of(l) + " can end on edge " + std::to_string(edge.edge + 1) + " of " +
      std::to_string(polygons[edge.polygon][edge.ring].size()) + ", from (" + text_of(from[0]) +
      ", " + text_of(from[1]) + ") to (" + text_of(to[0]) + ", " + text_of(to[1]) + ")" +
      (others > 0 ? " and " + std::to_string(others) + " more" : "") + ": raise " + section +
      "outline_simplify (now " + text_of(source.simplify) + ") or lower " + section +
      "element_size");
}

/// Makes cells end on the outline, if there is one, and on the scene's cuts. \return what became of
/// each cut
/// \param polygon  set to the outline's, in which each cell lies
std::vector<FittedCut> fit(const Scene& scene, MPI_Comm comm, std::vector<Tessellation> relaxed,
                           Tessellation& cells, std::vector<std::int32_t>& polygon) {
  std::vector<CutLine> lines;
  if (scene.fit_cuts)
    for (const Cut& c : scene.cuts) lines.push_back({c.from, c.to});
  if (!scene.sheet.outline.empty()) {
    OutlinedCells fitted = fit_to_outline(scene.sheet, std::move(relaxed), lines, comm);
    const auto& edges = fitted.unfollowed;
    if (!edges.empty()) refuse(edges.front(), edges.size() - 1, scene);
    cells = std::move(fitted.cells);
    polygon = std::move(fitted.polygon);
    return std::move(fitted.cuts);
  }
  if (lines.empty()) {
    cells = std::move(relaxed.front());
    return {};
  }
  FittedCells fitted = fit_to_cuts(scene.sheet, std::move(relaxed.front()), lines, comm);
  cells = std::move(fitted.cells);
  return std::move(fitted.cuts);
}

/// Makes the tessellations of the sheet, or of the rectangles around its polygons.
std::vector<Tessellation> relax(const Scene& scene, MPI_Comm comm, MeshReport& report) {
  Progress progress("mesh", scene.sheet.iterations);
  const auto show = [&](int iteration, double move) {
    stop_if_asked(comm);
    char note[48];
    std::snprintf(note, sizeof note, "largest move %.2g l", move);
    progress.update(iteration, note);
  };
  if (!scene.mesh_file.empty())
    return tessellate_with_file(scene.sheet, scene.mesh_file, comm, show, report.keep);
  return tessellate(meshed_boxes(scene.sheet), comm, show);
}

/// Returns the sets of the scene's boundaries, loads and initial motions that are named floe_K, K
/// the number of a feature of the outline, and are no regions.
std::map<std::string, std::int32_t> floes_named(const Scene& scene) {
  std::set<std::string> names;
  for (const Boundary& b : scene.boundaries) names.insert(b.set);
  for (const Load& l : scene.loads) names.insert(l.set);
  for (const Initial& i : scene.initials) names.insert(i.set);
  for (const Region& region : scene.regions) names.erase(region.name);
  const std::set<std::int32_t> features(scene.outline.feature.begin(), scene.outline.feature.end());
  std::map<std::string, std::int32_t> found;
  const std::string front = "floe_";
  for (const std::string& name : names) {
    std::int32_t number = 0;
    const char* end = name.data() + name.size();
    if (!name.starts_with(front) || name.starts_with(front + "0")) continue;
    const auto [rest, error] = std::from_chars(name.data() + front.size(), end, number);
    if (error == std::errc() && rest == end && features.contains(number)) found[name] = number;
  }
  return found;
}

/// Adds the sets of bodies with an edge of the sheet in a region.
void add_edge_regions(const Scene& scene, const Tessellation& cells, Lattice& lattice) {
  const bool any = std::any_of(scene.regions.begin(), scene.regions.end(),
                               [](const Region& region) { return region.edge; });
  if (!any) return;
  const std::vector<BoundaryEdge> edges = boundary_edges(cells);
  for (const Region& region : scene.regions) {
    if (!region.edge) continue;
    const auto& [x0, x1, y0, y1, z0, z1] = region.box;
    std::vector<std::int32_t> inside;
    for (const auto& [cell, from, to] : edges) {
      const double x = (from[0] + to[0]) / 2, y = (from[1] + to[1]) / 2;
      const double z = item(lattice.bodies.position, cell).z;
      if (x >= x0 && x <= x1 && y >= y0 && y <= y1 && z >= z0 && z <= z1 &&
          (inside.empty() || inside.back() != cell))
        inside.push_back(cell);
    }
    if (inside.empty())
      throw InputError("region: " + region.name +
                       ": box: no edge of the sheet has its middle inside this box");
    lattice.sets[region.name] = std::move(inside);
  }
}

/// Adds the sets of the floes that have sections.
void add_named_floes(const Scene& scene, const std::vector<std::int32_t>& polygon,
                     Lattice& lattice) {
  std::vector<std::vector<std::int32_t>*> sets;
  for (const Floe& floe : scene.floes)
    sets.resize(floe.first + floe.polygons, &lattice.sets[floe.name]);
  for (std::size_t k = 0; k < polygon.size() && !sets.empty(); ++k)
    item(sets, polygon[k])->push_back(static_cast<std::int32_t>(k));
}

/// Gives the beams of floes the factors of their strengths and energies, where these are not all 1.
void strengthen_floes(const Scene& scene, const std::vector<std::int32_t>& polygon,
                      Lattice& lattice) {
  const auto fill = [&](double Floe::*factor, std::vector<double>& column) {
    const auto is_one = [&](const Floe& floe) { return floe.*factor == 1; };
    if (std::all_of(scene.floes.begin(), scene.floes.end(), is_one)) return;
    std::vector<double> of_polygon;
    for (const Floe& floe : scene.floes)
      of_polygon.resize(floe.first + floe.polygons, floe.*factor);
    for (const auto& [i, j] : lattice.beams.bodies)
      column.push_back(item(of_polygon, item(polygon, i)));
  };
  fill(&Floe::strength, lattice.beams.strength);
  fill(&Floe::energy, lattice.beams.energy);
}

/// Adds the sets floe_1, floe_2, ... that the scene names: the bodies of the outline's features.
void add_floes(const Scene& scene, const std::vector<std::int32_t>& polygon, Lattice& lattice) {
  std::map<std::int32_t, std::vector<std::int32_t>*> floes;
  for (const auto& [set, feature] : floes_named(scene)) floes[feature] = &lattice.sets[set];
  if (floes.empty()) return;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const auto found = floes.find(item(scene.outline.feature, polygon[k]));
    if (found != floes.end()) found->second->push_back(static_cast<std::int32_t>(k));
  }
}

/// A rectangular sheet.
struct Rectangle {
  SheetPlan plan;
  Tessellation cells;
};

/// Returns the rectangle around the largest polygon of the outline, in which the strength of the
/// sheet is found.
Rectangle largest(const SheetPlan& sheet, const std::vector<Tessellation>& relaxed) {
  std::vector<MeshedBox> boxes = meshed_boxes(sheet);
  const auto box = std::max_element(boxes.begin(), boxes.end(), [](const auto& a, const auto& b) {
    return a.plan.area() < b.plan.area();
  });
  return {std::move(box->plan), relaxed[static_cast<std::size_t>(box - boxes.begin())]};
}

bool finds_strength(const Scene& scene) {
  return scene.forces.fracture &&
         (scene.fracture.calibrate || scene.fracture.flexural_strength > 0);
}

/// Describes what simplification did to an outline; empty if nothing.
std::string simplification(const OutlineSource& source) {
  const double least = source.least_simplify, most = source.simplify;
  if (most == 0) return {};
  return " (simplified to " + (least < most ? text_of(least) + " to " : "") + text_of(most) +
         " m from " + std::to_string(source.corners) + " corners, " + text_of(source.area) +
         " m^2; " + text_of(100 * source.moved / source.area) + " % of the area moved)";
}

/// Describes the floes that have sections, the first ones one by one.
std::string floes_text(const Scene& scene) {
  constexpr std::size_t most = 6;
  const std::size_t n = scene.floes.size();
  std::string text = "floes: " + std::to_string(n);
  for (std::size_t k = 0; k < std::min(n, most); ++k) {
    const Floe& floe = scene.floes[k];
    text += (k == 0 ? ": " : "; ") + floe.name + " " + text_of(area_of(scene, floe)) +
            " m^2, element_size " + text_of(floe.element_size) + " m" +
            simplification(floe.outline);
  }
  return text + (n > most ? "; and " + std::to_string(n - most) + " more" : "");
}

/// Describes the sheet's outline; empty if it is a rectangle.
std::string outline_text(const Scene& scene) {
  const Outline& outline = scene.sheet.outline;
  if (outline.empty()) return {};
  if (!scene.floes.empty()) return floes_text(scene);
  const std::size_t polygons = outline.polygons().size();
  std::string text = "outline: " + std::to_string(polygons) + " polygon" +
                     (polygons == 1 ? "" : "s") + ", " + std::to_string(outline.corners()) +
                     " corners, " + text_of(outline.area()) + " m^2";
  text += simplification(scene.outline);
  if (scene.outline.has_thickness) text += ", each of its own thickness";
  return text;
}

/// Refuses periods in which a body could meet another at both sides, and walls across them.
void check_periods(const Scene& scene, const Lattice& lattice) {
  if (!scene.periods.any()) return;
  constexpr double least = 4.5;  // two radii of both bodies, and the reach of the pair list
  double radius = 0;
  for (const Point3& v : lattice.shapes.vertices) radius = std::max(radius, length(v));
  const Vec3<double>& periods = scene.periods.length;
  for (const double period : {periods.x, periods.y}) {
    if (period > 0 && period < least * radius)
      throw InputError("model: periodic: " + text_of(period) +
                       " must be >= " + text_of(least * radius) + " [m], " + text_of(least) +
                       " times the radius of the largest body, or 0");
  }
  for (const Obstacle& o : scene.obstacles) {
    if (!o.is_half_space()) continue;
    const Vec3<double> n = o.parts[0].planes.front().normal;
    for (const std::size_t k : {0U, 1U}) {
      if (periods[k] > 0 && std::abs(n[k]) > 1e-12)
        throw InputError("obstacle: " + o.name + ": normal: has a part along " +
                         (k == 0 ? "x" : "y") +
                         ", after which the model repeats itself (model: periodic)");
    }
  }
}

/// The rectangle of a sheet that repeats itself, with sides along which its strength is found.
Rectangle one_that_ends(SheetPlan plan, MPI_Comm comm) {
  plan.periodic = false;
  return {plan, tessellate(plan, comm)};
}

/// \param around  set for a sheet with an outline, or one that repeats itself, whose strength is to
///   be found
Lattice mesh_sheet(const Scene& scene, MPI_Comm comm, MeshReport& report,
                   std::vector<FittedCut>& cuts, std::optional<Rectangle>& around) {
  const SheetSection section = section_of(scene);
  check_size(scene, free_memory(comm), size(comm));
  Tessellation cells;
  std::vector<std::int32_t> polygon;  // of the outline, in which each cell lies
  {
    const Timed timed(Event::mesh);
    std::vector<Tessellation> relaxed = relax(scene, comm, report);
    if (scene.sheet.periodic && finds_strength(scene)) around = one_that_ends(scene.sheet, comm);
    for (const Tessellation& t : relaxed) {
      report.largest_move = std::max(report.largest_move, t.largest_move);
      report.iterations = std::max(report.iterations, t.iterations);
    }
    if (!scene.sheet.outline.empty() && finds_strength(scene))
      around = largest(scene.sheet, relaxed);
    std::vector<FittedCut> fitted = fit(scene, comm, std::move(relaxed), cells, polygon);
    report.outline = outline_text(scene);
    report.cuts = remark_on(fitted, scene);
    if (!fitted.empty()) cuts = std::move(fitted);
  }
  report.energy_ratio = cells.energy_ratio;
  report.degenerate = cells.degenerate;
  const Timed timed(Event::lattice);
  const std::vector<double> thickness = thickness_of_cells(scene, cells, polygon);
  if (!thickness.empty()) report.thickness = thickness_report(cells, thickness);
  Lattice lattice = make_sheet(cells, section, thickness);
  add_edge_regions(scene, cells, lattice);
  add_floes(scene, polygon, lattice);
  add_named_floes(scene, polygon, lattice);
  strengthen_floes(scene, polygon, lattice);
  return lattice;
}

/// Finds the strength of the sheet, on its own lattice or on that of the rectangle around it, where
/// a uniform load makes a uniform stress. Collective.
StrengthCalibration strength_of(const Scene& scene, const Lattice& lattice,
                                const std::optional<Rectangle>& around, MPI_Comm comm) {
  if (!around) return calibrate_strength(scene, lattice, comm);
  Scene rectangle = scene;
  rectangle.sheet = around->plan;
  Lattice cells = make_sheet(around->cells, section_of(scene));
  if (scene.calibrate != Calibrate::none)
    (void)calibrate(cells, scene.ice, scene.calibrate, scene.beam.shear);
  return calibrate_strength(rectangle, cells, comm);
}

/// Makes the lattice of the strips of a sheet without end. Collective.
/// \param around  set for a sheet whose strength is to be found: a rectangle of its size
Lattice mesh_strips(const Scene& scene, MPI_Comm comm, MeshReport& report,
                    std::optional<Rectangle>& around) {
  check_size(scene, free_memory(comm), size(comm));
  const Timed timed(Event::mesh);
  report.ice = std::make_shared<SuppliedIce>(scene, comm);
  Lattice lattice = report.ice->lattice();
  report.energy_ratio = report.ice->energy_ratio();
  report.iterations = scene.sheet.iterations;
  if (finds_strength(scene)) around = one_that_ends(scene.sheet, comm);
  return lattice;
}

/// Refuses bodies of several parts, of which drag would act on faces where parts meet.
void check_parts(const Scene& scene, const Lattice& lattice) {
  for (std::int32_t b = 0; b < lattice.shapes.bodies(); ++b) {
    const std::int32_t parts = number_of_parts(lattice.shapes, b);
    if (parts > 1)
      throw InputError("water: drag: faces is for convex bodies; body " + std::to_string(b) +
                       " of '" + scene.lattice_file + "' has " + std::to_string(parts) + " parts");
  }
}

}  // namespace

SheetSection section_of(const Scene& scene) {
  return {scene.thickness, mid_plane(scene), scene.ice, scene.shear_factor, scene.torsion};
}

Lattice make_lattice(const Scene& scene, MPI_Comm comm, MeshReport& report) {
  if (!scene.has_sheet) require_lattice_file(scene, comm);
  std::vector<FittedCut> fitted(scene.cuts.size());
  std::optional<Rectangle> around;
  Lattice lattice = scene.supply.on   ? mesh_strips(scene, comm, report, around)
                    : scene.has_sheet ? mesh_sheet(scene, comm, report, fitted, around)
                                      : read_lattice(scene.lattice_file);
  const Timed timed(Event::lattice);
  if (scene.forces.beam && lattice.beams.size() == 0 && !scene.bonds.given)
    throw InputError(scene.has_sheet
                         ? "sheet: element_size: the sheet has a single cell and no beam"
                         : "forces: beam: '" + scene.lattice_file + "' has no beams");
  if (!scene.forces.beam) lattice.beams = {};  // loose bodies
  if (!scene.has_sheet && scene.forces.drag && scene.drag.faces) check_parts(scene, lattice);
  if (scene.calibrate != Calibrate::none)
    report.calibration = calibrate(lattice, scene.ice, scene.calibrate, scene.beam.shear);
  if (finds_strength(scene)) report.strength = strength_of(scene, lattice, around, comm);
  for (std::size_t k = 0; k < scene.cuts.size(); ++k) {
    const Cut& c = scene.cuts[k];
    const std::int32_t before = lattice.beams.size();
    cut(lattice, c.from, c.to, fitted[k].pairs);
    if (lattice.beams.size() == before && !c.may_miss)
      throw InputError("cut: " + c.name + ": crosses no beam; it would have no effect");
  }
  check_periods(scene, lattice);
  if (scene.supply.on) return lattice;  // in the order of names
  if (scene.bonds.given) report.bonds = add_bonds(scene, lattice);
  if (scene.has_sheet) (void)reorder(lattice);  // a file keeps its own order
  auto& all = lattice.sets["all"];
  all.resize(static_cast<std::size_t>(lattice.bodies.size()));
  std::iota(all.begin(), all.end(), 0);
  for (const Region& region : scene.regions)
    if (!region.edge)
      add_region(lattice, region.name, region.box, "region: " + region.name + ": box");
  if (scene.inertia_factor != 1) {
    for (Point3& moments : lattice.bodies.inertia) moments = scene.inertia_factor * moments;
  }
  add_structures(scene, lattice);
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
