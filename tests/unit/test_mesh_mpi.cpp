// The mesh is the same, bit for bit, on every rank and for any number of ranks.
#include <gtest/gtest.h>

#include <cstring>

#include "floe/base/petsc.h"
#include "floe/mesh/cuts.h"
#include "floe/mesh/tessellation.h"
#include "mesh/share.h"

namespace floe {
namespace {

/// FNV-1a over the bytes of everything a tessellation holds.
std::uint64_t hash(const Tessellation& t) {
  std::uint64_t h = 14695981039346656037ull;
  const auto add = [&h](const auto& value) {
    unsigned char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    for (const unsigned char b : bytes) h = (h ^ b) * 1099511628211ull;
  };
  for (const auto& [x, y] : t.generators) add(x), add(y);
  for (const auto& [x, y] : t.vertices) add(x), add(y);
  for (const auto k : t.offset) add(k);
  for (const Facet& f : t.facets) add(f.cells[0]), add(f.cells[1]), add(f.width);
  for (const auto s : t.sides) add(s);
  add(t.energy_ratio), add(t.largest_move), add(t.iterations), add(t.degenerate);
  return h;
}

/// Meshes on all ranks together and on this rank alone, and compares across all.
void expect_same_on_any_number_of_ranks(const SheetPlan& plan) {
  int calls = 0;
  const std::uint64_t together =
      hash(tessellate(plan, PETSC_COMM_WORLD, [&calls](int, double) { ++calls; }));
  const std::uint64_t alone = hash(tessellate(plan, MPI_COMM_SELF));
  EXPECT_EQ(together, alone);
  EXPECT_GT(calls, 0);
  std::vector<std::uint64_t> all(size());
  MPI_Allgather(&together, 1, MPI_UINT64_T, all.data(), 1, MPI_UINT64_T, PETSC_COMM_WORLD);
  for (const auto h : all) EXPECT_EQ(h, all[0]);
}

TEST(MeshOnRanks, Lloyd) {
  SheetPlan plan;
  plan.length = 60, plan.width = 40, plan.element_size = 1, plan.iterations = 40;
  expect_same_on_any_number_of_ranks(plan);
}

TEST(MeshOnRanks, QuasiNewton) {
  SheetPlan plan;
  plan.length = 40, plan.width = 60, plan.element_size = 1.3, plan.iterations = 60;
  plan.relaxation = Relaxation::quasi_newton;
  expect_same_on_any_number_of_ranks(plan);
}

TEST(MeshOnRanks, CellsFittedToCuts) {
  SheetPlan plan;
  plan.length = 30, plan.width = 20, plan.element_size = 1, plan.iterations = 40;
  const std::vector<CutLine> lines{{{-16, 1}, {3, 4}}, {{-4, -6}, {-2, 9}}};
  const auto fit = [&](MPI_Comm comm) {
    return hash(fit_to_cuts(plan, tessellate(plan, comm), lines, comm).cells);
  };
  EXPECT_EQ(fit(PETSC_COMM_WORLD), fit(MPI_COMM_SELF));
}

TEST(MeshOnRanks, FewerCellsThanRanks) {
  for (const double l : {4.5, 3.0, 2.0}) {
    for (const Relaxation relaxation : {Relaxation::lloyd, Relaxation::quasi_newton}) {
      SheetPlan plan;
      plan.length = plan.width = 4, plan.element_size = l, plan.iterations = 5;
      plan.relaxation = relaxation;
      expect_same_on_any_number_of_ranks(plan);
    }
  }
}

TEST(MeshOnRanks, ToleranceStopsAllAlike) {
  SheetPlan plan;
  plan.length = plan.width = 20, plan.element_size = 1, plan.iterations = 1000,
  plan.tolerance = 0.02;
  expect_same_on_any_number_of_ranks(plan);
}

TEST(Share, BlocksGatherAndConcatenate) {
  const mesh::Share share(PETSC_COMM_WORLD);
  std::vector<double> whole(11, -1);
  for (auto k = share.begin(11); k < share.end(11); ++k) whole[k] = k * k;
  share.gather(whole);
  for (int k = 0; k < 11; ++k) EXPECT_EQ(whole[k], k * k);
  std::vector<std::int32_t> list(share.rank, share.rank);  // empty on rank 0
  share.concatenate(list);
  std::vector<std::int32_t> expected;
  for (int r = 0; r < share.size; ++r) expected.insert(expected.end(), r, r);
  EXPECT_EQ(list, expected);
}

}  // namespace
}  // namespace floe
