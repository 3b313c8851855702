#include "floe/mesh/tessellation.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "mesh/periodic.h"
#include "mesh/relaxation.h"
#include "mesh/voronoi.h"

namespace floe {
namespace {

/// Returns n random points, uniform in the plan. The C++ standard fixes the numbers of the engine
/// but not those of its distributions, so the upper 53 bits are converted to [0, 1) here.
std::vector<Point2> random_generators(const SheetPlan& plan, std::int64_t n) {
  std::mt19937_64 engine(plan.seed);
  const auto uniform = [&engine] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Point2> points(static_cast<std::size_t>(n));
  for (auto& [x, y] : points) {
    x = plan.length * (uniform() - 0.5);
    y = plan.width * (uniform() - 0.5);
  }
  return points;
}

}  // namespace

std::int64_t number_of_cells(const SheetPlan& plan) {
  const auto cells = [](double area, double l) {
    return static_cast<std::int64_t>(std::ceil(2 * area / (std::numbers::sqrt3 * l * l)));
  };
  if (plan.of_polygon.empty()) return cells(plan.area(), plan.element_size);
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < plan.of_polygon.size(); ++k)
    sum += cells(Outline({plan.outline.polygons()[k]}).area(), plan.of_polygon[k].element_size);
  return sum;
}

Tessellation tessellate(const SheetPlan& plan, MPI_Comm comm,
                        const std::function<void(int, double)>& on_iteration) {
  constexpr std::int64_t most = 100'000'000;  // half-edges are numbered with 32 bits
  const std::int64_t n = number_of_cells(plan);
  if (n > most)
    throw InputError("sheet_element_size: makes " + std::to_string(n) + " cells, allowed are " +
                     std::to_string(most));
  // Numbered along a space-filling curve once; generators stay near their start during relaxation.
  std::vector<Point2> points = random_generators(plan, n);
  points = mesh::permuted(points, mesh::hilbert_order(points, plan.length, plan.width));
  mesh::Voronoi voronoi(plan, std::move(points), mesh::Share(comm));
  const int iterations = plan.relaxation == Relaxation::lloyd
                             ? mesh::lloyd(voronoi, plan, on_iteration)
                             : mesh::quasi_newton(voronoi, plan, on_iteration);
  std::vector<std::int32_t> number(static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < number.size(); ++k) number[k] = static_cast<std::int32_t>(k);
  Tessellation result = voronoi.finish(number);
  if (plan.periodic) {
    points = std::move(result.generators);
    mesh::relax_across(plan, points, comm);
    result = tessellate(plan, std::move(points));
  }
  result.iterations = iterations;
  return result;
}

Tessellation tessellate(const SheetPlan& plan, std::vector<std::array<double, 2>> generators) {
  if (plan.periodic) return mesh::tessellate_periodic(plan, generators);
  for (const auto& [x, y] : generators)
    if (!(std::abs(x) <= plan.length / 2 && std::abs(y) <= plan.width / 2))
      throw InputError("sheet: a generator of the mesh lies outside the plan");
  const auto order = mesh::hilbert_order(generators, plan.length, plan.width);
  return mesh::Voronoi(plan, mesh::permuted(generators, order), mesh::Share()).finish(order);
}

}  // namespace floe
