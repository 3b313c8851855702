#include "scene_model/mesh_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/collectives.h"
#include "base/on_root.h"
#include "files/files.h"
#include "files/hdf5.h"
#include "floe/base/petsc.h"
#include "floe/geometry/polyhedron.h"
#include "floe/mesh/cuts.h"

namespace floe {
namespace {

using Entry = std::pair<const char*, double>;

/// A number that tells plans of polygons apart (FNV-1a of their bits).
std::uint64_t identity(const std::vector<PolygonPlan>& plans) {
  std::uint64_t hash = 14695981039346656037U;
  const auto add = [&hash](std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte)
      hash = (hash ^ (word >> (8 * byte) & 0xffU)) * 1099511628211U;
  };
  for (const PolygonPlan& plan : plans) {
    add(std::bit_cast<std::uint64_t>(plan.element_size)), add(plan.seed);
    add(plan.rectangle ? 1 : 0);
    if (!plan.rectangle) continue;
    const auto& [length, width, centre, axis] = *plan.rectangle;
    for (const double x : {length, width, centre[0], centre[1], axis[0], axis[1]})
      add(std::bit_cast<std::uint64_t>(x));
  }
  return hash;
}

/// Values on which a mesh depends. Numbers of 64 bits are stored in two halves, since a double
/// holds 53 bits.
std::vector<Entry> identity(const SheetPlan& plan) {
  const auto low = [](std::uint64_t x) { return static_cast<double>(x & 0xffffffffU); };
  const auto high = [](std::uint64_t x) { return static_cast<double>(x >> 32U); };
  const bool is_rectangle = plan.outline.empty();
  std::vector<Entry> entries{
      Entry{"format", is_rectangle ? 1 : 2},
      {"length", plan.length},
      {"width", plan.width},
      {"element_size", plan.element_size},
      {"seed", low(plan.seed)},
      {"seed_high", high(plan.seed)},
      {"quasi_newton", plan.relaxation == Relaxation::quasi_newton ? 1.0 : 0.0},
      {"iterations", static_cast<double>(plan.iterations)},
      {"tolerance", plan.tolerance}};
  if (!is_rectangle) {
    const std::uint64_t outline = plan.outline.identity();
    entries.push_back({"outline", low(outline)});
    entries.push_back({"outline_high", high(outline)});
  }
  if (!plan.of_polygon.empty()) {
    const std::uint64_t floes = identity(plan.of_polygon);
    entries.push_back({"floes", low(floes)});
    entries.push_back({"floes_high", high(floes)});
  }
  return entries;
}

/// The part of a relaxation that a file keeps: the generators of each rectangle, about its centre.
struct Relaxed {
  std::vector<std::vector<Point2>> generators;
  int iterations = 0;
};

/// \throws InputError if these are no generators of a rectangle
void check(const std::vector<Point2>& generators, const SheetPlan& plan, const std::string& path) {
  for (const auto& [x, y] : generators) {
    if (!(std::abs(x) <= plan.length / 2 && std::abs(y) <= plan.width / 2))
      throw InputError("sheet: mesh_file: '" + path + "' has a generator outside the sheet");
  }
  std::vector<Point2> sorted = generators;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw InputError("sheet: mesh_file: '" + path + "' has a generator twice");
}

Relaxed read(const SheetPlan& plan, const std::vector<MeshedBox>& boxes, const std::string& path) {
  const Hdf5File file = Hdf5File::open(path, "sheet: mesh_file");
  if (!file.has("generators"))
    throw InputError("sheet: mesh_file: '" + path + "' is not a mesh file (no /generators)");
  for (const auto& [name, value] : identity(plan)) {
    if (file.read_attribute("generators", name) != value)
      throw InputError("sheet: mesh_file: '" + path + "' is the mesh of another sheet (its " +
                       name + " differs); remove it or name another file");
  }
  const std::vector<double> values = file.read("generators", 2);
  std::int64_t cells = 0;
  for (const MeshedBox& box : boxes) cells += number_of_cells(box.plan);
  if (static_cast<std::int64_t>(values.size() / 2) != cells)
    throw InputError("sheet: mesh_file: '" + path + "' has " + std::to_string(values.size() / 2) +
                     " generators, the sheet " + std::to_string(cells) + " cells");
  Relaxed relaxed;
  std::size_t next = 0;
  for (const MeshedBox& box : boxes) {
    std::vector<Point2>& generators = relaxed.generators.emplace_back();
    for (std::int64_t n = number_of_cells(box.plan); n > 0; --n, next += 2)
      generators.push_back({values[next], values[next + 1]});
    check(generators, box.plan, path);
  }
  const double done = file.read_attribute("generators", "iterations_done");
  if (!(done >= 0 && done <= 1e9))
    throw InputError("sheet: mesh_file: '" + path + "' has a bad number of iterations");
  relaxed.iterations = static_cast<int>(done);
  return relaxed;
}

void write(const SheetPlan& plan, const std::string& path, const Relaxed& relaxed) {
  remove_left_over(path);
  std::vector<double> values;
  for (const auto& generators : relaxed.generators)
    for (const auto& [x, y] : generators) values.push_back(x), values.push_back(y);
  Hdf5File file = Hdf5File::create(path);
  file.write("generators", std::span<const double>(values), 2);
  for (const auto& [name, value] : identity(plan)) file.attribute("generators", name, value);
  file.attribute("generators", "iterations_done", relaxed.iterations);
  file.close();
}

}  // namespace

std::vector<Tessellation> tessellate_with_file(const SheetPlan& plan, const std::string& file,
                                               MPI_Comm comm,
                                               const std::function<void(int, double)>& on_iteration,
                                               std::function<void()>& keep) {
  bool there = false;
  // Any existing entry counts, so that an unreadable file is an error and is not replaced.
  std::error_code ignored;
  if (rank(comm) == 0)
    there = std::filesystem::symlink_status(file, ignored).type() !=
            std::filesystem::file_type::not_found;
  broadcast(there, comm);
  const std::vector<MeshedBox> boxes = meshed_boxes(plan);
  Relaxed relaxed;
  if (there) {
    relaxed = read(plan, boxes, file);
  } else {
    for (Tessellation& made : tessellate(boxes, comm, on_iteration)) {
      relaxed.generators.push_back(std::move(made.generators));
      relaxed.iterations = std::max(relaxed.iterations, made.iterations);
    }
    keep = [plan, file, comm, relaxed] { on_root(comm, [&] { write(plan, file, relaxed); }); };
  }
  std::vector<Tessellation> cells;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    cells.push_back(tessellate(boxes[k].plan, std::move(relaxed.generators[k])));
    cells.back().iterations = relaxed.iterations;
  }
  return cells;
}

}  // namespace floe
