// A lattice packed for want of memory comes back to the last bit.
#include <gtest/gtest.h>

#include "lattice/packed_lattice.h"
#include "support/lattices.h"

namespace floe {
namespace {

TEST(PackedLattice, SheetsComeBackAsTheyWere) {
  Lattice lattice = test::sheet(8, 6, 1);
  const Lattice before = lattice;
  PackedLattice packed;
  packed.pack_shapes(lattice);
  packed.pack_beams(lattice);
  packed.pack_bodies(lattice, before.bodies);
  EXPECT_TRUE(lattice.shapes.empty());
  EXPECT_EQ(lattice.bodies.size(), 0);
  EXPECT_TRUE(lattice.beams.young.empty());
  EXPECT_FALSE(lattice.beams.area.empty());
  packed.unpack(lattice);
  EXPECT_EQ(lattice.shapes.vertices, before.shapes.vertices);
  EXPECT_EQ(lattice.shapes.corners, before.shapes.corners);
  EXPECT_EQ(lattice.bodies.position, before.bodies.position);
  EXPECT_EQ(lattice.bodies.inertia, before.bodies.inertia);
  EXPECT_EQ(lattice.beams.young, before.beams.young);
  EXPECT_EQ(lattice.beams.shear_modulus, before.beams.shear_modulus);
  EXPECT_EQ(lattice.beams.shear_factor, before.beams.shear_factor);
  EXPECT_EQ(lattice.beams.height, before.beams.height);
}

TEST(PackedLattice, WhatDiffersFromBeamToBeamStays) {
  Lattice lattice = test::sheet(8, 6, 1);
  lattice.beams.young.back() *= 1 + 1e-12;
  Bodies others = lattice.bodies;
  others.mass.back() *= 1 + 1e-12;
  const std::vector<double> young = lattice.beams.young;
  PackedLattice packed;
  packed.pack_beams(lattice);
  packed.pack_bodies(lattice, others);
  EXPECT_GT(lattice.bodies.size(), 0);
  EXPECT_EQ(lattice.beams.young, young);
  packed.unpack(lattice);
  EXPECT_EQ(lattice.beams.young, young);
  EXPECT_EQ(lattice.beams.shear_modulus.size(), young.size());
}

}  // namespace
}  // namespace floe
