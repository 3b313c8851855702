// Reading of prescribed motions and loads.
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "floe/base/item.h"
#include "reading.h"

namespace floe {
namespace {

/// Refuses values of components that are not fixed, which would be ignored in silence.
void check_fixed(Options& options, const Boundary& boundary, const std::string& key, Point3& values,
                 std::size_t first) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (values[k] == 0 || boundary.fixed[first + k]) continue;
    options.refuse_part(
        "boundary: NAME: " + key, boundary.name, "boundary: " + boundary.name + ": " + key,
        text_of(values[k]) + " has no effect: '" + std::string(component_names[first + k]) +
            "' is not in 'boundary: " + boundary.name + ": fix'");
    values[k] = 0;
  }
}

Boundary read_boundary(Options& options, Scene& scene, const std::string& name) {
  Boundary boundary;
  boundary.name = name;
  boundary.set = options.text("boundary: NAME: set", name);
  for (const std::string& word : options.words("boundary: NAME: fix", name)) {
    const auto at =
        std::find(component_names.begin(), component_names.end(), word) - component_names.begin();
    item(boundary.fixed, at) = true;
  }
  if (std::none_of(boundary.fixed.begin(), boundary.fixed.end(), [](bool fixed) { return fixed; }))
    throw InputError("boundary: " + name + ": fix: is empty; nothing would be prescribed");
  MotionTable table =
      read_motion_table(options, scene, "boundary: NAME: table",
                        {"boundary: NAME: velocity", "boundary: NAME: displacement",
                         "boundary: NAME: angular_velocity", "boundary: NAME: ramp"},
                        TableRotations::components, name);
  if (!table.empty()) {
    for (std::size_t k = 0; k < boundary.fixed.size(); ++k) {
      if (table.has(k) && !boundary.fixed[k])
        throw InputError("boundary: " + name + ": table: has a column of '" +
                         std::string(component_names[k]) + "', which is not in 'boundary: " + name +
                         ": fix'");
    }
    if (scene.integrator != Integrator::quasistatic)
      require_start(table, "boundary: " + name + ": table");
    boundary.table = std::move(table);
    return boundary;
  }
  constexpr std::string_view displacement = "boundary: NAME: displacement",
                             velocity = "boundary: NAME: velocity";
  const std::string_view given =
      options.one_of(displacement, velocity, name,
                     "boundary: " + name + ": give either velocity or displacement, not both");
  if (given == displacement) {
    boundary.displacement = options.vector(displacement, name);
    check_fixed(options, boundary, "displacement", *boundary.displacement, 0);
  } else {
    boundary.velocity = given == velocity ? options.vector(velocity, name) : Point3{};
    check_fixed(options, boundary, "velocity", *boundary.velocity, 0);
  }
  boundary.angular_velocity = options.vector("boundary: NAME: angular_velocity", name);
  check_fixed(options, boundary, "angular_velocity", boundary.angular_velocity, 3);
  boundary.ramp.seconds = options.number("boundary: NAME: ramp", name);
  return boundary;
}

/// Refuses a displacement without ramp in dynamics: bodies with mass cannot jump.
void require_motion(const Scene& scene, const Boundary& boundary) {
  if (scene.integrator == Integrator::quasistatic || boundary.ramp.seconds > 0 ||
      !boundary.displacement || *boundary.displacement == Point3{})
    return;
  throw InputError("boundary: " + boundary.name +
                   ": displacement needs ramp > 0 in a run with time: at once would be a jump");
}

Load read_load(Options& options, Scene& scene, const std::string& name) {
  Load load;
  load.name = name;
  constexpr std::string_view set = "load: NAME: set", point = "load: NAME: point";
  const std::string either = "load: " + name + ": give either set or point, ";
  const std::string_view given = options.one_of(set, point, name, either + "not both");
  if (given.empty()) throw InputError(either + "neither is there");
  if (given == set) load.set = options.text(set, name);
  if (given == point) load.point = options.numbers<2>(point, name);
  constexpr double most_force = 1e18, most_moment = 1e21;
  ReadTable read = read_time_table(options, scene,
                                   {"load: NAME: table",
                                    {"load: NAME: force", "load: NAME: moment", "load: NAME: ramp"},
                                    {{"fx", "N", most_force},
                                     {"fy", "N", most_force},
                                     {"fz", "N", most_force},
                                     {"mx", "N m", most_moment},
                                     {"my", "N m", most_moment},
                                     {"mz", "N m", most_moment}}},
                                   name);
  if (!read.table.empty()) {
    load.table = std::move(read.table);
    return load;
  }
  load.force = options.vector("load: NAME: force", name);
  load.moment = options.vector("load: NAME: moment", name);
  load.ramp.seconds = options.number("load: NAME: ramp", name);
  constexpr Point3 nothing{};
  if (load.force == nothing && load.moment == nothing)
    throw InputError("load: " + name + ": force and moment are both zero; it would have no effect");
  return load;
}

}  // namespace

void read_boundaries(Options& options, Scene& scene) {
  for (const std::string& name : options.names("boundary")) {
    scene.boundaries.push_back(read_boundary(options, scene, name));
    require_motion(scene, scene.boundaries.back());
  }
}

void read_loads(Options& options, Scene& scene) {
  for (const std::string& name : options.names("load"))
    scene.loads.push_back(read_load(options, scene, name));
}

}  // namespace floe
