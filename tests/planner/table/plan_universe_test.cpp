// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/table/plan_universe.h"

#include <gtest/gtest.h>

#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

TEST(PlanUniverse, RefusesFinerVoxelsThanMemoryHoldsBeforeWork) {
  const voxel::Lattice scan{{40, 40, 40}, glm::dmat4(1.0)};
  EXPECT_EQ(universe_of(scan, 0.25).lattice().spacing_mm(), glm::dvec3(0.25));
  try {
    universe_of(scan, 0.0005);
    FAIL() << "it should have been refused";
  } catch (const voxel::Error& error) {
    EXPECT_EQ(error.code(), voxel::ErrorCode::Resource);
    EXPECT_NE(std::string(error.what()).find("voxels of 0.0005 mm: in the scan's box they take "),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
