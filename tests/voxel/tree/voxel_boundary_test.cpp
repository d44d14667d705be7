// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/voxel_boundary.h"

#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using tests::unit_universe;

TEST(VoxelBoundary, ABoxAcrossBlocksHasTheFacesOfItsSixSides) {
  const Octree box = combine(unit_universe(5), Box{{2.5, 3.5, 0.5}, {18.5, 20.5, 9.5}});
  ASSERT_EQ(box.voxel_count(), 16u * 17u * 9u);
  glm::ivec3 low(0), high(0);
  for (const VoxelFace& face : voxel_boundary(box)) {
    (face.side < 0 ? low : high)[face.axis] += 1;
    EXPECT_EQ(face.voxel[face.axis],
              face.side < 0 ? glm::ivec3(3, 4, 1)[face.axis] : glm::ivec3(18, 20, 9)[face.axis]);
  }
  EXPECT_EQ(low, glm::ivec3(17 * 9, 16 * 9, 16 * 17));
  EXPECT_EQ(high, low);
}

TEST(VoxelBoundary, AFullUniverseEndsAtItsOwnSides) {
  EXPECT_EQ(voxel_boundary(Octree::full(unit_universe(4))).size(), 6u * 16u * 16u);
  EXPECT_TRUE(voxel_boundary(Octree::empty(unit_universe(4))).empty());
}

TEST(VoxelBoundary, EveryFaceOfASphereLiesBetweenInsideAndOutsideAndNoneIsMissing) {
  const Octree sphere = combine(unit_universe(6), Sphere{{30.2, 31.1, 29.7}, 21.3});
  glm::dvec3 faces(0.0);
  for (const VoxelFace& face : voxel_boundary(sphere)) {
    glm::ivec3 beyond = face.voxel;
    beyond[face.axis] += face.side;
    EXPECT_TRUE(sphere.contains(face.voxel));
    EXPECT_FALSE(sphere.contains(beyond));
    faces[face.axis] += 1.0;
  }
  EXPECT_EQ(faces, measure(sphere).exposed_mm2);
}

}  // namespace
}  // namespace octotomy::voxel
