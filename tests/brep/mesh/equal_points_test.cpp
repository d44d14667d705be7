// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/equal_points.h"

#include <gtest/gtest.h>

namespace octotomy::brep {
namespace {

TEST(EqualPoints, NameTheFirstOfTheirPlace) {
  EXPECT_EQ(first_equal_points({{1, 2, 3}, {0.0, 0, 0}, {1, 2, 3}, {-0.0, 0, 0}, {1, 2, 3.0000001}}),
            (std::vector<std::uint32_t>{0, 1, 0, 1, 4}));
  EXPECT_TRUE(first_equal_points({}).empty());
}

}  // namespace
}  // namespace octotomy::brep
