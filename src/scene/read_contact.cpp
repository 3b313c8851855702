// Reading of contacts and obstacles.
#include <cmath>

#include "contact_laws/restitution.h"
#include "floe/base/petsc.h"
#include "reading.h"

namespace floe {
namespace {

using Inputs = std::vector<std::pair<std::string, std::string>>;

Obstacle read_shape(Options& options, const std::string& name, Inputs& inputs) {
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
    inputs.emplace_back("obstacle: " + name + ": file", file);
    return polyhedron(read_polyhedron(file, "obstacle: " + name + ": file"), 0, of("point"));
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
  for (const std::string& name : options.names("obstacle")) {
    Obstacle obstacle = read_shape(options, name, scene.inputs);
    obstacle.name = name;
    obstacle.friction = options.number("obstacle: NAME: friction", name, contact.friction);
    if (options.given("obstacle: NAME: friction_wet", name)) {
      obstacle.friction_wet = options.number("obstacle: NAME: friction_wet", name);
    } else if (!options.given("obstacle: NAME: friction", name)) {
      obstacle.friction_wet = contact.friction_wet;
    }
    if (options.given("obstacle: NAME: mass", name)) {
      scene.structures.push_back(read_structure(options, obstacle));
      scene.structures.back().obstacle = scene.obstacles.size();
    } else {
      refuse_structure(options, name);
      obstacle.motion = read_motion(options, scene, name, obstacle.vertices.empty());
    }
    scene.obstacles.push_back(std::move(obstacle));
  }
}

}  // namespace floe
