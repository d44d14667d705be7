// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/topology.h"

#include <gtest/gtest.h>

#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

using voxel::Expression;
using voxel::Octree;

voxel::Universe universe() {
  voxel::Universe of_64;
  of_64.depth = 6;
  return of_64;
}
/// The voxels from one corner up to another, both in it.
Expression block(const glm::dvec3& low, const glm::dvec3& high) {
  return voxel::Box{universe().lattice().lps_mm(low - 0.4), universe().lattice().lps_mm(high + 0.4)};
}
Octree made(const Expression& expression) {
  return voxel::combine(universe(), expression);
}

const Expression shell = block({4, 4, 4}, {20, 20, 20}) - block({8, 8, 8}, {14, 14, 14});
const Expression ring = block({30, 30, 30}, {40, 40, 34}) - block({34, 34, 28}, {36, 36, 36});

TEST(Topology, CountsPartsCavitiesAndTunnels) {
  const Topology found = topology(made(shell | ring));
  EXPECT_EQ(found.parts, 2);
  EXPECT_EQ(found.cavities, 1);
  EXPECT_EQ(found.tunnels, 1);
  const Topology none = topology(Octree::empty(universe()));
  EXPECT_EQ(none.parts + none.cavities + none.tunnels, 0);
}

TEST(Topology, APartOfThreeVoxelsASideThatOneAloneHasIsNamedWithItsPlace) {
  const Octree voxels = made(shell | ring);
  const Octree mesh =
      made(shell | ring | block({50, 50, 50}, {52, 52, 52}) | block({50, 50, 4}, {60, 60, 5}));
  for (const bool swapped : {false, true}) {
    const Unmatched found = swapped ? unmatched_parts(mesh, voxels) : unmatched_parts(voxels, mesh);
    EXPECT_EQ(found.count, 1U) << "a sheet two voxels thick may be chance";
    ASSERT_TRUE(found.largest);
    EXPECT_EQ(found.largest->what, swapped ? part_of_voxels_only : part_of_mesh_only);
    EXPECT_NEAR(glm::length(found.largest->at_mm - universe().lattice().lps_mm({51, 51, 51})), 0.0, 1e-9);
    EXPECT_DOUBLE_EQ(found.largest->volume_mm3, 27.0);
  }
  EXPECT_EQ(unmatched_parts(voxels, voxels).count, 0U);
  EXPECT_EQ(unmatched_parts(voxels, made(shell | ring | block({20, 20, 20}, {24, 24, 24}))).count, 0U)
      << "it grew at a part that both have";
}

TEST(Topology, AFilledCavityIsNamedAndOneThatOpensIsNot) {
  const Octree voxels = made(shell);
  const Unmatched filled = unmatched_cavities(voxels, made(shell | block({8, 8, 8}, {14, 14, 14})));
  EXPECT_EQ(filled.count, 1U);
  ASSERT_TRUE(filled.largest);
  EXPECT_DOUBLE_EQ(filled.largest->volume_mm3, 343.0);
  EXPECT_EQ(unmatched_cavities(voxels, made(shell - block({10, 10, 2}, {10, 10, 9}))).count, 0U)
      << "its wall has a hole, which one voxel may make";
  EXPECT_EQ(unmatched_cavities(voxels, made(shell | block({8, 8, 8}, {14, 14, 12}))).count, 0U);
}

TEST(Topology, ALostPartLowersACertificateAndSaysWhere) {
  Certificate certificate;
  compare_topology(certificate, made(shell | ring), made(shell));
  EXPECT_EQ(certificate.verdict, Verdict::Fail);
  ASSERT_EQ(certificate.reasons.size(), 1U);
  EXPECT_NE(
      certificate.reasons.front().find("Parts that one kernel alone has, the largest near (35, 35, 32): 1"),
      std::string::npos)
      << certificate.reasons.front();
  Certificate right;
  compare_topology(right, made(shell | ring), made(shell | ring));
  EXPECT_EQ(right.verdict, Verdict::Pass);
  EXPECT_EQ(right.comparisons.size(), 3U);
}

}  // namespace
}  // namespace octotomy::verify
