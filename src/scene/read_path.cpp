// Reading of the section `static`: load steps, or a path with the load factor as an unknown.
#include <algorithm>
#include <array>
#include <utility>

#include "reading.h"

namespace floe {
namespace {

enum class Control { load, arc };

/// Lets a ramp go on past its ends, as the load factor does.
/// \param label  of its key
/// \returns whether the load factor scales it
bool make_endless(Ramp& ramp, double end, const std::string& label) {
  if (ramp.seconds != 0 && ramp.seconds != end)
    throw InputError(label + ": " + text_of(ramp.seconds) + " must be time: end " + text_of(end) +
                     ", by which the load factor scales it, or 0, by which it acts fully: "
                     "'static: path' is arc");
  ramp.endless = true;
  return ramp.seconds > 0;
}

/// Makes loads and motions linear in the load factor, time over time: end.
void make_linear(Scene& scene) {
  bool any = false;
  for (const SceneTable& table : scene.tables)
    throw InputError(table.key +
                     ": does not go with 'static: path' arc, which scales loads and "
                     "motions by a factor");
  for (Load& load : scene.loads)
    any = make_endless(load.ramp, scene.time.end, "load: " + load.name + ": ramp") || any;
  constexpr Point3 nothing{};
  for (Boundary& b : scene.boundaries) {
    const std::string label = "boundary: " + b.name + ": ramp";
    const bool moves = (b.velocity && *b.velocity != nothing) || b.angular_velocity != nothing;
    if (moves && b.ramp.seconds > 0)
      throw InputError(label + ": " + text_of(b.ramp.seconds) +
                       " must be 0 with a velocity, which is scaled by the load factor without a "
                       "ramp: 'static: path' is arc");
    if (moves || !b.displacement) {
      b.ramp.endless = true;
      any = any || moves;
      continue;
    }
    const bool scaled = make_endless(b.ramp, scene.time.end, label);
    any = any || (scaled && *b.displacement != nothing);
  }
  if (!any)
    throw InputError(
        "static: path: arc has no load to scale: give a load or a displacement the "
        "ramp time: end " +
        text_of(scene.time.end) + ", or a boundary a velocity");
}

void read_monitor(Options& options, Scene& scene) {
  auto& path = scene.path_control;
  if (!options.given("static: monitor")) {
    for (const auto* key : {"static: monitor_component", "static: monitor_displacement"})
      options.refuse(key, "would have no effect without 'static: monitor'");
    return;
  }
  path.monitor = options.text("static: monitor");
  const auto is_it = [&](const auto& part) { return part.name == path.monitor; };
  const bool load = std::any_of(scene.loads.begin(), scene.loads.end(), is_it);
  const bool boundary = std::any_of(scene.boundaries.begin(), scene.boundaries.end(), is_it);
  if (!load && !boundary)
    throw InputError("static: monitor: '" + path.monitor +
                     "' is neither in 'load: names' nor in 'boundary: names'");
  if (load && boundary)
    throw InputError("static: monitor: '" + path.monitor +
                     "' is both in 'load: names' and in 'boundary: names'");
  enum class Component { x, y, z };
  path.component = static_cast<int>(options.choice<Component>("static: monitor_component"));
  path.displacement = options.number("static: monitor_displacement");
}

}  // namespace

void read_path_choice(Options& options, Scene& scene) {
  if (scene.integrator == Integrator::quasistatic)
    scene.path_control.arc = options.choice<Control>("static: path") == Control::arc;
}

void read_path_control(Options& options, Scene& scene) {
  auto& path = scene.path_control;
  if (scene.integrator != Integrator::quasistatic) {
    options.refuse("static", "would have no effect: 'integrator' is not quasistatic");
    return;
  }
  if (!path.arc) {
    constexpr std::array keys{"static: load_factor",
                              "static: steps",
                              "static: arc_length",
                              "static: arc_length_min",
                              "static: arc_length_max",
                              "static: monitor",
                              "static: monitor_component",
                              "static: monitor_displacement",
                              "static: growth"};
    for (const auto* key : keys)
      options.refuse(key, "would have no effect: 'static: path' is load");
    return;
  }
  make_linear(scene);
  path.steps = options.integer("static: steps");
  for (const auto& [key, value] : {std::pair("static: arc_length", &path.arc_length),
                                   std::pair("static: arc_length_min", &path.arc_length_min),
                                   std::pair("static: arc_length_max", &path.arc_length_max)})
    if (options.given(key)) *value = options.number(key);
  const double first = path.arc_length, least = path.arc_length_min, most = path.arc_length_max;
  if (most > 0 && std::max(first, least) > most)
    throw InputError("static: arc_length_max: " + text_of(most) + " must be >= " +
                     (first > most ? "static: arc_length " : "static: arc_length_min ") +
                     text_of(std::max(first, least)) + " [m]");
  if (first > 0 && least > first)
    throw InputError("static: arc_length_min: " + text_of(least) +
                     " must be <= static: arc_length " + text_of(first) + " [m]");
  read_monitor(options, scene);
  if (path.monitor.empty() || options.given("static: load_factor"))
    path.load_factor = options.number("static: load_factor", {}, 1.0);
  if (scene.forces.fracture) {
    path.growth = options.number("static: growth");
  } else {
    options.refuse("static: growth", "would have no effect without 'forces: fracture'");
  }
}

}  // namespace floe
