// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/surface_distances.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "brep/mesh/solid.h"
#include "convert/voxel/voxelise.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

void add_box(brep::Triangles& mesh, const glm::dvec3& low, const glm::dvec3& high) {
  const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
  for (int corner = 0; corner < 8; ++corner)
    mesh.points_mm.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                corner & 4 ? high.z : low.z);
  constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : sides) {
    mesh.faces.push_back({first + a, first + b, first + c});
    mesh.faces.push_back({first + a, first + c, first + d});
  }
}

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
