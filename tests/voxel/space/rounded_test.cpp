// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/rounded.h"

#include <gtest/gtest.h>
#include <limits>

namespace octotomy::voxel {
namespace {

TEST(Rounded, KeepsThreeSignificantDigitsOfAnySize) {
  EXPECT_EQ(rounded(6.035699), "6.04");
  EXPECT_EQ(rounded(-0.0123456), "-0.0123");
  EXPECT_EQ(rounded(1876.42), "1880");
  EXPECT_EQ(rounded(355917.0), "356000");
  EXPECT_EQ(rounded(696.9), "697");
  EXPECT_EQ(rounded(5.0), "5");
  EXPECT_EQ(rounded(0.0), "0");
  EXPECT_EQ(rounded(3e-15), "3.00e-15");
}

TEST(Rounded, SaysWhatIsNoNumber) {
  EXPECT_EQ(rounded(std::numeric_limits<double>::quiet_NaN()), "not a number");
  EXPECT_EQ(rounded(std::numeric_limits<double>::infinity()), "infinitely many");
}

TEST(Rounded, HasPlacesInWholeMillimetresAndNoMinusZero) {
  EXPECT_EQ(rounded(glm::dvec3(12.2, -79.9, -0.2)), "(12, -80, 0)");
}

}  // namespace
}  // namespace octotomy::voxel
