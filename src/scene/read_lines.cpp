// Reading of mooring lines.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "reading.h"
#include "scene/table_file.h"

namespace floe {
namespace {

constexpr double longest = 1e9, strongest = 1e12, stiffest = 1e15;  // [m, N, N/m], as of the keys

std::string key(const char* last) { return "line: NAME: " + std::string(last); }

TensionCurve read_curve(Options& options, const std::string& name, Scene& scene) {
  const std::string file = options.text(key("table"), name), label = "line: " + name + ": table";
  scene.inputs.emplace_back(label, file);
  std::vector<TensionCurve::Row> rows;
  std::vector<std::vector<double>> table = read_table(file, label, {"length", "tension"}, 2);
  for (const auto& row : table) {
    const auto refuse = [&](const std::string& why) {
      throw InputError(label + ": '" + file + "': row " + std::to_string(rows.size() + 1) + ": " +
                       why);
    };
    if (!(std::abs(row[0]) <= longest))
      refuse("length " + text_of(row[0]) + " must be at most " + text_of(longest) + " [m]");
    if (!(row[1] >= 0 && row[1] <= strongest))
      refuse("tension " + text_of(row[1]) + " must be >= 0, <= " + text_of(strongest) + " [N]");
    if (!rows.empty() && !(row[0] > rows.back().length))
      refuse("length " + text_of(row[0]) + " must be more than that of the row before, " +
             text_of(rows.back().length) + " [m]");
    if (!rows.empty() && row[1] < rows.back().tension)
      refuse("tension " + text_of(row[1]) + " must be no less than that of the row before, " +
             text_of(rows.back().tension) + " [N]");
    if (!rows.empty() &&
        !(row[1] - rows.back().tension <= stiffest * (row[0] - rows.back().length)))
      refuse("the tension rises by more than " + text_of(stiffest) + " N/m from the row before");
    rows.push_back({row[0], row[1]});
  }
  if (!(rows.back().tension > 0))
    throw InputError(label + ": '" + file + "' would have no effect: there is no tension");
  scene.tables.push_back({label, file, std::move(table)});
  return TensionCurve(std::move(rows));
}

/// Reads how the anchor moves.
void read_anchor(Options& options, const std::string& name, Scene& scene, MooringLine& line) {
  line.anchor_table = read_motion_table(options, scene, key("anchor_table"),
                                        {"line: NAME: anchor_velocity", "line: NAME: anchor_ramp"},
                                        TableRotations::none, name);
  if (!line.anchor_table.empty())
    return require_start(line.anchor_table, "line: " + name + ": anchor_table");
  line.anchor_velocity = options.vector(key("anchor_velocity"), name);
  // Without a motion the key is not read, and so it is refused.
  if (line.moves()) line.anchor_ramp.seconds = options.number(key("anchor_ramp"), name);
}

/// A straight line through a length and its tension.
TensionCurve straight(double length, double tension, double stiffness) {
  const double slack = length - tension / stiffness;
  return TensionCurve({{slack, 0}, {slack + 1, stiffness}});
}

void read_line(Options& options, const std::string& name, Scene& scene) {
  const auto given = [&](const char* last) { return options.given(key(last), name); };
  const std::string of = options.text(key("structure"), name);
  const auto structure =
      std::find_if(scene.structures.begin(), scene.structures.end(),
                   [&](const Structure& s) { return scene.obstacles[s.obstacle].name == of; });
  if (structure == scene.structures.end())
    throw InputError("line: " + name + ": structure: '" + of + "' is no obstacle with a mass");
  SceneLine line;
  line.structure = static_cast<std::size_t>(structure - scene.structures.begin());
  line.line.name = name;
  line.line.fairlead = options.vector(key("fairlead"), name);
  line.line.anchor = options.vector(key("anchor"), name);
  const double length = floe::length(line.line.anchor - line.line.fairlead);
  if (!(length > 0))
    throw InputError("line: " + name + ": anchor: is where the fairlead is; it must be elsewhere");
  if (given("table")) {
    options.refuse_one(key("stiffness"), name, "'table' says it");
    line.line.curve = read_curve(options, name, scene);
    if (given("pretension")) {
      const double wanted = options.number(key("pretension"), name);
      if (!(wanted > 0) || !(line.line.curve.steepest() > 0))
        throw InputError("line: " + name + ": pretension: " + text_of(wanted) +
                         " must be > 0 [N] with a table whose tension rises");
      const double at = line.line.curve.length_at(wanted);
      if (!std::isfinite(at))
        throw InputError("line: " + name + ": pretension: " + text_of(wanted) +
                         " is more than the table reaches [N]");
      line.line.curve.lengthen(length - at);
    }
  } else {
    const double tension = options.number(key("pretension"), name),
                 stiffness = options.number(key("stiffness"), name);
    if (tension > longest * stiffness)
      throw InputError("line: " + name + ": pretension: " + text_of(tension) +
                       " [N] stretches a line of stiffness " + text_of(stiffness) + " [N/m] by " +
                       text_of(tension / stiffness) + " m, must be at most " + text_of(longest));
    line.line.curve = straight(length, tension, stiffness);
  }
  line.line.damping = options.number(key("damping"), name);
  read_anchor(options, name, scene, line.line);
  scene.lines.push_back(std::move(line));
}

}  // namespace

void read_lines(Options& options, Scene& scene) {
  for (const std::string& name : options.names("line")) {
    for (const Obstacle& o : scene.obstacles)
      if (o.name == name)
        throw InputError("line: names: '" + name + "' is the name of an obstacle too");
    read_line(options, name, scene);
  }
}

}  // namespace floe
