// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/voxel_boundary.h"

#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

using tests::unit_universe;

TEST(VoxelBoundary, ABoxAcrossBlocksHasTheFacesOfItsSixSides) {
  const voxel::Octree box = voxel::combine(unit_universe(5), voxel::Box{{2.5, 3.5, 0.5}, {18.5, 20.5, 9.5}});
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
  EXPECT_EQ(voxel_boundary(voxel::Octree::full(unit_universe(4))).size(), 6u * 16u * 16u);
  EXPECT_TRUE(voxel_boundary(voxel::Octree::empty(unit_universe(4))).empty());
}

TEST(VoxelBoundary, EveryFaceOfASphereLiesBetweenInsideAndOutsideAndNoneIsMissing) {
  const voxel::Octree sphere = voxel::combine(unit_universe(6), voxel::Sphere{{30.2, 31.1, 29.7}, 21.3});
  glm::dvec3 faces(0.0);
  for (const VoxelFace& face : voxel_boundary(sphere)) {
    glm::ivec3 beyond = face.voxel;
    beyond[face.axis] += face.side;
    EXPECT_TRUE(sphere.contains(face.voxel));
    EXPECT_FALSE(sphere.contains(beyond));
    faces[face.axis] += 1.0;
  }
  EXPECT_EQ(faces, voxel::measure(sphere).exposed_mm2);
}

}  // namespace
}  // namespace octotomy::verify
