/// \file
/// Files of outlines: GeoJSON (RFC 7946) and tables of x, y.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "floe/mesh/outline.h"

namespace floe {

/// A feature of a file: its polygons as they are in the file.
struct OutlineFeature {
  std::vector<RingedPolygon> polygons{};
  std::optional<double> thickness{};  ///< its property "thickness", if that is a number [m]
};
using OutlineFeatures = std::vector<OutlineFeature>;

/// Reads the features of a GeoJSON text: a Polygon, MultiPolygon, GeometryCollection, Feature or
/// FeatureCollection; or those of a table with x and y in its first two columns (separated by
/// commas, semicolons or blanks), a ring ending at an empty line or where the third column changes;
/// rings inside others are holes, and each outer ring is a feature.
/// \param file  name of the file, for messages; by .json and .geojson it is GeoJSON, whatever it
/// holds
/// \param key  that names the file, for messages
/// \throws InputError with one line that says what is wrong, beginning with "KEY: 'FILE'"
OutlineFeatures parse_outline(const std::string& text, const std::string& file,
                              const std::string& key = "sheet: outline");

}  // namespace floe
