#include "scene_model/mesh_file.h"

#include <algorithm>
#include <array>
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

namespace floe {
namespace {

using Entry = std::pair<const char*, double>;

/// Values on which a mesh depends. The seed is stored in two halves, since a double holds 53 bits.
std::array<Entry, 9> identity(const SheetPlan& plan) {
  return {Entry{"format", 1},
          {"length", plan.length},
          {"width", plan.width},
          {"element_size", plan.element_size},
          {"seed", static_cast<double>(plan.seed & 0xffffffffU)},
          {"seed_high", static_cast<double>(plan.seed >> 32U)},
          {"quasi_newton", plan.relaxation == Relaxation::quasi_newton ? 1.0 : 0.0},
          {"iterations", static_cast<double>(plan.iterations)},
          {"tolerance", plan.tolerance}};
}

/// The part of a relaxation that a file keeps.
struct Relaxed {
  std::vector<Point2> generators;
  int iterations = 0;
};

Relaxed read(const SheetPlan& plan, const std::string& path) {
  const Hdf5File file = Hdf5File::open(path, "sheet: mesh_file");
  if (!file.has("generators"))
    throw InputError("sheet: mesh_file: '" + path + "' is not a mesh file (no /generators)");
  for (const auto& [name, value] : identity(plan)) {
    if (file.read_attribute("generators", name) != value)
      throw InputError("sheet: mesh_file: '" + path + "' is the mesh of another sheet (its " +
                       name + " differs); remove it or name another file");
  }
  const std::vector<double> values = file.read("generators", 2);
  Relaxed relaxed;
  for (std::size_t k = 0; k + 1 < values.size(); k += 2)
    relaxed.generators.push_back({values[k], values[k + 1]});
  for (const auto& [x, y] : relaxed.generators) {
    if (!(std::abs(x) <= plan.length / 2 && std::abs(y) <= plan.width / 2))
      throw InputError("sheet: mesh_file: '" + path + "' has a generator outside the sheet");
  }
  if (static_cast<std::int64_t>(relaxed.generators.size()) != number_of_cells(plan))
    throw InputError("sheet: mesh_file: '" + path + "' has " +
                     std::to_string(relaxed.generators.size()) + " generators, the sheet " +
                     std::to_string(number_of_cells(plan)) + " cells");
  const double done = file.read_attribute("generators", "iterations_done");
  if (!(done >= 0 && done <= 1e9))
    throw InputError("sheet: mesh_file: '" + path + "' has a bad number of iterations");
  relaxed.iterations = static_cast<int>(done);
  std::vector<Point2> sorted = relaxed.generators;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw InputError("sheet: mesh_file: '" + path + "' has a generator twice");
  return relaxed;
}

void write(const SheetPlan& plan, const std::string& path, const Relaxed& relaxed) {
  remove_left_over(path);
  Hdf5File file = Hdf5File::create(path);
  file.write("generators",
             std::span(relaxed.generators.front().data(), 2 * relaxed.generators.size()), 2);
  for (const auto& [name, value] : identity(plan)) file.attribute("generators", name, value);
  file.attribute("generators", "iterations_done", relaxed.iterations);
  file.close();
}

}  // namespace

Tessellation tessellate_with_file(const SheetPlan& plan, const std::string& file, MPI_Comm comm,
                                  const std::function<void(int, double)>& on_iteration,
                                  std::function<void()>& keep) {
  bool there = false;
  // Any existing entry counts, so that an unreadable file is an error and is not replaced.
  std::error_code ignored;
  if (rank(comm) == 0)
    there = std::filesystem::symlink_status(file, ignored).type() !=
            std::filesystem::file_type::not_found;
  broadcast(there, comm);
  Relaxed relaxed;
  if (there) {
    relaxed = read(plan, file);
  } else {
    Tessellation made = tessellate(plan, comm, on_iteration);
    relaxed = {std::move(made.generators), made.iterations};
    keep = [plan, file, comm, relaxed] { on_root(comm, [&] { write(plan, file, relaxed); }); };
  }
  Tessellation cells = tessellate(plan, std::move(relaxed.generators));
  cells.iterations = relaxed.iterations;
  return cells;
}

}  // namespace floe
