#include "simulation/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/beams/moduli.h"
#include "floe/files/log.h"
#include "floe/session/version.h"

namespace floe {
namespace {

using Json = nlohmann::ordered_json;

/// Boundary of the scene that fixes x of a set; null if there is none.
const Boundary* boundary_on(const Scene& scene, const std::string& set) {
  const auto found = std::find_if(scene.boundaries.begin(), scene.boundaries.end(),
                                  [&](const Boundary& b) { return b.set == set && b.fixed[0]; });
  return found == scene.boundaries.end() ? nullptr : &*found;
}

/// Load of a bending test: the first one at a point; null if there is none.
const Load* point_load(const Scene& scene) {
  const auto found = std::find_if(scene.loads.begin(), scene.loads.end(),
                                  [](const Load& l) { return l.point.has_value(); });
  return found == scene.loads.end() ? nullptr : &*found;
}

std::string line(const char* format, auto... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return std::string(text) + "\n";
}

/// Mean x at rest of a boundary's bodies [m]. Collective.
template <class Space>
double mean_x(const Model<Space>& model, const Boundary& boundary) {
  std::array<double, 2> mine{};  // sum and number
  for (const PlacedBoundary& placed : model.boundaries()) {
    if (placed.boundary.name != boundary.name) continue;
    for (const std::int32_t body : placed.bodies) {
      if (body >= model.part().owned) continue;
      mine[0] += item(model.part().bodies.position, body)[0];
      mine[1] += 1;
    }
  }
  const auto [sum, number] = sum_over_ranks(mine, model.part().comm);
  return sum / number;
}

/// Adds the tension test (model.md, "Tension test"): E = F/(A0 eps) with F the internal forces of
/// the beams on the left bodies, eps = u/L, A0 = width h (paper); L of an outline is its extent in
/// x, and its mean width is the area over L. With the gauge length between the
/// centroids of the edge cells, on which u acts, in place of L, E tends to the modulus of a large
/// sheet.
template <class Space>
void add_tension(const Scene& scene, const Model<Space>& model, const MeshReport& mesh,
                 const Sample& last, Json& json, std::string& text) {
  const BoundarySample& left = last.boundaries.at(boundary_on(scene, "left")->name);
  const BoundarySample& right = last.boundaries.at(boundary_on(scene, "right")->name);
  const double strain = (right.displacement[0] - left.displacement[0]) / scene.sheet.length;
  const double width =
      scene.sheet.outline.empty() ? scene.sheet.width : scene.sheet.area() / scene.sheet.length;
  const double young = -left.force[0] / (width * scene.thickness * strain);
  const double gauge =
      mean_x(model, *boundary_on(scene, "right")) - mean_x(model, *boundary_on(scene, "left"));
  const double gauged = young * gauge / scene.sheet.length;
  const LatticeModuli lattice =
      mesh.calibration ? mesh.calibration->moduli
                       : lattice_moduli(scene.sheet.element_size, scene.thickness, scene.ice,
                                        scene.shear_factor, scene.beam.shear, scene.torsion);
  const double reference = lattice.young * scene.ice.young;
  json["E"] = young;
  json["E_over_Eb"] = young / scene.ice.young;
  json["E_star"] = reference;
  json["E_over_Estar"] = young / reference;
  json["gauge_length"] = gauge;
  json["E_gauge_over_Eb"] = gauged / scene.ice.young;
  text += line("E      = %.6g Pa (effective Young's modulus of the sheet)", young);
  text +=
      line("E/Eb   = %.6f (Eb = %.4g Pa, of the beams)", young / scene.ice.young, scene.ice.young);
  text += line("E/E*   = %.6f (E* = %.6g Pa, of the %s)", young / reference, reference,
               mesh.calibration ? "calibrated lattice" : "infinite regular lattice");
  text += line("E/Eb   = %.6f with the strain over the gauge length %.6g m between edge cells",
               gauged / scene.ice.young, gauge);
}

/// Adds the bending test (model.md, "Bending on water"): the deflection of the load's point from
/// the floating equilibrium at time 0, compared with the infinite plate's w0 = P/(8 k l_c^2), k =
/// rho_w g, l_c = (D/k)^(1/4) (Wyman 1950).
void add_bending(const Scene& scene, const Sample& first, const Sample& last, Json& json,
                 std::string& text) {
  const Load& load = *point_load(scene);
  const double k = scene.water_density * scene.gravity, h = scene.thickness, nu = scene.ice.poisson;
  const double plate = scene.ice.young * h * h * h / (12 * (1 - nu * nu));
  const double characteristic = std::pow(plate / k, 0.25);
  const double force = load.force_at(last.time).z;
  const double wyman = -force / (8 * k * characteristic * characteristic);
  const double deflection = first.loads.at(load.name)[2] - last.loads.at(load.name)[2];
  json["deflection_max"] = deflection;
  json["wyman"] = wyman;
  json["deflection_over_wyman"] = deflection / wyman;
  json["characteristic_length"] = characteristic;
  text += line("deflection = %.6g m under the load", deflection);
  text += line("w/w0       = %.6f (w0 = %.6g m, Wyman's infinite plate, l_c = %.5g m)",
               deflection / wyman, wyman, characteristic);
}

/// Adds the number of contacts at the end, and the largest and the mean force on each obstacle.
void add_contacts(const Scene& scene, const Sample& last, Json& json) {
  const auto value = [&](const std::string& name) {
    const auto found = std::find_if(last.forces.begin(), last.forces.end(),
                                    [&](const auto& column) { return column.first == name; });
    return found == last.forces.end() ? 0.0 : found->second;
  };
  for (const char* what : {"contacts", "contacts_enclosed"})
    json[what] = static_cast<std::int64_t>(value(what));
  for (const char* what : {"peak_force", "mean_force"}) {
    Json all = Json::object();
    for (const Obstacle& o : scene.obstacles) {
      const std::string column = o.name + "_" + what;
      all[o.name] = {value(column + "_x"), value(column + "_y"), value(column + "_z")};
    }
    if (!all.empty()) json[what] = all;
  }
}

/// Adds what has joined and left since the start, and the bodies at the end.
void add_supply(const Sample& last, Json& json) {
  Json supply = Json::object();
  for (const auto& [name, value] : last.forces) {
    if (name == "bodies" || name.ends_with("_supplied") || name.ends_with("_removed") ||
        name.find("_supplied_") != std::string::npos || name.find("_removed_") != std::string::npos)
      supply[name] = value;
  }
  json["supply"] = supply;
}

/// Adds what the cracks cost: l sigma_t^2/(2 E G_f), by means over the beams of l0/E; the areas of
/// broken sections, at tips of cracks and all; and energy_fracture + energy_released (statics) over
/// the broken area, over G_f (model.md, "Fracture"). Collective.
template <class Space>
void add_fracture(const Scene& scene, const Model<Space>& model, const Sample& last, Json& json,
                  std::string& text) {
  const Part& part = model.part();
  std::array<double, 4> sums{};  // l0/E of the beams, their number, area at tips, all area
  for (std::size_t m = 0; m < part.beams.bodies.size(); ++m) {
    if (part.counts_here[m] == 0) continue;
    sums[0] += part.beams.length[m] / part.beams.young[m];
    sums[1] += 1;
  }
  for (const Break& b : model.fracture()->breaks()) {
    sums[2] += b.at_tip ? b.area : 0;
    sums[3] += b.area;
  }
  const auto [ratio, beams, at_tips, area] = sum_over_ranks(sums, part.comm);
  const FractureOptions& options = scene.fracture;
  const double length =
      ratio / beams * options.tensile_strength * options.tensile_strength / (2 * options.energy);
  double spent = 0;
  for (const auto& [name, value] : last.forces) {
    if (name == "energy_fracture" || name == "energy_released") spent += value;
  }
  json["length_over_fracture_length"] = length;
  json["broken_area"] = area;
  json["broken_area_at_tips"] = at_tips;
  if (area == 0) return;
  const double toughness = spent / area / options.energy;
  json["Geff_over_Gf"] = toughness;
  text += line(
      "cracks: %.6g m^2 broken, %.6g m^2 at tips; G_eff/G_f = %.4g, l/(2 E G_f/sigma_t^2) "
      "= %.4g",
      area, at_tips, toughness, length);
  constexpr double kappa = 2.45;  // of a beam at a tip
  if (options.propagation == Propagation::strength && kappa * length > 1)
    text +=
        "warning: cracks run at the strength of the beams at their tips, so they cost more than "
        "G_f "
        "(about 2.6 l sigma_t^2/(2 E)), the more the larger the elements; fracture: propagation: "
        "energy makes them cost G_f\n";
}

Json as_json(const StrengthCalibration& c) {
  Json json;
  json["factor"] = c.factor;
  if (c.tension) {
    json["along_x"] = c.tension->along_x;
    json["along_y"] = c.tension->along_y;
  }
  json["bending_factor"] = c.bending_factor;
  json["bending_along_x"] = c.bending.along_x;
  json["bending_along_y"] = c.bending.along_y;
  return json;
}

/// Describes the sheet's outline, and what simplification did to that of its file.
Json as_json(const Outline& outline, const Scene& scene) {
  std::size_t holes = 0;
  for (const RingedPolygon& polygon : outline.polygons()) holes += polygon.size() - 1;
  const auto [least, most] = outline.box();
  return {{"file", scene.outline.file},
          {"polygons", outline.polygons().size()},
          {"holes", holes},
          {"corners", outline.corners()},
          {"area", outline.area()},
          {"centroid", outline.centroid()},
          {"box", {least[0], most[0], least[1], most[1]}},
          {"corners_of_file", scene.outline.corners},
          {"area_of_file", scene.outline.area},
          {"simplified_to", {scene.outline.least_simplify, scene.outline.simplify}},
          {"area_moved", scene.outline.moved},
          {"thickness_of_file", scene.outline.has_thickness}};
}

/// Describes the floes that have sections, by their names.
Json floes_as_json(const Scene& scene) {
  Json json;
  for (const Floe& floe : scene.floes) {
    Json one = {{"area", area_of(scene, floe)},
                {"polygons", floe.polygons},
                {"element_size", floe.element_size},
                {"seed", floe.seed}};
    if (!floe.outline.file.empty()) {
      one["file"] = floe.outline.file;
      one["area_of_file"] = floe.outline.area;
      one["corners_of_file"] = floe.outline.corners;
      one["simplified_to"] = {floe.outline.least_simplify, floe.outline.simplify};
      one["area_moved"] = floe.outline.moved;
    }
    json[floe.name] = std::move(one);
  }
  return json;
}

/// Adds where a path ended, and its limit points.
void add_path(const PathResult& path, Json& json, std::string& text) {
  Json points = Json::array();
  for (const LimitPoint& p : path.limit_points)
    points.push_back({{"kind", p.is_maximum ? "maximum" : "minimum"},
                      {"load_factor", p.load_factor},
                      {"step", p.step}});
  json["path"] = {{"end", path.end},
                  {"load_factor", path.load_factor},
                  {"arc_length", path.length},
                  {"snap_backs", path.snap_backs},
                  {"limit_points", points}};
  text += line("path: ended %s; load factor %.6g, %lld limit points, %lld steps of snap-back",
               path.end.empty() ? "early" : path.end.c_str(), path.load_factor,
               static_cast<long long>(path.limit_points.size()),
               static_cast<long long>(path.snap_backs));
}

/// Adds the expected constants of a large sheet of this lattice less those of the material.
void add_calibration(const Scene& scene, const Calibration& c, Json& json, std::string& text) {
  const double nu = scene.ice.poisson;
  Json j;
  j["kind"] = scene.calibrate == Calibrate::isotropic ? "isotropic" : "young";
  j["irregularity"] = c.ratios.irregularity;
  j["texture"] = std::abs(c.ratios.texture);
  j["scale"] = c.scale;
  j["shear_ratio"] = c.ratios.shear;
  j["torsion_ratio"] = c.ratios.torsion;
  j["young_error"] = c.moduli.young - 1;
  j["poisson_error"] = c.moduli.poisson - nu;
  j["bending_error"] = c.moduli.bending - 1;
  j["bending_poisson_error"] = c.moduli.bending_poisson - nu;
  j["young_scatter"] = c.scatter.young;
  j["poisson_scatter"] = c.scatter.poisson;
  j["bending_scatter"] = c.scatter.bending;
  j["bending_poisson_scatter"] = c.scatter.bending_poisson;
  json["calibration"] = j;
  text += line(
      "calibrated: large sheet has E/Eb = %.4f +- %.4f, nu = %.4f +- %.4f, D/D(Eb, nu) = %.4f +- "
      "%.4f, nu_b = %.4f +- %.4f",
      c.moduli.young, c.scatter.young, c.moduli.poisson, c.scatter.poisson, c.moduli.bending,
      c.scatter.bending, c.moduli.bending_poisson, c.scatter.bending_poisson);
}

}  // namespace

namespace {

/// Returns why the scene is no tension test; empty if it is one.
std::string tension_problem(const Scene& scene) {
  const Boundary *left = boundary_on(scene, "left"), *right = boundary_on(scene, "right");
  if (!scene.has_sheet || left == nullptr || right == nullptr)
    return "report: tension needs a sheet and boundaries that fix x of its sets 'left' and 'right'";
  const double end = scene.time.end;
  if (left->value(end)[0] == right->value(end)[0])
    return "report: tension needs boundaries that move 'right' against 'left' in x";
  return {};
}

/// Returns why the scene is no bending test; empty if it is one.
std::string bending_problem(const Scene& scene) {
  const Load* load = point_load(scene);
  if (!scene.has_sheet || !scene.forces.buoyancy || load == nullptr ||
      (load->table.empty() && load->force[2] == 0))
    return "report: bending needs a floating sheet (buoyancy) and a vertical load at a point";
  if (!load->table.empty())
    return "report: bending compares a load that rises once; load: " + load->name + " has a table";
  if (scene.path_control.arc)
    return "report: bending compares the full load with theory; 'static: path' is arc";
  if (scene.loads.size() > 1)
    return "report: bending compares one load with theory; load: names: has " +
           std::to_string(scene.loads.size());
  if (load->ramp.value(0) != 0)
    return "load: " + load->name +
           ": ramp: 0 must be > 0 for report: bending: deflections count from time 0";
  return {};
}

}  // namespace

void check_reports(Scene& scene) {
  const auto check = [&](bool& wanted, std::string (*problem_of)(const Scene&)) {
    const std::string problem = wanted ? problem_of(scene) : "";
    if (problem.empty()) return;
    if (!scene.report.may_go) throw InputError(problem);
    wanted = false;
    scene.remarks.push_back(problem + "; left out, since the command line is the cause");
  };
  check(scene.report.tension, tension_problem);
  check(scene.report.bending, bending_problem);
}

template <class Space>
Summary summarise(const Scene& scene, const ModelChoice& choice, const Model<Space>& model,
                  const MeshReport& mesh, const RunResult& result, const Sample& first,
                  const Sample& last, double wall) {
  Json json;
  std::string text;
  json["status"] = result.done ? "done" : result.stopped ? "stopped" : "failed";
  json["message"] = result.message;
  if (!result.warnings.empty()) json["warnings"] = result.warnings;
  json["bodies"] = model.part().global_bodies;
  json["beams"] = model.part().global_beams;
  json["ranks"] = size();
  const bool stepped = scene.integrator == Integrator::explicit_;
  constexpr std::array names{"quasistatic", "explicit", "implicit"};
  json["integrator"] = names[static_cast<std::size_t>(scene.integrator)];
  json["model"] = choice.text;
  json["time"] = last.time;
  json["steps"] = result.steps;
  json["dt"] = result.dt;
  if (stepped) {
    json["stepper"] = result.stepper;
    json["stable_dt"] = result.stable_dt;
    json["dt_limited_by"] = result.limited_by;
    json["ns_per_beam_step"] = 1e9 * wall_seconds(Event::solve) /
                               std::max(1.0, static_cast<double>(result.steps_now) *
                                                 static_cast<double>(model.part().global_beams));
  } else {
    json["newton_iterations"] = result.newton_iterations;
    if (scene.integrator == Integrator::quasistatic) json["factorisations"] = result.factorisations;
    if (result.unstable_modes >= 0) json["stable"] = result.unstable_modes == 0;
    if (result.path) add_path(*result.path, json, text);
  }
  if (scene.has_sheet) {
    if (scene.floes.empty()) json["seed"] = scene.sheet.seed;
    json["cvt_energy_ratio"] = mesh.energy_ratio;
    json["cvt_largest_move"] = mesh.largest_move;
    json["cvt_iterations"] = mesh.iterations;
    json["degenerate_facets"] = mesh.degenerate;
    if (!scene.floes.empty())
      json["floes"] = floes_as_json(scene);
    else if (!scene.sheet.outline.empty())
      json["outline"] = as_json(scene.sheet.outline, scene);
  }
  if (mesh.bonds) {
    const auto& [number, area, least_gap, most_gap] = *mesh.bonds;
    json["bonds"] = {
        {"number", number}, {"area", area}, {"least_gap", least_gap}, {"most_gap", most_gap}};
  }
  if (mesh.thickness) {
    const auto& [least, mean, most, deviation] = *mesh.thickness;
    json["thickness"] = {
        {"least", least}, {"mean", mean}, {"most", most}, {"deviation", deviation}};
    text += line("thickness: %.4g m in the mean, %.4g to %.4g, standard deviation %.4g", mean,
                 least, most, deviation);
  }
  text +=
      line("%d bodies, %lld beams, %lld %s, %lld Newton iterations", model.part().global_bodies,
           static_cast<long long>(model.part().global_beams), static_cast<long long>(result.steps),
           scene.integrator == Integrator::quasistatic ? "load steps" : "steps",
           static_cast<long long>(result.newton_iterations));
  if (scene.has_sheet)
    text += line("mesh: CVT energy %.4f of the hexagon's, last largest move %.2g l, %d iterations",
                 mesh.energy_ratio, mesh.largest_move, mesh.iterations);
  if (mesh.calibration) add_calibration(scene, *mesh.calibration, json, text);
  if (mesh.strength) json["strength_calibration"] = as_json(*mesh.strength);
  if (result.done && scene.report.tension) add_tension(scene, model, mesh, last, json, text);
  if (result.done && scene.report.bending) add_bending(scene, first, last, json, text);
  Json energy = Json::object();
  for (const auto& [name, value] : last.forces) {
    if (name.rfind("energy_", 0) == 0) energy[name.substr(7)] = value;
  }
  json["energy"] = energy;
  if (scene.forces.contact) add_contacts(scene, last, json);
  if (scene.supply.on) add_supply(last, json);
  for (const auto& [name, value] : last.forces) {
    if (name.rfind("beams_", 0) == 0 || name == "fragments")
      json[name] = static_cast<std::int64_t>(std::llround(value));
  }
  if (model.fracture() != nullptr) add_fracture(scene, model, last, json, text);
  if (const Moves& moves = result.moves; moves.count > 0) {
    json["moves"] = {
        {"count", moves.count}, {"load_before", moves.before}, {"load_after", moves.after}};
    text += line(
        "bodies moved between ranks %lld times; the last time the busiest rank went from "
        "%.2f to %.2f times the mean load",
        static_cast<long long>(moves.count), moves.before, moves.after);
  }
  json["wall_s"] = wall;
  json["mesh_s"] = wall_seconds(Event::mesh);
  json["lattice_s"] = wall_seconds(Event::lattice);
  json["partition_s"] = wall_seconds(Event::partition);
  json["forces_s"] = wall_seconds(Event::forces);
  json["tangent_s"] = wall_seconds(Event::tangent);
  json["solve_s"] = wall_seconds(Event::solve);
  json["output_s"] = wall_seconds(Event::output);
  const double memory = sum_over_ranks(peak_memory_mb(), model.part().comm);
  json["peak_memory_mb"] = memory;
  json["version"] = version();
  json["built_for"] = built_for(model.part().comm);
  text += line(
      "wall %.2f s (mesh %.2f, tangent %.2f, solve %.2f, output %.2f), %.0f MB on %d rank%s", wall,
      wall_seconds(Event::mesh), wall_seconds(Event::tangent), wall_seconds(Event::solve),
      wall_seconds(Event::output), memory, size(), size() == 1 ? "" : "s");
  return {json.dump(2) + "\n", text};
}

template Summary summarise(const Scene&, const ModelChoice&, const Model<Spatial>&,
                           const MeshReport&, const RunResult&, const Sample&, const Sample&,
                           double);
template Summary summarise(const Scene&, const ModelChoice&, const Model<Planar>&,
                           const MeshReport&, const RunResult&, const Sample&, const Sample&,
                           double);

}  // namespace floe
