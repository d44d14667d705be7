// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/table/plan_universe.h"

#include <cstdint>
#include <gtest/gtest.h>
#include <limits>

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

}  // namespace
}  // namespace octotomy::planner
