#include <algorithm>
#include <numeric>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/lattice/lattice.h"
#include "lattice/permute.h"

namespace floe {
namespace {

/// Returns the reverse Cuthill-McKee order of the bodies, where bodies joined by a beam are
/// neighbours (PETSc's ordering, on one rank).
std::vector<std::int32_t> reverse_cuthill_mckee(const Lattice& lattice) {
  const PetscInt n = lattice.bodies.size();
  std::vector<PetscInt> start(static_cast<std::size_t>(n) + 1, 0);
  for (PetscInt k = 0; k < n; ++k) start[static_cast<std::size_t>(k) + 1] = 1;  // the diagonal
  for (const auto& [i, j] : lattice.beams.bodies) {
    ++start[static_cast<std::size_t>(i) + 1];
    ++start[static_cast<std::size_t>(j) + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<PetscInt> columns(static_cast<std::size_t>(start.back()));
  std::vector<PetscInt> fill(start.begin(), start.end() - 1);
  const auto put = [&](PetscInt row, PetscInt column) {
    item(columns, item(fill, row)++) = column;
  };
  for (PetscInt k = 0; k < n; ++k) put(k, k);
  for (const auto& [i, j] : lattice.beams.bodies) {
    put(i, j);
    put(j, i);
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k)
    std::sort(columns.begin() + start[k], columns.begin() + start[k + 1]);
  std::vector<PetscScalar> values(columns.size(), 1.0);
  Handle<Mat> graph;
  check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, start.data(), columns.data(),
                                  values.data(), graph.put()));
  Handle<IS> rows, same;
  check(MatGetOrdering(graph, MATORDERINGRCM, rows.put(), same.put()));
  const PetscInt* order = nullptr;
  check(ISGetIndices(rows, &order));
  std::vector<std::int32_t> result(order, order + n);
  check(ISRestoreIndices(rows, &order));
  return result;
}

}  // namespace

std::vector<std::int32_t> reorder(Lattice& lattice) {
  std::vector<std::int32_t> order = reverse_cuthill_mckee(lattice);
  std::vector<std::int32_t> renumbered(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    item(renumbered, order[k]) = static_cast<std::int32_t>(k);
  permute(lattice.bodies, order);
  lattice.shapes = pick(lattice.shapes, order);
  for (auto& [name, set] : lattice.sets) {
    for (std::int32_t& body : set) body = item(renumbered, body);
    std::sort(set.begin(), set.end());
  }

  // A beam runs from the smaller to the larger body. Reversing a beam turns axis 1, and axis 2 with
  // it, so that axis 3 = 1 x 2 (up, in a sheet) stays.
  for (std::size_t m = 0; m < lattice.beams.bodies.size(); ++m) {
    auto& [i, j] = lattice.beams.bodies[m];
    i = item(renumbered, i);
    j = item(renumbered, j);
    if (i > j) {
      std::swap(i, j);
      lattice.beams.axis_y[m] = -lattice.beams.axis_y[m];
      if (!lattice.beams.offsets.empty())
        std::swap(lattice.beams.offsets[m][0], lattice.beams.offsets[m][1]);
      if (!lattice.beams.image.empty()) lattice.beams.image[m] = -lattice.beams.image[m];
    }
  }
  std::vector<std::int32_t> beams(lattice.beams.bodies.size());
  std::iota(beams.begin(), beams.end(), 0);
  std::stable_sort(beams.begin(), beams.end(), [&](std::int32_t a, std::int32_t b) {
    return item(lattice.beams.bodies, a) < item(lattice.beams.bodies, b);
  });
  permute(lattice.beams, beams);
  return order;
}

}  // namespace floe
