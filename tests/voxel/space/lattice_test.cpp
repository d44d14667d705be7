// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/lattice.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

TEST(Lattice, AnIndexIsAVoxelsCentreSoBoundsReachHalfAVoxelFurther) {
  const Lattice lattice = axis_aligned_lattice({10, 20, 5}, {1.0, 0.5, 2.0}, {-4.5, 0.25, 1.0});
  const Box box = bounds(lattice);
  EXPECT_EQ(box.low_mm, glm::dvec3(-5.0, 0.0, 0.0));
  EXPECT_EQ(box.high_mm, glm::dvec3(5.0, 10.0, 10.0));
  EXPECT_EQ(lattice.lps_mm({0, 0, 0}), glm::dvec3(-4.5, 0.25, 1.0));
  EXPECT_EQ(lattice.voxel({-4.5, 0.25, 1.0}), glm::dvec3(0.0));
  EXPECT_DOUBLE_EQ(lattice.voxel_mm3(), 1.0);
}

TEST(Lattice, AMirroredAxisMakesItLeftHanded) {
  Lattice lattice = axis_aligned_lattice({4, 4, 4}, {1, 1, 1}, {0, 0, 0});
  EXPECT_TRUE(lattice.right_handed());
  lattice.lps_from_voxel[0][0] = -1.0;
  EXPECT_FALSE(lattice.right_handed());
  EXPECT_DOUBLE_EQ(lattice.voxel_mm3(), 1.0);
}

TEST(Universe, TheSmallestCubeOfVoxelsSharesTheBoxesCentre) {
  const Universe universe = universe_around({{-128, -128, -1}, {128, 128, 225}}, 1.0);
  EXPECT_EQ(universe.depth, 8);
  const Box box = bounds(universe.lattice());
  EXPECT_EQ(box.low_mm, glm::dvec3(-128, -128, -16));
  EXPECT_EQ(box.high_mm, glm::dvec3(128, 128, 240));
}

TEST(Universe, RefusesVoxelsThatWouldTakeMoreThanTwelveLevels) {
  EXPECT_THROW(universe_around({{0, 0, 0}, {5000, 1, 1}}, 1.0), std::length_error);
  EXPECT_THROW(universe_around({{0, 0, 0}, {1, 1, 1}}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
