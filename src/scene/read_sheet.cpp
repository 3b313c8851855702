// Reading of the sheet and its ice, or of a lattice file; regions and cuts.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "floe/mesh/cuts.h"
#include "reading.h"

namespace floe {
namespace {

/// Sets the thickness of the polygons of the outline: one if it is the same for all, else that of
/// each and their mean.
void set_thickness(Scene& scene, const std::vector<double>& of_polygon) {
  const auto [least, most] = std::minmax_element(of_polygon.begin(), of_polygon.end());
  if (*least == *most) {
    scene.thickness = *least;
    return;
  }
  double volume = 0;
  for (std::size_t k = 0; k < of_polygon.size(); ++k)
    volume += of_polygon[k] * Outline({scene.sheet.outline.polygons()[k]}).area();
  scene.thickness = volume / scene.sheet.outline.area();
  scene.thickness_field.of_polygon = of_polygon;
}

/// Takes the thickness of each floe from the file of the outline. \return whether it has any
bool take_thickness_of_file(Scene& scene) {
  if (!has_thickness(scene.outline, "sheet: outline", "sheet: thickness")) return false;
  scene.outline.has_thickness = true;
  set_thickness(scene, scene.outline.thickness);
  return true;
}

/// Whether each floe has its own thickness.
bool all_have_thickness(const std::vector<Floe>& floes) {
  return !floes.empty() && std::none_of(floes.begin(), floes.end(),
                                        [](const Floe& f) { return f.thickness.empty(); });
}

/// Takes the thickness of floes that have their own; the others have that of the sheet.
void take_thickness_of_floes(Scene& scene) {
  const bool varies = scene.thickness_field.varies();
  std::vector<double> of_polygon;
  for (const Floe& floe : scene.floes) {
    of_polygon.insert(of_polygon.end(), floe.thickness.begin(), floe.thickness.end());
    if (floe.thickness.empty())
      of_polygon.resize(floe.first + floe.polygons, varies ? NAN : scene.thickness);
  }
  if (varies)
    scene.thickness_field.of_polygon = std::move(of_polygon);
  else
    set_thickness(scene, of_polygon);
}

/// Reads the thickness of the sheet, one or a field.
void read_thickness_of_sheet(Options& options, Scene& scene) {
  ThicknessField& field = scene.thickness_field;
  const bool random = options.given("sheet: thickness_deviation");
  const bool by_scene =
      random || options.given("sheet: thickness") || options.given("sheet: thickness_file");
  if (options.given("sheet: thickness_file")) {
    field.file = options.text("sheet: thickness_file");
    scene.inputs.emplace_back("sheet: thickness_file", field.file);
    for (const auto* key : {"sheet: thickness", "sheet: thickness_deviation"})
      options.refuse(key, "would have no effect: 'sheet: thickness_file' says it");
  } else if (by_scene || !scene.floes.empty() || !take_thickness_of_file(scene)) {
    scene.thickness = options.number("sheet: thickness");
    if (random) field.deviation = options.number("sheet: thickness_deviation");
  }
  if (field.deviation > 0) {
    field.correlation = options.numbers<2>("sheet: thickness_correlation");
    field.seed = static_cast<std::uint64_t>(options.integer("sheet: thickness_seed"));
  } else {
    for (const auto* key : {"sheet: thickness_correlation", "sheet: thickness_seed"})
      options.refuse(key,
                     "would have no effect: there is no random field "
                     "('sheet: thickness_deviation')");
  }
}

void read_thickness(Options& options, Scene& scene) {
  if (all_have_thickness(scene.floes)) {
    for (const auto* key :
         {"sheet: thickness", "sheet: thickness_file", "sheet: thickness_deviation",
          "sheet: thickness_correlation", "sheet: thickness_seed"})
      options.refuse(key, "would have no effect: each floe has its own");
  } else {
    read_thickness_of_sheet(options, scene);
  }
  if (!scene.floes.empty()) take_thickness_of_floes(scene);
}

/// Reads the plan of one sheet.
void read_plan(Options& options, Scene& scene) {
  SheetPlan& plan = scene.sheet;
  plan.element_size = options.number("sheet: element_size");
  const bool has_outline = read_outline(options, scene);
  if (!has_outline) {
    plan.length = options.number("sheet: length");
    plan.width = options.number("sheet: width", {}, plan.length);
    plan.periodic = options.flag("sheet: periodic");
  } else {
    options.refuse("sheet: periodic",
                   "does not go with 'sheet: outline': a rectangle repeats itself");
  }
  plan.seed = static_cast<std::uint64_t>(options.integer("sheet: seed"));
  const double shorter = std::min(plan.length, plan.width);
  if (plan.element_size > shorter && !has_outline)
    throw InputError("sheet: element_size: " + text_of(plan.element_size) + " must be <= " +
                     (plan.width < plan.length ? "sheet: width " : "sheet: length ") +
                     text_of(shorter) + " [m]");
}

/// Refuses what a sheet that repeats itself does not go with, as far as the sheet's keys say.
void check_periodic(const Scene& scene) {
  const auto refuse = [](const std::string& key, const std::string& why) {
    throw InputError(key + ": does not go with 'sheet: periodic': " + why);
  };
  if (scene.integrator == Integrator::quasistatic)
    refuse("integrator",
           "it must be explicit or implicit: statics look for free rigid motions of bodies that do "
           "not repeat themselves");
  if (!scene.mesh_file.empty()) refuse("sheet: mesh_file", "it keeps sheets that end");
  if (scene.thickness_field.deviation > 0)
    refuse("sheet: thickness_deviation", "the random field does not repeat itself");
}

void read_sheet(Options& options, Scene& scene) {
  SheetPlan& plan = scene.sheet;
  options.names("floe").empty() ? read_plan(options, scene) : read_floes(options, scene);
  plan.relaxation = options.choice<Relaxation>("sheet: relaxation");
  plan.iterations = static_cast<int>(options.integer("sheet: iterations"));
  plan.tolerance = options.number("sheet: tolerance");
  if (options.given("sheet: mesh_file")) {
    scene.mesh_file = options.text("sheet: mesh_file");
    scene.inputs.emplace_back("sheet: mesh_file", scene.mesh_file);
  }
  read_thickness(options, scene);
  if (plan.periodic) check_periodic(scene);
  scene.limit.memory = options.number("limit: memory", {}, 0.0);

  constexpr double most_bodies = 1e8;  // indices of beams and facets have 32 bits
  double bodies = 0;
  for (const MeshedBox& box : meshed_boxes(plan))
    bodies += (box.plan.length / box.plan.element_size) * (box.plan.width / box.plan.element_size);
  if (bodies > most_bodies)
    throw InputError("sheet: element_size: " + text_of(plan.element_size) + " would make about " +
                     text_of(bodies) + " bodies, at most " + text_of(most_bodies) +
                     " are possible");
}

void read_ice(Options& options, Scene& scene) {
  scene.ice.young = options.number("ice: young");
  scene.ice.poisson = options.number("ice: poisson");
  scene.ice.density = options.number("ice: density");
  if (!scene.forces.beam) return;
  scene.shear_factor = options.number("beam: shear_factor");
  scene.calibrate = options.choice<Calibrate>("beam: calibrate");
  if (scene.calibrate != Calibrate::isotropic) {
    scene.torsion = options.choice<Torsion>("beam: torsion");
    return;
  }
  if (scene.ice.poisson > largest_isotropic_poisson)
    throw InputError("ice: poisson: " + text_of(scene.ice.poisson) +
                     " must be <= 1/3 for beam: calibrate: isotropic, or stiffnesses are negative");
  for (const auto* key : {"beam: shear", "beam: torsion"})
    options.refuse(key, "would have no effect: 'beam: calibrate' is isotropic");
}

}  // namespace

bool has_thickness(const OutlineSource& outline, const std::string& outline_key,
                   const std::string& thickness_key) {
  const std::vector<double>& thickness = outline.thickness;
  const auto refuse = [&](std::size_t k, const std::string& why) {
    throw InputError(outline_key + ": '" + outline.file + "': feature " +
                     std::to_string(outline.feature[k]) + " has " + why + "; '" + thickness_key +
                     "' would take the place of those of the file");
  };
  const auto has_none = [](double h) { return std::isnan(h); };
  if (std::all_of(thickness.begin(), thickness.end(), has_none)) return false;
  for (std::size_t k = 0; k < thickness.size(); ++k) {
    const double h = thickness[k];
    if (has_none(h)) refuse(k, "no number \"thickness\" among its properties, others have");
    if (!(h >= 1e-9 && h <= 1e9))
      refuse(k, "the thickness " + text_of(h) + ", must be >= 1e-9, <= 1e9 [m]");
  }
  return true;
}

void read_lattice_source(Options& options, Scene& scene) {
  scene.has_sheet = options.given_section("sheet") || !options.names("floe").empty();
  const bool has_file = options.given("lattice_file");
  if (scene.has_sheet && options.on_command_line("lattice_file") &&
      !options.section_on_command_line("sheet") && !options.section_on_command_line("floe")) {
    for (const auto* section : {"sheet", "floe"})
      options.refuse(section, "'lattice_file' of the command line takes its place");
    scene.has_sheet = false;
  }
  if (scene.has_sheet && has_file)
    throw InputError(std::string("lattice_file: a scene has either '") +
                     (options.given_section("sheet") ? "sheet" : "floe") +
                     "' or 'lattice_file', this one has both");
  if (!scene.has_sheet && !has_file)
    throw InputError("sheet: a scene needs either 'sheet' or 'lattice_file', this one has neither");
  if (scene.has_sheet) {
    read_sheet(options, scene);
    read_ice(options, scene);
  } else {
    scene.lattice_file = options.text("lattice_file");
    scene.inputs.emplace_back("lattice_file", scene.lattice_file);
    constexpr auto said_by_file = "would have no effect: 'lattice_file' says it";
    for (const auto* key : {"ice", "beam: shear_factor", "beam: torsion", "beam: calibrate"})
      options.refuse(key, said_by_file);
    options.refuse("limit: memory", "would have no effect: only a sheet is judged by it");
    for (const auto* key : {"fracture: calibrate", "fracture: flexural_strength"})
      options.refuse(key, "needs 'sheet': a lattice file says nothing of a sheet's section");
  }
}

void read_bonds(Options& options, Scene& scene) {
  Bonds& bonds = scene.bonds;
  bonds.given = options.given_section("bonds");
  if (!bonds.given) return;
  if (!scene.forces.beam) {
    options.refuse("bonds", "would have no effect: 'forces' does not name beam, which bonds are");
    bonds.given = false;
    return;
  }
  bonds.gap = options.number("bonds: gap");
  bonds.in_box = options.given("bonds: box");
  if (bonds.in_box) {
    bonds.box = options.numbers<6>("bonds: box");
    for (const std::size_t k : {0U, 2U, 4U}) {
      if (bonds.box[k] > bonds.box[k + 1])
        throw InputError(
            "bonds: box: must be x0, x1, y0, y1, z0, z1 with x0 <= x1, y0 <= y1, "
            "z0 <= z1 [m]");
    }
  }
  bonds.young = scene.has_sheet ? options.number("bonds: young", {}, scene.ice.young)
                                : options.number("bonds: young");
  if (scene.forces.fracture) {
    bonds.strength = options.number("bonds: strength");
    bonds.energy = options.number("bonds: energy");
    return;
  }
  for (const auto* key : {"bonds: strength", "bonds: energy"})
    options.refuse(key, "would have no effect: 'forces' does not name fracture");
}

void read_regions_and_cuts(Options& options, Scene& scene) {
  for (const std::string& name : options.names("region")) {
    Region region{name, options.numbers<6>("region: NAME: box", name)};
    if (scene.sheet.periodic)
      options.refuse_one(
          "region: NAME: edge", name,
          "does not go with 'sheet: periodic': its ends are the sets left and right");
    else if (scene.has_sheet)
      region.edge = options.flag("region: NAME: edge", name);
    else
      options.refuse_one("region: NAME: edge", name, "needs 'sheet': a lattice file has no edges");
    const auto& box = region.box;
    if (box[0] > box[1] || box[2] > box[3] || box[4] > box[5])
      throw InputError("region: " + name +
                       ": box: must be x0, x1, y0, y1, z0, z1 with x0 <= x1, "
                       "y0 <= y1, z0 <= z1 [m]");
    const auto last = scene.has_sheet ? sheet_sets.begin() : sheet_sets.end() - 1;
    if (std::find(last, sheet_sets.end(), name) != sheet_sets.end())
      throw InputError("region: names: '" + name + "' is the name of a set that there is already");
    for (const Floe& floe : scene.floes)
      if (floe.name == name)
        throw InputError("region: names: '" + name + "' is the name of a floe");
    scene.regions.push_back(region);
  }
  const bool sheet_changed =
      options.section_on_command_line("sheet") || options.on_command_line("lattice_file");
  for (const std::string& name : options.names("cut")) {
    Cut cut{.name = name,
            .from = options.numbers<2>("cut: NAME: from", name),
            .to = options.numbers<2>("cut: NAME: to", name)};
    cut.may_miss = sheet_changed && !options.on_command_line("cut: NAME: from", name) &&
                   !options.on_command_line("cut: NAME: to", name);
    if (cut.from == cut.to) throw InputError("cut: " + name + ": from and to are the same point");
    scene.cuts.push_back(cut);
  }
  if (scene.sheet.periodic && !scene.cuts.empty())
    throw InputError("cut: " + scene.cuts[0].name +
                     ": does not go with 'sheet: periodic': a cut ends at the sheet's sides");
  if (scene.cuts.empty())
    options.refuse("sheet: fit_cuts", "would have no effect: the scene has no 'cut'");
  else if (scene.has_sheet)
    scene.fit_cuts = options.flag("sheet: fit_cuts");
}

}  // namespace floe
