// Reading of outlines, of the sheet or of floes: the file, its place, its simplification.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "floe/mesh/cuts.h"
#include "options/option_values.h"
#include "options/text_file.h"
#include "reading.h"
#include "scene/outline_file.h"

namespace floe {
namespace {

/// The keys of an outline.
struct OutlineKeys {
  std::string_view file, feature, scale, place, turn, simplify;
};
constexpr OutlineKeys of_sheet{"sheet: outline",       "sheet: outline_feature",
                               "sheet: outline_scale", "sheet: outline_place",
                               "sheet: outline_turn",  "sheet: outline_simplify"};
constexpr OutlineKeys of_floe{"floe: NAME: outline",       "floe: NAME: outline_feature",
                              "floe: NAME: outline_scale", "floe: NAME: place",
                              "floe: NAME: turn",          "floe: NAME: outline_simplify"};

/// Direction of the x axis after a turn; quarters of a turn are exact.
Point2 axis_of(double degrees) {
  const double quarters = std::round(degrees / 90), rest = degrees - 90 * quarters;
  const auto turn = static_cast<std::size_t>(std::fmod(std::fmod(quarters, 4) + 4, 4));
  constexpr std::array<Point2, 4> axes{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  const double c = std::cos(rest * std::numbers::pi / 180),
               s = std::sin(rest * std::numbers::pi / 180);
  const auto [cx, sx] = axes[turn];
  return {cx * c - sx * s, sx * c + cx * s};
}

/// Scales an outline, turns it about its centroid, and moves its centroid.
Outline placed(const Outline& given, double scale, double degrees,
               const std::optional<Point2>& place) {
  const Point2 centroid = given.centroid();
  const Point2 to = place ? *place : Point2{scale * centroid[0], scale * centroid[1]};
  const auto [cosine, sine] = axis_of(degrees);
  const double c = scale * cosine, s = scale * sine;
  std::vector<RingedPolygon> polygons = given.polygons();
  for (RingedPolygon& polygon : polygons)
    for (Ring& ring : polygon)
      for (Point2& p : ring) {
        const double x = p[0] - centroid[0], y = p[1] - centroid[1];
        p = {to[0] + c * x - s * y, to[1] + s * x + c * y};
      }
  return Outline(std::move(polygons));
}

/// Reads one outline.
class OutlineReader {
 public:
  /// \param name  of the floe; empty: the sheet
  OutlineReader(Options& options, const OutlineKeys& keys, std::string name, OutlineSource& source)
      : options_(options), keys_(keys), name_(std::move(name)), source_(source) {}

  /// \param plan  with the element size and the seed of this outline
  /// \param size_key  of this element size
  /// \return the simplified outline
  Outline read(const SheetPlan& plan, const std::string& size_key, Scene& scene);

 private:
  std::string label(std::string_view key) const { return option_label(key, name_); }
  Outline chosen(const OutlineFeatures& features, std::int64_t number);
  SimplifiedOutline simplified_as_needed(const Outline& given, const SheetPlan& plan);

  Options& options_;
  const OutlineKeys& keys_;
  std::string name_;
  OutlineSource& source_;
};

/// The polygons of the chosen feature, or of all. Stores which features they are of, and the
/// thickness that the file gives them.
Outline OutlineReader::chosen(const OutlineFeatures& features, std::int64_t number) {
  std::vector<RingedPolygon> polygons;
  const std::string where = label(keys_.feature) + ": " + std::to_string(number) + ": ";
  if (number > static_cast<std::int64_t>(features.size()))
    throw InputError(where + "'" + source_.file + "' has " + std::to_string(features.size()) +
                     " feature" + (features.size() == 1 ? "" : "s"));
  for (std::size_t k = 0; k < features.size(); ++k) {
    if (number != 0 && static_cast<std::size_t>(number) != k + 1) continue;
    const auto& of_feature = features[k].polygons;
    polygons.insert(polygons.end(), of_feature.begin(), of_feature.end());
    source_.feature.resize(polygons.size(), static_cast<std::int32_t>(k + 1));
    source_.thickness.resize(polygons.size(), features[k].thickness.value_or(NAN));
  }
  if (polygons.empty())
    throw InputError(where + "feature " + std::to_string(number) + " of '" + source_.file +
                     "' has no polygon");
  return Outline(std::move(polygons));
}

/// Whether two polygons have as many corners.
bool are_alike(const RingedPolygon& a, const RingedPolygon& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(),
                    [](const Ring& r, const Ring& s) { return r.size() == s.size(); });
}

/// The polygon whose corners lie between those of two others.
RingedPolygon between(const RingedPolygon& a, const RingedPolygon& b, double share) {
  RingedPolygon result = a;
  for (std::size_t r = 0; r < a.size(); ++r)
    for (std::size_t k = 0; k < a[r].size(); ++k)
      for (std::size_t axis = 0; axis < 2; ++axis)
        result[r][k][axis] += share * (b[r][k][axis] - a[r][k][axis]);
  return result;
}

/// Simplifies each polygon by the least of some tolerances with which cells can end on its edges.
/// Where polygons come to overlap, their corners move less far, by quarters, down to where they
/// were; if they still overlap, all are simplified together by half of the element size.
SimplifiedOutline OutlineReader::simplified_as_needed(const Outline& given, const SheetPlan& plan) {
  const double l = plan.element_size;
  // Over l. A smaller first one leaves corners whose cells shorten the stable step.
  constexpr std::array tolerances{0.5, 0.8};
  SimplifiedOutline result;
  source_.simplify = 0, source_.least_simplify = tolerances.back() * l;
  const auto simplify = [&](const RingedPolygon& polygon, Areas areas) {
    SimplifiedOutline one;
    if (is_one_cell(polygon, l)) {
      source_.least_simplify = 0;
      return SimplifiedOutline{Outline({polygon}), 0};
    }
    const auto found = [&](auto&& serves) {
      return std::find_if(tolerances.begin(), tolerances.end(), [&](double t) {
        one = simplified(Outline({polygon}), t * l, areas);
        return serves(one.outline.polygons().front(), plan) != 0;
      });
    };
    auto tolerance = found(can_be_followed);
    if (tolerance == tolerances.end()) tolerance = found(cells_in_a_row);
    if (tolerance == tolerances.end()) --tolerance;
    source_.simplify = std::max(source_.simplify, *tolerance * l);
    source_.least_simplify = std::min(source_.least_simplify, *tolerance * l);
    return one;
  };
  const std::size_t n = given.polygons().size();
  std::vector<SimplifiedOutline> kept;
  std::vector<std::optional<SimplifiedOutline>> shrunk(n);  // where corners stay where they are
  std::vector<RingedPolygon> polygons;
  std::vector<double> moved, share(n, 1.0);
  for (const RingedPolygon& polygon : given.polygons()) {
    kept.push_back(simplify(polygon, Areas::kept));
    polygons.push_back(kept.back().outline.polygons().front());
    moved.push_back(kept.back().moved);
  }
  for (bool changed = true; changed;) {
    std::set<std::size_t> near;
    for (const OverlappingPolygons& pair : find_overlaps(polygons, 0, n * n))
      near.insert({pair.first, pair.second});
    if (near.empty()) {
      result.outline = Outline(std::move(polygons));
      for (const double area : moved) result.moved += area;
      return result;
    }
    changed = false;
    for (const std::size_t k : near) {
      if (share[k] == 0) continue;
      changed = true, share[k] -= 0.25;
      if (!shrunk[k]) shrunk[k] = simplify(given.polygons()[k], Areas::changed);
      const RingedPolygon &most = kept[k].outline.polygons().front(),
                          &least = shrunk[k]->outline.polygons().front();
      if (!are_alike(most, least)) share[k] = 0;
      polygons[k] = share[k] == 0 ? least : between(least, most, share[k]);
      if (share[k] > 0 && !can_be_followed(polygons[k], plan)) share[k] = 0, polygons[k] = least;
      moved[k] = share[k] * kept[k].moved + (1 - share[k]) * shrunk[k]->moved;
    }
  }
  source_.simplify = source_.least_simplify = l / 2;
  return simplified(given, l / 2);
}

/// Length of all edges [m].
double perimeter(const Outline& outline) {
  double length = 0;
  for (const RingedPolygon& polygon : outline.polygons()) {
    for (const auto& ring : polygon) {
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const Point2 &from = ring[k], &to = ring[(k + 1) % ring.size()];
        length += std::hypot(to[0] - from[0], to[1] - from[1]);
      }
    }
  }
  return length;
}

Outline OutlineReader::read(const SheetPlan& plan, const std::string& size_key, Scene& scene) {
  source_.file = options_.text(keys_.file, name_);
  const std::string key = label(keys_.file);
  scene.inputs.emplace_back(key, source_.file);
  const std::int64_t feature = options_.integer(keys_.feature, name_);
  const double scale = options_.number(keys_.scale, name_),
               turn = options_.number(keys_.turn, name_);
  std::optional<Point2> place;
  if (options_.given(keys_.place, name_)) place = options_.numbers<2>(keys_.place, name_);
  const bool has_tolerance = options_.given(keys_.simplify, name_);
  if (has_tolerance) source_.simplify = options_.number(keys_.simplify, name_);

  constexpr std::size_t largest = 1'000'000'000;  // [B]
  const std::string text =
      read_text_file(key + ": '" + source_.file + "'", source_.file, largest, PETSC_COMM_WORLD);
  const Outline given = chosen(parse_outline(text, source_.file, key), feature);
  const auto refuse = [&](const std::string& why) {
    throw InputError(key + ": '" + source_.file + "': " + why);
  };
  if (const std::string why = given.flaw(); !why.empty()) refuse(why);
  const Outline at_place = placed(given, scale, turn, place);
  source_.corners = at_place.corners();
  source_.area = at_place.area();
  const auto [least, most] = at_place.box();
  const double length = most[0] - least[0], width = most[1] - least[1];
  if (!(std::min(length, width) >= plan.element_size))
    refuse("is " + text_of(length) + " m x " + text_of(width) + " m, smaller than " + size_key +
           ": " + text_of(plan.element_size) + " [m]; coordinates are metres times " +
           label(keys_.scale) + ": " + text_of(scale));
  constexpr double most_bodies = 1e8;
  const double l = plan.element_size;
  if (const double bodies = std::max(source_.area / (l * l), perimeter(at_place) / l);
      bodies > most_bodies)
    refuse("would make about " + text_of(bodies) + " bodies with " + size_key + ": " + text_of(l) +
           ", at most " + text_of(most_bodies) + " are possible");
  constexpr double farthest = 1e9;
  for (const double x : {least[0], least[1], most[0], most[1]})
    if (!(std::abs(x) <= farthest)) refuse("reaches farther than 1e+09 m from the origin");
  // Turned and rounded, corners that nearly touched may have come to lie across an edge.
  if (const std::string why = at_place.flaw(); !why.empty()) refuse(why);
  source_.least_simplify = source_.simplify;
  SimplifiedOutline simple =
      has_tolerance ? simplified(at_place, source_.simplify) : simplified_as_needed(at_place, plan);
  source_.moved = simple.moved;
  return std::move(simple.outline);
}

void refuse_keys_of_outline(Options& options) {
  for (const auto& key :
       {of_sheet.feature, of_sheet.scale, of_sheet.place, of_sheet.turn, of_sheet.simplify})
    options.refuse(key, "would have no effect: the scene has no 'sheet: outline'");
}

}  // namespace

bool read_outline(Options& options, Scene& scene) {
  if (!options.given(of_sheet.file)) {
    refuse_keys_of_outline(options);
    return false;
  }
  for (const auto* key : {"sheet: length", "sheet: width"})
    options.refuse(key, "would have no effect: 'sheet: outline' says it");
  SheetPlan& plan = scene.sheet;
  plan.outline =
      OutlineReader(options, of_sheet, {}, scene.outline).read(plan, "sheet: element_size", scene);
  const auto [low, high] = plan.outline.box();
  plan.length = high[0] - low[0], plan.width = high[1] - low[1];
  return true;
}

Outline read_outline_of_floe(Options& options, Floe& floe, const std::string& size_key,
                             Scene& scene) {
  SheetPlan plan;
  plan.element_size = floe.element_size, plan.seed = floe.seed;
  return OutlineReader(options, of_floe, floe.name, floe.outline).read(plan, size_key, scene);
}

PolygonPlan::Rectangle read_rectangle_of_floe(Options& options, Floe& floe,
                                              const std::string& size_key) {
  const std::string& name = floe.name;
  for (const auto& key : {of_floe.feature, of_floe.scale, of_floe.simplify})
    options.refuse_one(key, name, "would have no effect: the floe has no outline");
  PolygonPlan::Rectangle r;
  r.length = options.number("floe: NAME: length", name);
  r.width = options.number("floe: NAME: width", name, r.length);
  if (options.given(of_floe.place, name)) r.centre = options.numbers<2>(of_floe.place, name);
  r.axis = axis_of(options.number(of_floe.turn, name));
  if (const double shorter = std::min(r.length, r.width); floe.element_size > shorter)
    throw InputError(size_key + ": " + text_of(floe.element_size) + " must be <= floe: " + name +
                     (r.width < r.length ? ": width " : ": length ") + text_of(shorter) + " [m]");
  floe.outline.corners = 4, floe.outline.area = r.length * r.width;
  return r;
}

}  // namespace floe
