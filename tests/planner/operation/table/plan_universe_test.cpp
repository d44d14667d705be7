// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/plan_universe.h"

#include <cstdint>
#include <gtest/gtest.h>
#include <limits>

#include "voxel/filter/label_map.h"
#include "voxel/measure/measure.h"
#include "voxel/space/error.h"
#include "voxel/space/memory_need.h"

namespace octotomy::planner {
namespace {

TEST(PlanUniverse, RefusesFinerVoxelsThanMemoryHoldsBeforeWork) {
  const voxel::Lattice scan{{40, 40, 40}, glm::dmat4(1.0)};
  EXPECT_EQ(universe_of(scan, 0.25).lattice().spacing_mm(), glm::dvec3(0.25));
  voxel::limit_memory(std::uint64_t{4} << 30);
  try {
    universe_of(scan, 0.02);
    FAIL() << "it should have been refused";
  } catch (const voxel::Error& error) {
    EXPECT_EQ(error.code(), voxel::ErrorCode::Resource);
    EXPECT_NE(std::string(error.what()).find("voxels of 0.02 mm: in the scan's box they take 16 GB"),
              std::string::npos)
        << error.what();
  }
  voxel::limit_memory(std::numeric_limits<std::uint64_t>::max());
}

TEST(PlanUniverse, VoxelsOfALabelMapFillItsCells) {
  for (const double thick_mm : {1.0, 2.0, 3.0, 4.0}) {
    voxel::Scene scene;
    scene.lattice = voxel::axis_aligned_lattice({8, 8, 8}, {1.0, 1.0, thick_mm}, {3, -2, 5});
    scene.meaning = voxel::Meaning::Label;
    voxel::Int16Samples samples(512, 0);
    for (int z = 2; z < 5; ++z)
      for (int y = 3; y < 6; ++y) samples[static_cast<std::size_t>((z * 8 + y) * 8 + 4)] = 1;
    scene.samples = std::move(samples);
    const voxel::Universe universe = universe_of(scene, std::nullopt);
    ASSERT_EQ(universe.lattice().spacing_mm(), glm::dvec3(1.0));
    const voxel::Measures measures = voxel::measure(voxel::octree_of_label(universe, scene, 1));
    EXPECT_NEAR(measures.volume_mm3, 9.0 * thick_mm, 1e-9);
    const glm::dvec3 middle = scene.lattice.lps_mm({4, 4, 3});
    EXPECT_LT(glm::distance(*measures.centroid_mm, middle), 1e-9) << thick_mm;
    scene.meaning = voxel::Meaning::Raw;
    EXPECT_TRUE(universe_of(scene, std::nullopt, true) == universe);
    EXPECT_TRUE(universe_of(scene, std::nullopt) == universe_of(scene.lattice, std::nullopt));
  }
}

}  // namespace
}  // namespace octotomy::planner
