// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/surface_distances.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "brep/mesh/solid.h"
#include "convert/voxel/voxelise.h"
#include "tests/verify/add_box.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

using tests::add_box;

voxel::Octree digitised(const brep::Triangles& mesh) {
  voxel::Universe universe;
  universe.depth = 5;
  return convert::voxelise(universe, brep::trusted_solid(mesh, brep::Proof::Construction).linked());
}

/// Half a voxel's diagonal.
const double reach_mm = 0.5 * std::sqrt(3.0);

/// A block of ten voxels a side.
brep::Triangles block() {
  brep::Triangles mesh;
  add_box(mesh, glm::dvec3(4.5), glm::dvec3(14.5));
  return mesh;
}
/// The block, and a strip that is thinner than a voxel and lies between two layers of centres.
brep::Triangles block_and_strip() {
  brep::Triangles mesh = block();
  add_box(mesh, {2.1, 5.2, 25.3}, {3.6, 25.2, 25.6});
  return mesh;
}

TEST(SurfaceDistances, OfAStripThatVoxelsCannotHoldLeaveOutItsRimsToo) {
  const brep::Triangles mesh = block_and_strip();
  const brep::Solid solid = brep::trusted_solid(mesh, brep::Proof::Construction);
  const voxel::Octree octree = digitised(mesh);
  ASSERT_EQ(octree.voxel_count(), 1000U);
  SurfaceDistances distances(octree, solid, mesh, false);
  EXPECT_GT(distances.largest_mm(), 10.0);
  // The strip's upper and lower sides. Its rims are 1.5 mm and 20 mm thick along their own normals.
  EXPECT_NEAR(distances.leave_out_thin(), 2.0 * 1.5 * 20.0, 1e-9);
  EXPECT_GT(distances.largest_mm(), 10.0);
  EXPECT_NEAR(distances.leave_out_unheld(octree, reach_mm), 2.0 * 0.3 * (1.5 + 20.0), 1e-9);
  EXPECT_LT(distances.largest_mm(), 1e-9);
}

TEST(SurfaceDistances, APartThatVoxelsCanHoldAndLackStays) {
  const brep::Triangles mesh = block_and_strip();
  const brep::Solid solid = brep::trusted_solid(mesh, brep::Proof::Construction);
  brep::Triangles half;
  add_box(half, glm::dvec3(4.5), {8.5, 14.5, 14.5});
  SurfaceDistances distances(digitised(half), solid, mesh, false);
  distances.leave_out_thin();
  distances.leave_out_unheld(digitised(mesh), reach_mm);
  EXPECT_GT(distances.percentile95_mm(), 5.0);
  EXPECT_LE(distances.largest_mm(), 6.0);
  EXPECT_GT(distances.largest_mm(), 5.0);
}

/// The area of what was left out before does not count as area that was not sampled.
TEST(SurfaceDistances, ThinAreaIsMeasuredOnceBesideVoxelsThatWereLeftOut) {
  const brep::Triangles mesh = block_and_strip();
  const brep::Solid solid = brep::trusted_solid(mesh, brep::Proof::Construction);
  const voxel::Octree octree = digitised(mesh);
  SurfaceDistances distances(octree, solid, mesh, false);
  distances.leave_out_beside({{9, 9, 4}});
  EXPECT_NEAR(distances.leave_out_thin(), 2.0 * 1.5 * 20.0, 1e-9);
}

}  // namespace
}  // namespace octotomy::verify
