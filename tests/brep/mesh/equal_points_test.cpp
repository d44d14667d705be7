// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/equal_points.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace octotomy::brep {
namespace {

TEST(EqualPoints, NameTheFirstOfTheirPlace) {
  EXPECT_EQ(first_equal_points({{1, 2, 3}, {0.0, 0, 0}, {1, 2, 3}, {-0.0, 0, 0}, {1, 2, 3.0000001}}),
            (std::vector<std::uint32_t>{0, 1, 0, 1, 4}));
  EXPECT_TRUE(first_equal_points({}).empty());
}

/// Points that occur again after many others keep their numbers, independent of the expected count.
TEST(EqualPoints, KeepTheNumbersInWhichTheyWereMet) {
  constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
  for (const std::size_t expected : {0, 3, 5000}) {
    std::vector<glm::dvec3> points_mm;
    PointNumbers numbers(points_mm, expected);
    for (int round = 0; round < 2; ++round)
      for (std::uint32_t i = 0; i < 1000; ++i) EXPECT_EQ(numbers.number_of({i, -1.0 * i, 0.5}), i);
    EXPECT_EQ(numbers.number_of({-0.0, 0.0, 0.5}), 0U);
    EXPECT_EQ(numbers.number_of({no_number, 0.0, 0.0}), 1000U);
    EXPECT_EQ(numbers.number_of({no_number, 0.0, 0.0}), 1001U);
    ASSERT_EQ(points_mm.size(), 1002U);
    EXPECT_EQ(points_mm[999], glm::dvec3(999.0, -999.0, 0.5));
    EXPECT_FALSE(std::signbit(points_mm[0].y));
  }
}

}  // namespace
}  // namespace octotomy::brep
