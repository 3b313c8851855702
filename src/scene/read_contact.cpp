// Reading of contacts and obstacles.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "contact_laws/restitution.h"
#include "floe/base/petsc.h"
#include "floe/solid/solid_file.h"
#include "reading.h"
#include "solid/parts_file.h"

namespace floe {
namespace {

/// Whether a file's name is that of a surface of triangles.
bool is_surface(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".stl" || ending == ".obj";
}

/// Reads a solid from a file of triangles, in convex parts.
Obstacle read_solid(Options& options, const std::string& name, const std::string& file,
                    Scene& scene) {
  const auto key = [](const char* last) { return "obstacle: NAME: " + std::string(last); };
  const SolidFile solid{.path = file,
                        .unit = options.number(key("unit"), name),
                        .tolerance = options.number(key("tolerance"), name),
                        .most_parts = static_cast<int>(options.integer(key("most_parts"), name))};
  const ConvexParts parts = parts_of(solid, "obstacle: " + name + ": file", PETSC_COMM_WORLD);
  const auto number = parts.shapes.bodies();
  scene.remarks.push_back("obstacle: " + name + ": " + std::to_string(parts.triangles) +
                          " triangles around " + text_of(parts.volume) + " m^3 are " +
                          std::to_string(number) + " convex part" + (number == 1 ? "" : "s") +
                          " of " + text_of(parts.parts_volume) + " m^3, at most " +
                          text_of(parts.distance) + " m from its surface");
  return polyhedra(parts.shapes, options.vector(key("point"), name));
}

Obstacle read_shape(Options& options, const std::string& name, Scene& scene) {
  enum class Shape { halfspace, box, cone, cylinder, file };
  const auto of = [&](const char* key) {
    return options.vector("obstacle: NAME: " + std::string(key), name);
  };
  const auto shape = options.choice<Shape>("obstacle: NAME: shape", name);
  if (shape == Shape::halfspace) {
    const Vec3<double> point = of("point"), normal = of("normal");
    const double length2 = dot(normal, normal);
    if (!(length2 > 0 && std::isfinite(length2)))
      throw InputError("obstacle: " + name + ": normal: " + text_of(normal.x) + " " +
                       text_of(normal.y) + " " + text_of(normal.z) + " is no direction");
    return half_space(point, normal);
  }
  if (shape == Shape::box) {
    const Vec3<double> centre = of("centre"), size = of("size"), rotation = of("rotation");
    return box(centre, size, rotation);
  }
  if (shape == Shape::file) {
    const std::string file = options.text("obstacle: NAME: file", name);
    scene.inputs.emplace_back("obstacle: " + name + ": file", file);
    if (is_surface(file)) return read_solid(options, name, file, scene);
    return polyhedra(read_polyhedra(file, "obstacle: " + name + ": file"), of("point"));
  }
  const Vec3<double> base = of("base");
  const double radius = options.number("obstacle: NAME: radius", name),
               height = options.number("obstacle: NAME: height", name);
  const double top =
      shape == Shape::cone ? options.number("obstacle: NAME: top_radius", name) : radius;
  const std::int64_t facets = options.integer("obstacle: NAME: facets", name);
  return cone(base, radius, top, height, static_cast<int>(facets));
}

ObstacleMotion read_motion(Options& options, Scene& scene, const std::string& name,
                           bool half_space) {
  const auto given = [&](const char* key) {
    return options.given("obstacle: NAME: " + std::string(key), name);
  };
  ObstacleMotion motion;
  motion.table = read_motion_table(
      options, scene, "obstacle: NAME: table",
      {"obstacle: NAME: velocity", "obstacle: NAME: angular_velocity", "obstacle: NAME: amplitude",
       "obstacle: NAME: frequency", "obstacle: NAME: ramp"},
      half_space ? TableRotations::none : TableRotations::vector, name);
  if (!motion.table.empty()) {
    require_start(motion.table, "obstacle: " + name + ": table");
    return motion;
  }
  motion.velocity = options.vector("obstacle: NAME: velocity", name);
  if (half_space)
    options.refuse_one("obstacle: NAME: angular_velocity", name,
                       "a halfspace cannot turn; box, cone, cylinder and file can");
  if (!half_space)
    motion.angular_velocity = options.vector("obstacle: NAME: angular_velocity", name);
  if (given("amplitude") != given("frequency"))
    throw InputError("obstacle: " + name +
                     (given("amplitude") ? ": amplitude [m] needs frequency [Hz]"
                                         : ": frequency [Hz] needs amplitude [m]"));
  if (given("amplitude")) {
    motion.amplitude = options.vector("obstacle: NAME: amplitude", name);
    motion.frequency = options.number("obstacle: NAME: frequency", name);
  }
  // Without a motion the key is not read, and so it is refused.
  if (!motion.at_rest()) motion.ramp.seconds = options.number("obstacle: NAME: ramp", name);
  return motion;
}

/// Joins a part to its obstacle. \param obstacles  those that are parts of no other
void join_part(Options& options, const Obstacle& part, const std::string& whole,
               std::vector<Obstacle>& obstacles) {
  const std::string key = "obstacle: " + part.name + ": part_of: ";
  const auto found = std::find_if(obstacles.begin(), obstacles.end(),
                                  [&](const Obstacle& o) { return o.name == whole; });
  if (found == obstacles.end()) {
    std::string names;
    for (const Obstacle& o : obstacles) names += (names.empty() ? "" : ", ") + o.name;
    throw InputError(key + "there is no obstacle '" + whole + "' of its own" +
                     (names.empty() ? "" : " (there are " + names + ")"));
  }
  if (part.is_half_space() || found->is_half_space())
    throw InputError(key + "a halfspace has no parts and is none");
  for (const auto* last : {"friction", "friction_wet", "velocity", "angular_velocity", "amplitude",
                           "table", "frequency", "ramp", "mass"})
    options.refuse_one("obstacle: NAME: " + std::string(last), part.name,
                       "belongs to '" + whole + "', of which it is a part");
  add_parts(*found, part);
}

/// Refuses parts that overlap.
void check_parts(const Obstacle& obstacle, const std::vector<std::string>& names_of_parts) {
  const auto met = overlap_of_parts(obstacle);
  if (!met) return;
  const auto name = [&](std::int32_t part) {
    return names_of_parts[static_cast<std::size_t>(part)];
  };
  const std::string one = name(met->one), other = name(met->other);
  throw InputError("obstacle: " + obstacle.name + ": " +
                   (one == other ? "parts of '" + one + "' overlap by "
                                 : "its parts '" + one + "' and '" + other + "' overlap by ") +
                   text_of(met->volume) + " m^3; parts may meet at faces, not overlap");
}

void read_plastic_limit(Options& options, ContactOptions& contact) {
  PlasticLimit& limit = contact.plastic_limit;
  limit.pressure = options.number("contact: plastic_limit");
  limit.exponent = options.number("contact: plastic_exponent");
  // Where a key has no effect it is not read, and so it is refused.
  if (limit.exponent != 0) {
    limit.area = options.number("contact: plastic_area");
    limit.least = options.number("contact: plastic_least");
    if (options.given("contact: plastic_most"))
      limit.most = options.number("contact: plastic_most");
    if (limit.least > limit.most)
      throw InputError("contact: plastic_least: " + text_of(limit.least) +
                       " must be <= " + text_of(limit.most) + " [Pa], the plastic_most");
  }
  limit.fast = options.number("contact: plastic_fast");
  if (limit.fast != 1) limit.speed = options.number("contact: plastic_speed");
  contact.wear = options.flag("contact: wear");
}

}  // namespace

void read_contact(Options& options, Scene& scene) {
  ContactOptions& contact = scene.contact;
  contact.law = options.choice<ContactLaw>("contact: law");
  if (!scene.has_sheet && !options.given("contact: young"))
    throw InputError("contact: young: is required with lattice_file [Pa]");
  contact.young = options.number("contact: young", {}, scene.ice.young);
  if (options.given("contact: young_broken"))
    contact.young_broken = options.number("contact: young_broken");
  contact.friction = options.number("contact: friction");
  if (options.given("contact: friction_wet"))
    contact.friction_wet = options.number("contact: friction_wet");
  if (options.given("contact: plastic_limit")) read_plastic_limit(options, contact);
  contact.initial_overlap = options.choice<InitialOverlap>("contact: initial_overlap");
  contact.damping_ratio = damping_ratio_of(options.number("contact: restitution"));
  struct Joining {
    Obstacle part;
    std::string whole;
  };
  std::vector<Joining> joining;
  std::map<std::string, std::vector<std::string>> names_of_parts;  // per obstacle
  for (const std::string& name : options.names("obstacle")) {
    Obstacle obstacle = read_shape(options, name, scene);
    obstacle.name = name;
    if (options.given("obstacle: NAME: part_of", name)) {
      refuse_structure(options, name);
      joining.push_back({std::move(obstacle), options.text("obstacle: NAME: part_of", name)});
      continue;
    }
    names_of_parts[name].assign(obstacle.parts.size(), name);
    obstacle.friction = options.number("obstacle: NAME: friction", name, contact.friction);
    if (options.given("obstacle: NAME: friction_wet", name)) {
      obstacle.friction_wet = options.number("obstacle: NAME: friction_wet", name);
    } else if (!options.given("obstacle: NAME: friction", name) && contact.friction_wet) {
      // Written down, since in options.yaml and checkpoints the friction is given.
      obstacle.friction_wet =
          options.number("obstacle: NAME: friction_wet", name, contact.friction_wet);
    }
    if (options.given("obstacle: NAME: mass", name)) {
      scene.structures.push_back(read_structure(options, obstacle));
      scene.structures.back().obstacle = scene.obstacles.size();
    } else {
      refuse_structure(options, name);
      obstacle.motion = read_motion(options, scene, name, obstacle.is_half_space());
    }
    scene.obstacles.push_back(std::move(obstacle));
  }
  for (const auto& [part, whole] : joining) {
    join_part(options, part, whole, scene.obstacles);
    names_of_parts[whole].insert(names_of_parts[whole].end(), part.parts.size(), part.name);
  }
  for (const Obstacle& obstacle : scene.obstacles)
    check_parts(obstacle, names_of_parts[obstacle.name]);
}

}  // namespace floe
