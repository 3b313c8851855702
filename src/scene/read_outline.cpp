// Reading of a sheet's outline: the file, its place, its simplification.

#include <cmath>
#include <numbers>

#include "floe/mesh/cuts.h"
#include "options/text_file.h"
#include "reading.h"
#include "scene/outline_file.h"

namespace floe {
namespace {

/// Scales an outline, turns it about its centroid, and moves its centroid.
Outline placed(const Outline& given, double scale, double degrees,
               const std::optional<Point2>& place) {
  const Point2 centroid = given.centroid();
  const Point2 to = place ? *place : Point2{scale * centroid[0], scale * centroid[1]};
  // Quarters of a turn are exact.
  const double quarters = std::round(degrees / 90), rest = degrees - 90 * quarters;
  const auto turn = static_cast<std::size_t>(std::fmod(std::fmod(quarters, 4) + 4, 4));
  constexpr std::array<Point2, 4> axes{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  const double c0 = std::cos(rest * std::numbers::pi / 180),
               s0 = std::sin(rest * std::numbers::pi / 180);
  const auto [cx, sx] = axes[turn];
  const double c = scale * (cx * c0 - sx * s0), s = scale * (sx * c0 + cx * s0);
  std::vector<RingedPolygon> polygons = given.polygons();
  for (RingedPolygon& polygon : polygons)
    for (Ring& ring : polygon)
      for (Point2& p : ring) {
        const double x = p[0] - centroid[0], y = p[1] - centroid[1];
        p = {to[0] + c * x - s * y, to[1] + s * x + c * y};
      }
  return Outline(std::move(polygons));
}

/// The polygons of the chosen feature, or of all. Stores which features they are of, and the
/// thickness that the file gives them.
Outline chosen(const OutlineFeatures& features, std::int64_t number, const std::string& file,
               Scene& scene) {
  std::vector<RingedPolygon> polygons;
  if (number > static_cast<std::int64_t>(features.size()))
    throw InputError("sheet: outline_feature: " + std::to_string(number) + ": '" + file + "' has " +
                     std::to_string(features.size()) + " feature" +
                     (features.size() == 1 ? "" : "s"));
  for (std::size_t k = 0; k < features.size(); ++k) {
    if (number != 0 && static_cast<std::size_t>(number) != k + 1) continue;
    const auto& of_feature = features[k].polygons;
    polygons.insert(polygons.end(), of_feature.begin(), of_feature.end());
    scene.outline.feature.resize(polygons.size(), static_cast<std::int32_t>(k + 1));
    scene.outline.thickness.resize(polygons.size(), features[k].thickness.value_or(NAN));
  }
  if (polygons.empty())
    throw InputError("sheet: outline_feature: " + std::to_string(number) + ": feature " +
                     std::to_string(number) + " of '" + file + "' has no polygon");
  return Outline(std::move(polygons));
}

/// Simplifies each polygon by the least of some tolerances with which cells can end on its edges;
/// all polygons together by half of the element size if they would overlap else.
SimplifiedOutline simplified_as_needed(const Outline& given, Scene& scene) {
  auto& source = scene.outline;
  const double l = scene.sheet.element_size;
  // Over l. A smaller one leaves corners whose cells halve the stable step of the explicit scheme.
  constexpr std::array tolerances{0.4, 0.8};
  SimplifiedOutline result;
  std::vector<RingedPolygon> polygons;
  source.simplify = 0, source.least_simplify = tolerances.back() * l;
  for (const RingedPolygon& polygon : given.polygons()) {
    SimplifiedOutline one;
    double tolerance = 0;
    for (const double t : tolerances) {
      tolerance = t * l;
      one = simplified(Outline({polygon}), tolerance);
      if (can_be_followed(one.outline.polygons().front(), scene.sheet)) break;
    }
    source.simplify = std::max(source.simplify, tolerance);
    source.least_simplify = std::min(source.least_simplify, tolerance);
    result.moved += one.moved;
    polygons.push_back(one.outline.polygons().front());
  }
  result.outline = Outline(std::move(polygons));
  if (given.polygons().size() == 1 || result.outline.flaw().empty()) return result;
  source.simplify = source.least_simplify = l / 2;
  return simplified(given, l / 2);
}

void refuse_keys_of_outline(Options& options) {
  for (const auto* key : {"sheet: outline_feature", "sheet: outline_scale", "sheet: outline_place",
                          "sheet: outline_turn", "sheet: outline_simplify"})
    options.refuse(key, "would have no effect: the scene has no 'sheet: outline'");
}

}  // namespace

bool read_outline(Options& options, Scene& scene) {
  if (!options.given("sheet: outline")) {
    refuse_keys_of_outline(options);
    return false;
  }
  for (const auto* key : {"sheet: length", "sheet: width"})
    options.refuse(key, "would have no effect: 'sheet: outline' says it");
  SheetPlan& plan = scene.sheet;
  auto& source = scene.outline;
  source.file = options.text("sheet: outline");
  scene.inputs.emplace_back("sheet: outline", source.file);
  const std::int64_t feature = options.integer("sheet: outline_feature");
  const double scale = options.number("sheet: outline_scale"),
               turn = options.number("sheet: outline_turn");
  std::optional<Point2> place;
  if (options.given("sheet: outline_place")) place = options.numbers<2>("sheet: outline_place");
  const bool has_tolerance = options.given("sheet: outline_simplify");
  if (has_tolerance) source.simplify = options.number("sheet: outline_simplify");

  constexpr std::size_t largest = 1'000'000'000;  // [B]
  const std::string text = read_text_file("sheet: outline: '" + source.file + "'", source.file,
                                          largest, PETSC_COMM_WORLD);
  const Outline given = chosen(parse_outline(text, source.file), feature, source.file, scene);
  const auto refuse = [&](const std::string& why) {
    throw InputError("sheet: outline: '" + source.file + "': " + why);
  };
  if (const std::string why = given.flaw(); !why.empty()) refuse(why);
  const Outline at_place = placed(given, scale, turn, place);
  source.corners = at_place.corners();
  source.area = at_place.area();
  const auto [least, most] = at_place.box();
  const double length = most[0] - least[0], width = most[1] - least[1];
  if (!(std::min(length, width) >= plan.element_size))
    refuse("is " + text_of(length) + " m x " + text_of(width) +
           " m, smaller than sheet: element_size: " + text_of(plan.element_size) +
           " [m]; coordinates are metres times sheet: outline_scale: " + text_of(scale));
  constexpr double farthest = 1e9;
  for (const double x : {least[0], least[1], most[0], most[1]})
    if (!(std::abs(x) <= farthest)) refuse("reaches farther than 1e+09 m from the origin");
  // Turned and rounded, corners that nearly touched may have come to lie across an edge.
  if (const std::string why = at_place.flaw(); !why.empty()) refuse(why);
  source.least_simplify = source.simplify;
  SimplifiedOutline simple =
      has_tolerance ? simplified(at_place, source.simplify) : simplified_as_needed(at_place, scene);
  source.moved = simple.moved;
  plan.outline = std::move(simple.outline);
  const auto [low, high] = plan.outline.box();
  plan.length = high[0] - low[0], plan.width = high[1] - low[1];
  return true;
}

}  // namespace floe
