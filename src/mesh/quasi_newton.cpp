// L-BFGS on the CVT energy F(z) = sum of int |x - z_k|^2 dA over the cells. The gradient is 2 m_k
// (z_k - c_k), m = area, c = centroid (Du et al. 1999; F is twice differentiable: Liu et al. 2009).
// The solver is PETSc's BLMVM with the plan as bounds. Every rank runs the same solver on its own
// copy of the unknowns; only the work on the cells is shared by the ranks.
#include <petsctao.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <utility>

#include "mesh/relaxation.h"

namespace floe::mesh {
namespace {

/// Units of the solver: lengths in l, energies in l^2 times half the mean cell area. A unit step
/// along the negative gradient (m / mean m)(z - c) is then about one Lloyd move, which is always
/// safe.
struct Problem {
  Voronoi& voronoi;
  double l, mean_area, tolerance;
  int limit;
  const OnIteration& on_iteration;
  PetscInt iterations = 0;
  int evaluations = 0;
  std::exception_ptr failure;
};

struct Solver {
  Tao tao = nullptr;
  Solver() { check(TaoCreate(PETSC_COMM_SELF, &tao)); }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  ~Solver() { (void)TaoDestroy(&tao); }
};

/// Separates coincident generators, which have no cells of their own. A long trial step may move
/// several generators to one place (a corner of the plan, for example). F is continuous there: a
/// step of 1e-3 l away from each other changes F little, and the line search goes on.
void separate(std::vector<Point2>& points, double l) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(points[a], a) < std::pair(points[b], b);
  });
  const std::vector<Point2> old = points;
  int same = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Point2& p = old[order[k]];
    same = p == old[order[k - 1]] ? same + 1 : 0;
    // Towards the centre of the plan, which is convex, each by a different distance.
    const double shrink = same * 1e-3 * l / std::max(l, std::abs(p[0]) + std::abs(p[1]));
    for (double& x : points[order[k]]) x -= shrink * x;
  }
}

void set_generators(Problem& problem, Vec x) {
  const double* value = nullptr;
  check(VecGetArrayRead(x, &value));
  std::vector<Point2> points(problem.voronoi.generators().size());
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k] = {value[2 * k] * problem.l, value[2 * k + 1] * problem.l};
  check(VecRestoreArrayRead(x, &value));
  try {
    problem.voronoi.move(points);
  } catch (const InputError&) {
    separate(points, problem.l);
    problem.voronoi.move(points);
  }
}

double evaluate(Problem& problem, Vec x, Vec gradient) {
  set_generators(problem, x);
  const double scale = 1 / (problem.mean_area * problem.l);
  const auto& cells = problem.voronoi.cells();
  double* g = nullptr;
  double energy = 0;
  check(VecGetArrayWrite(gradient, &g));
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Point2 &z = problem.voronoi.generators()[k], &c = cells[k].centroid;
    for (int i = 0; i < 2; ++i) g[2 * k + i] = scale * cells[k].area * (z[i] - c[i]);
    energy += cells[k].energy;
  }
  check(VecRestoreArrayWrite(gradient, &g));
  // Relative to the energy of as many hexagons, its lower bound, because BLMVM takes its first step
  // as if the minimum were 0.
  const double hexagons = 5 / (18 * std::numbers::sqrt3) * problem.mean_area * problem.mean_area *
                          static_cast<double>(cells.size());
  return (energy - hexagons) / (2 * problem.mean_area * problem.l * problem.l);
}

PetscErrorCode objective(Tao, Vec x, double* f, Vec gradient, void* context) noexcept {
  auto& problem = *static_cast<Problem*>(context);
  try {
    ++problem.evaluations;
    *f = evaluate(problem, x, gradient);
    return 0;
  } catch (...) {  // an exception must not pass through PETSc's C code
    problem.failure = std::current_exception();
    return PETSC_ERR_USER;
  }
}

/// PETSc calls this function after every accepted step; the cells are those of the last evaluation.
PetscErrorCode test_move(Tao tao, void* context) noexcept {
  auto& problem = *static_cast<Problem*>(context);
  try {
    const double move = largest_move(problem.voronoi) / problem.l;
    PetscInt iteration = 0;
    check(TaoGetIterationNumber(tao, &iteration));
    if (iteration > problem.iterations) {
      problem.iterations = iteration;
      if (problem.on_iteration) problem.on_iteration(problem.evaluations, move);
    }
    if (problem.evaluations >= problem.limit)
      return TaoSetConvergedReason(tao, TAO_DIVERGED_MAXFCN);
    // Nearer than 1e-12 l to a minimum, differences of F are rounding, and a line search fails.
    if (move <= std::max(problem.tolerance, 1e-12))
      return TaoSetConvergedReason(tao, TAO_CONVERGED_USER);
    return TaoDefaultConvergenceTest(tao, nullptr);
  } catch (...) {
    problem.failure = std::current_exception();
    return PETSC_ERR_USER;
  }
}

Handle<Vec> plan_vector(std::size_t n) {
  Handle<Vec> x;
  check(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(2 * n), x.put()));
  return x;
}

Handle<Vec> corner_vector(std::size_t n, double x, double y) {
  Handle<Vec> v = plan_vector(n);
  double* value = nullptr;
  check(VecGetArrayWrite(v, &value));
  for (std::size_t k = 0; k < n; ++k) value[2 * k] = x, value[2 * k + 1] = y;
  check(VecRestoreArrayWrite(v, &value));
  return v;
}

}  // namespace

int quasi_newton(Voronoi& voronoi, const SheetPlan& plan, const OnIteration& on_iteration) {
  if (plan.iterations < 1) return 0;
  const auto n = voronoi.generators().size();
  const double l = plan.element_size;
  Problem problem{voronoi,
                  l,
                  plan.length * plan.width / static_cast<double>(n),
                  plan.tolerance,
                  plan.iterations,
                  on_iteration,
                  0,
                  0,
                  nullptr};
  const Handle<Vec> x = plan_vector(n);
  const Handle<Vec> low = corner_vector(n, -plan.length / (2 * l), -plan.width / (2 * l));
  const Handle<Vec> high = corner_vector(n, plan.length / (2 * l), plan.width / (2 * l));
  double* value = nullptr;
  check(VecGetArrayWrite(x, &value));
  for (std::size_t k = 0; k < n; ++k)
    for (int i = 0; i < 2; ++i) value[2 * k + i] = voronoi.generators()[k][i] / l;
  check(VecRestoreArrayWrite(x, &value));

  Solver solver;
  check(TaoSetType(solver.tao, TAOBLMVM));
  check(TaoSetSolution(solver.tao, x));
  check(TaoSetVariableBounds(solver.tao, low, high));
  check(TaoSetObjectiveAndGradient(solver.tao, nullptr, objective, &problem));
  check(TaoSetTolerances(solver.tao, 0, 0, 0));
  check(TaoSetMaximumIterations(solver.tao, plan.iterations));
  check(TaoSetConvergenceTest(solver.tao, test_move, &problem));
  check(TaoSetOptionsPrefix(solver.tao, "mesh_"));
  check(TaoSetFromOptions(solver.tao));
  const int ierr = TaoSolve(solver.tao);
  if (problem.failure) std::rethrow_exception(problem.failure);
  check(ierr);
  set_generators(problem, x);  // the last evaluation may belong to a rejected trial
  return problem.evaluations;
}

}  // namespace floe::mesh
