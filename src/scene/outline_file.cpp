#include "scene/outline_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>
#include <utility>

#include "floe/base/petsc.h"
#include "options/option_values.h"

namespace floe {
namespace {

using Json = nlohmann::json;
using Position = std::array<double, 2>;

constexpr std::size_t most_corners = 2'000'000;

class Reader {
 public:
  Reader(const std::string& file, const std::string& key) : file_(file), key_(key) {}

  OutlineFeatures json(const std::string& text);
  OutlineFeatures table(const std::string& text);

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(key_ + ": '" + file_ + "': " + why);
  }
  const Json& member(const Json& object, const char* name, const std::string& where) const;
  std::string type_of(const Json& object, const std::string& where) const;
  void add_geometry(const Json& geometry, const std::string& where, int depth,
                    std::vector<RingedPolygon>& polygons);
  RingedPolygon polygon(const Json& rings, const std::string& where);
  Ring ring(const Json& positions, const std::string& where);
  void count() {
    if (++corners_ > most_corners)
      refuse("has more than " + std::to_string(most_corners) + " corners");
  }

  const std::string &file_, &key_;
  std::size_t corners_ = 0;
};

const Json& Reader::member(const Json& object, const char* name, const std::string& where) const {
  if (!object.is_object()) refuse(where + " is no GeoJSON object");
  const auto found = object.find(name);
  if (found == object.end()) refuse(where + " has no \"" + name + "\"");
  return *found;
}

std::string Reader::type_of(const Json& object, const std::string& where) const {
  const Json& type = member(object, "type", where);
  if (!type.is_string()) refuse(where + ": \"type\" is no text");
  return type.get<std::string>();
}

Ring Reader::ring(const Json& positions, const std::string& where) {
  if (!positions.is_array()) refuse(where + ": a ring is a list of positions");
  Ring ring;
  for (const Json& p : positions) {
    if (!p.is_array() || p.size() < 2 || !p[0].is_number() || !p[1].is_number())
      refuse(where + ": position " + std::to_string(ring.size() + 1) + " is not [x, y]");
    ring.push_back({p[0].get<double>(), p[1].get<double>()});
    if (!std::isfinite(ring.back()[0]) || !std::isfinite(ring.back()[1]))
      refuse(where + ": position " + std::to_string(ring.size()) + " is not finite");
    count();
  }
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  return ring;
}

RingedPolygon Reader::polygon(const Json& rings, const std::string& where) {
  if (!rings.is_array() || rings.empty()) refuse(where + ": a polygon is a list of rings");
  RingedPolygon polygon;
  for (const Json& r : rings) polygon.push_back(ring(r, where));
  return polygon;
}

void Reader::add_geometry(const Json& geometry, const std::string& where, int depth,
                          std::vector<RingedPolygon>& polygons) {
  if (geometry.is_null()) return;
  const std::string type = type_of(geometry, where);
  if (type == "GeometryCollection") {
    constexpr int deepest = 20;
    if (depth == deepest) refuse(where + ": collections of geometries are nested too deep");
    const Json& all = member(geometry, "geometries", where);
    if (!all.is_array()) refuse(where + ": \"geometries\" is no list");
    for (const Json& one : all) add_geometry(one, where, depth + 1, polygons);
    return;
  }
  if (type != "Polygon" && type != "MultiPolygon")
    refuse(where + " is a " + type + "; outlines are Polygon or MultiPolygon");
  const Json& coordinates = member(geometry, "coordinates", where);
  if (type == "Polygon") {
    polygons.push_back(polygon(coordinates, where));
    return;
  }
  if (!coordinates.is_array()) refuse(where + ": \"coordinates\" is no list");
  for (const Json& one : coordinates) polygons.push_back(polygon(one, where));
}

/// The thickness among the properties of a feature.
std::optional<double> thickness_of(const Json& feature) {
  const auto properties = feature.find("properties");
  if (properties == feature.end() || !properties->is_object()) return {};
  const auto thickness = properties->find("thickness");
  if (thickness == properties->end() || !thickness->is_number()) return {};
  return thickness->get<double>();
}

OutlineFeatures Reader::json(const std::string& text) {
  Json top;
  try {
    top = Json::parse(text);
  } catch (const Json::parse_error& error) {
    refuse("is not JSON (at byte " + std::to_string(error.byte) + ")");
  } catch (const Json::exception&) {
    refuse("is not JSON (a number is too large)");
  }
  OutlineFeatures features;
  const std::string type = type_of(top, "the file");
  if (type == "FeatureCollection") {
    const Json& all = member(top, "features", "the file");
    if (!all.is_array()) refuse("\"features\" is no list");
    for (const Json& feature : all) {
      features.emplace_back();
      const std::string where = "feature " + std::to_string(features.size());
      add_geometry(member(feature, "geometry", where), where, 0, features.back().polygons);
      features.back().thickness = thickness_of(feature);
    }
  } else {
    features.emplace_back();
    const bool is_feature = type == "Feature";
    add_geometry(is_feature ? member(top, "geometry", "the feature") : top,
                 is_feature ? "the feature" : "the file", 0, features.back().polygons);
    if (is_feature) features.back().thickness = thickness_of(top);
  }
  return features;
}

/// Takes the next word of a line of a table.
std::string_view take_word(std::string_view& line) {
  constexpr std::string_view blanks = " \t\r", separators = ",; \t\r";
  const auto begin = std::min(line.find_first_not_of(blanks), line.size());
  line.remove_prefix(begin);
  const auto end = std::min(line.find_first_of(separators), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  if (!line.empty() && (line.front() == ',' || line.front() == ';')) line.remove_prefix(1);
  return word;
}

/// The rings of a table as polygons: a ring inside an odd number of others is a hole of the
/// innermost.
OutlineFeatures nested(const std::vector<Ring>& rings) {
  const std::size_t n = rings.size();
  std::vector<std::vector<std::size_t>> around(n);
  std::vector<PlanBox> boxes;
  for (const Ring& ring : rings) boxes.push_back(box_of({ring}));
  // From left to right, so that only rings that overlap in x are compared.
  std::vector<std::size_t> order(n), open;
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(boxes[a].least[0], -boxes[a].most[0]) <
           std::pair(boxes[b].least[0], -boxes[b].most[0]);
  });
  for (const std::size_t i : order) {
    std::erase_if(open, [&](std::size_t j) { return boxes[j].most[0] < boxes[i].least[0]; });
    for (const std::size_t j : open) {
      const bool within = boxes[i].most[0] <= boxes[j].most[0] &&
                          boxes[j].least[1] <= boxes[i].least[1] &&
                          boxes[i].most[1] <= boxes[j].most[1];
      if (within && contains({rings[j]}, rings[i].front())) around[i].push_back(j);
    }
    if (rings[i].size() > 2) open.push_back(i);
  }
  OutlineFeatures features;
  std::vector<std::size_t> feature(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (around[i].size() % 2 != 0) continue;
    feature[i] = features.size();
    features.push_back({.polygons = {{rings[i]}}});
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (around[i].size() % 2 == 0) continue;
    const auto inner = std::max_element(
        around[i].begin(), around[i].end(),
        [&](std::size_t a, std::size_t b) { return around[a].size() < around[b].size(); });
    // Rings that cross may seem to lie inside a hole only; such a table is refused later.
    if (around[*inner].size() % 2 == 0)
      features[feature[*inner]].polygons.front().push_back(rings[i]);
    else
      features.push_back({.polygons = {{rings[i]}}});
  }
  return features;
}

OutlineFeatures Reader::table(const std::string& text) {
  std::vector<Ring> rings(1);
  std::string_view rest = text, mark;
  bool is_first = true;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const auto end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::string where = "line " + std::to_string(number);
    line = line.substr(0, line.find('#'));
    const bool has_comment = line.size() < end;
    const std::string_view x = take_word(line), y = take_word(line), third = take_word(line);
    if (x.empty() && y.empty()) {
      if (!has_comment && !rings.back().empty()) rings.emplace_back();
      continue;
    }
    const auto px = to_number(x), py = to_number(y);
    if (std::exchange(is_first, false) && !px) continue;  // a heading
    if (!px || !py) refuse(where + ": is not x, y");
    if (!rings.back().empty() && third != mark) rings.emplace_back();
    mark = third;
    rings.back().push_back({*px, *py});
    count();
  }
  if (rings.back().empty()) rings.pop_back();
  for (Ring& ring : rings)
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  return nested(rings);
}

}  // namespace

OutlineFeatures parse_outline(const std::string& text, const std::string& file,
                              const std::string& key) {
  const auto first = text.find_first_not_of(" \t\r\n");
  const bool is_json = file.ends_with(".json") || file.ends_with(".geojson") ||
                       (first != std::string::npos && text[first] == '{');
  Reader reader(file, key);
  OutlineFeatures features = is_json ? reader.json(text) : reader.table(text);
  const bool any = std::any_of(features.begin(), features.end(),
                               [](const auto& feature) { return !feature.polygons.empty(); });
  if (!any) throw InputError(key + ": '" + file + "': has no polygon");
  return features;
}

}  // namespace floe
