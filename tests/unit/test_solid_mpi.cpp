// Convex parts of solids on several ranks: all have those that rank 0 finds.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/collectives.h"
#include "floe/base/petsc.h"
#include "solid/parts_file.h"
#include "support/solids.h"

namespace floe::test {
namespace {

TEST(SolidRanks, HaveTheSameParts) {
  setenv("XDG_CACHE_HOME", std::filesystem::absolute("cache").c_str(), 1);
  if (rank() == 0) write_obj(l_shape(), "l.obj");
  for (int k = 0; k < 2; ++k) {  // found, and taken from where they are kept
    const ConvexParts parts = parts_of({"l.obj", 1, 0, 10}, "file", PETSC_COMM_WORLD);
    EXPECT_EQ(parts.shapes.bodies(), 2);
    EXPECT_EQ(parts.triangles, 20);
    EXPECT_NEAR(parts.parts_volume, 6, 1e-12);
    EXPECT_NEAR(
        volume_properties(parts.shapes, 0).volume + volume_properties(parts.shapes, 1).volume, 6,
        1e-12);
    EXPECT_FALSE(open_edge(parts.shapes, 1));
  }
  if (rank() == 0) {
    EXPECT_TRUE(std::filesystem::exists("cache/floe"));
  }
  EXPECT_THROW(parts_of({"l.obj", 1, 0, 1}, "file", PETSC_COMM_WORLD), InputError);
}

}  // namespace
}  // namespace floe::test
