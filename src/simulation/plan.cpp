#include "simulation/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "floe/base/petsc.h"
#include "scene_model/amounts.h"

namespace floe {
namespace {

using amounts::bytes, amounts::count, amounts::text;
/// Formats "1 frame", "2 frames".
std::string counted(double value, const std::string& what) {
  return count(value) + " " + what + (value == 1 ? "" : "s");
}

std::string duration(double seconds) {
  constexpr double minute = 60, hour = 60 * minute, day = 24 * hour, year = 365.25 * day;
  if (seconds < 2 * minute) return text("%.3g s", seconds);
  if (seconds < 2 * hour) return text("%.3g min", seconds / minute);
  if (seconds < 3 * day) return text("%.3g h", seconds / hour);
  if (seconds < 2 * year) return text("%.3g days", seconds / day);
  return text("%.3g years", seconds / year);
}

std::string steps_text(const Scene& scene, const RunPlan& plan) {
  const bool is_static = scene.integrator == Integrator::quasistatic;
  const std::string step = is_static ? "load step" : "step";
  if (scene.path_control.arc) return "at most " + counted(plan.end, "step") + " along the path";
  if (plan.adaptive)
    return "steps as long as their error allows, the first " + text("%.4g s", plan.dt);
  std::string line = step + text(" %.4g", plan.dt) + (is_static ? "" : " s");
  if (plan.stable_dt > 0 && std::isfinite(plan.stable_dt))
    line += text(", %.3g of the stable step, limited by the ", plan.dt / plan.stable_dt) +
            plan.limited_by;
  if (!plan.resolves.empty()) line += ", so short that it resolves " + plan.resolves;
  line += "; " + counted(plan.steps, step);
  if (plan.done > 0) line += ", " + count(plan.done) + " of them made";
  return line;
}

/// Tells of tables in time whose rows are closer than a step: an explicit step takes their values
/// at one time. Else empty.
std::string tables_text(const Scene& scene, const RunPlan& plan) {
  std::string lines;
  if (scene.integrator != Integrator::explicit_ || plan.adaptive) return lines;
  for (const SceneTable& table : scene.tables) {
    if (table.key.starts_with("line: ") && table.key.ends_with(": table")) continue;  // of tension
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < table.rows.size(); ++k)
      least = std::min(least, table.rows[k][0] - table.rows[k - 1][0]);
    if (least < plan.dt)
      lines += "plan: " + table.key + ": rows are as near as " + text("%.3g s", least) +
               ", less than a step; what they do within a step is not seen as a whole\n";
  }
  return lines;
}

}  // namespace

PlannedOutput planned_output(const Scene& scene, const RunPlan& plan, const OutputSize& size) {
  constexpr double default_rows = 200;  // of explicit and implicit runs
  const bool is_static = scene.integrator == Integrator::quasistatic;
  // Samples that fall into the same step are one; implicit steps end where a sample is due.
  const double most = plan.steps > 0 && scene.integrator != Integrator::implicit
                          ? plan.steps
                          : std::numeric_limits<double>::infinity();
  const double history = scene.output.history > 0 ? plan.end / scene.output.history
                         : is_static              ? most
                                                  : default_rows;
  const double fields = scene.output.fields > 0 ? plan.end / scene.output.fields : 0;
  PlannedOutput output;
  output.frames = 1 + std::max(1.0, std::min(std::ceil(fields), most));
  output.rows = 1 + std::max(1.0, std::min(std::ceil(history), most));
  if (scene.output.history == 0)  // every sample is a row
    output.rows = std::max(output.rows, 1 + std::min(std::ceil(history) + output.frames, most));
  // The checkpoint before the last one is kept too.
  const bool several = (plan.steps - plan.done) * plan.seconds_a_step > scene.checkpoint.every;
  const double generations = several ? 2 : 1;
  output.bytes = size.once + output.rows * size.row + output.frames * size.frame +
                 (is_static ? 0 : generations * size.checkpoint);
  return output;
}

std::string plan_text(const Scene& scene, const RunPlan& plan, const OutputSize& size,
                      double memory) {
  const PlannedOutput output = planned_output(scene, plan, size);
  const std::string disk = counted(output.rows, "row") + ", " + counted(output.frames, "frame") +
                           ", " + bytes(output.bytes) + " on disk";
  if (output.frames > scene.limit.frames)
    throw InputError("output: fields: " + text("%g", scene.output.fields) + " s would make " +
                     counted(output.frames, "frame") + " (" + bytes(output.frames * size.frame) +
                     "), at most " + count(scene.limit.frames) + " are made (limit: frames)");
  if (output.bytes > 1e9 * scene.limit.disk)
    throw InputError("output: would be about " + disk + ", at most " +
                     bytes(1e9 * scene.limit.disk) + " are taken (limit: disk)");
  std::string lines = "plan: " + steps_text(scene, plan) + "\n";
  lines += "plan: about " + disk + "; " + bytes(memory) + " of memory so far";
  if (plan.bytes > 0) lines += ", about " + bytes(memory + plan.bytes) + " with the solver's";
  if (plan.seconds_a_step > 0)
    lines += "; about " +
             (plan.steps > 0 ? duration((plan.steps - plan.done) * plan.seconds_a_step)
                             : duration(plan.seconds_a_step) + " a step") +
             " (by " + plan.measured + ")";
  return lines + "\n" + tables_text(scene, plan);
}

}  // namespace floe
