// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/number_format.h"

#include <gtest/gtest.h>
#include <limits>

namespace octotomy::planner {
namespace {

TEST(Figures, GroupsFromFiveDigitsOnAndKeepsTheDecimalsWhole) {
  EXPECT_EQ(grouped(1234.5678, 3), "1234.568");
  EXPECT_EQ(grouped(12345.6789, 4), "12\u202f345.6789");
  EXPECT_EQ(grouped(1234567, 0), "1\u202f234\u202f567");
  EXPECT_EQ(grouped(0, 2), "0.00");
}

TEST(Figures, HasATrueMinusButNoneBeforeZero) {
  EXPECT_EQ(grouped(-12345, 0), "\u221212\u202f345");
  EXPECT_EQ(grouped(-0.004, 2), "0.00");
}

TEST(Figures, ShowsADashWhereThereIsNoNumber) {
  EXPECT_EQ(grouped(std::numeric_limits<double>::quiet_NaN(), 1), "\u2013");
  EXPECT_EQ(three_figures(std::numeric_limits<double>::infinity()), "\u2013");
}

TEST(Figures, KeepsThreeSignificantFigures) {
  EXPECT_EQ(three_figures(1234.4), "1234");
  EXPECT_EQ(three_figures(56.74), "56.7");
  EXPECT_EQ(three_figures(0.012345), "0.0123");
  EXPECT_EQ(three_figures(0.0), "0");
}

TEST(Figures, ArePlainUntilTheyGrowTooLongToRead) {
  EXPECT_EQ(plain(-0.5), "-0.5");
  EXPECT_EQ(plain(300.0), "300");
  EXPECT_EQ(plain(123456789012345.0), "123456789012345");
  EXPECT_EQ(plain(-1e300), "-1e+300");
}

}  // namespace
}  // namespace octotomy::planner
