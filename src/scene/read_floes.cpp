// Reading of floes, each with a section of its own.
#include <algorithm>
#include <cmath>

#include "options/option_values.h"
#include "reading.h"

namespace floe {
namespace {

constexpr auto size_of_floe = "floe: NAME: element_size", seed_of_floe = "floe: NAME: seed",
               thickness_of_floe = "floe: NAME: thickness";

bool all_give(const Options& options, const char* key) {
  const std::vector<std::string>& names = options.names("floe");
  return std::all_of(names.begin(), names.end(),
                     [&](const std::string& name) { return options.given(key, name); });
}

/// Refuses a key of the sheet that each floe has of its own.
void refuse_of_sheet(Options& options, const char* key) {
  options.refuse(key, std::string("would have no effect: each floe has its own"));
}

/// The corners of a rectangle.
Ring corners(const PolygonPlan::Rectangle& r) {
  const auto& [c, s] = r.axis;
  Ring ring;
  for (const Point2& half : {Point2{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const double x = half[0] * r.length / 2, y = half[1] * r.width / 2;
    ring.push_back({r.centre[0] + (c * x - s * y), r.centre[1] + (s * x + c * y)});
  }
  return ring;
}

/// The floe that has a polygon of the outline.
const Floe& floe_of(const Scene& scene, std::size_t polygon) {
  return *std::find_if(scene.floes.begin(), scene.floes.end(),
                       [&](const Floe& floe) { return polygon < floe.first + floe.polygons; });
}

/// Refuses floes that overlap by more than rounding.
void check_apart(const Scene& scene, const std::vector<RingedPolygon>& polygons) {
  const auto overlaps = find_overlaps(polygons, 1e-9 * scene.sheet.element_size, 1);
  if (overlaps.empty()) return;
  const OverlappingPolygons& pair = overlaps.front();
  const Floe &a = floe_of(scene, pair.first), &b = floe_of(scene, pair.second);
  const double tolerance = std::max(a.outline.simplify, b.outline.simplify);
  throw InputError("floe: " + a.name + " and floe: " + b.name + " overlap" + pair.place +
                   (tolerance > 0 ? ", as simplified to " + text_of(tolerance) + " m" : "") +
                   "; they may touch");
}

}  // namespace

double area_of(const Scene& scene, const Floe& floe) {
  double sum = 0;
  for (std::size_t k = floe.first; k < floe.first + floe.polygons; ++k)
    sum += Outline({scene.sheet.outline.polygons()[k]}).area();
  return sum;
}

void read_floes(Options& options, Scene& scene) {
  for (const auto* key : {"sheet: length", "sheet: width", "sheet: outline",
                          "sheet: outline_feature", "sheet: outline_scale", "sheet: outline_place",
                          "sheet: outline_turn", "sheet: outline_simplify"})
    refuse_of_sheet(options, key);
  SheetPlan& plan = scene.sheet;
  const bool own_sizes = all_give(options, size_of_floe),
             own_seeds = all_give(options, seed_of_floe);
  if (own_sizes)
    refuse_of_sheet(options, "sheet: element_size");
  else
    plan.element_size = options.number("sheet: element_size");
  if (own_seeds)
    refuse_of_sheet(options, "sheet: seed");
  else
    plan.seed = static_cast<std::uint64_t>(options.integer("sheet: seed"));
  std::vector<RingedPolygon> polygons;
  double least = HUGE_VAL;
  for (const std::string& name : options.names("floe")) {
    if (std::find(sheet_sets.begin(), sheet_sets.end(), name) != sheet_sets.end())
      throw InputError("floe: names: '" + name + "' is the name of a set that there is already");
    Floe& floe = scene.floes.emplace_back();
    floe.name = name, floe.first = polygons.size();
    const bool own_size = options.given(size_of_floe, name);
    floe.element_size = own_size ? options.number(size_of_floe, name) : plan.element_size;
    floe.seed = options.given(seed_of_floe, name)
                    ? static_cast<std::uint64_t>(options.integer(seed_of_floe, name))
                    : plan.seed;
    if (scene.forces.fracture) {
      floe.strength = options.number("floe: NAME: strength", name);
      floe.energy = options.number("floe: NAME: energy", name);
    } else {
      for (const auto* key : {"floe: NAME: strength", "floe: NAME: energy"})
        options.refuse_one(key, name, "would have no effect: 'forces' does not name fracture");
    }
    least = std::min(least, floe.element_size);
    const std::string size_key =
        own_size ? option_label(size_of_floe, name) : "sheet: element_size";
    PolygonPlan own{floe.element_size, floe.seed};
    if (options.given("floe: NAME: outline", name)) {
      for (const auto* key : {"floe: NAME: length", "floe: NAME: width"})
        options.refuse_one(key, name, "would have no effect: the floe's outline says it");
      const Outline outline = read_outline_of_floe(options, floe, size_key, scene);
      polygons.insert(polygons.end(), outline.polygons().begin(), outline.polygons().end());
    } else {
      own.rectangle = read_rectangle_of_floe(options, floe, size_key);
      polygons.push_back({corners(*own.rectangle)});
    }
    floe.polygons = polygons.size() - floe.first;
    if (options.given(thickness_of_floe, name))
      floe.thickness.assign(floe.polygons, options.number(thickness_of_floe, name));
    else if (has_thickness(floe.outline, option_label("floe: NAME: outline", name),
                           option_label(thickness_of_floe, name)))
      floe.thickness = floe.outline.thickness, floe.outline.has_thickness = true;
    plan.of_polygon.resize(polygons.size(), own);
  }
  plan.element_size = least;
  check_apart(scene, polygons);
  plan.outline = Outline(std::move(polygons));
  const auto [low, high] = plan.outline.box();
  plan.length = high[0] - low[0], plan.width = high[1] - low[1];
}

}  // namespace floe
